//! A valve's terminals: a master and emulated ones on one wire, in memory.

use crate::damaged::{Damaging, FRAMES, Numbers, damaged};
use crate::wire::{self, PERIOD_S, WATCHDOG_S};
use forcefeel_bus::drive::{Action, Ask, Node, Shown, State};
use forcefeel_bus::ethercat::analog::Analog;
use forcefeel_bus::ethercat::axis::Axis;
use forcefeel_bus::ethercat::mailbox::Object;
use forcefeel_bus::ethercat::start::start_terminals;
use forcefeel_bus::ethercat::station::scan;
use forcefeel_bus::ethercat::terminal::{TerminalPair, input, output};
use forcefeel_bus::fault::Fault;

/// Command at the third output; the drive's end at the first input, the column at the fourth.
const ANALOG: Analog = Analog {
    input_node: 2,
    output: output(2),
    inputs: [Some(input(1)), Some(input(0)), Some(input(3)), None],
    output_range: 10.0,
    position_range: 0.1,
    column_range: 0.25,
};
const SHOWN: Shown = Shown { position: -0.5, velocity: 0.0, torque: 0.0, sensors: [0.75, 0.125, 0.5] };
/// Half a step of 16 bits, as a share of a range.
const HALF_STEP: f64 = 0.5 / 32767.0;

type Wire = wire::Wire<TerminalPair>;

fn terminals() -> Wire {
    Wire::new(vec![TerminalPair::new(ANALOG, 1, true)], SHOWN)
}

impl Wire {
    fn action(&mut self) -> Action {
        self.slaves[0].action(self.now_s)
    }

    fn started(&mut self, analog: &Analog) -> Result<Axis, String> {
        assert_eq!(scan(self), Ok(vec![0, 0]));
        start_terminals(self, [1, 2], analog, WATCHDOG_S, 0x1_0000)
    }

    fn cycle(&mut self, axis: &mut Axis, cycle: u64, torque: f64, enable: bool) -> Result<State, Fault> {
        self.now_s += PERIOD_S;
        let mut packet = axis.ask(&Ask { cycle, torque, enable, watchdog_s: WATCHDOG_S });
        assert!(self.pass(&mut packet));
        axis.take(&mut packet.bytes).expect("its own frame")
    }

    /// An axis whose command acts, after five cycles.
    fn acting(&mut self) -> Axis {
        let mut axis = self.started(&ANALOG).expect("terminals that start");
        for cycle in 0..5 {
            self.cycle(&mut axis, cycle, -0.75, cycle > 2).expect("a whole frame");
        }
        assert!(axis.ready());
        axis
    }
}

#[test]
fn a_state_is_the_share_of_each_range_and_the_command_that_of_the_output() {
    let mut wire = terminals();
    let mut axis = wire.acting();
    let state = wire.cycle(&mut axis, 5, -0.75, true).expect("a whole frame");
    assert!((state.position + 0.5).abs() <= HALF_STEP && (state.torque + 0.75).abs() <= HALF_STEP);
    let [force, column, grip] = state.sensors;
    assert!((force - 0.75).abs() <= HALF_STEP && (column - 0.125).abs() <= HALF_STEP && grip.is_nan());
    assert_eq!((state.powered, state.acts, state.fault, state.answers), (true, true, Fault::NONE, Some(5)));
    let Action::Torque(share) = wire.action() else { panic!("no command") };
    assert!((share + 0.75).abs() <= HALF_STEP);
}

#[test]
fn a_command_acts_only_while_it_is_enabled_and_both_terminals_are_in_op() {
    let mut wire = terminals();
    let mut axis = wire.started(&ANALOG).expect("terminals that start");
    // In SAFE-OP an output takes nothing.
    assert!(!wire.cycle(&mut axis, 0, 1.0, true).expect("a whole frame").acts);
    assert_eq!(wire.action(), Action::Free);
    for cycle in 1..4 {
        wire.cycle(&mut axis, cycle, 1.0, false).expect("a whole frame");
    }
    assert_eq!(wire.action(), Action::Torque(0.0));
    assert!(wire.cycle(&mut axis, 4, 1.0, true).expect("a whole frame").acts);
    assert_eq!(wire.action(), Action::Torque(1.0));
}

#[test]
fn a_silent_loop_leaves_the_valve_without_a_command_until_it_is_stopped() {
    let mut wire = terminals();
    let mut axis = wire.acting();
    wire.now_s += WATCHDOG_S + 2.0 * PERIOD_S;
    assert_eq!(wire.action(), Action::Free);
    for cycle in 5..2000 {
        let state = wire.cycle(&mut axis, cycle, 1.0, true).expect("a whole frame");
        assert_eq!((state.fault, state.powered, state.acts), (Fault::WATCHDOG, false, false));
        assert_eq!(wire.action(), Action::Free);
    }
    for cycle in 2000..2010 {
        wire.cycle(&mut axis, cycle, 1.0, cycle > 2007).expect("a whole frame");
    }
    assert_eq!(wire.action(), Action::Torque(1.0));
}

#[test]
fn an_object_that_is_not_mapped_is_refused_with_those_that_are() {
    let refused = |analog: Analog| terminals().started(&analog).expect_err("a refusal");
    let why = refused(Analog { output: Object::new(0x7100, 1), ..ANALOG });
    assert!(why.contains("0x7100:1: expected") && why.contains("0x7000:1, 0x7010:1, 0x7020:1, 0x7030:1"), "{why}");
    // A bit of the status is no number.
    let why = refused(Analog { inputs: [Some(Object::new(0x6000, 1)), None, None, None], ..ANALOG });
    assert!(why.contains("0x6000:1: expected") && why.contains("0x6000:17"), "{why}");
}

#[test]
fn a_million_damaged_answers_do_not_panic_the_master_or_a_start() {
    let mut wire = terminals();
    let mut axis = wire.acting();
    let mut packet = axis.ask(&Ask { cycle: 5, torque: 0.5, enable: true, watchdog_s: WATCHDOG_S });
    wire.pass(&mut packet);
    let (mut numbers, mut counts) = (Numbers(7), [0_u32; 3]);
    for _ in 0..FRAMES {
        let place = match axis.take(&mut damaged(&mut numbers, packet.sent())) {
            None => 0,
            Some(Err(_)) => 1,
            Some(Ok(_)) => 2,
        };
        counts[place] += 1;
    }
    assert!(counts.iter().all(|count| *count > FRAMES / 100), "{counts:?}");

    let mut wire = Damaging(terminals(), Numbers(8), 0);
    let mut outcomes = [0_u32; 2];
    while wire.2 < FRAMES / 4 {
        wire.0 = terminals();
        let started = scan(&mut wire).and_then(|_| start_terminals(&mut wire, [1, 2], &ANALOG, WATCHDOG_S, 0x1_0000));
        outcomes[usize::from(started.is_ok())] += 1;
    }
    assert!(outcomes.iter().all(|count| *count > 10), "{outcomes:?}");
}
