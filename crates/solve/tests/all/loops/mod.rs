//! Random loops, the same each time.

use crate::draws::Draws;
use forcefeel_model::parameters::{COUNT, Parameters};

/// The elevator loader's values, the columns of those of the linear model, and a row of these for each of `count` loops, each
/// number within `factor` times less or more of its own.
pub fn loops(seed: u64, count: usize, factor: f64) -> ([f64; COUNT], Vec<usize>, Vec<f64>) {
    let mut draws = Draws::new(seed);
    let common = Parameters::elevator().values();
    let columns: Vec<usize> = (0..COUNT).filter(|&k| common[k].is_finite() && common[k] != 0.0).collect();
    let rows = (0..count).flat_map(|_| columns.iter());
    let varied = rows.map(|&column| common[column] * factor.powf(draws.uniform())).collect();
    (common, columns, varied)
}
