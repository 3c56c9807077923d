//! A law as C, and what it must answer.

use crate::arrays::{rows, vector};
use crate::errors::refused;
use crate::simulate::spring_curve;
use forcefeel_export::controller::{ANSWERS, FLIGHT, Given, INPUTS, Job, answers};
use forcefeel_export::emit::Source;
use forcefeel_export::pair::{GivenPair, LINK_ANSWERS, PAIR_ANSWERS, Pair};
use forcefeel_export::trace::logic::Kind;
use forcefeel_model::cancellation::{CANCELLATION_NUMBERS, Cancellation};
use forcefeel_model::electronic_link::MOST_DELAY;
use forcefeel_model::link::{HALVINGS, LINK_ROWS};
use forcefeel_model::observer::{MOST_STATES, NUMBERS};
use forcefeel_model::parameters::COUNT;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// The parts of C that follow from the trace of a controller's period.
#[pyclass(frozen, get_all, module = "forcefeel._core")]
pub struct LawSource {
    /// Name of each state, and whether it is a flag.
    states: Vec<(String, bool)>,
    /// The inputs that it reads, and between which values.
    inputs: Vec<(String, (f64, f64))>,
    functions: Vec<String>,
    step: String,
    reset: String,
    hinge_moment: String,
    /// Members of what is the same in all settings, and what they hold.
    same: (String, Vec<String>),
    /// Members of a setting, and for each setting what they hold.
    own: (String, Vec<String>),
    operations: (usize, usize),
}

/// The parts of C that follow from the trace of an axis: law, feel and supervisor.
#[pyclass(frozen, get_all, module = "forcefeel._core")]
pub struct AxisSource {
    /// Name of each state, its kind (number, flag, word), and what it is where the axis is off.
    states: Vec<(String, &'static str, f64)>,
    functions: Vec<String>,
    /// Type and name of each value that passes between the functions of a period, and these, the period itself last.
    members: Vec<(String, String)>,
    period: String,
    /// Members of a setting, and for each setting what they hold.
    own: (String, Vec<String>),
    operations: usize,
}

/// A law with its feel on a digital controller, for one setting or many.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct ExportedLaw(Job);

#[pymethods]
impl ExportedLaw {
    /// Values of the parameter table and the law's numbers, a row each setting; a law has `states`, and runs every `period_s`. Of one
    /// setting rows of the feel are `tunable`: place in the table, least and greatest value.
    #[new]
    #[pyo3(signature = (values, observers, *, states, period_s, single, linked = false, tunable = Vec::new(), curve = None, cancellation = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of a Python class")]
    fn new(
        values: PyReadonlyArray2<'_, f64>,
        observers: PyReadonlyArray2<'_, f64>,
        states: usize,
        period_s: f64,
        single: bool,
        linked: bool,
        tunable: Vec<(usize, [f64; 2])>,
        curve: Option<(PyReadonlyArray1<'_, f64>, PyReadonlyArray2<'_, f64>)>,
        cancellation: Option<[f64; CANCELLATION_NUMBERS]>,
    ) -> PyResult<Self> {
        let (values, observers) = (rows::<COUNT>("values", &values)?, rows::<NUMBERS>("observers", &observers)?);
        if values.is_empty() || values.len() != observers.len() {
            return Err(refused(format!("observers: expected a row for each of {} settings", values.len())));
        }
        if !(1..=MOST_STATES).contains(&states) {
            return Err(refused(format!("states: expected 1 to {MOST_STATES}, got {states}")));
        }
        if !tunable.is_empty() && (values.len() > 1 || tunable.iter().any(|&(row, _)| row >= COUNT)) {
            return Err(refused("tunable: expected rows of the parameter table, and one setting"));
        }
        let period_s = crate::limits::step(period_s)?;
        let curve = curve.map(|(knots, coefficients)| spring_curve(&knots, &coefficients)).transpose()?;
        let cancellation = cancellation.as_ref().map(Cancellation::from_numbers);
        Ok(Self(Job { values, observers, states, curve, cancellation, period_s, linked, tunable, single }))
    }

    /// The law as C, whose names begin with `name`.
    fn source(&self, py: Python<'_>, name: &str) -> LawSource {
        let Source { states, inputs, functions, step, reset, hinge_moment, same, own, operations } =
            py.detach(|| Source::of(&self.0, name));
        let [same, own] = [same, own].map(|numbers| (numbers.members, numbers.values));
        LawSource { states, inputs, functions, step, reset, hinge_moment, same, own, operations }
    }

    /// Law, feel and supervisor as C, whose names begin with `name`.
    fn axis_source(&self, py: Python<'_>, name: &str) -> PyResult<AxisSource> {
        if !self.0.tunable.is_empty() {
            return Err(refused("axis: expected a law without tunable rows"));
        }
        let source = py.detach(|| forcefeel_export::axis::AxisSource::of(&self.0, name));
        let source = source.map_err(|refusal| refused(refusal.text()))?;
        let kind = |kind: Kind| match kind {
            Kind::Number => "number",
            Kind::Flag => "flag",
            Kind::Word => "word",
        };
        Ok(AxisSource {
            states: source.states.into_iter().map(|state| (state.name, kind(state.kind), state.first)).collect(),
            functions: source.functions,
            members: source.period.members,
            period: source.period.code,
            own: (source.own.members, source.own.values),
            operations: source.operations,
        })
    }

