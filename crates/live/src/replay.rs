//! Records read and run again.

use crate::controller::Controller;
use crate::input_output::Sampled;
use crate::mcap::op;
use crate::mcap_reader::{Fields, Records};
use crate::record::{ABOUT, END, EVERY, LISTS, ROWS, WHY};
use crate::request::LoopRequest;
use crate::row::{COLUMNS, NAMES, Row};
use crate::setup::Setup;
use forcefeel_model::control::Sample;
use std::collections::BTreeMap;

/// What is in a record.
#[derive(Debug, Clone, Default)]
pub struct Contents {
    /// What was written about it.
    pub about: BTreeMap<String, String>,
    /// Lists of numbers that stand before the first row: what the loop was made of.
    pub setup: Vec<(String, Vec<f64>)>,
    /// Requests, each with the cycle from which it counts.
    pub requests: Vec<(u64, LoopRequest)>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows, one after the other.
    pub rows: Vec<f64>,
    /// Why the file breaks off, so that its last cycles may be missing; nothing of a whole one.
    pub broken: Option<String>,
    /// Why it ended, as it says of itself; nothing where the process that wrote it was killed.
    pub ended: Option<String>,
}

/// Reads the record of an axis, or of a loop that has but one; of a file that breaks off, all up to there.
///
/// # Errors
/// If it is none, or has other axes.
pub fn read(file: &[u8], axis: Option<&str>) -> Result<Contents, String> {
    let prefix = axis.map_or(String::new(), |axis| format!("/{axis}"));
    // Memory that is never written to is never taken.
    let mut contents = Contents { rows: Vec::with_capacity(file.len() / 8), ..Contents::default() };
    let mut channels: BTreeMap<u16, (String, u16)> = BTreeMap::new();
    let mut schemas: BTreeMap<u16, &[u8]> = BTreeMap::new();
    for record in Records::of(file)? {
        let taken = record.and_then(|(code, body)| {
            take(&mut contents, &prefix, (&mut channels, &mut schemas), code, body)
                .unwrap_or_else(|| Err(DAMAGED.to_string()))
        });
        if let Err(what) = taken {
            contents.broken = Some(what);
            break;
        }
    }
    if contents.setup.is_empty() {
        let axes: Vec<_> = channels.values().filter_map(|(topic, _)| topic.strip_suffix(LISTS)).collect();
        if !axes.is_empty() {
            let names: Vec<_> = axes.iter().map(|prefix| prefix.trim_start_matches('/')).collect();
            return Err(if axes == [""] {
                "is of one loader: leave the axis out".to_string()
            } else {
                format!("has the axes {}: choose one, such as run.mcap/{}", names.join(", "), names[0])
            });
        }
        let why = contents.broken.map_or(String::new(), |what| format!(": {what}"));
        return Err(format!("has no topic {LISTS} of a loop{why}"));
    }
    if contents.columns.is_empty() {
        contents.columns = NAMES.iter().map(ToString::to_string).collect();
    }
    if let Some(cycle) = contents.columns.iter().position(|name| name == "cycle") {
        put_in_order(&mut contents.rows, contents.columns.len(), cycle);
    }
    Ok(contents)
}

/// Puts the rows in the order of their cycles: those from before a trip stand behind later ones in a record of less than all rows.
fn put_in_order(rows: &mut Vec<f64>, columns: usize, cycle: usize) {
    let mut order: Vec<&[f64]> = rows.chunks_exact(columns).collect();
    if !order.is_sorted_by(|one, next| one[cycle] <= next[cycle]) {
        order.sort_by(|one, other| one[cycle].total_cmp(&other[cycle]));
        *rows = order.concat();
    }
}

const DAMAGED: &str = "a record's content is damaged";

/// Channels with topic and schema, schemas with their text.
type Kinds<'a, 'b> = (&'b mut BTreeMap<u16, (String, u16)>, &'b mut BTreeMap<u16, &'a [u8]>);

/// Takes what a record says; nothing where its content is not as long as it says.
fn take<'a>(
    contents: &mut Contents,
    prefix: &str,
    (channels, schemas): Kinds<'a, '_>,
    code: u8,
    body: &'a [u8],
) -> Option<Result<(), String>> {
    let mut fields = Fields(body);
    match code {
        op::METADATA => match fields.text()? {
            name if name.strip_prefix(ABOUT) == Some(prefix) => contents.about = fields.texts()?,
            END => contents.ended = fields.texts()?.remove(WHY),
            _ => {}
        },
        op::SCHEMA => {
            let id = fields.u16()?;
            let _name_and_encoding = (fields.text()?, fields.text()?);
            schemas.insert(id, fields.bytes()?);
        }
        op::CHANNEL => {
            let (id, schema) = (fields.u16()?, fields.u16()?);
            channels.insert(id, (fields.text()?.to_string(), schema));
        }
        op::MESSAGE => {
            let channel = fields.u16()?;
            let _sequence_and_times = fields.take(20)?;
            let Some((topic, schema)) = channels.get(&channel) else { return Some(Ok(())) };
            let Some(topic) = topic.strip_prefix(prefix) else { return Some(Ok(())) };
            if topic == ROWS {
                if contents.columns.is_empty() {
                    contents.columns = columns_of(schemas.get(schema).copied().unwrap_or_default());
                }
                let numbers = fields.0.get(4..)?.as_chunks::<8>().0;
                if numbers.len() != contents.columns.len() {
                    let (came, columns) = (numbers.len(), contents.columns.len());
                    return Some(Err(format!("a row has {came} numbers, its columns are {columns}")));
                }
                contents.rows.extend(numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)));
            } else if topic == LISTS {
                let (name, cycle, numbers) = list_of(fields.0)?;
                match LoopRequest::of(&name, &numbers) {
                    Some(request) => contents.requests.push((cycle, request)),
                    None => contents.setup.push((name, numbers)),
                }
            }
        }
        _ => {}
    }
    Some(Ok(()))
}

