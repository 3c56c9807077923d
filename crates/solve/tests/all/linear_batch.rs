//! Linear runs against steps with nalgebra's matrix exponential, lane by lane.

use crate::loops::loops;
use forcefeel_model::Scalar;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::dual::Dual;
use forcefeel_model::loader::Compliant;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_solve::law::Law;
use forcefeel_solve::linear_batch::LinearJob;
use forcefeel_solve::loops::Loops;
use forcefeel_solve::start::Start;
use forcefeel_solve::{StateSpace, linearize};
use nalgebra::{DMatrix, DVector};

const STEP: f64 = 1e-3;
/// What the unbalanced exponential of the reference leaves of sixteen digits, as a share of the largest value.
const REFERENCE: f64 = 1e-8;
/// Outputs of a run that are outputs of the linear model: angle, programmed displacement, load cell, flow, current.
const OUTPUTS: [usize; 5] = [0, 2, 5, 7, 8];
const MODEL_OUTPUTS: [usize; 5] = [0, 1, 3, 6, 5];

struct Draw {
    common: [f64; COUNT],
    columns: Vec<usize>,
    varied: Vec<f64>,
}

impl Draw {
    fn new(count: usize) -> Self {
        let (common, columns, varied) = loops(7, count, 1.15);
        Self { common, columns, varied }
    }
    fn loops(&self) -> Loops<'_> {
        let Self { common, columns, varied } = self;
        Loops { common, columns, varied, count: varied.len() / columns.len(), law: Law::Original }
    }
    fn model(&self, run: usize) -> StateSpace {
        let mut values = self.common;
        for (k, &column) in self.columns.iter().enumerate() {
            values[column] = self.varied[run * self.columns.len() + k];
        }
        let parameters = Parameters::from_values(&values).map(|value| Dual::constant(1.0).constant(value));
        linearize(&Compliant { parameters, compensator: Compensator::original(&parameters) }, &[0.0; 8], &[0.0; 2])
    }
}

/// The outputs of the model, sample by sample, by the exponential of the matrix with force and slope among the states.
fn reference(model: &StateSpace, force: &[[f64; 2]], start: Start, every: usize) -> Vec<Vec<f64>> {
    let mut whole = DMatrix::zeros(10, 10);
    whole.view_mut((0, 0), (8, 8)).copy_from(&(&model.a * STEP));
    whole.view_mut((0, 8), (8, 1)).copy_from(&(model.b.column(0) * STEP));
    whole[(8, 9)] = 1.0;
    let transition = whole.exp();
    let per_force = -model.a.clone().lu().solve(&model.b.column(0)).expect("a regular matrix");
    let (mut x, hand, until) = match start {
        Start::Under(force) => (&per_force * force, 0.0, 0),
        Start::Held(angle, until) => {
            let hand = angle / (model.c.row(0) * &per_force)[0];
            (&per_force * hand, hand, until)
        }
    };
    let mut found = Vec::new();
    for (k, &[now, then]) in force.iter().enumerate() {
        let held = if k < until { hand } else { 0.0 };
        if k % every == 0 {
            found.push((&model.c * &x + model.d.column(0) * (now + held)).as_slice().to_vec());
        }
        let mut all = DVector::zeros(10);
        all.rows_mut(0, 8).copy_from(&x);
        (all[8], all[9]) = (now + held, then - now);
        x = (&transition * all).rows(0, 8).into_owned();
    }
    let last = force[force.len() - 1][1];
    found.push((&model.c * &x + model.d.column(0) * last).as_slice().to_vec());
    found
}

fn step() -> Vec<[f64; 2]> {
    (0..240).map(|k| if k < 21 { [0.0; 2] } else { [400.0; 2] }).collect()
}

fn ramps_and_jumps() -> Vec<[f64; 2]> {
    let level = |k: i32| f64::from(k % 37) * 5.0;
    (0..240).map(|k| if (60..160).contains(&k) { [30.0; 2] } else { [level(k), level(k) + 3.0] }).collect()
}

fn run(loops: Loops<'_>, force: &[[f64; 2]], start: Start, every: usize, threads: usize) -> Vec<f64> {
    let job = LinearJob { loops, force_scale: None, force, step_s: STEP, start, every, outputs: &OUTPUTS };
    let mut histories = vec![f64::NAN; loops.count * OUTPUTS.len() * job.samples()];
    job.run(threads, &mut histories).expect("threads");
    histories
}

#[test]
fn runs_are_those_of_the_matrix_exponential() {
    let draw = Draw::new(11);
    for force in [step(), ramps_and_jumps()] {
        for start in [Start::Under(0.0), Start::Under(120.0), Start::Held(0.1, 50)] {
            for every in [1, 4] {
                let found = run(draw.loops(), &force, start, every, 2);
                let samples = force.len() / every + 1;
                for (k, found) in found.chunks(OUTPUTS.len() * samples).enumerate() {
                    let expected = reference(&draw.model(k), &force, start, every);
                    for (output, found) in MODEL_OUTPUTS.iter().zip(found.chunks(samples)) {
                        let scale = expected.iter().map(|row| row[*output].abs()).fold(0.0, f64::max);
                        for (found, row) in found.iter().zip(&expected) {
                            let off = (found - row[*output]).abs();
                            assert!(off <= REFERENCE * scale, "run {k}, output {output}: off by {off:e} of {scale:e}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn bits_depend_neither_on_threads_nor_on_the_neighbors() {
    let draw = Draw::new(19);
    let all = draw.loops();
    for start in [Start::Under(0.0), Start::Held(0.1, 50)] {
        for force in [step(), ramps_and_jumps()] {
            let together = run(all, &force, start, 1, 1);
            assert_eq!(together, run(all, &force, start, 1, 3));
            let size = together.len() / 19;
            for k in [0, 5, 18] {
                let width = all.columns.len();
                let alone = Loops { varied: &all.varied[k * width..(k + 1) * width], count: 1, ..all };
                assert_eq!(run(alone, &force, start, 1, 1), together[k * size..(k + 1) * size]);
            }
        }
    }
}

#[test]
fn force_scales_the_run() {
    let draw = Draw::new(9);
    let force = step();
    let scale: Vec<f64> = (0..9).map(|k| 0.5 + f64::from(k)).collect();
    let plain = run(draw.loops(), &force, Start::Under(0.0), 1, 1);
    let job = LinearJob {
        loops: draw.loops(),
        force_scale: Some(&scale),
        force: &force,
        step_s: STEP,
        start: Start::Under(0.0),
        every: 1,
        outputs: &OUTPUTS,
    };
    let mut scaled = vec![0.0; plain.len()];
    job.run(1, &mut scaled).expect("threads");
    let size = plain.len() / 9;
    let largest = plain.iter().map(|value| value.abs()).fold(0.0, f64::max);
    for (k, (scaled, plain)) in scaled.iter().zip(&plain).enumerate() {
        assert!((scaled - plain * scale[k / size]).abs() <= 1e-12 * largest * scale[k / size]);
    }
}
