//! A number that writes down what is done with it.
//!
//! Each operation becomes a node of a graph, once: the same operation on the same nodes is the same node. What is known is computed at once,
//! in the precision that the target has, so that folding is rounded as the target would have rounded it. A known number has a value for
//! each setting of the feel; two banks of them, `from` and `to`, stand for the settings between which a feel is changed.
//!
//! Sensors and states are taken to be finite, for what is not is turned away before: `0 x` is zero, and a limit that is infinite limits
//! nothing. The sign of a zero is not kept.

pub mod logic;
mod parts;

use core::cell::RefCell;
use core::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};
use core::panic::Location;
use forcefeel_model::Scalar;
use std::collections::{BTreeSet, HashMap};

/// Which settings a known number is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Bank {
    /// The same for all.
    All,
    /// Of the setting that is left, or stays.
    From,
    /// Of the setting that is gone to.
    To,
}

/// Operations on two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "as their names say")]
pub enum BinaryOp {
    Add,
    Sub,
    Mul,
    Div,
    Min,
    Max,
    TimesSign,
}

/// Operations on one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "as their names say")]
pub enum UnaryOp {
    Neg,
    Sqrt,
    Abs,
    Round,
}

/// A node: what it is made of.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Node {
    /// Known: the bits of its value in each setting, and from which set of rows it follows, 0 for none.
    Known(Vec<u64>, Bank, usize),
    /// Known too, and kept as data whatever it is: a number of the law's matrices.
    Data(Vec<u64>, Bank),
    /// An input or a state, by its place.
    Input(usize),
    /// A state that holds or not, by its place.
    Flag(usize),
    /// Of one number.
    UnaryOp(UnaryOp, u32),
    /// Of two numbers.
    BinaryOp(BinaryOp, u32, u32),
    /// Whether the first is less.
    Less(u32, u32),
    /// Both masks.
    And(u32, u32),
    /// Either mask.
    Or(u32, u32),
    /// Not the mask.
    Not(u32),
    /// Of a mask and two numbers.
    Select(u32, u32, u32),
    /// A mask that is known in each setting.
    Holds(Vec<bool>, Bank),
    /// What a part is given, by its place among that.
    Given(usize),
    /// A part, by the nodes that it gives, with what it is given here. If it gives one, it is that number.
    Part(Vec<u32>, Vec<u32>),
    /// One of the several numbers that a part gives.
    Gives(u32, usize),
    /// A count or a code, by its place.
    Word(usize),
    /// A count that is known, or the code of a value by its name.
    Whole(u32, &'static str),
    /// One more than a count.
    Next(u32),
    /// The larger of two counts.
    Larger(u32, u32),
    /// Whether a count is so much or more.
    AtLeast(u32, u32),
    /// Whether two codes are the same.
    Same(u32, u32),
    /// A count as a number.
    Number(u32),
    /// Whether a number is one, and finite.
    IsNumber(u32),
    /// Masks as bits of a word, the first the lowest.
    Bits(Vec<u32>),
}

/// Where an operation comes from.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Origin {
    /// Its section of a period.
    pub section: &'static str,
    /// The file of the model that asks for it, below its `src`; nothing of what the tracer adds.
    pub file: &'static str,
}

/// What was written down.
#[derive(Debug, Clone, Default)]
pub struct Graph {
    /// The nodes, each after those that it is made of.
    pub nodes: Vec<Node>,
    known: HashMap<Node, u32>,
    single: bool,
    /// How many settings of the feel it is of.
    pub settings: usize,
    /// The input that says how far one setting has been changed into another.
    share: Option<usize>,
    /// Parts that have begun and not ended.
    parts: usize,
    /// Where operations come from now.
    origin: Origin,
    /// Where each node comes from: where it was made first.
    pub origins: Vec<Origin>,
    /// Nodes with a name of their own.
    pub names: HashMap<u32, &'static str>,
    /// The rows, by their places, that data and masks follow from, and those that known numbers do.
    rows: HashMap<u32, BTreeSet<usize>>,
    row_sets: Vec<BTreeSet<usize>>,
}

