//! An electric drive: motor, current loop and transmission.
//!
//! `x_m` displacement of the drive's end · `r` travel per radian of the motor · `omega = x_m' / r` · `i` current · `e` command, in A ·
//! `K_t` torque constant, `K_e = K_t / n` back-EMF, `n = 3/2` for three phases in peak amperes, 1 for a brushed motor · `R`, `L`
//! winding · `F` force on the link, `k`, `c` link and transmission in series · `v_b` velocity of the base
//!
//! | | |
//! |---|---|
//! | `F = k (x_m - alpha x_b) + c (x_m' - alpha v_b)` | link and transmission, eq. (9) |
//! | `(J_m / r^2) x_m'' = (K_t i + T_cog(omega t)) / r - B_m x_m' / r^2 - F - friction` | rotor |
//! | `L i' = u - R i - K_e omega` | winding |
//! | `u = R i + K_e omega + w_c L (e - i)` within the voltage that there is | current loop |
//!
//! Without limits the current follows its command as a first-order lag of the loop's bandwidth, solved exactly: it may be as fast as it
//! likes. Its three numbers are `x_m, x_m', i`;
//! the rotor has mass, so the force follows from them and effort is the force itself.
//!
//! | part | file |
//! |---|---|
//! | torque, cogging, friction and inertia of the motor | [`motor`] |
//! | voltage, current and their limits | [`current_loop`] |
//! | link and transmission, losses of it | [`transmission`] |
//! | temperatures of winding and housing | [`thermal`] |
//! | motor, linkage and column as a linear system | [`plant`] |
//! | what motor and transmission give at the grip | [`statics`] |

mod channels;
pub mod current_loop;
pub mod motor;
pub mod plant;
pub mod statics;
pub mod thermal;
pub mod transmission;

use super::{
    Contact, Coupling, Drive, DriveSignals, Link, Motion, Neighbors, QuickPart, REMEMBERED, SIGNALS, Signals, Statics,
};
use crate::Scalar;
use crate::channels::COUNT;
use crate::controller::Converters;
use crate::dry_friction::{DryFriction, StickState};
use crate::effects::Effects;
use crate::parameters::Parameters;
use crate::run::{RunSnapshot, RunState, RunStepStart, Shared, Slow, StepFraction};
use channels::CHANNELS;
use current_loop::{Current, CurrentTrajectory, Warm};
use motor::Rotor;
use thermal::Warming;
use transmission::Train;

/// Places of its quantities: current in A, voltage in V, speed of the motor in rad/s.
pub const CURRENT: usize = 0;
/// See [`CURRENT`].
pub const VOLTAGE: usize = 1;
/// See [`CURRENT`].
pub const SPEED: usize = 2;
/// Temperature of the winding in degrees Celsius.
pub const WINDING: usize = 3;

/// Motor, current loop and transmission of one loader.
#[derive(Debug, Clone, Copy)]
pub struct Electric<S> {
    rotor: Rotor<S>,
    current: Current<S>,
    train: Train<S>,
    warming: Warming<S>,
    per_travel: S,
    one: S,
}

/// Memory of the drive from step to step.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "S: serde::Serialize, S::Mask: serde::Serialize",
        deserialize = "S: serde::Deserialize<'de>, S::Mask: serde::Deserialize<'de>"
    ))
)]
pub struct MotorState<S: Scalar> {
    /// What the rotor's dry friction does.
    pub grip: StickState<S>,
    /// Temperatures of winding and housing over that around, in K.
    pub warmth: [S; 2],
    /// What that makes of the winding.
    warm: Warm<S>,
    /// The current through the step.
    pub trajectory: CurrentTrajectory<S>,
}

impl<S: Scalar> Electric<S> {
    /// Torque of the motor in N m, friction left out.
    #[inline(always)]
    fn torque(&self, effects: &Effects, x_m: S, i: S) -> S {
        self.rotor.torque(effects, x_m * self.per_travel, i)
    }

    /// Acceleration of the drive's end at `x_m, x_m', i` against the link's force.
    #[inline(always)]
    fn acceleration(&self, effects: &Effects, [x_m, v_m, i]: [S; 3], force: S) -> S {
        self.rotor.acceleration(self.torque(effects, x_m, i), v_m, force)
    }

