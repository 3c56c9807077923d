//! Random numbers, the same each time.

/// A linear congruential generator (Knuth's MMIX), its upper half.
pub struct Draws(u64);

impl Draws {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }
    /// Between -1 and 1.
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let upper = u32::try_from(self.0 >> 32).expect("32 bits");
        f64::from(upper) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}
