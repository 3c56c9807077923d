//! An aircraft simulator in the loop, in virtual time: what its packets do to the column, what their silence does, what goes back.

#![expect(clippy::float_cmp, reason = "what is recorded is the number itself")]

use crate::loader::{PERIOD_S, setup};
use forcefeel_live::controller::Controller;
use forcefeel_live::host_link;
use forcefeel_live::input_output::{Disturbance, InputOutput};
use forcefeel_live::request::LoopRequest;
use forcefeel_live::row::Row;
use forcefeel_live::setup::{Rendered, Setup};
use forcefeel_live::simulated::{Script, simulated};
use forcefeel_live::supervision::STATES;
use forcefeel_model::host::packet::HOST_NUMBERS;
use forcefeel_model::host::packet::switches::{ACTIVE, DISCONNECT, FLIGHT, FREEZE};
use forcefeel_model::host::{FromHost, ToHost};
use forcefeel_model::parameters::TABLE;
use forcefeel_model::supervisor::SupervisorState;
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

/// Cycles between two packets: of a host with 100 a second.
const APART: u64 = 20;

/// The report's loader in its own position loop, under a digital controller at 2 kHz, with a host.
struct Run {
    controller: Controller,
    machine: Box<dyn InputOutput>,
    sequence: u32,
    rows: Vec<Row>,
    answers: Vec<ToHost>,
}

impl Run {
    fn new(factor: Option<(Vec<f64>, Vec<[f64; 4]>)>) -> Self {
        Self::limited(factor, &[])
    }

    /// With these rows of `safety`.
    fn limited(factor: Option<(Vec<f64>, Vec<[f64; 4]>)>, safety: &[(&str, f64)]) -> Self {
        let mut setup = Setup { factor, host: true, ..setup() };
        for (name, limit) in safety {
            let place = TABLE.iter().position(|row| row.part == "safety" && row.name == *name).expect("a row");
            setup.values[place] = *limit;
        }
        Self::made(setup)
    }

    fn made(mut setup: Setup) -> Self {
        let (machine, beginning) = simulated(&setup, Script::NONE);
        setup.beginning = Some(beginning);
        let mut controller = Controller::new(&setup).expect("it has limits");
        controller.take(&LoopRequest::On);
        Self { controller, machine, sequence: 0, rows: vec![], answers: vec![] }
    }

    /// So many cycles, a packet each `APART` where there is one; the last row.
    fn on(&mut self, cycles: u64, packet: Option<(u32, [f32; HOST_NUMBERS])>) -> Row {
        for k in 0..cycles {
            if let Some((switches, numbers)) = packet.filter(|_| k % APART == 0) {
                self.sequence += 1;
                self.controller.take(&LoopRequest::Host(FromHost { sequence: self.sequence, switches, numbers }));
            }
            let sampled = self.machine.read();
            let (command, row) = self.controller.step(sampled.as_ref(), 0);
            self.machine.write(&command);
            self.answers.extend(self.controller.answer(&row));
            self.rows.push(row);
        }
        self.rows[self.rows.len() - 1]
    }

    fn state(&self) -> SupervisorState {
        self.rows.last().map_or(SupervisorState::Off, |row| STATES[place(row)])
    }

    /// Column's angle in rad, the mean over two seconds: the original loop leaves a swing of 2 Hz that dies away slowly.
    fn angle(&self) -> f64 {
        self.rows.iter().rev().take(4000).map(|row| row.column_angle_rad).sum::<f64>() / 4000.0
    }

    /// Largest step of a column.
    fn step(&self, of: impl Fn(&Row) -> f64) -> f64 {
        self.rows.windows(2).map(|two| (of(&two[1]) - of(&two[0])).abs()).fold(0.0, f64::max)
    }
}

fn place(row: &Row) -> usize {
    STATES.iter().enumerate().position(|(k, _)| f64::from(u8::try_from(k).expect("few")) == row.state).expect("a state")
}

/// What holds without a host, but for some numbers.
fn sent(some: &[(usize, f32)]) -> [f32; HOST_NUMBERS] {
    let mut numbers = FromHost::none().numbers;
    for &(k, number) in some {
        numbers[k] = number;
    }
    numbers
}

