//! Features of a control that is let go: what the dynamic checks of the qualification rules compare.
//!
//! `x` position · `s` steady state, its mean over the tail · `x_0` where it was held · `A_d = x_0 - s` · `y = (x - s) / A_d`, 1 while held
//!
//! The control passes `y = 0.9`, `0.1` and then zero at `c_0, c_1, ...`; `A_k` is how far it goes between `c_{k-1}` and `c_k`.
//! A period of the rules is `P_0 = c_0 - t_{0.9}` and then the full cycles `P_n = c_{2n} - c_{2n-2}`, one after another.
//! A steady state that is known beforehand takes the place of the mean.
//! Instants and extrema are those of a polynomial through the samples around them ([`local_fit`](crate::local_fit)).

use crate::local_fit::{Instant, LocalFit};
use crate::threads::{NoThreads, each};

/// Releases that a thread takes at a time.
const PIECE: usize = 16;

/// Full cycles that are kept.
pub const CYCLES: usize = 8;
/// Zero crossings that are kept.
pub const CROSSINGS: usize = 2 * CYCLES + 1;
/// Overshoots that are kept.
pub const OVERSHOOTS: usize = 2 * CYCLES;
/// Samples around an instant that its polynomial goes through at least, on each side.
const AROUND: usize = 3;
/// Share of the residual band below which an overshoot is the last that is looked at.
const FADED: f64 = 0.5;
/// Samples that are looked at in one go.
const CHUNK: usize = 16;

const STEADY: usize = 0;
pub(crate) const DISPLACEMENT: usize = 1;
const TAIL_DEVIATION: usize = 2;
pub(crate) const SETTLED: usize = 3;
pub(crate) const HIGH: usize = 4;
pub(crate) const LOW: usize = 5;
pub(crate) const COUNT: usize = 6;
pub(crate) const CROSSING: usize = 7;
pub(crate) const OVERSHOOT: usize = CROSSING + CROSSINGS;
const OVERSHOOT_TIME: usize = OVERSHOOT + OVERSHOOTS;
/// Features of a release.
pub const FEATURES: usize = OVERSHOOT_TIME + OVERSHOOTS;

/// Name, number of columns and quantity (`x`: as the position, `s`, or none) of each group of features, in order.
pub const FEATURE_GROUPS: &[(&str, usize, &str)] = &[
    ("steady", 1, "x"),
    ("displacement", 1, "x"),
    ("tail_deviation", 1, "x"),
    ("settled", 1, "s"),
    ("high", 1, "s"),
    ("low", 1, "s"),
    ("count", 1, ""),
    ("crossings", CROSSINGS, "s"),
    ("overshoots", OVERSHOOTS, "x"),
    ("overshoot_times", OVERSHOOTS, "s"),
];

/// How releases are measured.
#[derive(Debug, Clone, Copy)]
pub struct Measuring<'a> {
    /// Time of the samples in s, rising.
    pub time: &'a [f64],
    /// Samples at the start in which the control is held; from the last of them on it is free.
    pub held: usize,
    /// First sample that a polynomial may go through.
    pub free: usize,
    /// Samples at the end over which the steady state is the mean.
    pub tail: usize,
    /// Residual band, as a share of `A_d`.
    pub band: f64,
    /// Shares of `A_d` between which the way back is timed.
    pub high: f64,
    /// The lower one.
    pub low: f64,
    /// Polynomials go through all samples closer than this, in s; through six at least.
    pub reach: f64,
    /// The control has passed zero when it is so far beyond.
    pub hysteresis: f64,
}

/// Features of one release; not a number where there is none.
#[derive(Debug, Clone, Copy)]
pub struct Release {
    /// The features in the order of [`FEATURE_GROUPS`].
    pub values: [f64; FEATURES],
    /// Of each instant the slope of the position there; not a number otherwise.
    pub slopes: [f64; FEATURES],
    /// Of each instant and extremum the deviation of the position there under white noise of deviation one.
    pub noise: [f64; FEATURES],
    /// Of each instant and extremum what a simpler polynomial would leave out of the position.
    pub last_terms: [f64; FEATURES],
}

/// The mean of full cycles in a row.
#[derive(Debug, Clone, Copy)]
pub struct Period {
    /// In s.
    pub mean: f64,
    /// Its standard uncertainty in s.
    pub uncertainty: f64,
    /// How many cycles.
    pub cycles: usize,
}

