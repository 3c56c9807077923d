//! The lines of a function of C: an operation each, in the order in which they were asked for.

use crate::blocks::{ALWAYS, Blocks, Operands, choice};
use crate::controller::{FIRST_OF_FLIGHT, FIRST_OF_LINK, FIRST_OF_TUNING, INPUTS, name_of, row_name};
use crate::dots::{Product, products};
use crate::operands::{held, of_few_steps, operands_of, reached, within};
use crate::statement::{Statement, Value, What, marked, text};
use crate::trace::logic::Kind;
use crate::trace::{Bank, BinaryOp, Graph, Node, Origin, UnaryOp};
use crate::writer::{Bits, Writer};
use std::collections::{HashMap, HashSet};

/// Operations in the arms of a select from which on they are worth a branch.
const WORTH_A_BRANCH: usize = 2;

/// Names of a function's arguments and of loops.
const RESERVED: [&str; 13] =
    ["state", "from", "to", "in", "out", "between", "flight", "seen", "good", "k", "m", "c", "r"];

/// The statements of a function while they are written.
#[derive(Debug)]
pub struct Body<'a> {
    writer: &'a mut Writer,
    graph: &'a Graph,
    operands: Operands,
    blocks: Blocks,
    /// The nodes of each block in their order.
    nodes: HashMap<usize, Vec<u32>>,
    products: Vec<Product>,
    /// The product of each row.
    product_of: HashMap<u32, usize>,
    /// The name of each node that has one by now.
    names: HashMap<u32, String>,
    /// The names that are taken.
    taken: HashSet<String>,
    /// Whether it is a part's, which is given the settings.
    is_part: bool,
    /// Where what is written comes from.
    origin: Origin,
    /// Banks whose settings a function is given.
    banks: Vec<Bank>,
    done: HashSet<u32>,
    statements: Vec<Statement>,
    operations: (usize, usize),
}

impl<'a> Body<'a> {
    /// A body that gives `wanted`, and what it calls them.
    pub fn of(writer: &'a mut Writer, graph: &'a Graph, wanted: &[u32], called: &[(u32, String)]) -> Self {
        let mut body = Self::with(writer, graph, wanted, None);
        for (node, name) in called {
            let kept =
                matches!(graph.nodes[*node as usize], Node::Input(_) | Node::Flag(_) | Node::Word(_) | Node::Known(..));
            if !kept && !body.names.contains_key(node) {
                let name = body.free(name, false);
                body.names.insert(*node, name);
            }
        }
        body
    }

    /// The body of a part, whose names are those that it is given.
    fn with(writer: &'a mut Writer, graph: &'a Graph, wanted: &[u32], names: Option<HashMap<u32, String>>) -> Self {
        let mut operands: Vec<Vec<u32>> = (0..graph.nodes.len()).map(|place| operands_of(graph, place)).collect();
        let (is_part, names) = (names.is_some(), names.unwrap_or_default());
        let given: HashSet<u32> = names.keys().copied().collect();
        let taken = names.values().cloned().chain(RESERVED.map(str::to_owned)).collect();
        for &node in &given {
            operands[node as usize] = Vec::new();
        }
        let (mut product_of, mut together) = (HashMap::new(), HashMap::new());
        let products = products(graph, &reached(&operands, wanted));
        for (k, product) in products.iter().enumerate() {
            let first = product.rows.iter().map(|&(_, node)| node).min();
            for &(_, node) in &product.rows {
                operands[node as usize].clone_from(&product.vector);
                product_of.insert(node, k);
                together.extend(first.map(|first| (node, first)));
            }
        }
        let done = given.clone();
        let operands = Operands { of: operands, together, given };
        let blocks = Blocks::of(graph, &operands, wanted);
        let mut nodes: HashMap<usize, Vec<u32>> = HashMap::new();
        for (&node, &block) in &blocks.of {
            nodes.entry(block).or_default().push(node);
        }
        for nodes in nodes.values_mut() {
            nodes.sort_unstable();
        }
        Self {
            writer,
            graph,
            operands,
            blocks,
            nodes,
            products,
            product_of,
            names,
            taken,
            is_part,
            origin: Origin::default(),
            banks: Vec::new(),
            done,
            statements: Vec::new(),
            operations: (0, 0),
        }
    }

