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
//! | whether the drive acts | `power` |
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
mod power;
mod search;
mod sensors;
pub mod sequence;

pub use function::{Action, Function, Functions};
pub use grip::GripEstimate;
pub use input::{RequestedMode, SupervisorInput};
pub use limits::{Limits, Refusal};
pub use sequence::SupervisorState;

use crate::Logic;
use crate::logic::{Count, FunctionSet};
use crate::transducers::SENSORS;
use command::Command;
use grip::{FeelMotion, GripMonitor};
use grip_reading::GripReading;
use grip_zero::GripZero;
pub(crate) use numbers::finite;
use plausibility::Plausibility;
use sensors::Sensors;
use sequence::Sequence;

/// How much quicker than those of a silent host the values of one that swings the column go: within two swings of it.
const SWING_FADES: f64 = 5.0;

/// What a loop may do in this period.
#[derive(Debug, Clone, Copy)]
pub struct SupervisorOutput<S: Logic> {
    /// State of the loader.
    pub state: S::Code<SupervisorState>,
    /// Command that is sent, in V or A.
    pub command: S,
    /// The enable line: the drive has power, a valve's bypass is closed.
    pub enable: S::Mask,
    /// Whether the law is followed.
    pub follows: S::Mask,
    /// Share of the feel that is there, 0 to 1.
    pub share: S,
    /// Column's angle in rad where the feel began to come or to go.
    pub anchor: S,
    /// Share of the host's values, 0 to 1; the default feel has the rest.
    pub host_share: S,
    /// Whether the travel is being found, and the feel's neutral in rad that then leads the column.
    pub leads: S::Mask,
    /// See [`leads`](Self::leads).
    pub led: S,
    /// What is known of the grip.
    pub grip: GripEstimate<S>,
    /// Zero of the force sensor at the grip in N, taken off its readings.
    pub grip_zero: S,
    /// Functions that act now.
    pub acting: S::Set,
    /// Functions that acted since they were acknowledged.
    pub tripped: S::Set,
    /// The one that stopped the loader.
    pub cause: S::Code<Option<Function>>,
}

impl<S: Logic> SupervisorOutput<S> {
    /// The feel's neutral in rad, where host and trim have it at `wanted`.
    #[inline(always)]
    pub fn neutral(&self, wanted: S) -> S {
        S::select(self.leads, self.led, self.anchor + self.share * (wanted - self.anchor))
    }
}

/// A loader's supervisor.
#[derive(Debug, Clone, Copy)]
pub struct Supervisor<S: Logic> {
    limits: Limits<S>,
    sensors: Sensors<S>,
    plausibility: Plausibility<S>,
    /// Whether the readings of this period are admitted yet.
    admitted: bool,
    watch: GripMonitor<S>,
    grip_zero: GripZero<S>,
    grip_reading: GripReading<S>,
    command: Command<S>,
    sequence: Sequence<S>,
    host_share: S,
    /// The column swings under the host, until that is acknowledged.
    swings: S::Mask,
    /// The column's angle as sampled last.
    angle: S,
    /// Functions that act in this period.
    acting: S::Set,
}

crate::logic::memory! {
    Supervisor {
        part sensors, plausibility, watch, grip_zero, grip_reading, command, sequence;
        number host_share;
        flag swings;
        number angle;
        set acting;
    }
}

impl<S: Logic> Supervisor<S> {
    /// A loader that is off; `like`: any number of the kind. Numbers that stand for several runs at once have no one state.
    pub fn new(limits: Limits, like: S) -> Self {
        Self::within(limits.numbers_of(like), like)
    }

    /// The same, with limits in the number type.
    pub fn within(limits: Limits<S>, like: S) -> Self {
        Self {
            limits,
            sensors: Sensors::new(like),
            plausibility: Plausibility::new(like),
            admitted: false,
            watch: GripMonitor::new(like),
            grip_zero: GripZero::new(like.zero()),
            grip_reading: GripReading::new(like.zero()),
            command: Command::new(like),
            sequence: Sequence::new(like),
            host_share: like.constant(1.0),
            swings: S::mask(false),
            angle: like.zero(),
            acting: S::Set::none(),
        }
    }

