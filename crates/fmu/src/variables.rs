//! The variables of an FMU: one table for the library and for what writes its description.
//!
//! A variable's reference is its place in a block: time, inputs, outputs, what a run begins with, rows of the parameter table.

use forcefeel_model::host::packet::FROM_HOST;
use forcefeel_model::law_inputs::{HAND, SHAKER, STIFFNESS_FACTOR, TRIM, sensed};
use forcefeel_model::parameters::{COUNT, DriveKind, Parameter, Parameters, TABLE};
use forcefeel_model::surface::FLIGHT;
use forcefeel_solve::outputs::{Output, outputs};

/// What an FMU holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The loader with its law: force in, position out.
    Loader,
    /// The law alone: sensors in, command out.
    Law,
    /// The machine alone: force and command in, sensors out.
    Machine,
}

impl Kind {
    /// The kinds by name.
    pub const NAMES: [(&str, Self); 3] = [("loader", Self::Loader), ("law", Self::Law), ("machine", Self::Machine)];
}

/// Reference of the time.
pub const TIME: u32 = 0;
/// Reference of the first of [`inputs`].
pub const INPUTS: u32 = 1;
/// Reference of the first of [`outputs`](seen).
pub const OUTPUTS: u32 = 101;
/// Reference of the first of [`OPTIONS`].
pub const OPTIONS_FROM: u32 = 201;
/// Reference of the clock of the law alone, which ticks at each of its samples.
pub const CLOCK: u32 = 301;
/// Reference of the first row of the parameter table.
pub const PARAMETERS: u32 = 1001;

/// Most inputs of a kind.
pub const MOST_INPUTS: usize = 7 + FLIGHT.len();
/// Most outputs of a kind.
pub const MOST_OUTPUTS: usize = 14;

/// An input or an output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// Its name.
    pub name: &'static str,
    /// Its SI unit.
    pub unit: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// What it is where nothing is done.
    pub start: f64,
    /// Smallest and largest value of an input.
    pub range: (f64, f64),
    /// Whether it counts through a step; else only where the controller samples.
    pub continuous: bool,
}

const fn signal(name: &'static str, unit: &'static str, meaning: &'static str) -> Signal {
    Signal { name, unit, meaning, start: 0.0, range: (f64::NEG_INFINITY, f64::INFINITY), continuous: true }
}

const fn sampled(name: &'static str, unit: &'static str, meaning: &'static str) -> Signal {
    Signal { continuous: false, ..signal(name, unit, meaning) }
}

/// The pilot's force, of loader and machine the first input.
const PILOT_FORCE: Signal = Signal { range: HAND, ..signal("pilot_force", "N", "force of the pilot at the grip") };

/// What the feel is told from outside.
const AROUND: [Signal; 3] = [
    Signal { range: TRIM, ..sampled("trim", "rad", "commanded neutral of the feel") },
    Signal {
        start: 1.0,
        range: STIFFNESS_FACTOR,
        ..sampled("stiffness_factor", "", "factor on the spring of the feel")
    },
    Signal { range: SHAKER, ..sampled("shaker", "", "how far the stick shaker is on, 0 to 1") },
];

/// The flight that acts on a loader's surface, with units and ranges of the packet of an aircraft simulator.
fn flight(values: &[f64; COUNT]) -> Vec<Signal> {
    let of = |(name, meaning): (&'static str, &'static str)| {
        let row = FROM_HOST.iter().find(|row| row.0 == name);
        row.map(|&(name, unit, low, high, start)| Signal {
            start: f64::from(start),
            range: (f64::from(low), f64::from(high)),
            ..sampled(name, unit, meaning)
        })
    };
    let is_there = Parameters::from_values(values).surface.is_there();
    if is_there { FLIGHT.into_iter().zip(FLOWN).filter_map(of).collect() } else { vec![] }
}

/// What the numbers of a flight mean.
const FLOWN: [&str; FLIGHT.len()] = [
    "dynamic pressure of the flight",
    "true airspeed",
    "angle of attack of the aircraft",
    "sideslip of the aircraft",
    "rate of roll",
    "rate of pitch",
    "rate of yaw",
    "load factor",
    "Mach number",
    "angle of the trim tab",
];

