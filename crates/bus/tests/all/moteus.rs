//! A moteus: what a node does in time, and what the loop makes of its answers.

use forcefeel_bus::drive::{Action, Ask, Shown, State};
use forcefeel_bus::ethercat::Units;
use forcefeel_bus::fault::Fault;
use forcefeel_bus::frame::Frame;
use forcefeel_bus::protocol::Protocol;

const SHOWN: Shown = Shown { position: 0.25, velocity: -1.5, torque: 0.5, sensors: [0.75, 0.125, 0.25] };

struct Pair {
    codec: Box<dyn forcefeel_bus::drive::Codec + Send>,
    node: Box<dyn forcefeel_bus::drive::Node + Send>,
}

impl Pair {
    fn new() -> Self {
        let codec = Protocol::Moteus.codec(5, [true; 3]).expect("a kind on CAN");
        Self { codec, node: Protocol::Moteus.node(5, Units::ONE, None, true) }
    }

    fn asked(&mut self, cycle: u64, enable: bool) -> Vec<Frame> {
        let mut frames = vec![];
        self.codec.ask(&Ask { cycle, torque: 0.5, enable, watchdog_s: 0.1 }, &mut |frame| frames.push(*frame));
        frames
    }

    fn answers(&mut self, frames: &[Frame], now_s: f64) -> Vec<Frame> {
        let mut answers = vec![];
        for frame in frames {
            self.node.take(frame, &SHOWN, now_s, &mut |answer| answers.push(*answer));
        }
        answers
    }

    fn exchange(&mut self, cycle: u64, enable: bool, now_s: f64) -> State {
        let frames = self.asked(cycle, enable);
        let answers = self.answers(&frames, now_s);
        answers.iter().find_map(|answer| self.codec.take(answer)).expect("an answer")
    }
}

#[test]
fn a_state_comes_as_it_is_shown() {
    let state = Pair::new().exchange(0, true, 0.0);
    assert_eq!((state.position, state.velocity, state.torque, state.sensors), (0.25, -1.5, 0.5, [0.75, 0.125, 0.25]));
    assert_eq!((state.answers, state.powered, state.fault), (Some(0), true, Fault::NONE));
}

#[test]
fn an_answer_tells_its_cycle_up_to_fifteen_late() {
    let mut pair = Pair::new();
    let first = pair.asked(40, true);
    for cycle in 41..=55 {
        pair.asked(cycle, true);
    }
    let answers = pair.answers(&first, 0.0);
    assert_eq!(pair.codec.take(&answers[0]).and_then(|state| state.answers), Some(40));
}

#[test]
fn another_nodes_answer_is_not_taken() {
    let mut other = Protocol::Moteus.codec(6, [true; 3]).expect("a kind on CAN");
    let mut pair = Pair::new();
    let frames = pair.asked(0, true);
    let answers = pair.answers(&frames, 0.0);
    assert_eq!(other.take(&answers[0]), None);
}

#[test]
fn a_silent_loop_leaves_the_drive_damped_until_it_is_stopped() {
    let mut pair = Pair::new();
    pair.exchange(0, true, 0.0);
    assert_eq!(pair.node.action(0.0999), Action::Torque(0.5));
    assert_eq!(pair.node.action(0.1001), Action::Damp);
    // A command that comes after all does not engage it.
    let state = pair.exchange(1, true, 0.2);
    assert_eq!((state.fault, state.powered), (Fault::WATCHDOG, false));
    assert_eq!(pair.node.action(0.2), Action::Damp);
    assert_eq!(pair.exchange(2, false, 0.3).fault, Fault::NONE);
    assert_eq!(pair.node.action(0.3), Action::Free);
}

#[test]
fn every_code_of_a_fault_has_its_name() {
    for code in 32..=48 {
        let mut pair = Pair::new();
        pair.exchange(0, true, 0.0);
        pair.node.fail(code);
        let state = pair.exchange(1, true, 0.001);
        let (name, remedy) = state.fault.text().expect("a name");
        assert!(name.starts_with("moteus: ") && !remedy.is_empty(), "{code}: {name}");
        assert_eq!(pair.node.action(0.001), Action::Free);
    }
    let mut pair = Pair::new();
    pair.node.fail(99);
    assert_eq!(pair.exchange(1, true, 0.0).fault, Fault::UNKNOWN);
}

#[test]
fn a_node_says_what_it_is() {
    let mut pair = Pair::new();
    let mut frames = vec![];
    pair.codec.who(5, &mut |frame| frames.push(*frame));
    let answers = pair.answers(&frames, 0.0);
    let identity = pair.codec.identity(&answers[0]).expect("an identity");
    assert_eq!((identity.node, identity.registers), (5, 5));
    assert!(pair.codec.accepts(&identity).is_ok());
    let older = forcefeel_bus::drive::Identity { registers: 4, ..identity };
    assert!(pair.codec.accepts(&older).is_err_and(|why| why.contains("register map 5, got ")));
}
