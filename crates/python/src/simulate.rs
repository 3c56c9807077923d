//! Runs in time.

use crate::arrays::{rows, vector};
use crate::errors::{refused, threads as answered};
use crate::laws::{Laws, NamedLaw, check_runs, effects_of};
use crate::limits::{at_least_zero, at_most, rising, step, timing as in_steps};
use crate::model::drive_of;
use crate::slopes::check_keys;
use forcefeel_batch::periods::periods;
use forcefeel_model::cancellation::{CANCELLATION_NUMBERS, Cancellation};
use forcefeel_model::channels::CHANNELS;
use forcefeel_model::controller::Timing;
use forcefeel_model::curve::Curve;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Inputs, Shared};
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::surface::{FLIGHT, FlightState};
use forcefeel_simulate::batch::{Change, Job, Sampling};
use forcefeel_simulate::measures::{Peaks, Samples, measure, measures};
use forcefeel_slopes::periods::Periods;
use forcefeel_slopes::record_slopes::SlopeJob;
use forcefeel_slopes::sampled_loops::{INPUTS, SampledLoops};
use forcefeel_solve::feel_alone::feel_alone;
use forcefeel_solve::law::Law;
use forcefeel_solve::outputs::{ELECTRIC_OUTPUTS, OUTPUTS, Output, outputs};
use forcefeel_solve::start::Start;
use numpy::{PyArray1, PyArray2, PyArray3, PyArray4, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use std::collections::BTreeMap;

type Names = Vec<(&'static str, &'static str)>;
type Arrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>);
/// Histories and their slopes.
type Sloped<'py> = (Bound<'py, PyArray3<f64>>, Bound<'py, PyArray4<f64>>);
/// Begin, end, the values and the observer that hold afterwards.
type ChangeOf<'py> = (usize, usize, PyReadonlyArray1<'py, f64>, Option<PyReadonlyArray1<'py, f64>>);

/// Name and SI unit of each output of a run of a loader with this drive.
#[pyfunction]
#[pyo3(signature = (drive = "hydraulic"))]
pub fn simulation_outputs(drive: &str) -> PyResult<Names> {
    Ok(outputs(drive_of(drive)?).to_vec())
}

/// Name and SI unit of each measure of a run of a loader with this drive.
#[pyfunction]
#[pyo3(signature = (drive = "hydraulic"))]
pub fn simulation_measures(drive: &str) -> PyResult<Names> {
    Ok(measures(drive_of(drive)?))
}

/// The measures of one run from its outputs (outputs, samples), a sample every `dt` seconds, whose last force holds the column at `rest`;
/// from the sample `free` on it is free.
#[pyfunction]
#[pyo3(signature = (outputs, dt, rest, *, free = 0, noise = 0.0))]
pub fn simulation_measure<'py>(
    py: Python<'py>,
    outputs: PyReadonlyArray2<'py, f64>,
    dt: f64,
    rest: f64,
    free: usize,
    noise: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let outputs = outputs.as_array();
    if outputs.nrows() != OUTPUTS.len() || outputs.ncols() < 2 {
        return Err(refused(format!("outputs: expected {} rows, got {:?}", OUTPUTS.len(), outputs.dim())));
    }
    at_most("free", outputs.ncols(), free)?;
    at_least_zero("noise", noise)?;
    let row = |output: Output| outputs.row(output as usize);
    let angle = row(Output::ColumnAngle).to_vec();
    let demand = [Output::ThirdSignal, Output::FirstSignal, Output::SecondSignal].map(row);
    let mut peaks = Peaks::new(0.0);
    for (k, &angle) in angle.iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a number of samples, far below 2^52")]
        peaks.see(angle, angle, [0, 1, 2].map(|j| demand[j][k]), k as f64 * dt);
    }
    let samples = Samples { dt, free, noise };
    Ok(PyArray1::from_slice(py, &measure((), &angle, &samples, &peaks, |_, _| rest).values()))
}

/// What stays the same over the runs of a simulation.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct Simulation {
    step_s: f64,
    sampling: Sampling,
    outputs: Vec<usize>,
    inputs: Vec<Inputs>,
    flights: Vec<[FlightState; 2]>,
    start: Start,
    timing: Option<Timing>,
    curve: Option<Curve>,
    cancellation: Option<Cancellation>,
    changes: Vec<Change>,
    /// Trim, a factor on the spring, the shaker or a flight is among the inputs.
    stirred: bool,
    /// There is a test signal or a command signal among the inputs.
    tested: bool,
}

