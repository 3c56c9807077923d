//! A case in virtual time: machine, digital controller and supervisor, as a live loop puts them together.

use crate::case::Case;
use crate::fault::FaultHistory;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::control::{Control, Sample};
use forcefeel_model::controller::{CommandDelay, Timing};
use forcefeel_model::drive::Drive;
use forcefeel_model::effects::Effects;
use forcefeel_model::linked_feels::{LinkTimes, LinkedFeel};
use forcefeel_model::machine::{Inputs, Machine, SamplingPoint, Shared, State, StepStart};
use forcefeel_model::observer::{NUMBERS, Observer, knows_contact, knows_friction};
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters};
use forcefeel_model::supervised_law::{LimitedCommand, SupervisedLaw};
use forcefeel_model::supervisor::{
    Limits, RequestedMode, Supervisor, SupervisorInput, SupervisorOutput, SupervisorState,
};
use forcefeel_model::transducers::SENSORS;
use forcefeel_solve::random::RandomStream;

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
    /// Force of the arm or clamp at the grip in N.
    pub arm: f64,
    /// Torque of a shaft on the column in N m.
    pub shaft: f64,
    /// Torque of an electronic link on the feel in N m.
    pub link: f64,
    /// Energy that was given to the hand so far, in J.
    pub given: f64,
    /// Energy in the column, the link and what moves it, in J.
    pub stored: f64,
}

/// A law: with an observer, or the loader's original loop.
pub type LawOf<'a> = Option<&'a [f64; NUMBERS]>;

/// Loaders with a law each: one with an observer, or none for the original loop.
#[derive(Debug, Clone, Copy)]
pub struct Loaders<'a> {
    /// Values, in the order of the parameter table.
    pub values: &'a [[f64; COUNT]],
    /// Numbers of the laws.
    pub observers: Option<&'a [[f64; NUMBERS]]>,
}

/// Steps of the machine in a period, and how long one may be at most.
const LONGEST_STEP_S: f64 = 5e-4;

/// What was recorded of a case; nothing where the loader cannot be supervised.
pub fn run<D: Drive<f64>>(case: &Case, law: LawOf<'_>, kind: DriveKind) -> Option<Record> {
    let mut under_test = Loop::<D>::new(case, law, kind, false)?;
    while !under_test.done() {
        under_test.arrive(0.0)?;
        under_test.set_out();
        under_test.advance(0.0);
    }
    Some(under_test.record())
}

/// What was recorded of a loader.
#[derive(Debug, Clone)]
pub struct Record {
    /// Limits of its supervisor.
    pub limits: Limits,
    /// What can hold energy.
    pub moving: Moving,
    /// A row for each sample.
    pub rows: Vec<Row>,
}

/// A supervised loader that goes through a case, as a link of two of them sees it.
pub trait Side {
    /// What an electronic link sees of it.
    fn linked(&self) -> LinkedFeel<f64>;
    /// What an electronic link gives it in the next cycle, and whether the other axis has stopped it.
    fn link(&mut self, given: [f64; 2], other_axis: bool);
    /// Times of an electronic link whose first side it is.
    fn times(&self) -> LinkTimes<f64>;
    /// Angle of the column.
    fn angle(&self) -> f64;
    /// The step in s.
    fn step_s(&self) -> f64;
    /// Whether the next step begins with a sample.
    fn at_sample(&self) -> bool;
    /// Whether all of the case's samples are through.
    fn done(&self) -> bool;
    /// Whether the supervisor has stopped it.
    fn stopped(&self) -> bool;
    /// Begins a step under a torque on the column; a cycle if a sample is due. Nothing where the supervisor was not asked.
    fn arrive(&mut self, torque: f64) -> Option<()>;
    /// Goes on under the command that is held by now.
    fn set_out(&mut self);
    /// Takes the step, the torque on the column ending so: angle and rate of the column. May be taken again.
    fn advance(&mut self, torque: f64) -> [f64; 2];
    /// What was recorded.
    fn record(&mut self) -> Record;
}

