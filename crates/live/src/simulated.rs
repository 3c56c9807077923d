//! The nonlinear machine in the loop's own thread, under a hand, with faults on demand.
//!
//! The machine goes on to the next sample when that is read; the command of the sample before is on its way meanwhile, with the delay of the
//! loader's controller. So a live run takes the steps of a simulation, and gives its bits.

use crate::input_output::{Command, Disturbance, Fault, InputOutput, Sampled};
use crate::setup::{Beginning, Setup};
use forcefeel_model::control::Sample;
use forcefeel_model::controller::CommandDelay;
use forcefeel_model::drive::{Drive, Kind};
use forcefeel_model::hand::Hand;
use forcefeel_model::machine::{Inputs, Machine, SamplingPoint, Shared, State, StepStart};
use forcefeel_model::transducers::SENSORS;
use forcefeel_model::with_drive;
use forcefeel_solve::sensor_noise::SensorNoise;
use forcefeel_solve::start::Start;

/// Samples that are kept, for those that come late.
const RECENT: usize = 64;

/// What is done to a simulated machine from its beginning on.
#[derive(Debug, Clone)]
pub struct Script {
    /// Where it begins.
    pub start: Start,
    /// Inputs of its first steps; after them what the last one ends with stays.
    pub inputs: Vec<Inputs>,
    /// Seed of the sensors' noise.
    pub seed: u64,
    /// Stream of that noise: the place of its axis, so that no two show the same.
    pub stream: u64,
    /// Whether a shaft acts on its column.
    pub linked: bool,
}

impl Script {
    /// At rest at neutral, nothing done.
    pub const NONE: Self = Self { start: Start::Under(0.0), inputs: vec![], seed: 0, stream: 0, linked: false };
}

/// A simulated machine, step by step: another may act on its column within each.
///
/// [`arrive`](Self::arrive), a sample where there is one, [`set_out`](Self::set_out), [`advance`](Self::advance) as often as it takes to
/// find the torque at the end of the step, [`done`](Self::done).
pub trait Stepped: InputOutput {
    /// Angle of the column.
    fn angle(&self) -> f64;
    /// Begins a step under a torque on the column, up to where a controller samples; whether one does.
    fn arrive(&mut self, torque: f64) -> bool;
    /// What the sensors show there.
    fn sample(&mut self) -> Option<Sampled>;
    /// Goes on under the command that is held by now.
    fn set_out(&mut self);
    /// Takes the step, the torque on the column ending so: angle and rate of the column. May be taken again.
    fn advance(&mut self, torque: f64) -> [f64; 2];
    /// The step is done.
    fn done(&mut self);
    /// The step in s.
    fn step_s(&self) -> f64;
}

/// The machine of a loader, and where it begins: the controller is to begin there too.
pub fn simulated(setup: &Setup, script: Script) -> (Box<dyn Stepped>, Beginning) {
    with_drive!(setup.drive(), K => begun::<K>(setup, script))
}

fn begun<K: Kind>(setup: &Setup, script: Script) -> (Box<dyn Stepped>, Beginning)
where
    Simulated<K::Of<f64>>: Stepped + 'static,
{
    let (machine, beginning) = Simulated::new(setup, setup.machine::<K>(), script);
    (Box::new(machine), beginning)
}

/// A machine that is simulated.
struct Simulated<D: Drive<f64>> {
    machine: Machine<f64, D>,
    shared: Shared,
    state: State<f64, D>,
    under_way: CommandDelay<f64>,
    script: Script,
    held_until: usize,
    noise: SensorNoise,
    hand: Hand,
    fault: Option<Fault>,
    /// What the sensors showed when a fault began.
    frozen: [f64; SENSORS],
    shown: [f64; SENSORS],
    /// Readings of the newest samples, by their number.
    recent: [[f64; SENSORS]; RECENT],
    samples: usize,
    command: f64,
    /// A step that waits for its command.
    arrived: Option<(SamplingPoint<f64, D>, Inputs)>,
    /// One that is taken, perhaps again.
    step: Option<Step<D>>,
}

/// A step that is taken, from where it began.
struct Step<D: Drive<f64>> {
    inputs: Inputs,
    start: StepStart<f64, D>,
    before: State<f64, D>,
}

impl<D: Drive<f64>> Simulated<D> {
    fn new(setup: &Setup, machine: Machine<f64, D>, script: Script) -> (Self, Beginning) {
        let mut shared = setup.shared();
        shared.effects.linked = script.linked;
        let start = script.start.of(&machine, &shared, &script.inputs);
        let equilibrium = &start.equilibrium;
        let mut state = machine.start(&shared, equilibrium);
        let feeling = state.feeling();
        let [delta, rate] = feeling.motion.at;
        let beginning = Beginning {
            sensors: machine.shown_at_rest(&shared.effects, equilibrium),
            delta,
            rate,
            neutral: feeling.neutral,
            estimate: *equilibrium.estimate(),
        };
        Machine::<f64, D>::hold(&mut state, equilibrium);
        if start.held_until == 0 {
            Machine::<f64, D>::let_go(&mut state);
        }
        let noise = SensorNoise::new(script.seed, script.stream);
        let made = Self {
            machine,
            shared,
            state,
            under_way: CommandDelay::holding(equilibrium.command()),
            script,
            held_until: start.held_until,
            noise,
            hand: Hand::of(&setup.parameters()),
            fault: None,
            frozen: beginning.sensors,
            shown: beginning.sensors,
            recent: [beginning.sensors; RECENT],
            samples: 0,
            command: equilibrium.command(),
            arrived: None,
            step: None,
        };
        (made, beginning)
    }

