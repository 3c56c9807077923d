//! Dual numbers: a value and its exact slope along one direction.
//!
//! `f(x + ε) = f(x) + f'(x) ε` with `ε² = 0`, so evaluating the model on a dual number differentiates it to rounding,
//! with no step size to choose.
//!
//! Value and slope may be of any number type: dual numbers of dual numbers give the slope of a slope, those of vector lanes many
//! runs with their slopes side by side. A value may also have slopes along several directions at once, [`Along`]: it is computed once for
//! all of them.

use crate::Scalar;
use core::array::from_fn;
use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A slope beside which all others vanish: whatever the units, the slopes of parameters do not drown it.
const FAST: f64 = 1e30;

/// The slope of a value of type `T`, along one direction or several.
pub trait Slope<T: Scalar>: Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> {
    /// The same slope in all directions.
    fn all(slope: T) -> Self;
    /// See [`Scalar::slope_times`].
    fn scaled(self, by: T) -> Self;
    /// See [`Scalar::slope_over`].
    fn over(self, by: T) -> Self;
    /// See [`Scalar::slope_over`], direction by direction.
    fn over_slope(self, by: Self) -> Self;
    /// See [`Scalar::times_sign`].
    fn signed(self, sign: T) -> Self;
    /// See [`Scalar::select`].
    fn either(mask: T::Mask, yes: Self, no: Self) -> Self;
}

impl<T: Scalar> Slope<T> for T {
    #[inline(always)]
    fn all(slope: T) -> Self {
        slope
    }
    #[inline(always)]
    fn scaled(self, by: T) -> Self {
        self.slope_times(by)
    }
    #[inline(always)]
    fn over(self, by: T) -> Self {
        self.slope_over(by)
    }
    #[inline(always)]
    fn over_slope(self, by: Self) -> Self {
        self.slope_over(by)
    }
    #[inline(always)]
    fn signed(self, sign: T) -> Self {
        self.times_sign(sign)
    }
    #[inline(always)]
    fn either(mask: T::Mask, yes: Self, no: Self) -> Self {
        T::select(mask, yes, no)
    }
}

/// Slopes along `N` directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Along<const N: usize>(pub [f64; N]);

impl<const N: usize> Along<N> {
    #[inline(always)]
    fn each(of: impl Fn(usize) -> f64) -> Self {
        Self(from_fn(of))
    }
}

impl<const N: usize> Add for Along<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::each(|k| self.0[k] + b.0[k])
    }
}

impl<const N: usize> Sub for Along<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::each(|k| self.0[k] - b.0[k])
    }
}

impl<const N: usize> Neg for Along<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::each(|k| -self.0[k])
    }
}

impl<const N: usize> Slope<f64> for Along<N> {
    #[inline(always)]
    fn all(slope: f64) -> Self {
        Self([slope; N])
    }
    #[inline(always)]
    fn scaled(self, by: f64) -> Self {
        Self::each(|k| self.0[k].slope_times(by))
    }
    #[inline(always)]
    fn over(self, by: f64) -> Self {
        Self::each(|k| self.0[k].slope_over(by))
    }
    #[inline(always)]
    fn over_slope(self, by: Self) -> Self {
        Self::each(|k| self.0[k].slope_over(by.0[k]))
    }
    #[inline(always)]
    fn signed(self, sign: f64) -> Self {
        if sign.is_sign_negative() { -self } else { self }
    }
    #[inline(always)]
    fn either(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
}

/// `value + slope ε`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<T = f64, D = T> {
    /// The number itself.
    pub value: T,
    /// Its derivative along the chosen direction, or directions.
    pub slope: D,
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
        Self::without_slope(value)
    }
}

impl<T: Scalar, D: Slope<T>> Dual<T, D> {
    #[inline(always)]
    fn without_slope(value: T) -> Self {
        Self { value, slope: D::all(value.zero()) }
    }
}

impl<const N: usize> Dual<f64, Along<N>> {
    /// The variable of the directions that `is_variable` selects: slope one along these, zero along the others.
    #[inline(always)]
    pub fn along(value: f64, is_variable: impl Fn(usize) -> bool) -> Self {
        Self { value, slope: Along::each(|k| if is_variable(k) { 1.0 } else { 0.0 }) }
    }
}

impl From<Dual> for f64 {
    /// Without its slope.
    fn from(number: Dual) -> Self {
        number.value
    }
}

impl<T: Scalar, D: Slope<T>> Add for Dual<T, D> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self { value: self.value + b.value, slope: self.slope + b.slope }
    }
}

impl<T: Scalar, D: Slope<T>> Sub for Dual<T, D> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self { value: self.value - b.value, slope: self.slope - b.slope }
    }
}

impl<T: Scalar, D: Slope<T>> Mul for Dual<T, D> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        // (a b)' = a' b + b' a
        Self { value: self.value * b.value, slope: self.slope.scaled(b.value) + b.slope.scaled(self.value) }
    }
}

impl<T: Scalar, D: Slope<T>> Div for Dual<T, D> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        // (a / b)' = (a' - b' (a / b)) / b
        let value = self.value / b.value;
        Self { value, slope: (self.slope - b.slope.scaled(value)).over(b.value) }
    }
}

impl<T: Scalar, D: Slope<T>> Neg for Dual<T, D> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<T: Scalar, D: Slope<T>> Scalar for Dual<T, D> {
    type Mask = T::Mask;
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        Self::without_slope(self.value.constant(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // A constant zero has no slope; the rule would divide zero by zero.
        let root = self.value.sqrt();
        Self { value: root, slope: self.slope.over(root.times(2.0)) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.times_sign(self)
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self::without_slope(self.value.round())
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
        Self { value: self.value.times_sign(other.value), slope: self.slope.signed(other.value) }
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
        Self { value: T::select(mask, yes.value, no.value), slope: D::either(mask, yes.slope, no.slope) }
    }
    #[inline(always)]
    fn slope_times(self, by: Self) -> Self {
        let (a, b) = (self.value, by.value);
        Self { value: a.slope_times(b), slope: self.slope.scaled(b) + by.slope.scaled(a) }
    }
    #[inline(always)]
    fn slope_over(self, by: Self) -> Self {
        let value = self.value.slope_over(by.value);
        Self { value, slope: (self.slope - by.slope.scaled(value)).over(by.value) }
    }
    const HAS_SLOPE: bool = true;
    const IN_LANES: bool = T::IN_LANES;
    #[inline(always)]
    fn still(self) -> Self {
        Self::without_slope(self.value)
    }
    #[inline(always)]
    fn moving(self) -> Self {
        Self { value: self.value, slope: D::all(self.value.constant(FAST)) }
    }
    #[inline(always)]
    fn root(self, residual: Self, change: Self) -> Self {
        // The root moves so that the residual r(x) stays zero, r_p + r_x x' = 0: by Newton's rule, as r' is linear in x'
        let per_slope = change.slope.scaled(self.value.constant(1.0 / FAST));
        Self { value: self.value, slope: self.slope - residual.slope.over_slope(per_slope) }
    }
}

#[cfg(feature = "serde")]
impl<'de, T: Scalar + serde::Deserialize<'de>> serde::Deserialize<'de> for Dual<T> {
    /// A number that was written down without a slope reads back as one that has none.
    fn deserialize<F: serde::Deserializer<'de>>(from: F) -> Result<Self, F::Error> {
        T::deserialize(from).map(Self::constant)
    }
}
