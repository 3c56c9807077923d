//! THE table of safety functions: a row each. What acts, how, after how many samples, and what a person reads.
//!
//! A function acts in the last of so many samples in a row that show its condition: 1 is the first sample that shows it.

use super::limits::Limits;
use crate::named::Named;

/// What a function does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// The command is zero and the drive disabled in the same sample.
    Cut,
    /// The command goes evenly to zero over the stop time, then the drive is disabled.
    Stop,
    /// The host's values give way to the default feel.
    Fade,
    /// The command is held to its limit.
    Limit,
}

impl Action {
    /// What it does, for a person.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Cut => "command zero and drive disabled at once",
            Self::Stop => "command to zero over the stop time, then drive disabled",
            Self::Fade => "the host's last values hold, then the default feel comes",
            Self::Limit => "command held to the limit",
        }
    }

    /// Whether the loader is stopped by it.
    pub const fn stops(self) -> bool {
        matches!(self, Self::Cut | Self::Stop)
    }
}

macro_rules! functions {
    ($( $(#[doc = $doc:literal])+ $Name:ident: $name:literal, $action:ident, $samples:expr, $sentence:literal; )*) => {
        /// A safety function.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Function { $( $(#[doc = $doc])+ $Name, )* }

        impl Function {
            /// All functions, in the order of the table.
            pub const ALL: &[Self] = &[ $( Self::$Name, )* ];

            /// Its name.
            pub const fn name(self) -> &'static str {
                match self { $( Self::$Name => $name, )* }
            }

            /// What it does.
            pub const fn action(self) -> Action {
                match self { $( Self::$Name => Action::$action, )* }
            }

            /// Samples in a row that show its condition when it acts.
            pub fn samples(self, limits: &Limits) -> u32 {
                let of: fn(&Limits) -> u32 = match self { $( Self::$Name => $samples, )* };
                of(limits)
            }

            /// What happened and what to do, for the person at the loader.
            pub const fn sentence(self) -> &'static str {
                match self { $( Self::$Name => $sentence, )* }
            }
        }
    };
}

