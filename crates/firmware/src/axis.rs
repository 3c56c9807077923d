//! A period of an axis: what the live loop does in a cycle, without a clock, a record or an operating system.

use crate::loader::{Loader, Setting};
use forcefeel_model::Scalar;
use forcefeel_model::control::{Answer, Control, Feeling, Remembered, Sample};
use forcefeel_model::machine::{Inputs, Shared};
use forcefeel_model::supervisor::{Limits, State, Supervisor, Told, Wish};
use forcefeel_model::transducers::SENSORS;

/// Column's angle in rad of the second row of [`Loader::at_rest`].
pub const ELSEWHERE_RAD: f64 = 0.1;

/// What is given to an axis in a period.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Input<S> {
    /// Load cell (N), position of the drive's end (m), displacement of the column's base (m), force at the grip (N).
    pub sensors: [S; SENSORS],
    /// Commanded neutral in rad.
    pub trim: S,
    /// On the feel's spring.
    pub stiffness_factor: S,
    /// Swing of the stick shaker, -1 to 1.
    pub shaker: S,
    /// How far the feel has been changed.
    pub share: S,
    /// Force at the grip in N that a host adds beside the hand's.
    pub added_force: S,
    /// The setting that is left, or stays.
    pub from: u32,
    /// The setting that is gone to.
    pub to: u32,
    /// Off, passive, active.
    pub wish: u32,
    /// Samples in a row without a sample.
    pub missed: u32,
    /// Periods in a row that were late.
    pub late: u32,
    /// Bits: emergency stop, fault of the drive, acknowledged.
    pub flags: u32,
}

/// The bits of [`Input::flags`].
pub const EMERGENCY_STOP: u32 = 1;
/// See [`EMERGENCY_STOP`].
pub const DRIVE_FAULT: u32 = 2;
/// See [`EMERGENCY_STOP`].
pub const ACKNOWLEDGED: u32 = 4;

/// What an axis answers.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Output<S> {
    /// To the drive, in V or A.
    pub command: S,
    /// That the feel hears, in N m.
    pub torque: S,
    /// Of the feel after the period, rad and rad/s.
    pub feel: [S; 2],
    /// Whether the drive has power.
    pub enable: u32,
    /// Off, initialising, passive, active, fading, tripped.
    pub state: u32,
    /// Safety functions that act, a bit each.
    pub acting: u32,
    /// Those that acted since they were acknowledged.
    pub tripped: u32,
}

/// Law, feel and supervisor of one axis.
#[derive(Debug, Clone)]
pub struct Axis<S: Scalar> {
    shared: Shared,
    control: Control<S>,
    settings: (u32, u32),
    remembered: Remembered<S>,
    feeling: Feeling<S>,
    placed: bool,
    at_rest: [[S; SENSORS]; 2],
    sensors: [S; SENSORS],
    supervisor: Supervisor<S>,
    /// Share and anchor of the feel's neutral.
    neutral: Option<(S, S)>,
    leads: Option<S>,
    answer: Answer<S>,
    command: S,
}

impl<S: Scalar> Axis<S> {
    /// An axis that is off; nothing if it has no settings, or no limits that a supervisor could hold it to.
    pub fn new(loader: &Loader, settings: &[Setting], like: S) -> Option<Self> {
        let first = settings.first()?;
        let limits = Limits::new(&first.parameters(0.0), first.drive(), loader.period_s).ok()?;
        let shared = loader.shared(settings);
        let control = first.control(&shared, like);
        let zero = like.zero();
        Some(Self {
            shared,
            control,
            settings: (0, 0),
            remembered: control.remember([zero; SENSORS], zero),
            feeling: control.resting(zero, zero),
            placed: false,
            at_rest: loader.at_rest.map(|row| row.map(|value| like.constant(value))),
            sensors: [zero; SENSORS],
            supervisor: Supervisor::new(limits, like),
            neutral: None,
            leads: None,
            answer: Answer { command: zero, torque: zero, base_rate: zero },
            command: zero,
        })
    }

    /// A period; nothing, and nothing is changed, if there are no such settings.
    pub fn step(&mut self, settings: &[Setting], given: &Input<S>) -> Option<Output<S>>
    where
        S: Into<f64>,
    {
        self.select(settings, given)?;
        let inputs = self.inputs(given);
        let fresh = given.missed == 0;
        if fresh {
            self.sensors = given.sensors;
        }
        let told = Told {
            sensed: self.sensors,
            missed: given.missed,
            late: given.late,
            host_age: None,
            command: self.command,
            feel_acceleration: self.control.free_acceleration(&self.shared, &self.feeling, &inputs),
            emergency_stop: given.flags & EMERGENCY_STOP != 0,
            drive_fault: given.flags & DRIVE_FAULT != 0,
            wish: match given.wish {
                1 => Wish::Passive,
                2 => Wish::Active,
                _ => Wish::Off,
            },
            acknowledge: given.flags & ACKNOWLEDGED != 0,
        };
        let finite = self.sensors.iter().all(|&value| finite(value));
        Some(if fresh && finite { self.act(&inputs, &told) } else { self.look(&told) })
    }

