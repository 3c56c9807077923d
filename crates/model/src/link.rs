//! Link between two pilots' controls: a compliant shaft with play and a breakout, or its image in two [feel computers](crate::electronic_link).
//!
//! `phi = theta_1 - r theta_2` angle of one control beyond the other · `r` ratio, 1 between two pilots · `k`, `c` stiffness and damping · `p`
//! play, full width · `M_b` breakout torque · `k_a` stiffness after it · `T` torque between them: `-T` on the first, `r T` on the second · `d`
//! delay from one control's sample to the other's feel computer · `c_i` largest damping that is injected · `F_p`, `F_d` hand forces for
//! priority and the dual-input cue · `I_m`, `B_m`, `G_m` of a body at the middle
//!
//! ```text
//! s = k (phi - clamp(phi, -p/2, p/2))
//! S = s                                          |s| <= M_b
//! S = sgn(s) (M_b + k_a (|s| - M_b) / k)         beyond
//! T = S + c phi'
//! ```
//!
//! `S` depends on the angle alone, so it is the slope of a potential: what is put into the spring comes back and no more, and the damper only
//! takes. It has no step, so none is felt where an override lets go or takes hold again, and both controls are aligned again when it has.
//! A clutch that slips would leave them apart. A link that uncouples at `M_b` stays open; the energy of its spring is lost to both.
//!
//! A body at the middle of the link, such as the surface that both pilots move, parts it into halves in series: each of `2 k`, `2 c`, `2 k_a` and `p / 2`,
//! which gives way at `M_b`, from the first control to the body and from the body to the second.

use crate::Scalar;
use crate::parameters::Parameter;
use crate::units::{self, Unit};

/// Rows of a link.
pub const LINK_ROWS: usize = 13;

/// The table of a link's parameters, in the order of its values; a row with `off_us` may be left out.
pub const LINK_TABLE: [Parameter; LINK_ROWS] = [
    row("stiffness", ("k", "stiffness of the link"), units::ROTARY_STIFFNESS, (2000.0, None), (1e-2, 1e7)),
    row("damping", ("c", "damping of the link"), units::ROTARY_DAMPING, (20.0, Some(0.0)), (0.0, 1e6)),
    row("play", ("p", "free play between the controls, full width"), units::ANGLE, (0.2, Some(0.0)), (0.0, 90.0)),
    row(
        "breakout",
        ("M_b", "torque above which the link gives way"),
        units::TORQUE,
        (1000.0, Some(f64::INFINITY)),
        (1e-2, 1e7),
    ),
    row(
        "stiffness_after",
        ("k_a", "stiffness after the breakout"),
        units::ROTARY_STIFFNESS,
        (500.0, Some(0.0)),
        (0.0, 1e7),
    ),
    row("delay", ("d", "delay of an electronic link, one way; 0: a period"), units::TIME, (1.0, Some(0.0)), (0.0, 1e3)),
    row(
        "injected_damping",
        ("c_i", "largest damping injected against the delay"),
        units::ROTARY_DAMPING,
        (50.0, Some(0.0)),
        (0.0, 1e6),
    ),
    row(
        "ratio",
        ("r", "angle of the first control for an angle of the second"),
        units::RATIO,
        (0.5, Some(1.0)),
        (-1e2, 1e2),
    ),
    row(
        "middle_inertia",
        ("I_m", "inertia of a body at the middle of the link"),
        units::INERTIA,
        (5.0, Some(0.0)),
        (0.0, 1e6),
    ),
    row(
        "middle_damping",
        ("B_m", "damping of the body at the middle"),
        units::ROTARY_DAMPING,
        (20.0, Some(0.0)),
        (0.0, 1e7),
    ),
    row(
        "middle_stiffness",
        ("G_m", "stiffness of the body at the middle, about zero"),
        units::ROTARY_STIFFNESS,
        (500.0, Some(0.0)),
        (0.0, 1e7),
    ),
    row(
        "priority_force",
        ("F_p", "hand force above which a pilot takes priority"),
        units::FORCE,
        (20.0, Some(f64::INFINITY)),
        (1e-2, 1e3),
    ),
    row(
        "dual_input_force",
        ("F_d", "force of each hand above which both are taken to put in"),
        units::FORCE,
        (2.0, Some(f64::INFINITY)),
        (1e-2, 1e3),
    ),
];

