//! Counts, codes, sets and decisions that are written down.
//!
//! A decision is taken both ways: [`Logic::paths`] runs its work once for each way through it, and chooses between what the ways leave
//! by the conditions that were decided. So the lines of the model become selects, and those the branches of the C.

use super::{Bank, GRAPH, Graph, Mask, Node, Trace, mask, with_graph};
use core::cell::RefCell;
use forcefeel_model::logic::{Count, FunctionSet, Logic, LogicState, LogicVisitor, Named};
use forcefeel_model::memory::MemoryVisitor;
use forcefeel_model::supervisor::{Action, Function};

/// A count or a code: its node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Word(pub u32);

/// A set of functions: for each whether it is in it.
pub type Masks = [Mask; Function::ALL.len()];

impl Graph {
    pub(super) fn is_number(&mut self, a: u32) -> u32 {
        if let Some((values, bank)) = self.value(a) {
            return self.holds(values.into_iter().map(f64::is_finite).collect(), bank);
        }
        self.put(Node::IsNumber(a))
    }

    fn known(&mut self, holds: bool) -> u32 {
        self.holds(vec![holds; self.settings], Bank::All)
    }

    /// `yes` where a mask holds, else `no`, of masks.
    fn choose(&mut self, mask: u32, yes: u32, no: u32) -> u32 {
        match (self.always(yes), self.always(no)) {
            (Some(true), _) => self.both(mask, no, false),
            (_, Some(false)) => self.both(mask, yes, true),
            (Some(false), _) => {
                let not = self.not(mask);
                self.both(not, no, true)
            }
            (_, Some(true)) => {
                let not = self.not(mask);
                self.both(not, yes, false)
            }
            _ => self.select(mask, yes, no),
        }
    }

    fn is_mask(&self, node: u32) -> bool {
        match self.nodes[node as usize] {
            Node::Flag(_)
            | Node::Less(..)
            | Node::And(..)
            | Node::Or(..)
            | Node::Not(_)
            | Node::Holds(..)
            | Node::AtLeast(..)
            | Node::Same(..)
            | Node::IsNumber(_) => true,
            Node::Select(_, yes, _) => self.is_mask(yes),
            _ => false,
        }
    }

    /// What a number, a flag or a word is in C.
    pub fn kind(&self, node: u32) -> Kind {
        match self.nodes[node as usize] {
            _ if self.is_mask(node) => Kind::Flag,
            Node::Word(_) | Node::Whole(..) | Node::Next(_) | Node::Larger(..) | Node::Bits(_) => Kind::Word,
            Node::Select(_, yes, _) => self.kind(yes),
            _ => Kind::Number,
        }
    }
}

/// What a node is in C.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// A flag.
    Flag,
    /// A count or a code.
    Word,
}

#[track_caller]
fn word(work: impl FnOnce(&mut Graph) -> u32) -> Word {
    Word(with_graph(work))
}

impl Word {
    /// A set as bits, in the order of the table.
    pub fn bits(set: &Masks) -> Self {
        word(|graph| graph.put(Node::Bits(set.iter().map(|mask| mask.0).collect())))
    }

    /// A count or a code that is an input or a state.
    pub fn input(place: usize) -> Self {
        word(|graph| graph.put(Node::Word(place)))
    }
}

impl Count<Mask> for Word {
    fn none() -> Self {
        word(|graph| graph.put(Node::Whole(0, "")))
    }
    #[track_caller]
    fn next(self) -> Self {
        word(|graph| graph.put(Node::Next(self.0)))
    }
    #[track_caller]
    fn larger(self, other: Self) -> Self {
        word(|graph| graph.put(Node::Larger(self.0, other.0)))
    }
    #[track_caller]
    fn at_least(self, samples: u32) -> Mask {
        mask(|graph| match graph.nodes[self.0 as usize] {
            _ if samples == 0 => graph.known(true),
            Node::Whole(count, _) => graph.known(count >= samples),
            _ => graph.put(Node::AtLeast(self.0, samples)),
        })
    }
    #[track_caller]
    fn only(self, condition: Mask) -> Self {
        let none = Self::none();
        word(|graph| graph.select(condition.0, self.0, none.0))
    }
}

impl FunctionSet<Mask> for Masks {
    fn none() -> Self {
        [Trace::mask(false); Function::ALL.len()]
    }
    #[track_caller]
    fn with(mut self, function: Function, holds: Mask) -> Self {
        self[function as usize] = self[function as usize] | holds;
        self
    }
    #[track_caller]
    fn and(self, other: Self) -> Self {
        core::array::from_fn(|k| self[k] | other[k])
    }
    #[track_caller]
    fn stops(self) -> Mask {
        any(self.stopping())
    }
    #[track_caller]
    fn does(self, action: Action) -> Mask {
        any(core::array::from_fn(|k| if Function::ALL[k].action() == action { self[k] } else { Trace::mask(false) }))
    }
    fn has(self, function: Function) -> Mask {
        self[function as usize]
    }
    fn stopping(self) -> Self {
        core::array::from_fn(|k| if Function::ALL[k].action().stops() { self[k] } else { Trace::mask(false) })
    }
    fn without(mut self, function: Function) -> Self {
        self[function as usize] = Trace::mask(false);
        self
    }
}

#[track_caller]
fn any(set: Masks) -> Mask {
    set.into_iter().fold(Trace::mask(false), |any, holds| any | holds)
}

thread_local! {
    /// What was decided in the ways that are under way, the innermost last.
    static DECIDED: RefCell<Vec<Vec<(Mask, bool)>>> = const { RefCell::new(Vec::new()) };
}

impl Logic for Trace {
    type Count = Word;
    type Set = Masks;
    type Code<E: Named> = Word;

