//! Noise of the sensors: a stream of its own for each run.

use forcefeel_model::transducers::SENSORS;
use forcefeel_solve::random::RandomStream;
use forcefeel_solve::sensor_noise::SensorNoise;
use forcefeel_solve::wide::Wide;

/// Standard normal numbers for runs side by side.
#[derive(Debug, Clone)]
pub struct Noise {
    /// For load cell, potentiometer and column sensor.
    column: Ahead,
    /// For the grip's sensor; none where there is no such sensor.
    grip: Option<Ahead>,
    /// Samples that are used up of those drawn.
    used: usize,
}

/// Samples that are drawn at a time. To draw one stream's numbers in a row is faster than to change streams for each.
const AHEAD: usize = 16;

impl Noise {
    /// The streams of these runs under a seed; one alone is for all runs.
    pub fn new(seed: u64, runs: &[u64], grip_sensor: bool) -> Self {
        let ahead = |sensors: usize, of: fn(SensorNoise) -> RandomStream| Ahead {
            streams: runs.iter().map(|&run| of(SensorNoise::new(seed, run))).collect(),
            drawn: vec![0.0; AHEAD * sensors * runs.len()],
        };
        let grip = grip_sensor.then(|| ahead(1, |noise| noise.grip));
        Self { column: ahead(SENSORS - 1, |noise| noise.column), grip, used: AHEAD }
    }

    /// A number for each sensor of each run; zero for a grip without one.
    #[inline(always)]
    pub fn next<T: Wide>(&mut self, token: T::Token) -> [T; SENSORS] {
        if self.used == AHEAD {
            self.draw();
        }
        let sample = self.used;
        self.used += 1;
        let column = |sensor: usize| self.column.numbers(token, sample * (SENSORS - 1) + sensor);
        let first: T = column(0);
        [first, column(1), column(2), self.grip.as_ref().map_or(first.zero(), |grip| grip.numbers(token, sample))]
    }

    /// Draws the numbers of the next samples.
    #[inline(never)]
    fn draw(&mut self) {
        self.column.draw();
        if let Some(grip) = &mut self.grip {
            grip.draw();
        }
        self.used = 0;
    }
}

/// Streams, a run each, and what is drawn of them.
#[derive(Debug, Clone)]
struct Ahead {
    streams: Vec<RandomStream>,
    /// In the order in which they are used: sample by sample, sensor by sensor, run by run.
    drawn: Vec<f64>,
}

impl Ahead {
    fn draw(&mut self) {
        let runs = self.streams.len();
        for (run, stream) in self.streams.iter_mut().enumerate() {
            // A copy stays in registers.
            let mut drawing = stream.clone();
            for number in self.drawn[run..].iter_mut().step_by(runs) {
                *number = drawing.normal();
            }
            *stream = drawing;
        }
    }

    /// The numbers of the runs at a place in the order; the only one for all of them.
    #[inline(always)]
    fn numbers<T: Wide>(&self, token: T::Token, place: usize) -> T {
        let runs = self.streams.len();
        let numbers = &self.drawn[place * runs..];
        if runs == T::RUNS {
            let numbers = &numbers[..T::RUNS];
            T::gather(token, |run| numbers[run])
        } else {
            T::gather(token, |_| numbers[0])
        }
    }
}
