//! Matrices of a period against runs of the engine, sample by sample, and against the whole of what a period carries.

use crate::observers::{DEAF, Sampled};
use crate::runs::{GAINS, everything, pushed, run};
use forcefeel_batch::periods::periods as periods_of;
use forcefeel_matrices::period;
use forcefeel_model::controller::Timing;
use forcefeel_model::dual::Dual;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::period::{BASE, Drives, PERIOD_STATES, Period, YOUNGEST};
use forcefeel_model::machine::{Inputs, Machine, Shared};
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::transducers::SENSORS;
use forcefeel_simulate::batch::Job;
use forcefeel_slopes::periods::Periods;
use forcefeel_slopes::sampled_loops::{INPUTS, SampledLoops};
use forcefeel_solve::law::Law;
use forcefeel_solve::outputs::OUTPUTS as BATCH_OUTPUTS;
use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{DMatrix, DVector};

const H: f64 = 2.5e-4;
/// Places of what a period carries.
const PISTON: usize = 0;
const DELTA: usize = 5;
const DELTA_RATE: usize = 6;
const HELD: usize = 7;
const LAST_BASE: usize = YOUNGEST + 7;
const PRESSURE: usize = LAST_BASE + 1;
const MEASURED: usize = PRESSURE + 2;
const ESTIMATE: usize = MEASURED + 2 * SENSORS;

/// Delays of none, half a period, one and two periods and more, in periods of one step and of several.
const TIMINGS: [Timing; 8] = [
    Timing { period: 1, delay: 0 },
    Timing { period: 1, delay: 1 },
    Timing { period: 2, delay: 0 },
    Timing { period: 2, delay: 1 },
    Timing { period: 2, delay: 2 },
    Timing { period: 2, delay: 4 },
    Timing { period: 4, delay: 3 },
    Timing { period: 4, delay: 10 },
];

fn lagging() -> Parameters<f64> {
    let mut p = Parameters::elevator();
    (p.load_cell.bandwidth, p.potentiometer.bandwidth, p.column_sensor.bandwidth) = (3000.0, 2000.0, 1000.0);
    p
}

fn shared(values: &[[f64; COUNT]], law: Law<'_>, timing: Timing) -> Shared {
    let effects = values.iter().map(Effects::of).reduce(Effects::or).expect("a loop").smooth();
    let effects = Effects { sampled: true, observer: matches!(law, Law::Observers(_)), ..effects };
    Shared { effects, step_s: H, timing: Some(timing), curve: None, cancellation: None }
}

fn loops<'a>(values: &'a [[f64; COUNT]], law: Law<'a>, timing: Timing) -> SampledLoops<'a> {
    SampledLoops { effects: shared(values, law, timing).effects, step_s: H, timing, values, law }
}

fn periods(values: &[[f64; COUNT]], law: Law<'_>, timing: Timing) -> Periods {
    periods_of(&loops(values, law, timing), 1).expect("threads")
}

#[expect(clippy::cast_precision_loss, reason = "a handful")]
fn period_s(timing: Timing) -> f64 {
    timing.period as f64 * H
}

/// A law that estimates, for a period.
fn estimating(p: &Parameters<f64>, timing: Timing) -> [f64; NUMBERS] {
    Sampled::estimating(p, DEAF, period_s(timing), 0.3).numbers()
}

/// One loop's `M, b_e, b_F` and where its states stand.
struct Found {
    states: Vec<usize>,
    matrix: DMatrix<f64>,
    by_command: DVector<f64>,
    by_force: DVector<f64>,
}

impl Found {
    fn of(periods: &Periods, run: usize) -> Self {
        let (states, n) = (periods.states.clone(), periods.states.len());
        let size = n * (n + INPUTS);
        let whole = DMatrix::from_row_slice(n, n + INPUTS, &periods.matrices[run * size..(run + 1) * size]);
        let column = |k: usize| whole.column(k).into_owned();
        let matrix = whole.columns(0, n).into_owned();
        Self { states, matrix, by_command: column(n), by_force: column(n + 1) }
    }

