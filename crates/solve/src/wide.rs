//! Numbers that stand for several runs: how they are made and taken apart, and what linear algebra asks of them.
//!
//! The step of a run does without fused operations, so that its bits are those of plain double precision. Matrices and
//! certified signs want them: one rounding where there would be two, and the exact error of a product. Each is rounded once on
//! every machine, so the bits are the same in whatever lane, and in plain `f64` where a machine has no vectors.

use crate::lanes::{EXPONENT, FOUR_LANES, FourLanes, LANES, Lanes};
use fearless_simd::Simd;
use forcefeel_model::Scalar;

/// A number that stands for several runs.
pub trait Wide: Scalar {
    /// What it takes to make one.
    type Token: Copy;
    /// How many runs.
    const RUNS: usize;
    /// Run `k`'s number is `of(k)`.
    fn gather(token: Self::Token, of: impl Fn(usize) -> f64) -> Self;
    /// Hands over each run's number.
    fn scatter(self, to: impl FnMut(usize, f64));
}

impl Wide for f64 {
    type Token = ();
    const RUNS: usize = 1;
    #[inline(always)]
    fn gather((): (), of: impl Fn(usize) -> f64) -> Self {
        of(0)
    }
    #[inline(always)]
    fn scatter(self, mut to: impl FnMut(usize, f64)) {
        to(0, self);
    }
}

macro_rules! wide {
    ($Lanes:ident, $COUNT:ident, [$($lane:literal),+]) => {
        impl<S: Simd> Wide for $Lanes<S> {
            type Token = S;
            const RUNS: usize = $COUNT;
            #[inline(always)]
            fn gather(simd: S, of: impl Fn(usize) -> f64) -> Self {
                // No loop, which is not sure to be compiled into the lanes' own.
                Self::new(simd, [$( of($lane) ),+])
            }
            #[inline(always)]
            fn scatter(self, mut to: impl FnMut(usize, f64)) {
                for (lane, value) in self.values().into_iter().enumerate() {
                    to(lane, value);
                }
            }
        }
    };
}

wide!(Lanes, LANES, [0, 1, 2, 3, 4, 5, 6, 7]);
wide!(FourLanes, FOUR_LANES, [0, 1, 2, 3]);

/// A number that stands for several runs, with what linear algebra in lanes asks for: operations that are rounded once, powers of two, and
/// transposition.
pub trait Fused: Wide {
    /// `self factor + term`, rounded once.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// The largest power of two that is not above the magnitude; of zero, zero; of what is not finite, infinity.
    fn power_of_two(self) -> Self;
    /// A number for each lane, from these places.
    fn picked(token: Self::Token, numbers: &[f64], places: &[usize; LANES]) -> Self;
    /// Hands over, run by run, eight numbers in a row.
    fn by_run(block: [Self; LANES], to: impl FnMut(usize, &[f64; LANES]));
}

impl Fused for f64 {
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        f64::mul_add(self, factor, term)
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        f64::from_bits(self.to_bits() & EXPONENT)
    }
    #[inline(always)]
    fn picked((): (), numbers: &[f64], places: &[usize; LANES]) -> Self {
        numbers[places[0]]
    }
    #[inline(always)]
    fn by_run(block: [Self; LANES], mut to: impl FnMut(usize, &[f64; LANES])) {
        to(0, &block);
    }
}

impl<S: Simd> Fused for Lanes<S> {
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.fused(factor, term)
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        self.exponent()
    }
    #[inline(always)]
    fn picked(simd: S, numbers: &[f64], &[a, b, c, d, e, f, g, h]: &[usize; LANES]) -> Self {
        let of = [numbers[a], numbers[b], numbers[c], numbers[d], numbers[e], numbers[f], numbers[g], numbers[h]];
        Self::new(simd, of)
    }
    #[inline(always)]
    fn by_run(block: [Self; LANES], mut to: impl FnMut(usize, &[f64; LANES])) {
        let [a, b, c, d, e, f, g, h] = block;
        // Three perfect shuffles transpose eight by eight.
        let ((a, b), (c, d), (e, f), (g, h)) = (a.zip(e), b.zip(f), c.zip(g), d.zip(h));
        let ((a, b), (c, d), (e, f), (g, h)) = (a.zip(e), b.zip(f), c.zip(g), d.zip(h));
        let ((a, b), (c, d), (e, f), (g, h)) = (a.zip(e), b.zip(f), c.zip(g), d.zip(h));
        to(0, &a.values());
        to(1, &b.values());
        to(2, &c.values());
        to(3, &d.values());
        to(4, &e.values());
        to(5, &f.values());
        to(6, &g.values());
        to(7, &h.values());
    }
}
