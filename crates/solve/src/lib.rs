//! Algorithms over a model. No physics here: what is asked of a loader is in `forcefeel-model`.
//!
//! | question | file |
//! |---|---|
//! | state-space matrices of a model | [`linearize`](mod@linearize) |
//! | state transition over one step | [`discretize`](mod@discretize) |
//! | recursion (22), dynamic programming | [`riccati`] |
//! | gains for many feel settings of one plant | [`schedule`] |
//! | a run in time | [`simulate`] |
//! | many runs, in vector lanes over the cores | [`batch`], [`lanes`] |
//! | what is asked of a run | [`measures`] |
//! | noise of the sensors | [`noise`] |
#![forbid(unsafe_code)]

pub mod batch;
pub mod discretize;
pub mod lanes;
pub mod linearize;
pub mod measures;
pub mod noise;
pub mod pair;
pub mod riccati;
pub mod schedule;
pub mod simulate;

pub use discretize::discretize;
pub use linearize::{StateSpace, linearize};
