//! A loader with its law as a board's library takes it, what it must answer there, and that library's sources.

use crate::arrays::rows;
use crate::errors::refused;
use forcefeel_firmware::axis::{Axis, Input, Number, Output};
use forcefeel_firmware::loader::{Loader, Setting};
use forcefeel_firmware::surface::{FLOWN, hinge_moment};
use forcefeel_model::Scalar;
use forcefeel_model::cancellation::CANCELLATION_NUMBERS;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::curve::MOST_POINTS;
use forcefeel_model::drive::Kind;
use forcefeel_model::machine::Machine;
use forcefeel_model::observer::{NUMBERS, SAMPLED};
use forcefeel_model::parameters::COUNT;
use forcefeel_model::with_drive;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// Numbers and words of an input; of an answer.
const GIVEN: usize = SAMPLED + 7;
const WORDS: usize = 8;
const ANSWERED: usize = 5;
const STATES: usize = 4;

/// Answers of a board: numbers and words, a row each sample.
type Answers<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// The members of C's structure of a loader, in their order.
type Members = (f64, [[f64; SAMPLED]; 2], Vec<f64>, Vec<f64>, Vec<[f64; 4]>, u32, u32);

/// One axis on a board: loader, law and supervisor, for one setting or many.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct BoardAxis {
    loader: Loader,
    settings: Vec<Setting>,
}

#[pymethods]
impl BoardAxis {
    /// Values of the parameter table and the law's numbers, a row each setting; the law runs every `period_s`.
    #[new]
    #[pyo3(signature = (values, laws, *, period_s, curve = None, cancellation = None))]
    fn new(
        values: PyReadonlyArray2<'_, f64>,
        laws: PyReadonlyArray2<'_, f64>,
        period_s: f64,
        curve: Option<(PyReadonlyArray1<'_, f64>, PyReadonlyArray2<'_, f64>)>,
        cancellation: Option<[f64; CANCELLATION_NUMBERS]>,
    ) -> PyResult<Self> {
        let (values, laws) = (rows::<COUNT>("values", &values)?, rows::<NUMBERS>("laws", &laws)?);
        if values.is_empty() || values.len() != laws.len() {
            return Err(refused(format!("laws: expected a row for each of {} settings", values.len())));
        }
        let settings: Vec<Setting> =
            values.into_iter().zip(laws).map(|(values, law)| Setting { values, law }).collect();
        let mut loader = Loader {
            period_s: crate::limits::step(period_s)?,
            at_rest: [[0.0; SAMPLED]; 2],
            cancellation: cancellation.unwrap_or_default(),
            knots: [0.0; MOST_POINTS],
            coefficients: [[0.0; 4]; MOST_POINTS - 1],
            points: 0,
            cancels: u32::from(cancellation.is_some()),
        };
        if let Some((knots, coefficients)) = &curve {
            crate::simulate::spring_curve(knots, coefficients)?;
            for (place, &knot) in loader.knots.iter_mut().zip(knots.as_slice()?) {
                *place = knot;
                loader.points += 1;
            }
            for (place, piece) in loader.coefficients.iter_mut().zip(rows::<4>("coefficients", coefficients)?) {
                *place = piece;
            }
        }
        loader.at_rest = with_drive!(settings[0].drive(), K => standing::<K>(&loader, &settings));
        Ok(Self { loader, settings })
    }

    /// Period; what sensors show at rest; cancellation, knots, coefficients, as C's structure has them; points, and whether it cancels.
    fn loader(&self) -> Members {
        let Loader { period_s, at_rest, cancellation, knots, coefficients, points, cancels } = self.loader;
        (period_s, at_rest, cancellation.to_vec(), knots.to_vec(), coefficients.to_vec(), points, cancels)
    }

