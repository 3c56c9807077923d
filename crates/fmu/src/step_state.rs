//! A step of each kind of FMU, and what is seen of it: on numbers, or on dual numbers for derivatives.

use crate::feel::{Feel, Programmed, count};
use crate::resources::Resources;
use crate::variables::{Kind, MOST_OUTPUTS, shown};
use forcefeel_model::Scalar;
use forcefeel_model::control::{Control, FeelState, LawState, Sample};
use forcefeel_model::controller::{CommandDelay, Timing};
use forcefeel_model::drive::Drive;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Equilibrium, Inputs, Machine, Memory, Shared, State, StepStart};
use forcefeel_model::observer::Observer;
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters};
use forcefeel_model::surface::FlightState;
use forcefeel_model::transducers::SENSORS;
use forcefeel_solve::outputs::Output;
use forcefeel_solve::sensor_noise::SensorNoise;
use forcefeel_solve::smooth::without_steps;
use forcefeel_solve::start::Start;
use serde::{Deserialize, Serialize};

/// What an importer gives for a step, with the slopes along which a derivative is wanted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Given<S> {
    pub pilot_force: f64,
    /// Zero, with the slope of the pilot's force.
    pub force_slope: S,
    pub command: S,
    pub sensed: [S; SENSORS],
    pub trim: f64,
    pub stiffness_factor: f64,
    pub shaker: f64,
    /// Of no effect on a loader without a surface.
    pub flight: FlightState,
}

/// A loader's numbers, worked out: what does not change from step to step but with the feel.
#[derive(Debug, Clone)]
pub(crate) struct StepConstants<S: Scalar, D: Drive<S>> {
    kind: Kind,
    parameters: Parameters<S>,
    timing: Timing,
    machine: Machine<S, D>,
    shared: Shared,
    shown: Vec<Output>,
    shaker_frequency: f64,
    /// The loader whose surface a flight acts on.
    in_flight: Option<Parameters<f64>>,
}

/// What changes from step to step.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(bound(
    serialize = "S: Serialize, S::Mask: Serialize, D::Memory: Serialize",
    deserialize = "S: Deserialize<'de>, S::Mask: Deserialize<'de>, D::Memory: Deserialize<'de>"
))]
pub(crate) struct StepState<S: Scalar, D: Drive<S>> {
    /// Loader and machine: the machine, with law and feel of a loader.
    state: State<S, D>,
    memory: Memory<S>,
    /// Machine: commands on their way.
    under_way: CommandDelay<S>,
    /// Law: feel, and what the law remembers.
    feeling: FeelState<S>,
    remembered: LawState<S>,
    /// Force of a hand that holds the column in N, and the step at which it lets go.
    hand: f64,
    held_until: usize,
    /// Machine: what the sensors showed at the last sample. Law: its last command, and the torque of it.
    sensed: [S; SENSORS],
    command: S,
    torque: S,
    noise: SensorNoise,
    step: usize,
}

impl<S: Scalar + Into<f64>, D: Drive<S>> StepConstants<S, D> {
    /// The loader with these values under the feel and the law of now, `like` a number of its kind.
    pub fn new(resources: &Resources, values: &[f64; COUNT], feel: &Feel, like: S) -> Self {
        let setup = &resources.setup;
        let all = Parameters::from_values(&values.map(|value| like.constant(value)));
        // A staircase has no slope.
        let all = if S::HAS_SLOPE { without_steps(all) } else { all };
        let parameters = with_feel(&all, &feel.now, like);
        let shared = setup.shared();
        // Any of the feel's rows may come while it runs; what is off changes nothing.
        let of_feel =
            Effects { feel_friction: true, feel_spring: true, feel_damping_and_stops: true, ..Effects::default() };
        let effects = Effects { test_signal: false, ..Effects::of(values) };
        let own = Effects {
            feedback: shared.effects.feedback,
            observer: shared.effects.observer,
            known_friction: shared.effects.known_friction,
            contact_law: shared.effects.contact_law,
            ..effects
        };
        let shared = Shared { effects: own.or(of_feel), ..shared };
        let law = setup.law().compensator(&parameters, |of| like.constant(of(0)));
        let machine = Machine::new(&parameters, law, &shared).with_observer(observer(resources, &feel.now, like));
        let shown = shown(resources.kind, DriveKind::of(values));
        let mut constants = Self {
            kind: resources.kind,
            parameters: all,
            timing: setup.timing,
            machine,
            shared,
            shown,
            shaker_frequency: Parameters::from_values(values).feel.shaker_frequency,
            in_flight: Some(Parameters::from_values(values)).filter(|of| of.surface.is_there()),
        };
        if let Some(change) = &feel.change {
            constants.fade_to(resources, &change.to, like);
        }
        constants
    }

