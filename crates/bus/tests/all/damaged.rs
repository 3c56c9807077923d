//! A million damaged frames and lines for each codec: none of them panics, and none moves a drive that is stopped.

use forcefeel_bus::drive::{Action, Ask, Codec, Node, Shown};
use forcefeel_bus::ethercat::Units;
use forcefeel_bus::ethercat::datagram::Packet;
use forcefeel_bus::ethercat::station::Segment;
use forcefeel_bus::frame::Frame;
use forcefeel_bus::line::{Adapter, Line, Lines};
use forcefeel_bus::protocol::Protocol;

pub const FRAMES: u32 = 1_000_000;

/// Numbers of a xorshift generator, from a fixed seed.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self, below: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 >> 11).expect("53 bits") % below
    }

    /// A frame with some bytes of it changed, and its length too.
    fn damaged(&mut self, frame: &Frame) -> Frame {
        let mut data = frame.data().to_vec();
        for _ in 0..=self.next(4) {
            if data.is_empty() || self.next(8) == 0 {
                data.resize(self.next(65), 0x50);
            }
            if !data.is_empty() {
                let place = self.next(data.len());
                data[place] = u8::try_from(self.next(256)).expect("a byte");
            }
        }
        let id = if self.next(4) == 0 { frame.id ^ (1 << self.next(29)) } else { frame.id };
        let fd = frame.fd;
        let mut made = if fd { Frame::fd(id, &data) } else { Frame::new(id, &data) };
        made.remote = frame.remote && self.next(8) > 0;
        made
    }
}

/// A frame of EtherCAT with some bytes of it changed, or cut off.
pub fn damaged(numbers: &mut Numbers, frame: &[u8]) -> Vec<u8> {
    let mut bytes = frame.to_vec();
    for _ in 0..=numbers.next(4) {
        let place = numbers.next(bytes.len());
        bytes[place] = u8::try_from(numbers.next(256)).expect("a byte");
    }
    bytes.truncate(if numbers.next(8) == 0 { numbers.next(bytes.len()) + 1 } else { bytes.len() });
    bytes
}

/// A wire on which one of 64 answers is damaged, and one lost; how many there were.
pub struct Damaging<W>(pub W, pub Numbers, pub u32);

impl<W: Segment> Segment for Damaging<W> {
    fn exchange(&mut self, packet: &mut Packet) -> bool {
        self.2 += 1;
        self.0.exchange(packet);
        if self.1.next(64) == 0 {
            let size = packet.sent().len();
            let bytes = damaged(&mut self.1, packet.sent());
            packet.bytes[..size].fill(0);
            packet.bytes[..bytes.len()].copy_from_slice(&bytes);
        }
        self.1.next(64) > 0
    }
    fn rest(&mut self) {}
}

/// Kinds on CAN, with the adapter of each.
fn kinds() -> impl Iterator<Item = (&'static str, Protocol, Adapter)> {
    Protocol::ALL.into_iter().filter_map(|(name, protocol)| Some((name, protocol, protocol.adapter()?)))
}

/// Both sides of a kind.
fn sides(protocol: Protocol) -> (Box<dyn Codec + Send>, Box<dyn Node + Send>) {
    (protocol.codec(1, [true; 3]).expect("a kind on CAN"), protocol.node(1, Units::ONE, None, true))
}

/// Frames of a cycle and their answers.
fn exchange(protocol: Protocol, enable: bool) -> (Vec<Frame>, Vec<Frame>) {
    let (mut codec, mut node) = sides(protocol);
    let (mut asked, mut answers) = (vec![], vec![]);
    for cycle in 0..3 {
        let mut frames = vec![];
        codec.ask(&Ask { cycle, torque: 0.5, enable, watchdog_s: 0.1 }, &mut |frame| frames.push(*frame));
        if cycle == 0 {
            codec.who(1, &mut |frame| frames.push(*frame));
        }
        for frame in &frames {
            node.take(frame, &Shown::default(), 0.0, &mut |answer| answers.push(*answer));
        }
        asked.extend(frames);
    }
    (asked, answers)
}

#[test]
fn a_million_damaged_answers_do_not_panic() {
    for (name, protocol, _) in kinds() {
        let (_, answers) = exchange(protocol, true);
        assert!(!answers.is_empty(), "{name}");
        let (mut numbers, mut taken) = (Numbers(1), 0);
        let (mut codec, _) = sides(protocol);
        for _ in 0..FRAMES {
            let place = numbers.next(answers.len());
            let frame = numbers.damaged(&answers[place]);
            taken += u32::from(codec.take(&frame).is_some());
            let _ = codec.identity(&frame);
        }
        // Some are whole after all, or nothing would be tried of what lies behind the first look.
        assert!(taken > 1000, "{name}: {taken}");
    }
}

#[test]
fn a_million_damaged_stops_leave_a_node_without_panic() {
    for (name, protocol, _) in kinds() {
        let (asked, _) = exchange(protocol, false);
        let (mut numbers, (_, mut node)) = (Numbers(2), sides(protocol));
        let mut answered = 0;
        for _ in 0..FRAMES {
            let place = numbers.next(asked.len());
            let frame = numbers.damaged(&asked[place]);
            node.take(&frame, &Shown::default(), 0.0, &mut |_| answered += 1);
        }
        assert!(answered > 1000, "{name}: {answered}");
        node.fail(0);
        assert_eq!(node.action(0.0), Action::Free, "{name}");
    }
}

#[test]
fn a_million_damaged_lines_give_no_panic_and_no_frame_that_was_not_sent() {
    for (name, protocol, adapter) in kinds() {
        let (_, answers) = exchange(protocol, true);
        let (mut numbers, mut lines) = (Numbers(3), Lines::new(adapter));
        let sent: Vec<_> = answers.iter().map(|frame| lines.give(frame)).collect();
        let (mut good, mut other) = (0, 0);
        for _ in 0..FRAMES {
            let place = numbers.next(sent.len());
            let (mut bytes, count) = sent[place];
            if numbers.next(4) > 0 {
                let at = numbers.next(count);
                bytes[at] = u8::try_from(numbers.next(256)).expect("a byte");
            }
            for &byte in &bytes[..count] {
                if let Some(Line::Frame(frame)) = lines.take(byte) {
                    good += u32::from(frame.data() == answers[place].data());
                    other += u32::from(frame.data() != answers[place].data());
                }
            }
        }
        // A quarter is whole; of the damaged ones a sum of 8 bits lets one in 256 pass at most.
        assert!(good > FRAMES / 5, "{name}: {good}");
        assert!(other < FRAMES / 256 || !adapter.has_sums(), "{name}: {other}");
    }
}
