//! The loop in real time.

mod histogram;
mod host;
mod no_allocation;
mod packets;
mod stall;
