//! The objects of an emulated drive, and what of them goes into its process data.

use super::cia402::{RATED, TORQUE_MODE, TORQUE_MODE_BIT, object};
use super::mailbox::{Abort, Object};
use super::{ENCODER, Units, nearest};
use crate::drive::Shown;
use alloc::vec;
use alloc::vec::Vec;

/// Objects of the map that the master writes, of that which it reads, and of their sync managers.
pub const OUTPUTS: u16 = 0x1600;
pub const INPUTS: u16 = 0x1a00;
pub const ASSIGNED: [u16; 2] = [0x1c12, 0x1c13];
const MANAGER_KINDS: u16 = 0x1c00;
/// Name and product code of the emulated drive.
pub const NAME: &str = "forcefeel emulated drive";
pub const PRODUCT: u32 = 402;
/// Most objects of a map.
const MOST: usize = 12;

/// Values that the master or the drive writes.
#[derive(Debug, Clone)]
pub(crate) struct Dictionary {
    pub units: Units,
    pub serial: u32,
    pub status: u16,
    pub error: u16,
    pub control: u16,
    pub mode: u8,
    pub target: i16,
    /// Zero: the motor turns freely after a fault; otherwise it is braked.
    pub reaction: i16,
    /// Outputs and inputs, each object as in the standard: index, sub-index, bits; how many count.
    maps: [(Vec<u32>, usize); 2],
    assigned: [bool; 2],
}

/// An object as a map has it.
pub const fn mapped(object: Object, bits: u32) -> u32 {
    (object.index as u32) << 16 | (object.sub as u32) << 8 | bits
}

impl Dictionary {
    pub fn new(units: Units, serial: u32) -> Self {
        let default = [
            vec![mapped(object::CONTROL, 16), mapped(object::TARGET_TORQUE, 16), mapped(object::MODE, 8)],
            vec![mapped(object::STATUS, 16), mapped(object::POSITION, 32)],
        ];
        Self {
            units,
            serial,
            status: 0,
            error: 0,
            control: 0,
            mode: 0,
            target: 0,
            reaction: 2,
            maps: default.map(|map| (map.clone(), map.len())),
            assigned: [true; 2],
        }
    }

    /// Little-endian value of an object, and whether it may be mapped.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number of mN m")]
    fn value(&self, of: Object, shown: &Shown) -> Option<(Vec<u8>, bool)> {
        let Units { rated_torque, counts, .. } = self.units;
        let analog = |raw: i32| (raw.clamp(-32768, 32767) as i16).to_le_bytes().to_vec();
        if let Some(place) = (0..3).find(|&place| self.units.own(place) == Some(of)) {
            let raw = self.units.raw(place, shown.sensors[place]);
            return Some((if place == ENCODER { raw.to_le_bytes().to_vec() } else { analog(raw) }, true));
        }
        let fixed = |bytes: &[u8]| Some((bytes.to_vec(), false));
        let live = |bytes: &[u8]| Some((bytes.to_vec(), true));
        match of {
            object::ERROR_CODE => live(&self.error.to_le_bytes()),
            object::CONTROL => live(&self.control.to_le_bytes()),
            object::STATUS => live(&self.status.to_le_bytes()),
            object::FAULT_REACTION => fixed(&self.reaction.to_le_bytes()),
            object::MODE | object::MODE_DISPLAY => live(&[self.mode]),
            object::POSITION => live(&nearest(shown.position * counts).to_le_bytes()),
            object::VELOCITY => live(&nearest(shown.velocity * counts).to_le_bytes()),
            object::TARGET_TORQUE => live(&self.target.to_le_bytes()),
            object::RATED_TORQUE => fixed(&((1000.0 * rated_torque + 0.5) as u32).to_le_bytes()),
            object::TORQUE => live(&analog(nearest(shown.torque / rated_torque * RATED))),
            object::SUPPORTED_MODES => fixed(&TORQUE_MODE_BIT.to_le_bytes()),
            // A servo drive by the profile 402.
            Object { index: 0x1000, sub: 0 } => fixed(&0x0002_0192_u32.to_le_bytes()),
            Object { index: 0x1001, sub: 0 } => fixed(&[u8::from(self.error != 0)]),
            Object { index: 0x1008, sub: 0 } => fixed(NAME.as_bytes()),
            Object { index: 0x1018, sub } => match sub {
                0 => fixed(&[4]),
                1 => fixed(&0_u32.to_le_bytes()),
                2 => fixed(&PRODUCT.to_le_bytes()),
                3 => fixed(&1_u32.to_le_bytes()),
                4 => fixed(&self.serial.to_le_bytes()),
                _ => None,
            },
            Object { index: MANAGER_KINDS, sub: 0 } => fixed(&[4]),
            Object { index: MANAGER_KINDS, sub: sub @ 1..=4 } => fixed(&[sub]),
            Object { index, sub } => {
                if let Some(place) = ASSIGNED.iter().position(|assigned| *assigned == index) {
                    return match sub {
                        0 => fixed(&[u8::from(self.assigned[place])]),
                        1 => fixed(&[OUTPUTS, INPUTS][place].to_le_bytes()),
                        _ => None,
                    };
                }
                let (map, count) = &self.maps[[OUTPUTS, INPUTS].iter().position(|map| *map == index)?];
                let entry = map.get(usize::from(sub).wrapping_sub(1));
                if sub == 0 { fixed(&[u8::try_from(*count).unwrap_or(0)]) } else { fixed(&entry?.to_le_bytes()) }
            }
        }
    }

