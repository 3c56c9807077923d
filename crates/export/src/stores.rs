//! Where a period loads its states, and where it stores their next values.
//!
//! A state is loaded before its first use. Its next value is stored as soon as it is computed and the last one is no longer needed. With all loads
//! at the start and all stores at the end, most values would wait on the stack in between: a tenth of a period's instructions.

use crate::statement::{Statement, What, marked, names};
use std::collections::HashMap;

/// The next value of a state.
pub struct Store {
    /// Stores it.
    pub statement: Statement,
    /// The state's name.
    pub name: String,
    /// The value.
    pub value: String,
}

/// The statements, with the loads and stores of states in their places.
pub fn interleaved(statements: Vec<Statement>, stores: Vec<Store>) -> Vec<Statement> {
    let (loads, mut rest): (Vec<_>, Vec<_>) = statements.into_iter().partition(|of| loaded(of).is_some());
    let local: HashMap<String, String> = loads.iter().filter_map(loaded).collect();
    for Store { mut statement, name, value } in stores {
        let last = local.get(&name);
        let computes = |of: &Statement| of.written().is_some_and(|written| names(&value).any(|name| name == written));
        let waits_for = |of: &Statement| holds(of, &|of| computes(of) || last.is_some_and(|last| mentions(of, last)));
        let place = rest.iter().rposition(waits_for).map_or(0, |last| last + 1);
        if let Some(before) = place.checked_sub(1) {
            statement.origin = rest[before].origin;
        }
        rest.insert(place, statement);
    }
    let mut loads_before: Vec<Vec<Statement>> = vec![Vec::new(); rest.len()];
    for mut load in loads {
        let Some((state, name)) = loaded(&load) else { continue };
        let overwrites = format!("{}->{state} = ", marked("state"));
        let stores = |of: &Statement| matches!(&of.what, What::Says(text) if text.starts_with(&overwrites));
        let first = rest.iter().position(|of| stores(of) || holds(of, &|of| mentions(of, &name))).unwrap_or(0);
        load.origin = rest.get(first).map_or(load.origin, |next| next.origin);
        loads_before[first].push(load);
    }
    let each = loads_before.into_iter().zip(rest);
    each.flat_map(|(loads, statement)| loads.into_iter().chain([statement])).collect()
}

/// The state that a statement loads, and the value that it becomes.
fn loaded(statement: &Statement) -> Option<(String, String)> {
    let What::Reads(value, text) = &statement.what else { return None };
    let state = text.replace('`', "").strip_prefix("state->")?.split(';').next()?.to_owned();
    Some((state, value.name.clone()))
}

/// Whether something holds for a statement or for one in it.
fn holds(statement: &Statement, what: &dyn Fn(&Statement) -> bool) -> bool {
    let mut any = false;
    statement.visit(&mut |of| any |= what(of));
    any
}

fn mentions(statement: &Statement, name: &str) -> bool {
    statement.names().contains(&name)
}
