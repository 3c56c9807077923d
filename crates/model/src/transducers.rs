//! Sensors as they are: offset, lag, noise and resolution of load cell, potentiometer, column sensor and the grip's force sensor.
//!
//! `x` what is measured · `f` what the sensor shows, `f' = w (x - f)` · `w` bandwidth · `h` time since `x` was `x_0`, `f` was `f_0`
//!
//! The lag is solved exactly for a measured value that changes evenly, so a sensor may be as fast as it likes:
//! `f = x - m + (f_0 - x_0 + m) exp(-w h)`, `m = (x - x_0) / (w h)`.

use crate::Scalar;
use crate::parameters::Parameters;

/// How many sensors there are: load cell (N), potentiometer (m), column sensor (m at the base), force sensor at the grip (N).
pub const SENSORS: usize = 4;

/// The sensors of one loader.
#[derive(Debug, Clone, Copy)]
pub struct Transducers<S> {
    /// Offsets.
    pub offset: [S; SENSORS],
    /// Noise of a sample, r.m.s.
    pub noise: [S; SENSORS],
    /// Resolution, and one over it.
    resolution: [[S; 2]; SENSORS],
    /// Of the load cell, in rad/s.
    load_cell_bandwidth: S,
    /// Of the column's sensor, in rad/s.
    column_bandwidth: S,
    half: [Lag<S>; SENSORS],
    whole: [Lag<S>; SENSORS],
}

/// A lag over a certain time.
#[derive(Debug, Clone, Copy)]
struct Lag<S> {
    /// `1 / (w h)`.
    per_time: S,
    /// `exp(-w h)`.
    kept: S,
}

impl<S: Scalar> Lag<S> {
    #[inline(always)]
    fn new(bandwidth: S, time: S) -> Self {
        let decay = bandwidth * time;
        Self { per_time: time.constant(1.0) / decay, kept: decay.decay() }
    }

    #[inline(always)]
    fn shown(&self, f_0: S, x_0: S, x: S, late: S) -> S {
        let m = (x - x_0) * (self.per_time + late);
        x - m + (f_0 - x_0 + m) * self.kept
    }
}

/// What a sensor measured and showed at the start of a step.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SensorReading<S> {
    /// Measured.
    pub measured: [S; SENSORS],
    /// Shown, without the offset.
    pub shown: [S; SENSORS],
}

impl<S: Scalar> Transducers<S> {
    /// The sensors of a loader in steps of `h` seconds.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, h: f64) -> Self {
        let Parameters { load_cell: f, potentiometer: x, column_sensor: c, grip_sensor: g, column, .. } = parameters;
        let arm = column.base_arm;
        let step = arm.constant(h);
        let bandwidths = [f.bandwidth, x.bandwidth, c.bandwidth, g.bandwidth];
        Self {
            offset: [f.offset, x.offset, c.offset * arm, g.offset],
            noise: [f.noise, x.noise, c.noise * arm, g.noise],
            resolution: [f.resolution, x.resolution, c.resolution * arm, g.resolution]
                .map(|step| [step, step.constant(1.0) / step]),
            load_cell_bandwidth: f.bandwidth,
            column_bandwidth: c.bandwidth,
            half: bandwidths.map(|bandwidth| Lag::new(bandwidth, step.times(0.5))),
            whole: bandwidths.map(|bandwidth| Lag::new(bandwidth, step)),
        }
    }

    /// What is shown after half a step in which the measured values changed evenly to `measured`.
    #[inline(always)]
    pub fn after_half(&self, before: &SensorReading<S>, measured: [S; SENSORS]) -> [S; SENSORS] {
        shown(&self.half, before, measured, measured[0].zero())
    }

    /// What is shown after a whole step; `late` for the load cell, see [`load_cell_late`](Self::load_cell_late).
    #[inline(always)]
    pub fn after_whole(&self, before: &SensorReading<S>, measured: [S; SENSORS], late: S) -> [S; SENSORS] {
        shown(&self.whole, before, measured, late)
    }

    /// Rate of what the column's sensor shows, from the base's displacement and rate and from what is shown.
    #[inline(always)]
    pub fn column_rate(&self, base: S, base_rate: S, shown: S) -> S {
        let w = self.column_bandwidth;
        // f' = w (x - f)
        S::select(w.less(w.constant(f64::INFINITY)), w * (base - shown), base_rate)
    }

    /// Share of a force that came `time` ago which the load cell has passed on since, on average: `1 - (1 - exp(-w T)) / (w T)`.
    #[inline(always)]
    pub fn load_cell_share(&self, time: S) -> S {
        let (one, decay) = (time.constant(1.0), self.load_cell_bandwidth * time);
        let share = one - (one - decay.decay()) / decay;
        S::select(decay.less(one.times(1e-6)), decay.times(0.5), share)
    }

    /// Share of a step by which the load cell takes a force for later than a straight line over the step that came `time` before its
    /// end, a share `first` of it at once and the rest evenly since.
    #[inline(always)]
    pub fn load_cell_late(&self, time: S, first: S) -> S {
        let (one, whole) = (time.constant(1.0), &self.whole[0]);
        // 1 - f = first exp(-w T) + (1 - first) (1 - exp(-w T)) / (w T), which a straight line has at 1 / (w h) + late
        let missing =
            first * (self.load_cell_bandwidth * time).decay() + (one - first) * (one - self.load_cell_share(time));
        missing / (one - whole.kept) - whole.per_time
    }

    /// A sample: with offset, with noise (`normal` is standard normal), in steps of the resolution.
    #[inline(always)]
    pub fn sample(&self, shown: [S; SENSORS], normal: [S; SENSORS]) -> [S; SENSORS] {
        let mut seen = shown;
        for k in 0..SENSORS {
            seen[k] = (shown[k] + self.offset[k] + self.noise[k] * normal[k]).quantized(self.resolution[k]);
        }
        seen
    }
}

#[inline(always)]
fn shown<S: Scalar>(
    lags: &[Lag<S>; SENSORS],
    before: &SensorReading<S>,
    measured: [S; SENSORS],
    late: S,
) -> [S; SENSORS] {
    let one = |k: usize, late: S| lags[k].shown(before.shown[k], before.measured[k], measured[k], late);
    let zero = late.zero();
    [one(0, late), one(1, zero), one(2, zero), one(3, zero)]
}