impl Release {
    const NONE: Self = Self {
        values: [f64::NAN; FEATURES],
        slopes: [f64::NAN; FEATURES],
        noise: [f64::NAN; FEATURES],
        last_terms: [f64::NAN; FEATURES],
    };

    /// The mean full cycle from the first crossing on, `(c_{2n} - c_0) / n`; none where the control does not cross so often, or has no
    /// one period: friction and springs that are not straight stretch a cycle more than the next, and move crossings where they
    /// leave extrema. First cycle, mean and extrema differ by `within` of the mean at most.
    ///
    /// An instant is known to `noise / |x'|`, so that each further cycle shares what the first crossing is off by, and ends at a
    /// slower crossing: `n` is where the mean is known best.
    pub fn period(&self, noise: f64, within: f64) -> Option<Period> {
        let off = |k: usize| if noise == 0.0 { 0.0 } else { noise / self.slopes[CROSSING + k].abs() };
        let lasted = |from: usize, to: usize| self.values[to] - self.values[from];
        let first = lasted(CROSSING, CROSSING + 2);
        let cycles = (1..=CYCLES).filter_map(|cycles| {
            let mean = lasted(CROSSING, CROSSING + 2 * cycles) / number(cycles);
            let last = OVERSHOOT_TIME + 2 * cycles - 1;
            // The first extremum is the one that what fades within the first swing moves most.
            let by_extrema = match cycles {
                1 => 2.0 * lasted(OVERSHOOT_TIME, last),
                _ => lasted(OVERSHOOT_TIME + 1, last) / number(cycles - 1),
            };
            let uncertainty = off(0).hypot(off(2 * cycles)) / number(cycles);
            let one = [first, by_extrema].iter().all(|other| (other - mean).abs() <= within * mean);
            (one && uncertainty.is_finite()).then_some(Period { mean, uncertainty, cycles })
        });
        cycles.min_by(|one, other| one.uncertainty.total_cmp(&other.uncertainty).then(other.cycles.cmp(&one.cycles)))
    }

    /// Sizes and instants of the overshoots beyond the steady state, away from where it was held, one after another.
    pub fn overshoots_beyond(&self) -> impl Iterator<Item = (f64, f64)> {
        let (sizes, times) = (&self.values[OVERSHOOT..OVERSHOOT_TIME], &self.values[OVERSHOOT_TIME..]);
        sizes.iter().copied().zip(times.iter().copied()).step_by(2).take_while(|(size, _)| size.is_finite())
    }

    fn put(&mut self, column: usize, value: f64, instant: &Instant) {
        self.values[column] = value;
        self.slopes[column] = instant.slope;
        self.noise[column] = instant.noise;
        self.last_terms[column] = instant.last_term;
    }
}

