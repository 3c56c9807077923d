//! Loops under a digital controller: the matrix of a period, exactly, from the step that runs it.
//!
//! `x+ = M x + b_e e_C + b_F F_p + sum b_j e_j`, `x` what the loader and its controller carry from one period to the next
//! ([`PERIOD_STATES`]), `e_C` a signal on the command, `F_p` a pilot force that stays through the period, `e_j` a test signal at the
//! amplifier during step `j` of the period. Each column is one evaluation on dual numbers at rest at neutral.
//!
//! What holds, touches or rounds, dry friction, play, stops, the feel's breakout and the steps of sensors and converters, is left
//! out: it has no slope at rest. States that nothing depends on have no column and are left out: their poles are at zero.

use forcefeel_model::Scalar;
use forcefeel_model::channels;
use forcefeel_model::controller::Timing;
use forcefeel_model::drive::{Drive, Kind};
use forcefeel_model::dual::Dual;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::period::{Drives, PERIOD_STATES, Period, YOUNGEST};
use forcefeel_model::machine::{Machine, Shared, Snapshot};
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters};
use forcefeel_model::with_drive;
use forcefeel_solve::law::Law;
use forcefeel_solve::smooth::without_steps;

/// Inputs of a period: signal on the command, pilot force.
pub const INPUTS: usize = 2;

/// States, then inputs.
pub const COLUMNS: usize = PERIOD_STATES + INPUTS;

/// Numbers of `[M, b_e, b_F]`, row by row.
pub type PeriodMatrix<T = f64> = [[T; COLUMNS]; PERIOD_STATES];

/// The channels at the start of a period as rows on the same columns.
pub type Rows<T> = [[T; COLUMNS]; channels::COUNT];

/// Loops that share their effects and their timing.
#[derive(Debug, Clone)]
pub struct SampledLoops<'a> {
    /// Effects in play; what holds, touches or steps is left out.
    pub effects: Effects,
    /// Length of a step in s.
    pub step_s: f64,
    /// When the controller acts.
    pub timing: Timing,
    /// Parameters of each loop, in the order of the table.
    pub values: &'a [[f64; COUNT]],
    /// The law of each.
    pub law: Law<'a>,
}

impl SampledLoops<'_> {
    /// The drive of a run.
    pub fn kind(&self, run: usize) -> DriveKind {
        DriveKind::of(&self.values[run])
    }

    /// The matrix of a run, whose parameters may have slopes of their own, and its channels at the start of a period.
    pub fn matrix_of<T: Scalar>(&self, run: usize, parameters: &Parameters<T>) -> (PeriodMatrix<T>, Rows<T>) {
        with_drive!(self.kind(run), K => self.matrix_with::<T, K>(run, parameters))
    }

    fn matrix_with<T: Scalar, K: Kind>(&self, run: usize, parameters: &Parameters<T>) -> (PeriodMatrix<T>, Rows<T>) {
        let zero = parameters.column.inertia.zero();
        let (mut matrix, mut rows) = ([[zero; COLUMNS]; PERIOD_STATES], [[zero; COLUMNS]; channels::COUNT]);
        let period = self.period::<T, K>(run, parameters);
        for column in 0..COLUMNS {
            let (state, drives) = along(|k| if k == column { Dual::variable(zero) } else { Dual::constant(zero) });
            let (now, next) = period.slopes(&state, &drives);
            let by_column = rows.iter_mut().zip(now).chain(matrix.iter_mut().zip(next));
            by_column.for_each(|(row, slope)| row[column] = slope);
        }
        (matrix, rows)
    }

    /// What a test signal at the amplifier during each step of a period makes of the next state, a column each, and of the channels
    /// while it is there.
    pub fn by_test_signal<T: Scalar>(&self, run: usize, parameters: &Parameters<T>) -> ByTestSignal<T> {
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
        let columns = (0..self.timing.period).map(|step| period.slopes(&state, &drives(step)));
        let (mut now, next): (Vec<_>, _) = columns.unzip();
        ByTestSignal { next, now: now.swap_remove(0) }
    }

    fn period<T: Scalar, K: Kind>(&self, run: usize, parameters: &Parameters<T>) -> Ready<'_, T, K::Of<Dual<T>>> {
        let zero = parameters.column.inertia.zero();
        self.ready::<T, K>(parameters, |of: &dyn Fn(usize) -> f64| zero.constant(of(run)))
    }

    /// A machine whose periods are asked for, of numbers that stand for several runs where `wide` makes them.
    #[inline(always)]
    pub fn ready<T: Scalar, K: Kind>(
        &self,
        parameters: &Parameters<T>,
        wide: impl Fn(&dyn Fn(usize) -> f64) -> T,
    ) -> Ready<'_, T, K::Of<Dual<T>>> {
        let parameters = parameters.map(Dual::constant);
        let wide = |of: &dyn Fn(usize) -> f64| Dual::constant(wide(of));
        let smooth = without_steps(parameters);
        let machine = Machine::new(&smooth, self.law.compensator(&smooth, wide), &self.shared());
        let machine = self.law.observer(wide).map_or(machine, |observer| machine.with_observer(observer));
        Ready { machine, loops: self, parameters }
    }

    /// What all share. Made where a step is compiled, so that the compiler sees which effects no period has, and leaves their code out.
    #[inline(always)]
    fn shared(&self) -> Shared {
        Shared {
            effects: Effects { sampled: true, surroundings: false, linked: false, ..self.effects.smooth() },
            step_s: self.step_s,
            timing: Some(self.timing),
            curve: None,
            cancellation: None,
        }
    }
}

