//! Recursion (22) on problems whose answer is known in closed form.

use crate::near::{ROUNDING, assert_near};
use crate::rows::rows;
use forcefeel_solve::riccati::{Problem, Solution, Status, Stop, recursion};
use nalgebra::DMatrix;

/// A problem of one state and one input: `x+ = phi x + h u`, cost `q x^2 + r u^2`.
struct Scalar {
    phi: f64,
    h: f64,
    q: f64,
    r: f64,
}

impl Scalar {
    fn run(&self, stop: Stop) -> Solution {
        let &Self { phi, h, q, r } = self;
        let problem = Problem { phi: rows([[phi]]), h: rows([[h]]), q: rows([[q]]), r: rows([[r]]) };
        recursion(&problem, stop)
    }

    /// Positive root of `h^2 E^2 + (r - phi^2 r - h^2 q) E - q r = 0`, which is the Riccati equation times `r + h^2 E`.
    fn cost(&self) -> f64 {
        let &Self { phi, h, q, r } = self;
        let b = r - phi * phi * r - h * h * q;
        (-b + (b * b + 4.0 * h * h * q * r).sqrt()) / (2.0 * h * h)
    }

    fn gain(&self) -> f64 {
        let &Self { phi, h, r, .. } = self;
        let e = self.cost();
        -h * e * phi / (r + h * h * e)
    }
}

/// Until the gains stand still to the last bit, or nearly.
const STAND_STILL: Stop = Stop::StandStill { tolerance: 1e-16, most_steps: 10_000 };

/// Stable, unstable, cheap and dear input.
const SCALARS: [Scalar; 4] = [
    Scalar { phi: 0.9, h: 0.5, q: 2.0, r: 0.3 },
    Scalar { phi: 3.0, h: -1.0, q: 1.0, r: 1.0 },
    Scalar { phi: 1.0, h: 1.0, q: 4.0, r: 1e-6 },
    Scalar { phi: 1.2, h: 0.1, q: 0.5, r: 50.0 },
];

#[test]
fn scalar_problem_converges_to_the_root_of_its_riccati_equation() {
    for scalar in SCALARS {
        let found = scalar.run(STAND_STILL);
        assert_eq!(found.status, Status::Converged);
        assert_near(found.cost[(0, 0)], scalar.cost(), 10.0 * ROUNDING); // slow problems add up more roundings
        assert_near(found.gains[(0, 0)], scalar.gain(), 10.0 * ROUNDING);
        assert!(found.change <= 1e-16 && found.steps < 10_000);
    }
}

#[test]
fn cheap_golden_ratio() {
    // phi = h = q = r = 1: E^2 = E + 1.
    let found = Scalar { phi: 1.0, h: 1.0, q: 1.0, r: 1.0 }.run(STAND_STILL);
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    assert_near(found.cost[(0, 0)], golden, ROUNDING);
    assert_near(found.gains[(0, 0)], 1.0 - golden, ROUNDING);
}

#[test]
fn horizon_gives_the_gains_of_the_first_of_its_steps() {
    // phi = h = q = r = 1, E_0 = 1: c_1 = -1/2, E_1 = 3/2; c_2 = -3/5, E_2 = 8/5; c_3 = -8/13, E_3 = 21/13 (Fibonacci).
    for (steps, gain, cost) in [(1, -1.0 / 2.0, 3.0 / 2.0), (2, -3.0 / 5.0, 8.0 / 5.0), (3, -8.0 / 13.0, 21.0 / 13.0)] {
        let found = Scalar { phi: 1.0, h: 1.0, q: 1.0, r: 1.0 }.run(Stop::Horizon(steps));
        assert_eq!((found.status, found.steps), (Status::Horizon, steps));
        assert_near(found.gains[(0, 0)], gain, ROUNDING);
        assert_near(found.cost[(0, 0)], cost, ROUNDING);
    }
}

#[test]
fn no_steps_leave_the_end_cost_and_no_gains() {
    let found = Scalar { phi: 1.0, h: 1.0, q: 7.0, r: 1.0 }.run(Stop::Horizon(0));
    assert_eq!((found.status, found.steps), (Status::Horizon, 0));
    assert_eq!((found.cost, found.gains), (rows([[7.0]]), rows([[0.0]])));
}

#[test]
fn constant_state_gets_a_finite_gain_though_its_cost_grows() {
    // x+ = phi x + h u + g f, f+ = f: no input moves f.
    let scalar = Scalar { phi: 1.1, h: 0.4, q: 2.0, r: 0.7 };
    let (Scalar { phi, h, q, r }, g) = (&scalar, 0.9);
    let problem = Problem {
        phi: rows([[*phi, g], [0.0, 1.0]]),
        h: rows([[*h], [0.0]]),
        q: rows([[*q, 0.0], [0.0, 0.0]]),
        r: rows([[*r]]),
    };
    let found = recursion(&problem, STAND_STILL);
    assert_eq!(found.status, Status::Converged);
    assert_near(found.gains[(0, 0)], scalar.gain(), ROUNDING);
    // The coupling cost p solves p = (phi + h c) (E g + p), a linear equation; its gain is -(r + h^2 E)^-1 h (E g + p).
    let (e, closed) = (scalar.cost(), phi + h * scalar.gain());
    let p = closed * e * g / (1.0 - closed);
    assert_near(found.gains[(0, 1)], -h * (e * g + p) / (r + h * h * e), ROUNDING);
    let half = recursion(&problem, Stop::Horizon(found.steps / 2));
    assert!(found.cost[(1, 1)] > 1.5 * half.cost[(1, 1)], "the cost of a push that never ends has no limit");
}

