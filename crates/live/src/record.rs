//! A record on the disk: an MCAP file that is whole whenever the process ends, and bounded.
//!
//! Rows and requests are messages in the common data representation of ROS 2, so that Foxglove and `PlotJuggler` open them: a row is its
//! numbers one after the other. Each axis of a cockpit has topics and metadata of its own. What the file ends with stands behind each flush, and is overwritten by the next once that is there.

use crate::mcap_writer::Writer;
use crate::request::LoopRequest;
use crate::room::reserve;
use crate::row::{COLUMNS, NAMES, Row};
use crate::whole_file::WholeFile;
use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

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

/// Why a part of a ring ends.
const CONTINUED: &str = "continued in the next part";
/// Name of the metadata of how many cycles lie between two rows.
pub const EVERY: &str = "record_every";

/// How large a record may be.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    /// Bytes on the disk at most.
    pub most_bytes: u64,
    /// Rows that are expected: there must be room on the disk for them.
    pub rows: u64,
    /// Whether the oldest rows go where there is room for no more, in two parts of half the bytes each.
    pub ring: bool,
}

/// What a record says of an axis.
#[derive(Clone)]
pub struct AxisOpening {
    /// Before the names of its topics and metadata: nothing, or a name of an axis with a slash before it.
    pub prefix: String,
    /// What is written about it.
    pub about: BTreeMap<String, String>,
    /// What its loop is made of.
    pub setup: Vec<(&'static str, Vec<f64>)>,
}

/// What a record begins with, and each part of a ring.
#[derive(Clone)]
pub struct Opening {
    /// The file.
    pub path: PathBuf,
    /// How large it may be.
    pub size: Size,
    /// Time of the first beat, in ns since 1970.
    pub start_ns: u64,
    /// Its axes, at least one.
    pub axes: Vec<AxisOpening>,
}

/// Channels of an axis, and its newest request of each kind with its cycle, which the next part begins with.
struct AxisTopics {
    rows: u16,
    lists: u16,
    requests: BTreeMap<&'static str, (u64, LoopRequest)>,
}

/// A record under way.
pub struct Record {
    opening: Opening,
    writer: Writer,
    axes: Vec<AxisTopics>,
    sequence: u32,
    most: u64,
    left: u64,
    /// Bytes of the part before.
    before: u64,
    /// The file once more, for the room that is taken ahead of it, and how far that goes.
    file: File,
    reserved: u64,
    /// Why `most` is less than it was to be.
    disk_full: Option<io::Error>,
    /// Rows that were taken, and those of them that were brought to the disk.
    taken: u64,
    kept: u64,
    time_s: f64,
}

impl Record {
    /// Begins a record, with what the loop is made of; it is whole from here on.
    ///
    /// # Errors
    /// If the file cannot be written, or the disk has too little room for what is expected; then no file is left.
    pub fn create(opening: Opening) -> io::Result<Self> {
        // A part of another run must not pass for one of this.
        match std::fs::remove_file(part_before(&opening.path)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Self::create_part(opening, 0.0),
        }
    }

    fn create_part(opening: Opening, time_s: f64) -> io::Result<Self> {
        let (path, file) = (opening.path.clone(), File::create(&opening.path)?);
        let begun = Self::begin(file, opening, time_s);
        if begun.is_err() {
            // Why it could not be begun says more than why it could not be removed.
            let _ = std::fs::remove_file(path);
        }
        begun
    }

    fn begin(file: File, opening: Opening, time_s: f64) -> io::Result<Self> {
        let Size { most_bytes, rows: expected, ring } = opening.size;
        let most = if ring { most_bytes / 2 } else { most_bytes };
        let reserved = expected.saturating_mul(ROW_BYTES).saturating_add(ROOM).max(AHEAD.min(most)).min(most_bytes);
        reserve(&file, 0, reserved).map_err(|error| {
            let text =
                format!("{error}; a record of this run takes {} MB, make room for it", reserved.div_ceil(1_000_000));
            io::Error::new(error.kind(), text)
        })?;
        let mut writer = Writer::begin(WholeFile::new(file.try_clone()?), "forcefeel")?;
        let columns: String = NAMES.iter().flat_map(|name| ["float64 ", name, "\n"]).collect();
        let list = "string name\nuint64 cycle\nfloat64[] numbers\n";
        let mut axes = Vec::with_capacity(opening.axes.len());
        for AxisOpening { prefix, about, .. } in &opening.axes {
            writer.metadata(&format!("{ABOUT}{prefix}"), about)?;
            let rows = writer.channel(&format!("{prefix}{ROWS}"), "forcefeel_msgs/msg/Cycle", &columns);
            let lists = writer.channel(&format!("{prefix}{LISTS}"), "forcefeel_msgs/msg/List", list);
            axes.push(AxisTopics { rows, lists, requests: BTreeMap::new() });
        }
        let setups: Vec<_> = opening.axes.iter().map(|axis| axis.setup.clone()).collect();
        let (sequence, disk_full, left, before) = (0, None, most, 0);
        let (taken, kept) = (0, 0);
        let mut record = Self {
            opening,
            writer,
            axes,
            sequence,
            most,
            left,
            before,
            file,
            reserved,
            disk_full,
            taken,
            kept,
            time_s,
        };
        for (axis, setup) in setups.into_iter().enumerate() {
            for (name, numbers) in setup {
                record.list(axis, name, 0, &numbers);
            }
        }
        // Of its own: without it no row can be read.
        record.end_chunk()?;
        Ok(record)
    }