#[pymethods]
impl Simulation {
    /// A sample every so many steps, or two a step where `every` is zero.
    ///
    /// `inputs`: by name (steps, 2), at the start and at the end of each step; of those that are not given there is nothing.
    #[new]
    #[pyo3(signature = (inputs, step_s, *, every = 1, outputs = vec![], start_force = 0.0, held = None, timing = None, curve = None, cancellation = None, changes = vec![]))]
    #[expect(clippy::too_many_arguments, reason = "keywords of a Python class")]
    fn new(
        inputs: BTreeMap<String, PyReadonlyArray2<'_, f64>>,
        step_s: f64,
        every: usize,
        outputs: Vec<usize>,
        start_force: f64,
        held: Option<(f64, usize)>,
        timing: Option<(usize, usize)>,
        curve: Option<(PyReadonlyArray1<'_, f64>, PyReadonlyArray2<'_, f64>)>,
        cancellation: Option<[f64; CANCELLATION_NUMBERS]>,
        changes: Vec<ChangeOf<'_>>,
    ) -> PyResult<Self> {
        outputs.iter().try_for_each(|&output| at_most("outputs", ELECTRIC_OUTPUTS.len() - 1, output))?;
        let mut done = 0;
        let changes = changes.iter().map(|(begin, end, values, observer)| {
            if *begin < done || end <= begin {
                return Err(refused("changes: expected each to begin where the one before is done, and to last"));
            }
            done = *end;
            let observer = observer.as_ref().map(|numbers| vector::<NUMBERS>("changes", numbers)).transpose()?;
            Ok(Change { steps: (*begin, *end), values: vector::<COUNT>("changes", values)?, observer })
        });
        let (inputs, flights) = steps(&inputs)?;
        let still = |step: &Inputs| {
            let Inputs { trim, stiffness_factor, shaker, added_force, added_stiffness, added_damping, .. } = *step;
            let beside = [added_force, added_stiffness, added_damping];
            (trim, stiffness_factor, shaker, beside) == ([0.0; 2], [1.0; 2], [0.0; 2], [[0.0; 2]; 3])
        };
        Ok(Self {
            stirred: !flights.is_empty() || !inputs.iter().all(still),
            tested: inputs
                .iter()
                .flat_map(|step| [step.test_signal, step.command_signal])
                .flatten()
                .any(|volts| volts != 0.0),
            step_s: step(step_s)?,
            sampling: if every == 0 { Sampling::Halves } else { Sampling::Every(every) },
            outputs,
            inputs,
            flights,
            start: held.map_or(Start::Under(start_force), |(angle, until)| Start::Held(angle, until)),
            timing: timing.map(in_steps).transpose()?,
            curve: curve.map(|(knots, coefficients)| spring_curve(&knots, &coefficients)).transpose()?,
            cancellation: cancellation.as_ref().map(Cancellation::from_numbers),
            changes: changes.collect::<PyResult<_>>()?,
        })
    }

