//! The kinds of fault, and what each does to what is sampled or commanded.

use forcefeel_model::supervisor::{Limits, SupervisorInput};
use forcefeel_model::transducers::SENSORS;

/// A kind of fault; where there are three of it, one for each sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// None.
    None,
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The drive reports a fault.
    DriveFault,
    /// The drive does not act, and does not say why.
    DriveStopped,
    /// A sensor gives no number.
    SensorNotANumber,
    /// The law gives no number.
    LawNotANumber,
    /// The feel gives no number.
    FeelNotANumber,
    /// A sensor shows more than it can.
    OutOfRange,
    /// A sensor jumps.
    Jump,
    /// Drive and sensors say nothing.
    Silence,
    /// A sensor stays where it is.
    Stuck,
    /// A sensor drifts.
    Drift,
    /// The hand pushes with more than the largest force.
    LargestForce,
    /// The hand pushes with more than the force that may last.
    LastingForce,
    /// The law asks for everything, in one direction.
    HardOver,
    /// The law asks for everything, to and fro.
    Swinging,
    /// The law asks for more than a number of any machine.
    Huge,
    /// The loop is late.
    Overrun,
    /// The host says nothing.
    HostSilent,
    /// A commanded runaway: the feel is forgotten, the column creeps away.
    Creep,
    /// Samples come late.
    Late,
    /// A few samples are lost.
    Lost,
    /// A sensor jumps for one sample.
    Spike,
    /// A sensor shows the opposite.
    Reversed,
    /// The drive has one command for good.
    DriveHardover,
    /// The drive adds something to each command.
    DriveOffset,
    /// The force sensor at the grip stays where it is.
    GripStuck,
    /// The same, and its noise goes on.
    GripNoisy,
}

impl Kind {
    /// All kinds.
    pub const ALL: &[Self] = &[
        Self::None,
        Self::EmergencyStop,
        Self::DriveFault,
        Self::DriveStopped,
        Self::SensorNotANumber,
        Self::LawNotANumber,
        Self::FeelNotANumber,
        Self::OutOfRange,
        Self::Jump,
        Self::Silence,
        Self::Stuck,
        Self::Drift,
        Self::LargestForce,
        Self::LastingForce,
        Self::HardOver,
        Self::Swinging,
        Self::Huge,
        Self::Overrun,
        Self::HostSilent,
        Self::Creep,
        Self::Late,
        Self::Lost,
        Self::Spike,
        Self::Reversed,
        Self::DriveHardover,
        Self::DriveOffset,
        Self::GripStuck,
        Self::GripNoisy,
    ];

    /// Whether it is the hand that is at fault.
    pub const fn is_of_hand(self) -> bool {
        matches!(self, Self::LargestForce | Self::LastingForce)
    }
}

/// A fault of a case.
#[derive(Debug, Clone, Copy)]
pub struct Fault {
    /// Its kind.
    pub kind: Kind,
    /// First sample that it is there.
    pub from: usize,
    /// Which sensor.
    pub sensor: usize,
    /// Its direction, -1 or 1.
    pub direction: f64,
    /// How much, 0 to 1.
    pub size: f64,
}

/// What a fault needs to know from before.
#[derive(Debug, Clone, Copy)]
pub struct FaultHistory {
    /// What the sensors showed last.
    pub shown: [f64; SENSORS],
    frozen: Option<f64>,
    late: u32,
    missed: u32,
    host: u32,
    /// What the sensors showed in the newest samples, by their number.
    recent: [[f64; SENSORS]; RECENT],
}

/// Place of the force sensor at the grip.
const GRIP: usize = SENSORS - 1;

/// Samples that are kept, for those that come late.
const RECENT: usize = 64;

impl FaultHistory {
    /// Nothing has been sampled yet.
    pub const NONE: Self =
        Self { shown: [0.0; SENSORS], frozen: None, late: 0, missed: 0, host: 0, recent: [[0.0; SENSORS]; RECENT] };

    /// What the sensors show at a sample, whatever becomes of it.
    pub fn see(&mut self, sample: usize, sensors: [f64; SENSORS]) {
        self.recent[sample % RECENT] = sensors;
    }
}

/// Lost samples in a row that the loader is to go on in spite of: a law of high gain may swing after more.
const BRIDGED: usize = 5;

impl Fault {
    /// Samples that are lost.
    fn lost(&self, limits: &Limits) -> usize {
        (1 + count(39.0 * self.size)).min(limits.silence as usize - 1)
    }

    /// Whether the loader is to go on in spite of it.
    pub fn is_bridged(&self, limits: &Limits) -> bool {
        match self.kind {
            Kind::None | Kind::Spike => true,
            Kind::Lost => self.lost(limits) <= BRIDGED,
            _ => false,
        }
    }

    /// Whether it is there at a sample.
    pub fn is_there(&self, sample: usize) -> bool {
        self.kind != Kind::None && sample >= self.from
    }

