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
use crate::Logic;
use crate::named::Named;

/// Samples for which a stop must be pressed.
const PRESSED: u32 = 10;
/// How far neutral may go beyond an end that is known, or from the middle where none is, in rad.
const FARTHEST_RAD: f64 = 1.6;

/// Where a search is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SearchPhase {
    /// There is none.
    None,
    /// On its way to the low stop.
    Low,
    /// To the high one.
    High,
    /// On its way back.
    Back,
}

impl Named for SearchPhase {
    const ALL: &'static [Self] = &[Self::None, Self::Low, Self::High, Self::Back];

    fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Low => "low",
            Self::High => "high",
            Self::Back => "back",
        }
    }
}

/// A search, if it is under way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Search<S: Logic> {
    phase: S::Code<SearchPhase>,
    pub(super) neutral: S,
    pub(super) stops: [S; 2],
    pressed: Debounce<S>,
    /// Both stops are found and the column is back.
    pub(super) is_done: S::Mask,
    /// There is something else.
    pub(super) blocked: S::Mask,
}

crate::logic::memory! { Search { code phase; number neutral; numbers stops; part pressed; flag is_done, blocked; } }

impl<S: Logic> Search<S> {
    /// Not under way.
    #[inline(always)]
    pub(super) fn none(angle: S) -> Self {
        Self {
            phase: S::code(SearchPhase::None),
            neutral: angle,
            stops: [angle; 2],
            pressed: Debounce::new(),
            is_done: S::mask(false),
            blocked: S::mask(false),
        }
    }

    /// From where the column is.
    #[inline(always)]
    pub(super) fn from(angle: S) -> Self {
        Self { phase: S::code(SearchPhase::Low), ..Self::none(angle) }
    }

    #[inline(always)]
    pub(super) fn is_under_way(&self) -> S::Mask {
        !S::is(self.phase, SearchPhase::None)
    }

    /// It is given up, or at its end.
    #[inline(always)]
    pub(super) fn end(&mut self) {
        self.phase = S::code(SearchPhase::None);
    }

    /// A sample further; decisions are taken.
    #[inline(always)]
    pub(super) fn step(&mut self, limits: &Limits<S>, angle: S, grip_force: S) {
        let step = limits.search_step;
        (self.is_done, self.blocked) = (S::mask(false), S::mask(false));
        let (end, way) = match S::which(self.phase) {
            SearchPhase::None => return,
            SearchPhase::Low => (0, -step),
            SearchPhase::High => (1, step),
            SearchPhase::Back => {
                let home = angle.zero().clamp(self.stops[0], self.stops[1]);
                let left = home - self.neutral;
                self.neutral = self.neutral + left.within(step);
                self.is_done = below(left.abs(), step);
                return;
            }
        };
        self.neutral = self.neutral + way;
        let pushes = below(limits.search_force, grip_force.times_sign(way));
        if S::holds(self.pressed.holds(pushes, PRESSED)) {
            let known = limits.stops[end];
            if finite(known) && S::holds(!below((angle - known).abs(), limits.travel_margin)) {
                self.blocked = S::mask(true);
                return;
            }
            self.stops[end] = angle;
            self.pressed = Debounce::new();
            self.neutral = angle;
            self.phase = S::code(if end == 0 { SearchPhase::High } else { SearchPhase::Back });
        }
        let from = if finite(limits.stops[end]) { limits.stops[end].abs() } else { angle.zero() };
        self.blocked = below(from + angle.constant(FARTHEST_RAD), self.neutral.abs());
    }
}
