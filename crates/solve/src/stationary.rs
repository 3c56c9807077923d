//! The stationary equation of recursion (22), by doubling: step `k` runs `2^k` steps of the recursion at once.
//!
//! `G_0 = H R^-1 H'` · `E_0 = Q` · `A_0 = Phi` · `W = I + G_k E_k`
//!
//!     A_(k+1) = A_k W^-1 A_k,   G_(k+1) = G_k + A_k W^-1 G_k A_k',   E_(k+1) = E_k + A_k' E_k W^-1 A_k
//!
//! `E_k` is the cost to go with `2^k` steps left, `A_k` the closed loop over as many. E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang,
//! Structure-preserving algorithms for periodic discrete-time algebraic Riccati equations, Int. J. Control 77 (2004) 767-788.

use crate::riccati::Problem;
use nalgebra::DMatrix;

/// Doublings at most: over `2^44` steps a pole at `1 - 1e-12` still decays to `1e-8`.
const MOST_DOUBLINGS: usize = 44;
/// Share of its state that the closed loop may still have after them.
const DECAYED: f64 = 1e-8;
/// Relative change of the cost at which it stands still.
const STILL: f64 = 1e-15;

/// A stationary cost, and how well it solves its equation.
#[derive(Debug, Clone)]
pub struct Stationary {
    /// `[E]`, n by n.
    pub cost: DMatrix<f64>,
    /// Residual of the equation, as a share of the largest number of the cost.
    pub residual: f64,
}

/// The stabilizing solution; none if a state does not decay in the closed loop, or a matrix cannot be inverted.
pub fn stationary(problem: &Problem) -> Option<Stationary> {
    let Problem { phi, h, q, r } = problem;
    let identity = DMatrix::identity(phi.nrows(), phi.nrows());
    let (mut a, mut e) = (phi.clone(), q.clone());
    let mut g = h * r.clone().lu().solve(&h.transpose())?;
    for _ in 0..MOST_DOUBLINGS {
        let inverse = (&identity + &g * &e).lu();
        let (wa, wg) = (inverse.solve(&a)?, inverse.solve(&g)?);
        let more = a.transpose() * &e * &wa;
        let change = more.amax();
        g = symmetric(&(&g + &a * wg * a.transpose()));
        e = symmetric(&(&e + more));
        a *= wa;
        if change <= STILL * e.amax() {
            return proved(problem, e);
        }
    }
    None
}

/// A cost with the residual of its equation, if every state decays under its gains.
fn proved(Problem { phi, h, q, r }: &Problem, cost: DMatrix<f64>) -> Option<Stationary> {
    let ht_e = h.transpose() * &cost;
    let gains = (r + &ht_e * h).lu().solve(&(ht_e * phi))?;
    let mut closed = phi - h * gains;
    let residual = (phi.transpose() * &cost * &closed + q - &cost).amax() / cost.amax();
    for _ in 0..MOST_DOUBLINGS {
        closed = &closed * &closed;
        if closed.amax() <= DECAYED {
            return Some(Stationary { cost, residual });
        }
    }
    None
}

fn symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    (matrix + matrix.transpose()) * 0.5
}
