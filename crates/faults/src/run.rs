//! A case in virtual time: machine, digital controller and supervisor, as a live loop puts them together.

use crate::case::Case;
use crate::fault::FaultHistory;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::control::Sample;
use forcefeel_model::controller::{CommandDelay, Timing};
use forcefeel_model::drive::Drive;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Inputs, Machine, Shared};
use forcefeel_model::observer::{NUMBERS, Observer, knows_contact, knows_friction};
use forcefeel_model::parameters::{DriveKind, Parameters};
use forcefeel_model::supervised_law::{LimitedCommand, SupervisedLaw};
use forcefeel_model::supervisor::{
    Limits, RequestedMode, Supervisor, SupervisorInput, SupervisorOutput, SupervisorState,
};
use forcefeel_model::transducers::SENSORS;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// What was recorded of a sample.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// What the supervisor was told.
    pub input: SupervisorInput<f64>,
    /// The readings that it admitted.
    pub used: Option<[f64; SENSORS]>,
    /// What it allowed.
    pub allowed: SupervisorOutput<f64>,
    /// Column's angle in rad and its rate in rad/s, as they are.
    pub angle: f64,
    /// See [`angle`](Self::angle).
    pub rate: f64,
    /// Load cell's force in N, as it is.
    pub force: f64,
    /// Force of the hand in N.
    pub hand: f64,
    /// Energy that was given to the hand so far, in J.
    pub given: f64,
    /// Energy in the column, the link and what moves it, in J.
    pub stored: f64,
}

/// A law: with an observer, or the loader's original loop.
pub type LawOf<'a> = Option<&'a [f64; NUMBERS]>;

/// Steps of the machine in a period, and how long one may be at most.
const LONGEST_STEP_S: f64 = 5e-4;

/// What was recorded of a case; nothing where the loader cannot be supervised.
pub fn run<D: Drive<f64>>(case: &Case, law: LawOf<'_>, kind: DriveKind) -> Option<(Limits, Vec<Row>)> {
    let parameters = Parameters::from_values(&case.values);
    let period = parameters.controller.period;
    let limits = Limits::new(&parameters, kind, period).ok()?;
    let steps = whole((period / LONGEST_STEP_S).ceil().max(1.0));
    #[expect(clippy::cast_precision_loss, reason = "a few steps")]
    let step_s = period / steps as f64;
    let delay = whole((parameters.controller.delay / step_s).round());
    let timing = Timing { period: steps, delay };
    let effects = Effects {
        observer: law.is_some(),
        known_friction: law.is_some_and(knows_friction),
        contact_law: law.is_some_and(knows_contact),
        sampled: true,
        surroundings: true,
        ..Effects::of(&case.values)
    };
    let shared = Shared { effects, step_s, timing: Some(timing), curve: None, cancellation: None };
    let compensator = if law.is_some() {
        Compensator::state_feedback(&parameters, [0.0; 7])
    } else {
        Compensator::original(&parameters)
    };
    let mut machine = Machine::<f64, D>::new(&parameters, compensator, &shared);
    if let Some(numbers) = law {
        machine = machine.with_observer(Observer::from_numbers(numbers));
    }
    let equilibrium = machine.held_at(&shared, case.angle, case.angle, 1.0);
    let mut state = machine.start(&shared, &equilibrium);
    let mut noise = ChaCha8Rng::seed_from_u64(case.seed);
    let mut supervisor = Supervisor::new(limits, 0.0);
    let control = *machine.control();
    let mut under_way = CommandDelay::holding(0.0);
    // As a live loop on a machine that it does not know, it finds out by its sensors where the column stands.
    let mut followed = SupervisedLaw::new(&control, machine.sensors_at_rest(&shared.effects));
    let mut rows = Vec::<Row>::with_capacity(case.samples);
    let mut before = [FaultHistory::NONE; 2];
    let mut given = 0.0;
    let column = parameters.column;
    let moving = Moving::of(&parameters, kind, &limits);
    for sample in 0..case.samples {
        let pushed: f64 = case.faults.iter().map(|fault| fault.force(&limits, sample)).sum();
        let last = rows.last().map(|row| row.allowed);
        let share = last.map_or(0.0, |allowed| allowed.share);
        // A person pushes as the feel comes.
        let hand = case.hand.at(sample, period) * share + pushed;
        let neutral = last.map_or(case.angle, |allowed| allowed.neutral(case.angle));
        let inputs = Inputs { force: [hand; 2], trim: [neutral; 2], ..Inputs::NONE };
        for step in 0..steps {
            let arrived = machine.arrive(&shared, &mut state, &inputs);
            if step == 0 {
                let now = arrived.now;
                let sensors =
                    machine.sampled(&shared, &state, || core::array::from_fn(|_| StandardNormal.sample(&mut noise)));
                let mut input = SupervisorInput {
                    sensed: sensors,
                    missed: 0,
                    periods: 1.0,
                    delay: 0,
                    late: 0,
                    host_age: Some(0),
                    command: 0.0,
                    feel_acceleration: control.free_acceleration(&shared, followed.feeling(), &inputs),
                    feel_rate: followed.feeling().motion.at[1] * control.per_delta(),
                    emergency_stop: false,
                    other_axis: false,
                    drive_fault: false,
                    requested: if sample == 0 { RequestedMode::Off } else { RequestedMode::Active },
                    acknowledge: false,
                };
                for (fault, before) in case.faults.iter().zip(&mut before) {
                    before.see(sample, sensors);
                    fault.spoil_sensed(before, &limits, sample, &mut input);
                    before.shown = sensors;
                }
                let admitted = supervisor.admit(&input);
                let of = admitted.map(|sensors| Sample { sensors, pilot_force: now.pilot_force });
                let mut allowed = None;
                let e = followed.step((&shared, &control), &inputs, of.as_ref(), |answer| {
                    input.command = answer.command;
                    for fault in &case.faults {
                        fault.spoil_command(&limits, sample, &mut input);
                    }
                    let output = supervisor.step(&input);
                    allowed = Some(output);
                    LimitedCommand::from(&output)
                });
                let allowed = allowed?;
                let acts = case.faults.iter().fold(e, |e, fault| fault.spoil_drive(&limits, sample, e));
                under_way.send(sample, if allowed.enable { acts } else { 0.0 });
                let [angle, rate] = [now.base, now.base_rate].map(|along| along / column.base_arm);
                let stored = moving.stored(rate, now.force);
                rows.push(Row { input, used: admitted, allowed, angle, rate, force: now.force, hand, given, stored });
            }
            if let Some(arriving) = timing.arriving_at(state.steps()) {
                state.command(under_way.arriving(arriving));
            }
            let step_start = machine.set_out(&shared, &mut state, &inputs, arrived);
            given -= hand * step_start.now.base_rate / column.base_arm * column.grip_arm * step_s;
            machine.advance(&shared, &mut state, &inputs, &step_start);
        }
    }
    Some((limits, rows))
}

