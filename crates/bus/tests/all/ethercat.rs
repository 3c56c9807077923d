//! EtherCAT: a master and an emulated drive on one wire, in memory.

use crate::damaged::{Damaging, FRAMES, Numbers, damaged};
use crate::wire::{self, PERIOD_S, WATCHDOG_S};
use forcefeel_bus::drive::{Action, Ask, Node, Shown, State};
use forcefeel_bus::ethercat::Units;
use forcefeel_bus::ethercat::axis::Axis;
use forcefeel_bus::ethercat::datagram::{Packet, at, command, datagrams};
use forcefeel_bus::ethercat::mailbox::Object;
use forcefeel_bus::ethercat::registers::{AL_STATUS, INIT, OP, SAFE_OP};
use forcefeel_bus::ethercat::servo_slave::ServoSlave;
use forcefeel_bus::ethercat::start::start_drive;
use forcefeel_bus::ethercat::station::{Segment, Station, scan};
use forcefeel_bus::ethercat::terminal::{DriveWithInputs, input};
use forcefeel_bus::fault::Fault;

const UNITS: Units = Units {
    rated_torque: 2.0,
    counts: 65536.0,
    column_counts: 1_048_576.0,
    sensors: [Some(Object::new(0x2100, 1)), Some(Object::new(0x60e4, 1)), Some(Object::new(0x2100, 2))],
    input_node: None,
};
const SHOWN: Shown = Shown { position: 0.25, velocity: -1.5, torque: 0.5, sensors: [0.75, 0.125, 0.25] };
type Wire = wire::Wire<ServoSlave>;

/// A wire with drives, and the master's axes of them.
pub struct Line {
    wire: Wire,
    axes: Vec<Axis>,
    cycle: u64,
}

impl Line {
    fn new(count: u8) -> Self {
        let slaves = (1..=count).map(|place| ServoSlave::new(UNITS, place, place == count)).collect();
        let mut wire = Wire::new(slaves, SHOWN);
        assert_eq!(scan(&mut wire), Ok(vec![0; usize::from(count)]));
        let mut reference = None;
        let axes = (1..=count).map(|place| {
            let axis = start_drive(
                &mut wire,
                [place.into(); 2],
                &UNITS,
                WATCHDOG_S,
                Some(PERIOD_S),
                u32::from(place) << 16,
                reference,
            );
            let axis = axis.expect("a drive that starts");
            reference = axis.clock();
            axis
        });
        let axes = axes.collect();
        Self { wire, axes, cycle: 0 }
    }

    fn cycle(&mut self, place: usize, torque: f64, enable: bool) -> Result<State, Fault> {
        self.wire.now_s += PERIOD_S;
        let ask = Ask { cycle: self.cycle, torque, enable, watchdog_s: WATCHDOG_S };
        self.cycle += 1;
        let mut packet = self.axes[place].ask(&ask);
        self.wire.pass(&mut packet);
        self.axes[place].take(&mut packet.bytes).expect("its own frame")
    }

    fn cycles(&mut self, count: usize, torque: f64, enable: bool) -> State {
        let states = (0..count).map(|_| self.cycle(0, torque, enable).expect("a whole frame"));
        states.last().expect("a cycle")
    }

    fn action(&mut self, place: usize) -> Action {
        let now_s = self.wire.now_s;
        self.wire.slaves[place].action(now_s)
    }

    fn al_state(&mut self, place: u16) -> [u8; 6] {
        let mut packet = Packet::of(command::FPRD, 0, at(0x1001 + place, AL_STATUS), &[0; 6]);
        self.wire.pass(&mut packet);
        let data = datagrams(&mut packet.bytes).next().map(|it| it.data.to_vec());
        data.expect("a datagram").try_into().expect("its bytes")
    }

    /// A line whose first drive is powered.
    fn powered() -> Self {
        let mut line = Self::new(1);
        line.cycles(3, 0.0, false);
        assert!(line.axes[0].ready());
        line.cycles(5, 0.5, true);
        assert_eq!(line.action(0), Action::Torque(0.5));
        line
    }
}

