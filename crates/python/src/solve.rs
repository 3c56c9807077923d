//! The solvers.

use crate::arrays::{Matrix, matrix, to_numpy, values, vector};
use crate::errors::{refused, threads as answered};
use crate::limits::at_most;
use crate::model::Columns;
use forcefeel_model::parameters::{Feel, Parameters};
use forcefeel_solve::feel_transition::{feel_step, feel_transition};
use forcefeel_solve::frequency_response::frequency_response as response;
use forcefeel_solve::riccati::{Problem, Solution, Status, Stop, recursion as run};
use forcefeel_solve::schedule::{Plant, Time, schedule as gains};
use forcefeel_solve::stationary::{Stationary, stationary as stand_still};
use forcefeel_solve::unit_circle::inside;
use nalgebra::{Matrix4, Matrix4x2, RowVector4};
use numpy::Complex64;
use numpy::ndarray::ArrayView1;
use numpy::{PyArray1, PyArray3, PyArray4, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::prelude::*;

/// Most steps of a recursion: some two seconds of computing for the design plant.
pub const MOST_STEPS: usize = 10_000_000;

/// How recursion (22) ended, and its gains.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct Recursion(Solution);

#[pymethods]
impl Recursion {
    #[getter]
    fn gains<'py>(&self, py: Python<'py>) -> PyResult<Matrix<'py>> {
        to_numpy(py, &self.0.gains)
    }
    #[getter]
    fn cost<'py>(&self, py: Python<'py>) -> PyResult<Matrix<'py>> {
        to_numpy(py, &self.0.cost)
    }
    #[getter]
    fn steps(&self) -> usize {
        self.0.steps
    }
    #[getter]
    fn change(&self) -> f64 {
        self.0.change
    }
    #[getter]
    fn status(&self) -> &'static str {
        match self.0.status {
            Status::Converged => "converged",
            Status::Horizon => "horizon",
            Status::Moving => "moving",
            Status::Singular => "singular",
        }
    }
}

/// `([Phi], [H])` of a linear system over one step.
#[pyfunction]
pub fn discretize<'py>(
    py: Python<'py>,
    a: PyReadonlyArray2<'py, f64>,
    b: PyReadonlyArray2<'py, f64>,
    step: f64,
) -> PyResult<(Matrix<'py>, Matrix<'py>)> {
    let (n, m) = b.as_array().dim();
    let (phi, h) = forcefeel_solve::discretize(&matrix("a", &a, (n, n))?, &matrix("b", &b, (n, m))?, step);
    Ok((to_numpy(py, &phi)?, to_numpy(py, &h)?))
}

/// `exp(a)`.
#[pyfunction]
pub fn exponential<'py>(py: Python<'py>, a: PyReadonlyArray2<'py, f64>) -> PyResult<Matrix<'py>> {
    let n = a.as_array().nrows();
    to_numpy(py, &forcefeel_solve::exponential(&matrix("a", &a, (n, n))?))
}

/// The states (steps + 1, n) of `x_{k+1} = phi x_k + v_k` from `start` on, with `v_k` the rows of `inputs`.
#[pyfunction]
pub fn propagated<'py>(
    py: Python<'py>,
    phi: PyReadonlyArray2<'py, f64>,
    start: PyReadonlyArray1<'py, f64>,
    inputs: PyReadonlyArray2<'py, f64>,
) -> PyResult<Matrix<'py>> {
    let (steps, n) = inputs.as_array().dim();
    let start = values("start", &start, n)?;
    let (phi, inputs) = (matrix("phi", &phi, (n, n))?, inputs.as_array().iter().copied().collect::<Vec<_>>());
    let states = py.detach(|| forcefeel_solve::propagated(&phi, start.as_slice(), &inputs));
    PyArray1::from_vec(py, states).reshape([steps + 1, n])
}

