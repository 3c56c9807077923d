//! What all functions of a law's C share: its numbers, tables and functions.

use crate::trace::{Bank, Graph, Node};
use core::fmt::Write;
use std::collections::BTreeSet;

/// The place of the first input of an axis, beyond all that a law is given; its states come after its inputs.
pub const FIRST_OF_AXIS: usize = 1 << 17;

/// Numbers of a law as members of a structure of C.
#[derive(Debug, Clone, Default)]
pub struct Numbers {
    /// The members.
    pub members: String,
    /// What they hold: a setting each, or of what is the same in all, a table each.
    pub values: Vec<String>,
}

/// Bits of a number in each setting.
pub type Bits = Vec<u64>;

/// A function of C.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Function {
    name: String,
    gives: String,
    parameters: String,
    lines: String,
}

impl core::fmt::Display for Function {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "static {} {}({})\n{{\n{}}}\n", self.gives, self.name, self.parameters, self.lines)
    }
}

/// Some columns of a matrix: where they are, and which they are.
#[derive(Debug, Clone)]
pub struct Table {
    /// Among the tables.
    pub place: usize,
    /// Of the matrix.
    pub columns: Vec<usize>,
}

/// Rows and columns of matrices, row by row, each once.
#[derive(Debug, Default)]
struct Tables(Vec<Vec<Vec<Bits>>>);

impl Tables {
    fn table(&mut self, rows: &[Vec<Bits>], columns: Vec<usize>) -> Table {
        let of = |row: &Vec<Bits>| columns.iter().map(|&column| row[column].clone()).collect();
        let rows: Vec<Vec<Bits>> = rows.iter().map(of).collect();
        let place = self.0.iter().position(|known| *known == rows).unwrap_or_else(|| {
            if !columns.is_empty() {
                self.0.push(rows);
            }
            self.0.len().saturating_sub(1)
        });
        Table { place, columns }
    }
}

/// What all bodies of a law share: its numbers and functions.
#[derive(Debug, Default)]
pub struct Writer {
    /// With which the names of C begin.
    pub name: String,
    single: bool,
    own: Tables,
    same: Tables,
    numbers: Vec<Bits>,
    /// Functions that a period calls.
    pub functions: Vec<Function>,
    /// The inputs that are read.
    pub inputs: BTreeSet<usize>,
    /// Of an axis, its inputs and states in their order: the pointer through which each is read, and its name.
    pub axis: Vec<(&'static str, String)>,
}

impl Writer {
    /// A writer; the names of C begin with `name`.
    pub fn new(name: &str, single: bool) -> Self {
        Self { name: name.to_owned(), single, ..Self::default() }
    }

    /// The pointer through which an input or a state of an axis is read, and its name.
    pub fn of_axis(&self, place: usize) -> Option<(&'static str, &str)> {
        place.checked_sub(FIRST_OF_AXIS).map(|k| (self.axis[k].0, self.axis[k].1.as_str()))
    }

    /// The type of its numbers.
    pub fn real(&self) -> String {
        format!("{}_real", self.name)
    }

    /// A table that is the same in all settings.
    pub fn same_table(&self, place: usize) -> String {
        format!("{}_numbers.same_{place}", self.name)
    }

    /// Notes that an input is read.
    pub fn reads(&mut self, input: usize) {
        self.inputs.insert(input);
    }

    /// The name of a function of a section, new or there already.
    pub fn function(&mut self, section: &str, gives: String, parameters: String, lines: String) -> String {
        let same = |known: &&Function| known.parameters == parameters && known.lines == lines;
        if let Some(known) = self.functions.iter().find(same) {
            return known.name.clone();
        }
        let name = format!("{}_{section}_{}", self.name, self.functions.len() + 1);
        self.functions.push(Function { name: name.clone(), gives, parameters, lines });
        name
    }

