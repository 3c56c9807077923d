//! A period without a clock: what a sample and the requests before it come to. Live, in virtual time and in a replay it is this.
//!
//! `s` share of a change of the feel that is over · its fade is `3 s^2 - 2 s^3`, so that neither the force nor its rate jumps

use crate::host_control::{HostControl, HostRequest};
use crate::input_output::{Command, Sampled};
use crate::request::{FeelRequest, LoopRequest};
use crate::row::Row;
use crate::setup::{Beginning, Setup};
use crate::supervision::{Asked, CycleStatus, Supervision, Verdict};
use crate::test_signal::TestSignal;
use forcefeel_bus::fault::Fault;
use forcefeel_model::control::{Control, ControlOutput, Sample};
use forcefeel_model::effects::Effects;
use forcefeel_model::host::ToHost;
use forcefeel_model::host::effects::Held;
use forcefeel_model::linked_feels::{LinkTimes, LinkedFeel};
use forcefeel_model::machine::{Inputs, Shared};
use forcefeel_model::modifiers::{FeelModifiers, ModifierRamp, ModifierRates};
use forcefeel_model::observer::Observer;
use forcefeel_model::parameters::Parameters;
use forcefeel_model::supervised_law::{LimitedCommand, SupervisedLaw};
use forcefeel_model::supervisor::{Functions, RequestedMode, SupervisorState};
use forcefeel_model::transducers::SENSORS;

/// Law, feel and supervisor of a running loop.
#[derive(Debug, Clone)]
pub struct Controller {
    parameters: Parameters<f64>,
    shared: Shared,
    control: Control<f64>,
    period_s: f64,
    followed: SupervisedLaw<f64>,
    sensors: [f64; SENSORS],
    pilot_force: f64,
    supervision: Supervision,
    asked: Asked,
    /// What is requested once the supervisor has been asked for off.
    after_off: Option<RequestedMode>,
    led: ModifierRamp<f64>,
    wanted: FeelModifiers,
    host: Option<HostControl>,
    /// What electronic links do to the feel in this cycle: torque in N m, damping in N m s/rad.
    link: [f64; 2],
    /// Whether it was asked to hold or to open, and has not been yet.
    link_asked: Option<bool>,
    /// Whether its priority button is pressed.
    presses: bool,
    change: Option<Change>,
    waiting: Option<FeelRequest>,
    test_signal: TestSignal,
    cycle: u64,
    beats: u64,
}

/// A change of the feel under way.
#[derive(Debug, Clone, Copy)]
struct Change {
    begin: u64,
    cycles: u64,
}