    fn place(&self, state: usize) -> Option<usize> {
        self.states.iter().position(|&kept| kept == state)
    }

    fn state(&self, x: &DVector<f64>, state: usize) -> f64 {
        x[self.place(state).expect("a state that is kept")]
    }
}

/// `M, b_e, b_F` with every state, from the step itself, and what the force of before does.
fn whole(p: &Parameters<f64>, law: Law<'_>, timing: Timing) -> (DMatrix<f64>, DVector<f64>) {
    let shared = shared(&[p.values()], law, timing);
    let parameters = p.map(Dual::constant);
    let wide = |of: &dyn Fn(usize) -> f64| Dual::constant(of(0));
    let mut machine: Machine<Dual> = Machine::new(&parameters, law.compensator(&parameters, wide), &shared);
    if let Some(observer) = law.observer(wide) {
        machine = machine.with_observer(observer);
    }
    let period = Period { machine: &machine, shared: &shared, timing };
    let (command, force, before) = (PERIOD_STATES, PERIOD_STATES + 1, PERIOD_STATES + 2);
    let column = |columns: &[usize]| {
        let along = |k: usize| if columns.contains(&k) { Dual::variable(0.0) } else { Dual::constant(0.0) };
        let drives = Drives {
            command_signal: along(command),
            force: along(force),
            force_before: along(before),
            test_signal: (Dual::constant(0.0), 0),
        };
        let (_, next) = period.next(&core::array::from_fn(along), &drives);
        DVector::from_iterator(PERIOD_STATES, next.into_iter().map(|number| number.slope))
    };
    let states = (0..=command).map(|k| column(&[k]));
    let matrix = DMatrix::from_columns(&states.chain([column(&[force, before])]).collect::<Vec<_>>());
    (matrix, column(&[before]))
}

fn spectral_radius(matrix: &DMatrix<f64>) -> f64 {
    let mut balanced = matrix.clone();
    balance_parlett_reinsch(&mut balanced);
    balanced.complex_eigenvalues().iter().map(|pole| pole.norm()).fold(0.0, f64::max)
}

/// A pilot's force for each period, held through it: a push, a pull, and what shakes.
fn forces(periods: usize) -> Vec<f64> {
    let force = |k: usize| if k.is_multiple_of(7) { 30.0 } else { [150.0, -220.0, 90.0][3 * k / periods] };
    (0..periods).map(force).collect()
}

/// Asserts that the matrices go through the samples of a run.
fn assert_runs(p: &Parameters<f64>, law: Law<'_>, timing: Timing) {
    // Angle, displacement and rate of the feel, load cell, pressure, piston.
    const OUTPUTS: [usize; 6] = [0, 2, 3, 5, 6, 4];
    let count = 400;
    let forces = forces(count);
    let inputs: Vec<Inputs> =
        (0..count * timing.period).map(|step| pushed([forces[step / timing.period]; 2])).collect();
    let values = [p.values()];
    let mut job = Job { law, outputs: &OUTPUTS, ..crate::runs::job(&inputs, &values, Some(timing)) };
    job.shared = shared(&values, law, timing);
    let (_, histories) = run(&job, 1);
    let history: Vec<&[f64]> = histories.chunks(inputs.len() + 1).collect();
    let found = Found::of(&periods(&values, law, timing), 0);
    assert!(spectral_radius(&found.matrix) < 1.0, "stable, so that roundings do not grow");
    let mut x = DVector::zeros(found.states.len());
    let kappa = p.actuator.oil_volume / (4.0 * p.actuator.bulk_modulus * p.actuator.area);
    let mut off = [0.0; OUTPUTS.len()];
    let by_before = whole(p, law, timing).1;
    let by_before = DVector::from_iterator(found.states.len(), found.states.iter().map(|&state| by_before[state]));
    let mut before = 0.0;
    for (k, force) in forces.iter().enumerate() {
        x = &found.matrix * &x + &found.by_force * *force + &by_before * (before - force);
        before = *force;
        let at = (k + 1) * timing.period;
        let [angle, delta, rate, _, pressure, piston] = [0, 1, 2, 3, 4, 5].map(|output| history[output][at]);
        // What was measured is that of the last step's start. The state's pressure is the slaved one, which nobody sees.
        let cell = history[3][at - 1];
        let expected = [
            (BASE, angle * p.column.base_arm),
            (DELTA, delta),
            (DELTA_RATE, rate),
            (MEASURED, cell),
            (PISTON, piston + kappa * pressure),
        ];
        // What the load cell measured counts only where it lags.
        for (off, (state, expected)) in off.iter_mut().zip(expected).filter(|(_, (at, _))| found.place(*at).is_some()) {
            *off = f64::max(*off, (found.state(&x, state) - expected).abs());
        }
    }
    let per_output = [p.column.base_arm, 1.0, 1.0, 1.0, 1.0, 1.0];
    for (k, off) in off.into_iter().enumerate() {
        let size = per_output[k] * history[k].iter().fold(0.0, |most: f64, value| most.max(value.abs()));
        assert!(off <= 1e-9 * size, "{timing:?}: {} is off by {off:e} of {size:e}", BATCH_OUTPUTS[OUTPUTS[k]].0);
    }
}

