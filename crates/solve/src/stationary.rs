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
/// Residual of a cost that is exact but for rounding.
const EXACT: f64 = 1e-12;

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

/// A cost with the residual of its equation, if every state decays under its gains; one that solves it less well than [`EXACT`] after a
/// step of Newton's: `E + X`, `X = C' X C + left`, `C` the closed loop.
fn proved(problem: &Problem, cost: DMatrix<f64>) -> Option<Stationary> {
    let (mut closed, left) = left_over(problem, &cost)?;
    let rough = Stationary { residual: left.amax() / cost.amax(), cost };
    let refines = rough.residual > EXACT;
    let mut correction = left;
    for _ in 0..MOST_DOUBLINGS {
        if refines {
            correction += closed.transpose() * &correction * &closed;
        }
        closed = &closed * &closed;
        if closed.amax() <= DECAYED {
            return Some(if refines { better(problem, rough, &correction) } else { rough });
        }
    }
    None
}

/// The cost with the correction, where it solves the equation better.
fn better(problem: &Problem, rough: Stationary, correction: &DMatrix<f64>) -> Stationary {
    let cost = symmetric(&(&rough.cost + correction));
    match left_over(problem, &cost).map(|(_, left)| left.amax() / cost.amax()) {
        Some(residual) if residual < rough.residual => Stationary { cost, residual },
        _ => rough,
    }
}

/// The closed loop under the gains of a cost, and what is left over of its equation.
fn left_over(Problem { phi, h, q, r }: &Problem, cost: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let ht_e = h.transpose() * cost;
    let gains = (r + &ht_e * h).lu().solve(&(ht_e * phi))?;
    let closed = phi - h * gains;
    let left = phi.transpose() * cost * &closed + q - cost;
    Some((closed, left))
}

fn symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    (matrix + matrix.transpose()) * 0.5
}
