//! The whole loader in time: one step of plant, controller and feel.
//!
//! `z` piston displacement with the oil uncompressed · `p` load pressure, slaved · `q_i`, `q_i'` no-load flow and its rate ·
//! `x_b`, `v` base and its velocity · `delta`, `delta'` programmed displacement and its rate · `I` impulse of the link's damper ·
//! `w = v + b I`, `u = delta' - (r / I_feel) I` the velocities that do not see the oil's pole, see `pressure.rs` · `h` step
//!
//! One step is the classical Runge-Kutta step of fourth order on `z, q_i, q_i', x_b, w` and, under the analog law, `delta, u`, with the
//! load pressure solved at every stage: fixed cost, no iteration, and no step so long that the oil makes it unstable. Dry
//! friction holds its direction through a step; what it did inside the last step is settled at the start of the next. So do
//! stops and the link's play hold their touch, and what touched inside a step is made good at its end, see `machine/touch.rs`.

mod digital;
mod equilibrium;
mod feel;
mod friction;
mod inputs;
mod middle;
mod oil;
pub mod period;
mod sensors;
mod slow;
mod step;
mod touch;

pub use digital::Memory;
pub use equilibrium::{EQUILIBRIUM_NUMBERS, Equilibrium, SEARCH_RAD};
pub use inputs::Inputs;

use crate::Scalar;
use crate::column::ColumnMotion;
use crate::compensator::Compensator;
use crate::controller::{Converters, Timing};
use crate::curve::Curve;
use crate::dry_friction::Grip;
use crate::effects::Effects;
use crate::feel::FeelLaw;
use crate::observer::Observer;
use crate::parameters::Parameters;
use crate::pressure::{Balance, Flow, Side};
use crate::transducers::{Seen, Transducers};
use crate::valve::ValveMotion;
use slow::Slow;

/// What all runs of a batch share.
#[derive(Debug, Clone)]
pub struct Shared {
    /// Effects in play.
    pub effects: Effects,
    /// Length of a step in s.
    pub step_s: f64,
    /// When a digital controller acts; an analog law otherwise.
    pub timing: Option<Timing>,
    /// Force over angle of the feel, in place of its straight spring.
    pub curve: Option<Curve>,
}

/// One loader, ready to run: its coefficients worked out.
#[derive(Debug, Clone, Copy)]
pub struct Machine<S> {
    law: Compensator<S>,
    observer: Observer<S>,
    next_observer: Observer<S>,
    valve: ValveMotion<S>,
    balance: Balance<S>,
    column: ColumnMotion<S>,
    feel: FeelLaw<S>,
    next_feel: FeelLaw<S>,
    transducers: Transducers<S>,
    converters: Converters<S>,
    /// `b c kappa`: velocity of the base per pressure that the damper's impulse is worth.
    base_impulse: S,
    /// `r c kappa / I`: the same for the feel.
    feel_impulse: S,
    /// `A` where the feel computer hears the load cell directly, zero where the load cell is sampled or lags.
    direct: S,
    force_scale: S,
    per_base: S,
    per_area: S,
    step: S,
    per_step: S,
}

/// State between two steps.
#[derive(Debug, Clone, Copy)]
pub struct State<S: Scalar> {
    slow: Slow<S>,
    column: Grip<S>,
    feel: Grip<S>,
    seen: Seen<S>,
    neutral: S,
    slider: S,
    /// Command that the amplifier holds under a digital controller.
    held: S,
    /// Pilot force at the end of the last step.
    pilot_force: S,
    /// Slaved load pressure at its start.
    pressure: S,
    /// By how much the load pressure was behind it.
    lag: S,
    /// Force of a hand that holds the grip until it lets go, in N.
    hand: S,
    /// What is added to the command that it holds, in V.
    test_signal: S,
    /// Share of the last step by which a force on the load cell came later than a straight line.
    late: S,
    /// Steps since the start.
    steps: usize,
}

/// What there is at one instant.
#[derive(Debug, Clone, Copy)]
pub struct Now<S> {
    /// Displacement of the column's base in m.
    pub base: S,
    /// Its velocity in m/s.
    pub base_rate: S,
    /// Programmed displacement, in its unit.
    pub delta: S,
    /// Its rate.
    pub delta_rate: S,
    /// Piston displacement in m.
    pub piston: S,
    /// Force of the load cell in N.
    pub force: S,
    /// Load pressure in Pa.
    pub pressure: S,
    /// Flow that moves piston and oil, in m³/s.
    pub flow: S,
    /// Valve current in A.
    pub current: S,
    /// Pilot force in N.
    pub pilot_force: S,
    /// Pressure and flow in balance, which the motions see; those above are behind them by the oil's lag.
    slaved: Flow<S>,
}

/// What the start of a step leaves for the rest of it.
#[derive(Debug, Clone, Copy)]
pub struct Begun<S: Scalar> {
    /// What there is now.
    pub now: Now<S>,
    slow: Slow<S>,
    rates: Slow<S>,
    side: Side<S>,
}

impl<S: Scalar> Machine<S> {
    /// The loader with these parameters under this law, in steps of `shared.step_s`.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, law: Compensator<S>, shared: &Shared) -> Self {
        let column = ColumnMotion::new(parameters);
        let balance = Balance::new(parameters, column.per_link_force);
        let feel = FeelLaw::new(parameters, &law);
        let one = parameters.column.inertia.constant(1.0);
        // A sampled load cell, or one with a lag, keeps the oil's pole from the feel computer.
        let direct = !parameters.load_cell.bandwidth.less(one / one.zero());
        let arm = if shared.timing.is_none() { law.load_cell_arm } else { one.zero() };
        let heard = S::select(direct, arm, one.zero());
        let observer = Observer::none(one);
        Self {
            law,
            observer,
            next_observer: observer,
            valve: ValveMotion::new(parameters, shared.effects.orifice),
            balance,
            column,
            feel,
            next_feel: feel,
            transducers: Transducers::new(parameters, shared.step_s),
            converters: Converters::new(parameters),
            base_impulse: column.per_link_force * balance.impulse,
            feel_impulse: heard * feel.per_torque * balance.impulse,
            direct: if shared.timing.is_none() { S::select(direct, balance.area, one.zero()) } else { one.zero() },
            force_scale: one,
            per_base: parameters.column.angle(one),
            per_area: one / balance.area,
            step: one.constant(shared.step_s),
            per_step: one.constant(1.0 / shared.step_s),
        }
    }

    /// The same loader with the pilot's force multiplied.
    #[inline(always)]
    pub fn with_force_scale(self, force_scale: S) -> Self {
        Self { force_scale, ..self }
    }

    /// The same loader under a sampled law with an observer; the gains of its law are not used.
    #[inline(always)]
    pub fn with_observer(self, observer: Observer<S>) -> Self {
        Self { observer, next_observer: observer, ..self }
    }

    /// Programmed angle in rad per programmed displacement.
    #[inline(always)]
    pub fn per_delta(&self) -> S {
        self.step.constant(1.0) / self.feel.per_angle
    }

    /// Column angle in rad per displacement of the base in m.
    #[inline(always)]
    pub fn per_base(&self) -> S {
        self.per_base
    }
}