thread_local! {
    static GRAPH: RefCell<Graph> = RefCell::default();
}

/// A number that writes down what is done with it: its node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trace(pub u32);

/// The outcome of a comparison: its node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mask(pub u32);

/// What `work` gives, and the graph that it wrote; `single` where the target computes in single precision, and by which input one setting
/// is changed into another.
pub fn traced<T>(single: bool, settings: usize, share: Option<usize>, work: impl FnOnce() -> T) -> (T, Graph) {
    GRAPH.with_borrow_mut(|graph| *graph = Graph { single, settings, share, ..Graph::default() });
    let evaluated = work();
    (evaluated, GRAPH.with_borrow_mut(core::mem::take))
}

/// The `f64` by which an input is told where the model takes none but `f64`: not a number, with the input's place in its last bits.
pub fn input_as_f64(place: usize) -> f64 {
    f64::from_bits(NAMED | place as u64)
}

const NAMED: u64 = 0x7ff8_f0ce_fee1_0000;
const PLACE: u64 = 0xffff;

/// The same for any number: its node in the last bits.
const TRACED: u64 = 0x7ff8_f0cf_0000_0000;

impl From<Trace> for f64 {
    fn from(number: Trace) -> Self {
        Self::from_bits(TRACED | u64::from(number.0))
    }
}

impl Graph {
    fn put(&mut self, node: Node) -> u32 {
        if let Some(&there) = self.known.get(&node) {
            return there;
        }
        let place = u32::try_from(self.nodes.len()).expect("a period has less than 2^32 operations");
        self.known.insert(node.clone(), place);
        self.nodes.push(node);
        self.origins.push(self.origin);
        place
    }

    /// The node as what follows from rows too; zero, one and infinity, which leave no operation, follow from none.
    fn follows_from(&mut self, node: u32, rows: BTreeSet<usize>) -> u32 {
        let neutral = |bits: &u64| [0.0, 1.0, f64::INFINITY].contains(&f64::from_bits(*bits).abs());
        match &self.nodes[node as usize] {
            _ if rows.is_empty() => node,
            Node::Known(bits, ..) if bits.iter().all(neutral) => node,
            Node::Known(bits, bank, _) => {
                let (bits, bank) = (bits.clone(), *bank);
                let rows = &rows | &self.rows_of(&[node]);
                let set = self.row_sets.iter().position(|known| *known == rows).unwrap_or_else(|| {
                    self.row_sets.push(rows);
                    self.row_sets.len() - 1
                });
                self.put(Node::Known(bits, bank, set + 1))
            }
            _ => {
                self.rows.entry(node).or_default().extend(rows);
                node
            }
        }
    }

    /// The rows that known numbers among nodes follow from.
    pub fn rows_of(&self, nodes: &[u32]) -> BTreeSet<usize> {
        let of = |node: &u32| match &self.nodes[*node as usize] {
            Node::Known(_, _, set) => set.checked_sub(1).map(|set| &self.row_sets[set]),
            _ => self.rows.get(node),
        };
        nodes.iter().filter_map(of).flatten().copied().collect()
    }

    /// A number that is known since others are.
    fn folded(&mut self, values: &[f64], bank: Bank, of: &[u32]) -> u32 {
        let number = self.number(values, bank);
        let rows = self.rows_of(of);
        self.follows_from(number, rows)
    }

    /// Values in all settings and the bank, of what may be folded.
    fn value(&self, node: u32) -> Option<(Vec<f64>, Bank)> {
        let Node::Known(bits, bank, _) = &self.nodes[node as usize] else { return None };
        Some((bits.iter().map(|&bits| f64::from_bits(bits)).collect(), *bank))
    }

    /// Whether it is known and so in every setting.
    fn is(&self, node: u32, so: impl Fn(f64) -> bool) -> bool {
        self.value(node).is_some_and(|(values, _)| values.into_iter().all(so))
    }

