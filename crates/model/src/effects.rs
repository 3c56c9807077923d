//! Which effects beyond the linear models are in play, so that a step need not compute the others.

use crate::parameters::{COUNT, DriveKind, Parameters};

/// A flag for each effect. An effect that is not in play changes nothing; one that is, but whose numbers are those of "off",
/// changes nothing either.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each effect is there or not, independently of the others")]
pub struct Effects {
    /// Eq. (1) in place of eqs. (2), (4).
    pub orifice: bool,
    /// Limits of current and flow.
    pub saturation: bool,
    /// Relief valve between the chambers.
    pub relief: bool,
    /// Free play of the link.
    pub backlash: bool,
    /// Dry friction of the column.
    pub column_friction: bool,
    /// Viscous friction, gravity, or a pilot's arm at the column.
    pub column_loads: bool,
    /// End stops of the column.
    pub column_stops: bool,
    /// Offset of a sensor.
    pub offsets: bool,
    /// Lag of a sensor.
    pub lags: bool,
    /// Dry friction of the feel.
    pub feel_friction: bool,
    /// Spring of the feel other than a straight line through zero.
    pub feel_spring: bool,
    /// Quadratic damping or soft stops of the feel.
    pub feel_damping_and_stops: bool,
    /// Hard stops or velocity limit of the feel.
    pub feel_limits: bool,
    /// A digital controller.
    pub sampled: bool,
    /// Noise of a sensor.
    pub noise: bool,
    /// A force sensor at the grip.
    pub grip_sensor: bool,
    /// Feedback of more than piston and programmed displacement.
    pub feedback: bool,
    /// A law with an observer in place of gains.
    pub observer: bool,
    /// Dry friction that this law knows.
    pub known_friction: bool,
    /// Trim, a factor on the feel's spring, or the stick shaker.
    pub surroundings: bool,
    /// A test signal at the amplifier, or one on the command.
    pub test_signal: bool,
    /// Something that moves the column from neutral while nobody touches it.
    pub biased: bool,
    /// Dry friction of the drive, losses of its transmission.
    pub drive_friction: bool,
    /// Cogging of the motor.
    pub cogging: bool,
    /// Heat of the motor.
    pub heating: bool,
}

impl Effects {
    /// The effects of a loader with these values, in the order of the parameter table; of the law and of the inputs nothing is
    /// known, so all that they may do is in play.
    pub fn of(values: &[f64; COUNT]) -> Self {
        let p = Parameters::from_values(values);
        let feel = &p.feel;
        let electric = DriveKind::of(values) == DriveKind::Electric;
        let offsets = [p.load_cell.offset, p.potentiometer.offset, p.column_sensor.offset, p.grip_sensor.offset];
        let lags =
            [p.load_cell.bandwidth, p.potentiometer.bandwidth, p.column_sensor.bandwidth, p.grip_sensor.bandwidth];
        let spring = [feel.deadband, feel.breakout, feel.preload, feel.hysteresis, feel.detent_force];
        let finite = |limits: &[f64]| limits.iter().any(|limit| limit.is_finite());
        let any = |numbers: &[f64]| numbers.iter().any(|&number| number != 0.0);
        Self {
            orifice: any(&[p.valve.orifice]),
            saturation: if electric {
                finite(&[p.current_loop.current_limit, p.current_loop.voltage_limit])
            } else {
                finite(&[p.amplifier.current_limit, p.valve.flow_limit])
            },
            relief: finite(&[p.actuator.relief_pressure]),
            backlash: any(&[p.linkage.backlash, p.transmission.backlash]),
            column_friction: any(&[p.column.coulomb_friction, p.column.static_friction]),
            column_loads: any(&[
                p.column.viscous_friction,
                p.column.gravity_torque,
                p.pilot.arm_damping,
                p.pilot.arm_stiffness,
            ]),
            column_stops: finite(&[p.column.stop_low, p.column.stop_high]),
            offsets: any(&offsets),
            lags: finite(&lags),
            feel_friction: any(&[feel.coulomb_friction, feel.static_friction]),
            feel_spring: any(&spring),
            feel_damping_and_stops: any(&[feel.quadratic_damping])
                || finite(&[feel.soft_stop_low, feel.soft_stop_high]),
            feel_limits: finite(&[feel.hard_stop_low, feel.hard_stop_high, feel.velocity_limit]),
            sampled: any(&[p.controller.period]),
            noise: any(&[p.load_cell.noise, p.potentiometer.noise, p.column_sensor.noise, p.grip_sensor.noise]),
            grip_sensor: any(&[p.grip_sensor.gain]),
            feedback: true,
            observer: false,
            known_friction: false,
            surroundings: true,
            test_signal: true,
            drive_friction: any(&[p.motor.coulomb_friction, p.motor.static_friction, p.brake.engaged])
                || p.transmission.efficiency < 1.0
                || p.transmission.backdriving_efficiency < 1.0,
            cogging: any(&[p.motor.cogging_torque, p.motor.cogging_torque_2]),
            heating: finite(&[p.thermal.winding_capacity]),
            biased: any(&offsets) || any(&[p.column.gravity_torque, feel.preload, feel.detent_force]),
        }
    }

    /// Those without what holds, touches or steps: what is left has a slope at rest.
    #[must_use]
    pub fn smooth(self) -> Self {
        Self {
            backlash: false,
            column_friction: false,
            column_stops: false,
            feel_friction: false,
            feel_spring: false,
            feel_limits: false,
            noise: false,
            known_friction: false,
            drive_friction: false,
            cogging: false,
            heating: false,
            ..self
        }
    }

    /// The effects of two loaders that run side by side.
    pub fn or(self, other: Self) -> Self {
        Self {
            orifice: self.orifice | other.orifice,
            saturation: self.saturation | other.saturation,
            relief: self.relief | other.relief,
            backlash: self.backlash | other.backlash,
            column_friction: self.column_friction | other.column_friction,
            column_loads: self.column_loads | other.column_loads,
            column_stops: self.column_stops | other.column_stops,
            offsets: self.offsets | other.offsets,
            lags: self.lags | other.lags,
            feel_friction: self.feel_friction | other.feel_friction,
            feel_spring: self.feel_spring | other.feel_spring,
            feel_damping_and_stops: self.feel_damping_and_stops | other.feel_damping_and_stops,
            feel_limits: self.feel_limits | other.feel_limits,
            sampled: self.sampled | other.sampled,
            noise: self.noise | other.noise,
            grip_sensor: self.grip_sensor | other.grip_sensor,
            feedback: self.feedback | other.feedback,
            observer: self.observer | other.observer,
            known_friction: self.known_friction | other.known_friction,
            surroundings: self.surroundings | other.surroundings,
            test_signal: self.test_signal | other.test_signal,
            biased: self.biased | other.biased,
            drive_friction: self.drive_friction | other.drive_friction,
            cogging: self.cogging | other.cogging,
            heating: self.heating | other.heating,
        }
    }
}
