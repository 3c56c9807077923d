//! An emulated slave: its states, its mailbox, its watchdog, and the device behind them.

use super::MOST_POSITION;
use super::controller::Controller;
use super::datagram::datagrams;
use super::mailbox::{Abort, Object, Request, answer};
use super::registers::{ERROR, INIT, OP, PRE_OP, SAFE_OP, TRIGGERS, WATCHDOG_CODE};
use super::sii::{self, Product};
use crate::drive::Shown;
use alloc::vec::Vec;

/// Codes of the application layer for a state that cannot be entered.
const NO_SUCH_CHANGE: u16 = 0x0011;
const NO_SUCH_STATE: u16 = 0x0012;
const BAD_MAILBOX: u16 = 0x0016;
const BAD_OUTPUTS: u16 = 0x001d;
const BAD_INPUTS: u16 = 0x001e;

/// Serial number of node 0, and by how much the clocks of two nodes differ, in ns.
const FIRST_SERIAL: u32 = 1000;
const APART_NS: u64 = 123_456_789;

/// Serial number of a node.
pub(crate) fn serial(node: u8) -> u32 {
    FIRST_SERIAL + u32::from(node)
}

/// What is behind a slave's controller.
pub trait Device {
    /// What it is.
    fn product(&self) -> Product;
    /// Bytes of outputs and inputs, as they are mapped.
    fn sizes(&self) -> [usize; 2];
    /// Value of an object.
    ///
    /// # Errors
    /// If it has no such object.
    fn upload(&self, object: Object, shown: &Shown) -> Result<Vec<u8>, Abort>;
    /// Writes a value; `mapping`: before process data begin.
    ///
    /// # Errors
    /// If it cannot be written.
    fn download(&mut self, object: Object, value: &[u8], mapping: bool) -> Result<(), Abort>;
    /// Takes outputs in OP.
    fn take(&mut self, outputs: &[u8], now_s: f64);
    /// Gives inputs.
    fn give(&self, inputs: &mut [u8], shown: &Shown);
    /// The slave is in another state than OP, by an error or not.
    fn stopped(&mut self, by_error: bool);
}

/// A slave with its device.
#[derive(Debug, Clone)]
pub struct Slave<D> {
    controller: Controller,
    pub(crate) device: D,
    state: u8,
    /// Whether the state came of an error that is not acknowledged.
    error: bool,
    written_s: f64,
    /// Its local time at the start, in ns.
    started_ns: u64,
}

impl<D: Device> Slave<D> {
    /// A slave in INIT, whose alias is its node's number where that is none of a position; the last of a line, or not.
    pub(crate) fn with(device: D, node: u8, last: bool) -> Self {
        let alias = if node > MOST_POSITION { node } else { 0 };
        Self {
            controller: Controller::new(sii::image(&device.product(), serial(node), alias), last),
            device,
            state: INIT,
            error: false,
            written_s: 0.0,
            started_ns: APART_NS * u64::from(node),
        }
    }

    /// Whether process data are exchanged.
    pub(crate) fn operational(&self) -> bool {
        self.state == OP
    }

    /// Enters a state; with a code by an error.
    pub(crate) fn enter(&mut self, state: u8, code: u16) {
        (self.state, self.error) = (state, code != 0);
        self.controller.set_state(state, code);
        if state != OP {
            self.device.stopped(code != 0);
        }
    }

    fn al_control(&mut self, now_s: f64) {
        let asked = self.controller.al_control();
        let (wanted, acknowledged) = (asked & 0x0f, asked & ERROR != 0);
        if self.error && !acknowledged {
            return;
        }
        let code = match (self.state, wanted) {
            (_, INIT) | (PRE_OP | SAFE_OP | OP, PRE_OP) | (SAFE_OP | OP, SAFE_OP) | (OP, OP) => 0,
            (INIT, PRE_OP) => self.check_mailbox(),
            (PRE_OP, SAFE_OP) => self.check_process_data(),
            (SAFE_OP, OP) => {
                self.written_s = now_s;
                0
            }
            (_, PRE_OP | SAFE_OP | OP) => NO_SUCH_CHANGE,
            _ => NO_SUCH_STATE,
        };
        self.enter(if code == 0 { wanted } else { self.state }, code);
    }

    fn check_mailbox(&self) -> u16 {
        let fits = (0..2).zip(sii::MANAGERS).all(|(number, (start, size, control))| {
            let manager = self.controller.manager(number);
            // The interrupt of the drive is nothing to the mailbox.
            (manager.active, manager.start, manager.size, manager.control & 0x0f) == (true, start, size, control & 0x0f)
        });
        if fits { 0 } else { BAD_MAILBOX }
    }

    fn check_process_data(&self) -> u16 {
        let fits = |number: u16, size: usize| {
            let manager = self.controller.manager(number);
            let (start, _, control) = sii::MANAGERS[usize::from(number)];
            let its = (manager.active, manager.start, usize::from(manager.size), manager.control & 0x0f);
            its == (true, start, size, control & 0x0f) || (size == 0 && !manager.active)
        };
        let [outputs, inputs] = self.device.sizes();
        match (fits(2, outputs), fits(3, inputs)) {
            (false, _) => BAD_OUTPUTS,
            (_, false) => BAD_INPUTS,
            _ => 0,
        }
    }

    fn message(&mut self, shown: &Shown) {
        let message = self.controller.take_message();
        if self.state < PRE_OP {
            return;
        }
        let Some((counter, object, request)) = Request::of(&message) else { return };
        let size = self.controller.message_size();
        let mapping = self.state == PRE_OP;
        let outcome = request.and_then(|request| match request {
            Request::Upload(object) => self.device.upload(object, shown).map(Some),
            Request::Download(object, value) => self.device.download(object, &value, mapping).map(|()| None),
        });
        let outcome = outcome.as_ref().map(Option::as_deref).map_err(|abort| *abort);
        self.controller.put_message(&answer(counter, object, outcome, size));
    }

    fn outputs(&mut self, now_s: f64) {
        self.written_s = now_s;
        if self.state == OP {
            let manager = self.controller.manager(2);
            self.device.take(self.controller.at(manager), now_s);
        }
    }

    /// Leaves OP where outputs are late.
    pub(crate) fn watch(&mut self, now_s: f64) {
        let manager = self.controller.manager(2);
        let triggers = manager.active && manager.control & TRIGGERS != 0;
        let late = self.controller.watchdog_s().is_some_and(|watchdog_s| now_s - self.written_s > watchdog_s);
        if self.state == OP && triggers && late {
            self.enter(SAFE_OP, WATCHDOG_CODE);
        }
    }

    /// Lets a frame through at a time in s, with its share changed; whether it had outputs for it.
    pub fn let_through(&mut self, frame: &mut [u8], shown: &Shown, now_s: f64) -> bool {
        self.watch(now_s);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time since the start")]
        let time_ns = self.started_ns + (1e9 * now_s) as u64;
        let mut commanded = false;
        for mut datagram in datagrams(frame) {
            if self.state >= SAFE_OP {
                let manager = self.controller.manager(3);
                self.device.give(self.controller.at(manager), shown);
            }
            let events = self.controller.pass(&mut datagram, time_ns);
            if events.al_control {
                self.al_control(now_s);
            }
            if events.mailbox {
                self.message(shown);
            }
            if events.outputs {
                self.outputs(now_s);
                commanded = true;
            }
        }
        commanded
    }
}