const TRIM: usize = 2;
const ADDED: usize = 5;
/// A column that stands, of what sensors and law leave.
const STANDS_RAD: f64 = 2e-3;

#[test]
fn an_added_force_moves_the_column_as_a_hand_does() {
    let mut run = Run::new(None);
    let row = run.on(14_000, Some((ACTIVE, sent(&[(TRIM, 0.03), (ADDED, 40.0)]))));
    assert_eq!(run.state(), SupervisorState::Active);
    assert_eq!((row.added_force_n, row.host_share, row.trips), (40.0, 1.0, 0.0));
    // No step: it comes with share and fade, of which the quicker takes 0.5 s.
    assert!(run.step(|row| row.added_force_n) < 40.0 * 2.5 * PERIOD_S / 0.5);
    let by_host = run.angle();
    run.on(14_000, Some((ACTIVE, sent(&[(TRIM, 0.03)]))));
    assert!((run.angle() - f64::from(0.03_f32)).abs() < STANDS_RAD, "{}", run.angle());
    run.machine.disturb(Disturbance::Force(40.0));
    run.on(14_000, Some((ACTIVE, sent(&[(TRIM, 0.03)]))));
    // But for what a hand stretches the link.
    assert!((by_host - run.angle()).abs() < 2.0 * STANDS_RAD, "{by_host} and {}", run.angle());
}

#[test]
fn flaps_move_the_neutral_within_the_limits_of_a_trim() {
    const FLAP: usize = HOST_NUMBERS - 1;
    let of = |name: &str| TABLE.iter().position(|row| row.name == name).expect("a row");
    let mut setup = Setup { flap_trim: -0.1, host: true, ..setup() };
    let packet = Some((ACTIVE, sent(&[(TRIM, 0.03), (FLAP, 0.4)])));
    let mut run = Run::made(setup.clone());
    let neutral = run.on(6000, packet).neutral_rad;
    assert!((neutral - (0.03 - 0.1 * 0.4)).abs() < 1e-8, "{neutral}");
    setup.values[of("host_angle")] = 0.004;
    let mut run = Run::made(setup);
    let neutral = run.on(6000, packet).neutral_rad;
    assert!((neutral + 0.004).abs() < 1e-8, "{neutral}");
}

#[test]
fn silence_holds_for_a_tenth_of_a_second_then_fades_to_the_default_feel_and_comes_back() {
    let mut run = Run::new(None);
    let packet = Some((ACTIVE, sent(&[(ADDED, 40.0), (1, 1.5)])));
    run.on(10_000, packet);
    let begun = run.rows.len();
    run.on(2000, None);
    let shares: Vec<f64> = run.rows[begun..].iter().map(|row| row.host_share).collect();
    let held = shares.iter().position(|share| *share < 1.0).expect("it fades");
    // The last packet came APART cycles before. A cycle's effects have the share of the one before.
    let silent = 200 - usize::try_from(APART).expect("few");
    assert!((silent..=silent + 1).contains(&held), "{held}");
    let gone = shares.iter().position(|share| *share == 0.0).expect("it is gone");
    assert!((999..=1001).contains(&(gone - held)), "{held} to {gone}");
    let row = run.on(4000, None);
    assert_eq!(
        (row.added_force_n, row.spring_factor, run.state(), row.trips),
        (0.0, 1.0, SupervisorState::Active, 0.0)
    );
    assert!(row.column_angle_rad.abs() < STANDS_RAD);
    let row = run.on(4000, packet);
    assert_eq!((row.host_share, row.added_force_n, row.spring_factor), (1.0, 40.0, 1.5));
    assert!(run.step(|row| row.added_force_n) < 40.0 * 2.5 * PERIOD_S / 0.5);
}

#[test]
fn a_host_that_does_not_want_the_feel_leaves_the_loader_passive() {
    let mut run = Run::new(None);
    run.on(6000, Some((0, sent(&[]))));
    assert_eq!(run.state(), SupervisorState::Passive);
    run.on(4000, Some((ACTIVE, sent(&[]))));
    assert_eq!(run.state(), SupervisorState::Active);
    run.on(4000, Some((0, sent(&[]))));
    assert_eq!(run.state(), SupervisorState::Passive);
    // One that is silent has no say.
    run.on(6000, None);
    assert_eq!(run.state(), SupervisorState::Active);
}