    /// Value of an object.
    pub fn upload(&self, of: Object, shown: &Shown) -> Result<Vec<u8>, Abort> {
        self.value(of, shown).map(|(value, _)| value).ok_or(Abort::MISSING)
    }

    /// Writes a value: the maps only before process data begin.
    pub fn download(&mut self, to: Object, value: &[u8], mapping: bool) -> Result<(), Abort> {
        let map = [OUTPUTS, INPUTS].iter().position(|map| *map == to.index);
        let assigned = ASSIGNED.iter().position(|assigned| *assigned == to.index);
        if (map.is_some() || assigned.is_some()) && !mapping {
            return Err(Abort::STATE);
        }
        if let Some(place) = assigned {
            return self.assign(place, to.sub, value);
        }
        if let Some(place) = map {
            return self.map(place, to.sub, value);
        }
        match (to, value) {
            (object::CONTROL, &[low, high]) => self.control = u16::from_le_bytes([low, high]),
            (object::MODE, &[mode]) if mode == 0 || mode == TORQUE_MODE => self.mode = mode,
            (object::MODE, &[_]) => return Err(Abort::VALUE),
            (object::TARGET_TORQUE, &[low, high]) => self.target = i16::from_le_bytes([low, high]),
            (object::FAULT_REACTION, &[low, high]) => self.reaction = i16::from_le_bytes([low, high]),
            (object::CONTROL | object::MODE | object::TARGET_TORQUE | object::FAULT_REACTION, _) => {
                return Err(Abort::SIZE);
            }
            (other, _) => {
                return Err(if self.value(other, &Shown::default()).is_some() {
                    Abort::READ_ONLY
                } else {
                    Abort::MISSING
                });
            }
        }
        Ok(())
    }

    fn assign(&mut self, place: usize, sub: u8, value: &[u8]) -> Result<(), Abort> {
        match (sub, value) {
            (0, &[count @ 0..=1]) => self.assigned[place] = count == 1,
            (0, &[_]) => return Err(Abort::VALUE),
            (1, &[low, high]) => {
                if u16::from_le_bytes([low, high]) != [OUTPUTS, INPUTS][place] {
                    return Err(Abort::VALUE);
                }
            }
            (0 | 1, _) => return Err(Abort::SIZE),
            _ => return Err(Abort::MISSING),
        }
        Ok(())
    }

    fn map(&mut self, place: usize, sub: u8, value: &[u8]) -> Result<(), Abort> {
        let sub = usize::from(sub);
        if sub == 0 {
            let &[count] = value else { return Err(Abort::SIZE) };
            let (map, counted) = &mut self.maps[place];
            if usize::from(count) > map.len() {
                return Err(Abort::VALUE);
            }
            *counted = usize::from(count);
            return Ok(());
        }
        let entry = value.try_into().map(u32::from_le_bytes).map_err(|_| Abort::SIZE)?;
        let of = object_of(entry);
        let Some((bytes, true)) = self.value(of, &Shown::default()) else { return Err(Abort::NOT_MAPPABLE) };
        let written = [object::CONTROL, object::MODE, object::TARGET_TORQUE].contains(&of);
        if 8 * bytes.len() != usize::try_from(entry & 0xff).unwrap_or(0) || (place == 0 && !written) {
            return Err(Abort::NOT_MAPPABLE);
        }
        let (map, counted) = &mut self.maps[place];
        if *counted != 0 || sub > MOST || sub > map.len() + 1 {
            return Err(Abort::STATE);
        }
        map.truncate(sub - 1);
        map.push(entry);
        Ok(())
    }

    fn entries(&self, place: usize) -> impl Iterator<Item = u32> {
        let (map, count) = &self.maps[place];
        map.iter().take(if self.assigned[place] { *count } else { 0 }).copied()
    }

    /// Bytes of outputs and inputs.
    pub fn sizes(&self) -> [usize; 2] {
        [0, 1].map(|place| self.entries(place).map(|entry| usize::from(entry.to_le_bytes()[0]) / 8).sum())
    }

    /// Takes outputs.
    pub fn take(&mut self, mut data: &[u8]) {
        for entry in self.entries(0).collect::<Vec<_>>() {
            let Some((value, rest)) = data.split_at_checked(usize::from(entry.to_le_bytes()[0]) / 8) else { return };
            // A mode that is not there is left out, as the drive's display of it shows.
            let _ = self.download(object_of(entry), value, false);
            data = rest;
        }
    }

    /// Inputs.
    pub fn give(&self, to: &mut [u8], shown: &Shown) {
        let inputs = self.entries(1).filter_map(|entry| self.value(object_of(entry), shown));
        to.iter_mut().zip(inputs.flat_map(|(value, _)| value)).for_each(|(to, byte)| *to = byte);
    }
}

fn object_of(entry: u32) -> Object {
    let [_, sub, low, high] = entry.to_le_bytes();
    Object::new(u16::from_le_bytes([low, high]), sub)
}