    /// Command, torque, angle and rate of the feel, share of the host (samples, 5), and enable, state, acting, tripped (samples, 4), for sensors, trim, factor,
    /// shaker, blend, added force, spring and damping (samples, 11) and from, to, request, missed, delay, late, flags, age of the host (samples, 8), from an axis that is off.
    #[pyo3(signature = (inputs, words, *, single))]
    fn answers<'py>(
        &self,
        py: Python<'py>,
        inputs: PyReadonlyArray2<'py, f64>,
        words: Vec<[u32; WORDS]>,
        single: bool,
    ) -> PyResult<Answers<'py>> {
        let inputs = rows::<GIVEN>("inputs", &inputs)?;
        if words.len() != inputs.len() {
            return Err(refused(format!("words: expected {} rows, got {}", inputs.len(), words.len())));
        }
        let outputs =
            py.detach(|| if single { self.run(0.0_f32, &inputs, &words) } else { self.run(0.0_f64, &inputs, &words) })?;
        let (numbers, words): (Vec<_>, Vec<_>) = outputs.into_iter().unzip();
        Ok((
            PyArray1::from_vec(py, numbers.into_flattened()).reshape([inputs.len(), ANSWERED])?,
            PyArray1::from_vec(py, words.into_flattened()).reshape([inputs.len(), STATES])?,
        ))
    }

    /// Force, spring and damping (flights, 3) that the surface of the first setting adds in flights and at angles (flights, 11).
    #[pyo3(signature = (flown, *, single))]
    fn added<'py>(
        &self,
        py: Python<'py>,
        flown: PyReadonlyArray2<'py, f64>,
        single: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let flown = rows::<FLOWN>("flown", &flown)?;
        let of = |row: &[f64; FLOWN]| {
            if single { self.added_in(0.0_f32, row) } else { self.added_in(0.0_f64, row) }
        };
        let added: Option<Vec<[f64; 3]>> = flown.iter().map(of).collect();
        let added = added.ok_or_else(|| refused("flown: expected numbers"))?;
        PyArray1::from_vec(py, added.into_flattened()).reshape([flown.len(), 3])
    }
}

impl BoardAxis {
    fn added_in<S: Scalar + Into<f64>>(&self, like: S, flown: &[f64; FLOWN]) -> Option<[f64; 3]> {
        let added = hinge_moment(&self.settings[0], &flown.map(|number| like.constant(number)));
        added.map(|added| added.map(Into::into))
    }

    fn run<S: Number>(
        &self,
        like: S,
        inputs: &[[f64; GIVEN]],
        words: &[[u32; WORDS]],
    ) -> PyResult<Vec<([f64; ANSWERED], [u32; STATES])>> {
        let no_limits = || refused("loader: has no limits that a supervisor could hold it to".to_owned());
        let mut axis = Axis::new(&self.loader, &self.settings, like).ok_or_else(no_limits)?;
        let no_setting = || refused(format!("words: expected settings below {}", self.settings.len()));
        inputs
            .iter()
            .zip(words)
            .map(|(numbers, &[from, to, request, missed, delay, late, flags, host_age])| {
                let [
                    force,
                    drive,
                    base,
                    grip,
                    trim,
                    stiffness_factor,
                    shaker,
                    blend,
                    added_force,
                    added_stiffness,
                    added_damping,
                ] = numbers.map(|number| like.constant(number));
                let sensors = [force, drive, base, grip];
                let given = Input {
                    sensors,
                    trim,
                    stiffness_factor,
                    shaker,
                    blend,
                    added_force,
                    added_stiffness,
                    added_damping,
                    from,
                    to,
                    request,
                    missed,
                    delay,
                    late,
                    flags,
                    host_age,
                };
                let Output { command, torque, feel: [angle, rate], enable, state, acting, tripped, host_share } =
                    axis.step(&self.settings, &given).ok_or_else(no_setting)?;
                Ok(([command, torque, angle, rate, host_share].map(Into::into), [enable, state, acting, tripped]))
            })
            .collect()
    }
}

/// What the sensors show where the column rests.
fn standing<K: Kind>(loader: &Loader, settings: &[Setting]) -> [[f64; SAMPLED]; 2] {
    let (shared, setting) = (loader.shared(settings), &settings[0]);
    let parameters = setting.parameters(0.0);
    let gains = Compensator::state_feedback(&parameters, [0.0; 7]);
    let machine = Machine::<f64, K::Of<f64>>::new(&parameters, gains, &shared).with_observer(setting.law(0.0));
    machine.sensors_at_rest(&shared.effects)
}

/// Files of the board's library, by their places below a workspace.
#[pyfunction]
pub fn board_sources() -> Vec<(&'static str, &'static str)> {
    let sources: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/board_sources.rs"));
    sources.to_vec()
}
