//! What a node is made of where it is written as C: what it waits for, and what a function is given.

use crate::trace::{BinaryOp, Graph, Node, UnaryOp};
use std::collections::HashSet;

/// What a node is made of, where C has a shorter word than the trace, and of a part what it holds on to as well.
pub fn operands_of(graph: &Graph, place: usize) -> Vec<u32> {
    let node = &graph.nodes[place];
    if let Some((x, limit)) = u32::try_from(place).ok().and_then(|node| within(graph, node)) {
        return vec![x, limit];
    }
    match node {
        Node::Part(roots, given) => [given.clone(), held(graph, roots)].concat(),
        node => node.operands(),
    }
}

/// What a part needs besides what it is given.
pub fn held(graph: &Graph, roots: &[u32]) -> Vec<u32> {
    let on_given = graph.on_given();
    let (mut open, mut seen, mut needed) = (roots.to_vec(), HashSet::new(), Vec::new());
    while let Some(node) = open.pop() {
        if !seen.insert(node) {
            continue;
        }
        if on_given[node as usize] {
            open.extend(graph.nodes[node as usize].operands());
        } else if !matches!(graph.nodes[node as usize], Node::Known(..) | Node::Data(..) | Node::Holds(..)) {
            needed.push(node);
        }
    }
    needed
}

/// The number and the limit of what is held between a limit and its negative.
pub fn within(graph: &Graph, node: u32) -> Option<(u32, u32)> {
    let &Node::BinaryOp(BinaryOp::Min, inner, high) = &graph.nodes[node as usize] else { return None };
    let &Node::BinaryOp(BinaryOp::Max, x, low) = &graph.nodes[inner as usize] else { return None };
    let opposite = match (&graph.nodes[low as usize], &graph.nodes[high as usize]) {
        (&Node::UnaryOp(UnaryOp::Neg, size), _) => size == high,
        (Node::Known(low, ..), Node::Known(high, ..)) => {
            low.iter().zip(high).all(|(&low, &high)| low == (-f64::from_bits(high)).to_bits())
        }
        _ => false,
    };
    (opposite && not_negative(graph, high)).then_some((x, high))
}

fn not_negative(graph: &Graph, node: u32) -> bool {
    match &graph.nodes[node as usize] {
        Node::Known(bits, ..) => bits.iter().all(|&bits| f64::from_bits(bits) >= 0.0),
        Node::UnaryOp(UnaryOp::Abs, _) => true,
        &Node::BinaryOp(BinaryOp::Max, a, b) => not_negative(graph, a) || not_negative(graph, b),
        _ => false,
    }
}

/// Which nodes are needed for `wanted`.
pub fn reached(operands: &[Vec<u32>], wanted: &[u32]) -> Vec<bool> {
    let mut needed = vec![false; operands.len()];
    let mut open = wanted.to_vec();
    while let Some(node) = open.pop() {
        if !core::mem::replace(&mut needed[node as usize], true) {
            open.extend(&operands[node as usize]);
        }
    }
    needed
}

/// Whether a number is what lies within a known limit over a known step, some millions of them at most: what rounds it need not ask
/// whether it has digits behind the point.
pub fn of_few_steps(graph: &Graph, node: u32) -> bool {
    let known = |node: u32| match &graph.nodes[node as usize] {
        Node::Known(bits, ..) => Some(bits.iter().map(|&bits| f64::from_bits(bits)).collect::<Vec<_>>()),
        _ => None,
    };
    let &Node::BinaryOp(BinaryOp::Div, x, step) = &graph.nodes[node as usize] else { return false };
    let Some((limits, steps)) = within(graph, x).and_then(|(_, limit)| known(limit)).zip(known(step)) else {
        return false;
    };
    limits.iter().zip(&steps).all(|(limit, step)| limit / step < MOST_STEPS)
}

/// A quarter of what single precision counts without a gap.
const MOST_STEPS: f64 = 4_194_304.0;
