//! What a law does against something stiff: part of a law with an observer, as data.
//!
//! A law that makes the column follow the feel believes the column to be free. Where it is clamped or on a stop, the feel goes on while
//! the column cannot, the drive integrates the difference, and the loop swings. In contact the drive follows the feel instead, the feel
//! takes the load cell's torque, and it is damped:
//!
//! `x` position of the drive's end · `alpha R_b` its travel per radian · `F_c` load cell · `T_o` torque of the hand that the observer estimates ·
//! `m` share of the contact, 0 to 1 · `h` period
//!
//! | | |
//! |---|---|
//! | `e_c = k_x (alpha R_b (delta - b) - x) + k_v (alpha R_b delta' - x')` | command in contact |
//! | `b+ = b + (theta - delta) h / t_b`, with `m < 0.9` or the drive at its limit `b - b h / t_b` | stretch of the link and droop of the drive: a column that leaves the contact and stays near it rests where the feel does |
//! | `T_c = -alpha R_b F_c` | torque in contact |
//! | `e = e_o + m (e_c - e_o)`, `T = T_o + m (T_c - T_o)` | between free motion and contact |
//! | `delta'+ = delta' / (1 + m B_c h / I)`, at most `v_m / m` | damping, at the end of the feel's step, and a rate that the drive can follow |
//!
//! Torque and angle are smoothed alike. A swing is a change of the torque from beyond `T_min` on one side to beyond it on the other within
//! `t_q`, quicker than a hand; of a slow column from beyond `q`, since what known friction holds shows up to that, either way. A swing in
//! which the column followed the feel to 3 % of its way was a hand's, and so was such a push. Contact is one of
//!
//! - two swings in a row that grow, or in which the torque falls by more than `K_e` per radian that the column goes on: no arm is as stiff.
//!   A released column swings too, with its arm, its link or an observer that is off; it decays, and it is soft;
//! - sixteen turns of the torque in a row by more than `0.8 T_min`, as quick and as stiff: a hand that pushes on while the loop swings against a
//!   stop keeps the torque on one side, and a weak swing stays below `T_min`. Where an arm can cause the torque, thirty-two are required: a column
//!   that decays makes fewer. Of a slow column with known friction a turn exceeds `2.5 q`: one that friction holds and releases in turn under a
//!   slow hand causes smaller ones. Within 40 ms of the last turn, quicker than a hand, a turn counts from `T_r` on, and so does the first after
//!   a second. So a light feel swings in a firm arm: the arm's force is weak, and the column's own inertia drives the load cell. Of slower turns, up
//!   to `3 t_q` apart, a stiff one counts if the feel moved relative to the column by 0.3 of the column's way; any other subtracts half of one;
//! - four bounces in a row, each within 0.4 s of the last and on the same side: a push of less than `t_q` that turns the column round from beyond
//!   1 rad/s. So a light feel swings against a soft stop, and the column follows it as well as under a hand;
//! - sixteen slower swings in a row, up to `2 t_q`, as stiff, none weaker than the last: a heavy feel on a stiff spring;
//! - a torque against the motion that rises by more than `0.2 K_e` per radian and turns the feel round faster than the column, by 0.1 rad/s and
//!   with a power beyond `0.12 T_min` times 1 rad/s, while the column slows down and `m < 0.5`: it struck something. A stop takes the momentum
//!   of the whole column, which throws a feel of less inertia back, and the drive would throw the column after it. Under a hand the feel turns with
//!   the column;
//! - a push against the motion, shorter than `0.9 t_q`, that has risen by more than `K_e` per radian since it began and has fallen as stiffly, the
//!   column thrown back 1.6 times as fast as it came at most; or over within a third of `t_q`, and it has turned the motion: a feel that is
//!   heavier than the column. The push of another column over a shaft falls while the column turns, but rises along its way;
//! - where a force sensor at the grip drives the feel, which shows no stop of the column: feel and column at an end stop of the loader file, the
//!   hand pushing into it or the feel moving on. While that is so, the feel moves as the column.
//!
//! Then `m = 1`, and the feel stands where the drive stands, at rest. It is given back by motion away from the place of the contact alone:
//! farther from it than `theta_n / 5`, where no push has begun for 0.3 s, or one along the motion after a rest of the torque, and the torque has
//! not gone on falling as against a spring, `m` falls by `|theta'| h / theta_t` a period. A column that stays, comes back to the place, or
//! swings, has all of it. The torque from which it falls follows in 0.5 s, and the place within `theta_n` in 5 s.
//!
//! A column that is let go moves away slowly: `B_c` alone slows it, `B_c |delta'| > 2 |T|`. After 60 ms of that `m` falls to 0 in 0.2 s. A swing in
//! contact, whose torque is zero in turn, is never loose for as long.
//!
//! The feel is farther out than the column by `theta_l` at most, in contact or not: a column that follows is nearer, and a feel that runs on while
//! the drive is at its limit would come back with all the force of its spring.
//!
//! `T_p` peak of the torque of late: a side counts from `max(T_min, r T_p)` on, so that what the estimate swings beyond after a blow is
//! none.
//!
//! An oscillation above the band of the motion as the sign of an unstable contact: F. Dimeas, N. Aspragathos, IEEE Trans. Haptics 9
//! (2016). Damping raised at once and given back within what is safe: F. Ferraguti et al., Int. J. Robotics Research 38 (2019).

