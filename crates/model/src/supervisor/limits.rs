//! What a supervisor allows, from the loader's `safety` rows and its parts.
//!
//! `T` period · times become whole samples: at most that long where something is silent or late, at least one · `alpha R_b` travel of the
//! drive per radian of the column · `e_max` largest command, in V of a valve's amplifier or in A of a motor

use super::numbers::below;
use crate::Scalar;
use crate::parameters::{DriveKind, Parameters};

/// What keeps a loader from being supervised.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// There is no sample period.
    NoPeriod,
    /// The largest command has no end.
    NoLimit,
}

impl Refusal {
    /// What was given, what was expected, what to do.
    pub const fn text(self) -> &'static str {
        match self {
            Self::NoPeriod => "the period: expected a finite time above zero; state controller.period",
            Self::NoLimit => "the drive's largest command: is without end; state current_loop.current_limit",
        }
    }
}

/// What a limit is in another number type, each number made by a function.
trait In<S> {
    type Found;
    fn of(self, number: &mut impl FnMut(f64) -> S) -> Self::Found;
}

impl<S> In<S> for f64 {
    type Found = S;
    fn of(self, number: &mut impl FnMut(f64) -> S) -> S {
        number(self)
    }
}

impl<S, const N: usize> In<S> for [f64; N] {
    type Found = [S; N];
    fn of(self, number: &mut impl FnMut(f64) -> S) -> [S; N] {
        self.map(number)
    }
}

impl<S> In<S> for u32 {
    type Found = Self;
    fn of(self, _: &mut impl FnMut(f64) -> S) -> Self {
        self
    }
}

impl<S> In<S> for bool {
    type Found = Self;
    fn of(self, _: &mut impl FnMut(f64) -> S) -> Self {
        self
    }
}

