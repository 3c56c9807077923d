//! A period of the digital loop as a function of its state: against the run, step by step, and its slopes.

use crate::draws::Draws;
use crate::near::{assert_near, assert_within};
use forcefeel_model::Scalar;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::controller::{MOST_UNDER_WAY, Timing};
use forcefeel_model::dual::Dual;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::period::{BASE, Drives, PERIOD_STATES, Period, YOUNGEST};
use forcefeel_model::machine::{Inputs, Machine, Shared};
use forcefeel_model::observer::{NUMBERS, Observer};
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::SENSORS;

const STEP: f64 = 2.5e-4;
const GAINS: [f64; 7] = [-194.0, -3.8e-9, 22.0, 0.67, 19.9, -0.7, -1.5e-3];

/// Places of `delta`, `delta'` and the command held among the numbers of a period.
const DELTA: usize = 5;
const DELTA_RATE: usize = 6;
const HELD: usize = 7;

/// A share of what each number of the state is at most in a run: meters, m³/s, m³/s², m, m/s; rad, rad/s; V; V; m; Pa; Pa; what is
/// sensed, N, m, m, N, twice; the observer's own.
const SIZES: [f64; PERIOD_STATES] = {
    let plant = [1e-2, 1e-4, 1e-2, 1e-2, 0.1];
    let sensed = [1e3, 1e-2, 1e-2, 1e3];
    let mut sizes = [1.0; PERIOD_STATES];
    let mut k = 0;
    while k < 5 {
        sizes[k] = plant[k];
        k += 1;
    }
    (sizes[DELTA], sizes[DELTA_RATE]) = (0.1, 1.0);
    let memory = YOUNGEST + MOST_UNDER_WAY - 1;
    (sizes[memory], sizes[memory + 1], sizes[memory + 2]) = (1e-2, 1e6, 1e4);
    k = 0;
    while k < 2 * SENSORS {
        sizes[memory + 3 + k] = sensed[k % SENSORS];
        k += 1;
    }
    sizes
};

/// Delays of none to the longest in periods of one to four steps.
const TIMINGS: [Timing; 9] = [
    Timing { period: 1, delay: 0 },
    Timing { period: 1, delay: 7 },
    Timing { period: 2, delay: 0 },
    Timing { period: 2, delay: 1 },
    Timing { period: 2, delay: 2 },
    Timing { period: 2, delay: 4 },
    Timing { period: 4, delay: 3 },
    Timing { period: 4, delay: 9 },
    Timing { period: 4, delay: 31 },
];

/// The elevator loader with sensors that lag and, where wanted, with all that bends without a kink.
fn loader(bent: bool) -> Parameters<f64> {
    let mut p = Parameters::elevator();
    (p.load_cell.bandwidth, p.potentiometer.bandwidth, p.column_sensor.bandwidth) = (3000.0, 2000.0, 1000.0);
    (p.grip_sensor.gain, p.grip_sensor.mass, p.grip_sensor.bandwidth) = (0.9, 0.4, 1500.0);
    if bent {
        p.valve.orifice = 1.0;
        (p.column.gravity_torque, p.column.viscous_friction) = (10.0, 1.0);
        (p.feel.quadratic_damping, p.amplifier.current_limit) = (5.0, 15e-3);
        p.controller.antiwindup = 100.0;
    }
    p
}

/// An observer's numbers: each a share of what makes its product one of the size of what it is for.
fn random_law(draws: &mut Draws) -> [f64; NUMBERS] {
    let signals = [1e3, 1e-2, 0.1, 1e3, 1.0];
    let known = |k: usize| if k < 9 { 1.0 } else { [1e3, 1e-2, 0.1, 1e3, 0.1, 1.0][k - 9] };
    core::array::from_fn(|k| match k {
        0..81 => 0.1 * draws.uniform(),
        81..126 => 0.1 * draws.uniform() / signals[(k - 81) % 5],
        126..141 => 0.1 * draws.uniform() / known(k - 126),
        141..156 => 10.0 * draws.uniform() / known(k - 141),
        _ => 0.0,
    })
}

/// A loader under its digital controller.
struct Loop {
    parameters: Parameters<f64>,
    observer: Option<[f64; NUMBERS]>,
    shared: Shared,
    timing: Timing,
}

impl Loop {
    fn new(parameters: &Parameters<f64>, observer: Option<&[f64; NUMBERS]>, timing: Timing) -> Self {
        let effects = Effects { sampled: true, observer: observer.is_some(), ..Effects::of(&parameters.values()) };
        let shared =
            Shared { effects: effects.smooth(), step_s: STEP, timing: Some(timing), curve: None, cancellation: None };
        Self { parameters: *parameters, observer: observer.copied(), shared, timing }
    }