    /// The limits.
    pub fn limits(&self) -> &Limits<S> {
        &self.limits
    }

    /// The feel's neutral in rad in the next period, where host and trim have it at `wanted`: see [`SupervisorOutput::neutral`].
    #[inline(always)]
    pub fn neutral(&self, wanted: S) -> S {
        let Sequence { share, anchor, search, .. } = &self.sequence;
        S::select(search.is_under_way(), search.neutral, *anchor + *share * (wanted - *anchor))
    }

    /// End stops in rad as the search found them; nothing before.
    pub fn found_stops(&self) -> Option<[S; 2]> {
        let (has_stops, stops) = self.sequence.found_stops();
        S::holds(has_stops).then_some(stops)
    }

    /// The readings that the law is given in this period: as sampled, or as predicted where the sample is lost, late or implausible; nothing
    /// where none can be. Of the input, command and feel need not be known yet.
    #[inline]
    pub fn admit(&mut self, input: &SupervisorInput<S>) -> Option<[S; SENSORS]> {
        let (known, readings) = self.admitted(input);
        S::holds(known).then_some(readings)
    }

    /// The same, and whether they are known.
    #[inline]
    pub fn admitted(&mut self, input: &SupervisorInput<S>) -> (S::Mask, [S; SENSORS]) {
        let limits = &self.limits;
        let in_time = !(input.missed.some() | input.delay.above(limits.late));
        let arrived = input.sensed.iter().fold(in_time, |arrived, value| arrived & value.is_number());
        let offset = self.grip_zero.offset;
        self.plausibility.admit(limits, arrived, (&input.sensed, input.periods));
        self.plausibility.readings[3] = self.plausibility.readings[3] - offset;
        self.admitted = true;
        (self.plausibility.begun, self.plausibility.readings)
    }

    /// One sample; its readings are admitted if they have not been.
    #[inline]
    pub fn step(&mut self, input: &SupervisorInput<S>) -> SupervisorOutput<S> {
        let limits = self.limits;
        if !self.admitted {
            self.admitted(input);
        }
        self.admitted = false;
        S::section("safety");
        let implausible = self.plausibility.wrong.map(|samples| samples.above(limits.bridge));
        self.acting = S::Set::none()
            .with(Function::EmergencyStop, input.emergency_stop)
            .with(Function::DriveFault, input.drive_fault)
            .with(Function::OtherAxis, input.other_axis)
            .with(Function::Overrun, input.late.at_least(limits.overrun))
            .with(Function::NotANumber, !(input.command.is_number() & input.feel_acceleration.is_number()))
            .with(Function::LoadCell, implausible[0])
            .with(Function::DrivePosition, implausible[1])
            .with(Function::ColumnAngle, implausible[2]);
        let used = (self.plausibility.begun, self.plausibility.readings);
        self.sensors.watch(&limits, input, used, &mut self.acting);
        S::paths(self, |this| {
            if S::holds(this.sensors.usable) {
                this.watch(&limits, input);
            }
        });
        S::section("command");
        let active = self.sequence.is(SupervisorState::Active);
        let saturated = self.command.saturated(&limits, active);
        self.acting = self.acting.with(Function::Saturation, saturated);
        self.host(&limits, input);
        self.sequence.step(&limits, input, (self.angle, self.watch.grip.force), &mut self.acting);
        S::paths(self, |this| {
            if S::holds(this.sequence.started) {
                // A new start: nothing of before counts.
                this.sensors = Sensors::new(this.angle);
                this.plausibility = Plausibility::new(this.angle);
                this.watch = GripMonitor::new(this.angle);
                this.grip_reading = GripReading::new(this.angle.zero());
            }
        });
        // Where the drive has no power a column may lie anywhere: readings that no prediction explains would bar the acknowledgment for good.
        let lost = implausible.into_iter().fold(S::mask(false), |any, sensor| any | sensor);
        S::paths(self, |this| {
            if S::holds(lost & !this.sequence.enable) {
                this.plausibility = Plausibility::new(this.angle);
            }
        });
        self.act(&limits, input)
    }

