//! One axis as C: law and feel under their supervisor, from the very lines that the live loop and a target board run.

use crate::controller::{Job, Program, machine};
use crate::emit::{needed, program};
use crate::functions::Period;
use crate::trace::logic::{Kind, NodeVisitor, Visiting, Word};
use crate::trace::{Bank, Mask, Node, Trace, traced};
use crate::writer::{FIRST_OF_AXIS, Numbers, Writer};
use forcefeel_model::Scalar;
use forcefeel_model::axis::{Axis, AxisInput};
use forcefeel_model::drive::Kind as Drive;
use forcefeel_model::logic::LogicState;
use forcefeel_model::machine::Shared;
use forcefeel_model::modifiers::{FeelModifiers, ModifierRates};
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::supervisor::{Limits, Refusal, Supervisor};
use forcefeel_model::transducers::SENSORS;
use forcefeel_model::with_drive;
use std::collections::BTreeSet;

/// Inputs of an axis, in this order, by what each is.
const AXIS_INPUTS: [(&str, Kind); 21] = [
    ("force", Kind::Number),
    ("position", Kind::Number),
    ("base", Kind::Number),
    ("grip", Kind::Number),
    ("trim", Kind::Number),
    ("stiffness_factor", Kind::Number),
    ("shaker", Kind::Number),
    (BLEND, Kind::Number),
    ("added_force", Kind::Number),
    ("added_stiffness", Kind::Number),
    ("added_damping", Kind::Number),
    ("request", Kind::Word),
    ("missed", Kind::Word),
    ("delay", Kind::Word),
    ("late", Kind::Word),
    ("host_age", Kind::Word),
    ("host", Kind::Flag),
    ("emergency_stop", Kind::Flag),
    ("drive_fault", Kind::Flag),
    ("drive_acts", Kind::Flag),
    ("acknowledged", Kind::Flag),
];

/// How far one setting of the feel has been changed into another.
const BLEND: &str = "blend";

/// A state of an axis in C.
#[derive(Debug, Clone)]
pub struct AxisState {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// What it is where the axis is off.
    pub first: f64,
}

/// An axis as C: the parts of its files that follow from the trace.
#[derive(Debug, Clone)]
pub struct AxisSource {
    /// Its states.
    pub states: Vec<AxisState>,
    /// Functions that a period calls.
    pub functions: Vec<String>,
    /// A period.
    pub period: Period,
    /// A setting's own numbers.
    pub own: Numbers,
    /// Operations of a period.
    pub operations: usize,
}

impl AxisSource {
    /// The axis of a job; the names of C begin with `name`.
    ///
    /// # Errors
    /// If there are no limits that a supervisor could hold the loader to.
    pub fn of(job: &Job, name: &str) -> Result<Self, Refusal> {
        let parameters = job.parameters(|_, of| of(0));
        let limits = Limits::new(&parameters, job.kind(), job.period_s)?;
        let period = TracedPeriod::without_constants(job, &limits);
        let mut writer = Writer::new(name, job.single);
        writer.axis = AXIS_INPUTS.iter().map(|&(name, _)| ("in", name.to_owned())).collect();
        writer.axis.extend(period.states.iter().map(|state| ("state", state.name.clone())));
        let states = needed(&period.program, BTreeSet::new());
        let (statements, (operations, _)) = program(&mut writer, &period.program, &states, false);
        let states = states.iter().map(|place| period.states[place - FIRST_OF_AXIS - AXIS_INPUTS.len()].clone());
        Ok(Self {
            states: states.collect(),
            functions: writer.functions.iter().map(ToString::to_string).collect(),
            period: Period::of(statements, name, writer.functions.len() + 1),
            own: writer.data(job.values.len()).1,
            operations,
        })
    }
}

/// A period that was traced, and its states.
struct TracedPeriod {
    program: Program,
    states: Vec<AxisState>,
    /// The node of each state where the axis is off.
    first: Vec<u32>,
}

