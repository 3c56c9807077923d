//! What an aircraft simulator does to the feel: its packets through the model's interpolation and effects, once a cycle.
//!
//! `q` dynamic pressure · `f(q)` the loader's factor on the spring · `s` share of the host's values, the supervisor's
//!
//! The spring has `1 + s (f(q) - 1)` of itself times the host's own factor. A host that has not spoken yet is a silent one: its values come
//! as its share does, over the supervisor's `host_fade`.

use crate::row::Row;
use crate::setup::Setup;
use forcefeel_model::curve::Curve;
use forcefeel_model::host::effects::Held;
use forcefeel_model::host::packet::{FROM_HOST, HOST_NUMBERS, switches};
use forcefeel_model::host::{FromHost, HostEffects, Stream, ToHost};
use forcefeel_model::parameters::Safety;
use forcefeel_model::supervisor::{Function, SupervisorOutput};

/// What a host wants of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HostRequest {
    /// Neutral in rad, beside the person's.
    pub neutral: f64,
    /// Factor on the spring.
    pub stiffness_factor: f64,
    /// Force at the grip in N, beside the hand's.
    pub added_force: f64,
    /// The shaker's share, 0 to 1.
    pub shaker: f64,
    /// Samples since the last packet; nothing where no host is listened to.
    pub age: Option<u32>,
    /// The host is there, and does not want the feel.
    pub holds_back: bool,
}

impl HostRequest {
    /// No host.
    pub const NONE: Self =
        Self { neutral: 0.0, stiffness_factor: 1.0, added_force: 0.0, shaker: 0.0, age: None, holds_back: false };
}

/// A host's packets and what they do.
#[derive(Debug, Clone)]
pub struct HostControl {
    stream: Stream,
    effects: HostEffects,
    grip_arm: f64,
    factor: Option<(Curve, [f64; 2])>,
    host_share: f64,
    limits: ValueLimits,
    /// The programmed control's angle.
    angle: f64,
    answers: u32,
    received: bool,
}

impl HostControl {
    /// Nothing has come yet.
    pub fn new(setup: &Setup) -> Self {
        let (parameters, period_s) = (setup.parameters(), setup.period_s());
        let grip_arm = parameters.column.grip_arm;
        let factor = setup.factor.as_ref().and_then(|(knots, coefficients)| {
            Some((Curve::new(knots, coefficients)?, [*knots.first()?, *knots.last()?]))
        });
        Self {
            stream: Stream::new(period_s),
            effects: HostEffects::new(period_s, grip_arm),
            grip_arm,
            factor,
            host_share: 0.0,
            limits: ValueLimits::of(&parameters.safety, period_s),
            angle: 0.0,
            answers: 0,
            received: false,
        }
    }

    /// A packet has come.
    pub fn take(&mut self, packet: &FromHost) {
        self.stream.take(packet);
        self.received = true;
    }

    /// Share of the host's values in the last cycle.
    pub fn share(&self) -> f64 {
        self.host_share
    }

    /// One sample on, of a control that is held so but for the pressure's factor.
    pub fn step<F: Fn(f64, f64) -> f64>(
        &mut self,
        held: &Held<F>,
        allowed: Option<&SupervisorOutput<f64>>,
    ) -> HostRequest {
        self.stream.step();
        // A feel that gives no number is the supervisor's matter; nothing is to remember it.
        self.angle = if held.angle.is_finite() { held.angle } else { self.angle };
        let age = self.stream.age();
        let (share, host_share) = allowed.map_or((0.0, 0.0), |allowed| (allowed.share, allowed.host_share));
        self.host_share = if age.is_some() { host_share } else { 0.0 };
        let values = self.limits.limited(self.stream.values(1.0), self.host_share);
        let on = self.stream.switches(self.host_share);
        let pressure = self.stream.values(1.0)[0];
        let of_pressure =
            self.factor.as_ref().map_or(1.0, |(curve, [low, high])| curve.at(pressure.clamp(*low, *high)));
        let of_pressure = 1.0 + self.host_share * (self.limits.spring(of_pressure) - 1.0);
        let force = |angle, factor| (held.force)(angle, factor * of_pressure);
        let held = Held { angle: self.angle, spring: held.spring, force };
        let command = self.effects.step(&held, &values, on, share);
        HostRequest {
            neutral: command.neutral,
            stiffness_factor: command.stiffness_factor * of_pressure,
            added_force: command.torque / self.grip_arm,
            shaker: command.shaker,
            age: Some(age.unwrap_or(u32::MAX)),
            holds_back: self.host_share > 0.0 && on & switches::ACTIVE == 0,
        }
    }

