//! The period of an axis in functions: 3,400 lines in a row are more than a reader, or a checker of rules, can follow.
//!
//! A function holds consecutive statements; long arms of branches are cut alike. A value that several functions use is a member of a
//! structure, and each reads states and inputs by itself. The operations and their order stay those of the trace.

use crate::statement::{Lines, Statement, Value, What, size};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Lines of an arm or a period that is not cut, and of most functions.
const LONGEST: usize = 400;
/// Lines after which a function ends where its section does.
const ENOUGH: usize = 250;

/// Pointers that functions are given, in their order, and their types.
const POINTERS: [(&str, &str); 6] = [
    ("state", "state"),
    ("from", "setting"),
    ("to", "setting"),
    ("in", "input"),
    ("out", "output"),
    ("between", "values"),
];
/// Place of what passes between functions, and of what every period has, with whether it writes through them.
const BETWEEN: usize = 5;
const OF_PERIOD: [(usize, bool); 3] = [(0, true), (3, false), (4, true)];

/// A period in functions.
#[derive(Debug, Clone)]
pub struct Period {
    /// Type and name of each value that passes between functions.
    pub members: Vec<(String, String)>,
    /// The functions, each before its callers; the last is the period itself.
    pub code: String,
}

/// A function and its statements.
type Function = (String, Vec<Statement>);

/// The pointers of a function by their places in [`POINTERS`], and whether it writes through them.
type Given = BTreeMap<usize, bool>;

impl Period {
    /// The statements of a period in functions, the first of them with this number; the names of C begin with `name`.
    pub fn of(statements: Vec<Statement>, name: &str, first: usize) -> Self {
        let (mut reads, others): (Vec<_>, _) =
            statements.into_iter().partition(|of| matches!(of.what, What::Reads(..)));
        // Each function begins with what it reads.
        if let Some(origin) = reads.iter().map(|read| read.origin).find(|origin| origin.section == "inputs") {
            for read in &mut reads {
                read.origin = origin;
            }
        }
        let mut cut = Cut { name, next: first, functions: Vec::new() };
        let body = cut.shortened(others);
        let mut functions = cut.functions;
        functions.push((format!("{name}_period"), body));
        let members = members(&functions);
        let mut writer = Writer {
            name,
            reads: reads.iter().filter_map(|read| Some((&*read.declared()?.name, read))).collect(),
            arrays: members.iter().filter(|of| !of.size.is_empty()).map(|of| &*of.name).collect(),
            given: HashMap::new(),
            lines: Lines::passing(members.iter().map(|of| of.name.clone())),
        };
        for function in &functions {
            writer.write(function);
        }
        let code = writer.lines.text;
        let member = |of: &Value| (of.kind.clone(), format!("{}{}", of.name, of.size));
        Self { members: members.iter().map(member).collect(), code }
    }
}

/// Functions that were cut out, each before its callers.
struct Cut<'a> {
    name: &'a str,
    next: usize,
    functions: Vec<Function>,
}

impl Cut<'_> {
    /// Statements, with calls where they or an arm in them are long.
    fn shortened(&mut self, statements: Vec<Statement>) -> Vec<Statement> {
        let shorter = |Statement { origin, what }| {
            let what = match what {
                What::Branches(arms) => {
                    What::Branches(arms.into_iter().map(|(head, arm)| (head, self.shortened(arm))).collect())
                }
                other => other,
            };
            Statement { origin, what }
        };
        let shorter: Vec<Statement> = statements.into_iter().map(shorter).collect();
        if size(&shorter) <= LONGEST {
            return shorter;
        }
        groups(shorter).into_iter().map(|group| self.function(group)).collect()
    }

    fn function(&mut self, group: Vec<Statement>) -> Statement {
        let origin = group[0].origin;
        let section = origin.section;
        let name = format!("{}_{section}_{}", self.name, self.next);
        self.next += 1;
        self.functions.push((name.clone(), group));
        Statement { origin, what: What::Calls(name) }
    }
}

