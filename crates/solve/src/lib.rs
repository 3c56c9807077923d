//! Algorithms over a model. No physics here: what is asked of a loader is in `forcefeel-model`.
//!
//! | question | file |
//! |---|---|
//! | state-space matrices of a model | [`linearize`](mod@linearize) |
//! | matrices and their slopes along parameters | [`slopes`] |
//! | state transition over one step | [`discretize`](mod@discretize) |
//! | recursion (22), dynamic programming | [`riccati`] |
//! | gains for many feel settings of one plant | [`schedule`] |
//! | a run in time | [`simulate`] |
//! | the programmed feel alone, in time, and from one time to another | [`feel_alone`](mod@feel_alone), [`feel_transition`](mod@feel_transition) |
//! | many runs, in vector lanes over the cores | [`batch`], [`lanes`], [`wide`] |
//! | runs and their slopes along parameters | [`record_slopes`] |
//! | what a run gives, what is asked of it | [`outputs`], [`measures`] |
//! | stability of many loops, proved | [`stability`], [`bounded`] |
//! | their poles | [`poles`] |
//! | their linear runs, exact | [`linear_batch`], [`transition`] |
//! | features of a control that is let go | [`release`], [`local_fit`] |
//! | their releases, the pilot's arm at the grip | [`releases`] |
//! | noise of the sensors | [`noise`] |
#![forbid(unsafe_code)]

pub mod balance;
pub mod batch;
pub mod bounded;
pub mod discretize;
pub mod feel_alone;
pub mod feel_transition;
pub mod lanes;
pub mod linear_batch;
pub mod linearize;
pub mod local_fit;
pub mod loops;
pub mod measures;
pub mod noise;
pub mod outputs;
pub mod pair;
pub mod poles;
pub mod record_slopes;
pub mod release;
pub mod releases;
pub mod riccati;
pub mod sampled_loops;
pub mod schedule;
pub mod simulate;
pub mod slopes;
pub mod stability;
mod threads;
pub mod transition;
pub mod wide;

pub use discretize::discretize;
pub use linearize::{StateSpace, linearize};
pub use threads::NoThreads;
