//! The host's packets, what holds between them, and what they do to the feel.

#![expect(clippy::float_cmp, reason = "what is not touched, or has arrived, is the number itself")]

use forcefeel_model::host::effects::Held;
use forcefeel_model::host::packet::{
    FROM_HOST, FROM_HOST_BYTES, HOST_NUMBERS, Refused, TO_HOST_BYTES, crc32, is_newer, switches,
};
use forcefeel_model::host::{FromHost, HostEffects, Stream, ToHost};

const PERIOD: f64 = 1e-3;

/// A packet that `tests/live_host` makes in Python too, and `host.c` in C.
const GOLDEN: &str = include_str!("host/packet.hex");

fn packet(sequence: u32, trim: f32) -> FromHost {
    let mut packet = FromHost { sequence, ..FromHost::none() };
    packet.numbers[2] = trim;
    packet
}

fn golden() -> FromHost {
    let numbers = [
        6000.0, 1.5, 0.05, -0.1, 120.0, 15.0, 0.5, -300.0, 0.02, 400.0, 250.0, 12.0, 62.0, 0.07, -0.02, 0.1, 0.05,
        -0.03, 1.4, 0.18, 0.06, 0.35,
    ];
    FromHost { sequence: 7, switches: switches::ACTIVE | switches::AUTOPILOT, numbers }
}

fn hex(digits: &str) -> u8 {
    u8::from_str_radix(digits, 16).expect("two hexadecimal digits")
}

#[test]
fn packets_come_back_as_they_went_and_have_the_published_bytes() {
    assert_eq!(crc32(b"123456789"), 0xCBF4_3926, "the check value of CRC-32");
    let bytes = golden().encode();
    assert_eq!(FromHost::decode(&bytes), Ok(golden()));
    let golden: Vec<u8> = (0..2 * bytes.len()).step_by(2).map(|k| hex(&GOLDEN[k..k + 2])).collect();
    assert_eq!((bytes.as_slice(), GOLDEN.trim().len()), (golden.as_slice(), 2 * bytes.len()));
    let back = ToHost { sequence: 3, status: 3, numbers: [0.1, -0.2, 30.0, 0.0, 1.0, 1.0] };
    assert_eq!(ToHost::decode(&back.encode()), Ok(back));
    assert_eq!((FROM_HOST_BYTES, TO_HOST_BYTES), (104, 40));
}

#[test]
fn what_is_no_packet_is_refused() {
    let bytes = golden().encode();
    assert_eq!(FromHost::decode(&bytes[1..]), Err(Refused::Length));
    for k in 0..bytes.len() {
        let mut broken = bytes;
        broken[k] ^= 1;
        assert!(FromHost::decode(&broken).is_err(), "byte {k}");
    }
    let of = |packet: FromHost| FromHost::decode(&packet.encode());
    assert_eq!(of(packet(1, f32::NAN)), Err(Refused::Number(2)));
    assert_eq!(of(packet(1, 5.0)), Err(Refused::Number(2)));
    assert_eq!(of(FromHost { switches: 1 << 20, ..FromHost::none() }), Err(Refused::Switches));
    assert_eq!(ToHost::decode(&golden().encode()), Err(Refused::Length));
}

#[test]
fn sequence_numbers_wrap_and_old_packets_are_left_out() {
    assert!(is_newer(0, u32::MAX) && !is_newer(5, 5) && !is_newer(4, 5));
    let mut stream = Stream::new(PERIOD);
    stream.take(&packet(10, 0.1));
    (0..100).for_each(|_| stream.step());
    stream.take(&packet(11, 0.2));
    stream.step();
    stream.take(&packet(10, 0.9));
    assert_eq!(stream.stale, 1);
    (0..200).for_each(|_| stream.step());
    assert_eq!(stream.values(1.0)[2], f64::from(0.2_f32));
    // A host that was started anew.
    stream.take(&packet(1, 0.3));
    assert_eq!(stream.stale, 1);
}

#[test]
fn no_value_has_a_step_at_30_or_200_hz_and_each_is_reached() {
    for (apart, late) in [(33, 0), (5, 0), (33, 60)] {
        let mut stream = Stream::new(PERIOD);
        let (mut last, mut most) = (0.0, 0.0_f64);
        for k in 0..40 {
            let trim = 0.1 * if k % 2 == 0 { 1.0 } else { -1.0 };
            stream.take(&packet(k + 1, trim));
            for _ in 0..apart + if k == 20 { late } else { 0 } {
                stream.step();
                let now = stream.values(1.0)[2];
                most = most.max((now - last).abs());
                last = now;
            }
            // The first takes its time, so does what is sent while it is under way.
            if k > 21 {
                assert!((last - f64::from(trim)).abs() < 1e-9, "{apart}: packet {k}");
            }
        }
        assert!(most <= 0.2 / f64::from(apart) * 1.001, "{apart}: a step of {most}");
        assert_eq!(stream.values(0.0)[1], 1.0, "without a host the spring is whole");
        assert_eq!((stream.switches(0.0), stream.age()), (0, Some(apart)));
    }
}

const ARM: f64 = 0.8;
const SPRING: f64 = 1000.0;

/// A control under a straight spring about neutral.
fn held(angle: f64) -> Held<impl Fn(f64, f64) -> f64> {
    Held { angle, spring: SPRING, force: |angle, factor| factor * SPRING * angle / ARM }
}

/// The first numbers of a host, the others as without one.
fn whole(first: [f64; 10]) -> [f64; HOST_NUMBERS] {
    let none = FROM_HOST.map(|(.., none)| f64::from(none));
    core::array::from_fn(|k| first.get(k).copied().unwrap_or(none[k]))
}

