//! The supervisor's functions, states and limits, a sample at a time.

use forcefeel_model::parameters::{DriveKind, Feel, Parameters};
use forcefeel_model::supervisor::limits::ESTIMATE_BANDWIDTH;
use forcefeel_model::supervisor::{
    Action, Function, Functions, Limits, Refusal, RequestedMode, Supervisor, SupervisorInput, SupervisorOutput,
    SupervisorState,
};

const PERIOD: f64 = 1e-3;

fn limits() -> Limits {
    Limits::new(&Parameters::elevator(), DriveKind::Hydraulic, PERIOD).expect("limits")
}

fn still(requested: RequestedMode) -> SupervisorInput<f64> {
    SupervisorInput {
        sensed: [0.0; 4],
        missed: 0,
        periods: 1.0,
        delay: 0,
        late: 0,
        host: false,
        host_age: 0,
        command: 0.0,
        feel_acceleration: 0.0,
        feel_rate: 0.0,
        link_torque: 0.0,
        emergency_stop: false,
        other_axis: false,
        drive_fault: false,
        drive_acts: true,
        requested,
        acknowledge: false,
    }
}

/// A loader that is active, and a sample to go on with.
fn active() -> (Supervisor<f64>, SupervisorInput<f64>) {
    active_under(&limits())
}

fn active_under(limits: &Limits) -> (Supervisor<f64>, SupervisorInput<f64>) {
    let mut supervisor = Supervisor::new(*limits, 0.0);
    supervisor.step(&still(RequestedMode::Off));
    let input = still(RequestedMode::Active);
    let output = (0..2000).map(|_| supervisor.step(&input)).last().expect("samples");
    assert_eq!((output.state, output.enable, output.share), (SupervisorState::Active, true, 1.0));
    (supervisor, input)
}

/// Samples until it is tripped, and until command and enable line are down, counted from 1.
fn until_safe(
    supervisor: &mut Supervisor<f64>,
    mut of: impl FnMut(u32) -> SupervisorInput<f64>,
) -> (u32, u32, SupervisorOutput<f64>) {
    let mut stopped = 0;
    for k in 1..20_000 {
        let allowed = supervisor.step(&of(k));
        assert!(allowed.command.is_finite());
        stopped = if stopped == 0 && allowed.state == SupervisorState::Tripped { k } else { stopped };
        if stopped != 0 && allowed.command == 0.0 && !allowed.enable {
            return (stopped, k, allowed);
        }
    }
    panic!("never safe");
}

/// What a fault makes of the samples from it on, counted from 1.
type Spoil = Box<dyn Fn(u32, &mut SupervisorInput<f64>)>;

#[test]
fn each_function_acts_in_its_stated_sample_and_is_latched() {
    let of = limits();
    let (grip, base) = (of.grip_arm / of.lever, of.base_arm);
    let cases: [(Function, Spoil); 12] = [
        (Function::EmergencyStop, Box::new(|_, input| input.emergency_stop = true)),
        (Function::DriveFault, Box::new(|_, input| input.drive_fault = true)),
        (Function::DriveStopped, Box::new(|_, input| input.drive_acts = false)),
        (Function::NotANumber, Box::new(|_, input| input.sensed[1] = f64::NAN)),
        (Function::NotANumber, Box::new(|_, input| input.command = f64::INFINITY)),
        (Function::OutOfRange, Box::new(move |_, input| input.sensed[0] = -of.range[0] * 1.01)),
        (Function::LoadCell, Box::new(move |_, input| input.sensed[0] = of.plausible[0] * 2.0)),
        (Function::ColumnAngle, Box::new(move |_, input| input.sensed[2] = of.plausible[2] * base * 2.0)),
        (Function::Late, Box::new(move |_, input| input.delay = of.late + 1)),
        (Function::Silence, Box::new(|k, input| input.missed = k)),
        (Function::Overrun, Box::new(|k, input| input.late = k)),
        (Function::Force, Box::new(move |_, input| held(&of, of.force_limit * grip * 1.01, input))),
    ];
    for (function, spoil) in cases {
        let (mut supervisor, input) = active();
        if function == Function::Force {
            // A force that jumps is bridged for a sample; a hand's rises.
            for share in 0..100 {
                let mut now = input;
                held(&of, of.force_limit * grip * 0.01 * f64::from(share), &mut now);
                supervisor.step(&now);
            }
        }
        let (stopped, safe, allowed) = until_safe(&mut supervisor, |k| {
            let mut now = input;
            spoil(k, &mut now);
            now
        });
        assert_eq!(allowed.cause, Some(function));
        assert_eq!(stopped, function.samples(&of), "{function:?}");
        assert!(safe < stopped + of.stop, "{function:?}");
        assert_eq!(supervisor.step(&input).state, SupervisorState::Tripped, "latched: {function:?}");
    }
}