    /// What it is told of a cycle, once for each that brought a packet.
    pub fn answer(&mut self, row: &Row, allowed: Option<&SupervisorOutput<f64>>) -> Option<ToHost> {
        if !core::mem::take(&mut self.received) {
            return None;
        }
        let allowed = allowed?;
        self.answers = self.answers.wrapping_add(1);
        let place = |cause: Function| Function::ALL.iter().position(|one| *one == cause);
        let cause = allowed.cause.and_then(place).map_or(0, |place| place + 1);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place in a short table")]
        let status = row.state as u32 | (cause as u32) << 8;
        let numbers = [
            row.column_angle_rad,
            allowed.grip.rate,
            allowed.grip.force,
            row.neutral_rad,
            allowed.share,
            self.host_share,
        ];
        #[expect(clippy::cast_possible_truncation, reason = "the packet has single precision")]
        let numbers = numbers.map(|number| if number.is_finite() { number as f32 } else { 0.0 });
        Some(ToHost { sequence: self.answers, status, numbers })
    }
}

/// Largest magnitude of each of the host's values, and its largest change in a period; what its pressure makes of the spring is one of them.
#[derive(Debug, Clone)]
struct ValueLimits {
    most: [f64; HOST_NUMBERS],
    step: [f64; HOST_NUMBERS],
    last: [f64; HOST_NUMBERS],
    of_pressure: f64,
}

/// The spring factor's place among the values.
const SPRING: usize = 1;

impl ValueLimits {
    /// Those of the loader file, by what a value is: pressure, spring, angle, angle, force, force, shaker, force, rate, force.
    fn of(safety: &Safety<f64>, period_s: f64) -> Self {
        let none = f64::INFINITY;
        let (spring, angle, force) = (safety.host_spring, safety.host_angle, safety.host_force);
        let most = [none, spring, angle, angle, force, force, none, force, safety.host_angle_rate, force];
        let (spring, angle, force) = (safety.host_spring_rate, safety.host_angle_rate, safety.host_force_rate);
        let step = [none, spring, angle, angle, force, force, none, force, none, force].map(|rate| rate * period_s);
        Self { most, step, last: FROM_HOST.map(|(.., without)| f64::from(without)), of_pressure: 1.0 }
    }

    /// The host's values, limited; the host has this share of them. A host that is silent loses them by its share, at no rate of theirs.
    fn limited(&mut self, values: [f64; HOST_NUMBERS], share: f64) -> [f64; HOST_NUMBERS] {
        core::array::from_fn(|k| {
            self.last[k] = next(self.last[k], values[k], (self.most[k], self.step[k]));
            let without = f64::from(FROM_HOST[k].4);
            without + share * (self.last[k] - without)
        })
    }

    /// What dynamic pressure makes of the spring.
    fn spring(&mut self, of_pressure: f64) -> f64 {
        self.of_pressure = next(self.of_pressure, of_pressure, (self.most[SPRING], self.step[SPRING]));
        self.of_pressure
    }
}

/// A value after a period, that was `last` before and goes to `value`.
fn next(last: f64, value: f64, (most, step): (f64, f64)) -> f64 {
    let within = value.clamp(-most, most);
    // What may change at once is the value itself, to the very bit.
    if (within - last).abs() <= step { within } else { last + (within - last).clamp(-step, step) }
}
