//! Numbers of twice the digits that know how wrong they are.
//!
//! A number is `high + low`, with `|low| <= u |high|` and `u = 2^-53`, and the true value of what was computed lies within
//! `error` of it. Products and sums follow Dekker and Knuth with the exact errors of single operations; what is left out of
//! them is at most some `u^2` of the operands and goes into the bound.
//!
//! The bound itself is summed in plain double precision. Every operation may make it too small by a factor `1 - u`, some
//! thousands of them by less than `1e-12`; the tests for a sign ask for twice the bound, which covers that. Underflow is left
//! out: it would take poles below `1e-30` or above `1e30` rad/s.
//!
//! Dekker, "A floating-point technique for extending the available precision", 1971; Joldes, Muller and Popescu, "Tight and
//! rigorous error bounds for basic building blocks of double-word arithmetic", 2017.

use crate::wide::Fused;
use forcefeel_model::Scalar;

/// `high + low`, true to within `error`.
#[derive(Debug, Clone, Copy)]
pub struct Bounded<T> {
    high: T,
    low: T,
    error: T,
}

/// What a fused `a - m b` leaves out is at most `32 u^2 (|a| + |m b|)`; a product, less. Twice that.
const LEFT_OUT: f64 = 64.0 * UNIT * UNIT;
/// `u`: half the distance from one to the next number.
const UNIT: f64 = f64::EPSILON / 2.0;

/// `a + b` rounded, and the exact error of that.
#[inline(always)]
fn two_sum<T: Scalar>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let from_b = sum - a;
    (sum, (a - (sum - from_b)) + (b - from_b))
}

impl<T: Fused> Bounded<T> {
    /// A number that is what it says.
    #[inline(always)]
    pub fn exact(value: T) -> Self {
        Self { high: value, low: value.zero(), error: value.zero() }
    }

    /// The number with its sign reversed.
    #[inline(always)]
    pub fn negative(self) -> Self {
        Self { high: -self.high, low: -self.low, error: self.error }
    }

    /// `self - m b`.
    #[inline(always)]
    pub fn minus_product(self, m: Self, b: Self) -> Self {
        let product = m.high * b.high;
        let rest = m.high.mul_add(b.high, -product); // exact
        let rest = m.low.mul_add(b.high, m.high.mul_add(b.low, rest));
        let (sum, sum_error) = two_sum(self.high, -product);
        let (high, low) = two_sum(sum, (self.low - rest) + sum_error);
        let (size_m, size_b) = (m.high.abs(), b.high.abs());
        // |(m + dm)(b + db) - m b| <= |m| |db| + (|b| + |db|) |dm|
        let carried = (size_b + b.error).mul_add(m.error, size_m.mul_add(b.error, self.error));
        let left_out = high.constant(LEFT_OUT);
        Self { high, low, error: (self.high.abs() + product.abs()).mul_add(left_out, carried) }
    }

    /// `self b`.
    #[inline(always)]
    pub fn times(self, b: Self) -> Self {
        Self::exact(self.high.zero()).minus_product(self.negative(), b)
    }

    /// `self / b`; zero where both are exactly zero, and of unlimited error where `b` may be zero otherwise.
    #[inline(always)]
    pub fn over(self, b: Self) -> Self {
        let zero = self.high.zero();
        let nothing = !(zero.less(self.high.abs() + self.error + b.high.abs() + b.error));
        let safe_b = T::select(nothing, zero.constant(1.0), b.high);
        let first = self.high / safe_b;
        let rest = self.minus_product(Self::exact(first), b);
        let (high, low) = two_sum(first, rest.high / safe_b);
        // |a / b - q| = |a - q b| / |b|, whatever q is.
        let quotient = Self { high, low, error: zero };
        let left = self.minus_product(quotient, b);
        let smallest = safe_b.abs().times(1.0 - 1e-9) - b.error;
        let error = (left.high.abs().times(2.0) + left.error) / smallest;
        let unlimited = zero.constant(f64::INFINITY);
        Self { high, low, error: T::select(zero.less(smallest), error, unlimited) }
    }

    /// Whether it is certainly above zero.
    #[inline(always)]
    pub fn is_positive(self) -> T::Mask {
        self.error.times(2.0).less(self.high)
    }

    /// Whether its leading part is smaller in magnitude than the other's.
    #[inline(always)]
    pub fn is_smaller(self, other: Self) -> T::Mask {
        self.high.abs().less(other.high.abs())
    }

    /// Both, exchanged where the mask holds.
    #[inline(always)]
    pub fn exchanged(mask: T::Mask, a: Self, b: Self) -> (Self, Self) {
        let pick = |x: Self, y: Self| Self {
            high: T::select(mask, x.high, y.high),
            low: T::select(mask, x.low, y.low),
            error: T::select(mask, x.error, y.error),
        };
        (pick(b, a), pick(a, b))
    }

    /// What it is taken for, and the bound of its error: for tests.
    pub fn parts(self) -> (T, T, T) {
        (self.high, self.low, self.error)
    }
}