functions! {
    /// The emergency stop is pressed.
    EmergencyStop: "emergency stop", Cut, |_| 1,
        "The emergency stop is pressed. Find out why, release it, then acknowledge.";
    /// The drive reports a fault of its own.
    DriveFault: "drive fault", Stop, |_| 1,
        "The drive reports a fault. Read its own display or log, then acknowledge.";
    /// The drive is enabled and does not act.
    DriveNotReady: "drive not ready", Cut, |limits| limits.power,
        "The drive was enabled and did not act. Look at its supply, its enable input and its display, then acknowledge.";
    /// The drive acted, and stopped by itself without a fault.
    DriveStopped: "drive stopped", Cut, |_| 1,
        "The drive stopped acting by itself. Look at its supply, its enable input and its display, then acknowledge.";
    /// A sensor's value, the feel's torque or the law's command is no finite number.
    NotANumber: "not a number", Stop, |_| 1,
        "A sensor, the feel or the law gave no finite number. Look at the last record, then at that sensor's wiring.";
    /// A sensor shows more than it can measure.
    OutOfRange: "out of range", Stop, |_| 1,
        "A sensor shows more than its range. Look for a broken wire or a short circuit.";
    /// The load cell shows what the observer cannot explain.
    LoadCell: "load cell implausible", Stop, |limits| limits.bridge + 1,
        "The load cell contradicts drive, link and command. Look at its cable, its sign and its amplifier.";
    /// The drive's position does.
    DrivePosition: "drive position implausible", Stop, |limits| limits.bridge + 1,
        "The drive's position contradicts its command. Look at its sensor's cable and counter, and at valve or motor.";
    /// The column's angle does.
    ColumnAngle: "column angle implausible", Stop, |limits| limits.bridge + 1,
        "The column's angle contradicts the force on it. Look at its sensor's cable, screen and counter.";
    /// Samples answer commands that are too old.
    Late: "samples late", Stop, |limits| limits.silence,
        "The samples came later than the law allows for. Look at the network, or design the law for a longer delay.";
    /// Drive and sensors give nothing.
    Silence: "sensors silent", Stop, |limits| limits.silence,
        "The drive and its sensors sent nothing. Look at the cable to the drive and its power.";
    /// A sensor shows the same number while the others show motion, or that at the grip while the hand's force changes.
    Stuck: "sensor stuck", Stop, |limits| limits.stuck,
        "A sensor stays at one number while the others move. Look at its coupling and its electronics.";
    /// Drive position, load cell and column angle do not go together.
    Disagreement: "sensors disagree", Stop, |limits| limits.agreement,
        "Drive position, load cell and column angle contradict one another. Check their zeros, their scales and the link.";
    /// The force at the grip lasts.
    Force: "force at the grip", Stop, |limits| limits.force,
        "The force at the grip stayed above its limit. Let go; if no hand pushed, look at the load cell's zero.";
    /// The force at the grip is beyond what the controls are made for.
    AbsoluteForce: "largest force", Cut, |_| CONFIRMED,
        "The force at the grip came to its absolute limit. Check linkage and stops before going on.";
    /// The force at the grip changes too fast.
    ForceRate: "rate of force", Stop, |_| CONFIRMED,
        "The force at the grip changed faster than its limit. Look for a hard stop, a collision or a law too quick.";
    /// The column moves too fast.
    Speed: "speed", Cut, |_| CONFIRMED,
        "The column moved faster than its limit. If no hand threw it, check law and feel in a simulation first.";
    /// The column is beyond its end stops.
    Travel: "travel", Stop, |_| CONFIRMED,
        "The column is beyond its end stops. Check the stops, and the zero of the column's sensor.";
    /// The column moves against its feel with no hand on it.
    Runaway: "runaway", Stop, |limits| limits.runaway,
        "The column moved against its feel with no hand on it. Do not start again before law and valve or motor are checked.";
    /// The column gives energy to the hand that its feel does not.
    Energy: "energy at the grip", Cut, |_| CONFIRMED,
        "The column moved against the hand otherwise than its feel. Check law, valve or motor before starting again.";
    /// The force sensor at the grip shows too much with no hand on it.
    GripOffset: "offset at the grip", Stop, |limits| limits.grip_zero,
        "The force sensor at the grip shows a force with no hand on it. Look at its cable and its zero, then commission it anew.";
    /// The command stays at its limit.
    Saturation: "limit too long", Stop, |limits| limits.saturation,
        "Current or flow stayed at its limit. The feel asks for more than the drive has, or something blocks it.";
    /// The loop misses its cycles.
    Overrun: "cycles late", Stop, |limits| limits.overrun,
        "The loop was late cycle after cycle. Give it a real-time kernel, a core of its own, or a longer period.";
    /// The end stops are not where the loader has them.
    TravelSearch: "travel search", Stop, |_| 1,
        "The end stops were not found where the loader file has them. Clear what blocks the column, or correct the file.";
    /// Another axis of the cockpit stopped.
    OtherAxis: "another axis", Stop, |_| 1,
        "Another axis of the cockpit stopped, and this one with it. Look at the trips of that axis, then acknowledge both.";
    /// The host sends nothing.
    HostSilent: "host silent", Fade, |limits| limits.host,
        "The simulator sends nothing; the default feel is on. The loader goes back to it when it sends again.";
    /// A column with no hand on it swings on under a host.
    Swing: "swing", Fade, |_| 1,
        "The column swings with no hand on it; the default feel is on. Close no spring over the host, then acknowledge.";
    /// The law asks for more than the largest command.
    CommandLimit: "command limit", Limit, |_| 1,
        "The law asks for more than the drive may give.";
    /// The law asks for a quicker change of the command than is allowed.
    CommandRate: "rate of command", Limit, |_| 1,
        "The law asks for a quicker change than the drive may make.";
}

/// One sample may be noise; two are not.
pub(super) const CONFIRMED: u32 = 2;

impl Function {
    /// Whether it stays until somebody acknowledges it.
    pub const fn latched(self) -> bool {
        self.action().stops() || matches!(self, Self::Swing)
    }
}

impl Named for Option<Function> {
    const ALL: &'static [Self] = &{
        let mut all = [None; Function::ALL.len() + 1];
        let mut k = 0;
        while k < Function::ALL.len() {
            all[k + 1] = Some(Function::ALL[k]);
            k += 1;
        }
        all
    };

    fn name(self) -> &'static str {
        self.map_or("none", Function::name)
    }
}

/// A set of functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Functions(u32);

impl Functions {
    /// None of them.
    pub const NONE: Self = Self(0);

    /// As bits, in the order of the table.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Whether there is none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether `function` is one of them.
    pub const fn has(self, function: Function) -> bool {
        self.0 & (1 << function as u32) != 0
    }

    /// With `function` where `holds`.
    #[inline(always)]
    pub const fn with(self, function: Function, holds: bool) -> Self {
        Self(self.0 | (holds as u32) << function as u32)
    }

    /// With `function` where `holds`, and without it elsewhere.
    #[inline(always)]
    pub const fn only(self, function: Function, holds: bool) -> Self {
        Self(self.0 & !(1 << function as u32)).with(function, holds)
    }

    /// Those of both.
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those that do so.
    pub const fn that(self, action: Action) -> Self {
        let (mut mask, mut k) = (0, 0);
        while k < Function::ALL.len() {
            if Function::ALL[k].action() as u32 == action as u32 {
                mask |= 1 << k;
            }
            k += 1;
        }
        Self(self.0 & mask)
    }

    /// Those that stop the loader.
    pub const fn stopping(self) -> Self {
        self.that(Action::Cut).and(self.that(Action::Stop))
    }

    /// The first of them in the table.
    pub fn first(self) -> Option<Function> {
        Function::ALL.iter().copied().find(|&function| self.has(function))
    }
}
