//! Verdicts on releases: each quantity's difference from the reference, as a share of its tolerance in a rule.
//!
//! `P_n` cycles, `A_k` overshoots, `A_d` displacement: [`release`](crate::release) · a limit is `max(s (n + 1) |scale|, a)`, `s` the
//! tolerance's share, `n + 1` where it grows with the cycle, `a` its amount.
//!
//! Where the reference overshoots beyond the residual band, cycles and overshoots are compared, else the fall time or the rise time.

use crate::release::{COUNT, CROSSING, CROSSINGS, DISPLACEMENT, FEATURES, HIGH, LOW, OVERSHOOT, OVERSHOOTS, SETTLED};

/// Cycles that are compared.
const CYCLES: usize = CROSSINGS / 2 + 1;
/// Rounding, as a share of a tolerance, by which a difference may exceed its limit.
const ROUNDING: f64 = 1e-12;

/// What a tolerance is of, by its name in a rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "names of the rules")]
pub enum Quantity {
    P0,
    Pn,
    A1,
    An,
    FirstOvershoot,
    Overshoots,
    SteadyState,
    Ad,
    FallTime,
    RiseTime,
}

impl Quantity {
    /// All, with their names.
    pub const NAMES: [(&str, Self); 10] = [
        ("P0", Self::P0),
        ("Pn", Self::Pn),
        ("A1", Self::A1),
        ("An", Self::An),
        ("first overshoot", Self::FirstOvershoot),
        ("overshoots", Self::Overshoots),
        ("steady state", Self::SteadyState),
        ("Ad", Self::Ad),
        ("fall time", Self::FallTime),
        ("rise time", Self::RiseTime),
    ];
}

/// What a share is of, by its name in a rule: of the reference, the quantity itself, its first or its largest overshoot, its displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "names of the rules")]
pub enum Base {
    Itself,
    A1,
    Amax,
    Ad,
}

impl Base {
    /// All, with their names.
    pub const NAMES: [(&str, Self); 4] =
        [("itself", Self::Itself), ("A1", Self::A1), ("Amax", Self::Amax), ("Ad", Self::Ad)];
}

/// Numbers of a tolerance.
pub const TOLERANCE_NUMBERS: usize = 5;

/// The tolerance of a quantity.
#[derive(Debug, Clone, Copy)]
pub struct Tolerance {
    quantity: Quantity,
    base: Base,
    /// Not a number where there is none.
    share: f64,
    grows: bool,
    /// In SI units; not a number where there is none.
    amount: f64,
}

impl Tolerance {
    /// The tolerance of these numbers, if they are one: places in [`Quantity::NAMES`] and [`Base::NAMES`], the share, 1 where it grows,
    /// the amount; not a number where there is none.
    pub fn of(numbers: &[f64; TOLERANCE_NUMBERS]) -> Option<Self> {
        let &[quantity, base, share, grows, amount] = numbers;
        let (quantity, base) = (at(&Quantity::NAMES, quantity)?, at(&Base::NAMES, base)?);
        Some(Self { quantity, base, share, grows: grows != 0.0, amount })
    }

    fn limit(&self, scale: f64, n: usize) -> f64 {
        if self.share.is_nan() {
            return if self.amount.is_nan() { f64::INFINITY } else { self.amount };
        }
        // The larger of two; the share alone where there is no amount.
        (self.share * if self.grows { number(n + 1) } else { 1.0 } * scale.abs()).max(self.amount)
    }
}

/// The quantities by which a release can fail, in the order of evaluation.
pub fn names() -> Vec<String> {
    let cycles = (0..CYCLES).map(|n| format!("P{n}"));
    let overshoots = (1..=OVERSHOOTS).map(|k| format!("A{k}"));
    let rest = ["first overshoot", "overshoots", "steady state", "Ad", "fall time", "rise time"].map(str::to_string);
    ["not measured", "not settled"]
        .map(str::to_string)
        .into_iter()
        .chain(cycles)
        .chain(overshoots)
        .chain(rest)
        .collect()
}

const NOT_SETTLED: usize = 1;
const FIRST_CYCLE: usize = 2;
const FIRST_OVERSHOOT: usize = FIRST_CYCLE + CYCLES;
const OTHERS: usize = FIRST_OVERSHOOT + OVERSHOOTS;
const COMPARED: usize = OTHERS + 6;

/// The features of a release, and when it was let go and recorded to.
#[derive(Debug, Clone, Copy)]
pub struct Measured<'a> {
    /// Features: [`Release::values`](crate::release::Release::values).
    pub values: &'a [f64; FEATURES],
    /// In s.
    pub release_s: f64,
    /// In s.
    pub end_s: f64,
}

impl Measured<'_> {
    fn cycle(&self, n: usize) -> f64 {
        let before = if n == 0 { self.values[HIGH] } else { self.values[CROSSING + 2 * n - 2] };
        self.values[CROSSING + 2 * n] - before
    }

    fn overshoot(&self, k: usize) -> f64 {
        self.values[OVERSHOOT + k]
    }

    fn fall_time(&self) -> f64 {
        self.values[LOW] - self.values[HIGH]
    }

    fn is_measured(&self) -> bool {
        let displacement = self.values[DISPLACEMENT];
        displacement.is_finite() && displacement != 0.0
    }

    /// Whether it came to rest: in the residual band for so many fall times at its end.
    fn is_settled(&self, fall_times: f64) -> bool {
        self.is_measured() && self.end_s - self.values[SETTLED] >= fall_times * self.fall_time()
    }
}

