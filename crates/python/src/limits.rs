//! What every call asks of its numbers, so that none goes on for ever.

use crate::errors::refused;
use forcefeel_model::controller::{MOST_UNDER_WAY, Timing};
use pyo3::prelude::*;

/// Most steps in a controller's period: the longest period of the parameter table in the shortest steps of a scenario.
const MOST_STEPS_IN_PERIOD: usize = 10_000;

/// When the controller acts, from the steps in its period and in its delay.
pub fn timing((period, delay): (usize, usize)) -> PyResult<Timing> {
    if !(1..=MOST_STEPS_IN_PERIOD).contains(&period) || delay >= MOST_UNDER_WAY * period {
        return Err(refused(format!(
            "timing: expected 1 to {MOST_STEPS_IN_PERIOD} steps in a period and a delay of less than {MOST_UNDER_WAY} periods, \
             got {period} and {delay}"
        )));
    }
    Ok(Timing { period, delay })
}

/// A length of a step.
pub fn step(seconds: f64) -> PyResult<f64> {
    if seconds.is_finite() && seconds > 0.0 {
        return Ok(seconds);
    }
    Err(refused(format!("step_s: expected a time above zero, got {seconds}")))
}

/// Numbers that rise, or a `ArgumentError` that names them.
pub fn rising(name: &str, numbers: &[f64]) -> PyResult<()> {
    let ends = [numbers.first(), numbers.last()];
    // In this form also where one of them is not a number.
    if ends.iter().all(|end| end.is_some_and(|end| end.is_finite())) && numbers.windows(2).all(|pair| pair[0] < pair[1])
    {
        return Ok(());
    }
    Err(refused(format!("{name}: expected rising numbers")))
}

/// A count of at most so many, or a `ArgumentError` that names it.
pub fn at_most(name: &str, most: usize, count: usize) -> PyResult<()> {
    if count <= most {
        return Ok(());
    }
    Err(refused(format!("{name}: expected at most {most}, got {count}")))
}

/// A finite number of at least zero, or a `ArgumentError` that names it.
pub fn at_least_zero(name: &str, number: f64) -> PyResult<()> {
    if number.is_finite() && number >= 0.0 {
        return Ok(());
    }
    Err(refused(format!("{name}: expected a number of at least zero, got {number}")))
}
