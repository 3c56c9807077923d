//! A cycle allocates nothing: with the machine simulated, over UDP, on a bus, while the feel changes, while it trips, under a host.

use crate::loader::setup;
use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use forcefeel_bus::drive::{Ask, Node, Shown};
use forcefeel_bus::ethercat::Units;
use forcefeel_bus::ethercat::datagram::Packet;
use forcefeel_bus::ethercat::servo_slave::ServoSlave;
use forcefeel_bus::ethercat::start::start_drive;
use forcefeel_bus::ethercat::station::{Segment, scan};
use forcefeel_bus::frame::Frame;
use forcefeel_bus::line::Line;
use forcefeel_bus::protocol::Protocol;
use forcefeel_bus::scale::Wiring;
use forcefeel_live::bus::{Fieldbus, NodeSettings, OnBus};
use forcefeel_live::can_bus::CanBus;
use forcefeel_live::carrier::Carrier;
use forcefeel_live::clock::{AtOnce, Clock, Woken};
use forcefeel_live::controller::Controller;
use forcefeel_live::cycle::Cycles;
use forcefeel_live::host_link::HostRings;
use forcefeel_live::input_output::{Disturbance, Fault, InputOutput};
use forcefeel_live::request::{FeelModifiers, FeelRequest, LoopRequest};
use forcefeel_live::setup::Setup;
use forcefeel_live::simulated::{Script, simulated};
use forcefeel_live::status::Status;
use forcefeel_live::udp::Udp;
use forcefeel_model::host::FromHost;
use forcefeel_model::host::packet::switches::{ACTIVE, AUTOPILOT, JAM, PUSHER, TRIM_RUNAWAY};
use forcefeel_model::parameters::TABLE;
use rtrb::RingBuffer;
use std::sync::{Arc, Mutex};
use std::time::Duration;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

fn cycles(
    setup: &Setup,
    machine: Box<dyn InputOutput>,
    requests: &[LoopRequest],
    disturbances: &[Disturbance],
) -> Cycles {
    let (mut asks, wishes_taken) = RingBuffer::new(64);
    let (mut disturbs, disturbances_taken) = RingBuffer::new(64);
    for request in requests {
        asks.push(*request).expect("there is room");
    }
    for one in disturbances {
        disturbs.push(*one).expect("there is room");
    }
    // Nobody takes what is told: the rings run full, which costs no allocation either.
    let (rows, _) = RingBuffer::new(128);
    let (taken, _) = RingBuffer::new(4);
    Cycles {
        controller: Controller::new(setup).expect("it has limits"),
        machine,
        plan: vec![(3, LoopRequest::On)],
        requests: wishes_taken,
        host: None,
        disturbances: disturbances_taken,
        rows,
        taken,
        status: Arc::new(Status::default()),
        planned: 0,
        patient: false,
    }
}

fn run(cycles: &mut Cycles, count: u64, clock: &mut AtOnce) {
    assert_no_alloc(|| {
        for k in 0..count {
            clock.wait();
            cycles.cycle(Woken { late_ns: 1000, missed: u64::from(k == 70) });
        }
    });
}

#[test]
fn a_cycle_allocates_nothing() {
    for supervised in [true, false] {
        let mut setup = Setup { supervised, ..setup() };
        let (machine, beginning) = simulated(&setup, Script::NONE);
        setup.beginning = Some(beginning);
        let mut softer = setup.values;
        let place = TABLE.iter().position(|row| (row.part, row.name) == ("feel", "breakout")).expect("it is there");
        softer[place] = 20.0;
        let feel = FeelRequest { values: softer, observer: None, cycles: 50 };
        let around = FeelModifiers { trim_rad: 0.05, stiffness_factor: 1.5, shaker: 1.0 };
        let requests = [LoopRequest::Feel(feel), LoopRequest::FeelModifiers(around)];
        let disturbances = [Disturbance::Force(30.0), Disturbance::HoldAt(Some(0.05))];
        let mut clock = AtOnce::new(setup.period_s());
        let mut loop_ = cycles(&setup, machine, &requests, &disturbances);
        run(&mut loop_, 2000, &mut clock);
        loop_.machine.disturb(Disturbance::Fault(Fault::NotANumber(1)));
        run(&mut loop_, 100, &mut clock);
        loop_.machine.disturb(Disturbance::Fault(Fault::Silent));
        run(&mut loop_, 100, &mut clock);
    }
}

#[test]
fn a_cycle_over_udp_allocates_nothing() {
    let setup = setup();
    let other = std::net::UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let address = other.local_addr().expect("an address");
    let machine = Udp::connect(address, Some(setup.period_s())).expect("a socket");
    let mut loop_ = cycles(&setup, Box::new(machine), &[LoopRequest::On], &[]);
    run(&mut loop_, 200, &mut AtOnce::new(setup.period_s()));
}

