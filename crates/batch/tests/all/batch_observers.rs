//! Runs under sampled laws with an observer: one that repeats static gains, at rest, changed while running, side by side.

use crate::observers::{DEAF, Sampled};
use crate::runs::{assert_bits_stay, bits, drawn, pushed, run, steps};
use forcefeel_model::controller::Timing;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::Inputs;
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_simulate::batch::{Change, Job};
use forcefeel_solve::law::Law;
use forcefeel_solve::outputs::OUTPUTS;
use forcefeel_solve::start::Start;

const H: f64 = 2.5e-4;
const TIMING: Timing = Timing { period: 2, delay: 1 };
const PERIOD: f64 = 2.0 * H;

const ALL: [usize; OUTPUTS.len()] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9];
const ANGLE: usize = 0;
const CURRENT: usize = 8;
/// About the most that each output is in a swing.
const SIZES: [f64; OUTPUTS.len()] = [0.03, 0.6, 0.05, 1.0, 5e-3, 2e3, 1e6, 1e-4, 1e-3, 200.0];

/// The same equations in another order: the roundings of a thousand periods, as a share of the most that an output is.
const SAME: f64 = 1e-12;
/// A current limit in A that a swing meets.
const LIMIT: f64 = 8e-4;

/// A push, a pull, nothing and a push; the feel and its surroundings as they are.
fn swing(count: usize) -> Vec<Inputs> {
    let force = |k: usize| [150.0, -220.0, 0.0, 80.0][4 * k / count];
    (0..count).map(|k| pushed([force(k); 2])).collect()
}

/// Inputs with the next feel's share growing evenly through these steps.
fn fading(mut inputs: Vec<Inputs>, (begin, done): (usize, usize)) -> Vec<Inputs> {
    #[expect(clippy::cast_precision_loss, reason = "some hundreds")]
    let share = |step: usize| (step - begin) as f64 / (done - begin) as f64;
    for (step, now) in inputs.iter_mut().enumerate().take(done).skip(begin) {
        now.fade = [share(step), share(step + 1)];
    }
    inputs
}

fn job<'a>(inputs: &'a [Inputs], values: &'a [[f64; COUNT]], law: Law<'a>) -> Job<'a> {
    let mut job = Job { law, outputs: &ALL, ..crate::runs::job(inputs, values, Some(TIMING)) };
    job.shared.step_s = H;
    job.shared.effects = Effects { observer: matches!(law, Law::Observers(_)), ..job.shared.effects };
    job
}

/// The history of each output of each run.
fn rows<'a>(histories: &'a [f64], inputs: &[Inputs]) -> impl Iterator<Item = &'a [f64]> {
    histories.chunks(inputs.len() + 1)
}

