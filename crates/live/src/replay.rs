//! Records read and run again.

use crate::controller::Controller;
use crate::input_output::Sampled;
use crate::record::{ABOUT, LISTS, ROWS};
use crate::row::{COLUMNS, NAMES, Row};
use crate::setup::Setup;
use crate::wish::Wish;
use forcefeel_model::control::Sample;
use mcap::read::{ChunkFlattener, Options};
use mcap::records::Record;
use std::collections::BTreeMap;

/// What is in a record.
#[derive(Debug, Clone, Default)]
pub struct Contents {
    /// What was written about it.
    pub about: BTreeMap<String, String>,
    /// Lists of numbers that stand before the first row: what the loop was made of.
    pub setup: Vec<(String, Vec<f64>)>,
    /// Wishes, each with the cycle from which it counts.
    pub wishes: Vec<(u64, Wish)>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows, one after the other.
    pub rows: Vec<f64>,
    /// Whether the file broke off, so that its last cycles may be missing.
    pub broken: bool,
}

/// Reads a record; of a file that breaks off, all up to there.
///
/// # Errors
/// If it is none.
pub fn read(file: &[u8]) -> Result<Contents, String> {
    let mut found = Contents::default();
    let mut channels: BTreeMap<u16, (String, u16)> = BTreeMap::new();
    let mut schemas: BTreeMap<u16, Vec<u8>> = BTreeMap::new();
    let records = ChunkFlattener::new_with_options(file, Options::IgnoreEndMagic.into())
        .map_err(|error| format!("is no MCAP file ({error})"))?;
    for record in records {
        let Ok(record) = record else {
            found.broken = true;
            break;
        };
        match record {
            Record::Metadata(metadata) if metadata.name == ABOUT => found.about = metadata.metadata,
            Record::Schema { header, data } => {
                schemas.insert(header.id, data.to_vec());
            }
            Record::Channel(channel) => {
                channels.insert(channel.id, (channel.topic, channel.schema_id));
            }
            Record::Message { header, data } => {
                let Some((topic, schema)) = channels.get(&header.channel_id) else { continue };
                if topic == ROWS {
                    if found.columns.is_empty() {
                        found.columns = columns_of(schemas.get(schema).map_or(&[], Vec::as_slice));
                    }
                    let numbers = data.get(4..).unwrap_or_default().as_chunks::<8>().0;
                    if numbers.len() != found.columns.len() {
                        return Err(format!(
                            "a row has {} numbers, its columns are {}",
                            numbers.len(),
                            found.columns.len()
                        ));
                    }
                    found.rows.extend(numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)));
                } else if topic == LISTS {
                    let (name, cycle, numbers) = list_of(&data).ok_or("has a list that cannot be read")?;
                    match Wish::of(&name, &numbers) {
                        Some(wish) => found.wishes.push((cycle, wish)),
                        None => found.setup.push((name, numbers)),
                    }
                }
            }
            _ => {}
        }
    }
    if found.setup.is_empty() {
        return Err(format!("has no topic {LISTS} of a loop"));
    }
    if found.columns.is_empty() {
        found.columns = NAMES.iter().map(ToString::to_string).collect();
    }
    Ok(found)
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

/// Runs a record's samples and wishes through the controller again, and compares every bit of what came of them.
///
/// # Errors
/// If the record is of another version.
pub fn replay(contents: &Contents) -> Result<Replayed, String> {
    if contents.columns != NAMES {
        return Err("was made by another version of forcefeel: its columns are others".to_string());
    }
    let setup = Setup::of(&contents.setup).ok_or("was made by another version of forcefeel: its setup does not fit")?;
    let mut controller = Controller::new(&setup)?;
    let mut wishes = contents.wishes.iter().peekable();
    let mut replayed = Replayed { cycles: 0, difference: None, gap: None };
    for numbers in contents.rows.as_chunks::<COLUMNS>().0 {
        let row = Row::of(numbers);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole numbers")]
        let (cycle, missed) = (row.cycle as u64, row.missed as u64);
        if cycle != controller.cycle() {
            replayed.gap = Some(controller.cycle());
            break;
        }
        while let Some((_, wish)) = wishes.next_if(|(from, _)| *from <= cycle) {
            controller.take(wish);
        }
        let sensors = [row.load_cell_force_n, row.drive_position_m, row.column_base_m, row.grip_force_n];
        let sample = Sample { sensors, pilot_force: row.pilot_force_n };
        let sampled = Sampled { sample, periods: row.periods, emergency_stop: row.emergency_stop != 0.0 };
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