    fn inputs(&self) -> Inputs {
        let script = &self.script.inputs;
        let last = || script.last().map_or(Inputs::NONE, Inputs::end);
        let mut inputs = script.get(self.state.steps()).copied().unwrap_or_else(last);
        // Nothing is added where there is no hand, or the bits of a simulation would not be met.
        if self.hand.is_there() {
            inputs.force = inputs.force.map(|force| force + self.hand.force());
        }
        inputs
    }

    /// What the sensors give where something may be broken.
    fn measured(&mut self) -> Option<[f64; SENSORS]> {
        let Self { machine, shared, state, noise, .. } = self;
        let mut sensors = machine.sampled(shared, state, &mut || noise.sample());
        match self.fault {
            Some(Fault::Silent) => return None,
            Some(Fault::Stuck(sensor)) => sensors[sensor] = self.frozen[sensor],
            Some(Fault::NotANumber(sensor)) => sensors[sensor] = f64::NAN,
            Some(Fault::Jump(sensor, by)) => sensors[sensor] += by,
            Some(Fault::Spike(sensor, by)) => {
                sensors[sensor] += by;
                self.fault = None;
            }
            Some(Fault::Reversed(sensor)) => sensors[sensor] = -sensors[sensor],
            Some(Fault::Late(_) | Fault::Deaf | Fault::Hardover(_)) | None => {}
        }
        self.shown = sensors;
        Some(sensors)
    }
}

impl<D: Drive<f64>> Stepped for Simulated<D>
where
    Self: Send,
{
    fn angle(&self) -> f64 {
        self.machine.column_angle(&self.state)
    }

    fn arrive(&mut self, torque: f64) -> bool {
        let inputs = Inputs { link_torque: [torque; 2], ..self.inputs() };
        let arrived = self.machine.arrive(&self.shared, &mut self.state, &inputs);
        self.arrived = Some((arrived, inputs));
        let sample = self.shared.timing.and_then(|timing| timing.sample_at(self.state.steps()));
        if let Some(sample) = sample {
            // Where nothing is written in time, the drive holds what it has.
            self.under_way.send(sample, self.command + inputs.command_signal[0]);
        }
        sample.is_some()
    }

    fn set_out(&mut self) {
        let Some((arrived, inputs)) = self.arrived.take() else { return };
        if let Some(sample) = self.shared.timing.and_then(|timing| timing.arriving_at(self.state.steps())) {
            self.state.command(self.under_way.arriving(sample));
        }
        let start = self.machine.set_out(&self.shared, &mut self.state, &inputs, arrived);
        self.step = Some(Step { inputs, start, before: self.state });
    }

    fn advance(&mut self, torque: f64) -> [f64; 2] {
        let Some(Step { inputs, start, before }) = &mut self.step else {
            return [self.machine.column_angle(&self.state), 0.0];
        };
        inputs.link_torque[1] = torque;
        self.state = *before;
        self.machine.advance(&self.shared, &mut self.state, inputs, start);
        self.machine.column_motion(&self.shared, &self.state, start)
    }

    fn done(&mut self) {
        let Some(Step { start, .. }) = self.step.take() else { return };
        let to_rad = self.machine.per_base();
        self.hand.see(start.now.base * to_rad, start.now.base_rate * to_rad, self.shared.step_s);
        if self.state.steps() == self.held_until {
            Machine::<f64, D>::let_go(&mut self.state);
        }
    }

    fn sample(&mut self) -> Option<Sampled> {
        let pilot_force = self.arrived.as_ref().map_or(f64::NAN, |(arrived, _)| arrived.now.pilot_force);
        let sensors = self.measured()?;
        let late = if let Some(Fault::Late(cycles)) = self.fault { cycles.min(RECENT - 1) } else { 0 };
        self.samples = self.samples.wrapping_add(1);
        self.recent[self.samples % RECENT] = sensors;
        let sensors = self.recent[self.samples.wrapping_sub(late) % RECENT];
        let delay = u32::try_from(late).unwrap_or(u32::MAX);
        Some(Sampled {
            sample: Sample { sensors, pilot_force },
            periods: 1.0,
            delay,
            emergency_stop: false,
            drive_fault: 0,
            drive_acts: true,
        })
    }

    fn step_s(&self) -> f64 {
        self.shared.step_s
    }
}

impl<D: Drive<f64>> InputOutput for Simulated<D>
where
    Self: Send,
{
    fn read(&mut self) -> Option<Sampled> {
        loop {
            if self.arrived.is_some() {
                self.set_out();
                self.advance(0.0);
                self.done();
            }
            if self.arrive(0.0) {
                return self.sample();
            }
        }
    }

    fn write(&mut self, command: &Command) {
        if self.fault == Some(Fault::Deaf) {
            return;
        }
        // A drive without power makes nothing of its command.
        let e = if let Some(Fault::Hardover(e)) = self.fault { e } else { command.command };
        self.command = if command.enable { e } else { 0.0 };
        let step = self.state.steps();
        if let (Some(sample), Some((_, inputs))) = (self.shared.timing.and_then(|it| it.sample_at(step)), &self.arrived)
        {
            self.under_way.send(sample, self.command + inputs.command_signal[0]);
        }
    }

    fn disturb(&mut self, disturbance: Disturbance) {
        match disturbance {
            Disturbance::Force(force) => self.hand.push(force),
            Disturbance::HoldAt(angle) => self.hand.take_to(angle),
            Disturbance::Fault(fault) => {
                self.frozen = self.shown;
                self.fault = Some(fault);
            }
            Disturbance::Repair => self.fault = None,
            // It stands by itself.
            Disturbance::Link(_) => {}
        }
    }
}
