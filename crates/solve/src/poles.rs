//! The poles of many loops: eigenvalues of the balanced matrix, a loop after the other, over the cores.

use crate::balance::balance;
use crate::loops::{Loops, Matrix, STATES, state_matrix};
use crate::threads::{NoThreads, each};
use nalgebra::{Complex, SMatrix, Schur};

/// The poles of one loop, in no order.
pub type Poles = [Complex<f64>; STATES];

/// Steps of the QR algorithm after which it is given up; it takes some three for each pole.
const MOST_STEPS: usize = 1000;

/// Eigenvalues of `a`; nothing if it is not made of numbers.
pub fn poles(a: &Matrix<f64>) -> Option<Poles> {
    if !a.as_flattened().iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let mut balanced = *a;
    balance(&mut balanced);
    let matrix = SMatrix::<f64, STATES, STATES>::from_fn(|i, j| balanced[i][j]);
    let values = Schur::try_new(matrix, f64::EPSILON, MOST_STEPS)?.complex_eigenvalues();
    let values: Poles = values.into();
    values.iter().all(|value| value.re.is_finite() && value.im.is_finite()).then_some(values)
}

impl Loops<'_> {
    /// The poles of each loop, computed on so many threads; not numbers where the loop's matrix is not made of numbers.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn poles(&self, threads: usize) -> Result<Vec<Poles>, NoThreads> {
        let unknown = [Complex::new(f64::NAN, f64::NAN); STATES];
        let mut found = vec![unknown; self.count];
        each(threads, found.iter_mut().enumerate(), |(run, found)| {
            if let Some(poles) = poles(&state_matrix(&self.models::<f64>((), run))) {
                *found = poles;
            }
        })?;
        Ok(found)
    }
}
