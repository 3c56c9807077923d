//! C99 from what was traced: a law's parts, and its numbers.

use crate::blocks::{Blocks, Operands};
use crate::body::Body;
use crate::controller::{Job, Program, is_flag, name_of, place_of};
use crate::operands::operands_of;
use crate::statement::{Statement, Value, What, marked, text};
use crate::stores::{Store, interleaved};
use crate::trace::{Node, Origin};
use crate::writer::{Numbers, Writer};
use std::collections::BTreeSet;

/// A law as C: the parts of its files that follow from the trace.
#[derive(Debug, Clone, Default)]
pub struct Source {
    /// Name of each state that the law needs, and whether it is a flag.
    pub states: Vec<(String, bool)>,
    /// The inputs that it reads, and between which values.
    pub inputs: Vec<(String, (f64, f64))>,
    /// Functions that a period calls.
    pub functions: Vec<String>,
    /// Body of a period.
    pub step: String,
    /// The start at rest.
    pub reset: String,
    /// Body of what a surface adds in a flight; empty without one.
    pub hinge_moment: String,
    /// Tables that are the same in all settings.
    pub same: Numbers,
    /// A setting's own numbers.
    pub own: Numbers,
    /// Operations of a period as written, and those of the loops over data.
    pub operations: (usize, usize),
}

/// Displacement and rate of the feel, which are given out.
const GIVEN: [&str; 2] = ["delta", "delta_rate"];

impl Source {
    /// The law of a job; the names of C begin with `name`.
    pub fn of(job: &Job, name: &str) -> Self {
        let (step, reset) = (job.period(), job.reset());
        let given = GIVEN.iter().filter_map(|name| place_of(name)).collect();
        let states = needed(&step, given);
        let mut writer = Writer::new(name, job.single);
        let (step_text, operations) = program(&mut writer, &step, &states, true);
        let (reset_text, _) = program(&mut writer, &reset, &states, false);
        let hinge_moment = if job.has_surface() { body_of(&mut writer, &job.hinge_moment()) } else { String::new() };
        let (same, own) = writer.data(job.values.len());
        let name = |&place: &usize| (name_of(place).to_owned(), is_flag(place));
        let ranges = job.ranges();
        Self {
            states: states.iter().map(name).collect(),
            inputs: writer.inputs.iter().map(|&place| (name_of(place).to_owned(), ranges[place])).collect(),
            functions: writer.functions.iter().map(ToString::to_string).collect(),
            step: text(&step_text),
            reset: text(&reset_text),
            hinge_moment,
            same,
            own,
            operations,
        }
    }
}

/// The lines of a program without states.
pub fn body_of(writer: &mut Writer, of: &Program) -> String {
    text(&program(writer, of, &BTreeSet::new(), true).0)
}

/// The states that are given out, and those that a program reads, directly or by others.
pub(crate) fn needed(program: &Program, given: BTreeSet<usize>) -> BTreeSet<usize> {
    let graph = &program.graph;
    let of = (0..graph.nodes.len()).map(|place| operands_of(graph, place)).collect();
    let operands = Operands { of, ..Operands::default() };
    let all: BTreeSet<usize> = program.next.iter().map(|&(place, _)| place).collect();
    let mut states = given;
    loop {
        let mut more = states.clone();
        // Placed, since a choice within an arm of its own mask reads nothing of its other arm.
        let blocks = Blocks::of(graph, &operands, &wanted(program, &states));
        more.extend(blocks.of.keys().filter_map(|&node| match graph.nodes[node as usize] {
            Node::Input(state) | Node::Flag(state) | Node::Word(state) if all.contains(&state) => Some(state),
            _ => None,
        }));
        if more == states {
            return states;
        }
        states = more;
    }
}

/// What a state is called.
fn kept(writer: &Writer, place: usize) -> String {
    writer.of_axis(place).map_or_else(|| name_of(place), |(_, name)| name).to_owned()
}

/// Outputs and next states.
fn wanted(program: &Program, states: &BTreeSet<usize>) -> Vec<u32> {
    let next = program.next.iter().filter(|(place, _)| states.contains(place)).map(|&(_, node)| node);
    program.outputs.iter().map(|&(_, node)| node).chain(next).collect()
}

/// The statements of a program, and its operations: as written, and in loops. If `checked`, and a result is no
/// number, no output is written and the feel stays as it was.
pub(crate) fn program(
    writer: &mut Writer,
    program: &Program,
    states: &BTreeSet<usize>,
    checked: bool,
) -> (Vec<Statement>, (usize, usize)) {
    let graph = &program.graph;
    let next = program.next.iter().filter(|(place, _)| states.contains(place));
    let next: Vec<(u32, String, usize)> = next.map(|&(place, node)| (node, kept(writer, place), place)).collect();
    let called = next.iter().map(|(node, name, _)| (*node, format!("next_{name}")));
    let outputs = program.outputs.iter().map(|&(what, node)| (node, what.replace('[', "_").replace(']', "")));
    let mut body = Body::of(writer, graph, &wanted(program, states), &called.chain(outputs).collect::<Vec<_>>());
    body.write_all();
    let result = |pointer, name: &str, value: &str| {
        let what = What::Says(format!("{}->{name} = {value};", marked(pointer)));
        Statement { origin: RESULT, what }
    };
    let results = program.outputs.iter().map(|&(what, node)| result("out", what, &body.spelled(node)));
    let mut results: Vec<Statement> = results.collect();
    let mut stores = Vec::new();
    for (node, name, place) in next {
        let node_of = &graph.nodes[node as usize];
        if !matches!(node_of, &Node::Input(same) | &Node::Flag(same) | &Node::Word(same) if same == place) {
            let value = body.spelled(node);
            if checked && GIVEN.contains(&&*name) {
                results.push(result("state", &name, &value));
            } else {
                stores.push(Store { statement: result("state", &name, &value), name, value });
            }
        }
    }
    let sum: Vec<String> = program.numbers.iter().map(|&node| body.spelled(node)).collect();
    let (statements, operations) = body.statements();
    let mut statements = interleaved(statements, stores);
    if checked {
        let good = Value { kind: "bool".to_owned(), name: "good".to_owned(), size: String::new() };
        let is_number = What::Makes(good, format!("{}_is_number({});", writer.name, sum.join(" + ")));
        let of_good = What::Branches(vec![("if (good) {".to_owned(), results)]);
        let what = [is_number, of_good, What::Says("return good;".to_owned())];
        statements.extend(what.map(|what| Statement { origin: RESULT, what }));
    } else {
        statements.extend(results);
    }
    (statements, operations)
}

/// Where what is given out and kept comes from.
const RESULT: Origin = Origin { section: "result", file: "" };
