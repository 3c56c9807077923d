//! Statements of C, before it is known in which function they stand.
//!
//! In their texts the names of values and of arguments stand between marks: where statements are cut into functions, a value that passes
//! between two becomes a member of a structure.

use crate::trace::Origin;
use core::fmt::Write;
use std::collections::{HashMap, HashSet};

/// A name in a text of C.
pub fn marked(name: &str) -> String {
    format!("`{name}`")
}

/// The names in a text.
pub fn names(text: &str) -> impl Iterator<Item = &str> {
    text.split('`').skip(1).step_by(2)
}

/// A value of C.
#[derive(Debug, Clone)]
pub struct Value {
    /// Its type.
    pub kind: String,
    /// Its name.
    pub name: String,
    /// The size of an array, in brackets; else nothing.
    pub size: String,
}

/// What a statement does; a text is what stands to the right, and behind it the rows as a comment.
#[derive(Debug, Clone)]
pub enum What {
    /// Takes a value from the state or the inputs, which is the same wherever it is done.
    Reads(Value, String),
    /// Makes a value.
    Makes(Value, String),
    /// Declares what a branch, a loop or a function fills.
    Declares(Value),
    /// Fills it, or a part of it.
    Fills(String, String),
    /// What its text says.
    Says(String),
    /// Runs one of its arms, each behind its head, or a loop.
    Branches(Vec<(String, Vec<Statement>)>),
    /// Calls a function that was cut out.
    Calls(String),
}

/// A statement.
#[derive(Debug, Clone)]
pub struct Statement {
    /// Where it comes from.
    pub origin: Origin,
    /// What it does.
    pub what: What,
}

impl Statement {
    /// Its lines, from head to end.
    pub fn size(&self) -> usize {
        match &self.what {
            What::Branches(arms) => 1 + arms.iter().map(|(_, arm)| 1 + size(arm)).sum::<usize>(),
            What::Reads(_, text) | What::Makes(_, text) => 1 + text.matches('\n').count(),
            _ => 1,
        }
    }

    /// It and all statements in it.
    pub fn visit<'a>(&'a self, visitor: &mut impl FnMut(&'a Self)) {
        visitor(self);
        if let What::Branches(arms) = &self.what {
            arms.iter().flat_map(|(_, arm)| arm).for_each(|inner| inner.visit(visitor));
        }
    }

    /// What it declares.
    pub fn declared(&self) -> Option<&Value> {
        match &self.what {
            What::Reads(value, _) | What::Makes(value, _) | What::Declares(value) => Some(value),
            _ => None,
        }
    }

    /// What it changes.
    pub fn written(&self) -> Option<&str> {
        if let What::Fills(name, _) = &self.what { Some(name) } else { self.declared().map(|value| &*value.name) }
    }

    /// The names in it, those of its arms aside.
    pub fn names(&self) -> Vec<&str> {
        let texts = match &self.what {
            What::Reads(_, text) | What::Makes(_, text) | What::Fills(_, text) | What::Says(text) => {
                names(text).collect()
            }
            What::Branches(arms) => arms.iter().flat_map(|(head, _)| names(head)).collect(),
            What::Declares(_) | What::Calls(_) => Vec::new(),
        };
        self.written().into_iter().chain(texts).collect()
    }
}

/// Lines of statements.
pub fn size(statements: &[Statement]) -> usize {
    statements.iter().map(Statement::size).sum()
}

/// Lines of C.
#[derive(Debug, Default)]
pub struct Lines {
    /// What has been written.
    pub text: String,
    /// Values that are members of a structure.
    pub members: HashSet<String>,
    /// The call of each function that was cut out.
    pub calls: HashMap<String, String>,
    /// The section that was written last, and those that were begun.
    pub section: &'static str,
    begun: HashSet<&'static str>,
}

impl Lines {
    /// No lines yet, where these values are members of a structure.
    pub fn passing(members: impl Iterator<Item = String>) -> Self {
        Self { members: members.collect(), ..Self::default() }
    }

    /// Statements, so far inward.
    pub fn write(&mut self, statements: &[Statement], indent: usize) {
        for Statement { origin, what } in statements {
            match what {
                What::Declares(value) if self.members.contains(&value.name) => continue,
                What::Calls(function) => {
                    let call = self.calls[function].clone();
                    self.line(indent, &call);
                    continue;
                }
                _ => self.enter(origin.section, indent),
            }
            let file = if origin.file.is_empty() { String::new() } else { format!(" /* file: {} */", origin.file) };
            match what {
                What::Makes(Value { name, .. }, text) if self.members.contains(name) => {
                    self.line(indent, &format!("{} = {text}{file}", marked(name)));
                }
                What::Makes(Value { kind, name, .. }, text) => {
                    self.line(indent, &format!("const {kind} {name} = {text}{file}"));
                }
                What::Reads(Value { kind, name, .. }, text) => {
                    self.line(indent, &format!("const {kind} {name} = {text}"));
                }
                What::Declares(Value { kind, name, size }) => self.line(indent, &format!("{kind} {name}{size};")),
                What::Fills(name, text) => self.line(indent, &format!("{}{text}", marked(name))),
                What::Says(text) => self.line(indent, text),
                What::Branches(arms) => {
                    for (k, (head, arm)) in arms.iter().enumerate() {
                        self.line(indent, &format!("{}{head}", if k > 0 { "} " } else { "" }));
                        self.write(arm, indent + 1);
                    }
                    self.line(indent, "}");
                }
                What::Calls(_) => {}
            }
        }
    }

    /// A line that tells the section, where another begins.
    fn enter(&mut self, section: &'static str, indent: usize) {
        if section != self.section {
            self.section = section;
            let again = if self.begun.insert(section) { "" } else { ", continued" };
            self.line(indent, &format!("/* section: {section}{again} */"));
        }
    }

    /// A line, so far inward.
    pub fn line(&mut self, indent: usize, line: &str) {
        let _ = write!(self.text, "{:1$}", "", 4 * indent);
        for (k, part) in line.split('`').enumerate() {
            let is_member = k % 2 == 1 && self.members.contains(part);
            self.text += if is_member { "between->" } else { "" };
            self.text += part;
        }
        self.text.push('\n');
    }
}

/// The lines of statements that stand in one function.
pub fn text(statements: &[Statement]) -> String {
    let mut lines = Lines::default();
    lines.write(statements, 1);
    lines.text
}
