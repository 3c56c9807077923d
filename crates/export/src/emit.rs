//! C99 from what was traced: a line an operation, in the order in which they were asked for.

use crate::controller::{INPUTS, Job, Program, name_of};
use crate::dots::{Product, products};
use crate::trace::{Bank, Graph, Node, One, Two};
use core::fmt::Write;
use std::collections::{BTreeSet, HashMap};

/// A law as C: the parts of its files that follow from the trace.
#[derive(Debug, Clone, Default)]
pub struct Source {
    /// Name of each state that the law needs, and whether it is a flag.
    pub states: Vec<(String, bool)>,
    /// The inputs that it reads.
    pub inputs: Vec<String>,
    /// Body of a period; of one in which the feel is changed, where there are settings; of the start at rest.
    pub step: String,
    /// While the feel is changed from one setting to another.
    pub between: Option<String>,
    /// The start at rest.
    pub reset: String,
    /// Members of a setting's numbers, and for each setting what they hold.
    pub members: String,
    /// Initialisers, a setting each.
    pub settings: Vec<String>,
    /// Operations of a period as written, and those of the loops over data.
    pub operations: (usize, usize),
}

/// Displacement and rate of the feel, which are given out.
const GIVEN: [usize; 2] = [INPUTS.len() + 3, INPUTS.len() + 4];

impl Source {
    /// The law of a job.
    pub fn of(job: &Job) -> Self {
        let step = job.period(false);
        let between = (job.values.len() > 1).then(|| job.period(true));
        let mut states = BTreeSet::from(GIVEN);
        for program in between.iter().chain([&step]) {
            states.extend(needed(program));
        }
        // What one of them needs, the other keeps.
        for program in between.iter().chain([&step]) {
            states = closed(program, states);
        }
        let reset = job.reset();
        let mut writer =
            Writer { job, tables: Vec::new(), matrices: HashMap::new(), numbers: Vec::new(), inputs: BTreeSet::new() };
        let (step_text, operations) = writer.body(&step, &states);
        let between_text = between.as_ref().map(|program| writer.body(program, &states).0);
        let (reset_text, _) = writer.body(&reset, &states);
        let (members, settings) = writer.data();
        let name = |&place: &usize| (name_of(place), name_of(place).ends_with("stuck"));
        Self {
            states: states.iter().map(name).collect(),
            inputs: writer.inputs.iter().map(|&place| name_of(place)).collect(),
            step: step_text,
            between: between_text,
            reset: reset_text,
            members,
            settings,
            operations,
        }
    }
}

/// The states that a program reads, directly or by others.
fn needed(program: &Program) -> BTreeSet<usize> {
    closed(program, BTreeSet::from(GIVEN))
}

fn closed(program: &Program, mut states: BTreeSet<usize>) -> BTreeSet<usize> {
    loop {
        let live = live(&program.graph, &wanted(program, &states), |_| None);
        let mut more = states.clone();
        for (place, node) in program.graph.nodes.iter().enumerate() {
            if let (true, &(Node::Input(input) | Node::Flag(input))) = (live[place], node)
                && input >= INPUTS.len()
            {
                more.insert(input);
            }
        }
        if more == states {
            return states;
        }
        states = more;
    }
}

/// Outputs and next states.
fn wanted(program: &Program, states: &BTreeSet<usize>) -> Vec<u32> {
    let next = program.next.iter().filter(|(place, _)| states.contains(place)).map(|&(_, node)| node);
    program.outputs.iter().map(|&(_, node)| node).chain(next).collect()
}

fn of(node: &Node) -> Vec<u32> {
    match *node {
        Node::Known(..) | Node::Data(..) | Node::Input(_) | Node::Flag(_) | Node::Holds(..) => Vec::new(),
        Node::One(_, a) | Node::Not(a) => vec![a],
        Node::Two(_, a, b) | Node::Less(a, b) | Node::And(a, b) | Node::Or(a, b) => vec![a, b],
        Node::Select(a, b, c) => vec![a, b, c],
    }
}

/// Which nodes are needed for `wanted`; `instead` says what else one is made of.
fn live(graph: &Graph, wanted: &[u32], instead: impl Fn(u32) -> Option<Vec<u32>>) -> Vec<bool> {
    let mut found = vec![false; graph.nodes.len()];
    let mut open = wanted.to_vec();
    while let Some(node) = open.pop() {
        if !core::mem::replace(&mut found[node as usize], true) {
            open.extend(instead(node).unwrap_or_else(|| of(&graph.nodes[node as usize])));
        }
    }
    found
}