#[test]
fn nothing_begins_before_the_drive_acts_and_then_it_is_as_of_one_that_acts_at_once() {
    let of = limits();
    let rows = |acts_from: u32| {
        let mut supervisor = Supervisor::new(of, 0.0);
        supervisor.step(&still(RequestedMode::Off));
        // A law that asks for much from the first sample on.
        let input = |k: u32| SupervisorInput {
            command: of.command,
            drive_acts: k >= acts_from,
            ..still(RequestedMode::Active)
        };
        (0..2000).map(|k| supervisor.step(&input(k))).collect::<Vec<_>>()
    };
    let (at_once, waited) = (rows(0), rows(800));
    let powered = at_once.iter().position(|row| row.enable).expect("power");
    let waits = &waited[powered..800];
    assert!(waits.iter().all(|row| row.enable && row.state == SupervisorState::Initializing && row.command == 0.0));
    // Whether it acts is seen from the sample after on.
    for (row, later) in at_once[powered + 1..].iter().zip(&waited[800..]) {
        assert_eq!((row.state, row.command, row.share), (later.state, later.command, later.share));
    }
}

#[test]
fn a_drive_that_does_not_act_in_time_is_named_and_an_off_forgets_it() {
    let of = limits();
    let (mut supervisor, idle) =
        (Supervisor::new(of, 0.0), SupervisorInput { drive_acts: false, ..still(RequestedMode::Active) });
    let off = SupervisorInput { requested: RequestedMode::Off, ..idle };
    supervisor.step(&off);
    // Off in between, it is waited for anew; what a lost sample says counts for nothing.
    for k in 0..of.stuck + of.power {
        let output = supervisor.step(&SupervisorInput { missed: k % 2, drive_acts: k % 2 == 1, ..idle });
        assert_eq!((output.state, output.command), (SupervisorState::Initializing, 0.0));
    }
    assert!(!supervisor.step(&off).enable);
    let last = (0..=of.stuck + of.power).map(|_| supervisor.step(&idle)).last().expect("samples");
    assert_eq!((last.state, last.cause), (SupervisorState::Tripped, Some(Function::DriveNotReady)));
    assert_eq!((last.command, last.enable), (0.0, false));
}

#[test]
fn a_column_that_a_hand_throws_to_its_speed_limit_is_stopped_in_the_second_sample() {
    let of = limits();
    let (mut supervisor, input) = active();
    let acceleration = 100.0;
    let angle = |k: u32| 0.5 * acceleration * (f64::from(k) * PERIOD).powi(2);
    let (stopped, safe, allowed) = until_safe(&mut supervisor, |k| {
        let mut now = input;
        now.feel_rate = acceleration * f64::from(k) * PERIOD;
        moved(&of, angle(k), &mut now);
        now
    });
    let fast = (1..1000).find(|&k| angle(k) - angle(k - 1) > of.speed_step).expect("it becomes so fast");
    assert_eq!((allowed.cause, stopped), (Some(Function::Speed), fast + Function::Speed.samples(&of) - 1));
    assert!(safe < stopped + of.stop);
}

/// The machine under a force of the load cell, the link stretched as it is.
fn held(of: &Limits, force: f64, input: &mut SupervisorInput<f64>) {
    input.sensed[0] = force;
    input.sensed[1] = force * of.link[0];
}

/// The machine at an angle.
fn moved(of: &Limits, angle: f64, input: &mut SupervisorInput<f64>) {
    input.sensed[1] = angle * of.lever;
    input.sensed[2] = angle * of.base_arm;
}