#[test]
fn matrices_go_through_the_samples_of_a_run_under_gains() {
    for p in [Parameters::elevator(), lagging()] {
        for timing in TIMINGS {
            assert_runs(&p, Law::Gains(&[GAINS]), timing);
            assert_runs(&p, Law::Original, timing);
        }
    }
}

#[test]
fn matrices_go_through_the_samples_of_a_run_under_an_observer() {
    for p in [Parameters::elevator(), lagging()] {
        for timing in TIMINGS {
            assert_runs(&p, Law::Observers(&[estimating(&p, timing)]), timing);
        }
    }
}

#[test]
fn law_that_repeats_the_gains_has_their_poles() {
    let p = lagging();
    for timing in TIMINGS {
        let repeating = Sampled::repeating(&p, DEAF, period_s(timing)).numbers();
        let of = |law| spectral_radius(&Found::of(&periods(&[p.values()], law, timing), 0).matrix);
        let (found, expected) = (of(Law::Observers(&[repeating])), of(Law::Gains(&[DEAF])));
        assert!((found - expected).abs() < 1e-10, "{timing:?}: {found} for {expected}"); // poles of a matrix that is not normal
    }
}

#[test]
fn states_that_are_left_out_have_their_poles_at_zero() {
    let p = lagging();
    for timing in TIMINGS {
        let observer = [estimating(&p, timing)];
        for law in [Law::Gains(&[GAINS]), Law::Original, Law::Observers(&observer)] {
            let (whole, _) = whole(&p, law, timing);
            let found = Found::of(&periods(&[p.values()], law, timing), 0);
            let n = found.states.len();
            assert!(n < PERIOD_STATES);
            let all = whole.columns(0, PERIOD_STATES).into_owned();
            let (radius, expected) = (spectral_radius(&found.matrix), spectral_radius(&all));
            assert!((radius - expected).abs() < 1e-10, "{timing:?}: {radius} for {expected}");
            // det(z - M) = z^(left out) det(z - M_kept)
            for z in [-1.5, -0.8, 0.7, 1.2, 2.0_f64] {
                let det = |m: &DMatrix<f64>| (DMatrix::identity(m.nrows(), m.nrows()) * z - m).determinant();
                let left_out = i32::try_from(PERIOD_STATES - n).expect("a handful");
                let (one, other) = (det(&all), z.powi(left_out) * det(&found.matrix));
                assert!((one - other).abs() <= 1e-9 * one.abs(), "{timing:?} at {z}: {one:e} for {other:e}");
            }
            // What is kept is the whole's, number by number, and that of a machine without vectors.
            let plain = period(&loops(&[p.values()], law, timing), 0);
            for (row, &state) in found.states.iter().enumerate() {
                for (column, &from) in found.states.iter().enumerate() {
                    assert_eq!(found.matrix[(row, column)].to_bits(), whole[(state, from)].to_bits());
                    assert_eq!(found.matrix[(row, column)].to_bits(), plain[state][from].to_bits());
                }
                assert_eq!(found.by_command[row].to_bits(), whole[(state, PERIOD_STATES)].to_bits());
                assert_eq!(found.by_force[row].to_bits(), whole[(state, PERIOD_STATES + 1)].to_bits());
            }
        }
    }
}