    /// Force, spring and damping (flights, 3) that the surface adds in flights and at angles (flights, 11), as the law's C computes them.
    fn added<'py>(&self, py: Python<'py>, flights: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flights = rows::<{ FLIGHT.len() }>("flights", &flights)?;
        PyArray1::from_vec(py, self.0.added(&flights).into_flattened()).reshape([flights.len(), 3])
    }

    /// Command, torque, displacement and rate of the feel (samples, 4) for `inputs` (samples, 11) in settings `from`, `to` (samples, 2),
    /// from rest at the first sample.
    fn answers<'py>(
        &self,
        py: Python<'py>,
        inputs: PyReadonlyArray2<'py, f64>,
        settings: Vec<(usize, usize)>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let inputs = rows::<{ INPUTS.len() }>("inputs", &inputs)?;
        let most = self.0.values.len();
        if settings.len() != inputs.len() || settings.iter().any(|&(from, to)| from >= most || to >= most) {
            return Err(refused(format!("settings: expected {} pairs of settings below {most}", inputs.len())));
        }
        let given: Vec<Given> =
            inputs.into_iter().zip(settings).map(|(inputs, settings)| Given { inputs, settings }).collect();
        let outputs = py.detach(|| answers(&self.0, &given));
        PyArray1::from_vec(py, outputs.into_flattened()).reshape([given.len(), ANSWERS])
    }
}

/// Two laws on an electronic link.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct ExportedPair(Pair);

#[pymethods]
impl ExportedPair {
    /// Two laws that are linked, of one period and precision; `values` of the link, in the order of its table.
    #[new]
    #[pyo3(signature = (first, second, values, *, delay, uncouples))]
    fn new(
        first: &ExportedLaw,
        second: &ExportedLaw,
        values: PyReadonlyArray1<'_, f64>,
        delay: usize,
        uncouples: bool,
    ) -> PyResult<Self> {
        let jobs = [first.0.clone(), second.0.clone()];
        let alike = jobs[0].period_s.to_bits() == jobs[1].period_s.to_bits() && jobs[0].single == jobs[1].single;
        if !alike || !jobs.iter().all(|job| job.linked) {
            return Err(refused("second: expected two linked laws of one period and one precision"));
        }
        if !(1..=MOST_DELAY).contains(&delay) {
            return Err(refused(format!("delay: expected 1 to {MOST_DELAY} periods, got {delay}")));
        }
        Ok(Self(Pair { jobs, values: vector::<LINK_ROWS>("values", &values)?, delay, uncouples }))
    }

    /// Steps of the search for where the middle rests.
    #[classattr]
    const HALVINGS: usize = HALVINGS;

    /// Bodies in C of a sample of the link and, with a middle, of a step of the search for where it rests; their names begin with `name`.
    fn source(&self, py: Python<'_>, name: &str) -> (String, Option<String>) {
        py.detach(|| self.0.source(name))
    }

    /// Answers (samples, 16) of a pair in the first settings: of both laws as `ExportedLaw.answers`, of the link as `link_answers`.
    ///
    /// `inputs` (samples, 27): of both laws, then hands, buttons and disconnect.
    fn answers<'py>(&self, py: Python<'py>, inputs: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        const LAWS: usize = 2 * INPUTS.len();
        let rows = rows::<{ LAWS + 5 }>("inputs", &inputs)?;
        let law = |inputs: &[f64]| Given { inputs: core::array::from_fn(|k| inputs[k]), settings: (0, 0) };
        let given: Vec<GivenPair> = rows
            .iter()
            .map(|row| GivenPair {
                laws: [law(row), law(&row[INPUTS.len()..])],
                hands: [row[LAWS], row[LAWS + 1]],
                pressed: [row[LAWS + 2] > 0.0, row[LAWS + 3] > 0.0],
                disconnect: row[LAWS + 4] > 0.0,
            })
            .collect();
        let answers = py.detach(|| self.0.answers(&given));
        PyArray1::from_vec(py, answers.into_flattened()).reshape([given.len(), PAIR_ANSWERS])
    }

    /// Force at each grip, damping on each feel, and 1 where each pilot has priority, where the link gives way, where it is open (samples, 8).
    ///
    /// `inputs` (samples, 9): angle and rate of both programmed controls, hands, buttons and disconnect.
    fn link_answers<'py>(
        &self,
        py: Python<'py>,
        inputs: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = rows::<9>("inputs", &inputs)?;
        let answers = py.detach(|| self.0.link_answers(&rows));
        PyArray1::from_vec(py, answers.into_flattened()).reshape([rows.len(), LINK_ANSWERS])
    }
}
