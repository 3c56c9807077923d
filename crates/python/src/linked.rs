//! Two loaders joined by a link.

use crate::arrays::vector;
use crate::errors::refused;
use crate::laws::{Laws, NamedLaw};
use crate::model::{Parameter, row};
use crate::simulate::Simulation;
use forcefeel_model::link::{LINK_ROWS, LINK_TABLE, MOST_DELAY};
use forcefeel_model::parameters::COUNT;
use forcefeel_simulate::linked::{JOINT_OUTPUTS, Joint};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// Simulation, values, and the law: by name, as gains or as an observer.
type SideOf<'py> = (
    PyRef<'py, Simulation>,
    PyReadonlyArray1<'py, f64>,
    Option<NamedLaw>,
    Option<PyReadonlyArray2<'py, f64>>,
    Option<PyReadonlyArray2<'py, f64>>,
);

/// The table of a link's parameters.
#[pyfunction]
pub fn link_parameters() -> Vec<Parameter> {
    LINK_TABLE.iter().map(row).collect()
}

/// Name and SI unit of each output of a link.
#[pyfunction]
pub fn linked_outputs() -> Vec<(&'static str, &'static str)> {
    JOINT_OUTPUTS.to_vec()
}

/// Outputs (samples, outputs of the first, of the second and of the link) of two loaders of one step and one period.
///
/// `delay`: periods of an electronic link; a mechanical one without. `disconnect`: a step; `jam`: the first side or the second, and a step.
#[pyfunction]
#[pyo3(signature = (first, second, values, *, delay = None, uncouples = false, disconnect = None, jam = None))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn simulate_linked<'py>(
    py: Python<'py>,
    first: SideOf<'py>,
    second: SideOf<'py>,
    values: PyReadonlyArray1<'py, f64>,
    delay: Option<usize>,
    uncouples: bool,
    disconnect: Option<usize>,
    jam: Option<(usize, usize)>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values = vector::<LINK_ROWS>("values", &values)?;
    let joint = Joint { values, delay, uncouples, disconnect, jam };
    if delay.is_some_and(|delay| !(1..=MOST_DELAY).contains(&delay)) {
        return Err(refused(format!("delay: expected 1 to {MOST_DELAY} periods, got {delay:?}")));
    }
    if jam.is_some_and(|(side, step)| side > 1 || step == 0) {
        return Err(refused(format!("jam: expected side 0 or 1 and a step from 1 on, got {jam:?}")));
    }
    let sides = [first, second];
    let every = sides[0].0.every_beside(&sides[1].0)?;
    let law = |(_, _, law, gains, observers): &SideOf<'py>| Laws::of(*law, gains.as_ref(), observers.as_ref(), 1);
    let laws = [law(&sides[0])?, law(&sides[1])?];
    let rows = [&sides[0], &sides[1]].map(|(_, values, ..)| vector::<COUNT>("values", values).map(|values| [values]));
    let [rows_first, rows_second] = rows;
    let rows = [rows_first?, rows_second?];
    let mut jobs = [0, 1].map(|side: usize| sides[side].0.job(&rows[side], laws[side].law()));
    for (stream, job) in jobs.iter_mut().enumerate() {
        let effects = &mut job.shared.effects;
        (effects.linked, job.noise.1) = (true, Some(stream as u64));
        effects.surroundings |= delay.is_some();
        effects.column_friction |= jam.is_some();
    }
    if delay.is_some() && jobs.iter().any(|job| job.shared.timing.is_none()) {
        return Err(refused("delay: expected loaders with a digital controller for an electronic link"));
    }
    let columns = jobs.iter().map(|job| job.outputs.len()).sum::<usize>() + JOINT_OUTPUTS.len();
    let numbers = py.detach(|| forcefeel_batch::run_linked([&jobs[0], &jobs[1]], &joint, every));
    let samples = numbers.len() / columns;
    PyArray1::from_vec(py, numbers).reshape([samples, columns])
}
