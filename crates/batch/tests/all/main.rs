//! Runs in time, their slopes, and the matrices of a period.

mod batch;
mod batch_lanes;
mod batch_linear;
mod batch_observers;
#[path = "../../../model/tests/all/draws/mod.rs"]
mod draws;
#[path = "../../../model/tests/all/near/mod.rs"]
mod near;
mod observers;
mod operations;
mod record_slopes;
mod runs;
mod sampled_loops;