    /// Writes all operations.
    pub fn write_all(&mut self) {
        self.write_block(ALWAYS);
    }

    /// The statements, and their operations: as written, and in loops.
    pub fn statements(self) -> (Vec<Statement>, (usize, usize)) {
        (self.statements, self.operations)
    }

    fn write_block(&mut self, block: usize) {
        for node in self.nodes.get(&block).cloned().unwrap_or_default() {
            self.write(node, block);
        }
    }

    /// Writes a node, those of the block that it needs before.
    fn write(&mut self, node: u32, block: usize) {
        let node = self.blocks.meant(node);
        if self.blocks.of.get(&node) != Some(&block) || !self.done.insert(node) {
            return;
        }
        if let Some(&group) = self.blocks.group_of.get(&node) {
            self.write_group(group);
            return;
        }
        for one in self.operands.of[node as usize].clone() {
            self.write(one, block);
        }
        if let Node::Part(roots, given) = &self.graph.nodes[node as usize] {
            self.enter(node);
            self.call(node, roots, given);
        } else if let Some(&product) = self.product_of.get(&node) {
            let product = self.products[product].clone();
            self.done.extend(product.rows.iter().map(|&(_, node)| node));
            self.enter(node);
            self.write_product(&product);
        } else if let Some(value) = self.value(node) {
            self.enter(node);
            let reads = matches!(self.graph.nodes[node as usize], Node::Input(_) | Node::Flag(_) | Node::Word(_));
            let rows = self.rows(&self.graph.nodes[node as usize].operands());
            let (of, text) = (self.value_of(node), format!("{value};{rows}"));
            self.put(if reads { What::Reads(of, text) } else { What::Makes(of, text) });
            self.operations.0 += usize::from(!self.operands.of[node as usize].is_empty());
        }
    }

    /// Selects on one mask: a branch where that saves operations.
    fn write_group(&mut self, group: usize) {
        let group = self.blocks.groups[group].clone();
        self.done.extend(group.members.iter().copied());
        self.write(group.mask, group.block);
        let within: Vec<u32> = group.arms.iter().flat_map(|&arm| self.all_within(arm)).collect();
        let arms = |node: u32| choice(self.graph, node).map_or([None; 2], |(_, arms)| arms);
        let mut members: Vec<(u32, [Option<u32>; 2])> = group.members.iter().map(|&node| (node, arms(node))).collect();
        members.sort_unstable();
        let needs = within.iter().flat_map(|&node| self.operands.of[node as usize].clone());
        let needs: Vec<u32> = needs.chain(members.iter().flat_map(|&(_, arms)| arms.into_iter().flatten())).collect();
        for node in needs {
            self.write(node, group.block);
        }
        let mask = self.spelled(group.mask);
        let of_mask = self.rows(&[group.mask]);
        if let Some(&(first, _)) = members.first() {
            self.enter(first);
        }
        if self.work(&within) < WORTH_A_BRANCH {
            for arm in group.arms {
                self.write_block(arm);
            }
            for (node, arms) in members {
                // Of two words that are known, C's type would be the smallest that holds them.
                let known = |arm: &Option<u32>| {
                    arm.is_some_and(|arm| matches!(self.graph.nodes[arm as usize], Node::Whole(..)))
                };
                let typed = if arms.iter().all(known) { format!("({})", self.kind(node)) } else { String::new() };
                let chosen = match arms.map(|arm| arm.map(|arm| self.spelled(arm))) {
                    [Some(yes), Some(no)] => format!("{mask} ? {typed}{yes} : {typed}{no}"),
                    [Some(second), None] => format!("{mask} && {second}"),
                    [None, second] => format!("(!{mask}) && {}", second.unwrap_or_default()),
                };
                let rows = self.rows(&[&[group.mask], &*arms.into_iter().flatten().collect::<Vec<_>>()].concat());
                let of = self.value_of(node);
                self.enter(node);
                self.put(What::Makes(of, format!("{chosen};{rows}")));
                self.operations.0 += 1;
            }
            return;
        }
        for &(node, _) in &members {
            let of = self.value_of(node);
            self.enter(node);
            self.put(What::Declares(of));
        }
        let (origin, mut branches) = (self.origin, Vec::new());
        for (arm, head) in [format!("if ({mask}) {{{of_mask}"), "else {".to_owned()].into_iter().enumerate() {
            let outer = core::mem::take(&mut self.statements);
            self.write_block(group.arms[arm]);
            for &(node, arms) in &members {
                let name = self.named(node);
                let value = arms[arm].map_or_else(|| "false".to_owned(), |chosen| self.spelled(chosen));
                let rows = arms[arm].map_or_else(String::new, |chosen| self.rows(&[chosen]));
                self.enter(node);
                self.put(What::Fills(name, format!(" = {value};{rows}")));
            }
            branches.push((head, core::mem::replace(&mut self.statements, outer)));
        }
        self.statements.push(Statement { origin, what: What::Branches(branches) });
        self.operations.0 += 1;
    }

