//! A slave that answers as a drive of CiA 402: its states, its mailbox, its watchdog, the reaction to a fault.
//!
//! After a fault of the communication its motor is braked, unless the object 0x605E says 0; after one of the drive it turns freely. It
//! stays there until the fault is cleared.

use super::cia402::{COMMUNICATION, Power, RATED, TORQUE_MODE};
use super::controller::Controller;
use super::datagram::datagrams;
use super::dictionary::Dictionary;
use super::mailbox::{Request, answer};
use super::registers::{ERROR, INIT, OP, PRE_OP, SAFE_OP, TRIGGERS, WATCHDOG_CODE};
use super::sii;
use super::{MOST_POSITION, Units};
use crate::drive::{Action, Node, Shown};

/// Codes of the application layer for a state that cannot be entered.
const NO_SUCH_CHANGE: u16 = 0x0011;
const NO_SUCH_STATE: u16 = 0x0012;
const BAD_MAILBOX: u16 = 0x0016;
const BAD_OUTPUTS: u16 = 0x001d;
const BAD_INPUTS: u16 = 0x001e;

/// Serial number of node 0, and by how much the clocks of two nodes differ, in ns.
const FIRST_SERIAL: u32 = 1000;
const APART_NS: u64 = 123_456_789;

/// A slave.
#[derive(Debug, Clone)]
pub struct Slave {
    controller: Controller,
    dictionary: Dictionary,
    state: u8,
    /// Whether the state came of an error that is not acknowledged.
    error: bool,
    power: Power,
    /// Control word before the last one.
    before: u16,
    written_s: f64,
    /// Its local time at the start, in ns.
    started_ns: u64,
    power_s: f64,
    /// When it was switched on.
    switched_s: f64,
}

impl Slave {
    /// A slave in INIT, whose alias is its node's number where that is none of a position; the last of a line, or not.
    pub fn new(units: Units, node: u8, last: bool) -> Self {
        let serial = FIRST_SERIAL + u32::from(node);
        let alias = if node > MOST_POSITION { node } else { 0 };
        let dictionary = Dictionary::new(units, serial);
        Self {
            controller: Controller::new(sii::image(serial, alias), last),
            dictionary,
            state: INIT,
            error: false,
            power: Power::Disabled,
            before: 0,
            written_s: 0.0,
            started_ns: APART_NS * u64::from(node),
            power_s: 0.0,
            switched_s: 0.0,
        }
    }

    fn enter(&mut self, state: u8, code: u16) {
        (self.state, self.error) = (state, code != 0);
        self.controller.set_state(state, code);
        match self.power {
            Power::Enabled | Power::QuickStop if state != OP && code != 0 => self.trip(COMMUNICATION),
            Power::Fault => {}
            _ if state != OP => self.power = Power::Disabled,
            _ => {}
        }
    }

    fn trip(&mut self, error: u16) {
        (self.power, self.dictionary.error) = (Power::Fault, error);
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
            its == (true, start, size, control & 0x0f)
        };
        let [outputs, inputs] = self.dictionary.sizes();
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
            Request::Upload(object) => self.dictionary.upload(object, shown).map(Some),
            Request::Download(object, value) => self.dictionary.download(object, &value, mapping).map(|()| None),
        });
        let outcome = outcome.as_ref().map(Option::as_deref).map_err(|abort| *abort);
        self.controller.put_message(&answer(counter, object, outcome, size));
    }

    fn outputs(&mut self, now_s: f64) {
        self.written_s = now_s;
        if self.state != OP {
            return;
        }
        let manager = self.controller.manager(2);
        self.dictionary.take(self.controller.at(manager));
        let (was, next) = (self.power, self.power.next(self.dictionary.control, self.before));
        self.switched_s = if was == Power::SwitchedOn { self.switched_s } else { now_s };
        let waits = next == Power::Enabled && was == Power::SwitchedOn && now_s - self.switched_s < self.power_s;
        self.power = if waits { was } else { next };
        self.before = self.dictionary.control;
        if self.power != Power::Fault {
            self.dictionary.error = 0;
        }
    }

    fn watch(&mut self, now_s: f64) {
        let triggers = self.controller.manager(2).control & TRIGGERS != 0;
        let late = self.controller.watchdog_s().is_some_and(|watchdog_s| now_s - self.written_s > watchdog_s);
        if self.state == OP && triggers && late {
            self.enter(SAFE_OP, WATCHDOG_CODE);
        }
    }
}

impl Node for Slave {
    fn pass(&mut self, frame: &mut [u8], shown: &Shown, now_s: f64) -> bool {
        self.watch(now_s);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a time since the start")]
        let time_ns = self.started_ns + (1e9 * now_s) as u64;
        let mut commanded = false;
        for mut datagram in datagrams(frame) {
            if self.state >= SAFE_OP {
                self.dictionary.status = self.power.status();
                let manager = self.controller.manager(3);
                self.dictionary.give(self.controller.at(manager), shown);
            }
            let events = self.controller.pass(&mut datagram, time_ns);
            if events.al_control {
                self.al_control(now_s);
            }
            if events.mailbox {
                self.dictionary.status = self.power.status();
                self.message(shown);
            }
            if events.outputs {
                self.outputs(now_s);
                commanded = true;
            }
        }
        commanded
    }

    fn action(&mut self, now_s: f64) -> Action {
        self.watch(now_s);
        let braked = self.dictionary.error == COMMUNICATION && self.dictionary.reaction != 0;
        match self.power {
            Power::Enabled if self.dictionary.mode == TORQUE_MODE => {
                Action::Torque(f64::from(self.dictionary.target) / RATED * self.dictionary.units.rated_torque)
            }
            Power::QuickStop => Action::Damp,
            Power::Fault if braked => Action::Damp,
            _ => Action::Free,
        }
    }

    fn fail(&mut self, code: u16) {
        if code == 0 { (self.power, self.dictionary.error) = (Power::Disabled, 0) } else { self.trip(code) }
    }

    fn delay_power(&mut self, power_s: f64) {
        self.power_s = power_s;
    }
}
