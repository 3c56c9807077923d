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
    /// Numbers of [`AHEAD`] samples: sample by sample, sensor by sensor, run by run.
    drawn: Vec<f64>,
    /// Samples of these that are used up.
    used: usize,
}

/// Streams from here on are those of the grip's sensors: with it or without, the others' noise is the same.
const OF_GRIP: u64 = 1 << 63;

/// Samples that are drawn at a time. To draw one stream's numbers in a row is faster than to change streams for each.
const AHEAD: usize = 16;

impl Noise {
    /// The streams of these runs under a seed; one alone is for all runs.
    pub fn new(seed: u64, runs: &[u64], grip_sensor: bool) -> Self {
        let stream = |run: u64| {
            let mut stream = ChaCha8Rng::seed_from_u64(seed);
            stream.set_stream(run);
            stream
        };
        let grip = if grip_sensor { runs.iter().map(|run| stream(run | OF_GRIP)).collect() } else { Vec::new() };
        let column = runs.iter().copied().map(stream).collect();
        Self { column, grip, drawn: vec![0.0; AHEAD * SENSORS * runs.len()], used: AHEAD }
    }

    /// A number for each sensor of each run.
    #[inline(always)]
    pub fn next<T: Wide>(&mut self, token: T::Token) -> [T; SENSORS] {
        if self.used == AHEAD {
            self.draw();
        }
        let (runs, sample) = (self.column.len(), self.used);
        self.used += 1;
        core::array::from_fn(|sensor| {
            let numbers = &self.drawn[(sample * SENSORS + sensor) * runs..][..runs];
            T::gather(token, |run| numbers[run.min(runs - 1)])
        })
    }

    /// Draws the numbers of the next samples. Those of a grip without a sensor stay zero.
    #[inline(never)]
    fn draw(&mut self) {
        let runs = self.column.len();
        for (streams, sensors) in [(&mut self.column, 0..SENSORS - 1), (&mut self.grip, SENSORS - 1..SENSORS)] {
            for (run, stream) in streams.iter_mut().enumerate() {
                for sample in 0..AHEAD {
                    for sensor in sensors.clone() {
                        self.drawn[(sample * SENSORS + sensor) * runs + run] = StandardNormal.sample(stream);
                    }
                }
            }
        }
        self.used = 0;
    }
}