/// What can hold energy, and how much power the drive has.
///
/// `J` column, `J_m` rotor · `F^2 / k` link · `V / beta` oil: `E = 1/2 J v^2 + 1/2 J_m (alpha R_b v / r)^2 + 1/2 F^2 / k + 1/2 (V / beta) p^2`
#[derive(Debug, Clone, Copy)]
pub struct Moving {
    inertia: f64,
    softness: f64,
    /// Largest power of a valve in W; of a motor, that at its fastest.
    power: f64,
    /// Of a motor: largest torque about the column's pivot in N m; zero of a valve, whose flow bounds its power.
    torque: f64,
}

impl Moving {
    /// That of a loader.
    pub fn of(parameters: &Parameters<f64>, kind: DriveKind, limits: &Limits) -> Self {
        let Parameters { column, actuator, valve, amplifier, motor, transmission, .. } = parameters;
        let [per_stiffness, ..] = limits.link;
        match kind {
            DriveKind::Hydraulic => {
                let current = limits.command * amplifier.admittance;
                // p (C_i i - C_p p) is largest at p = C_i i / 2 C_p; no more than the pump's pressure at the largest flow of eq. (1).
                let linear = (valve.current_gain * current).powi(2) / (4.0 * valve.pressure_gain);
                let orifice = valve.supply_pressure * valve.rated_flow * core::f64::consts::SQRT_2;
                Self {
                    inertia: column.inertia,
                    softness: per_stiffness + actuator.oil_volume / actuator.bulk_modulus / actuator.area.powi(2),
                    power: if valve.orifice == 0.0 { linear } else { orifice.max(linear) },
                    torque: 0.0,
                }
            }
            DriveKind::Electric => {
                let per_travel = limits.lever / transmission.travel;
                let inertia = column.inertia + motor.inertia * per_travel.powi(2);
                // The fastest that it can be: the speed limit, and what the motor adds until the loader is stopped.
                let torque = motor.torque_constant * limits.command;
                let late = f64::from(limits.stop + 4) * limits.period;
                let rate = limits.speed_step / limits.period * per_travel + torque / motor.inertia * late;
                Self { inertia, softness: per_stiffness, power: torque * rate, torque: torque * per_travel }
            }
        }
    }

    /// Largest power of the drive in W where the column is no faster than `rate`: a hand can throw a motor beyond its own speed.
    pub fn power(&self, rate: f64) -> f64 {
        self.power.max(self.torque * rate)
    }

    /// Energy in J at a rate of the column and a force of the link.
    pub fn stored(&self, rate: f64, force: f64) -> f64 {
        0.5 * self.inertia * rate * rate + 0.5 * self.softness * force * force
    }
}

/// First sample at which the loader is safe from `from` on: command zero, drive disabled.
pub fn safe_from(rows: &[Row], from: usize) -> Option<usize> {
    let safe = |row: &Row| row.allowed.command == 0.0 && !row.allowed.enable;
    (from..rows.len()).find(|&k| safe(&rows[k]) && rows[k].allowed.state == SupervisorState::Tripped)
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number above zero")]
fn whole(number: f64) -> usize {
    number as usize
}
