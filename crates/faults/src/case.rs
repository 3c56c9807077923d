//! A case, drawn from a seed: safety times, a hand, and a fault or two at drawn moments.

use crate::fault::{Fault, Kind};
use core::f64::consts::{FRAC_PI_2, TAU};
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::supervisor::Limits;
use forcefeel_solve::random::RandomStream;

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
    /// Whether its arm is a clamp, which no person feels.
    pub clamped: bool,
    /// Samples.
    pub samples: usize,
    /// Noise of the sensors: the numbers after those that drew the case.
    pub noise: RandomStream,
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
/// A column that bounces off a stop has its drive at its limit for up to 130.
const LONGER: (f64, f64) = (160.0, 280.0);
/// Angle in rad to either side, within the travel of every loader.
const FARTHEST_RAD: f64 = 0.1;
/// Samples in which a fault may begin, and in which it must come to its end.
const BEGINS: f64 = 250.0;
/// See [`BEGINS`].
const GOES_ON: usize = 1000;

impl Case {
    /// The case of a number, of the loaders with these values each; `pairs`: whether there are two faults.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "small numbers above zero"
    )]
    pub fn drawn(loaders: &[[f64; COUNT]], (seed, number): (u64, u64), pairs: bool) -> Self {
        let mut stream = RandomStream::new(seed, number);
        let mut draw = || stream.uniform();
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
        (safety.force_time, safety.saturation_time) = (time(LONG), time(LONGER));
        safety.power_time = time(LONG);
        (safety.host_time, safety.host_fade) = (time(SILENCE), time(FADE));
        let mut between = |(low, high): (f64, f64)| low + (high - low) * draw();
        let faults = kinds.map(|kind| Fault {
            kind,
            from: between((0.0, BEGINS)) as usize,
            sensor: between((0.0, 2.999)) as usize,
            direction: if between((-1.0, 1.0)) < 0.0 { -1.0 } else { 1.0 },
            size: between((0.0, 1.0)),
        });
        let &Parameters { feel, column, .. } = &parameters;
        // What the spring takes within a fifth of a radian, and well within the force that may last.
        let most = (0.2 * feel.stiffness / column.grip_arm).min(0.4 * parameters.safety.force_limit);
        let there = between((0.0, 1.0)) < 0.7;
        let hand = Hand {
            force: if there { between((0.1, 1.0)) * most } else { 0.0 },
            frequency: between((1.0, 12.0)),
            phase: between((0.0, TAU)),
            lets_go: between((0.0, 2.0 * BEGINS)) as usize,
        };
        // Half of them begin at zero.
        let angle = between((-FARTHEST_RAD, FARTHEST_RAD)) * if between((0.0, 1.0)) < 0.5 { 0.0 } else { 1.0 };
        let last = faults.iter().map(|fault| if fault.kind == Kind::None { 0 } else { fault.from }).max().unwrap_or(0);
        let values = parameters.values();
        Self { loader, values, faults, hand, angle, clamped: false, samples: last + GOES_ON, noise: stream }
    }

    /// Whether the loader is to go on in spite of its faults. Two that are bridged may be more than one that is.
    pub fn is_bridged(&self, limits: &Limits) -> bool {
        let faults = self.faults.iter().filter(|fault| fault.kind != Kind::None);
        faults.clone().count() < 2 && faults.clone().all(|fault| fault.is_bridged(limits))
    }

    /// Of the force of its arm or clamp, that which a person feels.
    pub fn felt(&self, arm: f64) -> f64 {
        if self.clamped { 0.0 } else { arm }
    }

    /// First sample of a fault.
    pub fn onset(&self) -> Option<usize> {
        self.faults.iter().filter(|fault| fault.kind != Kind::None).map(|fault| fault.from).min()
    }
}

