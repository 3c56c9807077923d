//! One step in time: its start, where it looks about and settles, then the Runge-Kutta stages.

use super::digital::Memory;
use super::{Machine, SamplingPoint, Shared, Snapshot, State, StepStart};
use crate::Scalar;
use crate::drive::Drive;
use crate::run::Slow;
use crate::run::{Inputs, StepFraction};
use crate::transducers::{SENSORS, SensorReading};

/// What a step needs at every stage.
pub(super) struct Stage<'a, S: Scalar, D: Drive<S>> {
    pub(super) shared: &'a Shared,
    pub(super) inputs: &'a Inputs,
    pub(super) state: &'a State<S, D>,
    pub(super) moment: StepFraction,
}

/// What the stages of a step share, its start among it.
type OfStep<'a, S, D> = (&'a Shared, &'a State<S, D>, &'a Inputs, &'a StepStart<S, D>);

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// The start of a step: settles what friction did in the last one, samples if it is time to, and looks.
    ///
    /// `normal` gives a standard normal number for each sensor when a sample is taken; lent, because the compiler would write what follows a
    /// value that may have been used up twice.
    #[inline(always)]
    pub fn begin(
        &self,
        shared: &Shared,
        state: &mut State<S, D>,
        memory: &mut Memory<S>,
        inputs: &Inputs,
        normal: &mut impl FnMut() -> [S; SENSORS],
    ) -> StepStart<S, D> {
        let arrived = self.arrive(shared, state, inputs);
        if let Some(timing) = shared.timing {
            self.act(shared, timing, (state, memory), inputs, &arrived.now, normal);
        }
        self.set_out(shared, state, inputs, arrived)
    }

    /// [`Self::begin`], compiled once for all runs of a number that stands alone.
    #[inline(never)]
    pub fn begin_compiled_once(
        &self,
        shared: &Shared,
        state: &mut State<S, D>,
        memory: &mut Memory<S>,
        inputs: &Inputs,
        normal: &mut dyn FnMut() -> [S; SENSORS],
    ) -> StepStart<S, D> {
        self.begin(shared, state, memory, inputs, &mut || normal())
    }

    /// [`Self::advance`], compiled once for all runs of a number that stands alone.
    #[inline(never)]
    pub fn advance_compiled_once(
        &self,
        shared: &Shared,
        state: &mut State<S, D>,
        inputs: &Inputs,
        step_start: &StepStart<S, D>,
    ) {
        self.advance(shared, state, inputs, step_start);
    }

    /// The start of a step up to where a controller samples: what friction did in the last one, what there is, what sensors show.
    #[inline(always)]
    pub fn arrive(&self, shared: &Shared, state: &mut State<S, D>, inputs: &Inputs) -> SamplingPoint<S, D> {
        let effects = &shared.effects;
        let side =
            if effects.column_friction { self.drive.side(effects, state.column.stuck) } else { self.drive.moving() };
        let force = self.pilot_force(state, inputs, StepFraction::Start);
        let mut now = self.look(effects, &side, &state.slow, state, (force, force.zero()));
        if state.steps > 0 {
            self.drive.catch_up(&self.neighbors(), effects, &side, state, &mut now);
        }
        if effects.lags || shared.timing.is_some() {
            let measured = self.measured_at_grip(effects, state, inputs, &now);
            let lags = |before| self.transducers.after_whole(before, measured, state.late);
            let shown = if effects.lags { lags(&state.seen) } else { measured };
            state.seen = SensorReading { measured, shown };
        }
        SamplingPoint { now, side }
    }

    /// The start of a step from there on, under the command that is held by now.
    #[inline(always)]
    pub fn set_out(
        &self,
        shared: &Shared,
        state: &mut State<S, D>,
        inputs: &Inputs,
        SamplingPoint { mut now, side }: SamplingPoint<S, D>,
    ) -> StepStart<S, D> {
        let effects = &shared.effects;
        let stage = Stage { shared, inputs, state, moment: StepFraction::Start };
        if effects.feel_limits && shared.timing.is_none() {
            let limited = self.control.feel.held_within((now.delta, now.delta_rate), (now.delta, now.delta_rate));
            (now.delta, now.delta_rate) = limited;
        }
        let mut rates = self.rates(&stage, &state.slow, &mut now);
        let side = self.settle(shared, state, inputs, &mut now, &mut rates, side);
        StepStart::<S, D> { now, slow: state.slow, rates, side }
    }

    /// The rest of a step.
    #[inline(always)]
    pub fn advance(&self, shared: &Shared, state: &mut State<S, D>, inputs: &Inputs, step_start: &StepStart<S, D>) {
        let analog = shared.timing.is_none();
        let (h, half) = (self.step, self.step.times(0.5));
        let start = state.slow;
        // Not in a loop: what the stages share would go through memory, and a batch take half as long again.
        let k_1 = step_start.rates;
        let of = (shared, &*state, inputs, step_start);
        let k_2 = self.stage(of, &start.moved(&k_1, half, analog), StepFraction::Half);
        let k_3 = self.stage(of, &start.moved(&k_2, half, analog), StepFraction::Half);
        let k_4 = self.stage(of, &start.moved(&k_3, h, analog), StepFraction::End);
        let total = Slow::weighted(&[k_1, k_2, k_3, k_4]);
        state.slow = start.moved(&total, self.step.times(1.0 / 6.0), analog);
        self.touch(shared, state, inputs, &start, step_start);
        self.drive.end_step(&shared.effects, state, step_start);
        if analog {
            state.slider = self.dragged(&shared.effects, state);
            if shared.effects.surroundings {
                state.neutral = self.control.feel.trimmed(state.neutral, h.constant(inputs.trim[1]), h);
            }
        }
        state.pilot_force = self.pilot_force(state, inputs, StepFraction::End);
        state.steps += 1;
    }

    /// The rates at a stage, compiled into each place that asks for them unless [`Scalar::COMPILED_ONCE`].
    #[inline(always)]
    fn stage(&self, of: OfStep<'_, S, D>, slow: &Slow<S>, moment: StepFraction) -> Slow<S> {
        if S::COMPILED_ONCE { self.stage_compiled_once(of, slow, moment) } else { self.stage_inlined(of, slow, moment) }
    }

    #[inline(never)]
    fn stage_compiled_once(&self, of: OfStep<'_, S, D>, slow: &Slow<S>, moment: StepFraction) -> Slow<S> {
        self.stage_inlined(of, slow, moment)
    }

    #[inline(always)]
    fn stage_inlined(
        &self,
        (shared, state, inputs, step_start): OfStep<'_, S, D>,
        slow: &Slow<S>,
        moment: StepFraction,
    ) -> Slow<S> {
        // The lag hardly changes in a step.
        let force = self.pilot_force(state, inputs, moment);
        let mut now = self.look(&shared.effects, &step_start.side, slow, state, (force, D::carried(&state.drive)));
        if shared.effects.feel_limits && shared.timing.is_none() {
            let before = (step_start.now.delta, step_start.now.delta_rate);
            (now.delta, now.delta_rate) = self.control.feel.held_within(before, (now.delta, now.delta_rate));
        }
        let stage = Stage { shared, inputs, state, moment };
        let mut rates = self.rates(&stage, slow, &mut now);
        Self::resist(&shared.effects, state, &mut rates);
        rates
    }

    /// Time derivatives, dry friction left out.
    #[inline(always)]
    pub(super) fn rates(&self, stage: &Stage<'_, S, D>, slow: &Slow<S>, now: &mut Snapshot<S, D>) -> Slow<S> {
        let effects = &stage.shared.effects;
        let mut feel = slow.feel;
        let mut e = if stage.shared.timing.is_some() {
            stage.state.held + stage.state.test_signal
        } else {
            let ([force, piston, base, _], base_rate) = self.shown(stage, now);
            let conditions = self.feel_conditions(effects, stage.state, stage.inputs, stage.moment);
            let torque = self.received_torque(force, now);
            let fade = stage.moment.of(stage.inputs.fade);
            let computer = self.feel_computer(stage.shared, fade);
            feel = [now.delta_rate, computer.acceleration((now.delta, now.delta_rate), torque, &conditions)];
            let x = [
                piston,
                force / self.drive.force_per_effort(),
                now.delta,
                now.delta_rate,
                base,
                base_rate,
                now.pilot_force,
            ];
            let e = self.control.law.command(&x);
            if effects.test_signal { e + e.constant(stage.moment.of(stage.inputs.command_signal)) } else { e }
        };
        if effects.test_signal {
            e = e + e.constant(stage.moment.of(stage.inputs.test_signal));
        }
        let [first, second, third] = self.drive.rates(effects, &stage.state.drive, (&slow.plant, stage.moment), e, now);
        let by_link = self.drive.pull(self.column.per_link_force, &now.balance);
        let way = (stage.state.slow.plant[3], slow.plant[3]);
        let mut pull = self.column.acceleration(effects, (by_link, now.pilot_force), way, now.base_rate);
        if effects.linked {
            pull = pull + self.column.per_torque.times(stage.moment.of(stage.inputs.link_torque));
        }
        Slow { plant: [first, second, third, now.base_rate, pull], feel }
    }
}
