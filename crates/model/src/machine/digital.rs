//! The digital controller's share of a step: when it samples, and when its command arrives.

use super::{Equilibrium, Machine, Shared, Snapshot, State};
use crate::Scalar;
use crate::control::{FeelState, LawState, Sample};
use crate::controller::{CommandDelay, Timing};
use crate::drive::Drive;
use crate::feel_computer::FeelMotion;
use crate::run;
use crate::run::Inputs;
use crate::transducers::SENSORS;

/// What a digital controller remembers from sample to sample, and its commands on their way.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Memory<S> {
    pub(super) under_way: CommandDelay<S>,
    pub(super) control: LawState<S>,
    /// What is added to every command on its way, in V, beside the inputs' signal.
    pub(super) command_signal: S,
}

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// What a digital controller remembers of the equilibrium.
    #[inline(always)]
    pub fn remember(&self, shared: &Shared, equilibrium: &Equilibrium<S>) -> Memory<S> {
        let shown = self.shown_at_rest(&shared.effects, equilibrium);
        let feel = [equilibrium.delta, equilibrium.delta_rate];
        Memory {
            under_way: CommandDelay::holding(equilibrium.command),
            control: self.control.remember(shown, equilibrium.estimate, feel),
            command_signal: equilibrium.delta.zero(),
        }
    }

    /// What the sensors give at a sample; `normal` is a standard normal number for each.
    #[inline(always)]
    pub fn sampled(
        &self,
        shared: &Shared,
        state: &State<S, D>,
        normal: &mut impl FnMut() -> [S; SENSORS],
    ) -> [S; SENSORS] {
        let zero = state.held.zero();
        let normal = if shared.effects.noise { normal() } else { [zero; SENSORS] };
        self.transducers.sample(state.seen.shown, normal)
    }

    /// The digital controller's share of a step.
    #[inline(always)]
    pub fn act(
        &self,
        shared: &Shared,
        timing: Timing,
        (state, memory): (&mut State<S, D>, &mut Memory<S>),
        inputs: &Inputs,
        now: &Snapshot<S, D>,
        normal: &mut impl FnMut() -> [S; SENSORS],
    ) {
        let steps = state.steps;
        if let Some(sample) = timing.sample_at(steps) {
            let sampled = Sample { sensors: self.sampled(shared, state, normal), pilot_force: now.pilot_force };
            let mut feeling = state.feeling();
            let law = (&mut feeling, &mut memory.control);
            let [e, _] = self.control.command_and_torque(shared, law, inputs, &sampled);
            state.feels(&feeling);
            memory.under_way.send(sample, e + memory.command_signal + e.constant(inputs.command_signal[0]));
        }
        if let Some(sample) = timing.arriving_at(steps) {
            state.held = memory.under_way.arriving(sample);
        }
    }
}

impl<S: Scalar, M> run::RunState<S, M> {
    /// The programmed feel as it stands.
    #[inline(always)]
    pub fn feeling(&self) -> FeelState<S> {
        let motion = FeelMotion { at: self.slow.feel, grip: self.feel, slider: self.slider };
        FeelState { motion, neutral: self.neutral }
    }

    /// The programmed feel stands so.
    #[inline(always)]
    pub(super) fn feels(&mut self, feeling: &FeelState<S>) {
        let &FeelState { motion: FeelMotion { at, grip, slider }, neutral } = feeling;
        (self.slow.feel, self.feel, self.slider, self.neutral) = (at, grip, slider, neutral);
    }

    /// The amplifier holds this command from now on.
    #[inline(always)]
    pub fn command(&mut self, e: S) {
        self.held = e;
    }

    /// Steps since the start.
    #[inline(always)]
    pub fn steps(&self) -> usize {
        self.steps
    }
}

impl<S: Scalar> Memory<S> {
    /// The command of sample number `sample`, while it is under way.
    #[inline(always)]
    pub fn command(&self, sample: usize) -> S {
        self.under_way.arriving(sample)
    }

    /// What the law remembers.
    #[inline(always)]
    pub fn control(&self) -> &LawState<S> {
        &self.control
    }
}
