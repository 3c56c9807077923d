//! The programmed feel alone in flight: what the hand would meet without a loader in between.

use crate::arrays::{rows, vector};
use crate::errors::refused;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::effects::Effects;
use forcefeel_model::feel::{FeelConditions, FeelLaw};
use forcefeel_model::feel_computer::{FeelComputer, FeelMotion};
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::surface::FlightState;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

type Values<'py> = PyReadonlyArray1<'py, f64>;

/// Feel and effects of a loader's values, with what comes from outside.
fn feel_of(values: &Values<'_>) -> PyResult<(Parameters<f64>, Effects, FeelLaw<f64>)> {
    let values = vector::<COUNT>("values", values)?;
    let parameters = Parameters::from_values(&values);
    // The feel of the column's torque, whose displacement is the angle.
    let feel = FeelLaw::new(&parameters, &Compensator::state_feedback(&parameters, [0.0; 7]));
    Ok((parameters, Effects { surroundings: true, ..Effects::of(&values) }, feel))
}

/// What the surface in a flight state does to a control at `angle`.
fn conditions(parameters: &Parameters<f64>, flight: &[f64; 10], angle: f64, slider: f64) -> FeelConditions<f64> {
    let added = parameters.hinge_moment(&FlightState::from_numbers(*flight), angle);
    FeelConditions {
        added_force: added.force,
        added: [added.stiffness, added.damping],
        slider,
        ..FeelConditions::at_rest(0.0, 1.0, angle)
    }
}

/// Force at the grip in N, (states,), that holds the programmed feel and the hinge moment of the loader's surface, without friction.
///
/// `flight`: as in `hinge_moment`.
#[pyfunction]
pub fn feel_held_in_flight<'py>(
    py: Python<'py>,
    values: Values<'py>,
    flight: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (parameters, effects, feel) = feel_of(&values)?;
    let held = |row: &[f64; 11]| {
        let (state, angle) = (core::array::from_fn(|k| row[k]), row[10]);
        feel.held(&effects, None, angle, 0.0, &conditions(&parameters, &state, angle, angle))
    };
    Ok(PyArray1::from_vec(py, rows("flight", &flight)?.iter().map(held).collect()))
}

/// The programmed feel with its surface, in time.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct FlownFeel {
    parameters: Parameters<f64>,
    effects: Effects,
    feel: FeelLaw<f64>,
    motion: Mutex<FeelMotion<f64>>,
}

#[pymethods]
impl FlownFeel {
    /// At rest at an angle.
    #[new]
    fn new(values: Values<'_>, angle: f64) -> PyResult<Self> {
        let (parameters, effects, feel) = feel_of(&values)?;
        let motion = Mutex::new(FeelMotion::resting(&feel, angle));
        Ok(Self { parameters, effects, feel, motion })
    }

    /// Angle in rad after `steps` of `step_s` under a force at the grip in N, in a flight state.
    fn run(&self, force: f64, flight: Values<'_>, steps: usize, step_s: f64) -> PyResult<f64> {
        let flight = vector::<10>("flight", &flight)?;
        if !(force.is_finite() && step_s > 0.0) {
            return Err(refused(format!("force, step_s: expected a number and a step above 0, got {force}, {step_s}")));
        }
        let computer =
            FeelComputer { feel: &self.feel, next: &self.feel, fade: 0.0, effects: &self.effects, curve: None };
        let mut motion = self.motion.lock().unwrap_or_else(PoisonError::into_inner);
        for _ in 0..steps {
            let conditions = conditions(&self.parameters, &flight, motion.at[0], motion.slider);
            computer.run(&mut motion, self.parameters.column.grip_arm * force, &conditions, step_s);
        }
        Ok(motion.at[0])
    }
}