/// A machine whose periods are asked for.
pub struct Ready<'a, T: Scalar, D: Drive<Dual<T>>> {
    machine: Machine<Dual<T>, D>,
    loops: &'a SampledLoops<'a>,
    parameters: Parameters<Dual<T>>,
}

impl<T: Scalar, D: Drive<Dual<T>>> Ready<'_, T, D> {
    /// The slopes of the channels at the start of a period, and of the state a period later. Compiled once, and not wherever they are
    /// asked for: a whole step is in it.
    #[inline(never)]
    fn slopes(
        &self,
        state: &[Dual<T>; PERIOD_STATES],
        drives: &Drives<Dual<T>>,
    ) -> ([T; channels::COUNT], [T; PERIOD_STATES]) {
        let (now, next) = self.next(state, drives);
        let channels = now.map_or([drives.force; channels::COUNT], |now| D::channels(&now, &self.parameters));
        (channels.map(|number| number.slope), next.map(|number| number.slope))
    }

    /// What there is at the start of a period, and the state a period later.
    #[inline(always)]
    pub fn next(&self, state: &[Dual<T>; PERIOD_STATES], drives: &Drives<Dual<T>>) -> Next<T, D> {
        let shared = self.loops.shared();
        Period { machine: &self.machine, shared: &shared, timing: self.loops.timing }.next(state, drives)
    }
}

/// What there is at the start of a period, if a step begins there, and the state a period later.
pub type Next<T, D> = (Option<Snapshot<Dual<T>, D>>, [Dual<T>; PERIOD_STATES]);

/// State and drives of which each is what `of` gives for its column.
#[inline(always)]
pub fn along<T: Scalar>(of: impl Fn(usize) -> Dual<T>) -> ([Dual<T>; PERIOD_STATES], Drives<Dual<T>>) {
    let [command_signal, force] = [of(PERIOD_STATES), of(PERIOD_STATES + 1)];
    let drives = Drives { command_signal, force, force_before: force, test_signal: (force.zero(), 0) };
    (core::array::from_fn(of), drives)
}

/// See [`SampledLoops::by_test_signal`].
#[derive(Debug, Clone)]
pub struct ByTestSignal<T> {
    /// The next state, for each step of the period.
    pub next: Vec<[T; PERIOD_STATES]>,
    /// The channels.
    pub now: [T; channels::COUNT],
}

/// The states that any loop's next state depends on, of those that are left, and those that are seen.
pub fn kept(matrices: &[PeriodMatrix], seen: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut depends = [[false; COLUMNS]; PERIOD_STATES];
    for matrix in matrices {
        let numbers = depends.as_flattened_mut().iter_mut().zip(matrix.as_flattened());
        numbers.for_each(|(depends, &number)| *depends |= number != 0.0);
    }
    let mut states: Vec<usize> = (0..PERIOD_STATES).collect();
    loop {
        let matters = |column: usize| states.iter().any(|&row| depends[row][column]);
        // The youngest command is what a loop is opened at.
        let left: Vec<usize> =
            states.iter().copied().filter(|&state| state == YOUNGEST || seen(state) || matters(state)).collect();
        if left.len() == states.len() {
            return states;
        }
        states = left;
    }
}
