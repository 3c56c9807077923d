//! What is at the other end of the loop: a machine, simulated or real. A driver is one more file that implements this trait.

use forcefeel_model::control::Sample;

/// What the loop asks of a machine.
///
/// Both calls return at once: what takes time is done by the other end, or by a thread of the driver's own. In virtual time, where
/// nothing waits for a clock, [`read`](Self::read) may wait for the sample.
pub trait InputOutput: Send {
    /// The newest sample that has not been read, if there is one.
    fn read(&mut self) -> Option<Sampled>;

    /// Sends a command on its way.
    fn write(&mut self, command: &Command);

    /// Number of what drive or bus complain of now, in the table of faults.
    fn fault(&self) -> u16 {
        0
    }

    /// What is asked of a machine that is simulated; a real one has a hand of its own.
    fn disturb(&mut self, _: Disturbance) {}
}

/// A sample as it came.
#[derive(Debug, Clone, Copy)]
pub struct Sampled {
    /// Load cell (N), position of the drive's end (m), displacement of the column's base (m); pilot's force (N), not a number where
    /// nothing measures it.
    pub sample: Sample<f64>,
    /// Periods since the sample that was read before it, by a clock; one where the machine has no time but the loop's. Cycles without a
    /// sample need not be counted.
    pub periods: f64,
    /// Cycles by which it is late: zero where it answers the newest command that was written before it was read.
    pub delay: u32,
    /// Whether the emergency stop is pressed.
    pub emergency_stop: bool,
    /// Number of what the drive complains of, in the table of faults; zero where all is well.
    pub drive_fault: u16,
    /// Whether the drive carries out its commands; so where it does not tell.
    pub drive_acts: bool,
}

/// What goes out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Cycle of the loop that it belongs to.
    pub cycle: u64,
    /// V at a valve's amplifier, A of a motor.
    pub command: f64,
    /// Whether the drive is to be powered.
    pub enable: bool,
    /// The supervisor's state.
    pub state: u8,
}

/// What is done to a simulated machine from outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Disturbance {
    /// The hand pushes with a force in N, beside the one that follows an angle.
    Force(f64),
    /// The hand takes the grip to an angle in rad, as a spring with a damper; nothing lets go.
    HoldAt(Option<f64>),
    /// The shaft to the other column is to hold, or to open.
    Link(bool),
    /// Something breaks.
    Fault(Fault),
    /// All is well again.
    Repair,
}

/// What may break; a sensor is counted as in a sample: load cell, drive, column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// No samples come.
    Silent,
    /// A sensor stays where it is.
    Stuck(usize),
    /// A sensor gives no number.
    NotANumber(usize),
    /// A sensor jumps by so much, in its own unit.
    Jump(usize, f64),
    /// Commands are lost: the drive holds the last one.
    Deaf,
    /// Samples come so many cycles late.
    Late(usize),
    /// A sensor jumps by so much in the next sample alone.
    Spike(usize, f64),
    /// A sensor shows the opposite.
    Reversed(usize),
    /// The drive has this command while it has power.
    Hardover(f64),
}