    fn number(&mut self, values: &[f64], bank: Bank) -> u32 {
        let rounded = values.iter().map(|&value| self.rounded(value).to_bits());
        let bits: Vec<u64> = rounded.collect();
        let same = bits.iter().all(|&one| one == bits[0]);
        self.put(Node::Known(bits, if same { Bank::All } else { bank }, 0))
    }

    #[expect(clippy::cast_possible_truncation, reason = "rounding to single precision is what is asked")]
    fn rounded(&self, value: f64) -> f64 {
        if self.single { f64::from(value as f32) } else { value }
    }

    #[expect(clippy::cast_possible_truncation, reason = "numbers of single precision, held in double")]
    fn one(&mut self, operation: UnaryOp, a: u32) -> u32 {
        if let Some((values, bank)) = self.value(a) {
            let single = self.single;
            let of = |x: f64| if single { f64::from(apply_one(operation, x as f32)) } else { apply_one(operation, x) };
            let evaluated: Vec<f64> = values.into_iter().map(of).collect();
            return self.folded(&evaluated, bank, &[a]);
        }
        if operation == UnaryOp::Neg
            && let Some(reversed) = self.reversed(a)
        {
            return reversed;
        }
        self.put(Node::UnaryOp(operation, a))
    }

    /// `-a`, where that takes no operation.
    fn reversed(&mut self, a: u32) -> Option<u32> {
        match self.nodes[a as usize] {
            Node::Known(..) => Some(self.one(UnaryOp::Neg, a)),
            Node::UnaryOp(UnaryOp::Neg, inner) => Some(inner),
            Node::BinaryOp(BinaryOp::TimesSign, size, of) => {
                let size = self.reversed(size)?;
                Some(self.two(BinaryOp::TimesSign, size, of))
            }
            Node::Select(mask, yes, no) => {
                let (yes, no) = (self.reversed(yes)?, self.reversed(no)?);
                Some(self.select(mask, yes, no))
            }
            _ => None,
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "numbers of single precision, held in double")]
    fn two(&mut self, operation: BinaryOp, a: u32, b: u32) -> u32 {
        if let (Some((x, bank_x)), Some((y, bank_y))) = (self.value(a), self.value(b))
            && let Some(bank) = together(bank_x, bank_y)
        {
            let single = self.single;
            let of = |x: f64, y: f64| {
                if single { f64::from(apply(operation, x as f32, y as f32)) } else { apply(operation, x, y) }
            };
            let evaluated: Vec<f64> = x.into_iter().zip(y).map(|(x, y)| of(x, y)).collect();
            return self.folded(&evaluated, bank, &[a, b]);
        }
        // a + (-b) = a - b, a - (-b) = a + b
        match (operation, &self.nodes[b as usize]) {
            (BinaryOp::Add, &Node::UnaryOp(UnaryOp::Neg, inner)) => return self.two(BinaryOp::Sub, a, inner),
            (BinaryOp::Sub, &Node::UnaryOp(UnaryOp::Neg, inner)) => return self.two(BinaryOp::Add, a, inner),
            _ => {}
        }
        let (zero, one) = (|x: f64| x == 0.0, |x: f64| x.to_bits() == 1f64.to_bits());
        let (most, least) = (|x: f64| x == f64::INFINITY, |x: f64| x == f64::NEG_INFINITY);
        match operation {
            BinaryOp::Add if self.is(a, zero) => return b,
            BinaryOp::Add | BinaryOp::Sub if self.is(b, zero) => return a,
            BinaryOp::Sub if self.is(a, zero) => return self.one(UnaryOp::Neg, b),
            BinaryOp::Mul if self.is(a, one) => return b,
            BinaryOp::Mul | BinaryOp::Div if self.is(b, one) => return a,
            BinaryOp::Mul if self.is(b, zero) => return self.number(&vec![0.0; self.settings], Bank::All),
            BinaryOp::Mul | BinaryOp::TimesSign if self.is(a, zero) => {
                return self.number(&vec![0.0; self.settings], Bank::All);
            }
            BinaryOp::Add if self.between(a, b) => return self.changed(a, b),
            BinaryOp::Min if self.is(a, most) => return b,
            BinaryOp::Max if self.is(a, least) => return b,
            BinaryOp::Min if self.is(b, most) => return a,
            BinaryOp::Max if self.is(b, least) => return a,
            BinaryOp::Min => {
                // Between limits that meet.
                if let &Node::BinaryOp(BinaryOp::Max, _, low) = &self.nodes[a as usize]
                    && let (Some((low, one)), Some((high, two))) = (self.value(low), self.value(b))
                    && together(one, two).is_some()
                    && low.iter().zip(&high).all(|(low, high)| low >= high)
                {
                    return b;
                }
            }
            _ => {}
        }
        self.put(Node::BinaryOp(operation, a, b))
    }

