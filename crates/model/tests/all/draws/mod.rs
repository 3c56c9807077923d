//! Random numbers, the same each time; the tests of other crates take them from here.
#![allow(dead_code, reason = "each crate takes what it needs")]

/// A linear congruential generator (Knuth's MMIX), its upper half.
pub struct Draws(u64);

impl Draws {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }
    /// The next 32 bits.
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        u32::try_from(self.0 >> 32).expect("32 bits")
    }
    /// A whole number within `low` and `high`, both included.
    pub fn whole(&mut self, low: i32, high: i32) -> i32 {
        let span = i64::from(high) - i64::from(low) + 1;
        i32::try_from(i64::from(low) + i64::from(self.bits()) % span).expect("between both")
    }
    /// Between -1 and 1.
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.bits()) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}
