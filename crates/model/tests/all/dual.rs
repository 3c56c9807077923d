//! Arithmetic of dual numbers against the rules of differentiation, written out as closed forms.

use crate::near::{ROUNDING, assert_near};
use forcefeel_model::Scalar;
use forcefeel_model::dual::{Along, Dual};

/// `t` where the functions below are looked at.
const POINTS: [f64; 4] = [-2.3, -0.4, 0.7, 5.9];

fn check(found: Dual, value: f64, slope: f64) {
    assert_near(found.value, value, ROUNDING);
    assert_near(found.slope, slope, ROUNDING);
}

/// `a = t^2 + 1` and `b = 3 - 2 t` as duals along `t`, with their values and slopes.
fn operands(t: f64) -> (Dual, Dual, [f64; 4]) {
    let [a, da, b, db] = [t * t + 1.0, 2.0 * t, 3.0 - 2.0 * t, -2.0];
    (Dual { value: a, slope: da }, Dual { value: b, slope: db }, [a, da, b, db])
}

#[test]
fn each_operation_follows_its_rule() {
    for t in POINTS {
        let (x, y, [a, da, b, db]) = operands(t);
        check(x + y, a + b, da + db);
        check(x - y, a - b, da - db);
        check(x * y, a * b, da * b + a * db);
        check(x / y, a / b, (da * b - a * db) / (b * b));
        check(-x, -a, -da);
        check(x.sqrt(), a.sqrt(), da / (2.0 * a.sqrt()));
    }
}

#[test]
fn constants_stay_constants_beside_infinite_ones() {
    let [infinite, zero, two] = [f64::INFINITY, 0.0, 2.0].map(Dual::constant);
    for found in [infinite * two, two / infinite, infinite / two, two * zero] {
        assert!(found.slope == 0.0, "{found:?}");
    }
}

#[test]
fn polynomial_has_the_slope_of_its_closed_form() {
    let [two, three] = [2.0, 3.0].map(Dual::constant);
    for t in POINTS {
        let x = Dual::variable(t);
        // 2 t^3 - 3 t + t = 2 t^3 - 2 t, slope 6 t^2 - 2
        check(two * x * x * x - three * x + x, 2.0 * t * t * t - 2.0 * t, 6.0 * t * t - 2.0);
    }
}

#[test]
fn chain_of_operations_has_the_slope_of_its_closed_form() {
    let [one, three] = [1.0, 3.0].map(Dual::constant);
    for t in POINTS {
        let x = Dual::variable(t);
        let root = (1.0 + t * t).sqrt();
        // f = sqrt(1 + t^2) / (t - 3), f' = (t / r (t - 3) - r) / (t - 3)^2
        let slope = (t / root * (t - 3.0) - root) / ((t - 3.0) * (t - 3.0));
        check((one + x * x).sqrt() / (x - three), root / (t - 3.0), slope);
    }
}

#[test]
fn constants_have_no_slope() {
    let c = Dual::constant(4.0);
    check(c, 4.0, 0.0);
    check(c.sqrt() * c - c / c, 7.0, 0.0);
}

#[test]
fn dual_numbers_of_dual_numbers_have_the_slope_of_the_slope() {
    let number = |value: f64| Dual::constant(Dual::constant(value));
    for t in POINTS {
        // Along t twice: value t, slopes 1, no slope of the slope.
        let x = Dual { value: Dual::variable(t), slope: Dual::constant(1.0) };
        // f = t^3, f'' = 6 t
        let cube = x * x * x;
        check(cube.value, t * t * t, 3.0 * t * t);
        check(cube.slope, 3.0 * t * t, 6.0 * t);
        // f = 1 / (t - 9), f'' = 2 / (t - 9)^3
        let quotient = number(1.0) / (x - number(9.0));
        check(quotient.slope, -(t - 9.0).powi(-2), 2.0 * (t - 9.0).powi(-3));
        // f = sqrt(1 + t^2), f'' = (1 + t^2)^(-3/2)
        let root = (number(1.0) + x * x).sqrt();
        check(root.slope, t / (1.0 + t * t).sqrt(), (1.0 + t * t).powf(-1.5));
        // f = -|t| t, f'' = -2 sign t
        check((-x.abs() * x).slope, -2.0 * t.abs(), -2.0 * t.signum());
    }
}

