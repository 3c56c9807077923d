//! What happens at the grip: force, its rate, speed, travel, and a column that runs away with no hand on it.
//!
//! `F` load cell · `theta`, `v` column angle and its rate · `tau` torque of the hand, estimated · `a_f` acceleration that
//! the feel gives the programmed control where no hand is on it, `v_f` its rate · `w_o` bandwidth of the estimates
//!
//! | | |
//! |---|---|
//! | `F_g = alpha R_b F / R_p` | force of the drive at the grip, eq. (6) without motion |
//! | `tau = w_o (J v - int (alpha R_b F + tau) dt)` | hand's torque, a lag of what is missing in eq. (6) |
//! | `f = F_f v / (|v| + v_s)` | dry friction of the loader file against the motion |
//! | `P = (alpha R_b F - f) v` | power that the drive gives to the column beyond the friction |
//! | `s = min(1, I / J)` | share of a feel that is lighter than the column |
//! | `P_f = s J a_f v` | power that the feel gives to a free column, eqs. (6), (11) |
//!
//! What a hand is given by a column that moves otherwise than its feel, `E' = P_g - max(0, -tau v_f) - E / 1 s` with `P_g = -tau v`, no less than
//! zero, is a fault's: a law or a drive that pushes against it. A feel that is followed gives back what it was given. A column that is faster than
//! its feel, `J (v^2 - v_f^2) / 2` beyond `motion_limit`, would throw itself at the link when it is stopped.
//!
//! A column that swings with no hand on it from side to side by more than `swing_limit`, each time by nine tenths of the last, swings on for
//! good: a hand that kept it swinging, its own or another pilot's over a link, would have a tenth of the drive's torque.
//!
//! With no hand on it a column gains speed only where its feel drives it. Where the feel brakes it, `P_f < 0`, and the drive does not
//! take half of that, `P > P_f / 2`, the column runs away: `|tau + f|` small for as long as the table has it. A valve stuck open is of
//! this kind, at constant speed too, where `P` is zero. What an error of the friction
//! or the weight of the column does looks like a hand.
//!
//! Estimate by the momentum, without the acceleration: De Luca and Mattone, ICRA 2005, 999-1004.

use super::debounce::Debounce;
use super::function::{CONFIRMED, Function};
use super::limits::{ESTIMATE_BANDWIDTH, Limits};
use super::numbers::below;
use super::sensors::Fresh;
use crate::Logic;
use crate::logic::{Count, FunctionSet};

/// What is known of the grip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GripEstimate<S> {
    /// Force of the drive at the grip in N; a hand that rests feels it.
    pub force: S,
    /// Force of the hand at the grip in N, estimated.
    pub hand_force: S,
    /// Angular velocity of the column in rad/s.
    pub rate: S,
    /// Energy in J that the hand is given otherwise than by the feel.
    pub energy: S,
}

/// How the feel moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct FeelMotion<S: Logic> {
    /// Whether the law is what moves the column.
    pub follows: S::Mask,
    /// Acceleration with no hand on it, in rad/s².
    pub acceleration: S,
    /// In rad/s.
    pub rate: S,
    /// Of electronic links, in N m.
    pub link_torque: S,
}

/// What is remembered of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct GripMonitor<S: Logic> {
    /// Whether there was a sample before; its angle and force.
    begun: S::Mask,
    last: [S; 2],
    /// `int (alpha R_b F + tau) dt`.
    impulse: S,
    torque: S,
    /// `v`, `alpha R_b F`, `a_f` and `v_f`, lagged as the hand's torque is.
    lagged: [S; 4],
    /// Changes of angle and force in the period before.
    changes: [S; 2],
    energy: S,
    swing: Swing<S>,
    pub(super) grip: GripEstimate<S>,
    lasting: [Debounce<S>; 2],
    force: Debounce<S>,
    hand: Debounce<S>,
    runaway: Debounce<S>,
    gives: Debounce<S>,
}

crate::logic::memory! { GripEstimate { number force, hand_force, rate, energy; } }
crate::logic::memory! {
    GripMonitor {
        flag begun;
        numbers last;
        number impulse, torque;
        numbers lagged, changes;
        number energy;
        part swing, grip;
        parts lasting;
        part force, hand, runaway, gives;
    }
}