impl Measuring<'_> {
    /// The features of one release; none of them if a sample is not a finite number or the control does not move.
    ///
    /// # Panics
    /// If there are not as many positions as times.
    pub fn measure(&self, position: &[f64]) -> Release {
        if !self.is_record(position) {
            return Release::NONE;
        }
        let tail = &position[position.len() - self.tail.max(1)..];
        let steady = mean(tail);
        let mut release = self.with_steady(position, steady);
        release.values[TAIL_DEVIATION] = tail.iter().fold(0.0, |most, x| f64::max(most, (x - steady).abs()));
        release
    }

    /// The same around a steady state that is known, which the control need not reach within the record; the tail's deviation is
    /// not a number.
    ///
    /// # Panics
    /// If there are not as many positions as times.
    pub fn measure_around(&self, position: &[f64], steady: f64) -> Release {
        if self.is_record(position) { self.with_steady(position, steady) } else { Release::NONE }
    }

    fn is_record(&self, position: &[f64]) -> bool {
        assert_eq!(position.len(), self.time.len(), "a position for each time");
        all_finite(position) && position.len() >= self.held.max(1) + self.tail.max(2 * AROUND)
    }

    fn with_steady(&self, position: &[f64], steady: f64) -> Release {
        let mut release = Release::NONE;
        let displacement = mean(&position[..self.held.max(1)]) - steady;
        release.values[STEADY] = steady;
        release.values[DISPLACEMENT] = displacement;
        if displacement != 0.0 {
            self.settling(&mut release, position);
            self.swings(&mut release, position);
        }
        release
    }

    /// The features of many releases, `FEATURES` numbers each, of one after another in `positions`.
    ///
    /// # Errors
    /// If the system gives no threads.
    ///
    /// # Panics
    /// If the sizes do not fit.
    pub fn measure_all(&self, positions: &[f64], threads: usize) -> Result<Vec<f64>, NoThreads> {
        let samples = self.time.len();
        assert_eq!(positions.len() % samples, 0, "a position for each time");
        let mut features = vec![f64::NAN; positions.len() / samples * FEATURES];
        let pieces = features.chunks_mut(PIECE * FEATURES).zip(positions.chunks(PIECE * samples));
        each(threads, pieces, |(features, positions)| {
            for (features, position) in features.chunks_exact_mut(FEATURES).zip(positions.chunks_exact(samples)) {
                features.copy_from_slice(&self.measure(position).values);
            }
        })?;
        Ok(features)
    }

    /// From when on the control stays in the residual band.
    fn settling(&self, release: &mut Release, position: &[f64]) {
        let (steady, band) = (release.values[STEADY], self.band * release.values[DISPLACEMENT].abs());
        let last = last_outside(position, steady, band);
        release.values[SETTLED] = match last {
            None => self.time[0],
            Some(k) if k + 1 == position.len() => f64::NAN,
            Some(k) => {
                let edge = steady + band.copysign(position[k] - steady);
                let share = (position[k] - edge) / (position[k] - position[k + 1]);
                self.time[k] + share * (self.time[k + 1] - self.time[k])
            }
        };
    }

    /// The way back, and the swings around the steady state.
    fn swings(&self, release: &mut Release, position: &[f64]) {
        let (steady, displacement) = (release.values[STEADY], release.values[DISPLACEMENT]);
        let from = self.held.max(1);
        for (column, share) in [(HIGH, self.high), (LOW, self.low)] {
            let level = steady + share * displacement;
            if let Some((before, _)) = passing(position, from, level, -displacement.signum(), 0.0) {
                self.put_crossing(release, column, position, before, level);
            }
        }
        let mut towards = -displacement.signum();
        let Some((before, mut seen)) = passing(position, from, steady, towards, self.hysteresis) else {
            release.values[COUNT] = 0.0;
            return;
        };
        self.put_crossing(release, CROSSING, position, before, steady);
        let (mut began, mut count) = (before, 0.0);
        let band = self.band * displacement.abs();
        for k in 0.. {
            let next = passing(position, seen, steady, -towards, self.hysteresis);
            let ends = next.map_or(position.len() - 1, |(before, _)| before);
            let size = self.overshoot(release, k, position, (began + 1, ends), towards);
            if size > band {
                count += 1.0;
            }
            let Some((before, beyond)) = next else { break };
            if k + 1 < CROSSINGS {
                self.put_crossing(release, CROSSING + k + 1, position, before, steady);
            }
            if size < FADED * band {
                break;
            }
            (began, seen, towards) = (before, beyond, -towards);
        }
        release.values[COUNT] = count;
    }

    /// How far the control goes among these samples; kept if it is one of the first overshoots.
    fn overshoot(
        &self,
        release: &mut Release,
        k: usize,
        position: &[f64],
        (from, to): (usize, usize),
        towards: f64,
    ) -> f64 {
        let steady = release.values[STEADY];
        let top = farthest(&position[from..=to.max(from)], towards) + from;
        let at = self.time[top];
        let fit = self.fit(position, top.saturating_sub(1), top);
        let extremum =
            fit.as_ref().and_then(|fit| fit.extremum(at)).filter(|it| (it.time - at).abs() <= self.near(top));
        let size = extremum.map_or(position[top] - steady, |it| it.value - steady) * towards;
        if k < OVERSHOOTS {
            release.values[OVERSHOOT + k] = size;
            release.values[OVERSHOOT_TIME + k] = at;
            if let Some(it) = extremum {
                release.put(OVERSHOOT + k, size, &it);
                release.put(OVERSHOOT_TIME + k, it.time, &it);
            }
        }
        size
    }

    /// Puts down when the position passes `level` between the sample `before` and the next.
    fn put_crossing(&self, release: &mut Release, column: usize, position: &[f64], before: usize, level: f64) {
        let (t, x) = ([self.time[before], self.time[before + 1]], [position[before], position[before + 1]]);
        let straight = t[0] + (level - x[0]) / (x[1] - x[0]) * (t[1] - t[0]);
        release.values[column] = straight;
        let fit = self.fit(position, before, before + 1);
        if let Some(it) = fit.and_then(|fit| fit.crossing(level, straight))
            && (it.time - straight).abs() <= self.near(before)
        {
            release.put(column, it.time, &it);
        }
    }

    /// How far from a sample what is sought there may lie.
    fn near(&self, sample: usize) -> f64 {
        let after = (sample + 2).min(self.time.len() - 1);
        (self.time[after] - self.time[after - 2]).max(self.reach)
    }

    /// The polynomial around two neighboring samples, or one.
    fn fit(&self, position: &[f64], left: usize, right: usize) -> Option<LocalFit> {
        let (begin, end) = (self.time[left] - self.reach, self.time[right] + self.reach);
        let least = self.free.min(left + 1);
        let mut from = (left + 1).saturating_sub(AROUND).max(least);
        let mut to = (right + AROUND).max(from + 2 * AROUND).min(position.len());
        while from > least && self.time[from - 1] >= begin {
            from -= 1;
        }
        while to < position.len() && self.time[to] <= end {
            to += 1;
        }
        (to - from >= 2).then(|| LocalFit::new(&self.time[from..to], &position[from..to]))
    }
}

