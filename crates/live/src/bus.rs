//! Drives on a bus: one port, a node for each axis, in units of the loader.
//!
//! Each cycle writes its command, and asks for the node's state in the same breath; the answer is the sample of the next cycle. So a
//! sample is answered a period after it was taken, which is the least `controller.delay`.
//!
//! A command that is lost leaves the drive with the one before, until its own watchdog damps it. An answer that is lost, damaged,
//! repeated or late counts as the supervisor has it of any machine.

use crate::input_output::{Command, InputOutput, Sampled};
use crate::priority::{PRIORITY, ask};
use forcefeel_bus::drive::{Ask, Identity, State};
use forcefeel_bus::ethercat::Units;
use forcefeel_bus::ethercat::analog::Analog;
use forcefeel_bus::fault::Fault;
use forcefeel_bus::protocol::Protocol;
use forcefeel_bus::scale::{Scale, Wiring};
use forcefeel_model::control::Sample;
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::SENSORS;
use std::panic::resume_unwind;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Cycles whose commands are remembered, as many as a moteus tells apart.
const REMEMBERED: usize = 16;
/// Cycles without an answer after which a node counts as silent.
const SILENT: u32 = 16;
/// How long its first state is waited for.
const FIRST_ANSWER: Duration = Duration::from_secs(1);
/// How long an answer is waited for in virtual time.
const VIRTUAL_PATIENCE: Duration = Duration::from_millis(250);

/// A node as a loader file has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeSettings {
    /// Kind of drive.
    pub protocol: Protocol,
    /// Its number.
    pub node: u8,
    /// Gear, zero, sensors.
    pub wiring: Wiring,
    /// Time without a command after which the drive damps by itself, in s.
    pub watchdog_s: f64,
    /// Units that a drive on EtherCAT does not state.
    pub units: Units,
    /// Terminals of a valve on EtherCAT.
    pub analog: Option<Analog>,
}

impl NodeSettings {
    /// The conversion of a loader there.
    pub fn scale(&self, parameters: &Parameters<f64>) -> Scale {
        match &self.analog {
            Some(analog) => Scale::of_valve(parameters, self.wiring, analog),
            None => Scale::new(parameters, self.wiring),
        }
    }
}

/// What carries the commands of all axes at a port, and their states.
pub trait Fieldbus: Send {
    /// Finds the drive of an axis, which can be driven, and leaves it stopped: its place.
    ///
    /// # Errors
    /// What was expected, what is there.
    fn connect(&mut self, settings: &NodeSettings, period_s: Option<f64>) -> Result<usize, String>;
    /// Sends what a cycle asks of an axis.
    fn ask(&mut self, place: usize, ask: &Ask);
    /// Takes all that has come.
    fn pump(&mut self);
    /// Waits until something has come, for so long at most.
    fn wait(&self, most: Duration);
    /// What an axis has answered.
    fn answer(&mut self, place: usize) -> &mut Answer;
    /// What the bus itself complains of, of an axis that does not answer; and whether that is sure without a wait.
    fn complaint(&self, place: usize) -> Option<(Fault, bool)>;
    /// What each node states of itself.
    fn nodes(&mut self, settings: &NodeSettings) -> Vec<Identity>;
}

/// The newest state of an axis, and whether it has not been read.
#[derive(Debug, Clone, Copy)]
pub struct Answer {
    /// The state.
    pub state: State,
    /// Whether it has not been read.
    pub fresh: bool,
}

impl Answer {
    /// Nothing has come yet.
    pub const NONE: Self = Self { state: State::NONE, fresh: false };
}

/// Load cell in N, drive's end and column's base in m, force sensor at the grip in N, current in A, time in s.
pub type Played = [f64; SENSORS + 2];

/// A bus that axes share.
pub type Port = Arc<Mutex<Box<dyn Fieldbus>>>;

/// An axis on a bus.
pub struct OnBus {
    bus: Port,
    place: usize,
    scale: Scale,
    watchdog_s: f64,
    /// Time in which the drive must act once it is enabled.
    power_time: Duration,
    /// Period of a loop by the clock in s.
    period_s: Option<f64>,
    /// Whether an answer is waited for.
    waits: bool,
    /// Commands so far, the first of which only asks.
    asked: u64,
    /// When each of the last was written, and whether it enabled.
    written: [(Instant, bool); REMEMBERED],
    /// Command that the last sample answered.
    answered: u64,
    /// Current of the motor in A, as the drive states it; command of a valve in V.
    current: f64,
    /// Whether a torque acts.
    acts: bool,
    silent: u32,
    fault: Fault,
}