    fn mask(holds: bool) -> Mask {
        mask(|graph| graph.known(holds))
    }
    fn holds(mask: Mask) -> bool {
        let (always, opposite) = GRAPH.with_borrow(|graph| {
            let opposite = if let Node::Not(mask) = graph.nodes[mask.0 as usize] { Some(Mask(mask)) } else { None };
            (graph.always(mask.0), opposite)
        });
        if let Some(always) = always {
            return always;
        }
        if let Some(opposite) = opposite {
            return !Self::holds(opposite);
        }
        DECIDED.with_borrow_mut(|ways| {
            if let Some(&(_, way)) = ways.iter().flatten().find(|(decided, _)| *decided == mask) {
                return way;
            }
            ways.last_mut().expect("decisions are taken within paths").push((mask, true));
            true
        })
    }
    fn code<E: Named>(value: E) -> Word {
        let place = E::ALL.iter().position(|known| *known == value).expect("all values are among ALL");
        word(|graph| graph.put(Node::Whole(u32::try_from(place).expect("a few values"), value.name())))
    }
    #[track_caller]
    fn is<E: Named>(code: Word, value: E) -> Mask {
        let value = Self::code(value);
        mask(|graph| match graph.nodes[code.0 as usize] {
            Node::Whole(..) => graph.known(code == value),
            _ => graph.put(Node::Same(code.0, value.0)),
        })
    }
    #[track_caller]
    fn which<E: Named>(code: Word) -> E {
        let [others @ .., last] = E::ALL else { unreachable!("an enumeration has values") };
        others.iter().copied().find(|&value| Self::holds(Self::is(code, value))).unwrap_or(*last)
    }
    #[track_caller]
    fn first(set: Masks) -> Word {
        let named = Function::ALL.iter().rev();
        named.fold(Self::code(None::<Function>), |later, &function| {
            let this = Self::code(Some(function));
            word(|graph| graph.select(set.has(function).0, this.0, later.0))
        })
    }
    #[track_caller]
    fn number(self, count: Word) -> Self {
        Self(with_graph(|graph| graph.put(Node::Number(count.0))))
    }
    fn paths<M: LogicState<Self>>(state: &mut M, work: impl Fn(&mut M)) {
        *state = explored(state, &work, Vec::new());
    }
}

/// What the ways leave of a state that begin with these decisions.
fn explored<M: LogicState<Trace>>(state: &M, work: &impl Fn(&mut M), begins: Vec<(Mask, bool)>) -> M {
    let given = begins.len();
    DECIDED.with_borrow_mut(|ways| ways.push(begins));
    let mut left = state.clone();
    work(&mut left);
    let way = DECIDED.with_borrow_mut(Vec::pop).unwrap_or_default();
    // Each decision was that the condition holds; now the other way, the last first.
    for k in (given..way.len()).rev() {
        let (condition, _) = way[k];
        let mut other = explored(state, work, [&way[..k], &[(condition, false)]].concat());
        let mut nodes = Visiting(Nodes(Vec::new()));
        other.visit(&mut nodes);
        left.visit(&mut Visiting(Chosen { condition: condition.0, others: nodes.0.0.into_iter() }));
    }
    left
}

/// Takes the node of each number, flag and word.
pub trait NodeVisitor {
    /// A node, by the name and the kind of what it is, to read or to replace.
    fn node(&mut self, name: &'static str, kind: Kind, node: &mut u32);
    /// See [`LogicVisitor::begin`].
    fn begin(&mut self, _name: &'static str) {}
    /// See [`LogicVisitor::end`].
    fn end(&mut self) {}
}

/// A visitor of nodes as one of what they are.
#[derive(Debug)]
pub struct Visiting<V>(pub V);

impl<V: NodeVisitor> MemoryVisitor<Trace> for Visiting<V> {
    #[track_caller]
    fn number(&mut self, name: &'static str, number: &mut Trace) {
        self.0.node(name, Kind::Number, &mut number.0);
    }
    fn flag(&mut self, name: &'static str, flag: &mut Mask) {
        self.0.node(name, Kind::Flag, &mut flag.0);
    }
}

impl<V: NodeVisitor> LogicVisitor<Trace> for Visiting<V> {
    fn count(&mut self, name: &'static str, count: &mut Word) {
        self.0.node(name, Kind::Word, &mut count.0);
    }
    fn code<E: Named>(&mut self, name: &'static str, code: &mut Word) {
        self.0.node(name, Kind::Word, &mut code.0);
    }
    fn set(&mut self, name: &'static str, set: &mut Masks) {
        self.0.begin(name);
        for (function, holds) in Function::ALL.iter().zip(set) {
            self.0.node(function.name(), Kind::Flag, &mut holds.0);
        }
        self.0.end();
    }
    fn begin(&mut self, name: &'static str) {
        self.0.begin(name);
    }
    fn end(&mut self) {
        self.0.end();
    }
}

/// Notes nodes.
struct Nodes(Vec<u32>);

impl NodeVisitor for Nodes {
    fn node(&mut self, _: &'static str, _: Kind, node: &mut u32) {
        self.0.push(*node);
    }
}

/// Keeps each node where a condition holds, and takes another where not.
struct Chosen<I> {
    condition: u32,
    others: I,
}

impl<I: Iterator<Item = u32>> NodeVisitor for Chosen<I> {
    fn node(&mut self, _: &'static str, kind: Kind, node: &mut u32) {
        let other = self.others.next().expect("a state is visited in one order");
        if *node != other {
            *node = GRAPH.with_borrow_mut(|graph| match kind {
                Kind::Flag => graph.choose(self.condition, *node, other),
                _ => graph.select(self.condition, *node, other),
            });
        }
    }
}
