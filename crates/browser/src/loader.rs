//! A hydraulic loader that is stepped as the page goes on, under a hand and a host.

use forcefeel_model::compensator::{Compensator, Displacement};
use forcefeel_model::controller::Timing;
use forcefeel_model::drive::hydraulic::Hydraulic;
use forcefeel_model::effects::Effects;
use forcefeel_model::hand::Hand;
use forcefeel_model::machine::{Inputs, Machine, Memory, Shared, State};
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_simulate::noise::Noise;
use forcefeel_solve::law::Law;
use forcefeel_solve::outputs::{OUTPUTS, Output};
use forcefeel_solve::start::Start;

/// What a loader is made of, as the page writes it: numbers alone, whole ones among them.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Setup {
    /// Values of the parameter table.
    pub values: [f64; COUNT],
    /// Step in s.
    pub step_s: f64,
    /// Steps in the controller's period; zero for an analog law.
    pub period: f64,
    /// Steps from a sample to its command.
    pub delay: f64,
    /// Angle in rad at which the grip was held before.
    pub held_rad: f64,
    /// The law: the original position loop, fixed gains, a sampled law.
    pub law: f64,
    /// Of fixed gains `c_1 .. c_7`, the load cell's arm, and whether the displacement is in V; of a sampled law its numbers.
    pub numbers: [f64; NUMBERS],
}

const GAINS: f64 = 1.0;
const SAMPLED: f64 = 2.0;

impl Setup {
    fn law(&self) -> Law<'_> {
        if self.law == SAMPLED {
            return Law::Observers(core::slice::from_ref(&self.numbers));
        }
        if self.law == GAINS {
            let [c_1, c_2, c_3, c_4, c_5, c_6, c_7, load_cell_arm, volts, ..] = self.numbers;
            let displacement = if volts == 0.0 { Displacement::Radians } else { Displacement::Volts };
            return Law::Fixed(Compensator { gains: [c_1, c_2, c_3, c_4, c_5, c_6, c_7], load_cell_arm, displacement });
        }
        Law::Original
    }

    fn shared(&self) -> Shared {
        let law = self.law();
        let effects = Effects {
            feedback: law.feeds_back(),
            observer: self.law == SAMPLED,
            known_friction: law.knows_friction(),
            contact_law: law.knows_contact(),
            test_signal: false,
            ..Effects::of(&self.values)
        };
        let timing = Timing { period: whole(self.period), delay: whole(self.delay) };
        let timing = (timing.period > 0).then_some(timing);
        Shared { effects, step_s: self.step_s, timing, curve: None, cancellation: None }
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a number of steps; what is none becomes zero"
)]
fn whole(steps: f64) -> usize {
    steps as usize
}

/// A loader between two steps.
#[derive(Debug, Clone)]
pub struct Loader {
    machine: Machine<f64>,
    shared: Shared,
    state: State<f64>,
    memory: Memory<f64>,
    noise: Noise,
    /// At the grip.
    pub hand: Hand,
    /// Force in N and spring rate in N m/rad that a host adds to the feel.
    pub added: [f64; 2],
}

impl Loader {
    /// The loader in equilibrium, its grip let go at this instant.
    pub fn new(setup: &Setup) -> Self {
        let (shared, parameters) = (setup.shared(), Parameters::from_values(&setup.values));
        let law = setup.law();
        let mut machine: Machine<f64, Hydraulic<f64>> =
            Machine::new(&parameters, law.compensator(&parameters, |of| of(0)), &shared);
        if let Some(observer) = law.observer(|of| of(0)) {
            machine = machine.with_observer(observer);
        }
        let start = Start::Held(setup.held_rad, 0).of(&machine, &shared, &[]);
        let state = machine.start(&shared, &start.equilibrium);
        let memory = machine.remember(&shared, &start.equilibrium);
        Self {
            noise: Noise::new(0, &[0], shared.effects.grip_sensor),
            hand: Hand::of(&parameters),
            added: [0.0; 2],
            machine,
            shared,
            state,
            memory,
        }
    }

    /// A step: outputs at its start.
    pub fn step(&mut self) -> [f64; OUTPUTS.len()] {
        let Self { machine, shared, state, memory, noise, hand, .. } = self;
        let [force, stiffness] = self.added;
        let inputs = Inputs {
            force: [hand.force(); 2],
            added_force: [force; 2],
            added_stiffness: [stiffness; 2],
            ..Inputs::NONE
        };
        let start = machine.begin(shared, state, memory, &inputs, &mut || noise.next(()));
        machine.advance(shared, state, &inputs, &start);
        let to_rad = machine.per_base();
        hand.see(start.now.base * to_rad, start.now.base_rate * to_rad, shared.step_s);
        core::array::from_fn(|place| Output::at(place).of(&start.now, to_rad))
    }
}
