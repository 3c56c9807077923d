//! Releases of many linear loops: stable or not, and the column's angle over time.

use crate::errors::{refused, threads as answered};
use crate::limits::step;
use crate::loops::Loops;
use forcefeel_solve::releases::Releases;
use numpy::{PyArray1, PyReadwriteArray2};
use pyo3::prelude::*;

/// Fills `angles` (loops, samples) with the column's angle from a release at `angle` on, and returns a code for each loop as
/// `Loops.stability` does; the arm is that of each loop's own parameters. Not numbers where the loop is not stable.
#[pyfunction]
pub fn released<'py>(
    py: Python<'py>,
    loops: &Loops,
    mut angles: PyReadwriteArray2<'_, f64>,
    angle: f64,
    step_s: f64,
    threads: usize,
) -> PyResult<Bound<'py, PyArray1<u8>>> {
    let loops = loops.many();
    let (count, samples) = angles.as_array().dim();
    let mut view = angles.as_array_mut();
    let room = view.as_slice_mut().filter(|_| count == loops.count);
    let Some(room) = room else {
        return Err(refused(format!("angles: expected {} rows in order, got {count}", loops.count)));
    };
    let job = Releases { loops, angle, step_s: step(step_s)?, samples };
    let verdicts = answered(py.detach(|| job.run(threads, room)))?;
    Ok(PyArray1::from_iter(py, verdicts.into_iter().map(|verdict| verdict as u8)))
}
