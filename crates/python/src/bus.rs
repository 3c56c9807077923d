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
use std::f64::consts::TAU;
use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};

/// A node, as the attributes of Python's `Bus`; an object is index and sub-index.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct NodeOf {
    kind: String,
    pub port: String,
    node: u8,
    gear: f64,
    zero_rad: f64,
    watchdog_s: f64,
    load_cell_n: Option<f64>,
    column_gear: Option<f64>,
    column_zero_rad: f64,
    grip_sensor_n: Option<f64>,
    rated_torque_n_m: Option<f64>,
    encoder_counts: Option<f64>,
    column_counts: Option<f64>,
    load_cell_object: Option<ObjectOf>,
    column_object: Option<ObjectOf>,
    grip_object: Option<ObjectOf>,
    input_node: Option<u8>,
    output_v: Option<f64>,
    output_object: Option<ObjectOf>,
    position_m: Option<f64>,
    position_zero_m: Option<f64>,
    position_object: Option<ObjectOf>,
    column_range_rad: Option<f64>,
}

type ObjectOf = (u16, u8);

impl NodeOf {
    /// The node in the engine's form.
    pub fn settings(&self) -> PyResult<NodeSettings> {
        let protocol = Protocol::ALL.iter().find(|(name, _)| *name == self.kind).map(|&(_, protocol)| protocol);
        let protocol = protocol.ok_or_else(|| refused(format!("kind: {:?} is none", self.kind)))?;
        let (wiring, analog) = match protocol {
            Protocol::Analog => (self.terminals(), Some(self.analog()?)),
            _ => (self.wiring(), None),
        };
        let units = if protocol == Protocol::EtherCat { self.units() } else { Units::ONE };
        Ok(NodeSettings { protocol, node: self.node, wiring, watchdog_s: self.watchdog_s, units, analog })
    }

    /// Of a motor.
    fn wiring(&self) -> Wiring {
        let column = self.column_gear.map(|gear| [gear, self.column_zero_rad / TAU]);
        Wiring {
            gear: self.gear,
            zero: self.zero_rad / TAU,
            load_cell: self.load_cell_n,
            column,
            grip: self.grip_sensor_n,
        }
    }

    /// Of a valve, whose position is a share of its input's range.
    fn terminals(&self) -> Wiring {
        let zero = self.position_zero_m.unwrap_or(0.0) / self.position_m.unwrap_or(1.0);
        Wiring { zero, column: Some([1.0, self.column_zero_rad / TAU]), ..self.wiring() }
    }

    fn units(&self) -> Units {
        let [load_cell, _, column, grip] = self.sensors(self.column_gear.is_some());
        Units {
            rated_torque: self.rated_torque_n_m.unwrap_or(1.0),
            counts: self.encoder_counts.unwrap_or(1.0),
            column_counts: self.column_counts.unwrap_or(1.0),
            sensors: [load_cell, column, grip],
            input_node: self.input_node,
        }
    }

    fn analog(&self) -> PyResult<Analog> {
        let (Some(input_node), Some(output)) = (self.input_node, self.output_object) else {
            return Err(refused("input_node, output_object: missing value"));
        };
        Ok(Analog {
            input_node,
            output: object(output),
            inputs: self.sensors(true),
            output_range: self.output_v.unwrap_or(1.0),
            position_range: self.position_m.unwrap_or(1.0),
            column_range: self.column_range_rad.unwrap_or(1.0) / TAU,
        })
    }

    /// Objects of load cell, drive's end, column and force sensor at the grip, of those that are wired.
    fn sensors(&self, column: bool) -> [Option<Object>; SENSORS] {
        let of = |wired: bool, stated: Option<ObjectOf>| stated.filter(|_| wired).map(object);
        [
            of(self.load_cell_n.is_some(), self.load_cell_object),
            of(true, self.position_object),
            of(column, self.column_object),
            of(self.grip_sensor_n.is_some(), self.grip_object),
        ]
    }
}

fn object((index, sub): ObjectOf) -> Object {
    Object::new(index, sub)
}

/// The ports that are open, by their path.
#[derive(Default)]
pub struct Ports(BTreeMap<String, Port>);

impl Ports {
    /// Connects to the node of an axis; axes at one port share it.
    pub fn connect(&mut self, py: Python<'_>, node: &NodeOf, setup: &Setup, by_clock: bool) -> PyResult<OnBus> {
        let (settings, port) = (node.settings()?, &node.port);
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
        let named = |error: io::Error| {
            io::Error::new(
                error.kind(),
                format!("expected a CAN interface, or a path of a serial port such as ./{port}: {error}"),
            )
        };
        return Ok(Box::new(CanBus::new(Box::new(SocketCan::open(port).map_err(named)?))));
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
