//! Features of releases.

use crate::arrays::rows;
use crate::errors::{refused, threads as answered};
use crate::limits::{at_least_zero, at_most, rising};
use forcefeel_solve::release::{FEATURE_GROUPS, FEATURES, Measuring, Release};
use forcefeel_solve::release_verdict::{Base, Measured, Quantity, ReleaseTest, TOLERANCE_NUMBERS, Tolerance, names};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

type Groups = Vec<(&'static str, usize, &'static str)>;
type Array<'py> = Bound<'py, PyArray2<f64>>;

/// Name, columns and quantity (x as the position, s, none) of each group of features, in order.
#[pyfunction]
pub fn release_feature_groups() -> Groups {
    FEATURE_GROUPS.to_vec()
}

/// How releases are measured: see `forcefeel_solve::release`.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct ReleaseMeasuring {
    time: Vec<f64>,
    held: usize,
    free: usize,
    tail: usize,
    /// Residual band, upper and lower share.
    shares: [f64; 3],
    reach: f64,
    hysteresis: f64,
}

impl ReleaseMeasuring {
    fn measuring(&self) -> Measuring<'_> {
        let [band, high, low] = self.shares;
        Measuring {
            time: &self.time,
            held: self.held,
            free: self.free,
            tail: self.tail,
            band,
            high,
            low,
            reach: self.reach,
            hysteresis: self.hysteresis,
        }
    }

    fn check(&self, samples: usize) -> PyResult<()> {
        if samples == self.time.len() {
            return Ok(());
        }
        Err(refused(format!("position: expected {} samples, got {samples}", self.time.len())))
    }
}

#[pymethods]
impl ReleaseMeasuring {
    #[new]
    #[pyo3(signature = (time, shares, *, tail, held = 1, free = 0, reach = 0.0, hysteresis = 0.0))]
    fn new(
        time: PyReadonlyArray1<'_, f64>,
        shares: [f64; 3],
        tail: usize,
        held: usize,
        free: usize,
        reach: f64,
        hysteresis: f64,
    ) -> PyResult<Self> {
        let time: Vec<f64> = time.as_array().iter().copied().collect();
        rising("time", &time)?;
        for (name, count) in [("tail", tail), ("held", held), ("free", free)] {
            at_most(name, time.len(), count)?;
        }
        for (name, size) in [("reach", reach), ("hysteresis", hysteresis)] {
            at_least_zero(name, size)?;
        }
        Ok(Self { time, held, free, tail, shares, reach, hysteresis })
    }

    /// The features (runs, features) of releases (runs, samples); not numbers where there are none.
    #[pyo3(signature = (position, threads = 1))]
    fn features<'py>(
        &self,
        py: Python<'py>,
        position: PyReadonlyArray2<'py, f64>,
        threads: usize,
    ) -> PyResult<Array<'py>> {
        let (runs, samples) = position.as_array().dim();
        self.check(samples)?;
        let view = position.as_array();
        let copied: Vec<f64>;
        // Row by row: the view gives no slice of an array that lies otherwise.
        let positions = if let Some(positions) = view.as_slice() {
            positions
        } else {
            copied = view.iter().copied().collect();
            &copied
        };
        let features = answered(py.detach(|| self.measuring().measure_all(positions, threads)))?;
        PyArray1::from_vec(py, features).reshape([runs, FEATURES])
    }

    /// Of one release (samples) four rows: the features, the slopes there, the deviations under white noise of deviation one, and
    /// what a simpler polynomial would leave out.
    fn details<'py>(&self, py: Python<'py>, position: PyReadonlyArray1<'py, f64>) -> PyResult<Array<'py>> {
        let position: Vec<f64> = position.as_array().iter().copied().collect();
        self.check(position.len())?;
        let Release { values, slopes, noise, last_terms } = self.measuring().measure(&position);
        PyArray1::from_vec(py, [values, slopes, noise, last_terms].concat()).reshape([4, FEATURES])
    }
}

type Verdicts<'py> = (Bound<'py, PyArray1<i8>>, Bound<'py, PyArray1<bool>>, Bound<'py, PyArray1<f64>>);

/// Quantities of tolerances, bases of their shares, and the quantities by which a release can fail, in order.
#[pyfunction]
pub fn release_rule_names() -> (Vec<&'static str>, Vec<&'static str>, Vec<String>) {
    (Quantity::NAMES.map(|(name, _)| name).to_vec(), Base::NAMES.map(|(name, _)| name).to_vec(), names())
}

/// Of releases with these features (runs, features) against a reference, one or one for each: place of the first failing quantity or -1,
/// whether it was evaluated, margin. `times`: when each side is let go, and recorded to.
#[pyfunction]
#[pyo3(signature = (values, reference, times, tolerances, *, rests_fall_times, by_rise_time = false))]
pub fn judge_releases<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    reference: PyReadonlyArray2<'py, f64>,
    times: [[f64; 2]; 2],
    tolerances: PyReadonlyArray2<'py, f64>,
    rests_fall_times: f64,
    by_rise_time: bool,
) -> PyResult<Verdicts<'py>> {
    let values = rows::<FEATURES>("values", &values)?;
    let reference = rows::<FEATURES>("reference", &reference)?;
    if reference.len() != 1 && reference.len() != values.len() {
        return Err(refused(format!("reference: expected 1 row or {}, got {}", values.len(), reference.len())));
    }
    let tolerances = rows::<TOLERANCE_NUMBERS>("tolerances", &tolerances)?;
    let tolerances: Option<Vec<Tolerance>> = tolerances.iter().map(Tolerance::of).collect();
    let tolerances = tolerances.ok_or_else(|| refused("tolerances: expected places of names of release_rule_names"))?;
    let overdamped = if by_rise_time { Quantity::RiseTime } else { Quantity::FallTime };
    let test = ReleaseTest { tolerances, rests_fall_times, overdamped };
    let verdicts: Vec<_> = py.detach(|| {
        let references = reference.iter().cycle();
        let measured = |values, [release_s, end_s]: [f64; 2]| Measured { values, release_s, end_s };
        let pairs = values.iter().zip(references);
        pairs.map(|(run, reference)| test.judge(&measured(run, times[0]), &measured(reference, times[1]))).collect()
    });
    let first =
        verdicts.iter().map(|verdict| verdict.first_failing.map_or(-1, |place| i8::try_from(place).unwrap_or(i8::MAX)));
    Ok((
        PyArray1::from_iter(py, first),
        PyArray1::from_iter(py, verdicts.iter().map(|verdict| verdict.evaluated)),
        PyArray1::from_iter(py, verdicts.iter().map(|verdict| verdict.margin)),
    ))
}