/// What the sensors show, noise and offset included.
const SENSED: [Signal; 4] = [
    sampled("sensed_load_cell_force", "N", "force that the load cell shows at the controller's sample"),
    sampled("sensed_drive_position", "m", "displacement of the drive's end that its sensor shows at the sample"),
    sampled(
        "sensed_column_base",
        "m",
        "displacement of the column's base that the column's sensor shows at the sample",
    ),
    sampled("sensed_grip_force", "N", "force that the grip's sensor shows at the sample; zero without one"),
];

fn command(drive: DriveKind) -> Signal {
    let unit = if drive == DriveKind::Electric { "A" } else { "V" };
    let command = sampled(
        "command",
        unit,
        "command of the law to the drive's amplifier; it arrives the controller's delay after the sample",
    );
    Signal { range: COMMAND, ..command }
}

/// A command to the machine in V or A: its amplifier limits what it answers, so any law's is taken that can be one.
const COMMAND: (f64, f64) = (-1e6, 1e6);

/// The inputs of a kind of FMU of a loader with these values, in the order of their references.
pub fn inputs(kind: Kind, values: &[f64; COUNT]) -> Vec<Signal> {
    let drive = DriveKind::of(values);
    match kind {
        Kind::Loader => [&[PILOT_FORCE][..], &AROUND, &flight(values)].concat(),
        Kind::Law => {
            let ranges = sensed(&Parameters::from_values(values));
            let shown = SENSED.into_iter().zip(ranges).map(|(signal, range)| Signal { range, ..signal });
            shown.chain(AROUND).chain(flight(values)).collect()
        }
        Kind::Machine => vec![PILOT_FORCE, command(drive)],
    }
}

/// The places in a simulation's outputs of what a kind of FMU shows.
pub(crate) fn shown(kind: Kind, drive: DriveKind) -> Vec<Output> {
    let of_law = [Output::FeelPosition, Output::FeelVelocity];
    let wanted = |output: &Output| match kind {
        Kind::Loader => *output != Output::PilotForce,
        Kind::Machine => *output != Output::PilotForce && !of_law.contains(output),
        Kind::Law => of_law.contains(output),
    };
    (0..outputs(drive).len()).map(Output::at).filter(wanted).collect()
}

/// The outputs of a kind of FMU, in the order of their references: those of a simulation by their names, then its own.
pub fn seen(kind: Kind, drive: DriveKind) -> Vec<Signal> {
    let of_simulation = shown(kind, drive).into_iter().map(|output| {
        let (name, unit) = outputs(drive)[output as usize];
        match output {
            Output::FeelPosition => sampled(name, "rad", meaning(output, name)),
            Output::FeelVelocity => sampled(name, "rad/s", meaning(output, name)),
            _ => signal(name, unit, meaning(output, name)),
        }
    });
    let own = match kind {
        Kind::Loader => vec![],
        Kind::Law => vec![command(drive), sampled("feel_torque", "N m", "torque that the feel computer receives")],
        Kind::Machine => SENSED.to_vec(),
    };
    of_simulation.chain(own).collect()
}

fn meaning(output: Output, name: &str) -> &'static str {
    match output {
        Output::ColumnAngle => "angle of the column",
        Output::ColumnVelocity => "angular velocity of the column",
        Output::FeelPosition => "angle that the feel computer asks for",
        Output::FeelVelocity => "its rate",
        Output::DrivePosition => "displacement of the drive's end",
        Output::LoadCellForce => "force of the load cell",
        Output::PilotForce => "force of the pilot at the grip",
        Output::FirstSignal | Output::SecondSignal | Output::ThirdSignal | Output::FourthSignal => of_drive(name),
    }
}

/// A quantity of the drive.
fn of_drive(name: &str) -> &'static str {
    match name {
        "load_pressure" => "pressure difference across the actuator's piston",
        "actuator_flow" => "flow of oil into the actuator",
        "valve_current" => "current through the coil of the valve",
        "motor_current" => "current through the winding of the motor",
        "motor_voltage" => "voltage at the motor",
        "motor_speed" => "angular velocity of the motor",
        "winding_temperature" => "temperature of the winding of the motor",
        _ => "",
    }
}

/// What is not a row of the parameter table, and is set before a run or during it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// Its name.
    pub name: &'static str,
    /// Its SI unit.
    pub unit: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// What it is where nothing is set.
    pub start: f64,
    /// Smallest and largest value.
    pub range: (f64, f64),
    /// Whether it is a whole number.
    pub whole: bool,
    /// Whether it may be changed while the FMU runs.
    pub tunable: bool,
}