const fn row(
    name: &'static str,
    (symbol, meaning): (&'static str, &'static str),
    unit: Unit,
    (default_us, off_us): (f64, Option<f64>),
    (minimum_us, maximum_us): (f64, f64),
) -> Parameter {
    let (part, source, instead_of) = ("links", "illustrative", &[] as &[&str]);
    Parameter { part, name, symbol, meaning, unit, default_us, off_us, minimum_us, maximum_us, source, instead_of }
}

/// A link, SI units.
#[derive(Debug, Clone, Copy)]
pub struct PilotLink<S> {
    pub(crate) stiffness: S,
    damping: S,
    half_play: S,
    breakout: S,
    pub(crate) stiffness_after: S,
    pub(crate) injected_damping: S,
    pub(crate) ratio: S,
}

impl<S: Scalar> PilotLink<S> {
    /// From values in the order of [`LINK_TABLE`].
    #[inline(always)]
    pub fn from_values(
        &[stiffness, damping, play, breakout, stiffness_after, _delay, injected_damping, ratio, ..]: &[S; LINK_ROWS],
    ) -> Self {
        Self { stiffness, damping, half_play: play.times(0.5), breakout, stiffness_after, injected_damping, ratio }
    }

    /// The part of the link on each side of its middle: in series both are the link.
    pub fn half(&self) -> Self {
        let [stiffness, damping, stiffness_after] =
            [self.stiffness, self.damping, self.stiffness_after].map(|whole| whole.times(2.0));
        Self { stiffness, damping, stiffness_after, half_play: self.half_play.times(0.5), ..*self }
    }

    /// Angle and rate of the first control beyond the second, from those of both.
    #[inline(always)]
    pub fn beyond(&self, first: [S; 2], second: [S; 2]) -> [S; 2] {
        [first[0] - self.ratio * second[0], first[1] - self.ratio * second[1]]
    }

    /// What a torque between the controls is on each of them.
    #[inline(always)]
    pub fn on_each(&self, torque: S) -> [S; 2] {
        [-torque, self.ratio * torque]
    }

    /// What the spring would give without a breakout.
    #[inline(always)]
    fn elastic(&self, phi: S) -> S {
        self.stiffness * (phi - phi.within(self.half_play))
    }

    /// Torque in N m between the controls, from the angle and the rate of one beyond the other.
    #[inline(always)]
    pub fn torque(&self, [phi, rate]: [S; 2]) -> S {
        let elastic = self.elastic(phi);
        let held = elastic.within(self.breakout);
        // Zero, too, where the breakout is infinite.
        held + (elastic - held) * self.stiffness_after / self.stiffness + self.damping * rate
    }

    /// Fastest rate in rad/s of masses on the link, from the sum of their inverse inertias.
    pub fn rate(&self, per_inertia: S) -> S {
        (self.stiffness.max(self.stiffness_after) * per_inertia).sqrt().max(self.damping * per_inertia)
    }

    /// Whether the spring is beyond its breakout.
    #[inline(always)]
    pub fn gives_way(&self, phi: S) -> S::Mask {
        self.breakout.less(self.elastic(phi).abs())
    }
}

/// A body at the middle of a link, such as the surface that both pilots move: `I_m theta'' + B_m theta' + G_m theta = T`.
#[derive(Debug, Clone, Copy)]
pub struct Middle<S> {
    inertia: S,
    damping: S,
    stiffness: S,
}

impl<S: Scalar> PilotLink<S> {
    /// The link from SI values in the order of [`LINK_TABLE`], as `number` has them; with a body at its middle the half on each side of it, and the
    /// body.
    pub fn parted(values: &[f64; LINK_ROWS], number: impl Fn(f64) -> S) -> (Self, Option<Middle<S>>) {
        let whole = Self::from_values(&values.map(&number));
        let &[.., inertia, damping, stiffness, _, _] = values;
        let middle = Middle { inertia: number(inertia), damping: number(damping), stiffness: number(stiffness) };
        if inertia > 0.0 { (whole.half(), Some(middle)) } else { (whole, None) }
    }
}

