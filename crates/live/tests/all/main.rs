//! The loop in real time.

mod axes;
mod drive_fault;
mod histogram;
mod host;
mod loader;
mod no_allocation;
mod packets;
mod priority;
mod record;
mod stall;
mod test_signal;
