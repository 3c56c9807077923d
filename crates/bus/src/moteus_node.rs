//! A node that answers as a moteus: its registers for torque mode, its watchdog, its faults.
//!
//! It stops, brakes and gives a feed-forward torque; a position or a velocity is not held. A write is taken before what the same frame
//! reads. After a time without a command, by register 0x027 or the default of `servo.default_timeout_s`, it damps in mode 11.

use crate::drive::{ALL_NODES, Action, Node, Send, Shown};
use crate::frame::Frame;
use crate::moteus::SENSORS;
use moteus_protocol::{
    CURRENT_REGISTER_MAP_VERSION, CanFdFrame, Mode, Register, Resolution, Scaling, Subframe, Value, WriteCanData,
    calculate_arbitration_id, parse_arbitration_id, parse_frame, scaling,
};

/// `servo.default_timeout_s`.
const TIMEOUT_S: f64 = 0.1;

/// A node.
#[derive(Debug, Clone)]
pub struct MoteusNode {
    number: u8,
    serial: i32,
    mode: Mode,
    fault: u16,
    torque: f64,
    timeout_s: f64,
    commanded_s: f64,
    started_s: Option<f64>,
    power_s: f64,
    enabled_s: f64,
}

impl MoteusNode {
    /// A node that is stopped.
    pub fn new(number: u8, serial: i32) -> Self {
        Self {
            number,
            serial,
            mode: Mode::Stopped,
            fault: 0,
            torque: 0.0,
            timeout_s: TIMEOUT_S,
            commanded_s: 0.0,
            started_s: None,
            power_s: 0.0,
            enabled_s: 0.0,
        }
    }

    fn write(&mut self, register: u16, value: Value, now_s: f64) {
        match Register::from_address(register) {
            Some(Register::Mode) => self.enter(value.to_i32(), now_s),
            Some(Register::CommandFeedforwardTorque) => self.torque = f64::from(value.to_f32(&scaling::TORQUE)),
            Some(Register::CommandTimeout) => {
                let timeout = f64::from(value.to_f32(&scaling::TIME));
                self.timeout_s = if timeout.is_nan() { TIMEOUT_S } else { timeout };
            }
            _ => {}
        }
    }

    /// Enters a mode: out of a fault or a timeout only by a stop.
    fn enter(&mut self, mode: i32, now_s: f64) {
        let Some(mode) = u8::try_from(mode).ok().and_then(|mode| Mode::try_from(mode).ok()) else { return };
        // What a command leaves out has its default.
        (self.torque, self.timeout_s) = (0.0, TIMEOUT_S);
        match mode {
            Mode::Stopped => (self.mode, self.fault) = (mode, 0),
            Mode::Position if self.mode == Mode::Stopped && self.power_s > 0.0 => {
                (self.mode, self.enabled_s) = (Mode::Enabling, now_s);
            }
            Mode::Position if self.mode == Mode::Enabling => {}
            Mode::Position | Mode::Brake if !self.mode.is_error() => self.mode = mode,
            _ => {}
        }
    }

    fn read(&self, register: u16, shown: &Shown, now_s: f64) -> Option<(f64, Scaling)> {
        let serial = f64::from(self.serial);
        let register = Register::from_address(register)?;
        let number = match register {
            Register::Mode => (f64::from(u8::from(self.mode)), scaling::INT),
            Register::Position | Register::Encoder0Position => (shown.position, scaling::POSITION),
            Register::Velocity => (shown.velocity, scaling::VELOCITY),
            Register::Torque => (shown.torque, scaling::TORQUE),
            Register::CommandFeedforwardTorque => (self.torque, scaling::TORQUE),
            Register::CommandTimeout => (self.timeout_s, scaling::TIME),
            Register::Fault => (f64::from(self.fault), scaling::INT),
            Register::MillisecondCounter => (1e3 * (now_s - self.started_s.unwrap_or(now_s)), scaling::INT),
            Register::Voltage => (24.0, scaling::VOLTAGE),
            Register::Temperature => (25.0, scaling::TEMPERATURE),
            Register::ModelNumber => (1.0, scaling::INT),
            Register::FirmwareVersion => (266.0, scaling::INT),
            Register::RegisterMapVersion => (f64::from(CURRENT_REGISTER_MAP_VERSION), scaling::INT),
            Register::MultiplexId => (f64::from(self.number), scaling::INT),
            Register::SerialNumber1 => (serial, scaling::INT),
            Register::SerialNumber2 | Register::SerialNumber3 => (0.0, scaling::INT),
            sensor => {
                let place = SENSORS.iter().position(|register| *register == sensor)?;
                (shown.sensors[place], if place == 1 { scaling::POSITION } else { scaling::PWM })
            }
        };
        Some(number)
    }
}

