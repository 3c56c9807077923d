//! The EEPROM of a slave: who it is, its mailboxes, its sync managers (ETG.1000.6, 5.4; addresses in words of 16 bits).

use super::registers::{MASTER_WRITES, TRIGGERS};
use alloc::vec;
use alloc::vec::Vec;

/// Where words are.
pub mod word {
    #![expect(missing_docs, reason = "names of the standard")]
    pub const ALIAS: u16 = 0x04;
    pub const VENDOR: u16 = 0x08;
    pub const MAILBOX: u16 = 0x18;
    pub const PROTOCOLS: u16 = 0x1c;
    pub const CATEGORIES: u16 = 0x40;
}

/// Bit of the mailbox's protocols: CANopen over EtherCAT.
pub const HAS_COE: u16 = 1 << 2;
/// Categories.
pub const SYNC_MANAGERS: u16 = 41;
const STRINGS: u16 = 10;
const GENERAL: u16 = 30;
const FMMUS: u16 = 40;
/// No more of them.
pub const END: u16 = 0xffff;

/// Start, size and control of the emulated slave's sync managers: mailbox out and in, outputs, inputs; the last two of three buffers, whose
/// sizes are the product's.
pub const MANAGERS: [(u16, u16, u8); 4] =
    [(0x1000, 128, 0x26), (0x1080, 128, 0x22), (0x1100, 0, 0x20 | MASTER_WRITES | TRIGGERS), (0x1180, 0, 0x20)];

/// An emulated product.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Product {
    /// Its name.
    pub name: &'static str,
    /// Its number.
    pub code: u32,
    /// Bytes of outputs and inputs by default.
    pub sizes: [u16; 2],
}

/// The EEPROM of an emulated slave: product code, serial number and alias, no maker.
pub fn image(product: &Product, serial: u32, alias: u8) -> Vec<u8> {
    let mut words = vec![0_u16; usize::from(word::CATEGORIES)];
    // Process data interface of 16 bits to a processor, and SYNC0.
    words[..2].copy_from_slice(&[0x0c08, 0x0000]);
    words[usize::from(word::ALIAS)] = alias.into();
    words[7] = u16::from(checksum(&bytes_of(&words[..7])));
    for (place, number) in [(0x0a, product.code), (0x0c, 1), (0x0e, serial)] {
        words[place..place + 2].copy_from_slice(&halves(number));
    }
    let [(out, out_size, _), (answers, answers_size, _), ..] = MANAGERS;
    words[usize::from(word::MAILBOX)..][..5].copy_from_slice(&[out, out_size, answers, answers_size, HAS_COE]);
    words[0x3e..0x40].copy_from_slice(&[15, 1]);
    let mut bytes = bytes_of(&words);
    let mut category = |kind: u16, mut data: Vec<u8>| {
        data.resize(data.len().next_multiple_of(2), 0);
        let size = u16::try_from(data.len() / 2).unwrap_or(0);
        bytes.extend([kind.to_le_bytes(), size.to_le_bytes()].as_flattened());
        bytes.extend(data);
    };
    let name = product.name.as_bytes();
    let count = u8::try_from(name.len()).unwrap_or(0);
    category(STRINGS, [&[1, count], name].concat());
    // The name's place among the strings, and service data objects.
    let mut general = vec![0; 32];
    (general[3], general[5]) = (1, 1);
    category(GENERAL, general);
    category(FMMUS, vec![1, 2, 0, 0]);
    let [outputs, inputs] = product.sizes;
    let sizes = [out_size, answers_size, outputs, inputs];
    let managers = MANAGERS.iter().zip(sizes).zip(1..).flat_map(|((&(start, _, control), size), kind)| {
        let ([a, b], [c, d]) = (start.to_le_bytes(), size.to_le_bytes());
        [a, b, c, d, control, 0, u8::from(size > 0), kind]
    });
    category(SYNC_MANAGERS, managers.collect());
    bytes.extend(END.to_le_bytes());
    bytes
}

fn bytes_of(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "both halves")]
fn halves(number: u32) -> [u16; 2] {
    [number as u16, (number >> 16) as u16]
}

/// CRC of 8 bits over the first seven words: polynomial `x^8 + x^2 + x + 1` from 0xff.
fn checksum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0xff, |sum, &byte| {
        (0..8).fold(sum ^ byte, |sum, _| if sum & 0x80 == 0 { sum << 1 } else { sum << 1 ^ 0x07 })
    })
}
