//! The units of the parameter table: coherent SI inside, metric and U.S. customary units for people.

/// One physical quantity's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Coherent SI unit: what every number inside the program is in.
    pub si: &'static str,
    /// Metric unit that people read.
    pub metric: &'static str,
    /// U.S. customary unit that people read; `lb` is a pound of force.
    pub us: &'static str,
    /// SI units in one U.S. customary unit.
    pub si_per_us: f64,
}

const fn unit(si: &'static str, metric: &'static str, us: &'static str, si_per_us: f64) -> Unit {
    Unit { si, metric, us, si_per_us }
}

/// Meters in an inch (exact, international yard and pound agreement 1959).
const IN: f64 = 0.0254;
/// Newtons in a pound of force (exact: 0.453 592 37 kg times 9.806 65 m/s²).
const LB: f64 = 4.448_221_615_260_5;
/// Amperes in a milliampere.
const MA: f64 = 1e-3;

/// A pure number.
pub const RATIO: Unit = unit("", "", "", 1.0);
/// A yes or a no: 1 or 0.
pub const SWITCH: Unit = unit("switch", "switch", "switch", 1.0);
/// Time, as of a sample.
pub const TIME: Unit = unit("s", "ms", "ms", 1e-3);
/// Rate.
pub const RATE: Unit = unit("1/s", "1/s", "1/s", 1.0);
/// Angle.
pub const ANGLE: Unit = unit("rad", "deg", "deg", core::f64::consts::PI / 180.0);
/// What there is per angle.
pub const PER_ANGLE: Unit = unit("1/rad", "1/rad", "1/rad", 1.0);
/// Angular velocity.
pub const ANGULAR_VELOCITY: Unit = unit("rad/s", "deg/s", "deg/s", core::f64::consts::PI / 180.0);
/// Voltage.
pub const VOLTAGE: Unit = unit("V", "V", "V", 1.0);
/// Mass.
pub const MASS: Unit = unit("kg", "kg", "lbm", 0.453_592_37);
/// Torque.
pub const TORQUE: Unit = unit("N m", "N m", "lb in", LB * IN);
/// Length.
pub const LENGTH: Unit = unit("m", "cm", "in", IN);
/// Area.
pub const AREA: Unit = unit("m^2", "cm^2", "in^2", IN * IN);
/// Volume.
pub const VOLUME: Unit = unit("m^3", "cm^3", "in^3", IN * IN * IN);
/// Angular frequency.
pub const ANGULAR_FREQUENCY: Unit = unit("rad/s", "rad/s", "rad/s", 1.0);
/// Frequency in cycles; 1 Hz is 2π rad/s.
pub const FREQUENCY: Unit = unit("rad/s", "Hz", "Hz", core::f64::consts::TAU);
/// Force.
pub const FORCE: Unit = unit("N", "N", "lb", LB);
/// Change of a force in time.
pub const FORCE_RATE: Unit = unit("N/s", "N/s", "lb/s", LB);
/// Power.
pub const POWER: Unit = unit("W", "W", "W", 1.0);
/// Energy.
pub const ENERGY: Unit = unit("J", "J", "J", 1.0);
/// Torque of a motor per current.
pub const TORQUE_PER_CURRENT: Unit = unit("N m/A", "N m/A", "lb in/A", LB * IN);
/// Speed of a motor per voltage.
pub const SPEED_PER_VOLTAGE: Unit = unit("rad/(s V)", "rpm/V", "rpm/V", core::f64::consts::TAU / 60.0);
/// Back-EMF of a motor per speed; a krpm is 1000 revolutions per minute.
pub const VOLTAGE_PER_SPEED: Unit = unit("V s/rad", "V/krpm", "V/krpm", 0.06 / core::f64::consts::TAU);
/// Electric current of a motor.
pub const MOTOR_CURRENT: Unit = unit("A", "A", "A", 1.0);
/// Torque of a motor.
pub const MOTOR_TORQUE: Unit = unit("N m", "N m", "lb in", LB * IN);
/// Inertia of a rotor.
pub const ROTOR_INERTIA: Unit = unit("kg m^2", "kg cm^2", "lb in s^2", LB * IN);
/// Electric resistance.
pub const RESISTANCE: Unit = unit("ohm", "ohm", "ohm", 1.0);
/// Inductance.
pub const INDUCTANCE: Unit = unit("H", "mH", "mH", 1e-3);
/// Temperature on the scale that people read.
pub const TEMPERATURE: Unit = unit("degC", "degC", "degC", 1.0);
/// Share per difference of temperature.
pub const PER_TEMPERATURE: Unit = unit("1/K", "1/K", "1/K", 1.0);
/// Thermal resistance.
pub const THERMAL_RESISTANCE: Unit = unit("K/W", "K/W", "K/W", 1.0);
/// Heat capacity.
pub const HEAT_CAPACITY: Unit = unit("J/K", "J/K", "J/K", 1.0);
/// Pressure.
pub const PRESSURE: Unit = unit("Pa", "MPa", "lb/in^2", LB / (IN * IN));
/// Electric current.
pub const CURRENT: Unit = unit("A", "mA", "mA", MA);
/// Volume flow.
pub const FLOW: Unit = unit("m^3/s", "cm^3/s", "in^3/s", IN * IN * IN);
/// Valve current gain.
pub const FLOW_PER_CURRENT: Unit = unit("m^3/(s A)", "cm^3/(s mA)", "in^3/(s mA)", IN * IN * IN / MA);
/// Valve pressure gain.
pub const FLOW_PER_PRESSURE: Unit = unit("m^5/(N s)", "cm^5/(N s)", "in^5/(lb s)", IN * IN * IN * IN * IN / LB);
/// Amplifier admittance.
pub const CURRENT_PER_VOLTAGE: Unit = unit("A/V", "mA/V", "mA/V", MA);
/// Position transducer gain.
pub const VOLTAGE_PER_LENGTH: Unit = unit("V/m", "V/cm", "V/in", 1.0 / IN);
/// Force transducer gain.
pub const VOLTAGE_PER_FORCE: Unit = unit("V/N", "V/N", "V/lb", 1.0 / LB);
/// Linear spring rate.
pub const STIFFNESS: Unit = unit("N/m", "N/cm", "lb/in", LB / IN);
/// Linear damping.
pub const DAMPING: Unit = unit("N s/m", "N s/cm", "lb s/in", LB / IN);
/// Rotary spring rate.
pub const ROTARY_STIFFNESS: Unit = unit("N m/rad", "N m/rad", "lb in/rad", LB * IN);
/// Rotary damping.
pub const ROTARY_DAMPING: Unit = unit("N m s/rad", "N m s/rad", "lb in s/rad", LB * IN);
/// Damping that grows with the square of the angular velocity.
pub const QUADRATIC_DAMPING: Unit = unit("N m s^2/rad^2", "N m s^2/rad^2", "lb in s^2/rad^2", LB * IN);
/// Mass moment of inertia.
pub const INERTIA: Unit = unit("N m s^2/rad", "N m s^2/rad", "lb in s^2/rad", LB * IN);
