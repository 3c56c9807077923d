//! What is asked of a run in place of its whole history.
//!
//! `theta` column angle, `theta_0` at the start, `theta_e` its mean over the last tenth of the run · `H = theta_e - theta_0` the
//! way · `P = max |theta - theta_0|` the largest excursion
//!
//! A column that ends where it began, as after a pulse or a doublet, has no way to measure by. It is one with `|H| <= 0.05 P`:
//! its overshoot is not a number, and it has settled when it stays within 5 % of `P`.

use forcefeel_model::Scalar;
use forcefeel_model::parameters::DriveKind;

/// Share of the run at its end over which the final angle is the mean, and the last swing is taken.
const TAIL: usize = 10;
/// Share of `|H|` within which the column counts as settled: the residual band of the qualification rules. Of `P`, within which
/// the column counts as back where it began.
pub const BAND: f64 = 0.05;
/// Share of the largest angle that is an excursion at least: a mean differs by rounding from what it is the mean of.
const ROUNDING: f64 = 1e-10;

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
    /// How far the column went beyond the final angle, as a share of the way to it; not a number if it came back.
    overshoot: "";
    /// Time after which the column stayed around the final angle, within 5 % of the way, or of the largest excursion if it
    /// came back.
    settling_time: "s";
    /// Mean time between two passes of the final angle upwards; not a number with fewer than two.
    period: "s";
    /// How often the column passed the final angle upwards.
    passes: "";
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

/// Largest magnitudes on the way, and when a run left every bound.
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
}

/// A column that turns so far has no model.
pub const BOUND_RAD: f64 = 10.0;
/// How many times as far the programmed angle may go: a servo that is held back leaves it far ahead.
const PROGRAMMED: f64 = 100.0;

impl<S: Scalar> Peaks<S> {
    /// Nothing seen yet.
    #[inline(always)]
    pub fn new(like: S) -> Self {
        let zero = like.zero();
        Self { current: zero, pressure: zero, flow: zero, diverged_at: like.constant(f64::INFINITY) }
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
    }
}

/// The measures of a column angle sampled every `dt` seconds; at least two samples.
#[inline(always)]
pub fn measure<S: Scalar>(angle: &[S], dt: f64, peaks: &Peaks<S>) -> Measures<S> {
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
        let time = first.constant(number(k) * dt);
        let (higher, lower) = (top.0.less(theta), theta.less(bottom.0));
        top = (top.0.max(theta), S::select(higher, time, top.1));
        bottom = (bottom.0.min(theta), S::select(lower, time, bottom.1));
    }
    let way = end - first;
    let largest = top.0.max(-bottom.0);
    let excursion = (top.0 - first).max(first - bottom.0).max(largest.times(ROUNDING));
    let went = excursion.times(BAND).less(way.abs());
    let band = S::select(went, way.abs(), excursion).times(BAND);
    let mut settled = first.zero();
    let mut passes = first.zero();
    let (mut first_pass, mut last_pass) = (first.zero(), first.zero());
    let mut before = first - end;
    for (k, &theta) in angle.iter().enumerate() {
        let time = first.constant(number(k) * dt);
        let off = theta - end;
        settled = S::select(band.less(off.abs()), time, settled);
        // Passed upwards between the last sample and this one; the time by a straight line.
        let up = before.less(off.zero()) & !off.less(off.zero());
        let when = time - (off / (off - before)).times(dt);
        first_pass = S::select(up & passes.less(passes.constant(0.5)), when, first_pass);
        last_pass = S::select(up, when, last_pass);
        passes = S::select(up, passes + passes.constant(1.0), passes);
        before = off;
    }
    let beyond = S::select(way.less(way.zero()), end - bottom.0, top.0 - end);
    let one = passes.constant(1.0);
    Measures {
        maximum_angle: top.0,
        time_of_maximum: top.1,
        minimum_angle: bottom.0,
        time_of_minimum: bottom.1,
        final_angle: end,
        overshoot: S::select(went, beyond / way.abs(), one.constant(f64::NAN)),
        settling_time: settled,
        period: S::select(one.less(passes), (last_pass - first_pass) / (passes - one), one.constant(f64::NAN)),
        passes,
        last_swing: highest - lowest,
        peak_current: peaks.current,
        peak_pressure: peaks.pressure,
        peak_flow: peaks.flow,
        diverged_at: peaks.diverged_at,
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of samples, far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
