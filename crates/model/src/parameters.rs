//! THE table of parameters: one row each. Everything that needs to know a parameter reads it here.
//!
//! The default column is the elevator loader of the 1974 report, in the U.S. customary units in which its "measurements
//! and calculations were made"; [`Parameter::default_si`] converts. A new parameter is one new row.
//!
//! Rows marked `optional` stand for what a real loader does beyond the report's linear models. Each has a value that holds
//! where a loader file does not give it, with which the models are the report's.
//!
//! Rows marked `alternative` are another way to state rows of the same part; a loader gives one or the other:
//!
//! | stated as | instead of | by |
//! |---|---|---|
//! | valve operating point | `C_i`, `C_p` | [`Valve::gains_at`](crate::drive::hydraulic::valve), eqs. (1)-(2) |
//! | linkage resonance | `k`, `c` | [`Linkage::from_resonance`](crate::linkage), appendix |
//! | feel frequency and damping ratio | `I`, `B` | [`Feel::from_frequency`](crate::feel), eq. (11) |
//! | data sheet of motor, drive or gear | `K_t`, `R`, `L`, limits, `r`, `b_t` | the loader file's reader |

use crate::units::{self, Unit};

/// One row of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// The part that it belongs to; a table of the loader file.
    pub part: &'static str,
    /// Its name within the part; a key of the loader file.
    pub name: &'static str,
    /// The report's letter.
    pub symbol: &'static str,
    /// What it means, in a line.
    pub meaning: &'static str,
    /// Its units.
    pub unit: Unit,
    /// The elevator loader's value, in U.S. customary units; for an optional row an example.
    pub default_us: f64,
    /// The value, in U.S. customary units, that stands where a loader does not give an optional row: the one that switches
    /// its effect off, or what goes with the effect unless said otherwise. Nothing for a row that a loader must give.
    pub off_us: Option<f64>,
    /// The smallest accepted value, in U.S. customary units.
    pub minimum_us: f64,
    /// The largest accepted value, in U.S. customary units.
    pub maximum_us: f64,
    /// Where the elevator loader's value comes from.
    pub source: &'static str,
    /// Names of the rows that this row may state in their stead; empty for the rows that make a loader.
    pub instead_of: &'static [&'static str],
}

impl Parameter {
    /// The elevator loader's value in SI units; for an optional row an example.
    pub fn default_si(&self) -> f64 {
        self.default_us * self.unit.si_per_us
    }

    /// The value in SI units where a loader does not give the row.
    pub fn off_si(&self) -> Option<f64> {
        self.off_us.map(|off| off * self.unit.si_per_us)
    }
}

macro_rules! names {
    ([ $($name:ident),* ]) => { &[ $(stringify!($name)),* ] };
}