    /// Measures (runs, measures) and histories (runs, outputs, samples) of the loaders with these values, a row each.
    #[pyo3(signature = (values, *, law = None, gains = None, observers = None, force_scale = None, seed = 0, first_run = None, angle_noise = 0.0, threads = 1))]
    #[expect(clippy::too_many_arguments, reason = "keywords of a Python method")]
    fn run<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'py, f64>,
        law: Option<NamedLaw>,
        gains: Option<PyReadonlyArray2<'py, f64>>,
        observers: Option<PyReadonlyArray2<'py, f64>>,
        force_scale: Option<PyReadonlyArray1<'py, f64>>,
        seed: u64,
        first_run: Option<u64>,
        angle_noise: f64,
        threads: usize,
    ) -> PyResult<Arrays<'py>> {
        at_least_zero("angle_noise", angle_noise)?;
        let values = rows::<COUNT>("values", &values)?;
        let runs = values.len();
        let laws = Laws::of(law, gains.as_ref(), observers.as_ref(), runs)?;
        let law = laws.law();
        let force_scale: Option<Vec<f64>> = force_scale.map(|scale| scale.as_array().iter().copied().collect());
        check_runs("force_scale", force_scale.as_ref().map(Vec::len), runs)?;
        let noise = (seed, first_run);
        let job = Job { force_scale: force_scale.as_deref(), noise, angle_noise, ..self.job(&values, law) };
        // NumPy's memory, which it asks the system for in large pages: a third of the time of a short run otherwise.
        let histories = PyArray3::zeros(py, [runs, self.outputs.len(), job.samples()], false);
        let mut writable = histories.readwrite();
        let into = writable.as_slice_mut()?;
        let measures = answered(py.detach(|| forcefeel_batch::run(&job, threads, into)))?;
        drop(writable);
        Ok((
            PyArray1::from_vec(py, measures.into_flattened())
                .reshape([runs, forcefeel_simulate::measures::MEASURES.len()])?,
            histories,
        ))
    }

    /// Channels (runs, channels, samples) of the loaders with these values, and their slopes (runs, keys, channels, samples) along the
    /// parameters at `keys`.
    #[pyo3(signature = (values, keys, *, channels, law = None, observers = None, threads = 1))]
    #[expect(clippy::too_many_arguments, reason = "keywords of a Python method")]
    fn slopes<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray2<'py, f64>,
        keys: Vec<usize>,
        channels: Vec<usize>,
        law: Option<NamedLaw>,
        observers: Option<PyReadonlyArray2<'py, f64>>,
        threads: usize,
    ) -> PyResult<Sloped<'py>> {
        let values = rows::<COUNT>("values", &values)?;
        check_keys(&keys)?;
        if keys.is_empty() {
            return Err(refused("keys: expected one at least; run gives the histories alone"));
        }
        if let Some(channel) = channels.iter().find(|&&channel| channel >= CHANNELS.len()) {
            return Err(refused(format!(
                "channels: expected places of channels below {}, got {channel}",
                CHANNELS.len()
            )));
        }
        let laws = Laws::of(law, None, observers.as_ref(), values.len())?;
        let job = SlopeJob { job: self.job(&values, laws.law()), keys: &keys, channels: &channels };
        let shape = [values.len(), channels.len(), job.job.samples()];
        let slopes = PyArray4::zeros(py, [shape[0], keys.len(), shape[1], shape[2]], false);
        let mut writable = slopes.readwrite();
        let into = writable.as_slice_mut()?;
        let histories = answered(py.detach(|| job.run(threads, into)))?;
        drop(writable);
        Ok((PyArray1::from_vec(py, histories).reshape(shape)?, slopes))
    }

    /// Angles (steps + 1) of the programmed feel alone of a loader with these values, in parts of a step no longer than so much.
    fn feel_alone<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray1<'py, f64>,
        longest_s: f64,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let values = vector::<COUNT>("values", &values)?;
        let parts = (self.step_s / longest_s).ceil();
        if !(1.0..=MOST_PARTS).contains(&parts) {
            return Err(refused(format!(
                "longest_s: expected the {} s of a step or less, down to a {MOST_PARTS}th, got {longest_s}",
                self.step_s
            )));
        }
        let effects = Effects { surroundings: self.stirred, ..Effects::of(&values) };
        let shared = Shared { effects, step_s: self.step_s, timing: None, curve: self.curve, cancellation: None };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number within bounds")]
        let angles = py.detach(|| {
            feel_alone(
                &Parameters::from_values(&values),
                &shared,
                self.start,
                (&self.inputs, &self.flights),
                parts as usize,
            )
        });
        Ok(PyArray1::from_vec(py, angles))
    }
}

/// Parts into which a step may be cut.
const MOST_PARTS: f64 = 1e6;

impl Simulation {
    /// Steps between samples; a run beside this one has as many, of the same length.
    pub fn every_beside(&self, other: &Self) -> PyResult<usize> {
        let period = |timing: Timing| timing.period;
        let pace = |run: &Self| (run.step_s, run.sampling, run.timing.map(period), run.inputs.len());
        match self.sampling {
            Sampling::Every(every) if pace(self) == pace(other) => Ok(every),
            _ => Err(refused(
                "second: expected step, period, samples and length of the first, and whole steps between samples",
            )),
        }
    }