#[test]
fn a_sensor_that_sticks_is_found_before_three_sensors_disagree() {
    let parameters = Parameters::elevator();
    let late = forcefeel_model::parameters::Safety { agreement_time: 1.0, ..parameters.safety };
    let of = Limits::new(&Parameters { safety: late, ..parameters }, DriveKind::Hydraulic, PERIOD).expect("limits");
    let mut supervisor = Supervisor::new(of, 0.0);
    supervisor.step(&still(RequestedMode::Off));
    let mut input = still(RequestedMode::Active);
    for _ in 0..2000 {
        supervisor.step(&input);
    }
    for k in 1..4000 {
        input.sensed[2] = f64::from(k) * 1e-5;
        let allowed = supervisor.step(&input);
        if allowed.state == SupervisorState::Tripped {
            assert_eq!(allowed.cause, Some(Function::Stuck));
            return;
        }
    }
    panic!("the position stays at zero and nobody minds");
}

#[test]
fn sensors_that_drift_apart_are_stopped_once_they_disagree() {
    let (mut supervisor, input) = active();
    let of = *supervisor.limits();
    // Slower than the observer forgets; none of them stays at a number, or it would be taken for stuck.
    let drift = |k: u32| f64::from(k) * 1e-3 * of.agreement_m;
    let (stopped, _, allowed) = until_safe(&mut supervisor, |k| {
        let tremor = f64::from(k) * 1e-9;
        let mut now = input;
        now.sensed = [tremor, drift(k) + tremor, tremor, 0.0];
        now
    });
    assert_eq!(allowed.cause, Some(Function::Disagreement));
    assert!(drift(stopped - of.agreement) < 1.1 * of.agreement_m, "{stopped}");
}

#[test]
fn a_spike_is_bridged_and_a_lost_sample_is_predicted() {
    let of = limits();
    let range = [of.range[0], of.range[1], of.range[2] * of.base_arm];
    for k in 0..3 {
        let (mut supervisor, input) = active();
        let mut spiked = input;
        spiked.sensed[k] = 0.9 * range[k];
        // The law is given what the observer knows, not the spike.
        let readings = supervisor.admit(&spiked).expect("readings");
        assert!(readings[k].abs() < 1e-9 * range[k], "sensor {k}: {readings:?}");
        supervisor.step(&spiked);
        assert_eq!(supervisor.step(&input).state, SupervisorState::Active);
    }
    // A column that turns at a constant speed goes on through what is lost.
    let (mut supervisor, input) = active();
    let rate = 0.05;
    let angle = |k: i32| rate * f64::from(k) * PERIOD;
    // Under the command that moves the drive at that speed: a e = d x'.
    let [per_volt, .., lag, _] = of.drive;
    let mut last = SupervisorInput { command: lag / per_volt * of.lever * rate, ..input };
    for k in 0..300 {
        moved(&of, angle(k), &mut last);
        supervisor.step(&last);
    }
    for k in 300..310 {
        let lost = SupervisorInput { missed: u32::try_from(k - 299).expect("a few"), ..last };
        let readings = supervisor.admit(&lost).expect("readings");
        assert!((readings[2] / of.base_arm - angle(k)).abs() < 1e-5, "{k}: {readings:?}");
        assert_eq!(supervisor.step(&lost).state, SupervisorState::Active);
    }
}

#[test]
fn an_angle_that_jumps_for_a_sample_is_no_speed() {
    let plain = Parameters::elevator();
    let strong = forcefeel_model::parameters::Safety { absolute_force: 1e5, ..plain.safety };
    let of = Limits::new(&Parameters { safety: strong, ..plain }, DriveKind::Hydraulic, PERIOD).expect("limits");
    let (mut supervisor, input) = active_under(&of);
    let mut jumps = input;
    jumps.sensed[2] = 3.0 * of.speed_step * of.base_arm;
    assert!(3.0 * of.speed_step < of.plausible[2], "it is not bridged");
    assert_eq!(supervisor.step(&jumps).state, SupervisorState::Active);
    assert_eq!(supervisor.step(&input).state, SupervisorState::Active);
}

#[test]
fn a_column_held_still_by_a_force_that_changes_is_no_stuck_sensor() {
    let of = limits();
    let (mut supervisor, input) = active();
    for k in 0..2000_u32 {
        let mut now = input;
        held(&of, 0.9 * of.force_limit * of.grip_arm / of.lever * (0.01 * f64::from(k)).sin(), &mut now);
        let allowed = supervisor.step(&now);
        assert_eq!((allowed.state, allowed.cause), (SupervisorState::Active, None), "{k}");
    }
    // And one that stays for good after a jump.
    let (mut supervisor, mut now) = active();
    held(&of, 0.9 * of.force_limit * of.grip_arm / of.lever, &mut now);
    assert!((0..2000).all(|_| supervisor.step(&now).state == SupervisorState::Active));
}