use crate::Scalar;
use crate::law_vector::quotient;
use crate::memory::MemoryVisitor;

/// Numbers of it, in the order of [`ContactLaw::take`]: `alpha R_b` in m, `k_x`, `k_v`, `B_c` in N m s/rad, `v_m` in rad/s, `T_r` and `T_min`
/// in N m, `K_e` in N m/rad, `t_q` in s, `theta_n` and `theta_t` in rad.
pub const CONTACT_NUMBERS: usize = 11;

/// Place of `T_min` among them, from the end: zero in a law that knows of no contact.
pub const THRESHOLD_FROM_END: usize = 5;

/// `r`.
const OF_PEAK: f64 = 0.3;

/// Growth from swing to swing that counts; what decays is left alone.
const GROWTH: f64 = 1.2;

/// Swings in a row.
const SWINGS: f64 = 2.0;

/// Longest time between two sides of a slow swing, in `t_q`, and its share of a quick one: sixteen in a row, none weaker than the last by more
/// than noise makes it.
const SLOW: f64 = 2.0;
const SLOW_SWING: f64 = 0.125;
const SLOW_GROWTH: f64 = 0.97;

/// Turns in a row of a torque that stays on one side: what decays has fewer; and how much of `T_min` is one. Of a torque estimated with noise
/// that is eight standard deviations; from six on, what the noise moves of a heavy feel turns too.
const TURNS: f64 = 16.0;
const TURN: f64 = 0.8;

/// Longest time in s between turns that count from `T_r` on: a hand shakes at up to 12 Hz.
const RIPPLE_S: f64 = 0.04;

/// Largest turn of the torque by stick-slip, over `q`: friction holds the column and releases it, so that it acts one way, then the other.
const STICK_SLIP: f64 = 2.5;

/// Share of the column's way by which the feel is apart from it at most where it follows. Of 240 settings of five loaders a hand that pushes with up
/// to 60 lb is then taken for contact in none at up to 2 Hz, in one at up to 3 Hz.
const FOLLOWS: f64 = 0.03;

/// Largest rate at which a stop throws a column back, of the rate before, with what the drive adds: a hand that taps one may do so faster. At 1.15
/// light columns that rub swing between stops.
const REBOUND: f64 = 1.6;

/// What a quick turn counts against something as soft as an arm: a swing that decays makes fewer than thirty-two, and no hand makes as many.
const SOFT_TURN: f64 = 0.5;

/// Longest time between two slow turns that count, in `t_q`, and the least motion of the feel relative to the column in one, as a share of the
/// column's way: the column follows a feel that a hand moves. A slow turn that does not count subtracts a soft one.
const SLOW_TURN: f64 = 3.0;
const APART: f64 = 0.3;

/// Between three bounces in a row and four, which are contact, and the longest time in s from one push to the next.
const BOUNCES: f64 = 3.5;
const BETWEEN_BOUNCES_S: f64 = 0.4;

/// `theta_l` in rad. In releases from the rule's angle the feel is ahead by 0.03 rad at most (`desktop-yoke`, its motor at its limit), of
/// the other loaders by 0.01.
pub const LEAD_RAD: f64 = 0.05;

/// Rate of the column in rad/s from which on a push may go against its motion. Slower are the noise of a column at rest, and stick-slip.
const MOVES_RAD_PER_S: f64 = 0.05;

