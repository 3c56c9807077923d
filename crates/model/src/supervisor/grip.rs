//! What happens at the grip: force, its rate, speed, travel, and a column that runs away with no hand on it.
//!
//! `F` load cell · `theta`, `v` column angle and its rate · `tau` torque of the hand, estimated · `a_f` acceleration that
//! the feel gives the programmed control where no hand is on it · `w_o` bandwidth of the estimates
//!
//! | | |
//! |---|---|
//! | `F_g = alpha R_b F / R_p` | force of the drive at the grip, eq. (6) without motion |
//! | `tau = w_o (J v - int (alpha R_b F + tau) dt)` | hand's torque, a lag of what is missing in eq. (6) |
//! | `P = alpha R_b F v` | power that the drive gives to the column |
//! | `P_f = J a_f v` | the same of a free column that follows its feel, eqs. (6), (11) |
//!
//! With no hand on it a column gains speed only where its feel drives it. Where the feel brakes it, `P_f < 0`, and the drive does not
//! take half of that, `P > P_f / 2`, the column runs away: `|tau|` small for as long as the table has it. A valve stuck open is of
//! this kind, at constant speed too, where `P` is zero. What the dry friction or the weight of the column does looks like a hand.
//!
//! Estimate by the momentum, without the acceleration: De Luca and Mattone, ICRA 2005, 999-1004.

use super::debounce::Debounce;
use super::function::{CONFIRMED, Function, Functions};
use super::limits::{ESTIMATE_BANDWIDTH, Limits};
use super::numbers::below;
use super::sensors::Fresh;
use crate::Scalar;

/// What is known of the grip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GripEstimate<S> {
    /// Force of the drive at the grip in N; a hand that rests feels it.
    pub force: S,
    /// Force of the hand at the grip in N, estimated.
    pub hand_force: S,
    /// Angular velocity of the column in rad/s.
    pub rate: S,
}

/// What is remembered of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct GripMonitor<S> {
    last: Option<(S, S)>,
    /// `int (alpha R_b F + tau) dt`.
    impulse: S,
    torque: S,
    /// `v`, `alpha R_b F` and `a_f`, lagged as the hand's torque is.
    lagged: [S; 3],
    pub(super) grip: GripEstimate<S>,
    lasting: [Debounce; 4],
    force: Debounce,
    hand: Debounce,
    runaway: Debounce,
}

impl<S: Scalar> GripMonitor<S> {
    #[inline(always)]
    pub(super) fn new(like: S) -> Self {
        let zero = like.zero();
        Self {
            last: None,
            impulse: zero,
            torque: zero,
            lagged: [zero; 3],
            grip: GripEstimate { force: zero, hand_force: zero, rate: zero },
            lasting: [Debounce::default(); 4],
            force: Debounce::default(),
            hand: Debounce::default(),
            runaway: Debounce::default(),
        }
    }

    /// What is wrong at the grip; `follows`: the law is what moves it.
    #[inline(always)]
    pub(super) fn watch(
        &mut self,
        limits: &Limits<S>,
        Fresh { sensed: [force, _, angle], periods }: Fresh<S>,
        (follows, feel_acceleration): (bool, S),
        functions: &mut Functions,
    ) {
        let one = force.constant(1.0);
        let drive_torque = force * limits.lever;
        let grip_force = drive_torque * (one / limits.grip_arm);
        let (last_angle, last_force) = self.last.unwrap_or((angle, grip_force));
        self.last = Some((angle, grip_force));
        let per_periods = one / periods;
        let (moved, changed) = ((angle - last_angle) * per_periods, (grip_force - last_force) * per_periods);
        let rate = moved * (one / limits.period);
        self.estimate(limits, [rate, drive_torque, feel_acceleration], limits.period * periods);
        self.grip = GripEstimate { force: grip_force, hand_force: self.torque * (one / limits.grip_arm), rate };
        let above = |value: S, limit: S| below(limit, value.abs());
        let [low, high] = limits.travel;
        let beyond = below(angle, low) || below(high, angle);
        let now = [
            (Function::AbsoluteForce, above(grip_force, limits.absolute_force)),
            (Function::ForceRate, above(changed, limits.force_step)),
            (Function::Speed, above(moved, limits.speed_step)),
            (Function::Travel, beyond),
        ];
        for (lasting, (function, condition)) in self.lasting.iter_mut().zip(now) {
            *functions = functions.with(function, lasting.holds(condition, CONFIRMED));
        }
        let lasts = self.force.holds(above(grip_force, limits.force_limit), limits.force);
        // The sensors' noise may look like a hand for a sample, once in a hundred thousand; a hand stays for two.
        let hand = self.hand.holds(!below(self.torque.abs(), limits.hand_torque), CONFIRMED);
        let runs = self.runaway.holds(follows && !hand && self.runs_away(limits), limits.runaway_condition);
        *functions = functions.with(Function::Force, lasts).with(Function::Runaway, runs);
    }

    #[inline(always)]
    fn estimate(&mut self, limits: &Limits<S>, [rate, drive_torque, of_feel]: [S; 3], time: S) {
        // A step of the lag, no longer than it is.
        let share = time.times(ESTIMATE_BANDWIDTH).min(time.constant(1.0));
        for (lagged, value) in self.lagged.iter_mut().zip([rate, drive_torque, of_feel]) {
            *lagged = *lagged + (value - *lagged) * share;
        }
        self.impulse = self.impulse + (drive_torque + self.torque) * time;
        self.torque = (rate * limits.inertia - self.impulse) * (share / time);
    }

    #[inline(always)]
    fn runs_away(&self, limits: &Limits<S>) -> bool {
        let [rate, drive_torque, feel_acceleration] = self.lagged;
        let (power, of_feel) = (drive_torque * rate, (feel_acceleration * rate) * limits.inertia);
        below(of_feel, -limits.runaway_power) && below(of_feel.times(0.5), power)
    }
}
