//! Lines of text by which a serial adapter carries frames.
//!
//! | adapter | a frame | |
//! |---|---|---|
//! | fdcanusb | `can send 8001 01000A b F *5B`, `rcv 100 2400 E F` | a check sum of 8 bits, where the other end takes one |
//! | slcan | `t02E4CDCC4C3E`, a request `r0298`; `T` and `R` with 29 bits | classic CAN, ends with CR; BEL is an error |

use crate::frame::{Frame, MOST_BYTES};
use moteus_protocol::CanFdFrame;
use moteus_protocol::fdcanusb::{
    EncodeOptions, MAX_LINE_LENGTH, compute_crc8, encode_can_send, parse_rcv, strip_checksum,
};

/// Room for a line.
pub const LINE: usize = MAX_LINE_LENGTH + 16;

/// Kinds of adapters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Adapter {
    /// The fdcanusb of mjbots, and a moteus at a serial port.
    Fdcanusb,
    /// Lawicel's lines, which most USB adapters of classic CAN have.
    Slcan,
}

impl Adapter {
    /// Whether its lines may have check sums.
    pub fn has_sums(self) -> bool {
        match self {
            Self::Fdcanusb => true,
            Self::Slcan => false,
        }
    }

    /// What is written to it first.
    pub fn opening(self) -> &'static [u8] {
        match self {
            Self::Fdcanusb => b"",
            // Closed, 1 Mbit/s, open.
            Self::Slcan => b"C\rS8\rO\r",
        }
    }
}

/// A line that came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// A frame from the bus, or for it.
    Frame(Frame),
    /// The adapter cannot do what it is asked for.
    Error,
    /// Nothing to act on.
    Other,
}

/// One end of an adapter's serial port: bytes to lines, frames to bytes.
#[derive(Debug, Clone, Copy)]
pub struct Lines {
    adapter: Adapter,
    /// Whether lines have check sums; one that came with a wrong one is dropped in any case.
    pub checked: bool,
    line: [u8; LINE],
    count: usize,
    /// Whether the line is longer than any.
    spoiled: bool,
}

impl Lines {
    /// Nothing has come yet.
    pub fn new(adapter: Adapter) -> Self {
        Self { adapter, checked: true, line: [0; LINE], count: 0, spoiled: false }
    }

    /// The bytes of a frame that the loop sends, and their number.
    pub fn send(&self, frame: &Frame) -> ([u8; LINE], usize) {
        match self.adapter {
            Adapter::Fdcanusb => {
                let mut bytes = [0; LINE];
                let options = EncodeOptions { checksum: self.checked, ..EncodeOptions::default() };
                let count = encode_can_send(&can_fd(frame), &options, &mut bytes).unwrap_or(0);
                (bytes, count)
            }
            Adapter::Slcan => slcan(frame),
        }
    }

    /// The bytes of a frame that an adapter gives, and their number.
    pub fn give(&self, frame: &Frame) -> ([u8; LINE], usize) {
        if self.adapter == Adapter::Slcan {
            return slcan(frame);
        }
        let mut line = Text::new();
        line.put(b"rcv ");
        line.hex(frame.id, if frame.id > 0xffff { 8 } else { 4 });
        line.put(b" ");
        frame.data().iter().for_each(|&byte| line.hex(u32::from(byte), 2));
        line.put(if frame.extended { b" E B F" } else { b" e B F" });
        self.end(line)
    }

    /// The bytes by which an adapter says that it has sent a frame, or could not; their number.
    pub fn acknowledge(&self, sent: bool) -> ([u8; LINE], usize) {
        let mut line = Text::new();
        if self.adapter == Adapter::Slcan {
            line.put(if sent { b"\r" } else { b"\x07" });
            return (line.bytes, line.count);
        }
        line.put(if sent { b"OK" } else { b"ERR bus off" });
        self.end(line)
    }

    fn end(&self, mut line: Text) -> ([u8; LINE], usize) {
        if self.checked {
            line.put(b" ");
            let sum = compute_crc8(&line.bytes[..line.count]);
            line.put(b"*");
            line.hex(u32::from(sum), 2);
        }
        line.put(b"\r\n");
        (line.bytes, line.count)
    }

