//! What an aircraft simulator sends to a loader and gets from it: pure, no clock, no sockets.
//!
//! | part | file |
//! |---|---|
//! | the bytes of a packet, both ways | [`packet`] |
//! | what goes in between two packets, so that no force has a step; silence | [`stream`] |
//! | autopilot, shaker, pusher, add-in force and trained faults, as what the feel is told | [`effects`] |
//!
//! A loop hands each packet that arrives to [`stream::Stream`], asks it once a sample what holds now, and gives that to
//! [`effects::HostEffects`], whose [`effects::FeelCommand`] the feel understands: a neutral, a factor on the spring, a torque, the shaker.

pub mod effects;
pub mod packet;
pub mod stream;

pub use effects::HostEffects;
pub use packet::{FromHost, ToHost};
pub use stream::Stream;
