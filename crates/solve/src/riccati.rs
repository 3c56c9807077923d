//! Dynamic programming: recursion (22) of the report, for any number of states and inputs.
//!
//! `x_(j+1) = [Phi] x_j + [H] u_j` · `V = sum x' [Q] x + u' [R] u` · `u = c_j x` · `[E]_j` cost to go with `j` steps left
//!
//! The recursion runs backward in time, so stopped after a horizon it gives the gains of the first of that many steps, and
//! run until the gains stand still it gives those of the infinite horizon. A state that the input cannot move and that does
//! not decay, such as a constant pilot force, makes `[E]` grow without bound but leaves the gains finite.

use nalgebra::DMatrix;

/// What is to be minimized: transition, input, state weight, input weight.
#[derive(Debug, Clone)]
pub struct Problem {
    /// State transition `[Phi]`, n by n.
    pub phi: DMatrix<f64>,
    /// Input transition `[H]`, n by m.
    pub h: DMatrix<f64>,
    /// State weight `[Q]`, n by n, symmetric; also the cost at the end, `[E]_0`.
    pub q: DMatrix<f64>,
    /// Input weight `[R]`, m by m, symmetric.
    pub r: DMatrix<f64>,
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Stop {
    /// After this many steps.
    pub steps: usize,
    /// Or as soon as no gain changes by more than this share of the largest gain; zero runs all steps.
    pub tolerance: f64,
}

/// How a recursion ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The gains stand still to the tolerance.
    Converged,
    /// All steps were run.
    Horizon,
    /// `[R] + [H]'[E][H]` could not be inverted, or a number left the range of double precision.
    Singular,
}

/// The result.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Feedback `u = c x`, m by n.
    pub gains: DMatrix<f64>,
    /// Cost to go `[E]`, n by n.
    pub cost: DMatrix<f64>,
    /// Steps taken.
    pub steps: usize,
    /// Change of the gains in the last step, as a share of the largest gain.
    pub change: f64,
    /// How it ended.
    pub status: Status,
}

/// Runs recursion (22).
pub fn recursion(problem: &Problem, stop: Stop) -> Solution {
    let Problem { phi, h, q, r } = problem;
    let mut solution = Solution {
        gains: DMatrix::zeros(h.ncols(), phi.ncols()),
        cost: q.clone(),
        steps: 0,
        change: f64::INFINITY,
        status: Status::Horizon,
    };
    while solution.steps < stop.steps {
        let ht_e = h.transpose() * &solution.cost;
        // c_j = -(R + H' E_(j-1) H)^-1 H' E_(j-1) Phi                                                  eq. (22a)
        let gains = (r + &ht_e * h).lu().solve(&-(ht_e * phi));
        let Some(gains) = gains.filter(|c| c.iter().all(|x| x.is_finite())) else {
            solution.status = Status::Singular;
            break;
        };
        let closed = phi + h * &gains;
        // E_j = (Phi + H c_j)' E_(j-1) (Phi + H c_j) + Q + c_j' R c_j                                    eq. (22b)
        let cost = closed.transpose() * &solution.cost * &closed + q + gains.transpose() * r * &gains;
        // Rounding would let the antisymmetric part grow; it has no meaning.
        solution.cost = (&cost + cost.transpose()) * 0.5;
        solution.change = (&gains - &solution.gains).amax() / gains.amax();
        solution.gains = gains;
        solution.steps += 1;
        if solution.change <= stop.tolerance {
            solution.status = Status::Converged;
            break;
        }
    }
    solution
}