/// A bus whose node answers at once; its drive fails after so many frames.
struct Answering {
    node: Box<dyn Node + Send>,
    answers: [Option<Frame>; 4],
    fails_after: u32,
}

impl Carrier for Answering {
    fn send(&mut self, frame: &Frame) {
        self.fails_after = self.fails_after.saturating_sub(1);
        if self.fails_after == 0 {
            self.node.fail(33);
        }
        let shown = Shown { sensors: [0.5, 0.0, 0.5], ..Shown::default() };
        let answers = &mut self.answers;
        self.node.take(frame, &shown, 0.0, &mut |answer| {
            if let Some(free) = answers.iter_mut().find(|place| place.is_none()) {
                *free = Some(*answer);
            }
        });
    }

    fn next(&mut self) -> Option<Line> {
        self.answers.iter_mut().find_map(Option::take).map(Line::Frame)
    }

    fn wait(&self, most: Duration) {
        std::thread::sleep(most);
    }
}

#[test]
fn a_cycle_on_a_bus_allocates_nothing() {
    let (setup, mut connected) = (setup(), 0);
    for (name, protocol) in Protocol::ALL {
        let node = protocol.node(1, Units::ONE, None, true);
        let carrier = Answering { node, answers: [None; 4], fails_after: 1000 };
        let bus: Box<dyn Fieldbus> = Box::new(CanBus::new(Box::new(carrier)));
        let bus = Arc::new(Mutex::new(bus));
        let wiring = Wiring { gear: 1.0, zero: 0.0, load_cell: Some(400.0), column: Some([1.0, 0.0]), grip: None };
        let settings = NodeSettings { protocol, node: 1, wiring, watchdog_s: 0.1, units: Units::ONE, analog: None };
        let machine = OnBus::connect(&bus, &setup.parameters(), &settings, Some(setup.period_s()));
        // A heartbeat tells the older ODrive, and this bus has no time.
        let Ok(machine) = machine else { continue };
        connected += 1;
        let mut loop_ = cycles(&setup, Box::new(machine), &[LoopRequest::On], &[]);
        run(&mut loop_, 2000, &mut AtOnce::new(setup.period_s()));
        let silent = loop_.status.silent.load(std::sync::atomic::Ordering::Relaxed);
        assert!(silent == 0, "{name}: {silent} cycles without a sample");
    }
    assert_eq!(connected, 2);
}

#[test]
fn a_frame_of_ethercat_allocates_nothing_on_its_way_out_and_back() {
    struct Wire(ServoSlave);
    impl Segment for Wire {
        fn exchange(&mut self, packet: &mut Packet) -> bool {
            self.0.pass(&mut packet.bytes, &Shown::default(), 0.0);
            true
        }
        fn rest(&mut self) {}
    }
    let mut wire = Wire(ServoSlave::new(Units::ONE, 1, true));
    scan(&mut wire).expect("a slave");
    let mut axis = start_drive(&mut wire, [1; 2], &Units::ONE, 0.1, Some(1e-3), 0, None).expect("a start");
    for cycle in 0..100 {
        let ask = Ask { cycle, torque: 0.5, enable: cycle > 10, watchdog_s: 0.1 };
        let mut packet = assert_no_alloc(|| axis.ask(&ask));
        wire.exchange(&mut packet);
        let state = assert_no_alloc(|| axis.take(&mut packet.bytes));
        assert!(state.is_some_and(|state| state.is_ok_and(|state| cycle < 20 || state.powered)));
    }
}

#[test]
fn a_cycle_under_a_host_allocates_nothing() {
    let mut setup = Setup { host: true, ..setup() };
    let (machine, beginning) = simulated(&setup, Script::NONE);
    setup.beginning = Some(beginning);
    let (mut sends, packets) = RingBuffer::new(16);
    let (answers, mut replies) = RingBuffer::new(16);
    let mut loop_ =
        Cycles { host: Some(HostRings { packets, answers }), ..cycles(&setup, machine, &[LoopRequest::On], &[]) };
    let mut clock = AtOnce::new(setup.period_s());
    let mut status = 0;
    // Everything that a host can ask for, one after the other, then its silence and its fade.
    for (sequence, also) in [0, AUTOPILOT, PUSHER, JAM, TRIM_RUNAWAY].into_iter().enumerate() {
        let sequence = u32::try_from(sequence).expect("a few") + 1;
        let packet = FromHost { sequence, switches: ACTIVE | also, ..FromHost::none() };
        sends.push(packet).expect("there is room");
        run(&mut loop_, 200, &mut clock);
        status += std::iter::from_fn(|| replies.pop().ok()).count();
    }
    run(&mut loop_, 3000, &mut clock);
    assert_eq!(status, 5);
}
