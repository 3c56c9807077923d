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
}

impl Kind {
    /// All kinds.
    pub const ALL: &[Self] = &[
        Self::None,
        Self::EmergencyStop,
        Self::DriveFault,
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
    ];
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
    /// Which way, -1 or 1.
    pub way: f64,
    /// How much, 0 to 1.
    pub size: f64,
}

/// What a fault needs to know from before.
#[derive(Debug, Clone, Copy, Default)]
pub struct FaultHistory {
    /// What the sensors showed last.
    pub shown: [f64; SENSORS],
    frozen: Option<f64>,
    late: u32,
    missed: u32,
    host: u32,
}

impl Fault {
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
            Kind::SensorNotANumber => input.sensed[k] = [f64::NAN, f64::INFINITY][usize::from(self.size > 0.5)],
            Kind::FeelNotANumber => input.feel_acceleration = f64::NAN,
            Kind::OutOfRange => {
                let range = [limits.range[0], limits.range[1], limits.range[2] * limits.base_arm][k];
                input.sensed[k] = self.way * range * (1.001 + self.size);
            }
            Kind::Jump => {
                let [force, position, angle] = limits.plausible;
                let implausible = [force, position, angle * limits.base_arm][k];
                input.sensed[k] += self.way * implausible * (4.0 + 20.0 * self.size);
            }
            Kind::Silence => {
                before.missed += 1;
                input.missed = input.missed.max(before.missed);
            }
            Kind::Stuck => input.sensed[k] = *before.frozen.get_or_insert(before.shown[k]),
            Kind::Drift => {
                // Within half a second to ten times what may disagree.
                let whole = 10.0 * limits.agreement_m * (0.2 + self.size);
                let of_sensor = [1.0 / limits.link[0], 1.0, 1.0 / limits.lever * per_angle[2]][k];
                #[expect(clippy::cast_precision_loss, reason = "a number of samples")]
                let share = (since as f64 * limits.period / 0.5).min(1.0);
                input.sensed[k] += self.way * whole * of_sensor * share;
            }
            Kind::Overrun => {
                before.late += 1;
                input.late = input.late.max(before.late);
            }
            Kind::HostSilent => {
                before.host += 1;
                input.host_age = input.host_age.max(Some(before.host));
            }
            _ => {}
        }
    }

    /// What becomes of the law's command.
    pub fn spoil_command(&self, limits: &Limits, sample: usize, input: &mut SupervisorInput<f64>) {
        if !self.is_there(sample) {
            return;
        }
        let full = self.way * limits.command;
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
            Kind::Huge => input.command = self.way * 1e300,
            _ => {}
        }
    }

    /// Force in N that it adds at the grip.
    pub fn force(&self, limits: &Limits, sample: usize) -> f64 {
        if !self.is_there(sample) {
            return 0.0;
        }
        match self.kind {
            Kind::LargestForce => self.way * limits.absolute_force * (1.2 + 2.0 * self.size),
            Kind::LastingForce => self.way * limits.force_limit * (1.2 + 2.0 * self.size),
            _ => 0.0,
        }
    }
}
