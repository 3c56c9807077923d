//! A link in two feel computers: what each works out from its own control and from the other's of some periods before.
//!
//! `theta_1`, `theta_2` angles of the controls · `k` stiffness of the [link](crate::link) · `d` delay from one control's sample to the other's feel
//! computer · `h` period · `c_i` injected damping
//!
//! The torque is that of the link with the other control's angle of `d` before, held for a period `h`. By themselves delay and hold damp two
//! controls that move together by `k d`, and drive two that move apart by `k (d + h)`. So each angle is carried on along its last period, to the middle
//! of the hold:
//!
//! ```text
//! theta(t + h/2) ~ theta(t - d) + (d + h/2) (theta(t - d) - theta(t - d - h)) / h
//! ```
//!
//! What is left is of the second order in `d`. With `n = d / h`, `A(z) = 1 + (1 - 1/z) / 2`, `G(z) = z^-n (1 + (n + 1/2) (1 - 1/z))`, the energy that
//! delay and hold still give to controls that move together (`-`) and apart (`+`) is taken by a damping on each control of
//!
//! ```text
//! c_i >= k h max over w of  -Re{(1/z - 1) (A(z) -+ G(z))} / |z - 1|^2,   z = exp(j w h)
//! c_i  = k max(d + 2 h, 1.064 (d + h))
//! ```
//!
//! The sum is that of J. E. Colgate, G. G. Schenkel, J. Robotic Systems 14(1) (1997) 37-47, for two controls and a held torque; the second line is above it
//! for each `n` up to [`MOST_DELAY`]. Without the angles carried on it would be `k (d + h)`: the bound `k <= c / d` of E. Nuno, L. Basanez, R. Ortega,
//! Automatica 47(3) (2011) 485-495, with the hold.

use crate::Scalar;
use crate::link::{LINK_ROWS, Middle, PilotLink};

/// Place of the middle beside both controls.
const MIDDLE: usize = 2;

/// Most periods of delay of an electronic link.
pub const MOST_DELAY: usize = 255;

/// An electronic link: what each feel computer works out from its own control and from the other's of some periods before.
///
/// A body at its middle is worked out where the first control is; it and the second see each other after the delay. Each half of the link is
/// between it and a control then.
#[derive(Debug, Clone, Copy)]
pub struct ElectronicLink<S> {
    link: PilotLink<S>,
    middle: Option<Middle<S>>,
    delay: usize,
    /// Angle and rate of both controls at the last samples, and of the middle.
    past: [[[S; 2]; 3]; MOST_DELAY + 2],
    sample: usize,
}

impl<S: Scalar> ElectronicLink<S> {
    /// A link with SI values in the order of [its table](crate::link::LINK_TABLE), as `number` has them, and so many periods of delay, at most
    /// [`MOST_DELAY`]; with its middle if it has one.
    pub fn new(values: &[f64; LINK_ROWS], number: impl Fn(f64) -> S, delay: usize) -> Self {
        let (link, middle) = PilotLink::parted(values, number);
        let zero = link.stiffness.zero();
        Self { link, middle, delay: delay.min(MOST_DELAY), past: [[[zero; 2]; 3]; MOST_DELAY + 2], sample: 0 }
    }

    /// Remembers angle and rate of both controls and of the middle at samples of so many periods before the next one, of the middle at the next one, too.
    pub fn recall(&mut self, motions: impl Fn(usize) -> [[S; 2]; 3]) {
        let length = self.past.len();
        self.sample = length;
        for age in 0..=self.delay + 1 {
            self.past[(self.sample + length - age) % length] = motions(age);
        }
    }

    /// Angle and rate of the middle at the next sample; nothing without one.
    pub fn middle(&self) -> Option<[S; 2]> {
        self.middle.is_some().then(|| self.past[self.sample % self.past.len()][MIDDLE])
    }

    /// Of controls at rest at two angles: the angles between which the middle rests, and the half of two such angles in which it does.
    pub fn halved(&self, controls: [S; 2], between: [S; 2]) -> Option<[[S; 2]; 2]> {
        self.middle.map(|middle| [Middle::between(&self.link, controls), middle.halved(&self.link, controls, between)])
    }

    /// Whether it has seen nothing.
    #[inline(always)]
    pub fn is_new(&self) -> bool {
        self.sample == 0
    }

    /// At a sample each `h`, the controls having rested so before the first one, from angle and rate of both: of each feel computer angle and rate of
    /// the first control beyond the second, or of its control beyond the middle.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "at most MOST_DELAY periods")]
    pub fn sampled(&mut self, [first, second]: [[S; 2]; 2], h: S) -> [[S; 2]; 2] {
        let (length, link) = (self.past.len(), self.link);
        let now = self.sample % length;
        if self.is_new() {
            let resting = self.middle.map(|middle| middle.resting(&link, [first[0], second[0]]));
            self.past = [[first, second, resting.unwrap_or(first)]; MOST_DELAY + 2];
        }
        [self.past[now][0], self.past[now][1]] = [first, second];
        let carried = |of: usize, delay: usize| {
            let [then, before] = [delay, delay + 1].map(|back| self.past[(self.sample + length - back) % length][of]);
            [then[0] + (then[0] - before[0]).times(delay as f64 + 0.5), then[1]]
        };
        let seen = if let Some(middle) = self.middle {
            let (first, here) = (carried(0, 0), carried(MIDDLE, 0));
            let of_first = [first[0] - here[0], first[1] - here[1]];
            let of_second = link.beyond(here, carried(1, self.delay));
            let seen = [of_first, link.beyond(carried(MIDDLE, self.delay), carried(1, 0))];
            let torque = link.torque(of_first) - link.torque(of_second);
            self.past[(now + 1) % length][MIDDLE] = middle.advance(self.past[now][MIDDLE], h, torque);
            seen
        } else {
            let beyond = |delays: [usize; 2]| link.beyond(carried(0, delays[0]), carried(1, delays[1]));
            [beyond([0, self.delay]), beyond([self.delay, 0])]
        };
        self.sample += 1;
        seen
    }

    /// Damping in N m s/rad on the first control and on the second, against the delay and against the period `h` for which the torque is held.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "at most MOST_DELAY periods")]
    pub fn injected(&self, h: S) -> [S; 2] {
        let PilotLink { stiffness, stiffness_after, injected_damping, ratio, .. } = self.link;
        let periods = ((self.delay + 2) as f64).max(1.064 * (self.delay + 1) as f64);
        // With the steeper k, at most the row.
        let damping = (stiffness.max(stiffness_after) * h.times(periods)).min(injected_damping);
        [damping, ratio * ratio * damping]
    }

    /// The link.
    pub fn link(&self) -> &PilotLink<S> {
        &self.link
    }
}
