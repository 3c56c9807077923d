//! What an aircraft simulator does to the feel: its packets through the model's interpolation and effects, once a cycle.
//!
//! `q` dynamic pressure · `f(q)` the loader's factor on the spring · `s` share of the host's values, the supervisor's
//!
//! The spring has `1 + s (f(q) - 1)` of itself times the host's own factor. Beside it act the host's added spring and damping, and the
//! hinge moment of the loader's surface in the host's flight state, closed here from cycle to cycle. A packet whose spring and damping the
//! loader cannot render is refused before it acts, or softened to the nearest that it renders.
//! A host that has not spoken yet is a silent one: its values come
//! as its share does, over the supervisor's `host_fade`.

use crate::row::Row;
use crate::setup::{Rendered, Setup};
use forcefeel_model::curve::Curve;
use forcefeel_model::host::effects::Held;
use forcefeel_model::host::packet::{FROM_HOST, HOST_NUMBERS, switches};
use forcefeel_model::host::{FromHost, HostEffects, Stream, ToHost};
use forcefeel_model::parameters::{Parameters, Safety};
use forcefeel_model::supervisor::{Function, SupervisorOutput};
use forcefeel_model::surface::{Added, FlightState};

/// What a host wants of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HostRequest {
    /// Neutral in rad, beside the person's.
    pub neutral: f64,
    /// Factor on the spring.
    pub stiffness_factor: f64,
    /// Force at the grip, spring and damping beside the hand's and the feel's.
    pub added: Added,
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
        Self { neutral: 0.0, stiffness_factor: 1.0, added: Added::NONE, shaker: 0.0, age: None, holds_back: false };
}

/// What became of the last packet, as a bit of the status.
#[derive(Debug, Clone, Copy)]
enum Outcome {
    Taken = 0,
    /// The loader cannot render its spring or damping.
    Refused = 1 << 16,
    /// The nearest spring and damping that the loader renders act in their place.
    Softened = 1 << 17,
}

