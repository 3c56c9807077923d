//! Gains for many feel settings of one plant.
//!
//! The plant `z = [x_p, p, x_b, x_b']` does not see the feel model `w = [delta, delta']`, `w' = W w`, so the Riccati equation
//! of the whole falls apart: one 4-state Riccati equation for the plant (solved once, by the caller) and, per setting, one
//! linear equation for the block `P` (4 by 2) of the cost that couples `z` and `w`:
//!
//! | time | equation |
//! |---|---|
//! | continuous | `M' P + P W + Q = 0` |
//! | discrete, step `h` | `P = M' P Phi + Q`, `Phi = exp(W h)` |
//!
//! `M` closed-loop plant matrix, `Q` (4 by 2) coupling block of `[Q]`. `W` and `Phi` are 2 by 2, so with their trace `t` and
//! determinant `d` the theorem of Cayley and Hamilton removes them from one side and leaves a single 4 by 4 system:
//!
//! | time | system |
//! |---|---|
//! | continuous | `(M'^2 + t M' + d) P = -(M' Q + Q adj W)` |
//! | discrete | `(1 - t M' + d M'^2) P = Q - M' Q adj Phi` |
//!
//! `adj W = t - W`. The gains of `w` are `c_w = -k P` (continuous) and `-k P Phi` (discrete), where the row `k` is
//! `R^-1 b'` or `(R + b' E b)^-1 b'` of the plant's Riccati equation.

use forcefeel_model::parameters::Feel;
use nalgebra::{Matrix2, Matrix4, Matrix4x2, RowVector2, RowVector4};

/// Continuous time, or discrete with its period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Time {
    /// Continuous.
    Continuous,
    /// Discrete with this period in s.
    Discrete(f64),
}

/// What all settings share.
#[derive(Debug, Clone)]
pub struct Plant {
    /// Closed-loop matrix `M` of the plant under its own feedback, in the time of the design.
    pub closed: Matrix4<f64>,
    /// Coupling weight `Q` between plant and feel states.
    pub coupling: Matrix4x2<f64>,
    /// Row `k` that turns cost into gains.
    pub gain_row: RowVector4<f64>,
    /// Time of the design.
    pub time: Time,
}

/// Gains `[c_delta, c_delta']` for each setting; `NaN` where the linear equation is singular.
pub fn schedule(plant: &Plant, settings: &[Feel<f64>]) -> Vec<[f64; 2]> {
    let mt = plant.closed.transpose();
    let squared = mt * mt;
    let mt_q = mt * plant.coupling;
    settings.iter().map(|setting| gains(plant, &mt, &squared, &mt_q, setting)).collect()
}

fn gains(
    plant: &Plant,
    mt: &Matrix4<f64>,
    squared: &Matrix4<f64>,
    mt_q: &Matrix4x2<f64>,
    setting: &Feel<f64>,
) -> [f64; 2] {
    let w = feel_matrix(setting);
    let (system, right, after) = match plant.time {
        Time::Continuous => {
            let (t, d) = (w.trace(), w.determinant());
            let system = squared + mt * t + Matrix4::identity() * d;
            (system, -(mt_q + plant.coupling * adjugate(&w)), Matrix2::identity())
        }
        Time::Discrete(h) => {
            let phi = exponential(&(w * h));
            let (t, d) = (phi.trace(), phi.determinant());
            let system = Matrix4::identity() - mt * t + squared * d;
            (system, plant.coupling - mt_q * adjugate(&phi), phi)
        }
    };
    // Only the row k P is wanted: solve the transposed system for it once instead of for both columns of P.
    let row = system.transpose().lu().solve(&plant.gain_row.transpose());
    row.map_or([f64::NAN; 2], |row| {
        let gains: RowVector2<f64> = -(row.transpose() * right * after);
        gains.into()
    })
}

/// `W` of `w' = W w`: the unforced feel, column by column.
fn feel_matrix(feel: &Feel<f64>) -> Matrix2<f64> {
    Matrix2::new(0.0, 1.0, feel.acceleration(1.0, 0.0, 0.0), feel.acceleration(0.0, 1.0, 0.0))
}

fn adjugate(m: &Matrix2<f64>) -> Matrix2<f64> {
    Matrix2::new(m.m22, -m.m12, -m.m21, m.m11)
}

/// `exp(m)` in closed form: `exp(m) = e^s (cosh r + (m - s) sinh r / r)`, `s = tr m / 2`, `r^2 = s^2 - det m`.
fn exponential(m: &Matrix2<f64>) -> Matrix2<f64> {
    let s = m.trace() / 2.0;
    let r2 = s * s - m.determinant();
    let r = r2.abs().sqrt();
    let (cosh, sinh_over_r) = if r < 1e-4 {
        // Series of both: the first term left out, r^4 / 24, is below rounding.
        (1.0 + r2 / 2.0, 1.0 + r2 / 6.0)
    } else if r2 > 0.0 {
        (r.cosh(), r.sinh() / r)
    } else {
        (r.cos(), r.sin() / r)
    };
    let shifted = m - Matrix2::identity() * s;
    (Matrix2::identity() * cosh + shifted * sinh_over_r) * s.exp()
}
