//! Many closed loops: from rows of parameters to the matrices of the linear model, a loop in each lane.
//!
//! The loader with a compliant link, eq. (17), is linear, so column `j` of its state matrix is its derivative at the unit vector
//! along state `j`: the numbers that [`linearize`](mod@crate::linearize) reads off dual numbers, to the last bit.

use crate::lanes::LANES;
use crate::law::Law;
use crate::wide::Fused;
use crate::wide::Wide;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::loader::{Compliant, System};
use forcefeel_model::parameters::{COUNT, Parameters};

/// States of the loader with a compliant link.
pub const STATES: usize = 8;

/// A square matrix of the loop's size, row by row.
pub type Matrix<T> = [[T; STATES]; STATES];

/// Loops that differ in some parameters.
#[derive(Debug, Clone, Copy)]
pub struct Loops<'a> {
    /// What they have in common, in the order of the parameter table.
    pub common: &'a [f64; COUNT],
    /// Which parameters differ.
    pub columns: &'a [usize],
    /// These parameters of each loop, loop by loop.
    pub varied: &'a [f64],
    /// How many loops.
    pub count: usize,
    /// The law of each.
    pub law: Law<'a>,
}

impl Loops<'_> {
    /// The models of the loops from `first` on, one in each lane; the last one again where there are no more.
    #[inline(always)]
    pub fn models<T: Fused>(&self, token: T::Token, first: usize) -> Compliant<T> {
        let last = self.count - 1;
        let zero = values_of::<T>(token, 0.0);
        let mut values = [zero; COUNT];
        for (value, &common) in values.iter_mut().zip(self.common) {
            *value = zero.constant(common);
        }
        let mut places = [0; LANES];
        for (lane, place) in places.iter_mut().enumerate() {
            *place = (first + lane).min(last) * self.columns.len();
        }
        for &column in self.columns {
            values[column] = T::picked(token, self.varied, &places);
            for place in &mut places {
                *place += 1;
            }
        }
        let parameters = Parameters::from_values(&values);
        let compensator = match self.law {
            Law::Original => Compensator::original(&parameters),
            Law::Position => Compensator::position_loop(&parameters),
            Law::Open => Compensator::none(&parameters),
            Law::Fixed(law) => law.map(|value| zero.constant(value)),
            Law::Gains(gains) => {
                let gain = |k: usize| T::gather(token, |lane| gains[(first + lane).min(last)][k]);
                Compensator::state_feedback(&parameters, [0, 1, 2, 3, 4, 5, 6].map(gain))
            }
            Law::Observers(_) => Compensator::state_feedback(&parameters, [zero; 7]),
        };
        Compliant { parameters, compensator }
    }
}

/// The same number in every lane.
#[inline(always)]
pub fn values_of<T: Wide>(token: T::Token, value: f64) -> T {
    T::gather(token, |_| value)
}

/// The state matrix of eq. (17) in every lane.
#[inline(always)]
pub fn state_matrix<T: Wide>(model: &Compliant<T>) -> Matrix<T> {
    let zero = model.parameters.column.inertia.zero();
    let mut a = [[zero; STATES]; STATES];
    let mut x = [zero; STATES];
    for j in 0..STATES {
        x[j] = zero.constant(1.0);
        let column = model.derivative(&x, &[zero; 2]);
        x[j] = zero;
        for i in 0..STATES {
            a[i][j] = column[i];
        }
    }
    a
}
