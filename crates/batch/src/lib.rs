//! Many runs: groups of them over the cores.
#![forbid(unsafe_code)]

pub mod periods;

use fearless_simd::Level;
use forcefeel_model::link::LINK_ROWS;
use forcefeel_model::parameters::{DriveKind, Feel};
use forcefeel_simulate::batch::{Job, Values, WIDTH};
use forcefeel_simulate::feel_pair::feel_pair;
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

/// Runs pairs of loaders of two jobs of one step and one period, each pair joined by a link of its own, on so many threads, a sample every so many
/// steps: pair by pair and sample by sample the outputs of the first, of the second and
/// [`JOINT_OUTPUTS`](forcefeel_simulate::linked::JOINT_OUTPUTS) into `histories`.
///
/// # Errors
/// If the system gives no threads.
///
/// # Panics
/// If there are no pairs, or `histories` has not the size of what is asked for.
pub fn run_linked(
    jobs: [&Job<'_>; 2],
    joints: &[Joint],
    every: usize,
    threads: usize,
    histories: &mut [f64],
) -> Result<(), NoThreads> {
    let pairs = histories.chunks_mut(histories.len() / joints.len()).zip(joints).enumerate();
    each(threads, pairs, |(run, (history, joint))| {
        let sides = jobs.map(|job| match job.values.first().map_or(DriveKind::Hydraulic, DriveKind::of) {
            DriveKind::Hydraulic => forcefeel_batch_hydraulic::side(job, run),
            DriveKind::Electric => forcefeel_batch_electric::side(job, run),
        });
        let mut rows = Vec::with_capacity(history.len());
        run_pair(sides, joint, jobs[0], (jobs[0].inputs.len(), every), &mut rows);
        history.copy_from_slice(&rows);
    })
}

/// Releases of many pairs of feels on one link, on so many threads: the angles of each first, then of each second feel, into `angles`.
///
/// # Errors
/// If the system gives no threads.
///
/// # Panics
/// If there are no pairs.
pub fn release_feels(
    feels: [&[Feel<f64>]; 2],
    (link, uncouples): (&[f64; LINK_ROWS], bool),
    release: (f64, f64),
    threads: usize,
    angles: &mut [f64],
) -> Result<(), NoThreads> {
    let pairs = angles.chunks_mut(angles.len() / feels[0].len()).zip(feels[0].iter().zip(feels[1]));
    each(threads, pairs, |(angles, (first, second))| feel_pair([first, second], link, uncouples, release, angles))
}
