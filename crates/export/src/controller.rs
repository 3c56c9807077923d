//! A controller's period and its start at rest, for any number type: let through by the tracing one, and run by the others for reference.

use crate::trace::{Bank, Graph, Mask, Trace, input_as_f64, traced};
use forcefeel_model::Scalar;
use forcefeel_model::cancellation::Cancellation;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::contact_law::{CONTACT_NUMBERS, ContactState};
use forcefeel_model::control::{Control, FeelState, LawState, Sample};
use forcefeel_model::controller::Timing;
use forcefeel_model::curve::Curve;
use forcefeel_model::drive::Kind;
use forcefeel_model::dry_friction::StickState;
use forcefeel_model::effects::Effects;
use forcefeel_model::feel_computer::FeelMotion;
use forcefeel_model::known_friction::{FRICTION_NUMBERS, FrictionState};
use forcefeel_model::law_inputs::{
    ADDED as ADDED_RANGES, SHAKER_SWING, STIFFNESS_FACTOR as FACTOR_RANGE, TRIM as TRIM_RANGE, sensed,
};
use forcefeel_model::machine::{Inputs, Machine, Shared};
use forcefeel_model::memory::MemoryVisitor;
use forcefeel_model::observer::{MOST_STATES, NUMBERS, Observer, SAMPLED, knows_contact, knows_friction};
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters, TABLE};
use forcefeel_model::surface::{self, Added, FlightState};
use forcefeel_model::with_drive;
use std::sync::OnceLock;

/// What a controller is given in a period, in this order; `blend` is how far the feel has been changed. What is added beside the feel is
/// read where the loader has a surface.
pub const INPUTS: [&str; 11] = [
    "force",
    "position",
    "base",
    "grip",
    "trim",
    "stiffness_factor",
    "shaker",
    "blend",
    "added_force",
    "added_stiffness",
    "added_damping",
];

/// What a surface's hinge moment is given, in this order: the flight, and the control's angle.
pub const FLIGHT: [&str; surface::FLIGHT.len() + 1] = {
    let mut names = ["angle"; surface::FLIGHT.len() + 1];
    let mut k = 0;
    while k < surface::FLIGHT.len() {
        names[k] = surface::FLIGHT[k];
        k += 1;
    }
    names
};

/// The place of the first of [`FLIGHT`], beyond all that a controller remembers.
pub const FIRST_OF_FLIGHT: usize = 1 << 15;

/// What a link is given, in this order: angles and rates of both controls at ages, hands, and flags; angle and rate of the middle at the same
/// ages; angles of both controls at rest, and those between which the middle rests.
pub const LINK: [&str; 39] = [
    "now.angle[0]",
    "now.rate[0]",
    "now.angle[1]",
    "now.rate[1]",
    "last.angle[0]",
    "last.rate[0]",
    "last.angle[1]",
    "last.rate[1]",
    "then.angle[0]",
    "then.rate[0]",
    "then.angle[1]",
    "then.rate[1]",
    "before.angle[0]",
    "before.rate[0]",
    "before.angle[1]",
    "before.rate[1]",
    "hand[0]",
    "hand[1]",
    "share",
    "gain[0]",
    "gain[1]",
    "button[0]",
    "button[1]",
    "disconnect",
    "open",
    "by_force[0]",
    "by_force[1]",
    "middle[0][0]",
    "middle[0][1]",
    "middle[1][0]",
    "middle[1][1]",
    "middle[2][0]",
    "middle[2][1]",
    "middle[3][0]",
    "middle[3][1]",
    "angle[0]",
    "angle[1]",
    "low",
    "high",
];

/// The place of the first of [`LINK`], beyond the flight.
pub const FIRST_OF_LINK: usize = FIRST_OF_FLIGHT + FLIGHT.len();

/// The place of the first row of the parameter table that is tuned, beyond the link.
pub const FIRST_OF_TUNING: usize = FIRST_OF_LINK + LINK.len();

