//! Verdicts on matrices whose eigenvalues are known without rounding, and on loops against computed eigenvalues.
#![expect(clippy::needless_range_loop, reason = "indices as in the equations")]

use crate::draws::Draws;
use crate::loops::loops;
use forcefeel_model::Scalar;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::dual::Dual;
use forcefeel_model::loader::Compliant;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_solve::bounded::Bounded;
use forcefeel_solve::law::Law;
use forcefeel_solve::linearize;
use forcefeel_solve::loops::{Loops, Matrix, state_matrix};
use forcefeel_solve::poles::poles;
use forcefeel_solve::stability::{Verdict, verdict};
use nalgebra::SMatrix;

/// Distance from the axis, as a share of the matrix's size, from which computed eigenvalues of a random matrix are to be trusted.
const TRUSTED: f64 = 1e-9;
/// Real parts of the exact matrices are multiples of this; their entries stay exact in double precision.
const GRAIN: f64 = 1.0 / 1024.0;

/// A matrix of eigenvalues known without rounding: blocks of one or two, chained or not, seen through whole-number shears and
/// scales that are powers of two. Returns it with its largest real part.
fn exact(draws: &mut Draws, nearest: f64) -> (Matrix<f64>, f64) {
    let mut a = [[0.0; 8]; 8];
    let mut largest = f64::NEG_INFINITY;
    let mut k = 0;
    while k < 8 {
        let re = if k == 0 { nearest } else { -GRAIN * up_to(draws, 2, 16) };
        largest = largest.max(re);
        let size = if k == 7 { 1 } else { usize::try_from(draws.whole(1, 2)).expect("one or two") };
        for i in k..k + size {
            a[i][i] = re;
        }
        if size == 2 {
            let im = up_to(draws, 0, 8);
            (a[k][k + 1], a[k + 1][k]) = (im, -im);
        }
        // A chain: with equal eigenvalues the matrix is defective.
        if k + size < 8 && draws.whole(0, 1) == 1 {
            a[k + size - 1][k + size] = 1.0;
        }
        k += size;
    }
    for _ in 0..8 {
        let (i, j, m) = (draws.whole(0, 7), draws.whole(1, 7), f64::from(draws.whole(-1, 1)));
        let i = usize::try_from(i).expect("an index");
        shear(&mut a, i, (i + usize::try_from(j).expect("an index")) % 8, m);
    }
    for i in 0..8 {
        let scale = 2f64.powi(draws.whole(-20, 20));
        for j in 0..8 {
            a[i][j] *= scale;
            a[j][i] /= scale;
        }
    }
    (a, largest)
}

/// A whole number of up to `2^low` to `2^high`.
fn up_to(draws: &mut Draws, low: i32, high: i32) -> f64 {
    let most = 1 << draws.whole(low, high);
    f64::from(draws.whole(1, most))
}

/// `(1 + m e_i e_j') A (1 - m e_i e_j')`.
fn shear(a: &mut Matrix<f64>, i: usize, j: usize, m: f64) {
    for k in 0..8 {
        a[i][k] += m * a[j][k];
    }
    for row in a {
        row[j] -= m * row[i];
    }
}

/// The companion matrix of `s^8 + c_7 s^7 + ... + c_0` with coefficients from `c_0` on.
fn companion(coefficients: &[f64; 8]) -> Matrix<f64> {
    let mut a = [[0.0; 8]; 8];
    for i in 0..8 {
        if i < 7 {
            a[i][i + 1] = 1.0;
        }
        a[7][i] = -coefficients[i];
    }
    a
}

/// Coefficients of the product of polynomials given without their leading one, from the constant on.
fn expanded(factors: &[&[f64]]) -> [f64; 8] {
    let mut product = vec![1.0];
    for factor in factors {
        let mut next = vec![0.0; product.len() + factor.len()];
        for (i, &p) in product.iter().enumerate() {
            for (j, &f) in factor.iter().chain([&1.0]).enumerate() {
                next[i + j] += p * f;
            }
        }
        product = next;
    }
    product[..8].try_into().expect("degree eight")
}

