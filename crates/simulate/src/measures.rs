//! What is asked of a run in place of its whole history.
//!
//! `theta` column angle, `theta_0` at the start, `theta_e` where the last force holds it, dry friction aside · `H = theta_e - theta_0`
//! the way · `P = max |theta - theta_0|` the largest excursion · `sigma` what the sensors' noise moves the column by, r.m.s.
//!
//! Overshoot and period are those of a release around `theta_e` ([`release`](forcefeel_solve::release)), and not numbers where the
//! run does not tell them:
//!
//! | the column | no number |
//! |---|---|
//! | ends where it began, `|H| <= 0.05 P`, or hardly moves, `P <= 0.05 |H|` | both |
//! | met a stop, of its own or a programmed one | both |
//! | still moves when the run ends and has not passed `theta_e`, or not turned beyond it | overshoot |
//! | has not passed `theta_e` three times, or friction stretches its swings: they differ by more than [`KNOWN`] | period |
//! | moves so little that noise may put the number off by more than [`KNOWN`] | that one |
//!
//! It has settled when it stays within 5 % of `H` around `theta_e`, or around where dry friction holds it farther off; of `P` if it
//! ends where it began.

use forcefeel_model::Scalar;
use forcefeel_model::parameters::{DriveKind, Parameters};
use forcefeel_solve::release::Measuring;
use forcefeel_solve::wide::Wide;

/// Share of the run at its end over which the final angle is the mean, and the last swing is taken.
const TAIL: usize = 10;
/// Share of `|H|` within which the column counts as settled: the residual band of the qualification rules. Of `P`, within which
/// the column counts as back where it began.
pub const BAND: f64 = 0.05;
/// Share of the largest angle that is an excursion at least: a mean differs by rounding from what it is the mean of.
const ROUNDING: f64 = 1e-10;
/// Share of a number within which noise leaves it, or there is none; of an overshoot within the band, the share of the band, and of
/// one that is zero, the share of the way.
pub const KNOWN: f64 = 0.01;
/// Standard deviations of the noise beyond a level at which the column has passed it.
const PASSED: f64 = 4.0;
/// Standard deviations within which noise leaves a number.
const COVERAGE: f64 = 2.0;
/// Share of `|H|` by which a column at rest moves at most over the last tenth of the run.
const AT_REST: f64 = 1e-3;
/// Share of its distance from the equilibrium by which a column moves at most over the last tenth if dry friction holds it there.
const HELD: f64 = 0.01;
/// Share of a programmed stop from which on it is reached, but for rounding.
const REACHED: f64 = 1e-6;

/// The measures of a loader with this drive: what of the drive a run tells the peaks of has names of its own.
pub fn measures(kind: DriveKind) -> Vec<(&'static str, &'static str)> {
    let named = |&(name, unit): &(&'static str, &'static str)| match (kind, name) {
        (DriveKind::Electric, "peak_pressure") => ("peak_voltage", "V"),
        (DriveKind::Electric, "peak_flow") => ("peak_speed", "rad/s"),
        _ => (name, unit),
    };
    MEASURES.iter().map(named).collect()
}

