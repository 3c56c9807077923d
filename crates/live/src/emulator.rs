//! Machines of loaders as nodes of a bus, behind a pseudo terminal that any client of the bus opens.
//!
//! By the clock the machines go on by themselves, in steps finer than a sample. Without one each machine takes a period at each command
//! for its node: then a loop in virtual time and its machine go together, and repeat to the bit.

use crate::input_output::{Command, Disturbance};
use crate::priority::ask;
use crate::serial::Serial;
use crate::setup::Setup;
use crate::simulated::{Script, Stepped, simulated};
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use forcefeel_bus::drive::{Action, Node, Shown};
use forcefeel_bus::frame::Frame;
use forcefeel_bus::line::{Line, Lines};
use forcefeel_bus::protocol::Protocol;
use forcefeel_bus::scale::Scale;
use forcefeel_model::controller::Timing;
use std::collections::VecDeque;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Longest rest between two looks at the port.
const NAP: Duration = Duration::from_micros(250);
/// Most that the machines catch up at once, in s.
const MOST_BEHIND_S: f64 = 0.1;
/// Rate in 1/s at which a drive that damps takes the speed off its own rotor.
const DAMPS_PER_S: f64 = 60.0;

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
    /// The adapter is off the bus, and says so.
    BusOff,
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
    /// Something happens to a machine.
    Machine(usize, Disturbance),
}

/// A bus under way.
pub struct Emulator {
    port: PathBuf,
    shared: Arc<Shared>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

#[derive(Default)]
struct Shared {
    end: AtomicBool,
    asked: Mutex<Vec<EmulatorRequest>>,
    /// Command and angle of each machine's newest step.
    seen: Mutex<Vec<[f64; 2]>>,
}

/// A machine with its drive.
struct Axis {
    machine: Box<dyn Stepped>,
    node: Box<dyn Node + Send>,
    /// To make it anew.
    made: (Protocol, u8),
    scale: Scale,
    shown: Shown,
    position: f64,
    travel: f64,
    /// Command in A per speed of the motor in rad/s at which it damps, and the most.
    damping: [f64; 2],
    command: f64,
    period: usize,
    /// Time of its machine in s.
    time_s: f64,
}

/// A loader at a node: its setup, kind and number, and how it is wired.
pub type Place = (Setup, Protocol, u8, forcefeel_bus::scale::Wiring, Script);

impl Emulator {
    /// Begins.
    ///
    /// # Errors
    /// If the system gives no terminal or no thread.
    pub fn start(places: Vec<Place>, by_clock: bool) -> io::Result<Self> {
        let (serial, port) = Serial::pseudo()?;
        let adapter = places.first().map_or(Protocol::Moteus, |place| place.1).adapter();
        let shared = Arc::new(Shared::default());
        let sees = Arc::clone(&shared);
        let axes = move || places.into_iter().map(Axis::new).collect::<Vec<_>>();
        let thread = thread::Builder::new().name("forcefeel-emulator".into()).spawn(move || {
            // By the clock a machine is not held up by others.
            let _held = by_clock.then(ask);
            Wire {
                serial,
                lines: Lines::new(adapter),
                axes: axes(),
                shared: sees,
                fault: None,
                answers: 0,
                held: VecDeque::new(),
            }
            .run(by_clock);
        })?;
        Ok(Self { port, shared, thread: Mutex::new(Some(thread)) })
    }

    /// Where clients open it.
    pub fn port(&self) -> &Path {
        &self.port
    }

    /// Has something happen.
    pub fn ask(&self, asked: EmulatorRequest) {
        locked(&self.shared.asked).push(asked);
    }

    /// Command in A and angle of the column in rad of each machine.
    pub fn seen(&self) -> Vec<[f64; 2]> {
        locked(&self.shared.seen).clone()
    }

    /// Ends it.
    pub fn end(&self) {
        self.shared.end.store(true, Relaxed);
        if let Some(thread) = locked(&self.thread).take() {
            // A thread that panicked has said why, and is over.
            let _ = thread.join();
        }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        self.end();
    }
}

impl Axis {
    fn new((setup, protocol, number, wiring, script): Place) -> Self {
        let parameters = setup.parameters();
        let period = setup.timing.period;
        // The bus itself is the delay; a step is a sample.
        let (mut machine, _) = simulated(&Setup { timing: Timing { period: 1, delay: 0 }, ..setup }, script);
        let scale = Scale::new(&parameters, wiring);
        let motor = &parameters.motor;
        let damping = DAMPS_PER_S * motor.inertia / motor.torque_constant;
        let sensors = machine.read().map_or([0.0; 4], |sampled| sampled.sample.sensors);
        Self {
            machine,
            node: protocol.node(number),
            made: (protocol, number),
            scale,
            shown: scale.shown(sensors, 0.0, 0.0),
            position: sensors[1],
            travel: parameters.transmission.travel,
            damping: [damping, parameters.current_loop.current_limit],
            command: 0.0,
            period,
            time_s: 0.0,
        }
    }