const FORCE: usize = 0;
const BASE: usize = 2;
const TRIM: usize = SAMPLED;
pub(crate) const STIFFNESS_FACTOR: usize = TRIM + 1;
const SHARE: usize = 7;
pub(crate) const ADDED: usize = 8;

/// The name of a place: of an input, then of a number that a controller remembers, of the flight, of a link, or of a row.
pub fn name_of(place: usize) -> &'static str {
    if let Some(row) = place.checked_sub(FIRST_OF_TUNING) {
        return TABLE[row].name;
    }
    if let Some(k) = place.checked_sub(FIRST_OF_LINK) {
        return LINK[k];
    }
    if let Some(k) = place.checked_sub(FIRST_OF_FLIGHT) {
        return FLIGHT[k];
    }
    INPUTS.get(place).copied().unwrap_or_else(|| remembered()[place - INPUTS.len()].0)
}

/// The place of a number that a controller remembers.
pub fn place_of(name: &str) -> Option<usize> {
    remembered().iter().position(|&(known, _)| known == name).map(|k| INPUTS.len() + k)
}

/// Whether a place holds a flag.
pub fn is_flag(place: usize) -> bool {
    place.checked_sub(INPUTS.len()).is_some_and(|k| remembered()[k].1)
}

/// A law with its feel, for one setting or many.
#[derive(Debug, Clone)]
pub struct Job {
    /// Values of the parameter table of each setting.
    pub values: Vec<[f64; COUNT]>,
    /// The law of each setting, and of how many states.
    pub observers: Vec<[f64; NUMBERS]>,
    /// States of the law; the others are zero.
    pub states: usize,
    /// Force over angle of the feel.
    pub curve: Option<Curve>,
    /// What is added to the command.
    pub cancellation: Option<Cancellation>,
    /// The controller's period in s.
    pub period_s: f64,
    /// Whether force, spring and damping beside the feel are inputs without a surface, too.
    pub linked: bool,
    /// Rows of the feel that the program tunes, by their places in the table, each with its least and greatest value; of one setting.
    pub tunable: Vec<(usize, [f64; 2])>,
    /// Whether the target computes in single precision.
    pub single: bool,
}

/// What was traced: the graph, and which nodes are wanted of it.
#[derive(Debug, Clone)]
pub struct Program {
    /// The operations.
    pub graph: Graph,
    /// Command, torque that the feel receives, displacement and rate of the feel.
    pub outputs: Vec<(&'static str, u32)>,
    /// What must be numbers, or nothing of the period is kept: the outputs, the command before it is limited.
    pub numbers: Vec<u32>,
    /// The next state by its place.
    pub next: Vec<(usize, u32)>,
}

/// One sample: what the controller is given, the setting that it has and the one that it goes to.
#[derive(Debug, Clone, Copy)]
pub struct Given {
    /// In the order of [`INPUTS`].
    pub inputs: [f64; INPUTS.len()],
    /// The settings.
    pub settings: (usize, usize),
}

/// Numbers of an [`answers`] row: command, torque, and the feel's displacement and rate after the period.
pub const ANSWERS: usize = 4;

impl Job {
    pub(crate) fn kind(&self) -> DriveKind {
        DriveKind::of(&self.values[0])
    }

    pub(crate) fn shared(&self) -> Shared {
        let tuned = (0..2).map(|end| {
            let mut values = self.values[0];
            self.tunable.iter().for_each(|&(row, ends)| values[row] = ends[end]);
            values
        });
        let effects =
            self.values.iter().copied().chain(tuned).map(|of| Effects::of(&of)).reduce(Effects::or).unwrap_or_default();
        Shared {
            effects: Effects {
                observer: true,
                surroundings: effects.surroundings || self.linked,
                known_friction: self.observers.iter().any(knows_friction),
                contact_law: self.observers.iter().any(knows_contact),
                ..effects
            },
            step_s: self.period_s,
            timing: Some(Timing { period: 1, delay: 0 }),
            curve: self.curve,
            cancellation: self.cancellation,
        }
    }