#[test]
fn commands_that_are_kept_are_those_under_way() {
    let p = Parameters::elevator();
    for timing in TIMINGS {
        let found = Found::of(&periods(&[p.values()], Law::Gains(&[GAINS]), timing), 0);
        let Timing { period, delay } = timing;
        // Held is what acts until the first command of the period arrives.
        let at_once = delay.is_multiple_of(period);
        assert_eq!(found.place(HELD).is_some(), !at_once, "{timing:?}");
        // Those that arrive in the period, or later: the youngest at least, where the loop is opened.
        let under_way = (delay / period).max(1);
        for age in 0..7 {
            assert_eq!(found.place(YOUNGEST + age).is_some(), age < under_way, "{timing:?}, {age} periods old");
        }
        assert!(found.place(LAST_BASE).is_some(), "the base's rate is a difference");
        assert!((ESTIMATE..PERIOD_STATES).all(|state| found.place(state).is_none()), "no observer runs");
    }
}

#[test]
fn command_signal_is_a_command_like_any_other() {
    let p = lagging();
    for timing in TIMINGS {
        let law = [estimating(&p, timing)];
        let found = Found::of(&periods(&[p.values()], Law::Observers(&law), timing), 0);
        // A period after it set out it is the youngest command, and where nothing has arrived yet, it is nothing else.
        let youngest = found.place(YOUNGEST).expect("the youngest");
        assert_eq!(found.by_command[youngest].to_bits(), 1.0_f64.to_bits());
        let others = found.by_command.iter().enumerate().any(|(k, &by)| k != youngest && by != 0.0);
        assert_eq!(others, timing.delay < timing.period, "{timing:?}");
        // After two periods it is what that command has become: M b_e.
        if timing.delay >= timing.period {
            let later = &found.matrix * &found.by_command;
            assert_eq!(later, found.matrix.column(youngest).into_owned());
        }
    }
}

/// What holds, touches or rounds, as values of the table.
fn with_steps(p: &Parameters<f64>) -> Parameters<f64> {
    let (full, mut p) = (everything(), *p);
    (p.load_cell.resolution, p.load_cell.noise) = (full.load_cell.resolution, full.load_cell.noise);
    (p.potentiometer.resolution, p.potentiometer.noise) = (full.potentiometer.resolution, full.potentiometer.noise);
    (p.column_sensor.resolution, p.column_sensor.noise) = (full.column_sensor.resolution, full.column_sensor.noise);
    (p.controller.input_range, p.controller.input_bits) = (full.controller.input_range, 8.0);
    (p.controller.output_range, p.controller.output_bits) = (full.controller.output_range, 8.0);
    p.controller.antiwindup = full.controller.antiwindup;
    (p.column.coulomb_friction, p.column.static_friction) = (full.column.coulomb_friction, full.column.static_friction);
    (p.column.stop_low, p.column.stop_high) = (full.column.stop_low, full.column.stop_high);
    p.linkage.backlash = full.linkage.backlash;
    (p.amplifier.current_limit, p.valve.flow_limit) = (full.amplifier.current_limit, full.valve.flow_limit);
    p.actuator.relief_pressure = full.actuator.relief_pressure;
    p.feel = forcefeel_model::parameters::Feel {
        inertia: p.feel.inertia,
        damping: p.feel.damping,
        stiffness: p.feel.stiffness,
        ..full.feel
    };
    p
}

