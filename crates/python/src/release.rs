//! Features of releases.

use crate::errors::{refused, threads as answered};
use crate::limits::{at_least_zero, at_most, rising};
use forcefeel_solve::release::{FEATURE_GROUPS, FEATURES, Measuring, Release};
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
