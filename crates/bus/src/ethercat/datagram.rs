//! EtherCAT frames: datagrams one after another behind an Ethernet head, changed by each slave on their way (ETG.1000.4).
//!
//! `cmd u8, idx u8, address u32, length u16 (bit 15: another follows), irq u16, data, working counter u16`, all little-endian.

/// Type of an Ethernet frame.
pub const ETHERTYPE: u16 = 0x88a4;
/// Most bytes of a frame.
pub const MOST: usize = 1514;
/// Least bytes of a frame.
const LEAST: usize = 60;
/// Ethernet's head and EtherCAT's, that of a datagram, and its working counter.
const HEAD: usize = 16;
const DATAGRAM: usize = 10;
const COUNTER: usize = 2;
/// Bits of a length.
const LENGTH: u16 = 0x7ff;
const FOLLOWS: u16 = 0x8000;

/// Commands: by position, by station address, of all, of logical addresses; the last two read one slave and write the others.
pub mod command {
    #![expect(missing_docs, reason = "names of the standard")]
    pub const APRD: u8 = 1;
    pub const APWR: u8 = 2;
    pub const APRW: u8 = 3;
    pub const FPRD: u8 = 4;
    pub const FPWR: u8 = 5;
    pub const FPRW: u8 = 6;
    pub const BRD: u8 = 7;
    pub const BWR: u8 = 8;
    pub const BRW: u8 = 9;
    pub const LRD: u8 = 10;
    pub const LWR: u8 = 11;
    pub const LRW: u8 = 12;
    pub const ARMW: u8 = 13;
    pub const FRMW: u8 = 14;
}

/// A frame that is made up, sent, and read when it comes back.
#[derive(Debug, Clone)]
pub struct Packet {
    /// Its bytes; those behind its end are zero.
    pub bytes: [u8; MOST],
    end: usize,
    last: Option<usize>,
}

impl Default for Packet {
    fn default() -> Self {
        Self::new()
    }
}

impl Packet {
    /// A frame without datagrams, to all, from an address that no maker has.
    pub fn new() -> Self {
        let mut bytes = [0; MOST];
        bytes[..6].fill(0xff);
        bytes[6] = 0x05;
        bytes[12..14].copy_from_slice(&ETHERTYPE.to_be_bytes());
        Self { bytes, end: HEAD, last: None }
    }

    /// A frame with one datagram.
    pub fn of(command: u8, index: u8, address: u32, data: &[u8]) -> Self {
        let mut packet = Self::new();
        packet.put(command, index, address, data);
        packet
    }

    /// Adds a datagram; one that has no room is left out.
    pub fn put(&mut self, command: u8, index: u8, address: u32, data: &[u8]) {
        let (start, size) = (self.end, data.len());
        let end = start + DATAGRAM + size + COUNTER;
        if end > MOST {
            return;
        }
        let datagram = &mut self.bytes[start..end];
        datagram.fill(0);
        datagram[..2].copy_from_slice(&[command, index]);
        datagram[2..6].copy_from_slice(&address.to_le_bytes());
        datagram[6..8].copy_from_slice(&length(size).to_le_bytes());
        datagram[DATAGRAM..DATAGRAM + size].copy_from_slice(data);
        if let Some(last) = self.last {
            self.bytes[last + 7] |= (FOLLOWS >> 8).to_le_bytes()[0];
        }
        (self.end, self.last) = (end, Some(start));
        let whole = length(end - HEAD) | 0x1000;
        self.bytes[14..16].copy_from_slice(&whole.to_le_bytes());
    }

    /// Command and number of the first datagram.
    pub fn first(&self) -> [u8; 2] {
        [self.bytes[HEAD], self.bytes[HEAD + 1]]
    }

    /// Gives the first datagram another number.
    pub fn renumber(&mut self, index: u8) {
        self.bytes[HEAD + 1] = index;
    }

    /// The bytes that are sent.
    pub fn sent(&self) -> &[u8] {
        &self.bytes[..self.end.max(LEAST)]
    }
}

fn length(size: usize) -> u16 {
    u16::try_from(size).unwrap_or(0) & LENGTH
}

/// Station or position, and the address within the slave, as one address.
pub fn at(slave: u16, register: u16) -> u32 {
    u32::from(register) << 16 | u32::from(slave)
}

/// A datagram of a frame.
#[derive(Debug)]
pub struct Datagram<'a> {
    /// What is asked.
    pub command: u8,
    /// The master's number of it.
    pub index: u8,
    /// Where.
    pub address: &'a mut [u8; 4],
    /// What is written, or has been read.
    pub data: &'a mut [u8],
    counter: &'a mut [u8; 2],
}

impl Datagram<'_> {
    /// Station or position.
    pub fn slave(&self) -> u16 {
        u16::from_le_bytes([self.address[0], self.address[1]])
    }

    /// Address within the slave.
    pub fn register(&self) -> u16 {
        u16::from_le_bytes([self.address[2], self.address[3]])
    }

    /// Logical address.
    pub fn logical(&self) -> u32 {
        u32::from_le_bytes(*self.address)
    }

    /// The working counter.
    pub fn counter(&self) -> u16 {
        u16::from_le_bytes(*self.counter)
    }

    /// Adds to the working counter.
    pub fn count(&mut self, more: u16) {
        *self.counter = self.counter().wrapping_add(more).to_le_bytes();
    }
}

/// The datagrams of a frame; none of one that is no frame of EtherCAT, and none from where it is damaged.
pub fn datagrams(frame: &mut [u8]) -> Datagrams<'_> {
    let head = frame.get(12..HEAD).and_then(<[u8]>::first_chunk::<4>).copied();
    let rest = match head {
        Some([0x88, 0xa4, low, high]) if high >> 4 == 1 => {
            let size = usize::from(u16::from_le_bytes([low, high]) & LENGTH);
            frame.get_mut(HEAD..HEAD + size).unwrap_or_default()
        }
        _ => &mut [],
    };
    Datagrams { rest }
}

/// Datagrams one after another.
#[derive(Debug)]
pub struct Datagrams<'a> {
    rest: &'a mut [u8],
}

impl<'a> Iterator for Datagrams<'a> {
    type Item = Datagram<'a>;

    fn next(&mut self) -> Option<Datagram<'a>> {
        let (head, rest) = core::mem::take(&mut self.rest).split_at_mut_checked(DATAGRAM)?;
        let bits = u16::from_le_bytes([head[6], head[7]]);
        let (data, rest) = rest.split_at_mut_checked(usize::from(bits & LENGTH))?;
        let (counter, rest) = rest.split_first_chunk_mut::<COUNTER>()?;
        self.rest = if bits & FOLLOWS == 0 { &mut [] } else { rest };
        let (words, address) = head[..6].split_first_chunk_mut::<2>()?;
        Some(Datagram { command: words[0], index: words[1], address: address.first_chunk_mut()?, data, counter })
    }
}
