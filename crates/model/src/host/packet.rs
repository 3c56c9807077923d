//! The bytes of a packet: fixed layout, little-endian, with version, sequence number and check sum.
//!
//! | offset | bytes | |
//! |---|---|---|
//! | 0 | 4 | `FFH2` from the host, `FFL1` from the loader: name and version |
//! | 4 | 4 | sequence number, unsigned |
//! | 8 | 4 | switches of the host, state of the loader: bits, unsigned |
//! | 12 | 4 each | numbers, single precision, in the order of [`FROM_HOST`] or [`TO_HOST`] |
//! | last | 4 | CRC-32 of all before (IEEE 802.3, as `zlib.crc32`) |
//!
//! Single precision has seven digits, more than any of these quantities; a packet is as good on a 32-bit target.

/// Numbers from the host: name, SI unit, smallest, largest, and what holds without a host.
pub const FROM_HOST: [(&str, &str, f32, f32, f32); HOST_NUMBERS] = [
    ("dynamic_pressure", "Pa", 0.0, 2e5, 0.0),
    ("spring_factor", "", 0.0, 20.0, 1.0),
    ("trim", "rad", -4.0, 4.0, 0.0),
    ("autopilot_position", "rad", -4.0, 4.0, 0.0),
    ("autopilot_force", "N", 0.0, 2000.0, 0.0),
    ("added_force", "N", -2000.0, 2000.0, 0.0),
    ("shaker", "", 0.0, 1.0, 0.0),
    ("pusher_force", "N", -2000.0, 2000.0, 0.0),
    ("trim_runaway_rate", "rad/s", -1.0, 1.0, 0.0),
    ("jam_force", "N", 0.0, 2000.0, 0.0),
    ("added_stiffness", "N m/rad", -1e5, 1e5, 0.0),
    ("added_damping", "N m s/rad", -1e4, 1e4, 0.0),
    ("true_airspeed", "m/s", 0.0, 2000.0, 0.0),
    ("angle_of_attack", "rad", -4.0, 4.0, 0.0),
    ("sideslip", "rad", -4.0, 4.0, 0.0),
    ("roll_rate", "rad/s", -20.0, 20.0, 0.0),
    ("pitch_rate", "rad/s", -20.0, 20.0, 0.0),
    ("yaw_rate", "rad/s", -20.0, 20.0, 0.0),
    ("load_factor", "", -50.0, 50.0, 1.0),
    ("mach", "", 0.0, 10.0, 0.0),
    ("tab", "rad", -2.0, 2.0, 0.0),
    ("flap", "rad", -2.0, 2.0, 0.0),
];

/// Numbers to the host: name and SI unit.
pub const TO_HOST: [(&str, &str); LOADER_NUMBERS] =
    [("angle", "rad"), ("rate", "rad/s"), ("force", "N"), ("neutral", "rad"), ("share", ""), ("host_share", "")];

/// How many numbers there are from the host.
pub const HOST_NUMBERS: usize = 22;
/// How many to it.
pub const LOADER_NUMBERS: usize = 6;
/// Bytes of a packet from the host.
pub const FROM_HOST_BYTES: usize = 16 + 4 * HOST_NUMBERS;
/// Bytes of a packet to it.
pub const TO_HOST_BYTES: usize = 16 + 4 * LOADER_NUMBERS;

/// Switches: bit by bit.
pub mod switches {
    /// The loader is to give its feel.
    pub const ACTIVE: u32 = 1;
    /// The autopilot is engaged.
    pub const AUTOPILOT: u32 = 1 << 1;
    /// The stick pusher pushes.
    pub const PUSHER: u32 = 1 << 2;
    /// Trained fault: the control is jammed where it is.
    pub const JAM: u32 = 1 << 3;
    /// Trained fault: the control is disconnected from the surface; no spring is left.
    pub const DISCONNECT: u32 = 1 << 4;
    /// Trained fault: hydraulic or electric power of the aircraft's own controls is lost: the hand moves the surface.
    pub const POWER_LOST: u32 = 1 << 5;
    /// Trained fault: the trim runs away.
    pub const TRIM_RUNAWAY: u32 = 1 << 6;
    /// The simulator stands still, or takes the aircraft elsewhere: its numbers hold, and come back slowly after it.
    pub const FREEZE: u32 = 1 << 7;
    /// The flight state is given: the hinge moment of the loader's surface acts.
    pub const FLIGHT: u32 = 1 << 8;
    /// All that there are.
    pub const ALL: u32 = (1 << 9) - 1;
}

/// What a host sends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FromHost {
    /// One more than in the packet before; wraps.
    pub sequence: u32,
    /// See [`switches`].
    pub switches: u32,
    /// In the order of [`FROM_HOST`].
    pub numbers: [f32; HOST_NUMBERS],
}