impl Node for MoteusNode {
    fn take(&mut self, frame: &Frame, shown: &Shown, now_s: f64, send: Send) -> bool {
        let (source, to, prefix) = parse_arbitration_id(frame.id);
        let to = to.cast_unsigned();
        if prefix != 0 || (to != self.number && to != ALL_NODES) {
            return false;
        }
        self.started_s.get_or_insert(now_s);
        let mut commanded = false;
        let mut answer = CanFdFrame::new();
        let mut run = Run::NONE;
        for subframe in parse_frame(frame.data()) {
            let Subframe::Register { register, resolution, value, .. } = subframe else { continue };
            match value {
                Some(value) => {
                    self.write(register, value, now_s);
                    (self.commanded_s, commanded) = (now_s, true);
                }
                None => run.answer(&mut answer, register, resolution, self.read(register, shown, now_s)),
            }
        }
        if frame.id & 0x8000 != 0 {
            answer.pad_to_dlc();
            let number = i8::try_from(self.number).unwrap_or(0);
            let id = calculate_arbitration_id(number, source, 0, false);
            send(&Frame::fd(id, answer.payload()));
        }
        commanded
    }

    fn action(&mut self, now_s: f64) -> Action {
        if self.mode == Mode::Enabling && now_s - self.enabled_s >= self.power_s {
            self.mode = Mode::Position;
        }
        if self.mode == Mode::Position && now_s - self.commanded_s > self.timeout_s {
            self.mode = Mode::Timeout;
        }
        match self.mode {
            Mode::Position => Action::Torque(self.torque),
            Mode::Timeout | Mode::Brake => Action::Damp,
            _ => Action::Free,
        }
    }

    fn fail(&mut self, code: u16) {
        (self.mode, self.fault) = if code == 0 { (Mode::Stopped, 0) } else { (Mode::Fault, code) };
    }

    fn delay_power(&mut self, power_s: f64) {
        self.power_s = power_s;
    }
}

/// Registers that follow one another in an answer, with one head.
struct Run {
    /// Where their count is, their resolution, and the register that would go on.
    at: Option<(usize, Resolution, u16)>,
}

impl Run {
    const NONE: Self = Self { at: None };

    fn answer(&mut self, to: &mut CanFdFrame, register: u16, resolution: Resolution, value: Option<(f64, Scaling)>) {
        /// Answers, of the resolution that is added to them.
        const REPLY: u8 = 0x20;
        /// More than a head and a register of two bytes.
        const HEAD: usize = 5;
        let Some((value, scaling)) = value else { return };
        if to.remaining_capacity() < HEAD + resolution.size() {
            return;
        }
        #[expect(clippy::cast_sign_loss, reason = "a resolution that is read is not negative")]
        let code = (resolution as i8 as u8) << 2;
        match self.at {
            Some((count, its, next)) if its == resolution && next == register => {
                to.data[count] += 1;
                self.at = Some((count, its, next + 1));
            }
            _ => {
                let mut writer = WriteCanData::new(to);
                writer.write_u8(REPLY | code);
                writer.write_u8(1);
                let count = usize::from(writer.size()) - 1;
                writer.write_varuint(u32::from(register));
                self.at = Some((count, resolution, register + 1));
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "a drive has numbers of 32 bits")]
        WriteCanData::new(to).write_mapped(value as f32, &scaling, resolution);
    }
}