    /// Whether another part may follow where this one is full.
    pub fn turns(&self) -> bool {
        self.opening.size.ring && self.disk_full.is_none()
    }

    /// Ends this part of a ring, which takes the place of the one before, and begins the next.
    ///
    /// # Errors
    /// If a file cannot be written, with the rows that were taken and those of them that were brought to the disk.
    pub fn next_part(self) -> Result<Self, ((u64, u64), io::Error)> {
        let (taken, before, time_s) = (self.taken, self.most - self.left, self.time_s);
        let mut opening = self.opening.clone();
        let requests: Vec<_> = self.axes.iter().map(|axis| axis.requests.clone()).collect();
        opening.size.rows = 0;
        self.finish(CONTINUED).map_err(|(kept, error)| ((taken, kept), error))?;
        let begun = std::fs::rename(&opening.path, part_before(&opening.path));
        let begun = begun.and_then(|()| Self::create_part(opening, time_s));
        let mut next = begun.map_err(|error| ((taken, taken), error))?;
        (next.taken, next.kept, next.before) = (taken, taken, before);
        for (axis, requests) in requests.iter().enumerate() {
            for (cycle, request) in requests.values() {
                next.request(axis, *cycle, request);
            }
        }
        Ok(next)
    }

    /// A row of an axis.
    pub fn row(&mut self, axis: usize, row: &Row) {
        let mut data = [0; 4 + 8 * COLUMNS];
        data[..4].copy_from_slice(&CDR);
        for (k, number) in row.numbers().into_iter().enumerate() {
            data[4 + 8 * k..12 + 8 * k].copy_from_slice(&number.to_le_bytes());
        }
        self.taken += 1;
        // In virtual time more rows may come between two flushes than there is room for.
        if self.most - self.left + ROOM > self.reserved {
            self.reserve_ahead();
        }
        self.time_s = row.time_s;
        self.message(self.axes[axis].rows, &data);
    }

    /// A request of an axis, from a cycle on.
    pub fn request(&mut self, axis: usize, cycle: u64, request: &LoopRequest) {
        let (name, numbers) = request.numbers();
        self.list(axis, name, cycle, &numbers);
        self.axes[axis].requests.insert(name, (cycle, *request));
    }

    /// A list of numbers with its name, from a cycle on.
    fn list(&mut self, axis: usize, name: &str, cycle: u64, numbers: &[f64]) {
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
        self.message(self.axes[axis].lists, &data);
    }

    fn message(&mut self, channel: u16, data: &[u8]) {
        self.sequence = self.sequence.wrapping_add(1);
        // With its index: as much again as two numbers.
        self.left = self.left.saturating_sub(data.len() as u64 + MESSAGE_BYTES);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time since the start")]
        let time_ns = self.opening.start_ns + (self.time_s * 1e9) as u64;
        self.writer.message(channel, self.sequence, time_ns, data);
    }

    /// Bytes on the disk so far, those included that are still to be brought to it.
    pub fn bytes(&self) -> u64 {
        self.before + self.most - self.left
    }

    /// Rows that were taken, and those of them that were brought to the disk.
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
        self.writer.flush()?;
        self.kept = self.taken;
        if self.most - self.left + AHEAD - STEP > self.reserved {
            self.reserve_ahead();
        }
        Ok(())
    }

    /// The same, with a check sum over what came since the last.
    ///
    /// # Errors
    /// If the file cannot be written; what was brought to it before stays.
    pub fn end_chunk(&mut self) -> io::Result<()> {
        self.left = self.left.saturating_sub(CHUNK_BYTES);
        self.writer.end_chunk()?;
        // Its rows are in the file; what follows is an index of them.
        self.kept = self.taken;
        self.flush()
    }

    /// Takes room for what comes; where there is none, the record ends within what it has.
    fn reserve_ahead(&mut self) {
        let ahead = (self.most - self.left + AHEAD).clamp(self.reserved, self.most.max(self.reserved));
        // Step by step: of much that is refused at once there may be room for most.
        while self.reserved < ahead {
            let next = (self.reserved + STEP).min(ahead);
            if let Err(error) = reserve(&self.file, self.reserved, next) {
                self.left = self.left.saturating_sub(self.most - self.reserved);
                self.most = self.reserved;
                self.disk_full = Some(error);
                return;
            }
            self.reserved = next;
        }
    }

    /// Ends the record, with the reason for it and an index for those who jump about in it; says how many of its rows are in the file.
    ///
    /// # Errors
    /// If the file cannot be written; what was brought to it before stays.
    pub fn finish(mut self, why: &str) -> Result<u64, (u64, io::Error)> {
        let end = || {
            self.writer.metadata(END, &BTreeMap::from([(WHY.to_string(), why.to_string())]))?;
            self.writer.finish()
        };
        end().map(|()| self.taken).map_err(|error| (self.kept, error))
    }
}

/// Where the part before is, of a ring.
fn part_before(path: &Path) -> PathBuf {
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push("-previous.mcap");
    path.with_file_name(name)
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
/// By how much more at a time.
const STEP: u64 = 1 << 20;

/// Fills up to a multiple of `to` bytes behind the four of the head.
fn align(data: &mut Vec<u8>, to: usize) {
    data.resize(4 + (data.len() - 4).next_multiple_of(to), 0);
}