    /// Whether `a + b` is `a + (a' - a) share`.
    fn between(&self, a: u32, b: u32) -> bool {
        let Node::BinaryOp(BinaryOp::Mul, change, share) = self.nodes[b as usize] else { return false };
        let of_share = matches!(self.nodes[share as usize], Node::Input(place) if Some(place) == self.share);
        of_share && matches!(self.nodes[change as usize], Node::BinaryOp(BinaryOp::Sub, _, from) if from == a)
    }

    /// `a + b` of what is between two settings: `a` itself while nothing is changed, and where both are the same.
    fn changed(&mut self, a: u32, b: u32) -> u32 {
        let Node::BinaryOp(BinaryOp::Mul, change, share) = self.nodes[b as usize] else { return a };
        if matches!(self.nodes[change as usize], Node::BinaryOp(BinaryOp::Sub, to, _) if to == a) {
            return a;
        }
        let zero = self.number(&vec![0.0; self.settings], Bank::All);
        let changing = self.less(zero, share);
        let sum = self.put(Node::BinaryOp(BinaryOp::Add, a, b));
        self.select(changing, sum, a)
    }

    fn less(&mut self, a: u32, b: u32) -> u32 {
        if let (Some((x, bank_x)), Some((y, bank_y))) = (self.value(a), self.value(b))
            && let Some(bank) = together(bank_x, bank_y)
        {
            let evaluated = x.iter().zip(&y).map(|(x, y)| x < y).collect();
            let mask = self.holds(evaluated, bank);
            let rows = self.rows_of(&[a, b]);
            return self.follows_from(mask, rows);
        }
        let (most, least) = (|x: f64| x == f64::INFINITY, |x: f64| x == f64::NEG_INFINITY);
        if a == b || self.is(a, most) || self.is(b, least) {
            return self.holds(vec![false; self.settings], Bank::All);
        }
        if self.is(b, most) || self.is(a, least) || self.is(a, |x| x == 0.0) && self.is_something(b) {
            return self.holds(vec![true; self.settings], Bank::All);
        }
        self.put(Node::Less(a, b))
    }

    /// Whether it is the magnitude of data that are nowhere zero: what is zero is left out of the code, so no other data may stand there.
    fn is_something(&self, node: u32) -> bool {
        let Node::UnaryOp(UnaryOp::Abs, data) = self.nodes[node as usize] else { return false };
        matches!(&self.nodes[data as usize], Node::Data(bits, _) if bits.iter().all(|&bits| f64::from_bits(bits) != 0.0))
    }

    fn holds(&mut self, values: Vec<bool>, bank: Bank) -> u32 {
        let same = values.iter().all(|&one| one == values[0]);
        self.put(Node::Holds(values, if same { Bank::All } else { bank }))
    }

    fn mask(&self, node: u32) -> Option<(&[bool], Bank)> {
        if let Node::Holds(values, bank) = &self.nodes[node as usize] { Some((values, *bank)) } else { None }
    }

    /// Whether a mask is known, and the same in all settings.
    fn always(&self, node: u32) -> Option<bool> {
        self.mask(node).and_then(|(values, bank)| (bank == Bank::All).then_some(values[0]))
    }