impl<S: Scalar> Middle<S> {
    /// Where it rests between both controls at rest, its rate zero: the torque on it falls with its angle, which is halved in.
    pub fn resting(&self, half: &PilotLink<S>, controls: [S; 2]) -> [S; 2] {
        let mut between = Self::between(half, controls);
        for _ in 0..HALVINGS {
            between = self.halved(half, controls, between);
        }
        [between[0] + between[1], between[0].zero()].map(|twice| twice.times(0.5))
    }

    /// Two angles between which it rests.
    #[inline(always)]
    pub fn between(half: &PilotLink<S>, [first, second]: [S; 2]) -> [S; 2] {
        let (second, zero) = (half.ratio * second, first.zero());
        [first.min(second).min(zero), first.max(second).max(zero)]
    }

    /// The half of them in which it does.
    #[inline(always)]
    pub fn halved(&self, half: &PilotLink<S>, [first, second]: [S; 2], [low, high]: [S; 2]) -> [S; 2] {
        let (at, zero) = ((low + high).times(0.5), first.zero());
        let of_second = half.torque([at - half.ratio * second, zero]);
        let above = zero.less(half.torque([first - at, zero]) - of_second - self.stiffness * at);
        [S::select(above, at, low), S::select(above, high, at)]
    }

    /// Its inverse inertia.
    pub fn per_inertia(&self) -> S {
        self.inertia.constant(1.0) / self.inertia
    }

    /// Angle and rate a time `h` on, under a mean torque: the trapezoidal rule.
    #[inline(always)]
    pub fn advance(&self, [angle, rate]: [S; 2], h: S, torque: S) -> [S; 2] {
        let own = self.damping.times(0.5) + self.stiffness * h.times(0.25);
        let per = self.inertia / h;
        let end = (rate * (per - own) + torque - self.stiffness * angle) / (per + own);
        [angle + h.times(0.5) * (rate + end), end]
    }
}

/// Halvings that find where a middle rests, to the last bit of an angle.
pub const HALVINGS: usize = 60;

/// Which of two pilots has priority: by a button, else by a force above `F_p`, kept until it is below half of it.
#[derive(Debug, Clone, Copy)]
pub struct Priority<S: Scalar = f64> {
    takes: S,
    puts_in: S,
    /// Whether each pilot has it by force.
    pub by_force: [S::Mask; 2],
}

impl<S: Scalar> Priority<S> {
    /// From values in the order of [`LINK_TABLE`].
    pub fn from_values(&[.., takes, puts_in]: &[S; LINK_ROWS]) -> Self {
        Self { takes, puts_in, by_force: [takes.less(takes); 2] }
    }

    /// At a sample, from the force of each hand and who presses the button, the first before the second: who has priority.
    #[inline(always)]
    pub fn of_hands(&mut self, hands: [S; 2], pressed: [S::Mask; 2]) -> [S::Mask; 2] {
        let [first, second] = hands.map(S::abs);
        let above = |limit: S| [limit.less(first), limit.less(second)];
        let (held, taken) = (above(self.takes.times(0.5)), above(self.takes));
        let kept = [0, 1].map(|side: usize| self.by_force[side] & held[side]);
        let newly = !(kept[0] | kept[1]) & (taken[0] | taken[1]);
        let stronger = first.less(second);
        self.by_force = [kept[0] | newly & !stronger, kept[1] | newly & stronger];
        let by_force = self.by_force.map(|side| side & !(pressed[0] | pressed[1]));
        [pressed[0] | by_force[0], pressed[1] & !pressed[0] | by_force[1]]
    }

    /// Whether both pilots put in.
    #[inline(always)]
    pub fn dual_input(&self, hands: [S; 2]) -> S::Mask {
        let [first, second] = hands.map(|hand| self.puts_in.less(hand.abs()));
        first & second
    }
}