#[test]
fn dynamic_pressure_has_the_factor_of_the_loader_and_a_disconnect_takes_the_spring() {
    // From 1 at 1 kPa straight to 3 at 5 kPa.
    let mut run = Run::new(Some((vec![1000.0, 5000.0], vec![[0.0, 0.0, 5e-4, 1.0]])));
    for (pressure, factor) in [(500.0, 1.0), (3000.0, 2.0), (9000.0, 3.0)] {
        let row = run.on(6000, Some((ACTIVE, sent(&[(0, pressure)]))));
        assert!((row.spring_factor - factor).abs() < 1e-9, "{pressure}: {}", row.spring_factor);
    }
    let row = run.on(2000, Some((ACTIVE | DISCONNECT, sent(&[(0, 9000.0)]))));
    assert_eq!((row.spring_factor, row.trips), (0.0, 0.0));
    assert_eq!(run.on(4000, None).spring_factor, 1.0, "the default feel has no factor");
}

#[test]
fn each_value_of_a_host_has_the_range_and_the_rate_of_the_loader_file() {
    let factor = Some((vec![1000.0, 5000.0], vec![[0.0, 0.0, 5e-4, 1.0]]));
    let safety = [
        ("host_force", 30.0),
        ("host_force_rate", 20.0),
        ("host_angle", 0.02),
        ("host_angle_rate", 0.01),
        ("host_spring", 2.0),
        ("host_spring_rate", 0.5),
    ];
    let mut run = Run::limited(factor.clone(), &safety);
    run.on(6000, Some((ACTIVE, sent(&[]))));
    // Force, angle, factor: for two seconds they go at their rate, then they are at the end of their range.
    let wild = Some((ACTIVE, sent(&[(0, 9000.0), (TRIM, 0.5), (ADDED, 500.0)])));
    let begun = run.rows.len();
    let row = run.on(12_000, wild);
    assert_eq!((row.added_force_n, row.spring_factor), (30.0, 2.0));
    assert!((row.neutral_rad - 0.02).abs() < 1e-12, "{}", row.neutral_rad);
    let rate = |of: fn(&Row) -> f64| {
        run.rows[begun..].windows(2).map(|two| (of(&two[1]) - of(&two[0])).abs()).fold(0.0, f64::max) / PERIOD_S
    };
    assert!(rate(|row| row.added_force_n) < 20.0 * 1.001 && rate(|row| row.spring_factor) < 0.5 * 1.001);
    assert!(rate(|row| row.neutral_rad) < 0.01 * 1.001);
    // A silent host loses its values as ever.
    let row = run.on(2000, None);
    assert_eq!((row.added_force_n, row.spring_factor, row.trips), (0.0, 1.0, 0.0));
    // Without the rows they are what was sent.
    let mut run = Run::new(factor);
    run.on(6000, Some((ACTIVE, sent(&[]))));
    let row = run.on(4000, Some((ACTIVE, sent(&[(0, 9000.0), (TRIM, 0.1), (ADDED, 90.0)]))));
    assert!((row.added_force_n - 90.0).abs() < 1e-9 && row.spring_factor == 3.0, "{}", row.added_force_n);
}

/// Cycles between two packets of a host with 60 a second.
const FRAME: u64 = 33;

#[test]
fn a_host_that_closes_a_spring_over_its_packets_is_told_and_its_swing_damped_within_half_a_second() {
    let mut run = Run::new(None);
    run.on(6000, Some((ACTIVE, sent(&[]))));
    run.machine.disturb(Disturbance::Force(60.0));
    let (spring, mut angle, mut told) = (2700.0, 0.0, None);
    for frame in 0..200 {
        if frame == 30 {
            run.machine.disturb(Disturbance::Force(0.0));
        }
        // By the angle of the frame before.
        #[expect(clippy::cast_possible_truncation, reason = "the packet has single precision")]
        let numbers = sent(&[(ADDED, (-spring * angle) as f32)]);
        angle = run.rows[run.rows.len() - 1].column_angle_rad;
        run.sequence += 1;
        run.controller.take(&LoopRequest::Host(FromHost { sequence: run.sequence, switches: ACTIVE, numbers }));
        let row = run.on(FRAME, None);
        told = told.or((row.trips != 0.0).then_some(run.rows.len()));
    }
    let told = told.expect("it is told");
    let largest = |rows: &[Row]| rows.iter().map(|row| row.column_angle_rad.abs()).fold(0.0, f64::max);
    let (before, after) = (largest(&run.rows[told - 1000..told]), largest(&run.rows[told + 1000..]));
    assert!(after < 0.5 * before, "{before} and {after}");
    let last = run.rows[run.rows.len() - 1];
    assert_eq!((last.host_share, run.state()), (0.0, SupervisorState::Active));
    // A person acknowledges; the host, which sends no force any more, comes back.
    run.controller.take(&LoopRequest::Acknowledge);
    let row = run.on(2000, Some((ACTIVE, sent(&[]))));
    assert_eq!((row.trips, row.host_share), (0.0, 1.0));
}

