//! What keeps a live loader safe: between law and output, once a sample. Pure, without a clock of its own; no more than a Linux process
//! can be, so emergency stop and dump valve, or torque off, are hard-wired beside it.
//!
//! | part | file |
//! |---|---|
//! | the safety functions: what each does, after how many samples, its sentence | [`function`] |
//! | limits in SI units and samples | [`limits`] |
//! | sensors that are silent, late, stuck, in disagreement | `sensors` |
//! | each sensor against the observer; lost and wrong samples bridged | `plausibility` |
//! | force, speed, travel, runaway | [`grip`] |
//! | zero of the force sensor at the grip | `grip_zero` |
//! | whether it follows the hand | `grip_reading` |
//! | limits of the command, its way to zero | `command` |
//! | off, initializing, passive, active, fading, tripped | [`sequence`] |
//! | finding the travel | `search` |
//!
//! A loop calls [`Supervisor::admit`] in each period for the readings that the law is given, then [`Supervisor::step`] with the law's command, and
//! does what is [`SupervisorOutput`]:
//!
//! - it sends `command`, and drives the enable line with `enable`;
//! - where `follows` is false, it keeps the feel computer and its neutral at the column's angle and at rest, the law in equilibrium there,
//!   so that nothing jumps when the law is followed again;
//! - where it is true, the feel's neutral is [`SupervisorOutput::neutral`] of what it would be: it comes from where the column stood, so the spring is
//!   whole from the first sample on and pulls at nothing;
//! - it multiplies what the host adds to the feel by `share`, and leads the host's values to the default feel as `host_share` goes from
//!   one to zero.
//!
//! To fade the spring itself in would leave a hand with a control that nothing holds.
//!
//! Passive is what the drive does with a command of zero. A valve's spool is centered: the ports are closed and the oil holds the piston;
//! the grip gives by no more than the link's spring. It is free only when the enable line falls and opens the bypass. A motor without
//! current is free: the hand moves column and rotor against friction and cogging.

mod command;
mod debounce;
pub mod function;
pub mod grip;
mod grip_reading;
mod grip_zero;
mod input;
pub mod limits;
mod numbers;
mod plausibility;
mod search;
mod sensors;
pub mod sequence;

pub use function::{Action, Function, Functions};
pub use grip::GripEstimate;
pub use input::{RequestedMode, SupervisorInput};
pub use limits::{Limits, Refusal};
pub use sequence::SupervisorState;

use crate::Scalar;
use crate::transducers::SENSORS;
use command::Command;
use grip::{FeelMotion, GripMonitor};
use grip_reading::GripReading;
use grip_zero::GripZero;
use numbers::below;
pub(crate) use numbers::finite;
use plausibility::Plausibility;
use sensors::Sensors;
use sequence::Sequence;

/// How much quicker than those of a silent host the values of one that swings the column go: within two swings of it.
const SWING_FADES: f64 = 5.0;

/// What a loop may do in this period.
#[derive(Debug, Clone, Copy)]
pub struct SupervisorOutput<S> {
    /// State of the loader.
    pub state: SupervisorState,
    /// Command that is sent, in V or A.
    pub command: S,
    /// The enable line: the drive has power, a valve's bypass is closed.
    pub enable: bool,
    /// Whether the law is followed.
    pub follows: bool,
    /// Share of the feel that is there, 0 to 1.
    pub share: S,
    /// Column's angle in rad where the feel began to come or to go.
    pub anchor: S,
    /// Share of the host's values, 0 to 1; the default feel has the rest.
    pub host_share: S,
    /// The feel's neutral in rad that leads the column while the travel is found.
    pub leads: Option<S>,
    /// What is known of the grip.
    pub grip: GripEstimate<S>,
    /// Zero of the force sensor at the grip in N, taken off its readings.
    pub grip_zero: S,
    /// Functions that act now.
    pub acting: Functions,
    /// Functions that acted since they were acknowledged.
    pub tripped: Functions,
    /// The one that stopped the loader.
    pub cause: Option<Function>,
}

impl<S: Scalar> SupervisorOutput<S> {
    /// The feel's neutral in rad, where host and trim have it at `wanted`.
    #[inline(always)]
    pub fn neutral(&self, wanted: S) -> S {
        self.leads.unwrap_or(self.anchor + self.share * (wanted - self.anchor))
    }
}

/// A loader's supervisor.
#[derive(Debug, Clone, Copy)]
pub struct Supervisor<S> {
    limits: Limits<S>,
    sensors: Sensors<S>,
    plausibility: Plausibility<S>,
    /// The readings of this period, and whether they are admitted yet.
    admitted: (bool, Option<[S; SENSORS]>),
    watch: GripMonitor<S>,
    grip_zero: GripZero<S>,
    grip_reading: GripReading<S>,
    command: Command<S>,
    sequence: Sequence<S>,
    host_share: S,
    /// The column swings under the host, until that is acknowledged.
    swings: bool,
    /// The column's angle as sampled last.
    angle: S,
}

impl<S: Scalar> Supervisor<S> {
    /// A loader that is off; `like`: any number of the kind. Numbers that stand for several runs at once have no one state.
    pub fn new(limits: Limits, like: S) -> Self {
        Self {
            limits: limits.numbers_of(like),
            sensors: Sensors::new(like),
            plausibility: Plausibility::new(like),
            admitted: (false, None),
            watch: GripMonitor::new(like),
            grip_zero: GripZero::new(like.zero()),
            grip_reading: GripReading::new(like.zero()),
            command: Command::new(like),
            sequence: Sequence::new(like),
            host_share: like.constant(1.0),
            swings: false,
            angle: like.zero(),
        }
    }

    /// The limits.
    pub fn limits(&self) -> &Limits<S> {
        &self.limits
    }

