//! Packets: what was written is read, and nothing else is.

use forcefeel_live::input_output::{Command, InputOutput};
use forcefeel_live::request::{FeelModifiers, LoopRequest};
use forcefeel_live::udp::{
    NO_CYCLE, Request, Stamped, Udp, ask_bytes, command_bytes, request_of, sample_bytes, sample_of,
};
use forcefeel_model::control::Sample;
use std::net::{SocketAddr, UdpSocket};

fn stamped() -> Stamped {
    let sample = Sample { sensors: [1.5, -0.25, 1e-300, 7.0], pilot_force: f64::NAN };
    Stamped {
        sequence: 7,
        session: 77,
        answers: 6,
        clock_ns: 123_456_789,
        sample,
        emergency_stop: true,
        drive_acts: false,
    }
}

#[test]
fn a_sample_comes_back_as_it_was() {
    let record = sample_of(&sample_bytes(&stamped())).expect("a sample");
    assert_eq!((record.sequence, record.session, record.answers, record.clock_ns), (7, 77, 6, 123_456_789));
    assert_eq!(record.sample.sensors.map(f64::to_bits), stamped().sample.sensors.map(f64::to_bits));
    assert!(record.sample.pilot_force.is_nan());
    for (emergency_stop, drive_acts) in [(false, false), (false, true), (true, false), (true, true)] {
        let bytes = sample_bytes(&Stamped { emergency_stop, drive_acts, ..stamped() });
        let record = sample_of(&bytes).expect("a sample");
        assert_eq!((record.emergency_stop, record.drive_acts), (emergency_stop, drive_acts));
    }
}

#[test]
fn a_command_comes_back_as_it_was() {
    let command = Command { cycle: 9, command: -3.25, enable: true, state: 3 };
    assert_eq!(request_of(&command_bytes(&command, 77, 8)), Some((77, Request::Command(command))));
    assert_eq!(request_of(&ask_bytes(78)), Some((78, Request::Ask)));
}

#[test]
fn every_damaged_byte_is_seen() {
    let (sample, command) = (sample_bytes(&stamped()), ask_bytes(77));
    for k in 0..sample.len() {
        let mut damaged = sample;
        damaged[k] ^= 0x10;
        assert!(sample_of(&damaged).is_none(), "byte {k}");
    }
    for k in 0..command.len() {
        let mut damaged = command;
        damaged[k] ^= 0x10;
        assert!(request_of(&damaged).is_none(), "byte {k}");
    }
    assert!(sample_of(&sample[..63]).is_none() && sample_of(&command).is_none() && request_of(&[]).is_none());
}

/// A loop at a machine's socket: its session key, and where it is.
fn asked(machine: &UdpSocket) -> (Udp, u64, SocketAddr) {
    let loop_ = Udp::connect(machine.local_addr().expect("an address"), Some(1e-3)).expect("a socket");
    let mut bytes = [0; 64];
    let (count, at) = machine.recv_from(&mut bytes).expect("a request");
    let (session, request) = request_of(&bytes[..count]).expect("a request");
    assert_eq!(request, Request::Ask);
    (loop_, session, at)
}

#[test]
fn a_forged_packet_is_refused_and_a_late_one_says_how_late_it_is() {
    let machine = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let (mut loop_, session, at) = asked(&machine);
    let mut sequence = 0;
    let mut send = |session, answers| {
        sequence += 1;
        let bytes = sample_bytes(&Stamped { sequence, session, answers, ..stamped() });
        machine.send_to(&bytes, at).expect("sent");
    };
    // Of another session, and in answer to a command that was never written.
    send(session ^ 1, NO_CYCLE);
    send(session, 0);
    silent(&mut loop_, 1);
    send(session, NO_CYCLE);
    assert_eq!(loop_.read().map(|sampled| (sampled.delay, sampled.drive_acts)), Some((0, false)));
    for cycle in 0..8 {
        loop_.write(&Command { cycle, command: 0.0, enable: false, state: 0 });
    }
    send(session, 8);
    silent(&mut loop_, 1);
    for (answers, delay) in [(7, 0), (6, 1), (2, 5)] {
        send(session, answers);
        assert_eq!(loop_.read().map(|sampled| sampled.delay), Some(delay));
    }
}

/// So many cycles of which none has a sample.
fn silent(loop_: &mut Udp, cycles: usize) {
    for _ in 0..cycles {
        assert!(loop_.read().is_none());
    }
}

#[test]
fn what_comes_late_twice_or_out_of_order_is_dropped_and_a_machine_that_begins_anew_is_not() {
    let machine = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let (mut loop_, session, at) = asked(&machine);
    let send = |sequence, clock_ns| {
        let bytes = sample_bytes(&Stamped { sequence, clock_ns, session, answers: NO_CYCLE, ..stamped() });
        machine.send_to(&bytes, at).expect("sent");
    };
    send(10, 1000);
    assert!(loop_.read().is_some());
    for sequence in [10, 9, 1] {
        send(sequence, 2000);
        silent(&mut loop_, 1);
    }
    // Held back while the line was cut, whatever the silence was.
    for cycles in [1, 15, 16, 200] {
        silent(&mut loop_, cycles);
        for sequence in [8, 10, 7, 7] {
            send(sequence, 900 + sequence);
        }
        silent(&mut loop_, 1);
    }
    send(11, 3000);
    assert!(loop_.read().is_some());
    // Started anew: it counts from one, its clock went on.
    silent(&mut loop_, 16);
    send(1, 4000);
    assert!(loop_.read().is_some());
    send(2, 4001);
    assert!(loop_.read().is_some());
    // Its power was off: its clock begins anew too.
    silent(&mut loop_, 4000);
    send(1, 1);
    silent(&mut loop_, 1000);
    send(1, 1);
    assert!(loop_.read().is_some());
}

#[test]
fn a_wish_comes_back_as_it_was() {
    let around = LoopRequest::FeelModifiers(FeelModifiers { trim_rad: 0.1, stiffness_factor: 1.0, shaker: 0.5 });
    for name in ["on", "passive", "off", "acknowledge", "stop", "around"] {
        let request = LoopRequest::of(name, &[]).unwrap_or(around);
        let (name, numbers) = request.numbers();
        assert_eq!(LoopRequest::of(name, &numbers), Some(request));
    }
    assert_eq!(LoopRequest::of("feel", &[1.0]), None);
}
