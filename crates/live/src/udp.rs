//! A machine over the network: packets of fixed layout, little-endian, each with version, sequence number and check sum.
//!
//! | sample, 88 bytes | | command, 56 bytes | |
//! |---|---|---|---|
//! | 0 | `FFLV` | 0 | `FFLV` |
//! | 4 | version, u16 | 4 | version, u16 |
//! | 6 | kind 1, u16 | 6 | kind 2; 3 asks for samples, u16 |
//! | 8 | sequence number, u64 | 8 | sequence number: the loop's cycle, u64 |
//! | 16 | session key of the loop, u64 | 16 | session key, drawn as the loop starts, u64 |
//! | 24 | cycle that it answers: the newest command's, all ones before the first, u64 | 24 | sequence number of the sample that it answers, u64 |
//! | 32 | clock of the machine in ns, u64 | 32 | command in V or A, f64 |
//! | 40 | load cell in N, f64 | 40 | bit 0: power the drive, u32 |
//! | 48 | position of the drive's end in m, f64 | 44 | the supervisor's state, u32 |
//! | 56 | displacement of the column's base in m, f64 | 48 | zero, u32 |
//! | 64 | pilot's force in N or not a number, f64 | 52 | CRC-32 of bytes 0 to 51, u32 |
//! | 72 | force sensor at the grip in N, zero where there is none, f64 | | |
//! | 80 | bit 0: emergency stop; bit 1: the drive carries out no commands, u32 | | |
//! | 84 | CRC-32 of bytes 0 to 83, u32 | | |
//!
//! A packet with another session key, or one that answers a cycle that was never sent, is dropped: a forged packet or one of a loop that has
//! ended does nothing. The delay of a sample is counted in cycles, from the command that it could have answered to the one that it answers.
//!
//! The machine sends a sample to whoever asked last, once a period or whenever a command comes. A sample that is damaged, of another version or
//! not newer than the last one is dropped. Newer is the higher sequence number. Of a machine that was silent for some cycles it may also be the
//! later clock: it was started anew and counts from the beginning, which a packet that comes late does not look like. One whose clock begins
//! anew too is taken after a longer silence, which the supervisor has latched.
//!
//! By the clock, a sample is as much younger than the one before as the machine's clock says, and by no more than went by here: what is held
//! up between two commands leaves a machine that samples at each of them without one, and the sample that was read before the pause was
//! taken before it too.

use crate::input_output::{Command, InputOutput, Sampled};
use forcefeel_model::control::Sample;
use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

/// Version of the packets.
pub const VERSION: u16 = 2;
/// Bytes of a sample.
pub const SAMPLE_BYTES: usize = 88;
/// Bytes of a command.
pub const COMMAND_BYTES: usize = 56;

const MAGIC: [u8; 4] = *b"FFLV";
const SAMPLE: u16 = 1;
const COMMAND: u16 = 2;
const ASK: u16 = 3;

/// Flags of a sample. A machine that does not know whether its drive acts leaves the second at zero.
const STOPPED: u32 = 1;
const IDLE: u32 = 2;

/// How long a sample is waited for in virtual time.
const PATIENCE: Duration = Duration::from_secs(2);

/// Cycles without a sample after which the machine is asked again, and may count from the beginning.
const ASK_AGAIN: u32 = 16;
/// Cycles without a sample after which its clock may begin anew too: a second at 5 kHz, some at less.
const FORGET: u32 = 5000;

/// Cycle that a sample answers before the first command.
pub const NO_CYCLE: u64 = u64::MAX;

/// A sample with its sequence number and the machine's clock in ns.
#[derive(Debug, Clone, Copy)]
pub struct Stamped {
    /// Sequence number.
    pub sequence: u64,
    /// Session key of the loop that asked.
    pub session: u64,
    /// Cycle of the newest command, or [`NO_CYCLE`].
    pub answers: u64,
    /// Clock of the machine.
    pub clock_ns: u64,
    /// What it measured.
    pub sample: Sample<f64>,
    /// Whether the emergency stop is pressed.
    pub emergency_stop: bool,
    /// Whether the drive carries out its commands.
    pub drive_acts: bool,
}

/// What came from a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Request {
    /// Samples are to be sent here.
    Ask,
    /// A command.
    Command(Command),
}