    fn both(&mut self, a: u32, b: u32, and: bool) -> u32 {
        // `and` of what holds is the other, `or` of what does not likewise.
        for (one, other) in [(a, b), (b, a)] {
            match self.always(one) {
                Some(value) if value == and => return other,
                Some(_) => return one,
                None => {}
            }
        }
        if let (Some((x, one)), Some((y, two))) = (self.mask(a), self.mask(b))
            && let Some(bank) = together(one, two)
        {
            let evaluated = x.iter().zip(y).map(|(&x, &y)| if and { x & y } else { x | y }).collect();
            return self.holds(evaluated, bank);
        }
        if and && (self.denies(a, b) || self.denies(b, a)) {
            return self.holds(vec![false; self.settings], Bank::All);
        }
        self.put(if and { Node::And(a, b) } else { Node::Or(a, b) })
    }

    /// Whether `b` is the opposite of `a`, or of one of the masks that must hold for `a`.
    fn denies(&self, a: u32, b: u32) -> bool {
        if self.nodes[b as usize] == Node::Not(a) {
            return true;
        }
        matches!(self.nodes[a as usize], Node::And(one, other) if self.denies(one, b) || self.denies(other, b))
    }

    fn not(&mut self, a: u32) -> u32 {
        if let Some((values, bank)) = self.mask(a) {
            let evaluated = values.iter().map(|&one| !one).collect();
            return self.holds(evaluated, bank);
        }
        self.put(Node::Not(a))
    }

    fn select(&mut self, mask: u32, yes: u32, no: u32) -> u32 {
        // Within an arm the same mask is known.
        let of_arm = |node: u32, held: bool| match self.nodes[node as usize] {
            Node::Select(same, yes, no) if same == mask => {
                if held {
                    yes
                } else {
                    no
                }
            }
            _ => node,
        };
        let (mut yes, no) = (of_arm(yes, true), of_arm(no, false));
        // Where one of two masks holds, and the second does not, the first does.
        if let (&Node::Or(a, b), &Node::Select(second, high, low)) =
            (&self.nodes[mask as usize], &self.nodes[yes as usize])
            && let Some(first) = [(a, b), (b, a)].into_iter().find_map(|(x, y)| (y == second).then_some(x))
            && let Node::Select(same, held, _) = self.nodes[low as usize]
            && same == first
        {
            yes = self.select(second, high, held);
        }
        if yes == no {
            return yes;
        }
        // The same numbers, of whatever rows.
        if let (Some((x, bank)), Some((y, other))) = (self.value(yes), self.value(no))
            && bank == other
            && x.iter().map(|it| it.to_bits()).eq(y.iter().map(|it| it.to_bits()))
        {
            return self.folded(&x, bank, &[yes, no]);
        }
        if let Node::Not(mask) = self.nodes[mask as usize] {
            return self.select(mask, no, yes);
        }
        if let Some(value) = self.always(mask) {
            return if value { yes } else { no };
        }
        if let (Some((masks, bank)), Some((x, one)), Some((y, two))) =
            (self.mask(mask), self.value(yes), self.value(no))
            && let Some(bank) = together(bank, one).and_then(|bank| together(bank, two))
        {
            let evaluated: Vec<f64> =
                masks.iter().zip(x.iter().zip(y)).map(|(&m, (&x, y))| if m { x } else { y }).collect();
            return self.folded(&evaluated, bank, &[mask, yes, no]);
        }
        self.put(Node::Select(mask, yes, no))
    }
}

impl Node {
    /// The nodes that it is made of; of a part, those that it is given.
    pub fn operands(&self) -> Vec<u32> {
        match *self {
            Self::Known(..)
            | Self::Data(..)
            | Self::Input(_)
            | Self::Flag(_)
            | Self::Holds(..)
            | Self::Given(_)
            | Self::Word(_)
            | Self::Whole(..) => Vec::new(),
            Self::UnaryOp(_, a)
            | Self::Not(a)
            | Self::Gives(a, _)
            | Self::Next(a)
            | Self::AtLeast(a, _)
            | Self::Number(a)
            | Self::IsNumber(a) => vec![a],
            Self::BinaryOp(_, a, b)
            | Self::Less(a, b)
            | Self::And(a, b)
            | Self::Or(a, b)
            | Self::Larger(a, b)
            | Self::Same(a, b) => vec![a, b],
            Self::Select(a, b, c) => vec![a, b, c],
            Self::Part(_, ref given) => given.clone(),
            Self::Bits(ref masks) => masks.clone(),
        }
    }
}

