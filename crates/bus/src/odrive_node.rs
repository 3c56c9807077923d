//! A node that answers as an ODrive, with the sensor board beside it: torque mode, heartbeat, watchdog, errors.
//!
//! Once the watchdog has run out, or an error has come, its motor turns freely until errors are cleared and its state is asked for again.

use crate::drive::{Action, Node, Send, Shown};
use crate::frame::Frame;
use crate::odrive::{
    ADDRESS, CLEAR, CLOSED_LOOP, ERRORS, ESTIMATES, Firmware, HEARTBEAT, IDLE, SENSORS, SET_MODE, SET_STATE,
    SET_TORQUE, TORQUE_MODE, TURN, VERSION, frame,
};

/// `axis.config.watchdog_timeout`.
const TIMEOUT_S: f64 = 0.1;
/// `can.heartbeat_msg_rate_ms`.
const HEARTBEAT_S: f64 = 0.1;

/// A node.
#[derive(Debug, Clone)]
pub struct OdriveNode {
    number: u8,
    firmware: Firmware,
    serial: i32,
    state: u8,
    error: u32,
    torque_mode: bool,
    torque: f64,
    commanded_s: f64,
    beaten_s: f64,
    power_s: f64,
    /// When it is to be in closed loop, if it is on its way there.
    ready_s: Option<f64>,
}

impl OdriveNode {
    /// A node that is idle.
    pub fn new(number: u8, firmware: Firmware, serial: i32) -> Self {
        Self {
            number,
            firmware,
            serial,
            state: IDLE,
            error: 0,
            torque_mode: false,
            torque: 0.0,
            commanded_s: 0.0,
            beaten_s: f64::NEG_INFINITY,
            power_s: 0.0,
            ready_s: None,
        }
    }

    fn disarm(&mut self, error: u32) {
        self.error |= error;
        (self.state, self.ready_s) = (IDLE, None);
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a drive has numbers of 32 bits; shares are of their range, an angle of its turn"
    )]
    fn answer(&self, command: u32, shown: &Shown) -> Option<Frame> {
        let version = [2, 4, 4, 58, 0, 6, 11, 0];
        match command {
            VERSION if self.firmware == Firmware::Six => Some(frame(self.number, VERSION, &version)),
            ADDRESS if self.firmware == Firmware::Six => {
                let [a, b, c, d] = self.serial.to_le_bytes();
                Some(frame(self.number, ADDRESS, &[self.number, a, b, c, d, 0, 0, 0]))
            }
            ERRORS => Some(frame(self.number, ERRORS, self.error.to_le_bytes().as_slice())),
            ESTIMATES => {
                let [position, velocity] = [shown.position as f32, shown.velocity as f32].map(f32::to_le_bytes);
                Some(frame(self.number, ESTIMATES, [position, velocity].as_flattened()))
            }
            SENSORS => {
                let [load_cell, column, grip] = shown.sensors;
                let share = |share: f64| ((share * f64::from(u16::MAX) + 0.5) as u16).to_le_bytes();
                let turned = (column * TURN) as i64 as u32;
                let ([a, b], [c, d], [e, f, g, h]) = (share(load_cell), share(grip), turned.to_le_bytes());
                Some(Frame::new(SENSORS | u32::from(self.number), &[a, b, c, d, e, f, g, h]))
            }
            _ => None,
        }
    }
}

impl Node for OdriveNode {
    fn take(&mut self, came: &Frame, shown: &Shown, now_s: f64, send: Send) -> bool {
        let board = came.id == SENSORS | u32::from(self.number);
        if came.extended || !(board || came.id >> 5 == u32::from(self.number)) {
            return false;
        }
        let command = if board { SENSORS } else { came.id & 0x1f };
        if came.remote {
            if let Some(answer) = self.answer(command, shown) {
                send(&answer);
            }
            // A machine without a clock goes on as its state is asked for.
            return command == ESTIMATES;
        }
        match (command, came.data()) {
            (SET_STATE, &[state, 0, 0, 0]) if state == IDLE || (state == CLOSED_LOOP && self.error == 0) => {
                self.ready_s = (state == CLOSED_LOOP && self.power_s > 0.0).then_some(now_s + self.power_s);
                self.state = if self.ready_s.is_some() { IDLE } else { state };
                self.commanded_s = now_s;
            }
            (SET_STATE, _) => self.error |= 1,
            (SET_MODE, data) => self.torque_mode = data == TORQUE_MODE,
            (SET_TORQUE, &[a, b, c, d]) => {
                (self.torque, self.commanded_s) = (f64::from(f32::from_le_bytes([a, b, c, d])), now_s);
            }
            (CLEAR, _) => self.error = 0,
            _ => {}
        }
        false
    }

    fn tick(&mut self, now_s: f64, send: Send) {
        // The time of a machine without a clock of its own falls back once commands come.
        if (now_s - self.beaten_s).abs() >= HEARTBEAT_S {
            self.beaten_s = now_s;
            let [a, b, c, d] = self.error.to_le_bytes();
            send(&frame(self.number, HEARTBEAT, &[a, b, c, d, self.state, 0, 0, 0]));
        }
    }

    fn action(&mut self, now_s: f64) -> Action {
        if self.ready_s.is_some_and(|ready_s| ready_s <= now_s) {
            (self.state, self.ready_s) = (CLOSED_LOOP, None);
        }
        if self.state == CLOSED_LOOP && now_s - self.commanded_s > TIMEOUT_S {
            self.disarm(self.firmware.watchdog());
        }
        if self.state == CLOSED_LOOP && self.torque_mode { Action::Torque(self.torque) } else { Action::Free }
    }

    fn fail(&mut self, code: u16) {
        if code == 0 {
            (self.error, self.state) = (0, IDLE);
        } else {
            self.disarm(1 << (code % 32));
        }
    }

    fn delay_power(&mut self, power_s: f64) {
        self.power_s = power_s;
    }
}