/// `D^-1 a D` with a diagonal `D` of powers of two that makes rows and columns alike, and that diagonal.
#[pyfunction]
pub fn balanced<'py>(
    py: Python<'py>,
    a: PyReadonlyArray2<'py, f64>,
) -> PyResult<(Matrix<'py>, Bound<'py, PyArray1<f64>>)> {
    let n = a.as_array().nrows();
    let (like, diagonal) = forcefeel_solve::balanced(matrix("a", &a, (n, n))?);
    Ok((to_numpy(py, &like)?, PyArray1::from_slice(py, diagonal.as_slice())))
}

/// `c (p - a)^-1 b` at complex points `p`.
#[pyfunction]
pub fn frequency_response<'py>(
    py: Python<'py>,
    a: PyReadonlyArray2<'py, f64>,
    b: PyReadonlyArray1<'py, f64>,
    c: PyReadonlyArray1<'py, f64>,
    points: PyReadonlyArray1<'py, Complex64>,
) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
    let n = a.as_array().nrows();
    let (a, b, c) = (matrix("a", &a, (n, n))?, values("b", &b, n)?, values("c", &c, n)?);
    let points: Vec<_> = points.as_array().iter().copied().collect();
    Ok(PyArray1::from_vec(py, py.detach(|| response(a, &b, &c, points.into_iter()))))
}

/// Recursion (22) over a horizon of `steps`, or with a `tolerance` until the gains stand still, at most `steps`.
#[pyfunction]
pub fn recursion(
    py: Python<'_>,
    phi: PyReadonlyArray2<'_, f64>,
    h: PyReadonlyArray2<'_, f64>,
    q: PyReadonlyArray2<'_, f64>,
    r: PyReadonlyArray2<'_, f64>,
    steps: usize,
    tolerance: Option<f64>,
) -> PyResult<Recursion> {
    at_most("steps", MOST_STEPS, steps)?;
    let problem = problem(&phi, &h, &q, &r)?;
    let stop = tolerance.map_or(Stop::Horizon(steps), |tolerance| Stop::StandStill { tolerance, most_steps: steps });
    Ok(Recursion(py.detach(|| run(&problem, stop))))
}

/// Cost at which recursion (22) stands still, and its residual; none if a state does not decay.
#[pyfunction]
pub fn stationary<'py>(
    py: Python<'py>,
    phi: PyReadonlyArray2<'py, f64>,
    h: PyReadonlyArray2<'py, f64>,
    q: PyReadonlyArray2<'py, f64>,
    r: PyReadonlyArray2<'py, f64>,
) -> PyResult<Option<(Matrix<'py>, f64)>> {
    let problem = problem(&phi, &h, &q, &r)?;
    let solution = stand_still(&problem);
    solution.map(|Stationary { cost, residual }| Ok((to_numpy(py, &cost)?, residual))).transpose()
}

fn problem(
    phi: &PyReadonlyArray2<'_, f64>,
    h: &PyReadonlyArray2<'_, f64>,
    q: &PyReadonlyArray2<'_, f64>,
    r: &PyReadonlyArray2<'_, f64>,
) -> PyResult<Problem> {
    let (n, m) = h.as_array().dim();
    if n == 0 || m == 0 {
        return Err(refused(format!("h: expected a state and an input at least, got {:?}", (n, m))));
    }
    Ok(Problem {
        phi: matrix("phi", phi, (n, n))?,
        h: matrix("h", h, (n, m))?,
        q: matrix("q", q, (n, n))?,
        r: matrix("r", r, (m, m))?,
    })
}

