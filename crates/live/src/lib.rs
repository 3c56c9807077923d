//! A loader live: one thread that samples, asks the model's controller, lets the supervisor pass on, and writes, once a period.
//!
//! | question | file |
//! |---|---|
//! | what is at the other end: the machine simulated, or over the network | [`input_output`], [`simulated`], [`simulated_pair`], [`udp`] |
//! | or on a bus of drives: its axes; CAN, its carriers; EtherCAT, its interface | [`bus`]; [`can_bus`], [`carrier`], [`serial`], `socket_can`; `ethercat`, `raw_socket` |
//! | emulated drives on a bus: the port, the wire, a drive with its machine | [`emulator`], [`emulated_wire`], [`emulated_axis`] |
//! | a period, without a clock: law, feel, changes of the feel, supervisor | [`controller`], [`supervision`] |
//! | an aircraft simulator as host: what it does to the feel, its socket | [`host_control`], [`host_link`] |
//! | what is asked of a running loop | [`request`] |
//! | the thread: waits, counts, never catches up; all axes of a cockpit | [`axes`], [`cycle`], [`clock`], [`priority`] |
//! | what the rest of the process sees of it | [`row`], [`status`], [`running`] |
//! | records that stay whole, the rows that they keep, room for them, the format of their files, their replay | [`record`], [`thinning`], [`whole_file`], [`room`], [`mcap`], [`mcap_writer`], [`mcap_reader`], [`replay`] |
//!
//! The thread makes no allocation, takes no lock and calls the system for the wait, the input and the output alone; rings carry requests to
//! it and rows from it. The same [`controller::Controller`] runs live, in virtual time and in a replay: the same samples and
//! requests give the same bits.
#![deny(unsafe_code)]

pub mod axes;
pub mod bus;
pub mod can_bus;
pub mod carrier;
pub mod clock;
pub mod controller;
pub mod cycle;
pub mod emulated_axis;
// Only Linux has a port of CAN or EtherCAT beside the serial one.
#[cfg_attr(not(target_os = "linux"), allow(irrefutable_let_patterns))]
pub mod emulated_wire;
pub mod emulator;
#[cfg(target_os = "linux")]
pub mod ethercat;
pub mod host_control;
pub mod host_link;
pub mod input_output;
pub mod mcap;
pub mod mcap_reader;
pub mod mcap_writer;
pub mod priority;
#[cfg(target_os = "linux")]
pub mod raw_socket;
pub mod record;
pub mod replay;
pub mod request;
pub mod room;
pub mod row;
pub mod running;
pub mod serial;
pub mod setup;
pub mod simulated;
pub mod simulated_pair;
#[cfg(target_os = "linux")]
pub mod socket_can;
pub mod status;
pub mod supervision;
pub mod test_signal;
pub mod thinning;
pub mod udp;
pub mod whole_file;
