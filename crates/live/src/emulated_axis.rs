//! A machine with its drive, on an emulated bus.

use crate::bus::NodeSettings;
use crate::input_output::Command;
use crate::setup::Setup;
use crate::simulated::{Script, Stepped, simulated};
use forcefeel_bus::drive::{Action, Node, Shown};
use forcefeel_bus::scale::Scale;
use forcefeel_model::controller::Timing;

/// Rate in 1/s at which a drive that damps takes the speed off its own rotor.
const DAMPS_PER_S: f64 = 60.0;

/// A loader at a node: its setup, the node, and what happens to it.
pub type Place = (Setup, NodeSettings, Script);

/// A machine with its drive.
pub(crate) struct Axis {
    pub machine: Box<dyn Stepped>,
    pub node: Box<dyn Node + Send>,
    /// A second drive with the same number, whose motor moves nothing here.
    pub twin: Option<Box<dyn Node + Send>>,
    /// To make it anew; whether it is the last of its line, and the time in s that the drive takes to act.
    settings: (NodeSettings, bool, f64),
    scale: Scale,
    pub shown: Shown,
    position: f64,
    travel: f64,
    /// Command in A per speed of the motor in rad/s at which it damps, and the most.
    damping: [f64; 2],
    pub command: f64,
    pub period: usize,
    /// Time of its machine in s.
    pub time_s: f64,
}

impl Axis {
    /// A machine at rest with its drive; the last of its line or not, and the time in s that the drive takes to act once it is enabled.
    pub fn new((setup, settings, script): Place, last: bool, power_s: f64) -> Self {
        let parameters = setup.parameters();
        let period = setup.timing.period;
        // The bus itself is the delay; a step is a sample.
        let (mut machine, _) = simulated(&Setup { timing: Timing { period: 1, delay: 0 }, ..setup }, script);
        let scale = settings.scale(&parameters);
        let motor = &parameters.motor;
        let damping = DAMPS_PER_S * motor.inertia / motor.torque_constant;
        let sensors = machine.read().map_or([0.0; 4], |sampled| sampled.sample.sensors);
        Self {
            machine,
            node: node(&settings, last, power_s),
            twin: None,
            settings: (settings, last, power_s),
            scale,
            shown: scale.shown(sensors, 0.0, 0.0),
            position: sensors[1],
            travel: parameters.transmission.travel,
            damping: [damping, parameters.current_loop.current_limit],
            command: 0.0,
            period,
            time_s: 0.0,
        }
    }

    /// Has the drive start anew.
    pub fn restart(&mut self) {
        let (settings, last, power_s) = &self.settings;
        self.node = node(settings, *last, *power_s);
    }

    /// Adds a second drive with the same number.
    pub fn add_twin(&mut self) {
        let (settings, ..) = &self.settings;
        self.twin = Some(settings.protocol.twin(settings.node));
    }

    /// Steps of the machine, with what the drive does.
    pub fn advance(&mut self, steps: usize) {
        for _ in 0..steps {
            self.time_s += self.machine.step_s();
            let speed = self.shown.velocity;
            let [per_speed, most] = self.damping;
            self.command = match self.node.action(self.time_s) {
                Action::Free => 0.0,
                Action::Torque(torque) => self.scale.command(torque),
                Action::Damp => (-per_speed * self.scale.speed(speed)).clamp(-most, most),
            };
            self.machine.write(&Command { cycle: 0, command: self.command, enable: true, state: 0 });
            if let Some(sampled) = self.machine.read() {
                let sensors = sampled.sample.sensors;
                let speed = (sensors[1] - self.position) / (self.travel * self.machine.step_s());
                self.position = sensors[1];
                self.shown = self.scale.shown(sensors, self.command, speed);
            }
        }
    }
}

fn node(settings: &NodeSettings, last: bool, power_s: f64) -> Box<dyn Node + Send> {
    let mut made = settings.protocol.node(settings.node, settings.units, settings.analog, last);
    made.delay_power(power_s);
    made
}