/// Rate from which on it strikes something: 1 deg/s, twice its noise. A light feel under a gentle hand comes to a stop at 2 deg/s, and its drive would
/// throw it back from steel at 60.
const STRIKES_RAD_PER_S: f64 = 0.02;

/// A bounce turns the column round from beyond this rate in rad/s.
const FAST_RAD_PER_S: f64 = 1.0;

/// By how much in rad/s a feel turns round faster than a column that struck something.
const THROWN_RAD_PER_S: f64 = 0.1;

/// Power that does so, over `T_min` times 1 rad/s: a light column that strikes a soft stop causes less torque than `T_min`, and throws its feel all
/// the faster. An arm of such a column causes 0.1.
const THROWS: f64 = 0.12;

/// Share of `K_e` by which the torque rises per radian: an arm alone is softer, one that swings with its column looks stiffer.
const RISES: f64 = 0.2;

/// By how much in rad/s a column that struck something is slower than `BEFORE_S` ago, or by which share of that rate. A light one that swings with an
/// arm may still go faster.
const SLOWS_RAD_PER_S: f64 = 0.05;
const SLOWED: f64 = 0.5;

/// Time constant in s over which torque and angle are smoothed: long beside a sample, short beside the swings of a contact.
pub const SMOOTHING_S: f64 = 0.004;

/// Time constant in s of the rate before a push: it lags the torque, whose observer is not at once there.
const BEFORE_S: f64 = 0.008;

/// Share of its largest torque by which a blow falls: one about the threshold is none.
const DISTINCT: f64 = 0.5;

/// Longest push that is a blow, in `t_q`: half a period of the quickest hand is no shorter.
const BRIEF: f64 = 0.9;

/// Longest push that turns the motion, in `t_q`.
const SHORT: f64 = 1.0 / 3.0;

/// Factor on `T_min` while a bench signal moves the column beside the law: the observer takes what the machine is off by for a hand.
const BESIDE: f64 = 5.0;

/// Time constant of the peak, in `t_q`.
const PEAK_LASTS: f64 = 5.0;

/// Time in s without a new push, after which the torque has rested, as it has if its last turn was slower than `t_q`: then motion away, and a push
/// along it, give the contact back.
const SETTLED_S: f64 = 0.3;

/// `t_b` in s: long beside the drive's lag, so that this integral adds no phase where the contact's own loop crosses.
const OFFSET_S: f64 = 0.5;

/// Share of the contact below which the integral is given up: at rest away from the place, noise alone takes a little of the share.
const OFFSET_SHARE: f64 = 0.9;

/// Time constant in s of the place of the contact: long beside the time in which a column that was thrown back creeps to its stop again, which would be
/// motion away from a place that followed it.
const PLACE_S: f64 = 5.0;

/// Time constant in s of the torque there: longer than a swing, shorter than a hand leans on a stop.
const TORQUE_S: f64 = 0.5;

/// Distance from the place of the contact in `theta_n`, up to which a column is still there.
const HERE: f64 = 0.2;

/// Share of `K_e` by which the torque falls with the motion where the column is still held. In the softest clamp of an envelope it falls by a fifth.
const HELD: f64 = 0.05;

/// Least torque of the damping, over that of what touches, by which a column is loose; how long in s it has to be, and how long in s the contact then
/// takes to end.
const LOOSE: f64 = 2.0;
const LOOSE_S: f64 = 0.06;
const LET_GO_S: f64 = 0.2;

/// What a law does in contact.
#[derive(Debug, Clone, Copy)]
pub struct ContactLaw<S> {
    per_angle: S,
    stiffness: S,
    rate: S,
    damping: S,
    speed: S,
    ripple: S,
    threshold: S,
    environment: S,
    quick: S,
    /// One over the time constant of the peak, in 1/s.
    per_peak: S,
    /// `theta_n`.
    pub near: S,
    travel: S,
}

