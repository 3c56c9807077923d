//! Packets: what was written is read, and nothing else is.

use forcefeel_live::input_output::{Command, Sampled};
use forcefeel_live::udp::{Request, Stamped, ask_bytes, command_bytes, request_of, sample_bytes, sample_of};
use forcefeel_live::wish::{Around, Wish};
use forcefeel_model::control::Sample;

fn stamped() -> Stamped {
    let sample = Sample { sensors: [1.5, -0.25, 1e-300, 7.0], pilot_force: f64::NAN };
    Stamped { sequence: 7, clock_ns: 123_456_789, sampled: Sampled { sample, emergency_stop: true } }
}

#[test]
fn a_sample_comes_back_as_it_was() {
    let found = sample_of(&sample_bytes(&stamped())).expect("a sample");
    assert_eq!((found.sequence, found.clock_ns), (7, 123_456_789));
    assert_eq!(found.sampled.sample.sensors.map(f64::to_bits), stamped().sampled.sample.sensors.map(f64::to_bits));
    assert!(found.sampled.sample.pilot_force.is_nan() && found.sampled.emergency_stop);
}

#[test]
fn a_command_comes_back_as_it_was() {
    let command = Command { cycle: 9, command: -3.25, enable: true, state: 3 };
    assert_eq!(request_of(&command_bytes(&command, 8)), Some(Request::Command(command)));
    assert_eq!(request_of(&ask_bytes()), Some(Request::Ask));
}

#[test]
fn every_damaged_byte_is_seen() {
    let (sample, command) = (sample_bytes(&stamped()), ask_bytes());
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

#[test]
fn a_wish_comes_back_as_it_was() {
    let around = Wish::Around(Around { trim_rad: 0.1, stiffness_factor: 1.0, shaker: 0.5 });
    for name in ["on", "passive", "off", "acknowledge", "stop", "around"] {
        let wish = Wish::of(name, &[]).unwrap_or(around);
        let (name, numbers) = wish.numbers();
        assert_eq!(Wish::of(name, &numbers), Some(wish));
    }
    assert_eq!(Wish::of("feel", &[1.0]), None);
}