#[test]
fn eigenvalues_known_without_rounding_are_judged_right_and_proved() {
    let mut draws = Draws::new(1);
    let mut unproved = 0;
    for k in 0..4000 {
        let nearest = GRAIN * up_to(&mut draws, 0, 16);
        let stable = k % 2 == 0;
        let (a, largest) = exact(&mut draws, if stable { -nearest } else { nearest });
        assert_eq!(largest < 0.0, stable);
        let expected = if stable { Verdict::Stable } else { Verdict::Unstable };
        let found = verdict(&a);
        // Equal eigenvalues in separate chains end every elimination early; of such a matrix nothing need be proved.
        if matches!(found, Verdict::StableByPoles | Verdict::UnstableByPoles) {
            unproved += 1;
        } else {
            assert_eq!(found, expected, "real part {largest} of {a:?}");
        }
    }
    assert!(unproved < 400, "{unproved} of 4000 not proved");
}

#[test]
fn an_eigenvalue_on_the_axis_is_never_proved_stable() {
    let mut draws = Draws::new(2);
    for _ in 0..1000 {
        let (a, largest) = exact(&mut draws, 0.0);
        assert!(largest == 0.0 && verdict(&a) != Verdict::Stable, "{a:?}");
    }
}

#[test]
fn defective_companions_are_judged_where_computed_eigenvalues_are_off() {
    let ones: &[f64] = &[1.0];
    let eightfold = companion(&expanded(&[ones; 8]));
    assert_eq!(verdict(&eightfold), Verdict::Stable);
    // Eight poles at one place come out of double precision a hundredth apart from it: so near the axis they say nothing.
    let near: &[f64] = &[1.0 / 1024.0];
    assert_eq!(verdict(&companion(&expanded(&[near; 8]))), Verdict::Stable);
    let beyond: &[f64] = &[-1.0 / 1024.0];
    assert_eq!(verdict(&companion(&expanded(&[beyond; 8]))), Verdict::Unstable);
    for damping in [-1.0, 1.0].map(|sign| sign * 2f64.powi(-20)) {
        let swing: &[f64] = &[1.0, damping];
        let a = companion(&expanded(&[swing, ones, ones, ones, ones, ones, ones]));
        assert_eq!(verdict(&a), if damping > 0.0 { Verdict::Stable } else { Verdict::Unstable });
    }
}

#[test]
fn random_matrices_agree_with_computed_eigenvalues() {
    let mut draws = Draws::new(3);
    let mut seen = [0; 2];
    for _ in 0..4000 {
        let shift = f64::from(draws.whole(0, 3));
        let a: Matrix<f64> = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                draws.uniform() * 10f64.powi(draws.whole(0, 3)) - if i == j { shift * 1e3 } else { 0.0 }
            })
        });
        let matrix = SMatrix::<f64, 8, 8>::from_fn(|i, j| a[i][j]);
        let largest = matrix.complex_eigenvalues().iter().map(|value| value.re).fold(f64::NEG_INFINITY, f64::max);
        if largest.abs() < TRUSTED * matrix.norm() {
            continue;
        }
        let found = verdict(&a);
        assert_eq!(found, if largest < 0.0 { Verdict::Stable } else { Verdict::Unstable }, "{largest:e}");
        seen[usize::from(largest < 0.0)] += 1;
    }
    assert!(seen.iter().all(|&count| count > 500), "{seen:?}");
}

#[test]
fn what_is_not_made_of_numbers_is_unknown() {
    for entry in [f64::NAN, f64::INFINITY] {
        let mut a = companion(&[1.0; 8]);
        a[3][4] = entry;
        assert_eq!(verdict(&a), Verdict::Unknown);
        assert!(poles(&a).is_none());
    }
}