impl TracedPeriod {
    fn of<K: Drive>(job: &Job, limits: (&Limits, &[BTreeSet<usize>]), constant: &BTreeSet<usize>) -> Self {
        let shared = job.shared();
        let at_rest = at_rest::<K>(job, &shared);
        let settings = job.values.len();
        // An axis that is off is in the first setting.
        let off =
            Job { values: vec![job.values[0]; settings], observers: vec![job.observers[0]; settings], ..job.clone() };
        let share = (settings > 1).then(|| place_of_input(BLEND));
        let ((outputs, next, states, first), graph) = traced(job.single, settings, share, || {
            // Where the law begins is a linear equation of its matrices: with numbers that are known, it is solved here.
            let control = job.tracing::<K>(&shared, false);
            let off = off.tracing::<K>(&shared, false);
            let known = |value: f64| Trace::known(&vec![value; settings], Bank::All);
            let mut rows = limits.1.iter();
            let limits = limits.0.made_by(|number| {
                rows.next().into_iter().flatten().fold(known(number), |number, &row| number.of_row(row))
            });
            let parameters = job.parameters(|row, of| known(of(0)).of_row(row));
            let feel = parameters.feel;
            let pace = ModifierRates {
                trim_rate: feel.trim_rate,
                shaker_frequency: feel.shaker_frequency,
                period: known(job.period_s),
            };
            let supervisor = Supervisor::within(limits, known(0.0));
            let mut axis = Axis::new(&off, at_rest.map(|row| row.map(known)), supervisor);
            Trace::section("inputs");
            let given = given(if share.is_some() { Trace::input(place_of_input(BLEND)) } else { known(0.0) });
            let mut states = Visiting(States { constant, parts: Vec::new(), noted: Vec::new(), first: Vec::new() });
            axis.visit(&mut states);
            let (command, allowed) =
                axis.step((&shared, &control), &pace, &given).expect("a supervisor is asked in each period");
            Trace::section("outputs");
            let [angle, rate] = axis.followed().feeling().motion.at.map(|number| number * control.per_delta());
            let outputs = vec![
                ("command", command.0),
                ("torque", axis.followed().answer().torque.0),
                ("feel_angle", angle.0),
                ("feel_rate", rate.0),
                ("enable", allowed.enable.0),
                ("state", allowed.state.0),
                ("acting", Word::bits(&allowed.acting).0),
                ("tripped", Word::bits(&allowed.tripped).0),
                ("host_share", allowed.host_share.0),
            ];
            let mut next = Visiting(Next(Vec::new()));
            axis.visit(&mut next);
            (outputs, next.0.0, states.0.noted, states.0.first)
        });
        let value = |node: u32| match &graph.nodes[node as usize] {
            Node::Known(bits, ..) => f64::from_bits(bits[0]),
            Node::Whole(value, _) => f64::from(*value),
            Node::Holds(values, _) => f64::from(u8::from(values[0])),
            // All follows from numbers that are known.
            other => unreachable!("a state that is off: {other:?}"),
        };
        let states = states.into_iter().zip(&first).map(|(state, &node)| AxisState { first: value(node), ..state });
        let states = states.collect();
        let next = next.into_iter().enumerate().map(|(k, node)| (place_of_state(k), node)).collect();
        Self { program: Program { graph, outputs, numbers: Vec::new(), next }, states, first }
    }

    /// Without the states that stay what they are where the axis is off, whatever the inputs and the others are: of all that may be so, those
    /// that then change are taken out until none does.
    fn without_constants(job: &Job, limits: &Limits) -> Self {
        let rows = rows_of(job, limits);
        let of = |constant: &_| with_drive!(job.kind(), K => Self::of::<K>(job, (limits, &rows), constant));
        let mut constant: BTreeSet<usize> = (0..of(&BTreeSet::new()).first.len()).collect();
        loop {
            let period: Self = of(&constant);
            let count = constant.len();
            constant.retain(|&k| period.program.next[k].1 == period.first[k]);
            if constant.len() == count {
                return period;
            }
        }
    }
}

fn place_of_input(name: &str) -> usize {
    let known = AXIS_INPUTS.iter().position(|(known, _)| *known == name);
    FIRST_OF_AXIS + known.expect("an input of the table")
}