fn columns_of(schema: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(schema);
    text.lines().filter_map(|line| line.strip_prefix("float64 ")).map(str::to_string).collect()
}

/// Name, cycle and numbers of a list.
fn list_of(data: &[u8]) -> Option<(String, u64, Vec<f64>)> {
    let data = data.get(4..)?;
    let word = |at: usize| Some(u32::from_le_bytes(*data.get(at..)?.first_chunk()?) as usize);
    let length = word(0)?;
    let name = String::from_utf8(data.get(4..3 + length)?.to_vec()).ok()?;
    let at = (4 + length).next_multiple_of(8);
    let cycle = u64::from_le_bytes(*data.get(at..)?.first_chunk()?);
    let count = word(at + 8)?;
    let numbers = data.get((at + 12).next_multiple_of(8)..)?.as_chunks::<8>().0;
    (numbers.len() == count).then(|| (name, cycle, numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()))
}

/// What came of a replay.
#[derive(Debug, Clone, PartialEq)]
pub struct Replayed {
    /// Cycles that were run again.
    pub cycles: u64,
    /// The first number that differs: cycle, column, as recorded, as replayed.
    pub difference: Option<(u64, &'static str, f64, f64)>,
    /// The first cycle that the record lacks.
    pub gap: Option<u64>,
}

/// Columns that the clock wrote.
const OF_CLOCK: [&str; 2] = ["late_s", "work_s"];

/// Runs a record's samples and requests through the controller again, and compares every bit of what came of them.
///
/// # Errors
/// If the record is of another version, or lacks cycles by its rate or its beginning.
pub fn replay(contents: &Contents) -> Result<Replayed, String> {
    if contents.columns != NAMES {
        return Err("was made by another version of forcefeel: its columns are others".to_string());
    }
    if let Some(every) = contents.about.get(EVERY) {
        return Err(format!("has a row each {every} cycles, and a replay needs every cycle: record without a rate"));
    }
    if let Some(first) = contents.rows.get(1).filter(|cycle| **cycle > 0.0) {
        return Err(format!(
            "begins at cycle {first}, and a replay needs the run from its beginning: record without a ring"
        ));
    }
    let setup = Setup::of(&contents.setup).ok_or("was made by another version of forcefeel: its setup does not fit")?;
    let mut controller = Controller::new(&setup)?;
    let mut requests = contents.requests.iter().peekable();
    let mut replayed = Replayed { cycles: 0, difference: None, gap: None };
    for numbers in contents.rows.as_chunks::<COLUMNS>().0 {
        let row = Row::of(numbers);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers")]
        let (cycle, missed) = (row.cycle as u64, row.missed as u64);
        if cycle != controller.cycle() {
            replayed.gap = Some(controller.cycle());
            break;
        }
        while let Some((_, request)) = requests.next_if(|(from, _)| *from <= cycle) {
            controller.take(request);
        }
        let sensors = [row.load_cell_force_n, row.drive_position_m, row.column_base_m, row.grip_force_n];
        let sample = Sample { sensors, pilot_force: row.pilot_force_n };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers")]
        let (delay, drive_fault) = (row.delay as u32, row.drive_fault as u16);
        let emergency_stop = row.emergency_stop != 0.0;
        let drive_acts = row.drive_acts != 0.0;
        let sampled = Sampled { sample, periods: row.periods, delay, emergency_stop, drive_fault, drive_acts };
        controller.link([row.link_torque_n_m, row.link_damping_n_m_s_per_rad]);
        let (_, again) = controller.step((row.sampled != 0.0).then_some(&sampled), missed);
        replayed.cycles += 1;
        let pairs = NAMES.iter().zip(numbers.iter().zip(again.numbers()));
        let differs = |name: &str, a: f64, b: f64| {
            !OF_CLOCK.contains(&name) && a.to_bits() != b.to_bits() && !(a.is_nan() && b.is_nan())
        };
        if let Some((name, (was, is))) = pairs.into_iter().find(|(name, (was, is))| differs(name, **was, *is)) {
            replayed.difference = Some((cycle, name, *was, is));
            break;
        }
    }
    Ok(replayed)
}