impl<S: Logic> GripMonitor<S> {
    #[inline(always)]
    pub(super) fn new(like: S) -> Self {
        let zero = like.zero();
        Self {
            begun: S::mask(false),
            last: [zero; 2],
            impulse: zero,
            torque: zero,
            lagged: [zero; 4],
            changes: [zero; 2],
            energy: zero,
            swing: Swing { turned_at: zero, last: zero, torques: [zero; 2], undamped: S::Count::none() },
            grip: GripEstimate { force: zero, hand_force: zero, rate: zero, energy: zero },
            lasting: [Debounce::new(); 2],
            force: Debounce::new(),
            hand: Debounce::new(),
            runaway: Debounce::new(),
            gives: Debounce::new(),
        }
    }

    /// `alpha R_b F`, lagged as the hand's torque is.
    #[inline(always)]
    pub(super) fn drive_torque(&self) -> S {
        self.lagged[1]
    }

    /// What is wrong at the grip.
    #[inline(always)]
    pub(super) fn watch(
        &mut self,
        limits: &Limits<S>,
        Fresh { sensed: [force, _, angle], periods }: Fresh<S>,
        FeelMotion { follows, acceleration: feel_acceleration, rate: feel_rate, link_torque }: FeelMotion<S>,
        functions: &mut S::Set,
    ) {
        S::section("grip");
        let one = force.constant(1.0);
        let drive_torque = force * limits.lever;
        let grip_force = drive_torque * (one / limits.grip_arm);
        let last = |k: usize, now: S| S::select(self.begun, self.last[k], now);
        let (last_angle, last_force) = (last(0, angle), last(1, grip_force));
        (self.begun, self.last) = (S::mask(true), [angle, grip_force]);
        let per_periods = one / periods;
        let (moved, changed) = ((angle - last_angle) * per_periods, (grip_force - last_force) * per_periods);
        let rate = moved * (one / limits.period);
        self.estimate(limits, [rate, drive_torque, feel_acceleration, feel_rate], limits.period * periods);
        // At an end stop the stop's torque is in that of the hand.
        let energy = self.given(limits, follows & limits.is_free(angle), limits.period * periods);
        self.grip = GripEstimate { force: grip_force, hand_force: self.torque * (one / limits.grip_arm), rate, energy };
        let above = |value: S, limit: S| below(limit, value.abs());
        let [low, high] = limits.travel;
        let beyond = below(angle, low) | below(high, angle);
        let now = [(Function::AbsoluteForce, above(grip_force, limits.absolute_force)), (Function::Travel, beyond)];
        for (lasting, (function, condition)) in self.lasting.iter_mut().zip(now) {
            *functions = functions.with(function, lasting.holds(condition, CONFIRMED));
        }
        // In both of two samples, and the same way: to and fro, as a spike has it, is no motion.
        let [last_moved, last_changed] = self.changes;
        self.changes = [moved, changed];
        let fast = |now: S, last: S, most: S| {
            let way = now.constant(1.0).times_sign(now);
            below(most, now * way) & below(most, last * way)
        };
        *functions = functions
            .with(Function::Speed, fast(moved, last_moved, limits.speed_step))
            .with(Function::ForceRate, fast(changed, last_changed, limits.force_step));
        let lasts = self.force.holds(above(grip_force, limits.force_limit), limits.force);
        // The sensors' noise may look like a hand for a sample, once in a hundred thousand; a hand stays for two.
        // What the column's inertia shows is the hand's torque less the friction's.
        let hand = self.torque + self.friction(limits);
        let hand = self.hand.holds(!below(hand.abs(), limits.hand_torque), CONFIRMED);
        let runs = self.runaway.holds(follows & !hand & self.runs_away(limits), limits.runaway_condition);
        let moves = self.torque.abs().max(link_torque.abs());
        let swings = self.swing.goes_on(limits, (angle, self.lagged[0]), [moves, self.lagged[1]]);
        let too_much = below(limits.energy[0], energy) | (follows & self.thrown(limits));
        let gives = self.gives.holds(too_much, CONFIRMED);
        *functions = functions
            .with(Function::Force, lasts)
            .with(Function::Runaway, runs)
            .with(Function::Energy, gives)
            .with(Function::Swing, follows & swings);
    }