impl Controller {
    /// The controller of a loader, before its first sample.
    ///
    /// # Errors
    /// If the loader has no limits that a supervisor could hold it to.
    pub fn new(setup: &Setup) -> Result<Self, &'static str> {
        let (shared, control, parameters) = (setup.shared(), setup.control(), setup.parameters());
        let effects = Effects { surroundings: true, test_signal: false, ..shared.effects };
        let at_rest = setup.at_rest();
        let (followed, sensors, neutral) = match setup.beginning {
            Some(Beginning { sensors, delta, rate, neutral, estimate }) => {
                let mut feeling = control.resting(delta, neutral);
                feeling.motion.at[1] = rate;
                (SupervisedLaw::in_equilibrium(&control, at_rest, (sensors, estimate, feeling)), sensors, neutral)
            }
            None => (SupervisedLaw::new(&control, at_rest), [0.0; SENSORS], 0.0),
        };
        let trim_rad = neutral * control.per_delta();
        Ok(Self {
            parameters,
            shared: Shared { effects, ..shared },
            control,
            period_s: setup.period_s(),
            followed,
            sensors,
            pilot_force: 0.0,
            supervision: Supervision::new(setup)?,
            asked: Asked { request: RequestedMode::Off, acknowledge: false, stop: false, other_axis: false },
            after_off: Some(RequestedMode::Off),
            led: ModifierRamp::at(trim_rad),
            wanted: FeelModifiers { trim_rad, ..FeelModifiers::NONE },
            host: setup.host.then(|| HostControl::new(setup)),
            link: [0.0; 2],
            link_asked: None,
            presses: false,
            change: None,
            waiting: None,
            test_signal: TestSignal::default(),
            cycle: 0,
            beats: 0,
        })
    }

    /// Period of the loop, and the share of the feel that comes or goes in it.
    pub fn link_times(&self) -> LinkTimes<f64> {
        LinkTimes::new(self.period_s, self.parameters.safety.fade_time)
    }

    /// Adds a bench signal to the law's command, which the supervisor limits with it; the law's observer is not told.
    pub fn excite(&mut self, test_signal: TestSignal) {
        self.test_signal = test_signal;
    }

    /// The cycle that comes next.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// Takes a request, which counts from the next cycle on. Of two feels that wait, the newer stays.
    pub fn take(&mut self, request: &LoopRequest) {
        match request {
            LoopRequest::Feel(feel) => self.waiting = Some(*feel),
            LoopRequest::FeelModifiers(around) => self.wanted = *around,
            LoopRequest::On => self.request(RequestedMode::Active),
            LoopRequest::Passive => self.request(RequestedMode::Passive),
            LoopRequest::Off => self.request(RequestedMode::Off),
            LoopRequest::Acknowledge => self.asked.acknowledge = true,
            LoopRequest::Stop => self.asked.stop = true,
            LoopRequest::OtherAxis => self.asked.other_axis = true,
            LoopRequest::Priority(pressed) => self.presses = *pressed,
            LoopRequest::Link(holds) => self.link_asked = Some(*holds),
            LoopRequest::Host(packet) => {
                if let Some(host) = &mut self.host {
                    let feel = &self.parameters.feel;
                    host.take(packet, [self.wanted.stiffness_factor * feel.stiffness, feel.damping]);
                }
            }
        }
    }

    /// A supervisor starts nothing before it was asked for off: so off counts for a cycle, as it does for the first, even where another request
    /// comes within it.
    fn request(&mut self, request: RequestedMode) {
        if request == RequestedMode::Off {
            (self.asked.request, self.after_off) = (request, Some(request));
        } else if let Some(after) = &mut self.after_off {
            *after = request;
        } else {
            self.asked.request = request;
        }
    }

    /// The functions that stopped it; none of a loop that is not stopped.
    pub fn stopped_by(&self) -> Functions {
        let stopped = self.supervision.last().filter(|allowed| allowed.state == SupervisorState::Tripped);
        stopped.map_or(Functions::NONE, |allowed| allowed.tripped)
    }

    /// What an electronic link sees of it; whether it `opens` as it is asked since this was called last.
    pub fn linked(&mut self, opens: bool) -> LinkedFeel<f64> {
        let asked = if opens { self.link_asked.take() } else { None };
        LinkedFeel {
            programmed: self.followed.feeling().motion.at.map(|number| number * self.control.per_delta()),
            share: self.supervision.share(),
            // As the supervisor estimates it, or as measured where nobody looks on.
            hand_force: self.supervision.last().map_or(self.pilot_force, |allowed| allowed.grip.hand_force),
            presses: self.presses,
            opens: asked == Some(false),
            closes: asked == Some(true),
        }
    }

    /// What one of its electronic links does to the feel in the next cycle: torque in N m and damping in N m s/rad.
    pub fn link(&mut self, [torque, damping]: [f64; 2]) {
        self.link = [self.link[0] + torque, self.link[1] + damping];
    }

    /// What the host is told of a cycle, if it has sent something since it was told last.
    pub fn answer(&mut self, row: &Row) -> Option<ToHost> {
        self.host.as_mut()?.answer(row, self.supervision.last())
    }

    /// Packets of the host that were softened.
    pub fn softened(&self) -> u64 {
        self.host.as_ref().map_or(0, |host| host.softened)
    }

    /// A sample as it came. Without the pilot's force under a law that requires it, it is at fault: the loader does not start, by name.
    pub fn checked(&self, sampled: Sampled) -> Sampled {
        let lacks = !self.shared.effects.observer && sampled.sample.pilot_force.is_nan();
        let drive_fault = if lacks && sampled.drive_fault == 0 { Fault::NO_PILOT_FORCE.0 } else { sampled.drive_fault };
        Sampled { drive_fault, ..sampled }
    }

    /// A cycle: the command, and what there is to see; `missed` beats went by before it.
    pub fn step(&mut self, sampled: Option<&Sampled>, missed: u64) -> (Command, Row) {
        self.beats += missed;
        let fade = self.change_feel();
        let pace = self.pace();
        let around = self.led.step(&self.wanted, &pace);
        let of_host = self.of_host(fade, around.stiffness_factor);
        let inputs = self.inputs((fade, around), &pace, &of_host);
        // Before its feel is wanted a host leaves the loader passive, whatever the person wants.
        let held_back = self.asked.request == RequestedMode::Active && of_host.holds_back;
        let asked =
            Asked { request: if held_back { RequestedMode::Passive } else { self.asked.request }, ..self.asked };
        let seen = CycleStatus {
            sensors: sampled.map_or(self.sensors, |sampled| sampled.sample.sensors),
            periods: sampled.map(|sampled| sampled.periods),
            delay: sampled.map_or(0, |sampled| sampled.delay),
            link_torque: self.link[0],
            feel_acceleration: self.control.free_acceleration(&self.shared, self.followed.feeling(), &inputs),
            feel_rate: self.followed.feeling().motion.at[1] * self.control.per_delta(),
            emergency_stop: sampled.is_some_and(|sampled| sampled.emergency_stop),
            drive_fault: sampled.is_some_and(|sampled| sampled.drive_fault != 0),
            drive_acts: sampled.is_some_and(|sampled| sampled.drive_acts),
            missed,
            host_age: of_host.age,
            asked,
        };
        (self.asked.acknowledge, self.asked.stop, self.asked.other_axis) = (false, false, false);
        self.asked.request = self.after_off.take().unwrap_or(self.asked.request);
        self.sensors = seen.sensors;
        let (supervision, mut verdict) = (&mut self.supervision, Verdict::NONE);
        self.pilot_force = sampled.map_or(self.pilot_force, |sampled| sampled.sample.pilot_force);
        let pilot_force = self.pilot_force;
        let sample = supervision.admit(&seen).map(|sensors| Sample { sensors, pilot_force });
        let active = supervision.last().is_some_and(|allowed| allowed.state == SupervisorState::Active);
        self.shared.effects.excited = self.test_signal.is_ahead();
        let test_signal = self.test_signal.next(active);
        let written = self.followed.step((&self.shared, &self.control), &inputs, sample.as_ref(), |answer| {
            let asked = answer.command + test_signal;
            verdict = supervision.look(&ControlOutput { command: asked, ..*answer });
            // What passes whole is the law's own command to the last bit.
            let whole = verdict.command.to_bits() == asked.to_bits();
            let command = if whole { answer.command } else { verdict.command - test_signal };
            LimitedCommand { command, ..verdict.passed() }
        });
        let added = if verdict.enable { test_signal } else { 0.0 };
        let verdict = Verdict { command: written + added, ..verdict };
        let command =
            Command { cycle: self.cycle, command: verdict.command, enable: verdict.enable, state: verdict.state };
        let row = self.row(sampled, &verdict, &inputs, missed);
        self.link = [0.0; 2];
        self.cycle += 1;
        self.beats += 1;
        (command, row)
    }

    /// Begins and ends changes of the feel; how far the present one is.
    fn change_feel(&mut self) -> f64 {
        if self.change.is_some_and(|change| self.cycle >= change.begin + change.cycles) {
            self.control.faded();
            self.change = None;
        }
        if self.change.is_none()
            && let Some(FeelRequest { values, observer, cycles }) = self.waiting.take()
        {
            let parameters = Parameters { feel: Parameters::from_values(&values).feel, ..self.parameters };
            let effects = Effects::of(&values);
            let observer = observer.map(|numbers| Observer::from_numbers(&numbers));
            self.control.fade_to(&parameters, observer.as_ref());
            let of_feel = Effects {
                feel_friction: effects.feel_friction,
                feel_spring: effects.feel_spring,
                feel_damping_and_stops: effects.feel_damping_and_stops,
                feel_limits: effects.feel_limits,
                ..Effects::default()
            };
            self.shared.effects = self.shared.effects.or(of_feel);
            self.parameters = parameters;
            self.change = Some(Change { begin: self.cycle, cycles: u64::from(cycles.max(1)) });
        }
        self.change.map_or(0.0, |Change { begin, cycles }| {
            let share = count(self.cycle - begin) / count(cycles);
            share * share * (3.0 - 2.0 * share)
        })
    }

    /// What the host wants of this cycle, where the person has set a factor on the spring; nothing where there is none.
    fn of_host(&mut self, fade: f64, persons: f64) -> HostRequest {
        let Some(host) = &mut self.host else { return HostRequest::NONE };
        let (control, shared, feeling) = (&self.control, &self.shared, self.followed.feeling());
        let force = |angle, factor: f64| control.holding_force(shared, feeling, (persons * factor, fade), angle);
        let angle = feeling.motion.at[0] * control.per_delta();
        host.step(&Held { angle, spring: self.parameters.feel.stiffness, force }, self.supervision.last())
    }

    fn pace(&self) -> ModifierRates<f64> {
        let feel = &self.parameters.feel;
        ModifierRates { trim_rate: feel.trim_rate, shaker_frequency: feel.shaker_frequency, period: self.period_s }
    }

    /// What the feel is told from outside in this cycle.
    fn inputs(
        &mut self,
        (fade, around): (f64, FeelModifiers),
        pace: &ModifierRates<f64>,
        of_host: &HostRequest,
    ) -> Inputs {
        // What the person sets and what the host does go together.
        let trim_rad = around.trim_rad + of_host.neutral;
        let stiffness_factor = around.stiffness_factor * of_host.stiffness_factor;
        let swing = self.led.swing(around.shaker.max(of_host.shaker), pace);
        let [torque, damping] = self.link;
        Inputs {
            trim: [self.supervision.neutral(trim_rad); 2],
            stiffness_factor: [stiffness_factor; 2],
            shaker: [swing; 2],
            added_force: [of_host.added.force + torque / self.parameters.column.grip_arm; 2],
            added_stiffness: [of_host.added.stiffness; 2],
            added_damping: [of_host.added.damping + damping; 2],
            fade: [fade; 2],
            ..Inputs::NONE
        }
    }

    fn row(&self, sampled: Option<&Sampled>, verdict: &Verdict, inputs: &Inputs, missed: u64) -> Row {
        let [force, position, base, grip] = self.sensors;
        let per_delta = self.control.per_delta();
        let (feeling, answer) = (self.followed.feeling(), self.followed.answer());
        let [delta, rate] = feeling.motion.at;
        Row {
            time_s: count(self.beats) * self.period_s,
            cycle: count(self.cycle),
            column_angle_rad: base * self.control.per_base(),
            pilot_force_n: sampled.map_or(f64::NAN, |sampled| sampled.sample.pilot_force),
            load_cell_force_n: force,
            drive_position_m: position,
            column_base_m: base,
            grip_force_n: grip,
            grip_zero_n: self.supervision.last().map_or(0.0, |allowed| allowed.grip_zero),
            feel_angle_rad: delta * per_delta,
            feel_rate_rad_per_s: rate * per_delta,
            feel_torque_n_m: answer.torque,
            neutral_rad: feeling.neutral * per_delta,
            fade: inputs.fade[0],
            spring_factor: inputs.stiffness_factor[0],
            added_force_n: inputs.added_force[0],
            added_stiffness_n_m_per_rad: inputs.added_stiffness[0],
            added_damping_n_m_s_per_rad: inputs.added_damping[0],
            link_torque_n_m: self.link[0],
            link_damping_n_m_s_per_rad: self.link[1],
            host_share: self.host.as_ref().map_or(0.0, HostControl::share),
            law_command: answer.command,
            command: verdict.command,
            enable: f64::from(u8::from(verdict.enable)),
            state: f64::from(verdict.state),
            trips: f64::from(verdict.trips),
            acting: f64::from(verdict.acting),
            hand_force_n: verdict.hand_force,
            sampled: f64::from(u8::from(sampled.is_some())),
            periods: sampled.map_or(f64::NAN, |sampled| sampled.periods),
            delay: sampled.map_or(f64::NAN, |sampled| f64::from(sampled.delay)),
            emergency_stop: f64::from(u8::from(sampled.is_some_and(|sampled| sampled.emergency_stop))),
            drive_fault: sampled.map_or(0.0, |sampled| f64::from(sampled.drive_fault)),
            drive_acts: f64::from(u8::from(sampled.is_some_and(|sampled| sampled.drive_acts))),
            missed: count(missed),
            late_s: 0.0,
            work_s: 0.0,
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of cycles, below 2^52 for a hundred thousand years")]
fn count(cycles: u64) -> f64 {
    cycles as f64
}