/// The bank of what is made of two; none where they are of different ones.
fn together(a: Bank, b: Bank) -> Option<Bank> {
    match (a, b) {
        (Bank::All, other) | (other, Bank::All) => Some(other),
        (a, b) => (a == b).then_some(a),
    }
}

fn apply<S: Scalar>(operation: BinaryOp, x: S, y: S) -> S {
    match operation {
        BinaryOp::Add => x + y,
        BinaryOp::Sub => x - y,
        BinaryOp::Mul => x * y,
        BinaryOp::Div => x / y,
        BinaryOp::Min => x.min(y),
        BinaryOp::Max => x.max(y),
        BinaryOp::TimesSign => x.times_sign(y),
    }
}

fn apply_one<S: Scalar>(operation: UnaryOp, x: S) -> S {
    match operation {
        UnaryOp::Neg => -x,
        UnaryOp::Sqrt => x.sqrt(),
        UnaryOp::Abs => Scalar::abs(x),
        UnaryOp::Round => x.round(),
    }
}

/// Where the model's files begin in the compiler's paths.
const MODEL: [&str; 2] = ["model/src/", "model\\src\\"];

/// Works on the graph; the nodes that it makes come from the caller's file.
#[track_caller]
fn with_graph<T>(work: impl FnOnce(&mut Graph) -> T) -> T {
    let path = Location::caller().file();
    let file = MODEL.iter().find_map(|folder| path.rsplit_once(folder)).map_or("", |(_, file)| file);
    GRAPH.with_borrow_mut(|graph| {
        graph.origin.file = file;
        work(graph)
    })
}

#[track_caller]
fn put(work: impl FnOnce(&mut Graph) -> u32) -> Trace {
    Trace(with_graph(work))
}

#[track_caller]
fn mask(work: impl FnOnce(&mut Graph) -> u32) -> Mask {
    Mask(with_graph(work))
}

impl Trace {
    /// A known number with its value in each setting.
    pub fn known(values: &[f64], bank: Bank) -> Self {
        put(|graph| graph.number(values, bank))
    }

    /// A number of the law's matrices, which stays data.
    pub fn data(values: &[f64], bank: Bank) -> Self {
        put(|graph| {
            let bits = values.iter().map(|&value| graph.rounded(value).to_bits()).collect();
            graph.put(Node::Data(bits, bank))
        })
    }

    /// The known number as what follows from a row, by its place.
    #[must_use]
    pub fn of_row(self, row: usize) -> Self {
        put(|graph| graph.follows_from(self.0, BTreeSet::from([row])))
    }

    /// An input or a state.
    pub fn input(place: usize) -> Self {
        put(|graph| graph.put(Node::Input(place)))
    }
}

impl Mask {
    /// A state that holds or not.
    pub fn flag(place: usize) -> Self {
        Self(GRAPH.with_borrow_mut(|graph| graph.put(Node::Flag(place))))
    }
}

