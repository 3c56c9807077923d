//! Dual numbers: a value and its exact slope along one direction.
//!
//! `f(x + ε) = f(x) + f'(x) ε` with `ε² = 0`, so evaluating the model on a dual number differentiates it to rounding,
//! with no step size to choose.
//!
//! Value and slope may be of any number type: dual numbers of dual numbers give the slope of a slope, those of vector lanes many
//! runs with their slopes side by side.

use crate::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A slope beside which all others vanish: whatever the units, the slopes of parameters do not drown it.
const FAST: f64 = 1e30;

/// `value + slope ε`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<T = f64> {
    /// The number itself.
    pub value: T,
    /// Its derivative along the chosen direction.
    pub slope: T,
}

impl<T: Scalar> Dual<T> {
    /// The variable that is differentiated by: slope one.
    #[inline(always)]
    pub fn variable(value: T) -> Self {
        Self { value, slope: value.constant(1.0) }
    }

    /// A number that does not depend on the variable.
    #[inline(always)]
    pub fn constant(value: T) -> Self {
        Self { value, slope: value.zero() }
    }
}

impl From<Dual> for f64 {
    /// Without its slope.
    fn from(number: Dual) -> Self {
        number.value
    }
}

impl<T: Scalar> Add for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { value: self.value + b.value, slope: self.slope + b.slope }
    }
}

impl<T: Scalar> Sub for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { value: self.value - b.value, slope: self.slope - b.slope }
    }
}

impl<T: Scalar> Mul for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        // (a b)' = a' b + b' a
        Self { value: self.value * b.value, slope: self.slope.slope_times(b.value) + b.slope.slope_times(self.value) }
    }
}

impl<T: Scalar> Div for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        // (a / b)' = (a' - b' (a / b)) / b
        let value = self.value / b.value;
        Self { value, slope: (self.slope - b.slope.slope_times(value)).slope_over(b.value) }
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<T: Scalar> Scalar for Dual<T> {
    type Mask = T::Mask;
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::constant(self.value.constant(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // A constant zero has no slope; the rule would divide zero by zero.
        let root = self.value.sqrt();
        Self { value: root, slope: self.slope.slope_over(root.times(2.0)) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.times_sign(self)
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self::constant(self.value.round())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.less(other), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.less(self), self, other)
    }
    #[inline(always)]
    fn times_sign(self, other: Self) -> Self {
        Self { value: self.value.times_sign(other.value), slope: self.slope.times_sign(other.value) }
    }
    #[inline(always)]
    fn less(self, other: Self) -> T::Mask {
        self.value.less(other.value)
    }
    #[inline(always)]
    fn any(mask: T::Mask) -> bool {
        T::any(mask)
    }
    #[inline(always)]
    fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Self { value: T::select(mask, yes.value, no.value), slope: T::select(mask, yes.slope, no.slope) }
    }
    #[inline(always)]
    fn slope_times(self, by: Self) -> Self {
        let (a, b) = (self.value, by.value);
        Self { value: a.slope_times(b), slope: self.slope.slope_times(b) + by.slope.slope_times(a) }
    }
    #[inline(always)]
    fn slope_over(self, by: Self) -> Self {
        let value = self.value.slope_over(by.value);
        Self { value, slope: (self.slope - by.slope.slope_times(value)).slope_over(by.value) }
    }
    const HAS_SLOPE: bool = true;
    const IN_LANES: bool = T::IN_LANES;
    #[inline(always)]
    fn still(self) -> Self {
        Self::constant(self.value)
    }
    #[inline(always)]
    fn moving(self) -> Self {
        Self { value: self.value, slope: self.value.constant(FAST) }
    }
    #[inline(always)]
    fn root(self, residual: Self, change: Self) -> Self {
        // The root moves so that the residual r(x) stays zero, r_p + r_x x' = 0: by Newton's rule, as r' is linear in x'
        let per_slope = change.slope.times(1.0 / FAST);
        Self { value: self.value, slope: self.slope - residual.slope.slope_over(per_slope) }
    }
}

#[cfg(feature = "serde")]
impl<'de, T: Scalar + serde::Deserialize<'de>> serde::Deserialize<'de> for Dual<T> {
    /// A number that was written down without a slope reads back as one that has none.
    fn deserialize<F: serde::Deserializer<'de>>(from: F) -> Result<Self, F::Error> {
        T::deserialize(from).map(Self::constant)
    }
}
