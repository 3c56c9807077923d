//! Random numbers and random loops, the same each time.

use forcefeel_model::parameters::{COUNT, Parameters};

/// A linear congruential generator (Knuth's MMIX), its upper half.
pub struct Draws(u64);

impl Draws {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }
    /// A whole number within `low` and `high`, both included.
    pub fn whole(&mut self, low: i32, high: i32) -> i32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let span = i64::from(high) - i64::from(low) + 1;
        let drawn = i64::from(u32::try_from(self.0 >> 32).expect("32 bits")) % span;
        i32::try_from(i64::from(low) + drawn).expect("between both")
    }
    /// Between -1 and 1.
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.whole(-1_000_000, 1_000_000)) / 1e6
    }
}

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