macro_rules! parameter_table {
    ($(
        #[doc = $doc:literal]
        $part:ident: $Part:ident {
            $( $name:ident: $symbol:literal, $meaning:literal, $unit:ident, $default:expr, $minimum:literal .. $maximum:literal, $source:literal; )*
        }
        optional {
            $( $extra:ident: $esymbol:literal, $emeaning:literal, $eunit:ident, $eexample:expr, $eminimum:literal .. $emaximum:literal, off $eoff:expr; )*
        }
        $(alternative to $replaced:tt {
            $( $other:ident: $osymbol:literal, $omeaning:literal, $ounit:ident, $odefault:expr, $ominimum:literal .. $omaximum:literal, $osource:literal; )*
        })*
    )*) => {
        $(
            #[doc = $doc]
            #[derive(Debug, Clone, Copy, PartialEq)]
            pub struct $Part<S> {
                $( #[doc = concat!("`", $symbol, "`: ", $meaning, ".")] pub $name: S, )*
                $( #[doc = concat!("`", $esymbol, "`: ", $emeaning, ".")] pub $extra: S, )*
            }
        )*

        $(
            impl<S: Copy> $Part<S> {
                /// The same part in another number type.
                pub fn map<T>(&self, convert: impl Fn(S) -> T) -> $Part<T> {
                    $Part { $( $name: convert(self.$name), )* $( $extra: convert(self.$extra), )* }
                }
            }
        )*

        /// The numbers of one loader, part by part, in SI units.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Parameters<S> {
            $( #[doc = $doc] pub $part: $Part<S>, )*
        }

        /// The rows that make a [`Parameters`], in the order of its values.
        pub const TABLE: &[Parameter] = &[ $( $( Parameter {
            part: stringify!($part), name: stringify!($name), symbol: $symbol, meaning: $meaning, unit: units::$unit,
            default_us: $default, off_us: None, minimum_us: $minimum, maximum_us: $maximum, source: $source, instead_of: &[],
        }, )* $( Parameter {
            part: stringify!($part), name: stringify!($extra), symbol: $esymbol, meaning: $emeaning, unit: units::$eunit,
            default_us: $eexample, off_us: Some($eoff), minimum_us: $eminimum, maximum_us: $emaximum, source: "example",
            instead_of: &[],
        }, )* )* ];

        /// The rows that a loader file may give instead of others.
        pub const ALTERNATIVES: &[Parameter] = &[ $( $( $( Parameter {
            part: stringify!($part), name: stringify!($other), symbol: $osymbol, meaning: $omeaning, unit: units::$ounit,
            default_us: $odefault, off_us: None, minimum_us: $ominimum, maximum_us: $omaximum, source: $osource, instead_of: names!($replaced),
        }, )* )* )* ];

        /// The parts and what each is.
        pub const PARTS: &[(&str, &str)] = &[ $( (stringify!($part), $doc.trim_ascii()) ),* ];

        /// How many values a [`Parameters`] holds.
        pub const COUNT: usize = TABLE.len();

        impl<S: Copy> Parameters<S> {
            /// From values in the order of [`TABLE`], SI units.
            #[inline(always)]
            pub fn from_values(values: &[S; COUNT]) -> Self {
                let mut next = 0;
                let mut take = || { next += 1; values[next - 1] };
                Self { $( $part: $Part { $( $name: take(), )* $( $extra: take(), )* }, )* }
            }

            /// The same loader in another number type.
            pub fn map<T>(&self, convert: impl Fn(S) -> T + Copy) -> Parameters<T> {
                Parameters { $( $part: self.$part.map(convert), )* }
            }

            /// The values in the order of [`TABLE`], SI units.
            pub fn values(&self) -> [S; COUNT] {
                [ $( $( self.$part.$name, )* $( self.$part.$extra, )* )* ]
            }
        }
    };
}

parameter_table! {
    /// Servo amplifier: voltage in, valve current out.
    amplifier: Amplifier {
        admittance: "K_2", "valve current per volt at the amplifier's input", CURRENT_PER_VOLTAGE, 1.56, 1e-3..1e3, "appendix";
    }
    optional {
        current_limit: "i_max", "largest current that the amplifier delivers", CURRENT, 15.0, 1e-3..1e5, off f64::INFINITY;
    }

    /// Four-way, two-stage electrohydraulic control valve.
    valve: Valve {
        current_gain: "C_i", "flow per unit of valve current at the operating point, eq. (2)", FLOW_PER_CURRENT, 5.45, 1e-4..1e4, "appendix";
        pressure_gain: "C_p", "flow lost per unit of load pressure at the operating point, eq. (2)", FLOW_PER_PRESSURE, 0.0102, 1e-7..1e2, "appendix";
        natural_frequency: "w_n", "natural frequency of the valve's flow response", ANGULAR_FREQUENCY, 377.0, 1.0..1e5, "appendix";
        damping_ratio: "zeta", "damping ratio of the valve's flow response", RATIO, 0.9, 0.05..10.0, "appendix";
        rated_flow: "q_r", "flow at rated current and no load pressure", FLOW, 100.0, 1e-2..1e5, "appendix";
        rated_current: "i_r", "largest valve current", CURRENT, 15.0, 0.1..1e4, "appendix";
        supply_pressure: "p_s", "supply pressure less return pressure", PRESSURE, 1200.0, 10.0..1e5, "appendix";
    }
    optional {
        orifice: "eq. (1)", "whether the flow follows the orifice, eq. (1), or the gains C_i, C_p", SWITCH, 1.0, 0.0..1.0, off 0.0;
        flow_limit: "q_max", "largest flow that the spool's stroke lets through at no load", FLOW, 100.0, 1e-3..1e6, off f64::INFINITY;
    }
    alternative to [current_gain, pressure_gain] {
        operating_current: "i*/i_r", "valve current at the operating point, as a share of the rated current", RATIO, 0.2, 1e-3..1.0, "page of eq. (2)";
        operating_pressure: "p*/p_s", "load pressure at the operating point, as a share of the supply pressure", RATIO, 0.33, 0.0..0.99, "page of eq. (2)";
    }

    /// Double-acting hydraulic actuator.
    actuator: Actuator {
        area: "A", "piston area", AREA, 2.36, 1e-3..1e3, "appendix";
        oil_volume: "V_E", "effective volume of compressed oil", VOLUME, 11.7, 1e-3..1e5, "appendix";
        bulk_modulus: "beta", "bulk modulus of the oil", PRESSURE, 250_000.0, 1e3..1e6, "appendix";
    }
    optional {
        relief_pressure: "p_relief", "load pressure above which oil passes by the piston", PRESSURE, 1500.0, 1.0..1e5, off f64::INFINITY;
        relief_gain: "C_relief", "flow past the piston per unit of pressure above the relief pressure", FLOW_PER_PRESSURE, 1.0, 1e-4..1e3, off 1.0;
        seal_friction: "F_seal", "dry friction of the seals on the moving piston, which no load cell in the linkage shows", FORCE, 5.0, 0.0..1e5, off 0.0;
    }

    /// Electric motor: torque from current.
    motor: Motor {
        torque_constant: "K_t", "torque per ampere: of the peak of a phase of three, or of a brushed motor's current", TORQUE_PER_CURRENT, 3.0667, 1e-3..1e4, "servo motor";
        inertia: "J_m", "inertia of the rotor, with all that turns with it", ROTOR_INERTIA, 0.001_593_15, 1e-8..1e4, "servo motor";
    }
    optional {
        three_phase: "n", "whether the winding has three phases, in place of a brushed motor's one", SWITCH, 1.0, 0.0..1.0, off 0.0;
        viscous_friction: "B_m", "viscous friction of the rotor", ROTARY_DAMPING, 0.001, 0.0..1e4, off 0.0;
        coulomb_friction: "T_c", "dry friction of bearings and seals while the rotor turns", MOTOR_TORQUE, 0.2, 0.0..1e4, off 0.0;
        static_friction: "T_s", "torque at which the resting rotor breaks away; at least the dry friction", MOTOR_TORQUE, 0.3, 0.0..1e4, off 0.0;
        cogging_torque: "T_1", "amplitude of the cogging torque", MOTOR_TORQUE, 0.2, 0.0..1e3, off 0.0;
        cogging_periods: "N_1", "its periods per turn of the motor", RATIO, 24.0, 1.0..1e3, off 24.0;
        cogging_phase: "phi_1", "its phase at the motor's zero", ANGLE, 0.0, -360.0..360.0, off 0.0;
        cogging_torque_2: "T_2", "amplitude of a second harmonic of the cogging torque", MOTOR_TORQUE, 0.05, 0.0..1e3, off 0.0;
        cogging_periods_2: "N_2", "its periods per turn of the motor", RATIO, 48.0, 1.0..1e3, off 48.0;
        cogging_phase_2: "phi_2", "its phase at the motor's zero", ANGLE, 0.0, -360.0..360.0, off 0.0;
    }
    alternative to [torque_constant] {
        torque_constant_peak: "K_t,peak", "torque per peak ampere of a phase of three", TORQUE_PER_CURRENT, 3.0667, 1e-3..1e4, "servo motor";
        torque_constant_rms: "K_t,rms", "torque per r.m.s. ampere of a phase of three", TORQUE_PER_CURRENT, 4.337, 1e-3..1e4, "servo motor";
        speed_constant: "K_v", "speed without load per volt at the terminals of a brushed or block-commutated motor", SPEED_PER_VOLTAGE, 27.56, 1e-2..1e5, "servo motor";
        speed_constant_peak: "K_v,peak", "speed without load per peak volt between two of three phases", SPEED_PER_VOLTAGE, 23.87, 1e-2..1e5, "servo motor";
        speed_constant_rms: "K_v,rms", "speed without load per r.m.s. volt between two of three phases", SPEED_PER_VOLTAGE, 33.75, 1e-2..1e5, "servo motor";
        voltage_constant: "K_e", "back-EMF at the terminals of a brushed or block-commutated motor", VOLTAGE_PER_SPEED, 36.28, 1e-2..1e5, "servo motor";
        voltage_constant_peak: "K_e,peak", "peak of the back-EMF between two of three phases", VOLTAGE_PER_SPEED, 41.9, 1e-2..1e5, "servo motor";
        voltage_constant_rms: "K_e,rms", "r.m.s. of the back-EMF between two of three phases", VOLTAGE_PER_SPEED, 29.63, 1e-2..1e5, "servo motor";
    }

    /// Winding of the motor.
    winding: Winding {
        resistance: "R", "resistance of a phase, or of a brushed motor's terminals, at the temperature around", RESISTANCE, 1.535, 1e-5..1e4, "servo motor";
        inductance: "L", "inductance of a phase, or of a brushed motor's terminals", INDUCTANCE, 3.285, 1e-5..1e4, "servo motor";
    }
    optional {
        temperature_coefficient: "a_R", "share by which the resistance grows per degree", PER_TEMPERATURE, 0.00393, 0.0..0.1, off 0.0;
    }
    alternative to [resistance, inductance] {
        resistance_line_to_line: "R_ll", "resistance between two of three phases", RESISTANCE, 3.07, 1e-5..1e4, "servo motor";
        inductance_line_to_line: "L_ll", "inductance between two of three phases", INDUCTANCE, 6.57, 1e-5..1e4, "servo motor";
        resistance_phase: "R_ph", "resistance of one of three phases", RESISTANCE, 1.535, 1e-5..1e4, "servo motor";
        inductance_phase: "L_ph", "inductance of one of three phases", INDUCTANCE, 3.285, 1e-5..1e4, "servo motor";
    }

    /// Current loop of the motor's amplifier: it makes the current follow the command, which is in A.
    current_loop: CurrentLoop {
        bandwidth: "w_c / 2 pi", "bandwidth of the current loop, a first-order lag", FREQUENCY, 1000.0, 10.0..2e4, "illustrative";
    }
    optional {
        current_limit: "i_max", "largest current, peak of a phase", MOTOR_CURRENT, 19.0, 1e-3..1e4, off f64::INFINITY;
        voltage_limit: "u_max", "largest voltage of a phase, peak; of three phases the supply over the root of 3", VOLTAGE, 179.0, 0.1..1e5, off f64::INFINITY;
        continuous_current: "i_c", "current that the drive gives without end, peak of a phase; for sizing", MOTOR_CURRENT, 6.0, 1e-3..1e4, off f64::INFINITY;
        peak_time: "t_p", "time for which the drive gives more than its continuous current; for sizing", TIME, 2000.0, 1.0..1e6, off f64::INFINITY;
    }
    alternative to [current_limit] {
        current_limit_peak: "i_max,peak", "largest current, peak of one of three phases", MOTOR_CURRENT, 19.0, 1e-3..1e4, "illustrative";
        current_limit_rms: "i_max,rms", "largest current, r.m.s. of one of three phases", MOTOR_CURRENT, 13.43, 1e-3..1e4, "illustrative";
    }
    alternative to [continuous_current] {
        continuous_current_peak: "i_c,peak", "continuous current of the drive, peak of one of three phases", MOTOR_CURRENT, 6.0, 1e-3..1e4, "illustrative";
        continuous_current_rms: "i_c,rms", "continuous current of the drive, r.m.s. of one of three phases", MOTOR_CURRENT, 4.243, 1e-3..1e4, "illustrative";
    }
    alternative to [voltage_limit] {
        supply_voltage: "U", "voltage of the drive's supply or link", VOLTAGE, 310.0, 0.1..1e5, "servo motor";
    }

    /// Transmission from the motor to the linkage: gear, belt, capstan or ballscrew.
    transmission: Transmission {
        travel: "r", "travel of the linkage's end per radian of the motor: radius of a capstan, lead of a screw over 2 pi", LENGTH, 0.7874, 1e-4..100.0, "illustrative";
    }
    optional {
        stiffness: "k_t", "spring rate of the transmission at the linkage's end; its damping is to it as the link's to the link's own", STIFFNESS, 20000.0, 1.0..1e8, off f64::INFINITY;
        backlash: "b_t", "free play of the transmission at the linkage's end", LENGTH, 0.002, 0.0..1.0, off 0.0;
        efficiency: "eta", "share of the motor's power that arrives at the linkage", RATIO, 0.9, 0.05..1.0, off 1.0;
        backdriving_efficiency: "eta_b", "share of the linkage's power that arrives at the motor", RATIO, 0.9, 0.05..1.0, off 1.0;
    }
    alternative to [travel] {
        lead: "2 pi r", "travel of the linkage's end per turn of the motor or, with gear_ratio, of the gear's output", LENGTH, 4.9474, 1e-3..1e3, "illustrative";
        radius: "r_o", "radius of the pulley, capstan or arm at the motor or, with gear_ratio, at the gear's output", LENGTH, 0.7874, 1e-4..100.0, "illustrative";
        gear_ratio: "N", "turns of the motor per turn of the gear's output", RATIO, 5.0, 1e-3..1e4, "illustrative";
    }
    alternative to [backlash] {
        backlash_angle: "b_g", "free play at the output of a gear, or at the motor", ANGLE, 0.05, 0.0..90.0, "illustrative";
    }

    /// Heat of the motor: winding and housing as two masses.
    thermal: Thermal {}
    optional {
        winding_resistance: "R_wh", "thermal resistance from the winding to the housing", THERMAL_RESISTANCE, 1.0, 1e-4..1e3, off f64::INFINITY;
        housing_resistance: "R_ha", "thermal resistance from the housing to the air", THERMAL_RESISTANCE, 1.5, 1e-4..1e3, off f64::INFINITY;
        winding_capacity: "C_w", "heat capacity of the winding", HEAT_CAPACITY, 100.0, 1e-2..1e6, off f64::INFINITY;
        housing_capacity: "C_h", "heat capacity of the housing", HEAT_CAPACITY, 1000.0, 1e-2..1e7, off f64::INFINITY;
        ambient: "T_a", "temperature around", TEMPERATURE, 25.0, -50.0..100.0, off 25.0;
        derating_from: "T_d", "temperature of the winding above which the largest current falls", TEMPERATURE, 110.0, 20.0..300.0, off 110.0;
        winding_limit: "T_max", "temperature of the winding at which none is left", TEMPERATURE, 130.0, 30.0..400.0, off 130.0;
    }

    /// Brake on the motor's shaft.
    brake: Brake {}
    optional {
        torque: "T_b", "torque that the brake holds", MOTOR_TORQUE, 20.0, 1e-3..1e5, off 0.0;
        engaged: "brake", "whether the brake is on", SWITCH, 1.0, 0.0..1.0, off 0.0;
    }

    /// Link between the drive's load cell and the base of the column.
    linkage: Linkage {
        ratio: "alpha", "linkage ratio l_2 / (l_1 + l_2): travel of the drive per travel of the column's base", RATIO, 0.59, 1e-2..1.0, "appendix";
        stiffness: "k", "spring rate of the linkage", STIFFNESS, 6107.86, 1.0..1e8, "appendix";
        damping: "c", "damping coefficient of the linkage", DAMPING, 16.2016, 1e-3..1e6, "appendix";
    }
    optional {
        backlash: "b", "free play of the link, measured at the drive", LENGTH, 0.002, 0.0..1.0, off 0.0;
    }
    alternative to [stiffness, damping] {
        resonance_frequency: "w_link / 2 pi", "frequency at which the column swings on the linkage", FREQUENCY, 12.0, 0.1..1e3, "page of figure 8";
        resonance_damping_ratio: "zeta_link", "damping ratio of the column swinging on the linkage", RATIO, 0.1, 1e-3..1.0, "page of figure 8";
    }

    /// Control column: any grip that turns about a pivot.
    column: Column {
        inertia: "J", "mass moment of inertia of the column about its pivot", INERTIA, 37.4, 1e-4..1e5, "appendix";
        base_arm: "R_b", "lever arm of the column's base", LENGTH, 10.0, 0.05..200.0, "appendix";
        grip_arm: "R_p", "lever arm of the pilot's force", LENGTH, 31.375, 0.05..200.0, "appendix";
    }
    optional {
        viscous_friction: "B_c", "viscous friction of the column about its pivot", ROTARY_DAMPING, 10.0, 0.0..1e6, off 0.0;
        coulomb_friction: "F_c", "dry friction of the moving column, as force at the grip", FORCE, 3.0, 0.0..1e4, off 0.0;
        static_friction: "F_s", "force at the grip at which the resting column breaks away; at least the dry friction", FORCE, 4.0, 0.0..1e4, off 0.0;
        stribeck_velocity: "omega_s", "velocity over which the friction falls from breakaway to dry friction; a jump unless given", ANGULAR_VELOCITY, 3.0, 0.0..1e4, off 0.0;
        friction_asymmetry: "a_F", "share by which friction and breakaway are larger towards positive angles, and smaller towards negative ones", RATIO, 0.1, -0.9..0.9, off 0.0;
        gravity_torque: "U", "weight of the column times the distance of its center of gravity from the pivot", TORQUE, 100.0, 0.0..1e6, off 0.0;
        gravity_angle: "phi_U", "angle of the center of gravity from the vertical above the pivot, column at neutral", ANGLE, 0.0, -180.0..180.0, off 0.0;
        stop_low: "theta_min", "lower end stop", ANGLE, -20.0, -180.0..0.0, off f64::NEG_INFINITY;
        stop_high: "theta_max", "upper end stop", ANGLE, 20.0, 0.0..180.0, off f64::INFINITY;
        stop_stiffness: "k_stop", "spring rate of the end stops", ROTARY_STIFFNESS, 5e5, 1.0..1e9, off 5e5;
        stop_damping: "c_stop", "damping of the end stops", ROTARY_DAMPING, 1000.0, 0.0..1e7, off 1000.0;
    }

    /// Load cell between drive and linkage.
    load_cell: LoadCell {
        gain: "K_1", "load cell circuit's output per unit of force", VOLTAGE_PER_FORCE, 0.005, 1e-7..10.0, "appendix";
    }
    optional {
        offset: "F_0", "offset of the load cell", FORCE, 0.5, -1e4..1e4, off 0.0;
        noise: "sigma_F", "noise of a sample of the load cell, r.m.s.", FORCE, 0.1, 0.0..1e4, off 0.0;
        resolution: "dF", "smallest step of the load cell", FORCE, 0.05, 0.0..1e4, off 0.0;
        bandwidth: "f_F", "bandwidth of the load cell, a first-order lag", FREQUENCY, 500.0, 0.1..1e5, off f64::INFINITY;
    }

    /// Sensor of the drive's position: a potentiometer, or any other.
    potentiometer: Potentiometer {
        gain: "K_3", "potentiometer circuit's output per unit of piston travel", VOLTAGE_PER_LENGTH, 7.632, 1e-3..1e4, "appendix";
    }
    optional {
        offset: "x_0", "offset of the drive's position", LENGTH, 0.001, -10.0..10.0, off 0.0;
        noise: "sigma_x", "noise of a sample of the drive's position, r.m.s.", LENGTH, 0.0005, 0.0..1.0, off 0.0;
        resolution: "dx", "smallest step of the drive's position", LENGTH, 0.0005, 0.0..1.0, off 0.0;
        bandwidth: "f_x", "bandwidth of the position's sensor, a first-order lag", FREQUENCY, 500.0, 0.1..1e5, off f64::INFINITY;
    }

    /// Sensor of the column's angle.
    column_sensor: ColumnSensor {}
    optional {
        offset: "theta_0", "offset of the column's sensor", ANGLE, 0.05, -10.0..10.0, off 0.0;
        noise: "sigma_theta", "noise of a sample of the column's angle, r.m.s.", ANGLE, 0.005, 0.0..10.0, off 0.0;
        resolution: "dtheta", "smallest step of the column's angle", ANGLE, 0.005, 0.0..10.0, off 0.0;
        bandwidth: "f_theta", "bandwidth of the column's sensor, a first-order lag", FREQUENCY, 500.0, 0.1..1e5, off f64::INFINITY;
    }

    /// Force sensor at the grip, between hand and column; there is none unless its gain is given.
    grip_sensor: GripSensor {}
    optional {
        gain: "K_g", "share of the force at the grip that the sensor shows; 1 as calibrated", RATIO, 1.0, 1e-2..100.0, off 0.0;
        mass: "m_o", "mass outboard of the sensor, part of J and felt by the hand before the sensor", MASS, 0.5, 0.0..10.0, off 0.0;
        offset: "F_0g", "offset of the grip's sensor", FORCE, 0.2, -1e4..1e4, off 0.0;
        noise: "sigma_g", "noise of a sample of the grip's sensor, r.m.s.", FORCE, 0.02, 1e-6..1e4, off 0.0;
        resolution: "dF_g", "smallest step of the grip's sensor", FORCE, 0.01, 0.0..10.0, off 0.0;
        bandwidth: "f_g", "bandwidth of the grip's sensor, a first-order lag", FREQUENCY, 500.0, 0.1..1e5, off f64::INFINITY;
    }

    /// Digital controller that runs the feel computer and the compensator; analog, without delay, unless a period is given.
    controller: Controller {}
    optional {
        period: "T", "sample period", TIME, 0.5, 1e-2..100.0, off 0.0;
        delay: "tau", "time from the sample to its command", TIME, 0.5, 0.0..100.0, off 0.0;
        input_range: "E_in", "largest voltage that the input converters take", VOLTAGE, 10.0, 1e-3..1e4, off f64::INFINITY;
        input_bits: "n_in", "bits of the input converters over twice their range", RATIO, 16.0, 1.0..52.0, off 0.0;
        output_range: "E_out", "largest voltage that the output converter gives", VOLTAGE, 10.0, 1e-3..1e4, off f64::INFINITY;
        output_bits: "n_out", "bits of the output converter over twice its range", RATIO, 16.0, 1.0..52.0, off 0.0;
        antiwindup: "a_w", "rate at which the programmed displacement gives way while the command is cut off", RATE, 100.0, 0.0..1e5, off 0.0;
    }

    /// Feel computer: the programmed inertia, damping and stiffness.
    feel: Feel {
        inertia: "I", "programmed inertia of the control", INERTIA, 60.0, 1e-6..1e7, "appendix";
        damping: "B", "programmed damping of the control", ROTARY_DAMPING, 304.0, 0.0..1e8, "appendix";
        stiffness: "G", "programmed spring rate of the control", ROTARY_STIFFNESS, 9600.0, 1e-3..1e8, "appendix";
        maximum_stiffness: "G_max", "largest programmed spring rate; scales the load cell's channel", ROTARY_STIFFNESS, 28800.0, 1e-3..1e8, "appendix";
    }
    optional {
        coulomb_friction: "F_cf", "programmed dry friction while moving, as force at the grip", FORCE, 2.0, 0.0..1e4, off 0.0;
        static_friction: "F_sf", "programmed force at the grip at which the resting control breaks away; at least the dry friction", FORCE, 3.0, 0.0..1e4, off 0.0;
        quadratic_damping: "B_2", "programmed damping that grows with the square of the velocity", QUADRATIC_DAMPING, 50.0, 0.0..1e7, off 0.0;
        deadband: "phi_d", "angle to either side of neutral within which the spring does not act", ANGLE, 0.5, 0.0..90.0, off 0.0;
        breakout: "F_b", "force at the grip that it takes to leave neutral, over the friction", FORCE, 4.0, 0.0..1e4, off 0.0;
        breakout_travel: "phi_b", "angle over which the breakout force builds up", ANGLE, 0.1, 1e-3..10.0, off 0.1;
        preload: "F_0f", "constant force at the grip towards negative angles", FORCE, 5.0, -1e4..1e4, off 0.0;
        hysteresis: "F_h", "force at the grip by which way and way back differ from their mean", FORCE, 1.0, 0.0..1e4, off 0.0;
        hysteresis_travel: "phi_h", "angle over which the hysteresis turns round", ANGLE, 0.2, 1e-3..10.0, off 0.2;
        detent_force: "F_d", "force at the grip that it takes to leave the detent", FORCE, 3.0, 0.0..1e4, off 0.0;
        detent_angle: "phi_det", "where the detent is", ANGLE, 5.0, -180.0..180.0, off 0.0;
        detent_travel: "w_det", "angle from the detent to its largest force", ANGLE, 1.0, 1e-3..90.0, off 1.0;
        soft_stop_low: "phi_s1", "angle below which the lower soft stop pushes back", ANGLE, -15.0, -180.0..180.0, off f64::NEG_INFINITY;
        soft_stop_high: "phi_s2", "angle above which the upper soft stop pushes back", ANGLE, 15.0, -180.0..180.0, off f64::INFINITY;
        soft_stop_stiffness: "k_s", "spring rate of the soft stops", ROTARY_STIFFNESS, 5e4, 1.0..1e9, off 5e4;
        soft_stop_damping: "c_s", "damping of the soft stops", ROTARY_DAMPING, 100.0, 0.0..1e7, off 0.0;
        hard_stop_low: "phi_h1", "lowest angle of the programmed control", ANGLE, -18.0, -180.0..180.0, off f64::NEG_INFINITY;
        hard_stop_high: "phi_h2", "highest angle of the programmed control", ANGLE, 18.0, -180.0..180.0, off f64::INFINITY;
        velocity_limit: "phi'_max", "largest angular velocity of the programmed control", ANGULAR_VELOCITY, 60.0, 0.1..1e5, off f64::INFINITY;
        trim_rate: "n'_max", "largest angular velocity of the trimmed neutral", ANGULAR_VELOCITY, 2.0, 1e-3..1e5, off f64::INFINITY;
        shaker_force: "F_sh", "amplitude of the stick shaker, as force at the grip", FORCE, 10.0, 0.0..1e4, off 0.0;
        shaker_frequency: "f_sh", "frequency of the stick shaker", FREQUENCY, 20.0, 0.1..200.0, off 20.0;
    }
    alternative to [inertia, damping] {
        natural_frequency: "sqrt(G/I) / 2 pi", "programmed natural frequency", FREQUENCY, 2.0, 1e-3..100.0, "appendix, page of [Q]";
        damping_ratio: "B / (2 sqrt(G I))", "programmed damping ratio", RATIO, 0.2, 0.0..100.0, "appendix, page of [Q]";
    }

    /// Control surface that a reversible control moves; its hinge moment comes from the flight state that an aircraft simulator sends.
    surface: Surface {}
    optional {
        area: "S_h", "area behind the hinge; there is no surface unless it is given", AREA, 3456.0, 1e-2..1e6, off 0.0;
        chord: "c_h", "mean chord behind the hinge", LENGTH, 18.0, 1e-2..1e3, off 0.0;
        gearing: "k_h", "angle of the surface per angle of the control, at its neutral; negative where a positive control moves the surface to negative angles", RATIO, 1.0, -20.0..20.0, off 0.0;
        gearing_change: "k_h'", "share by which the gearing changes per radian of the control", PER_ANGLE, 0.2, -10.0..10.0, off 0.0;
        at_zero: "C_0", "coefficient of the hinge moment with all angles zero", RATIO, 0.01, -1.0..1.0, off 0.0;
        per_flow: "C_alpha", "coefficient per angle of attack at the surface", PER_ANGLE, -0.1, -5.0..5.0, off 0.0;
        per_deflection: "C_delta", "coefficient per angle of the surface; negative where it trails", PER_ANGLE, -0.3, -5.0..5.0, off 0.0;
        per_tab: "C_tau", "coefficient per angle of the tab", PER_ANGLE, -0.1, -5.0..5.0, off 0.0;
        per_rate: "C_rate", "coefficient per delta' c / (2 V): damping by the surface's own rate", PER_ANGLE, -0.5, -50.0..50.0, off 0.0;
        share: "s_h", "share of the hinge moment that reaches the control: 1 reversible, below it boosted, 0 irreversible", RATIO, 0.5, 0.0..1.0, off 1.0;
        pressure_ratio: "eta_h", "dynamic pressure at the surface per that of the flight", RATIO, 0.9, 0.0..5.0, off 1.0;
        flow_per_attack: "a_h", "angle of attack at the surface per that of the aircraft, less the downwash", RATIO, 0.6, -5.0..5.0, off 0.0;
        flow_per_sideslip: "b_h", "the same per sideslip", RATIO, 1.0, -5.0..5.0, off 0.0;
        incidence: "i_h", "angle of attack at the surface with that of the aircraft zero", ANGLE, -2.0, -45.0..45.0, off 0.0;
        roll_arm: "l_p", "arm by which a rate of roll changes that angle", LENGTH, 100.0, -1e4..1e4, off 0.0;
        pitch_arm: "l_q", "arm by which a rate of pitch does: of a tail, its distance behind the center of gravity", LENGTH, 180.0, -1e4..1e4, off 0.0;
        yaw_arm: "l_r", "arm by which a rate of yaw does", LENGTH, 180.0, -1e4..1e4, off 0.0;
        tab_gearing: "k_tau", "angle of the tab per angle of the surface: negative of a balance tab, positive of an anti-servo tab", RATIO, -0.3, -10.0..10.0, off 0.0;
        tab_stiffness: "k_tab", "torque at the control per angle of a spring tab; small of a servo tab", ROTARY_STIFFNESS, 1000.0, 1e-3..1e8, off f64::INFINITY;
        cable_stiffness: "k_cable", "spring rate of the cables between control and surface, at the control", ROTARY_STIFFNESS, 20000.0, 1.0..1e9, off f64::INFINITY;
        compressible: "M_h", "whether the coefficients of the angles grow with the Mach number, as 1 / sqrt(1 - M^2) up to 0.8", SWITCH, 1.0, 0.0..1.0, off 0.0;
        mach_1: "M_1", "first Mach number of the table of the coefficients' factors, which are 1 at Mach 0", RATIO, 0.6, 1e-3..10.0, off f64::INFINITY;
        mach_2: "M_2", "second Mach number of the table of the coefficients' factors, which are 1 at Mach 0", RATIO, 0.8, 2e-3..10.0, off f64::INFINITY;
        mach_3: "M_3", "third Mach number of the table of the coefficients' factors, which are 1 at Mach 0", RATIO, 0.95, 3e-3..10.0, off f64::INFINITY;
        flow_factor_1: "f_alpha1", "factor of C_alpha at the first Mach number of the table", RATIO, 1.1, -20.0..20.0, off 1.0;
        flow_factor_2: "f_alpha2", "factor of C_alpha at the second Mach number of the table", RATIO, 1.3, -20.0..20.0, off 1.0;
        flow_factor_3: "f_alpha3", "factor of C_alpha at the third Mach number of the table", RATIO, 1.2, -20.0..20.0, off 1.0;
        deflection_factor_1: "f_delta1", "factor of C_delta at the first Mach number of the table", RATIO, 1.1, -20.0..20.0, off 1.0;
        deflection_factor_2: "f_delta2", "factor of C_delta at the second Mach number of the table", RATIO, 1.5, -20.0..20.0, off 1.0;
        deflection_factor_3: "f_delta3", "factor of C_delta at the third Mach number of the table", RATIO, 2.0, -20.0..20.0, off 1.0;
        tab_factor_1: "f_tau1", "factor of C_tau at the first Mach number of the table", RATIO, 0.9, -20.0..20.0, off 1.0;
        tab_factor_2: "f_tau2", "factor of C_tau at the second Mach number of the table", RATIO, 0.8, -20.0..20.0, off 1.0;
        tab_factor_3: "f_tau3", "factor of C_tau at the third Mach number of the table", RATIO, 0.5, -20.0..20.0, off 1.0;
        deflection_1: "delta_1", "first angle of the surface in the table of the coefficient over it, which is there in place of C_delta", ANGLE, -25.0, -90.0..84.0, off f64::INFINITY;
        deflection_2: "delta_2", "second angle of the surface in the table of the coefficient over it, which is there in place of C_delta", ANGLE, -15.0, -89.0..85.0, off f64::INFINITY;
        deflection_3: "delta_3", "third angle of the surface in the table of the coefficient over it, which is there in place of C_delta", ANGLE, -8.0, -88.0..86.0, off f64::INFINITY;
        deflection_4: "delta_4", "fourth angle of the surface in the table of the coefficient over it, which is there in place of C_delta", ANGLE, 0.0, -87.0..87.0, off f64::INFINITY;
        deflection_5: "delta_5", "fifth angle of the surface in the table of the coefficient over it, which is there in place of C_delta", ANGLE, 8.0, -86.0..88.0, off f64::INFINITY;
        deflection_6: "delta_6", "sixth angle of the surface in the table of the coefficient over it, which is there in place of C_delta", ANGLE, 15.0, -85.0..89.0, off f64::INFINITY;
        deflection_7: "delta_7", "seventh angle of the surface in the table of the coefficient over it, which is there in place of C_delta", ANGLE, 25.0, -84.0..90.0, off f64::INFINITY;
        coefficient_1: "C_1", "coefficient of the hinge moment at the first angle of the table", RATIO, 0.3, -5.0..5.0, off f64::INFINITY;
        coefficient_2: "C_2", "coefficient of the hinge moment at the second angle of the table", RATIO, 0.13, -5.0..5.0, off f64::INFINITY;
        coefficient_3: "C_3", "coefficient of the hinge moment at the third angle of the table", RATIO, 0.06, -5.0..5.0, off f64::INFINITY;
        coefficient_4: "C_4", "coefficient of the hinge moment at the fourth angle of the table", RATIO, 0.0, -5.0..5.0, off f64::INFINITY;
        coefficient_5: "C_5", "coefficient of the hinge moment at the fifth angle of the table", RATIO, -0.06, -5.0..5.0, off f64::INFINITY;
        coefficient_6: "C_6", "coefficient of the hinge moment at the sixth angle of the table", RATIO, -0.13, -5.0..5.0, off f64::INFINITY;
        coefficient_7: "C_7", "coefficient of the hinge moment at the seventh angle of the table", RATIO, -0.3, -5.0..5.0, off f64::INFINITY;
        bobweight: "W_b", "force at the grip per load factor, towards negative angles", FORCE, 4.0, -1e3..1e3, off 0.0;
    }

    /// Pilot at the grip.
    pilot: Pilot {
        force: "F_p", "step of pilot force in the time responses", FORCE, 96.0, 1e-3..1e4, "appendix";
    }
    optional {
        arm_mass: "m_a", "mass of the pilot's arm at the grip", MASS, 3.0, 0.0..1e3, off 0.0;
        arm_damping: "d_a", "damping of the pilot's arm at the grip", DAMPING, 0.05, 0.0..1e3, off 0.0;
        arm_stiffness: "k_a", "spring rate of the pilot's arm at the grip", STIFFNESS, 0.3, 0.0..1e4, off 0.0;
    }

    /// What the supervisor of a loader that runs live allows; each row has a default, see the guide to safety.
    safety: Safety {}
    optional {
        force_limit: "F_1", "force at the grip that stops the loader once it lasts; 14 CFR 25.143(d) has one for each axis, for a short time", FORCE, 75.0, 0.1..1e4, off 75.0;
        force_time: "t_1", "how long such a force may last", TIME, 5000.0, 1.0..1e5, off 5000.0;
        absolute_force: "F_2", "force at the grip that stops the loader at once; 14 CFR 25.397(c), largest at a wheel's rim or on pedals", FORCE, 300.0, 0.1..1e4, off 300.0;
        force_rate: "F'_max", "largest change of the force at the grip in time", FORCE_RATE, 20000.0, 1.0..1e7, off f64::INFINITY;
        speed_limit: "theta'_max", "largest angular velocity of the column", ANGULAR_VELOCITY, 600.0, 1.0..1e4, off 600.0;
        travel_margin: "theta_m", "angle by which the column may press beyond its end stops", ANGLE, 2.0, 1e-3..30.0, off 2.0;
        force_range: "F_r", "largest force that the load cell can show", FORCE, 2500.0, 0.1..1e6, off 2500.0;
        position_range: "x_r", "largest displacement that the drive's sensor can show", LENGTH, 12.0, 1e-2..1e3, off 12.0;
        angle_range: "theta_r", "largest angle that the column's sensor can show", ANGLE, 180.0, 0.1..3600.0, off 180.0;
        bridge_time: "t_b", "how long a prediction stands for a reading that the observer cannot explain", TIME, 2.0, 0.1..20.0, off 2.0;
        delay_tolerance: "t_l", "time by which a sample may be later than controller.delay has it; later ones are taken as lost", TIME, 1.0, 0.0..20.0, off 1.0;
        agreement: "d_theta", "angle within which drive, load cell and column agree by the link's spring", ANGLE, 0.5, 1e-3..30.0, off 0.5;
        agreement_time: "t_a", "how long they may disagree", TIME, 10.0, 0.1..1e4, off 10.0;
        stuck_time: "t_s", "how long a sensor may show the same number while the others show motion", TIME, 50.0, 1.0..1e4, off 50.0;
        silence_time: "t_q", "how long drive and sensors may be silent", TIME, 20.0, 1.0..1e3, off 20.0;
        host_time: "t_h", "how long the host's last values hold when it is silent", TIME, 100.0, 1.0..1e5, off 100.0;
        host_fade: "t_d", "how long the change from the host's feel to the default one takes, and back", TIME, 500.0, 1.0..1e5, off 500.0;
        overrun_time: "t_o", "how long each cycle of the loop may be late, one after another", TIME, 20.0, 0.1..1e3, off 20.0;
        saturation_time: "t_i", "how long current or flow may stay at its limit", TIME, 500.0, 1.0..1e5, off 500.0;
        hand_force: "F_n", "force at the grip below which there is no hand on it", FORCE, 2.0, 0.0..1e3, off 2.0;
        grip_offset: "F_0m", "largest offset of the force sensor at the grip that is zeroed while there is no hand on it", FORCE, 5.0, 0.0..1e3, off 5.0;
        grip_zero_time: "t_0", "how long the grip must be untouched before its force sensor is zeroed", TIME, 5000.0, 100.0..1e5, off 5000.0;
        runaway_power: "P_r", "power that the feel would take from a moving column, below which it is not watched for running away", POWER, 5.0, 1e-3..1e5, off 5.0;
        runaway_time: "t_r", "how long a column may move against its feel with no hand on it", TIME, 50.0, 1.0..1e4, off 50.0;
        energy_limit: "E_1", "energy that a hand may be given by a column that moves otherwise than its feel; what is older than a second is forgotten", ENERGY, 4.0, 1e-2..1e3, off 4.0;
        motion_limit: "E_2", "energy of motion by which a column may be faster than its feel", ENERGY, 20.0, 1e-1..1e4, off 20.0;
        swing_limit: "theta_w", "swing of a column with no hand on it, from side to side, that must die away; else the host's values go", ANGLE, 2.0, 1e-2..90.0, off 2.0;
        host_force: "F_h", "largest force at the grip of each of the host's values that is one", FORCE, 100.0, 0.0..1e4, off f64::INFINITY;
        host_force_rate: "F'_h", "its largest change in time", FORCE_RATE, 500.0, 1e-2..1e7, off f64::INFINITY;
        host_angle: "theta_h", "largest trim and autopilot position of the host", ANGLE, 10.0, 0.0..180.0, off f64::INFINITY;
        host_angle_rate: "theta'_h", "their largest change in time, and that of a trim runaway", ANGULAR_VELOCITY, 20.0, 1e-3..1e5, off f64::INFINITY;
        host_spring: "k_h", "largest spring factor of the host, and of its dynamic pressure", RATIO, 5.0, 0.0..100.0, off f64::INFINITY;
        host_spring_rate: "k'_h", "its largest change in time", RATE, 2.0, 1e-3..1e5, off f64::INFINITY;
        fade_time: "t_f", "how long the feel takes to come and to go", TIME, 500.0, 1.0..1e5, off 500.0;
        stop_time: "t_z", "how long the command takes to zero when the loader is stopped", TIME, 20.0, 0.0..1e3, off 20.0;
        start_share: "s_0", "share of the largest command that there is when the feel begins to come", RATIO, 0.2, 1e-3..1.0, off 0.2;
        command_share: "s_e", "share of the drive's largest command that is allowed", RATIO, 1.0, 1e-3..1.0, off 1.0;
        command_rate: "s'_e", "largest change of the command in time, as a share of the largest", RATE, 1000.0, 1.0..1e6, off 1000.0;
        travel_search: "search", "whether the column is led to both end stops before it is used", SWITCH, 1.0, 0.0..1.0, off 0.0;
        search_speed: "theta'_s", "angular velocity of that", ANGULAR_VELOCITY, 5.0, 0.1..90.0, off 5.0;
        search_force: "F_s0", "force at the grip at which an end stop is found", FORCE, 20.0, 0.1..1e3, off 20.0;
        power_time: "t_on", "how long the drive may take to act once it is enabled", TIME, 3000.0, 1.0..1e5, off 3000.0;
    }
}

/// What moves the linkage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DriveKind {
    /// Valve and piston.
    Hydraulic,
    /// Motor and transmission.
    Electric,
}

impl DriveKind {
    /// The drive of a loader with these values: one that has a motor is electric. Rows of the other drive are off, or zero.
    pub fn of(values: &[f64; COUNT]) -> Self {
        if Parameters::from_values(values).motor.torque_constant > 0.0 { Self::Electric } else { Self::Hydraulic }
    }
}

impl Parameter {
    /// The drive whose loaders alone have this row; none for a row that all have.
    pub fn drive(&self) -> Option<DriveKind> {
        match (self.part, self.name) {
            // A digital drive takes its sensors as numbers, its command in A.
            ("load_cell" | "potentiometer", "gain")
            | ("controller", "input_range" | "input_bits" | "output_range" | "output_bits")
            | ("amplifier" | "valve" | "actuator", _) => Some(DriveKind::Hydraulic),
            ("motor" | "winding" | "current_loop" | "transmission" | "thermal" | "brake", _) => {
                Some(DriveKind::Electric)
            }
            _ => None,
        }
    }
}

impl Parameters<f64> {
    /// The elevator loader with every optional row of a hydraulic loader at its example.
    pub fn with_every_row() -> Self {
        let elevator = Self::elevator().values();
        let of_motor = |row: &Parameter| row.drive() == Some(DriveKind::Electric);
        Self::from_values(&core::array::from_fn(
            |k| {
                if of_motor(&TABLE[k]) { elevator[k] } else { TABLE[k].default_si() }
            },
        ))
    }

    /// The elevator loader of the report, every optional row off.
    pub fn elevator() -> Self {
        let stated = |row: &Parameter| if row.drive() == Some(DriveKind::Electric) { 0.0 } else { row.default_si() };
        Self::from_values(&core::array::from_fn(|k| TABLE[k].off_si().unwrap_or_else(|| stated(&TABLE[k]))))
    }
}
