//! The wire of an emulated bus with what is wrong with it: frames come in, answers go out.

use crate::emulated_axis::Axis;
use crate::input_output::Disturbance;
#[cfg(target_os = "linux")]
use crate::raw_socket::RawSocket;
use crate::serial::Serial;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use forcefeel_bus::ethercat::datagram::MOST;
use forcefeel_bus::frame::Frame;
use forcefeel_bus::line::{Adapter, Line, Lines};
use std::collections::VecDeque;
use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Longest rest between two looks at the port.
const NAP: Duration = Duration::from_micros(250);
/// Time without a frame after which machines without a clock send by themselves.
const IDLE: Duration = Duration::from_millis(200);
/// Most reads of the port before the machines go on.
const MOST_READS: usize = 64;
/// Most that the machines catch up at once, in s.
const MOST_BEHIND_S: f64 = 0.1;

/// What is wrong with the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WireFault {
    /// Answers are lost.
    Lost,
    /// Answers come so many commands late.
    Late(usize),
    /// Answers come twice.
    Repeated,
    /// A bit of an answer is turned round.
    Corrupt,
    /// The node is gone: no frame reaches it.
    Gone,
    /// The adapter is off the bus, and says so; on EtherCAT the link is down.
    BusOff,
    /// The nodes let a frame pass without their share: on EtherCAT its working counter is wrong.
    Miscounted,
}

/// What is done to an emulated bus from outside.
#[derive(Debug, Clone, Copy)]
pub enum EmulatorRequest {
    /// Something is wrong with each so manieth answer from now on, or nothing.
    Wire(Option<(WireFault, u32)>),
    /// A drive fails with the maker's code.
    Fail(usize, u16),
    /// A drive loses its supply for a moment.
    Restart(usize),
    /// A second drive has the number of one.
    Twin(usize),
    /// Something happens to a machine.
    Machine(usize, Disturbance),
}

#[derive(Default)]
pub(crate) struct Shared {
    pub end: AtomicBool,
    pub asked: Mutex<Vec<EmulatorRequest>>,
    /// Command and angle of each machine's newest step.
    pub seen: Mutex<Vec<[f64; 2]>>,
}

/// Where the frames come from and the answers go.
pub(crate) enum Terminals {
    /// A serial adapter at a pseudo terminal.
    Serial(Serial, Lines),
    /// A network interface.
    #[cfg(target_os = "linux")]
    Interface(RawSocket),
}

impl Terminals {
    /// A pseudo terminal for an adapter, an interface without one; and where others open it.
    pub fn open(adapter: Option<Adapter>, interface: &str) -> io::Result<(Self, PathBuf)> {
        if let Some(adapter) = adapter {
            let (serial, port) = Serial::pseudo()?;
            return Ok((Self::Serial(serial, Lines::new(adapter)), port));
        }
        #[cfg(target_os = "linux")]
        return Ok((Self::Interface(RawSocket::open(interface)?), interface.into()));
        #[cfg(not(target_os = "linux"))]
        Err(io::Error::new(io::ErrorKind::Unsupported, format!("{interface}: expected Linux for EtherCAT")))
    }

    /// What has come: bytes of lines, or a frame.
    fn read(&self, bytes: &mut [u8]) -> usize {
        match self {
            Self::Serial(serial, _) => serial.read(bytes),
            #[cfg(target_os = "linux")]
            Self::Interface(socket) => socket.receive(bytes).unwrap_or(0),
        }
    }

    fn write(&self, bytes: &[u8]) {
        match self {
            Self::Serial(serial, _) => _ = serial.write(bytes),
            #[cfg(target_os = "linux")]
            Self::Interface(socket) => socket.send(bytes),
        }
    }

    fn wait(&self, most: Duration) {
        match self {
            Self::Serial(serial, _) => serial.wait(most),
            #[cfg(target_os = "linux")]
            Self::Interface(socket) => socket.wait(most),
        }
    }
}

