//! What a drive or its bus may complain of: one table of numbers, names and remedies.

use crate::ethercat::registers::WATCHDOG_CODE;

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
    /// The slave did not take its share of a frame.
    pub const COUNTER: Self = Self(7);
    /// The drive is in another mode.
    pub const MODE: Self = Self(8);
    /// The samples lack the pilot's force, and the law requires it.
    pub const NO_PILOT_FORCE: Self = Self(9);

    /// The fault of a number, [`Self::UNKNOWN`] where the table lacks it.
    pub fn of(number: u16) -> Self {
        if number == 0 || Self(number).text().is_some() { Self(number) } else { Self::UNKNOWN }
    }

    /// That of a code of EtherCAT's application layer.
    pub fn of_al(code: u16) -> Self {
        if code == WATCHDOG_CODE { Self::WATCHDOG } else { Self::of(AL.saturating_add(code)) }
    }

    /// That of an error code of CiA 402, which is the number itself.
    pub fn of_drive(code: u16) -> Self {
        if code < CIA_402 { Self::UNKNOWN } else { Self::of(code) }
    }

    /// Its name and remedy; nothing of none. An error code of CiA 402 that the table lacks has those of its class.
    pub fn text(self) -> Option<(&'static str, &'static str)> {
        let of = |number: u16| FAULTS.iter().find(|row| row.0 == number).map(|&(_, name, remedy)| (name, remedy));
        let class = |mask: u16| of(self.0 & mask).filter(|_| self.0 >= CIA_402);
        of(self.0).or_else(|| [0xfff0, 0xff00, 0xf000].into_iter().find_map(class))
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

/// What is added to the codes of EtherCAT's application layer.
pub const AL: u16 = 600;
/// The first error code of CiA 402.
pub const CIA_402: u16 = 0x1000;

/// Number, name and remedy of each fault.
pub const FAULTS: &[(u16, &str, &str)] = &[
    (1, "node silent", "check the node's power, its number and the cable"),
    (2, "bus error", "check the bus's termination, its bit rate and that the node has power"),
    (3, "drive stopped by itself", "check the drive's supply; it may have restarted"),
    (4, "drive watchdog", "the drive missed its commands; check the cable and the loop's missed periods"),
    (5, "no position", "calibrate the drive's encoder with the maker's tool"),
    (6, "unknown drive fault", "read the fault with the maker's tool"),
    (7, "wrong working counter", "check the slave's power and cable; if the slave has restarted, start the loop again"),
    (8, "drive not in torque mode", "check the drive's configuration with the maker's tool"),
    (9, "no pilot's force in the samples", "the law requires it: choose the law robust, or have the machine send it"),
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
    (AL + 0x01, "EtherCAT: unspecified error", "read the fault with the maker's tool"),
    (AL + 0x11, "EtherCAT: invalid state change", "restart the slave"),
    (AL + 0x12, "EtherCAT: unknown state", "restart the slave"),
    (AL + 0x16, "EtherCAT: invalid mailbox configuration", "write the slave's EEPROM with the maker's tool"),
    (AL + 0x17, "EtherCAT: invalid sync manager configuration", "write the slave's EEPROM with the maker's tool"),
    (AL + 0x18, "EtherCAT: no valid inputs", "check the drive's encoder and supply"),
    (AL + 0x19, "EtherCAT: no valid outputs", "check the loop's missed periods"),
    (AL + 0x1a, "EtherCAT: synchronization error", "lower this computer's jitter: forcefeel bus names what is missing"),
    (AL + 0x1d, "EtherCAT: invalid output configuration", "check that the drive's outputs can be mapped"),
    (AL + 0x1e, "EtherCAT: invalid input configuration", "check that the drive's inputs can be mapped"),
    (AL + 0x1f, "EtherCAT: invalid watchdog configuration", "change watchdog in [bus]"),
    (AL + 0x20, "EtherCAT: slave needs a cold start", "switch its supply off and on"),
    (AL + 0x21, "EtherCAT: slave needs INIT", "start the loop again"),
    (AL + 0x24, "EtherCAT: invalid input mapping", "check that the drive's inputs can be mapped"),
    (AL + 0x25, "EtherCAT: invalid output mapping", "check that the drive's outputs can be mapped"),
    (AL + 0x27, "EtherCAT: free run not supported", "set the drive to synchronous mode with the maker's tool"),
    (AL + 0x2c, "EtherCAT: fatal synchronization error", "lower this computer's jitter, then restart the slave"),
    (AL + 0x2d, "EtherCAT: no synchronization signal", "check that the drive has a distributed clock"),
    (AL + 0x30, "EtherCAT: invalid clock configuration", "choose a period that the drive supports"),
    (AL + 0x32, "EtherCAT: clock not locked", "lower this computer's jitter: forcefeel bus names what is missing"),
    (AL + 0x35, "EtherCAT: invalid cycle time", "choose a period that the drive supports"),
    (AL + 0x50, "EtherCAT: EEPROM not accessible", "restart the slave"),
    (AL + 0x51, "EtherCAT: EEPROM error", "write the slave's EEPROM with the maker's tool"),
    (0x1000, "CiA 402: general error", "read the fault with the maker's tool"),
    (0x2000, "CiA 402: current fault", "check the motor's wiring and the current limits"),
    (0x2300, "CiA 402: over current at the output", "check the motor's wiring, or lower the torque"),
    (0x2320, "CiA 402: short circuit at the output", "check the motor's wiring"),
    (0x3000, "CiA 402: voltage fault", "check the supply"),
    (0x3110, "CiA 402: mains over voltage", "check the supply"),
    (0x3120, "CiA 402: mains under voltage", "check the supply"),
    (0x3210, "CiA 402: DC link over voltage", "absorb regenerated power: fit a brake resistor"),
    (0x3220, "CiA 402: DC link under voltage", "check the supply"),
    (0x4000, "CiA 402: temperature fault", "cool drive and motor, or lower the torque"),
    (0x5000, "CiA 402: device hardware fault", "restart the drive; if it comes again, replace it"),
    (0x6000, "CiA 402: device software fault", "restart the drive; check its parameters with the maker's tool"),
    (0x6300, "CiA 402: invalid parameters", "check the drive's parameters with the maker's tool"),
    (0x7000, "CiA 402: fault of an additional module", "read the fault with the maker's tool"),
    (0x7120, "CiA 402: motor fault", "free the column; check the motor and its wiring"),
    (0x7300, "CiA 402: sensor fault", "check the encoder and its wiring"),
    (0x7500, "CiA 402: communication fault", "check the cable and the loop's missed periods"),
    (0x8000, "CiA 402: monitoring fault", "read the fault with the maker's tool"),
    (0x8100, "CiA 402: communication monitoring", "check the cable and the loop's missed periods"),
    (0x8400, "CiA 402: speed limit", "raise the drive's speed limit"),
    (0x8600, "CiA 402: position limit", "move the column within the drive's limits"),
    (0x8700, "CiA 402: synchronization fault", "lower this computer's jitter: forcefeel bus names what is missing"),
    (0x9000, "CiA 402: external fault", "check what is wired to the drive's fault input"),
    (0xf000, "CiA 402: fault of the maker's own", "read the fault with the maker's tool"),
];
