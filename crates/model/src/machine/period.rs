//! The loader under a digital controller, from one period to the next: its state as a list of numbers.
//!
//! A period is a function of these numbers, of the pilot's force and of signals on the command and at the amplifier, so dual numbers
//! give the matrices of the sampled loop, its delay and its sensors' lags included, from the very step that runs it.

use super::{Equilibrium, Inputs, Machine, Memory, Shared, Snapshot, State};
use crate::Scalar;
use crate::controller::{MOST_UNDER_WAY, Timing};
use crate::drive::Drive;
use crate::drive::hydraulic::Hydraulic;
use crate::memory::MemoryVisitor;
use crate::observer::MOST_STATES;
use crate::transducers::{SENSORS, SensorReading};
use core::slice::{Iter, IterMut};

/// Numbers of the state between two periods: `z, q_i, q_i', x_b, w`, `delta, u`, the command held, those under way, the youngest
/// first, the base as sampled last, the slaved load pressure and by how much the true one is behind it, what the sensors measured and showed, the observer.
pub const PERIOD_STATES: usize = 5 + 2 + 1 + UNDER_WAY + 3 + 2 * SENSORS + MOST_STATES;

/// Place of the column's base among them.
pub const BASE: usize = 3;

/// Place of the youngest command.
pub const YOUNGEST: usize = 8;

/// Place of the first of what the sensors showed: load cell, potentiometer, column, grip.
pub const SHOWN: usize = YOUNGEST + UNDER_WAY + 3 + SENSORS;

const UNDER_WAY: usize = MOST_UNDER_WAY - 1;

/// What moves a loader in a period.
#[derive(Debug, Clone, Copy)]
pub struct Drives<S> {
    /// A signal in V that the controller adds to the command at its sample.
    pub command_signal: S,
    /// A pilot force in N that stays.
    pub force: S,
    /// The one of before, which the drive has followed so far.
    pub force_before: S,
    /// A test signal in V at the amplifier's input during one step of the period, and which.
    pub test_signal: (S, usize),
}

/// A period from a state at rest at neutral, nothing pushing but the pilot's force.
#[derive(Debug, Clone, Copy)]
pub struct Period<'a, S: Scalar, D: Drive<S> = Hydraulic<S>> {
    /// The loader.
    pub machine: &'a Machine<S, D>,
    /// What is in play; with a controller's timing.
    pub shared: &'a Shared,
    /// When the controller acts.
    pub timing: Timing,
}

impl<S: Scalar, D: Drive<S>> Period<'_, S, D> {
    /// What there is at the start of the period, its command on the way, unless it has no step; and the state a period later.
    #[inline(always)]
    pub fn next(
        &self,
        numbers: &[S; PERIOD_STATES],
        drives: &Drives<S>,
    ) -> (Option<Snapshot<S, D>>, [S; PERIOD_STATES]) {
        let (zero, (test_signal, at)) = (drives.force.zero(), drives.test_signal);
        let (mut state, mut memory) = self.put(numbers, drives);
        let (none, mut now) = ([zero; SENSORS], None);
        for step in 0..self.timing.period {
            state.test_signal = if step == at { test_signal } else { zero };
            let step_start = self.machine.begin(self.shared, &mut state, &mut memory, &Inputs::NONE, &mut || none);
            now.get_or_insert(step_start.now);
            self.machine.advance(self.shared, &mut state, &Inputs::NONE, &step_start);
        }
        if !self.shared.effects.observer {
            // Nothing moves it and nothing asks for it.
            memory.control.estimate = [zero; MOST_STATES];
        }
        (now, Self::read(state, memory))
    }

    #[inline(always)]
    fn put(&self, numbers: &[S; PERIOD_STATES], drives: &Drives<S>) -> (State<S, D>, Memory<S>) {
        let equilibrium = Equilibrium::neutral(numbers[0].zero());
        let (mut state, mut memory) =
            (self.machine.start(self.shared, &equilibrium), self.machine.remember(self.shared, &equilibrium));
        visit::<S, D>((&mut state, &mut memory), FIRST_SAMPLE, &mut Put(numbers.iter()));
        state.steps = FIRST_SAMPLE * self.timing.period;
        (state.hand, state.pilot_force) = (drives.force, drives.force_before);
        memory.command_signal = drives.command_signal;
        (state, memory)
    }

    #[inline(always)]
    fn read(mut state: State<S, D>, mut memory: Memory<S>) -> [S; PERIOD_STATES] {
        let mut numbers = [state.held; PERIOD_STATES];
        visit::<S, D>((&mut state, &mut memory), FIRST_SAMPLE + 1, &mut Read(numbers.iter_mut()));
        numbers
    }
}

/// Number of the first sample of a period: the commands of those before may be under way.
const FIRST_SAMPLE: usize = MOST_UNDER_WAY;

/// Visits each number of the state between two periods of which the next is sample number `sample`; the one list of them.
#[inline(always)]
fn visit<S: Scalar, D: Drive<S>>(
    (state, memory): (&mut State<S, D>, &mut Memory<S>),
    sample: usize,
    visitor: &mut impl MemoryVisitor<S>,
) {
    for number in &mut state.slow.plant {
        visitor.number("plant", number);
    }
    let mut feeling = state.feeling();
    feeling.visit(visitor);
    state.feels(&feeling);
    visitor.number("held", &mut state.held);
    for age in 1..=UNDER_WAY {
        visitor.number("under_way", memory.under_way.command_mut(sample - age));
    }
    memory.control.visit_samples(visitor);
    let mut drive = D::remembered(&state.drive);
    for number in &mut drive {
        visitor.number("drive", number);
    }
    D::remember(&mut state.drive, drive);
    let SensorReading { measured, shown } = &mut state.seen;
    for number in measured.iter_mut().chain(shown) {
        visitor.number("sensor", number);
    }
    memory.control.visit_estimate(visitor);
}

/// Replaces numbers by those of a list.
struct Put<'a, S>(Iter<'a, S>);

impl<S: Scalar> MemoryVisitor<S> for Put<'_, S> {
    #[inline(always)]
    fn number(&mut self, _: &'static str, number: &mut S) {
        if let Some(&value) = self.0.next() {
            *number = value;
        }
    }

    #[inline(always)]
    fn nonlinear(&mut self, _: &'static str, _: &mut S) {}

    #[inline(always)]
    fn flag(&mut self, _: &'static str, _: &mut S::Mask) {}
}

/// Writes numbers to a list.
struct Read<'a, S>(IterMut<'a, S>);

impl<S: Scalar> MemoryVisitor<S> for Read<'_, S> {
    #[inline(always)]
    fn number(&mut self, _: &'static str, number: &mut S) {
        if let Some(place) = self.0.next() {
            *place = *number;
        }
    }

    #[inline(always)]
    fn nonlinear(&mut self, _: &'static str, _: &mut S) {}

    #[inline(always)]
    fn flag(&mut self, _: &'static str, _: &mut S::Mask) {}
}
