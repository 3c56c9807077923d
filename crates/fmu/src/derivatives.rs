//! Exact derivatives: the last communication step once more, on dual numbers along the direction that is asked for.
//!
//! `dy = sum_k (dy / du_k) du_k`: how the outputs at the present communication point change with the inputs that were held through the
//! step up to it; before the first step, and in an event of the law's clock, with those of now. Dry friction, stops and limits stay as they are, and steps of sensors and
//! converters, which have no slope, are left out.

use crate::feel::Feel;
use crate::instance::Instance;
use crate::instance_state::{AnyStepState, StepRestorePoint};
use crate::step_state::{Given, StepConstants, StepState};
use crate::variables::{Kind, MOST_INPUTS, MOST_OUTPUTS};
use forcefeel_model::drive::Drive;
use forcefeel_model::drive::electric::Electric;
use forcefeel_model::drive::hydraulic::Hydraulic;
use forcefeel_model::dual::Dual;
use forcefeel_model::surface::FLIGHT;
use serde::Serialize;
use serde::de::DeserializeOwned;

impl Instance {
    /// The derivatives of the outputs `unknowns` along the inputs `knowns`, which change by `seed`.
    ///
    /// # Errors
    /// If one of them is no output or no input that has a derivative, or the FMU is not initialized.
    pub fn derivative(&mut self, unknowns: &[u32], knowns: &[u32], seed: &[f64]) -> Result<Vec<f64>, String> {
        if self.ticks() {
            // In an event: of what follows the inputs as they are now.
            let mut settled = self.clone();
            settled.settle()?;
            return settled.derivative(unknowns, knowns, seed);
        }
        let mut along = [0.0; MOST_INPUTS];
        for (&known, &by) in knowns.iter().zip(seed) {
            let place = self.input(known).ok_or_else(|| format!("{known}: is the reference of no input"))?;
            let name = self.input_name(place);
            if matches!(name, "trim" | "stiffness_factor" | "shaker") || FLIGHT.contains(&name) {
                return Err(format!("{name}: has no derivative, as it is told to the feel in steps"));
            }
            along[place] += by;
        }
        let slopes = self.slopes(&along)?;
        let of = |&unknown: &u32| match self.output(unknown) {
            Some(place) => Ok(slopes[place]),
            None => Err(format!("{unknown}: is the reference of no output")),
        };
        unknowns.iter().map(of).collect()
    }

    fn slopes(&self, along: &[f64; MOST_INPUTS]) -> Result<[f64; MOST_OUTPUTS], String> {
        let kept = self.kept();
        let (inputs, feel, step_state, steps) = match (&kept.before, &kept.step_state) {
            (Some(StepRestorePoint { feel, step_state, inputs, steps }), _) => (inputs, feel, step_state, *steps),
            (None, Some(step_state)) => (&kept.inputs, &kept.feel, step_state, 0),
            _ => return Err("the FMU is not initialized".to_string()),
        };
        let given = self.dual(inputs, along);
        match step_state {
            AnyStepState::Hydraulic(step_state) => {
                self.slopes_of::<Hydraulic<f64>, Hydraulic<Dual>>(step_state, feel, &given, steps)
            }
            AnyStepState::Electric(step_state) => {
                self.slopes_of::<Electric<f64>, Electric<Dual>>(step_state, feel, &given, steps)
            }
        }
    }

    fn slopes_of<D: Drive<f64>, E: Drive<Dual>>(
        &self,
        step_state: &StepState<f64, D>,
        feel: &Feel,
        given: &Given<Dual>,
        steps: usize,
    ) -> Result<[f64; MOST_OUTPUTS], String>
    where
        D::Memory: Serialize,
        E::Memory: DeserializeOwned,
    {
        // Numbers that were written down read back as dual ones without a slope.
        let written = postcard::to_stdvec(step_state).map_err(|error| error.to_string())?;
        let mut step_state: StepState<Dual, E> = postcard::from_bytes(&written).map_err(|error| error.to_string())?;
        let mut feel = feel.clone();
        let mut constants: StepConstants<Dual, E> =
            StepConstants::new(&self.resources, &self.values(), &feel, Dual::constant(0.0));
        constants.go(&self.resources, (&mut step_state, &mut feel), given, (steps, self.change_steps()));
        Ok(constants.look(&step_state, &feel, given).map(|output| output.slope))
    }

    /// The inputs with their slopes.
    fn dual(&self, inputs: &[f64; MOST_INPUTS], along: &[f64; MOST_INPUTS]) -> Given<Dual> {
        let (value, slope) = (self.given(inputs), self.given(along));
        let dual = |value: f64, slope: f64| Dual { value, slope };
        let force_slope = if self.resources.kind == Kind::Law { 0.0 } else { slope.pilot_force };
        Given {
            pilot_force: value.pilot_force,
            force_slope: dual(0.0, force_slope),
            command: dual(value.command, slope.command),
            sensed: core::array::from_fn(|k| dual(value.sensed[k], slope.sensed[k])),
            trim: value.trim,
            stiffness_factor: value.stiffness_factor,
            shaker: value.shaker,
            flight: value.flight,
        }
    }
}
