//! What carries frames between a loop and its bus.

use crate::serial::Serial;
use forcefeel_bus::frame::Frame;
use forcefeel_bus::line::{Adapter, Line, Lines};
use std::io;
use std::path::Path;
use std::time::Duration;

/// A way to a bus; no call waits but [`wait`](Self::wait).
pub trait Carrier: Send {
    /// Sends a frame, or loses it.
    fn send(&mut self, frame: &Frame);
    /// What has come next, if anything has.
    fn next(&mut self) -> Option<Line>;
    /// Waits until something has come, for so long at most.
    fn wait(&self, most: Duration);
    /// Leaves out check sums, where the other end does not know them.
    fn without_sums(&mut self) {}
}

/// A serial adapter.
#[derive(Debug)]
pub struct SerialAdapter {
    port: Serial,
    lines: Lines,
    bytes: [u8; 512],
    read: [usize; 2],
    /// Whether the last line was cut off.
    cut: bool,
}

impl SerialAdapter {
    /// Opens the port of an adapter.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn open(path: &Path, adapter: Adapter) -> io::Result<Self> {
        let mut made = Self {
            port: Serial::open(path)?,
            lines: Lines::new(adapter),
            bytes: [0; 512],
            read: [0; 2],
            cut: true, // of whoever had it before
        };
        made.put(adapter.opening());
        Ok(made)
    }

    fn put(&mut self, bytes: &[u8]) {
        if self.cut && self.port.write(b"\r") == 0 {
            return;
        }
        self.cut = self.port.write(bytes) < bytes.len();
    }
}

impl Carrier for SerialAdapter {
    fn send(&mut self, frame: &Frame) {
        let (bytes, count) = self.lines.send(frame);
        self.put(&bytes[..count]);
    }

    fn next(&mut self) -> Option<Line> {
        loop {
            if self.read[0] == self.read[1] {
                self.read = [0, self.port.read(&mut self.bytes)];
                if self.read[1] == 0 {
                    return None;
                }
            }
            let byte = self.bytes[self.read[0]];
            self.read[0] += 1;
            if let Some(line) = self.lines.take(byte) {
                return Some(line);
            }
        }
    }

    fn wait(&self, most: Duration) {
        self.port.wait(most);
    }

    fn without_sums(&mut self) {
        self.lines.checked = false;
    }
}
