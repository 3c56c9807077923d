//! State-space matrices as exact Jacobians, eqs. (14a), (14b).
//!
//! `x' = A x + B u`, `y = C x + D u` · column `j` of `[A; C]` is the slope of the model along state `j`, of `[B; D]` along
//! input `j`, each from one evaluation on dual numbers.

use forcefeel_model::dual::Dual;
use forcefeel_model::loader::System;
use nalgebra::DMatrix;

/// Matrices of a linear system of `X` states, `U` inputs, `Y` outputs.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace {
    /// State matrix, `X` by `X`.
    pub a: DMatrix<f64>,
    /// Input matrix, `X` by `U`.
    pub b: DMatrix<f64>,
    /// Output matrix, `Y` by `X`.
    pub c: DMatrix<f64>,
    /// Feedthrough matrix, `Y` by `U`.
    pub d: DMatrix<f64>,
}

/// Jacobians of `system` at the state `x` and the input `u`.
pub fn linearize<const X: usize, const U: usize, const Y: usize>(
    system: &impl System<Dual, X, U, Y>,
    x: &[f64; X],
    u: &[f64; U],
) -> StateSpace {
    let (rest_x, rest_u) = (x.map(Dual::constant), u.map(Dual::constant));
    let mut result = StateSpace {
        a: DMatrix::zeros(X, X),
        b: DMatrix::zeros(X, U),
        c: DMatrix::zeros(Y, X),
        d: DMatrix::zeros(Y, U),
    };
    for j in 0..X {
        let mut x = rest_x;
        x[j] = Dual::variable(x[j].value);
        set_column(&mut result.a, j, &system.derivative(&x, &rest_u));
        set_column(&mut result.c, j, &system.outputs(&x, &rest_u));
    }
    for j in 0..U {
        let mut u = rest_u;
        u[j] = Dual::variable(u[j].value);
        set_column(&mut result.b, j, &system.derivative(&rest_x, &u));
        set_column(&mut result.d, j, &system.outputs(&rest_x, &u));
    }
    result
}

fn set_column(matrix: &mut DMatrix<f64>, j: usize, values: &[Dual]) {
    for (entry, dual) in matrix.column_mut(j).iter_mut().zip(values) {
        *entry = dual.slope;
    }
}
