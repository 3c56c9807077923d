//! Each sensor against what the observer of drive, link and column predicts of it; what stands for a sample that is lost, late or wrong.
//!
//! `theta`, `v` column angle and rate · `tau` torque of the hand · `x` drive position · `u` its speed without load · `F` load cell · `F_b` what
//! the load cell shows beside the link's force · `e` command that acts · `a`, `b`, `d`, `g` of the drive · `s = x - alpha R_b theta`
//!
//! | | |
//! |---|---|
//! | `J v' = alpha R_b F + tau`, `tau' = 0` | eq. (6) |
//! | `u' = a e - b F - d u`, `x' = u - g F` | a valve's flow with its lag, eqs. (2) and (4); a motor's rotor |
//! | `F = k (s -+ b) + c s' + F_b`, `F_b' = 0` | eq. (9) |
//!
//! A step is one of implicit Euler, which is stable for any link; it is solved for `F` in closed form. Each reading corrects the states by
//! the gains of a critically damped tracking filter of the bandwidth `w_o`. A reading farther from its prediction than
//! [`Limits::plausible`] is not used: its prediction stands for it, for `bridge_time` at most. A lost sample is three such.

use super::limits::{ESTIMATE_BANDWIDTH, Limits};
use super::numbers::below;
use super::sensors::OF_LINK;
use crate::Scalar;
use crate::controller::CommandDelay;
use crate::transducers::SENSORS;

/// Observer of drive, link and column.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plausibility<S> {
    /// Readings of the sample that was used last.
    last: Option<[S; OF_LINK]>,
    /// `theta`, `v`, `tau`.
    column: [S; 3],
    /// `x`, `u`.
    drive: [S; 2],
    /// `F`, `F_b`.
    link: [S; 2],
    /// Force at the grip as sampled last, which nothing predicts.
    grip: S,
    commands: CommandDelay<S>,
    sample: usize,
    /// Periods since the last sample that the prediction has gone through.
    lost: S,
    /// By how much more than right behind a sample the prediction may be off.
    slack: S,
    /// Samples in a row in which each sensor was implausible.
    pub(super) wrong: [u32; OF_LINK],
}

/// Slack where it begins: of a column at the speed limit, whose rate is not known, the filter's lag comes to six times what is plausible.
const SLACK_AT_FIRST: f64 = 10.0;

impl<S: Scalar> Plausibility<S> {
    #[inline(always)]
    pub(super) fn new(like: S) -> Self {
        let zero = like.zero();
        Self {
            last: None,
            column: [zero; 3],
            drive: [zero; 2],
            link: [zero; 2],
            grip: zero,
            commands: CommandDelay::holding(zero),
            sample: 0,
            lost: zero,
            slack: like.constant(SLACK_AT_FIRST),
            wrong: [0; OF_LINK],
        }
    }

    /// The command that goes out for this sample.
    #[inline(always)]
    pub(super) fn sends(&mut self, e: S) {
        self.commands.send(self.sample, e);
        self.sample = self.sample.wrapping_add(1);
    }

    /// The readings that the law is given: as sampled, so many periods behind those before, or as predicted. Nothing before the first sample.
    #[inline(always)]
    pub(super) fn admit(&mut self, limits: &Limits<S>, sensed: Option<(&[S; SENSORS], S)>) -> Option<[S; SENSORS]> {
        let one = self.grip.constant(1.0);
        let (sensors, periods) = match (sensed, self.last) {
            (None, None) => return None,
            (None, Some(_)) => {
                self.predict(limits, one);
                self.lost = self.lost + one;
                return Some(self.readings(limits));
            }
            (Some((sensors, periods)), _) => (sensors, periods),
        };
        let &[force, position, base, grip] = sensors;
        let y = [force, position, base / limits.base_arm];
        self.grip = grip;
        let ahead = (periods - self.lost).max(one);
        if self.last.is_none() || below(one.times(f64::from(limits.silence)), ahead) {
            // Nothing predicts so far ahead.
            self.begin(limits, y, periods);
            return Some(*sensors);
        }
        self.predict(limits, ahead);
        let predicted = [self.link[0], self.drive[0], self.column[0]];
        let mut used = y;
        for k in 0..OF_LINK {
            let plausible = !below(limits.plausible[k] * self.slack, (y[k] - predicted[k]).abs());
            self.wrong[k] = if plausible { 0 } else { self.wrong[k].saturating_add(1) };
            used[k] = if plausible { y[k] } else { predicted[k] };
        }
        self.correct(limits, [used[0] - predicted[0], used[1] - predicted[1], used[2] - predicted[2]]);
        (self.last, self.lost) = (Some(used), one.zero());
        let taken = |k: usize, as_sampled: S, predicted: S| if self.wrong[k] == 0 { as_sampled } else { predicted };
        Some([taken(0, force, used[0]), taken(1, position, used[1]), taken(2, base, used[2] * limits.base_arm), grip])
    }

