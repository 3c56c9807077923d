//! Many loops under a digital controller: the matrices of a period, exactly, from the step that runs it.
//!
//! `x+ = M x + b_e e_C + b_F F_p + sum b_j e_j`, `x` what the loader and its controller carry from one period to the next
//! ([`PERIOD_STATES`]), `e_C` a signal on the command, `F_p` a pilot force that stays through the period, `e_j` a test signal at the
//! amplifier during step `j` of the period. Each column is one evaluation on dual numbers at rest at neutral.
//!
//! What holds, touches or rounds, dry friction, play, stops, the feel's breakout and the steps of sensors and converters, is left
//! out: it has no slope at rest. States that nothing depends on have no column and are left out: their poles are at zero.

use core::sync::atomic::{AtomicBool, Ordering};
use fearless_simd::{Level, Simd};
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
use forcefeel_solve::lanes::{LANES, Lanes};
use forcefeel_solve::law::Law;
use forcefeel_solve::return_on_vectors;
use forcefeel_solve::smooth::without_steps;
use forcefeel_solve::threads::{NoThreads, each};
use forcefeel_solve::wide::Wide;

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
        let (level, all) = (Level::new(), Evaluated::new((0..PERIOD_STATES).collect()));
        let runs = self.values.len();
        if runs > 2 * LANES {
            // States on which nothing depends in the first and last loops are left out; if one matters to another loop, all are evaluated below.
            let mut some = vec![[[0.0; COLUMNS]; PERIOD_STATES]; 2 * LANES];
            for (blocks, first) in some.chunks_mut(LANES).zip([0, runs - LANES]) {
                self.group(level, first, &all, blocks.as_flattened_mut().as_flattened_mut());
            }
            let evaluated = Evaluated::new(kept(&some, |_| false));
            let (matrices, depends) = self.blocks(level, threads, &evaluated)?;
            if !depends {
                return Ok(Periods { states: evaluated.states, matrices });
            }
        }
        let (whole, _) = self.blocks(level, threads, &all)?;
        let whole = whole.as_chunks::<COLUMNS>().0.as_chunks::<PERIOD_STATES>().0;
        let states = kept(whole, |_| false);
        let columns: Vec<usize> = states.iter().copied().chain(PERIOD_STATES..COLUMNS).collect();
        let mut matrices = Vec::with_capacity(whole.len() * states.len() * columns.len());
        for matrix in whole {
            for &state in &states {
                matrices.extend(columns.iter().map(|&k| matrix[state][k]));
            }
        }
        Ok(Periods { states, matrices })
    }

    /// The matrices of all loops on the states that are evaluated, and whether one of these depends on another state.
    fn blocks(&self, level: Level, threads: usize, evaluated: &Evaluated) -> Result<(Vec<f64>, bool), NoThreads> {
        let mut blocks = vec![0.0; self.values.len() * evaluated.size()];
        let depends = AtomicBool::new(false);
        each(threads, blocks.chunks_mut(LANES * evaluated.size()).enumerate(), |(group, blocks)| {
            if self.group(level, group * LANES, evaluated, blocks) {
                depends.store(true, Ordering::Relaxed);
            }
        })?;
        Ok((blocks, depends.into_inner()))
    }

    /// The matrices of a group of runs, and whether a state depends on one that is not evaluated.
    fn group(&self, level: Level, first: usize, evaluated: &Evaluated, blocks: &mut [f64]) -> bool {
        let runs = first..(first + LANES).min(self.values.len());
        if runs.clone().all(|run| self.kind(run) == self.kind(first)) {
            return_on_vectors!(level, simd => with_drive!(self.kind(first), K => {
                self.vectorized::<_, K>(simd, first, evaluated, blocks)
            }));
        }
        let mut depends = false;
        for (run, block) in runs.zip(blocks.chunks_mut(evaluated.size())) {
            let (matrix, _) = self.matrix_of(run, &Parameters::from_values(&self.values[run]));
            for (&state, row) in evaluated.states.iter().zip(block.chunks_mut(evaluated.width())) {
                for (value, &place) in matrix[state].iter().zip(&evaluated.places) {
                    match row.get_mut(place) {
                        Some(entry) => *entry = *value,
                        None => depends |= *value != 0.0,
                    }
                }
            }
        }
        depends
    }

    /// The same with the runs side by side, column by column.
    #[inline(always)]
    fn vectorized<S: Simd, K: Kind>(&self, simd: S, first: usize, evaluated: &Evaluated, blocks: &mut [f64]) -> bool {
        simd.vectorize(
            #[inline(always)]
            || {
                let last = self.values.len() - 1;
                let wide = |of: &dyn Fn(usize) -> f64| Lanes::gather(simd, |lane| of((first + lane).min(last)));
                let values = core::array::from_fn(|k| wide(&|run| self.values[run][k]));
                let ready = self.ready::<Lanes<S>, K>(&Parameters::from_values(&values), wide);
                let (width, size, zero) = (evaluated.width(), evaluated.size(), Lanes::splat(simd, 0.0));
                let mut depends = false;
                // All others are evaluated as one, their sum, after the last column.
                for place in 0..=width {
                    let slope = |k: usize| Lanes::splat(simd, f64::from(evaluated.places[k] == place));
                    let (state, drives) = along(|k| Dual { value: zero, slope: slope(k) });
                    let (_, next) = ready.next(&state, &drives);
                    for (row, &state) in evaluated.states.iter().enumerate() {
                        let slopes = next[state].slope.values();
                        if place == width {
                            depends |= slopes.iter().any(|&slope| slope != 0.0);
                            continue;
                        }
                        for (block, slope) in blocks.chunks_mut(size).zip(slopes) {
                            block[row * width + place] = slope;
                        }
                    }
                }
                depends
            },
        )
    }

    fn kind(&self, run: usize) -> DriveKind {
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

    #[inline(always)]
    fn ready<T: Scalar, K: Kind>(
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

/// Which states of a matrix are evaluated, and for each state and input its column; of those that are not, none.
struct Evaluated {
    states: Vec<usize>,
    places: [usize; COLUMNS],
}

impl Evaluated {
    fn new(states: Vec<usize>) -> Self {
        let others = states.len() + INPUTS;
        let columns = || states.iter().copied().chain(PERIOD_STATES..COLUMNS);
        let places = core::array::from_fn(|k| columns().position(|column| column == k).unwrap_or(others));
        Self { states, places }
    }

    /// Columns of a matrix.
    fn width(&self) -> usize {
        self.states.len() + INPUTS
    }

    /// Numbers of a matrix.
    fn size(&self) -> usize {
        self.states.len() * self.width()
    }
}

/// A machine whose periods are asked for.
struct Ready<'a, T: Scalar, D: Drive<Dual<T>>> {
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
    fn next(&self, state: &[Dual<T>; PERIOD_STATES], drives: &Drives<Dual<T>>) -> Next<T, D> {
        let shared = self.loops.shared();
        Period { machine: &self.machine, shared: &shared, timing: self.loops.timing }.next(state, drives)
    }
}

type Next<T, D> = (Option<Snapshot<Dual<T>, D>>, [Dual<T>; PERIOD_STATES]);

/// State and drives of which each is what `of` gives for its column.
#[inline(always)]
fn along<T: Scalar>(of: impl Fn(usize) -> Dual<T>) -> ([Dual<T>; PERIOD_STATES], Drives<Dual<T>>) {
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
