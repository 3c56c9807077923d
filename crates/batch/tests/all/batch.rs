//! Batches of runs: the same bits on any number of threads and in any place, members that fail, samples, laws.

use crate::runs::{GAINS, STEP, assert_bits_stay, bits, drawn, everything, job, order, run, steps};
use forcefeel_model::compensator::Compensator;
use forcefeel_model::controller::Timing;
use forcefeel_model::machine::Inputs;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_simulate::batch::{Change, Job, Sampling, Values};
use forcefeel_simulate::measures::MEASURES;
use forcefeel_solve::law::Law;
use forcefeel_solve::outputs::OUTPUTS;
use forcefeel_solve::start::Start;

/// Two groups and five runs of a third.
const RUNS: usize = 37;
const ALL: [usize; OUTPUTS.len()] = {
    let mut all = [0; OUTPUTS.len()];
    let mut k = 0;
    while k < all.len() {
        all[k] = k;
        k += 1;
    }
    all
};
const TIMING: Timing = Timing { period: 2, delay: 3 };

fn bits_of(measures: &[Values]) -> Vec<u64> {
    bits(measures.as_flattened())
}

/// Index of a measure.
fn measure(name: &str) -> usize {
    MEASURES.iter().position(|(measure, _)| *measure == name).expect("a measure")
}

/// Every effect there is, analog with two samples a step and digital with noise.
fn jobs<'a>(inputs: &'a [Inputs], values: &'a [[f64; COUNT]]) -> [Job<'a>; 2] {
    let analog = Job { sampling: Sampling::Halves, outputs: &ALL, ..job(inputs, values, None) };
    let law = Law::Fixed(Compensator::state_feedback(&everything(), GAINS));
    let start = Start::Held(0.05, 20);
    let digital = Job { law, start, sampling: Sampling::Every(3), outputs: &ALL, ..job(inputs, values, Some(TIMING)) };
    [analog, digital]
}

#[test]
fn bits_depend_neither_on_threads_nor_on_the_place_in_the_batch() {
    let (inputs, values) = (steps(100, STEP), drawn(RUNS, 0.1));
    for job in jobs(&inputs, &values) {
        assert_bits_stay(&job, None);
    }
}

#[test]
fn link_that_closes_its_play_leaves_a_saturated_neighbor_alone() {
    // Current limits for which limit / admittance times admittance is a rounding below the limit, in every second run.
    let mut inputs = steps(200, STEP);
    for now in &mut inputs[100..] {
        now.force = [420.0; 2];
    }
    let (mut values, mut short) = (drawn(2 * RUNS, 0.0), 0);
    for (k, values) in (0_u32..).zip(&mut values) {
        let mut p = Parameters::from_values(values);
        p.linkage.backlash = 2e-4 * f64::from(k % 5);
        p.amplifier.admittance *= 0.8 + 5e-3 * f64::from(k);
        let back = |limit: f64| limit / p.amplifier.admittance * p.amplifier.admittance;
        let limits = (0..1000).map(|share| 3e-4 + 1e-7 * f64::from(share));
        let limit = limits.into_iter().find(|&limit| k % 2 == 1 || back(limit) < limit).unwrap_or(3e-4);
        short += u32::from(back(limit) < limit);
        p.amplifier.current_limit = limit;
        *values = p.values();
    }
    assert!(short > 10, "{short}");
    let (together, _) = run(&job(&inputs, &values, None), 1);
    for (measures, values) in together.iter().zip(&values) {
        let limit = Parameters::from_values(values).amplifier.current_limit;
        assert!(measures[measure("peak_current")] >= limit, "it is at its limit");
    }
    for (k, one) in values.iter().enumerate() {
        let (alone, _) = run(&job(&inputs, core::slice::from_ref(one), None), 1);
        assert_eq!(bits_of(&alone), bits(&together[k]), "run {k}");
    }
}