/// What is remembered of it from sample to sample.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactState<S> {
    /// Share of the contact, 0 to 1.
    pub share: S,
    /// Angle of the column in rad at which it was noticed last.
    pub place: S,
    /// Torque there in N m.
    place_torque: S,
    /// Torque without its noise in N m, and smoothed as the rate is.
    torque: S,
    torque_before: S,
    /// Angle smoothed likewise, in rad.
    angle: S,
    /// Rate of that angle in rad/s, smoothed once more.
    pub rate: S,
    /// How far the feel is beyond the column in rad, smoothed likewise.
    lead: S,
    /// Peak of the torque of late in N m.
    peak: S,
    /// Side to which the torque pushed last, -1, 0 or 1.
    side: S,
    /// Time since that push began, in s.
    since: S,
    /// Whether it lasts: 0 if not, 1 if it went against the motion when it began, else -0.5 in a swing, -1 if the torque had rested.
    push: S,
    /// Rate before it in rad/s.
    before: S,
    /// Angle in rad at which it began.
    began_angle: S,
    /// Largest torque of it in N m.
    extreme: S,
    /// Angle and lead there in rad.
    extreme_angle: S,
    extreme_lead: S,
    /// Largest torque of the push before, in N m.
    last: S,
    /// Swings in a row that count.
    swings: S,
    /// Direction in which the torque changes, -1 or 1, its extreme so far, angle and lead there, and the time in s since the last turn.
    direction: S,
    turn: S,
    turn_angle: S,
    turn_lead: S,
    since_turn: S,
    /// Turns in a row that count.
    turns: S,
    /// Bounces in a row, with the sign of their side.
    bounces: S,
    /// Angle in rad by which the command allows for the link's stretch and the drive's droop.
    pub offset: S,
    /// Time in s for which the column has been loose.
    loose: S,
}

/// What a sample counts for.
struct Counts<S: Scalar> {
    /// Whether something touches.
    noticed: S::Mask,
    share: S,
    /// Angle of the contact and torque there.
    place: [S; 2],
    swings: S,
    turns: S,
    bounces: S,
    loose: S,
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
    /// Nothing touches at an angle; the hand has pushed with `torque` for long.
    #[inline(always)]
    pub fn free(torque: S, angle: S) -> Self {
        let (zero, one) = (torque.zero(), torque.constant(1.0));
        Self {
            share: zero,
            place: angle,
            place_torque: torque,
            torque,
            torque_before: torque,
            angle,
            rate: zero,
            lead: zero,
            peak: torque.abs(),
            // Not the sign of a zero, which exported C does not keep.
            side: S::select(torque.less(zero), -one, one),
            since: one,
            push: -one,
            before: zero,
            began_angle: angle,
            extreme: torque,
            extreme_angle: angle,
            extreme_lead: zero,
            last: zero,
            swings: zero,
            direction: one,
            turn: torque,
            turn_angle: angle,
            turn_lead: zero,
            since_turn: one,
            turns: zero,
            bounces: zero,
            offset: zero,
            loose: zero,
        }
    }

    /// Visits each number.
    #[inline(always)]
    pub fn visit(&mut self, visitor: &mut impl MemoryVisitor<S>) {
        visitor.nonlinear("contact_share", &mut self.share);
        visitor.nonlinear("contact_place", &mut self.place);
        visitor.nonlinear("contact_place_torque", &mut self.place_torque);
        visitor.nonlinear("contact_torque", &mut self.torque);
        visitor.nonlinear("contact_torque_before", &mut self.torque_before);
        visitor.nonlinear("contact_angle", &mut self.angle);
        visitor.nonlinear("contact_rate", &mut self.rate);
        visitor.nonlinear("contact_lead", &mut self.lead);
        visitor.nonlinear("contact_peak", &mut self.peak);
        visitor.nonlinear("contact_side", &mut self.side);
        visitor.nonlinear("contact_since", &mut self.since);
        visitor.nonlinear("contact_push", &mut self.push);
        visitor.nonlinear("contact_before", &mut self.before);
        visitor.nonlinear("contact_began_angle", &mut self.began_angle);
        visitor.nonlinear("contact_extreme", &mut self.extreme);
        visitor.nonlinear("contact_extreme_angle", &mut self.extreme_angle);
        visitor.nonlinear("contact_extreme_lead", &mut self.extreme_lead);
        visitor.nonlinear("contact_last", &mut self.last);
        visitor.nonlinear("contact_swings", &mut self.swings);
        visitor.nonlinear("contact_direction", &mut self.direction);
        visitor.nonlinear("contact_turn", &mut self.turn);
        visitor.nonlinear("contact_turn_angle", &mut self.turn_angle);
        visitor.nonlinear("contact_turn_lead", &mut self.turn_lead);
        visitor.nonlinear("contact_since_turn", &mut self.since_turn);
        visitor.nonlinear("contact_turns", &mut self.turns);
        visitor.nonlinear("contact_bounces", &mut self.bounces);
        visitor.nonlinear("contact_offset", &mut self.offset);
        visitor.nonlinear("contact_loose", &mut self.loose);
    }
}