#[test]
fn the_load_cell_of_a_column_at_an_end_stop_may_be_off_by_thrice_as_much() {
    for (stop_high, off, stops) in [(0.3, 2.0, true), (-1e-6, 2.0, false), (-1e-6, 4.0, true)] {
        let mut parameters = Parameters::elevator();
        (parameters.column.stop_low, parameters.column.stop_high) = (-0.3, stop_high);
        let of = Limits::new(&parameters, DriveKind::Hydraulic, PERIOD).expect("limits");
        let (mut supervisor, mut input) = active_under(&of);
        input.sensed[0] = off * of.plausible[0];
        assert_eq!((0..5).any(|_| supervisor.step(&input).acting.has(Function::LoadCell)), stops, "{stop_high}, {off}");
    }
}

#[test]
fn a_command_is_held_to_its_limit_and_to_its_rate() {
    let (mut supervisor, mut input) = active();
    let of = *supervisor.limits();
    let mut last = 0.0;
    for k in 0..200 {
        input.command = if k % 2 == 0 { 1e300 } else { -1e300 };
        let allowed = supervisor.step(&input);
        assert!(
            allowed.command.abs() <= of.command && (allowed.command - last).abs() <= of.command_step * (1.0 + 1e-12)
        );
        assert!(allowed.acting.has(Function::CommandLimit) && allowed.state == SupervisorState::Active);
        last = allowed.command;
    }
}

#[test]
fn a_column_that_leaves_its_feel_with_no_hand_on_it_is_stopped_in_time() {
    let (mut supervisor, mut input) = active();
    let of = *supervisor.limits();
    // A constant speed away from neutral: the link carries nothing, the feel asks to be braked.
    let (rate, braking) = (0.5, 40.0);
    input.feel_acceleration = -braking;
    assert!(of.inertia * braking * rate > of.runaway_power);
    // It comes to that speed without a hand: the link gives J theta''.
    let (stopped, ..) = until_safe(&mut supervisor, |k| {
        let mut now = input;
        let time = f64::from(k) * PERIOD;
        let rise = 0.02;
        let (acceleration, angle) = if time < rise {
            (rate / rise, 0.5 * rate / rise * time * time)
        } else {
            (0.0, rate * (time - 0.5 * rise))
        };
        let force = of.inertia * acceleration / of.lever;
        now.sensed = [force, angle * of.lever + force * of.link[0], angle * of.base_arm, 0.0];
        now
    });
    assert!(stopped <= of.runaway + 25, "{stopped} of {}", of.runaway);
}

#[test]
fn a_hand_too_light_to_be_seen_moves_a_light_feel_and_no_hand_is_stopped() {
    let plain = Parameters::elevator();
    let parameters = Parameters { feel: Feel { inertia: 0.1 * plain.column.inertia, ..plain.feel }, ..plain };
    let of = Limits::new(&parameters, DriveKind::Hydraulic, PERIOD).expect("limits");
    let (rate, hand) = (2.0, 0.7 * of.hand_torque);
    // The feel balances the hand at a constant speed: the link carries the hand's torque, or nothing where the column runs away.
    for (torque, stops) in [(hand, false), (0.0, true)] {
        let (mut supervisor, mut input) = active_under(&of);
        input.feel_acceleration = -hand / parameters.feel.inertia;
        let force = -torque / of.lever;
        let stopped = (0..400).any(|k: u32| {
            let time = f64::from(k) * PERIOD;
            let rise = 0.1;
            let angle = rate * if time < rise { 0.5 * time * time / rise } else { time - 0.5 * rise };
            let driven = force + if time < rise { of.inertia * rate / rise / of.lever } else { 0.0 };
            let sensed = [driven, angle * of.lever + driven * of.link[0], angle * of.base_arm, 0.0];
            let mut now = input;
            (now.sensed, now.feel_rate) = (sensed, rate);
            supervisor.step(&now).acting.has(Function::Runaway)
        });
        assert_eq!(stopped, stops, "under a torque of {torque}");
    }
}

