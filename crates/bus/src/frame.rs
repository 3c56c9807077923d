//! A CAN frame, classic or FD.

/// Most bytes of a frame.
pub const MOST_BYTES: usize = 64;

/// A frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// Identifier: of 11 bits, or of 29 where it is larger or extended.
    pub id: u32,
    /// Whether the identifier has 29 bits.
    pub extended: bool,
    /// Whether it asks for the frame of this identifier, and has no data.
    pub remote: bool,
    /// Whether it is a frame of CAN FD.
    pub fd: bool,
    pub(crate) size: u8,
    pub(crate) bytes: [u8; MOST_BYTES],
}

impl Frame {
    /// A frame with data, cut off at [`MOST_BYTES`].
    pub fn new(id: u32, data: &[u8]) -> Self {
        let mut bytes = [0; MOST_BYTES];
        let size = data.len().min(MOST_BYTES);
        bytes[..size].copy_from_slice(&data[..size]);
        let counted = u8::try_from(size).unwrap_or(0);
        Self { id, extended: id > 0x7ff, remote: false, fd: false, size: counted, bytes }
    }

    /// A frame of CAN FD.
    pub fn fd(id: u32, data: &[u8]) -> Self {
        Self { fd: true, ..Self::new(id, data) }
    }

    /// Its data.
    pub fn data(&self) -> &[u8] {
        &self.bytes[..usize::from(self.size)]
    }
}
