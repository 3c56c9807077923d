//! Drives on CAN: a carrier of frames, a node for each axis.

use crate::bus::{Answer, Fieldbus, NodeSettings};
use crate::carrier::Carrier;
use forcefeel_bus::drive::{ALL_NODES, Ask, Codec, Identity};
use forcefeel_bus::fault::Fault;
use forcefeel_bus::frame::Frame;
use forcefeel_bus::line::Line;
use forcefeel_bus::scale::Wiring;
use std::cmp::Reverse;
use std::time::{Duration, Instant};

/// How long a node is waited for, and how often it is asked.
const PATIENCE: Duration = Duration::from_millis(500);
const TRIES: usize = 3;
/// What a node that states no serial number has.
const NO_SERIAL: [u32; 3] = [0; 3];
/// How long nodes are listened to.
const LISTENS: Duration = Duration::from_millis(250);

/// A port with its nodes.
pub struct CanBus {
    carrier: Box<dyn Carrier>,
    nodes: Vec<Tap>,
    error: bool,
}

/// A node with its answer.
struct Tap {
    codec: Box<dyn Codec + Send>,
    answer: Answer,
}

impl CanBus {
    /// A bus without nodes.
    pub fn new(carrier: Box<dyn Carrier>) -> Self {
        Self { carrier, nodes: vec![], error: false }
    }

    /// Asks a node what it is, or all where the number is that of all; what answers within a time.
    fn who(&mut self, codec: &dyn Codec, node: u8, patience: Duration) -> Vec<Identity> {
        self.count(codec, node, patience).0
    }

    /// The same, and how many answered that state no serial number.
    fn count(&mut self, codec: &dyn Codec, node: u8, patience: Duration) -> (Vec<Identity>, usize) {
        let Self { carrier, error, .. } = self;
        codec.who(node, &mut |frame| carrier.send(frame));
        let (begun, mut answers, mut once) = (Instant::now(), vec![], 0);
        while let Some(left) = patience.checked_sub(begun.elapsed()) {
            match carrier.next() {
                Some(Line::Frame(frame)) => {
                    once += usize::from(codec.answers_once(&frame));
                    answers.extend(codec.identity(&frame));
                }
                Some(Line::Error) => *error = true,
                Some(Line::Other) => {}
                None => carrier.wait(left),
            }
        }
        (apart(answers), once)
    }

    /// Finds a node that can be driven.
    ///
    /// # Errors
    /// What was expected, what is there.
    fn find(&mut self, codec: &dyn Codec, of: &NodeSettings) -> Result<(), String> {
        let node = of.node;
        let numbers = of.protocol.nodes();
        if !numbers.contains(&node) || (0..self.nodes.len()).any(|place| self.nodes[place].codec.node() == node) {
            let (first, last) = (numbers.start(), numbers.end());
            return Err(format!("node: expected {first} to {last}, each for one axis, got {node}; change [bus] node"));
        }
        let (mut answers, mut once) = (vec![], 0);
        for tried in 0..TRIES {
            self.error = false;
            (answers, once) = self.count(codec, node, PATIENCE);
            // Others are heard by what they send by themselves.
            answers.retain(|it| it.node == node);
            if !answers.is_empty() {
                break;
            }
            if self.error && tried == 0 {
                self.carrier.without_sums();
            }
        }
        match answers.as_slice() {
            [] => {
                let there = self.who(codec, ALL_NODES, PATIENCE);
                let there: Vec<_> = there.iter().map(|identity| identity.node.to_string()).collect();
                let there =
                    if there.is_empty() { "no other node".to_string() } else { format!("node {}", there.join(", ")) };
                let why = if self.error { "the adapter reports a bus error" } else { "no answer" };
                Err(format!(
                    "expected node {node}, got {why} from it and {there}; check power, cable, adapter, and kind and node of [bus]"
                ))
            }
            [_] if once > 1 => Err(format!(
                "expected one node {node}, got {once}, which state no serial number; give each a number of its own with the maker's tool"
            )),
            [identity] => codec.accepts(identity).map_err(|why| format!("node {node}: {why}")),
            several => Err(format!(
                "expected one node {node}, got {}, with the serial numbers {}; give each a number of its own with the maker's tool",
                several.len(),
                several.iter().map(Identity::serial_text).collect::<Vec<_>>().join(" and ")
            )),
        }
    }
}

/// The nodes of answers, each with the most that it stated: two of one number differ by their serial number, which not every answer has.
fn apart(mut answers: Vec<Identity>) -> Vec<Identity> {
    answers.sort_by_key(|it| (it.node, Reverse(it.registers)));
    let mut nodes: Vec<Identity> = vec![];
    for answer in answers {
        let same = |it: &Identity| it.node == answer.node && (it.serial == answer.serial || answer.serial == NO_SERIAL);
        if nodes.iter().any(same) {
            continue;
        }
        match nodes.iter_mut().find(|it| it.node == answer.node) {
            Some(known) if known.serial == NO_SERIAL => known.serial = answer.serial,
            Some(&mut known) if known.registers > answer.registers => {
                nodes.push(Identity { serial: answer.serial, ..known });
            }
            _ => nodes.push(answer),
        }
    }
    nodes.sort_by_key(|it| (it.node, it.serial));
    nodes
}

impl Fieldbus for CanBus {
    fn connect(&mut self, settings: &NodeSettings, _: Option<f64>) -> Result<usize, String> {
        let Wiring { load_cell, column, grip, .. } = settings.wiring;
        let sensors = [load_cell.is_some(), column.is_some(), grip.is_some()];
        let codec = settings.protocol.codec(settings.node, sensors).ok_or("kind: expected a drive on CAN")?;
        self.find(&*codec, settings)?;
        self.nodes.push(Tap { codec, answer: Answer::NONE });
        Ok(self.nodes.len() - 1)
    }

    fn ask(&mut self, place: usize, ask: &Ask) {
        let Self { carrier, nodes, .. } = self;
        nodes[place].codec.ask(ask, &mut |frame: &Frame| carrier.send(frame));
    }

    fn pump(&mut self) {
        while let Some(line) = self.carrier.next() {
            match line {
                Line::Frame(frame) => {
                    self.error = false;
                    for tap in &mut self.nodes {
                        let Some(state) = tap.codec.take(&frame) else { continue };
                        // One that is repeated, or that a later one has overtaken, is no news.
                        if state.answers.is_none() || state.answers > tap.answer.state.answers {
                            tap.answer = Answer { state, fresh: true };
                        }
                    }
                }
                Line::Error => self.error = true,
                Line::Other => {}
            }
        }
    }
    fn wait(&self, most: Duration) {
        self.carrier.wait(most);
    }

    fn answer(&mut self, place: usize) -> &mut Answer {
        &mut self.nodes[place].answer
    }

    fn complaint(&self, _: usize) -> Option<(Fault, bool)> {
        self.error.then_some((Fault::BUS, true))
    }

    fn nodes(&mut self, settings: &NodeSettings) -> Vec<Identity> {
        let Some(codec) = settings.protocol.codec(settings.node, [false; 3]) else { return vec![] };
        let mut answers = self.who(&*codec, ALL_NODES, LISTENS);
        // A node that does not answer a request to all may answer its own.
        answers.extend(self.who(&*codec, settings.node, LISTENS).into_iter().filter(|it| it.node == settings.node));
        apart(answers)
    }
}