    /// A matrix as two tables: the columns that are a setting's own, and those that are the same in all.
    pub fn tables(&mut self, rows: &[Vec<Bits>]) -> (Table, Table) {
        let alike = |bits: &Bits| bits.len() > 1 && bits.iter().all(|one| *one == bits[0]);
        let columns = 0..rows.first().map_or(0, Vec::len);
        let (same, own) = columns.partition(|&column| rows.iter().all(|row| alike(&row[column])));
        (self.own.table(rows, own), self.same.table(rows, same))
    }

    /// What is known, as it is spelled in C; `setting` names where the numbers of a bank are. None of what is not known.
    pub fn known(&mut self, graph: &Graph, node: u32, setting: impl Fn(Bank) -> String) -> Option<String> {
        Some(match &graph.nodes[node as usize] {
            Node::Known(bits, Bank::All, _) => literal(f64::from_bits(bits[0]), self.single),
            Node::Known(bits, bank, _) | Node::Data(bits, bank) => self.number(bits.clone(), &setting(*bank)),
            Node::Whole(value, "") => format!("{value}U"),
            Node::Whole(value, name) => format!("{value}U /* {name} */"),
            Node::Holds(values, Bank::All) => values[0].to_string(),
            Node::Holds(values, bank) => {
                let bits = values.iter().map(|&value| f64::from(u8::from(value)).to_bits()).collect();
                format!("({} > {})", self.number(bits, &setting(*bank)), literal(0.5, self.single))
            }
            _ => return None,
        })
    }

    /// One of a setting's numbers.
    fn number(&mut self, bits: Bits, setting: &str) -> String {
        let place = self.numbers.iter().position(|known| *known == bits).unwrap_or_else(|| {
            self.numbers.push(bits);
            self.numbers.len() - 1
        });
        format!("{setting}->n[{place}]")
    }

    /// What is the same in all settings, and a setting's own numbers.
    pub fn data(&self, settings: usize) -> (Numbers, Numbers) {
        let real = self.real();
        let size = |table: &Vec<Vec<Bits>>| format!("[{}][{}]", table.len(), table[0].len());
        let (mut same, mut members) = (Numbers::default(), String::new());
        for (k, table) in self.same.0.iter().enumerate() {
            let _ = writeln!(same.members, "    {real} same_{k}{};", size(table));
            same.values.push(self.rows(table, 0));
        }
        for (k, table) in self.own.0.iter().enumerate() {
            let _ = writeln!(members, "    {real} m{k}{};", size(table));
        }
        if !self.numbers.is_empty() {
            let _ = writeln!(members, "    {real} n[{}];", self.numbers.len());
        }
        let setting = |k: usize| {
            let mut parts: Vec<String> = self.own.0.iter().map(|table| self.rows(table, k)).collect();
            if !self.numbers.is_empty() {
                parts.push(self.row(&self.numbers, k));
            }
            format!("    {{\n        {}\n    }}", parts.join(",\n        "))
        };
        (same, Numbers { members, values: (0..settings).map(setting).collect() })
    }

    /// The numbers of a table in a setting.
    fn rows(&self, table: &[Vec<Bits>], setting: usize) -> String {
        let rows = table.iter().map(|row| self.row(row, setting)).collect::<Vec<_>>();
        format!("{{{}}}", rows.join(",\n         "))
    }

    fn row(&self, row: &[Bits], setting: usize) -> String {
        let spelled = row.iter().map(|bits| literal(f64::from_bits(bits[setting]), self.single));
        format!("{{{}}}", spelled.collect::<Vec<_>>().join(", "))
    }
}

/// A number that C reads back to the last bit.
fn literal(value: f64, single: bool) -> String {
    #[expect(clippy::cast_possible_truncation, reason = "a number of single precision, held in double")]
    let text = if single { format!("{:?}F", value as f32) } else { format!("{value:?}") };
    match (value.is_infinite(), value < 0.0) {
        (true, false) => "REAL_INFINITY".to_owned(),
        (true, true) => "(-REAL_INFINITY)".to_owned(),
        (false, true) => format!("({text})"),
        (false, false) => text,
    }
}