    /// At the start of a step: what dry friction did to the rotor inside the last one, and does in this.
    #[inline(always)]
    fn stick(
        &self,
        neighbors: &Neighbors<'_, S>,
        state: &mut RunState<S, MotorState<S>>,
        now: &mut RunSnapshot<S, S>,
        rates: &mut Slow<S>,
    ) {
        let (v, pull) = (state.slow.plant[1], rates.plant[1]);
        let moves = v.zero().less(v.abs());
        let friction = self.friction(now.balance, S::select(moves, v, pull));
        let settled = friction.settled(&state.drive.grip, v, pull, (neighbors.step, neighbors.per_step));
        state.drive.grip = friction.grip(settled.velocity, pull);
        state.slow.plant[0] = state.slow.plant[0] + settled.displacement;
        state.slow.plant[1] = S::select(settled.settled, settled.velocity, v);
        now.position = state.slow.plant[0];
        now.signals[SPEED] = state.slow.plant[1] * self.per_travel;
        rates.plant[0] = state.slow.plant[1];
    }

    /// Dry friction of the rotor under the link's force `f`, moving or about to move along `way`.
    #[inline(always)]
    fn friction(&self, f: S, way: S) -> DryFriction<S> {
        self.rotor.friction(self.train.lost(f, way) / self.per_travel)
    }
}

impl<S: Scalar> Drive<S> for Electric<S> {
    #[inline(always)]
    fn new(parameters: &Parameters<S>, shared: &Shared, _: &Coupling<S>) -> Self {
        let one = parameters.column.inertia.constant(1.0);
        Self {
            rotor: Rotor::new(parameters),
            current: Current::new(parameters, shared.step_s),
            train: Train::new(parameters),
            warming: Warming::new(parameters, shared.step_s),
            per_travel: one / parameters.transmission.travel,
            one,
        }
    }

    #[inline(always)]
    fn converters(parameters: &Parameters<S>) -> Converters<S> {
        Converters::of_numbers(parameters.current_loop.current_limit, parameters.controller.antiwindup)
    }
}

impl<S: Scalar> Statics<S> for Electric<S> {
    const COMMAND_HOLDS: bool = true;

    #[inline(always)]
    fn link(&self) -> Link<S> {
        self.train.link
    }

    #[inline(always)]
    fn force_per_effort(&self) -> S {
        self.one
    }

    #[inline(always)]
    fn effort(&self, force: S) -> S {
        force
    }

    #[inline(always)]
    fn effort_of_stretch(&self, stretch: S) -> S {
        stretch / self.train.link.per_stiffness
    }

    #[inline(always)]
    fn stretch_at_rest(&self, effort: S) -> S {
        self.train.stretch_at_rest(effort)
    }

    /// Force of the motor under the command, less what the link takes.
    #[inline(always)]
    fn residual(&self, effects: &Effects, e: S, (position, effort): (S, S)) -> S {
        let i = self.current.commanded(effects, &self.current.warm(e.zero()), e);
        self.torque(effects, position, i) * self.per_travel - effort
    }
}

impl<S: Scalar> Motion<S> for Electric<S> {
    /// `alpha c` while the base moves, zero while it sticks.
    type Side = S;
    /// Force on the link in N.
    type Balance = S;
    type Memory = MotorState<S>;

    #[inline(always)]
    fn side(&self, _: &Effects, stuck: S::Mask) -> S {
        S::select(stuck, self.one.zero(), self.train.base_damping)
    }

    #[inline(always)]
    fn moving(&self) -> S {
        self.train.base_damping
    }

    #[inline(always)]
    fn balance(&self, effects: &Effects, side: &S, _: S::Mask, &[x_m, v_m, _, x_b, w]: &[S; 5]) -> S {
        self.train.force(effects, (x_m, v_m), x_b, *side * w)
    }

    #[inline(always)]
    fn pull(&self, base_per_force: S, balance: &S) -> S {
        base_per_force * *balance
    }

    #[inline(always)]
    fn rates(
        &self,
        effects: &Effects,
        memory: &MotorState<S>,
        (&[x_m, v_m, carried, ..], moment): (&[S; 5], StepFraction),
        e: S,
        now: &mut RunSnapshot<S, S>,
    ) -> [S; 3] {
        let required = self.current.commanded(effects, &memory.warm, e);
        let (i, i_rate) = self.current.at(moment, &memory.trajectory, carried, required);
        if moment == StepFraction::Start {
            now.signals[VOLTAGE] = self.current.voltage(effects, &memory.warm, (i, v_m * self.per_travel), required);
        }
        [v_m, self.acceleration(effects, [x_m, v_m, i], now.balance), i_rate]
    }

    #[inline(always)]
    fn at_rest(&self, effects: &Effects, position: S, effort: S) -> ([S; 3], [S; 2], MotorState<S>) {
        let zero = position.zero();
        let i = (effort / self.per_travel - self.torque(effects, position, zero)) / self.rotor.torque_constant;
        let grip = StickState::resting(&self.friction(effort, zero));
        (
            [position, zero, i],
            [zero; 2],
            MotorState {
                grip,
                warmth: [zero; 2],
                warm: self.current.warm(zero),
                trajectory: CurrentTrajectory::constant(i),
            },
        )
    }