#[test]
fn control_that_meets_its_hard_stop_leaves_a_neighbor_that_sticks_alone() {
    // What sticks has gone no way, which the time since a touch is a part of.
    let (inputs, mut values) = (steps(400, STEP), drawn(RUNS, 0.0));
    for (k, values) in values.iter_mut().enumerate() {
        let mut p = Parameters::from_values(values);
        p.feel.hard_stop_high = 0.01;
        if k % 2 == 1 {
            (p.feel.coulomb_friction, p.feel.static_friction) = (1e4, 1e4);
        }
        *values = p.values();
    }
    let (together, _) = run(&job(&inputs, &values, None), 1);
    for (k, one) in values.iter().enumerate() {
        let (alone, _) = run(&job(&inputs, core::slice::from_ref(one), None), 1);
        assert!(together[k].iter().take(3).all(|value| value.is_finite()), "run {k}: {:?}", together[k]);
        assert_eq!(bits_of(&alone), bits(&together[k]), "run {k}");
    }
}

#[test]
fn every_size_of_a_last_group_is_written_whole() {
    let (inputs, values) = (steps(20, STEP), drawn(18, 0.1));
    let whole = run(&Job { outputs: &[0, 6], ..job(&inputs, &values, None) }, 1);
    for count in 1..values.len() {
        let (measures, histories) = run(&Job { outputs: &[0, 6], ..job(&inputs, &values[..count], None) }, 2);
        assert_eq!(bits_of(&measures), bits_of(&whole.0[..count]));
        assert_eq!(bits(&histories), bits(&whole.1[..histories.len()]));
    }
}

#[test]
fn member_that_fails_leaves_the_others_alone() {
    // So long that a column of negative inertia diverges whatever else is drawn.
    let (inputs, values) = (steps(600, STEP), drawn(20, 0.1));
    let mut broken = values.clone();
    let break_of = |values: &mut [f64; COUNT], change: &dyn Fn(&mut Parameters<f64>)| {
        let mut p = Parameters::from_values(values);
        change(&mut p);
        *values = p.values();
    };
    break_of(&mut broken[3], &|p| p.column.inertia *= -1.0);
    break_of(&mut broken[11], &|p| p.linkage.stiffness = f64::NAN);
    break_of(&mut broken[17], &|p| p.valve.supply_pressure = 0.0);
    for timing in [None, Some(TIMING)] {
        let good = run(&Job { outputs: &ALL, ..job(&inputs, &values, timing) }, 1);
        let found = run(&Job { outputs: &ALL, ..job(&inputs, &broken, timing) }, 1);
        let size = good.1.len() / 20;
        for k in 0..20 {
            let failed = [3, 11, 17].contains(&k);
            assert_eq!(found.0[k][measure("diverged_at")].is_finite(), failed, "run {k}");
            if !failed {
                assert_eq!(bits(&found.0[k]), bits(&good.0[k]), "run {k}");
                let one = k * size..(k + 1) * size;
                assert_eq!(bits(&found.1[one.clone()]), bits(&good.1[one]), "run {k}");
            }
        }
    }
}

#[test]
fn samples_every_so_many_steps_are_those_of_every_step() {
    let (inputs, values) = (steps(101, STEP), drawn(17, 0.1));
    let every = |n: usize| run(&Job { sampling: Sampling::Every(n), outputs: &ALL, ..job(&inputs, &values, None) }, 1);
    let (_, all) = every(1);
    for n in [2, 5, 7, 101, 102] {
        let samples = 101 / n + 1;
        let (_, found) = every(n);
        for (row, found) in all.chunks(102).zip(found.chunks(samples)) {
            let picked: Vec<f64> = row.iter().step_by(n).copied().collect();
            assert_eq!(bits(found), bits(&picked));
        }
    }
}

