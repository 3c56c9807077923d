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

/// Bandwidth in rad/s at which a drive tracks its encoder, as an ODrive's (`encoder_bandwidth`): one step of 30 us would state
/// mostly noise.
const TRACKS_AT: f64 = 1000.0;

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
    rotor: Rotor,
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
            rotor: Rotor { position: sensors[1] / parameters.transmission.travel, speed: 0.0 },
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
                self.rotor.track(sensors[1] / self.travel, self.machine.step_s());
                self.shown = self.scale.shown(sensors, self.command, self.rotor.speed);
            }
        }
    }
}

/// Angle in rad and speed in rad/s of a rotor as its drive tracks them: a loop of second order, critically damped.
struct Rotor {
    position: f64,
    speed: f64,
}

impl Rotor {
    fn track(&mut self, position: f64, step_s: f64) {
        self.position += self.speed * step_s;
        let missed = position - self.position;
        self.position += 2.0 * TRACKS_AT * missed * step_s;
        self.speed += TRACKS_AT * TRACKS_AT * missed * step_s;
    }
}

fn node(settings: &NodeSettings, last: bool, power_s: f64) -> Box<dyn Node + Send> {
    let mut made = settings.protocol.node(settings.node, settings.units, settings.analog, last);
    made.delay_power(power_s);
    made
}
