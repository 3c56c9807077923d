//! Rows of a matrix times a vector, found again among the operations.
//!
//! The model writes `sum = sum + a_k x_k` in loops; traced, that is a chain. Chains of data on the same numbers in the same order are rows of
//! one matrix, and are emitted as a loop over rows: the same operations in the same order, and so the same bits.

use crate::trace::{Bank, BinaryOp, Graph, Node};
use std::collections::HashMap;

/// Rows on one vector.
#[derive(Debug, Clone)]
pub struct Product {
    /// The nodes that are multiplied, in their order.
    pub vector: Vec<u32>,
    /// Whose data they are.
    pub bank: Bank,
    /// The data of each row, and the node that is its sum.
    pub rows: Vec<(Vec<u32>, u32)>,
}

/// The products of a graph that are worth a loop: rows that are used beyond their own chain.
///
/// # Panics
/// If the graph has more than 2^32 nodes.
pub fn products(graph: &Graph, live: &[bool]) -> Vec<Product> {
    let mut inner = vec![false; graph.nodes.len()];
    for (place, node) in graph.nodes.iter().enumerate() {
        if live[place]
            && let &Node::BinaryOp(BinaryOp::Add, sum, term) = node
            && chain(graph, sum).is_some()
            && data_times(graph, term).is_some()
        {
            inner[sum as usize] = true;
        }
    }
    let mut places: HashMap<(Vec<u32>, Bank), usize> = HashMap::new();
    let mut products: Vec<Product> = Vec::new();
    for place in (0..graph.nodes.len()).filter(|&place| live[place] && !inner[place]) {
        let node = u32::try_from(place).expect("a graph's places are 32 bits");
        let Some((data, vector)) = chain(graph, node).filter(|(data, _)| data.len() > 1) else { continue };
        let bank = bank_of(graph, data[0]);
        let at = *places.entry((vector.clone(), bank)).or_insert_with(|| {
            products.push(Product { vector, bank, rows: Vec::new() });
            products.len() - 1
        });
        products[at].rows.push((data, node));
    }
    products
}

fn bank_of(graph: &Graph, node: u32) -> Bank {
    if let Node::Data(_, bank) = &graph.nodes[node as usize] { *bank } else { Bank::All }
}

fn data_times(graph: &Graph, node: u32) -> Option<(u32, u32)> {
    let &Node::BinaryOp(BinaryOp::Mul, a, x) = &graph.nodes[node as usize] else { return None };
    matches!(graph.nodes[a as usize], Node::Data(..)).then_some((a, x))
}

/// Data and vector of a chain `a_0 x_0 + a_1 x_1 + ...`, all of one bank.
fn chain(graph: &Graph, node: u32) -> Option<(Vec<u32>, Vec<u32>)> {
    if let Some((a, x)) = data_times(graph, node) {
        return Some((vec![a], vec![x]));
    }
    let &Node::BinaryOp(BinaryOp::Add, sum, term) = &graph.nodes[node as usize] else { return None };
    let (a, x) = data_times(graph, term)?;
    let (mut data, mut vector) = chain(graph, sum)?;
    if bank_of(graph, data[0]) != bank_of(graph, a) {
        return None;
    }
    data.push(a);
    vector.push(x);
    Some((data, vector))
}
