//! The states of a loader, and how it goes from one to another.
//!
//! ```text
//! off -> initializing -> passive <-> fading <-> active
//!  ^          |             |          |          |      any function that stops
//!  +-- acknowledged ------ tripped <---+----------+
//! ```
//!
//! To acknowledge does not start anything: after it the person must have requested off before the loader starts (ISO 13850, 4.1.4).

use super::function::{Action, Function, Functions};
use super::input::{RequestedMode, SupervisorInput};
use super::limits::Limits;
use super::numbers::below;
use super::search::{Found, Search};
use crate::Scalar;

/// State of a loader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SupervisorState {
    /// Without power.
    Off,
    /// Sensors are watched before there is power; then the travel is found, if that is asked for.
    Initializing,
    /// Power, and a command of zero.
    Passive,
    /// The feel is there.
    Active,
    /// The feel comes or goes.
    Fading,
    /// A function stopped the loader.
    Tripped,
}

impl SupervisorState {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Initializing => "initializing",
            Self::Passive => "passive",
            Self::Active => "active",
            Self::Fading => "fading",
            Self::Tripped => "tripped",
        }
    }
}

/// Where a loader is in it.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::struct_excessive_bools, reason = "each holds by itself, in any of the states")]
pub(super) struct Sequence<S> {
    pub(super) state: SupervisorState,
    /// Share of the feel.
    pub(super) share: S,
    /// Column's angle where the feel began to come or to go.
    pub(super) anchor: S,
    comes: bool,
    pub(super) enable: bool,
    pub(super) tripped: Functions,
    pub(super) cause: Option<Function>,
    cut: bool,
    /// Off has been requested since the loader was off.
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
            state: SupervisorState::Off,
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
        matches!(self.state, SupervisorState::Active | SupervisorState::Fading) || self.search.is_some()
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
        if matches!(self.state, SupervisorState::Tripped | SupervisorState::Off) {
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
        input: &SupervisorInput<S>,
        (angle, grip_force): (S, S),
        functions: &mut Functions,
    ) -> bool {
        let newly = input.acknowledge && !self.acknowledged;
        self.acknowledged = input.acknowledge;
        let asked = self.state;
        if let Some(search) = &mut self.search {
            let outcome = search.step(limits, angle, grip_force);
            *functions = functions.with(Function::TravelSearch, outcome == Found::Other);
            if outcome == Found::Both {
                (self.stops, self.search, self.state) = (Some(search.stops), None, SupervisorState::Passive);
            }
        }
        if input.requested == RequestedMode::Off
            && matches!(self.state, SupervisorState::Initializing | SupervisorState::Passive)
        {
            self.off(true);
        }
        if !matches!(self.state, SupervisorState::Off) && !functions.stopping().is_empty() {
            self.trip(*functions);
        }
        match self.state {
            SupervisorState::Off => {
                self.armed |= input.requested == RequestedMode::Off;
                if self.armed
                    && input.requested != RequestedMode::Off
                    && functions.stopping().is_empty()
                    && self.at_zero
                {
                    (self.state, self.watched, self.share) = (SupervisorState::Initializing, 0, angle.zero());
                }
            }
            SupervisorState::Initializing => self.initialize(limits, angle),
            SupervisorState::Passive if input.requested == RequestedMode::Active && self.at_zero => {
                (self.state, self.at_zero, self.share) = (SupervisorState::Fading, false, angle.zero());
                (self.anchor, self.comes) = (angle, true);
            }
            SupervisorState::Active | SupervisorState::Fading => {
                self.fade(limits, input.requested == RequestedMode::Active, angle);
            }
            SupervisorState::Tripped if newly && self.at_zero && !self.enable && functions.stopping().is_empty() => {
                (self.tripped, self.cause, self.cut) = (Functions::NONE, None, false);
                self.off(input.requested == RequestedMode::Off);
            }
            SupervisorState::Passive | SupervisorState::Tripped => {}
        }
        asked == SupervisorState::Off && self.state == SupervisorState::Initializing
    }

    #[inline(always)]
    fn off(&mut self, armed: bool) {
        (self.state, self.search, self.armed) = (SupervisorState::Off, None, armed);
    }

    #[inline(always)]
    fn trip(&mut self, functions: Functions) {
        if self.state != SupervisorState::Tripped {
            self.cause = functions.stopping().first();
        }
        self.tripped = self.tripped.and(functions.stopping());
        self.cut |= !functions.that(Action::Cut).is_empty();
        (self.state, self.search) = (SupervisorState::Tripped, None);
    }

    /// Sensors are watched for as long as one may be stuck, without power; then there is power.
    #[inline(always)]
    fn initialize(&mut self, limits: &Limits<S>, angle: S) {
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
            self.state = SupervisorState::Passive;
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
            (true, false, _) => SupervisorState::Active,
            (false, _, false) => SupervisorState::Passive,
            _ => SupervisorState::Fading,
        };
    }
}