#[test]
fn each_packet_is_answered_with_what_there_is() {
    let mut run = Run::new(None);
    run.on(10_000, Some((ACTIVE, sent(&[(TRIM, 0.05)]))));
    let sequences: Vec<u32> = run.answers.iter().map(|answer| answer.sequence).collect();
    assert_eq!(sequences, (1..=500).collect::<Vec<u32>>());
    let last = run.answers[run.answers.len() - 1];
    // The packet before the last row by 19 cycles brought it.
    let row = run.rows[run.rows.len() - usize::try_from(APART).expect("few")];
    #[expect(clippy::cast_possible_truncation, reason = "the packet has single precision")]
    let expected = [row.column_angle_rad as f32, row.neutral_rad as f32];
    assert_eq!(([last.numbers[0], last.numbers[3]], last.status), (expected, 3));
    assert_eq!((last.numbers[4], last.numbers[5]), (1.0, 1.0));
    run.controller.take(&LoopRequest::Stop);
    run.on(APART, Some((ACTIVE, sent(&[]))));
    // Tripped, by the first function of the table.
    assert_eq!(run.answers[run.answers.len() - 1].status, 5 | 1 << 8);
}

#[test]
fn a_socket_takes_one_host_and_good_packets_alone() {
    let bound = || UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let (link, mut of_axes) = host_link::between(bound(), 1).expect("a socket");
    let mut of_host = of_axes.remove(0);
    let host_status = Arc::clone(&link.host_status);
    let ended = Arc::new(AtomicBool::new(false));
    let end = Arc::clone(&ended);
    let thread = thread::spawn(move || link.listen(&end));
    let (host, other) = (bound(), bound());
    host.set_read_timeout(Some(Duration::from_secs(5))).expect("a time");
    let packet = |sequence| FromHost { sequence, switches: ACTIVE, ..FromHost::none() };
    let mut damaged = packet(9).encode();
    damaged[20] ^= 1;
    let wait = |count: u64| {
        for _ in 0..5000 {
            if host_status.packets.load(Relaxed) + host_status.refused.load(Relaxed) == count {
                return;
            }
            thread::sleep(Duration::from_millis(1));
        }
        panic!("{host_status:?}");
    };
    let answer = ToHost { sequence: 1, status: 3, numbers: [0.5; 6] };
    for (k, (from, bytes)) in [
        (&host, packet(5).encode().to_vec()),
        (&host, packet(5).encode().to_vec()),
        (&host, damaged.to_vec()),
        (&host, vec![0; 3]),
        (&other, packet(7).encode().to_vec()),
        (&host, packet(6).encode().to_vec()),
    ]
    .into_iter()
    .enumerate()
    {
        from.send_to(&bytes, host_status.at).expect("it is sent");
        if [0, 5].contains(&k) {
            while of_host.packets.is_empty() {
                thread::sleep(Duration::from_millis(1));
            }
            of_host.answers.push(answer).expect("there is room");
            let mut back = [0; 64];
            let (count, _) = host.recv_from(&mut back).expect("an answer");
            assert_eq!(ToHost::decode(&back[..count]), Ok(answer));
            assert_eq!(of_host.packets.pop().expect("it is there").sequence, if k == 0 { 5 } else { 6 });
        }
        wait(k as u64 + 1);
    }
    assert_eq!((host_status.packets.load(Relaxed), host_status.refused.load(Relaxed)), (2, 4));
    assert_eq!(host_status.last().expect("it spoke").0, host.local_addr().expect("an address"));
    // Another sender waits for a person's word, however long the host is silent; a third has to wait then, too.
    assert!(!host_status.accept(), "nobody waits while the host speaks");
    thread::sleep(Duration::from_millis(1100));
    let (others, third) = (other.local_addr().expect("an address"), bound());
    for (k, from) in [&other, &other].into_iter().enumerate() {
        from.send_to(&packet(8).encode(), host_status.at).expect("it is sent");
        wait(7 + k as u64);
        assert_eq!((host_status.packets.load(Relaxed), host_status.waiting()), (2, Some(others)));
    }
    assert!(host_status.accept() && host_status.waiting().is_none());
    third.send_to(&packet(9).encode(), host_status.at).expect("it is sent");
    wait(9);
    assert_eq!(host_status.packets.load(Relaxed), 2);
    other.send_to(&packet(1).encode(), host_status.at).expect("it is sent");
    while of_host.packets.is_empty() {
        thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(of_host.packets.pop().expect("it is there").sequence, 1);
    wait(10);
    assert_eq!((host_status.packets.load(Relaxed), host_status.last().expect("it spoke").0), (3, others));
    host.send_to(&packet(99).encode(), host_status.at).expect("it is sent");
    wait(11);
    assert_eq!(host_status.packets.load(Relaxed), 3, "the host before is another sender now");
    ended.store(true, Relaxed);
    thread.join().expect("it ends");
}

/// Places of the added spring and damping, of pressure and airspeed.
const STIFFNESS: usize = 10;
const DAMPING: usize = 11;
const PRESSURE: usize = 0;
const AIRSPEED: usize = 12;

#[test]
fn coefficients_that_no_loader_renders_are_refused_before_they_act() {
    let mut run = Run::new(None);
    let stiffness = setup().parameters().feel.stiffness;
    #[expect(clippy::cast_possible_truncation, reason = "the packet has single precision")]
    let negative = sent(&[(STIFFNESS, (-2.0 * stiffness) as f32)]);
    run.on(4000, Some((ACTIVE, sent(&[(DAMPING, 5.0)]))));
    assert_eq!(run.answers.last().expect("answers").status, 3);
    let row = run.on(100, Some((ACTIVE, negative)));
    assert_eq!(run.answers.last().expect("answers").status, 3 | 1 << 16);
    assert_eq!((row.added_stiffness_n_m_per_rad, row.added_damping_n_m_s_per_rad), (0.0, 5.0));
    // A host that sends nothing else is a silent one.
    let row = run.on(2000, Some((ACTIVE, negative)));
    assert_eq!((row.host_share, row.added_damping_n_m_s_per_rad, run.state()), (0.0, 0.0, SupervisorState::Active));
    // A loader that renders less says so.
    let rendered = |spring, damping| Rendered { spring, damping };
    let springs = vec![rendered(0.5 * stiffness, [10.0, 50.0]), rendered(2.0 * stiffness, [20.0, 80.0])];
    let feel = setup().parameters().feel.damping;
    for (added, more, refused) in
        [(0.0, 0.0, 0), (0.0, 30.0 - feel, 0), (0.9, 70.0 - feel, 0), (1.1, 70.0 - feel, 1), (0.0, 5.0 - feel, 1)]
    {
        let mut run = Run::made(Setup { rendered: springs.clone(), host: true, ..setup() });
        #[expect(clippy::cast_possible_truncation, reason = "the packet has single precision")]
        run.on(40, Some((ACTIVE, sent(&[(STIFFNESS, (added * stiffness) as f32), (DAMPING, more as f32)]))));
        assert_eq!(run.answers.last().expect("answers").status >> 16, refused, "{added}, {more}");
    }
}

#[test]
fn coefficients_that_a_loader_does_not_render_are_softened_where_it_is_told_to() {
    let setup = setup();
    let feel = setup.parameters().feel;
    let (g, b) = (feel.stiffness, feel.damping);
    let rendered = |spring, damping| Rendered { spring, damping };
    let springs = vec![rendered(0.5 * g, [10.0, 50.0]), rendered(2.0 * g, [20.0, 80.0])];
    let softens = Setup { rendered: springs, softens: true, host: true, ..setup };
    // Spring factor and added spring in G, damping of the whole in N m s/rad: as asked for, and as rendered.
    let cases = [
        ([1.0, 0.0, 30.0], [1.0, 0.0, 30.0]),
        ([1.0, 0.5, 5.0], [1.0, 0.5, 10.0 + 2.0 / 3.0 * 10.0]),
        ([1.0, 3.0, 90.0], [0.5, 1.5, 80.0]),
        ([0.2, 0.0, 5.0], [0.2, 0.3, 10.0]),
        ([3.0, 0.0, b], [2.0, 0.0, b]),
        ([0.2, 0.0, b], [0.2, 0.0, b]),
    ];
    for (asked, given) in cases {
        let mut run = Run::made(softens.clone());
        let [factor, spring, damping] = asked;
        #[expect(clippy::cast_possible_truncation, reason = "the packet has single precision")]
        let numbers = [(1, factor), (STIFFNESS, spring * g), (DAMPING, damping - b)].map(|(k, of)| (k, of as f32));
        let row = run.on(6000, Some((ACTIVE, sent(&numbers))));
        let soft = u64::from(asked != given);
        assert_eq!(u64::from(run.answers.last().expect("answers").status >> 16), 2 * soft, "{asked:?}");
        assert_eq!(run.controller.softened() > 0, soft == 1, "{asked:?}");
        let found = [row.spring_factor, row.added_stiffness_n_m_per_rad / g, row.added_damping_n_m_s_per_rad + b];
        for (found, given) in found.into_iter().zip(given) {
            assert!((found - given).abs() < 1e-6 * (1.0 + given), "{asked:?}: {found}, {given}"); // of the packet's f32
        }
    }
}

#[test]
fn numbers_hold_while_the_simulator_stands_still_and_come_back_over_a_second() {
    let mut run = Run::new(None);
    run.on(6000, Some((ACTIVE, sent(&[(ADDED, 10.0)]))));
    let row = run.on(2000, Some((ACTIVE | FREEZE, sent(&[(ADDED, 50.0)]))));
    assert_eq!((row.added_force_n, row.host_share), (10.0, 1.0));
    let row = run.on(1000, Some((ACTIVE, sent(&[(ADDED, 50.0)]))));
    assert!((row.added_force_n - 30.0).abs() < 0.5, "half a second after it half of the way: {}", row.added_force_n);
    let row = run.on(1040, Some((ACTIVE, sent(&[(ADDED, 50.0)]))));
    assert_eq!(row.added_force_n, 50.0);
    assert!(run.step(|row| row.added_force_n) < 40.0 / 1900.0);
}

#[test]
fn the_surface_acts_in_the_flight_that_the_host_tells() {
    let place = |name: &str| TABLE.iter().position(|row| row.part == "surface" && row.name == name).expect("a row");
    let mut setup = Setup { host: true, ..setup() };
    let rows = [("area", 1.0), ("chord", 0.4), ("gearing", 1.0), ("per_deflection", -0.3), ("per_rate", -2.0)];
    for (name, value) in rows {
        setup.values[place(name)] = value;
    }
    let mut run = Run::made(setup);
    let flight = sent(&[(PRESSURE, 1500.0), (AIRSPEED, 50.0)]);
    let row = run.on(6000, Some((ACTIVE, flight)));
    assert_eq!((row.added_stiffness_n_m_per_rad, row.added_damping_n_m_s_per_rad), (0.0, 0.0), "it does not fly");
    let row = run.on(2000, Some((ACTIVE | FLIGHT, flight)));
    let stiffness = 1500.0 * 0.4 * 0.3;
    assert!(
        (row.added_stiffness_n_m_per_rad - stiffness).abs() < 1e-9 * stiffness,
        "{}",
        row.added_stiffness_n_m_per_rad
    );
    let damping = 1500.0 * 0.4 * 2.0 * 0.4 / 100.0;
    assert!((row.added_damping_n_m_s_per_rad - damping).abs() < 1e-9 * damping, "{}", row.added_damping_n_m_s_per_rad);
    assert!(run.step(|row| row.added_stiffness_n_m_per_rad) < 0.01 * stiffness);
}
