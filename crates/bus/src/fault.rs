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
];