/// Bits of a number in each setting.
type Bits = Vec<u64>;

struct Writer<'a> {
    job: &'a Job,
    /// Rows and columns of each matrix, row by row.
    tables: Vec<Vec<Vec<Bits>>>,
    matrices: HashMap<Vec<Vec<Bits>>, usize>,
    numbers: Vec<Bits>,
    inputs: BTreeSet<usize>,
}

impl Writer<'_> {
    /// The lines of a program, and its operations: as written, and in loops.
    fn body(&mut self, program: &Program, states: &BTreeSet<usize>) -> (String, (usize, usize)) {
        let graph = &program.graph;
        let wanted = wanted(program, states);
        let products = products(graph, &live(graph, &wanted, |_| None));
        let mut row_of: HashMap<u32, (usize, usize)> = HashMap::new();
        for (k, product) in products.iter().enumerate() {
            for (row, &(_, node)) in product.rows.iter().enumerate() {
                row_of.insert(node, (k, row));
            }
        }
        let live = live(graph, &wanted, |node| row_of.get(&node).map(|&(k, _)| products[k].vector.clone()));
        let (mut text, mut operations, mut written) = (String::new(), (0, 0), BTreeSet::new());
        for (place, node) in graph.nodes.iter().enumerate().filter(|&(place, _)| live[place]) {
            let name = u32::try_from(place).expect("a graph's places are 32 bits");
            if let Some(&(k, _)) = row_of.get(&name) {
                if written.insert(k) {
                    let product = &products[k];
                    self.product(graph, &mut text, product);
                    let terms = product.rows.len() * (2 * product.vector.len() - 1);
                    if product.rows.len() > 1 { operations.1 += terms } else { operations.0 += terms }
                }
                continue;
            }
            if let Some(line) = self.line(graph, name, node) {
                text += &line;
                operations.0 += usize::from(!of(node).is_empty());
            }
        }
        for &(what, node) in &program.outputs {
            let _ = writeln!(text, "    out->{what} = {};", self.spelled(graph, node));
        }
        for &(place, node) in program.next.iter().filter(|(place, _)| states.contains(place)) {
            if !matches!(graph.nodes[node as usize], Node::Input(same) | Node::Flag(same) if same == place) {
                let _ = writeln!(text, "    state->{} = {};", name_of(place), self.spelled(graph, node));
            }
        }
        (text, operations)
    }

    /// An operation as a line; nothing of what needs none.
    fn line(&mut self, graph: &Graph, name: u32, node: &Node) -> Option<String> {
        let mut s = |node: u32| self.spelled(graph, node);
        let value = match *node {
            Node::Known(..) | Node::Data(..) | Node::Holds(..) => return None,
            Node::Input(place) if place < INPUTS.len() => {
                self.inputs.insert(place);
                format!("in->{}", name_of(place))
            }
            Node::Input(place) | Node::Flag(place) => format!("state->{}", name_of(place)),
            Node::One(One::Neg, a) => format!("-{}", s(a)),
            Node::One(One::Sqrt, a) => format!("REAL_SQRT({})", s(a)),
            Node::One(One::Abs, a) => format!("REAL_ABS({})", s(a)),
            Node::One(One::Round, a) => format!("nearest({})", s(a)),
            Node::Two(Two::Add, a, b) => format!("{} + {}", s(a), s(b)),
            Node::Two(Two::Sub, a, b) => format!("{} - {}", s(a), s(b)),
            Node::Two(Two::Mul, a, b) => format!("{} * {}", s(a), s(b)),
            Node::Two(Two::Div, a, b) => format!("{} / {}", s(a), s(b)),
            Node::Two(Two::Min, a, b) => format!("smaller({}, {})", s(a), s(b)),
            Node::Two(Two::Max, a, b) => format!("larger({}, {})", s(a), s(b)),
            Node::Two(Two::TimesSign, a, b) => format!("with_sign({}, {})", s(a), s(b)),
            Node::Less(a, b) => format!("{} < {}", s(a), s(b)),
            Node::And(a, b) => format!("{} && {}", s(a), s(b)),
            Node::Or(a, b) => format!("{} || {}", s(a), s(b)),
            Node::Not(a) => format!("!{}", s(a)),
            Node::Select(mask, yes, no) => format!("{} ? {} : {}", s(mask), s(yes), s(no)),
        };
        let kind = match node {
            Node::Flag(_) | Node::Less(..) | Node::And(..) | Node::Or(..) | Node::Not(_) => "bool",
            _ => "real",
        };
        Some(format!("    const {kind} v{name} = {value};\n"))
    }

    /// Rows times a vector: a loop over rows, or one row as it stands.
    fn product(&mut self, graph: &Graph, text: &mut String, product: &Product) {
        let bits = |node: &u32| match &graph.nodes[*node as usize] {
            Node::Data(bits, _) => bits.clone(),
            _ => unreachable!("a product's numbers are data"),
        };
        let rows: Vec<Vec<Bits>> = product.rows.iter().map(|(data, _)| data.iter().map(bits).collect()).collect();
        let table = *self.matrices.entry(rows.clone()).or_insert_with(|| {
            self.tables.push(rows);
            self.tables.len() - 1
        });
        let bank = if product.bank == Bank::To { "to" } else { "from" };
        let names: Vec<String> = product.vector.iter().map(|&node| self.spelled(graph, node)).collect();
        let sum = |row: &str| {
            let terms = names.iter().enumerate().map(|(k, name)| format!("({row}[{k}] * {name})"));
            terms.collect::<Vec<_>>().join(" + ")
        };
        if let [(_, node)] = product.rows[..] {
            let _ = writeln!(text, "    const real v{node} = {};", sum(&format!("{bank}->m{table}[0]")));
            return;
        }
        let first = product.rows[0].1;
        let count = product.rows.len();
        let _ = writeln!(text, "    real r{first}[{count}];\n    for (unsigned int k = 0U; k < {count}U; ++k) {{");
        let _ = writeln!(
            text,
            "        const real *const m = {bank}->m{table}[k];\n        r{first}[k] = {};\n    }}",
            sum("m")
        );
        for (k, (_, node)) in product.rows.iter().enumerate() {
            let _ = writeln!(text, "    const real v{node} = r{first}[{k}];");
        }
    }

    /// How a node is named where it is used.
    fn spelled(&mut self, graph: &Graph, node: u32) -> String {
        match &graph.nodes[node as usize] {
            Node::Known(bits, Bank::All) => literal(f64::from_bits(bits[0]), self.job.single),
            Node::Known(bits, bank) | Node::Data(bits, bank) => self.number(bits.clone(), *bank),
            Node::Holds(values, Bank::All) => values[0].to_string(),
            Node::Holds(values, bank) => {
                let bits = values.iter().map(|&value| f64::from(u8::from(value)).to_bits()).collect();
                format!("({} > {})", self.number(bits, *bank), literal(0.5, self.job.single))
            }
            _ => format!("v{node}"),
        }
    }

    /// One of a setting's numbers.
    fn number(&mut self, bits: Bits, bank: Bank) -> String {
        let place = self.numbers.iter().position(|known| *known == bits).unwrap_or_else(|| {
            self.numbers.push(bits);
            self.numbers.len() - 1
        });
        format!("{}->n[{place}]", if bank == Bank::To { "to" } else { "from" })
    }

    /// The members of a setting's numbers, and what each setting holds.
    fn data(&self) -> (String, Vec<String>) {
        let mut members = String::new();
        for (k, table) in self.tables.iter().enumerate() {
            let _ = writeln!(members, "    real m{k}[{}][{}];", table.len(), table[0].len());
        }
        if !self.numbers.is_empty() {
            let _ = writeln!(members, "    real n[{}];", self.numbers.len());
        }
        let setting = |k: usize| {
            let spelled = |bits: &Bits| literal(f64::from_bits(bits[k]), self.job.single);
            let row = |row: &Vec<Bits>| format!("{{{}}}", row.iter().map(spelled).collect::<Vec<_>>().join(", "));
            let table = |table: &Vec<Vec<Bits>>| {
                format!("        {{{}}}", table.iter().map(row).collect::<Vec<_>>().join(",\n         "))
            };
            let mut parts: Vec<String> = self.tables.iter().map(table).collect();
            if !self.numbers.is_empty() {
                parts.push(format!("        {}", row(&self.numbers)));
            }
            format!("    {{\n{}\n    }}", parts.join(",\n"))
        };
        (members, (0..self.job.values.len()).map(setting).collect())
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