    /// The parameters of a setting, or of all in one bank, made of numbers by `number`.
    pub(crate) fn parameters<S: Scalar>(&self, number: impl Fn(usize, &dyn Fn(usize) -> f64) -> S) -> Parameters<S> {
        Parameters::from_values(&core::array::from_fn(|k| number(k, &|setting| self.values[setting][k])))
    }

    pub(crate) fn observer<S: Scalar>(&self, number: impl Fn(usize, &dyn Fn(usize) -> f64) -> S) -> Observer<S> {
        Observer::from_numbers(&core::array::from_fn(|k| number(k, &|setting| self.observers[setting][k])))
    }

    /// Between which values each of [`INPUTS`] is taken.
    pub fn ranges(&self) -> [(f64, f64); INPUTS.len()] {
        let [force, position, base, grip] = sensed(&Parameters::from_values(&self.values[0]));
        let [added_force, added_stiffness, added_damping] = ADDED_RANGES;
        [
            force,
            position,
            base,
            grip,
            TRIM_RANGE,
            FACTOR_RANGE,
            SHAKER_SWING,
            (0.0, 1.0),
            added_force,
            added_stiffness,
            added_damping,
        ]
    }

    /// What the law of each setting remembers in equilibrium.
    fn still(&self, shared: &Shared) -> Still<Vec<f64>> {
        let of = |setting| with_drive!(self.kind(), K => self.still_of::<K>(shared, setting));
        let all: Vec<Still<f64>> = (0..self.values.len()).map(of).collect();
        core::array::from_fn(|k| core::array::from_fn(|part| all.iter().map(|still| still[k][part]).collect()))
    }

    /// Play and cogging are left out: where in them the drive hangs, load cell and column do not show.
    fn still_of<K: Kind>(&self, shared: &Shared, setting: usize) -> Still<f64> {
        let mut parameters = self.parameters(|_, of| of(setting));
        (parameters.linkage.backlash, parameters.transmission.backlash) = (0.0, 0.0);
        let shared = Shared {
            effects: Effects { saturation: false, ..shared.effects.smooth() },
            cancellation: None,
            ..shared.clone()
        };
        let machine = machine::<f64, K>(&parameters, self.observer(|_, of| of(setting)), &shared);
        // What the sensors show, and what the law remembers, base, load cell or neutral aside.
        let at = |aside: [f64; SHOWN]| -> ([f64; SHOWN], [f64; MOST_STATES + 3]) {
            let equilibrium = machine.standing_at(&shared, aside);
            let [force, _, base, _] = machine.shown_at_rest(&shared.effects, &equilibrium);
            let memory = machine.remember(&shared, &equilibrium);
            let remembered = memory.control();
            let beside = [remembered.position, remembered.friction_state.feel_torque, equilibrium.delta()];
            let numbers =
                core::array::from_fn(
                    |k| if k < MOST_STATES { remembered.estimate[k] } else { beside[k - MOST_STATES] },
                );
            ([base, force, aside[2]], numbers)
        };
        let none = at([0.0; SHOWN]);
        let aside: [_; SHOWN] =
            core::array::from_fn(|k| at(core::array::from_fn(|j| if j == k { ASIDE[k] } else { 0.0 })));
        core::array::from_fn(|number| {
            let per: [f64; SHOWN] =
                core::array::from_fn(|k| (aside[k].1[number] - none.1[number]) / (aside[k].0[k] - none.0[k]));
            let at_zero = none.1[number] - (0..SHOWN).map(|k| per[k] * none.0[k]).sum::<f64>();
            [at_zero, per[0], per[1], per[2]]
        })
    }

