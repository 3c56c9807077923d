//! What an MCAP file is made of (<https://mcap.dev/spec>): records, each a code, its length in eight bytes and so many bytes.

/// What a file begins and ends with.
pub const MAGIC: [u8; 8] = [0x89, b'M', b'C', b'A', b'P', b'0', b'\r', b'\n'];

/// Codes of records.
pub mod op {
    /// What wrote the file.
    pub const HEADER: u8 = 1;
    /// Where the summary is.
    pub const FOOTER: u8 = 2;
    /// What messages of a kind consist of.
    pub const SCHEMA: u8 = 3;
    /// A topic with its schema.
    pub const CHANNEL: u8 = 4;
    /// A message on a channel.
    pub const MESSAGE: u8 = 5;
    /// Records with their check sum.
    pub const CHUNK: u8 = 6;
    /// Where the messages of a channel stand in the chunk before.
    pub const MESSAGE_INDEX: u8 = 7;
    /// Where a chunk stands.
    pub const CHUNK_INDEX: u8 = 8;
    /// How much of everything there is.
    pub const STATISTICS: u8 = 11;
    /// Texts by name.
    pub const METADATA: u8 = 12;
    /// Where they stand.
    pub const METADATA_INDEX: u8 = 13;
    /// Where records of a kind stand in the summary.
    pub const SUMMARY_OFFSET: u8 = 14;
    /// The end of all but the summary.
    pub const DATA_END: u8 = 15;
    /// A record of a program's own, which readers skip.
    pub const OWN: u8 = 0x80;
}
