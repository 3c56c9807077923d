//! The states of a loader, and how it goes from one to another.
//!
//! ```text
//! off -> initializing -> passive <-> fading <-> active
//!  ^          |             |          |          |      any function that stops
//!  +-- acknowledged ------ tripped <---+----------+
//! ```
//!
//! To acknowledge does not start anything: after it the person must have requested off before the loader starts (ISO 13850, 4.1.4).

use super::function::{Action, Function};
use super::input::{RequestedMode, SupervisorInput};
use super::limits::Limits;
use super::numbers::below;
use super::power::Power;
use super::search::Search;
use crate::Logic;
use crate::logic::{Count, FunctionSet};
use crate::named::Named;

/// State of a loader.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SupervisorState {
    /// Without power.
    Off,
    /// Sensors are watched before there is power; then the drive is waited for, and the travel found, if that is asked for.
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

impl Named for SupervisorState {
    const ALL: &'static [Self] =
        &[Self::Off, Self::Initializing, Self::Passive, Self::Active, Self::Fading, Self::Tripped];

    fn name(self) -> &'static str {
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
pub(super) struct Sequence<S: Logic> {
    pub(super) state: S::Code<SupervisorState>,
    /// Share of the feel.
    pub(super) share: S,
    /// Column's angle where the feel began to come or to go.
    pub(super) anchor: S,
    comes: S::Mask,
    pub(super) enable: S::Mask,
    power: Power<S>,
    pub(super) tripped: S::Set,
    pub(super) cause: S::Code<Option<Function>>,
    pub(super) cut: S::Mask,
    /// Off has been requested since the loader was off.
    armed: S::Mask,
    /// The command has come to zero.
    at_zero: S::Mask,
    acknowledged: S::Mask,
    watched: S::Count,
    pub(super) search: Search<S>,
    /// Whether the end stops are found, and where.
    has_stops: S::Mask,
    stops: [S; 2],
    /// The loader has just been started.
    pub(super) started: S::Mask,
}

crate::logic::memory! {
    Sequence {
        code state;
        number share, anchor;
        flag comes, enable;
        part power;
        set tripped;
        code cause;
        flag cut, armed, at_zero, acknowledged;
        count watched;
        part search;
        flag has_stops;
        numbers stops;
        flag started;
    }
}

impl<S: Logic> Sequence<S> {
    pub(super) fn new(like: S) -> Self {
        let (no, zero) = (S::mask(false), like.zero());
        Self {
            state: S::code(SupervisorState::Off),
            share: zero,
            anchor: zero,
            comes: no,
            enable: no,
            power: Power::new(),
            tripped: S::Set::none(),
            cause: S::code(None),
            cut: no,
            armed: no,
            at_zero: S::mask(true),
            acknowledged: no,
            watched: S::Count::none(),
            search: Search::none(zero),
            has_stops: no,
            stops: [zero; 2],
            started: no,
        }
    }

    /// Whether the law moves the column.
    #[inline(always)]
    pub(super) fn follows(&self) -> S::Mask {
        self.is(SupervisorState::Active) | self.is(SupervisorState::Fading) | self.search.is_under_way()
    }

    #[inline(always)]
    pub(super) fn is(&self, state: SupervisorState) -> S::Mask {
        S::is(self.state, state)
    }

    /// The drive has no power any more.
    #[inline(always)]
    pub(super) fn disabled(&mut self) {
        (self.enable, self.at_zero) = (S::mask(false), S::mask(true));
    }

    /// The command has come to zero.
    #[inline(always)]
    pub(super) fn stopped(&mut self) {
        self.at_zero = S::mask(true);
        self.enable = self.enable & !(self.is(SupervisorState::Tripped) | self.is(SupervisorState::Off));
    }

    pub(super) fn found_stops(&self) -> (S::Mask, [S; 2]) {
        (self.has_stops, self.stops)
    }

    /// One sample further, at the column's angle under the drive's force at the grip.
    #[inline(always)]
    pub(super) fn step(
        &mut self,
        limits: &Limits<S>,
        input: &SupervisorInput<S>,
        (angle, grip_force): (S, S),
        functions: &mut S::Set,
    ) {
        S::section("sequence");
        let newly = input.acknowledge & !self.acknowledged;
        self.acknowledged = input.acknowledge;
        let was_off = self.is(SupervisorState::Off);
        self.power.watch(limits, input, self.enable, functions);
        if limits.travel_search {
            S::paths(&mut self.search, |search| search.step(limits, angle, grip_force));
            *functions = functions.with(Function::TravelSearch, self.search.blocked);
        }
        let (functions, stops) = (*functions, functions.stops());
        S::paths(self, |this| {
            this.before(limits, input, (functions, stops));
            this.go(limits, input, (newly, stops), angle);
        });
        self.started = was_off & self.is(SupervisorState::Initializing);
    }