#[test]
fn a_state_comes_as_it_is_shown_in_units_of_the_drive() {
    let state = Line::powered().cycles(1, 0.5, true);
    assert_eq!((state.position, state.velocity, state.torque), (0.25, -1.5, 0.5));
    assert_eq!((state.powered, state.fault), (true, Fault::NONE));
    // 16 bits of a range, and counts of a turn.
    assert!((state.sensors[0] - 0.75).abs() < 1.0 / 65534.0 && (state.sensors[2] - 0.25).abs() < 1.0 / 65534.0);
    assert!((state.sensors[1] - 0.125).abs() < f64::EPSILON);
}

#[test]
fn a_drive_is_enabled_by_the_profiles_words_and_gives_the_torque_of_the_cycle() {
    let mut line = Line::new(1);
    assert_eq!(line.al_state(0)[0], SAFE_OP);
    let mut words = vec![];
    for enable in [false, false, true, true, true, true] {
        let mut packet = line.axes[0].ask(&Ask { cycle: line.cycle, torque: -0.25, enable, watchdog_s: WATCHDOG_S });
        line.cycle += 1;
        let control = datagrams(&mut packet.bytes).next().map(|it| it.data[0]);
        line.wire.pass(&mut packet);
        let status = datagrams(&mut packet.bytes).nth(1).map(|it| it.data[0]);
        line.axes[0].take(&mut packet.bytes);
        words.push((control.expect("outputs"), status.expect("inputs")));
    }
    // Each answer shows the state after the command of its own frame; the first one asked for OP alone.
    assert_eq!(words, [(0, 0x50), (6, 0x31), (7, 0x33), (15, 0x37), (15, 0x37), (15, 0x37)]);
    assert_eq!(line.al_state(0)[0], OP);
    assert_eq!(line.action(0), Action::Torque(-0.25));
}

#[test]
fn a_silent_loop_leaves_the_drive_braked_until_it_is_stopped() {
    let mut line = Line::powered();
    line.wire.now_s += 0.0999;
    assert_eq!(line.action(0), Action::Torque(0.5));
    line.wire.now_s += 0.0003;
    assert_eq!(line.action(0), Action::Damp);
    assert_eq!(line.al_state(0), [SAFE_OP | 0x10, 0, 0, 0, 0x1b, 0]);
    // Commands that come after all do not engage it.
    for _ in 0..2000 {
        let state = line.cycle(0, 0.5, true).expect("a whole frame");
        assert_eq!((state.fault, state.powered), (Fault::WATCHDOG, false));
        assert_eq!(line.action(0), Action::Damp);
    }
    assert_eq!(line.cycles(8, 0.0, false).fault, Fault::NONE);
    assert_eq!(line.action(0), Action::Free);
    line.cycles(4, 0.5, true);
    assert_eq!(line.action(0), Action::Torque(0.5));
}

#[test]
fn a_fault_of_the_drive_is_named_by_its_code_or_class_and_cleared_by_a_stop() {
    for (code, name) in [
        (0x3220, "CiA 402: DC link under voltage"),
        (0x7121, "CiA 402: motor fault"),
        (0x2311, "CiA 402: over current at the output"),
        (0xff07, "CiA 402: fault of the maker's own"),
    ] {
        let mut line = Line::powered();
        line.wire.slaves[0].fail(code);
        let fault = line.cycles(20, 0.5, true).fault;
        assert_eq!(fault.0, code);
        assert!(fault.text().is_some_and(|(text, remedy)| text == name && !remedy.is_empty()), "{code:x} {fault}");
        assert_eq!(line.action(0), Action::Free);
        line.cycles(5, 0.0, false);
        line.cycles(4, 0.5, true);
        assert_eq!(line.action(0), Action::Torque(0.5));
    }
}

#[test]
fn a_slave_that_is_gone_or_restarted_does_not_count_and_leaves_the_other_axis() {
    let mut line = Line::new(3);
    for place in 0..3 {
        (0..3).for_each(|_| assert!(line.cycle(place, 0.0, false).is_ok()));
        (0..5).for_each(|_| assert!(line.cycle(place, 0.5, true).is_ok()));
    }
    line.wire.slaves[1] = ServoSlave::new(UNITS, 2, false);
    assert_eq!(line.cycle(1, 0.5, true), Err(Fault::COUNTER));
    assert_eq!(line.action(1), Action::Free);
    assert!(line.cycle(2, 0.5, true).is_ok_and(|state| state.powered && state.fault == Fault::NONE));
    assert_eq!(line.action(2), Action::Torque(0.5));
}

