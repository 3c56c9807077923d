//! Loaders in equilibrium, from which a run starts: eqs. (6), (9), (11), (13) without motion.
//!
//! `theta` column angle · `x_b` base · `delta` programmed displacement · `S` spring of the feel · `r` load cell's arm · effort: load
//! pressure of a hydraulic drive
//!
//! Given `theta` and `delta`, everything at rest follows in turn: the feel's spring gives the load cell's force, that gives the
//! stretch of the link and so the drive's end, and the law the command. `delta` is where the command asks for no more than holds
//! the effort; for a given pilot force, `theta` is where that force holds the column. A feel computer that is deaf stays at
//! neutral; then it is the effort that is looked for.
//!
//! A search is thousands of evaluations in a row, once a run: it is left to the compiler what of it is inlined, and vector lanes
//! find their equilibria one by one.

use super::{Machine, Shared, State};
use crate::Scalar;
use crate::bisect::bisect;
use crate::cancellation::Cancellation;
use crate::drive::Drive;
use crate::dry_friction::StickState;
use crate::effects::Effects;
use crate::feel::FeelConditions;
use crate::observer::{Estimate, MOST_STATES, SAMPLED};
use crate::run::{SEARCH_RAD, Slow};
use crate::transducers::{SENSORS, SensorReading};

/// Numbers of a [`Equilibrium`].
pub const EQUILIBRIUM_NUMBERS: usize = 8 + MOST_STATES;

/// A loader in equilibrium, from which a run starts.
#[derive(Debug, Clone, Copy)]
pub struct Equilibrium<S> {
    /// Base, drive, programmed displacement, trimmed neutral and the drive's effort.
    pub(super) base: S,
    pub(super) position: S,
    pub(super) delta: S,
    pub(super) neutral: S,
    pub(super) effort: S,
    /// Rate at which the feel goes on, and its drive's limit takes it back.
    pub(super) delta_rate: S,
    /// Command that holds them.
    pub(super) command: S,
    /// State of the law's observer.
    pub(super) estimate: Estimate<S>,
    /// Pilot force that holds the column.
    pub pilot_force: S,
}

impl<S: Scalar> Equilibrium<S> {
    /// Everything at zero.
    pub(super) fn neutral(zero: S) -> Self {
        Self::from_numbers(&[zero; EQUILIBRIUM_NUMBERS])
    }

    /// This one where `mask` holds, the other elsewhere.
    pub(super) fn or(self, other: &Self, mask: S::Mask) -> Self {
        let (own, others) = (self.numbers(), other.numbers());
        Self::from_numbers(&core::array::from_fn(|k| S::select(mask, own[k], others[k])))
    }

    /// Displacement of the column's base in m.
    pub fn base(&self) -> S {
        self.base
    }

    /// Programmed displacement.
    pub fn delta(&self) -> S {
        self.delta
    }

    /// Command that holds it.
    pub fn command(&self) -> S {
        self.command
    }

    /// State of the law's observer.
    pub fn estimate(&self) -> &Estimate<S> {
        &self.estimate
    }

    /// What makes it out.
    pub fn numbers(&self) -> [S; EQUILIBRIUM_NUMBERS] {
        let &Self { base, position, delta, neutral, effort, delta_rate, command, estimate, pilot_force } = self;
        let others = [base, position, delta, neutral, effort, delta_rate, command, pilot_force];
        core::array::from_fn(|k| if k < MOST_STATES { estimate[k] } else { others[k - MOST_STATES] })
    }

