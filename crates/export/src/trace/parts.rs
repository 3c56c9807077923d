//! Parts of a period that are done several times: what they depend on, and whether they become functions.

use super::{Graph, Node};
use std::collections::HashSet;

/// Least operations of a part that are worth a function; fewer are written where they are done.
const WORTH_A_FUNCTION: usize = 20;

impl Graph {
    /// Whether a part is a function: of a law that changes between settings, where enough operations depend on what it is given.
    ///
    /// A law of one setting asks for each part a few times, and takes fewer instructions where it is written out; one of many has two
    /// laws' parts in a period, and would not be within its bytes.
    pub(super) fn is_worth_a_function(&self, roots: &[u32]) -> bool {
        if self.settings == 1 {
            return false;
        }
        let depends = self.on_given();
        let mut open = roots.to_vec();
        let mut seen = HashSet::new();
        while let Some(node) = open.pop() {
            if depends[node as usize] && seen.insert(node) {
                open.extend(self.nodes[node as usize].operands());
            }
        }
        seen.len() >= WORTH_A_FUNCTION
    }

    /// Those of what a part gives that depend on what it is given, each once.
    pub(super) fn roots<const M: usize>(&self, depends_on_input: [u32; M]) -> Vec<u32> {
        let depends = self.on_given();
        let mut roots = Vec::new();
        for node in depends_on_input {
            if depends[node as usize] && !roots.contains(&node) {
                roots.push(node);
            }
        }
        roots
    }

    /// A node of a part with what the part is given in place of what it depends on.
    pub(super) fn written_out(&mut self, node: u32, given: (&[bool], &[u32])) -> u32 {
        if !given.0[node as usize] {
            return node;
        }
        let origin = self.origins[node as usize];
        let name = self.names.get(&node).copied();
        let written = match self.nodes[node as usize].clone() {
            Node::Given(k) => return given.1[k],
            Node::UnaryOp(operation, a) => {
                let a = self.written_out(a, given);
                self.origin = origin;
                self.one(operation, a)
            }
            Node::BinaryOp(operation, a, b) => {
                let (a, b) = (self.written_out(a, given), self.written_out(b, given));
                self.origin = origin;
                self.two(operation, a, b)
            }
            Node::Less(a, b) => {
                let (a, b) = (self.written_out(a, given), self.written_out(b, given));
                self.origin = origin;
                self.less(a, b)
            }
            Node::And(a, b) => {
                let (a, b) = (self.written_out(a, given), self.written_out(b, given));
                self.origin = origin;
                self.both(a, b, true)
            }
            Node::Or(a, b) => {
                let (a, b) = (self.written_out(a, given), self.written_out(b, given));
                self.origin = origin;
                self.both(a, b, false)
            }
            Node::Not(a) => {
                let a = self.written_out(a, given);
                self.origin = origin;
                self.not(a)
            }
            Node::Select(mask, yes, no) => {
                let (mask, yes, no) =
                    (self.written_out(mask, given), self.written_out(yes, given), self.written_out(no, given));
                self.origin = origin;
                self.select(mask, yes, no)
            }
            _ => node,
        };
        if let Some(name) = name {
            self.names.entry(written).or_insert(name);
        }
        written
    }

    /// Which nodes depend on what a part is given.
    pub fn on_given(&self) -> Vec<bool> {
        let mut depends_on_input = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let depends =
                matches!(node, Node::Given(_)) || node.operands().iter().any(|&one| depends_on_input[one as usize]);
            depends_on_input.push(depends);
        }
        depends_on_input
    }
}