#[test]
fn a_silent_host_fades_and_comes_back_without_a_stop() {
    let (mut supervisor, mut input) = active();
    let of = *supervisor.limits();
    let mut shares = vec![];
    for age in 0..of.host + 600 {
        (input.host, input.host_age) = (true, age);
        shares.push(supervisor.step(&input).host_share);
    }
    assert!(shares[..of.host as usize].iter().all(|&share| share >= 1.0));
    assert_eq!(shares.last(), Some(&0.0));
    assert!(shares.windows(2).all(|pair| pair[0] - pair[1] <= of.host_step * 1.001));
    input.host_age = 0;
    let back = (0..600).map(|_| supervisor.step(&input)).last().expect("samples");
    assert_eq!((back.state, back.host_share), (SupervisorState::Active, 1.0));
}

#[test]
fn a_column_that_was_thrown_and_lies_elsewhere_can_be_acknowledged() {
    let of = limits();
    let (mut supervisor, mut input) = active();
    for k in 0..220 {
        moved(&of, 0.75 * of.speed_step * f64::from(k * k) / 220.0, &mut input);
        supervisor.step(&input);
    }
    let mut elsewhere = still(RequestedMode::Off);
    moved(&of, -0.1, &mut elsewhere);
    let rested = (0..1000).map(|_| supervisor.step(&elsewhere)).last().expect("samples");
    assert_eq!((rested.state, rested.enable), (SupervisorState::Tripped, false));
    elsewhere.acknowledge = true;
    assert_eq!((0..5).map(|_| supervisor.step(&elsewhere)).last().map(|it| it.state), Some(SupervisorState::Off));
}

#[test]
fn to_acknowledge_starts_nothing() {
    let (mut supervisor, mut input) = active();
    input.emergency_stop = true;
    let cut = supervisor.step(&input);
    assert_eq!((cut.state, cut.command, cut.enable), (SupervisorState::Tripped, 0.0, false));
    input.acknowledge = true;
    assert_eq!(supervisor.step(&input).state, SupervisorState::Tripped, "while it is pressed");
    (input.emergency_stop, input.acknowledge) = (false, false);
    supervisor.step(&input);
    input.acknowledge = true;
    for _ in 0..100 {
        assert_eq!(supervisor.step(&input).state, SupervisorState::Off, "the request stands, and nothing starts");
    }
    input.requested = RequestedMode::Off;
    supervisor.step(&input);
    input.requested = RequestedMode::Passive;
    assert_eq!((0..500).map(|_| supervisor.step(&input)).last().map(|it| it.state), Some(SupervisorState::Passive));
}

#[test]
fn the_feel_comes_from_where_the_column_stands() {
    let mut supervisor = Supervisor::new(limits(), 0.0);
    let of = *supervisor.limits();
    let mut input = still(RequestedMode::Off);
    moved(&of, 0.1, &mut input);
    supervisor.step(&input);
    input.requested = RequestedMode::Active;
    let mut before = None;
    for _ in 0..2000 {
        let allowed = supervisor.step(&input);
        if allowed.follows {
            let neutral = allowed.neutral(0.0);
            let step = (neutral - before.unwrap_or(0.1)).abs();
            assert!(step <= 0.1 * of.fade_step * 1.001);
            before = Some(neutral);
        }
    }
    assert_eq!(before, Some(0.0));
}

#[test]
fn the_travel_is_found_or_refused() {
    let plain = Parameters::elevator();
    let safety = forcefeel_model::parameters::Safety { travel_search: 1.0, ..plain.safety };
    let column = forcefeel_model::parameters::Column { stop_low: -0.3, stop_high: 0.2, ..plain.column };
    let of = Limits::new(&Parameters { safety, column, ..plain }, DriveKind::Hydraulic, PERIOD).expect("limits");
    for (stops, output) in [([-0.3, 0.2], SupervisorState::Passive), ([-0.1, 0.2], SupervisorState::Tripped)] {
        let mut supervisor = Supervisor::new(of, 0.0);
        supervisor.step(&still(RequestedMode::Off));
        let mut input = still(RequestedMode::Passive);
        let mut state = SupervisorState::Off;
        for _ in 0..30_000 {
            let allowed = supervisor.step(&input);
            state = allowed.state;
            if matches!(state, SupervisorState::Passive | SupervisorState::Tripped) {
                break;
            }
            if allowed.leads {
                let leads = allowed.led;
                // The column follows up to its stop; from there the drive stretches the link.
                let angle = leads.clamp(stops[0], stops[1]);
                let force = (leads - angle) * 2e5;
                input.sensed = [force, angle * of.lever + force * of.link[0], angle * of.base_arm, 0.0];
            }
        }
        assert_eq!(state, output);
        if output == SupervisorState::Passive {
            // Rounding of the angle from the base's displacement.
            let near = |output: [f64; 2]| output.iter().zip(stops).all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(supervisor.found_stops().is_some_and(near));
        }
    }
}