    /// What is done in a block and those that lie in it.
    fn all_within(&self, block: usize) -> Vec<u32> {
        let inside = |&(other, _): &(&usize, &Vec<u32>)| self.blocks.enclosing(*other).contains(&block);
        let mut within: Vec<u32> =
            self.nodes.iter().filter(inside).flat_map(|(_, nodes)| nodes.iter().copied()).collect();
        // The same law is the same C each time, whatever the order of a map.
        within.sort_unstable();
        within
    }

    /// How much nodes are to be computed.
    fn work(&self, nodes: &[u32]) -> usize {
        let of = |&node: &u32| match self.graph.nodes[node as usize] {
            _ if self.product_of.contains_key(&node) => WORTH_A_BRANCH,
            Node::Part(..) | Node::UnaryOp(UnaryOp::Sqrt | UnaryOp::Round, _) | Node::BinaryOp(BinaryOp::Div, ..) => {
                WORTH_A_BRANCH
            }
            _ => usize::from(!self.operands.of[node as usize].is_empty()),
        };
        nodes.iter().map(of).sum()
    }

    /// The rows of known numbers among nodes, as a comment.
    fn rows(&self, nodes: &[u32]) -> String {
        // What is compared with a known number bears its rows too, and is no number itself.
        let rows = self.graph.rows_of(nodes);
        if rows.is_empty() {
            return String::new();
        }
        format!(" /* {} */", rows.into_iter().map(row_name).collect::<Vec<_>>().join(", "))
    }

    /// What follows comes from where a node does.
    fn enter(&mut self, node: u32) {
        self.origin = self.graph.origins[node as usize];
    }

    /// A statement more.
    pub fn put(&mut self, what: What) {
        self.statements.push(Statement { origin: self.origin, what });
    }

    /// A node as a value of C.
    fn value_of(&mut self, node: u32) -> Value {
        Value { kind: self.kind(node), name: self.named(node), size: String::new() }
    }