/// See [`Side`].
pub struct Loop<'a, D: Drive<f64>> {
    case: &'a Case,
    parameters: Parameters<f64>,
    limits: Limits,
    moving: Moving,
    shared: Shared,
    timing: Timing,
    machine: Machine<f64, D>,
    state: State<f64, D>,
    noise: RandomStream,
    supervisor: Supervisor<f64>,
    control: Control<f64>,
    followed: SupervisedLaw<f64>,
    under_way: CommandDelay<f64>,
    before: [FaultHistory; 2],
    given: f64,
    link: [f64; 2],
    other_axis: bool,
    rows: Vec<Row>,
    arrived: Option<(SamplingPoint<f64, D>, Inputs)>,
    step: Option<Step<D>>,
}

/// A step that is taken, from where it began.
struct Step<D: Drive<f64>> {
    inputs: Inputs,
    start: StepStart<f64, D>,
    before: State<f64, D>,
}

impl<'a, D: Drive<f64>> Loop<'a, D> {
    /// At rest; `on_shaft`: whether a shaft turns its column. Nothing where the loader cannot be supervised.
    pub fn new(case: &'a Case, law: LawOf<'_>, kind: DriveKind, on_shaft: bool) -> Option<Self> {
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
            linked: on_shaft,
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
        let control = *machine.control();
        Some(Self {
            case,
            parameters,
            limits,
            moving: Moving::of(&parameters, kind, &limits),
            timing,
            state: machine.start(&shared, &equilibrium),
            noise: case.noise.clone(),
            supervisor: Supervisor::new(limits, 0.0),
            control,
            // As a live loop on a machine that it does not know, it finds out by its sensors where the column stands.
            followed: SupervisedLaw::new(&control, machine.sensors_at_rest(&shared.effects)),
            under_way: CommandDelay::holding(0.0),
            before: [FaultHistory::NONE; 2],
            given: 0.0,
            link: [0.0; 2],
            other_axis: false,
            rows: Vec::with_capacity(case.samples),
            arrived: None,
            step: None,
            shared,
            machine,
        })
    }

    fn inputs(&self, torque: f64) -> Inputs {
        let sample = self.state.steps() / self.timing.period;
        let pushed: f64 = self.case.faults.iter().map(|fault| fault.force(&self.limits, sample)).sum();
        // What is allowed at a sample counts from the next on.
        let last = sample.checked_sub(1).and_then(|last| self.rows.get(last)).map(|row| row.allowed);
        let share = last.map_or(0.0, |allowed| allowed.share);
        // A person pushes as the feel comes.
        let hand = self.case.hand.at(sample, self.limits.period) * share + pushed;
        let neutral = last.map_or(self.case.angle, |allowed| allowed.neutral(self.case.angle));
        let [of_link, damping] = self.link;
        Inputs {
            force: [hand; 2],
            trim: [neutral; 2],
            added_force: [of_link / self.parameters.column.grip_arm; 2],
            added_damping: [damping; 2],
            link_torque: [torque; 2],
            ..Inputs::NONE
        }
    }

    /// Force at the grip in N of the arm's spring and damper.
    fn arm(&self, [angle, rate]: [f64; 2]) -> f64 {
        let Parameters { pilot, column, .. } = &self.parameters;
        -(pilot.arm_stiffness * angle + pilot.arm_damping * rate) * column.grip_arm
    }

    fn cycle(&mut self, arrived: &SamplingPoint<f64, D>, inputs: &Inputs) -> Option<()> {
        let Self { case, limits, shared, machine, state, noise, supervisor, control, followed, .. } = self;
        let (now, sample) = (&arrived.now, self.rows.len());
        let sensors = machine.sampled(shared, state, &mut || core::array::from_fn(|_| noise.normal()));
        let mut input = SupervisorInput {
            sensed: sensors,
            missed: 0,
            periods: 1.0,
            delay: 0,
            late: 0,
            host: true,
            host_age: 0,
            command: 0.0,
            feel_acceleration: control.free_acceleration(shared, followed.feeling(), inputs),
            feel_rate: followed.feeling().motion.at[1] * control.per_delta(),
            link_torque: self.link[0],
            emergency_stop: false,
            other_axis: self.other_axis,
            drive_fault: false,
            drive_acts: true,
            requested: if sample == 0 { RequestedMode::Off } else { RequestedMode::Active },
            acknowledge: false,
        };
        for (fault, before) in case.faults.iter().zip(&mut self.before) {
            before.see(sample, sensors);
            fault.spoil_sensed(before, limits, sample, &mut input);
            before.shown = sensors;
        }
        let admitted = supervisor.admit(&input);
        let of = admitted.map(|sensors| Sample { sensors, pilot_force: now.pilot_force });
        let mut allowed = None;
        let e = followed.step((shared, control), inputs, of.as_ref(), |answer| {
            input.command = answer.command;
            for fault in &case.faults {
                fault.spoil_command(limits, sample, &mut input);
            }
            let output = supervisor.step(&input);
            allowed = Some(output);
            LimitedCommand::from(&output)
        });
        let allowed = allowed?;
        let acts = case.faults.iter().fold(e, |e, fault| fault.spoil_drive(limits, sample, e));
        self.under_way.send(sample, if allowed.enable { acts } else { 0.0 });
        let [angle, rate] = [now.base, now.base_rate].map(|along| along / self.parameters.column.base_arm);
        let (given, stored) = (self.given, self.moving.stored(rate, now.force));
        let arm = self.arm([angle, rate]);
        let [hand, shaft, link] = [inputs.force[0], inputs.link_torque[0], self.link[0]];
        let force = now.force;
        self.rows.push(Row {
            input,
            used: admitted,
            allowed,
            angle,
            rate,
            force,
            hand,
            arm,
            shaft,
            link,
            given,
            stored,
        });
        Some(())
    }
}

