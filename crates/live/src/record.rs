//! A record on the disk: an MCAP file that is whole whenever the process ends, and bounded.
//!
//! Rows and wishes are messages in the common data representation of ROS 2, so that Foxglove and `PlotJuggler` open them: a row is its
//! numbers one after the other. What the file ends with stands behind each chunk, and is overwritten by the next once that is there.

use crate::row::{COLUMNS, NAMES, Row};
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{McapResult, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Topic of the rows.
pub const ROWS: &str = "/cycle";
/// Topic of lists of numbers: what the loop is made of, and wishes.
pub const LISTS: &str = "/list";
/// Name of the metadata.
pub const ABOUT: &str = "forcefeel";

/// A record under way.
pub struct Record {
    writer: Writer<NoSeek<WholeFile>>,
    rows: u16,
    lists: u16,
    sequence: u32,
    /// Time of the record's first beat, in ns since 1970.
    start_ns: u64,
    most: u64,
    left: u64,
}

impl Record {
    /// Begins a record of at most so many bytes, with what the loop is made of; it is whole from here on.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(
        path: &Path,
        most_bytes: u64,
        start_ns: u64,
        about: &BTreeMap<String, String>,
        setup: &[(&'static str, Vec<f64>)],
    ) -> McapResult<Self> {
        let file = WholeFile { file: File::create(path)?, written: 0, pending: Vec::with_capacity(1 << 20) };
        let options = WriteOptions::new().compression(None).chunk_size(None).disable_seeking(true);
        let mut writer = options.library("forcefeel").create(NoSeek::new(file))?;
        writer.write_metadata(&Metadata { name: ABOUT.to_string(), metadata: about.clone() })?;
        let columns: String = NAMES.iter().flat_map(|name| ["float64 ", name, "\n"]).collect();
        let of_rows = writer.add_schema("forcefeel_msgs/msg/Cycle", "ros2msg", columns.as_bytes())?;
        let of_lists = writer.add_schema(
            "forcefeel_msgs/msg/List",
            "ros2msg",
            b"string name\nuint64 cycle\nfloat64[] numbers\n",
        )?;
        let none = BTreeMap::new();
        let rows = writer.add_channel(of_rows, ROWS, "cdr", &none)?;
        let lists = writer.add_channel(of_lists, LISTS, "cdr", &none)?;
        let mut record = Self { writer, rows, lists, sequence: 0, start_ns, most: most_bytes, left: most_bytes };
        for (name, numbers) in setup {
            record.list(name, 0, 0.0, numbers)?;
        }
        record.flush()?;
        Ok(record)
    }

    /// A row.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn row(&mut self, row: &Row) -> McapResult<()> {
        let mut data = [0; 4 + 8 * COLUMNS];
        data[..4].copy_from_slice(&CDR);
        for (k, number) in row.numbers().into_iter().enumerate() {
            data[4 + 8 * k..12 + 8 * k].copy_from_slice(&number.to_le_bytes());
        }
        self.message(self.rows, row.time_s, &data)
    }

    /// A list of numbers with its name, from a cycle on.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn list(&mut self, name: &str, cycle: u64, time_s: f64, numbers: &[f64]) -> McapResult<()> {
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
        self.message(self.lists, time_s, &data)
    }

    fn message(&mut self, channel_id: u16, time_s: f64, data: &[u8]) -> McapResult<()> {
        self.sequence = self.sequence.wrapping_add(1);
        // With its index: as much again as two numbers.
        self.left = self.left.saturating_sub(data.len() as u64 + MESSAGE_BYTES);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time since the start")]
        let log_time = self.start_ns + (time_s * 1e9) as u64;
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time, publish_time: log_time };
        self.writer.write_to_known_channel(&header, data)
    }

    /// Bytes so far, those included that are still to be brought to the file.
    pub fn bytes(&self) -> u64 {
        self.most - self.left
    }

    /// Whether there is room for no more.
    pub fn is_full(&self) -> bool {
        self.left < ROOM
    }

    /// Brings all that was written to the file, which is whole with it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn flush(&mut self) -> McapResult<()> {
        self.left = self.left.saturating_sub(CHUNK_BYTES);
        self.writer.flush()
    }

    /// Ends the record, with an index for those who jump about in it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self) -> McapResult<()> {
        self.writer.finish()?;
        let mut file = self.writer.into_inner().into_inner();
        file.write_pending(&[])?;
        file.file.set_len(file.written)?;
        Ok(())
    }
}

/// Little-endian, no options.
const CDR: [u8; 4] = [0, 1, 0, 0];

/// What MCAP adds to a message, and to a chunk with the rows' and the lists' indexes and its share of the summary.
const MESSAGE_BYTES: u64 = 31 + 16;
const CHUNK_BYTES: u64 = 400;
/// Kept for the end of a record.
const ROOM: u64 = 64 << 10;

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
}

impl WholeFile {
    /// Whoever is killed on the way leaves a file that begins and ends as one should: read from the front it ends where the write
    /// before did, and who looks at its last bytes first finds no index there.
    fn write_pending(&mut self, end: &[u8]) -> io::Result<()> {
        let (from, stays) = (self.written, self.pending.len());
        self.pending.extend_from_slice(end);
        let whole = self.pending.len();
        let head = whole.min(END.len());
        let tail = whole.saturating_sub(END.len()).max(head);
        if whole - tail == END.len() {
            write_at(&mut self.file, &END, from + tail as u64)?;
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
        self.write_pending(&END)
    }
}

fn write_at(file: &mut File, bytes: &[u8], at: u64) -> io::Result<()> {
    use std::io::{Seek, SeekFrom};
    file.seek(SeekFrom::Start(at))?;
    file.write_all(bytes)
}

/// End of the data, footer without a summary, and the magic: what an MCAP file without an index ends with.
const END: [u8; 50] = {
    let mut end = [0; 50];
    // Code, length and check sum of the end of the data.
    (end[0], end[1]) = (0x0f, 4);
    // Code and length of the footer, then where the summary is, that of its offsets, its check sum.
    (end[13], end[14]) = (0x02, 20);
    let magic = mcap::MAGIC;
    let mut k = 0;
    while k < 8 {
        end[42 + k] = magic[k];
        k += 1;
    }
    end
};