    /// What an operation is in C; nothing of what needs none.
    fn value(&mut self, node: u32) -> Option<String> {
        let (graph, name) = (self.graph, self.writer.name.clone());
        if let Some((x, limit)) = within(graph, node) {
            return Some(format!("{name}_within({}, {})", self.spelled(x), self.spelled(limit)));
        }
        if let Node::Input(place) | Node::Flag(place) | Node::Word(place) = graph.nodes[node as usize]
            && let Some(of_axis) = self.writer.of_axis(place)
        {
            let (pointer, member) = of_axis;
            return Some(format!("{}->{member}", marked(pointer)));
        }
        let mut s = |node: u32| self.spelled(node);
        Some(match graph.nodes[node as usize] {
            Node::Input(place) if place < INPUTS.len() => {
                self.writer.reads(place);
                format!("in->{}", name_of(place))
            }
            Node::Input(place) if place >= FIRST_OF_TUNING => format!("state->tuning.{}", name_of(place)),
            Node::Input(place) | Node::Flag(place) if place >= FIRST_OF_LINK => format!("seen->{}", name_of(place)),
            Node::Input(place) if place >= FIRST_OF_FLIGHT => format!("flight->{}", name_of(place)),
            Node::Input(place) | Node::Flag(place) => format!("state->{}", name_of(place)),
            Node::UnaryOp(UnaryOp::Neg, a) => format!("-{}", s(a)),
            Node::UnaryOp(UnaryOp::Sqrt, a) => format!("REAL_SQRT({})", s(a)),
            Node::UnaryOp(UnaryOp::Abs, a) => format!("REAL_ABS({})", s(a)),
            Node::UnaryOp(UnaryOp::Round, a) if of_few_steps(graph, a) => format!("{name}_nearest_of_few({})", s(a)),
            Node::UnaryOp(UnaryOp::Round, a) => format!("{name}_nearest({})", s(a)),
            Node::BinaryOp(BinaryOp::Add, a, b) => format!("{} + {}", s(a), s(b)),
            Node::BinaryOp(BinaryOp::Sub, a, b) => format!("{} - {}", s(a), s(b)),
            Node::BinaryOp(BinaryOp::Mul, a, b) => format!("{} * {}", s(a), s(b)),
            Node::BinaryOp(BinaryOp::Div, a, b) => format!("{} / {}", s(a), s(b)),
            Node::BinaryOp(BinaryOp::Min, a, b) => format!("{name}_smaller({}, {})", s(a), s(b)),
            Node::BinaryOp(BinaryOp::Max, a, b) => format!("{name}_larger({}, {})", s(a), s(b)),
            Node::BinaryOp(BinaryOp::TimesSign, a, b) => format!("{name}_with_sign({}, {})", s(a), s(b)),
            Node::Less(a, b) => format!("{} < {}", s(a), s(b)),
            Node::And(a, b) => format!("{} && {}", s(a), s(b)),
            Node::Or(a, b) => format!("{} || {}", s(a), s(b)),
            Node::Not(a) => format!("!{}", s(a)),
            Node::Next(a) => format!("{name}_next({})", s(a)),
            Node::Larger(a, b) => format!("({0} > {1}) ? {0} : {1}", s(a), s(b)),
            Node::AtLeast(a, samples) => format!("{} >= {samples}U", s(a)),
            Node::Same(a, b) => format!("{} == {}", s(a), s(b)),
            Node::Number(a) => format!("({})({})", self.writer.real(), self.spelled(a)),
            Node::IsNumber(a) => format!("{name}_is_number({})", s(a)),
            Node::Bits(ref masks) => {
                let known = |node: u32| matches!(graph.nodes[node as usize], Node::Holds(..));
                let bits = masks.iter().enumerate().filter(|&(_, &mask)| !known(mask));
                let bits: Vec<String> = bits.map(|(k, &mask)| format!("{name}_bit({}, {k}U)", s(mask))).collect();
                if bits.is_empty() { "0U".to_owned() } else { bits.join("\n        | ") }
            }
            Node::Known(..) | Node::Data(..) | Node::Holds(..) | Node::Given(_) | Node::Select(..) | Node::Part(..) => {
                return None;
            }
            Node::Word(_) | Node::Whole(..) => return None,
            Node::Gives(part, place) => format!("{}[{place}]", marked(&self.results(part))),
        })
    }

    fn kind(&self, node: u32) -> String {
        match self.graph.kind(node) {
            Kind::Flag => "bool".to_owned(),
            Kind::Word => "uint32_t".to_owned(),
            Kind::Number => self.writer.real(),
        }
    }