    /// Traces a period.
    pub fn period(&self) -> Program {
        let ((outputs, numbers, next), graph) = self.traced(|shared, control| {
            let mut inputs = Inputs::NONE;
            for (k, input) in
                [&mut inputs.trim, &mut inputs.stiffness_factor, &mut inputs.shaker].into_iter().enumerate()
            {
                *input = [input_as_f64(TRIM + k); 2];
            }
            if self.values.len() > 1 {
                inputs.fade = [input_as_f64(SHARE); 2];
            }
            if self.linked || self.has_surface() {
                let added = [&mut inputs.added_force, &mut inputs.added_stiffness, &mut inputs.added_damping];
                for (k, input) in added.into_iter().enumerate() {
                    *input = [input_as_f64(ADDED + k); 2];
                }
            }
            Trace::section("inputs");
            let (mut feeling, mut remembered) = state();
            let zero = Trace::known(&vec![0.0; self.values.len()], Bank::All);
            let sample = Sample { sensors: core::array::from_fn(Trace::input), pilot_force: zero };
            // The place of a supervisor: it may put another command in place of the law's.
            let mut torque = zero;
            let e = control.command(shared, (&mut feeling, &mut remembered), &inputs, &sample, |answer| {
                torque = answer.torque;
                None
            });
            let [delta, rate] = feeling.motion.at;
            let limited = control.within_range(e);
            let outputs =
                vec![("command", limited.0), ("torque", torque.0), ("feel_angle", delta.0), ("feel_rate", rate.0)];
            let numbers = [e, torque, delta, rate].map(|number| number.0).to_vec();
            (outputs, numbers, next(&feeling, &remembered))
        });
        Program { graph, outputs, numbers, next }
    }

    /// Whether a flight acts on the loader.
    pub fn has_surface(&self) -> bool {
        self.values.iter().any(|values| Parameters::from_values(values).surface.is_there())
    }

    /// Traces what the surface, the same in all settings, adds to the feel in a flight.
    pub fn hinge_moment(&self) -> Program {
        let (outputs, graph) = traced(self.single, 1, None, || {
            Trace::section("surface");
            let parameters = self.parameters(|row, of| Trace::known(&[of(0)], Bank::From).of_row(row));
            let given: [Trace; FLIGHT.len()] = core::array::from_fn(|k| Trace::input(FIRST_OF_FLIGHT + k));
            let names = ["added_force", "added_stiffness", "added_damping"];
            names.into_iter().zip(added(&parameters, given).map(|number| number.0)).collect::<Vec<_>>()
        });
        let numbers = outputs.iter().map(|&(_, node)| node).collect();
        Program { graph, outputs, numbers, next: Vec::new() }
    }

    /// Force, spring and damping that the surface adds in flights and at angles in the order of [`FLIGHT`].
    pub fn added(&self, given: &[[f64; FLIGHT.len()]]) -> Vec<[f64; 3]> {
        if self.single { self.added_in(0.0f32, given) } else { self.added_in(0.0f64, given) }
    }

    fn added_in<S: Scalar + Into<f64>>(&self, like: S, given: &[[f64; FLIGHT.len()]]) -> Vec<[f64; 3]> {
        let parameters = self.parameters(|_, of| like.constant(of(0)));
        let added = |row: &[f64; FLIGHT.len()]| added(&parameters, row.map(|number| like.constant(number)));
        given.iter().map(|row| added(row).map(Into::into)).collect()
    }

    /// Traces the start at rest where the column stands.
    pub fn reset(&self) -> Program {
        let (next, graph) = self.traced(|shared, control| {
            Trace::section("rest");
            let still = self.still(shared).map(|pair| pair.map(|of| number(&of, Bank::From)));
            let (feeling, remembered) = resting(control, &still, [BASE, FORCE, TRIM].map(Trace::input));
            next(&feeling, &remembered)
        });
        Program { graph, outputs: Vec::new(), numbers: Vec::new(), next }
    }

    fn traced<T>(&self, work: impl FnOnce(&Shared, &Control<Trace>) -> T) -> (T, Graph) {
        traced(self.single, self.values.len(), Some(SHARE), || {
            let shared = self.shared();
            let control = with_drive!(self.kind(), K => self.tracing::<K>(&shared, true));
            work(&shared, &control)
        })
    }

