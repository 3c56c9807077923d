//! The mailbox, with CANopen's service data objects in it, expedited and normal (ETG.1000.6, 5.6).
//!
//! `length u16, address u16, channel u8, type u4, counter u4` and then `service << 12 u16, command u8, index u16, sub-index u8, data`.

use alloc::vec;
use alloc::vec::Vec;

/// Bytes before the data of a service, of which the first ones are the mailbox's own.
pub const HEAD: usize = 12;
const MAILBOX: usize = 6;
const COE: u8 = 3;
const REQUEST: u8 = 2;
const RESPONSE: u8 = 3;
/// Commands, by their upper bits.
const DOWNLOAD: u8 = 0x20;
const UPLOAD: u8 = 0x40;
const DOWNLOADED: u8 = 0x60;
const ABORT: u8 = 0x80;
const EXPEDITED: u8 = 0x02;
const SIZED: u8 = 0x01;

/// A place in the dictionary of objects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Object {
    /// Index.
    pub index: u16,
    /// Sub-index.
    pub sub: u8,
}

impl Object {
    /// That of an index and its sub-index.
    pub const fn new(index: u16, sub: u8) -> Self {
        Self { index, sub }
    }
}

impl core::fmt::Display for Object {
    fn fmt(&self, to: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(to, "0x{:04X}:{}", self.index, self.sub)
    }
}

/// Why a slave refuses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Abort(pub u32);

impl Abort {
    /// No such object.
    pub const MISSING: Self = Self(0x0602_0000);
    /// It cannot be written.
    pub const READ_ONLY: Self = Self(0x0601_0002);
    /// Another number of bytes.
    pub const SIZE: Self = Self(0x0607_0010);
    /// It cannot be mapped into process data.
    pub const NOT_MAPPABLE: Self = Self(0x0604_0041);
    /// Not in this state.
    pub const STATE: Self = Self(0x0800_0022);
    /// No such value.
    pub const VALUE: Self = Self(0x0609_0030);
    /// No such command.
    pub const COMMAND: Self = Self(0x0504_0001);
}

/// A request to a dictionary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Request {
    /// For the value of an object.
    Upload(Object),
    /// To write a value.
    Download(Object, Vec<u8>),
}

impl Request {
    /// The message of a mailbox of this size; a value that has no room is cut off.
    pub fn message(&self, counter: u8, size: usize) -> Vec<u8> {
        match self {
            Self::Upload(object) => message(counter, REQUEST, UPLOAD, *object, &[0; 4], size),
            Self::Download(object, value) => with_value(counter, REQUEST, DOWNLOAD, *object, value, size),
        }
    }

    /// The request in a message, with its counter; the abort and its object where it is another service.
    ///
    /// # Errors
    /// Nothing where no answer is due.
    pub fn of(message: &[u8]) -> Option<(u8, Object, Result<Self, Abort>)> {
        let (counter, service, command, object, data) = parts(message)?;
        if service != REQUEST {
            return None;
        }
        let request = match command & 0xe0 {
            UPLOAD => Ok(Self::Upload(object)),
            DOWNLOAD => value_of(command, data).map_or(Err(Abort::SIZE), |value| Ok(Self::Download(object, value))),
            ABORT => return None,
            _ => Err(Abort::COMMAND),
        };
        Some((counter, object, request))
    }
}

/// The slave's message: what it uploads, that it has downloaded, or that it refuses.
pub fn answer(counter: u8, object: Object, outcome: Result<Option<&[u8]>, Abort>, size: usize) -> Vec<u8> {
    match outcome {
        Ok(Some(value)) => with_value(counter, RESPONSE, UPLOAD, object, value, size),
        Ok(None) => message(counter, RESPONSE, DOWNLOADED, object, &[0; 4], size),
        Err(Abort(code)) => message(counter, REQUEST, ABORT, object, &code.to_le_bytes(), size),
    }
}

/// What a slave's message answers of an object: the value, empty after a download; nothing where it is of another matter.
pub fn answered(message: &[u8], asked: Object) -> Option<Result<Vec<u8>, Abort>> {
    let (_, service, command, object, data) = parts(message)?;
    if object != asked || !(service == REQUEST || service == RESPONSE) {
        return None;
    }
    match command & 0xe0 {
        UPLOAD => value_of(command, data).map(Ok),
        DOWNLOADED => Some(Ok(vec![])),
        ABORT => Some(Err(Abort(u32::from_le_bytes(*data.first_chunk()?)))),
        _ => None,
    }
}

fn parts(message: &[u8]) -> Option<(u8, u8, u8, Object, &[u8])> {
    let length = usize::from(u16::from_le_bytes(*message.first_chunk()?));
    let body = message.get(MAILBOX..MAILBOX.checked_add(length)?)?;
    let (&[_, service, command, low, high, sub], data) = body.split_first_chunk::<6>()?;
    let kind = message[5];
    let object = Object::new(u16::from_le_bytes([low, high]), sub);
    (kind & 0x0f == COE).then_some((kind >> 4 & 7, service >> 4, command, object, data))
}

/// The value of an upload's or a download's first message, which has to be whole.
fn value_of(command: u8, data: &[u8]) -> Option<Vec<u8>> {
    let (size, data) = if command & EXPEDITED == 0 {
        let (size, data) = data.split_first_chunk::<4>()?;
        (usize::try_from(u32::from_le_bytes(*size)).ok()?, data)
    } else {
        (if command & SIZED == 0 { 4 } else { 4 - usize::from(command >> 2 & 3) }, data)
    };
    Some(data.get(..size)?.to_vec())
}

fn with_value(counter: u8, service: u8, command: u8, object: Object, value: &[u8], size: usize) -> Vec<u8> {
    if let 1..=4 = value.len() {
        let unused = u8::try_from(4 - value.len()).unwrap_or(0);
        let mut data = [0; 4];
        data[..value.len()].copy_from_slice(value);
        return message(counter, service, command | unused << 2 | EXPEDITED | SIZED, object, &data, size);
    }
    let value = &value[..value.len().min(size.saturating_sub(HEAD + 4))];
    let mut data = u32::try_from(value.len()).unwrap_or(0).to_le_bytes().to_vec();
    data.extend_from_slice(value);
    message(counter, service, command | SIZED, object, &data, size)
}

fn message(counter: u8, service: u8, command: u8, object: Object, data: &[u8], size: usize) -> Vec<u8> {
    let mut bytes = vec![0; size.max(HEAD + data.len())];
    let length = u16::try_from(HEAD - MAILBOX + data.len()).unwrap_or(0);
    bytes[..2].copy_from_slice(&length.to_le_bytes());
    bytes[5] = COE | (counter & 7) << 4;
    bytes[7] = service << 4;
    bytes[8] = command;
    bytes[9..11].copy_from_slice(&object.index.to_le_bytes());
    bytes[11] = object.sub;
    bytes[HEAD..HEAD + data.len()].copy_from_slice(data);
    bytes
}
