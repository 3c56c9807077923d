//! Checks of single numbers.

use crate::Scalar;

/// Whether one number is below another.
#[inline(always)]
pub(super) fn below<S: Scalar>(a: S, b: S) -> S::Mask {
    a.less(b)
}

/// Whether a number is one, and finite.
#[inline(always)]
pub(crate) fn finite<S: Scalar>(value: S) -> bool {
    S::any(value.is_number())
}
