//! One axis in a period: what is set around its feel, its law, its feel and its supervisor, without a clock, a bus or a record.
//!
//! A target board runs it, and it is traced into C; the live loop does the same with a bus, a host and a record.

use crate::Logic;
use crate::control::{Control, Sample};
use crate::logic::Count;
use crate::modifiers::{FeelModifiers, ModifierRamp, ModifierRates};
use crate::run::{Inputs, Shared};
use crate::supervised_law::{LimitedCommand, SupervisedLaw};
use crate::supervisor::{RequestedMode, Supervisor, SupervisorInput, SupervisorOutput};
use crate::transducers::SENSORS;

/// What is given to an axis in a period.
#[derive(Debug, Clone, Copy)]
pub struct AxisInput<S: Logic> {
    /// Load cell (N), position of the drive's end (m), displacement of the column's base (m), force at the grip (N).
    pub sensors: [S; SENSORS],
    /// Where trim, factor and shaker are to go.
    pub wanted: FeelModifiers<S>,
    /// How far the feel has been changed.
    pub blend: S,
    /// Force at the grip in N, spring in N m/rad about the angle zero and damping in N m s/rad that a host adds.
    pub added: [S; 3],
    /// The requested mode.
    pub requested: S::Code<RequestedMode>,
    /// Whether a host gives what is wanted and added.
    pub host: S::Mask,
    /// Periods since its last values.
    pub host_age: S::Count,
    /// Samples in a row without a sample.
    pub missed: S::Count,
    /// Periods by which the sample is later than the controller's delay has it.
    pub delay: S::Count,
    /// Periods in a row that were late.
    pub late: S::Count,
    /// The emergency stop is pressed.
    pub emergency_stop: S::Mask,
    /// The drive reports a fault.
    pub drive_fault: S::Mask,
    /// The drive carries out its commands; holds, too, of one that does not tell.
    pub drive_acts: S::Mask,
    /// The message of a trip is acknowledged.
    pub acknowledge: S::Mask,
}

/// Law, feel and supervisor of one axis.
#[derive(Debug, Clone)]
pub struct Axis<S: Logic> {
    led: ModifierRamp<S>,
    followed: SupervisedLaw<S>,
    sensors: [S; SENSORS],
    supervisor: Supervisor<S>,
    /// Samples in a row that had not come by the period before.
    missed: S::Count,
    /// Whether there was a period before.
    begun: S::Mask,
}

crate::logic::memory! {
    Axis { part led, followed; numbers sensors; part supervisor; count missed; flag begun; }
}

impl<S: Logic + Into<f64>> Axis<S> {
    /// An axis that is off.
    pub fn new(control: &Control<S>, at_rest: [[S; SENSORS]; 2], supervisor: Supervisor<S>) -> Self {
        let zero = at_rest[0][0].zero();
        Self {
            led: ModifierRamp::at(zero),
            followed: SupervisedLaw::new(control, at_rest),
            sensors: [zero; SENSORS],
            supervisor,
            missed: S::Count::none(),
            begun: S::mask(false),
        }
    }

    /// Law and feel.
    pub fn followed(&self) -> &SupervisedLaw<S> {
        &self.followed
    }

    /// A period: the command that goes out, and what is allowed beside.
    #[inline(always)]
    pub fn step(
        &mut self,
        (shared, control): (&Shared, &Control<S>),
        pace: &ModifierRates<S>,
        given: &AxisInput<S>,
    ) -> Option<(S, SupervisorOutput<S>)> {
        let like = pace.period;
        let inputs = self.inputs(pace, given);
        let came = !given.missed.some();
        if S::any(came) {
            self.sensors = core::array::from_fn(|k| S::select(came, given.sensors[k], self.sensors[k]));
        }
        let mut input = SupervisorInput {
            sensed: self.sensors,
            missed: given.missed,
            periods: like.number(self.missed) + like.constant(1.0),
            delay: given.delay,
            late: given.late,
            host: given.host,
            host_age: given.host_age,
            // The law's, as it comes to it.
            command: like.zero(),
            feel_acceleration: control.free_acceleration(shared, self.followed.feeling(), &inputs),
            feel_rate: self.followed.feeling().motion.at[1] * control.per_delta(),
            link_torque: like.zero(),
            emergency_stop: given.emergency_stop,
            other_axis: S::mask(false),
            drive_fault: given.drive_fault,
            drive_acts: given.drive_acts,
            requested: given.requested,
            acknowledge: given.acknowledge,
        };
        self.missed = given.missed;
        let (known, sensors) = self.supervisor.admitted(&input);
        let sample = Sample { sensors, pilot_force: like.zero() };
        let (supervisor, mut allowed) = (&mut self.supervisor, None);
        let command = self.followed.step_where((shared, control), &inputs, (&sample, known), |answer| {
            input.command = answer.command;
            let now = supervisor.step(&input);
            allowed = Some(now);
            LimitedCommand::from(&now)
        });
        // The supervisor is asked in each period, once: there always is what it allows.
        allowed.map(|allowed| (command, allowed))
    }

    /// What the feel is told from outside.
    #[inline(always)]
    fn inputs(&mut self, pace: &ModifierRates<S>, given: &AxisInput<S>) -> Inputs {
        S::section("modifiers");
        let modifiers = self.led.step(&given.wanted, pace);
        let swing = self.led.swing(modifiers.shaker, pace);
        let trim = S::select(self.begun, self.supervisor.neutral(modifiers.trim_rad), modifiers.trim_rad);
        self.begun = S::mask(true);
        let [trim, stiffness_factor, shaker, fade] =
            [trim, modifiers.stiffness_factor, swing, given.blend].map(|number| [number.into(); 2]);
        let [added_force, added_stiffness, added_damping] = given.added.map(|number| [number.into(); 2]);
        Inputs { trim, stiffness_factor, shaker, added_force, added_stiffness, added_damping, fade, ..Inputs::NONE }
    }
}
