//! Many linear loops: their stability, their poles, their runs.

use crate::arrays::{rows, vector};
use crate::errors::{refused, threads as answered};
use crate::limits::step;
use crate::model::GainLaw;
use forcefeel_model::compensator::Compensator as Compensation;
use forcefeel_model::parameters::COUNT;
use forcefeel_solve::law::Law;
use forcefeel_solve::linear_batch::LinearJob;
use forcefeel_solve::loops::{Loops as Many, STATES};
use forcefeel_solve::outputs::OUTPUTS;
use forcefeel_solve::start::Start;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray3};
use pyo3::prelude::*;

/// Loops that share what `common` says but for the parameters in `columns`, of which `varied` has a row for each.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct Loops {
    common: [f64; COUNT],
    columns: Vec<usize>,
    varied: Vec<f64>,
    count: usize,
    law: Option<Compensation<f64>>,
    gains: Option<Vec<[f64; 7]>>,
}

impl Loops {
    pub(crate) fn many(&self) -> Many<'_> {
        let law = match (&self.gains, &self.law) {
            (Some(gains), _) => Law::Gains(gains),
            (None, Some(law)) => Law::Fixed(*law),
            (None, None) => Law::Original,
        };
        let Self { common, columns, varied, count, .. } = self;
        Many { common, columns, varied, count: *count, law }
    }
}

#[pymethods]
impl Loops {
    #[new]
    #[pyo3(signature = (common, columns, varied, *, law = None, gains = None))]
    fn new(
        common: PyReadonlyArray1<'_, f64>,
        columns: Vec<usize>,
        varied: PyReadonlyArray2<'_, f64>,
        law: Option<&GainLaw>,
        gains: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Self> {
        let (count, width) = varied.as_array().dim();
        if width != columns.len() || count == 0 || columns.iter().any(|&column| column >= COUNT) {
            return Err(refused(format!(
                "varied: expected a row of {} values, of parameters below {COUNT}, for each loop, got shape {:?}",
                columns.len(),
                (count, width)
            )));
        }
        let gains = gains.map(|gains| rows::<7>("gains", &gains)).transpose()?;
        if gains.as_ref().is_some_and(|gains| gains.len() != count) {
            return Err(refused(format!("gains: expected {count} rows")));
        }
        Ok(Self {
            common: vector::<COUNT>("common", &common)?,
            columns,
            // Row by row, however the array lies in memory.
            varied: varied.as_array().iter().copied().collect(),
            count,
            law: law.map(GainLaw::law),
            gains,
        })
    }

    /// A code for each loop: 0 unstable, 1 stable, both proved; 2 unstable, 3 stable, by computed poles; 4 not made of numbers.
    fn stability<'py>(&self, py: Python<'py>, threads: usize) -> PyResult<Bound<'py, PyArray1<u8>>> {
        let verdicts = answered(py.detach(|| self.many().stability(threads)))?;
        Ok(PyArray1::from_iter(py, verdicts.into_iter().map(|verdict| verdict as u8)))
    }

    /// Poles (loops, states, 2), real and imaginary part, in no order; not numbers where the matrix is not made of numbers.
    fn poles<'py>(&self, py: Python<'py>, threads: usize) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let poles = answered(py.detach(|| self.many().poles(threads)))?;
        let parts = poles.into_flattened().into_iter().flat_map(|pole| [pole.re, pole.im]);
        PyArray1::from_iter(py, parts).reshape([self.count, STATES, 2])
    }

    /// Fills `histories` (loops, outputs, samples) with the exact runs under `force` (steps, 2).
    #[pyo3(signature = (histories, force, step_s, *, every, outputs, force_scale, start_force, held, threads))]
    #[expect(clippy::too_many_arguments, reason = "keywords of a Python method")]
    fn run(
        &self,
        py: Python<'_>,
        mut histories: PyReadwriteArray3<'_, f64>,
        force: PyReadonlyArray2<'_, f64>,
        step_s: f64,
        every: usize,
        outputs: Vec<usize>,
        force_scale: Option<PyReadonlyArray1<'_, f64>>,
        start_force: f64,
        held: Option<(f64, usize)>,
        threads: usize,
    ) -> PyResult<()> {
        let force = rows::<2>("force", &force)?;
        let force_scale: Option<Vec<f64>> = force_scale.map(|scale| scale.as_array().iter().copied().collect());
        if force_scale.as_ref().is_some_and(|scale| scale.len() != self.count) {
            return Err(refused(format!("force_scale: expected {} values", self.count)));
        }
        if every == 0 || !force.len().is_multiple_of(every) || outputs.iter().any(|&output| output >= OUTPUTS.len()) {
            return Err(refused("every, outputs: expected a divisor of the steps and places of outputs"));
        }
        let job = LinearJob {
            loops: self.many(),
            force_scale: force_scale.as_deref(),
            force: &force,
            step_s: step(step_s)?,
            start: held.map_or(Start::Under(start_force), |(angle, until)| Start::Held(angle, until)),
            every,
            outputs: &outputs,
        };
        let expected = (self.count, outputs.len(), job.samples());
        let shape = histories.as_array().dim();
        let mut view = histories.as_array_mut();
        let room = view.as_slice_mut().filter(|_| shape == expected);
        let Some(room) = room else {
            return Err(refused(format!("histories: expected shape {expected:?} in order, got {shape:?}")));
        };
        answered(py.detach(|| job.run(threads, room)))?;
        Ok(())
    }
}
