//! What a drive or its bus may complain of: one table of numbers, names and remedies.

/// A fault by its number; zero is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Fault(pub u16);

impl Fault {
    /// All is well.
    pub const NONE: Self = Self(0);
    /// The node does not answer.
    pub const SILENT: Self = Self(1);
    /// The adapter reports errors of the bus.
    pub const BUS: Self = Self(2);
    /// The node stopped by itself while it was enabled.
    pub const RESTARTED: Self = Self(3);
    /// The drive missed its commands.
    pub const WATCHDOG: Self = Self(4);
    /// The drive states no position.
    pub const NO_POSITION: Self = Self(5);
    /// A fault that the table lacks.
    pub const UNKNOWN: Self = Self(6);

    /// The fault of a number, [`Self::UNKNOWN`] where the table lacks it.
    pub fn of(number: u16) -> Self {
        if number == 0 || FAULTS.iter().any(|&(its, _, _)| its == number) { Self(number) } else { Self::UNKNOWN }
    }

    /// Its name and remedy; nothing of none.
    pub fn text(self) -> Option<(&'static str, &'static str)> {
        FAULTS.iter().find(|&&(number, _, _)| number == self.0).map(|&(_, name, remedy)| (name, remedy))
    }

    /// Whether there is one.
    pub fn is_some(self) -> bool {
        self != Self::NONE
    }
}

impl core::fmt::Display for Fault {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (name, remedy) = self.text().unwrap_or(("none", "nothing to do"));
        write!(to, "{name}; {remedy}")
    }
}

/// What is added to the fault codes of a moteus.
pub const MOTEUS: u16 = 100;
/// What is added to the number of an error's bit of an ODrive with firmware 0.5.
pub const ODRIVE_5: u16 = 300;
/// The same with firmware 0.6.
pub const ODRIVE_6: u16 = 400;

/// Number, name and remedy of each fault.
pub const FAULTS: &[(u16, &str, &str)] = &[
    (1, "node silent", "check the node's power, its number and the cable"),
    (2, "bus error", "check the bus's termination, its bit rate and that the node has power"),
    (3, "drive stopped by itself", "check the drive's supply; it may have restarted"),
    (4, "drive watchdog", "the drive missed its commands; check the cable and the loop's missed periods"),
    (5, "no position", "calibrate the drive's encoder with the maker's tool"),
    (6, "unknown drive fault", "read the fault with the maker's tool"),
    (132, "moteus: calibration fault", "calibrate with moteus_tool --calibrate"),
    (133, "moteus: motor driver fault", "check the motor's wiring and the supply"),
    (134, "moteus: over voltage", "absorb regenerated power, or raise the supply's rating"),
    (135, "moteus: encoder fault", "check the encoder's magnet and wiring"),
    (136, "moteus: motor not configured", "calibrate with moteus_tool --calibrate"),
    (137, "moteus: PWM cycle overrun", "lower servo.pwm_rate_hz"),
    (138, "moteus: over temperature", "cool the drive, or lower the torque"),
    (139, "moteus: outside limit", "move the column within servopos.position_min and max"),
    (140, "moteus: under voltage", "check the supply"),
    (141, "moteus: configuration changed", "stop the drive before its configuration is changed"),
    (142, "moteus: theta invalid", "configure the commutation encoder"),
    (143, "moteus: position invalid", "configure the output encoder"),
    (144, "moteus: driver enable fault", "restart the drive; if it comes again, replace it"),
    (145, "moteus: stop position deprecated", "leave the stop position out"),
    (146, "moteus: timing violation", "lower servo.pwm_rate_hz"),
    (147, "moteus: BEMF feedforward without acceleration limit", "set servo.bemf_feedforward to 0"),
    (148, "moteus: invalid limits", "check servopos.position_min and max"),
    (300, "ODrive: invalid state", "calibrate motor and encoder with odrivetool"),
    (306, "ODrive: motor failed", "read axis.motor.error with odrivetool"),
    (307, "ODrive: sensorless estimator failed", "use an encoder"),
    (308, "ODrive: encoder failed", "read axis.encoder.error with odrivetool"),
    (309, "ODrive: controller failed", "read axis.controller.error; check vel_limit and overspeed"),
    (312, "ODrive: lower end stop pressed", "move the column off the end stop"),
    (313, "ODrive: upper end stop pressed", "move the column off the end stop"),
    (314, "ODrive: emergency stop requested", "release the stop, then acknowledge"),
    (317, "ODrive: homing without end stop", "do not home the axis"),
    (318, "ODrive: over temperature", "cool the drive, or lower the torque"),
    (319, "ODrive: unknown position", "calibrate the encoder with odrivetool"),
    (400, "ODrive: initializing", "wait until the drive has started"),
    (401, "ODrive: system error", "restart the drive; read its error with odrivetool"),
    (402, "ODrive: timing error", "read the error with odrivetool"),
    (403, "ODrive: missing estimate", "calibrate the encoder with odrivetool"),
    (404, "ODrive: bad configuration", "check the configuration with odrivetool"),
    (405, "ODrive: driver fault", "check the motor's wiring and the supply"),
    (406, "ODrive: missing input", "check the configured input"),
    (408, "ODrive: DC bus over voltage", "absorb regenerated power: fit a brake resistor"),
    (409, "ODrive: DC bus under voltage", "check the supply"),
    (410, "ODrive: DC bus over current", "raise dc_max_positive_current, or lower the torque"),
    (411, "ODrive: DC bus over regenerated current", "fit a brake resistor, or raise dc_max_negative_current"),
    (412, "ODrive: current limit violation", "raise current_hard_max, or lower the torque"),
    (413, "ODrive: motor over temperature", "cool the motor, or lower the torque"),
    (414, "ODrive: inverter over temperature", "cool the drive, or lower the torque"),
    (415, "ODrive: velocity limit violation", "raise vel_limit"),
    (416, "ODrive: position limit violation", "move the column within the limits"),
    (425, "ODrive: emergency stop requested", "release the stop, then acknowledge"),
    (426, "ODrive: spinout detected", "check the encoder, and calibrate it"),
    (427, "ODrive: brake resistor disarmed", "check the brake resistor"),
    (428, "ODrive: thermistor disconnected", "check the thermistor's wiring"),
    (430, "ODrive: calibration error", "calibrate with odrivetool"),
];
