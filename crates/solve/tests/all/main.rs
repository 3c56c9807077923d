//! The algorithms.

mod discretize;
mod draws;
mod feel_transition;
mod linear_batch;
mod linearize;
mod near;
mod recursion;
mod release;
mod rows;
mod schedule;
mod stability;
