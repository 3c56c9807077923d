//! Slopes, by dual numbers: a step, or a period, on numbers that carry their derivative.
//!
//! | of | file |
//! |---|---|
//! | records of a bench, along parameters | [`record_slopes`] |
//! | a period of a digital controller: its matrix | [`sampled_loops`] |
//! | the matrices of many | [`periods`] |
#![forbid(unsafe_code)]

pub mod periods;
pub mod record_slopes;
pub mod sampled_loops;

use forcefeel_model::dual::{Along, Dual};
use forcefeel_model::parameters::{COUNT, Parameters};

/// The parameters as dual numbers along one of them.
pub fn along(values: &[f64; COUNT], key: Option<usize>) -> Parameters<Dual> {
    let dual = |k: usize| if Some(k) == key { Dual::variable(values[k]) } else { Dual::constant(values[k]) };
    Parameters::from_values(&core::array::from_fn(dual))
}

/// The parameters with their slopes along so many of them at once; of fewer keys the rest have none.
pub fn along_each<const N: usize>(values: &[f64; COUNT], keys: &[usize]) -> Parameters<Dual<f64, Along<N>>> {
    let dual = |k: usize| Dual::along(values[k], |direction| keys.get(direction) == Some(&k));
    Parameters::from_values(&core::array::from_fn(dual))
}