/// A frame of CAN, or of Ethernet.
enum Came {
    Frame(Frame),
    #[cfg_attr(not(target_os = "linux"), expect(dead_code, reason = "there is no interface"))]
    Packet(Vec<u8>),
}

/// The port with its machines.
pub(crate) struct Wire {
    terminals: Terminals,
    axes: Vec<Axis>,
    shared: Arc<Shared>,
    fault: Option<(WireFault, u32)>,
    answers: u32,
    held: VecDeque<(usize, Vec<u8>)>,
    /// When the last frame came.
    came: Instant,
}

impl Wire {
    /// A wire without a fault.
    pub fn new(terminals: Terminals, axes: Vec<Axis>, shared: Arc<Shared>) -> Self {
        Self { terminals, axes, shared, fault: None, answers: 0, held: VecDeque::new(), came: Instant::now() }
    }

    /// Runs until the end is asked for.
    pub fn run(mut self, by_clock: bool) {
        let begun = Instant::now();
        let mut bytes = [0; MOST];
        while !self.shared.end.load(Relaxed) {
            let asked = core::mem::take(&mut *locked(&self.shared.asked));
            for asked in asked {
                self.take(asked);
            }
            let came = self.received(&mut bytes);
            let count = came.len();
            for (left, frame) in (1..=count).rev().zip(came) {
                if by_clock {
                    self.catch_up(begun, left);
                }
                match frame {
                    Came::Frame(frame) => self.frame(&frame, by_clock),
                    Came::Packet(mut packet) => self.packet(&mut packet, by_clock),
                }
            }
            if by_clock {
                self.catch_up(begun, 1);
            }
            // Where machines wait for commands, what they send by themselves goes with those, or by the clock while none comes.
            let idle = self.came.elapsed();
            if by_clock || idle > IDLE {
                self.tick(if by_clock { 0.0 } else { idle.as_secs_f64() });
            }
            *locked(&self.shared.seen) = self.axes.iter().map(|axis| [axis.command, axis.machine.angle()]).collect();
            if count == 0 {
                self.terminals.wait(NAP);
            }
        }
    }

    /// Has the machines go on by the clock. Of several frames that came while this computer was busy, each gets its share of the time
    /// before it: a drive would have taken them one after another.
    fn catch_up(&mut self, begun: Instant, frames: usize) {
        let now_s = begun.elapsed().as_secs_f64();
        for axis in &mut self.axes {
            axis.time_s = axis.time_s.max(now_s - MOST_BEHIND_S);
            #[expect(clippy::cast_precision_loss, reason = "a few frames")]
            let until_s = axis.time_s + (now_s - axis.time_s) / frames as f64;
            while axis.time_s + axis.machine.step_s() <= until_s {
                axis.advance(1);
            }
        }
    }

    /// The frames that have come, of at most [`MOST_READS`] reads: another program may write without end.
    fn received(&mut self, bytes: &mut [u8]) -> Vec<Came> {
        let mut frames = vec![];
        for _ in 0..MOST_READS {
            let count = self.terminals.read(bytes);
            if count == 0 {
                break;
            }
            self.came = Instant::now();
            match &mut self.terminals {
                Terminals::Serial(_, lines) => {
                    frames.extend(bytes[..count].iter().filter_map(|&byte| match lines.take(byte) {
                        Some(Line::Frame(frame)) => Some(Came::Frame(frame)),
                        _ => None,
                    }));
                }
                #[cfg(target_os = "linux")]
                Terminals::Interface(_) => frames.push(Came::Packet(bytes[..count].to_vec())),
            }
        }
        frames
    }

    fn take(&mut self, asked: EmulatorRequest) {
        match asked {
            EmulatorRequest::Wire(fault) => {
                (self.fault, self.answers) = (fault, 0);
                self.held.clear();
            }
            EmulatorRequest::Fail(place, code) => self.axes[place].node.fail(code),
            EmulatorRequest::Restart(place) => self.axes[place].restart(),
            EmulatorRequest::Twin(place) => self.axes[place].add_twin(),
            EmulatorRequest::Machine(place, disturbance) => self.axes[place].machine.disturb(disturbance),
        }
    }