#[test]
fn an_answer_tells_its_cycle_up_to_255_late_and_a_damaged_one_is_none() {
    let mut line = Line::powered();
    let ask = |cycle| Ask { cycle, torque: 0.0, enable: true, watchdog_s: WATCHDOG_S };
    let mut first = line.axes[0].ask(&ask(1000));
    line.wire.pass(&mut first);
    line.axes[0].ask(&ask(1255));
    let state = line.axes[0].take(&mut first.bytes.clone()).expect("its own frame").expect("a whole frame");
    assert_eq!(state.answers, Some(1000));
    for change in [12, 16, 18, 22] {
        let mut damaged = first.bytes;
        damaged[change] ^= 1;
        assert_eq!(line.axes[0].take(&mut damaged), None, "{change}");
    }
}

#[test]
fn a_slave_states_who_it_is_and_its_alias() {
    let mut wire = Wire::new(vec![ServoSlave::new(UNITS, 1, false), ServoSlave::new(UNITS, 200, true)], SHOWN);
    assert_eq!(scan(&mut wire), Ok(vec![0, 200]));
    // The other way round each has an address that the other had.
    wire.slaves.reverse();
    assert_eq!(scan(&mut wire), Ok(vec![200, 0]));
    wire.slaves.reverse();
    assert_eq!(scan(&mut wire), Ok(vec![0, 200]));
    let identity = Station::new(&mut wire, 2).identity(2).expect("an answer");
    assert_eq!((identity.node, identity.model, identity.serial), (2, 402, [0, 0, 1200]));
}

#[test]
fn clocks_of_a_line_run_by_the_first() {
    let mut line = Line::new(2);
    let times = [0x1001, 0x1002].map(|station| {
        let mut packet = Packet::of(command::FPRD, 0, at(station, 0x0910), &[0; 8]);
        line.wire.pass(&mut packet);
        let data = datagrams(&mut packet.bytes).next().map(|it| it.data.to_vec());
        u64::from_le_bytes(data.expect("a datagram").try_into().expect("eight bytes"))
    });
    assert_eq!(times[0], times[1]);
    assert!(line.axes.iter().all(|axis| axis.clock() == Some(0x1001)));
}

#[test]
fn a_drive_of_an_earlier_loop_takes_no_part_in_the_frames_of_the_next() {
    let mut line = Line::new(2);
    scan(&mut line.wire).expect("two slaves");
    // Where those of the first drive were.
    let started = start_drive(&mut line.wire, [2; 2], &UNITS, WATCHDOG_S, Some(PERIOD_S), 1 << 16, None);
    line.axes[1] = started.expect("a drive that starts");
    assert!(line.cycle(1, 0.0, false).is_ok());
}

/// What a start complains of where the slave's side is another.
fn refusal(units: &Units) -> String {
    let mut wire = Wire::new(vec![ServoSlave::new(UNITS, 1, true)], SHOWN);
    scan(&mut wire).expect("a slave");
    let refused = start_drive(&mut wire, [1; 2], units, WATCHDOG_S, None, 0, None);
    assert_eq!(wire.slaves[0].action(wire.now_s), Action::Free);
    refused.expect_err("a refusal")
}

#[test]
fn a_drive_that_does_not_fit_is_refused_by_name() {
    assert!(refusal(&Units { rated_torque: 3.0, ..UNITS }).contains("the drive's own, 0x6076, 2 N m, got 3 N m"));
    let other = [Some(Object::new(0x2200, 1)), None, None];
    assert!(refusal(&Units { sensors: other, ..UNITS }).contains("0x2200:1: expected a sensor's object"));
}

