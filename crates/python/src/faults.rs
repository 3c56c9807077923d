//! Faults injected into supervised loaders, and the table of safety functions.

use crate::arrays::rows;
use crate::errors::{refused, threads as answered};
use crate::model::drive_of;
use forcefeel_faults::fault::Kind;
use forcefeel_faults::oracle::Outcome;
use forcefeel_faults::pair::{Joint, PairOutcome};
use forcefeel_faults::run::Loaders;
use forcefeel_model::link::LINK_ROWS;
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::supervisor::{Function, Limits};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// Columns of the outcomes: numbers, -1 where there is none.
const COLUMNS: usize = 14;
/// Those of a pair.
const PAIR_COLUMNS: usize = 4 + 2 * COLUMNS;

/// A row of the table of safety functions.
type Row = (&'static str, &'static str, u32, bool, &'static str);

/// Name, what it does, samples, whether it is latched, and sentence of each safety function of a loader with these values.
#[pyfunction]
pub fn safety_functions(values: PyReadonlyArray1<'_, f64>, drive: &str, period_s: f64) -> PyResult<Vec<Row>> {
    let values = crate::arrays::vector::<COUNT>("values", &values)?;
    let limits = Limits::new(&Parameters::from_values(&values), drive_of(drive)?, period_s)
        .map_err(|refusal| refused(refusal.text().to_string()))?;
    let row = |f: &Function| (f.name(), f.action().text(), f.samples(&limits), f.latched(), f.sentence());
    Ok(Function::ALL.iter().map(row).collect())
}

/// Names of the kinds of fault.
#[pyfunction]
pub fn fault_kinds() -> Vec<String> {
    Kind::ALL.iter().map(|kind| format!("{kind:?}")).collect()
}

/// Values and laws of loaders, a row for each.
type Rows = (Vec<[f64; COUNT]>, Option<Vec<[f64; NUMBERS]>>);

fn loaders_of(values: &PyReadonlyArray2<'_, f64>, observers: Option<&PyReadonlyArray2<'_, f64>>) -> PyResult<Rows> {
    let values = rows::<COUNT>("values", values)?;
    let observers = observers.map(|numbers| rows::<NUMBERS>("observers", numbers)).transpose()?;
    if values.is_empty() || observers.as_ref().is_some_and(|laws| laws.len() != values.len()) {
        return Err(refused(format!(
            "observers: expected {} rows, one for each loader, and one loader at least",
            values.len()
        )));
    }
    Ok((values, observers))
}

/// Outcomes (cases, 14) of so many faults, 0 to 2 a case, in supervised loaders with these values and laws: both kinds, the samples at which
/// the loader had to be stopped, was stopped and was safe, what went wrong as bits, energy to the hand and its bound in J, the function that
/// was due and the one that is named, how long in s the force at the grip is above 1.5 times the largest legal one, the largest force in N, the
/// energy to the hand in J beyond what the feel gives, and the loader; -1 where there is none.
#[pyfunction]
#[pyo3(signature = (values, observers = None, *, seed = 0, first = 0, count = 1000, faults = 1, threads = 1))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn supervised_faults<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    observers: Option<PyReadonlyArray2<'py, f64>>,
    seed: u64,
    first: u64,
    count: u64,
    faults: u8,
    threads: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (values, observers) = loaders_of(&values, observers.as_ref())?;
    let loaders = Loaders { values: &values, observers: observers.as_deref() };
    let outcomes = answered(py.detach(|| loaders.outcomes(seed, (first, count), faults, threads)))?;
    let numbers: Option<Vec<[f64; COLUMNS]>> = outcomes.iter().map(|outcome| outcome.as_ref().map(numbers)).collect();
    PyArray1::from_vec(py, numbers.ok_or_else(not_supervised)?.into_flattened()).reshape([outcomes.len(), COLUMNS])
}

fn not_supervised() -> PyErr {
    refused("values: a loader has no period, or its drive's largest command no end".to_string())
}

/// Places of both loaders, values, periods of delay or none of a shaft, and whether it stays open once it has given way.
#[derive(FromPyObject)]
pub struct JointOf([usize; 2], [f64; LINK_ROWS], Option<usize>, bool);

/// Outcomes (cases, 32) of so many faults, 0 to 2 a case, on one side of two loaders on a link: which link, which side has the faults, the
/// largest force of the link at the grip of the other in N from the fault on, its largest step in a period, and the outcomes of both sides as
/// of `supervised_faults`.
#[pyfunction]
#[pyo3(signature = (values, observers, links, *, seed = 0, first = 0, count = 1000, faults = 1, threads = 1))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn supervised_pair_faults<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    observers: Option<PyReadonlyArray2<'py, f64>>,
    links: Vec<JointOf>,
    seed: u64,
    first: u64,
    count: u64,
    faults: u8,
    threads: usize,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (values, observers) = loaders_of(&values, observers.as_ref())?;
    if links.is_empty() || links.iter().flat_map(|link| link.0).any(|place| place >= values.len()) {
        return Err(refused("links: expected one or more, each between two of the loaders".to_string()));
    }
    let joint = |JointOf(between, values, delay, uncouples)| Joint { between, values, delay, uncouples };
    let joints: Vec<_> = links.into_iter().map(joint).collect();
    let loaders = Loaders { values: &values, observers: observers.as_deref() };
    let outcomes = answered(py.detach(|| loaders.pair_outcomes(&joints, seed, (first, count), faults, threads)))?;
    let rows: Option<Vec<[f64; PAIR_COLUMNS]>> =
        outcomes.iter().map(|outcome| outcome.as_ref().map(pair_numbers)).collect();
    PyArray1::from_vec(py, rows.ok_or_else(not_supervised)?.into_flattened()).reshape([outcomes.len(), PAIR_COLUMNS])
}

#[expect(clippy::cast_precision_loss, reason = "small numbers")]
fn pair_numbers(outcome: &PairOutcome) -> [f64; PAIR_COLUMNS] {
    let mut row = [0.0; PAIR_COLUMNS];
    let [force, step] = outcome.force;
    row[..4].copy_from_slice(&[outcome.joint as f64, outcome.faulty as f64, force, step]);
    for (columns, side) in row[4..].chunks_exact_mut(COLUMNS).zip(&outcome.sides) {
        columns.copy_from_slice(&numbers(side));
    }
    row
}

#[expect(clippy::cast_precision_loss, reason = "numbers of samples")]
fn numbers(outcome: &Outcome) -> [f64; COLUMNS] {
    let at = |sample: Option<usize>| sample.map_or(-1.0, |k| k as f64);
    let of = |function: Option<Function>| function.map_or(-1.0, |function| f64::from(function as u8));
    let [first, second] = outcome.kinds.map(|kind| kind as f64);
    let [given, bound] = outcome.energy;
    let Outcome { due, stopped, safe, wrong, due_to, cause, .. } = *outcome;
    let wrong = f64::from(wrong.bits());
    [
        first,
        second,
        at(due),
        at(stopped),
        at(safe),
        wrong,
        given,
        bound,
        of(due_to),
        of(cause),
        outcome.above,
        outcome.force,
        outcome.excess,
        outcome.loader as f64,
    ]
}