const fn choice(name: &'static str, unit: &'static str, meaning: &'static str, range: (f64, f64)) -> Choice {
    Choice { name, unit, meaning, start: 0.0, range, whole: false, tunable: false }
}

pub(crate) const START_FORCE: usize = 0;
pub(crate) const START_ANGLE: usize = 1;
pub(crate) const HELD_UNTIL: usize = 2;
pub(crate) const SEED: usize = 3;
pub(crate) const FEEL_CHANGE_TIME: usize = 4;
pub(crate) const SETTING: usize = 5;

/// What a run begins with, and how the feel is changed.
pub const OPTIONS: [Choice; 6] = [
    choice("start_force", "N", "force of the pilot under which the run begins at rest", (-1e5, 1e5)),
    choice(
        "start_angle",
        "rad",
        "angle of the column at which the run begins, where a hand holds it there",
        (-1.5, 1.5),
    ),
    choice("held_until", "s", "how long a hand holds the column at the start angle before it lets go", (0.0, 1e4)),
    Choice { whole: true, ..choice("seed", "", "seed of the sensors' noise", (0.0, 2_147_483_647.0)) },
    Choice {
        start: 0.5,
        tunable: true,
        ..choice("feel_change_time", "s", "how long the feel takes from its old values to new ones", (1e-4, 1e3))
    },
    Choice {
        start: 1.0,
        whole: true,
        tunable: true,
        ..choice("setting", "", "which of the settings of feel and law holds", (1.0, 1e4))
    },
];

/// Places of the options that a kind of FMU has; `settings`: how many of feel and law.
pub fn options(kind: Kind, settings: usize) -> Vec<usize> {
    let has = |place: &usize| match *place {
        HELD_UNTIL | SEED => kind != Kind::Law,
        FEEL_CHANGE_TIME => kind != Kind::Machine,
        SETTING => kind != Kind::Machine && settings > 1,
        _ => true,
    };
    (0..OPTIONS.len()).filter(has).collect()
}

/// Whether a row of the parameter table is a variable of a kind of FMU, of a loader with these values.
///
/// Not those that the library's steps, or the law's are made for, those of a scenario and of the supervisor, nor a limit that is off.
pub fn has_row(kind: Kind, row: &Parameter, value: f64) -> bool {
    let own = match kind {
        Kind::Loader => true,
        Kind::Law => row.part == "feel",
        Kind::Machine => row.part != "feel",
    };
    let made_for =
        matches!((row.part, row.name), ("controller", "period" | "delay") | ("pilot", "force") | ("safety", _));
    own && !made_for && value.is_finite() && within(range(row), value)
}

/// The rows of a kind of FMU.
pub fn rows(kind: Kind, drive: DriveKind, values: &[f64; COUNT]) -> Vec<usize> {
    let has = |&k: &usize| TABLE[k].drive().is_none_or(|its| its == drive) && has_row(kind, &TABLE[k], values[k]);
    (0..COUNT).filter(has).collect()
}

/// Whether a row may be changed while the FMU runs: the feel, but for the shaker's frequency, whose phase would jump.
pub fn is_tunable(row: &Parameter) -> bool {
    row.part == "feel" && row.name != "shaker_frequency"
}

/// Whether a row is a yes or a no.
pub fn is_switch(row: &Parameter) -> bool {
    row.unit.si == "switch"
}

/// Smallest and largest value of a row in SI units.
pub fn range(row: &Parameter) -> (f64, f64) {
    (row.minimum_us * row.unit.si_per_us, row.maximum_us * row.unit.si_per_us)
}

/// Whether a value is in a range, but for the rounding of its ends.
pub(crate) fn within((low, high): (f64, f64), value: f64) -> bool {
    low - low.abs() * ROUNDING <= value && value <= high + high.abs() * ROUNDING
}

/// Relative: a limit that was stated with ten digits, perhaps in another unit, is still the limit.
const ROUNDING: f64 = 1e-9;

/// The variables of an FMU.
#[derive(Debug)]
pub(crate) struct Variables {
    pub inputs: Vec<Signal>,
    pub outputs: usize,
    pub options: Vec<usize>,
    pub rows: Vec<usize>,
}