#[test]
fn what_holds_touches_or_rounds_leaves_the_matrices_as_they_are() {
    for p in [Parameters::elevator(), lagging()] {
        for timing in [Timing { period: 2, delay: 1 }, Timing { period: 4, delay: 10 }] {
            let observer = [estimating(&p, timing)];
            for law in [Law::Gains(&[GAINS]), Law::Original, Law::Observers(&observer)] {
                let (found, expected) =
                    (periods(&[with_steps(&p).values()], law, timing), periods(&[p.values()], law, timing));
                assert_eq!(found.states, expected.states);
                assert!(found.matrices.iter().all(|value| value.is_finite()));
                assert!(found.matrices == expected.matrices, "{timing:?}: number by number");
            }
        }
    }
}

#[test]
fn many_loops_are_the_loops_one_by_one() {
    let mut loaders = vec![Parameters::elevator(); 21];
    for (k, p) in (0_u8..).zip(&mut loaders) {
        p.linkage.stiffness *= 1.0 + 0.1 * f64::from(k);
    }
    let timing = Timing { period: 2, delay: 1 };
    let values: Vec<_> = loaders.iter().map(Parameters::values).collect();
    let laws: Vec<_> = loaders.iter().map(|p| estimating(p, timing)).collect();
    let law = Law::Observers(&laws);
    let many = loops(&values, law, timing);
    let all = periods_of(&many, 1).expect("threads");
    let bits = |matrices: &[f64]| matrices.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    for threads in [2, 3] {
        assert_eq!(bits(&periods_of(&many, threads).expect("threads").matrices), bits(&all.matrices), "{threads}");
    }
    let size = all.matrices.len() / values.len();
    for (k, one) in values.iter().enumerate() {
        let alone = periods(&[*one], Law::Observers(&laws[k..=k]), timing);
        assert_eq!(alone.states, all.states);
        assert_eq!(bits(&alone.matrices), bits(&all.matrices[k * size..(k + 1) * size]), "loop {k}");
    }
    // One law for all is the first one's for each.
    let shared_law = periods(&values, Law::Observers(&laws[..1]), timing);
    assert_eq!(bits(&shared_law.matrices), bits(&periods(&values, Law::Observers(&[laws[0]; 5]), timing).matrices));
}

#[test]
fn state_that_matters_to_one_loop_is_kept_for_all() {
    // A sensor that lags beside one that does not: what it showed matters to the one loop alone.
    let timing = Timing { period: 2, delay: 1 };
    let (plain, lagging) = (Parameters::elevator(), lagging());
    let both = [plain.values(), lagging.values()];
    let gains = [GAINS; 2];
    let states = |values: &[[f64; COUNT]]| periods(values, Law::Gains(&gains[..values.len()]), timing).states;
    let (one, other, together) = (states(&both[..1]), states(&both[1..]), states(&both));
    assert!(one.len() < other.len(), "{one:?} {other:?}");
    assert_eq!(together, other);
}

#[test]
fn state_that_matters_to_one_loop_among_many_is_kept_for_all() {
    let timing = Timing { period: 2, delay: 1 };
    let (values, middle) = (vec![Parameters::elevator().values(); 40], 20);
    let mut without_rate = GAINS;
    without_rate[5] = 0.0;
    let mut gains = [without_rate; 40];
    gains[middle] = GAINS;
    let all = periods(&values, Law::Gains(&gains), timing);
    let alone = periods(&values[..1], Law::Gains(&gains[middle..=middle]), timing);
    assert!(periods(&values[..1], Law::Gains(&gains[..1]), timing).states.len() < alone.states.len());
    assert_eq!(all.states, alone.states);
    let size = alone.matrices.len();
    assert_eq!(all.matrices[middle * size..][..size], alone.matrices[..]);
}
