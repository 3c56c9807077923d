//! Loaders, inputs and jobs for the tests of runs in time.
#![allow(dead_code, reason = "each test file takes what it needs")]

use crate::draws::Draws;
use forcefeel_model::controller::Timing;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Inputs, Shared};
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters, TABLE};
use forcefeel_simulate::batch::{Job, Sampling, Values};
use forcefeel_solve::law::Law;
use forcefeel_solve::start::Start;

/// Length of a step in s.
pub const STEP: f64 = 1e-3;

/// Gains of the size that the design gives.
pub const GAINS: [f64; 7] = [-194.0, -3.8e-9, 22.0, 0.67, 19.9, -0.7, -1.5e-3];

/// The elevator loader with every optional row at its example, but stops that a push of [`steps`] reaches.
pub fn everything() -> Parameters<f64> {
    let mut p = Parameters::with_every_row();
    (p.column.stop_low, p.column.stop_high) = (-0.06, 0.06);
    (p.feel.soft_stop_low, p.feel.soft_stop_high) = (-0.05, 0.05);
    (p.feel.hard_stop_low, p.feel.hard_stop_high) = (-0.07, 0.07);
    p
}

/// Its values, each number of each run within `spread` of its own, and some effects off in some of the runs.
pub fn drawn(runs: usize, spread: f64) -> Vec<[f64; COUNT]> {
    let mut draws = Draws::new(3); // under which run 3 falls over with a negative inertia, as a test asks
    let one = |k: usize, draws: &mut Draws| {
        if TABLE[k].drive() == Some(DriveKind::Electric) {
            return everything().values()[k];
        }
        let (row, share, off) = (&TABLE[k], draws.uniform(), draws.uniform() < -0.5 && spread > 0.0);
        let switch = ["orifice", "period", "delay", "input_range", "input_bits", "output_range", "output_bits"]
            .contains(&row.name);
        let value = everything().values()[k];
        match row.off_si() {
            _ if switch => value,
            Some(off_si) if off => off_si,
            _ => value * (1.0 + spread * share),
        }
    };
    (0..runs).map(|_| core::array::from_fn(|k| one(k, &mut draws))).collect()
}

/// Inputs of a step under this force and nothing else.
pub fn pushed(force: [f64; 2]) -> Inputs {
    Inputs { force, ..Inputs::NONE }
}

/// A push and a pull, the neutral trimmed, the spring stiffened and the shaker on.
pub fn steps(count: u32, h: f64) -> Vec<Inputs> {
    let at = |k: u32| {
        let t = f64::from(k) * h;
        (0.02 * t, 1.0 + t, (120.0 * t).sin())
    };
    let one = |k: u32| {
        let force = if k < 5 {
            0.0
        } else if k < 60 {
            420.0
        } else {
            -420.0
        };
        let ((trim, factor, shaker), next) = (at(k), at(k + 1));
        Inputs {
            force: [force; 2],
            trim: [trim, next.0],
            stiffness_factor: [factor, next.1],
            shaker: [shaker, next.2],
            ..Inputs::NONE
        }
    };
    (0..count).map(one).collect()
}

/// The original loop, a sample at every step, no outputs; analog without `timing`.
pub fn job<'a>(inputs: &'a [Inputs], values: &'a [[f64; COUNT]], timing: Option<Timing>) -> Job<'a> {
    let effects = values.iter().map(Effects::of).reduce(Effects::or).expect("a run");
    Job {
        shared: Shared {
            effects: Effects { sampled: timing.is_some(), ..effects },
            step_s: STEP,
            timing,
            curve: None,
            cancellation: None,
        },
        start: Start::Under(0.0),
        inputs,
        flights: &[],
        values,
        law: Law::Original,
        force_scale: None,
        changes: &[],
        noise: (1, Some(0)),
        angle_noise: 0.0,
        sampling: Sampling::Every(1),
        outputs: &[],
    }
}

/// Measures and histories.
pub fn run(job: &Job<'_>, threads: usize) -> (Vec<Values>, Vec<f64>) {
    let mut histories = vec![f64::NAN; job.values.len() * job.outputs.len() * job.samples()];
    let measures = forcefeel_batch::run(job, threads, &mut histories).expect("threads");
    (measures, histories)
}

/// How fast errors fall when the step is halved: the least slope.
pub fn order(errors: &[f64]) -> f64 {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).fold(f64::INFINITY, f64::min)
}

/// Bits, so that what is not a number is equal to itself.
pub fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// The bits of each run depend neither on the threads nor on its place in the batch; `laws` are those of the runs, if each has one.
pub fn assert_bits_stay(job: &Job<'_>, laws: Option<&[[f64; NUMBERS]]>) {
    let (measures, histories) = run(job, 1);
    for threads in [2, 3] {
        let (again, histories_again) = run(job, threads);
        assert_eq!(bits(measures.as_flattened()), bits(again.as_flattened()), "{threads}");
        assert_eq!(bits(&histories), bits(&histories_again), "{threads}");
    }
    let size = histories.len() / job.values.len();
    for k in [0, 7, 15, 16, 31, 32, 36] {
        // Alone it runs in plain double precision, with the noise of its own index.
        let law = laws.map_or(job.law, |laws| Law::Observers(&laws[k..=k]));
        let noise = (job.noise.0, job.noise.1.map(|first| first + k as u64));
        let (found, history) = run(&Job { values: &job.values[k..=k], law, noise, ..job.clone() }, 1);
        assert_eq!(bits(found.as_flattened()), bits(&measures[k]), "run {k}");
        assert_eq!(bits(&history), bits(&histories[k * size..(k + 1) * size]), "run {k}");
    }
    // The other way round, each has other neighbors; the noise goes with the index and stays away.
    let mut quiet = job.clone();
    quiet.shared.effects.noise = false;
    let (straight, _) = run(&quiet, 1);
    let turned: Vec<_> = job.values.iter().rev().copied().collect();
    let laws_turned: Vec<_> = laws.unwrap_or_default().iter().rev().copied().collect();
    let law = laws.map_or(job.law, |_| Law::Observers(&laws_turned));
    let (found, _) = run(&Job { values: &turned, law, ..quiet }, 1);
    for (k, found) in found.iter().rev().enumerate() {
        assert_eq!(bits(found), bits(&straight[k]), "run {k}");
    }
}
