//! Where each operation is done: in every period, or only where the mask holds that chooses its result.
//!
//! A select whose arms need operations that nothing else needs becomes an `if`, and those operations stand in its arms; so does "and", whose
//! second mask counts only where the first holds. Selects on one mask share one `if` where none of them waits for another. What is left out changes no bit: it would have been thrown away.
//!
//! Each operation stands in the innermost block that holds all of its uses (C. Click, Global code motion, global value numbering, PLDI 1995,
//! pp. 246-257).

use crate::trace::{Graph, Node};
use std::collections::{HashMap, HashSet};

/// The block that is always run.
pub const ALWAYS: usize = 0;

/// Selects on one mask, side by side in one block.
#[derive(Debug, Clone)]
pub struct Group {
    /// What they choose by.
    pub mask: u32,
    /// Where they stand.
    pub block: usize,
    /// What is done where the mask holds, and where it does not.
    pub arms: [usize; 2],
    /// The selects, the last first.
    pub members: Vec<u32>,
}

/// Where each operation is done.
#[derive(Debug, Clone, Default)]
pub struct Blocks {
    /// The block of each node that is needed.
    pub of: HashMap<u32, usize>,
    /// What a select within an arm of its own mask comes to.
    pub instead: HashMap<u32, u32>,
    /// Groups of selects.
    pub groups: Vec<Group>,
    /// The group of a select.
    pub group_of: HashMap<u32, usize>,
    /// The group and the arm that a block is; none for [`ALWAYS`].
    arms: Vec<Option<(usize, usize)>>,
}

/// What a program's nodes are made of, where that is not what the trace says.
#[derive(Debug, Clone, Default)]
pub struct Operands {
    /// The nodes that each is made of.
    pub of: Vec<Vec<u32>>,
    /// Nodes that are made together, each with the first of them.
    pub together: HashMap<u32, u32>,
    /// Nodes that a function is given.
    pub given: HashSet<u32>,
}

/// What a node chooses by, and what where that holds and where not; none where it then does not hold itself.
pub fn choice(graph: &Graph, node: u32) -> Option<(u32, [Option<u32>; 2])> {
    match graph.nodes[node as usize] {
        Node::Select(mask, yes, no) => Some((mask, [Some(yes), Some(no)])),
        Node::And(first, second) => Some(match graph.nodes[first as usize] {
            Node::Not(mask) => (mask, [None, Some(second)]),
            _ => (first, [Some(second), None]),
        }),
        _ => None,
    }
}

impl Blocks {
    /// Places what `wanted` needs.
    pub fn of(graph: &Graph, operands: &Operands, wanted: &[u32]) -> Self {
        let mut blocks = Self { arms: vec![None], ..Self::default() };
        for &node in wanted {
            blocks.used(node, ALWAYS);
        }
        for place in (0..graph.nodes.len()).rev() {
            let Ok(node) = u32::try_from(place) else { continue };
            if let Some(&first) = operands.together.get(&node)
                && let Some(&block) = blocks.of.get(&node)
            {
                blocks.used(first, block);
            }
            if let Some(&block) = blocks.of.get(&node) {
                blocks.place(graph, operands, (node, block));
            }
        }
        for (&node, first) in &operands.together {
            if let Some(&block) = blocks.of.get(first) {
                blocks.of.insert(node, block);
            }
        }
        blocks
    }

    fn place(&mut self, graph: &Graph, operands: &Operands, (node, block): (u32, usize)) {
        match graph.nodes[node as usize] {
            Node::Input(_) | Node::Flag(_) | Node::Word(_) => {
                self.of.insert(node, ALWAYS);
            }
            _ if operands.given.contains(&node) => {
                self.of.insert(node, ALWAYS);
            }
            Node::Select(..) | Node::And(..) => self.choose(graph, operands, (node, block)),
            _ if operands.together.get(&node).is_some_and(|&first| first != node) => {}
            _ => {
                for &one in &operands.of[node as usize] {
                    self.used(one, block);
                }
            }
        }
    }

    /// Places what chooses: in a group, or as what it comes to within an arm of its own mask.
    fn choose(&mut self, graph: &Graph, operands: &Operands, (node, block): (u32, usize)) {
        let Some((mask, chosen)) = choice(graph, node) else { return };
        match self.arm_of(mask, block).map(|arm| chosen[arm]) {
            Some(Some(chosen)) => {
                self.instead.insert(node, chosen);
                self.used(chosen, block);
            }
            // What holds not is spelled out.
            Some(None) => operands.of[node as usize].iter().for_each(|&one| self.used(one, block)),
            None => {
                let group = self.group(operands, (node, mask, block));
                self.used(mask, block);
                for (chosen, arm) in chosen.into_iter().zip(self.groups[group].arms) {
                    if let Some(chosen) = chosen {
                        self.used(chosen, arm);
                    }
                }
            }
        }
    }

    /// The group of a select: one that is there, or a new one.
    fn group(&mut self, operands: &Operands, (node, mask, block): (u32, u32, usize)) -> usize {
        let alike = |group: &Group| group.mask == mask && group.block == block;
        let there = (0..self.groups.len()).rev().filter(|&k| alike(&self.groups[k]));
        let group = there.into_iter().find(|&k| !self.waits_for(operands, k, node)).unwrap_or_else(|| {
            let arms = [self.arms.len(), self.arms.len() + 1];
            self.arms.extend([Some((self.groups.len(), 0)), Some((self.groups.len(), 1))]);
            self.groups.push(Group { mask, block, arms, members: Vec::new() });
            self.groups.len() - 1
        });
        self.groups[group].members.push(node);
        self.group_of.insert(node, group);
        group
    }

    /// Whether a group can be run only after a node, each of the groups on the way being run as a whole.
    fn waits_for(&self, operands: &Operands, group: usize, node: u32) -> bool {
        let mut open = self.groups[group].members.clone();
        let mut seen: HashSet<u32> = open.iter().copied().collect();
        while let Some(one) = open.pop() {
            if one == node {
                return true;
            }
            let whole = self.group_of.get(&one).map_or(&[][..], |&group| &self.groups[group].members);
            let first = operands.together.get(&one);
            for &next in operands.of[one as usize].iter().chain(whole).chain(first) {
                if next >= node && seen.insert(next) {
                    open.push(next);
                }
            }
        }
        false
    }

    /// The arm of a mask within which a block lies.
    fn arm_of(&self, mask: u32, mut block: usize) -> Option<usize> {
        while let Some((group, arm)) = self.arms[block] {
            if self.groups[group].mask == mask {
                return Some(arm);
            }
            block = self.groups[group].block;
        }
        None
    }

    fn used(&mut self, node: u32, block: usize) {
        let both = self.of.get(&node).map_or(block, |&there| self.common(there, block));
        self.of.insert(node, both);
    }

    /// The innermost block that holds two.
    fn common(&self, a: usize, b: usize) -> usize {
        let enclosing = self.enclosing(a);
        self.enclosing(b).into_iter().find(|block| enclosing.contains(block)).unwrap_or(ALWAYS)
    }

    /// A block and those that it lies in, outwards.
    pub fn enclosing(&self, block: usize) -> Vec<usize> {
        let outer = |&block: &usize| self.arms[block].map(|(group, _)| self.groups[group].block);
        core::iter::successors(Some(block), outer).collect()
    }

    /// What stands for a node.
    pub fn meant(&self, mut node: u32) -> u32 {
        while let Some(&other) = self.instead.get(&node) {
            node = other;
        }
        node
    }
}