macro_rules! measures {
    ($( $( #[doc = $doc:literal] )+ $name:ident: $unit:literal; )*) => {
        /// The measures of one run, or of one in each lane.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Measures<S> { $( $( #[doc = $doc] )+ pub $name: S, )* }

        /// Name and SI unit of each measure, in order.
        pub const MEASURES: &[(&str, &str)] = &[ $( (stringify!($name), $unit), )* ];

        impl<S: Copy> Measures<S> {
            /// The values in the order of [`MEASURES`].
            pub fn values(&self) -> [S; MEASURES.len()] {
                [ $( self.$name, )* ]
            }
        }
    };
}

measures! {
    /// Largest column angle.
    maximum_angle: "rad";
    /// When it was reached.
    time_of_maximum: "s";
    /// Smallest column angle.
    minimum_angle: "rad";
    /// When it was reached.
    time_of_minimum: "s";
    /// Mean column angle over the last tenth of the run.
    final_angle: "rad";
    /// Where the last force holds the column, dry friction aside; not a number where nothing does.
    equilibrium_angle: "rad";
    /// How far the column went beyond the equilibrium, as a share of the way to it; not a number where the run does not tell.
    overshoot: "";
    /// Time after which the column stayed around the equilibrium, within 5 % of the way, or of the largest excursion if it
    /// came back; not a number if it does not in the end.
    settling_time: "s";
    /// Mean time from one pass of the equilibrium to the next to the same side; not a number where the run does not tell.
    period: "s";
    /// How many periods that is the mean of; not a number without one.
    periods: "";
    /// Swing, from lowest to highest, over the last tenth of the run.
    last_swing: "rad";
    /// Largest magnitude of the current of valve or motor.
    peak_current: "A";
    /// Largest magnitude of the load pressure; of a motor's voltage.
    peak_pressure: "Pa";
    /// Largest magnitude of the flow; of a motor's speed.
    peak_flow: "m^3/s";
    /// When the run left every bound; infinite if it did not.
    diverged_at: "s";
}

/// Largest magnitudes on the way, whether a stop was met, and when a run left every bound.
#[derive(Debug, Clone, Copy)]
pub struct Peaks<S> {
    /// Valve current in A.
    pub current: S,
    /// Load pressure in Pa.
    pub pressure: S,
    /// Flow in m³/s.
    pub flow: S,
    /// When the column angle left [`BOUND_RAD`], in s.
    pub diverged_at: S,
    /// 1 once the column or the programmed control has met a stop, 0 before.
    met_stop: S,
    /// Lowest and highest angle that the column and the programmed control are left.
    stops: [[S; 2]; 2],
}

/// A column that turns so far has no model.
pub const BOUND_RAD: f64 = 10.0;
/// How many times as far the programmed angle may go: a servo that is held back leaves it far ahead.
const PROGRAMMED: f64 = 100.0;

impl<S: Scalar> Peaks<S> {
    /// Nothing seen yet.
    #[inline(always)]
    pub fn new(like: S) -> Self {
        let (zero, none) = (like.zero(), like.constant(f64::INFINITY));
        let stops = [[-none, none]; 2];
        Self { current: zero, pressure: zero, flow: zero, diverged_at: none, met_stop: zero, stops }
    }

    /// With the stops of a loader.
    #[inline(always)]
    pub fn with_stops(self, &Parameters { column, feel, .. }: &Parameters<S>) -> Self {
        let inside = |bound: S, side: f64| {
            let none = bound.constant(f64::INFINITY);
            S::select(bound.abs().less(none), bound - bound.abs().times(side * REACHED), bound)
        };
        let programmed = [inside(feel.hard_stop_low, -1.0), inside(feel.hard_stop_high, 1.0)];
        Self { stops: [[column.stop_low, column.stop_high], programmed], ..self }
    }

    /// Takes one instant along: column angle and programmed angle in rad, current, pressure and flow.
    #[inline(always)]
    pub fn see(&mut self, angle: S, programmed: S, [current, pressure, flow]: [S; 3], time: f64) {
        self.current = self.current.max(current.abs());
        self.pressure = self.pressure.max(pressure.abs());
        self.flow = self.flow.max(flow.abs());
        // What is no number is not within; a stuck column keeps its angle, so the pressure is asked too.
        // Behind end stops the programmed angle may run away by itself.
        let bound = angle.constant(BOUND_RAD);
        let within = angle.abs().less(bound)
            & programmed.abs().less(bound.times(PROGRAMMED))
            & pressure.abs().less(angle.constant(f64::INFINITY));
        let now = angle.constant(time).min(self.diverged_at);
        self.diverged_at = S::select(within, self.diverged_at, now);
        let [[low, high], [programmed_low, programmed_high]] = self.stops;
        let met =
            angle.less(low) | high.less(angle) | programmed.less(programmed_low) | programmed_high.less(programmed);
        self.met_stop = S::select(met, angle.constant(1.0), self.met_stop);
    }
}

/// How the samples of a run were taken.
#[derive(Debug, Clone, Copy)]
pub struct Samples {
    /// Time between two, in s.
    pub dt: f64,
    /// The first from which on the column is free.
    pub free: usize,
    /// Sigma, in rad.
    pub noise: f64,
}

/// The measures of sampled column angles; at least two samples. `rest` gives the angle at which a lane's last force holds its column,
/// from the mean over the last tenth of its run.
#[inline(always)]
pub fn measure<S: Wide>(
    token: S::Token,
    angle: &[S],
    samples: &Samples,
    peaks: &Peaks<S>,
    rest: impl Fn(usize, f64) -> f64,
) -> Measures<S> {
    let first = angle[0];
    let tail = &angle[angle.len() - (angle.len() / TAIL).max(1)..];
    let (mut lowest, mut highest, mut sum) = (tail[0], tail[0], first.zero());
    for &theta in tail {
        (lowest, highest, sum) = (lowest.min(theta), highest.max(theta), sum + theta);
    }
    let end = sum.times(1.0 / number(tail.len()));
    let mut top = (first, first.zero());
    let mut bottom = (first, first.zero());
    for (k, &theta) in angle.iter().enumerate() {
        let time = first.constant(number(k) * samples.dt);
        let (higher, lower) = (top.0.less(theta), theta.less(bottom.0));
        top = (top.0.max(theta), S::select(higher, time, top.1));
        bottom = (bottom.0.min(theta), S::select(lower, time, bottom.1));
    }
    let of_lanes = |value: S| {
        let mut lanes = vec![0.0; S::RUNS];
        value.scatter(|lane, value| lanes[lane] = value);
        lanes
    };
    let ends = of_lanes(end);
    let equilibrium = S::gather(token, |lane| rest(lane, ends[lane]));
    let to = S::select(equilibrium.abs().less(first.constant(f64::INFINITY)), equilibrium, end);
    let way = to - first;
    let largest = top.0.max(-bottom.0);
    let excursion = (top.0 - first).max(first - bottom.0).max(largest.times(ROUNDING));
    let went = excursion.times(BAND).less(way.abs()) & way.abs().times(BAND).less(excursion);
    let band = S::select(went, way.abs(), excursion).times(BAND);
    // Near the top of a swing a column all but stands too.
    let held = band.less((end - to).abs()) & (highest - lowest).less((end - to).abs().times(HELD));
    let center = S::select(held, end, to);
    let mut settled = first.zero();
    for (k, &theta) in angle.iter().enumerate() {
        let time = first.constant(number(k) * samples.dt);
        settled = S::select(band.less((theta - center).abs()), time, settled);
    }
    let outside = band.less((angle[angle.len() - 1] - center).abs());
    let none = first.constant(f64::NAN);
    let swing = highest - lowest;
    let (went, met, equilibria, swings) = (
        of_lanes(S::select(went, none.constant(1.0), none.zero())),
        of_lanes(peaks.met_stop),
        of_lanes(equilibrium),
        of_lanes(swing),
    );
    let mut of_lane = vec![Swings::NONE; S::RUNS];
    let is_measured = |lane: usize| went[lane] > 0.0 && met[lane] == 0.0 && equilibria[lane].is_finite();
    if (0..S::RUNS).any(is_measured) {
        let time: Vec<f64> = (0..angle.len()).map(|k| number(k) * samples.dt).collect();
        let mut positions = vec![0.0; S::RUNS * angle.len()];
        for (k, theta) in angle.iter().enumerate() {
            theta.scatter(|lane, value| positions[lane * angle.len() + k] = value);
        }
        for (lane, position) in positions.chunks_exact(angle.len()).enumerate().filter(|&(lane, _)| is_measured(lane)) {
            of_lane[lane] = Swings::of(&time, position, samples, (equilibria[lane], swings[lane]));
        }
    }
    let each = |of: fn(&Swings) -> f64| S::gather(token, |lane| of(&of_lane[lane]));
    Measures {
        maximum_angle: top.0,
        time_of_maximum: top.1,
        minimum_angle: bottom.0,
        time_of_minimum: bottom.1,
        final_angle: end,
        equilibrium_angle: equilibrium,
        overshoot: each(|it| it.overshoot),
        settling_time: S::select(outside, none, settled),
        period: each(|it| it.period),
        periods: each(|it| it.periods),
        last_swing: swing,
        peak_current: peaks.current,
        peak_pressure: peaks.pressure,
        peak_flow: peaks.flow,
        diverged_at: peaks.diverged_at,
    }
}

/// What a column that goes from one place to another does around where it goes.
#[derive(Debug, Clone, Copy)]
struct Swings {
    overshoot: f64,
    period: f64,
    periods: f64,
}

impl Swings {
    const NONE: Self = Self { overshoot: f64::NAN, period: f64::NAN, periods: f64::NAN };

    /// Of a column that ends around `rest` and moves by `last_swing` over the last tenth of the run.
    fn of(time: &[f64], position: &[f64], samples: &Samples, (rest, last_swing): (f64, f64)) -> Self {
        let noise = samples.noise;
        let measuring = Measuring {
            time,
            held: 1,
            free: samples.free,
            tail: 1,
            band: BAND,
            high: 1.0 - BAND,
            low: BAND,
            reach: 0.0,
            hysteresis: PASSED * noise,
        };
        let measures = measuring.measure_around(position, rest);
        let way = (rest - position[0]).abs();
        let (largest, reached) = measures
            .overshoots_beyond()
            .fold((0.0, 0.0), |largest, overshoot| if overshoot.0 > largest.0 { overshoot } else { largest });
        let known = if largest > 0.0 {
            reached < time[time.len() - 1] && COVERAGE * noise <= KNOWN * f64::max(largest, BAND * way)
        } else {
            last_swing <= AT_REST * way + 2.0 * PASSED * noise && PASSED * noise <= KNOWN * way
        };
        let overshoot = if known { largest / way } else { f64::NAN };
        match measures.period(noise, KNOWN).filter(|it| COVERAGE * it.uncertainty <= KNOWN * it.mean) {
            Some(it) => Self { overshoot, period: it.mean, periods: number(it.cycles) },
            None => Self { overshoot, ..Self::NONE },
        }
    }
}

#[inline]
#[expect(clippy::cast_precision_loss, reason = "a number of samples, far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
