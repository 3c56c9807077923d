//! The number type of the model.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// What the equations of the model ask of a number.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The constant `value` as this number type.
    fn constant(value: f64) -> Self;
    /// The square root; not a number below zero.
    fn sqrt(self) -> Self;
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
}

impl Scalar for f32 {
    #[expect(clippy::cast_possible_truncation, reason = "rounding to single precision is what is asked")]
    fn constant(value: f64) -> Self {
        value as f32
    }
    fn sqrt(self) -> Self {
        libm::sqrtf(self)
    }
}
