//! Drives and valves' terminals on EtherCAT: one interface, a frame for each axis and cycle.

use crate::bus::{Answer, Fieldbus, NodeSettings};
use crate::raw_socket::RawSocket;
use forcefeel_bus::drive::{Ask, Identity};
use forcefeel_bus::ethercat::MOST_POSITION;
use forcefeel_bus::ethercat::axis::Axis;
use forcefeel_bus::ethercat::datagram::{MOST, Packet, datagrams};
use forcefeel_bus::ethercat::start::{start_drive, start_terminals};
use forcefeel_bus::ethercat::station::{Segment, Station, scan, stop_all};
use forcefeel_bus::fault::Fault;
use std::io;
use std::thread;
use std::time::{Duration, Instant};

/// How long a frame is waited for.
const ROUND: Duration = Duration::from_millis(20);
/// Period in which axes that have started are asked while others start, and how long one may take to be ready.
const KEPT_UP: Duration = Duration::from_millis(2);
const READY: Duration = Duration::from_secs(3);
/// Logical addresses of an axis.
const SHARE: u32 = 0x1_0000;

/// An interface with its slaves.
pub struct EtherCat {
    socket: RawSocket,
    /// Alias of each slave by position.
    aliases: Vec<u16>,
    axes: Vec<Tap>,
    /// Number of the last frame that was waited for.
    index: u8,
    kept_up: Instant,
}

/// An axis with its answer.
struct Tap {
    axis: Axis,
    /// Of its slaves, the second the same where there is one.
    positions: [u16; 2],
    answer: Answer,
    /// What its last frame said, if that was no state.
    complaint: Option<Fault>,
    /// Cycle of its last frame, and its watchdog in s.
    cycle: u64,
    watchdog_s: f64,
}

impl EtherCat {
    /// Opens an interface, and counts its slaves.
    ///
    /// # Errors
    /// If it cannot be opened, or has none.
    pub fn open(name: &str) -> io::Result<Self> {
        let socket = RawSocket::open(name)?;
        let mut made = Self { socket, aliases: vec![], axes: vec![], index: 0, kept_up: Instant::now() };
        made.aliases = scan(&mut made).map_err(io::Error::other)?;
        Ok(made)
    }

    /// Position of the node that a key states, from one.
    fn position(&self, key: &str, node: u8) -> Result<u16, String> {
        let (count, aliases) = (u16::try_from(self.aliases.len()).unwrap_or(u16::MAX), &self.aliases);
        if node <= MOST_POSITION {
            let position = u16::from(node);
            return if (1..=count).contains(&position) {
                Ok(position)
            } else {
                Err(format!(
                    "expected a slave at position {node}, got {count} on the wire; check power and [bus] {key}"
                ))
            };
        }
        let mut places = (1..=count).filter(|position| aliases[usize::from(position - 1)] == u16::from(node));
        match (places.next(), places.next()) {
            (Some(position), None) => Ok(position),
            (Some(_), Some(_)) => Err(format!("expected one slave with alias {node}, got more; give each its own")),
            (None, _) => Err(format!("expected a slave with alias {node}, got aliases {aliases:?}; check [bus] {key}")),
        }
    }

    /// Asks an axis that is stopped.
    fn keep_up(&mut self, place: usize) {
        // In the loop's last cycle: its answer is no news of the loop's.
        let Tap { cycle, watchdog_s, .. } = self.axes[place];
        self.ask(place, &Ask { cycle, torque: 0.0, enable: false, watchdog_s });
    }

    /// Asks an axis until it is in OP without a fault.
    fn ready(&mut self, place: usize) -> Result<(), String> {
        let begun = Instant::now();
        while begun.elapsed() < READY {
            self.keep_up(place);
            self.wait(ROUND);
            self.pump();
            if self.axes[place].axis.ready() {
                return Ok(());
            }
            thread::sleep(KEPT_UP);
        }
        let Tap { complaint, answer, .. } = &self.axes[place];
        let fault = complaint.unwrap_or(answer.state.fault);
        Err(format!(
            "expected OP and a drive without a fault, got {}",
            if fault.is_some() { fault } else { Fault::SILENT }
        ))
    }