impl<S: Scalar> ContactLaw<S> {
    /// The numbers one after the other.
    #[inline(always)]
    pub fn take(mut next: impl FnMut() -> S) -> Self {
        let (per_angle, stiffness, rate, damping, speed) = (next(), next(), next(), next(), next());
        let (ripple, threshold, environment, quick) = (next(), next(), next(), next());
        let (near, travel) = (next(), next());
        let per_peak = quotient(quick.constant(1.0 / PEAK_LASTS), quick);
        Self {
            per_angle,
            stiffness,
            rate,
            damping,
            speed,
            ripple,
            threshold,
            environment,
            quick,
            per_peak,
            near,
            travel,
        }
    }

    /// A law that knows of no contact.
    #[inline(always)]
    pub fn none(zero: S) -> Self {
        Self::take(|| zero)
    }

    /// The contact after a sample at which the hand's torque is estimated as `torque`, and whether it begins at this one; `friction`:
    /// largest torque of known friction, `q`; `at_end`: whether the column is at an end stop that the torque does not show; `alone`: whether
    /// nothing is added to the command of which the observer, and so its torque, knows nothing.
    #[inline(always)]
    pub fn noticed(
        &self,
        (torque, friction): (S, Option<S>),
        ([column, feel, feel_rate], at_end, alone): ([S; 3], Option<S::Mask>, bool),
        was: ContactState<S>,
        [h, per_h]: [S; 2],
    ) -> (ContactState<S>, S::Mask) {
        let (zero, one) = (torque.zero(), torque.constant(1.0));
        let (now, now_rate) = self.smoothed(torque, [column, feel], &was, [h, per_h]);
        let ContactState { torque, angle, rate, lead, peak, .. } = now;

        // Stick-slip is slow; a swing against a spring is fastest halfway.
        let sticks = rate.abs().less(one.times(MOVES_RAD_PER_S));
        let beyond = |least: S, of_friction: S| least.max(S::select(sticks, of_friction, zero));
        let threshold = if alone { self.threshold } else { self.threshold.times(BESIDE) };
        let least = threshold.max(peak.times(OF_PEAK));
        let least = friction.map_or(least, |friction| beyond(least, friction));
        let pushes = least.less(torque.abs()) & zero.less(self.threshold);
        let lasted = zero.less(was.push.abs());
        let to_other_side = pushes & (torque * was.side).less(zero);
        let begins = to_other_side | (pushes & !lasted);
        let over = lasted & !pushes;
        let back = (was.turn - torque) * was.direction;
        let turn = threshold.times(TURN);
        let turn = if alone {
            let soon_or_first = was.since_turn.less(one.times(RIPPLE_S)) | !was.since_turn.less(one);
            S::select(soon_or_first & was.share.less(one.times(0.5)), self.ripple, turn)
        } else {
            turn
        };
        let turn = friction.map_or(turn, |friction| beyond(turn, friction.times(STICK_SLIP)));
        let turns_back = turn.less(back) & zero.less(self.threshold);
        let since = S::select(begins, zero, (was.since + h).min(one));
        let touches = zero.less(was.share);
        let thrown = self.throws_back(&now, [now_rate, (lead - was.lead) * per_h], threshold);
        // Alone, a run looks at each change for itself.
        let quiet = S::IN_LANES && {
            let changes = begins | over | turns_back | touches | thrown | !now.swings.less(one.times(SWINGS));
            !S::any(at_end.map_or(changes, |at_end| changes | at_end))
        };
        let counts = if quiet {
            let place = [was.place, was.place_torque];
            Counts {
                noticed: begins,
                share: was.share.max(zero),
                place,
                swings: now.swings,
                turns: was.turns,
                bounces: was.bounces,
                loose: zero,
            }
        } else {
            self.counts(
                &now,
                [
                    to_other_side,
                    over,
                    turns_back,
                    touches,
                    thrown,
                    begins & !was.since.less(one.times(BETWEEN_BOUNCES_S)),
                ],
                [now_rate, back, since],
                ([column, feel_rate], friction.unwrap_or(zero), at_end),
                h,
            )
        };

        let pushed = one.times_sign(torque);
        let side = S::select(begins, pushed, was.side);
        let larger = begins | (was.extreme * side).less(torque * side);
        let swings_on = was.since.less(one.times(SETTLED_S)) & zero.less(was.turns);
        let along = S::select(swings_on, one.times(-0.5), -one);
        let against = S::select((rate * pushed).less(-one.times(MOVES_RAD_PER_S)), one, along);
        let onward = turns_back | back.less(zero);
        let Counts { noticed, share, place: [place, place_torque], swings, turns, bounces, loose } = counts;
        let state = ContactState {
            share,
            place,
            place_torque,
            side,
            since,
            push: S::select(begins, against, S::select(pushes, was.push, zero)),
            before: S::select(begins, rate, was.before),
            began_angle: S::select(begins, angle, was.began_angle),
            extreme: S::select(larger, torque, was.extreme),
            extreme_angle: S::select(larger, angle, was.extreme_angle),
            extreme_lead: S::select(larger, lead, was.extreme_lead),
            last: S::select(to_other_side, was.extreme.abs(), was.last),
            swings,
            direction: S::select(turns_back, -was.direction, was.direction),
            turn: S::select(onward, torque, was.turn),
            turn_angle: S::select(onward, angle, was.turn_angle),
            turn_lead: S::select(onward, lead, was.turn_lead),
            since_turn: S::select(turns_back, zero, (was.since_turn + h).min(one)),
            turns,
            bounces,
            loose,
            ..now
        };
        (state, noticed & was.share.less(one.times(0.5)))
    }

