//! What a law does against something stiff: part of a law with an observer, as data.
//!
//! A law that makes the column follow the feel believes the column to be free. Where it is clamped or on a stop, the feel goes on while
//! the column cannot, the drive integrates the difference, and the loop swings. In contact the drive follows the feel instead, the feel
//! hears the load cell, and it is damped:
//!
//! `x` position of the drive's end · `alpha R_b` its travel per radian · `F_c` load cell · `T_o` torque of the hand that the observer estimates ·
//! `m` share of the contact, 0 to 1 · `h` period
//!
//! | | |
//! |---|---|
//! | `e_c = k_x (alpha R_b delta - x) + k_v (alpha R_b delta' - x')` | command in contact |
//! | `T_c = -alpha R_b F_c` | torque in contact |
//! | `e = e_o + m (e_c - e_o)`, `T = T_o + m (T_c - T_o)` | between free motion and contact |
//! | `delta'+ = delta' / (1 + m B_c h / I)` | damping, at the end of the feel's step |
//!
//! Contact shows in what no hand does within less than `t_q`: the torque pushes to one side and to the other, or it pushes against the
//! motion and is gone, as where the column strikes a stop. Then `m = 1`, and the feel stands where the drive stands, at rest. It is given back by motion away from the place of the
//! contact alone: farther from it than `theta_n`, where no push has begun for `t_q`, `m` falls by `|theta'| h / theta_t` a period. A column
//! that stays, or comes back to the place, keeps it.
//!
//! `T_p` peak of the torque of late: a side counts from `max(T_min, r T_p)` on, so that what the estimate swings beyond after a blow is
//! none.
//!
//! An oscillation above the band of the motion as the sign of an unstable contact: F. Dimeas, N. Aspragathos, IEEE Trans. Haptics 9
//! (2016). Damping raised at once and given back within what is safe: F. Ferraguti et al., Int. J. Robotics Research 38 (2019).

use crate::Scalar;
use crate::law_vector::quotient;
use crate::memory::MemoryVisitor;

/// Numbers of it, in the order of [`ContactLaw::take`]: `alpha R_b` in m, `k_x`, `k_v`, `B_c` in N m s/rad, `T_min` in N m, `t_q` in s,
/// `theta_n` and `theta_t` in rad.
pub const CONTACT_NUMBERS: usize = 8;

/// Place of `T_min` among them, from the end: zero in a law that knows of no contact.
pub const THRESHOLD_FROM_END: usize = 4;

/// `r`.
const OF_PEAK: f64 = 0.3;

/// Rate of the column in rad/s from which on a push may go against its motion; the noise of a column at rest is slower.
const MOVES_RAD_PER_S: f64 = 0.05;

/// Time constant in s over which the estimate's noise is smoothed: long beside a sample, short beside the swings of a contact.
const SMOOTH_S: f64 = 0.004;

/// Time constant of the peak, in `t_q`.
const PEAK_LASTS: f64 = 5.0;

/// What a law does in contact.
#[derive(Debug, Clone, Copy)]
pub struct ContactLaw<S> {
    per_angle: S,
    stiffness: S,
    rate: S,
    damping: S,
    threshold: S,
    quick: S,
    near: S,
    travel: S,
}

/// What is remembered of it from sample to sample.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactState<S> {
    /// Share of the contact, 0 to 1.
    pub share: S,
    /// Angle of the column at which it began last, in rad.
    pub place: S,
    /// Side to which the torque pushed last, -1, 0 or 1.
    side: S,
    /// Time since that push began, in s.
    since: S,
    /// Whether it lasts: 0 if not, 1 if it went against the motion when it began, else -1.
    push: S,
    /// Peak of the torque of late in N m.
    peak: S,
    /// The torque without its noise, in N m.
    smooth: S,
}

/// What the law is told at a sample.
#[derive(Debug, Clone, Copy)]
pub struct ContactInputs<S> {
    /// Force of the load cell in N.
    pub force: S,
    /// Position of the drive's end in m, and its rate.
    pub position: [S; 2],
    /// Angle of the column in rad, and its rate.
    pub angle: [S; 2],
    /// Displacement of the feel in rad, and its rate.
    pub feel: [S; 2],
}

