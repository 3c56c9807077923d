//! THE table of parameters: one row each. Everything that needs to know a parameter reads it here.
//!
//! The default column is the elevator loader of the 1974 report, in the U.S. customary units in which its "measurements
//! and calculations were made"; [`Parameter::default_si`] converts. A new parameter is one new row.
//!
//! Rows marked `alternative` are another way to state rows of the same part; a loader gives one or the other:
//!
//! | stated as | instead of | by |
//! |---|---|---|
//! | valve operating point | `C_i`, `C_p` | [`Valve::gains_at`](crate::valve), eqs. (1)-(2) |
//! | linkage resonance | `k`, `c` | [`Linkage::from_resonance`](crate::linkage), appendix |
//! | feel frequency and damping ratio | `I`, `B` | [`Feel::from_frequency`](crate::feel), eq. (11) |

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
    /// The elevator loader's value, in U.S. customary units.
    pub default_us: f64,
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
    /// The elevator loader's value in SI units.
    pub fn default_si(&self) -> f64 {
        self.default_us * self.unit.si_per_us
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
        alternative to $replaced:tt {
            $( $other:ident: $osymbol:literal, $omeaning:literal, $ounit:ident, $odefault:expr, $ominimum:literal .. $omaximum:literal, $osource:literal; )*
        }
    )*) => {
        $(
            #[doc = $doc]
            #[derive(Debug, Clone, Copy, PartialEq)]
            pub struct $Part<S> {
                $( #[doc = concat!("`", $symbol, "`: ", $meaning, ".")] pub $name: S, )*
            }
        )*

        $(
            impl<S: Copy> $Part<S> {
                /// The same part in another number type.
                pub fn map<T>(&self, convert: impl Fn(S) -> T) -> $Part<T> {
                    $Part { $( $name: convert(self.$name), )* }
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
            default_us: $default, minimum_us: $minimum, maximum_us: $maximum, source: $source, instead_of: &[],
        }, )* )* ];

        /// The rows that a loader file may give instead of others.
        pub const ALTERNATIVES: &[Parameter] = &[ $( $( Parameter {
            part: stringify!($part), name: stringify!($other), symbol: $osymbol, meaning: $omeaning, unit: units::$ounit,
            default_us: $odefault, minimum_us: $ominimum, maximum_us: $omaximum, source: $osource, instead_of: names!($replaced),
        }, )* )* ];

        /// The parts and what each is.
        pub const PARTS: &[(&str, &str)] = &[ $( (stringify!($part), $doc.trim_ascii()) ),* ];

        /// How many values a [`Parameters`] holds.
        pub const COUNT: usize = TABLE.len();

        impl<S: Copy> Parameters<S> {
            /// From values in the order of [`TABLE`], SI units.
            pub fn from_values(values: &[S; COUNT]) -> Self {
                let mut next = 0;
                let mut take = || { next += 1; values[next - 1] };
                Self { $( $part: $Part { $( $name: take(), )* }, )* }
            }

            /// The same loader in another number type.
            pub fn map<T>(&self, convert: impl Fn(S) -> T + Copy) -> Parameters<T> {
                Parameters { $( $part: self.$part.map(convert), )* }
            }

            /// The values in the order of [`TABLE`], SI units.
            pub fn values(&self) -> [S; COUNT] {
                [ $( $( self.$part.$name, )* )* ]
            }
        }
    };
}

parameter_table! {
    /// Servo amplifier: voltage in, valve current out.
    amplifier: Amplifier {
        admittance: "K_2", "valve current per volt at the amplifier's input", CURRENT_PER_VOLTAGE, 1.56, 1e-3..1e3, "appendix";
    }
    alternative to [] {}

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
    alternative to [] {}

    /// Link between the actuator's load cell and the base of the column.
    linkage: Linkage {
        ratio: "alpha", "linkage ratio l_2 / (l_1 + l_2): piston travel per travel of the column's base", RATIO, 0.59, 1e-2..1.0, "appendix";
        stiffness: "k", "spring rate of the linkage", STIFFNESS, 6107.86, 1.0..1e8, "appendix";
        damping: "c", "damping coefficient of the linkage", DAMPING, 16.2016, 1e-3..1e6, "appendix";
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
    alternative to [] {}

    /// Load cell between actuator and linkage.
    load_cell: LoadCell {
        gain: "K_1", "load cell circuit's output per unit of force", VOLTAGE_PER_FORCE, 0.005, 1e-7..10.0, "appendix";
    }
    alternative to [] {}

    /// Potentiometer at the piston.
    potentiometer: Potentiometer {
        gain: "K_3", "potentiometer circuit's output per unit of piston travel", VOLTAGE_PER_LENGTH, 7.632, 1e-3..1e4, "appendix";
    }
    alternative to [] {}

    /// Feel computer: the programmed inertia, damping and stiffness.
    feel: Feel {
        inertia: "I", "programmed inertia of the control", INERTIA, 60.0, 1e-6..1e7, "appendix";
        damping: "B", "programmed damping of the control", ROTARY_DAMPING, 304.0, 0.0..1e8, "appendix";
        stiffness: "G", "programmed spring rate of the control", ROTARY_STIFFNESS, 9600.0, 1e-3..1e8, "appendix";
        maximum_stiffness: "G_max", "largest programmed spring rate; scales the load cell's channel", ROTARY_STIFFNESS, 28800.0, 1e-3..1e8, "appendix";
    }
    alternative to [inertia, damping] {
        natural_frequency: "sqrt(G/I) / 2 pi", "programmed natural frequency", FREQUENCY, 2.0, 1e-3..100.0, "appendix, page of [Q]";
        damping_ratio: "B / (2 sqrt(G I))", "programmed damping ratio", RATIO, 0.2, 0.0..100.0, "appendix, page of [Q]";
    }

    /// Pilot at the grip.
    pilot: Pilot {
        force: "F_p", "step of pilot force in the time responses", FORCE, 96.0, 1e-3..1e4, "appendix";
    }
    alternative to [] {}
}

impl<S: crate::Scalar> Parameters<S> {
    /// The elevator loader of the report.
    pub fn elevator() -> Self {
        Self::from_values(&core::array::from_fn(|k| S::constant(TABLE[k].default_si())))
    }
}