/// The bytes of a sample.
pub fn sample_bytes(stamped: &Stamped) -> [u8; SAMPLE_BYTES] {
    let Stamped { sequence, session, answers, clock_ns, sample, emergency_stop, drive_acts } = stamped;
    let [force, position, base, grip] = sample.sensors;
    let mut bytes = headed(SAMPLE, *sequence, *session);
    bytes[24..32].copy_from_slice(&answers.to_le_bytes());
    bytes[32..40].copy_from_slice(&clock_ns.to_le_bytes());
    for (k, number) in [force, position, base, sample.pilot_force, grip].into_iter().enumerate() {
        bytes[40 + 8 * k..48 + 8 * k].copy_from_slice(&number.to_le_bytes());
    }
    let flags = [*emergency_stop, !drive_acts].map(u32::from);
    bytes[80..84].copy_from_slice(&((flags[0] * STOPPED) | (flags[1] * IDLE)).to_le_bytes());
    summed(bytes)
}

/// The sample of these bytes, if they are one.
pub fn sample_of(bytes: &[u8]) -> Option<Stamped> {
    let bytes = checked::<SAMPLE_BYTES>(bytes, &[SAMPLE])?;
    let number = |at: usize| f64::from_le_bytes(part(bytes, at));
    let sample = Sample { sensors: [number(40), number(48), number(56), number(72)], pilot_force: number(64) };
    let flags = u32::from_le_bytes(part(bytes, 80));
    Some(Stamped {
        sequence: u64::from_le_bytes(part(bytes, 8)),
        session: u64::from_le_bytes(part(bytes, 16)),
        answers: u64::from_le_bytes(part(bytes, 24)),
        clock_ns: u64::from_le_bytes(part(bytes, 32)),
        sample,
        emergency_stop: flags & STOPPED != 0,
        drive_acts: flags & IDLE == 0,
    })
}

/// The bytes of a command that answers a sample.
pub fn command_bytes(command: &Command, session: u64, answers: u64) -> [u8; COMMAND_BYTES] {
    let mut bytes = headed(COMMAND, command.cycle, session);
    bytes[24..32].copy_from_slice(&answers.to_le_bytes());
    bytes[32..40].copy_from_slice(&command.command.to_le_bytes());
    bytes[40..44].copy_from_slice(&u32::from(command.enable).to_le_bytes());
    bytes[44..48].copy_from_slice(&u32::from(command.state).to_le_bytes());
    summed(bytes)
}

/// The bytes that ask for samples.
pub fn ask_bytes(session: u64) -> [u8; COMMAND_BYTES] {
    summed(headed(ASK, 0, session))
}

/// Session key, and the request of a loop to a machine, if these bytes are one.
pub fn request_of(bytes: &[u8]) -> Option<(u64, Request)> {
    let bytes = checked::<COMMAND_BYTES>(bytes, &[COMMAND, ASK])?;
    let session = u64::from_le_bytes(part(bytes, 16));
    if u16::from_le_bytes(part(bytes, 6)) == ASK {
        return Some((session, Request::Ask));
    }
    let command = Command {
        cycle: u64::from_le_bytes(part(bytes, 8)),
        command: f64::from_le_bytes(part(bytes, 32)),
        enable: u32::from_le_bytes(part(bytes, 40)) & 1 != 0,
        state: u8::try_from(u32::from_le_bytes(part(bytes, 44))).ok()?,
    };
    Some((session, Request::Command(command)))
}

fn headed<const N: usize>(kind: u16, sequence: u64, session: u64) -> [u8; N] {
    let mut bytes = [0; N];
    bytes[..4].copy_from_slice(&MAGIC);
    bytes[4..6].copy_from_slice(&VERSION.to_le_bytes());
    bytes[6..8].copy_from_slice(&kind.to_le_bytes());
    bytes[8..16].copy_from_slice(&sequence.to_le_bytes());
    bytes[16..24].copy_from_slice(&session.to_le_bytes());
    bytes
}

fn summed<const N: usize>(mut bytes: [u8; N]) -> [u8; N] {
    let sum = crc32fast::hash(&bytes[..N - 4]);
    bytes[N - 4..].copy_from_slice(&sum.to_le_bytes());
    bytes
}

fn checked<'a, const N: usize>(bytes: &'a [u8], kinds: &[u16]) -> Option<&'a [u8; N]> {
    let bytes: &[u8; N] = bytes.try_into().ok()?;
    let head = bytes[..4] == MAGIC && u16::from_le_bytes(part(bytes, 4)) == VERSION;
    let good = head && kinds.contains(&u16::from_le_bytes(part(bytes, 6)));
    (good && crc32fast::hash(&bytes[..N - 4]) == u32::from_le_bytes(part(bytes, N - 4))).then_some(bytes)
}

/// So many bytes from a place on that is within.
fn part<const N: usize, const M: usize>(bytes: &[u8; N], at: usize) -> [u8; M] {
    core::array::from_fn(|k| bytes[at + k])
}