    /// The state with what is smoothed of a sample, without swings that are too old, and the rate of the smoothed angle.
    #[inline(always)]
    fn smoothed(
        &self,
        torque: S,
        [column, feel]: [S; 2],
        was: &ContactState<S>,
        [h, per_h]: [S; 2],
    ) -> (ContactState<S>, S) {
        let (zero, one) = (torque.zero(), torque.constant(1.0));
        let [soon, later] = [SMOOTHING_S, BEFORE_S].map(|time| h.times(1.0 / time).min(one));
        let follow = |was: S, now: S, share: S| was + (now - was) * share;
        let (torque, angle) = (follow(was.torque, torque, soon), follow(was.angle, column, soon));
        let now_rate = (angle - was.angle) * per_h;
        // A heavy feel swings on a stiff spring as slowly as a hand can.
        let slow = was.since.less(self.quick.times(SLOW));
        let now = ContactState {
            torque,
            torque_before: follow(was.torque_before, torque, later),
            angle,
            rate: follow(was.rate, now_rate, later),
            lead: follow(was.lead, feel - column, soon),
            peak: torque.abs().max(was.peak * (one - h * self.per_peak)),
            swings: S::select(slow, was.swings, zero),
            ..*was
        };
        (now, now_rate)
    }

    /// Whether the column struck something that turns its feel round: a torque against its motion that still rises. `now_rate` is that of the
    /// smoothed angle, `lead_rate` of the feel relative to the column.
    #[inline(always)]
    fn throws_back(&self, now: &ContactState<S>, [now_rate, lead_rate]: [S; 2], threshold: S) -> S::Mask {
        let one = now_rate.constant(1.0);
        let throws = threshold.times(THROWS).less(now.torque * lead_rate)
            & one.zero().less(self.threshold)
            & now.share.less(one.times(0.5));
        // The way back, which the feel begins.
        let back = one.times_sign(now.torque);
        let turns_faster = one.times(THROWN_RAD_PER_S).less(lead_rate * back);
        let moves = (now.rate * back).less(-one.times(STRIKES_RAD_PER_S));
        let slows = one.times(SLOWS_RAD_PER_S).min(now.rate.abs().times(SLOWED)).less((now_rate - now.rate) * back);
        // While the torque rises from the one before, the column moves by its rate times this constant.
        let risen = (now.torque - now.torque_before) * back;
        let rises = (self.environment.times(RISES * BEFORE_S) * now.rate.abs()).less(risen);
        throws & turns_faster & moves & slows & rises
    }

