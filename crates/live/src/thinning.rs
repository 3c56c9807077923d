//! The rows that a record keeps: each n-th, those of events, and all around a change of the trips.

use crate::row::Row;
use std::collections::VecDeque;

/// Time before and after a change of the trips of which all rows are kept, in s.
const AROUND_S: f64 = 1.0;

/// Chooses the rows of a record.
pub struct Thinning {
    every: u64,
    last: Option<Row>,
    /// Rows of the last second that were left out.
    left_out: VecDeque<Row>,
    /// Until when all are kept.
    all_until_s: f64,
}

impl Thinning {
    /// Keeps each `every`-th row.
    pub fn new(every: u64) -> Self {
        Self { every, last: None, left_out: VecDeque::new(), all_until_s: f64::NEG_INFINITY }
    }

    /// Takes a row; gives those to keep now: around a change of the trips also older ones that were left out.
    pub fn take(&mut self, row: Row) -> Vec<Row> {
        if self.every <= 1 {
            return vec![row];
        }
        let before = self.last.replace(row).unwrap_or(row);
        let mut kept = Vec::new();
        while self.left_out.front().is_some_and(|old| old.time_s < row.time_s - AROUND_S) {
            self.left_out.pop_front();
        }
        if row.trips.to_bits() != before.trips.to_bits() {
            kept.extend(self.left_out.drain(..));
            self.all_until_s = row.time_s + AROUND_S;
        }
        let discrete = |row: &Row| {
            [row.state, row.enable, row.emergency_stop, row.drive_fault, row.drive_acts, row.sampled].map(f64::to_bits)
        };
        let event = discrete(&row) != discrete(&before) || row.missed > 0.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number")]
        let regular = (row.cycle as u64).is_multiple_of(self.every);
        if regular || event || row.time_s <= self.all_until_s {
            kept.push(row);
        } else {
            self.left_out.push_back(row);
        }
        kept
    }
}