#[test]
fn inputs_of_separate_problems_do_not_mix() {
    let [a, b, ..] = SCALARS;
    let diagonal = |x: f64, y: f64| rows([[x, 0.0], [0.0, y]]);
    let problem =
        Problem { phi: diagonal(a.phi, b.phi), h: diagonal(a.h, b.h), q: diagonal(a.q, b.q), r: diagonal(a.r, b.r) };
    let found = recursion(&problem, STAND_STILL);
    assert_eq!(found.status, Status::Converged);
    for (k, scalar) in [a, b].iter().enumerate() {
        assert_near(found.gains[(k, k)], scalar.gain(), ROUNDING);
        assert_near(found.cost[(k, k)], scalar.cost(), ROUNDING);
    }
    assert_near(found.gains[(0, 1)].abs() + found.gains[(1, 0)].abs(), 0.0, 0.0);
}

#[test]
fn input_that_costs_nothing_and_does_nothing_is_singular() {
    let found = Scalar { phi: 0.5, h: 0.0, q: 1.0, r: 0.0 }.run(STAND_STILL);
    assert_eq!((found.status, found.steps), (Status::Singular, 0));
}

#[test]
fn numbers_beyond_double_precision_are_singular() {
    // Unstable and out of reach: the cost squares each step until it is infinite, and infinity times zero is no number.
    let found = Scalar { phi: 1e100, h: 0.0, q: 1.0, r: 1.0 }.run(Stop::Horizon(100));
    assert_eq!(found.status, Status::Singular);
    let found = Scalar { phi: f64::NAN, h: 1.0, q: 1.0, r: 1.0 }.run(STAND_STILL);
    assert_eq!((found.status, found.steps), (Status::Singular, 0));
}

#[test]
fn steps_that_run_out_leave_the_gains_moving() {
    // The gains approach their limit by a tenth of a per cent a step.
    let slow = Scalar { phi: 1.0, h: 1e-3, q: 1.0, r: 4.0 };
    let found = slow.run(Stop::StandStill { tolerance: 1e-12, most_steps: 100 });
    assert_eq!((found.status, found.steps), (Status::Moving, 100));
    assert!(found.change > 1e-3);
}

#[test]
fn change_is_that_over_the_second_half_of_the_steps() {
    // Looked at after 1, 2 and 4 steps: -1/2, -3/5, -21/34 (Fibonacci), so (21/34 - 3/5) / (21/34) = 1/35.
    let found = Scalar { phi: 1.0, h: 1.0, q: 1.0, r: 1.0 }.run(Stop::StandStill { tolerance: 0.0, most_steps: 4 });
    assert_near(found.gains[(0, 0)], -21.0 / 34.0, ROUNDING);
    assert_near(found.change, 1.0 / 35.0, 10.0 * ROUNDING); // a difference of near numbers
}

/// One state is brought to rest in a step, so its gain stands still at once; beside it a chain of delays with a weight
/// at its end, which the other input feels only after as many steps.
fn late_weight() -> Problem {
    let (n, mut phi, mut h) = (6, DMatrix::zeros(6, 6), DMatrix::zeros(6, 2));
    (phi[(0, 0)], phi[(n - 1, n - 1)], h[(0, 0)], h[(1, 1)]) = (1.0, 1.0, 1.0, 1.0);
    for k in 2..n {
        phi[(k, k - 1)] = 1.0;
    }
    let mut q = DMatrix::zeros(n, n);
    (q[(0, 0)], q[(n - 1, n - 1)]) = (1.0, 1.0);
    Problem { phi, h, q, r: rows([[0.0, 0.0], [0.0, 1.0]]) }
}

#[test]
fn weight_that_comes_late_is_waited_for() {
    let found = recursion(&late_weight(), STAND_STILL);
    assert_eq!(found.status, Status::Converged);
    // The chain ends in a sum of what was put in, weighted one against one: the golden ratio on every state of it.
    for k in 1..6 {
        assert_near(found.gains[(1, k)], f64::midpoint(1.0, -(5.0_f64.sqrt())), ROUNDING);
    }
}

#[test]
fn horizon_runs_all_its_steps_though_no_gain_moves() {
    let found = recursion(&late_weight(), Stop::Horizon(50));
    assert_eq!((found.status, found.steps), (Status::Horizon, 50));
}

#[test]
fn gains_that_are_zero_stand_still() {
    // What the input reaches is forgotten by itself.
    let found = Scalar { phi: 0.0, h: 1.0, q: 1.0, r: 1.0 }.run(STAND_STILL);
    assert_eq!(found.status, Status::Converged);
    assert_eq!(found.gains, rows([[0.0]]));
}

#[test]
fn swinging_gains_do_not_pass_for_standing_still_at_a_turning_point() {
    // A slow plant that is weighed against a swinging reference: the gains on the reference swing as they settle.
    let (decay, angle) = (0.999, 0.05_f64);
    let (sin, cos) = angle.sin_cos();
    let problem = Problem {
        phi: rows([[decay, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]]),
        h: rows([[1e-3], [0.0], [0.0]]),
        q: rows([[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]]),
        r: rows([[1.0]]),
    };
    let tolerance = 1e-6;
    let found = recursion(&problem, Stop::StandStill { tolerance, most_steps: 1_000_000 });
    let exact = recursion(&problem, Stop::Horizon(200_000));
    assert_eq!(found.status, Status::Converged);
    let error = (&found.gains - &exact.gains).amax() / exact.gains.amax();
    assert!(error <= tolerance, "stopped {error:e} away");
}