/// A host's packets and what they do.
#[derive(Debug, Clone)]
pub struct HostControl {
    stream: Stream,
    effects: HostEffects,
    parameters: Parameters<f64>,
    factor: Option<(Curve, [f64; 2])>,
    rendered: Vec<Rendered>,
    softens: bool,
    /// Packets that were softened.
    pub softened: u64,
    /// What the flaps move the neutral by, in rad/rad.
    flap_trim: f64,
    /// Share of the surface's hinge moment, and what it changes by in a period.
    flies: f64,
    flies_by: f64,
    outcome: Outcome,
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
        let factor = setup.factor.as_ref().and_then(|(knots, coefficients)| {
            Some((Curve::new(knots, coefficients)?, [*knots.first()?, *knots.last()?]))
        });
        Self {
            stream: Stream::new(period_s),
            effects: HostEffects::new(period_s, parameters.column.grip_arm),
            parameters,
            factor,
            rendered: setup.rendered.clone(),
            softens: setup.softens,
            softened: 0,
            flap_trim: setup.flap_trim,
            flies: 0.0,
            flies_by: period_s / TAKES_OFF_S,
            outcome: Outcome::Taken,
            host_share: 0.0,
            limits: ValueLimits::of(&parameters.safety, period_s),
            angle: 0.0,
            answers: 0,
            received: false,
        }
    }

    /// A packet has come, while the feel has this spring rate in N m/rad and damping in N m s/rad. What the loader cannot render is left out
    /// or softened, and the host told so.
    pub fn take(&mut self, packet: &FromHost, [spring, damping]: [f64; 2]) {
        let values = packet.numbers.map(f64::from);
        let added = self.added(&values, f64::from(u8::from(packet.has(switches::FLIGHT))));
        let of_feel = values[SPRING] * self.of_pressure(values[0]) * spring;
        let asked = [of_feel + added.stiffness, damping + added.damping];
        let plain = added.stiffness == 0.0 && added.damping == 0.0;
        let frozen = packet.has(switches::FREEZE);
        let nearest = if self.softens && !frozen { self.nearest(asked, plain) } else { None };
        self.outcome = match nearest {
            Some(nearest) if nearest.iter().zip(asked).any(|(near, asked)| (near - asked).abs() > 0.0) => {
                self.softened += 1;
                self.stream.take(&softened(packet, of_feel, asked, nearest));
                Outcome::Softened
            }
            None if !frozen && !plain && !renders(&self.rendered, asked) => Outcome::Refused,
            _ => {
                self.stream.take(packet);
                Outcome::Taken
            }
        };
        self.received = true;
    }

    /// The rendered spring rate and damping nearest to these; of a host that adds none, its own spring if that is not too stiff. Nothing where
    /// it is not known what is rendered.
    fn nearest(&self, [spring, damping]: [f64; 2], plain: bool) -> Option<[f64; 2]> {
        let (first, last) = (self.rendered.first()?, self.rendered.last()?);
        if plain {
            return Some([spring.min(last.spring), damping]);
        }
        let nearest = spring.clamp(first.spring, last.spring);
        let [least, most] = self.rendered.windows(2).find_map(|pair| dampings(pair, nearest))?;
        Some([nearest, damping.clamp(least, most)])
    }

    /// What the host's own coefficients and a share of the surface's hinge moment add to the feel, where the control stands.
    fn added(&self, values: &[f64; HOST_NUMBERS], flies: f64) -> Added {
        let &[dynamic_pressure, .., mach, tab, _] = values;
        let &[.., stiffness, damping, true_airspeed, angle_of_attack, sideslip, roll, pitch, yaw, load_factor, _, _, _] =
            values;
        let flight = FlightState {
            dynamic_pressure,
            true_airspeed,
            angle_of_attack,
            sideslip,
            rates: [roll, pitch, yaw],
            load_factor,
            mach,
            tab,
        };
        let of = self.parameters.hinge_moment(&flight, self.angle);
        Added {
            force: values[FORCE] + flies * of.force,
            stiffness: stiffness + flies * of.stiffness,
            damping: damping + flies * of.damping,
        }
    }

    fn of_pressure(&self, pressure: f64) -> f64 {
        self.factor.as_ref().map_or(1.0, |(curve, [low, high])| curve.at(pressure.clamp(*low, *high)))
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
        let mut wanted = self.stream.values(1.0);
        // Before the limits: what the flaps move the neutral by is bounded as a trim is.
        wanted[TRIM] += self.flap_trim * wanted[FLAP];
        let values = self.limits.limited(wanted, self.host_share);
        let on = self.stream.switches(self.host_share);
        let of_pressure = self.of_pressure(wanted[0]);
        let of_pressure = 1.0 + self.host_share * (self.limits.spring(of_pressure) - 1.0);
        let flies = on & switches::FLIGHT != 0 && self.stream.age().is_some();
        let by = self.flies_by;
        self.flies = if flies { (self.flies + by).min(1.0) } else { (self.flies - by).max(0.0) };
        let added = self.added(&values, self.flies);
        let grip_arm = self.parameters.column.grip_arm;
        let force = |angle, factor| (held.force)(angle, factor * of_pressure) + added.stiffness * angle / grip_arm;
        let mut values = values;
        values[FORCE] = added.force;
        let held = Held { angle: self.angle, spring: held.spring, force };
        let command = self.effects.step(&held, &values, on, share);
        HostRequest {
            neutral: command.neutral,
            stiffness_factor: command.stiffness_factor * of_pressure,
            added: Added {
                force: command.torque / grip_arm,
                stiffness: share * added.stiffness,
                damping: share * added.damping,
            },
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
        let status = row.state as u32 | (cause as u32) << 8 | self.outcome as u32;
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

/// Places among the values: of the spring factor, the trim, the added force and the flaps' angle.
const SPRING: usize = 1;
const TRIM: usize = 2;
const FORCE: usize = 5;
/// Places of the added spring and damping.
const STIFFNESS: usize = 10;
const DAMPING: usize = 11;
const FLAP: usize = HOST_NUMBERS - 1;
/// Time in which the surface's hinge moment comes and goes, in s.
const TAKES_OFF_S: f64 = 0.1;

/// Whether a spring rate lies among those that a loader renders, and the damping between what it needs there.
fn renders(rendered: &[Rendered], [spring, damping]: [f64; 2]) -> bool {
    let inside =
        |pair: &[Rendered]| dampings(pair, spring).is_some_and(|[least, most]| (least..=most).contains(&damping));
    if rendered.is_empty() { spring > 0.0 && damping >= 0.0 } else { rendered.windows(2).any(inside) }
}

/// Least and most damping at a spring rate between two that are rendered; nothing beyond them.
fn dampings(pair: &[Rendered], spring: f64) -> Option<[f64; 2]> {
    let [a, b] = [pair[0], pair[1]];
    let share = (spring - a.spring) / (b.spring - a.spring);
    let between = |k: usize| a.damping[k] + share * (b.damping[k] - a.damping[k]);
    (0.0..=1.0).contains(&share).then(|| [between(0), between(1)])
}

/// A packet that asks for `nearest` instead, of which the feel's own spring has `of_feel`. A spring that is too stiff is softened in its
/// parts alike, so that its neutral stays.
#[expect(clippy::cast_possible_truncation, reason = "the packet has single precision")]
fn softened(packet: &FromHost, of_feel: f64, asked: [f64; 2], nearest: [f64; 2]) -> FromHost {
    let mut packet = *packet;
    let kept = if nearest[0] < asked[0] { nearest[0] / asked[0] } else { 1.0 };
    let added = [nearest[0] - asked[0] + (1.0 - kept) * of_feel, nearest[1] - asked[1]];
    packet.numbers[SPRING] *= kept as f32;
    packet.numbers[STIFFNESS] += added[0] as f32;
    packet.numbers[DAMPING] += added[1] as f32;
    packet
}

impl ValueLimits {
    /// Those of the loader file, by what a value is: pressure, spring, angle, angle, force, force, shaker, force, rate, force; the others are the flight's
    /// own, and bounded by what is rendered.
    fn of(safety: &Safety<f64>, period_s: f64) -> Self {
        let none = f64::INFINITY;
        let whole = |first: &[f64; 10]| core::array::from_fn(|k| first.get(k).copied().unwrap_or(none));
        let (spring, angle, force) = (safety.host_spring, safety.host_angle, safety.host_force);
        let most = whole(&[none, spring, angle, angle, force, force, none, force, safety.host_angle_rate, force]);
        let (spring, angle, force) = (safety.host_spring_rate, safety.host_angle_rate, safety.host_force_rate);
        let step =
            whole(&[none, spring, angle, angle, force, force, none, force, none, force]).map(|rate| rate * period_s);
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
