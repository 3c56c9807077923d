//! Many loops under a digital controller: the matrices of a period, exactly, from the step that runs it.
//!
//! `x+ = M x + b_e e_C + b_F F_p + sum b_j e_j`, `x` what the loader and its controller carry from one period to the next
//! ([`PERIOD_STATES`]), `e_C` a signal on the command, `F_p` a pilot force that stays through the period, `e_j` a test signal at the
//! amplifier during step `j` of the period. Each column is one evaluation on dual numbers at rest at neutral.
//!
//! What holds, touches or rounds, dry friction, play, stops, the feel's breakout and the steps of sensors and converters, is left
//! out: it has no slope at rest. States that nothing depends on have no column and are left out: their poles are at zero.

use crate::law::Law;
use crate::threads::{NoThreads, pool};
use forcefeel_model::Scalar;
use forcefeel_model::channels;
use forcefeel_model::controller::Timing;
use forcefeel_model::drive::{Drive, Kind, Signals};
use forcefeel_model::dual::Dual;
use forcefeel_model::machine::period::{Drives, PERIOD_STATES, Period, YOUNGEST};
use forcefeel_model::machine::{Machine, Shared};
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters};
use forcefeel_model::with_drive;
use rayon::prelude::*;

/// Inputs of a period: signal on the command, pilot force.
pub const INPUTS: usize = 2;

/// States, then inputs.
pub(crate) const COLUMNS: usize = PERIOD_STATES + INPUTS;

/// Numbers of `[M, b_e, b_F]`, row by row.
pub(crate) type PeriodMatrix<T = f64> = [[T; COLUMNS]; PERIOD_STATES];

/// The channels at the start of a period as rows on the same columns.
pub(crate) type Rows<T> = [[T; COLUMNS]; channels::COUNT];

/// Loops that share their effects and their timing.
#[derive(Debug, Clone)]
pub struct SampledLoops<'a> {
    /// What all share; with a controller's timing.
    pub shared: Shared,
    /// When the controller acts.
    pub timing: Timing,
    /// Parameters of each loop, in the order of the table.
    pub values: &'a [[f64; COUNT]],
    /// The law of each.
    pub law: Law<'a>,
}

/// The matrices of loops.
#[derive(Debug, Clone)]
pub struct Periods {
    /// Which states are kept, places among the [`PERIOD_STATES`].
    pub states: Vec<usize>,
    /// `[M, b_e, b_F]` of each loop, row by row.
    pub matrices: Vec<f64>,
}

impl SampledLoops<'_> {
    /// The matrices of all loops on so many threads.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn periods(&self, threads: usize) -> Result<Periods, NoThreads> {
        let pool = pool(threads)?;
        let whole: Vec<PeriodMatrix> =
            pool.install(|| (0..self.values.len()).into_par_iter().map(|run| self.matrix(run)).collect());
        let states = kept(&whole, |_| false);
        let columns = || states.iter().copied().chain(PERIOD_STATES..COLUMNS);
        let row = |matrix: &PeriodMatrix, state: usize| columns().map(|k| matrix[state][k]).collect::<Vec<_>>();
        let matrices = whole.iter().flat_map(|matrix| states.iter().flat_map(|&state| row(matrix, state))).collect();
        Ok(Periods { states, matrices })
    }

    fn matrix(&self, run: usize) -> PeriodMatrix {
        self.matrix_of(run, &Parameters::from_values(&self.values[run]))
    }

    fn kind(&self, run: usize) -> DriveKind {
        DriveKind::of(&self.values[run])
    }

    /// The matrix of a run, whose parameters may have slopes of their own.
    pub(crate) fn matrix_of<T: Scalar>(&self, run: usize, parameters: &Parameters<T>) -> PeriodMatrix<T> {
        with_drive!(self.kind(run), K => self.matrix_with::<T, K>(run, parameters))
    }

    fn matrix_with<T: Scalar, K: Kind>(&self, run: usize, parameters: &Parameters<T>) -> PeriodMatrix<T> {
        let zero = parameters.column.inertia.zero();
        let mut matrix = [[zero; COLUMNS]; PERIOD_STATES];
        let period = self.period::<T, K>(run, parameters);
        for column in 0..COLUMNS {
            let (state, drives) = columnwise(zero, column);
            for (row, number) in matrix.iter_mut().zip(period.of().next(&state, &drives)) {
                row[column] = number.slope;
            }
        }
        matrix
    }

    /// What a test signal at the amplifier during each step of a period makes of the next state, a column each, and of the channels
    /// while it is there.
    pub(crate) fn by_test_signal<T: Scalar>(&self, run: usize, parameters: &Parameters<T>) -> ByTestSignal<T> {
        with_drive!(self.kind(run), K => self.tested::<T, K>(run, parameters))
    }

    fn tested<T: Scalar, K: Kind>(&self, run: usize, parameters: &Parameters<T>) -> ByTestSignal<T> {
        let zero = parameters.column.inertia.zero();
        let (period, none) = (self.period::<T, K>(run, parameters), Dual::constant(zero));
        let drives = |step: usize| Drives {
            command_signal: none,
            force: none,
            force_before: none,
            test_signal: (Dual::variable(zero), step),
        };
        let state = [none; PERIOD_STATES];
        let next = |step: usize| period.of().next(&state, &drives(step)).map(|number| number.slope);
        let now = period.of().now(&state, &drives(0));
        let shown = <K::Of<Dual<T>> as Signals<Dual<T>>>::channels(&now, &parameters.map(Dual::constant));
        ByTestSignal { next: (0..self.timing.period).map(next).collect(), now: shown.map(|number| number.slope) }
    }

    /// The channels at the start of a period.
    pub(crate) fn rows_of<T: Scalar>(&self, run: usize, parameters: &Parameters<T>) -> Rows<T> {
        with_drive!(self.kind(run), K => self.rows_with::<T, K>(run, parameters))
    }

    fn rows_with<T: Scalar, K: Kind>(&self, run: usize, parameters: &Parameters<T>) -> Rows<T> {
        let zero = parameters.column.inertia.zero();
        let mut rows = [[zero; COLUMNS]; channels::COUNT];
        let (period, on_bench) = (self.period::<T, K>(run, parameters), parameters.map(Dual::constant));
        for column in 0..COLUMNS {
            let (state, drives) = columnwise(zero, column);
            let now = period.of().now(&state, &drives);
            let shown = <K::Of<Dual<T>> as Signals<Dual<T>>>::channels(&now, &on_bench);
            for (row, number) in rows.iter_mut().zip(shown) {
                row[column] = number.slope;
            }
        }
        rows
    }

    fn period<T: Scalar, K: Kind>(&self, run: usize, parameters: &Parameters<T>) -> Ready<'_, Dual<T>, K::Of<Dual<T>>> {
        let zero = parameters.column.inertia.zero();
        let parameters = without_steps(parameters.map(Dual::constant));
        let wide = |of: &dyn Fn(usize) -> f64| Dual::constant(zero.constant(of(run)));
        let machine = Machine::new(&parameters, self.law.compensator(&parameters, wide), &self.shared);
        let machine = self.law.observer(wide).map_or(machine, |observer| machine.with_observer(observer));
        Ready { machine, shared: &self.shared, timing: self.timing }
    }
}