/// One row a limit: its name and what it is.
macro_rules! limits {
    ($( $(#[doc = $doc:literal])+ $name:ident: $kind:ty, )*) => {
        /// Limits in SI units and samples. A target that has no double precision keeps them in its own.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Limits<S = f64> { $( $(#[doc = $doc])+ pub $name: $kind, )* }

        impl Limits {
            /// The same limits in another number type.
            pub fn numbers_of<S: Scalar>(&self, like: S) -> Limits<S> {
                self.made_by(|number| like.constant(number))
            }

            /// The same limits, each number made by a function, in the order of the table.
            pub fn made_by<S>(&self, mut number: impl FnMut(f64) -> S) -> Limits<S> {
                Limits { $( $name: In::<S>::of(self.$name, &mut number), )* }
            }
        }
    };
}

limits! {
    /// `T` in s.
    period: S,
    /// `e_max`, in V or A.
    command: S,
    /// Largest change of the command in a sample, in V or A.
    command_step: S,
    /// Change of the command in a sample while the loader is stopped, in V or A.
    stop_step: S,
    /// Samples from a stop until the command is zero and the drive disabled.
    stop: u32,
    /// Share of the largest command with which the feel begins.
    start_share: S,
    /// Share of the feel per sample while it comes or goes.
    fade_step: S,
    /// Share of the host's values per sample while they come or go.
    host_step: S,
    /// Force at the grip in N: for a time, at once, and its largest change in a sample.
    force_limit: S,
    /// See [`force_limit`](Self::force_limit).
    absolute_force: S,
    /// See [`force_limit`](Self::force_limit).
    force_step: S,
    /// Largest change of the column's angle in a sample, in rad.
    speed_step: S,
    /// Angles in rad that the column may not pass; its stops with their margin.
    travel: [S; 2],
    /// The end stops themselves.
    stops: [S; 2],
    /// Margin of them.
    travel_margin: S,
    /// Ranges of load cell (N), drive position (m), column angle (rad).
    range: [S; 3],
    /// Differences from their prediction that readings of the same may have.
    plausible: [S; 3],
    /// Samples in a row in which a reading may be implausible, and is bridged.
    bridge: u32,
    /// Whole periods from a sample to its command.
    delay: u32,
    /// Cycles by which a sample may be late.
    late: u32,
    /// `a` in m/s² per V or A, `b` in 1/kg, `d` in 1/s and `g` in m/s per N of the drive: see `plausibility`.
    drive: [S; 4],
    /// Share of a difference by which place, rate (1/s) and acceleration (1/s²) are corrected.
    tracking: [S; 3],
    /// By how much the link's stretch may differ from its spring's, in m of the drive, its play left out.
    agreement_m: S,
    /// Samples after which the functions act, where not one or two.
    agreement: u32,
    /// See [`agreement`](Self::agreement).
    stuck: u32,
    /// See [`agreement`](Self::agreement).
    silence: u32,
    /// See [`agreement`](Self::agreement).
    host: u32,
    /// See [`agreement`](Self::agreement).
    overrun: u32,
    /// See [`agreement`](Self::agreement).
    saturation: u32,
    /// See [`agreement`](Self::agreement).
    force: u32,
    /// See [`agreement`](Self::agreement).
    power: u32,
    /// Samples of the condition and of the filter before it.
    runaway: u32,
    /// Samples of the condition alone.
    runaway_condition: u32,
    /// Dry friction of the moving column in N m.
    friction: S,
    /// Torque of the force at the grip below which there is no hand on it, in N m.
    hand_torque: S,
    /// In W.
    runaway_power: S,
    /// Energy to the hand in J, and the share of it that is forgotten in a sample.
    energy: [S; 2],
    /// Energy in J of a column's motion beyond its feel's.
    motion: S,
    /// Swing of a column with no hand on it, from side to side, in rad.
    swing: S,
    /// Whether there is a force sensor at the grip.
    grip_sensor: bool,
    /// Samples without a hand after which it is zeroed.
    grip_zero: u32,
    /// Largest mean torque in N m that may be estimated of no hand.
    grip_quiet: S,
    /// Largest span in N of the sensor's readings without a hand.
    grip_span: S,
    /// Change of the hand's estimated torque in N m by which it has to move.
    grip_apart: S,
    /// Samples for which it has to be so: what the estimate takes to settle, too.
    grip_stuck: u32,
    /// Largest zero in N.
    grip_most: S,
    /// Change of the zero in a sample, in N.
    grip_step: S,
    /// `R_p` in m.
    grip_arm: S,
    /// `alpha R_b` in m.
    lever: S,
    /// `J` in N m s²/rad.
    inertia: S,
    /// `I / J` of a feel lighter than the column, or one.
    light_feel: S,
    /// `R_b` in m.
    base_arm: S,
    /// Length in m that link and transmission give per N, their half play in m, and `c / k` in s.
    link: [S; 3],
    /// Whether the column is led to its stops first.
    travel_search: bool,
    /// Neutral's change in a sample while it is, in rad.
    search_step: S,
    /// Force at the grip at which a stop is found, in N.
    search_force: S,
}

/// `w_o` of the hand's estimate, in rad/s: quick beside the times of the table, slow beside a sample.
pub const ESTIMATE_BANDWIDTH: f64 = 190.0;
/// Time constant in s with which the energy that a hand was given is forgotten.
const FORGETS_S: f64 = 1.0;
/// Time constants after which a filter has come to within a hundredth.
const FILTER_SETTLES: f64 = 5.0;

/// Share of the force of a hand that the mean estimate of none stays below.
const NO_HAND: f64 = 0.25;
/// Span of ten thousand samples of noise, as a multiple of its r.m.s.
const WIDEST_NOISE: f64 = 10.0;

impl<S: Scalar> Limits<S> {
    /// Whether a column at this angle is at neither end stop.
    #[inline(always)]
    pub(super) fn is_free(&self, angle: S) -> S::Mask {
        let [low, high] = self.stops;
        below(low, angle) & below(angle, high)
    }
}

impl Limits {
    /// Those of a loader under a controller with this period in s.
    ///
    /// # Errors
    /// If there is no period or no largest command.
    pub fn new(values: &Parameters<f64>, kind: DriveKind, period: f64) -> Result<Self, Refusal> {
        if !(period > 0.0 && period.is_finite()) {
            return Err(Refusal::NoPeriod);
        }
        let Parameters { safety, column, linkage, transmission, controller, grip_sensor, .. } = values;
        let command = largest_command(values, kind) * safety.command_share;
        if !(command > 0.0 && command.is_finite()) {
            return Err(Refusal::NoLimit);
        }
        let within = |time: f64| whole((time / period * (1.0 + ROUNDING)).max(1.0));
        let lever = linkage.ratio * column.base_arm;
        let stop = whole((safety.stop_time / period).max(1.0));
        let converted = |range: f64, gain: f64| {
            if kind == DriveKind::Hydraulic { range.min(controller.input_range / gain) } else { range }
        };
        let range = [
            converted(safety.force_range, values.load_cell.gain),
            converted(safety.position_range, values.potentiometer.gain),
            safety.angle_range,
        ];
        let (per_stiffness, half_play) = match kind {
            DriveKind::Hydraulic => (1.0 / linkage.stiffness, 0.5 * linkage.backlash),
            DriveKind::Electric => (
                1.0 / linkage.stiffness + 1.0 / transmission.stiffness,
                0.5 * (linkage.backlash + transmission.backlash),
            ),
        };
        let drive = drive(values, kind);
        let runaway_condition = within(safety.runaway_time);
        let stuck = within(safety.stuck_time);
        let settles = whole(FILTER_SETTLES / (ESTIMATE_BANDWIDTH * period)) + 1;
        let largest_friction = column.static_friction.max(column.coulomb_friction);
        Ok(Self {
            period,
            command,
            command_step: safety.command_rate * period * command,
            stop_step: command / f64::from(stop),
            stop,
            start_share: safety.start_share,
            fade_step: (period / safety.fade_time).min(1.0),
            host_step: (period / safety.host_fade).min(1.0),
            force_limit: safety.force_limit,
            absolute_force: safety.absolute_force,
            force_step: safety.force_rate * period,
            speed_step: safety.speed_limit * period,
            travel: [column.stop_low - safety.travel_margin, column.stop_high + safety.travel_margin],
            stops: [column.stop_low, column.stop_high],
            travel_margin: safety.travel_margin,
            range,
            plausible: plausible(values, &drive, per_stiffness, command),
            bridge: within(safety.bridge_time),
            delay: whole((controller.delay / period).round()).min(MOST_DELAY),
            late: whole(safety.delay_tolerance / period * (1.0 + ROUNDING)),
            drive,
            tracking: tracking(period),
            agreement_m: safety.agreement * lever,
            agreement: within(safety.agreement_time),
            stuck,
            silence: within(safety.silence_time),
            host: within(safety.host_time),
            overrun: within(safety.overrun_time),
            saturation: within(safety.saturation_time),
            force: within(safety.force_time),
            power: within(safety.power_time),
            runaway: runaway_condition + settles,
            runaway_condition,
            friction: column.coulomb_friction * column.grip_arm,
            hand_torque: safety.hand_force * column.grip_arm,
            runaway_power: safety.runaway_power,
            energy: [safety.energy_limit, (period / FORGETS_S).min(1.0)],
            motion: safety.motion_limit,
            swing: safety.swing_limit,
            grip_sensor: grip_sensor.gain > 0.0,
            grip_zero: within(safety.grip_zero_time),
            grip_quiet: (largest_friction + NO_HAND * safety.hand_force) * column.grip_arm,
            grip_span: WIDEST_NOISE * grip_sensor.noise + MOST_STEPS * grip_sensor.resolution,
            grip_apart: (safety.hand_force + 2.0 * (1.0 + column.friction_asymmetry.abs()) * largest_friction)
                * column.grip_arm,
            grip_stuck: stuck + settles,
            grip_most: safety.grip_offset,
            grip_step: safety.hand_force * period,
            grip_arm: column.grip_arm,
            lever,
            inertia: column.inertia,
            light_feel: (values.feel.inertia / column.inertia).min(1.0),
            base_arm: column.base_arm,
            link: [per_stiffness, half_play, linkage.damping / linkage.stiffness],
            travel_search: safety.travel_search != 0.0,
            search_step: safety.search_speed * period,
            search_force: safety.search_force,
        })
    }
}

/// A time that is a whole number of periods is so in spite of rounding.
const ROUNDING: f64 = 1e-9;

/// Most whole periods of delay that the commands under way have room for.
pub(super) const MOST_DELAY: u32 = 6;

/// `a`, `b`, `d`, `g` of the drive.
fn drive(values: &Parameters<f64>, kind: DriveKind) -> [f64; 4] {
    let Parameters { amplifier, valve, actuator, motor, transmission, .. } = values;
    match kind {
        DriveKind::Hydraulic => {
            // The flow follows its command in 2 zeta / w_n; A x' = C_i K_2 e - C_p F / A.
            let quick = valve.natural_frequency / (2.0 * valve.damping_ratio);
            let per_volt = valve.current_gain * amplifier.admittance / actuator.area;
            [quick * per_volt, 0.0, quick, valve.pressure_gain / (actuator.area * actuator.area)]
        }
        DriveKind::Electric => {
            // J_m / r^2 x'' = K_t i / r - F - B_m / r^2 x'
            let per_mass = transmission.travel * transmission.travel / motor.inertia;
            [
                per_mass * motor.torque_constant / transmission.travel,
                per_mass,
                motor.viscous_friction / motor.inertia,
                0.0,
            ]
        }
    }
}

/// Gains of a critically damped tracking filter whose poles are all at `exp(-w_o T)`.
fn tracking(period: f64) -> [f64; 3] {
    // A step of the lag, no longer than it is; of no more than half of it, so that no reading is taken as it is.
    let step = (ESTIMATE_BANDWIDTH * period).min(0.5);
    let kept = 1.0 - step;
    [1.0 - kept * kept * kept, 1.5 * step * step * (1.0 + kept) / period, step * step * step / (period * period)]
}

/// Multiple of a sensor's r.m.s. noise that no sample of a loader's life has, and of its steps beside it.
const MOST_NOISE: f64 = 8.0;
const MOST_STEPS: f64 = 2.0;
/// Largest lag of the tracking filter behind a step of acceleration, times `w_o^2`.
const LARGEST_LAG: f64 = 0.5;
/// Share of the lags of drive and column by which the link's force is off: they go together.
const SHARE_OF_LAG: f64 = 0.25;

/// By how much a reading may differ from its prediction: noise and steps of the sensor, and the lag behind the largest acceleration that
/// the prediction does not know of: that of the column by the largest force of a hand, that of the drive by its largest command. The column's
/// is no more than that behind a step to its speed limit.
fn plausible(values: &Parameters<f64>, [a, ..]: &[f64; 4], per_stiffness: f64, command: f64) -> [f64; 3] {
    let Parameters { safety, column, linkage, load_cell, potentiometer, column_sensor, .. } = values;
    let per_acceleration = LARGEST_LAG / (ESTIMATE_BANDWIDTH * ESTIMATE_BANDWIDTH);
    let noise = |noise: f64, resolution: f64| MOST_NOISE * noise + MOST_STEPS * resolution;
    let position = per_acceleration * a * command;
    let angle = per_acceleration * safety.absolute_force * column.grip_arm / column.inertia;
    // A light column is at its speed limit before the largest force has done so much.
    let to_speed_limit = safety.speed_limit / ESTIMATE_BANDWIDTH;
    let lever = linkage.ratio * column.base_arm;
    [
        noise(load_cell.noise, load_cell.resolution) + SHARE_OF_LAG * (position + lever * angle) / per_stiffness,
        noise(potentiometer.noise, potentiometer.resolution) + position,
        noise(column_sensor.noise, column_sensor.resolution) + angle.min(to_speed_limit),
    ]
}

/// `e_max` of the drive, in V at a valve's amplifier or in A.
fn largest_command(values: &Parameters<f64>, kind: DriveKind) -> f64 {
    match kind {
        DriveKind::Hydraulic => {
            let current = values.amplifier.current_limit.min(values.valve.rated_current);
            (current / values.amplifier.admittance).min(values.controller.output_range)
        }
        DriveKind::Electric => values.current_loop.current_limit,
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of samples; the cast saturates")]
fn whole(samples: f64) -> u32 {
    samples as u32
}