    /// What ends a state, whatever it is for.
    #[inline(always)]
    fn before(&mut self, limits: &Limits<S>, input: &SupervisorInput<S>, (functions, stops): (S::Set, S::Mask)) {
        if limits.travel_search && S::holds(self.search.is_done) {
            (self.has_stops, self.stops) = (S::mask(true), self.search.stops);
            self.search.end();
            self.state = S::code(SupervisorState::Passive);
        }
        match S::which(self.state) {
            SupervisorState::Off => {}
            SupervisorState::Initializing | SupervisorState::Passive
                if S::holds(S::is(input.requested, RequestedMode::Off)) =>
            {
                self.off(S::mask(true));
            }
            _ if S::holds(stops) => self.trip(functions),
            _ => {}
        }
    }

    /// From state to state.
    #[inline(always)]
    fn go(&mut self, limits: &Limits<S>, input: &SupervisorInput<S>, (newly, stops): (S::Mask, S::Mask), angle: S) {
        let requested = |mode: RequestedMode| S::is(input.requested, mode);
        match S::which(self.state) {
            SupervisorState::Off => {
                self.armed = self.armed | requested(RequestedMode::Off);
                if S::holds(self.armed & !requested(RequestedMode::Off) & !stops & self.at_zero) {
                    self.state = S::code(SupervisorState::Initializing);
                    (self.watched, self.share) = (S::Count::none(), angle.zero());
                }
            }
            SupervisorState::Initializing => self.initialize(limits, angle),
            SupervisorState::Passive => {
                if S::holds(requested(RequestedMode::Active) & self.at_zero) {
                    self.state = S::code(SupervisorState::Fading);
                    (self.at_zero, self.share) = (S::mask(false), angle.zero());
                    (self.anchor, self.comes) = (angle, S::mask(true));
                }
            }
            SupervisorState::Active | SupervisorState::Fading => {
                self.fade(limits, requested(RequestedMode::Active), angle);
            }
            SupervisorState::Tripped => {
                if S::holds(newly & self.at_zero & !self.enable & !stops) {
                    (self.tripped, self.cause, self.cut) = (S::Set::none(), S::code(None), S::mask(false));
                    self.off(requested(RequestedMode::Off));
                }
            }
        }
    }

    #[inline(always)]
    fn off(&mut self, armed: S::Mask) {
        self.search.end();
        (self.state, self.armed) = (S::code(SupervisorState::Off), armed);
    }

    #[inline(always)]
    fn trip(&mut self, functions: S::Set) {
        if S::which(self.state) != SupervisorState::Tripped {
            self.cause = S::first(functions.stopping());
        }
        self.tripped = self.tripped.and(functions.stopping());
        self.cut = self.cut | functions.does(Action::Cut);
        self.search.end();
        self.state = S::code(SupervisorState::Tripped);
    }

    /// Sensors are watched for as long as one may be stuck, without power; then there is power, and once the drive acts it goes on.
    #[inline(always)]
    fn initialize(&mut self, limits: &Limits<S>, angle: S) {
        if S::holds(self.search.is_under_way()) {
            return;
        }
        self.watched = self.watched.next();
        if S::holds(!self.watched.at_least(limits.stuck)) {
            return;
        }
        self.enable = S::mask(true);
        if S::holds(!self.power.acted) {
            return;
        }
        if limits.travel_search {
            (self.search, self.at_zero) = (Search::from(angle), S::mask(false));
        } else {
            self.state = S::code(SupervisorState::Passive);
        }
    }

    #[inline(always)]
    fn fade(&mut self, limits: &Limits<S>, comes: S::Mask, angle: S) {
        let (step, one) = (limits.fade_step, self.share.constant(1.0));
        let whole = !below(self.share, one);
        let turns = (comes & !self.comes) | (self.comes & !comes);
        // A fade that turns round goes back on its way: neutral does not jump.
        self.anchor = S::select(turns & whole, angle, self.anchor);
        self.comes = comes;
        self.share = S::select(comes, self.share + step, self.share - step).clamp(step.zero(), one);
        let state = if S::holds(comes & !below(self.share, one)) {
            SupervisorState::Active
        } else if S::holds(!comes & !below(step.zero(), self.share)) {
            SupervisorState::Passive
        } else {
            SupervisorState::Fading
        };
        self.state = S::code(state);
    }
}
