//! A wire of EtherCAT in memory.

use forcefeel_bus::drive::{Node, Shown};
use forcefeel_bus::ethercat::datagram::Packet;
use forcefeel_bus::ethercat::station::Segment;

/// Watchdog of slaves on a wire, and the period of their cycle, in s.
pub const WATCHDOG_S: f64 = 0.1;
pub const PERIOD_S: f64 = 0.001;

/// Slaves on a wire, what their machines show, and what time it is.
pub struct Wire<N> {
    pub slaves: Vec<N>,
    pub shown: Shown,
    pub now_s: f64,
}

impl<N: Node> Wire<N> {
    pub fn new(slaves: Vec<N>, shown: Shown) -> Self {
        Self { slaves, shown, now_s: 0.0 }
    }

    /// Whether one of them had a command.
    pub fn pass(&mut self, packet: &mut Packet) -> bool {
        let (shown, now_s) = (self.shown, self.now_s);
        self.slaves.iter_mut().fold(false, |commanded, slave| slave.pass(&mut packet.bytes, &shown, now_s) | commanded)
    }
}

impl<N: Node> Segment for Wire<N> {
    fn exchange(&mut self, packet: &mut Packet) -> bool {
        self.now_s += 1e-4;
        self.pass(packet);
        true
    }

    fn rest(&mut self) {
        self.now_s += PERIOD_S;
    }
}
