//! Runs in time, their slopes, and the matrices of a period.

mod batch;
mod batch_lanes;
mod batch_linear;
mod batch_observers;
#[path = "../../../solve/tests/all/near/mod.rs"]
mod near;
mod observers;
mod operations;
mod record_slopes;
mod runs;
mod sampled_loops;
