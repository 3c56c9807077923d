//! A file that is whole whenever the process ends.

use crate::mcap::MAGIC;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};

/// A file that ends as an MCAP file does after every flush.
pub struct WholeFile {
    file: File,
    /// Bytes that stay.
    written: u64,
    pending: Vec<u8>,
    /// A write failed; the file ends where it did before it.
    given_up: bool,
}

impl WholeFile {
    /// An empty file.
    pub fn new(file: File) -> Self {
        Self { file, written: 0, pending: Vec::with_capacity(1 << 20), given_up: false }
    }

    /// Puts bytes in the place of others, once all that came before is in the file: they may speak of it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn overwrite(&mut self, at: u64, bytes: &[u8]) -> io::Result<()> {
        self.flush()?;
        if self.given_up { Ok(()) } else { write_at(&mut self.file, bytes, at) }
    }

    /// Ends the file behind what came so far, which has an end of its own.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(mut self) -> io::Result<()> {
        self.write_pending(&[])?;
        self.file.set_len(self.written)
    }

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
        if self.pending.is_empty() { Ok(()) } else { self.write_pending(&NO_INDEX) }
    }
}

fn write_at(file: &mut File, bytes: &[u8], at: u64) -> io::Result<()> {
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
