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

use super::limits::{ESTIMATE_BANDWIDTH, Limits, MOST_DELAY};
use super::numbers::below;
use super::sensors::OF_LINK;
use crate::Logic;
use crate::logic::Count;
use crate::transducers::SENSORS;

/// Observer of drive, link and column.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plausibility<S: Logic> {
    /// Whether a sample has been used, and the readings of the last.
    pub(super) begun: S::Mask,
    last: [S; OF_LINK],
    /// `theta`, `v`, `tau`.
    column: [S; 3],
    /// `x`, `u`.
    drive: [S; 2],
    /// `F`, `F_b`.
    link: [S; 2],
    /// Force at the grip as sampled last, which nothing predicts.
    grip: S,
    /// Commands that went out, the last first.
    sent: [S; 1 + MOST_DELAY as usize],
    /// Periods since the last sample that the prediction has gone through.
    lost: S,
    /// By how much more than right behind a sample the prediction may be off.
    slack: S,
    /// Samples in a row in which each sensor was implausible.
    pub(super) wrong: [S::Count; OF_LINK],
    /// What the law is given; nothing unless `begun`.
    pub(super) readings: [S; SENSORS],
}

crate::logic::memory! {
    Plausibility {
        flag begun;
        numbers last, column, drive, link;
        number grip;
        numbers sent;
        number lost, slack;
        counts wrong;
        numbers readings;
    }
}

/// Slack where it begins: of a column at the speed limit, whose rate is not known, the filter's lag comes to six times what is plausible.
const SLACK_AT_FIRST: f64 = 10.0;

/// Slack where the column is at an end stop, of which nothing here knows: thrown at 3 rad/s against one of steel it comes to 1.5.
const SLACK_AT_STOP: f64 = 3.0;

impl<S: Logic> Plausibility<S> {
    #[inline(always)]
    pub(super) fn new(like: S) -> Self {
        let zero = like.zero();
        Self {
            begun: S::mask(false),
            last: [zero; OF_LINK],
            column: [zero; 3],
            drive: [zero; 2],
            link: [zero; 2],
            grip: zero,
            sent: [zero; 1 + MOST_DELAY as usize],
            lost: zero,
            slack: like.constant(SLACK_AT_FIRST),
            wrong: [S::Count::none(); OF_LINK],
            readings: [zero; SENSORS],
        }
    }

    /// The command that goes out for this sample.
    #[inline(always)]
    pub(super) fn sends(&mut self, e: S) {
        for k in (1..self.sent.len()).rev() {
            self.sent[k] = self.sent[k - 1];
        }
        self.sent[0] = e;
    }

    /// Finds the readings that the law is given: as sampled, so many periods behind those before, or as predicted where none arrived.
    /// There are none before the first sample.
    #[inline(always)]
    pub(super) fn admit(&mut self, limits: &Limits<S>, arrived: S::Mask, (sensors, periods): (&[S; SENSORS], S)) {
        S::section("plausibility");
        let one = periods.constant(1.0);
        let ahead = S::select(arrived, (periods - self.lost).max(one), one);
        // Nothing predicts so far ahead.
        let begins = arrived & (!self.begun | below(one.times(f64::from(limits.silence)), ahead));
        S::paths(self, |this| {
            if S::holds(begins) {
                this.begin(limits, sensors, periods);
            } else if S::holds(this.begun) {
                this.predict(limits, ahead);
                if S::holds(arrived) {
                    this.judge(limits, sensors);
                } else {
                    this.lost = this.lost + one;
                    this.readings = this.predicted(limits);
                }
            }
        });
    }

    /// Each reading against its prediction.
    #[inline(always)]
    fn judge(&mut self, limits: &Limits<S>, &[force, position, base, grip]: &[S; SENSORS]) {
        let y = [force, position, base / limits.base_arm];
        let slack = self.slack.max(force.constant(SLACK_AT_STOP));
        self.slack = S::select(limits.is_free(y[2]), self.slack, slack);
        let predicted = [self.link[0], self.drive[0], self.column[0]];
        let (mut used, mut plausible) = (y, [S::mask(true); OF_LINK]);
        for k in 0..OF_LINK {
            plausible[k] = !below(limits.plausible[k] * self.slack, (y[k] - predicted[k]).abs());
            self.wrong[k] = self.wrong[k].in_a_row(!plausible[k]);
            used[k] = S::select(plausible[k], y[k], predicted[k]);
        }
        self.correct(limits, [used[0] - predicted[0], used[1] - predicted[1], used[2] - predicted[2]]);
        (self.last, self.lost, self.grip) = (used, force.zero(), grip);
        let base = S::select(plausible[2], base, used[2] * limits.base_arm);
        self.readings = [used[0], used[1], base, grip];
    }

    #[inline(always)]
    fn predicted(&self, limits: &Limits<S>) -> [S; SENSORS] {
        [self.link[0], self.drive[0], self.column[0] * limits.base_arm, self.grip]
    }

    /// Where there is nothing to predict from: at rest, or with the rates of the two last samples.
    #[inline(always)]
    fn begin(&mut self, limits: &Limits<S>, sensors: &[S; SENSORS], periods: S) {
        let &[force, position, base, grip] = sensors;
        let (angle, zero) = (base / limits.base_arm, force.zero());
        let per_time = force.constant(1.0) / (limits.period * periods);
        let rate = |now: S, last: S| S::select(self.begun, (now - last) * per_time, zero);
        let rates = [rate(position, self.last[1]), rate(angle, self.last[2])];
        let [.., per_force] = limits.drive;
        self.column = [angle, rates[1], -(force * limits.lever)];
        self.drive = [position, rates[0] + per_force * force];
        let link_force = self.link_force(limits, rates[0] - limits.lever * rates[1]);
        self.link = [force, force - link_force];
        (self.begun, self.last, self.lost) = (S::mask(true), [force, position, angle], zero);
        (self.slack, self.wrong) = (force.constant(SLACK_AT_FIRST), [S::Count::none(); OF_LINK]);
        (self.grip, self.readings) = (grip, *sensors);
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
        let e = self.sent[limits.delay.min(MOST_DELAY) as usize];
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
