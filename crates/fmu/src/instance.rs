//! What an importer does with an FMU: begins, goes from one communication point to the next, keeps a state and takes it back.

use crate::feel::count;
use crate::instance_state::{AnyStepState, InstanceState, StepRestorePoint};
use crate::resources::Resources;
use crate::step_state::{StepConstants, stride};
use crate::variables::{
    FEEL_CHANGE_TIME, HELD_UNTIL, Kind, MOST_OUTPUTS, SEED, START_ANGLE, START_FORCE, Variables, inputs, options, rows,
    seen,
};
use forcefeel_model::drive::electric::Electric;
use forcefeel_model::drive::hydraulic::Hydraulic;
use forcefeel_model::parameters::{COUNT, DriveKind};
use forcefeel_solve::start::Start;
use std::sync::Arc;

/// By what part of a step the importer's time may differ from a whole number of them: the rounding of sums and differences.
const ROUNDING: f64 = 1e-6;

/// An FMU in a process.
#[derive(Debug, Clone)]
pub struct Instance {
    pub(crate) resources: Arc<Resources>,
    pub(crate) variables: Arc<Variables>,
    pub(crate) kept: InstanceState,
    /// Made of what is kept.
    pub(crate) run: Option<Run>,
    pub(crate) seen: Option<[f64; MOST_OUTPUTS]>,
}

/// A loader with either drive, ready to run.
#[derive(Debug, Clone)]
pub(crate) enum Run {
    Hydraulic(Box<StepConstants<f64, Hydraulic<f64>>>),
    Electric(Box<StepConstants<f64, Electric<f64>>>),
}

impl Instance {
    /// An instance of the FMU with these resources.
    ///
    /// # Errors
    /// If the description was written for others.
    pub fn new(resources: Resources, token: &str) -> Result<Self, String> {
        if resources.token != token {
            return Err(format!(
                "the token of the description is {token}, that of the resources {}; take both from one FMU",
                resources.token
            ));
        }
        let values = resources.setup.values;
        let (kind, drive) = (resources.kind, DriveKind::of(&values));
        let variables = Variables {
            inputs: inputs(kind, &values),
            outputs: seen(kind, drive).len(),
            options: options(kind, resources.settings.len()),
            rows: rows(kind, drive, &values),
        };
        let kept = InstanceState::new(&resources, &variables);
        Ok(Self { resources: Arc::new(resources), variables: Arc::new(variables), kept, run: None, seen: None })
    }

    /// As it was before anything was set.
    pub fn reset(&mut self) {
        self.restore(&InstanceState::new(&self.resources, &self.variables));
    }

    /// When the run begins.
    ///
    /// # Errors
    /// If that is no number.
    pub fn start_at(&mut self, start_s: f64) -> Result<(), String> {
        if !start_s.is_finite() {
            return Err(format!("start time: expected a number, got {start_s}"));
        }
        self.kept.start_s = start_s;
        Ok(())
    }

    /// Ends the initialization: from here on only inputs and what is tunable can be set.
    ///
    /// # Errors
    /// If the run cannot begin so.
    pub fn start(&mut self) -> Result<(), String> {
        self.prepare()?;
        self.kept.started = true;
        Ok(())
    }

