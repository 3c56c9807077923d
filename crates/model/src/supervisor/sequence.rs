//! The states of a loader, and how it goes from one to another.
//!
//! ```text
//! off -> initialising -> passive <-> fading <-> active
//!  ^          |             |          |          |      any function that stops
//!  +-- acknowledged ------ tripped <---+----------+
//! ```
//!
//! To acknowledge does not start anything: after it the person must have wished for off before the loader starts (ISO 13850, 4.1.4).

use super::function::{Action, Function, Functions};
use super::limits::Limits;
use super::search::{Found, Search};
use super::{Told, below};
use crate::Scalar;

/// State of a loader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Without power.
    Off,
    /// Sensors are watched before there is power; then the travel is found, if that is asked for.
    Initialising,
    /// Power, and a command of zero.
    Passive,
    /// The feel is there.
    Active,
    /// The feel comes or goes.
    Fading,
    /// A function stopped the loader.
    Tripped,
}

impl State {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Initialising => "initialising",
            Self::Passive => "passive",
            Self::Active => "active",
            Self::Fading => "fading",
            Self::Tripped => "tripped",
        }
    }
}

/// What the person wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wish {
    /// No power.
    Off,
    /// Power without feel.
    Passive,
    /// Feel.
    Active,
}

/// Where a loader is in it.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_excessive_bools, reason = "each holds by itself, in any of the states")]
pub(super) struct Sequence<S> {
    pub(super) state: State,
    /// Share of the feel.
    pub(super) share: S,
    /// Column's angle where the feel began to come or to go.
    pub(super) anchor: S,
    comes: bool,
    pub(super) enable: bool,
    pub(super) tripped: Functions,
    pub(super) cause: Option<Function>,
    cut: bool,
    /// Off has been wished for since the loader was off.
    armed: bool,
    /// The command has come to zero.
    at_zero: bool,
    acknowledged: bool,
    watched: u32,
    search: Option<Search<S>>,
    stops: Option<[S; 2]>,
}

impl<S: Scalar> Sequence<S> {
    pub(super) fn new(like: S) -> Self {
        Self {
            state: State::Off,
            share: like.zero(),
            anchor: like.zero(),
            comes: false,
            enable: false,
            tripped: Functions::NONE,
            cause: None,
            cut: false,
            armed: false,
            at_zero: true,
            acknowledged: false,
            watched: 0,
            search: None,
            stops: None,
        }
    }

    /// Whether the law moves the column.
    #[inline(always)]
    pub(super) fn follows(&self) -> bool {
        matches!(self.state, State::Active | State::Fading) || self.search.is_some()
    }

    #[inline(always)]
    pub(super) fn is_cut(&self) -> bool {
        self.cut
    }

    /// The drive has no power any more.
    #[inline(always)]
    pub(super) fn disabled(&mut self) {
        (self.enable, self.at_zero) = (false, true);
    }

    /// The command has come to zero.
    #[inline(always)]
    pub(super) fn stopped(&mut self) {
        self.at_zero = true;
        if matches!(self.state, State::Tripped | State::Off) {
            self.enable = false;
        }
    }

    #[inline(always)]
    pub(super) fn leads(&self) -> Option<S> {
        self.search.map(|search| search.neutral)
    }

    pub(super) fn found_stops(&self) -> Option<[S; 2]> {
        self.stops
    }

    /// One sample further, at the column's angle under the drive's force at the grip; whether the loader has just been started.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        limits: &Limits<S>,
        told: &Told<S>,
        (angle, grip_force): (S, S),
        found: &mut Functions,
    ) -> bool {
        let newly = told.acknowledge && !self.acknowledged;
        self.acknowledged = told.acknowledge;
        let asked = self.state;
        if let Some(search) = &mut self.search {
            let outcome = search.step(limits, angle, grip_force);
            *found = found.with(Function::TravelSearch, outcome == Found::Other);
            if outcome == Found::Both {
                (self.stops, self.search, self.state) = (Some(search.stops), None, State::Passive);
            }
        }
        if told.wish == Wish::Off && matches!(self.state, State::Initialising | State::Passive) {
            self.off(true);
        }
        if !matches!(self.state, State::Off) && !found.stopping().is_empty() {
            self.trip(*found);
        }
        match self.state {
            State::Off => {
                self.armed |= told.wish == Wish::Off;
                if self.armed && told.wish != Wish::Off && found.stopping().is_empty() && self.at_zero {
                    (self.state, self.watched, self.share) = (State::Initialising, 0, angle.zero());
                }
            }
            State::Initialising => self.initialise(limits, angle),
            State::Passive if told.wish == Wish::Active && self.at_zero => {
                (self.state, self.at_zero, self.share) = (State::Fading, false, angle.zero());
                (self.anchor, self.comes) = (angle, true);
            }
            State::Active | State::Fading => self.fade(limits, told.wish == Wish::Active, angle),
            State::Tripped if newly && self.at_zero && !self.enable && found.stopping().is_empty() => {
                (self.tripped, self.cause, self.cut) = (Functions::NONE, None, false);
                self.off(told.wish == Wish::Off);
            }
            State::Passive | State::Tripped => {}
        }
        asked == State::Off && self.state == State::Initialising
    }

    #[inline(always)]
    fn off(&mut self, armed: bool) {
        (self.state, self.search, self.armed) = (State::Off, None, armed);
    }

    #[inline(always)]
    fn trip(&mut self, found: Functions) {
        if self.state != State::Tripped {
            self.cause = found.stopping().first();
        }
        self.tripped = self.tripped.and(found.stopping());
        self.cut |= !found.that(Action::Cut).is_empty();
        (self.state, self.search) = (State::Tripped, None);
    }

    /// Sensors are watched for as long as one may be stuck, without power; then there is power.
    #[inline(always)]
    fn initialise(&mut self, limits: &Limits<S>, angle: S) {
        if self.search.is_some() {
            return;
        }
        self.watched += 1;
        if self.watched < limits.stuck {
            return;
        }
        self.enable = true;
        if limits.travel_search {
            (self.search, self.at_zero) = (Some(Search::from(angle)), false);
        } else {
            self.state = State::Passive;
        }
    }

    #[inline(always)]
    fn fade(&mut self, limits: &Limits<S>, comes: bool, angle: S) {
        let whole = !below(self.share, self.share.constant(1.0));
        if comes != self.comes {
            // A fade that turns round goes back on its way: neutral does not jump.
            self.anchor = if whole { angle } else { self.anchor };
            self.comes = comes;
        }
        let step = limits.fade_step;
        let (zero, one) = (step.zero(), step.constant(1.0));
        self.share = (if comes { self.share + step } else { self.share - step }).clamp(zero, one);
        self.state = match (comes, below(self.share, one), below(zero, self.share)) {
            (true, false, _) => State::Active,
            (false, _, false) => State::Passive,
            _ => State::Fading,
        };
    }
}
