//! Recursion (22) on problems whose answer is known in closed form.

mod near;
mod rows;

use forcefeel_solve::riccati::{Problem, Solution, Status, Stop, recursion};
use near::{ROUNDING, assert_near};
use rows::rows;

/// A problem of one state and one input: `x+ = phi x + h u`, cost `q x^2 + r u^2`.
struct Scalar {
    phi: f64,
    h: f64,
    q: f64,
    r: f64,
}

impl Scalar {
    fn run(&self, steps: usize, tolerance: f64) -> Solution {
        let &Self { phi, h, q, r } = self;
        let problem = Problem { phi: rows([[phi]]), h: rows([[h]]), q: rows([[q]]), r: rows([[r]]) };
        recursion(&problem, Stop { steps, tolerance })
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
        let found = scalar.run(10_000, 1e-16);
        assert_eq!(found.status, Status::Converged);
        assert_near(found.cost[(0, 0)], scalar.cost(), 10.0 * ROUNDING); // slow problems add up more roundings
        assert_near(found.gains[(0, 0)], scalar.gain(), 10.0 * ROUNDING);
        assert!(found.change <= 1e-16 && found.steps < 10_000);
    }
}

#[test]
fn cheap_golden_ratio() {
    // phi = h = q = r = 1: E^2 = E + 1.
    let found = Scalar { phi: 1.0, h: 1.0, q: 1.0, r: 1.0 }.run(100, 1e-16);
    let golden = f64::midpoint(1.0, 5.0_f64.sqrt());
    assert_near(found.cost[(0, 0)], golden, ROUNDING);
    assert_near(found.gains[(0, 0)], 1.0 - golden, ROUNDING);
}

#[test]
fn horizon_gives_the_gains_of_the_first_of_its_steps() {
    // phi = h = q = r = 1, E_0 = 1: c_1 = -1/2, E_1 = 3/2; c_2 = -3/5, E_2 = 8/5; c_3 = -8/13, E_3 = 21/13 (Fibonacci).
    for (steps, gain, cost) in [(1, -1.0 / 2.0, 3.0 / 2.0), (2, -3.0 / 5.0, 8.0 / 5.0), (3, -8.0 / 13.0, 21.0 / 13.0)] {
        let found = Scalar { phi: 1.0, h: 1.0, q: 1.0, r: 1.0 }.run(steps, 0.0);
        assert_eq!((found.status, found.steps), (Status::Horizon, steps));
        assert_near(found.gains[(0, 0)], gain, ROUNDING);
        assert_near(found.cost[(0, 0)], cost, ROUNDING);
    }
    let third = Scalar { phi: 1.0, h: 1.0, q: 1.0, r: 1.0 }.run(3, 0.0);
    assert_near(third.change, (8.0 / 13.0 - 3.0 / 5.0) / (8.0 / 13.0), 10.0 * ROUNDING); // a difference of near numbers
}

#[test]
fn no_steps_leave_the_end_cost_and_no_gains() {
    let found = Scalar { phi: 1.0, h: 1.0, q: 7.0, r: 1.0 }.run(0, 0.0);
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
    let found = recursion(&problem, Stop { steps: 1000, tolerance: 1e-16 });
    assert_eq!(found.status, Status::Converged);
    assert_near(found.gains[(0, 0)], scalar.gain(), ROUNDING);
    // The coupling cost p solves p = (phi + h c) (E g + p), a linear equation; its gain is -(r + h^2 E)^-1 h (E g + p).
    let (e, closed) = (scalar.cost(), phi + h * scalar.gain());
    let p = closed * e * g / (1.0 - closed);
    assert_near(found.gains[(0, 1)], -h * (e * g + p) / (r + h * h * e), ROUNDING);
    let half = recursion(&problem, Stop { steps: found.steps / 2, tolerance: 0.0 });
    assert!(found.cost[(1, 1)] > 1.5 * half.cost[(1, 1)], "the cost of a push that never ends has no limit");
}

#[test]
fn inputs_of_separate_problems_do_not_mix() {
    let [a, b, ..] = SCALARS;
    let diagonal = |x: f64, y: f64| rows([[x, 0.0], [0.0, y]]);
    let problem =
        Problem { phi: diagonal(a.phi, b.phi), h: diagonal(a.h, b.h), q: diagonal(a.q, b.q), r: diagonal(a.r, b.r) };
    let found = recursion(&problem, Stop { steps: 1000, tolerance: 1e-16 });
    assert_eq!(found.status, Status::Converged);
    for (k, scalar) in [a, b].iter().enumerate() {
        assert_near(found.gains[(k, k)], scalar.gain(), ROUNDING);
        assert_near(found.cost[(k, k)], scalar.cost(), ROUNDING);
    }
    assert_near(found.gains[(0, 1)].abs() + found.gains[(1, 0)].abs(), 0.0, 0.0);
}

#[test]
fn input_that_costs_nothing_and_does_nothing_is_singular() {
    let found = Scalar { phi: 0.5, h: 0.0, q: 1.0, r: 0.0 }.run(100, 1e-12);
    assert_eq!((found.status, found.steps), (Status::Singular, 0));
}

#[test]
fn numbers_beyond_double_precision_are_singular() {
    // Unstable and out of reach: the cost squares each step until it is infinite, and infinity times zero is no number.
    let found = Scalar { phi: 1e100, h: 0.0, q: 1.0, r: 1.0 }.run(100, 0.0);
    assert_eq!(found.status, Status::Singular);
    let found = Scalar { phi: f64::NAN, h: 1.0, q: 1.0, r: 1.0 }.run(100, 1e-12);
    assert_eq!((found.status, found.steps), (Status::Singular, 0));
}
