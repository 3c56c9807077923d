//! Where a period reads its states, and where it keeps their next values.
//!
//! A state is read before its first use. Its next value is kept as soon as it is made and the last one is used no more. With all of them read at
//! the start and kept at the end, most would wait on the stack in between: a tenth of a period's instructions.

use crate::statement::{Statement, What, names};
use std::collections::HashMap;

/// The next value of a state, kept.
pub struct Store {
    /// Keeps it.
    pub statement: Statement,
    /// The state's name.
    pub name: String,
    /// What is kept.
    pub value: String,
}

/// The statements, with each state's reading and keeping in their places.
pub fn interleaved(statements: Vec<Statement>, stores: Vec<Store>) -> Vec<Statement> {
    let of_state = |statement: &Statement| match &statement.what {
        What::Reads(value, text) => {
            let member = text.replace('`', "").strip_prefix("state->")?.split(';').next()?.to_owned();
            Some((member, value.name.clone()))
        }
        _ => None,
    };
    let (reads, mut rest): (Vec<_>, Vec<_>) =
        statements.into_iter().partition(|statement| of_state(statement).is_some());
    let local: HashMap<String, String> = reads.iter().filter_map(of_state).collect();
    let mut kept = HashMap::new();
    for Store { mut statement, name, value } in stores {
        let last = local.get(&name);
        let waits_for = |statement: &Statement| {
            let mut waits = false;
            statement.visit(&mut |one| {
                waits |= last.is_some_and(|last| one.names().contains(&&**last))
                    || one.written().is_some_and(|written| names(&value).any(|name| name == written));
            });
            waits
        };
        let place = rest.iter().rposition(waits_for).map_or(0, |last| last + 1);
        if let Some(before) = place.checked_sub(1) {
            statement.origin = rest[before].origin;
        }
        for place_of_other in kept.values_mut().filter(|other| **other >= place) {
            *place_of_other += 1;
        }
        kept.insert(name, place);
        rest.insert(place, statement);
    }
    let mut read_before: Vec<Vec<Statement>> = vec![Vec::new(); rest.len()];
    for mut read in reads {
        let Some((member, name)) = of_state(&read) else { continue };
        let used = |statement: &Statement| {
            let mut used = false;
            statement.visit(&mut |one| used |= one.names().contains(&&*name));
            used
        };
        let first = rest.iter().position(used).into_iter().chain(kept.get(&member).copied()).min().unwrap_or(0);
        read.origin = rest.get(first).map_or(read.origin, |next| next.origin);
        read_before[first].push(read);
    }
    let each = read_before.into_iter().zip(rest);
    each.flat_map(|(reads, statement)| reads.into_iter().chain([statement])).collect()
}