macro_rules! operator {
    ($Trait:ident, $method:ident) => {
        impl $Trait for Trace {
            type Output = Self;
            #[track_caller]
            fn $method(self, other: Self) -> Self {
                put(|graph| graph.two(BinaryOp::$Trait, self.0, other.0))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Trace {
    type Output = Self;
    #[track_caller]
    fn neg(self) -> Self {
        put(|graph| graph.one(UnaryOp::Neg, self.0))
    }
}

impl BitAnd for Mask {
    type Output = Self;
    #[track_caller]
    fn bitand(self, other: Self) -> Self {
        mask(|graph| graph.both(self.0, other.0, true))
    }
}

impl BitOr for Mask {
    type Output = Self;
    #[track_caller]
    fn bitor(self, other: Self) -> Self {
        mask(|graph| graph.both(self.0, other.0, false))
    }
}

impl Not for Mask {
    type Output = Self;
    #[track_caller]
    fn not(self) -> Self {
        mask(|graph| graph.not(self.0))
    }
}

impl Scalar for Trace {
    type Mask = Mask;

    fn constant(self, value: f64) -> Self {
        if value.is_nan() && value.to_bits() & !PLACE == NAMED {
            return Self::input((value.to_bits() & PLACE) as usize);
        }
        if value.is_nan() && value.to_bits() >> 32 == TRACED >> 32 {
            return Self(u32::try_from(value.to_bits() & u64::from(u32::MAX)).unwrap_or_default());
        }
        put(|graph| graph.number(&vec![value; graph.settings], Bank::All))
    }
    #[track_caller]
    fn sqrt(self) -> Self {
        put(|graph| graph.one(UnaryOp::Sqrt, self.0))
    }
    #[track_caller]
    fn abs(self) -> Self {
        put(|graph| graph.one(UnaryOp::Abs, self.0))
    }
    #[track_caller]
    fn round(self) -> Self {
        put(|graph| graph.one(UnaryOp::Round, self.0))
    }
    #[track_caller]
    fn min(self, other: Self) -> Self {
        put(|graph| graph.two(BinaryOp::Min, self.0, other.0))
    }
    #[track_caller]
    fn max(self, other: Self) -> Self {
        put(|graph| graph.two(BinaryOp::Max, self.0, other.0))
    }
    #[track_caller]
    fn times_sign(self, other: Self) -> Self {
        put(|graph| graph.two(BinaryOp::TimesSign, self.0, other.0))
    }
    #[track_caller]
    fn is_number(self) -> Mask {
        mask(|graph| graph.is_number(self.0))
    }
    #[track_caller]
    fn less(self, other: Self) -> Mask {
        mask(|graph| graph.less(self.0, other.0))
    }
    /// What may hold is computed.
    fn any(mask: Mask) -> bool {
        GRAPH.with_borrow(|graph| graph.mask(mask.0).is_none_or(|(values, _)| values.contains(&true)))
    }
    #[track_caller]
    fn select(condition: Mask, yes: Self, no: Self) -> Self {
        put(|graph| graph.select(condition.0, yes.0, no.0))
    }
    fn part_begins<const N: usize>(given: [Self; N]) -> [Self; N] {
        let parts = GRAPH.with_borrow_mut(|graph| {
            graph.parts += 1;
            graph.parts
        });
        // A part of a part is written out.
        if parts == 1 { core::array::from_fn(|k| put(|graph| graph.put(Node::Given(k)))) } else { given }
    }
    fn part_ends<const N: usize, const M: usize>(given: [Self; N], evaluated: [Self; M]) -> [Self; M] {
        GRAPH.with_borrow_mut(|graph| {
            graph.parts -= 1;
            if graph.parts > 0 {
                return evaluated;
            }
            let given = given.map(|one| one.0);
            let roots = graph.roots(evaluated.map(|one| one.0));
            if !graph.is_worth_a_function(&roots) {
                let depends = graph.on_given();
                let origin = graph.origin;
                let written = evaluated.map(|one| Self(graph.written_out(one.0, (&depends, &given))));
                graph.origin = origin;
                return written;
            }
            let part = graph.put(Node::Part(roots.clone(), given.to_vec()));
            evaluated.map(|one| match roots.iter().position(|&root| root == one.0) {
                None => one,
                Some(0) if roots.len() == 1 => Self(part),
                Some(k) => Self(graph.put(Node::Gives(part, k))),
            })
        })
    }
    fn section(name: &'static str) {
        GRAPH.with_borrow_mut(|graph| graph.origin.section = name);
    }
    fn named(self, name: &'static str) -> Self {
        GRAPH.with_borrow_mut(|graph| {
            graph.names.entry(self.0).or_insert(name);
        });
        self
    }
    #[track_caller]
    fn slope_times(self, by: Self) -> Self {
        self * by
    }
    #[track_caller]
    fn slope_over(self, by: Self) -> Self {
        self / by
    }
}
