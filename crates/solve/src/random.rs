//! Streams of random numbers, alike in simulations, live machines, FMUs and injected faults.
//!
//! Each stream is a function of its seed and its number alone, so one run of many is repeated by itself. The generator is xoshiro256++ (D. Blackman,
//! S. Vigna, ACM Trans. Math. Software 47 (2021)), its state four outputs of `SplitMix64` from a hash of the seed plus the number, as its authors advise.
//! Streams of one seed never start in the same state, those of two seeds by chance: one pair in 2^64. All streams lie on one cycle of 2^256 - 1 states, from
//! places that are as good as drawn: with a million streams of a million numbers each, two overlap somewhere with a chance of 2^-196. Hence no jumps,
//! which would cost more than a short run.

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rand_xoshiro::{SplitMix64, Xoshiro256PlusPlus};

/// One stream.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RandomStream(Xoshiro256PlusPlus);

impl RandomStream {
    /// The stream of a number under a seed.
    pub fn new(seed: u64, number: u64) -> Self {
        // Without the hash, run 1 of seed 0 would be run 0 of seed 1.
        let hash = SplitMix64::seed_from_u64(seed).next_u64();
        Self(Xoshiro256PlusPlus::seed_from_u64(hash.wrapping_add(number)))
    }

    /// A number of the standard normal distribution.
    #[inline]
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    /// A number from zero to below one.
    #[inline]
    pub fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.0)
    }
}
