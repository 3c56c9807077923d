//! Matrices written as they are read.

use nalgebra::DMatrix;

/// The matrix with these rows.
pub fn rows<const R: usize, const C: usize>(rows: [[f64; C]; R]) -> DMatrix<f64> {
    DMatrix::from_row_iterator(R, C, rows.into_iter().flatten())
}