    /// The one that these make out.
    #[inline(always)]
    pub fn from_numbers(numbers: &[S; EQUILIBRIUM_NUMBERS]) -> Self {
        let [base, position, delta, neutral, effort, delta_rate, command, pilot_force] =
            core::array::from_fn(|k| numbers[MOST_STATES + k]);
        let estimate = core::array::from_fn(|k| numbers[k]);
        Self { base, position, delta, neutral, effort, delta_rate, command, estimate, pilot_force }
    }
}

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// The loader at rest with the column held at the angle `theta` and the neutral trimmed to `trim`, both in rad.
    pub fn held_at(&self, shared: &Shared, theta: S, trim: S, stiffness_factor: S) -> Equilibrium<S> {
        let x_b = theta / self.control.per_base;
        let neutral = trim * self.control.feel.per_angle;
        // The effort where the programmed displacement is known: the link stretches by no more than the travel that is looked at.
        let with_delta = |effects: &Effects, delta: S| {
            let travel = self.drive.link().ratio / self.control.per_base * (theta.abs() + theta.constant(SEARCH_RAD));
            let most = if self.drifts() { travel.zero() } else { self.drive.effort_of_stretch(travel) };
            bisect((-most, most), Equilibrium::neutral(delta.zero()), |effort| {
                let driven = (effort, self.drive.stretch_at_rest(effort));
                self.standing((effects, shared.cancellation), [x_b, delta, neutral], driven)
            })
        };
        let search = |effects: &Effects| {
            // A feel computer that is deaf stays at neutral.
            if self.is_deaf() {
                return with_delta(effects, neutral);
            }
            let feel = &self.control.feel;
            let (center, reach) = (theta * feel.per_angle, feel.per_angle.times(SEARCH_RAD));
            let free = bisect((center - reach, center + reach), Equilibrium::neutral(center.zero()), |delta| {
                let conditions = FeelConditions::at_rest(neutral, stiffness_factor, delta);
                let driven = self.received(shared, x_b, delta, &conditions);
                self.standing((effects, shared.cancellation), [x_b, delta, neutral], driven)
            });
            // At a hard stop the feel takes any torque.
            let stopped = feel.between_stops(free.delta);
            let beyond = stopped.zero().less((free.delta - stopped).abs());
            if !(effects.feel_limits && S::any(beyond)) {
                return free;
            }
            with_delta(effects, stopped).or(&free, beyond)
        };
        let effects = &shared.effects;
        if !(D::COMMAND_HOLDS && effects.saturation) {
            return search(effects);
        }
        // What a limited command asks for beyond an effort that no command holds changes its sign far from any equilibrium.
        let unlimited = Effects { saturation: false, ..*effects };
        let equilibrium = search(&unlimited);
        let residual =
            |effects| self.drive.residual(effects, equilibrium.command, (equilibrium.position, equilibrium.effort));
        let cut = residual(effects) - residual(&unlimited);
        let beyond = cut.zero().less(cut.abs());
        if !S::any(beyond) {
            return equilibrium;
        }
        let limited = search(effects);
        let limited =
            if effects.observer { self.told_of_its_limit(shared, limited, stiffness_factor) } else { limited };
        limited.or(&equilibrium, beyond)
    }

    /// The loader at rest where base and load cell are moved by these from zero, in m and N, and the neutral is trimmed to this angle in rad:
    /// under whatever feel asks for that force.
    pub fn standing_at(&self, shared: &Shared, [x_b, force, trim]: [S; 3]) -> Equilibrium<S> {
        let effort = self.drive.effort(force);
        let (driven, neutral) = ((effort, self.drive.stretch_at_rest(effort)), trim * self.control.feel.per_angle);
        let (center, reach) = (self.control.delta_at(x_b), self.control.feel.per_angle.times(SEARCH_RAD));
        bisect((center - reach, center + reach), Equilibrium::neutral(center.zero()), |delta| {
            self.standing((&shared.effects, shared.cancellation), [x_b, delta, neutral], driven)
        })
    }

    /// The loader at rest under the pilot's force.
    pub fn held_by(&self, shared: &Shared, force: S, trim: S, stiffness_factor: S) -> Equilibrium<S> {
        let reach = force.constant(SEARCH_RAD);
        bisect((-reach, reach), Equilibrium::neutral(reach.zero()), |theta| {
            let equilibrium = self.held_at(shared, theta, trim, stiffness_factor);
            (equilibrium.pilot_force - force, equilibrium)
        })
    }

    /// Whether the feel computer receives nothing of the load cell, as in a servo on its own.
    fn is_deaf(&self) -> bool {
        let arm = self.control.law.load_cell_arm;
        !S::any(arm.zero().less(arm.abs()))
    }

    /// Whether nothing brings the piston back: the amplifier is open.
    pub fn drifts(&self) -> bool {
        let follows = self.control.law.gains[0];
        self.is_deaf() && !S::any(follows.zero().less(follows.abs()))
    }

    /// Effort at which the feel computer receives what its spring asks for at a programmed displacement, and the link's stretch.
    fn received(&self, shared: &Shared, x_b: S, delta: S, conditions: &FeelConditions<S>) -> (S, S) {
        let effects = &shared.effects;
        // S(delta) = T                                                                            eq. (11) at rest
        let spring = self.control.feel.spring(effects, shared.curve.as_ref(), delta, conditions)
            - self.control.feel.pushed(effects, conditions.start, (delta, delta.zero()));
        if effects.observer {
            let by_feel = self.control.observer.feel_torque_at_rest(delta, trimmed(effects, conditions.neutral));
            self.observed_equilibrium(effects, x_b, spring - by_feel)
        } else {
            self.received_equilibrium(spring)
        }
    }

    /// What holds at rest for a base, a programmed displacement and its neutral, and an effort with the link's stretch, and what
    /// the command then asks for beyond it.
    fn standing(
        &self,
        (effects, cancellation): (&Effects, Option<Cancellation>),
        [x_b, delta, neutral]: [S; 3],
        (effort, stretch): (S, S),
    ) -> (S, Equilibrium<S>) {
        let zero = delta.zero();
        let x_p = self.drive.link().ratio * x_b + stretch;
        let pilot_force = self.holding_force(effects, x_b, effort);
        let y = self.sampled_at_rest(effects, x_b, x_p, effort);
        let (e, estimate) = if effects.observer {
            let law = &self.control.observer;
            let untrimmed = law.untrimmed(delta, trimmed(effects, neutral));
            let estimate = law.at_rest(&y, untrimmed);
            (law.output(&estimate, &y, [untrimmed, zero], None).command, estimate)
        } else {
            let [force, piston, angle, _] = y;
            let e = self.control.law.command(&[
                piston,
                self.drive.effort(force),
                delta,
                zero,
                angle / self.control.per_base,
                zero,
                pilot_force,
            ]);
            (e, [zero; MOST_STATES])
        };
        let e = cancellation.map_or(e, |known| e + known.command(y[1], zero, zero));
        let residual = self.drive.residual(effects, e, (x_p, effort));
        let (base, position, command) = (x_b, x_p, e);
        let equilibrium =
            Equilibrium { base, position, delta, neutral, effort, delta_rate: zero, command, estimate, pilot_force };
        (residual, equilibrium)
    }

    /// Pilot force that holds the column at a base where the drive has an effort.
    pub(super) fn holding_force(&self, effects: &Effects, x_b: S, effort: S) -> S {
        // R_p F_p + alpha R_b F_c + loads = 0                                                         eq. (6) at rest
        let pull = self.column.per_link_force * self.drive.force_per_effort() * effort
            + self.column.loads(effects, x_b, x_b, x_b.zero());
        -pull / self.column.per_pilot_force
    }

    /// Effort at which the load cell is received as the torque `T`, `T = -r (F_c + F_0)`, and the link's stretch.
    fn received_equilibrium(&self, torque: S) -> (S, S) {
        let effort = self.drive.effort(-torque / self.control.law.load_cell_arm - self.transducers.offset[0]);
        (effort, self.drive.stretch_at_rest(effort))
    }

    /// Effort and stretch at which an observer receives the torque `T` of the sensors in equilibrium, `T = t_F F_c + t_x x_p + t_theta theta + t_g F_g`.
    ///
    /// Where the drive hangs free within the link's play, there is no effort, and the law says where it hangs.
    fn observed_equilibrium(&self, effects: &Effects, x_b: S, torque: S) -> (S, S) {
        let link = self.drive.link();
        let [per_force, per_piston, per_angle, per_grip, _] = self.control.observer.torque_at_rest();
        let [force, piston, angle, grip] = self.sampled_at_rest(effects, x_b, link.ratio * x_b, x_b.zero());
        let per_stretch = self.drive.force_per_effort() * link.per_stiffness;
        // At rest the hand holds against the link, F_g per F_c.
        let against = self.grip.shown(-self.column.per_link_force / self.column.per_pilot_force, [x_b.zero(); 3]);
        let per_effort = (per_force + per_grip * against) * self.drive.force_per_effort() + per_piston * per_stretch;
        let known = per_force * force + per_angle * angle + per_grip * grip;
        let left = torque - known - per_piston * piston;
        let play = per_piston * link.half_play;
        let one = x_b.constant(1.0);
        let side = one.times_sign(left).times_sign(per_effort);
        let pressed = (left - play * side) / per_effort;
        let hangs = left.abs().less(play.abs());
        let effort = S::select(hangs, one.zero(), pressed);
        let stretch = S::select(hangs, left / S::select(hangs, per_piston, one), self.drive.stretch_at_rest(effort));
        (effort, stretch)
    }

    /// What the sensors show where the column rests, untouched and without a command: at zero and at another angle. At rest they are
    /// straight between the two.
    pub fn sensors_at_rest(&self, effects: &Effects) -> [[S; SENSORS]; 2] {
        let zero = self.control.per_base.zero();
        // The other angle may be beyond an end stop, which would push back with more than the drive has.
        let effects = &Effects { column_stops: false, ..*effects };
        [0.0, ELSEWHERE_RAD].map(|angle| {
            let x_b = zero.constant(angle) / self.control.per_base;
            // alpha R_b F_c + loads = 0: what pulls the column hangs on the drive.                       eq. (6) at rest
            let force = -self.column.loads(effects, x_b, x_b, zero) / self.column.per_link_force;
            let effort = self.drive.effort(force);
            self.shown_there(effects, [x_b, self.drive.link().ratio * x_b + self.drive.stretch_at_rest(effort), effort])
        })
    }

    /// What the sensors show in equilibrium.
    #[inline(always)]
    pub fn shown_at_rest(&self, effects: &Effects, equilibrium: &Equilibrium<S>) -> [S; SENSORS] {
        let &Equilibrium { base, position, effort, .. } = equilibrium;
        self.shown_there(effects, [base, position, effort])
    }

    #[inline(always)]
    fn shown_there(&self, effects: &Effects, [x_b, x_p, effort]: [S; 3]) -> [S; SENSORS] {
        let [force, piston, base, grip] = self.transducers.offset;
        let on_cell = self.drive.force_per_effort() * effort;
        let at_grip = self.grip_at_rest(effects, x_b, on_cell);
        [on_cell + force, x_p + piston, x_b + base, at_grip + grip]
    }

    /// The same as the law takes it, the column's as an angle.
    #[inline(always)]
    pub(super) fn sampled_at_rest(&self, effects: &Effects, x_b: S, x_p: S, effort: S) -> [S; SAMPLED] {
        self.control.sampled(&self.shown_there(effects, [x_b, x_p, effort]))
    }

    /// Force at the grip that holds the column against a force on the load cell.
    #[inline(always)]
    fn grip_at_rest(&self, effects: &Effects, x_b: S, force: S) -> S {
        let zero = x_b.zero();
        if !effects.grip_sensor {
            return zero;
        }
        let pull = self.column.per_link_force * force + self.column.loads(effects, x_b, x_b, zero);
        self.grip.shown(-pull / self.column.per_pilot_force, [x_b, zero, zero])
    }

    /// A run's first state.
    #[inline(always)]
    pub fn start(&self, shared: &Shared, equilibrium: &Equilibrium<S>) -> State<S, D> {
        let zero = equilibrium.base.zero();
        let &Equilibrium { base, position, delta, delta_rate, effort, .. } = equilibrium;
        let ([first, second, third], [w, u], drive) = self.drive.at_rest(&shared.effects, position, effort);
        let u = if shared.timing.is_some() { delta_rate } else { u };
        let force = self.drive.force_per_effort() * effort;
        let measured = [force, position, base, self.grip_at_rest(&shared.effects, base, force)];
        State::<S, D> {
            slow: Slow { plant: [first, second, third, base, w], feel: [delta, u] },
            column: StickState::resting(&self.column.friction),
            feel: StickState::resting(&self.control.feel.friction),
            drive,
            seen: SensorReading { measured, shown: measured },
            neutral: equilibrium.neutral,
            slider: delta,
            held: equilibrium.command,
            pilot_force: equilibrium.pilot_force,
            hand: zero,
            test_signal: zero,
            late: zero,
            steps: 0,
        }
    }
}

/// The neutral as the law gets it.
fn trimmed<S: Scalar>(effects: &Effects, neutral: S) -> S {
    if effects.surroundings { neutral } else { neutral.zero() }
}

/// An angle that is not zero.
const ELSEWHERE_RAD: f64 = 0.1;
