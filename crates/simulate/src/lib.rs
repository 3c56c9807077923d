//! Nonlinear runs in time: a loader, or many side by side, through the steps of their inputs.
//!
//! All of it is generic over the drive and the number: compiled for each drive in `forcefeel-batch`, on dual numbers in `forcefeel-slopes`.
//!
//! | question | file |
//! |---|---|
//! | a run | [`run`](mod@run) |
//! | many runs, in vector lanes | [`batch`], [`pair`] |
//! | what is asked of a run | [`measures`] |
//! | two loaders joined by a link, and their feels alone | [`linked`], [`feel_pair`] |
//! | noise of the sensors | [`noise`] |
#![forbid(unsafe_code)]

pub mod batch;
pub mod feel_pair;
pub mod linked;
pub mod measures;
pub mod noise;
pub mod pair;
pub mod run;