    #[inline(always)]
    fn estimate(&mut self, limits: &Limits<S>, [rate, drive_torque, of_feel, feel_rate]: [S; 4], time: S) {
        // A step of the lag, no longer than it is.
        let share = time.times(ESTIMATE_BANDWIDTH).min(time.constant(1.0));
        for (lagged, value) in self.lagged.iter_mut().zip([rate, drive_torque, of_feel, feel_rate]) {
            *lagged = *lagged + (value - *lagged) * share;
        }
        self.impulse = self.impulse + (drive_torque + self.torque) * time;
        self.torque = (rate * limits.inertia - self.impulse) * (share / time);
    }

    /// Torque of dry friction against the motion, which the drive has to give as well.
    #[inline(always)]
    fn friction(&self, limits: &Limits<S>) -> S {
        let [rate, ..] = self.lagged;
        limits.friction * rate / (rate.abs() + rate.constant(SLOW_RAD_PER_S))
    }

    #[inline(always)]
    fn runs_away(&self, limits: &Limits<S>) -> S::Mask {
        let [rate, drive_torque, feel_acceleration, _] = self.lagged;
        let power = (drive_torque - self.friction(limits)) * rate;
        let of_feel = feel_acceleration * rate * limits.inertia * limits.light_feel;
        let of_hand = (self.torque * rate).max(rate.zero()) * (rate.constant(1.0) - limits.light_feel);
        below(of_feel, -limits.runaway_power) & below((of_feel + of_hand).times(0.5), power * limits.light_feel)
    }

    /// Whether the column is faster than its feel by too much.
    #[inline(always)]
    fn thrown(&self, limits: &Limits<S>) -> S::Mask {
        let [rate, .., feel_rate] = self.lagged;
        below(limits.motion, (rate * rate - feel_rate * feel_rate) * limits.inertia.times(0.5))
    }

    /// What the hand is given otherwise than by the feel, while that is known.
    #[inline(always)]
    fn given(&mut self, limits: &Limits<S>, known: S::Mask, time: S) -> S {
        let [_, forgets] = limits.energy;
        let [rate, .., feel_rate] = self.lagged;
        let zero = time.zero();
        let of_feel = (-(self.torque * feel_rate)).max(zero);
        let power = S::select(known, -(self.torque * rate) - of_feel, zero);
        self.energy = (self.energy + power * time - self.energy * forgets).max(zero);
        self.energy
    }
}

/// A column that swings from side to side.
#[derive(Debug, Clone, Copy)]
struct Swing<S: Logic> {
    /// Angle at which it turned last, and by how much it had moved to there.
    turned_at: S,
    last: S,
    /// Largest torque of the hands and of the drive since it turned.
    torques: [S; 2],
    /// Swings in a row of nearly the same size.
    undamped: S::Count,
}

crate::logic::memory! { Swing { number turned_at, last; numbers torques; count undamped; } }

/// `v_s`: a column that runs away is faster.
const SLOW_RAD_PER_S: f64 = 0.01;
/// Share of a swing by which the next is undamped, of a damping ratio below 0.034; and how many such are no accident.
const UNDAMPED: f64 = 0.9;
const SWINGS: u32 = 3;
/// Share of the drive's torque that a hand has which keeps a column swinging: twice its damping ratio, and that not the smallest.
const KEEPS_SWINGING: f64 = 0.1;

impl<S: Logic> Swing<S> {
    /// At an angle, with its lagged rate, under these torques of hands and drive.
    #[inline(always)]
    fn goes_on(&mut self, limits: &Limits<S>, (angle, lagged): (S, S), torques: [S; 2]) -> S::Mask {
        for (most, torque) in self.torques.iter_mut().zip(torques) {
            *most = most.max(torque.abs());
        }
        // It turns where its lagged rate, which noise does not turn, changes its sign.
        let moved = angle - self.turned_at;
        let turns = below(moved * lagged, lagged.zero()) & below(limits.swing.times(TURNS), moved.abs());
        S::paths(self, |this| {
            if S::holds(turns) {
                let [hand, drive] = this.torques;
                let alone = below(hand, limits.hand_torque.min(drive.times(KEEPS_SWINGING)));
                let large = !below(moved.abs(), limits.swing);
                let kept = !below(moved.abs(), this.last.times(UNDAMPED));
                this.undamped = this.undamped.in_a_row(large & kept & alone);
                (this.turned_at, this.last, this.torques) = (angle, moved.abs(), [angle.zero(); 2]);
            }
        });
        let goes_on = self.undamped.at_least(SWINGS);
        self.undamped = self.undamped.only(!goes_on);
        goes_on
    }
}

/// Share of the swing that is watched which noise does not come to.
const TURNS: f64 = 0.1;
