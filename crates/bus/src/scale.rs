//! Revolutions and torque of a drive in the loader's units, and back.
//!
//! `q` position that the drive states · `q_0` at neutral · `G` turns of the motor per turn that the drive states, negative the other way
//! round · `r` travel of the drive's end per radian of the motor · `K_t` torque per ampere · `e` command in A · `T` torque that the
//! drive states · `k`, `alpha` link and its ratio · `R_b` arm of the column's base
//!
//! | | |
//! |---|---|
//! | `x = 2 pi r G (q - q_0)` | the drive's end |
//! | `T = G K_t e` | torque of a command |
//! | `x_b = 2 pi R_b g (q_c - q_c0)`, or `(x - F / k) / alpha` without an encoder at the column | its base |
//! | `F = F_r (2 v - 1)`, or `T / (G r)` without a load cell | load cell whose amplifier gives the share `v` of the input's range |
//!
//! A valve's amplifier is at an analog output, and its sensors at analog inputs: `T` is the share of the output's range, `q` that of the
//! input of the drive's end, and `2 pi r G` the position at the end of that.

use crate::drive::{Shown, State};
use crate::ethercat::analog::Analog;
use core::f64::consts::TAU;
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::SENSORS;

/// How a machine is wired to its drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wiring {
    /// `G`.
    pub gear: f64,
    /// `q_0`.
    pub zero: f64,
    /// `F_r` of the load cell, in N; nothing where there is none.
    pub load_cell: Option<f64>,
    /// `g`, turns of the column per turn of its encoder, and `q_c0`; nothing where there is none.
    pub column: Option<[f64; 2]>,
    /// `F_r` of the force sensor at the grip, in N; nothing where there is none.
    pub grip: Option<f64>,
}

/// The conversion of a loader.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    wiring: Wiring,
    /// `2 pi r G`.
    travel: f64,
    /// `G K_t`.
    torque: f64,
    /// `2 pi R_b g`.
    base: f64,
    /// `G r`.
    per_force: f64,
    stiffness: f64,
    ratio: f64,
}

impl Scale {
    /// That of a loader with a motor.
    pub fn new(parameters: &Parameters<f64>, wiring: Wiring) -> Self {
        let Parameters { motor, transmission, linkage, column, .. } = parameters;
        Self {
            wiring,
            travel: TAU * transmission.travel * wiring.gear,
            torque: wiring.gear * motor.torque_constant,
            base: TAU * column.base_arm * wiring.column.map_or(1.0, |[per_turn, _]| per_turn),
            per_force: wiring.gear * transmission.travel,
            stiffness: linkage.stiffness,
            ratio: linkage.ratio,
        }
    }

    /// That of a loader with a valve at terminals: `gear` counts for nothing.
    pub fn of_valve(parameters: &Parameters<f64>, wiring: Wiring, analog: &Analog) -> Self {
        let Parameters { linkage, column, .. } = parameters;
        Self {
            wiring,
            travel: analog.position_range,
            torque: 1.0 / analog.output_range,
            base: TAU * column.base_arm,
            // What has no load cell has no force here.
            per_force: f64::NAN,
            stiffness: linkage.stiffness,
            ratio: linkage.ratio,
        }
    }

    /// Torque of a command in A, or the share of an output's range of one in V.
    pub fn torque(&self, command: f64) -> f64 {
        self.torque * command
    }

    /// Command in A of a torque, or in V of a share.
    pub fn command(&self, torque: f64) -> f64 {
        torque / self.torque
    }

    /// Speed of the motor in rad/s at a velocity that the drive states in revolutions per second.
    pub fn speed(&self, velocity: f64) -> f64 {
        TAU * self.wiring.gear * velocity
    }

    /// What the sensors of a sample show.
    pub fn sensors(&self, state: &State) -> [f64; SENSORS] {
        let Wiring { zero, load_cell, column, grip, .. } = self.wiring;
        let [load_cell_share, turns, grip_share] = state.sensors;
        let position = self.travel * (state.position - zero);
        let force = load_cell.map_or(state.torque / self.per_force, |range| range * (2.0 * load_cell_share - 1.0));
        let base = column.map_or((position - force / self.stiffness) / self.ratio, |[_, zero]| {
            // An encoder of one turn begins anew there.
            let turned = turns - zero;
            self.base * (turned - round(turned))
        });
        [force, position, base, grip.map_or(0.0, |range| range * (2.0 * grip_share - 1.0))]
    }

    /// What a drive states where the sensors show this and the motor has this current in A and speed in rad/s.
    pub fn shown(&self, [force, position, base, grip]: [f64; SENSORS], current: f64, speed: f64) -> Shown {
        let Wiring { gear, zero, load_cell, column, grip: grip_range } = self.wiring;
        let share = |force: f64, range: Option<f64>| {
            range.map_or(f64::NAN, |range| (0.5 + 0.5 * force / range).clamp(0.0, 1.0))
        };
        Shown {
            position: position / self.travel + zero,
            velocity: speed / (TAU * gear),
            torque: self.torque(current),
            sensors: [
                share(force, load_cell),
                column.map_or(f64::NAN, |[_, zero]| base / self.base + zero),
                share(grip, grip_range),
            ],
        }
    }
}

/// To the nearest whole number, without a standard library; of more turns than a sensor has, none.
fn round(turns: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, reason = "it saturates")]
    let whole = (turns + if turns < 0.0 { -0.5 } else { 0.5 }) as i32;
    f64::from(whole)
}
