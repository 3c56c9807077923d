//! Gain schedule: the cost block `P` of each setting from a dense Kronecker solve that knows no theorem of Cayley.

use crate::rows::rows;
use forcefeel_model::parameters::{Feel, Parameters};
use forcefeel_solve::schedule::{Plant, Time, schedule};
use nalgebra::{DMatrix, DVector, Matrix4, Matrix4x2, RowVector4};

/// What an 8 by 8 solve and an exponential leave of sixteen digits, as a share of the larger gain.
const SOLVE: f64 = 1e-12;
/// Step of the sampled design in s.
const STEP: f64 = 0.02;

/// Undamped, damped, exactly critical (repeated roots), either side of it, overdamped, and very stiff.
const SETTINGS: [[f64; 3]; 9] = [
    [2.0, 0.0, 8.0],
    [2.0, 1.0, 8.0],
    [2.0, 8.0, 8.0],
    [2.0, 8.0 * (1.0 - 1e-9), 8.0],
    [2.0, 8.0 * (1.0 + 1e-9), 8.0],
    // Half the distance of the roots times STEP is 1e-4 at 8.000 025: the exponential leaves its series there.
    [2.0, 8.000_024, 8.0],
    [2.0, 8.000_026, 8.0],
    [2.0, 60.0, 8.0],
    [0.01, 0.3, 4e3],
];

fn feel([inertia, damping, stiffness]: [f64; 3]) -> Feel<f64> {
    Feel { inertia, damping, stiffness, maximum_stiffness: stiffness, ..Parameters::elevator().feel }
}

/// A stable matrix without symmetry, of a continuous plant.
fn closed() -> Matrix4<f64> {
    Matrix4::new(
        -9.0, 2.0, 0.5, -1.0, //
        1.0, -4.0, 3.0, 0.2, //
        0.3, -2.0, -5.0, 1.5, //
        2.0, 0.7, -1.0, -3.0,
    )
}

fn plant(time: Time) -> Plant {
    let closed = match time {
        Time::Continuous => closed(),
        Time::Discrete(h) => (closed() * h).exp(),
    };
    Plant {
        closed,
        coupling: Matrix4x2::new(0.3, -0.1, 0.0, 0.4, -10.0, 0.0, 1.2, 2.0),
        gain_row: RowVector4::new(0.5, -2.0, 1.0, 3.0),
        time,
    }
}

/// Gains by `vec(A X B) = (B' kron A) vec(X)`.
fn by_kronecker(plant: &Plant, [inertia, damping, stiffness]: [f64; 3]) -> [f64; 2] {
    let w = rows([[0.0, 1.0], [-stiffness / inertia, -damping / inertia]]);
    let mt = DMatrix::from_column_slice(4, 4, plant.closed.transpose().as_slice());
    let q = DVector::from_column_slice(plant.coupling.as_slice());
    let (system, right, after) = match plant.time {
        // M' P + P W = -Q
        Time::Continuous => {
            let system = DMatrix::identity(2, 2).kronecker(&mt) + w.transpose().kronecker(&DMatrix::identity(4, 4));
            (system, -q, DMatrix::identity(2, 2))
        }
        // P - M' P Phi = Q
        Time::Discrete(h) => {
            let phi = (w * h).exp();
            (DMatrix::identity(8, 8) - phi.transpose().kronecker(&mt), q, phi)
        }
    };
    let solution = system.lu().solve(&right).expect("a regular system");
    let p = DMatrix::from_column_slice(4, 2, solution.as_slice());
    let k = DMatrix::from_row_slice(1, 4, plant.gain_row.as_slice());
    let gains = -k * p * after;
    [gains[0], gains[1]]
}

fn check(time: Time) {
    let plant = plant(time);
    let found = schedule(&plant, &SETTINGS.map(feel));
    assert_eq!(found.len(), SETTINGS.len());
    for (gains, setting) in found.iter().zip(SETTINGS) {
        let expected = by_kronecker(&plant, setting);
        let scale = expected[0].abs().max(expected[1].abs());
        for (gain, expected) in gains.iter().zip(expected) {
            assert!((gain - expected).abs() <= SOLVE * scale, "{setting:?}: expected {expected:e}, got {gain:e}");
        }
    }
}

#[test]
fn continuous_gains_solve_the_linear_equation() {
    check(Time::Continuous);
}

#[test]
fn sampled_gains_solve_the_linear_equation() {
    check(Time::Discrete(STEP));
}

#[test]
fn small_step_leads_to_the_continuous_gains() {
    // A sampled design whose plant, weight and gain row are sampled too tends to the continuous one, in first order.
    let continuous = schedule(&plant(Time::Continuous), &[feel([2.0, 1.0, 8.0])])[0];
    let error = |h: f64| {
        let mut sampled = plant(Time::Discrete(h));
        sampled.coupling *= h;
        (schedule(&sampled, &[feel([2.0, 1.0, 8.0])])[0][0] - continuous[0]).abs()
    };
    let slope = (error(2e-4) / error(1e-4)).log2();
    assert!((slope - 1.0).abs() < 0.01, "order {slope}"); // the term in h^2 is a few 1e-4 of that in h
}

#[test]
fn settings_without_an_answer_are_marked_and_leave_the_others_alone() {
    // M has the root 1 and the overdamped feel the root -1: they add up to zero, so P has no equation.
    let mut plant = plant(Time::Continuous);
    plant.closed = Matrix4::from_diagonal(&nalgebra::Vector4::new(1.0, -1.0, -2.0, -3.0));
    let good = [2.0, 1.0, 8.0];
    let found = schedule(&plant, &[good, [1.0, 3.0, 2.0], good].map(feel));
    assert!(found[1].iter().all(|gain| gain.is_nan()));
    assert!(found[0].iter().all(|gain| gain.is_finite()) && found[0].map(f64::to_bits) == found[2].map(f64::to_bits));
}

#[test]
fn no_settings_give_no_gains() {
    assert!(schedule(&plant(Time::Continuous), &[]).is_empty());
}
