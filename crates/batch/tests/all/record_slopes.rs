//! Slopes of records: each pair's own, whatever goes beside it, and those of a difference.

use crate::near::assert_within;
use forcefeel_model::channels::COUNT as CHANNELS;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::Inputs;
use forcefeel_model::parameters::{COUNT, Parameters, TABLE};
use forcefeel_simulate::batch::Job;
use forcefeel_slopes::record_slopes::SlopeJob;
use forcefeel_solve::law::Law;
use forcefeel_solve::start::Start;

/// Relative step of a central difference; extrapolated from it and its half, the error is of fourth order, 1e-16.
const STEP: f64 = 1e-4;
/// Of record and slope: the difference's rounding, 1e-16 / 1e-4, with three digits for pressures that are differences of larger ones.
const DIFFERENCE: f64 = 1e-9;

fn key(part: &str, name: &str) -> usize {
    TABLE.iter().position(|row| (row.part, row.name) == (part, name)).expect("a row of the table")
}

/// A voltage that swings.
fn swing(count: usize) -> Vec<Inputs> {
    let at = |k: usize| 0.5 * (0.02 * f64::from(u32::try_from(k).expect("a small number"))).sin();
    (0..count).map(|k| Inputs { test_signal: [at(k), at(k + 1)], ..Inputs::NONE }).collect()
}

fn slopes(job: Job<'_>, keys: &[usize], threads: usize) -> (Vec<f64>, Vec<f64>) {
    let channels: Vec<usize> = (0..CHANNELS).collect();
    let mut slopes = vec![f64::NAN; job.values.len() * keys.len() * CHANNELS * job.samples()];
    let values = SlopeJob { job, keys, channels: &channels }.run(threads, &mut slopes).expect("threads");
    (values, slopes)
}

fn job<'a>(inputs: &'a [Inputs], values: &'a [[f64; COUNT]], law: Law<'a>) -> Job<'a> {
    let mut job = Job { law, ..crate::runs::job(inputs, values, None) };
    job.shared.effects = Effects { orifice: true, ..job.shared.effects };
    job
}

#[test]
fn slopes_of_records_are_differences_under_every_law_by_name() {
    let inputs = swing(300);
    for law in [Law::Open, Law::Position, Law::Original] {
        let p = Parameters::elevator().values();
        for k in [key("valve", "rated_flow"), key("linkage", "stiffness"), key("column", "inertia")] {
            let moved = |share: f64| core::array::from_fn(|j| if j == k { p[j] * (1.0 + share) } else { p[j] });
            let five = [p, moved(STEP), moved(-STEP), moved(STEP / 2.0), moved(-STEP / 2.0)];
            let (values, slopes) = slopes(job(&inputs, &five, law), &[k], 1);
            let records: Vec<&[f64]> = values.chunks(values.len() / five.len()).collect();
            let samples = inputs.len() + 1;
            let most = |of: &[f64]| of.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            for from in (0..records[0].len()).step_by(samples) {
                let slope: Vec<f64> = slopes[from..from + samples].iter().map(|slope| slope * p[k]).collect();
                let within = DIFFERENCE * (most(&records[0][from..from + samples]) + most(&slope));
                for (at, slope) in (from..).zip(slope) {
                    let whole = (records[1][at] - records[2][at]) / (2.0 * STEP);
                    let half = (records[3][at] - records[4][at]) / STEP;
                    assert_within((4.0 * half - whole) / 3.0, slope, within);
                }
            }
        }
    }
}

/// Begun from a held column, in the position loop.
fn held<'a>(inputs: &'a [Inputs], values: &'a [[f64; COUNT]]) -> Job<'a> {
    Job { start: Start::Held(0.02, 40), ..job(inputs, values, Law::Position) }
}

#[test]
fn pair_depends_on_no_other_and_on_no_number_of_threads() {
    let inputs = swing(120);
    // More than go along with one run.
    let keys = [
        key("actuator", "oil_volume"),
        key("column", "base_arm"),
        key("column", "inertia"),
        key("linkage", "ratio"),
        key("linkage", "stiffness"),
        key("linkage", "damping"),
        key("valve", "rated_flow"),
        key("actuator", "area"),
    ];
    // Of the loaders that are drawn, those that do not diverge.
    let finite = |values: &[f64; COUNT]| {
        let (_, slopes) = slopes(held(&inputs, core::slice::from_ref(values)), &keys, 1);
        slopes.iter().all(|slope| slope.is_finite())
    };
    let values: Vec<_> = crate::runs::drawn(12, 0.02).into_iter().filter(finite).take(3).collect();
    assert_eq!(values.len(), 3);
    let job = held(&inputs, &values);
    let (together, along) = slopes(job.clone(), &keys, 2);
    let (again, once) = slopes(job.clone(), &keys, 1);
    assert!(together == again && along == once);
    assert!(along.iter().all(|slope| slope.is_finite()));
    let size = together.len() / values.len();
    for run in 0..values.len() {
        for (k, &key) in keys.iter().enumerate() {
            let alone = Job { values: &values[run..=run], ..job.clone() };
            let (value, slope) = slopes(alone, &[key], 1);
            assert!(value == together[run * size..(run + 1) * size]);
            let pair = run * keys.len() + k;
            assert!(slope == along[pair * size..(pair + 1) * size]);
        }
    }
}