    /// Steps of the machine, with what the drive does.
    fn advance(&mut self, steps: usize) {
        for _ in 0..steps {
            self.time_s += self.machine.step_s();
            let speed = self.shown.velocity;
            let [per_speed, most] = self.damping;
            self.command = match self.node.action(self.time_s) {
                Action::Free => 0.0,
                Action::Torque(torque) => self.scale.command(torque),
                Action::Damp => (-per_speed * self.scale.speed(speed)).clamp(-most, most),
            };
            self.machine.write(&Command { cycle: 0, command: self.command, enable: true, state: 0 });
            if let Some(sampled) = self.machine.read() {
                let sensors = sampled.sample.sensors;
                let speed = (sensors[1] - self.position) / (self.travel * self.machine.step_s());
                self.position = sensors[1];
                self.shown = self.scale.shown(sensors, self.command, speed);
            }
        }
    }
}

/// The port with its machines.
struct Wire {
    serial: Serial,
    lines: Lines,
    axes: Vec<Axis>,
    shared: Arc<Shared>,
    fault: Option<(WireFault, u32)>,
    answers: u32,
    held: VecDeque<(usize, Frame)>,
}

impl Wire {
    fn run(mut self, by_clock: bool) {
        let begun = Instant::now();
        let mut bytes = [0; 512];
        while !self.shared.end.load(Relaxed) {
            let asked = core::mem::take(&mut *locked(&self.shared.asked));
            for asked in asked {
                self.take(asked);
            }
            if by_clock {
                let now_s = begun.elapsed().as_secs_f64();
                for axis in &mut self.axes {
                    axis.time_s = axis.time_s.max(now_s - MOST_BEHIND_S);
                    while axis.time_s + axis.machine.step_s() <= now_s {
                        axis.advance(1);
                    }
                }
            }
            // Where machines wait for commands, what they send by themselves is still of the clock.
            self.tick(if by_clock { 0.0 } else { begun.elapsed().as_secs_f64() });
            *locked(&self.shared.seen) = self.axes.iter().map(|axis| [axis.command, axis.machine.angle()]).collect();
            let count = self.serial.read(&mut bytes);
            for &byte in &bytes[..count] {
                if let Some(Line::Frame(frame)) = self.lines.take(byte) {
                    self.frame(&frame, by_clock);
                }
            }
            if count == 0 {
                self.serial.wait(NAP);
            }
        }
    }

    fn take(&mut self, asked: EmulatorRequest) {
        match asked {
            EmulatorRequest::Wire(fault) => {
                (self.fault, self.answers) = (fault, 0);
                self.held.clear();
            }
            EmulatorRequest::Fail(place, code) => self.axes[place].node.fail(code),
            EmulatorRequest::Restart(place) => {
                let (protocol, number) = self.axes[place].made;
                self.axes[place].node = protocol.node(number);
            }
            EmulatorRequest::Machine(place, disturbance) => self.axes[place].machine.disturb(disturbance),
        }
    }

    /// What the nodes send by themselves.
    fn tick(&mut self, more_s: f64) {
        let cut = matches!(self.fault, Some((WireFault::Gone | WireFault::BusOff | WireFault::Lost, 1)));
        for axis in &mut self.axes {
            axis.node.tick(axis.time_s + more_s, &mut |frame| {
                let (bytes, count) = self.lines.give(frame);
                if !cut {
                    self.serial.write(&bytes[..count]);
                }
            });
        }
    }

    fn frame(&mut self, frame: &Frame, by_clock: bool) {
        let fault = self.fault.map(|(fault, _)| fault);
        let sent = fault != Some(WireFault::BusOff);
        let (bytes, count) = self.lines.acknowledge(sent);
        self.serial.write(&bytes[..count]);
        if !sent || fault == Some(WireFault::Gone) {
            return;
        }
        for place in 0..self.axes.len() {
            let mut answers = vec![];
            let axis = &mut self.axes[place];
            let shown = axis.shown;
            let commanded = axis.node.take(frame, &shown, axis.time_s, &mut |answer| answers.push(*answer));
            if commanded && !by_clock {
                axis.advance(axis.period);
            }
            for answer in answers {
                self.answer(&answer);
            }
        }
    }

    fn answer(&mut self, frame: &Frame) {
        self.answers += 1;
        self.held.iter_mut().for_each(|(left, _)| *left = left.saturating_sub(1));
        let (mut bytes, count) = self.lines.give(frame);
        match self.fault.filter(|(_, every)| self.answers.is_multiple_of(*every)).map(|(fault, _)| fault) {
            Some(WireFault::Lost | WireFault::Gone | WireFault::BusOff) => {}
            Some(WireFault::Late(by)) => self.held.push_back((by, *frame)),
            Some(WireFault::Repeated) => {
                self.serial.write(&bytes[..count]);
                self.serial.write(&bytes[..count]);
            }
            Some(WireFault::Corrupt) => {
                bytes[count / 2] ^= 1;
                self.serial.write(&bytes[..count]);
            }
            None => {
                self.serial.write(&bytes[..count]);
            }
        }
        while let Some((0, late)) = self.held.front().copied() {
            self.held.pop_front();
            let (bytes, count) = self.lines.give(&late);
            self.serial.write(&bytes[..count]);
        }
    }
}

fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}
