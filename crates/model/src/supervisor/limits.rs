//! What a supervisor allows, from the loader's `safety` rows and its parts.
//!
//! `T` period · times become whole samples: at most that long where something is silent or late, at least one · `alpha R_b` travel of the
//! drive per radian of the column · `e_max` largest command, in V of a valve's amplifier or in A of a motor

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

/// Limits in SI units and samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// `T` in s.
    pub period: f64,
    /// `e_max`, in V or A.
    pub command: f64,
    /// Largest change of the command in a sample, in V or A.
    pub command_step: f64,
    /// Change of the command in a sample while the loader is stopped, in V or A.
    pub stop_step: f64,
    /// Samples from a stop until the command is zero and the drive disabled.
    pub stop: u32,
    /// Share of the largest command with which the feel begins.
    pub start_share: f64,
    /// Share of the feel per sample while it comes or goes.
    pub fade_step: f64,
    /// Share of the host's values per sample while they come or go.
    pub host_step: f64,
    /// Force at the grip in N: for a time, at once, and its largest change in a sample.
    pub force_limit: f64,
    /// See [`force_limit`](Self::force_limit).
    pub absolute_force: f64,
    /// See [`force_limit`](Self::force_limit).
    pub force_step: f64,
    /// Largest change of the column's angle in a sample, in rad.
    pub speed_step: f64,
    /// Angles in rad that the column may not pass; its stops with their margin.
    pub travel: [f64; 2],
    /// The end stops themselves.
    pub stops: [f64; 2],
    /// Margin of them.
    pub travel_margin: f64,
    /// Ranges of load cell (N), drive position (m), column angle (rad).
    pub range: [f64; 3],
    /// Changes in a sample that the machine cannot make, of the same.
    pub jump: [f64; 3],
    /// By how much the link's stretch may differ from its spring's, in m of the drive, its play left out.
    pub agreement_m: f64,
    /// Samples after which the functions act, where not one or two.
    pub agreement: u32,
    /// See [`agreement`](Self::agreement).
    pub stuck: u32,
    /// See [`agreement`](Self::agreement).
    pub silence: u32,
    /// See [`agreement`](Self::agreement).
    pub host: u32,
    /// See [`agreement`](Self::agreement).
    pub overrun: u32,
    /// See [`agreement`](Self::agreement).
    pub saturation: u32,
    /// See [`agreement`](Self::agreement).
    pub force: u32,
    /// Samples of the condition and of the filter before it.
    pub runaway: u32,
    /// Samples of the condition alone.
    pub runaway_condition: u32,
    /// Torque of the force at the grip below which there is no hand on it, in N m.
    pub hand_torque: f64,
    /// In W.
    pub runaway_power: f64,
    /// `R_p` in m.
    pub grip_arm: f64,
    /// `alpha R_b` in m.
    pub lever: f64,
    /// `J` in N m s²/rad.
    pub inertia: f64,
    /// `R_b` in m.
    pub base_arm: f64,
    /// Length in m that link and transmission give per N, their half play in m, and `c / k` in s.
    pub link: [f64; 3],
    /// Whether the column is led to its stops first.
    pub travel_search: bool,
    /// Neutral's change in a sample while it is, in rad.
    pub search_step: f64,
    /// Force at the grip at which a stop is found, in N.
    pub search_force: f64,
}

/// `w_o` of the hand's estimate, in rad/s: quick beside the times of the table, slow beside a sample.
pub const ESTIMATE_BANDWIDTH: f64 = 190.0;
/// Time constants after which a filter has come to within a hundredth.
const FILTER_SETTLES: f64 = 5.0;

impl Limits {
    /// Those of a loader under a controller with this period in s.
    ///
    /// # Errors
    /// If there is no period or no largest command.
    pub fn new(values: &Parameters<f64>, kind: DriveKind, period: f64) -> Result<Self, Refusal> {
        if !(period > 0.0 && period.is_finite()) {
            return Err(Refusal::NoPeriod);
        }
        let Parameters { safety, column, linkage, transmission, controller, .. } = values;
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
        let angle_jump = safety.jump_speed * period;
        let (per_stiffness, half_play) = match kind {
            DriveKind::Hydraulic => (1.0 / linkage.stiffness, 0.5 * linkage.backlash),
            DriveKind::Electric => (
                1.0 / linkage.stiffness + 1.0 / transmission.stiffness,
                0.5 * (linkage.backlash + transmission.backlash),
            ),
        };
        let runaway_condition = within(safety.runaway_time);
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
            jump: [0.5 * range[0], lever * angle_jump, angle_jump],
            agreement_m: safety.agreement * lever,
            agreement: within(safety.agreement_time),
            stuck: within(safety.stuck_time),
            silence: within(safety.silence_time),
            host: within(safety.host_time),
            overrun: within(safety.overrun_time),
            saturation: within(safety.saturation_time),
            force: within(safety.force_time),
            runaway: runaway_condition + whole(FILTER_SETTLES / (ESTIMATE_BANDWIDTH * period)) + 1,
            runaway_condition,
            hand_torque: safety.hand_force * column.grip_arm,
            runaway_power: safety.runaway_power,
            grip_arm: column.grip_arm,
            lever,
            inertia: column.inertia,
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
