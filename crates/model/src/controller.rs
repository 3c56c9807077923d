//! Digital controller: the same law and the same feel computer, run once a period.
//!
//! `T` period · `tau` delay from a sample to its command · `e` command
//!
//! At `t_k = k T` it samples the sensors, works out `e_k` from the feel computer's present displacement, and moves the feel computer on
//! to `t_{k+1}` under the torque just sampled. `e_k` reaches the amplifier at `t_k + tau` and stays until the next. As `T` and
//! `tau` go to zero this is the analog loop.

use crate::Scalar;
use crate::parameters::Parameters;

/// Most commands that may be under way at once: the delay is shorter than this many periods.
pub const MOST_UNDER_WAY: usize = 8;

/// When the controller acts, in steps of the simulation; the same for all runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// Steps in a period.
    pub period: usize,
    /// Steps from a sample to its command.
    pub delay: usize,
}

impl Timing {
    /// The number of the sample that is taken at a step, if one is.
    #[inline(always)]
    pub fn sample_at(self, step: usize) -> Option<usize> {
        step.is_multiple_of(self.period).then_some(step / self.period)
    }

    /// The number of the sample whose command arrives at a step, if one does.
    #[inline(always)]
    pub fn arriving_at(self, step: usize) -> Option<usize> {
        step.checked_sub(self.delay).and_then(|since| self.sample_at(since))
    }
}

/// Converters and limits of the controller.
#[derive(Debug, Clone, Copy)]
pub struct Converters<S> {
    /// Of the load cell, in N.
    force: Converter<S>,
    /// Of the potentiometer, in m.
    piston: Converter<S>,
    output: Converter<S>,
    /// Largest command that the amplifier answers.
    current_range: S,
    /// `a_w` in 1/s.
    pub antiwindup: S,
}

/// Range of a converter; its step, and one over it.
#[derive(Debug, Clone, Copy)]
struct Converter<S> {
    range: S,
    step: [S; 2],
}

impl<S: Scalar> Converter<S> {
    #[inline(always)]
    fn new(range: S, step: S) -> Self {
        Self { range, step: [step, step.constant(1.0) / step] }
    }

    #[inline(always)]
    fn converted(&self, value: S) -> S {
        value.within(self.range).quantized(self.step)
    }
}

impl<S: Scalar> Converters<S> {
    /// The converters of a loader.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>) -> Self {
        let Parameters { controller, load_cell, potentiometer, amplifier, .. } = parameters;
        let input_step = step(controller.input_range, controller.input_bits);
        // A converter takes `gain` volts per unit.
        let input = |gain: S| Converter::new(controller.input_range / gain, input_step / gain);
        Self {
            force: input(load_cell.gain),
            piston: input(potentiometer.gain),
            output: Converter::new(controller.output_range, step(controller.output_range, controller.output_bits)),
            current_range: amplifier.current_limit / amplifier.admittance,
            antiwindup: controller.antiwindup,
        }
    }

    /// Those of a drive that takes its sensors as numbers, its command too, up to `range`.
    #[inline(always)]
    pub fn of_numbers(range: S, antiwindup: S) -> Self {
        let one = range.constant(1.0);
        let none = Converter::new(one / one.zero(), one.zero());
        Self { force: none, piston: none, output: none, current_range: range, antiwindup }
    }

    /// Load cell force and piston displacement as the controller reads their voltages.
    #[inline(always)]
    pub fn read(&self, force: S, piston: S) -> (S, S) {
        (self.force.converted(force), self.piston.converted(piston))
    }

    /// The voltage that the controller gives for a command.
    #[inline(always)]
    pub fn write(&self, e: S) -> S {
        self.output.converted(e)
    }

    /// What the amplifier answers of a command.
    #[inline(always)]
    pub fn within_range(&self, e: S) -> S {
        e.within(self.output.range.min(self.current_range))
    }
}

/// Step of a converter of so many bits over twice its range; zero where there is none.
#[inline(always)]
fn step<S: Scalar>(range: S, bits: S) -> S {
    let one = range.constant(1.0);
    let mut levels = one;
    for bit in 1..=52 {
        levels = S::select(bits.less(bits.constant(f64::from(bit))), levels, levels.times(2.0));
    }
    S::select(bits.less(one), range.zero(), range.times(2.0) / levels)
}

/// Commands on their way to the amplifier.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CommandDelay<S> {
    commands: [S; MOST_UNDER_WAY],
}

impl<S: Scalar> CommandDelay<S> {
    /// Nothing under way but `e`.
    #[inline(always)]
    pub fn holding(e: S) -> Self {
        Self { commands: [e; MOST_UNDER_WAY] }
    }

    /// The command of sample number `sample` sets out.
    #[inline(always)]
    pub fn send(&mut self, sample: usize, e: S) {
        self.commands[sample % MOST_UNDER_WAY] = e;
    }

    /// The command of sample number `sample`, to be replaced.
    #[inline(always)]
    pub fn command_mut(&mut self, sample: usize) -> &mut S {
        &mut self.commands[sample % MOST_UNDER_WAY]
    }

    /// The command of sample number `sample`, which arrives now.
    #[inline(always)]
    pub fn arriving(&self, sample: usize) -> S {
        self.commands[sample % MOST_UNDER_WAY]
    }
}