#[test]
fn what_cannot_be_supervised_is_refused() {
    let elevator = Parameters::elevator();
    assert_eq!(Limits::new(&elevator, DriveKind::Hydraulic, 0.0), Err(Refusal::NoPeriod));
    assert_eq!(Limits::new(&elevator, DriveKind::Electric, PERIOD), Err(Refusal::NoLimit));
    assert!(
        [Refusal::NoPeriod, Refusal::NoLimit]
            .iter()
            .all(|refusal| refusal.text().contains("expected") || refusal.text().contains("state"))
    );
}

#[test]
fn single_precision_does_the_same() {
    let mut supervisor = Supervisor::new(limits(), 0.0_f32);
    let mut input = SupervisorInput {
        sensed: [0.0_f32; 4],
        missed: 0,
        periods: 1.0,
        delay: 0,
        late: 0,
        host: false,
        host_age: 0,
        command: 1.0,
        feel_acceleration: 0.0,
        feel_rate: 0.0,
        link_torque: 0.0,
        emergency_stop: false,
        other_axis: false,
        drive_fault: false,
        drive_acts: true,
        requested: RequestedMode::Off,
        acknowledge: false,
    };
    supervisor.step(&input);
    input.requested = RequestedMode::Active;
    let output = (0..2000).map(|_| supervisor.step(&input)).last().expect("samples");
    assert_eq!((output.state, output.command), (SupervisorState::Active, 1.0));
    input.sensed[0] = f32::NAN;
    let stop = limits().stop;
    let ended = (0..stop).map(|_| supervisor.step(&input)).last().expect("samples");
    assert_eq!((ended.state, ended.command, ended.enable), (SupervisorState::Tripped, 0.0, false));
}

#[test]
fn the_table_is_whole() {
    let all = Function::ALL.iter().fold(Functions::NONE, |set, &function| set.with(function, true));
    assert_eq!(all.bits().count_ones() as usize, Function::ALL.len());
    let stays = |f: Function| all.stopping().has(f) || f == Function::Swing;
    assert!(Function::ALL.iter().all(|&f| f.latched() == stays(f) && f.sentence().ends_with('.')));
    assert_eq!(all.that(Action::Cut).first(), Some(Function::EmergencyStop));
}

#[test]
fn the_guide_has_the_table() {
    let guide = include_str!("../../../../docs/how-to/safety.md");
    for function in Function::ALL {
        let action = ["cut", "stop", "fade", "limit"][function.action() as usize];
        let (name, samples) = (function.name(), function.samples(&limits()));
        let row = format!("| {name} | {action} | {samples} |");
        assert!(guide.contains(&row), "docs/how-to/safety.md lacks: {row}");
    }
}

#[test]
fn a_column_that_pushes_against_the_hand_otherwise_than_its_feel_is_stopped_by_the_energy() {
    let of = limits();
    for (feel_rate, stops) in [(0.0, true), (-1.0, false)] {
        let (mut supervisor, input) = active();
        let mut stopped = None;
        // A hand of 200 N holds against a drive that pushes the column back at 1 rad/s, without acceleration.
        let force = 200.0 * of.grip_arm / of.lever;
        for k in 1..300 {
            let mut now = input;
            let push = force * (f64::from(k) * 0.02).min(1.0);
            let angle = -f64::from((k - 50).max(0)) * PERIOD;
            now.sensed = [-push, angle * of.lever - push * of.link[0], angle * of.base_arm, 0.0];
            now.feel_rate = if k > 50 { feel_rate } else { 0.0 };
            let allowed = supervisor.step(&now);
            if allowed.acting.has(Function::Energy) {
                stopped.get_or_insert(k);
            }
        }
        assert_eq!(stopped.is_some(), stops, "{stopped:?}");
        // 200 N at 0.8 m/s: 4 J take 25 ms; rate and torque lag by 5 ms each, and two samples confirm it.
        assert!(stopped.is_none_or(|k| k < 50 + 42), "{stopped:?}");
    }
}

