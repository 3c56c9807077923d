//! Drives on a bus.

use crate::errors::refused;
use forcefeel_bus::ethercat::Units;
use forcefeel_bus::ethercat::analog::Analog;
use forcefeel_bus::ethercat::mailbox::Object;
use forcefeel_bus::fault::Fault;
use forcefeel_bus::load::of_cycle;
use forcefeel_bus::protocol::Protocol;
use forcefeel_bus::scale::Wiring;
use forcefeel_live::bus::{Fieldbus, NodeSettings, OnBus, Port};
use forcefeel_live::can_bus::CanBus;
use forcefeel_live::carrier::SerialAdapter;
#[cfg(target_os = "linux")]
use forcefeel_live::ethercat::EtherCat;
use forcefeel_live::setup::Setup;
#[cfg(target_os = "linux")]
use forcefeel_live::socket_can::SocketCan;
use forcefeel_model::transducers::SENSORS;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// A node: kind, port, number; gear, zero, range of the load cell, turns and zero of the column's encoder, range of the grip's sensor;
/// watchdog in s; rated torque in N m, counts of both encoders, objects of the sensors, where the drive states none; of a valve's terminals
/// node of the inputs, objects of output and inputs, ranges of the command in V, of the drive's end in m, of the column in turns.
#[derive(FromPyObject)]
pub struct NodeOf(String, pub String, u8, WiringOf, f64, Option<UnitsOf>, Option<AnalogOf>);

type WiringOf = (f64, f64, Option<f64>, Option<[f64; 2]>, Option<f64>);
type UnitsOf = (f64, f64, f64, [Option<(u16, u8)>; 3]);
type AnalogOf = (u8, (u16, u8), [Option<(u16, u8)>; SENSORS], [f64; 3]);

impl NodeOf {
    /// The node in the engine's form.
    pub fn settings(&self) -> PyResult<NodeSettings> {
        let Self(kind, _, node, (gear, zero, load_cell, column, grip), watchdog_s, units, analog) = self;
        let protocol = Protocol::ALL.iter().find(|(name, _)| name == kind).map(|&(_, protocol)| protocol);
        let protocol = protocol.ok_or_else(|| refused(format!("kind: {kind:?} is none")))?;
        let wiring = Wiring { gear: *gear, zero: *zero, load_cell: *load_cell, column: *column, grip: *grip };
        let units = units.map_or(Units::ONE, |(rated_torque, counts, column_counts, sensors)| Units {
            rated_torque,
            counts,
            column_counts,
            sensors: sensors.map(|sensor| sensor.map(object)),
        });
        let analog = analog.map(|(input_node, output, inputs, ranges)| Analog {
            input_node,
            output: object(output),
            inputs: inputs.map(|input| input.map(object)),
            output_range: ranges[0],
            position_range: ranges[1],
            column_range: ranges[2],
        });
        Ok(NodeSettings { protocol, node: *node, wiring, watchdog_s: *watchdog_s, units, analog })
    }
}

fn object((index, sub): (u16, u8)) -> Object {
    Object::new(index, sub)
}

/// The ports that are open, by their path.
#[derive(Default)]
pub struct Ports(BTreeMap<String, Port>);

impl Ports {
    /// Connects to the node of an axis; axes at one port share it.
    pub fn connect(&mut self, py: Python<'_>, node: &NodeOf, setup: &Setup, by_clock: bool) -> PyResult<OnBus> {
        let (settings, port) = (node.settings()?, &node.1);
        let named = |why: String| PyOSError::new_err(format!("{port}: {why}"));
        if !self.0.contains_key(port) {
            let bus = py.detach(|| opened(port, settings.protocol))?;
            self.0.insert(port.clone(), Arc::new(Mutex::new(bus)));
        }
        let period_s = by_clock.then(|| setup.period_s());
        let bus = &self.0[port];
        py.detach(|| OnBus::connect(bus, &setup.parameters(), &settings, period_s)).map_err(named)
    }
}

/// The bus at a port.
pub fn opened(port: &str, protocol: Protocol) -> PyResult<Box<dyn Fieldbus>> {
    open(port, protocol).map_err(|error| PyOSError::new_err(format!("{port}: {error}")))
}

/// At a serial adapter, or at an interface of the network where it is no path.
fn open(port: &str, protocol: Protocol) -> io::Result<Box<dyn Fieldbus>> {
    let Some(adapter) = protocol.adapter() else {
        #[cfg(target_os = "linux")]
        return Ok(Box::new(EtherCat::open(port)?));
        #[cfg(not(target_os = "linux"))]
        return Err(io::Error::new(io::ErrorKind::Unsupported, "expected Linux for EtherCAT"));
    };
    #[cfg(target_os = "linux")]
    if !port.contains('/') {
        return Ok(Box::new(CanBus::new(Box::new(SocketCan::open(port)?))));
    }
    Ok(Box::new(CanBus::new(Box::new(SerialAdapter::open(Path::new(port), adapter)?))))
}

/// Adds its functions to the module.
pub fn fill(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(bus_kinds, module)?)?;
    module.add_function(wrap_pyfunction!(drive_fault, module)?)?;
    module.add_function(wrap_pyfunction!(bus_frames, module)?)?;
    Ok(())
}

/// Name and remedy of a fault of drive or bus by its number; nothing of zero.
#[pyfunction]
pub fn drive_fault(number: u16) -> Option<(&'static str, &'static str)> {
    Fault::of(number).text()
}

/// Name, bytes, bits and time in s of a frame, and its period in s; nothing of one that comes in each cycle.
type Loaded = (&'static str, usize, u32, f64, Option<f64>);

/// The frames that a cycle of a node has on its bus.
#[pyfunction]
pub fn bus_frames(node: NodeOf) -> PyResult<Vec<Loaded>> {
    let NodeSettings { protocol, node, wiring, units, analog, .. } = node.settings()?;
    let sensors = [wiring.load_cell.is_some(), wiring.column.is_some(), wiring.grip.is_some()];
    let frames = of_cycle(protocol, node, sensors, &units, analog.as_ref());
    Ok(frames.iter().map(|frame| (frame.name, frame.bytes, frame.bits, frame.time_s, frame.every_s)).collect())
}

/// Kinds of drives with the numbers that a node may have.
#[pyfunction]
pub fn bus_kinds() -> Vec<(&'static str, u8, u8)> {
    let kinds = Protocol::ALL.iter().map(|&(name, protocol)| (name, protocol.nodes()));
    kinds.map(|(name, nodes)| (name, *nodes.start(), *nodes.end())).collect()
}