    /// With gains and with an observer, for each timing.
    fn all(parameters: &Parameters<f64>) -> impl Iterator<Item = Self> {
        let law = random_law(&mut Draws::new(11));
        TIMINGS.into_iter().flat_map(move |timing| [None, Some(&law)].map(|law| Self::new(parameters, law, timing)))
    }

    fn machine<S: Scalar>(&self, like: S) -> Machine<S> {
        let parameters = self.parameters.map(|value| like.constant(value));
        let law = Compensator::state_feedback(&parameters, GAINS.map(|gain| like.constant(gain)));
        let machine = Machine::new(&parameters, law, &self.shared);
        match self.observer {
            None => machine,
            Some(law) => machine.with_observer(Observer::from_numbers(&law.map(|number| like.constant(number)))),
        }
    }

    /// The next state under a pilot's force and a signal on the command.
    fn next<S: Scalar>(&self, numbers: &[S; PERIOD_STATES], force: S, command_signal: S) -> [S; PERIOD_STATES] {
        self.driven(numbers, &Drives { command_signal, force, force_before: force, test_signal: (force.zero(), 0) })
    }

    fn driven<S: Scalar>(&self, numbers: &[S; PERIOD_STATES], drives: &Drives<S>) -> [S; PERIOD_STATES] {
        let machine = self.machine(drives.force);
        Period { machine: &machine, shared: &self.shared, timing: self.timing }.next(numbers, drives).1
    }

    /// Slopes of the next state at zero along one of its numbers, the pilot's force or the command signal.
    fn slopes(&self, along: Along) -> [f64; PERIOD_STATES] {
        let one = |is: bool| if is { Dual::variable(0.0) } else { Dual::constant(0.0) };
        let state = core::array::from_fn(|k| one(along == Along::State(k)));
        self.next(&state, one(along == Along::Force), one(along == Along::CommandSignal)).map(|number| number.slope)
    }

    /// The next state from zero but for so much along one direction.
    fn moved(&self, along: Along, by: f64) -> [f64; PERIOD_STATES] {
        let one = |is: bool| if is { by } else { 0.0 };
        let state = core::array::from_fn(|k| one(along == Along::State(k)));
        self.next(&state, one(along == Along::Force), one(along == Along::CommandSignal))
    }
}

/// What a period depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Along {
    State(usize),
    Force,
    CommandSignal,
}

impl Along {
    fn all() -> impl Iterator<Item = Self> {
        (0..PERIOD_STATES).map(Self::State).chain([Self::Force, Self::CommandSignal])
    }

    fn size(self) -> f64 {
        match self {
            Self::State(k) => SIZES[k],
            Self::Force => 100.0,
            Self::CommandSignal => 1.0,
        }
    }
}

/// A state of the size that a run goes through.
fn random_state(draws: &mut Draws) -> [f64; PERIOD_STATES] {
    SIZES.map(|size| size * draws.uniform())
}

#[test]
fn periods_one_after_the_other_are_the_run_bit_for_bit() {
    for bent in [false, true] {
        for one in Loop::all(&loader(bent)) {
            let (machine, shared, timing) = (one.machine(1.0), &one.shared, one.timing);
            let equilibrium = machine.held_at(shared, 0.0, 0.0, 1.0);
            let (mut state, mut memory) = (machine.start(shared, &equilibrium), machine.remember(shared, &equilibrium));
            let (mut numbers, mut force_before) = ([0.0; PERIOD_STATES], 0.0);
            for period in 0..40 {
                // A push, then a pull.
                let force = if period < 20 { 150.0 } else { -220.0 };
                let inputs = Inputs { force: [force; 2], ..Inputs::NONE };
                for step in 0..timing.period {
                    let step_start = machine.begin(shared, &mut state, &mut memory, &inputs, &mut || [0.0; SENSORS]);
                    if step == 0 {
                        let now = [step_start.now.base, step_start.now.delta, step_start.now.delta_rate];
                        let carried = [numbers[BASE], numbers[DELTA], numbers[DELTA_RATE]];
                        assert_eq!(now.map(f64::to_bits), carried.map(f64::to_bits), "{timing:?}, period {period}");
                    }
                    machine.advance(shared, &mut state, &inputs, &step_start);
                }
                let drives = Drives { command_signal: 0.0, force, force_before, test_signal: (0.0, 0) };
                numbers = one.driven(&numbers, &drives);
                force_before = force;
            }
            assert!(numbers[BASE] != 0.0 && numbers[DELTA] != 0.0, "it moves");
        }
    }
}

