//! Roots by halving: to rounding by value; their slopes, for numbers that have one, follow from those of the residual.

use crate::Scalar;

/// What `residual` gives beside the residual at its root, the end of an interval between whose ends it changes sign, halved until
/// that is below rounding; with the slope of the root, for numbers that have one. The residual is worked out in one place, as it
/// is compiled into every vector's loop.
#[inline(always)]
pub(crate) fn bisect<S: Scalar, T>((low, high): (S, S), nothing: T, residual: impl Fn(S) -> (S, T)) -> T {
    let (mut low, mut high) = (low, high);
    let zero = low.zero();
    let (mut at_low, mut still, mut change, mut given) = (zero, zero, zero, nothing);
    for turn in 0..=LAST {
        if !S::HAS_SLOPE && (STILL..LAST).contains(&turn) {
            continue;
        }
        let x = match turn {
            0 => low,
            1..=HALVINGS => (low + high).times(0.5),
            STILL => high.still(),
            MOVING => high.moving(),
            _ => high,
        };
        let (left, beside) = residual(x);
        match turn {
            0 => at_low = left,
            1..=HALVINGS => {
                let same = zero.less(left * at_low);
                // An exact root is kept from below, so that a symmetric loader rests at zero.
                let exact = !zero.less(left.abs());
                low = S::select(same | exact, x, low);
                high = S::select(same, high, x);
            }
            STILL => still = left,
            MOVING => {
                change = left - still;
                high = high.still().root(still, change);
            }
            // What the change was short of digits, where the root moves by very different amounts with one thing and another.
            AGAIN => high = high.root(left, change),
            _ => given = beside,
        }
    }
    given
}

/// Halvings of an interval.
const HALVINGS: usize = 60;
/// After them, the residual's slopes: with a root that stands still, with one that moves, and with the root's own; then the rest.
const STILL: usize = HALVINGS + 1;
const MOVING: usize = HALVINGS + 2;
const AGAIN: usize = HALVINGS + 3;
const LAST: usize = HALVINGS + 4;
