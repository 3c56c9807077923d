//! Arithmetic of dual numbers against the rules of differentiation, written out as closed forms.

mod near;

use forcefeel_model::Scalar;
use forcefeel_model::dual::Dual;
use near::{ROUNDING, assert_near};

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