/// The outcome of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReleaseVerdict {
    /// Place in [`names`] of the first quantity by which it fails.
    pub first_failing: Option<usize>,
    /// Whether both releases came to rest.
    pub evaluated: bool,
    /// `1 - max(difference / tolerance)`; not a number where it was not evaluated.
    pub margin: f64,
}

/// A test of releases.
#[derive(Debug, Clone)]
pub struct ReleaseTest {
    /// Its tolerances.
    pub tolerances: Vec<Tolerance>,
    /// Fall times for which a release at rest stays in the residual band.
    pub rests_fall_times: f64,
    /// Which time is compared where the reference has no overshoot.
    pub overdamped: Quantity,
}

impl ReleaseTest {
    /// The verdict on a release.
    pub fn judge(&self, actual: &Measured<'_>, reference: &Measured<'_>) -> ReleaseVerdict {
        let mut shares = [f64::NEG_INFINITY; COMPARED];
        for tolerance in &self.tolerances {
            self.compare(tolerance, actual, reference, &mut shares);
        }
        let evaluated = [actual, reference].iter().all(|release| release.is_settled(self.rests_fall_times));
        let beyond = |wrong: bool| if wrong { f64::INFINITY } else { f64::NEG_INFINITY };
        shares[0] = beyond(!(actual.is_measured() && reference.is_measured()));
        shares[NOT_SETTLED] = beyond(!evaluated);
        let largest = shares.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        ReleaseVerdict {
            first_failing: shares.iter().position(|&share| share > 1.0 + ROUNDING),
            evaluated,
            margin: if evaluated { 1.0 - largest } else { f64::NAN },
        }
    }

    /// Puts down the shares of a tolerance; minus infinity stays where nothing is compared, infinity is where a quantity is missing.
    fn compare(
        &self,
        tolerance: &Tolerance,
        actual: &Measured<'_>,
        reference: &Measured<'_>,
        shares: &mut [f64; COMPARED],
    ) {
        let count = reference.values[COUNT];
        let (swings, overshoots) = (count > 0.0, actual.values[COUNT] > 0.0);
        let share = |of: f64, expected: f64, n: usize| {
            let scale = match tolerance.base {
                Base::Itself => expected,
                Base::A1 => or_zero(reference.overshoot(0)),
                Base::Amax => (0..OVERSHOOTS).map(|k| or_zero(reference.overshoot(k))).fold(0.0, f64::max),
                Base::Ad => reference.values[DISPLACEMENT],
            };
            let share = (of - expected).abs() / tolerance.limit(scale, n);
            if share.is_nan() { f64::INFINITY } else { share }
        };
        let feature = |place: usize| share(actual.values[place], reference.values[place], 0);
        match tolerance.quantity {
            Quantity::P0 | Quantity::Pn => {
                let cycles = if tolerance.quantity == Quantity::P0 { 0..1 } else { 1..CYCLES };
                for n in cycles.filter(|&n| swings && count >= number(2 * n)) {
                    shares[FIRST_CYCLE + n] = share(actual.cycle(n), reference.cycle(n), n);
                }
            }
            Quantity::A1 | Quantity::An => {
                let first_apart = self.tolerances.iter().any(|other| other.quantity == Quantity::A1);
                let first = tolerance.quantity == Quantity::A1;
                for k in (0..OVERSHOOTS).filter(|&k| count > number(k) && (!first_apart || (k == 0) == first)) {
                    shares[FIRST_OVERSHOOT + k] = share(or_zero(actual.overshoot(k)), reference.overshoot(k), 0);
                }
            }
            Quantity::FirstOvershoot if swings && !overshoots => {
                shares[OTHERS] = f64::INFINITY;
            }
            Quantity::Overshoots => shares[OTHERS + 1] = feature(COUNT),
            Quantity::SteadyState => shares[OTHERS + 2] = feature(DISPLACEMENT),
            Quantity::Ad => shares[OTHERS + 3] = feature(DISPLACEMENT),
            Quantity::FallTime if !swings && self.overdamped == Quantity::FallTime => {
                shares[OTHERS + 4] = share(actual.fall_time(), reference.fall_time(), 0);
            }
            Quantity::RiseTime if !swings && self.overdamped == Quantity::RiseTime => {
                let rise = |release: &Measured<'_>| release.values[LOW] - release.release_s;
                shares[OTHERS + 5] = share(rise(actual), rise(reference), 0);
            }
            Quantity::FirstOvershoot | Quantity::FallTime | Quantity::RiseTime => {}
        }
    }
}

fn at<T: Copy>(names: &[(&str, T)], place: f64) -> Option<T> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "what is no place becomes one beyond")]
    names.get(if place >= 0.0 { place as usize } else { names.len() }).map(|(_, of)| *of)
}

fn or_zero(size: f64) -> f64 {
    if size.is_nan() { 0.0 } else { size }
}

#[expect(clippy::cast_precision_loss, reason = "a number of cycles or overshoots, far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
