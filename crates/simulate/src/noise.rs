//! Noise of the sensors: a stream of its own for each run.

use forcefeel_model::transducers::SENSORS;
use forcefeel_solve::wide::Wide;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Standard normal numbers for runs side by side.
#[derive(Debug, Clone)]
pub struct Noise(Vec<ChaCha8Rng>);

impl Noise {
    /// The streams of these runs under a seed.
    pub fn new(seed: u64, runs: impl Iterator<Item = u64>) -> Self {
        let stream = |run: u64| {
            let mut stream = ChaCha8Rng::seed_from_u64(seed);
            stream.set_stream(run);
            stream
        };
        Self(runs.map(stream).collect())
    }

    /// A number for each sensor of each run.
    pub fn next<T: Wide>(&mut self, token: T::Token) -> [T; SENSORS] {
        let mut numbers = || {
            let drawn: Vec<f64> = self.0.iter_mut().map(|stream| StandardNormal.sample(stream)).collect();
            T::gather(token, |run| drawn[run])
        };
        [numbers(), numbers(), numbers()]
    }
}