fn largest(row: &[f64]) -> f64 {
    row.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Asserts that histories differ by no more than so much of the most that each output is.
fn assert_same(found: &[f64], expected: &[f64], inputs: &[Inputs], share: f64) {
    assert_eq!(found.len(), expected.len());
    for (k, (found, expected)) in rows(found, inputs).zip(rows(expected, inputs)).enumerate() {
        let off = found.iter().zip(expected).map(|(found, expected)| (found - expected).abs()).fold(0.0, f64::max);
        let (output, size) = (k % OUTPUTS.len(), largest(expected));
        assert!(off <= share * size, "{} of {}: {off:e} of {size:e}", OUTPUTS[output].0, k / OUTPUTS.len());
    }
}

/// The elevator loader, and some whose linkage and valve are not what they are said to be.
fn perturbed() -> Vec<Parameters<f64>> {
    let mut all = vec![Parameters::elevator(); 5];
    for (k, p) in (-2_i32..).zip(&mut all) {
        let by = 1.0 + 0.05 * f64::from(k);
        p.linkage.stiffness *= by;
        p.linkage.damping /= by;
        p.valve.current_gain *= by;
        p.valve.pressure_gain /= by * by;
        p.valve.natural_frequency /= by;
    }
    all
}

fn limited(p: &mut Parameters<f64>) {
    (p.amplifier.current_limit, p.controller.antiwindup) = (LIMIT, 100.0);
}

fn noisy(p: &mut Parameters<f64>) {
    (p.load_cell.noise, p.potentiometer.noise, p.column_sensor.noise) = (0.5, 1e-6, 1e-6);
}

fn off_zero(p: &mut Parameters<f64>) {
    (p.load_cell.offset, p.potentiometer.offset, p.column_sensor.offset) = (2.0, 3e-5, -1e-3);
}

fn with_play(p: &mut Parameters<f64>) {
    p.linkage.backlash = 5e-5;
}

/// What is changed at a loader, one after the other.
type Changes<'a> = &'a [fn(&mut Parameters<f64>)];

fn changed(p: &mut Parameters<f64>, changes: Changes<'_>) {
    for change in changes {
        change(p);
    }
}

#[test]
fn law_that_repeats_the_gains_gives_their_run() {
    let inputs = swing(1200);
    let variants: [Changes<'_>; 4] = [&[], &[limited], &[noisy, off_zero], &[limited, noisy, off_zero]];
    for changes in variants {
        let mut loaders = perturbed();
        for p in &mut loaders {
            changed(p, changes);
        }
        let values: Vec<_> = loaders.iter().map(Parameters::values).collect();
        let laws: Vec<_> = loaders.iter().map(|p| Sampled::repeating(p, DEAF, PERIOD).numbers()).collect();
        let gains = vec![DEAF; values.len()];
        for start in [Start::Under(0.0), Start::Held(0.05, 40)] {
            let of = |law| run(&Job { start, ..job(&inputs, &values, law) }, 1).1;
            let (expected, found) = (of(Law::Gains(&gains)), of(Law::Observers(&laws)));
            assert_same(&found, &expected, &inputs, SAME);
            let is_limited = loaders[0].amplifier.current_limit < f64::INFINITY;
            for current in rows(&found, &inputs).skip(CURRENT).step_by(OUTPUTS.len()) {
                assert_eq!(largest(current) <= LIMIT, is_limited, "without a limit it is beyond it");
            }
        }
    }
}

#[test]
fn law_replayed_on_its_samples_gives_the_currents_of_the_run() {
    let inputs = swing(1200);
    // A sample of the load cell lies between two steps of the history: a command that does not depend on it.
    let gains = core::array::from_fn(|k| if k == 1 { 0.0 } else { DEAF[k] });
    let variants: [Changes<'_>; 2] = [&[], &[limited]];
    for changes in variants {
        let mut p = Parameters::elevator();
        changed(&mut p, changes);
        let law = Sampled::estimating(&p, gains, PERIOD, 0.3);
        let (_, found) = run(&job(&inputs, &[p.values()], Law::Observers(&[law.numbers()])), 1);
        let history: Vec<&[f64]> = rows(&found, &inputs).collect();
        // The amplifier answers a command up to its largest current, and the law receives what it answers.
        let range = p.amplifier.current_limit / p.amplifier.admittance;
        let (mut xi, mut cut) = (Sampled::at_neutral(), 0);
        for step in (0..inputs.len() - TIMING.delay).step_by(TIMING.period) {
            let [angle, delta, delta_rate, piston, force] = [0, 2, 3, 4, 5].map(|output| history[output][step]);
            let answered = |e: f64| e.clamp(-range, range);
            let (next, e) = law.replay(&xi, [force, piston, angle, 0.0], [delta, delta_rate], answered);
            let current = history[CURRENT][step + TIMING.delay];
            let off = (current - p.amplifier.admittance * e).abs();
            assert!(off <= SAME * SIZES[CURRENT], "step {step}: {off:e} beside {current:e}");
            cut += u32::from(e.abs() >= range);
            xi = next;
        }
        assert_eq!(cut > 10, !changes.is_empty(), "{cut} times cut off");
    }
}

#[test]
fn run_that_starts_at_rest_stays_there() {
    // As good as the bisection: a rounding of the largest numbers that go into it.
    const AT_REST: f64 = 1e-13;
    let variants: [Changes<'_>; 4] = [&[], &[off_zero], &[with_play], &[off_zero, with_play]];
    for changes in variants {
        let mut p = Parameters::elevator();
        changed(&mut p, changes);
        for share in [0.3, -0.3] {
            let (values, laws) = ([p.values()], [Sampled::estimating(&p, DEAF, PERIOD, share).numbers()]);
            // The link pushes or pulls with more than what its play is worth.
            for (angle, force) in [(0.05, 50.0), (-0.1, -90.0)] {
                for (start, force) in [(Start::Held(angle, 2000), 0.0), (Start::Under(force), force)] {
                    let inputs = vec![pushed([force; 2]); 1999];
                    let (_, found) = run(&Job { start, ..job(&inputs, &values, Law::Observers(&laws)) }, 1);
                    for (output, row) in rows(&found, &inputs).enumerate() {
                        let moved = row.iter().map(|value| (value - row[0]).abs()).fold(0.0, f64::max);
                        assert!(moved <= AT_REST * SIZES[output], "{start:?}: {} by {moved:e}", OUTPUTS[output].0);
                    }
                    if let Start::Held(angle, _) = start {
                        assert!((found[ANGLE] - angle).abs() <= AT_REST, "{start:?}: {}", found[ANGLE]);
                    }
                }
            }
        }
    }
}

#[test]
fn run_at_rest_under_a_law_that_estimates_is_where_the_equations_say() {
    let mut p = Parameters::elevator();
    off_zero(&mut p);
    let (share, angle) = (0.3, 0.05);
    let (values, laws) = ([p.values()], [Sampled::estimating(&p, DEAF, PERIOD, share).numbers()]);
    let inputs = [pushed([0.0; 2])];
    let start = Start::Held(angle, 2);
    let (_, found) = run(&Job { start, ..job(&inputs, &values, Law::Observers(&laws)) }, 1);
    let at_rest: Vec<f64> = rows(&found, &inputs).map(|row| row[0]).collect();
    let [delta, piston, force, pressure, current] = [2, 4, 5, 6, CURRENT].map(|output| at_rest[output]);
    let Parameters { linkage: link, column, feel, amplifier, valve, .. } = p;
    let near = |found: f64, expected: f64, size: f64| {
        assert!((found - expected).abs() <= 1e-12 * size, "{found} for {expected}");
    };
    // A p = k (x_p - alpha x_b),  C_i i = C_p p
    near(force, link.stiffness * (piston - link.ratio * column.base_arm * angle), 500.0);
    near(valve.current_gain * current, valve.pressure_gain * pressure, valve.pressure_gain * 5e5);
    // The estimate of the link's excess is all that the sensors add; G delta = T.
    let shown = angle + p.column_sensor.offset;
    let stretch = piston + p.potentiometer.offset - link.ratio * column.base_arm * shown;
    let feel_torque = force + p.load_cell.offset;
    let excess = feel_torque - link.stiffness * stretch;
    let torque = -link.ratio * column.base_arm * (feel_torque + share * excess);
    near(feel.stiffness * delta, torque, 50.0);
    // e = c x + d,  d = 9/10 e / (1/10 + 9/10) of the whole command
    let [c_1, c_2, c_3, _, c_5, ..] = DEAF;
    let x = c_1 * (piston + p.potentiometer.offset)
        + c_2 * feel_torque / p.actuator.area
        + c_3 * delta
        + c_5 * column.base_arm * shown;
    near(current / amplifier.admittance, 10.0 * x, 20.0 * angle);
}

/// The elevator loader's values, those with a stiffer and heavier feel, and a law for each.
fn two_settings() -> ([[f64; COUNT]; 2], [Sampled; 2]) {
    let one = Parameters::elevator();
    let mut other = one;
    (other.feel.stiffness, other.feel.inertia, other.feel.damping) =
        (1.5 * one.feel.stiffness, 1.2 * one.feel.inertia, 1.4 * one.feel.damping);
    let laws = [
        Sampled::estimating(&one, DEAF, PERIOD, 0.3),
        Sampled::estimating(&one, DEAF, PERIOD, -0.2).further(1.05).faster(3.0),
    ];
    ([one.values(), other.values()], laws)
}

#[test]
fn change_to_the_same_feel_and_law_changes_nothing() {
    let ([one, _], [law, _]) = two_settings();
    let (values, laws) = ([one], [law.numbers()]);
    let steps = (400, 500);
    let inputs = fading(swing(1200), steps);
    let plain = job(&inputs, &values, Law::Observers(&laws));
    let (_, without) = run(&plain, 1);
    for observer in [None, Some(laws[0])] {
        let changes = [Change { steps, values: one, observer }];
        let (_, with) = run(&Job { changes: &changes, ..plain.clone() }, 1);
        assert_same(&with, &without, &inputs, SAME);
    }
}

#[test]
fn change_of_the_feel_alone_keeps_the_law() {
    let ([one, other], [law, _]) = two_settings();
    let (values, laws) = ([one], [law.numbers()]);
    let steps = (400, 500);
    let inputs = fading(swing(1200), steps);
    let of = |values_after, observer| {
        let changes = [Change { steps, values: values_after, observer }];
        run(&Job { changes: &changes, ..job(&inputs, &values, Law::Observers(&laws)) }, 1).1
    };
    let kept = of(other, None);
    assert_eq!(bits(&kept), bits(&of(other, Some(laws[0]))));
    assert_ne!(bits(&kept), bits(&of(one, None)));
}

#[test]
fn law_after_a_change_is_the_second() {
    let ([one, other], [from, to]) = two_settings();
    let inputs = swing(1200);
    let (_, expected) = run(&job(&inputs, &[other], Law::Observers(&[to.numbers()])), 1);
    // From rest at neutral, where both laws are alike, the first period is already the second's.
    let mut at_once = inputs.clone();
    for now in &mut at_once[..TIMING.period] {
        now.fade = [1.0; 2];
    }
    let changes = [Change { steps: (0, TIMING.period), values: other, observer: Some(to.numbers()) }];
    let (values, laws) = ([one], [from.numbers()]);
    let (_, found) = run(&Job { changes: &changes, ..job(&at_once, &values, Law::Observers(&laws)) }, 1);
    assert_same(&found, &expected, &inputs, SAME);
    let (_, first) = run(&job(&inputs, &values, Law::Observers(&laws)), 1);
    assert!((first[600] - expected[600]).abs() > 0.01 * largest(&expected[..=1200]), "the laws differ");
}

#[test]
fn half_way_between_two_laws_is_the_law_of_their_mean() {
    let ([one, _], [from, to]) = two_settings();
    let (values, laws) = ([one], [from.numbers()]);
    let mean: [f64; NUMBERS] = core::array::from_fn(|k| 0.5 * (laws[0][k] + to.numbers()[k]));
    let inputs = swing(1200);
    let (_, expected) = run(&job(&inputs, &values, Law::Observers(&[mean])), 1);
    let mut half = inputs.clone();
    for now in &mut half {
        now.fade = [0.5; 2];
    }
    let changes = [Change { steps: (0, inputs.len() + 1), values: one, observer: Some(to.numbers()) }];
    let (_, found) = run(&Job { changes: &changes, ..job(&half, &values, Law::Observers(&laws)) }, 1);
    assert_same(&found, &expected, &inputs, SAME);
}

#[test]
fn change_of_the_law_makes_no_jump_and_ends_at_rest_under_the_second() {
    // A fade of a hundred periods moves the command from sample to sample by less than this share of what a switch does.
    const JUMP: f64 = 0.05;
    let ([one, other], [from, to]) = two_settings();
    let (values, laws) = ([one], [from.numbers()]);
    let start = Start::Under(60.0);
    let count = 40_000;
    let changing = |steps: (usize, usize)| {
        let inputs = fading(vec![pushed([60.0; 2]); count], steps);
        let changes = [Change { steps, values: other, observer: Some(to.numbers()) }];
        let job = Job { start, changes: &changes, ..job(&inputs, &values, Law::Observers(&laws)) };
        run(&job, 1).1
    };
    let largest_step = |histories: &[f64]| {
        let current = &histories[CURRENT * (count + 1)..(CURRENT + 1) * (count + 1)];
        current.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
    };
    let (faded, switched) = (changing((400, 600)), changing((400, 402)));
    let share = largest_step(&faded) / largest_step(&switched);
    assert!(share < JUMP, "{share}");
    // Where it starts at rest under the second law, the first arrives in time.
    let inputs = [pushed([60.0; 2])];
    let (_, rest) = run(&Job { start, ..job(&inputs, &[other], Law::Observers(&[to.numbers()])) }, 1);
    let histories = faded.chunks(count + 1);
    for (output, (row, rest)) in histories.zip(rows(&rest, &inputs)).enumerate() {
        let off = (row[count] - rest[0]).abs();
        assert!(off < 1e-6 * SIZES[output], "{}: {off:e}", OUTPUTS[output].0); // still settling
    }
}

/// Two groups of lanes and five runs of a third.
const RUNS: usize = 37;

/// An observer for each of these loaders, with every effect there is.
fn laws_of(values: &[[f64; COUNT]]) -> Vec<[f64; NUMBERS]> {
    let share = |k: u32| 0.3 - 0.01 * f64::from(k);
    let law = |(k, values)| Sampled::estimating(&Parameters::from_values(values), DEAF, PERIOD, share(k)).numbers();
    (0..).zip(values).map(law).collect()
}

#[test]
fn bits_depend_neither_on_threads_nor_on_the_place_in_the_batch() {
    let fade_steps = (40, 60);
    let (inputs, values) = (fading(steps(100, H), fade_steps), drawn(RUNS, 0.1));
    let laws = laws_of(&values);
    let changes = [Change { steps: fade_steps, values: values[3], observer: Some(laws[5]) }];
    let job = Job { changes: &changes, start: Start::Held(0.03, 20), ..job(&inputs, &values, Law::Observers(&laws)) };
    assert!(run(&job, 1).1.iter().all(|value| value.is_finite()));
    assert_bits_stay(&job, Some(&laws));
}

#[test]
fn one_law_for_all_is_the_same_law_for_each() {
    let (inputs, values) = (steps(60, H), drawn(RUNS, 0.1));
    let law = laws_of(&values)[0];
    let of = |laws: &[[f64; NUMBERS]]| run(&job(&inputs, &values, Law::Observers(laws)), 1).1;
    assert_eq!(bits(&of(&[law])), bits(&of(&vec![law; RUNS])));
}

#[test]
fn member_whose_law_is_not_made_of_numbers_leaves_the_others_alone() {
    let (inputs, values) = (steps(60, H), drawn(20, 0.1));
    let laws = laws_of(&values);
    let mut broken = laws.clone();
    broken[4] = [f64::NAN; NUMBERS];
    let of = |laws: &[[f64; NUMBERS]]| run(&job(&inputs, &values, Law::Observers(laws)), 1).1;
    let (good, found) = (of(&laws), of(&broken));
    let size = good.len() / values.len();
    for (k, (good, found)) in good.chunks(size).zip(found.chunks(size)).enumerate() {
        assert_eq!(bits(good) == bits(found), k != 4, "run {k}");
    }
}
