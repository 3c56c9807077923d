//! Noise of the sensors: a stream of its own for each run.

use forcefeel_model::transducers::SENSORS;
use forcefeel_solve::wide::Wide;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Standard normal numbers for runs side by side.
#[derive(Debug, Clone)]
pub struct Noise {
    /// Of load cell, potentiometer and column sensor.
    column: Vec<ChaCha8Rng>,
    /// Of the grip's sensor; none where there is no such sensor.
    grip: Vec<ChaCha8Rng>,
}

/// Streams from here on are those of the grip's sensors: with it or without, the others' noise is the same.
const OF_GRIP: u64 = 1 << 63;

impl Noise {
    /// The streams of these runs under a seed.
    pub fn new(seed: u64, runs: impl Iterator<Item = u64> + Clone, grip_sensor: bool) -> Self {
        let stream = |run: u64| {
            let mut stream = ChaCha8Rng::seed_from_u64(seed);
            stream.set_stream(run);
            stream
        };
        let grip = if grip_sensor { runs.clone().map(|run| stream(run | OF_GRIP)).collect() } else { Vec::new() };
        Self { column: runs.map(stream).collect(), grip }
    }

    /// A number for each sensor of each run.
    pub fn next<T: Wide>(&mut self, token: T::Token) -> [T; SENSORS] {
        let numbers = |streams: &mut [ChaCha8Rng]| {
            let drawn: Vec<f64> = streams.iter_mut().map(|stream| StandardNormal.sample(stream)).collect();
            T::gather(token, |run| drawn.get(run).copied().unwrap_or_default())
        };
        let column = &mut self.column;
        [numbers(column), numbers(column), numbers(column), numbers(&mut self.grip)]
    }
}