    /// Goes on from a communication point to the next.
    ///
    /// # Errors
    /// If the point is not where the run is, the step is no multiple of the internal one, or the run diverges.
    pub fn step(&mut self, from_s: f64, by_s: f64) -> Result<(), String> {
        if !self.kept.started {
            return Err("the FMU is not initialized".to_string());
        }
        self.settle()?;
        let step_s = self.step_s();
        let now = self.time();
        let summed = 4.0 * f64::EPSILON * now.abs() * count(self.steps().max(1));
        if !near(from_s, now, ROUNDING * step_s + summed) {
            return Err(format!("communication point: expected {now} s, where the last step ended, got {from_s} s"));
        }
        let steps = (by_s / step_s).round();
        if !((1.0..=MOST_STEPS).contains(&steps)
            && near(by_s, steps * step_s, ROUNDING * step_s + 4.0 * f64::EPSILON * now.abs()))
        {
            return Err(format!(
                "communication step: expected a multiple of the internal step of {step_s} s, got {by_s} s; nothing is rounded"
            ));
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
        let steps = steps as usize - usize::from(self.kept.sampled);
        self.kept.sampled = false;
        if steps > 0 {
            self.go(steps)?;
        }
        self.seen = None;
        if self.seen()?.iter().any(|value| !value.is_finite()) {
            return Err(format!("the run diverged before {} s", self.time()));
        }
        Ok(())
    }

    /// So many internal steps.
    fn go(&mut self, steps: usize) -> Result<(), String> {
        self.prepare()?;
        let (given, change_steps) = (self.given(&self.kept.inputs), self.change_steps());
        let InstanceState { feel, step_state, before, inputs, .. } = &mut self.kept;
        if let Some(step_state) = step_state.as_ref() {
            *before =
                Some(StepRestorePoint { feel: feel.clone(), step_state: step_state.clone(), inputs: *inputs, steps });
        }
        match (&mut self.run, step_state) {
            (Some(Run::Hydraulic(constants)), Some(AnyStepState::Hydraulic(step_state))) => {
                constants.go(&self.resources, (step_state, feel), &given, (steps, change_steps));
            }
            (Some(Run::Electric(constants)), Some(AnyStepState::Electric(step_state))) => {
                constants.go(&self.resources, (step_state, feel), &given, (steps, change_steps));
            }
            _ => return Err("the state is that of another FMU".to_string()),
        }
        self.seen = None;
        Ok(())
    }

    /// Whether it has a clock: the law alone.
    pub fn has_clock(&self) -> bool {
        self.resources.kind == Kind::Law
    }

    /// Whether the clock ticks now.
    pub fn ticks(&self) -> bool {
        self.kept.ticks
    }

    /// The clock ticks: a sample is taken here, of what the inputs are by when that is settled.
    ///
    /// # Errors
    /// If there is no clock, or it ticked here before.
    pub fn tick(&mut self) -> Result<(), String> {
        if !self.has_clock() || !self.kept.started {
            return Err("clock: there is none, or the FMU is not initialized".to_string());
        }
        if self.kept.sampled {
            return Err(format!("clock: ticked at {} s already", self.time()));
        }
        (self.kept.ticks, self.seen) = (true, None);
        Ok(())
    }

    /// What follows from the clock's tick is settled.
    ///
    /// # Errors
    /// As `step`.
    pub fn settle(&mut self) -> Result<(), String> {
        if self.kept.ticks {
            self.go(1)?;
            (self.kept.ticks, self.kept.sampled) = (false, true);
        }
        Ok(())
    }

    /// Where the run is, in s.
    pub fn time(&self) -> f64 {
        let taken = usize::from(self.kept.sampled) * stride(self.resources.kind, self.resources.setup.timing);
        self.kept.start_s + count(self.steps().saturating_sub(taken)) * self.resources.setup.step_s
    }

    /// By what its description knows its resources, and its states one another.
    pub fn token(&self) -> &str {
        &self.resources.token
    }

    /// What makes it out now.
    pub fn kept(&self) -> &InstanceState {
        &self.kept
    }

    /// As it was when that was kept.
    pub fn restore(&mut self, kept: &InstanceState) {
        (self.kept, self.run, self.seen) = (kept.clone(), None, None);
    }

    /// Length of the internal step in s: of the law alone the controller's period.
    pub fn step_s(&self) -> f64 {
        let setup = &self.resources.setup;
        count(stride(self.resources.kind, setup.timing)) * setup.step_s
    }

    pub(crate) fn values(&self) -> [f64; COUNT] {
        self.kept.values.as_slice().try_into().unwrap_or(self.resources.setup.values)
    }

    /// Steps of the machine in a change of the feel.
    pub(crate) fn change_steps(&self) -> usize {
        let steps = (self.kept.options[FEEL_CHANGE_TIME] / self.resources.setup.step_s).round();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
        let steps = steps as usize;
        steps
    }

    fn steps(&self) -> usize {
        match &self.kept.step_state {
            Some(AnyStepState::Hydraulic(step_state)) => step_state.steps(),
            Some(AnyStepState::Electric(step_state)) => step_state.steps(),
            None => 0,
        }
    }

    /// Makes what runs of what is kept, and the beginning where there is none.
    fn prepare(&mut self) -> Result<(), String> {
        if self.run.is_some() {
            return Ok(());
        }
        let begins = !self.kept.started;
        let (values, given) = (self.values(), self.given(&self.kept.inputs));
        let start = self.beginning()?;
        let InstanceState { feel, step_state, options, .. } = &mut self.kept;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
        let seed = options[SEED] as u64;
        self.run = Some(match DriveKind::of(&values) {
            DriveKind::Hydraulic => {
                let constants = StepConstants::new(&self.resources, &values, feel, 0.0);
                if begins {
                    *step_state = Some(AnyStepState::Hydraulic(Box::new(constants.start(start, seed, &given))));
                }
                Run::Hydraulic(Box::new(constants))
            }
            DriveKind::Electric => {
                let constants = StepConstants::new(&self.resources, &values, feel, 0.0);
                if begins {
                    *step_state = Some(AnyStepState::Electric(Box::new(constants.start(start, seed, &given))));
                }
                Run::Electric(Box::new(constants))
            }
        });
        Ok(())
    }

    /// Where the run begins.
    fn beginning(&self) -> Result<Start, String> {
        let options = &self.kept.options;
        let step_s = self.resources.setup.step_s;
        let held = (options[HELD_UNTIL] / step_s).round();
        if !near(options[HELD_UNTIL], held * step_s, ROUNDING * step_s) {
            return Err(format!("held_until: expected a multiple of {step_s} s, got {} s", options[HELD_UNTIL]));
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
        let held = held as usize;
        Ok(if held > 0 || options[START_ANGLE] != 0.0 {
            Start::Held(options[START_ANGLE], held)
        } else {
            Start::Under(options[START_FORCE])
        })
    }

    /// What is seen under the inputs of now.
    pub(crate) fn seen(&mut self) -> Result<[f64; MOST_OUTPUTS], String> {
        if let Some(seen) = self.seen {
            return Ok(seen);
        }
        if self.kept.ticks {
            // What is seen while the clock ticks follows the inputs until it is settled.
            let mut settled = self.clone();
            settled.settle()?;
            return settled.seen();
        }
        self.prepare()?;
        let given = self.given(&self.kept.inputs);
        let outputs = match (&self.run, &self.kept.step_state) {
            (Some(Run::Hydraulic(constants)), Some(AnyStepState::Hydraulic(step_state))) => {
                constants.look(step_state, &self.kept.feel, &given)
            }
            (Some(Run::Electric(constants)), Some(AnyStepState::Electric(step_state))) => {
                constants.look(step_state, &self.kept.feel, &given)
            }
            _ => return Err("the state is that of another FMU".to_string()),
        };
        self.seen = Some(outputs);
        Ok(outputs)
    }
}

/// Most internal steps in one of the importer: hours.
const MOST_STEPS: f64 = 1e8;

/// Whether two times are the same but for rounding; "not a number" never is.
fn near(outputs: f64, expected: f64, rounding: f64) -> bool {
    (outputs - expected).abs() <= rounding
}
