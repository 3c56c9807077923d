//! A case, drawn from a seed: safety times, a hand, and a fault or two at drawn moments.

use crate::fault::{Fault, Kind};
use forcefeel_model::parameters::{COUNT, Parameters};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardUniform};

/// One case.
#[derive(Debug, Clone)]
pub struct Case {
    /// Which of the loaders.
    pub loader: usize,
    /// Its values, with the safety times of the case.
    pub values: [f64; COUNT],
    /// Its faults; of a single one the second is none.
    pub faults: [Fault; 2],
    /// The hand.
    pub hand: Hand,
    /// Where the column stands when the loop begins, and its neutral, in rad.
    pub angle: f64,
    /// Samples.
    pub samples: usize,
    /// Seed of the sensors' noise.
    pub seed: u64,
}

/// A hand that pushes to and fro.
#[derive(Debug, Clone, Copy)]
pub struct Hand {
    /// Largest force in N; zero where there is no hand.
    pub force: f64,
    /// In rad/s.
    pub frequency: f64,
    /// Phase at the start.
    pub phase: f64,
    /// Sample at which it lets go.
    pub lets_go: usize,
}

/// What the times of a case are, in periods: short, so that a case is.
const STUCK: (f64, f64) = (10.0, 30.0);
const FADE: (f64, f64) = (20.0, 80.0);
const SILENCE: (f64, f64) = (3.0, 20.0);
const STOP: (f64, f64) = (1.0, 20.0);
const LONG: (f64, f64) = (40.0, 120.0);
/// Angle in rad to either side, within the travel of every loader.
const FARTHEST_RAD: f64 = 0.1;
/// Samples in which a fault may begin, and in which it must come to its end.
const BEGINS: f64 = 250.0;
/// See [`BEGINS`].
const GOES_ON: usize = 300;

impl Case {
    /// The case of a number, of the loaders with these values each; `pairs`: whether there are two faults.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "small numbers above zero"
    )]
    pub fn drawn(loaders: &[[f64; COUNT]], (seed, number): (u64, u64), pairs: bool) -> Self {
        let mut bits = ChaCha8Rng::seed_from_u64(seed);
        bits.set_stream(number);
        let mut draw = || -> f64 { StandardUniform.sample(&mut bits) };
        let mut between = |(low, high): (f64, f64)| low + (high - low) * draw();
        let mut choose = |count: usize| between((0.0, count as f64)) as usize;
        let loader = choose(loaders.len()).min(loaders.len() - 1);
        let mut kind = || Kind::ALL[choose(Kind::ALL.len()).min(Kind::ALL.len() - 1)];
        let kinds = [kind(), if pairs { kind() } else { Kind::None }];
        let mut between = |(low, high): (f64, f64)| low + (high - low) * draw();
        let mut parameters = Parameters::from_values(&loaders[loader]);
        let period = parameters.controller.period;
        let mut time = |range| between(range) * period;
        let safety = &mut parameters.safety;
        (safety.stuck_time, safety.fade_time, safety.silence_time) = (time(STUCK), time(FADE), time(SILENCE));
        (safety.stop_time, safety.overrun_time, safety.agreement_time) = (time(STOP), time(SILENCE), time(SILENCE));
        (safety.force_time, safety.saturation_time) = (time(LONG), time(LONG));
        (safety.host_time, safety.host_fade) = (time(SILENCE), time(FADE));
        let mut between = |(low, high): (f64, f64)| low + (high - low) * draw();
        let faults = kinds.map(|kind| Fault {
            kind,
            from: between((0.0, BEGINS)) as usize,
            sensor: between((0.0, 2.999)) as usize,
            way: if between((-1.0, 1.0)) < 0.0 { -1.0 } else { 1.0 },
            size: between((0.0, 1.0)),
        });
        let &Parameters { feel, column, .. } = &parameters;
        // What the spring takes within a fifth of a radian, and well within the force that may last.
        let most = (0.2 * feel.stiffness / column.grip_arm).min(0.4 * parameters.safety.force_limit);
        let there = between((0.0, 1.0)) < 0.7;
        let hand = Hand {
            force: if there { between((0.1, 1.0)) * most } else { 0.0 },
            frequency: between((1.0, 12.0)),
            phase: between((0.0, core::f64::consts::TAU)),
            lets_go: between((0.0, 2.0 * BEGINS)) as usize,
        };
        // Half of them begin at zero.
        let angle = between((-FARTHEST_RAD, FARTHEST_RAD)) * if between((0.0, 1.0)) < 0.5 { 0.0 } else { 1.0 };
        let last = faults.iter().map(|fault| if fault.kind == Kind::None { 0 } else { fault.from }).max().unwrap_or(0);
        let values = parameters.values();
        Self { loader, values, faults, hand, angle, samples: last + GOES_ON, seed: seed ^ number }
    }
}

impl Hand {
    /// Its force at a sample, in N.
    pub fn at(&self, sample: usize, period: f64) -> f64 {
        if sample >= self.lets_go {
            return 0.0;
        }
        #[expect(clippy::cast_precision_loss, reason = "a number of samples")]
        let time = sample as f64 * period;
        // It takes hold over a twentieth of a second.
        self.force * (time / 0.05).min(1.0) * (self.frequency * time + self.phase).sin()
    }
}