/// What a loader sends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToHost {
    /// One more than in the packet before; wraps.
    pub sequence: u32,
    /// State of the loader in the lowest byte, in the order of its states; function that stopped it in the next, from 1; bit 16 where the
    /// packet was refused since the loader cannot render its spring or damping.
    pub status: u32,
    /// In the order of [`TO_HOST`].
    pub numbers: [f32; LOADER_NUMBERS],
}

/// Why a packet is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refused {
    /// It has another length.
    Length,
    /// It begins with another name or version.
    Version,
    /// Its check sum is another.
    Checksum,
    /// There are switches that this version has not.
    Switches,
    /// This number is none, or out of its range.
    Number(usize),
}

impl FromHost {
    /// What holds without a host.
    pub fn none() -> Self {
        Self { sequence: 0, switches: 0, numbers: FROM_HOST.map(|(.., none)| none) }
    }

    /// Its bytes.
    pub fn encode(&self) -> [u8; FROM_HOST_BYTES] {
        let mut bytes = [0; FROM_HOST_BYTES];
        fill(&mut bytes, *b"FFH2", [self.sequence, self.switches], &self.numbers);
        bytes
    }

    /// What the bytes hold.
    ///
    /// # Errors
    /// If it is no such packet, or a number is out of its range: nothing is repaired.
    pub fn decode(bytes: &[u8]) -> Result<Self, Refused> {
        let mut numbers = [0.0; HOST_NUMBERS];
        let [sequence, switches] = take(bytes, *b"FFH2", &mut numbers)?;
        if switches & !switches::ALL != 0 {
            return Err(Refused::Switches);
        }
        let wrong = numbers.iter().zip(&FROM_HOST).position(|(x, (_, _, low, high, _))| !(*low..=*high).contains(x));
        wrong.map_or(Ok(Self { sequence, switches, numbers }), |k| Err(Refused::Number(k)))
    }

    /// Whether a switch is on.
    pub fn has(&self, switch: u32) -> bool {
        self.switches & switch != 0
    }
}

impl ToHost {
    /// Its bytes.
    pub fn encode(&self) -> [u8; TO_HOST_BYTES] {
        let mut bytes = [0; TO_HOST_BYTES];
        fill(&mut bytes, *b"FFL1", [self.sequence, self.status], &self.numbers);
        bytes
    }

    /// What the bytes hold.
    ///
    /// # Errors
    /// If it is no such packet.
    pub fn decode(bytes: &[u8]) -> Result<Self, Refused> {
        let mut numbers = [0.0; LOADER_NUMBERS];
        let [sequence, status] = take(bytes, *b"FFL1", &mut numbers)?;
        numbers
            .iter()
            .position(|x| !x.is_finite())
            .map_or(Ok(Self { sequence, status, numbers }), |k| Err(Refused::Number(k)))
    }
}

/// Whether `sequence` comes after `last`, less than half of all numbers before it.
pub fn is_newer(sequence: u32, last: u32) -> bool {
    (1..1 << 31).contains(&sequence.wrapping_sub(last))
}

fn fill(bytes: &mut [u8], name: [u8; 4], words: [u32; 2], numbers: &[f32]) {
    bytes[..4].copy_from_slice(&name);
    bytes[4..8].copy_from_slice(&words[0].to_le_bytes());
    bytes[8..12].copy_from_slice(&words[1].to_le_bytes());
    for (place, number) in bytes[12..].chunks_exact_mut(4).zip(numbers) {
        place.copy_from_slice(&number.to_le_bytes());
    }
    let end = bytes.len() - 4;
    let sum = crc32(&bytes[..end]);
    bytes[end..].copy_from_slice(&sum.to_le_bytes());
}

fn take(bytes: &[u8], name: [u8; 4], numbers: &mut [f32]) -> Result<[u32; 2], Refused> {
    if bytes.len() != 16 + 4 * numbers.len() {
        return Err(Refused::Length);
    }
    let word = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
    if word(0) != name {
        return Err(Refused::Version);
    }
    let end = bytes.len() - 4;
    if u32::from_le_bytes(word(end)) != crc32(&bytes[..end]) {
        return Err(Refused::Checksum);
    }
    for (k, number) in numbers.iter_mut().enumerate() {
        *number = f32::from_le_bytes(word(12 + 4 * k));
    }
    Ok([u32::from_le_bytes(word(4)), u32::from_le_bytes(word(8))])
}

/// CRC-32, IEEE 802.3: bits reversed, polynomial `EDB88320`, begun and ended with all bits turned.
pub fn crc32(bytes: &[u8]) -> u32 {
    let mut sum = u32::MAX;
    for &byte in bytes {
        sum ^= u32::from(byte);
        for _ in 0..8 {
            sum = if sum & 1 == 0 { sum >> 1 } else { (sum >> 1) ^ 0xEDB8_8320 };
        }
    }
    !sum
}
