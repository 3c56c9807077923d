//! A loop that is held up while its machine moves on: velocities are of the time that really went by.

use crate::loader::{PERIOD_S, setup};
use forcefeel_live::clock::{Clock, Monotonic};
use forcefeel_live::controller::Controller;
use forcefeel_live::cycle::Cycles;
use forcefeel_live::row::Row;
use forcefeel_live::status::Status;
use forcefeel_live::udp::{NO_CYCLE, Request, SAMPLE_BYTES, Stamped, Udp, request_of, sample_bytes};
use forcefeel_model::control::Sample;
use forcefeel_model::parameters::Parameters;
use forcefeel_model::supervisor::Function;
use rtrb::RingBuffer;
use std::net::UdpSocket;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::{Duration, Instant};

const STALL: Duration = Duration::from_millis(200);
/// The column goes to and fro so far, in rad.
const FARTHEST_RAD: f64 = 0.2;
/// Speed limit of the report's loader, in rad/s.
const LIMIT: f64 = 600.0 * core::f64::consts::PI / 180.0;

/// When a machine samples.
#[derive(Clone, Copy, PartialEq)]
enum Samples {
    /// As a command comes.
    WhenAsked,
    /// By a clock of its own.
    ByItself,
}

/// Angle in rad of a column that swings with this largest speed.
fn angle(time_s: f64, speed: f64) -> f64 {
    FARTHEST_RAD * (speed * time_s / FARTHEST_RAD).sin()
}

/// A machine of its own time: sensors of a column that swings.
fn machine(socket: &UdpSocket, samples: Samples, speed: f64, ended: &AtomicBool) {
    let of = Parameters::elevator();
    let begun = Instant::now();
    let (mut to, mut sequence, mut answers) = (None, 0, NO_CYCLE);
    let wait = if samples == Samples::ByItself { Duration::from_secs_f64(PERIOD_S) } else { Duration::from_millis(50) };
    socket.set_read_timeout(Some(wait)).expect("a time");
    while !ended.load(Relaxed) {
        let mut bytes = [0; SAMPLE_BYTES];
        let came = socket.recv_from(&mut bytes).ok();
        let asked = came.and_then(|(count, from)| Some((request_of(&bytes[..count])?, from)));
        if let Some(((session, request), from)) = asked {
            answers = if let Request::Command(command) = request { command.cycle } else { NO_CYCLE };
            to = Some((session, from));
        }
        if let Some((session, to)) = to
            && (asked.is_some() || samples == Samples::ByItself)
        {
            sequence += 1;
            let time = begun.elapsed();
            let base = angle(time.as_secs_f64(), speed) * of.column.base_arm;
            let sensors = [0.0, base * of.linkage.ratio, base, 0.0];
            let sample = Sample { sensors, pilot_force: 0.0 };
            let clock_ns = u64::try_from(time.as_nanos()).expect("less than 500 years");
            let stamped =
                Stamped { sequence, session, answers, clock_ns, sample, emergency_stop: false, drive_acts: true };
            socket.send_to(&sample_bytes(&stamped), to).expect("sent");
        }
    }
}

/// The rows of a loop that stalls twice.
fn rows(samples: Samples, speed: f64) -> Vec<Row> {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let at = socket.local_addr().expect("an address");
    let ended = Arc::new(AtomicBool::new(false));
    let end = Arc::clone(&ended);
    let thread = thread::spawn(move || machine(&socket, samples, speed, &end));
    let (rows, mut told) = RingBuffer::new(4096);
    let mut run = Cycles {
        controller: Controller::new(&setup()).expect("it has limits"),
        machine: Box::new(Udp::connect(at, Some(PERIOD_S)).expect("a socket")),
        plan: vec![],
        requests: RingBuffer::new(1).1,
        host: None,
        disturbances: RingBuffer::new(1).1,
        rows,
        taken: RingBuffer::new(1).0,
        status: Arc::new(Status::default()),
        planned: 0,
        patient: false,
    };
    let mut clock = Monotonic::new(PERIOD_S);
    for cycle in 0..1200 {
        if [400, 800].contains(&cycle) {
            thread::sleep(STALL);
        }
        run.cycle(clock.wait());
    }
    ended.store(true, Relaxed);
    thread.join().expect("it ends");
    std::iter::from_fn(|| told.pop().ok()).collect()
}

fn acted(rows: &[Row], function: Function) -> bool {
    let bit = 1 << Function::ALL.iter().position(|&one| one == function).expect("in the table");
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "bits of a whole number")]
    rows.iter().any(|row| row.acting as u32 & bit != 0)
}

#[test]
fn a_stall_makes_no_column_faster_than_it_is() {
    for samples in [Samples::WhenAsked, Samples::ByItself] {
        let slow = rows(samples, 0.2 * LIMIT);
        assert!(slow.iter().map(|row| row.missed).fold(0.0, f64::max) > 300.0);
        for function in [Function::ColumnAngle, Function::Speed] {
            assert!(!acted(&slow, function), "{function:?}");
        }
        assert!(acted(&rows(samples, 2.0 * LIMIT), Function::Speed), "what is too fast is seen");
    }
}
