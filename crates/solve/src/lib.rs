//! Algorithms over a model. No physics here: what is asked of a loader is in `forcefeel-model`. Its nonlinear runs in time are in
//! `forcefeel-simulate`.
//!
//! | question | file |
//! |---|---|
//! | state-space matrices of a model | [`linearize`](mod@linearize) |
//! | state transition over one step | [`discretize`](mod@discretize) |
//! | recursion (22), dynamic programming | [`riccati`] |
//! | gains for many feel settings of one plant | [`schedule`] |
//! | the programmed feel alone, in time, and from one time to another | [`feel_alone`](mod@feel_alone), [`feel_transition`](mod@feel_transition) |
//! | frequency response | [`frequency_response`] |
//! | many at once, in vector lanes over the cores | [`lanes`], [`wide`], [`threads`] |
//! | laws of many, where a run begins and would rest, what it gives | [`law`], [`start`], [`rest`], [`outputs`] |
//! | stability of many loops, proved | [`stability`], [`bounded`] |
//! | their poles | [`poles`] |
//! | whether the poles of many matrices are inside the unit circle | [`unit_circle`] |
//! | their linear runs, exact | [`linear_batch`], [`transition`] |
//! | random numbers, noise of the sensors | [`random`], [`sensor_noise`] |
//! | a loader that has slopes | [`smooth`] |
//! | features of a control that is let go | [`release`], [`local_fit`] |
//! | whether that is within a rule's tolerances | [`release_verdict`] |
//! | their releases, the pilot's arm at the grip | [`releases`] |
#![forbid(unsafe_code)]

pub mod balance;
pub mod bounded;
pub mod discretize;
pub mod feel_alone;
pub mod feel_transition;
pub mod frequency_response;
pub mod lanes;
pub mod law;
pub mod linear_batch;
pub mod linearize;
pub mod local_fit;
pub mod loops;
pub mod outputs;
pub mod poles;
pub mod random;
pub mod release;
pub mod release_verdict;
pub mod releases;
pub mod rest;
pub mod riccati;
pub mod schedule;
pub mod sensor_noise;
pub mod smooth;
pub mod stability;
pub mod start;
pub mod stationary;
pub mod threads;
pub mod transition;
pub mod unit_circle;
pub mod wide;

pub use discretize::{balanced, discretize, exponential, propagated};
pub use linearize::{StateSpace, linearize};
