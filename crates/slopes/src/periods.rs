//! Matrices of a period of many loops, eight side by side in vector lanes, over the cores. What takes the compiler long is generic, and compiled
//! where the loops of one drive run.

use crate::sampled_loops::{COLUMNS, INPUTS, PeriodMatrix, SampledLoops, along, kept};
use core::sync::atomic::{AtomicBool, Ordering};
use fearless_simd::{Level, Simd};
use forcefeel_model::drive::Kind;
use forcefeel_model::dual::Dual;
use forcefeel_model::machine::period::PERIOD_STATES;
use forcefeel_model::parameters::Parameters;
use forcefeel_solve::lanes::{FourLanes, LANES, Lanes};
use forcefeel_solve::return_on_vectors;
use forcefeel_solve::threads::{NoThreads, each};
use forcefeel_solve::wide::Wide;

/// What [`periods`] gives.
#[derive(Debug, Clone)]
pub struct Periods {
    /// Which states are kept, places among the [`PERIOD_STATES`].
    pub states: Vec<usize>,
    /// `[M, b_e, b_F]` of each loop, row by row.
    pub matrices: Vec<f64>,
}

/// Fills the matrices of loops of one drive, [`LANES`] at most, from a first one on, and says whether a state depends on one that is not evaluated.
pub type Group<'a> = &'a (dyn Fn(&Evaluated, usize, &mut [f64]) -> bool + Sync);

/// The matrices of all loops on so many threads.
///
/// # Errors
/// If the system gives no threads.
pub fn periods(loops: &SampledLoops<'_>, threads: usize, group: Group<'_>) -> Result<Periods, NoThreads> {
    let all = Evaluated::new((0..PERIOD_STATES).collect());
    let runs = loops.values.len();
    if runs > 2 * LANES {
        // States on which nothing depends in the first and last loops are left out; if one matters to another loop, all are evaluated below.
        let mut some = vec![[[0.0; COLUMNS]; PERIOD_STATES]; 2 * LANES];
        for (blocks, first) in some.chunks_mut(LANES).zip([0, runs - LANES]) {
            all.by_drive(loops, first, blocks.as_flattened_mut().as_flattened_mut(), group);
        }
        let evaluated = Evaluated::new(kept(&some, |_| false));
        let (matrices, depends) = evaluated.blocks(loops, threads, group)?;
        if !depends {
            return Ok(Periods { states: evaluated.states, matrices });
        }
    }
    let (whole, _) = all.blocks(loops, threads, group)?;
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

/// Which states of a matrix are evaluated, and for each state and input its column; of those that are not, none.
#[derive(Debug)]
pub struct Evaluated {
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
    pub fn size(&self) -> usize {
        self.states.len() * self.width()
    }

    /// The matrices of all loops on these states, and whether one of these depends on another state.
    fn blocks(
        &self,
        loops: &SampledLoops<'_>,
        threads: usize,
        group: Group<'_>,
    ) -> Result<(Vec<f64>, bool), NoThreads> {
        let mut blocks = vec![0.0; loops.values.len() * self.size()];
        let depends = AtomicBool::new(false);
        each(threads, blocks.chunks_mut(LANES * self.size()).enumerate(), |(chunk, blocks)| {
            if self.by_drive(loops, chunk * LANES, blocks, group) {
                depends.store(true, Ordering::Relaxed);
            }
        })?;
        Ok((blocks, depends.into_inner()))
    }

    /// The loops from the first on whose matrices these are, those of one drive at a time.
    fn by_drive(&self, loops: &SampledLoops<'_>, first: usize, blocks: &mut [f64], group: Group<'_>) -> bool {
        let runs = first..first + blocks.len() / self.size();
        let alike = runs.clone().take_while(|&run| loops.kind(run) == loops.kind(first)).count();
        let (these, others) = blocks.split_at_mut(alike * self.size());
        let depends = group(self, first, these);
        if others.is_empty() { depends } else { self.by_drive(loops, first + alike, others, group) | depends }
    }

    /// Writes a matrix in full where its states are kept, and says whether one of these depends on another.
    pub fn put(&self, matrix: &PeriodMatrix, block: &mut [f64]) -> bool {
        let mut depends = false;
        for (&state, row) in self.states.iter().zip(block.chunks_mut(self.width())) {
            for (&number, &place) in matrix[state].iter().zip(&self.places) {
                match row.get_mut(place) {
                    Some(entry) => *entry = number,
                    None => depends |= number != 0.0,
                }
            }
        }
        depends
    }

    /// A [`Group`] on the widest instructions that the machine has; none where it has no vectors. Where eight loops would take several registers
    /// for a number they go four by four, which takes a third less time, and half as long to compile.
    pub fn on_vectors<K: Kind>(&self, loops: &SampledLoops<'_>, first: usize, blocks: &mut [f64]) -> Option<bool> {
        return_on_vectors!(
            Level::new(),
            simd => Some(self.in_groups::<_, Lanes<_>, K>(simd, loops, first, blocks)),
            simd => Some(self.in_groups::<_, FourLanes<_>, K>(simd, loops, first, blocks))
        );
        None
    }

    fn in_groups<S: Simd, T: Wide<Token = S>, K: Kind>(
        &self,
        simd: S,
        loops: &SampledLoops<'_>,
        first: usize,
        blocks: &mut [f64],
    ) -> bool {
        let groups = blocks.chunks_mut(T::RUNS * self.size()).enumerate();
        groups.fold(false, |depends, (group, blocks)| {
            self.vectorized::<S, T, K>(simd, loops, first + group * T::RUNS, blocks) | depends
        })
    }

    /// Column by column.
    #[inline(always)]
    fn vectorized<S: Simd, T: Wide<Token = S>, K: Kind>(
        &self,
        simd: S,
        loops: &SampledLoops<'_>,
        first: usize,
        blocks: &mut [f64],
    ) -> bool {
        simd.vectorize(
            #[inline(always)]
            || {
                let (width, size) = (self.width(), self.size());
                let last = first + blocks.len() / size - 1;
                let wide = |of: &dyn Fn(usize) -> f64| T::gather(simd, |lane| of((first + lane).min(last)));
                let zero = wide(&|_| 0.0);
                let values = core::array::from_fn(|k| wide(&|run| loops.values[run][k]));
                let ready = loops.ready::<T, K>(&Parameters::from_values(&values), wide);
                let mut depends = false;
                // All others are evaluated as one, their sum, after the last column.
                for place in 0..=width {
                    let slope = |k: usize| zero.constant(f64::from(self.places[k] == place));
                    let (state, drives) = along(|k| Dual { value: zero, slope: slope(k) });
                    let (_, next) = ready.next(&state, &drives);
                    for (row, &state) in self.states.iter().enumerate() {
                        next[state].slope.scatter(|lane, slope| {
                            if place == width {
                                depends |= slope != 0.0;
                            } else if let Some(entry) = blocks.get_mut(lane * size + row * width + place) {
                                *entry = slope;
                            }
                        });
                    }
                }
                depends
            },
        )
    }
}
