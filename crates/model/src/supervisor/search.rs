//! Finding the travel: the feel's neutral leads the column to one end stop, to the other, and back.
//!
//! `n` neutral · `F_g` force of the drive at the grip
//!
//! The law is what moves the column, with the share of its command that it starts with, so this serves every drive. A stop is where the
//! drive presses the grip with the search force; if the column's stops are known, it must be one of them.

use super::debounce::Debounce;
use super::limits::Limits;
use super::numbers::below;
use super::numbers::finite;
use crate::Scalar;

/// Samples for which a stop must be pressed.
const PRESSED: u32 = 10;
/// How far neutral may go beyond an end that is known, or from the middle where none is, in rad.
const FARTHEST_RAD: f64 = 1.6;

/// How far a search is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Found {
    /// It goes on.
    Searching,
    /// Both stops are found and the column is back.
    Both,
    /// There is something else.
    Other,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SearchPhase {
    Low,
    High,
    Back,
}

/// A search under way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search<S> {
    leg: SearchPhase,
    pub(super) neutral: S,
    pub(super) stops: [S; 2],
    pressed: Debounce,
}

impl<S: Scalar> Search<S> {
    /// From where the column is.
    #[inline(always)]
    pub(super) fn from(angle: S) -> Self {
        Self { leg: SearchPhase::Low, neutral: angle, stops: [angle; 2], pressed: Debounce::default() }
    }

    /// A sample further.
    #[inline(always)]
    pub(super) fn step(&mut self, limits: &Limits<S>, angle: S, grip_force: S) -> Found {
        let step = limits.search_step;
        let (end, way) = match self.leg {
            SearchPhase::Low => (0, -step),
            SearchPhase::High => (1, step),
            SearchPhase::Back => {
                let home = angle.zero().clamp(self.stops[0], self.stops[1]);
                let left = home - self.neutral;
                self.neutral = self.neutral + left.within(step);
                return if below(left.abs(), step) { Found::Both } else { Found::Searching };
            }
        };
        self.neutral = self.neutral + way;
        let pushes = below(limits.search_force, grip_force.times_sign(way));
        if self.pressed.holds(pushes, PRESSED) {
            let known = limits.stops[end];
            if finite(known) && !below((angle - known).abs(), limits.travel_margin) {
                return Found::Other;
            }
            self.stops[end] = angle;
            self.pressed = Debounce::default();
            self.neutral = angle;
            self.leg = if self.leg == SearchPhase::Low { SearchPhase::High } else { SearchPhase::Back };
        }
        let from = if finite(limits.stops[end]) { limits.stops[end].abs() } else { angle.zero() };
        if below(from + angle.constant(FARTHEST_RAD), self.neutral.abs()) { Found::Other } else { Found::Searching }
    }
}