/// What a hand does in a case without a fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Legal {
    /// None is there.
    Off,
    /// It holds the column and lets go.
    Releases,
    /// It holds still, or against an end stop, with any force that may last.
    Holds,
    /// It holds with an arm, and pushes as it does, or holds still.
    Arm,
    /// It pushes to and fro as hard as it may.
    Pushes,
}

impl Legal {
    const ALL: [Self; 5] = [Self::Off, Self::Releases, Self::Holds, Self::Arm, Self::Pushes];
}

/// Samples of a case without a fault.
const LEGAL_SAMPLES: usize = 4000;
/// Share of the force that may last to which a hand pushes.
pub(crate) const HARDEST: f64 = 0.9;
/// Arms by which the envelope judges a law: mass in kg, damping in N s/m and stiffness in N/m at the grip; light, loose, firm.
pub(crate) const ARMS: [[f64; 3]; 3] = [[0.8, 5.5, 30.0], [1.0, 10.0, 50.0], [3.0, 40.0, 1000.0]];

impl Case {
    /// The case of a number without a fault: every other is on a cold day, with twice the dry friction.
    pub fn legal(loaders: &[[f64; COUNT]], (seed, number): (u64, u64)) -> Self {
        let mut stream = RandomStream::new(seed, number);
        let mut draw = || stream.uniform();
        let mut between = |(low, high): (f64, f64)| low + (high - low) * draw();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number above zero")]
        let whole = |number: f64| number as usize;
        #[expect(clippy::cast_precision_loss, reason = "a few loaders")]
        let loader = whole(between((0.0, loaders.len() as f64))).min(loaders.len() - 1);
        let does = Legal::ALL[usize::try_from(number).unwrap_or(0) % Legal::ALL.len()];
        let mut parameters = Parameters::from_values(&loaders[loader]);
        if between((-1.0, 1.0)) < 0.0 {
            parameters.column.coulomb_friction *= 2.0;
            parameters.column.static_friction *= 2.0;
            parameters.motor.coulomb_friction *= 2.0;
            parameters.motor.static_friction *= 2.0;
        }
        let Parameters { feel, column, .. } = parameters;
        let may_last = HARDEST * parameters.safety.force_limit;
        // What the spring takes within a fifth of a radian.
        let taken = (0.2 * feel.stiffness / column.grip_arm).min(may_last);
        // Where nothing else holds it, a hand may not push further.
        let may_last = if column.stop_low.is_finite() && column.stop_high.is_finite() { may_last } else { taken };
        let still = between((0.0, 1.0)) < 0.3;
        let (force, frequency, phase) = match does {
            Legal::Off => (0.0, 0.0, 0.0),
            Legal::Releases => (taken, 0.0, FRAC_PI_2),
            Legal::Holds => (may_last, 0.0, FRAC_PI_2),
            Legal::Arm => (may_last, if still { 0.0 } else { between((1.0, 12.0)) }, FRAC_PI_2),
            Legal::Pushes => (may_last, between((1.0, 12.0)), between((0.0, TAU))),
        };
        if matches!(does, Legal::Arm | Legal::Pushes) {
            let pilot = &mut parameters.pilot;
            [pilot.arm_mass, pilot.arm_damping, pilot.arm_stiffness] = ARMS[whole(between((0.0, 3.0))).min(2)];
        }
        let hand = Hand {
            force: force * between((0.1, 1.0)) * if between((-1.0, 1.0)) < 0.0 { -1.0 } else { 1.0 },
            frequency,
            phase,
            lets_go: if does == Legal::Releases { whole(between((1600.0, 3200.0))) } else { usize::MAX },
        };
        let none = Fault { kind: Kind::None, from: 0, sensor: 0, direction: 1.0, size: 0.0 };
        Self {
            loader,
            values: parameters.values(),
            faults: [none; 2],
            hand,
            angle: between((-FARTHEST_RAD, FARTHEST_RAD)) * if between((0.0, 1.0)) < 0.5 { 0.0 } else { 1.0 },
            clamped: false,
            samples: LEGAL_SAMPLES,
            noise: stream,
        }
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
