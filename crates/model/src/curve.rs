//! A curve through points: piecewise cubic, straight beyond its ends.
//!
//! `x_j` knots · `c_j0 .. c_j3` coefficients of piece `j`: `y = ((c_j0 u + c_j1) u + c_j2) u + c_j3`, `u = x - x_j`
//!
//! The coefficients come from whoever makes the curve; a monotone interpolation (Fritsch and Carlson) keeps a spring a spring.

use crate::Scalar;

/// Most points of a curve.
pub const MOST_POINTS: usize = 32;

/// Knots and coefficients, shared by all runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    pieces: usize,
    knots: [f64; MOST_POINTS],
    /// Piece `0` leads up to the first knot, piece `j` leaves knot `j - 1`.
    coefficients: [[f64; 4]; MOST_POINTS + 1],
}

impl Curve {
    /// From knots and the coefficients of the pieces between them; nothing if their numbers do not fit.
    #[inline(always)]
    pub fn new(knots: &[f64], coefficients: &[[f64; 4]]) -> Option<Self> {
        if knots.len() < 2 || knots.len() > MOST_POINTS || coefficients.len() + 1 != knots.len() {
            return None;
        }
        let mut curve =
            Self { pieces: knots.len(), knots: [0.0; MOST_POINTS], coefficients: [[0.0; 4]; MOST_POINTS + 1] };
        curve.knots[..knots.len()].copy_from_slice(knots);
        let first = coefficients[0];
        curve.coefficients[0] = [0.0, 0.0, first[2], first[3]];
        curve.coefficients[1..knots.len()].copy_from_slice(coefficients);
        let &[c_0, c_1, c_2, c_3] = &coefficients[coefficients.len() - 1];
        let u = knots[knots.len() - 1] - knots[knots.len() - 2];
        let (end, slope) = (((c_0 * u + c_1) * u + c_2) * u + c_3, (3.0 * c_0 * u + 2.0 * c_1) * u + c_2);
        curve.coefficients[knots.len()] = [0.0, 0.0, slope, end];
        Some(curve)
    }

    /// The curve at `x`.
    #[inline(always)]
    pub fn at<S: Scalar>(&self, x: S) -> S {
        let mut knot = x.constant(self.knots[0]);
        let mut c = self.coefficients[0].map(|value| x.constant(value));
        // Taken, not sliced: a number of pieces that the compiler does not know would leave a panic in it.
        for (&next, piece) in self.knots.iter().zip(&self.coefficients[1..]).take(self.pieces) {
            let before = x.less(x.constant(next));
            knot = S::select(before, knot, x.constant(next));
            for (c, &value) in c.iter_mut().zip(piece) {
                *c = S::select(before, *c, x.constant(value));
            }
        }
        let u = x - knot;
        ((c[0] * u + c[1]) * u + c[2]) * u + c[3]
    }
}
