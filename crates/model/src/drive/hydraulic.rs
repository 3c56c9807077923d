//! A hydraulic drive: servo amplifier, control valve and piston, eqs. (1)-(5), (13).
//!
//! | part | file |
//! |---|---|
//! | servo amplifier | [`amplifier`] |
//! | control valve, in a run with its limits | [`valve`] |
//! | actuator | [`actuator`] |
//! | load pressure, slaved | [`pressure`] |
//! | what valve and piston give at the grip | [`statics`] |
//!
//! Its three numbers are `z, q_i, q_i'`, its effort is the load pressure `p`, which oil and the link's damper bring behind its
//! balance: see `pressure.rs`.

pub mod actuator;
pub mod amplifier;
mod lag;
mod play;
pub mod pressure;
pub mod statics;
pub mod valve;

use super::{Coupling, Drive, DriveSignals, Link, Motion, REMEMBERED, SIGNALS, Signals, Statics};
use crate::Scalar;
use crate::channels::{self, Bench, CHANNELS};
use crate::controller::Converters;
use crate::effects::Effects;
use crate::parameters::Parameters;
use crate::run::{RunSnapshot, Shared, StepFraction};
use pressure::{Balance, Flow, Side};
use valve::ValveMotion;

/// Places of its quantities: load pressure in Pa, flow that moves piston and oil in m³/s, valve current in A.
pub const PRESSURE: usize = 0;
/// See [`PRESSURE`].
pub const FLOW: usize = 1;
/// See [`PRESSURE`].
pub const CURRENT: usize = 2;

/// Valve and piston of one loader.
#[derive(Debug, Clone, Copy)]
pub struct Hydraulic<S> {
    valve: ValveMotion<S>,
    balance: Balance<S>,
    /// `b c kappa`: velocity of the base per pressure that the damper's impulse is worth.
    base_impulse: S,
    /// `r c kappa / I`: the same for the feel.
    feel_impulse: S,
    /// `A` where the feel computer receives the load cell directly, zero where the load cell is sampled or lags.
    direct: S,
    per_area: S,
}

/// What the oil remembers of a step.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Oil<S> {
    /// Slaved load pressure at its start.
    pressure: S,
    /// By how much the load pressure was behind it.
    lag: S,
}

impl<S: Scalar> Drive<S> for Hydraulic<S> {
    #[inline(always)]
    fn new(parameters: &Parameters<S>, shared: &Shared, coupling: &Coupling<S>) -> Self {
        let balance = Balance::new(parameters, coupling.base_per_force);
        let one = balance.area.constant(1.0);
        Self {
            valve: ValveMotion::new(parameters, shared.effects.orifice),
            balance,
            base_impulse: coupling.base_per_force * balance.impulse,
            feel_impulse: coupling.feel_per_force * balance.impulse,
            direct: S::select(coupling.direct, balance.area, one.zero()),
            per_area: one / balance.area,
        }
    }

    #[inline(always)]
    fn converters(parameters: &Parameters<S>) -> Converters<S> {
        Converters::new(parameters)
    }
}

impl<S: Scalar> Statics<S> for Hydraulic<S> {
    const COMMAND_HOLDS: bool = false;

    #[inline(always)]
    fn link(&self) -> Link<S> {
        let Balance { ratio, half_play, per_stiffness, .. } = self.balance;
        Link { ratio, half_play, per_stiffness }
    }

    #[inline(always)]
    fn force_per_effort(&self) -> S {
        self.balance.area
    }

    #[inline(always)]
    fn effort(&self, force: S) -> S {
        force * self.per_area
    }

    #[inline(always)]
    fn effort_of_stretch(&self, stretch: S) -> S {
        stretch / self.balance.per_stiffness * self.per_area
    }

    #[inline(always)]
    fn stretch_at_rest(&self, effort: S) -> S {
        self.balance.stretch_at_rest(effort)
    }

    /// Flow that the command asks for, less what is lost at the pressure.
    #[inline(always)]
    fn residual(&self, effects: &Effects, e: S, (_, effort): (S, S)) -> S {
        let flow = self.valve.flow_per_current * self.valve.current(effects, e);
        flow - self.balance.leakage(effects, effort)
    }
}

impl<S: Scalar> Motion<S> for Hydraulic<S> {
    type Side = Side<S>;
    type Balance = Flow<S>;
    type Memory = Oil<S>;

    #[inline(always)]
    fn side(&self, effects: &Effects, stuck: S::Mask) -> Side<S> {
        self.balance.side(effects, stuck)
    }