/// Consecutive statements that become a function each; the outputs and states are written in the last.
fn groups(statements: Vec<Statement>) -> Vec<Vec<Statement>> {
    let mut groups: Vec<Vec<Statement>> = vec![Vec::new()];
    for statement in statements {
        let group = groups.last().map_or(&[][..], Vec::as_slice);
        if let Some(last) = group.last() {
            let (size, is_result) = (size(group), statement.origin.section == "result");
            let ends = statement.origin.section != last.origin.section && (size >= ENOUGH || is_result);
            let full = !is_result && size + statement.size() > LONGEST;
            if (ends || full) && !matches!(last.what, What::Declares(_)) {
                groups.push(Vec::new());
            }
        }
        if let Some(group) = groups.last_mut() {
            group.push(statement);
        }
    }
    groups
}

/// Each value that a function declares and another uses.
fn members(functions: &[Function]) -> Vec<Value> {
    let mut declared: Vec<(usize, &Value)> = Vec::new();
    let mut used: HashSet<(&str, usize)> = HashSet::new();
    for (function, (_, statements)) in functions.iter().enumerate() {
        for statement in statements {
            statement.visit(&mut |inner| {
                declared.extend(inner.declared().map(|value| (function, value)));
                used.extend(inner.names().into_iter().map(|name| (name, function)));
            });
        }
    }
    let passes =
        |&(of, value): &(usize, &Value)| (0..functions.len()).any(|k| k != of && used.contains(&(&value.name, k)));
    declared.into_iter().filter(passes).map(|(_, value)| value.clone()).collect()
}

/// The lines of the functions, each given the pointers that it or those that it calls need.
struct Writer<'a> {
    name: &'a str,
    reads: HashMap<&'a str, &'a Statement>,
    arrays: HashSet<&'a str>,
    given: HashMap<&'a str, Given>,
    lines: Lines,
}

impl<'a> Writer<'a> {
    /// A function, after those that it calls; the last has the values that pass, and is called from outside.
    fn write(&mut self, (function, statements): &'a Function) {
        let (mut given, mut reads) = (Given::new(), Vec::new());
        for statement in statements {
            statement.visit(&mut |inner| {
                self.needs(inner, &mut given);
                reads.extend(inner.names().into_iter().filter_map(|name| self.reads.get(name).copied()));
            });
        }
        let is_period = *function == format!("{}_period", self.name);
        if is_period {
            given.remove(&BETWEEN);
            given.extend(OF_PERIOD);
        }
        let pointer = |(place, writes): (&usize, &bool)| {
            let (argument, of) = POINTERS[*place];
            format!("{}{}_{of} *{argument}", if *writes { "" } else { "const " }, self.name)
        };
        let parameters = given.iter().map(pointer).collect::<Vec<_>>().join(", ");
        let kind = if is_period { "static".to_owned() } else { format!("{}_INLINE", self.name) };
        self.lines.line(0, &format!("{kind} void {function}({parameters})\n{{"));
        if is_period && !self.lines.members.is_empty() {
            self.lines.line(1, &format!("{0}_values values;\n    {0}_values *const between = &values;", self.name));
        }
        let mut seen = HashSet::new();
        reads.retain(|read| seen.insert(core::ptr::from_ref(*read)));
        self.lines.section = "";
        self.lines.write(&reads.into_iter().cloned().collect::<Vec<_>>(), 1);
        self.lines.write(statements, 1);
        self.lines.line(0, "}\n");
        let arguments = given.keys().map(|&place| POINTERS[place].0).collect::<Vec<_>>().join(", ");
        self.lines.calls.insert(function.clone(), format!("{function}({arguments});"));
        self.given.insert(function, given);
    }

    /// The pointers that a statement needs.
    fn needs(&self, statement: &Statement, given: &mut Given) {
        if let What::Calls(called) = &statement.what {
            for (&place, &writes) in &self.given[&**called] {
                *given.entry(place).or_default() |= writes;
            }
        }
        let place = |pointer: &str| POINTERS.iter().position(|(argument, _)| *argument == pointer);
        for name in statement.names() {
            let (place, writes) = if let Some(read) = self.reads.get(name) {
                (read.names().into_iter().find_map(place), false)
            } else if self.lines.members.contains(name) {
                // A function that is given an array writes there.
                (Some(BETWEEN), statement.written() == Some(name) || self.arrays.contains(name))
            } else {
                (place(name), ["state", "out"].contains(&name))
            };
            if let Some(place) = place {
                *given.entry(place).or_default() |= writes;
            }
        }
    }
}
