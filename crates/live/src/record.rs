//! A record on the disk: an MCAP file that is whole whenever the process ends, and bounded.
//!
//! Rows and requests are messages in the common data representation of ROS 2, so that Foxglove and `PlotJuggler` open them: a row is its
//! numbers one after the other. What the file ends with stands behind each chunk, and is overwritten by the next once that is there.

use crate::mcap::MAGIC;
use crate::mcap_writer::Writer;
use crate::room::reserve;
use crate::row::{COLUMNS, NAMES, Row};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Topic of the rows.
pub const ROWS: &str = "/cycle";
/// Topic of lists of numbers: what the loop is made of, and requests.
pub const LISTS: &str = "/list";
/// Name of the metadata.
pub const ABOUT: &str = "forcefeel";
/// Name of those at its end, which say why it ended.
pub const END: &str = "forcefeel-end";
/// Name of that reason.
pub const WHY: &str = "why";
/// Why a record ends that has room for all.
pub const WITH_THE_RUN: &str = "with the run";

/// How large a record may be.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// Bytes of the file at most.
    pub most_bytes: u64,
    /// Rows that are expected: there must be room on the disk for them.
    pub rows: u64,
}

/// A record under way.
pub struct Record {
    writer: Writer<WholeFile>,
    rows: u16,
    lists: u16,
    sequence: u32,
    /// Time of the record's first beat, in ns since 1970.
    start_ns: u64,
    most: u64,
    left: u64,
    /// The file once more, for the room that is taken ahead of it, and how far that goes.
    file: File,
    reserved: u64,
    /// Why `most` is less than it was to be.
    disk_full: Option<io::Error>,
    /// Rows that were taken, and those of them that are in the file.
    taken: u64,
    kept: u64,
}