    /// What a sample counts for where a push or a turn begins or ends, or something touches. `now` has the torque, angle, rate and peak of the sample
    /// and the swings that are not too old.
    #[inline(always)]
    fn counts(
        &self,
        now: &ContactState<S>,
        [to_other_side, over, turns_back, touches, thrown, began_late]: [S::Mask; 6],
        [now_rate, back, since]: [S; 3],
        ([column, feel_rate], friction, at_end): ([S; 2], S, Option<S::Mask>),
        h: S,
    ) -> Counts<S> {
        let (zero, one) = (h.zero(), h.constant(1.0));
        let &ContactState { torque, angle, rate, .. } = now;
        let quick = now.since.less(self.quick);
        let (fell, went) = (torque - now.extreme, angle - now.extreme_angle);
        let hard = (self.environment * went.abs()).less(fell.abs());
        let stiff = hard & !zero.less(fell * went);
        // Then the torque was a hand's, however little a heavy feel moves.
        let follows = (now.lead - now.extreme_lead).abs().less(went.abs().times(FOLLOWS));
        let swing = to_other_side & quick;
        let peak_before = now.extreme.abs();
        let counts = !follows & (stiff | !peak_before.less(now.last.times(GROWTH)));
        // A hand does not push harder each time.
        let slow_counts =
            !follows & stiff & now.last.times(SLOW_GROWTH).less(peak_before) & now.since.less(self.quick.times(SLOW));
        let swings = S::select(
            to_other_side,
            S::select(
                quick,
                S::select(counts, now.swings + one, zero),
                S::select(slow_counts, now.swings + one.times(SLOW_SWING), zero),
            ),
            now.swings,
        );
        let moves = one.times(STRIKES_RAD_PER_S);
        let rose = (self.environment * (now.extreme_angle - now.began_angle).abs()).less(peak_before);
        let blow = over & hard & rose & peak_before.times(DISTINCT).less(fell.abs());
        let (before, after) = (now.before * now.side, now_rate * now.side);
        let brief = now.since.less(self.quick.times(BRIEF));
        let fast_rebound = before.times(-REBOUND).less(after);
        let struck = blow & brief & stiff & !follows & !fast_rebound & zero.less(now.push);
        let turned = blow & now.since.less(self.quick.times(SHORT)) & before.less(-moves) & moves.less(after);
        // The torque of a mass goes with the angle.
        let turned_by = angle - now.turn_angle;
        let hard_turn = (self.environment * turned_by.abs()).less(back) & !(turned_by * now.direction).less(zero);
        let counted = now.turns + S::select(hard_turn, one, one.times(SOFT_TURN));
        // Of a slow turn the feel tells whether a hand made it.
        let apart = turned_by.abs().times(APART).less((now.lead - now.turn_lead).abs());
        let slow_turns = S::select(hard_turn & apart & !follows, counted, (now.turns - one.times(SOFT_TURN)).max(zero));
        let turned_soon = now.since_turn.less(self.quick.times(SLOW_TURN));
        let slow_turns = S::select(turned_soon, slow_turns, zero);
        let turns = S::select(turns_back, S::select(now.since_turn.less(self.quick), counted, slow_turns), now.turns);
        let fast = one.times(FAST_RAD_PER_S);
        let bounced = over & (quick & zero.less(now.push) & before.less(-fast) & moves.less(after));
        let in_a_row = one.times_sign(now.side) + S::select(zero.less(now.bounces * now.side), now.bounces, zero);
        let bounces = S::select(bounced, in_a_row, S::select(began_late, zero, now.bounces));
        let bounces_on = bounced & one.times(BOUNCES).less(bounces.abs());
        let turns_on = turns_back & !turns.less(one.times(TURNS));
        let noticed =
            !swings.less(one.times(SWINGS)) | bounces_on | turns_on | thrown | struck | turned | (swing & touches);
        let noticed = at_end.map_or(noticed, |at_end| noticed | at_end);

        // It follows a column that rests beside it, and a hand that leans on a stop, which changes the torque.
        let [follows_column, follows_torque] =
            [PLACE_S, TORQUE_S].map(|time| S::select(touches, h.times(1.0 / time).min(one), zero));
        let here = (column - now.place).abs().less(self.near);
        // Where the push was largest: a column that is thrown back has left the place before the push is over. A turn or a blow may be too weak for a
        // push, and the last push long over.
        let weak = thrown & !zero.less(now.push.abs());
        let largest = |of_turn, of_push, here| S::select(weak, here, S::select(turns_on, of_turn, of_push));
        let beside = now.place + S::select(here, (column - now.place) * follows_column, zero);
        let place = S::select(noticed, largest(now.turn_angle, now.extreme_angle, angle), beside);
        let place = at_end.map_or(place, |at_end| S::select(at_end, column, place));
        let settling = now.place_torque + (torque - now.place_torque) * follows_torque;
        let place_torque = S::select(noticed, largest(now.turn, now.extreme, torque), settling);

        let (from, near) = (column - place, self.near.times(HERE));
        let (gone, loose) = if S::any(touches) {
            let held = ((torque - place_torque + self.environment.times(HELD) * from) * from).less(zero);
            let away = near.less(from.abs()) & zero.less(rate * from);
            // A push after a rest is a hand's that takes the column away, not a swing.
            let settled = !since.less(one.times(SETTLED_S)) | !(-one).less(now.push);
            let leaves = away & !held & settled;
            // A rate without its noise, which would give the contact of a column at rest back.
            let by_way = S::select(leaves, rate.abs() * quotient(h, self.travel), zero);
            let slowed = (torque.abs() + friction).times(LOOSE).less((self.damping * feel_rate).abs());
            // By the column's rate: after a blow that of a light feel trembles.
            let loose = S::select(touches & slowed & zero.less(rate * from), now.loose + h, zero);
            let let_go = one.times(LOOSE_S).less(loose) & near.less(from.abs());
            (by_way.max(S::select(let_go, h.times(1.0 / LET_GO_S), zero)), loose)
        } else {
            (zero, zero)
        };
        let whole = noticed | (touches & from.abs().less(near));
        let share = S::select(whole, one, (now.share - gone).max(zero));
        Counts { noticed, share, place: [place, place_torque], swings, turns, bounces, loose }
    }