/// The loop's end.
#[derive(Debug)]
pub struct Udp {
    socket: UdpSocket,
    /// Key that a packet of this loop and of its machine has.
    session: u64,
    /// Cycle of the newest command.
    written: Option<u64>,
    /// Period of the loop in s where it goes by the clock.
    period_s: Option<f64>,
    last: Option<Last>,
    /// When the last sample was read, and the one before it.
    read: [Instant; 2],
    silent: u32,
}

/// Of the last sample.
#[derive(Debug, Clone, Copy)]
struct Last {
    sequence: u64,
    clock_ns: u64,
}

impl Udp {
    /// Asks a machine for its samples, for a loop with this period in s by the clock; without one in virtual time, where a cycle begins when
    /// its sample is there.
    ///
    /// # Errors
    /// If the address cannot be reached.
    pub fn connect(address: SocketAddr, period_s: Option<f64>) -> io::Result<Self> {
        let any = if address.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" };
        let socket = UdpSocket::bind(any)?;
        socket.connect(address)?;
        socket.set_nonblocking(period_s.is_some())?;
        if period_s.is_none() {
            socket.set_read_timeout(Some(PATIENCE))?;
        }
        // Nothing but the standard library's own random keys is needed for a number that cannot be guessed.
        let session = RandomState::new().build_hasher().finish();
        socket.send(&ask_bytes(session))?;
        Ok(Self { socket, session, written: None, period_s, last: None, read: [Instant::now(); 2], silent: 0 })
    }

    /// The next sample in the socket that is newer than the last.
    fn next(&mut self) -> Option<Stamped> {
        let mut bytes = [0; SAMPLE_BYTES + 1];
        loop {
            let count = match self.socket.recv(&mut bytes) {
                Ok(count) => count,
                // Nobody listens there yet, or no more; the next one may come all the same.
                Err(error) if error.kind() == io::ErrorKind::ConnectionRefused => return None,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(_) => return None,
            };
            if let Some(stamped) = sample_of(&bytes[..count])
                && stamped.session == self.session
                && self.delay(stamped.answers).is_some()
                && self.is_newer(&stamped)
            {
                let Stamped { sequence, clock_ns, .. } = stamped;
                self.last = Some(Last { sequence, clock_ns });
                return Some(stamped);
            }
        }
    }

    fn is_newer(&self, stamped: &Stamped) -> bool {
        self.last.is_none_or(|last| {
            stamped.sequence > last.sequence || (self.silent >= ASK_AGAIN && stamped.clock_ns > last.clock_ns)
        })
    }
}

impl Udp {
    /// Cycles by which a sample that answers a cycle is late: zero where it answers the newest command. Nothing where that was never sent.
    fn delay(&self, answers: u64) -> Option<u32> {
        let newest = self.written.map_or(0, |cycle| cycle + 1);
        let answered = if answers == NO_CYCLE { 0 } else { answers.checked_add(1)? };
        let late = newest.checked_sub(answered)?;
        Some(if answered == 0 { 0 } else { u32::try_from(late).unwrap_or(u32::MAX) })
    }

    /// Periods by which a sample that was read now is younger than the one that was read before it.
    fn periods(&mut self, before: Option<Last>, clock_ns: u64) -> f64 {
        let Some(period_s) = self.period_s else { return 1.0 };
        let [last, earlier] = self.read;
        self.read = [Instant::now(), last];
        let there = before.map_or(Duration::ZERO, |last| Duration::from_nanos(clock_ns.saturating_sub(last.clock_ns)));
        let here = self.read[0].duration_since(earlier);
        (there.min(here).as_secs_f64() / period_s).max(1.0)
    }
}

impl InputOutput for Udp {
    fn read(&mut self) -> Option<Sampled> {
        let before = self.last;
        let mut newest = self.next();
        while self.period_s.is_some()
            && let Some(newer) = if newest.is_some() { self.next() } else { None }
        {
            newest = Some(newer);
        }
        self.silent = if newest.is_some() { 0 } else { self.silent.saturating_add(1) };
        if self.silent >= FORGET {
            self.last = None;
        }
        if self.silent > 0 && self.silent.is_multiple_of(ASK_AGAIN) {
            let _ = self.socket.send(&ask_bytes(self.session));
        }
        let Stamped { answers, clock_ns, sample, emergency_stop, drive_acts, .. } = newest?;
        let delay = self.delay(answers)?;
        Some(Sampled {
            sample,
            periods: self.periods(before, clock_ns),
            delay,
            emergency_stop,
            drive_fault: 0,
            drive_acts,
        })
    }

    fn write(&mut self, command: &Command) {
        // A packet that cannot be sent is one that is lost: the machine misses it, and acts.
        self.written = Some(command.cycle);
        let _ = self.socket.send(&command_bytes(command, self.session, self.last.map_or(0, |last| last.sequence)));
    }
}