#[test]
fn a_column_that_is_thrown_faster_than_its_feel_is_stopped_before_it_is_too_fast() {
    let of = limits();
    for (follows, stops) in [(0.0, true), (1.0, false)] {
        let (mut supervisor, input) = active();
        let acceleration = 60.0;
        let mut rate = 0.0;
        for k in 1..100 {
            let time = f64::from(k) * PERIOD;
            rate = acceleration * time;
            let (force, angle) = (of.inertia * acceleration / of.lever, 0.5 * rate * time);
            let mut now = SupervisorInput { feel_rate: follows * rate, ..input };
            now.sensed = [force, angle * of.lever + force * of.link[0], angle * of.base_arm, 0.0];
            if supervisor.step(&now).acting.has(Function::Energy) {
                break;
            }
        }
        // J v^2 / 2 of the lagged rate.
        let most = (2.0 * of.motion / of.inertia).sqrt() + 1.5 * acceleration / ESTIMATE_BANDWIDTH;
        assert_eq!(rate < most, stops, "{rate} and {most}");
    }
}

#[test]
fn a_column_that_swings_under_a_host_with_no_hand_on_it_goes_to_the_default_feel() {
    let of = limits();
    // The third is kept swinging by another pilot over a link.
    for (damping, share, fades) in [(0.0, 0.0, true), (0.2, 0.0, false), (0.0, 0.5, false)] {
        let (mut supervisor, input) = active();
        let (mut shares, mut told) = (vec![], false);
        let omega = 2.0 * core::f64::consts::TAU;
        for k in 0..2000_u32 {
            let time = f64::from(k) * PERIOD;
            let mut now = SupervisorInput { host: true, ..input };
            // The column under the link alone, as a spring of its own moves it.
            let angle =
                |time: f64| 0.1 * (1.0 - (-4.0 * time).exp()) * (-damping * omega * time).exp() * (omega * time).sin();
            let acceleration = (angle(time + PERIOD) - 2.0 * angle(time) + angle(time - PERIOD)) / PERIOD.powi(2);
            let force = of.inertia * acceleration / of.lever;
            now.sensed = [force, angle(time) * of.lever + force * of.link[0], angle(time) * of.base_arm, 0.0];
            now.feel_rate = (angle(time + PERIOD) - angle(time)) / PERIOD;
            now.link_torque = share * force * of.lever;
            let allowed = supervisor.step(&now);
            assert_eq!(allowed.state, SupervisorState::Active, "{:?}", allowed.cause);
            told |= allowed.acting.has(Function::Swing);
            shares.push(allowed.host_share);
        }
        assert_eq!((told, shares.last() == Some(&0.0)), (fades, fades));
        let now = SupervisorInput { host: true, ..input };
        assert_eq!(supervisor.step(&now).tripped.has(Function::Swing), fades, "it stays");
        supervisor.step(&SupervisorInput { acknowledge: true, ..now });
        let back = (0..600).map(|_| supervisor.step(&now)).last().expect("samples");
        assert!(!back.tripped.has(Function::Swing));
        assert!(back.host_share >= 1.0);
    }
}

/// A loader with a force sensor at the grip, untouched but for `touch`: its zero after so many samples, and what acted.
fn grip_zero_after(samples: u32, offset: f64, touch: impl Fn(u32, &mut SupervisorInput<f64>)) -> (f64, Functions) {
    let mut p = Parameters::elevator();
    (p.grip_sensor.gain, p.grip_sensor.noise, p.safety.grip_zero_time) = (1.0, 0.1, 1.0);
    let of = Limits::new(&p, DriveKind::Hydraulic, PERIOD).expect("limits");
    let (mut supervisor, input) = active_under(&of);
    let mut acted = Functions::NONE;
    let mut zero = 0.0;
    for k in 0..samples {
        let mut now = input;
        now.sensed[3] = offset + 0.2 * f64::from(k % 3) - 0.2;
        touch(k, &mut now);
        let readings = supervisor.admit(&now).expect("readings");
        assert!((readings[3] - (now.sensed[3] - zero)).abs() < 1e-12, "the law is given what is left");
        let allowed = supervisor.step(&now);
        (zero, acted) = (allowed.grip_zero, acted.and(allowed.acting));
    }
    (zero, acted)
}