    fn took(&mut self, frame: &mut [u8]) {
        for tap in &mut self.axes {
            match tap.axis.take(frame) {
                Some(Ok(state)) => {
                    tap.complaint = None;
                    // One that is repeated, or that a later one has overtaken, is no news.
                    if state.answers > tap.answer.state.answers {
                        tap.answer = Answer { state, fresh: true };
                    }
                }
                Some(Err(fault)) => tap.complaint = Some(fault),
                None => {}
            }
        }
    }
}

impl Drop for EtherCat {
    /// Leaves all slaves in INIT, without torque: none of them has to wait for its watchdog.
    fn drop(&mut self) {
        stop_all(self);
    }
}

impl Segment for EtherCat {
    fn exchange(&mut self, packet: &mut Packet) -> bool {
        if self.kept_up.elapsed() > KEPT_UP {
            self.kept_up = Instant::now();
            (0..self.axes.len()).for_each(|place| self.keep_up(place));
        }
        self.index = self.index.wrapping_add(1);
        packet.renumber(self.index);
        let first = packet.first();
        self.socket.send(packet.sent());
        let begun = Instant::now();
        while let Some(left) = ROUND.checked_sub(begun.elapsed()) {
            let mut bytes = [0; MOST];
            let Some(_) = self.socket.receive(&mut bytes) else {
                self.socket.wait(left);
                continue;
            };
            if datagrams(&mut bytes).next().is_some_and(|it| [it.command, it.index] == first) {
                packet.bytes = bytes;
                return true;
            }
            self.took(&mut bytes);
        }
        false
    }

    fn rest(&mut self) {
        thread::sleep(Duration::from_millis(1));
    }
}

impl Fieldbus for EtherCat {
    fn connect(&mut self, settings: &NodeSettings, period_s: Option<f64>) -> Result<usize, String> {
        let NodeSettings { node, units, analog, watchdog_s, .. } = settings;
        let output = self.position("node", *node)?;
        let input = analog.map(|analog| analog.input_node).or(units.input_node);
        let input = input.map_or(Ok(output), |node| self.position("input_node", node))?;
        let positions = [output, input];
        let taken = |position| self.axes.iter().any(|tap| tap.positions.contains(&position));
        if taken(output) {
            return Err(format!("node: expected one for each axis, got {node} twice; change [bus] node"));
        }
        if taken(input) {
            // An axis starts its terminals itself, and stops them with itself.
            return Err(format!(
                "input_node: terminal {input} has the inputs of another axis, even if channels are free; give each axis an input \
                 terminal of its own, and change [bus] input_node"
            ));
        }
        let place = self.axes.len();
        let reference = self.axes.iter().find_map(|tap| tap.axis.clock());
        let base = SHARE * u32::try_from(place + 1).unwrap_or(1);
        let named = |why| format!("node {node}: {why}");
        let axis = match analog {
            Some(analog) => start_terminals(self, positions, analog, *watchdog_s, base),
            None => start_drive(self, positions, units, *watchdog_s, period_s, base, reference),
        };
        let axis = axis.map_err(named)?;
        let answer = Answer::NONE;
        self.axes.push(Tap { axis, positions, answer, complaint: None, cycle: 0, watchdog_s: *watchdog_s });
        self.ready(place).map_err(named)?;
        self.axes[place].answer = Answer::NONE;
        Ok(place)
    }

    fn ask(&mut self, place: usize, ask: &Ask) {
        let tap = &mut self.axes[place];
        tap.cycle = ask.cycle;
        let packet = tap.axis.ask(ask);
        self.socket.send(packet.sent());
    }

    fn pump(&mut self) {
        let mut bytes = [0; MOST];
        while self.socket.receive(&mut bytes).is_some() {
            self.took(&mut bytes);
        }
    }

    fn wait(&self, most: Duration) {
        self.socket.wait(most);
    }

    fn answer(&mut self, place: usize) -> &mut Answer {
        &mut self.axes[place].answer
    }

    fn complaint(&self, place: usize) -> Option<(Fault, bool)> {
        self.axes[place].complaint.map(|fault| (fault, false))
    }

    fn nodes(&mut self, _: &NodeSettings) -> Vec<Identity> {
        let positions = 1..=self.aliases.len();
        let nodes = positions.filter_map(|position| {
            let number = u16::try_from(position).ok()?;
            Station::new(self, number).identity(u8::try_from(position).ok()?).ok()
        });
        nodes.collect()
    }
}
