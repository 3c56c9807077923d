//! An MCAP file, written from its beginning to its end: chunks, each with the places of its messages behind it; at the end a summary.
//!
//! A chunk grows in the file: a record that readers skip stands where its head will, the messages behind it count by themselves until
//! the head is put over that record.

use crate::mcap::{MAGIC, op};
use crate::whole_file::WholeFile;
use crc32fast::{Hasher, hash};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// A file under way.
pub struct Writer {
    to: WholeFile,
    /// Bytes before the chunk under way, and their check sum.
    position: u64,
    sum: Hasher,
    chunk: Chunk,
    /// Schemas and channels, which the summary repeats.
    schemas: Vec<Vec<u8>>,
    channels: Vec<Vec<u8>>,
    chunk_indexes: Vec<Vec<u8>>,
    metadata_indexes: Vec<Vec<u8>>,
    /// Messages on each channel.
    counts: BTreeMap<u16, u64>,
    /// When the first message came, and the last.
    times: Option<(u64, u64)>,
}

/// Records of the chunk under way.
#[derive(Default)]
struct Chunk {
    records: Vec<u8>,
    /// Bytes of them that were handed to the file.
    handed: usize,
    /// Time and place of each message on a channel.
    messages: BTreeMap<u16, Vec<(u64, u64)>>,
    times: Option<(u64, u64)>,
}