fn place_of_state(k: usize) -> usize {
    FIRST_OF_AXIS + AXIS_INPUTS.len() + k
}

/// What the sensors show at rest at zero and at another angle.
fn at_rest<K: Drive>(job: &Job, shared: &Shared) -> [[f64; SENSORS]; 2] {
    let parameters = job.parameters(|_, of| of(0));
    machine::<f64, K>(&parameters, job.observer(|_, of| of(0)), shared).sensors_at_rest(&shared.effects)
}

/// The rows that each number of the limits follows from: those with which it changes.
fn rows_of(job: &Job, limits: &Limits) -> Vec<BTreeSet<usize>> {
    let list = |limits: &Limits| {
        let mut numbers = Vec::new();
        limits.made_by(|number| numbers.push(number.to_bits()));
        numbers
    };
    let numbers = list(limits);
    let mut rows = vec![BTreeSet::new(); numbers.len()];
    for row in 0..COUNT {
        for aside in ASIDE {
            let mut values = job.values[0];
            values[row] = if values[row] == 0.0 { aside } else { values[row] * (1.0 + aside) };
            let Ok(other) = Limits::new(&Parameters::from_values(&values), job.kind(), job.period_s) else { continue };
            for (rows, _) in rows.iter_mut().zip(numbers.iter().zip(list(&other))).filter(|(_, (a, b))| *a != b) {
                rows.insert(row);
            }
        }
    }
    rows
}

/// Changes of a row by which it is seen what follows from it: a small one, and one that whole samples show.
const ASIDE: [f64; 2] = [1e-3, 0.5];

/// Most letters of a state's name.
const LONGEST: usize = 26;

/// The inputs of a period.
fn given(blend: Trace) -> AxisInput<Trace> {
    let number = |name: &str| Trace::input(place_of_input(name));
    let word = |name: &str| Word::input(place_of_input(name));
    let flag = |name: &str| Mask::flag(place_of_input(name));
    AxisInput {
        sensors: ["force", "position", "base", "grip"].map(number),
        wanted: FeelModifiers {
            trim_rad: number("trim"),
            stiffness_factor: number("stiffness_factor"),
            shaker: number("shaker"),
        },
        blend,
        added: ["added_force", "added_stiffness", "added_damping"].map(number),
        requested: word("request"),
        host: flag("host"),
        host_age: word("host_age"),
        missed: word("missed"),
        delay: word("delay"),
        late: word("late"),
        emergency_stop: flag("emergency_stop"),
        drive_fault: flag("drive_fault"),
        drive_acts: flag("drive_acts"),
        acknowledge: flag("acknowledged"),
    }
}

/// Notes the states and what they are where the axis is off, and puts inputs in their place.
struct States<'a> {
    constant: &'a BTreeSet<usize>,
    parts: Vec<&'static str>,
    noted: Vec<AxisState>,
    first: Vec<u32>,
}

impl NodeVisitor for States<'_> {
    fn node(&mut self, name: &'static str, kind: Kind, node: &mut u32) {
        let k = self.noted.len();
        // Within the letters of a name that C99 tells apart, behind "next_".
        let path = [&self.parts[..], &[name]].concat();
        let name = (usize::from(path.len() > 2)..path.len()).map(|k| path[k..].join("_").replace(' ', "_"));
        let name = name.into_iter().find(|name| name.len() <= LONGEST).expect("a name is short");
        self.noted.push(AxisState { name, kind, first: 0.0 });
        self.first.push(*node);
        if !self.constant.contains(&k) {
            let place = place_of_state(k);
            *node = match kind {
                Kind::Number => Trace::input(place).0,
                Kind::Flag => Mask::flag(place).0,
                Kind::Word => Word::input(place).0,
            };
        }
    }
    fn begin(&mut self, name: &'static str) {
        self.parts.push(name);
    }
    fn end(&mut self) {
        self.parts.pop();
    }
}

/// Notes the nodes of the states after a period.
struct Next(Vec<u32>);

impl NodeVisitor for Next {
    fn node(&mut self, _: &'static str, _: Kind, node: &mut u32) {
        self.0.push(*node);
    }
}
