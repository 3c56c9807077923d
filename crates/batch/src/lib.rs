//! Many runs: groups of them over the cores.
#![forbid(unsafe_code)]

use fearless_simd::Level;
use forcefeel_model::parameters::DriveKind;
use forcefeel_simulate::batch::{Job, Values, WIDTH};
use forcefeel_simulate::linked::{Joint, run_pair};
use forcefeel_simulate::measures::MEASURES;
use forcefeel_solve::threads::{NoThreads, each};

/// Runs all of a job on so many threads: the measures of each run, and its histories run by run, output by output, sample by sample
/// into `histories`.
///
/// # Errors
/// If the system gives no threads.
///
/// # Panics
/// If `histories` has not the size of what is asked for.
pub fn run(job: &Job<'_>, threads: usize, histories: &mut [f64]) -> Result<Vec<Values>, NoThreads> {
    let size = job.outputs.len() * job.samples();
    assert_eq!(histories.len(), job.values.len() * size, "histories");
    let mut measures = vec![[0.0; MEASURES.len()]; job.values.len()];
    let level = Level::new();
    let group = match job.values.first().map_or(DriveKind::Hydraulic, DriveKind::of) {
        DriveKind::Hydraulic => forcefeel_batch_hydraulic::group,
        DriveKind::Electric => forcefeel_batch_electric::group,
    };
    let mut histories = histories.chunks_mut((WIDTH * size).max(1));
    let groups = measures.chunks_mut(WIDTH).enumerate().map(|(k, measures)| {
        // None where there is nothing to keep.
        (k * WIDTH, measures, histories.next().unwrap_or_default())
    });
    each(threads, groups, |(first, measures, histories)| group(job, level, first, measures, histories))?;
    Ok(measures)
}

/// Runs the first loaders of two jobs of one step and one period joined by a link, a sample every so many steps: sample by sample the outputs of
/// the first, of the second and [`JOINT_OUTPUTS`](forcefeel_simulate::linked::JOINT_OUTPUTS).
pub fn run_linked(jobs: [&Job<'_>; 2], joint: &Joint, every: usize) -> Vec<f64> {
    let sides = jobs.map(|job| match job.values.first().map_or(DriveKind::Hydraulic, DriveKind::of) {
        DriveKind::Hydraulic => forcefeel_batch_hydraulic::side(job),
        DriveKind::Electric => forcefeel_batch_electric::side(job),
    });
    run_pair(sides, joint, jobs[0], (jobs[0].inputs.len(), every))
}
