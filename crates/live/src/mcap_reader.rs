//! The records of an MCAP file: every length is held against the bytes that are there before anything is made of it.
//!
//! A reader of damaged files must neither panic nor take memory for what a damaged length promises. Here nothing is copied, and a chunk's
//! check sum is looked at before its records.

use crate::mcap::{MAGIC, op};
use std::collections::BTreeMap;

/// Records in the order of the file, those in chunks among them, up to the end of the data; or where it is damaged, and how.
pub struct Records<'a> {
    file: &'a [u8],
    /// What has not been read of the file.
    rest: &'a [u8],
    /// What has not been read of a chunk.
    chunk: &'a [u8],
    /// Chunks so far.
    chunks: u64,
    /// Why the file breaks off in that chunk.
    cut_off: Option<String>,
    over: bool,
}

impl<'a> Records<'a> {
    /// The records of a file.
    ///
    /// # Errors
    /// If it does not begin as an MCAP file does.
    pub fn of(file: &'a [u8]) -> Result<Self, String> {
        let rest = file.strip_prefix(&MAGIC).ok_or("is no MCAP file: it does not begin as one")?;
        Ok(Self { file, rest, chunk: &[], chunks: 0, cut_off: None, over: false })
    }

    fn step(&mut self) -> Result<Option<(u8, &'a [u8])>, String> {
        loop {
            if !self.chunk.is_empty() {
                let (code, body, rest) = split(self.chunk)?;
                self.chunk = rest;
                return Ok(Some((code, body)));
            }
            if let Some(why) = self.cut_off.take() {
                return Err(why);
            }
            let before = self.file.len() - self.rest.len();
            let (code, body, rest) = match split(self.rest) {
                // Of a chunk that is cut off its first records are there.
                Err(why) if self.rest.first() == Some(&op::CHUNK) => {
                    (self.chunk, self.rest) = (begun(self.rest.get(9..).unwrap_or_default()), &[]);
                    self.cut_off = Some(why);
                    continue;
                }
                entries => entries?,
            };
            self.rest = rest;
            match code {
                op::CHUNK => {
                    self.chunks += 1;
                    self.chunk = unpacked(body).map_err(|why| format!("chunk {} {why}", self.chunks))?;
                }
                op::DATA_END => {
                    let sum = body.try_into().map(u32::from_le_bytes).map_err(|_| "its end is damaged")?;
                    same_sum(sum, &self.file[..before])?;
                    check_end(self.file).ok_or("its end is missing")??;
                    return Ok(None);
                }
                _ => return Ok(Some((code, body))),
            }
        }
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = Result<(u8, &'a [u8]), String>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.over {
            return None;
        }
        let at = self.file.len() - self.rest.len();
        let entries = self.step().map_err(|what| format!("{what} (byte {at} of {})", self.file.len())).transpose();
        self.over = !matches!(entries, Some(Ok(_)));
        entries
    }
}

/// Code and content of the first record, and what stands behind it.
fn split(bytes: &[u8]) -> Result<(u8, &[u8], &[u8]), String> {
    let (Some(code), Some(length)) = (bytes.first(), bytes.get(1..9).and_then(|bytes| bytes.first_chunk())) else {
        return Err("it ends before its end".to_string());
    };
    let (length, there) = (u64::from_le_bytes(*length), &bytes[9..]);
    match usize::try_from(length).ok().filter(|length| *length <= there.len()) {
        Some(length) => Ok((*code, &there[..length], &there[length..])),
        None => Err(format!("a record of {length} bytes is said to stand where {} are left", there.len())),
    }
}

/// What is there of the records of a chunk that is not there as a whole.
fn begun(body: &[u8]) -> &[u8] {
    let mut fields = Fields(body);
    let head = (fields.take(28), fields.text(), fields.take(8));
    if let (Some(_), Some(""), Some(_)) = head { fields.0 } else { &[] }
}

/// The records of a chunk: first and last time, size and check sum as unpacked, how it is packed, size as packed.
fn unpacked(body: &[u8]) -> Result<&[u8], String> {
    let damaged = "is damaged: its head";
    let mut fields = Fields(body);
    fields.take(16).ok_or(damaged)?;
    let (size, sum) = (fields.u64().ok_or(damaged)?, fields.u32().ok_or(damaged)?);
    let (packing, packed) = (fields.text().ok_or(damaged)?, fields.u64().ok_or(damaged)?);
    if !packing.is_empty() {
        return Err(format!("is packed by {packing:?}, which forcefeel does not write"));
    }
    let records = usize::try_from(packed).ok().and_then(|packed| fields.take(packed)).ok_or(damaged)?;
    if size != packed {
        return Err(damaged.to_string());
    }
    same_sum(sum, records).map_err(|why| format!("is damaged: {why}"))?;
    Ok(records)
}

/// Looks at the footer, which begins with where the summary does and ends with the sum from there on; nothing where it is not there.
fn check_end(file: &[u8]) -> Option<Result<(), String>> {
    let before_sum = file.strip_suffix(&MAGIC)?.len().checked_sub(4)?;
    let footer = before_sum.checked_sub(1 + 8 + 16)?;
    let mut fields = Fields(&file[footer..]);
    if fields.take(1)? != [op::FOOTER] || fields.u64()? != 20 {
        return None;
    }
    let (summary, _offsets, sum) = (fields.u64()?, fields.u64()?, fields.u32()?);
    let summed = usize::try_from(summary).ok().and_then(|from| file.get(from..before_sum));
    Some(summed.map_or_else(|| Err("its end is damaged".to_string()), |summed| same_sum(sum, summed)))
}

/// Zero is the sum of what has none.
fn same_sum(sum: u32, bytes: &[u8]) -> Result<(), String> {
    if sum == 0 || sum == crc32fast::hash(bytes) {
        return Ok(());
    }
    Err("a check sum does not fit what it is of".to_string())
}

/// Numbers and texts one after the other; nothing where there are too few bytes.
pub struct Fields<'a>(pub &'a [u8]);

impl<'a> Fields<'a> {
    /// So many bytes.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    /// A number of two bytes.
    pub fn u16(&mut self) -> Option<u16> {
        self.take(2)?.first_chunk().map(|bytes| u16::from_le_bytes(*bytes))
    }

    /// Of four.
    pub fn u32(&mut self) -> Option<u32> {
        self.take(4)?.first_chunk().map(|bytes| u32::from_le_bytes(*bytes))
    }

    /// Of eight.
    pub fn u64(&mut self) -> Option<u64> {
        self.take(8)?.first_chunk().map(|bytes| u64::from_le_bytes(*bytes))
    }

    /// A length and so many bytes.
    pub fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.u32()?;
        self.take(usize::try_from(length).ok()?)
    }

    /// The same as a text.
    pub fn text(&mut self) -> Option<&'a str> {
        str::from_utf8(self.bytes()?).ok()
    }

    /// Texts by name.
    pub fn texts(&mut self) -> Option<BTreeMap<String, String>> {
        let (mut pairs, mut entries) = (Fields(self.bytes()?), BTreeMap::new());
        while !pairs.0.is_empty() {
            let name = pairs.text()?;
            entries.insert(name.to_string(), pairs.text()?.to_string());
        }
        Some(entries)
    }
}
