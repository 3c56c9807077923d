//! Which effects beyond the linear models are in play, so that a step need not compute the others.

use crate::parameters::{COUNT, DriveKind, Parameters};
use crate::transducers::SENSORS;

/// One row an effect: its meaning, `no_slope` where it holds, touches or steps, and whether a loader with the parameters `p` and this drive
/// has it.
macro_rules! effects {
    (($p:ident, $electric:ident) $( $(#[doc = $doc:literal])+ $name:ident $(, $no_slope:ident)? = $of:expr; )*) => {
        /// A flag for each effect. An effect that is not in play changes nothing; one that is, but whose numbers are those of "off",
        /// changes nothing either.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        pub struct Effects { $( $(#[doc = $doc])+ pub $name: bool, )* }

        impl Effects {
            /// The effects of a loader with these values, in the order of the parameter table; of the law and of the inputs nothing is
            /// known, so all that they may do is in play.
            pub fn of(values: &[f64; COUNT]) -> Self {
                let $p = &Parameters::from_values(values);
                let $electric = DriveKind::of(values) == DriveKind::Electric;
                Self { $( $name: $of, )* }
            }

            /// The effects of two loaders that run side by side.
            pub fn or(self, other: Self) -> Self {
                Self { $( $name: self.$name | other.$name, )* }
            }

            /// Those without what holds, touches or steps: what is left has a slope at rest.
            #[must_use]
            pub fn smooth(self) -> Self {
                Self { $( $name: effects!(@smooth self.$name $(, $no_slope)?), )* }
            }
        }
    };
    (@smooth $value:expr, no_slope) => { false };
    (@smooth $value:expr) => { $value };
}

effects! {
    (p, electric)

    /// Eq. (1) in place of eqs. (2), (4).
    orifice = any(&[p.valve.orifice]);
    /// Limits of current and flow.
    saturation = if electric {
        finite(&[p.current_loop.current_limit, p.current_loop.voltage_limit])
    } else {
        finite(&[p.amplifier.current_limit, p.valve.flow_limit])
    };
    /// Relief valve between the chambers.
    relief = finite(&[p.actuator.relief_pressure]);
    /// Free play of the link.
    backlash, no_slope = any(&[p.linkage.backlash, p.transmission.backlash]);
    /// Dry friction of the column.
    column_friction, no_slope = any(&[p.column.coulomb_friction, p.column.static_friction]);
    /// Fall of that friction from breakaway over a velocity.
    stribeck, no_slope = any(&[p.column.stribeck_velocity]);
    /// Dry friction of the piston's seals.
    seals, no_slope = any(&[p.actuator.seal_friction]);
    /// Viscous friction, or a pilot's arm at the column.
    column_loads = any(&[p.column.viscous_friction, p.pilot.arm_damping, p.pilot.arm_stiffness]);
    /// Gravity at the column. Apart from the loads: its sine takes an eighth of a step.
    gravity = any(&[p.column.gravity_torque]);
    /// End stops of the column.
    column_stops, no_slope = finite(&[p.column.stop_low, p.column.stop_high]);
    /// Offset of a sensor.
    offsets = any(&offsets(p));
    /// Lag of a sensor.
    lags = finite(&[
        p.load_cell.bandwidth,
        p.potentiometer.bandwidth,
        p.column_sensor.bandwidth,
        p.grip_sensor.bandwidth,
    ]);
    /// Dry friction of the feel.
    feel_friction, no_slope = any(&[p.feel.coulomb_friction, p.feel.static_friction]);
    /// Spring of the feel other than a straight line through zero.
    feel_spring, no_slope = p.feel.has_parts() || any(&[p.feel.deadband, p.feel.preload]);
    /// Quadratic damping or soft stops of the feel.
    feel_damping_and_stops = any(&[p.feel.quadratic_damping])
        || finite(&[p.feel.soft_stop_low, p.feel.soft_stop_high]);
    /// Hard stops or velocity limit of the feel.
    feel_limits, no_slope = finite(&[p.feel.hard_stop_low, p.feel.hard_stop_high, p.feel.velocity_limit]);
    /// A digital controller.
    sampled = any(&[p.controller.period]);
    /// Noise of a sensor.
    noise, no_slope = any(&[p.load_cell.noise, p.potentiometer.noise, p.column_sensor.noise, p.grip_sensor.noise]);
    /// A force sensor at the grip.
    grip_sensor = any(&[p.grip_sensor.gain]);
    /// Feedback of more than piston and programmed displacement.
    feedback = true;
    /// A law with an observer in place of gains.
    observer = false;
    /// Dry friction that this law knows.
    known_friction, no_slope = false;
    /// What this law does in contact.
    contact_law, no_slope = false;
    /// Trim, a factor on the feel's spring, or the stick shaker.
    surroundings = true;
    /// A test signal at the amplifier, or one on the command.
    test_signal = true;
    /// A bench signal beside the law's command, of which its observer is not told.
    excited, no_slope = false;
    /// A link to another column.
    linked = false;
    /// Something that moves the column from neutral while nobody touches it.
    biased = any(&offsets(p)) || p.feel.has_biased_parts() || any(&[p.column.gravity_torque, p.feel.preload]);
    /// Dry friction of the drive, losses of its transmission.
    drive_friction, no_slope = any(&[p.motor.coulomb_friction, p.motor.static_friction, p.brake.engaged])
        || p.transmission.efficiency < 1.0
        || p.transmission.backdriving_efficiency < 1.0;
    /// Cogging of the motor.
    cogging, no_slope = any(&[p.motor.cogging_torque, p.motor.cogging_torque_2]);
    /// Heat of the motor.
    heating, no_slope = finite(&[p.thermal.winding_capacity]);
}

/// Offset of each sensor.
fn offsets(p: &Parameters<f64>) -> [f64; SENSORS] {
    [p.load_cell.offset, p.potentiometer.offset, p.column_sensor.offset, p.grip_sensor.offset]
}

fn finite(limits: &[f64]) -> bool {
    limits.iter().any(|limit| limit.is_finite())
}

fn any(numbers: &[f64]) -> bool {
    numbers.iter().any(|&number| number != 0.0)
}
