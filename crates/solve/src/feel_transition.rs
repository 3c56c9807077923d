//! The programmed feel from one time to another, exactly: eq. (11), `w' = W w` on `w = [delta, delta']`.
//!
//! `w_n`, `zeta` natural frequency and damping ratio · `s = -zeta w_n t` · `r^2 = (zeta^2 - 1) (w_n t)^2`
//!
//! `exp(W t) = e^s (cosh r + (W t - s) sinh r / r)`, which holds below, at and above critical damping.

use crate::discretize;
use forcefeel_model::parameters::Feel;
use nalgebra::{DMatrix, Matrix2};

/// `exp(W t)` of the unforced feel.
pub fn feel_transition(feel: &Feel<f64>, t: f64) -> Matrix2<f64> {
    let (frequency, damping) = feel.frequency();
    let turned = frequency * t;
    let s = -damping * turned;
    let r2 = (damping * damping - 1.0) * turned * turned;
    let r = r2.abs().sqrt();
    let (cosh, sinh_by_r) = if r < NEAR {
        (s.exp() * (1.0 + r2 / 2.0), s.exp() * (1.0 + r2 / 6.0))
    } else if r2 > 1.0 {
        // As sums of e^(s + r) and e^(s - r), neither of which grows; they cancel where r is small.
        let (up, down) = ((s + r).exp(), (s - r).exp());
        (f64::midpoint(up, down), (up - down) / (2.0 * r))
    } else if r2 > 0.0 {
        (s.exp() * r.cosh(), s.exp() * r.sinh() / r)
    } else {
        (s.exp() * r.cos(), s.exp() * r.sin() / r)
    };
    let across = t * sinh_by_r;
    Matrix2::new(cosh - s * sinh_by_r, across, -frequency * frequency * across, cosh + s * sinh_by_r)
}

/// Where the series of `cosh r` and `sinh r / r` end with `r^2`: the next term, `r^4 / 24`, is below rounding.
const NEAR: f64 = 1e-4;

/// `[Phi, Gamma]` (2 by 3) of the feel over a period `h` under a torque that stays: `w+ = Phi w + Gamma T`.
pub fn feel_step(feel: &Feel<f64>, h: f64) -> DMatrix<f64> {
    let rates = |delta: f64, rate: f64, torque: f64| [rate, feel.acceleration(delta, rate, torque)];
    let columns = [rates(1.0, 0.0, 0.0), rates(0.0, 1.0, 0.0)].concat();
    let (phi, gamma) =
        discretize(&DMatrix::from_vec(2, 2, columns), &DMatrix::from_vec(2, 1, rates(0.0, 0.0, 1.0).to_vec()), h);
    DMatrix::from_fn(2, 3, |i, j| if j < 2 { phi[(i, j)] } else { gamma[(i, 0)] })
}