impl OnBus {
    /// Finds the node of an axis, stopped, and asks for its first sample.
    ///
    /// # Errors
    /// If the node is not there, is there twice, or cannot be driven.
    pub fn connect(
        bus: &Port,
        parameters: &Parameters<f64>,
        settings: &NodeSettings,
        period_s: Option<f64>,
    ) -> Result<Self, String> {
        let mut opened = locked(bus);
        let place = opened.connect(settings, period_s)?;
        let mut made = Self {
            bus: Arc::clone(bus),
            place,
            scale: settings.scale(parameters),
            watchdog_s: settings.watchdog_s,
            power_time: Duration::from_secs_f64(parameters.safety.power_time),
            period_s,
            waits: period_s.is_none(),
            asked: 0,
            written: [(Instant::now(), false); REMEMBERED],
            answered: 0,
            current: 0.0,
            acts: false,
            silent: 0,
            fault: Fault::NONE,
        };
        opened.ask(place, &made.ask(0.0, false));
        let begun = Instant::now();
        while !opened.answer(place).fresh
            && let Some(left) = FIRST_ANSWER.checked_sub(begun.elapsed())
        {
            opened.wait(left);
            opened.pump();
        }
        let state = opened.answer(place).state;
        drop(opened);
        let node = settings.node;
        if state.answers.is_none() && state.position.is_nan() {
            return Err(format!("node {node}: expected an answer to a stop, got none; check cable and bit rate"));
        }
        if state.fault.is_some() {
            return Err(format!("node {node}: expected a stopped drive without a fault, got {}", state.fault));
        }
        Ok(made)
    }

    /// Sends a command, and waits for the state that answers it: sensors, fault and time that it took; nothing if none comes.
    pub fn exchange(&mut self, command: f64, enable: bool) -> Option<(Sampled, Fault, Duration)> {
        let begun = Instant::now();
        self.waits = true;
        {
            // An earlier answer that was not read is not that of this command.
            let mut bus = locked(&self.bus);
            bus.pump();
            bus.answer(self.place).fresh = false;
        }
        self.write(&Command { cycle: 0, command, enable, state: 0 });
        let sampled = self.read()?;
        Some((sampled, self.fault, begun.elapsed()))
    }

    /// Gives the drive these currents in A, one a period by the clock where there is one, and stops it: what the sensors showed and the
    /// current in A as each came, and when it was sent in s; why it ended early, if it did.
    ///
    /// One that is late is not made up for: those after it are as late. One that is too late is a matter of the drive's watchdog. The drive's end stays within a distance in m of where it began.
    pub fn play(&mut self, currents: &[f64], most: f64) -> (Vec<Played>, Option<String>) {
        first(|| self.played(currents, most))
    }

    fn played(&mut self, currents: &[f64], most: f64) -> (Vec<Played>, Option<String>) {
        let (mut rows, mut ended) = (Vec::with_capacity(currents.len()), self.power_up());
        let currents = if ended.is_none() { currents } else { &[] };
        let begun = Instant::now();
        let mut due = begun;
        for &current in currents {
            if let Some(period_s) = self.period_s {
                let now = Instant::now();
                thread::sleep(due.saturating_duration_since(now));
                due = due.max(now) + Duration::from_secs_f64(period_s);
            }
            let sent_s = begun.elapsed().as_secs_f64();
            let Some((sampled, fault, _)) = self.exchange(current, true) else {
                ended = Some("the drive did not answer; check cable and supply".to_string());
                break;
            };
            let [force, position, base, grip] = sampled.sample.sensors;
            rows.push([force, position, base, grip, self.current, sent_s]);
            let start = rows[0][1];
            if fault.is_some() {
                ended = Some(fault.to_string());
                break;
            }
            if (position - start).abs() > most {
                ended = Some(format!("the drive's end moved by more than {most:.3} m; lower the limits of the signal"));
                break;
            }
        }
        let _ = self.exchange(0.0, false);
        (rows, ended)
    }