/// Gains of the feel states for each setting `[I, B, G]`, a row each.
#[pyfunction]
pub fn schedule<'py>(
    py: Python<'py>,
    closed: PyReadonlyArray2<'py, f64>,
    coupling: PyReadonlyArray2<'py, f64>,
    gain_row: PyReadonlyArray1<'py, f64>,
    period: Option<f64>,
    settings: PyReadonlyArray2<'py, f64>,
) -> PyResult<Matrix<'py>> {
    let plant = Plant {
        closed: Matrix4::from_iterator(matrix("closed", &closed, (4, 4))?.iter().copied()),
        coupling: Matrix4x2::from_iterator(matrix("coupling", &coupling, (4, 2))?.iter().copied()),
        gain_row: RowVector4::from_row_slice(&vector::<4>("gain_row", &gain_row)?),
        time: period.map_or(Time::Continuous, Time::Discrete),
    };
    let settings = feels(&settings)?;
    let rows = py.detach(|| gains(&plant, &settings));
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 2])
}

/// The feels of settings `[I, B, G]`, a row each.
pub fn feels(settings: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Feel<f64>>> {
    let settings = settings.as_array();
    if settings.ncols() != 3 {
        return Err(refused(format!("settings: expected columns I, B, G, got {}", settings.ncols())));
    }
    let plain = Parameters::elevator().feel;
    let of = |s: ArrayView1<'_, f64>| Feel {
        inertia: s[0],
        damping: s[1],
        stiffness: s[2],
        maximum_stiffness: s[2],
        ..plain
    };
    Ok(settings.outer_iter().map(of).collect())
}

/// Natural frequencies in rad/s and damping ratios of the feels of settings `[I, B, G]`, a row each.
#[pyfunction]
pub fn feel_frequencies<'py>(py: Python<'py>, settings: PyReadonlyArray2<'py, f64>) -> PyResult<Columns<'py>> {
    let (frequency, damping_ratio) = feels(&settings)?.iter().map(Feel::frequency).unzip();
    Ok((PyArray1::from_vec(py, frequency), PyArray1::from_vec(py, damping_ratio)))
}

/// `exp(W t)` (settings, times, 2, 2) of the unforced feel of each setting `[I, B, G]`, on its displacement and its rate.
#[pyfunction]
pub fn feel_transitions<'py>(
    py: Python<'py>,
    settings: PyReadonlyArray2<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray4<f64>>> {
    let feels = feels(&settings)?;
    let times: Vec<f64> = times.as_array().iter().copied().collect();
    let mut numbers = Vec::with_capacity(4 * feels.len() * times.len());
    for feel in &feels {
        for &t in &times {
            numbers.extend_from_slice(feel_transition(feel, t).transpose().as_slice());
        }
    }
    PyArray1::from_vec(py, numbers).reshape([feels.len(), times.len(), 2, 2])
}

/// `[Phi, Gamma]` (settings, 2, 3) of the feel of each setting `[I, B, G]` over a period under a torque that stays.
#[pyfunction]
pub fn feel_steps<'py>(
    py: Python<'py>,
    settings: PyReadonlyArray2<'py, f64>,
    period: f64,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let feels = feels(&settings)?;
    let numbers: Vec<f64> =
        feels.iter().flat_map(|feel| feel_step(feel, period).transpose().as_slice().to_vec()).collect();
    PyArray1::from_vec(py, numbers).reshape([feels.len(), 2, 3])
}

/// For each of `matrices` (count, n, n) 1 if all its eigenvalues are inside the unit circle, 0 if not, -1 where its powers do not tell.
#[pyfunction]
pub fn inside_unit_circle<'py>(
    py: Python<'py>,
    matrices: PyReadonlyArray3<'py, f64>,
    threads: usize,
) -> PyResult<Bound<'py, PyArray1<i8>>> {
    let view = matrices.as_array();
    let (_, n, columns) = view.dim();
    if n != columns {
        return Err(refused(format!("matrices: expected as many columns as rows, got {:?}", view.dim())));
    }
    let numbers: Vec<f64> = view.iter().copied().collect();
    let verdicts = answered(py.detach(|| inside(&numbers, n, threads)))?;
    Ok(PyArray1::from_iter(py, verdicts.into_iter().map(|verdict| verdict.map_or(-1, i8::from))))
}