    pub fn job<'a>(&'a self, values: &'a [[f64; COUNT]], law: Law<'a>) -> Job<'a> {
        let all = self.changes.iter().map(|change| &change.values).chain(values);
        let mut effects = effects_of(all, &law);
        (effects.surroundings, effects.test_signal, effects.excited) = (self.stirred, self.tested, self.tested);
        Job {
            shared: Shared {
                effects,
                step_s: self.step_s,
                timing: self.timing,
                curve: self.curve,
                cancellation: self.cancellation,
            },
            start: self.start,
            inputs: &self.inputs,
            flights: &self.flights,
            values,
            law,
            force_scale: None,
            changes: &self.changes,
            noise: (0, Some(0)),
            angle_noise: 0.0,
            sampling: self.sampling,
            outputs: &self.outputs,
        }
    }
}

/// Places of the states that are kept, and the matrices (loops, states, states + 2) of a period of each loader under a digital
/// controller: `x+ = M x + b_e e_C + b_F F_p`.
#[pyfunction]
#[pyo3(signature = (values, step_s, timing, *, law = None, gains = None, observers = None, threads = 1))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn sampled_loops<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    step_s: f64,
    timing: (usize, usize),
    law: Option<NamedLaw>,
    gains: Option<PyReadonlyArray2<'py, f64>>,
    observers: Option<PyReadonlyArray2<'py, f64>>,
    threads: usize,
) -> PyResult<(Vec<usize>, Bound<'py, PyArray3<f64>>)> {
    let values = rows::<COUNT>("values", &values)?;
    let laws = Laws::of(law, gains.as_ref(), observers.as_ref(), values.len())?;
    let law = laws.law();
    let (step_s, timing) = (step(step_s)?, in_steps(timing)?);
    let loops = SampledLoops { effects: effects_of(values.iter(), &law), step_s, timing, values: &values, law };
    let Periods { states, matrices } = answered(py.detach(|| periods(&loops, threads)))?;
    let shape = [values.len(), states.len(), states.len() + INPUTS];
    Ok((states, PyArray1::from_vec(py, matrices).reshape(shape)?))
}

/// The inputs of each step, and the flight's states where there is one.
pub(crate) fn steps(
    given: &BTreeMap<String, PyReadonlyArray2<'_, f64>>,
) -> PyResult<(Vec<Inputs>, Vec<[FlightState; 2]>)> {
    let count = given.values().next().map_or(0, |input| input.as_array().nrows());
    if count == 0 {
        return Err(refused("inputs: expected an input and a step at least"));
    }
    let mut steps = vec![Inputs::NONE; count];
    for (name, input) in given {
        let input = input.as_array();
        if input.dim() != (count, 2) {
            let shape = input.dim();
            return Err(refused(format!(
                "inputs: {name}: expected shape {:?} as of the others, got {shape:?}",
                (count, 2)
            )));
        }
        if FLIGHT.contains(&name.as_str()) {
            continue;
        }
        let Some(place) = Inputs::place(name) else {
            let names = [Inputs::NAMES, &FLIGHT].concat().join(", ");
            return Err(refused(format!("inputs: expected names out of {names}, got {name:?}")));
        };
        for (step, row) in steps.iter_mut().zip(input.outer_iter()) {
            *place(step) = [row[0], row[1]];
        }
    }
    let flown: Vec<_> = FLIGHT.iter().filter_map(|&name| given.get(name)).collect();
    let state = |step: usize, side: usize| {
        FlightState::from_numbers(core::array::from_fn(|k| flown[k].as_array()[[step, side]]))
    };
    match flown.len() {
        0 => Ok((steps, vec![])),
        10 => Ok((steps, (0..count).map(|step| [state(step, 0), state(step, 1)]).collect())),
        _ => Err(refused(format!("inputs: expected all of a flight: {}", FLIGHT.join(", ")))),
    }
}

pub(crate) fn spring_curve(
    knots: &PyReadonlyArray1<'_, f64>,
    coefficients: &PyReadonlyArray2<'_, f64>,
) -> PyResult<Curve> {
    let knots: Vec<f64> = knots.as_array().iter().copied().collect();
    rising("curve", &knots)?;
    let coefficients = rows::<4>("curve", coefficients)?;
    Curve::new(&knots, &coefficients).ok_or_else(|| refused("curve: knots and coefficients do not fit"))
}