#[test]
fn period_of_a_linear_loader_is_linear() {
    let mut draws = Draws::new(12);
    for one in Loop::all(&loader(false)) {
        let (a, b) = (random_state(&mut draws), random_state(&mut draws));
        let sum = core::array::from_fn(|k| 2.0 * a[k] - 3.0 * b[k]);
        let [of_a, of_b, of_sum] =
            [(&a, 40.0, 0.1), (&b, -70.0, -0.2), (&sum, 290.0, 0.8)].map(|(x, f, e)| one.next(x, f, e));
        for k in 0..PERIOD_STATES {
            let size = SIZES[k].max(of_a[k].abs()).max(of_b[k].abs());
            assert_within(of_sum[k], 2.0 * of_a[k] - 3.0 * of_b[k], 1e-11 * size); // some hundred roundings of what cancels
        }
    }
}

#[test]
fn slopes_are_the_differences_of_periods() {
    for bent in [false, true] {
        for one in Loop::all(&loader(bent)) {
            for along in Along::all() {
                let by = 1e-4 * along.size();
                let (slopes, up, down) = (one.slopes(along), one.moved(along, by), one.moved(along, -by));
                let difference = |k: usize| (up[k] - down[k]) / (2.0 * by);
                for k in 0..PERIOD_STATES {
                    assert!(slopes[k].is_finite(), "{along:?} to {k}");
                    // Per what moves it; of the second order in the share moved, of the first where an orifice has its corner.
                    let size = slopes[k].abs().max(SIZES[k] / along.size());
                    assert_within(difference(k), slopes[k], 1e-5 * size);
                }
            }
        }
    }
}

#[test]
fn command_signal_is_the_difference_that_it_makes() {
    let mut draws = Draws::new(13);
    for one in Loop::all(&loader(false)) {
        let (x, slopes) = (random_state(&mut draws), one.slopes(Along::CommandSignal));
        let (with, without) = (one.next(&x, 30.0, 1.0), one.next(&x, 30.0, 0.0));
        for k in 0..PERIOD_STATES {
            let size = with[k].abs().max(without[k].abs());
            assert_within(with[k] - without[k], slopes[k], 1e-13 * size + 1e-12 * slopes[k].abs()); // a difference
        }
    }
}

#[test]
fn command_signal_sets_out_with_the_command_and_arrives_with_it() {
    for one in Loop::all(&loader(true)) {
        let Timing { period, delay } = one.timing;
        let mut expected = one.slopes(Along::CommandSignal);
        assert_near(expected[YOUNGEST], 1.0, 0.0);
        assert_near(expected[HELD], if delay < period { 1.0 } else { 0.0 }, 0.0);
        // The controller learns nothing of it, and what is a period away moves nothing yet.
        (expected[YOUNGEST], expected[HELD]) = (0.0, 0.0);
        let moved = expected.iter().any(|&slope| slope != 0.0);
        assert_eq!(moved, delay < period, "{:?}", one.timing);
    }
}

#[test]
fn test_signal_at_the_amplifier_is_the_command_held_and_nobody_s_sample() {
    // All through a period it moves what a command held that much higher would move; the controller learns nothing of it.
    for one in Loop::all(&loader(false)) {
        let Timing { period, delay } = one.timing;
        let still = [Dual::constant(0.0); PERIOD_STATES];
        let none = Dual::constant(0.0);
        let by_step = |step: usize| {
            let drives = Drives {
                command_signal: none,
                force: none,
                force_before: none,
                test_signal: (Dual::variable(0.0), step),
            };
            one.driven(&still, &drives).map(|number| number.slope)
        };
        let mut sum = [0.0; PERIOD_STATES];
        for step in 0..period {
            let moved = by_step(step);
            assert_near(moved[HELD], 0.0, 0.0);
            sum.iter_mut().zip(moved).for_each(|(sum, by)| *sum += by);
        }
        let held = one.slopes(Along::State(HELD));
        let arriving = match delay / period {
            0 => one.slopes(Along::CommandSignal),
            age => one.slopes(Along::State(YOUNGEST + age - 1)),
        };
        for k in (0..PERIOD_STATES).filter(|k| !(HELD..YOUNGEST + MOST_UNDER_WAY - 1).contains(k)) {
            let expected = held[k] + arriving[k];
            assert_within(sum[k], expected, 1e-9 * expected.abs().max(1e-12 * SIZES[k]));
        }
    }
}

#[test]
fn commands_under_way_grow_older_by_a_period() {
    let mut draws = Draws::new(14);
    for one in Loop::all(&loader(true)) {
        let Timing { period, delay } = one.timing;
        let x = random_state(&mut draws);
        let next = one.next(&x, 10.0, 0.0);
        let under_way = YOUNGEST..YOUNGEST + MOST_UNDER_WAY - 1;
        for age in under_way.skip(1) {
            assert_near(next[age], x[age - 1], 0.0);
        }
        // Held is what arrived last: the command of this period, or one that was under way.
        let periods = delay / period;
        let held = if periods == 0 { next[YOUNGEST] } else { x[YOUNGEST + periods - 1] };
        assert_near(next[HELD], held, 0.0);
    }
}