    /// What a sample shows that can be used.
    #[inline(always)]
    fn watch(&mut self, limits: &Limits<S>, input: &SupervisorInput<S>) {
        let fresh = self.sensors.fresh;
        self.angle = fresh.sensed[2];
        let or_none = |value: S| S::select(value.is_number(), value, value.zero());
        let feel = FeelMotion {
            follows: self.sequence.follows(),
            acceleration: or_none(input.feel_acceleration),
            rate: or_none(input.feel_rate),
            link_torque: input.link_torque,
        };
        self.watch.watch(limits, fresh, feel, &mut self.acting);
        S::section("grip_zero");
        let (reading, torque) = (input.sensed[3], self.watch.grip.hand_force * limits.grip_arm);
        let offset = self.grip_zero.watch(limits, reading, torque);
        self.acting = self.acting.with(Function::GripOffset, offset);
        if limits.grip_sensor {
            S::section("grip_reading");
            let time = limits.period * fresh.periods;
            let torques = [torque, self.watch.drive_torque()];
            let stuck = self.grip_reading.is_stuck(limits, (reading, time), (limits.is_free(self.angle), torques));
            self.acting = self.acting.with(Function::Stuck, stuck);
        }
    }

    /// What comes of the state.
    #[inline(always)]
    fn act(&mut self, limits: &Limits<S>, input: &SupervisorInput<S>) -> SupervisorOutput<S> {
        S::section("command");
        let follows = self.sequence.follows();
        S::paths(self, |this| {
            if S::holds(this.sequence.cut) {
                this.command.cut();
                this.sequence.disabled();
            } else if S::holds(follows) {
                // While the loop is late, the law knows nothing new: the last command holds.
                let e = S::select(input.late.some(), this.command.last, input.command);
                this.command.follow(limits, e, this.sequence.share, &mut this.acting);
            } else {
                this.command.stop(limits);
                if S::holds(this.command.is_zero) {
                    this.sequence.stopped();
                }
            }
        });
        let sent = S::select(self.sequence.enable, self.command.last, self.command.last.zero());
        self.plausibility.sends(sent);
        SupervisorOutput {
            state: self.sequence.state,
            command: self.command.last,
            enable: self.sequence.enable,
            follows,
            share: self.sequence.share,
            host_share: self.host_share,
            anchor: self.sequence.anchor,
            leads: self.sequence.search.is_under_way(),
            led: self.sequence.search.neutral,
            grip: self.watch.grip,
            grip_zero: self.grip_zero.offset,
            acting: self.acting,
            tripped: self.sequence.tripped.with(Function::Swing, self.swings),
            cause: self.sequence.cause,
        }
    }

    /// Holds the host's values, then leads to the default feel, and back when the host speaks again.
    #[inline(always)]
    fn host(&mut self, limits: &Limits<S>, input: &SupervisorInput<S>) {
        let silent = input.host & input.host_age.at_least(limits.host);
        self.swings = input.host & !input.acknowledge & (self.swings | self.acting.has(Function::Swing));
        self.acting =
            self.acting.without(Function::Swing).with(Function::HostSilent, silent).with(Function::Swing, self.swings);
        let step = limits.host_step;
        let (zero, one) = (step.zero(), step.constant(1.0));
        let change = S::select(self.swings, -step.times(SWING_FADES), S::select(silent, -step, step));
        self.host_share = (self.host_share + change).clamp(zero, one);
    }
}