    /// What becomes of what is sensed, and of the times, at a sample.
    pub fn spoil_sensed(
        &self,
        before: &mut FaultHistory,
        limits: &Limits,
        sample: usize,
        input: &mut SupervisorInput<f64>,
    ) {
        if !self.is_there(sample) {
            return;
        }
        let k = self.sensor;
        let since = sample - self.from;
        let per_angle = [1.0, limits.lever, limits.base_arm];
        match self.kind {
            Kind::EmergencyStop => input.emergency_stop = true,
            Kind::DriveFault => input.drive_fault = true,
            Kind::DriveStopped => input.drive_acts = false,
            Kind::SensorNotANumber => input.sensed[k] = [f64::NAN, f64::INFINITY][usize::from(self.size > 0.5)],
            Kind::FeelNotANumber => input.feel_acceleration = f64::NAN,
            Kind::OutOfRange => {
                let range = [limits.range[0], limits.range[1], limits.range[2] * limits.base_arm][k];
                input.sensed[k] = self.direction * range * (1.001 + self.size);
            }
            Kind::Jump => {
                let [force, position, angle] = limits.plausible;
                let implausible = [force, position, angle * limits.base_arm][k];
                input.sensed[k] += self.direction * implausible * (4.0 + 20.0 * self.size);
            }
            Kind::Silence => {
                before.missed += 1;
                input.missed = input.missed.max(before.missed);
            }
            Kind::Stuck => input.sensed[k] = *before.frozen.get_or_insert(before.shown[k]),
            Kind::GripStuck => input.sensed[GRIP] = *before.frozen.get_or_insert(before.shown[GRIP]),
            Kind::GripNoisy => {
                let frozen = *before.frozen.get_or_insert(before.shown[GRIP]);
                input.sensed[GRIP] = frozen + NOISE_OF_SPAN * limits.grip_span * noise(since);
            }
            Kind::Drift => {
                // Within half a second to ten times what may disagree.
                let whole = 10.0 * limits.agreement_m * (0.2 + self.size);
                let of_sensor = [1.0 / limits.link[0], 1.0, 1.0 / limits.lever * per_angle[2]][k];
                #[expect(clippy::cast_precision_loss, reason = "a number of samples")]
                let share = (since as f64 * limits.period / 0.5).min(1.0);
                input.sensed[k] += self.direction * whole * of_sensor * share;
            }
            Kind::Overrun => {
                before.late += 1;
                input.late = input.late.max(before.late);
            }
            Kind::HostSilent => {
                before.host += 1;
                input.host_age = input.host_age.max(before.host);
            }
            Kind::Late => {
                let by = (1 + count(39.0 * self.size)).min(sample);
                (input.sensed, input.delay) = (before.recent[(sample - by) % RECENT], u32::try_from(by).unwrap_or(0));
            }
            Kind::Lost => {
                // Fewer than the supervisor takes for silence.
                let last = self.lost(limits);
                if since < last {
                    input.missed = input.missed.max(u32::try_from(since + 1).unwrap_or(0));
                } else if since == last {
                    input.periods = input.periods.max(u32::try_from(last + 1).map_or(1.0, f64::from));
                }
            }
            Kind::Spike if since == 0 => {
                let range = [limits.range[0], limits.range[1], limits.range[2] * limits.base_arm][k];
                input.sensed[k] = (input.sensed[k] + self.direction * range * self.size).clamp(-range, range);
            }
            Kind::Reversed => input.sensed[k] = -input.sensed[k],
            _ => {}
        }
    }

    /// What the drive makes of a command, in V or A.
    pub fn spoil_drive(&self, limits: &Limits, sample: usize, command: f64) -> f64 {
        let full = self.direction * limits.command;
        match self.kind {
            Kind::DriveHardover if self.is_there(sample) => full * (0.1 + 0.9 * self.size),
            Kind::DriveOffset if self.is_there(sample) => command + full * (0.02 + 0.4 * self.size),
            _ => command,
        }
    }

    /// What becomes of the law's command.
    pub fn spoil_command(&self, limits: &Limits, sample: usize, input: &mut SupervisorInput<f64>) {
        if !self.is_there(sample) {
            return;
        }
        let full = self.direction * limits.command;
        match self.kind {
            Kind::LawNotANumber => input.command = [f64::NAN, f64::NEG_INFINITY][usize::from(self.size > 0.5)],
            Kind::HardOver => input.command = full * (0.2 + 2.0 * self.size),
            Kind::Creep => input.command = full * (0.02 + 0.2 * self.size),
            Kind::Swinging => {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "a small number above zero"
                )]
                let half = 1 + (self.size * 20.0) as usize;
                input.command = full * if ((sample - self.from) / half).is_multiple_of(2) { 1.5 } else { -1.5 };
            }
            Kind::Huge => input.command = self.direction * 1e300,
            _ => {}
        }
    }

    /// Force in N that it adds at the grip.
    pub fn force(&self, limits: &Limits, sample: usize) -> f64 {
        if !self.is_there(sample) {
            return 0.0;
        }
        match self.kind {
            Kind::LargestForce => self.direction * limits.absolute_force * (1.2 + 2.0 * self.size),
            Kind::LastingForce => self.direction * limits.force_limit * (1.2 + 2.0 * self.size),
            _ => 0.0,
        }
    }
}

/// Noise of a sensor as a share of the span that is its widest.
const NOISE_OF_SPAN: f64 = 0.1;

/// Noise of a sample, uniform and of unit variance.
#[expect(clippy::cast_precision_loss, reason = "32 bits")]
fn noise(sample: usize) -> f64 {
    // Knuth's multiplicative hash, the product's upper half.
    let hash = (sample as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
    12.0_f64.sqrt() * (hash as f64 / f64::from(u32::MAX) - 0.5)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number above zero")]
fn count(number: f64) -> usize {
    number as usize
}
