//! The digital controller's share of a step.
//!
//! `T` period · `e` command · `a_w` anti-windup · see `controller.rs`

use super::inputs::{Inputs, Moment};
use super::{Equilibrium, Machine, Now, Shared, State};
use crate::Scalar;
use crate::controller::{Timing, UnderWay};
use crate::drive::Drive;
use crate::feel_computer::FeelMotion;
use crate::observer::{Estimate, MOST_STATES, SAMPLED, Says};
use crate::transducers::SENSORS;

/// What a digital controller remembers from sample to sample.
#[derive(Debug, Clone, Copy)]
pub struct Memory<S> {
    pub(super) under_way: UnderWay<S>,
    /// Displacement of the base as sampled last.
    pub(super) base: S,
    /// Position of the drive's end as sampled last.
    position: S,
    /// State of the observer.
    pub(super) estimate: Estimate<S>,
    /// Torque that the feel computer heard last.
    heard: S,
    /// What is added to every command on its way, in V, beside the inputs' signal.
    pub(super) command_signal: S,
}

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// What a digital controller remembers of the equilibrium.
    #[inline(always)]
    pub fn remember(&self, equilibrium: &Equilibrium<S>) -> Memory<S> {
        let base = equilibrium.base + self.transducers.offset[2];
        let y = self.sampled_at_rest(equilibrium.base, equilibrium.position, equilibrium.effort);
        let estimate = self.observer.at_rest(&y, equilibrium.delta);
        let heard = self.observer.says(&estimate, &y, [equilibrium.delta, base.zero()], None).torque;
        let under_way = UnderWay::holding(equilibrium.command);
        Memory { under_way, base, position: y[1], estimate, heard, command_signal: base.zero() }
    }

    /// The digital controller's share of a step.
    #[inline(always)]
    pub(super) fn control(
        &self,
        shared: &Shared,
        timing: Timing,
        (state, memory): (&mut State<S, D>, &mut Memory<S>),
        inputs: &Inputs,
        now: &Now<S, D>,
        normal: impl FnOnce() -> [S; SENSORS],
    ) {
        let steps = state.steps;
        if steps.is_multiple_of(timing.period) {
            let normal = if shared.effects.noise { normal() } else { [now.force.zero(); SENSORS] };
            let sample = self.transducers.sample(state.seen.shown, normal);
            let e = self.sample(shared, timing, (state, memory), inputs, now, sample);
            memory
                .under_way
                .send(steps / timing.period, e + memory.command_signal + e.constant(inputs.command_signal[0]));
        }
        if steps >= timing.delay && (steps - timing.delay).is_multiple_of(timing.period) {
            state.held = memory.under_way.arriving((steps - timing.delay) / timing.period);
        }
    }

    /// Works out the command and moves the feel computer on by a period.
    #[inline(always)]
    fn sample(
        &self,
        shared: &Shared,
        timing: Timing,
        (state, memory): (&mut State<S, D>, &mut Memory<S>),
        inputs: &Inputs,
        now: &Now<S, D>,
        [force, piston, base]: [S; SENSORS],
    ) -> S {
        let period = self.step.times(count(timing.period));
        let (force, piston) = self.converters.read(force, piston);
        // There is no tachometer: the velocity is the last period's difference.
        let base_rate = (base - memory.base) / period;
        memory.base = base;
        let y = [force, piston, base * self.per_base];
        let added = shared.cancellation.map(|known| known.command(piston, (piston - memory.position) / period));
        memory.position = piston;
        let Says { command: e, torque, .. } = if shared.effects.observer {
            self.observed(shared, memory, &y, state.slow.feel, (inputs.fade[0], added))
        } else {
            let [delta, delta_rate] = state.slow.feel;
            let x = [piston, self.drive.effort_shown(force), delta, delta_rate, base, base_rate, now.pilot_force];
            Says { command: self.law.command(&x), torque: self.law.feel_torque(force), friction: force.zero() }
        };
        let e = added.map_or(e, |added| e + added);
        // The neutral moves through the period: half of it before the feel runs, half after.
        let trim = period.constant(inputs.trim[0]);
        state.neutral = self.feel.trimmed(state.neutral, trim, period.times(0.5));
        self.run_feel(shared, state, inputs, torque, period);
        state.neutral = self.feel.trimmed(state.neutral, trim, period.times(0.5));
        let gain = if shared.effects.observer {
            let (from, to) = (self.observer.per_delta(), self.next_observer.per_delta());
            from + (to - from).times(inputs.fade[0])
        } else {
            self.law.gains[2]
        };
        let has_gain = gain.zero().less(gain.abs());
        let excess = S::select(has_gain, self.converters.cut_off(e) / gain, gain.zero());
        // delta' = ... - 2 a_w (e - e_cut) / c_3, delta'' = ... - a_w^2 (e - e_cut) / c_3: place and speed give way, or the speed
        // would carry the control on. What sticks keeps its speed of zero.
        let given_way = self.converters.antiwindup * period * excess;
        let slower = self.converters.antiwindup * given_way;
        let [delta, rate] = state.slow.feel;
        let sticks = shared.effects.feel_friction;
        let slower = if sticks { S::select(state.feel.stuck, rate.zero(), slower) } else { slower };
        state.slow.feel = [delta - given_way.times(2.0), rate - slower];
        self.converters.write(e)
    }

    /// What the observer's law says at a sample; while the feel changes, between the two laws.
    #[inline(always)]
    fn observed(
        &self,
        shared: &Shared,
        memory: &mut Memory<S>,
        y: &[S; SAMPLED],
        feel: [S; 2],
        (fade, added): (f64, Option<S>),
    ) -> Says<S> {
        let xi = memory.estimate;
        let heard = if shared.effects.known_friction { Some(memory.heard) } else { None };
        let now = self.observer.says(&xi, y, feel, heard);
        if fade == 0.0 {
            memory.heard = now.torque;
            let e = self.answered(now.command, added);
            memory.estimate = self.observer.next(&xi, y, e, heard.map(|_| now.friction));
            return now;
        }
        let says = now.towards(self.next_observer.says(&xi, y, feel, heard), fade);
        memory.heard = says.torque;
        let (e, friction) = (self.answered(says.command, added), heard.map(|_| says.friction));
        let (from, to) = (self.observer.next(&xi, y, e, friction), self.next_observer.next(&xi, y, e, friction));
        for k in 0..MOST_STATES {
            memory.estimate[k] = from[k] + (to[k] - from[k]).times(fade);
        }
        says
    }

    /// The command as far as the amplifier answers it together with what is added.
    #[inline(always)]
    fn answered(&self, e: S, added: Option<S>) -> S {
        e - self.converters.cut_off(added.map_or(e, |added| e + added))
    }

    /// The feel computer over one period.
    #[inline(always)]
    fn run_feel(&self, shared: &Shared, state: &mut State<S, D>, inputs: &Inputs, torque: S, h: S) {
        let around = self.around(&shared.effects, state, inputs, Moment::Start);
        let mut motion = FeelMotion { at: state.slow.feel, grip: state.feel, slider: state.slider };
        self.feel_computer(shared, inputs.fade[0]).run(&mut motion, torque, &around, h);
        (state.slow.feel, state.feel, state.slider) = (motion.at, motion.grip, motion.slider);
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of steps in a period, far below 2^52")]
#[inline(always)]
fn count(steps: usize) -> f64 {
    steps as f64
}