    /// Law, feel and converters of numbers that write down; the law's matrices as tables, or as numbers like the others.
    pub(crate) fn tracing<K: Kind>(&self, shared: &Shared, tables: bool) -> Control<Trace> {
        Trace::section("tuning");
        let all = |of: &dyn Fn(usize) -> f64| (0..self.values.len()).map(of).collect::<Vec<_>>();
        let bank = |bank: Bank| {
            let law = self.observer(|place, of| {
                let numbers = all(of);
                let number = if tables && self.is_of_matrices(place) {
                    number(&numbers, bank)
                } else {
                    Trace::known(&numbers, bank)
                };
                number.of_row(COUNT + part_of(place).0)
            });
            let parameters = self.parameters(|row, of| {
                let tuned = self.tunable.iter().any(|&(tuned, _)| tuned == row);
                if tuned { Trace::input(FIRST_OF_TUNING + row) } else { Trace::known(&all(of), bank) }.of_row(row)
            });
            (parameters, law)
        };
        let ((from, law), (to, next_law)) = (bank(Bank::From), bank(Bank::To));
        let mut control = control::<_, K>(&from, law, shared);
        control.fade_to(&to, Some(&next_law));
        control
    }

    /// Whether a number of the law is one of its matrices' that the law has states for.
    fn is_of_matrices(&self, place: usize) -> bool {
        let n = self.states;
        let is_computed = |k: usize| k < n || k >= MOST_STATES;
        let (part, k) = part_of(place);
        match part {
            0 => k / MOST_STATES < n && k % MOST_STATES < n,
            1 | 4 => k / WIDE < n,
            2 | 3 | 6 => is_computed(k),
            5 => true,
            7 => k < n,
            _ => false,
        }
    }
}

const KNOWN: usize = MOST_STATES + SAMPLED + 2;
const WIDE: usize = SAMPLED + 1;

/// The parts of a law's numbers in their order, and how many numbers each has.
const LAW_PARTS: [(&str, usize); 10] = [
    ("law.transition", MOST_STATES * MOST_STATES),
    ("law.input", MOST_STATES * WIDE),
    ("law.command", KNOWN),
    ("law.torque", KNOWN),
    ("law.settled", MOST_STATES * WIDE),
    ("law.neutral", 2),
    ("law.friction_rate", KNOWN),
    ("law.friction_xi", MOST_STATES),
    ("law.friction", FRICTION_NUMBERS - KNOWN - MOST_STATES),
    ("law.contact", CONTACT_NUMBERS),
];

/// The part that a number of the law is in, and its place there.
fn part_of(place: usize) -> (usize, usize) {
    let (mut part, mut k) = (0, place);
    while k >= LAW_PARTS[part].1 {
        k -= LAW_PARTS[part].1;
        part += 1;
    }
    (part, k)
}

/// The name of a row by its place: of the parameter table, or of a part of the law's numbers.
pub fn row_name(row: usize) -> String {
    match row.checked_sub(COUNT) {
        None => format!("{}.{}", TABLE[row].part, TABLE[row].name),
        Some(part) => LAW_PARTS[part].0.to_owned(),
    }
}

/// Force, spring and damping that a surface adds in a flight and at an angle in the order of [`FLIGHT`].
fn added<S: Scalar>(parameters: &Parameters<S>, given: [S; FLIGHT.len()]) -> [S; 3] {
    let flight = FlightState::from_numbers(core::array::from_fn(|k| given[k]));
    let Added { force, stiffness, damping } = parameters.hinge_moment(&flight, given[FLIGHT.len() - 1]);
    [force, stiffness, damping]
}

/// A number that stays data, but for what is zero under every setting: that is no work.
fn number(values: &[f64], bank: Bank) -> Trace {
    let works = values.iter().any(|&value| value != 0.0);
    if works { Trace::data(values, bank) } else { Trace::known(values, bank) }
}

/// One loader under a law.
pub(crate) fn machine<S: Scalar, K: Kind>(
    parameters: &Parameters<S>,
    law: Observer<S>,
    shared: &Shared,
) -> Machine<S, K::Of<S>> {
    let gains = Compensator::state_feedback(parameters, [parameters.column.inertia.zero(); 7]);
    Machine::new(parameters, gains, shared).with_observer(law)
}

/// Law, feel and converters of one loader.
fn control<S: Scalar, K: Kind>(parameters: &Parameters<S>, law: Observer<S>, shared: &Shared) -> Control<S> {
    *machine::<S, K>(parameters, law, shared).control()
}

/// What a law remembers in equilibrium: its state, then the drive's position, the torque that the feel receives and the feel's displacement;
/// each with base, load cell and neutral at zero, per displacement of the base, per force that the load cell shows and per angle of the neutral.
type Still<T> = [[T; 1 + SHOWN]; MOST_STATES + 3];

/// Base, load cell, neutral: what tells one equilibrium from another.
const SHOWN: usize = 3;

/// Small angle and force, in rad and N, at which the equilibria are taken whose differences are [`Still`]: they are linear.
const ASIDE: [f64; SHOWN] = [0.1, 10.0, 0.1];

/// The controller in the equilibrium of base, load cell and neutral, as a run begins.
///
/// The drive's sensor does not count: a law that integrates would make volts of what it and the column's are apart.
fn resting<S: Scalar>(control: &Control<S>, still: &Still<S>, shown: [S; SHOWN]) -> (FeelState<S>, LawState<S>) {
    let [base, force, trim] = shown;
    let zero = trim.zero();
    let mut feeling = control.resting(zero, zero);
    let [estimate @ .., position, feel_torque, delta] = still.map(|[at_zero, per_base, per_force, per_trim]| {
        at_zero + per_base * base + per_force * force + per_trim * trim
    });
    // Under a law with an observer the feel's displacement is an angle.
    (feeling.motion.at[0], feeling.motion.slider, feeling.neutral) = (delta, delta, trim);
    let friction_state = FrictionState::initial(feel_torque);
    let contact_state = ContactState::free(feel_torque, base * control.per_base());
    (feeling, LawState { base, position, estimate, friction_state, contact_state })
}

/// Name of each number that a controller remembers, and whether it is a flag.
fn remembered() -> &'static [(&'static str, bool)] {
    static NAMES: OnceLock<Vec<(&str, bool)>> = OnceLock::new();
    NAMES.get_or_init(|| {
        let mut names = Names(Vec::new());
        visit(&mut nothing(0.0, false), &mut names);
        names.0
    })
}