impl Writer {
    /// Begins a file, with the name of what writes it.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn begin(to: WholeFile, library: &str) -> io::Result<Self> {
        let mut writer = Self {
            to,
            position: 0,
            sum: Hasher::new(),
            chunk: Chunk::default(),
            schemas: Vec::new(),
            channels: Vec::new(),
            chunk_indexes: Vec::new(),
            metadata_indexes: Vec::new(),
            counts: BTreeMap::new(),
            times: None,
        };
        writer.put(&MAGIC)?;
        writer.put(&Content::new().text("").text(library).record(op::HEADER))?;
        Ok(writer)
    }

    /// Takes texts by name down, behind what came before.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn metadata(&mut self, name: &str, texts: &BTreeMap<String, String>) -> io::Result<()> {
        self.end_chunk()?;
        let pairs = texts.iter().fold(Content::new(), |pairs, (key, text)| pairs.text(key).text(text));
        let record = Content::new().text(name).list(&pairs).record(op::METADATA);
        let index = Content::new().u64(self.position).u64(record.len() as u64).text(name);
        self.metadata_indexes.push(index.record(op::METADATA_INDEX));
        self.put(&record)
    }

    /// Adds a topic whose messages are encoded as CDR and consist of what `schema`, a message of ROS 2, says.
    pub fn channel(&mut self, topic: &str, name: &str, schema: &str) -> u16 {
        let id = u16::try_from(self.channels.len() + 1).unwrap_or(u16::MAX);
        let described = Content::new().u16(id).text(name).text("ros2msg").text(schema).record(op::SCHEMA);
        self.chunk.records.extend(&described);
        self.schemas.push(described);
        let channel = Content::new().u16(id).u16(id).text(topic).text("cdr").list(&Content::new()).record(op::CHANNEL);
        self.chunk.records.extend(&channel);
        self.channels.push(channel);
        id
    }

    /// A message on a channel, at a time in ns.
    pub fn message(&mut self, channel: u16, sequence: u32, time_ns: u64, data: &[u8]) {
        let around = |times: Option<(u64, u64)>| {
            times.map_or((time_ns, time_ns), |(first, last)| (first.min(time_ns), last.max(time_ns)))
        };
        self.times = Some(around(self.times));
        *self.counts.entry(channel).or_default() += 1;
        let Chunk { records, messages, times, .. } = &mut self.chunk;
        *times = Some(around(*times));
        messages.entry(channel).or_default().push((time_ns, records.len() as u64));
        records.push(op::MESSAGE);
        records.extend((2 + 4 + 8 + 8 + data.len() as u64).to_le_bytes());
        records.extend(channel.to_le_bytes());
        records.extend(sequence.to_le_bytes());
        records.extend(time_ns.to_le_bytes());
        records.extend(time_ns.to_le_bytes());
        records.extend(data);
    }

    /// Brings all that came so far to the file.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.hand_over()?;
        self.to.flush()
    }

    /// Ends the file with a summary.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(mut self) -> io::Result<()> {
        self.end_chunk()?;
        let sum = self.sum.clone().finalize();
        self.put(&Content::new().u32(sum).record(op::DATA_END))?;
        let start = self.position;
        self.sum = Hasher::new();
        let groups = [
            (op::SCHEMA, self.schemas.concat()),
            (op::CHANNEL, self.channels.concat()),
            (op::STATISTICS, self.statistics()),
            (op::CHUNK_INDEX, self.chunk_indexes.concat()),
            (op::METADATA_INDEX, self.metadata_indexes.concat()),
        ];
        let mut offsets = Vec::new();
        for (code, records) in groups.iter().filter(|(_, records)| !records.is_empty()) {
            let content = Content(vec![*code]).u64(self.position).u64(records.len() as u64);
            offsets.extend(content.record(op::SUMMARY_OFFSET));
            self.put(records)?;
        }
        let offsets_start = self.position;
        self.put(&offsets)?;
        // The sum is of all before it.
        let footer = Content::new().u64(start).u64(offsets_start).u32(0).record(op::FOOTER);
        self.put(&footer[..footer.len() - 4])?;
        let sum = self.sum.clone().finalize();
        self.put(&sum.to_le_bytes())?;
        self.put(&MAGIC)?;
        self.to.finish()
    }

    fn statistics(&self) -> Vec<u8> {
        let counts = self.counts.iter().fold(Content::new(), |counts, (&id, &count)| counts.u16(id).u64(count));
        let (first, last) = self.times.unwrap_or_default();
        Content::new()
            .u64(self.counts.values().sum())
            .u16(u16::try_from(self.schemas.len()).unwrap_or(u16::MAX))
            .count(self.channels.len())
            .count(0)
            .count(self.metadata_indexes.len())
            .count(self.chunk_indexes.len())
            .u64(first)
            .u64(last)
            .list(&counts)
            .record(op::STATISTICS)
    }

    fn hand_over(&mut self) -> io::Result<()> {
        let Chunk { records, handed, .. } = &mut self.chunk;
        if *handed == 0 && !records.is_empty() {
            self.to.write_all(&HEAD_TO_COME)?;
        }
        self.to.write_all(&records[*handed..])?;
        *handed = records.len();
        Ok(())
    }

    /// Ends the chunk under way, if there is one: from here on its check sum holds it together.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn end_chunk(&mut self) -> io::Result<()> {
        if self.chunk.records.is_empty() {
            return Ok(());
        }
        self.hand_over()?;
        let Chunk { records, messages, times, .. } = std::mem::take(&mut self.chunk);
        let (first, last) = times.unwrap_or_default();
        let size = records.len() as u64;
        let fields = Content::new().u64(first).u64(last).u64(size).u32(hash(&records)).text("").u64(size);
        let head = Content(vec![op::CHUNK]).u64(fields.0.len() as u64 + size).and(&fields.0).0;
        let start = self.position;
        self.to.overwrite(start, &head)?;
        self.count(&head);
        self.count(&records);
        let end = self.position;
        let mut places = Content::new();
        for (&channel, messages) in &messages {
            places = places.u16(channel).u64(self.position);
            let entries = messages.iter().fold(Content::new(), |entries, &(time, at)| entries.u64(time).u64(at));
            self.put(&Content::new().u16(channel).list(&entries).record(op::MESSAGE_INDEX))?;
        }
        let index = Content::new().u64(first).u64(last).u64(start).u64(end - start).list(&places);
        let index = index.u64(self.position - end).text("").u64(size).u64(size);
        self.chunk_indexes.push(index.record(op::CHUNK_INDEX));
        Ok(())
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.count(bytes);
        self.to.write_all(bytes)
    }

    fn count(&mut self, bytes: &[u8]) {
        self.sum.update(bytes);
        self.position += bytes.len() as u64;
    }
}

/// As long as the head of a chunk: a record of a code that the format leaves to programs.
const HEAD_TO_COME: [u8; 49] = {
    let mut record = [0; 49];
    (record[0], record[1]) = (op::OWN, 40);
    record
};

/// What a record is made of: numbers, and texts and lists behind their length, one after the other.
struct Content(Vec<u8>);

impl Content {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn and(mut self, bytes: &[u8]) -> Self {
        self.0.extend(bytes);
        self
    }

    fn u16(self, number: u16) -> Self {
        self.and(&number.to_le_bytes())
    }

    fn u32(self, number: u32) -> Self {
        self.and(&number.to_le_bytes())
    }

    fn u64(self, number: u64) -> Self {
        self.and(&number.to_le_bytes())
    }

    fn count(self, number: usize) -> Self {
        self.u32(u32::try_from(number).unwrap_or(u32::MAX))
    }

    fn text(self, text: &str) -> Self {
        self.count(text.len()).and(text.as_bytes())
    }

    fn list(self, entries: &Self) -> Self {
        self.count(entries.0.len()).and(&entries.0)
    }

    /// As a record.
    fn record(self, code: u8) -> Vec<u8> {
        let mut record = vec![code];
        record.extend((self.0.len() as u64).to_le_bytes());
        record.extend(self.0);
        record
    }
}