    /// End stops in rad as the search found them; nothing before.
    pub fn found_stops(&self) -> Option<[S; 2]> {
        self.sequence.found_stops()
    }

    /// The readings that the law is given in this period: as sampled, or as predicted where the sample is lost, late or implausible; nothing
    /// where none can be. Of the input, command and feel need not be known yet.
    #[inline]
    pub fn admit(&mut self, input: &SupervisorInput<S>) -> Option<[S; SENSORS]> {
        let limits = &self.limits;
        let arrived =
            input.missed == 0 && input.delay <= limits.late && input.sensed.iter().all(|&value| finite(value));
        let offset = self.grip_zero.offset;
        let readings = self.plausibility.admit(limits, arrived.then_some((&input.sensed, input.periods)));
        let readings = readings.map(|[force, position, base, grip]| [force, position, base, grip - offset]);
        self.admitted = (true, readings);
        readings
    }

    /// One sample; its readings are admitted if they have not been.
    #[inline]
    pub fn step(&mut self, input: &SupervisorInput<S>) -> SupervisorOutput<S> {
        let limits = self.limits;
        let mut functions = Functions::NONE
            .with(Function::EmergencyStop, input.emergency_stop)
            .with(Function::DriveFault, input.drive_fault)
            .with(Function::OtherAxis, input.other_axis)
            .with(Function::Overrun, input.late >= limits.overrun)
            .with(Function::NotANumber, !(finite(input.command) && finite(input.feel_acceleration)));
        let used = if self.admitted.0 { self.admitted.1 } else { self.admit(input) };
        self.admitted.0 = false;
        let follows = self.sequence.follows();
        let implausible = self.plausibility.wrong.map(|samples| samples > limits.bridge);
        functions = functions
            .with(Function::LoadCell, implausible[0])
            .with(Function::DrivePosition, implausible[1])
            .with(Function::ColumnAngle, implausible[2]);
        if let Some(fresh) = self.sensors.watch(&limits, input, used, &mut functions) {
            self.angle = fresh.sensed[2];
            let known = finite(input.feel_acceleration);
            let of_feel = if known { input.feel_acceleration } else { self.angle.zero() };
            let rate = if finite(input.feel_rate) { input.feel_rate } else { self.angle.zero() };
            let feel = FeelMotion { follows, acceleration: of_feel, rate, link_torque: input.link_torque };
            self.watch.watch(&limits, fresh, feel, &mut functions);
            let (reading, torque) = (input.sensed[3], self.watch.grip.hand_force * limits.grip_arm);
            functions = functions.with(Function::GripOffset, self.grip_zero.watch(&limits, reading, torque));
            if limits.grip_sensor {
                let [low, high] = limits.stops;
                let free = below(low, self.angle) && below(self.angle, high);
                let time = limits.period * fresh.periods;
                let torques = free.then_some([torque, self.watch.drive_torque()]);
                let stuck = self.grip_reading.is_stuck(&limits, (reading, time), torques);
                functions = functions.with(Function::Stuck, stuck);
            }
        }
        let saturated = self.command.saturated(&limits, self.sequence.state == SupervisorState::Active);
        functions = functions.with(Function::Saturation, saturated);
        self.host(&limits, (input.host_age, input.acknowledge), &mut functions);
        if self.sequence.step(&limits, input, (self.angle, self.watch.grip.force), &mut functions) {
            // A new start: nothing of before counts.
            self.sensors = Sensors::new(self.angle);
            self.plausibility = Plausibility::new(self.angle);
            self.watch = GripMonitor::new(self.angle);
            self.grip_reading = GripReading::new(self.angle.zero());
        }
        self.act(&limits, input, functions)
    }

    /// What comes of the state.
    #[inline(always)]
    fn act(&mut self, limits: &Limits<S>, input: &SupervisorInput<S>, mut functions: Functions) -> SupervisorOutput<S> {
        let follows = self.sequence.follows();
        if self.sequence.is_cut() {
            self.command.cut();
            self.sequence.disabled();
        } else if follows {
            // While the loop is late, the law knows nothing new: the last command holds.
            let holds = input.late > 0;
            let e = if holds { self.command.last } else { input.command };
            self.command.follow(limits, e, self.sequence.share, &mut functions);
        } else if self.command.stop(limits) {
            self.sequence.stopped();
        }
        self.plausibility.sends(if self.sequence.enable { self.command.last } else { self.command.last.zero() });
        SupervisorOutput {
            state: self.sequence.state,
            command: self.command.last,
            enable: self.sequence.enable,
            follows,
            share: self.sequence.share,
            host_share: self.host_share,
            anchor: self.sequence.anchor,
            leads: self.sequence.leads(),
            grip: self.watch.grip,
            grip_zero: self.grip_zero.offset,
            acting: functions,
            tripped: self.sequence.tripped.with(Function::Swing, self.swings),
            cause: self.sequence.cause,
        }
    }

    /// Holds the host's values, then leads to the default feel, and back when the host speaks again.
    #[inline(always)]
    fn host(&mut self, limits: &Limits<S>, (age, acknowledge): (Option<u32>, bool), functions: &mut Functions) {
        let silent = age.is_some_and(|samples| samples >= limits.host);
        self.swings = !acknowledge && age.is_some() && (self.swings || functions.has(Function::Swing));
        *functions = functions.with(Function::HostSilent, silent).only(Function::Swing, self.swings);
        let step = limits.host_step;
        let (zero, one) = (step.zero(), step.constant(1.0));
        let change = match (self.swings, silent) {
            (true, _) => -step.times(SWING_FADES),
            (_, true) => -step,
            _ => step,
        };
        self.host_share = (self.host_share + change).clamp(zero, one);
    }
}
