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
use forcefeel_model::host::packet::switches;
use forcefeel_model::host::{FromHost, HostEffects, Stream, ToHost};
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
        let values = self.stream.values(self.host_share);
        let on = self.stream.switches(self.host_share);
        let pressure = self.stream.values(1.0)[0];
        let of_pressure = self
            .factor
            .as_ref()
            .map_or(1.0, |(curve, [low, high])| 1.0 + self.host_share * (curve.at(pressure.clamp(*low, *high)) - 1.0));
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