    /// Displacement of the feel at which the drive stands.
    #[inline(always)]
    pub fn where_drive_stands(&self, position: S) -> S {
        quotient(position, self.per_angle)
    }

    /// The feel no farther out than the column by `theta_l`.
    #[inline(always)]
    pub fn follow(&self, [delta, rate]: [S; 2], ([column, column_rate], neutral): ([S; 2], S)) -> [S; 2] {
        let (zero, most) = (delta.zero(), delta.constant(LEAD_RAD));
        let ahead = delta - column;
        let apart = most.less(ahead.abs()) & zero.less(self.threshold);
        if !S::any(apart) {
            return [delta, rate];
        }
        let lead = most.times_sign(ahead);
        // A hand that is stronger than the drive holds the column farther out than the feel.
        let cut = apart & zero.less(ahead * (delta - neutral));
        let onward = zero.less((rate - column_rate) * lead);
        // Exported C skips it as a whole in a period in which nothing is apart.
        [S::select(cut, column + lead, delta), S::select(cut & onward, column_rate, rate)]
    }

    /// What the command allows for after a sample at which the feel stands at an angle and the column at another, the command `beyond` what the
    /// drive can take.
    #[inline(always)]
    pub fn next_offset(&self, state: &ContactState<S>, [delta, column]: [S; 2], (beyond, h): (S, S)) -> S {
        let slow = h.times(1.0 / OFFSET_S).min(h.constant(1.0));
        // A hand stronger than the drive would wind the integral up, and the drive would throw the column as the hand lets go.
        let leaves = state.share.less(h.constant(OFFSET_SHARE)) | h.zero().less(beyond.abs());
        state.offset + S::select(leaves, -state.offset, column - delta) * slow
    }

    /// `T_c`.
    #[inline(always)]
    pub fn torque(&self, force: S) -> S {
        -self.per_angle * force
    }

    /// Command and torque at a sample, `free` those of free motion, `torque` that of contact, where the column rests so far beyond the drive.
    #[inline(always)]
    pub fn output(&self, [share, offset]: [S; 2], free: [S; 2], torque: S, inputs: &ContactInputs<S>) -> [S; 2] {
        let [delta, rate] = inputs.feel;
        let [position, speed] = inputs.position;
        let command = self.stiffness * (self.per_angle * (delta - offset) - position)
            + self.rate * (self.per_angle * rate - speed);
        [free[0] + share * (command - free[0]), free[1] + share * (torque - free[1])]
    }

    /// What damping and the drive's speed leave of the feel's rate after a period, `per_torque` one over its inertia.
    #[inline(always)]
    pub fn damped(&self, share: S, rate: S, per_torque: S, h: S) -> S {
        let one = rate.constant(1.0);
        let touches = rate.zero().less(share);
        if !S::any(touches) {
            return rate;
        }
        let fastest = self.speed / share;
        let damped = (rate / (one + share * (self.damping * per_torque * h))).min(fastest).max(-fastest);
        S::select(touches, damped, rate)
    }
}