    /// Rows times a vector: in a law of one setting as they stand, in one of many, which would be too long so, a loop over rows.
    fn write_product(&mut self, product: &Product) {
        let bits = |node: &u32| match &self.graph.nodes[*node as usize] {
            Node::Data(bits, _) => bits.clone(),
            _ => unreachable!("a product's numbers are data"),
        };
        let rows: Vec<Vec<Bits>> = product.rows.iter().map(|(data, _)| data.iter().map(bits).collect()).collect();
        let (own, same) = self.writer.tables(&rows);
        let bank = self.setting(product.bank);
        let data: Vec<u32> = product.rows.iter().flat_map(|(data, _)| data.iter().copied()).collect();
        let of_data = self.rows(&data);
        let vector: Vec<String> = product.vector.iter().map(|&node| self.spelled(node)).collect();
        let (own_row, same_row) = (format!("{bank}->m{}", own.place), self.writer.same_table(same.place));
        let sum = |own_row: &str, same_row: &str| {
            let place = |k: &usize| match own.columns.iter().position(|column| column == k) {
                Some(place) => format!("{own_row}[{place}]"),
                None => format!("{same_row}[{}]", same.columns.iter().filter(|&column| column < k).count()),
            };
            let terms = vector.iter().enumerate().map(|(k, name)| format!("({} * {name})", place(&k)));
            terms.collect::<Vec<_>>().join(" + ")
        };
        let terms = product.rows.len() * (2 * product.vector.len() - 1);
        let real = self.writer.real();
        if self.graph.settings == 1 || product.rows.len() == 1 {
            for (k, &(_, node)) in product.rows.iter().enumerate() {
                let of = self.value_of(node);
                let sum = sum(&format!("{own_row}[{k}]"), &format!("{same_row}[{k}]"));
                self.put(What::Makes(of, format!("{sum};{of_data}")));
            }
            self.operations.0 += terms;
            return;
        }
        self.operations.1 += terms;
        let (first, count) = (product.rows[0].1, product.rows.len());
        let sums = self.free(&format!("{}_rows", self.graph.origins[first as usize].section), false);
        self.put(What::Declares(Value { kind: real.clone(), name: sums.clone(), size: format!("[{count}]") }));
        let outer = core::mem::take(&mut self.statements);
        for (name, table, row) in [("m", &own, own_row), ("c", &same, same_row)] {
            if !table.columns.is_empty() {
                self.put(What::Says(format!("const {real} *const {name} = {row}[k];")));
            }
        }
        self.put(What::Fills(sums.clone(), format!("[k] = {};{of_data}", sum("m", "c"))));
        let head = format!("for (unsigned int k = 0U; k < {count}U; ++k) {{");
        let arm = core::mem::replace(&mut self.statements, outer);
        self.put(What::Branches(vec![(head, arm)]));
        for (k, &(_, node)) in product.rows.iter().enumerate() {
            let of = self.value_of(node);
            self.put(What::Makes(of, format!("{}[{k}];", marked(&sums))));
        }
    }