    /// Some steps, with the changes of the feel that begin and end in them; one takes `change_steps`.
    pub fn go(
        &mut self,
        resources: &Resources,
        (step_state, feel): (&mut StepState<S, D>, &mut Feel),
        given: &Given<S>,
        (steps, change_steps): (usize, usize),
    ) {
        for _ in 0..steps {
            if let Some(to) = feel.begin(step_state.step, change_steps) {
                self.fade_to(resources, to, given.command);
            }
            self.step(step_state, feel, given);
            if feel.end(step_state.step) {
                self.machine.faded(&self.shared, &mut step_state.state);
            }
        }
    }

    /// Begins a change of the feel.
    fn fade_to(&mut self, resources: &Resources, to: &Programmed, like: S) {
        self.machine.fade_to(&with_feel(&self.parameters, to, like), Some(&observer(resources, to, like)));
    }

    /// What the inputs are in a step, the feel's fade and the hinge moment where the control stands included.
    fn inputs(&self, given: &Given<S>, feel: &Feel, step_state: &StepState<S, D>) -> Inputs {
        let step = step_state.step;
        let swing = |step: usize| {
            if given.shaker == 0.0 {
                return 0.0;
            }
            let turns = self.shaker_frequency / core::f64::consts::TAU * count(step) * self.shared.step_s;
            given.shaker * Scalar::sin(turns.fract() * core::f64::consts::TAU)
        };
        let inputs = Inputs {
            force: [given.pilot_force; 2],
            trim: [given.trim; 2],
            stiffness_factor: [given.stiffness_factor; 2],
            shaker: [swing(step), swing(step + 1)],
            fade: [feel.fade(step), feel.fade(step + 1)],
            ..Inputs::NONE
        };
        // The moment's slope over the angle is in the spring: a derivative needs none of the angle's own.
        let angle = match self.kind {
            Kind::Law => step_state.feeling.motion.at[0] * self.machine.control().per_delta(),
            _ => self.machine.programmed_motion(&step_state.state)[0],
        };
        self.in_flight.as_ref().map_or(inputs, |of| of.in_flight(&inputs, &[given.flight; 2], angle.into()))
    }

    /// The hand that holds the column, with the slope of the pilot's force.
    fn hold(step_state: &mut StepState<S, D>, given: &Given<S>) {
        if !S::HAS_SLOPE {
            return;
        }
        let like = given.command;
        let hand = if step_state.step < step_state.held_until { step_state.hand } else { 0.0 };
        // A slope of the force is that of a hand that follows it.
        let force = like.constant(hand) + given.force_slope;
        let mut numbers = Equilibrium::from_numbers(&[like.zero(); forcefeel_model::machine::EQUILIBRIUM_NUMBERS]);
        numbers.pilot_force = force;
        Machine::<S, D>::hold(&mut step_state.state, &numbers);
    }

    /// The start of a step up to what is seen.
    fn begin(&self, step_state: &mut StepState<S, D>, inputs: &Inputs, given: &Given<S>) -> StepStart<S, D> {
        let StepState { state, memory, noise, .. } = step_state;
        let like = given.command;
        let mut normal = || noise.sample().map(|number| like.constant(number));
        // Not `begin` for one kind and its parts for the other: two starts of a step would be compiled into this function.
        let arrived = self.machine.arrive(&self.shared, state, inputs);
        if self.kind == Kind::Loader {
            if let Some(timing) = self.shared.timing {
                self.machine.act(&self.shared, timing, (state, memory), inputs, &arrived.now, &mut normal);
            }
        } else {
            if let Some(sample) = self.timing.sample_at(step_state.step) {
                step_state.sensed = self.machine.sampled(&self.shared, state, &mut normal);
                step_state.under_way.send(sample, given.command + given.command.zero());
            }
            if let Some(sample) = self.timing.arriving_at(step_state.step) {
                state.command(step_state.under_way.arriving(sample));
            }
        }
        self.machine.set_out(&self.shared, state, inputs, arrived)
    }

    /// A step.
    fn step(&self, step_state: &mut StepState<S, D>, feel: &Feel, given: &Given<S>) {
        let inputs = self.inputs(given, feel, step_state);
        if self.kind == Kind::Law {
            self.act(step_state, &inputs, given);
        } else {
            Self::hold(step_state, given);
            let step_start = self.begin(step_state, &inputs, given);
            self.machine.advance(&self.shared, &mut step_state.state, &inputs, &step_start);
        }
        step_state.step += stride(self.kind, self.timing);
        if step_state.step == step_state.held_until {
            Machine::<S, D>::let_go(&mut step_state.state);
        }
    }