fn settled(on: u32, numbers: [f64; 10], angle: f64) -> forcefeel_model::host::effects::FeelCommand {
    let mut effects = HostEffects::new(PERIOD, ARM);
    let mut last = effects.step(&held(0.0), &whole(numbers), 0, 1.0);
    for _ in 0..400 {
        let now = effects.step(&held(angle), &whole(numbers), on, 1.0);
        assert!((now.torque - last.torque).abs() < 0.02 * ARM * 4000.0, "a step");
        last = now;
    }
    last
}

#[test]
fn an_autopilot_gives_way_at_its_force_and_a_jam_at_its_own() {
    let mut numbers = [0.0, 1.0, 0.0, 0.2, 100.0, 0.0, 0.0, 0.0, 0.0, 250.0];
    // Far from its place it pulls with the force that overrides it.
    assert!((settled(switches::AUTOPILOT, numbers, -0.5).torque - ARM * 100.0).abs() < 1e-9);
    assert_eq!(settled(0, numbers, -0.5).torque, 0.0);
    // Jammed at zero, where the column was.
    assert!((settled(switches::JAM, numbers, 0.3).torque + ARM * 250.0).abs() < 1e-9);
    numbers[5] = 12.0;
    assert!((settled(0, numbers, 0.3).torque - ARM * 12.0).abs() < 1e-9);
    numbers[7] = -200.0;
    assert!((settled(switches::PUSHER, numbers, 0.3).torque + ARM * 188.0).abs() < 1e-9);
}

/// Where a control comes to rest under its spring of these factors and a hand's force: `f G theta = T(theta) + R_p F`, by bisection.
fn rests(on: u32, numbers: [f64; 10], hand: f64) -> f64 {
    let (mut low, mut high) = (-1.0, 1.0);
    for _ in 0..60 {
        let angle = 0.5 * (low + high);
        let told = settled(on, numbers, angle);
        let left = told.torque + ARM * hand - told.stiffness_factor * SPRING * angle;
        if left > 0.0 { low = angle } else { high = angle }
    }
    low
}

#[test]
fn an_autopilot_comes_to_its_place_whatever_loads_the_control_within_its_force() {
    let on = switches::AUTOPILOT;
    for (factor, added) in [(1.0, 0.0), (2.5, 0.0), (0.0, 0.0), (1.0, 60.0), (1.5, -80.0)] {
        let numbers = [0.0, factor, 0.0, 0.2, 900.0, added, 0.0, 0.0, 0.0, 0.0];
        assert!((rests(on, numbers, 0.0) - 0.2).abs() < 1e-9, "factor {factor}, {added} N");
        // A hand meets four springs and the feel's own: (4 + f) G (theta - theta_a) = R_p F.
        let off = ARM * 50.0 / ((4.0 + factor) * SPRING);
        assert!((rests(on, numbers, 50.0) - 0.2 - off).abs() < 1e-9, "factor {factor}, {added} N");
    }
    // Trimmed to its place it has the whole force for a hand; then it slips, and what it does not carry the feel's spring does.
    let numbers = [0.0, 1.0, 0.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let slips = 100.0 * ARM / (4.0 * SPRING);
    assert!(rests(on, numbers, 124.0) < slips && rests(on, numbers, 126.0) > slips);
    assert!((rests(on, numbers, 300.0) - ARM * 200.0 / SPRING).abs() < 1e-9);
    // What it has not the force for it does not reach: G theta = R_p F_a.
    let numbers = [0.0, 1.0, 0.0, 0.2, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert!((rests(on, numbers, 0.0) - ARM * 100.0 / SPRING).abs() < 1e-9);
}

#[test]
fn a_jam_holds_where_it_came_whatever_the_autopilot_does() {
    let numbers = [0.0, 1.0, 0.0, -0.3, 150.0, 40.0, 0.0, 0.0, 0.0, 400.0];
    let jammed_at = 0.1;
    let torque = |on, angle| {
        let mut effects = HostEffects::new(PERIOD, ARM);
        effects.step(&held(jammed_at), &whole(numbers), switches::AUTOPILOT, 1.0);
        (0..400).map(|_| effects.step(&held(angle), &whole(numbers), on, 1.0).torque).last().expect("samples")
    };
    // At rest where it jammed: the spring is carried, and so is the autopilot that pulls the other way.
    for on in [switches::JAM, switches::JAM | switches::AUTOPILOT] {
        assert!((torque(on, jammed_at) - SPRING * jammed_at).abs() < 1e-9);
        let off = 0.01;
        assert!((torque(on, jammed_at + off) - (SPRING * jammed_at - 4.0 * SPRING * off)).abs() < 1e-9);
    }
    // Broken out it holds back with its force, beside the host's 40 N.
    assert!((torque(switches::JAM, 0.5) - ARM * (40.0 - 400.0)).abs() < 1e-9);
}

#[test]
fn a_lost_spring_and_a_trim_that_runs_away() {
    let numbers = [0.0, 1.5, 0.1, 0.0, 0.0, 0.0, 1.0, 0.0, 0.05, 0.0];
    assert_eq!(settled(switches::DISCONNECT, numbers, 0.0).stiffness_factor, 0.0);
    assert_eq!(settled(switches::POWER_LOST, numbers, 0.0).stiffness_factor, 0.0);
    let run = settled(switches::TRIM_RUNAWAY, numbers, 0.0);
    assert!((run.neutral - (0.1 + 0.05 * 0.4)).abs() < 1e-9);
    assert_eq!((run.stiffness_factor, run.shaker), (1.5, 1.0));
    let mut effects = HostEffects::new(PERIOD, ARM);
    let half = effects.step(&held(0.0), &whole(numbers), 0, 0.5);
    assert_eq!(half.shaker, 0.5);
}
