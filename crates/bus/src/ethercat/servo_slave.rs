//! A slave that answers as a drive of CiA 402: its power, its reaction to a fault.
//!
//! After a fault of the communication its motor is braked, unless the object 0x605E says 0; after one of the drive it turns freely. It
//! stays there until the fault is cleared.

use super::Units;
use super::cia402::{COMMUNICATION, Power, RATED, TORQUE_MODE};
use super::dictionary::{Dictionary, NAME, PRODUCT};
use super::mailbox::{Abort, Object};
use super::sii::Product;
use super::slave::{Device, Slave, serial};
use crate::drive::{Action, Node, Shown};
use alloc::vec::Vec;

/// A drive behind its slave's controller.
#[derive(Debug, Clone)]
pub struct ServoDevice {
    dictionary: Dictionary,
    power: Power,
    /// Control word before the last one.
    before: u16,
    /// Time that it takes to act, and when it was switched on, in s.
    power_s: f64,
    switched_s: f64,
}

/// A slave with a drive.
pub type ServoSlave = Slave<ServoDevice>;

impl ServoSlave {
    /// A slave in INIT; the last of a line, or not.
    pub fn new(units: Units, node: u8, last: bool) -> Self {
        let mut dictionary = Dictionary::new(units, serial(node));
        dictionary.status = Power::Disabled.status();
        let device = ServoDevice { dictionary, power: Power::Disabled, before: 0, power_s: 0.0, switched_s: 0.0 };
        Self::with(device, node, last)
    }
}

impl ServoDevice {
    fn trip(&mut self, error: u16) {
        (self.power, self.dictionary.error) = (Power::Fault, error);
        self.dictionary.status = self.power.status();
    }

    fn set(&mut self, power: Power) {
        self.power = power;
        self.dictionary.status = power.status();
    }
}

impl Device for ServoDevice {
    fn product(&self) -> Product {
        Product { name: NAME, code: PRODUCT, sizes: [5, 13] }
    }

    fn sizes(&self) -> [usize; 2] {
        self.dictionary.sizes()
    }

    fn upload(&self, object: Object, shown: &Shown) -> Result<Vec<u8>, Abort> {
        self.dictionary.upload(object, shown)
    }

    fn download(&mut self, object: Object, value: &[u8], mapping: bool) -> Result<(), Abort> {
        self.dictionary.download(object, value, mapping)
    }

    fn take(&mut self, outputs: &[u8], now_s: f64) {
        self.dictionary.take(outputs);
        let (was, next) = (self.power, self.power.next(self.dictionary.control, self.before));
        self.switched_s = if was == Power::SwitchedOn { self.switched_s } else { now_s };
        let waits = next == Power::Enabled && was == Power::SwitchedOn && now_s - self.switched_s < self.power_s;
        self.set(if waits { was } else { next });
        self.before = self.dictionary.control;
        if self.power != Power::Fault {
            self.dictionary.error = 0;
        }
    }

    fn give(&self, inputs: &mut [u8], shown: &Shown) {
        self.dictionary.give(inputs, shown);
    }

    fn stopped(&mut self, by_error: bool) {
        match self.power {
            Power::Enabled | Power::QuickStop if by_error => self.trip(COMMUNICATION),
            Power::Fault => {}
            _ => self.set(Power::Disabled),
        }
    }
}

impl Node for ServoSlave {
    fn pass(&mut self, frame: &mut [u8], shown: &Shown, now_s: f64) -> bool {
        self.let_through(frame, shown, now_s)
    }

    fn action(&mut self, now_s: f64) -> Action {
        self.watch(now_s);
        let device = &self.device;
        let braked = device.dictionary.error == COMMUNICATION && device.dictionary.reaction != 0;
        match device.power {
            Power::Enabled if device.dictionary.mode == TORQUE_MODE => {
                Action::Torque(f64::from(device.dictionary.target) / RATED * device.dictionary.units.rated_torque)
            }
            Power::QuickStop => Action::Damp,
            Power::Fault if braked => Action::Damp,
            _ => Action::Free,
        }
    }

    fn fail(&mut self, code: u16) {
        if code == 0 {
            self.device.dictionary.error = 0;
            self.device.set(Power::Disabled);
        } else {
            self.device.trip(code);
        }
    }

    fn delay_power(&mut self, power_s: f64) {
        self.device.power_s = power_s;
    }
}