#[test]
fn a_drive_without_torque_mode_is_refused_by_the_object_that_says_so() {
    /// A drive whose 0x6502 lacks the mode.
    struct Lacking(Wire);
    impl Segment for Lacking {
        fn exchange(&mut self, packet: &mut Packet) -> bool {
            let came = self.0.exchange(packet);
            let value = [0x43, 0x02, 0x65, 0x00, 0x00, 0x02];
            if let Some(place) = packet.bytes.windows(value.len()).position(|bytes| bytes == value) {
                packet.bytes[place + 5] = 0x01;
            }
            came
        }
        fn rest(&mut self) {}
    }
    let mut wire = Lacking(Wire::new(vec![ServoSlave::new(UNITS, 1, true)], SHOWN));
    scan(&mut wire).expect("a slave");
    let refused = start_drive(&mut wire, [1; 2], &UNITS, WATCHDOG_S, None, 0, None);
    assert!(refused.is_err_and(|why| why.contains("bit 9 of 0x6502, got 0x00000100")));
}

#[test]
fn a_slave_refuses_a_state_out_of_turn_by_its_code() {
    let mut wire = Wire::new(vec![ServoSlave::new(UNITS, 1, true)], SHOWN);
    scan(&mut wire).expect("a slave");
    for (asked, status, code) in
        [(OP, INIT | 0x10, 0x11), (0x13, INIT | 0x10, 0x12), (0x12, INIT | 0x10, 0x16), (0x11, INIT, 0)]
    {
        let mut packet = Packet::of(command::BWR, 0, at(0, 0x0120), &[asked, 0]);
        wire.pass(&mut packet);
        let mut packet = Packet::of(command::BRD, 0, at(0, AL_STATUS), &[0; 6]);
        wire.pass(&mut packet);
        let data = datagrams(&mut packet.bytes).next().map(|it| [it.data[0], it.data[4]]);
        assert_eq!(data, Some([status, code]), "{asked:x}");
    }
}

#[test]
fn a_slave_starts_as_ever_after_a_million_damaged_frames() {
    // Frames of a start and of a cycle with the drive stopped.
    struct Tap(Wire, Vec<Vec<u8>>);
    impl Segment for Tap {
        fn exchange(&mut self, packet: &mut Packet) -> bool {
            self.1.push(packet.sent().to_vec());
            self.0.exchange(packet)
        }
        fn rest(&mut self) {}
    }
    let mut tap = Tap(Wire::new(vec![ServoSlave::new(UNITS, 1, true)], SHOWN), vec![]);
    scan(&mut tap).expect("a slave");
    let mut axis = start_drive(&mut tap, [1; 2], &UNITS, WATCHDOG_S, Some(PERIOD_S), 0, None).expect("a start");
    for cycle in 0..8 {
        let mut packet = axis.ask(&Ask { cycle, torque: 0.0, enable: false, watchdog_s: WATCHDOG_S });
        tap.exchange(&mut packet);
        axis.take(&mut packet.bytes);
    }
    let Tap(mut wire, sent) = tap;
    let (mut numbers, mut answered) = (Numbers(4), 0);
    for _ in 0..FRAMES {
        let place = numbers.next(sent.len());
        let mut bytes = damaged(&mut numbers, &sent[place]);
        wire.slaves[0].pass(&mut bytes, &SHOWN, wire.now_s);
        answered += u32::from(datagrams(&mut bytes).any(|it| it.counter() > 0));
    }
    assert!(answered > FRAMES / 10, "{answered}");
    scan(&mut wire).expect("a slave");
    let started = start_drive(&mut wire, [1; 2], &UNITS, WATCHDOG_S, None, 0, None);
    assert_eq!(started.map(|_| ()), Ok(()));
}

#[test]
fn a_million_damaged_answers_do_not_panic_the_master() {
    let mut line = Line::powered();
    let mut packet = line.axes[0].ask(&Ask { cycle: line.cycle, torque: 0.5, enable: true, watchdog_s: WATCHDOG_S });
    line.wire.pass(&mut packet);
    let (mut numbers, mut counts) = (Numbers(5), [0_u32; 3]);
    for _ in 0..FRAMES {
        let mut bytes = damaged(&mut numbers, packet.sent());
        let place = match line.axes[0].take(&mut bytes) {
            None => 0,
            Some(Err(_)) => 1,
            Some(Ok(_)) => 2,
        };
        counts[place] += 1;
    }
    // Of each kind some, or nothing would be tried of what lies behind the first look.
    assert!(counts.iter().all(|count| *count > FRAMES / 100), "{counts:?}");
}

