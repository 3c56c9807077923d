//! The number type of the model.

use core::fmt::Debug;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// What the equations of the model ask of a number.
///
/// A number may stand for several runs at once, one in each lane; what depends on a comparison is therefore chosen with
/// [`Scalar::select`], lane by lane, and a constant is made from a number that is at hand, which knows how many lanes it has.
/// Only correctly rounded operations are asked for, so a run gives the same bits in whatever lane it stands.
pub trait Scalar:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The outcome of a comparison, lane by lane.
    type Mask: Copy + Debug + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask> + Not<Output = Self::Mask>;

    /// The constant `value` in the number type of `self`.
    fn constant(self, value: f64) -> Self;
    /// The square root; not a number below zero.
    fn sqrt(self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The nearest whole number; of two equally near, the even one.
    fn round(self) -> Self;
    /// The smaller of two.
    fn min(self, other: Self) -> Self;
    /// The larger of two.
    fn max(self, other: Self) -> Self;
    /// `self` with its sign reversed where that of `other` is negative.
    fn times_sign(self, other: Self) -> Self;
    /// Whether `self < other`.
    fn less(self, other: Self) -> Self::Mask;
    /// Whether the mask holds in any lane: what changes nothing elsewhere need then not be computed.
    fn any(mask: Self::Mask) -> bool;
    /// Whether it is a number, and finite.
    #[inline(always)]
    #[track_caller]
    fn is_number(self) -> Self::Mask {
        self.abs().less(self.constant(f64::INFINITY))
    }
    /// `yes` where the mask holds, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// `self by` for a slope: zero stays zero, however large the number beside it, since limits that are off are infinite.
    fn slope_times(self, by: Self) -> Self;
    /// `self / by` for a slope: zero stays zero, even over zero.
    fn slope_over(self, by: Self) -> Self;
    /// Whether it has a slope of its own, see [`Dual`](crate::dual::Dual). The next three change that slope and nothing else; a slope
    /// of the slope they do not carry.
    const HAS_SLOPE: bool = false;
    /// Whether it stands for several runs at once.
    const IN_LANES: bool = false;
    /// Whether what is large is compiled once for all places that ask for it. With a slope of its own a step is three times as long, and a
    /// number alone gains nothing where it is inlined; what runs in vector lanes must be.
    const COMPILED_ONCE: bool = Self::HAS_SLOPE && !Self::IN_LANES;
    /// The number without its slope.
    #[inline(always)]
    fn still(self) -> Self {
        self
    }
    /// The number with a slope beside which all others vanish.
    #[inline(always)]
    fn moving(self) -> Self {
        self
    }
    /// The number, a root of a residual by value, with a slope nearer to the root's: from the residual at it, and from the change of
    /// the residual from such a number that is still to one that is moving.
    #[inline(always)]
    fn root(self, _residual: Self, _change: Self) -> Self {
        self
    }

    /// Begins a part of a period that is done several times, with what it is given. A number that writes down its operations puts others in
    /// place of these, and so writes the part once.
    #[inline(always)]
    fn part_begins<const N: usize>(given: [Self; N]) -> [Self; N] {
        given
    }
    /// Ends a part, with what [`part_begins`](Self::part_begins) was given, and with what was found.
    #[inline(always)]
    fn part_ends<const N: usize, const M: usize>(_given: [Self; N], outputs: [Self; M]) -> [Self; M] {
        outputs
    }

    /// Begins a section of a period: what follows belongs to it, for a number that writes down its operations.
    #[inline(always)]
    fn section(_name: &'static str) {}
    /// The number under a name, for one that writes down its operations.
    #[inline(always)]
    fn named(self, _name: &'static str) -> Self {
        self
    }

    /// `self` times a constant.
    #[inline(always)]
    #[track_caller]
    fn times(self, factor: f64) -> Self {
        self * self.constant(factor)
    }
    /// Zero in the number type of `self`.
    #[inline(always)]
    #[track_caller]
    fn zero(self) -> Self {
        self.constant(0.0)
    }
    /// The nearest value within `low` and `high`.
    #[inline(always)]
    #[track_caller]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// The nearest value within `-limit` and `limit`.
    #[inline(always)]
    #[track_caller]
    fn within(self, limit: Self) -> Self {
        self.clamp(-limit, limit)
    }
    /// The sine, to rounding, of an angle within some turns of zero.
    #[inline(always)]
    fn sin(self) -> Self {
        // sin x = -+sin(x - n pi), then the series to x^21, whose next term is 1e-18 at pi / 2
        let turns = self.times(core::f64::consts::FRAC_1_PI).round();
        let x = self - turns.times(core::f64::consts::PI);
        let odd = turns - turns.times(0.5).round().times(2.0);
        let squared = x * x;
        let series = SINE.iter().rev().fold(x.zero(), |sum, &term| sum * squared + x.constant(term));
        let sine = x * series;
        Self::select(odd.abs().less(odd.constant(0.5)), sine, -sine)
    }
    /// `exp(-self)` for a number that is not negative; zero for infinity.
    #[inline(always)]
    fn decay(self) -> Self {
        // exp(-x) = exp(-x / 1024)^1024, the series to its 12th term; beyond 700 the result is no number of double precision
        let x = self.min(self.constant(700.0)).times(-1.0 / 1024.0);
        let mut sum = x.constant(1.0);
        for n in (1..=12).rev() {
            sum = x.constant(1.0) + (x * sum).times(1.0 / f64::from(n));
        }
        for _ in 0..10 {
            sum = sum * sum;
        }
        Self::select(self.less(self.constant(700.0)), sum, self.zero())
    }
    /// `self` rounded to a multiple of `step`; itself where the step is zero. `per_step` is one over it: a product takes a quarter of the
    /// time of a quotient, and rounds to the same multiple but for rounding at the middle between two.
    #[inline(always)]
    #[track_caller]
    fn quantized(self, [step, per_step]: [Self; 2]) -> Self {
        let stepped = self.zero().less(step);
        if Self::any(stepped) { Self::select(stepped, (self * per_step).round() * step, self) } else { self }
    }
}

/// `1, -1/3!, 1/5!, ...`: the series of the sine.
const SINE: [f64; 11] = {
    let mut terms = [1.0; 11];
    let (mut k, mut n) = (1, 2.0);
    while k < 11 {
        terms[k] = -terms[k - 1] / (n * (n + 1.0));
        (k, n) = (k + 1, n + 2.0);
    }
    terms
};

macro_rules! scalar {
    ($type:ty, $sqrt:path, $round:path, $constant:expr) => {
        impl Scalar for $type {
            type Mask = bool;
            #[inline(always)]
            fn constant(self, value: f64) -> Self {
                $constant(value)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$type>::abs(self)
            }
            #[inline(always)]
            fn round(self) -> Self {
                $round(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn times_sign(self, other: Self) -> Self {
                if other.is_sign_negative() { -self } else { self }
            }
            #[inline(always)]
            fn less(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn any(mask: bool) -> bool {
                mask
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn slope_times(self, by: Self) -> Self {
                if self == 0.0 { 0.0 } else { self * by }
            }
            #[inline(always)]
            fn slope_over(self, by: Self) -> Self {
                if self == 0.0 { 0.0 } else { self / by }
            }
        }
    };
}

scalar!(f64, libm::sqrt, libm::rint, |value| value);
#[expect(clippy::cast_possible_truncation, reason = "rounding to single precision is what is asked")]
const _: () = {
    scalar!(f32, libm::sqrtf, libm::rintf, |value| value as f32);
};