    #[inline(always)]
    fn readings(&self, limits: &Limits<S>) -> [S; SENSORS] {
        [self.link[0], self.drive[0], self.column[0] * limits.base_arm, self.grip]
    }

    /// Where there is nothing to predict from: at rest, or with the rates of the two last samples.
    #[inline(always)]
    fn begin(&mut self, limits: &Limits<S>, y: [S; OF_LINK], periods: S) {
        let [force, position, angle] = y;
        let zero = force.zero();
        let rates = match self.last {
            Some(last) => {
                let per_time = force.constant(1.0) / (limits.period * periods);
                [(position - last[1]) * per_time, (angle - last[2]) * per_time]
            }
            None => [zero; 2],
        };
        let [.., per_force] = limits.drive;
        self.column = [angle, rates[1], -(force * limits.lever)];
        self.drive = [position, rates[0] + per_force * force];
        let link_force = self.link_force(limits, rates[0] - limits.lever * rates[1]);
        self.link = [force, force - link_force];
        (self.last, self.lost, self.slack, self.wrong) = (Some(y), zero, force.constant(SLACK_AT_FIRST), [0; OF_LINK]);
    }

    /// `F - F_b` with drive and column as they are, `x' - alpha R_b v` being `rate`.
    #[inline(always)]
    fn link_force(&self, limits: &Limits<S>, rate: S) -> S {
        let [per_stiffness, half_play, damping_time] = limits.link;
        let stretch = self.drive[0] - limits.lever * self.column[0];
        (stretch - stretch.within(half_play) + damping_time * rate) / per_stiffness
    }

    /// Goes on by so many periods.
    #[inline(always)]
    fn predict(&mut self, limits: &Limits<S>, periods: S) {
        let one = periods.constant(1.0);
        let h = limits.period * periods;
        let e = self.commands.arriving(self.sample.wrapping_sub(1 + limits.delay as usize));
        let ([angle, rate, hand], [position, free]) = (self.column, self.drive);
        let [a, b, d, g] = limits.drive;
        let [per_stiffness, half_play, damping_time] = limits.link;
        // Rates without the link's force, and what they lose by a newton of it.
        let kept = one / (one + h * d);
        let rate_alone = rate + h * hand / limits.inertia;
        let free_alone = (free + h * a * e) * kept;
        let per_force = h * b * kept + g + h * limits.lever * limits.lever / limits.inertia;
        // (F - F_b) / k = s -+ b + (c / k) s', s' = free_alone - alpha R_b rate_alone - per_force F
        let opening = free_alone - limits.lever * rate_alone;
        let stretch = position - limits.lever * angle + h * opening;
        let pulled = stretch - stretch.within(half_play) + damping_time * opening + per_stiffness * self.link[1];
        let force = pulled / (per_stiffness + (h + damping_time) * per_force);
        let rate = rate_alone + h * limits.lever * force / limits.inertia;
        let free = free_alone - h * b * kept * force;
        self.column = [angle + h * rate, rate, hand];
        self.drive = [position + h * (free - g * force), free];
        self.link[0] = force;
        self.slack =
            self.slack * (one + (periods - one + self.lost.min(one)) * limits.period.times(ESTIMATE_BANDWIDTH));
    }

    /// Takes the differences from the prediction in.
    #[inline(always)]
    fn correct(&mut self, limits: &Limits<S>, [force, position, angle]: [S; OF_LINK]) {
        let one = force.constant(1.0);
        let [place, rate, acceleration] = limits.tracking;
        let add = |to: &mut S, what: S| *to = *to + what;
        add(&mut self.column[0], place * angle);
        add(&mut self.column[1], rate * angle);
        add(&mut self.column[2], acceleration * limits.inertia * angle);
        add(&mut self.drive[0], place * position);
        add(&mut self.drive[1], rate * position);
        let share = limits.period.times(BESIDE_BANDWIDTH).min(one);
        add(&mut self.link[1], share * force);
        self.slack = one + (self.slack - one) * (one - limits.period.times(ESTIMATE_BANDWIDTH)).max(one.zero());
    }
}

/// Of `F_b`, in rad/s: slow beside a load cell that turns its sign or sticks, quick beside offsets and the link's tolerance.
const BESIDE_BANDWIDTH: f64 = 50.0;