#[test]
fn loops_agree_with_their_poles_in_whatever_lane_and_on_any_threads() {
    // 8 k + 5 loops, so that the last group is not full.
    let (common, columns, varied) = loops(4, 2005, 30.0);
    let gains: Vec<[f64; 7]> =
        (0..2005).map(|k| [-2300.0, -1e-6, 15.0 + f64::from(k) * 1e-2, 2.0, 900.0, 30.0, 0.0]).collect();
    for law in [Law::Original, Law::Gains(&gains)] {
        let many = Loops { common: &common, columns: &columns, varied: &varied, count: 2005, law };
        let verdicts = many.stability(1).expect("threads");
        assert_eq!(verdicts, many.stability(3).expect("threads"));
        let mut seen = [0; 2];
        for (run, (&found, poles)) in verdicts.iter().zip(many.poles(2).expect("threads")).enumerate() {
            assert_eq!(found, verdict(&state_matrix(&many.models::<f64>((), run))), "lane against one alone");
            let largest = poles.iter().map(|pole| pole.re).fold(f64::NEG_INFINITY, f64::max);
            let size = poles.iter().map(|pole| pole.re.hypot(pole.im)).fold(0.0, f64::max);
            if largest.abs() > TRUSTED * size {
                assert_eq!(found, if largest < 0.0 { Verdict::Stable } else { Verdict::Unstable }, "{largest:e}");
            }
            seen[usize::from(largest < 0.0)] += 1;
        }
        assert!(seen.iter().all(|&count| count > 100), "{seen:?}");
    }
}

#[test]
#[expect(clippy::float_cmp, reason = "to the last bit")]
fn unit_vectors_give_the_jacobians_to_the_last_bit() {
    let (common, columns, varied) = loops(5, 3, 2.0);
    let many = Loops { common: &common, columns: &columns, varied: &varied, count: 3, law: Law::Original };
    for run in 0..3 {
        let a = state_matrix(&many.models::<f64>((), run));
        let mut values: [f64; COUNT] = common;
        for (k, &column) in columns.iter().enumerate() {
            values[column] = varied[run * columns.len() + k];
        }
        let parameters = Parameters::from_values(&values).map(|value| Dual::constant(1.0).constant(value));
        let model = Compliant { parameters, compensator: Compensator::original(&parameters) };
        let expected = linearize(&model, &[0.0; 8], &[0.0; 2]).a;
        for i in 0..8 {
            for j in 0..8 {
                assert_eq!(a[i][j], expected[(i, j)]);
            }
        }
    }
}

#[test]
fn bounds_hold_the_true_value() {
    // Whole numbers of up to 2^40, so that i128 knows the truth and 106 bits do not.
    let mut draws = Draws::new(6);
    let mut wrong = 0;
    for _ in 0..20_000 {
        let mut draw =
            || (i64::from(draws.whole(-(1 << 20), 1 << 20)) << 20) + i64::from(draws.whole(0, (1 << 20) - 1));
        let [a, b, c, d, e] = [draw(), draw(), draw(), draw(), draw()];
        let [x, y, z, v, w] = [a, b, c, d, e].map(|whole| Bounded::exact(float(i128::from(whole))));
        let truth = (i128::from(a) * i128::from(b) - i128::from(c)) * i128::from(d) - i128::from(e) * i128::from(a);
        let found = x.times(y).minus_product(Bounded::exact(1.0), z).times(v).minus_product(w, x);
        let (high, low, error) = found.parts();
        // high and low are whole numbers here but for the last bits of low.
        let off = float(truth - whole(high)) - low;
        assert!(off.abs() <= error, "{off:e} beyond {error:e}");
        wrong += usize::from(off != 0.0);
        let quotient = found.over(v);
        let back = found.minus_product(quotient, v).parts();
        assert!(back.0.abs() <= back.2, "a quotient times its divisor");
    }
    assert!(wrong > 100, "the test must ask for more than is exact: {wrong}");
}

#[test]
fn division_by_what_may_be_zero_knows_nothing() {
    let [zero, one] = [0.0, 1.0].map(Bounded::exact);
    let third = one.over(Bounded::exact(3.0));
    // 1 - 3 (1/3): zero but for its error.
    let nothing = one.minus_product(third, Bounded::exact(3.0));
    assert!(one.over(nothing).parts().2.is_infinite() && one.over(zero).parts().2.is_infinite());
    assert_eq!(zero.over(zero).parts(), (0.0, 0.0, 0.0));
    assert!(!nothing.is_positive() && !nothing.negative().is_positive());
}

#[expect(clippy::cast_precision_loss, reason = "below 2^53")]
fn float(whole: i128) -> f64 {
    whole as f64
}

#[expect(clippy::cast_possible_truncation, reason = "a whole number of up to 2^101")]
fn whole(value: f64) -> i128 {
    value as i128
}
