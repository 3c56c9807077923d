//! An electronic link from sample to sample: torque and damping on each feel, which pilot has priority, and how its share comes and goes.
//!
//! `s` share of the link · `s_1`, `s_2` shares of both feels · `T`, `c_i` torque and injected damping, see [`link`](crate::link) · `h` period · `t_f`
//! time in which a feel comes
//!
//! `s` goes to `s_1 s_2`, of an open link to 0, by at most `h / t_f` a period; each feel is given `s T` and the damping `s c_i`. `T` stays as it is once
//! a feel is gone, which jumps to its column then. So neither a start, a trip of one side, an opening nor a closing is felt as a step. A link that
//! uncouples at its breakout is open at once. The side with priority is given nothing, the other side all: either comes and goes over `t_f` too.

use crate::Scalar;
use crate::electronic_link::ElectronicLink;
use crate::link::{LINK_ROWS, Priority};

/// An electronic link between two feels.
#[derive(Debug, Clone, Copy)]
pub struct LinkedFeels<S: Scalar> {
    /// The angles that it has seen.
    pub electronic: ElectronicLink<S>,
    /// Who has priority by force.
    pub priority: Priority<S>,
    /// Whether it is open.
    pub open: S::Mask,
    /// Its share; that of both feels at its first sample.
    pub share: S,
    /// What each side is given of it: nothing where the side has priority.
    pub gains: [S; 2],
    /// Torque on each feel at a share of one.
    torques: [S; 2],
    uncouples: bool,
}

/// One side of a link at a sample.
#[derive(Debug, Clone, Copy)]
pub struct LinkedFeel<S: Scalar> {
    /// Angle and rate of its programmed control, in rad and rad/s.
    pub programmed: [S; 2],
    /// Share of its feel that is there, 0 to 1.
    pub share: S,
    /// Force of its hand in N.
    pub hand_force: S,
    /// Whether its pilot presses the priority button.
    pub presses: S::Mask,
    /// Whether it opens the link, which stays open.
    pub opens: S::Mask,
    /// Whether it closes the link.
    pub closes: S::Mask,
}

/// Times of a link.
#[derive(Debug, Clone, Copy)]
pub struct LinkTimes<S> {
    /// Period in s.
    pub period: S,
    /// Largest change of a share in a period.
    pub change: S,
}

impl<S: Scalar> LinkTimes<S> {
    /// `h / t_f`, at most all of it.
    pub fn new(period: S, fade_time: S) -> Self {
        Self { period, change: (period / fade_time).min(period.constant(1.0)) }
    }
}

/// What a link gives at a sample.
#[derive(Debug, Clone, Copy)]
pub struct LinkOutputs<S: Scalar> {
    /// Torque on each feel in N m.
    pub torques: [S; 2],
    /// Damping on each feel in N m s/rad.
    pub damping: [S; 2],
    /// Which pilot has priority.
    pub priority: [S::Mask; 2],
    /// Whether it is open or beyond its breakout.
    pub gives_way: S::Mask,
}

impl<S: Scalar> LinkedFeels<S> {
    /// From SI values in the order of its table, as `number` has them, with so many periods of delay, and the middle that it may have.
    pub fn new(values: &[f64; LINK_ROWS], number: impl Fn(f64) -> S, delay: usize, uncouples: bool) -> Self {
        let priority = Priority::from_values(&values.map(&number));
        let [zero, one] = [number(0.0), number(1.0)];
        let electronic = ElectronicLink::new(values, number, delay);
        Self { electronic, priority, open: zero.less(zero), share: one, gains: [one; 2], torques: [zero; 2], uncouples }
    }

    /// At a sample.
    #[inline(always)]
    pub fn sampled(&mut self, times: &LinkTimes<S>, sides: &[LinkedFeel<S>; 2]) -> LinkOutputs<S> {
        let [zero, one] = [times.period.zero(), times.period.constant(1.0)];
        let wanted = sides[0].share * sides[1].share;
        if self.electronic.is_new() {
            self.share = wanted;
        }
        let toward = |now: S, goal: S| now + (goal - now).within(times.change);
        let seen = self.electronic.sampled(sides.map(|side| side.programmed), times.period);
        let link = *self.electronic.link();
        let [first, second] = seen.map(|[phi, _]| link.gives_way(phi));
        self.open = self.open & !(sides[0].closes | sides[1].closes) | sides[0].opens | sides[1].opens;
        let share = self.share;
        self.share = toward(share, S::select(self.open, zero, wanted));
        if self.uncouples {
            let uncoupled = (first | second) & !self.open & zero.less(share);
            self.share = S::select(uncoupled, zero, self.share);
            self.open = self.open | uncoupled;
        }
        let priority = self.priority.of_hands(sides.map(|side| side.hand_force), sides.map(|side| side.presses));
        for side in 0..2 {
            let torque = link.on_each(link.torque(seen[side]))[side];
            self.torques[side] = S::select(zero.less(wanted), torque, self.torques[side]);
            self.gains[side] = toward(self.gains[side], S::select(priority[side], zero, one));
        }
        let injected = self.electronic.injected(times.period);
        let on = |side: usize, whole: S| self.gains[side] * self.share * whole;
        LinkOutputs {
            torques: [0, 1].map(|side| on(side, self.torques[side])),
            damping: [0, 1].map(|side| on(side, injected[side])),
            priority,
            gives_way: self.open | first,
        }
    }
}