    /// Law, feel and supervisor at a sample.
    fn act(&mut self, inputs: &Inputs, told: &Told<S>) -> Output<S> {
        self.place();
        let sample = Sample { sensors: self.sensors, pilot_force: self.command.zero() };
        let (supervisor, answer, mut allowed) = (&mut self.supervisor, &mut self.answer, None);
        let law = (&mut self.feeling, &mut self.remembered);
        let written = self.control.command(&self.shared, law, inputs, &sample, |found| {
            *answer = *found;
            let may = supervisor.step(&Told { command: found.command, ..*told });
            allowed = Some(may);
            // Where nothing is changed, the law goes on to the very bit.
            differ(may.command, found.command).then_some(may.command)
        });
        // The model asks once, always.
        let Some(allowed) = allowed else { return self.look(told) };
        if !finite(self.answer.command) {
            // What the law remembers is lost.
            self.placed = false;
        }
        (self.neutral, self.leads) = (Some((allowed.share, allowed.anchor)), allowed.leads);
        if !allowed.follows {
            // The law looks on, told of the command that goes out; the feel waits where the column stands.
            self.rest();
        }
        // The converter's step may round the command up; without power there is none.
        let zero = written.zero();
        self.command = match (allowed.follows, allowed.enable) {
            (false, _) => allowed.command,
            (true, false) => zero,
            (true, true) => written,
        };
        self.output(&allowed)
    }

    /// Nothing was sampled that a law could use: the command holds, as far as the supervisor allows.
    fn look(&mut self, told: &Told<S>) -> Output<S> {
        let allowed = self.supervisor.step(told);
        self.command = allowed.command;
        (self.neutral, self.leads) = (Some((allowed.share, allowed.anchor)), allowed.leads);
        self.output(&allowed)
    }

    fn output(&self, allowed: &forcefeel_model::supervisor::Allowed<S>) -> Output<S> {
        let per_delta = self.control.per_delta();
        Output {
            command: self.command,
            torque: self.answer.torque,
            feel: self.feeling.motion.at.map(|number| number * per_delta),
            enable: u32::from(allowed.enable),
            state: match allowed.state {
                State::Off => 0,
                State::Initialising => 1,
                State::Passive => 2,
                State::Active => 3,
                State::Fading => 4,
                State::Tripped => 5,
            },
            acting: allowed.acting.bits(),
            tripped: allowed.tripped.bits(),
        }
    }

    /// The law begins in the equilibrium where the column stands, whatever drive's sensor and load cell show besides.
    fn place(&mut self) {
        if self.placed {
            return;
        }
        self.placed = true;
        let [zero, there] = &self.at_rest;
        let share = (self.sensors[2] - zero[2]) / (there[2] - zero[2]);
        let sensors = core::array::from_fn(|k| zero[k] + (there[k] - zero[k]) * share);
        self.remembered = self.control.remember(sensors, self.control.delta_at(self.sensors[2]));
        self.rest();
    }

    /// The feel rests where the column stands, its neutral there too.
    fn rest(&mut self) {
        let delta = self.control.delta_at(self.sensors[2]);
        if finite(delta) {
            self.feeling = self.control.resting(delta, delta);
        }
    }

    /// The feels between which it is.
    fn select(&mut self, settings: &[Setting], given: &Input<S>) -> Option<()> {
        let (from, to) = (settings.get(given.from as usize)?, settings.get(given.to as usize)?);
        let like = self.command;
        if self.settings.0 != given.from {
            self.control = from.control(&self.shared, like);
        }
        if self.settings != (given.from, given.to) {
            self.control.fade_to(&to.parameters(like), Some(&to.law(like)));
            self.settings = (given.from, given.to);
        }
        Some(())
    }

    /// What the feel is told from outside.
    fn inputs(&self, given: &Input<S>) -> Inputs
    where
        S: Into<f64>,
    {
        let wanted = given.trim;
        let trim = match (self.leads, self.neutral) {
            (Some(leads), _) => leads,
            (None, Some((share, anchor))) => anchor + share * (wanted - anchor),
            (None, None) => wanted,
        };
        let [trim, stiffness_factor, shaker, fade, added_force] =
            [trim, given.stiffness_factor, given.shaker, given.share, given.added_force]
                .map(|number| [number.into(); 2]);
        Inputs { trim, stiffness_factor, shaker, fade, added_force, ..Inputs::NONE }
    }
}

fn finite<S: Scalar>(value: S) -> bool {
    S::any(value.abs().less(value.constant(f64::INFINITY)))
}

/// Whether two numbers are not the same; what is no number is not even that.
fn differ<S: Scalar>(a: S, b: S) -> bool {
    !finite(a) || !finite(b) || S::any(a.less(b) | b.less(a))
}
