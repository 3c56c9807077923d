//! Runs of loaders with an electric drive. In a crate of its own, because a step in vector lanes takes the compiler longer than all else: those of
//! both drives are compiled side by side.
#![forbid(unsafe_code)]

use fearless_simd::Level;
use forcefeel_model::drive::OfElectric;
use forcefeel_simulate::batch::{Job, Values};
use forcefeel_simulate::linked::{self, Side};
use forcefeel_slopes::periods::Evaluated;
use forcefeel_slopes::sampled_loops::SampledLoops;

/// The group of runs from `first` on: the measures of each, and its histories where there is room for them.
pub fn group(job: &Job<'_>, level: Level, first: usize, measures: &mut [Values], histories: &mut [f64]) {
    job.group_on_vectors::<OfElectric>(level, first, measures, histories);
}

/// The loader of a run of a job as a side of a pair.
pub fn side<'a>(job: &'a Job<'a>, run: usize) -> Box<dyn Side + 'a> {
    linked::side::<OfElectric>(job, run)
}

/// Matrices of a period of loops from `first` on, in vector lanes; none where the machine has no vectors.
pub fn periods(evaluated: &Evaluated, loops: &SampledLoops<'_>, first: usize, blocks: &mut [f64]) -> Option<bool> {
    evaluated.on_vectors::<OfElectric>(loops, first, blocks)
}