#[test]
fn half_steps_agree_with_steps_where_both_are() {
    let (inputs, values) = (steps(60, STEP), drawn(17, 0.1));
    for timing in [None, Some(TIMING)] {
        let job = Job { outputs: &ALL, ..job(&inputs, &values, timing) };
        let (_, whole) = run(&job, 1);
        let (_, halves) = run(&Job { sampling: Sampling::Halves, ..job.clone() }, 1);
        // The angle alone is had more cheaply, and is the same.
        let (_, angles) = run(&Job { sampling: Sampling::Halves, outputs: &[0], ..job }, 1);
        for (row, (whole, halves)) in whole.chunks(61).zip(halves.chunks(121)).enumerate() {
            let picked: Vec<f64> = halves.iter().step_by(2).copied().collect();
            assert_eq!(bits(whole), bits(&picked));
            if row % OUTPUTS.len() == 0 {
                let run = row / OUTPUTS.len();
                assert_eq!(bits(halves), bits(&angles[run * 121..(run + 1) * 121]));
            }
        }
    }
}

#[test]
fn middles_of_a_smooth_run_are_those_of_a_fine_one_to_third_order() {
    // Orifice and gravity, and nothing that switches. Current apart: it is drawn straight.
    let mut p = Parameters::elevator();
    p.valve.orifice = 1.0;
    p.column.gravity_torque = 10.0;
    p.linkage.damping *= 1e-4; // without the oil's pole nothing is slaved, and no floor of the slaving is seen
    let values = [p.values()];
    let outputs = [0, 1, 2, 3, 4, 5, 6, 7];
    let ramps = |h: f64| {
        // 0.4 s, straight between points 16 ms apart: the same force at every step.
        let force = |t: f64| 250.0 * (t / 0.016).floor().mul_add(0.4, 0.0).sin();
        let at = |t: f64| {
            let (left, share) = (t / 0.016, (t / 0.016).fract());
            let point = |k: f64| force((left.floor() + k) * 0.016 + 1e-6);
            point(0.0) + (point(1.0) - point(0.0)) * share
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundreds of steps")]
        let count = (0.4 / h).round() as u32;
        (0..count)
            .map(|k| crate::runs::pushed([at(f64::from(k) * h + 1e-9), at(f64::from(k + 1) * h - 1e-9)]))
            .collect::<Vec<_>>()
    };
    let trace = |h: f64, sampling: Sampling| {
        let inputs = ramps(h);
        let mut job = Job { sampling, outputs: &outputs, ..job(&inputs, &values, None) };
        job.shared.step_s = h;
        run(&job, 1).1
    };
    let finest = 2.5e-4;
    let fine = trace(finest, Sampling::Every(1));
    let samples = fine.len() / outputs.len();
    let errors = [4e-3, 2e-3, 1e-3].map(|h| {
        let halves = trace(h, Sampling::Halves);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a handful")]
        let parts = (0.5 * h / finest).round() as usize;
        halves
            .chunks(halves.len() / outputs.len())
            .zip(fine.chunks(samples))
            .map(|(halves, fine)| {
                let size = fine.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                let off = |k: usize| (halves[k] - fine[k * parts]).abs() / size;
                (1..halves.len()).step_by(2).map(off).fold(0.0, f64::max)
            })
            .collect::<Vec<_>>()
    });
    for (k, &output) in outputs.iter().enumerate() {
        let of = errors.each_ref().map(|errors| errors[k]);
        assert!(order(&of) > 2.8, "{}: {of:?}", OUTPUTS[output].0);
    }
}

#[test]
fn measures_are_the_same_whether_histories_are_kept_or_not() {
    let (inputs, values) = (steps(150, STEP), drawn(18, 0.1));
    for timing in [None, Some(TIMING)] {
        let none = job(&inputs, &values, timing);
        let (measures, histories) = run(&none, 2);
        assert!(histories.is_empty());
        let (with, _) = run(&Job { outputs: &ALL, ..none }, 2);
        assert_eq!(bits_of(&measures), bits_of(&with));
    }
}

#[test]
fn gains_of_each_run_are_a_law_of_its_own() {
    let inputs = steps(100, STEP);
    let values = vec![everything().values(); 9];
    let gains: Vec<[f64; 7]> = (0_u8..9).map(|k| GAINS.map(|gain| gain * (1.0 + 0.01 * f64::from(k)))).collect();
    for timing in [None, Some(TIMING)] {
        let many = Job { law: Law::Gains(&gains), outputs: &ALL, ..job(&inputs, &values, timing) };
        let (measures, histories) = run(&many, 1);
        let size = histories.len() / 9;
        for (k, &gains) in gains.iter().enumerate() {
            let law = Law::Fixed(Compensator::state_feedback(&everything(), gains));
            let alone = Job { law, values: &values[..1], noise: (1, Some(k as u64)), ..many.clone() };
            let (one, history) = run(&alone, 1);
            assert_eq!(bits_of(&one), bits(&measures[k]));
            assert_eq!(bits(&history), bits(&histories[k * size..(k + 1) * size]));
        }
        assert_ne!(bits(&measures[0]), bits(&measures[1]));
    }
}

#[test]
fn fixed_law_meets_each_loader_and_gains_are_told_its_geometry() {
    let inputs = steps(100, STEP);
    let mut other = everything();
    other.linkage.ratio *= 1.05;
    let values = [everything().values(), other.values()];
    let gains = [GAINS; 2];
    let of = |law| run(&Job { law, outputs: &ALL, ..job(&inputs, &values, None) }, 1).1;
    let fixed = of(Law::Fixed(Compensator::state_feedback(&everything(), GAINS)));
    let each = of(Law::Gains(&gains));
    let size = fixed.len() / 2;
    // The arm of the load cell is alpha R_b: the nominal loader's in the one, each run's own in the other.
    assert_eq!(bits(&fixed[..size]), bits(&each[..size]));
    assert_ne!(bits(&fixed[size..]), bits(&each[size..]));
}

#[test]
fn only_a_law_that_receives_more_than_the_position_loop_feeds_back() {
    let p = Parameters::elevator();
    assert!(!Law::Original.feeds_back());
    assert!(!Law::Fixed(Compensator::original(&p)).feeds_back());
    assert!(Law::Gains(&[GAINS]).feeds_back());
    for k in [1, 3, 4, 5, 6] {
        let mut law = Compensator::original(&p);
        law.gains[k] = 1e-3;
        assert!(Law::Fixed(law).feeds_back());
    }
}

#[test]
fn factor_on_the_force_is_a_larger_force() {
    let values = drawn(17, 0.1);
    let (inputs, doubled) = (steps(100, STEP), steps(100, STEP));
    let doubled: Vec<Inputs> =
        doubled.iter().map(|now| Inputs { force: now.force.map(|force| 2.0 * force), ..*now }).collect();
    let scale = [2.0; 17];
    let scaled = run(&Job { force_scale: Some(&scale), outputs: &ALL, ..job(&inputs, &values, None) }, 1);
    let plain = run(&Job { outputs: &ALL, ..job(&doubled, &values, None) }, 1);
    assert_eq!(bits(&scaled.1), bits(&plain.1));
}

#[test]
fn change_of_the_feel_to_what_it_is_changes_nothing() {
    let values = drawn(1, 0.0);
    let mut inputs = steps(120, STEP);
    for (k, now) in (0_u8..).zip(&mut inputs[40..60]) {
        now.fade = [f64::from(k) / 20.0, f64::from(k + 1) / 20.0];
    }
    let change = [Change { steps: (40, 60), values: values[0], observer: None }];
    for timing in [None, Some(TIMING)] {
        let plain = Job { outputs: &ALL, ..job(&inputs, &values, timing) };
        let (_, with) = run(&Job { changes: &change, ..plain.clone() }, 1);
        let (_, without) = run(&plain, 1);
        for (row, (with, without)) in with.chunks(121).zip(without.chunks(121)).enumerate() {
            let size = without.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            for (with, without) in with.iter().zip(without) {
                // A quotient of two equal numbers times a third, when the change is done.
                assert!((with - without).abs() <= 1e-10 * size, "{}: {with} {without}", OUTPUTS[row].0);
            }
        }
    }
}

#[test]
#[should_panic(expected = "histories")]
fn histories_of_another_size_are_refused() {
    let (inputs, values) = (steps(10, STEP), drawn(2, 0.0));
    let job = Job { outputs: &[0], ..job(&inputs, &values, None) };
    forcefeel_batch::run(&job, 1, &mut [0.0; 3]).expect("threads");
}