    /// A part with what it is given: a call of the function that is written of it.
    fn call(&mut self, node: u32, roots: &[u32], given: &[u32]) {
        let held = held(self.graph, roots);
        let inside = self.graph.nodes.iter().enumerate().filter_map(|(place, node)| match node {
            Node::Given(k) => Some((u32::try_from(place).ok()?, format!("given_{k}"))),
            _ => None,
        });
        // The section of what is given out, which the part began.
        let section = roots.first().map_or("", |&root| self.graph.origins[root as usize].section);
        let kept: Vec<(u32, String)> = held.iter().map(|&node| (node, self.named(node))).collect();
        let names = inside.chain(kept.iter().cloned()).collect();
        let mut body = Body::with(self.writer, self.graph, roots, Some(names));
        // In the order in which what is given needs them, which is the same in each setting.
        for &root in roots {
            body.write(root, ALWAYS);
        }
        for (k, &root) in roots.iter().enumerate() {
            let value = body.spelled(root);
            body.put(What::Says(if roots.len() == 1 {
                format!("return {value};")
            } else {
                format!("r[{k}] = {value};")
            }));
        }
        let (banks, lines, operations) = (body.banks, text(&body.statements), body.operations);
        let real = self.writer.real();
        let pointers = (0..banks.len()).map(|k| format!("const {}_setting *s{k}", self.writer.name));
        let numbers = (0..given.len()).map(|k| format!("{real} given_{k}"));
        let kept = kept.iter().map(|(node, name)| format!("{} {name}", self.kind(*node)));
        let gives = if roots.len() == 1 { real.clone() } else { "void".to_owned() };
        let results = (roots.len() > 1).then(|| format!("{real} *r"));
        let parameters = pointers.chain(results).chain(numbers).chain(kept).collect::<Vec<_>>().join(", ");
        let known = self.writer.functions.len();
        let name = self.writer.function(section, gives, parameters, lines);
        if self.writer.functions.len() > known {
            self.operations.0 += operations.0;
        }
        let settings: Vec<String> = banks.into_iter().map(|bank| self.setting(bank)).collect();
        let results = if roots.len() == 1 { Vec::new() } else { vec![marked(&self.results(node))] };
        let values: Vec<String> = given.iter().chain(&held).map(|&node| self.spelled(node)).collect();
        let call = format!("{name}({});", [settings, results, values].concat().join(", "));
        if roots.len() == 1 {
            let of = self.value_of(node);
            self.put(What::Makes(of, call));
        } else {
            let name = self.results(node);
            self.put(What::Declares(Value { kind: real, name, size: format!("[{}]", roots.len()) }));
            self.put(What::Says(call));
        }
    }

    /// The array of what a part gives.
    fn results(&mut self, part: u32) -> String {
        if let Some(name) = self.names.get(&part) {
            return name.clone();
        }
        let name = self.free(&format!("{}_results", self.graph.origins[part as usize].section), false);
        self.names.insert(part, name.clone());
        name
    }

    /// Where the numbers of a bank are.
    fn setting(&mut self, bank: Bank) -> String {
        if !self.is_part {
            return marked(if bank == Bank::To { "to" } else { "from" });
        }
        let place = self.banks.iter().position(|&known| known == bank).unwrap_or_else(|| {
            self.banks.push(bank);
            self.banks.len() - 1
        });
        format!("s{place}")
    }

    /// How a node is named where it is used.
    pub fn spelled(&mut self, node: u32) -> String {
        let node = self.blocks.meant(node);
        let bank = match &self.graph.nodes[node as usize] {
            Node::Known(_, bank, _) | Node::Data(_, bank) | Node::Holds(_, bank) if *bank != Bank::All => {
                self.setting(*bank)
            }
            _ => String::new(),
        };
        match self.writer.known(self.graph, node, |_| bank.clone()) {
            Some(known) => known,
            None => marked(&self.named(node)),
        }
    }

    fn named(&mut self, node: u32) -> String {
        if let Some(name) = self.names.get(&node) {
            return name.clone();
        }
        let name = match (&self.graph.nodes[node as usize], self.graph.names.get(&node)) {
            (&Node::Input(place) | &Node::Flag(place) | &Node::Word(place), _) => {
                let name = match self.writer.of_axis(place) {
                    Some(("in", name)) => format!("input_{name}"),
                    Some((_, name)) => name.to_owned(),
                    None if place < INPUTS.len() => format!("input_{}", name_of(place)),
                    None => name_of(place).to_owned(),
                };
                self.free(&name.replace(['.', '['], "_").replace(']', ""), false)
            }
            (_, Some(name)) => self.free(name, false),
            _ => self.free(self.graph.origins[node as usize].section, true),
        };
        self.names.insert(node, name.clone());
        name
    }

    /// A name that is not taken: this one, or with a number.
    fn free(&mut self, name: &str, numbered: bool) -> String {
        let first = usize::from(!numbered) + 1;
        let bare = (!numbered && !self.taken.contains(name)).then(|| name.to_owned());
        let mut numbers = (first..).map(|k| format!("{name}_{k}"));
        let free = bare.or_else(|| numbers.find(|name| !self.taken.contains(name))).unwrap_or_default();
        self.taken.insert(free.clone());
        free
    }
}
