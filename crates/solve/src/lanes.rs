//! Eight runs at once, or four: a number with a lane for each.
//!
//! The vector instructions are chosen when the program runs: AVX-512 or AVX2 where the machine has them and they were compiled for
//! (`build.rs`), else what every machine has. Each lane is computed with correctly rounded operations and without fused ones, so it holds the same bits as the
//! same run alone in double precision, on whatever machine.
//!
//! The operations are `#[inline]` and not `#[inline(always)]`: each is then made simple by itself before the step takes it in. With
//! all of them laid into one function first, the compiler needs three times as long for the same instructions.

use core::ops::{Add, Div, Mul, Neg, Sub};
use fearless_simd::prelude::*;
use fearless_simd::{f64x4, f64x8, mask64x4, mask64x8, u64x8};
use forcefeel_model::Scalar;

/// The bits of a double's exponent.
pub(crate) const EXPONENT: u64 = 0x7ff0_0000_0000_0000;

macro_rules! operator {
    ($Lanes:ident, $Trait:ident, $method:ident) => {
        impl<S: Simd> $Trait for $Lanes<S> {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                Self($Trait::$method(self.0, other.0))
            }
        }
    };
}

macro_rules! lanes {
    ($Lanes:ident, $COUNT:ident = $count:literal, $numbers:ident, $mask:ident; $of:literal, $side_by_side:literal) => {
        #[doc = $side_by_side]
        pub const $COUNT: usize = $count;

        #[doc = $of]
        #[derive(Debug, Clone, Copy)]
        pub struct $Lanes<S: Simd>($numbers<S>);

        impl<S: Simd> $Lanes<S> {
            /// The same number in every lane.
            #[inline(always)]
            pub fn splat(simd: S, value: f64) -> Self {
                Self($numbers::splat(simd, value))
            }
            /// A number for each lane.
            #[inline(always)]
            pub fn new(simd: S, values: [f64; $COUNT]) -> Self {
                Self($numbers::simd_from(simd, values))
            }
            /// The numbers of the lanes.
            #[inline(always)]
            pub fn values(self) -> [f64; $COUNT] {
                self.0.into()
            }
        }

        operator!($Lanes, Add, add);
        operator!($Lanes, Sub, sub);
        operator!($Lanes, Mul, mul);
        operator!($Lanes, Div, div);

        impl<S: Simd> Neg for $Lanes<S> {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl<S: Simd> Scalar for $Lanes<S> {
            type Mask = $mask<S>;
            const IN_LANES: bool = true;
            #[inline]
            fn constant(self, value: f64) -> Self {
                Self::splat(self.0.simd, value)
            }
            #[inline]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            #[inline]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }
            #[inline]
            fn round(self) -> Self {
                Self(self.0.round_ties_even())
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                Self(self.0.min(other.0))
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                Self(self.0.max(other.0))
            }
            #[inline]
            fn times_sign(self, other: Self) -> Self {
                let sign = $numbers::splat(self.0.simd, -0.0).to_bits();
                Self((self.0.to_bits() ^ (other.0.to_bits() & sign)).bitcast())
            }
            #[inline]
            fn less(self, other: Self) -> Self::Mask {
                self.0.simd_lt(other.0)
            }
            #[inline]
            fn any(mask: Self::Mask) -> bool {
                mask.any_true()
            }
            #[inline]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                Self(mask.select(yes.0, no.0))
            }
            #[inline]
            fn slope_times(self, by: Self) -> Self {
                let zero = self.zero();
                Self(self.0.simd_eq(zero.0).select(zero.0, self.0 * by.0))
            }
            #[inline]
            fn slope_over(self, by: Self) -> Self {
                let zero = self.zero();
                Self(self.0.simd_eq(zero.0).select(zero.0, self.0 / by.0))
            }
        }
    };
}

lanes!(Lanes, LANES = 8, f64x8, mask64x8; "One number of eight runs.", "How many runs stand side by side.");
lanes!(
    FourLanes, FOUR_LANES = 4, f64x4, mask64x4;
    "One number of four runs: for a step whose instructions and numbers are too many for the nearest cache with eight, where a register holds four.",
    "How many runs stand side by side in one of those."
);

impl<S: Simd> Lanes<S> {
    /// `self factor + term`, rounded once.
    #[inline(always)]
    pub(crate) fn fused(self, factor: Self, term: Self) -> Self {
        Self(self.0.mul_add_precise(factor.0, term.0))
    }
    /// Only the exponent of each number.
    #[inline(always)]
    pub(crate) fn exponent(self) -> Self {
        let bits = self.0.to_bits();
        Self((bits & u64x8::splat(self.0.simd, EXPONENT)).bitcast())
    }
    /// The lanes of both in turn: the first halves, the second halves.
    #[inline(always)]
    pub(crate) fn zip(self, other: Self) -> (Self, Self) {
        (Self(self.0.zip_low(other.0)), Self(self.0.zip_high(other.0)))
    }
}

/// Whether runs are compiled for AVX-512, and for AVX2: see `build.rs`.
pub const COMPILED_FOR: (bool, bool) = (cfg!(avx512), cfg!(avx2));

/// Returns what `$run` gives with `$simd`, the widest vector instructions that the machine has; goes on where it has none. Those whose
/// registers hold a number of eight runs, and those that need several, may be given different things to do.
#[macro_export]
macro_rules! return_on_vectors {
    ($level:expr, $simd:ident => $run:expr) => {
        $crate::return_on_vectors!($level, $simd => $run, $simd => $run);
    };
    ($level:expr, $whole:ident => $in_one:expr, $parted:ident => $in_several:expr) => {
        #[cfg(target_arch = "x86_64")]
        {
            // Of constants, so that the compiler leaves out what is not compiled for.
            if $crate::lanes::COMPILED_FOR.0
                && let Some($whole) = $level.as_avx512()
            {
                return $in_one;
            }
            if $crate::lanes::COMPILED_FOR.1
                && let Some($parted) = $level.as_avx2()
            {
                return $in_several;
            }
        }
        #[cfg(target_arch = "aarch64")]
        if let Some($parted) = $level.as_neon() {
            return $in_several;
        }
        let _ = $level;
    };
}