#[test]
fn slopes_of_two_parameters_meet_in_the_slope_of_the_slope() {
    let (a, b) = (3.0, 0.7);
    let x = Dual { value: Dual::constant(a), slope: Dual::constant(1.0) };
    let y = Dual { value: Dual::variable(b), slope: Dual::constant(0.0) };
    // f = a / b + a b^2: f_ab = -1 / b^2 + 2 b
    check((x / y + x * y * y).slope, 1.0 / b + b * b, -1.0 / (b * b) + 2.0 * b);
    // A limit that is off does not depend on anything, and what is zero now may have a slope.
    let off = Dual::constant(Dual::constant(f64::INFINITY));
    let gain = y - Dual::constant(Dual::constant(b));
    check((x * gain).slope, 0.0, 1.0);
    check((x / off).slope, 0.0, 0.0);
    check(x.within(off).slope, 1.0, 0.0);
    check((off * y).slope, 0.0, 0.0);
}

#[test]
fn magnitude_and_sign_agree_on_zeros() {
    for zero in [0.0, -0.0] {
        let x = Dual::variable(zero);
        assert!(x.abs().times_sign(x) == x, "{x:?}");
    }
}

#[test]
fn root_moves_as_its_residual_does() {
    let p = Dual::variable(7.0);
    // x^2 = p at x = sqrt(p): x' = 1 / (2 x)
    let residual = |x: Dual| x * x - p;
    let x = Dual { value: 7.0_f64.sqrt(), slope: 1e9 };
    let still = residual(x.still());
    let root = x.still().root(still, residual(x.moving()) - still);
    check(root, 7.0_f64.sqrt(), 0.5 / 7.0_f64.sqrt());
    // A residual of very different scales: 1e-12 x = 4e6 (p - 7), x' = 4e18; with a slope of one for x its share would be lost.
    let steep = |x: Dual| x * Dual::constant(1e-12) - (p - Dual::constant(7.0)) * Dual::constant(4e6);
    let x = Dual::variable(0.0);
    let still = steep(x.still());
    check(x.still().root(still, steep(x.moving()) - still), 0.0, 4e18);
    assert!(Scalar::root(2.0_f64, 1.0, 5.0).to_bits() == 2.0_f64.to_bits());
}

/// Each operation of two numbers and a third that is zero beside infinite ones.
fn operations<S: Scalar>(x: S, y: S, off: S) -> Vec<S> {
    let infinite = x.constant(f64::INFINITY);
    let root = x.root(x * x - y, x.still() - x.moving());
    let chosen = [S::select(x.less(y), x, y), S::select(y.less(x), x, y), x.min(y), x.max(y)];
    let mut found =
        vec![x + y, x - y, x * y, x / y, -x, (x * x).sqrt(), off.sqrt(), y.abs(), x.round(), x.times_sign(y)];
    found.extend([
        off * infinite,
        off / infinite,
        x.slope_times(y),
        x.slope_over(y),
        x.sin(),
        x.still(),
        x.moving(),
        root,
    ]);
    found.extend(chosen);
    found
}

#[test]
fn slopes_along_several_directions_are_those_along_each() {
    let of_x = [1.0, 0.0, -2.5];
    let of_y = [0.0, 3.0, 0.7];
    for t in POINTS {
        let together = operations(
            Dual { value: t, slope: Along(of_x) },
            Dual { value: 3.0 - 2.0 * t, slope: Along(of_y) },
            Dual::along(0.0, |_| false),
        );
        for k in 0..3 {
            let alone = operations(
                Dual { value: t, slope: of_x[k] },
                Dual { value: 3.0 - 2.0 * t, slope: of_y[k] },
                Dual::constant(0.0),
            );
            for (many, one) in together.iter().zip(alone) {
                assert_eq!(
                    (many.value.to_bits(), many.slope.0[k].to_bits()),
                    (one.value.to_bits(), one.slope.to_bits())
                );
            }
        }
    }
}