    #[inline(always)]
    fn moving(&self) -> Side<S> {
        self.balance.moving()
    }

    #[inline(always)]
    fn balance(&self, effects: &Effects, side: &Side<S>, touches: S::Mask, plant: &[S; 5]) -> Flow<S> {
        self.balance.solve(effects, side, touches, *plant)
    }

    #[inline(always)]
    fn pull(&self, base_per_force: S, balance: &Flow<S>) -> S {
        base_per_force * self.balance.area * (balance.pressure - balance.seals)
    }

    #[inline(always)]
    fn rates(
        &self,
        effects: &Effects,
        _: &Oil<S>,
        (plant, _): (&[S; 5], StepFraction),
        e: S,
        now: &mut RunSnapshot<S, Flow<S>>,
    ) -> [S; 3] {
        let &[_, q_i, q_i_rate, ..] = plant;
        let current = self.valve.current(effects, e);
        now.signals[CURRENT] = current;
        let flow_acceleration = self.valve.flow_acceleration(effects, q_i, q_i_rate, current);
        [now.balance.flow * self.per_area, q_i_rate, flow_acceleration]
    }

    #[inline(always)]
    fn at_rest(&self, effects: &Effects, position: S, effort: S) -> ([S; 3], [S; 2], Oil<S>) {
        let z = position + self.balance.compressibility * effort;
        let q_i = self.balance.leakage(effects, effort);
        let momenta = [self.base_impulse * effort, -self.feel_impulse * effort];
        ([z, q_i, z.zero()], momenta, Oil { pressure: effort, lag: z.zero() })
    }

    fn remembered(memory: &Oil<S>) -> [S; REMEMBERED] {
        [memory.pressure, memory.lag]
    }

    fn remember(memory: &mut Oil<S>, [pressure, lag]: [S; REMEMBERED]) {
        *memory = Oil { pressure, lag };
    }
}

impl<S: Scalar> Signals<S> for Hydraulic<S> {
    const NAMES: &'static [(&'static str, &'static str)] =
        &[("piston_position", "m"), ("load_pressure", "Pa"), ("actuator_flow", "m^3/s"), ("valve_current", "A")];
    const PEAKS: [usize; 3] = [CURRENT, PRESSURE, FLOW];
    const CHANNELS: &'static [(&'static str, &'static str)] = CHANNELS;

    #[inline(always)]
    fn carried(memory: &Oil<S>) -> S {
        -memory.lag
    }

    #[inline(always)]
    fn signals(&self, plant: &[S; 5], balance: &Flow<S>, behind: S) -> DriveSignals<S> {
        self.shown(plant[0], (balance.pressure + behind, balance.seals), balance.flow, behind.zero())
    }

    #[inline(always)]
    fn signals_between(
        &self,
        plant: &[S; 5],
        balance: &Flow<S>,
        [a, b]: [&RunSnapshot<S, Flow<S>>; 2],
        digital: bool,
    ) -> DriveSignals<S> {
        // The lag itself changes so little over a step that a straight line will do.
        let lag = |now: &RunSnapshot<S, Flow<S>>| {
            (now.signals[PRESSURE] - now.balance.pressure, now.signals[FLOW] - now.balance.flow)
        };
        let (from, to) = (lag(a), lag(b));
        let pressure = balance.pressure + (from.0 + to.0).times(0.5);
        let flow = balance.flow + (from.1 + to.1).times(0.5);
        let [from, to] = [a, b].map(|now| now.signals[CURRENT]);
        let current = if digital { from } else { (from + to).times(0.5) };
        self.shown(plant[0], (pressure, balance.seals), flow, current)
    }

    #[inline(always)]
    fn channels(now: &RunSnapshot<S, Flow<S>>, parameters: &Parameters<S>) -> [S; channels::COUNT] {
        let &RunSnapshot { base, base_rate, position, force, signals, .. } = now;
        let [pressure, flow, current] = [PRESSURE, FLOW, CURRENT].map(|k| signals[k]);
        Bench { base, base_rate, piston: position, force, pressure, flow, current }.channels(parameters)
    }
}

impl<S: Scalar> Hydraulic<S> {
    #[inline(always)]
    fn shown(&self, z: S, (pressure, seals): (S, S), flow: S, current: S) -> DriveSignals<S> {
        let mut signals = [flow; SIGNALS];
        (signals[PRESSURE], signals[CURRENT]) = (pressure, current);
        let force = self.balance.area * (pressure - seals);
        DriveSignals { position: self.balance.piston(z, pressure), force, signals }
    }
}