impl Record {
    /// Begins a record, with what the loop is made of; it is whole from here on.
    ///
    /// # Errors
    /// If the file cannot be written, or the disk has too little room for what is expected; then no file is left.
    pub fn create(
        path: &Path,
        size: Size,
        start_ns: u64,
        about: &BTreeMap<String, String>,
        setup: &[(&'static str, Vec<f64>)],
    ) -> io::Result<Self> {
        let file = File::create(path)?;
        let begun = Self::begin(file, size, start_ns, about, setup);
        if begun.is_err() {
            // Why it could not be begun says more than why it could not be removed.
            let _ = std::fs::remove_file(path);
        }
        begun
    }

    fn begin(
        file: File,
        Size { most_bytes: most, rows: expected }: Size,
        start_ns: u64,
        about: &BTreeMap<String, String>,
        setup: &[(&'static str, Vec<f64>)],
    ) -> io::Result<Self> {
        let reserved = expected.saturating_mul(ROW_BYTES).saturating_add(ROOM).max(AHEAD).min(most);
        reserve(&file, 0, reserved).map_err(|error| {
            let text =
                format!("{error}; a record of this run takes {} MB, make room for it", reserved.div_ceil(1_000_000));
            io::Error::new(error.kind(), text)
        })?;
        let whole =
            WholeFile { file: file.try_clone()?, written: 0, pending: Vec::with_capacity(1 << 20), given_up: false };
        let mut writer = Writer::begin(whole, "forcefeel")?;
        writer.metadata(ABOUT, about)?;
        let columns: String = NAMES.iter().flat_map(|name| ["float64 ", name, "\n"]).collect();
        let rows = writer.channel(ROWS, "forcefeel_msgs/msg/Cycle", &columns);
        let list = "string name\nuint64 cycle\nfloat64[] numbers\n";
        let lists = writer.channel(LISTS, "forcefeel_msgs/msg/List", list);
        let (sequence, disk_full, left) = (0, None, most);
        let mut record =
            Self { writer, rows, lists, sequence, start_ns, most, left, file, reserved, disk_full, taken: 0, kept: 0 };
        for (name, numbers) in setup {
            record.list(name, 0, 0.0, numbers);
        }
        record.flush()?;
        Ok(record)
    }

    /// A row.
    pub fn row(&mut self, row: &Row) {
        let mut data = [0; 4 + 8 * COLUMNS];
        data[..4].copy_from_slice(&CDR);
        for (k, number) in row.numbers().into_iter().enumerate() {
            data[4 + 8 * k..12 + 8 * k].copy_from_slice(&number.to_le_bytes());
        }
        self.taken += 1;
        // In virtual time more rows may come between two flushes than there is room for.
        if self.bytes() + ROOM > self.reserved {
            self.reserve_ahead();
        }
        self.message(self.rows, row.time_s, &data);
    }

    /// A list of numbers with its name, from a cycle on.
    pub fn list(&mut self, name: &str, cycle: u64, time_s: f64, numbers: &[f64]) {
        let mut data = CDR.to_vec();
        let length = |count: usize| u32::try_from(count).unwrap_or(u32::MAX).to_le_bytes();
        data.extend(length(name.len() + 1));
        data.extend(name.as_bytes());
        data.push(0);
        align(&mut data, 8);
        data.extend(cycle.to_le_bytes());
        data.extend(length(numbers.len()));
        align(&mut data, 8);
        data.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        self.message(self.lists, time_s, &data);
    }

    fn message(&mut self, channel: u16, time_s: f64, data: &[u8]) {
        self.sequence = self.sequence.wrapping_add(1);
        // With its index: as much again as two numbers.
        self.left = self.left.saturating_sub(data.len() as u64 + MESSAGE_BYTES);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time since the start")]
        let time_ns = self.start_ns + (time_s * 1e9) as u64;
        self.writer.message(channel, self.sequence, time_ns, data);
    }

    /// Bytes so far, those included that are still to be brought to the file.
    pub fn bytes(&self) -> u64 {
        self.most - self.left
    }

    /// Rows that were taken, and those of them that are in the file.
    pub fn rows(&self) -> (u64, u64) {
        (self.taken, self.kept)
    }

    /// Why there is room for no more, if there is not.
    pub fn full(&self) -> Option<String> {
        let why = || self.disk_full.as_ref().map_or("full".to_string(), |error| format!("the disk is full: {error}"));
        (self.left < ROOM).then(why)
    }

    /// Brings all that was written to the file, which is whole with it, and takes room for what comes.
    ///
    /// # Errors
    /// If the file cannot be written; what was brought to it before stays.
    pub fn flush(&mut self) -> io::Result<()> {
        self.left = self.left.saturating_sub(CHUNK_BYTES);
        self.writer.flush()?;
        self.kept = self.taken;
        self.reserve_ahead();
        Ok(())
    }

    /// Takes room for what comes; where there is none, the record ends within what it has.
    fn reserve_ahead(&mut self) {
        let ahead = (self.bytes() + AHEAD).clamp(self.reserved, self.most.max(self.reserved));
        if let Err(error) = reserve(&self.file, self.reserved, ahead) {
            self.left = self.left.saturating_sub(self.most - self.reserved);
            self.most = self.reserved;
            self.disk_full = Some(error);
        } else {
            self.reserved = ahead;
        }
    }

    /// Ends the record, with the reason for it and an index for those who jump about in it; says how many of its rows are in the file.
    ///
    /// # Errors
    /// If the file cannot be written; what was brought to it before stays.
    pub fn finish(mut self, why: &str) -> Result<u64, (u64, io::Error)> {
        let end = || {
            self.writer.metadata(END, &BTreeMap::from([(WHY.to_string(), why.to_string())]))?;
            let mut file = self.writer.finish()?;
            file.write_pending(&[])?;
            file.file.set_len(file.written)
        };
        end().map(|()| self.taken).map_err(|error| (self.kept, error))
    }
}

/// Little-endian, no options.
const CDR: [u8; 4] = [0, 1, 0, 0];

/// What MCAP adds to a message, and to a chunk with the rows' and the lists' indexes and its share of the summary.
const MESSAGE_BYTES: u64 = 31 + 16;
const CHUNK_BYTES: u64 = 400;
/// Of a row with its head and its place in the indexes.
const ROW_BYTES: u64 = (4 + 8 * COLUMNS) as u64 + MESSAGE_BYTES;
/// Kept for the end of a record.
const ROOM: u64 = 64 << 10;
/// Room on the disk that is taken ahead: of a loop at 5 kHz, 3 s.
const AHEAD: u64 = 4 << 20;

/// Fills up to a multiple of `to` bytes behind the four of the head.
fn align(data: &mut Vec<u8>, to: usize) {
    data.resize(4 + (data.len() - 4).next_multiple_of(to), 0);
}

/// A file that ends as an MCAP file does after every flush.
struct WholeFile {
    file: File,
    /// Bytes that stay.
    written: u64,
    pending: Vec<u8>,
    /// A write failed; the file ends where it did before it.
    given_up: bool,
}

impl WholeFile {
    /// Whoever is killed on the way leaves a file that begins and ends as one should: read from the front it ends where the write
    /// before did, and who looks at its last bytes first finds no index there.
    ///
    /// Where a write fails, as on a full disk, the file is made to end where it did before.
    fn write_pending(&mut self, end: &[u8]) -> io::Result<()> {
        if self.given_up {
            return Ok(());
        }
        self.write_behind(end).inspect_err(|_| {
            self.given_up = true;
            // The end before lies on blocks that the file has; what stands behind it goes.
            if write_at(&mut self.file, &NO_INDEX, self.written).is_ok() {
                let _ = self.file.set_len(self.written + NO_INDEX.len() as u64);
            }
        })
    }

    fn write_behind(&mut self, end: &[u8]) -> io::Result<()> {
        let (from, stays) = (self.written, self.pending.len());
        self.pending.extend_from_slice(end);
        let whole = self.pending.len();
        let head = whole.min(NO_INDEX.len());
        let tail = whole.saturating_sub(NO_INDEX.len()).max(head);
        if whole - tail == NO_INDEX.len() {
            write_at(&mut self.file, &NO_INDEX, from + tail as u64)?;
        }
        // Behind the present end, then over it, then the file's own last bytes.
        write_at(&mut self.file, &self.pending[head..tail], from + head as u64)?;
        write_at(&mut self.file, &self.pending[..head], from)?;
        write_at(&mut self.file, &self.pending[tail..], from + tail as u64)?;
        self.written += stays as u64;
        self.pending.clear();
        Ok(())
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.pending.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.write_pending(&NO_INDEX)
    }
}

fn write_at(file: &mut File, bytes: &[u8], at: u64) -> io::Result<()> {
    use std::io::{Seek, SeekFrom};
    file.seek(SeekFrom::Start(at))?;
    file.write_all(bytes)
}

/// End of the data, footer without a summary, and the magic: what an MCAP file without an index ends with.
const NO_INDEX: [u8; 50] = {
    let mut end = [0; 50];
    // Code, length and check sum of the end of the data.
    (end[0], end[1]) = (0x0f, 4);
    // Code and length of the footer, then where the summary is, that of its offsets, its check sum.
    (end[13], end[14]) = (0x02, 20);
    let mut k = 0;
    while k < 8 {
        end[42 + k] = MAGIC[k];
        k += 1;
    }
    end
};