/// A machine whose periods are asked for.
struct Ready<'a, S: Scalar, D: Drive<S>> {
    machine: Machine<S, D>,
    shared: &'a Shared,
    timing: Timing,
}

impl<S: Scalar, D: Drive<S>> Ready<'_, S, D> {
    fn of(&self) -> Period<'_, S, D> {
        Period { machine: &self.machine, shared: self.shared, timing: self.timing }
    }
}

/// State and drives at neutral, dual along a column.
fn columnwise<T: Scalar>(zero: T, column: usize) -> ([Dual<T>; PERIOD_STATES], Drives<Dual<T>>) {
    let along = |k: usize| if k == column { Dual::variable(zero) } else { Dual::constant(zero) };
    let drives = Drives {
        command_signal: along(PERIOD_STATES),
        force: along(PERIOD_STATES + 1),
        force_before: along(PERIOD_STATES + 1),
        test_signal: (Dual::constant(zero), 0),
    };
    (core::array::from_fn(along), drives)
}

/// See [`SampledLoops::by_test_signal`].
#[derive(Debug, Clone)]
pub(crate) struct ByTestSignal<T> {
    pub(crate) next: Vec<[T; PERIOD_STATES]>,
    pub(crate) now: [T; channels::COUNT],
}

/// Sensors and converters that do not round: a staircase has no slope.
pub fn without_steps<T: Scalar>(mut parameters: Parameters<T>) -> Parameters<T> {
    let none = parameters.column.inertia.zero();
    let Parameters { load_cell, potentiometer, column_sensor, grip_sensor, controller, .. } = &mut parameters;
    let of_load_cell = [&mut load_cell.resolution, &mut potentiometer.resolution];
    for resolution in of_load_cell.into_iter().chain([&mut column_sensor.resolution, &mut grip_sensor.resolution]) {
        *resolution = none;
    }
    (controller.input_bits, controller.output_bits) = (none, none);
    parameters
}

/// The states that any loop's next state depends on, of those that are left, and those that are seen.
pub(crate) fn kept(matrices: &[PeriodMatrix], seen: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut states: Vec<usize> = (0..PERIOD_STATES).collect();
    loop {
        let matters =
            |column: usize| matrices.iter().any(|matrix| states.iter().any(|&row| matrix[row][column] != 0.0));
        // The youngest command is what a loop is opened at.
        let left: Vec<usize> =
            states.iter().copied().filter(|&state| state == YOUNGEST || seen(state) || matters(state)).collect();
        if left.len() == states.len() {
            return states;
        }
        states = left;
    }
}
