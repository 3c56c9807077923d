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
pub enum Stop {
    /// After so many steps.
    Horizon(usize),
    /// When the gains stand still.
    StandStill {
        /// Largest change of a gain over the second half of the steps, as a share of the largest gain. Over half of them,
        /// because gains that swing towards their limit stand still for a moment at each turning point.
        tolerance: f64,
        /// Give up after so many steps.
        most_steps: usize,
    },
}

/// How a recursion ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// The gains stand still to the tolerance.
    Converged,
    /// All steps of the horizon were run.
    Horizon,
    /// The gains still moved when the steps ran out.
    Moving,
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
    /// Change of the gains over the second half of the steps when it was last looked at, as a share of the largest gain.
    pub change: f64,
    /// How it ended.
    pub status: Status,
}

/// Runs recursion (22).
pub fn recursion(problem: &Problem, stop: Stop) -> Solution {
    let n = problem.phi.ncols();
    let (most_steps, tolerance) = match stop {
        Stop::Horizon(steps) => (steps, None),
        Stop::StandStill { tolerance, most_steps } => (most_steps, Some(tolerance)),
    };
    let mut solution = Solution {
        gains: DMatrix::zeros(problem.h.ncols(), n),
        cost: problem.q.clone(),
        steps: 0,
        change: f64::INFINITY,
        status: if tolerance.is_some() { Status::Moving } else { Status::Horizon },
    };
    // A weight may need n steps to be felt at the input, so nothing is judged before.
    let (mut earlier, mut look) = (None, n);
    while solution.steps < most_steps {
        if !step(problem, &mut solution) {
            solution.status = Status::Singular;
            break;
        }
        if solution.steps == look {
            if let Some(earlier) = earlier {
                solution.change = relative_change(&solution.gains, &earlier);
            }
            if tolerance.is_some_and(|tolerance| solution.change <= tolerance) {
                solution.status = Status::Converged;
                break;
            }
            earlier = Some(solution.gains.clone());
            look *= 2;
        }
    }
    solution
}

/// One step backward in time; false if it is singular.
fn step(problem: &Problem, solution: &mut Solution) -> bool {
    let Problem { phi, h, q, r } = problem;
    let ht_e = h.transpose() * &solution.cost;
    // c_j = -(R + H' E_(j-1) H)^-1 H' E_(j-1) Phi                                                      eq. (22a)
    let gains = (r + &ht_e * h).lu().solve(&-(ht_e * phi));
    let Some(gains) = gains.filter(|c| c.iter().all(|x| x.is_finite())) else {
        return false;
    };
    let closed = phi + h * &gains;
    // E_j = (Phi + H c_j)' E_(j-1) (Phi + H c_j) + Q + c_j' R c_j                                        eq. (22b)
    let cost = closed.transpose() * &solution.cost * &closed + q + gains.transpose() * r * &gains;
    // Rounding would let the antisymmetric part grow; it has no meaning.
    solution.cost = (&cost + cost.transpose()) * 0.5;
    solution.gains = gains;
    solution.steps += 1;
    true
}

/// Largest difference as a share of the largest gain; zero where all are zero.
fn relative_change(gains: &DMatrix<f64>, earlier: &DMatrix<f64>) -> f64 {
    let difference = (gains - earlier).amax();
    if difference == 0.0 { 0.0 } else { difference / gains.amax() }
}