impl<S: Scalar> ContactState<S> {
    /// Nothing touches; the hand has pushed with `torque` for long.
    #[inline(always)]
    pub fn free(torque: S) -> Self {
        let (zero, one) = (torque.zero(), torque.constant(1.0));
        Self {
            share: zero,
            place: zero,
            side: one.times_sign(torque),
            since: one,
            push: -one,
            peak: torque.abs(),
            smooth: torque,
        }
    }

    /// Visits each number.
    #[inline(always)]
    pub fn visit(&mut self, visitor: &mut impl MemoryVisitor<S>) {
        let Self { share, place, side, since, push, peak, smooth } = self;
        visitor.nonlinear("contact_share", share);
        visitor.nonlinear("contact_place", place);
        visitor.nonlinear("contact_side", side);
        visitor.nonlinear("contact_since", since);
        visitor.nonlinear("contact_push", push);
        visitor.nonlinear("contact_peak", peak);
        visitor.nonlinear("contact_smooth", smooth);
    }
}

impl<S: Scalar> ContactLaw<S> {
    /// The numbers one after the other.
    #[inline(always)]
    pub fn take(mut next: impl FnMut() -> S) -> Self {
        let (per_angle, stiffness, rate, damping) = (next(), next(), next(), next());
        let (threshold, quick, near, travel) = (next(), next(), next(), next());
        Self { per_angle, stiffness, rate, damping, threshold, quick, near, travel }
    }

    /// A law that knows of no contact.
    #[inline(always)]
    pub fn none(zero: S) -> Self {
        Self::take(|| zero)
    }

    /// The contact after a sample at which the hand's torque is estimated as `torque`, and whether it begins at this one.
    #[inline(always)]
    pub fn noticed(
        &self,
        torque: S,
        [angle, rate]: [S; 2],
        state: ContactState<S>,
        h: S,
    ) -> (ContactState<S>, S::Mask) {
        let (zero, one) = (torque.zero(), torque.constant(1.0));
        let smooth = state.smooth + (torque - state.smooth) * h.times(1.0 / SMOOTH_S).min(one);
        let torque = smooth;
        let peak = torque.abs().max(state.peak - state.peak * quotient(h, self.quick).times(1.0 / PEAK_LASTS));
        let least = self.threshold.max(peak.times(OF_PEAK));
        let pushes = least.less(torque.abs()) & zero.less(self.threshold);
        let to_other_side = pushes & (torque * state.side).less(zero);
        let turned = to_other_side | (pushes & !zero.less(state.push.abs()));
        let struck = !pushes & zero.less(state.push);
        let noticed = (to_other_side | struck) & state.since.less(self.quick);
        let side = S::select(turned, one.times_sign(torque), state.side);
        let since = S::select(turned, zero, (state.since + h).min(self.quick));
        let against = S::select((rate.times_sign(torque)).less(-one.times(MOVES_RAD_PER_S)), one, -one);
        let push = S::select(turned, against, S::select(pushes, state.push, zero));
        let begins = noticed & state.share.less(one.times(0.5));
        let place = S::select(begins, angle, state.place);
        let (from, away) = (angle - place, rate * (angle - place));
        let moves = self.near.less(from.abs()) & zero.less(away) & !since.less(self.quick);
        let gone = S::select(moves, quotient((rate * h).abs(), self.travel), zero);
        let share = S::select(noticed, one, (state.share - gone).max(zero));
        (ContactState { share, place, side, since, push, peak, smooth }, begins)
    }

    /// Displacement of the feel at which the drive stands.
    #[inline(always)]
    pub fn where_drive_stands(&self, position: S) -> S {
        quotient(position, self.per_angle)
    }

    /// Command and torque at a sample, `free` those of free motion.
    #[inline(always)]
    pub fn output(&self, share: S, free: [S; 2], inputs: &ContactInputs<S>) -> [S; 2] {
        let apart = |k: usize| self.per_angle * inputs.feel[k] - inputs.position[k];
        let command = self.stiffness * apart(0) + self.rate * apart(1);
        let torque = -self.per_angle * inputs.force;
        [free[0] + share * (command - free[0]), free[1] + share * (torque - free[1])]
    }

    /// What the damping leaves of the feel's rate after a period, `per_torque` one over its inertia.
    #[inline(always)]
    pub fn damped(&self, share: S, rate: S, per_torque: S, h: S) -> S {
        let one = rate.constant(1.0);
        rate / (one + share * self.damping * per_torque * h)
    }
}
