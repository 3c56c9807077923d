//! The algorithms.

mod discretize;
#[path = "../../../model/tests/all/draws/mod.rs"]
mod draws;
mod feel_transition;
mod frequency_response;
mod linear_batch;
mod linearize;
mod loops;
#[path = "../../../model/tests/all/near/mod.rs"]
mod near;
mod random;
mod recursion;
mod release;
mod rows;
mod schedule;
mod stability;
mod unit_circle;