    /// Takes a byte: the line that it ends, if it does.
    pub fn take(&mut self, byte: u8) -> Option<Line> {
        if byte == BELL && self.adapter == Adapter::Slcan {
            (self.count, self.spoiled) = (0, false);
            return Some(Line::Error);
        }
        if byte != b'\n' && byte != b'\r' {
            self.spoiled |= self.count == LINE;
            if !self.spoiled {
                self.line[self.count] = byte;
                self.count += 1;
            }
            return None;
        }
        let (count, spoiled) = (self.count, self.spoiled);
        (self.count, self.spoiled) = (0, false);
        (count > 0 && !spoiled).then(|| self.read(count))
    }

    fn read(&mut self, count: usize) -> Line {
        let line = self.line;
        if self.adapter == Adapter::Slcan {
            return slcan_of(&line[..count]).map_or(Line::Other, Line::Frame);
        }
        let (text, summed, good) = strip_checksum(&line[..count]);
        if if summed { !good } else { self.checked && text.starts_with(b"rcv") } {
            return Line::Other;
        }
        if let Some(command) = text.strip_prefix(b"can send") {
            // A loop that sends no sums is given none.
            self.checked = summed;
            let mut line = Text::new();
            line.put(b"rcv");
            line.put(command);
            return frame_of(&line.bytes[..line.count]);
        }
        if text.starts_with(b"ERR") { Line::Error } else { frame_of(text) }
    }
}

fn frame_of(line: &[u8]) -> Line {
    parse_rcv(line).map_or(Line::Other, |came| {
        // The adapter marks a long identifier by a bit of its own.
        let id = came.arbitration_id & 0x1fff_ffff;
        Line::Frame(Frame::fd(id, came.payload()))
    })
}

/// The line of an error of slcan.
const BELL: u8 = 7;

fn slcan(frame: &Frame) -> ([u8; LINE], usize) {
    let mut line = Text::new();
    let kind: &[u8] = match (frame.remote, frame.extended) {
        (false, false) => b"t",
        (false, true) => b"T",
        (true, false) => b"r",
        (true, true) => b"R",
    };
    line.put(kind);
    line.hex(frame.id, if frame.extended { 8 } else { 3 });
    // A request states the length of its answer.
    let count = if frame.remote { 8 } else { frame.data().len().min(8) };
    line.hex(u32::try_from(count).unwrap_or(0), 1);
    frame.data().iter().take(8).for_each(|&byte| line.hex(u32::from(byte), 2));
    line.put(b"\r");
    (line.bytes, line.count)
}

fn slcan_of(line: &[u8]) -> Option<Frame> {
    let (&kind, rest) = line.split_first()?;
    let (remote, extended) = (kind == b'r' || kind == b'R', kind == b'T' || kind == b'R');
    if !(remote || extended || kind == b't') {
        return None;
    }
    let (id, rest) = rest.split_at_checked(if extended { 8 } else { 3 })?;
    let (count, digits) = rest.split_first()?;
    let count = usize::try_from(hex(&[*count])?).ok().filter(|count| *count <= 8)?;
    let mut data = [0; 8];
    if !remote {
        // An adapter may add the time behind the data.
        for (byte, pair) in data[..count].iter_mut().zip(digits.get(..2 * count)?.chunks_exact(2)) {
            *byte = u8::try_from(hex(pair)?).ok()?;
        }
    }
    let id = hex(id).filter(|id| *id <= if extended { 0x1fff_ffff } else { 0x7ff })?;
    Some(Frame { extended, remote, ..Frame::new(id, if remote { &[] } else { &data[..count] }) })
}

fn hex(digits: &[u8]) -> Option<u32> {
    digits.iter().try_fold(0, |number, &digit| Some(number << 4 | char::from(digit).to_digit(16)?))
}

fn can_fd(frame: &Frame) -> CanFdFrame {
    let mut to = CanFdFrame::new();
    to.arbitration_id = frame.id;
    let data = frame.data();
    to.data[..data.len()].copy_from_slice(data);
    to.size = u8::try_from(data.len().min(MOST_BYTES)).unwrap_or(0);
    to
}

/// Text that grows up to [`LINE`] bytes; what is beyond is left out.
struct Text {
    bytes: [u8; LINE],
    count: usize,
}

impl Text {
    fn new() -> Self {
        Self { bytes: [0; LINE], count: 0 }
    }

    fn put(&mut self, text: &[u8]) {
        let room = text.len().min(LINE - self.count);
        self.bytes[self.count..self.count + room].copy_from_slice(&text[..room]);
        self.count += room;
    }

    fn hex(&mut self, number: u32, digits: u32) {
        for digit in (0..digits).rev() {
            self.put(&[b"0123456789ABCDEF"[(number >> (4 * digit)) as usize & 15]]);
        }
    }
}
