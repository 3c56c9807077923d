//! Two numbers side by side, so that while one waits for a result the other computes.
//!
//! The equations of a step wait for one another: a vector of runs keeps the processor busy for less than half of the time. Two
//! vectors that take turns fill the gaps.

use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use forcefeel_model::Scalar;
use forcefeel_solve::wide::Wide;

/// Two of a kind; of numbers and of the outcomes of comparisons.
#[derive(Debug, Clone, Copy)]
pub struct Pair<T>(pub T, pub T);

macro_rules! operator {
    ($Trait:ident, $method:ident) => {
        impl<T: $Trait<Output = T>> $Trait for Pair<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
    (of one $Trait:ident, $method:ident) => {
        impl<T: $Trait<Output = T>> $Trait for Pair<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self) -> Self {
                Self(self.0.$method(), self.1.$method())
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);
operator!(BitAnd, bitand);
operator!(BitOr, bitor);
operator!(of one Neg, neg);
operator!(of one Not, not);

impl<T: Wide> Wide for Pair<T> {
    type Token = T::Token;
    const RUNS: usize = 2 * T::RUNS;
    #[inline(always)]
    fn gather(token: T::Token, of: impl Fn(usize) -> f64) -> Self {
        Self(T::gather(token, &of), T::gather(token, |k| of(T::RUNS + k)))
    }
    #[inline(always)]
    fn scatter(self, mut to: impl FnMut(usize, f64)) {
        self.0.scatter(&mut to);
        self.1.scatter(|k, value| to(T::RUNS + k, value));
    }
}

impl<T: Scalar> Scalar for Pair<T> {
    type Mask = Pair<T::Mask>;
    const IN_LANES: bool = true;
    #[inline(always)]
    fn constant(self, value: f64) -> Self {
        let constant = self.0.constant(value);
        Self(constant, constant)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(self.0.round(), self.1.round())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn times_sign(self, other: Self) -> Self {
        Self(self.0.times_sign(other.0), self.1.times_sign(other.1))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Self::Mask {
        Pair(self.0.less(other.0), self.1.less(other.1))
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        T::any(mask.0 | mask.1)
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(T::select(mask.0, yes.0, no.0), T::select(mask.1, yes.1, no.1))
    }
    #[inline(always)]
    fn slope_times(self, by: Self) -> Self {
        Self(self.0.slope_times(by.0), self.1.slope_times(by.1))
    }
    #[inline(always)]
    fn slope_over(self, by: Self) -> Self {
        Self(self.0.slope_over(by.0), self.1.slope_over(by.1))
    }
}