    /// Powers the drive without a current, until it acts; why not, if it does not.
    pub fn power_up(&mut self) -> Option<String> {
        let begun = Instant::now();
        while begun.elapsed() < self.power_time {
            match self.exchange(0.0, true) {
                None => return Some("the drive did not answer; check cable and supply".to_string()),
                Some((_, fault, _)) if fault.is_some() => return Some(fault.to_string()),
                Some(_) if self.acts => return None,
                Some(_) => thread::sleep(self.period_s.map_or(Duration::ZERO, Duration::from_secs_f64)),
            }
        }
        let time = self.power_time;
        Some(format!("the drive was enabled and did not act within {time:?}; check its supply and enable input"))
    }

    /// So many exchanges with the drive off, one a period: the time that each answer took in s, infinite where none came.
    pub fn round_trips(&mut self, count: usize, period: Duration) -> Vec<f64> {
        first(|| self.timed(count, period))
    }

    fn timed(&mut self, count: usize, period: Duration) -> Vec<f64> {
        let mut due = Instant::now();
        let exchanges = (0..count).map(|_| {
            thread::sleep(due.saturating_duration_since(Instant::now()));
            due = (due + period).max(Instant::now());
            self.exchange(0.0, false).map_or(f64::INFINITY, |(_, _, took)| took.as_secs_f64())
        });
        exchanges.collect()
    }

    /// The next command.
    fn ask(&mut self, torque: f64, enable: bool) -> Ask {
        let cycle = self.asked;
        self.written[remembered(cycle)] = (Instant::now(), enable);
        self.asked += 1;
        Ask { cycle, torque, enable, watchdog_s: self.watchdog_s }
    }

    /// What is wrong with a state: also where the drive stopped though it was enabled.
    fn fault_of(&self, state: &State, answered: u64) -> Fault {
        let enabled = |cycle: u64| self.written[remembered(cycle)].1;
        let stopped = answered > 0 && enabled(answered) && enabled(answered - 1) && !state.powered;
        if stopped && !state.fault.is_some() { Fault::RESTARTED } else { state.fault }
    }
}

impl InputOutput for OnBus {
    fn read(&mut self) -> Option<Sampled> {
        let mut bus = locked(&self.bus);
        bus.pump();
        if self.waits {
            let begun = Instant::now();
            while !bus.answer(self.place).fresh
                && let Some(left) = VIRTUAL_PATIENCE.checked_sub(begun.elapsed())
            {
                bus.wait(left);
                bus.pump();
            }
        }
        let answer = bus.answer(self.place);
        let (state, fresh) = (answer.state, core::mem::take(&mut answer.fresh));
        let complaint = bus.complaint(self.place);
        drop(bus);
        if !fresh {
            self.silent = self.silent.saturating_add(1);
            self.fault = match (complaint, self.fault) {
                (Some((fault, true)), _) => fault,
                (of, _) if self.silent >= SILENT => of.map_or(Fault::SILENT, |(fault, _)| fault),
                (_, before) => before,
            };
            return None;
        }
        self.silent = 0;
        let newest = self.asked - 1;
        let answered = state.answers.unwrap_or(newest);
        self.fault = self.fault_of(&state, answered);
        self.current = self.scale.command(state.torque);
        self.acts = state.acts;
        let since = self.written[remembered(answered)].0.duration_since(self.written[remembered(self.answered)].0);
        self.answered = answered;
        Some(Sampled {
            sample: Sample { sensors: self.scale.sensors(&state), pilot_force: f64::NAN },
            periods: self.period_s.map_or(1.0, |period| (since.as_secs_f64() / period).max(1.0)),
            delay: u32::try_from(newest - answered).unwrap_or(u32::MAX),
            emergency_stop: false,
            drive_fault: self.fault.0,
            drive_acts: state.acts,
        })
    }

    fn write(&mut self, command: &Command) {
        let torque = self.scale.torque(command.command);
        let ask = self.ask(torque, command.enable);
        locked(&self.bus).ask(self.place, &ask);
    }

    fn fault(&self) -> u16 {
        self.fault.0
    }
}

/// Works in a thread that runs before others, as far as the system lets it.
fn first<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let (_granted, _held) = ask(PRIORITY, true);
            work()
        });
        worker.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

#[expect(clippy::cast_possible_truncation, reason = "below the number that is remembered")]
fn remembered(cycle: u64) -> usize {
    (cycle % REMEMBERED as u64) as usize
}

/// The bus: its axes are in one thread, and none waits for another.
fn locked(bus: &Port) -> MutexGuard<'_, Box<dyn Fieldbus>> {
    bus.lock().unwrap_or_else(PoisonError::into_inner)
}