    /// What the nodes send by themselves.
    fn tick(&mut self, more_s: f64) {
        let Terminals::Serial(serial, lines) = &self.terminals else { return };
        let cut = matches!(self.fault, Some((WireFault::Gone | WireFault::BusOff | WireFault::Lost, 1)));
        for axis in &mut self.axes {
            axis.node.tick(axis.time_s + more_s, &mut |frame| {
                let (bytes, count) = lines.give(frame);
                if !cut {
                    serial.write(&bytes[..count]);
                }
            });
        }
    }

    /// Whether a fault of the wire is that of each frame.
    fn is(&self, fault: WireFault) -> bool {
        self.fault.is_some_and(|(its, _)| its == fault)
    }

    /// A frame of EtherCAT passes all slaves, and goes back.
    fn packet(&mut self, bytes: &mut [u8], by_clock: bool) {
        if self.is(WireFault::Gone) || self.is(WireFault::BusOff) {
            return;
        }
        let miscounted = self.fault.filter(|(fault, _)| *fault == WireFault::Miscounted);
        if !miscounted.is_some_and(|(_, every)| (self.answers + 1).is_multiple_of(every)) {
            for axis in &mut self.axes {
                let shown = axis.shown;
                if axis.node.pass(bytes, &shown, axis.time_s) && !by_clock {
                    axis.advance(axis.period);
                }
            }
        }
        // The first slave marks what has passed it.
        if let Some(source) = bytes.get_mut(6) {
            *source |= 0x02;
        }
        self.answer(bytes);
    }

    /// A frame of CAN is acknowledged, and each node may answer it.
    fn frame(&mut self, frame: &Frame, by_clock: bool) {
        let Terminals::Serial(serial, lines) = &self.terminals else { return };
        let sent = !self.is(WireFault::BusOff);
        let (bytes, count) = lines.acknowledge(sent);
        serial.write(&bytes[..count]);
        let (mut answers, mut advanced) = (vec![], false);
        if sent && !self.is(WireFault::Gone) {
            for axis in &mut self.axes {
                let shown = axis.shown;
                let mut send = |answer: &Frame| {
                    let (bytes, count) = lines.give(answer);
                    answers.push(bytes[..count].to_vec());
                };
                let commanded = axis.node.take(frame, &shown, axis.time_s, &mut send);
                if let Some(twin) = &mut axis.twin {
                    twin.take(frame, &shown, axis.time_s, &mut send);
                }
                if commanded && !by_clock {
                    axis.advance(axis.period);
                    advanced = true;
                }
            }
        }
        if advanced {
            self.tick(0.0);
        }
        for answer in &mut answers {
            self.answer(answer);
        }
    }

    fn answer(&mut self, bytes: &mut [u8]) {
        self.answers += 1;
        self.held.iter_mut().for_each(|(left, _)| *left = left.saturating_sub(1));
        match self.fault.filter(|(_, every)| self.answers.is_multiple_of(*every)).map(|(fault, _)| fault) {
            Some(WireFault::Lost | WireFault::Gone | WireFault::BusOff) => {}
            Some(WireFault::Late(by)) => self.held.push_back((by, bytes.to_vec())),
            Some(WireFault::Repeated) => {
                self.terminals.write(bytes);
                self.terminals.write(bytes);
            }
            Some(WireFault::Corrupt) => {
                bytes[bytes.len() / 2] ^= 1;
                self.terminals.write(bytes);
            }
            Some(WireFault::Miscounted) | None => self.terminals.write(bytes),
        }
        while self.held.front().is_some_and(|(left, _)| *left == 0) {
            if let Some((_, late)) = self.held.pop_front() {
                self.terminals.write(&late);
            }
        }
    }
}

pub(crate) fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}