#[test]
fn a_million_damaged_answers_do_not_panic_a_start() {
    let mut wire = Damaging(Wire::new(vec![], SHOWN), Numbers(6), 0);
    let mut outcomes = [0_u32; 2];
    while wire.2 < FRAMES {
        wire.0.slaves = vec![ServoSlave::new(UNITS, 1, true)];
        let started = scan(&mut wire)
            .and_then(|_| start_drive(&mut wire, [1; 2], &UNITS, WATCHDOG_S, Some(PERIOD_S), 0, None).map(|_| ()));
        outcomes[usize::from(started.is_ok())] += 1;
        assert_eq!(wire.0.slaves[0].action(wire.0.now_s), Action::Free);
    }
    assert!(outcomes[0] > 10, "{outcomes:?}");
}

type Beside = wire::Wire<DriveWithInputs>;

/// Force sensors at the second and fourth input of a terminal behind the drive.
const AT_TERMINAL: Units =
    Units { sensors: [Some(input(1)), UNITS.sensors[1], Some(input(3))], input_node: Some(2), ..UNITS };

fn started_beside(wire: &mut dyn Segment, units: &Units, places: [u16; 2]) -> Result<Axis, String> {
    assert_eq!(scan(wire), Ok(vec![0, 0]));
    start_drive(wire, places, units, WATCHDOG_S, Some(PERIOD_S), 1 << 16, None)
}

#[test]
fn force_sensors_at_a_terminal_are_read_beside_the_drive() {
    let mut wire = Beside::new(vec![DriveWithInputs::new(AT_TERMINAL, 1, 2, true)], SHOWN);
    let mut axis = started_beside(&mut wire, &AT_TERMINAL, [1, 2]).expect("slaves that start");
    let mut cycle = |wire: &mut Beside, cycle, gone| {
        wire.now_s += PERIOD_S;
        let mut packet = axis.ask(&Ask { cycle, torque: 1.0, enable: cycle > 9, watchdog_s: WATCHDOG_S });
        wire.pass(&mut packet);
        if gone {
            // The counter of the inputs: behind Ethernet's head, the outputs' datagram and the inputs.
            let inputs = datagrams(&mut packet.bytes).nth(1).expect("inputs");
            assert_eq!(inputs.counter(), 2);
            let counter = 16 + (10 + 5 + 2) + 10 + inputs.data.len();
            packet.bytes[counter] = 1;
        }
        axis.take(&mut packet.bytes).expect("its own frame")
    };
    for at in 0..20 {
        cycle(&mut wire, at, false).expect("a whole frame");
    }
    let state = cycle(&mut wire, 20, false).expect("a whole frame");
    assert!((state.position - 0.25).abs() < 1e-4 && (state.torque - 0.5).abs() < 1e-3 && state.acts);
    let off = [0.75, 0.125, 0.25].iter().zip(state.sensors).map(|(stated, read)| (stated - read).abs());
    assert!(off.fold(0.0, f64::max) < 2e-5, "{:?}", state.sensors);
    assert_eq!(wire.slaves[0].action(wire.now_s), Action::Torque(1.0));
    assert_eq!(cycle(&mut wire, 21, true), Err(Fault::COUNTER));
}

#[test]
fn a_terminal_without_the_sensor_or_in_the_drives_place_is_refused() {
    let mut wire = Beside::new(vec![DriveWithInputs::new(AT_TERMINAL, 1, 2, true)], SHOWN);
    let other = Units { sensors: [Some(Object::new(0x6100, 17)), None, None], ..AT_TERMINAL };
    let why = started_beside(&mut wire, &other, [1, 2]).expect_err("a refusal");
    assert!(why.contains("input_node 2: 0x6100:17: expected") && why.contains("0x6030:17"), "{why}");
    let why = started_beside(&mut wire, &AT_TERMINAL, [1, 1]).expect_err("a refusal");
    assert!(why.contains("input_node 2: expected another slave than the drive"), "{why}");
}