    #[inline(always)]
    fn settle(
        &self,
        neighbors: &Neighbors<'_, S>,
        effects: &Effects,
        state: &mut RunState<S, MotorState<S>>,
        now: &mut RunSnapshot<S, S>,
        rates: &mut Slow<S>,
    ) {
        if effects.drive_friction {
            self.stick(neighbors, state, now, rates);
        }
        let required = rates.plant[2];
        let mut resisted = *rates;
        Self::resist(effects, &state.drive, &mut resisted);
        let speed = (state.slow.plant[1] + resisted.plant[1] * neighbors.step.times(0.5)) * self.per_travel;
        state.drive.trajectory =
            self.current.trajectory(effects, &state.drive.warm, (state.slow.plant[2], speed), required);
        rates.plant[2] = state.drive.trajectory.rate;
    }

    #[inline(always)]
    fn resist(effects: &Effects, memory: &MotorState<S>, rates: &mut Slow<S>) {
        if effects.drive_friction {
            let pull = rates.plant[1] + memory.grip.drag;
            rates.plant[1] = S::select(memory.grip.stuck, pull.zero(), pull);
        }
    }

    #[inline(always)]
    fn end_step(&self, effects: &Effects, state: &mut RunState<S, MotorState<S>>, step_start: &RunStepStart<S, S, S>) {
        if effects.heating {
            let squared = state.drive.trajectory.mean_square(step_start.now.signals[CURRENT], state.slow.plant[2]);
            let power = self.current.heat(&state.drive.warm, squared);
            state.drive.warmth = self.warming.after(state.drive.warmth, power);
            state.drive.warm = self.current.warm(state.drive.warmth[0]);
        }
    }

    /// None: heat and dry friction are left out of a linear loop.
    fn remembered(memory: &MotorState<S>) -> [S; REMEMBERED] {
        [memory.warmth[0].zero(); REMEMBERED]
    }

    fn remember(_: &mut MotorState<S>, _: [S; REMEMBERED]) {}
}

impl<S: Scalar> QuickPart<S> for Electric<S> {
    #[inline(always)]
    fn catch_up(
        &self,
        _: &Neighbors<'_, S>,
        effects: &Effects,
        _: &S,
        state: &mut RunState<S, MotorState<S>>,
        now: &mut RunSnapshot<S, S>,
    ) {
        if effects.heating {
            now.signals[WINDING] = self.warming.ambient + state.drive.warmth[0];
        }
    }
}

impl<S: Scalar> Contact<S> for Electric<S> {
    #[inline(always)]
    fn command_jump(&self, _: &Effects, _: &RunSnapshot<S, S>, e_change: S) -> S {
        self.current.bandwidth * e_change
    }
}

impl<S: Scalar> Signals<S> for Electric<S> {
    const NAMES: &'static [(&'static str, &'static str)] = &[
        ("drive_position", "m"),
        ("motor_current", "A"),
        ("motor_voltage", "V"),
        ("motor_speed", "rad/s"),
        ("winding_temperature", "degC"),
    ];
    const PEAKS: [usize; 3] = [CURRENT, VOLTAGE, SPEED];
    const CHANNELS: &'static [(&'static str, &'static str)] = CHANNELS;

    #[inline(always)]
    fn carried(memory: &MotorState<S>) -> S {
        memory.warmth[0]
    }

    #[inline(always)]
    fn signals(&self, &[x_m, v_m, i, ..]: &[S; 5], balance: &S, warmth: S) -> DriveSignals<S> {
        let mut signals = [i; SIGNALS];
        (signals[VOLTAGE], signals[SPEED]) = (i.zero(), v_m * self.per_travel);
        signals[WINDING] = self.warming.ambient + warmth;
        DriveSignals { position: x_m, force: *balance, signals }
    }

    #[inline(always)]
    fn signals_between(
        &self,
        plant: &[S; 5],
        balance: &S,
        [a, b]: [&RunSnapshot<S, S>; 2],
        _: bool,
    ) -> DriveSignals<S> {
        let mut seen = self.signals(plant, balance, balance.zero());
        seen.signals[WINDING] = (a.signals[WINDING] + b.signals[WINDING]).times(0.5);
        seen.signals[VOLTAGE] = (a.signals[VOLTAGE] + b.signals[VOLTAGE]).times(0.5);
        seen
    }

    #[inline(always)]
    fn channels(now: &RunSnapshot<S, S>, parameters: &Parameters<S>) -> [S; COUNT] {
        let angle = |x: S| parameters.column.angle(x);
        let [i, voltage, speed, winding] = now.signals;
        let turned = now.position / parameters.transmission.travel;
        [angle(now.base), angle(now.base_rate), now.position, now.force, i, voltage, speed, turned, winding]
    }
}
