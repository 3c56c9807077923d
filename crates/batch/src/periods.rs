//! Matrices of a period of many loops, those of each drive where its step is compiled.

use forcefeel_model::parameters::DriveKind;
use forcefeel_slopes::periods::{Periods, periods as over_the_cores};
use forcefeel_slopes::sampled_loops::SampledLoops;
use forcefeel_solve::threads::NoThreads;

/// The matrices of all loops on so many threads.
///
/// # Errors
/// If the system gives no threads.
pub fn periods(loops: &SampledLoops<'_>, threads: usize) -> Result<Periods, NoThreads> {
    over_the_cores(loops, threads, &|evaluated, first, blocks| {
        let on_vectors = match loops.kind(first) {
            DriveKind::Hydraulic => forcefeel_batch_hydraulic::periods(evaluated, loops, first, blocks),
            DriveKind::Electric => forcefeel_batch_electric::periods(evaluated, loops, first, blocks),
        };
        // A machine without vectors computes the slopes of the slopes as well, which are compiled in any case.
        on_vectors.unwrap_or_else(|| {
            let each = (first..).zip(blocks.chunks_mut(evaluated.size()));
            each.fold(false, |depends, (run, block)| {
                evaluated.put(&forcefeel_matrices::period(loops, run), block) | depends
            })
        })
    })
}
