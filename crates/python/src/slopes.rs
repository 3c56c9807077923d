//! Matrices of the linear models on a bench, and their slopes along parameters.

use crate::arrays::{Matrix, to_numpy, vector};
use crate::errors::refused;
use crate::laws::{Laws, NamedLaw, effects_of};
use crate::limits::{step, timing as in_steps};
use crate::model::drive_of;
use forcefeel_matrices::{Linkage, Slopes, linear, sampled};
use forcefeel_model::drive::{Kind, Signals};
use forcefeel_model::parameters::COUNT;
use forcefeel_model::with_drive;
use forcefeel_slopes::sampled_loops::SampledLoops;
use forcefeel_solve::StateSpace;
use nalgebra::DMatrix;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

type Stack<'py> = Bound<'py, PyArray3<f64>>;
/// `A, B, C, D`, then their slopes (keys, rows, columns).
type Sloped<'py> = (Matrix<'py>, Matrix<'py>, Matrix<'py>, Matrix<'py>, Stack<'py>, Stack<'py>, Stack<'py>, Stack<'py>);

/// Name and SI unit of each channel of a bench with a loader of this drive.
#[pyfunction]
#[pyo3(signature = (drive = "hydraulic"))]
pub fn channels(drive: &str) -> PyResult<Vec<(&'static str, &'static str)>> {
    Ok(with_drive!(drive_of(drive)?, K => <<K as Kind>::Of<f64> as Signals<f64>>::CHANNELS.to_vec()))
}

/// The loader on a bench in continuous time and its slopes along the parameters at `keys`.
#[pyfunction]
#[pyo3(signature = (values, keys, *, linkage, law))]
pub fn linear_slopes<'py>(
    py: Python<'py>,
    values: PyReadonlyArray1<'py, f64>,
    keys: Vec<usize>,
    linkage: &str,
    law: NamedLaw,
) -> PyResult<Sloped<'py>> {
    let linkage = match linkage {
        "rigid" => Linkage::Rigid,
        "compliant" => Linkage::Compliant,
        other => {
            return Err(refused(format!("linkage: expected 'rigid' or 'compliant', got {other:?}")));
        }
    };
    let values = vector::<COUNT>("values", &values)?;
    check_keys(&keys)?;
    sloped(py, &linear(&values, &keys, linkage, &law.law()))
}

/// The loader on a bench from one period of its controller to the next, and its slopes along the parameters at `keys`.
#[pyfunction]
#[pyo3(signature = (values, keys, step_s, timing, *, law = None, observers = None))]
pub fn sampled_slopes<'py>(
    py: Python<'py>,
    values: PyReadonlyArray1<'py, f64>,
    keys: Vec<usize>,
    step_s: f64,
    timing: (usize, usize),
    law: Option<NamedLaw>,
    observers: Option<PyReadonlyArray2<'py, f64>>,
) -> PyResult<Sloped<'py>> {
    let values = [vector::<COUNT>("values", &values)?];
    check_keys(&keys)?;
    let laws = Laws::of(law, None, observers.as_ref(), values.len())?;
    let law = laws.law();
    let (step_s, timing) = (step(step_s)?, in_steps(timing)?);
    let loops = SampledLoops { effects: effects_of(values.iter(), &law), step_s, timing, values: &values, law };
    let slopes = py.detach(|| sampled(&loops, &keys));
    sloped(py, &slopes)
}

/// Refuses what is no place in the parameter table.
pub fn check_keys(keys: &[usize]) -> PyResult<()> {
    match keys.iter().find(|&&key| key >= COUNT) {
        Some(key) => Err(refused(format!("keys: expected places of parameters below {COUNT}, got {key}"))),
        None => Ok(()),
    }
}

fn sloped<'py>(py: Python<'py>, Slopes { model, along }: &Slopes) -> PyResult<Sloped<'py>> {
    let one = |of: fn(&StateSpace) -> &DMatrix<f64>| to_numpy(py, of(model));
    let all = |of: fn(&StateSpace) -> &DMatrix<f64>| {
        let numbers: Vec<f64> =
            along.iter().flat_map(|slope| of(slope).transpose().iter().copied().collect::<Vec<_>>()).collect();
        PyArray1::from_vec(py, numbers).reshape([along.len(), of(model).nrows(), of(model).ncols()])
    };
    Ok((
        one(|m| &m.a)?,
        one(|m| &m.b)?,
        one(|m| &m.c)?,
        one(|m| &m.d)?,
        all(|m| &m.a)?,
        all(|m| &m.b)?,
        all(|m| &m.c)?,
        all(|m| &m.d)?,
    ))
}