/// The last sample before the position passes `level` towards that side and the first that is more than `beyond` past it.
fn passing(position: &[f64], from: usize, level: f64, towards: f64, beyond: f64) -> Option<(usize, usize)> {
    let limit = level * towards + beyond;
    let past = from + first_above(position.get(from..)?, towards, limit)?;
    let before = (0..past).rev().find(|&k| position[k] * towards <= level * towards)?;
    Some((before, past))
}

/// The first sample of which `x sign > limit`.
fn first_above(x: &[f64], sign: f64, limit: f64) -> Option<usize> {
    let mut chunks = x.chunks_exact(CHUNK);
    let mut at = 0;
    for chunk in &mut chunks {
        if chunk.iter().filter(|&x| x * sign > limit).count() > 0 {
            break;
        }
        at += CHUNK;
    }
    x[at..].iter().position(|x| x * sign > limit).map(|k| at + k)
}

/// The last sample farther than `band` from `steady`.
fn last_outside(x: &[f64], steady: f64, band: f64) -> Option<usize> {
    let mut end = x.len();
    for chunk in x.rchunks_exact(CHUNK) {
        if chunk.iter().filter(|&x| (x - steady).abs() > band).count() > 0 {
            break;
        }
        end -= CHUNK;
    }
    x[..end].iter().rposition(|x| (x - steady).abs() > band)
}

/// The first of the samples that lie farthest towards that side.
fn farthest(x: &[f64], towards: f64) -> usize {
    let mut most = [f64::NEG_INFINITY; CHUNK];
    let chunks = x.chunks_exact(CHUNK);
    let rest = chunks.remainder().iter().fold(f64::NEG_INFINITY, |most, x| most.max(x * towards));
    for chunk in chunks {
        for (most, x) in most.iter_mut().zip(chunk) {
            let x = x * towards;
            *most = if x > *most { x } else { *most };
        }
    }
    let most = most.iter().fold(rest, |one, other| one.max(*other));
    x.iter().position(|x| x * towards >= most).unwrap_or(0)
}

fn all_finite(x: &[f64]) -> bool {
    let mut sums = [0.0; CHUNK];
    let chunks = x.chunks_exact(CHUNK);
    let rest = chunks.remainder().iter().all(|x| x.is_finite());
    for chunk in chunks {
        // Zero times what is not a finite number is not a number, and stays in the sum.
        for (sum, x) in sums.iter_mut().zip(chunk) {
            *sum += x * 0.0;
        }
    }
    rest && sums.iter().all(|sum| *sum == 0.0)
}

fn mean(x: &[f64]) -> f64 {
    // From the first sample on: what all samples have in common is no sum's rounding.
    x[0] + x.iter().fold(0.0, |sum, value| sum + (value - x[0])) / number(x.len())
}

#[expect(clippy::cast_precision_loss, reason = "a number of samples or cycles, far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
