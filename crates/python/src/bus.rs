//! Drives on a bus.

use crate::errors::refused;
use forcefeel_bus::fault::Fault;
use forcefeel_bus::line::Adapter;
use forcefeel_bus::protocol::Protocol;
use forcefeel_bus::scale::Wiring;
use forcefeel_live::bus::{Bus, NodeSettings, OnBus};
use forcefeel_live::carrier::{Carrier, SerialAdapter};
use forcefeel_live::setup::Setup;
#[cfg(target_os = "linux")]
use forcefeel_live::socket_can::SocketCan;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// A node: kind, port, number; gear, zero, range of the load cell, turns and zero of the column's encoder, range of the grip's sensor;
/// watchdog in s.
#[derive(FromPyObject)]
pub struct NodeOf(String, pub String, u8, (f64, f64, Option<f64>, Option<[f64; 2]>, Option<f64>), f64);

impl NodeOf {
    /// The node in the engine's form.
    pub fn settings(&self) -> PyResult<NodeSettings> {
        let Self(kind, _, node, (gear, zero, load_cell, column, grip), watchdog_s) = self;
        let protocol = Protocol::ALL.iter().find(|(name, _)| name == kind).map(|&(_, protocol)| protocol);
        let protocol = protocol.ok_or_else(|| refused(format!("kind: {kind:?} is none")))?;
        let wiring = Wiring { gear: *gear, zero: *zero, load_cell: *load_cell, column: *column, grip: *grip };
        Ok(NodeSettings { protocol, node: *node, wiring, watchdog_s: *watchdog_s })
    }
}

/// The ports that are open, by their path.
#[derive(Default)]
pub struct Ports(BTreeMap<String, Arc<Mutex<Bus>>>);

impl Ports {
    /// Connects to the node of an axis; axes at one port share it.
    pub fn connect(&mut self, py: Python<'_>, node: &NodeOf, setup: &Setup, by_clock: bool) -> PyResult<OnBus> {
        let (settings, port) = (node.settings()?, &node.1);
        let named = |why: String| PyOSError::new_err(format!("{port}: {why}"));
        if !self.0.contains_key(port) {
            let bus = opened(port, settings.protocol.adapter())?;
            self.0.insert(port.clone(), Arc::new(Mutex::new(bus)));
        }
        let period_s = by_clock.then(|| setup.period_s());
        let bus = &self.0[port];
        py.detach(|| OnBus::connect(bus, &setup.parameters(), &settings, period_s)).map_err(named)
    }
}

/// The bus at a port.
pub fn opened(port: &str, adapter: Adapter) -> PyResult<Bus> {
    let carrier = open(port, adapter).map_err(|error| PyOSError::new_err(format!("{port}: {error}")))?;
    Ok(Bus::new(carrier))
}

/// The carrier at a port: an interface of CAN where it is no path.
fn open(port: &str, adapter: Adapter) -> io::Result<Box<dyn Carrier>> {
    #[cfg(target_os = "linux")]
    if !port.contains('/') {
        return Ok(Box::new(SocketCan::open(port)?));
    }
    Ok(Box::new(SerialAdapter::open(Path::new(port), adapter)?))
}

/// Name and remedy of a fault of drive or bus by its number; nothing of zero.
#[pyfunction]
pub fn drive_fault(number: u16) -> Option<(&'static str, &'static str)> {
    Fault::of(number).text()
}

/// Kinds of drives with the numbers that a node may have.
#[pyfunction]
pub fn bus_kinds() -> Vec<(&'static str, u8, u8)> {
    let kinds = Protocol::ALL.iter().map(|&(name, protocol)| (name, protocol.nodes()));
    kinds.map(|(name, nodes)| (name, *nodes.start(), *nodes.end())).collect()
}
