//! Nonlinear runs in time: a loader, or many side by side, through the steps of their inputs.
//!
//! | question | file |
//! |---|---|
//! | a run | [`run`](mod@run) |
//! | many runs, in vector lanes over the cores | [`batch`], [`pair`] |
//! | what is asked of a run | [`measures`] |
//! | runs and their slopes along parameters | [`record_slopes`] |
//! | noise of the sensors | [`noise`] |
#![forbid(unsafe_code)]

pub mod batch;
pub mod measures;
pub mod noise;
pub mod pair;
pub mod record_slopes;
pub mod run;
