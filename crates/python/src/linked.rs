//! Two loaders joined by a link.

use crate::arrays::{rows, vector};
use crate::errors::{refused, threads as answered};
use crate::laws::{Laws, NamedLaw, check_runs};
use crate::limits::step;
use crate::model::{Parameter, row};
use crate::simulate::Simulation;
use crate::solve::feels;
use forcefeel_model::electronic_link::MOST_DELAY;
use forcefeel_model::link::{LINK_ROWS, LINK_TABLE};
use forcefeel_model::parameters::COUNT;
use forcefeel_model::shaft::Shaft;
use forcefeel_simulate::linked::{JOINT_OUTPUTS, Joint, SAMPLED};
use numpy::{PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// Simulation, values and the law of each run: by name, as gains or as an observer.
type SideOf<'py> = (
    PyRef<'py, Simulation>,
    PyReadonlyArray2<'py, f64>,
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

/// A rate in rad/s that no mode of two columns on a shaft is above, from its values and the inertia of each.
#[pyfunction]
pub fn fastest_on_shaft(values: PyReadonlyArray1<'_, f64>, inertias: (f64, f64)) -> PyResult<f64> {
    let values = vector::<LINK_ROWS>("values", &values)?;
    Ok(Shaft::fastest(&values, [1.0 / inertias.0, 1.0 / inertias.1]))
}

/// Outputs (pairs, samples, outputs of the first, of the second and of the link) of pairs of loaders of one step and one period.
///
/// `values`: of the link of each pair. `delay`: periods of an electronic link; a mechanical one without. `disconnect`: a step; `jam`: the first side
/// or the second, and a step; `button`: likewise, who has priority from then on.
/// `samples`: what laws and link were given and gave at the last sample follows: of each side sensors and command; hands; 1 if open.
#[pyfunction]
#[pyo3(signature = (first, second, values, *, delay = None, uncouples = false, disconnect = None, jam = None, button = None, samples = false, threads = 1))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn simulate_linked<'py>(
    py: Python<'py>,
    first: SideOf<'py>,
    second: SideOf<'py>,
    values: PyReadonlyArray2<'py, f64>,
    delay: Option<usize>,
    uncouples: bool,
    disconnect: Option<usize>,
    jam: Option<(usize, usize)>,
    button: Option<(usize, usize)>,
    samples: bool,
    threads: usize,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let joints: Vec<Joint> = rows::<LINK_ROWS>("values", &values)?
        .into_iter()
        .map(|values| Joint { values, delay, uncouples, disconnect, jam, button, samples })
        .collect();
    if delay.is_some_and(|delay| !(1..=MOST_DELAY).contains(&delay)) {
        return Err(refused(format!("delay: expected 1 to {MOST_DELAY} periods, got {delay:?}")));
    }
    if button.is_some_and(|(side, _)| side > 1) {
        return Err(refused(format!("button: expected side 0 or 1 and a step, got {button:?}")));
    }
    if jam.is_some_and(|(side, step)| side > 1 || step == 0) {
        return Err(refused(format!("jam: expected side 0 or 1 and a step from 1 on, got {jam:?}")));
    }
    let sides = [first, second];
    let every = sides[0].0.every_beside(&sides[1].0)?;
    let loaders = [rows::<COUNT>("values", &sides[0].1)?, rows::<COUNT>("values", &sides[1].1)?];
    for side in &loaders {
        check_runs("values", Some(side.len()), joints.len())?;
    }
    let law =
        |(_, _, law, gains, observers): &SideOf<'py>| Laws::of(*law, gains.as_ref(), observers.as_ref(), joints.len());
    let laws = [law(&sides[0])?, law(&sides[1])?];
    let mut jobs = [0, 1].map(|side: usize| sides[side].0.job(&loaders[side], laws[side].law()));
    for (stream, job) in jobs.iter_mut().enumerate() {
        let effects = &mut job.shared.effects;
        (effects.linked, job.noise.1) = (true, Some(stream as u64));
        effects.surroundings |= delay.is_some();
        effects.column_friction |= jam.is_some();
    }
    if delay.is_some() && jobs.iter().any(|job| job.shared.timing.is_none()) {
        return Err(refused("delay: expected loaders with a digital controller for an electronic link"));
    }
    let columns = jobs.iter().map(|job| job.outputs.len()).sum::<usize>()
        + JOINT_OUTPUTS.len()
        + if samples { SAMPLED } else { 0 };
    let histories = PyArray3::zeros(py, [joints.len(), jobs[0].samples(), columns], false);
    let mut writable = histories.readwrite();
    let into = writable.as_slice_mut()?;
    answered(py.detach(|| forcefeel_batch::run_linked([&jobs[0], &jobs[1]], &joints, every, threads, into)))?;
    drop(writable);
    Ok(histories)
}

/// Angles (pairs, 2, samples) of two feels each, rows I, B, G, on a link without delay, let go together from `angle`.
#[pyfunction]
#[pyo3(signature = (first, second, values, release, samples, *, uncouples = false, threads = 1))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn linked_feels<'py>(
    py: Python<'py>,
    first: PyReadonlyArray2<'py, f64>,
    second: PyReadonlyArray2<'py, f64>,
    values: PyReadonlyArray1<'py, f64>,
    release: (f64, f64),
    samples: usize,
    uncouples: bool,
    threads: usize,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let both = [feels(&first)?, feels(&second)?];
    check_runs("second", Some(both[1].len()), both[0].len())?;
    if both[0].is_empty() || samples == 0 {
        return Err(refused("first: expected at least one feel and one sample"));
    }
    let link = vector::<LINK_ROWS>("values", &values)?;
    let release = (release.0, step(release.1)?);
    let angles = PyArray3::zeros(py, [both[0].len(), 2, samples], false);
    let mut writable = angles.readwrite();
    let into = writable.as_slice_mut()?;
    let [first, second] = &both;
    answered(
        py.detach(|| forcefeel_batch::release_feels([first, second], (&link, uncouples), release, threads, into)),
    )?;
    drop(writable);
    Ok(angles)
}