    /// A period of the law alone.
    fn act(&self, step_state: &mut StepState<S, D>, inputs: &Inputs, given: &Given<S>) {
        let StepState { feeling, remembered, .. } = step_state;
        let answer = act(self.machine.control(), &self.shared, (feeling, remembered), inputs, given);
        [step_state.command, step_state.torque] = answer;
    }

    /// What is seen at the start of the step that comes next, under what is given.
    pub fn look(&self, step_state: &StepState<S, D>, feel: &Feel, given: &Given<S>) -> [S; MOST_OUTPUTS] {
        let mut outputs = [given.command.zero(); MOST_OUTPUTS];
        let mut next = 0;
        let mut put = |value: S| {
            outputs[next.min(MOST_OUTPUTS - 1)] = value;
            next += 1;
        };
        if self.kind == Kind::Law {
            let [delta, rate] = step_state.feeling.motion.at;
            [delta, rate, step_state.command, step_state.torque].into_iter().for_each(put);
            return outputs;
        }
        let mut step_state = step_state.clone();
        let inputs = self.inputs(given, feel, &step_state);
        Self::hold(&mut step_state, given);
        let step_start = self.begin(&mut step_state, &inputs, given);
        self.shown.iter().for_each(|output| put(output.of(&step_start.now, self.machine.per_base())));
        if self.kind == Kind::Machine {
            step_state.sensed.into_iter().for_each(put);
        }
        outputs
    }
}

impl<D: Drive<f64>> StepConstants<f64, D> {
    /// Where a run begins.
    pub fn start(&self, start: Start, seed: u64, given: &Given<f64>) -> StepState<f64, D> {
        let inputs = Inputs { trim: [given.trim; 2], stiffness_factor: [given.stiffness_factor; 2], ..Inputs::NONE };
        let beginning = start.of(&self.machine, &self.shared, &[inputs]);
        let equilibrium = &beginning.equilibrium;
        let mut state = self.machine.start(&self.shared, equilibrium);
        let memory = self.machine.remember(&self.shared, equilibrium);
        let feeling = state.feeling();
        Machine::<f64, D>::hold(&mut state, equilibrium);
        if beginning.held_until == 0 {
            Machine::<f64, D>::let_go(&mut state);
        }
        StepState {
            state,
            under_way: CommandDelay::holding(equilibrium.command()),
            feeling,
            remembered: *memory.control(),
            memory,
            hand: equilibrium.pilot_force,
            held_until: beginning.held_until,
            sensed: self.machine.shown_at_rest(&self.shared.effects, equilibrium),
            command: equilibrium.command(),
            torque: 0.0,
            // As the first run of a simulation has it.
            noise: SensorNoise::new(seed, 0),
            step: 0,
        }
    }
}

impl<S: Scalar, D: Drive<S>> StepState<S, D> {
    /// Steps since the start.
    pub fn steps(&self) -> usize {
        self.step
    }
}

/// Command and torque of a period of the law alone. Not of a machine, so that it is compiled once for both drives.
#[inline(never)]
fn act<S: Scalar>(
    control: &Control<S>,
    shared: &Shared,
    law: (&mut FeelState<S>, &mut LawState<S>),
    inputs: &Inputs,
    given: &Given<S>,
) -> [S; 2] {
    let zero = given.command.zero();
    let sample = Sample { sensors: given.sensed, pilot_force: zero };
    let [command, torque] = control.command_and_torque(shared, law, inputs, &sample);
    // What the drive answers, and a rounding beyond: so the amplifier comes to its own limit to the bit.
    let most = control.within_range(zero.constant(f64::INFINITY)).times(1.0 + f64::EPSILON);
    [command.within(most), torque]
}

/// Steps of the machine in one of the FMU: the law alone goes from sample to sample.
pub(crate) fn stride(kind: Kind, timing: Timing) -> usize {
    if kind == Kind::Law { timing.period } else { 1 }
}

fn with_feel<S: Scalar>(all: &Parameters<S>, programmed: &Programmed, like: S) -> Parameters<S> {
    let values: Option<[f64; COUNT]> = programmed.values.as_slice().try_into().ok();
    values.map_or(*all, |values| {
        let programmed = Parameters::from_values(&values.map(|value| like.constant(value)));
        Parameters { feel: programmed.feel, ..*all }
    })
}

fn observer<S: Scalar>(resources: &Resources, programmed: &Programmed, like: S) -> Observer<S> {
    let setting = resources.settings.get(programmed.setting).or(resources.settings.first());
    setting.map_or(Observer::none(like), |setting| {
        Observer::from_numbers(&setting.observer.map(|number| like.constant(number)))
    })
}