/// A memory of nothing.
fn nothing<S: Scalar>(zero: S, stuck: S::Mask) -> (FeelState<S>, LawState<S>) {
    let grip = StickState { stuck, drag: zero, velocity: zero, pull: zero };
    let motion = FeelMotion { at: [zero; 2], grip, slider: zero };
    let law = LawState {
        base: zero,
        position: zero,
        estimate: [zero; MOST_STATES],
        friction_state: FrictionState::initial(zero),
        contact_state: ContactState::free(zero, zero),
    };
    (FeelState { motion, neutral: zero }, law)
}

/// Visits each number that a controller remembers, in the order of the places.
fn visit<S: Scalar>((feeling, remembered): &mut (FeelState<S>, LawState<S>), visitor: &mut impl MemoryVisitor<S>) {
    remembered.visit_samples(visitor);
    feeling.visit(visitor);
    remembered.visit_estimate(visitor);
}

/// Notes names.
struct Names(Vec<(&'static str, bool)>);

impl<S: Scalar> MemoryVisitor<S> for Names {
    fn number(&mut self, name: &'static str, _: &mut S) {
        self.0.push((name, false));
    }

    fn flag(&mut self, name: &'static str, _: &mut S::Mask) {
        self.0.push((name, true));
    }
}

/// Replaces each number by the input of the next place.
struct ToInputs(usize);

impl MemoryVisitor<Trace> for ToInputs {
    fn number(&mut self, _: &'static str, number: &mut Trace) {
        *number = Trace::input(self.0);
        self.0 += 1;
    }

    fn flag(&mut self, _: &'static str, flag: &mut Mask) {
        *flag = Mask::flag(self.0);
        self.0 += 1;
    }
}

/// Notes the node of each number.
struct Nodes(Vec<u32>);

impl MemoryVisitor<Trace> for Nodes {
    fn number(&mut self, _: &'static str, number: &mut Trace) {
        self.0.push(number.0);
    }

    fn flag(&mut self, _: &'static str, flag: &mut Mask) {
        self.0.push(flag.0);
    }
}

/// The state, as inputs.
fn state() -> (FeelState<Trace>, LawState<Trace>) {
    let first = INPUTS.len();
    let mut state = nothing(Trace::input(first), Mask::flag(first));
    visit(&mut state, &mut ToInputs(first));
    state
}

/// The state by places.
fn next(feeling: &FeelState<Trace>, remembered: &LawState<Trace>) -> Vec<(usize, u32)> {
    let mut nodes = Nodes(Vec::new());
    visit(&mut (*feeling, *remembered), &mut nodes);
    nodes.0.into_iter().enumerate().map(|(k, node)| (INPUTS.len() + k, node)).collect()
}

/// What a controller answers sample by sample, from rest at the first sample's sensors: command, torque, displacement, rate.
pub fn answers(job: &Job, given: &[Given]) -> Vec<[f64; ANSWERS]> {
    let Some(first) = given.first() else { return Vec::new() };
    if job.single { run(job, 0.0f32, first, given) } else { run(job, 0.0f64, first, given) }
}

fn run<S: Scalar + Into<f64>>(job: &Job, like: S, first: &Given, given: &[Given]) -> Vec<[f64; ANSWERS]> {
    let mut controller = Controller::new(job, like, first);
    given.iter().map(|one| controller.step(one).map(Into::into)).collect()
}

/// A controller that computes.
#[derive(Debug)]
pub struct Controller<S: Scalar> {
    shared: Shared,
    parts: Vec<(Parameters<S>, Observer<S>, Control<S>)>,
    state: (FeelState<S>, LawState<S>),
    like: S,
}

impl<S: Scalar> Controller<S> {
    /// At rest at a sample's sensors.
    pub fn new(job: &Job, like: S, first: &Given) -> Self {
        with_drive!(job.kind(), K => Self::with::<K>(job, like, first))
    }

    fn with<K: Kind>(job: &Job, like: S, first: &Given) -> Self {
        let shared = job.shared();
        let parts: Vec<_> = (0..job.values.len())
            .map(|setting| {
                let parameters = job.parameters(|_, of| like.constant(of(setting)));
                let law = job.observer(|_, of| like.constant(of(setting)));
                (parameters, law, control::<S, K>(&parameters, law, &shared))
            })
            .collect();
        let from = first.settings.0;
        let still = job.still(&shared).map(|pair| pair.map(|of| like.constant(of[from])));
        let shown = [BASE, FORCE, TRIM].map(|place| like.constant(first.inputs[place]));
        let state = resting(&parts[from].2, &still, shown);
        Self { shared, parts, state, like }
    }

    /// Angle and rate of the programmed control.
    pub fn programmed(&self) -> [S; 2] {
        self.state.0.motion.at
    }

    /// A period: command, torque, displacement, rate.
    pub fn step(&mut self, given: &Given) -> [S; ANSWERS] {
        let (from, to) = given.settings;
        let mut control = self.parts[from].2;
        control.fade_to(&self.parts[to].0, Some(&self.parts[to].1));
        let [.., trim, stiffness_factor, shaker, fade, added_force, added_stiffness, added_damping] =
            given.inputs.map(|input| [input; 2]);
        let inputs = Inputs {
            trim,
            stiffness_factor,
            shaker,
            fade,
            added_force,
            added_stiffness,
            added_damping,
            ..Inputs::NONE
        };
        let sensors = core::array::from_fn(|k| self.like.constant(given.inputs[k]));
        let sample = Sample { sensors, pilot_force: self.like.zero() };
        let mut torque = self.like;
        let e = control.command(&self.shared, (&mut self.state.0, &mut self.state.1), &inputs, &sample, |answer| {
            torque = answer.torque;
            None
        });
        let [delta, rate] = self.programmed();
        [control.within_range(e), torque, delta, rate]
    }
}