#[test]
fn an_untouched_sensor_at_the_grip_is_zeroed_and_a_hand_is_not_zeroed_away() {
    let (zero, acted) = grip_zero_after(3000, 4.0, |_, _| ());
    assert!((zero - 4.0).abs() < 1e-3, "{zero}");
    assert!(acted.is_empty());
    // Before its time it is not; then no faster than a hand notices.
    assert!(grip_zero_after(999, 4.0, |_, _| ()).0 == 0.0);
    let of = limits();
    let step = of.hand_torque / of.grip_arm * PERIOD;
    assert!(grip_zero_after(1100, 4.0, |_, _| ()).0 <= 101.0 * step);
    // A hand that the load cell shows, or that is not as still as the sensor's noise.
    let pull = 4.0 * of.grip_arm / of.lever;
    assert!(grip_zero_after(3000, 4.0, |_, now| now.sensed[0] = -pull).0 == 0.0);
    assert!(grip_zero_after(3000, 4.0, |k, now| now.sensed[3] += 1.5 * (f64::from(k) * 0.01).sin()).0 == 0.0);
}

#[test]
fn an_offset_at_the_grip_beyond_its_limit_stops_the_loader() {
    let (zero, acted) = grip_zero_after(12_000, 30.0, |_, _| ());
    assert!(acted.has(Function::GripOffset));
    let most = Parameters::elevator().safety.grip_offset;
    assert!(zero <= most + 1e-9, "{zero}");
    assert!(!grip_zero_after(12_000, 20.0, |_, _| ()).1.has(Function::GripOffset));
}

/// Whether a sensor at the grip is found to be stuck, on which a hand of 20 N rests from sample 100 on, seen by the load cell, until it lets
/// go; with an end stop so far to either side.
fn grip_is_stuck(
    samples: u32,
    stop: f64,
    lets_go: u32,
    touch: impl Fn(u32, &Limits, &mut SupervisorInput<f64>),
) -> bool {
    let mut p = Parameters::elevator();
    (p.grip_sensor.gain, p.grip_sensor.noise) = (1.0, 0.1);
    (p.column.stop_low, p.column.stop_high) = (-stop, stop);
    let of = Limits::new(&p, DriveKind::Hydraulic, PERIOD).expect("limits");
    let (mut supervisor, input) = active_under(&of);
    (0..samples).any(|k| {
        let mut now = input;
        // No sensor of the link shows the same number twice.
        now.sensed = now.sensed.map(|shown| shown + 1e-9 * f64::from(k % 2));
        if (100..lets_go).contains(&k) {
            now.sensed[3] = 20.0;
            now.sensed[0] -= 20.0 * of.grip_arm / of.lever;
        }
        touch(k, &of, &mut now);
        supervisor.step(&now).acting.has(Function::Stuck)
    })
}

#[test]
fn a_spike_as_a_grip_sensor_comes_to_rest_is_not_taken_for_the_hand() {
    let of = limits();
    for at in 101..2 * of.grip_stuck + 200 {
        let spiked = |k: u32, of: &Limits, now: &mut SupervisorInput<f64>| {
            now.sensed[2] += if k == at { 0.9 * of.plausible[2] * of.base_arm } else { 0.0 };
        };
        assert!(!grip_is_stuck(3 * of.grip_stuck + 500, 0.1, u32::MAX, spiked), "spike at {at}");
    }
}

#[test]
fn a_stuck_grip_sensor_is_found_after_its_column_has_met_a_stop() {
    let of = limits();
    let meets = 1000 + of.grip_stuck / 2;
    let stuck = |k: u32, of: &Limits, now: &mut SupervisorInput<f64>| {
        now.sensed[3] = if k < 100 { 0.0 } else { 20.0 };
        now.sensed[2] += if (meets..meets + 5).contains(&k) { 1.1e-3 * of.base_arm } else { 0.0 };
    };
    let samples = meets + 2 * of.grip_stuck + 100;
    assert!(grip_is_stuck(samples, 1e-3, 1000, stuck), "the hand has let go");
    assert!(!grip_is_stuck(samples, 1e-3, u32::MAX, stuck), "the hand is still there");
}
