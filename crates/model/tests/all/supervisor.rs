//! The supervisor's functions, states and limits, a sample at a time.

use forcefeel_model::parameters::{DriveKind, Parameters};
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
        late: 0,
        host_age: None,
        command: 0.0,
        feel_acceleration: 0.0,
        emergency_stop: false,
        drive_fault: false,
        requested,
        acknowledge: false,
    }
}

/// A loader that is active, and a sample to go on with.
fn active() -> (Supervisor<f64>, SupervisorInput<f64>) {
    let mut supervisor = Supervisor::new(limits(), 0.0);
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
    let agree = of.agreement_m;
    let speed = of.speed_step * 1.01;
    let cases: [(Function, Spoil); 11] = [
        (Function::EmergencyStop, Box::new(|_, input| input.emergency_stop = true)),
        (Function::DriveFault, Box::new(|_, input| input.drive_fault = true)),
        (Function::NotANumber, Box::new(|_, input| input.sensed[1] = f64::NAN)),
        (Function::NotANumber, Box::new(|_, input| input.command = f64::INFINITY)),
        (Function::OutOfRange, Box::new(move |_, input| input.sensed[0] = -of.range[0] * 1.01)),
        (Function::Jump, Box::new(move |_, input| input.sensed[2] = of.jump[2] * base * 1.01)),
        (Function::Silence, Box::new(|k, input| input.missed = k)),
        (Function::Overrun, Box::new(|k, input| input.late = k)),
        // None of them stays at a number, or it would be taken for stuck.
        (
            Function::Disagreement,
            Box::new(move |k, input| {
                let tremor = f64::from(k) * 1e-9;
                input.sensed = [tremor, 1.5 * agree + tremor, tremor, 0.0];
            }),
        ),
        (Function::Force, Box::new(move |_, input| held(&of, of.force_limit * grip * 1.01, input))),
        (Function::Speed, Box::new(move |k, input| moved(&of, f64::from(k) * speed, input))),
    ];
    for (function, spoil) in cases {
        let (mut supervisor, input) = active();
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
    for k in 1..400 {
        input.sensed[2] = f64::from(k) * 1e-4;
        let allowed = supervisor.step(&input);
        if allowed.state == SupervisorState::Tripped {
            assert_eq!(allowed.cause, Some(Function::Stuck));
            return;
        }
    }
    panic!("the position stays at zero and nobody minds");
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
fn a_silent_host_fades_and_comes_back_without_a_stop() {
    let (mut supervisor, mut input) = active();
    let of = *supervisor.limits();
    let mut shares = vec![];
    for age in 0..of.host + 600 {
        input.host_age = Some(age);
        shares.push(supervisor.step(&input).host_share);
    }
    assert!(shares[..of.host as usize].iter().all(|&share| share >= 1.0));
    assert_eq!(shares.last(), Some(&0.0));
    assert!(shares.windows(2).all(|pair| pair[0] - pair[1] <= of.host_step * 1.001));
    input.host_age = Some(0);
    let back = (0..600).map(|_| supervisor.step(&input)).last().expect("samples");
    assert_eq!((back.state, back.host_share), (SupervisorState::Active, 1.0));
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
            if let Some(leads) = allowed.leads {
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
        late: 0,
        host_age: None,
        command: 1.0,
        feel_acceleration: 0.0,
        emergency_stop: false,
        drive_fault: false,
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
    assert!(Function::ALL.iter().all(|&f| f.latched() == all.stopping().has(f) && f.sentence().ends_with('.')));
    assert_eq!(all.that(Action::Cut).first(), Some(Function::EmergencyStop));
}

#[test]
fn the_guide_has_the_table() {
    let guide = include_str!("../../../../docs/how-to/safety.md");
    for function in Function::ALL {
        let action = ["cut", "stop", "fade", "limit"][function.action() as usize];
        let latched = if function.latched() { "yes" } else { "no" };
        let (name, samples) = (function.name(), function.samples(&limits()));
        let row = format!("| {name} | {action} | {samples} | {latched} | {} |", function.sentence());
        assert!(guide.contains(&row), "docs/how-to/safety.md lacks: {row}");
    }
}
