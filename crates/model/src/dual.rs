//! Dual numbers: a value and its exact slope along one direction.
//!
//! `f(x + ε) = f(x) + f'(x) ε` with `ε² = 0`, so evaluating the model on a dual number differentiates it to rounding,
//! with no step size to choose.

use crate::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// `value + slope ε`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    /// The number itself.
    pub value: f64,
    /// Its derivative along the chosen direction.
    pub slope: f64,
}

impl Dual {
    /// The variable that is differentiated by: slope one.
    pub fn variable(value: f64) -> Self {
        Self { value, slope: 1.0 }
    }
}

/// A constant has no slope, however large the number it is multiplied by: limits that are off are infinite.
fn scaled(slope: f64, by: f64) -> f64 {
    if slope == 0.0 { 0.0 } else { slope * by }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { value: self.value + b.value, slope: self.slope + b.slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self { value: self.value - b.value, slope: self.slope - b.slope }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self { value: self.value * b.value, slope: scaled(self.slope, b.value) + scaled(b.slope, self.value) }
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        let slope = self.slope - scaled(b.slope, value);
        Self { value, slope: if slope == 0.0 { 0.0 } else { slope / b.value } }
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl Dual {
    /// A number that does not depend on the variable.
    pub fn constant(value: f64) -> Self {
        Self { value, slope: 0.0 }
    }
}

impl Scalar for Dual {
    type Mask = bool;
    fn constant(self, value: f64) -> Self {
        Self::constant(value)
    }
    fn sqrt(self) -> Self {
        let root = libm::sqrt(self.value);
        // A constant zero has no slope; the rule would divide zero by zero.
        let slope = if self.slope == 0.0 { 0.0 } else { self.slope / (2.0 * root) };
        Self { value: root, slope }
    }
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
    fn round(self) -> Self {
        Self::constant(libm::rint(self.value))
    }
    fn min(self, other: Self) -> Self {
        if self.value < other.value { self } else { other }
    }
    fn max(self, other: Self) -> Self {
        if self.value > other.value { self } else { other }
    }
    fn times_sign(self, other: Self) -> Self {
        if other.value.is_sign_negative() { -self } else { self }
    }
    fn less(self, other: Self) -> bool {
        self.value < other.value
    }
    fn any(mask: bool) -> bool {
        mask
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}
