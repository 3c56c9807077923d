//! The packets between an aircraft simulator and a loader, for programs that speak for either.

use crate::errors::refused;
use forcefeel_model::host::packet::{FROM_HOST, HOST_NUMBERS, switches};
use forcefeel_model::host::{FromHost, ToHost};
use pyo3::prelude::*;
use std::collections::BTreeMap;

/// The numbers that a host sends: name, SI unit, smallest, largest, and what holds without a host.
#[pyfunction]
pub fn host_numbers() -> Vec<(&'static str, &'static str, f32, f32, f32)> {
    FROM_HOST.to_vec()
}

/// The switches of a host by name.
#[pyfunction]
pub fn host_switches() -> BTreeMap<&'static str, u32> {
    use switches::{ACTIVE, FLIGHT, FREEZE, JAM};
    [("active", ACTIVE), ("jam", JAM), ("freeze", FREEZE), ("flight", FLIGHT)].into()
}

/// A host's packet; of the numbers that are not given holds what does without a host.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arguments over by value")]
#[expect(clippy::cast_possible_truncation, reason = "the packet has single precision")]
pub fn host_packet(sequence: u32, switches: u32, numbers: BTreeMap<String, f64>) -> PyResult<Vec<u8>> {
    let mut packet = FromHost { sequence, switches, ..FromHost::none() };
    for (name, number) in &numbers {
        let place = FROM_HOST.iter().position(|(known, ..)| known == name);
        packet.numbers[place.ok_or_else(|| refused(format!("numbers: {name:?} is none of a host's")))?] =
            *number as f32;
    }
    let bytes = packet.encode();
    FromHost::decode(&bytes).map_err(|why| refused(format!("numbers: out of the range of a packet ({why:?})")))?;
    Ok(bytes.to_vec())
}

/// What a loader's packet holds: sequence number, status, numbers; nothing if it is none.
#[pyfunction]
pub fn host_answer(packet: &[u8]) -> Option<(u32, u32, Vec<f32>)> {
    ToHost::decode(packet).ok().map(|answer| (answer.sequence, answer.status, answer.numbers.to_vec()))
}

/// What a host's packet holds: sequence number, switches, numbers by name; nothing if it is none.
#[pyfunction]
pub fn host_request(packet: &[u8]) -> Option<(u32, u32, BTreeMap<&'static str, f32>)> {
    let taken = FromHost::decode(packet).ok()?;
    let named = (0..HOST_NUMBERS).map(|k| (FROM_HOST[k].0, taken.numbers[k])).collect();
    Some((taken.sequence, taken.switches, named))
}