impl<D: Drive<f64>> Side for Loop<'_, D> {
    fn linked(&self) -> LinkedFeel<f64> {
        let last = self.rows.last();
        LinkedFeel {
            programmed: self.followed.feeling().motion.at.map(|number| number * self.control.per_delta()),
            share: last.map_or(0.0, |row| row.allowed.share),
            hand_force: last.map_or(0.0, |row| row.allowed.grip.hand_force),
            presses: false,
            opens: false,
            closes: false,
        }
    }

    fn link(&mut self, given: [f64; 2], other_axis: bool) {
        (self.link, self.other_axis) = (given, other_axis);
    }

    fn times(&self) -> LinkTimes<f64> {
        LinkTimes::new(self.limits.period, self.parameters.safety.fade_time)
    }

    fn angle(&self) -> f64 {
        self.machine.column_angle(&self.state)
    }

    fn step_s(&self) -> f64 {
        self.shared.step_s
    }

    fn at_sample(&self) -> bool {
        self.timing.sample_at(self.state.steps()).is_some()
    }

    fn done(&self) -> bool {
        self.at_sample() && self.rows.len() >= self.case.samples
    }

    fn stopped(&self) -> bool {
        self.rows.last().is_some_and(|row| row.allowed.state == SupervisorState::Tripped)
    }

    fn arrive(&mut self, torque: f64) -> Option<()> {
        let inputs = self.inputs(torque);
        let due = self.at_sample();
        let arrived = self.machine.arrive(&self.shared, &mut self.state, &inputs);
        if due {
            self.cycle(&arrived, &inputs)?;
        }
        self.arrived = Some((arrived, inputs));
        Some(())
    }

    fn set_out(&mut self) {
        let Some((arrived, inputs)) = self.arrived.take() else { return };
        if let Some(arriving) = self.timing.arriving_at(self.state.steps()) {
            self.state.command(self.under_way.arriving(arriving));
        }
        let start = self.machine.set_out(&self.shared, &mut self.state, &inputs, arrived);
        let column = &self.parameters.column;
        let rate = start.now.base_rate / column.base_arm;
        let arm = self.case.felt(self.arm([start.now.base / column.base_arm, rate]));
        self.given -= (inputs.force[0] + arm) * rate * column.grip_arm * self.shared.step_s;
        self.step = Some(Step { inputs, start, before: self.state });
    }

    fn advance(&mut self, torque: f64) -> [f64; 2] {
        let Some(Step { inputs, start, before }) = &mut self.step else { return [self.angle(), 0.0] };
        inputs.link_torque[1] = torque;
        self.state = *before;
        self.machine.advance(&self.shared, &mut self.state, inputs, start);
        self.machine.column_motion(&self.shared, &self.state, start)
    }

    fn record(&mut self) -> Record {
        Record { limits: self.limits, moving: self.moving, rows: core::mem::take(&mut self.rows) }
    }
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

    /// Largest torque in N m about the column's pivot that the drive holds; of a valve more than any hand's.
    pub fn holds(&self) -> f64 {
        if self.torque > 0.0 { self.torque } else { f64::INFINITY }
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
