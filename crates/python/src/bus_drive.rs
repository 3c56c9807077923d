//! A drive on its bus before a loop runs it.

use crate::bus::{NodeOf, Ports, opened};
use crate::live::LiveSetup;
use forcefeel_bus::drive::Identity;
use forcefeel_live::bus::{OnBus, Played};
use forcefeel_model::transducers::SENSORS;
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The drive of a loader on its bus, without a loop.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct BusDrive {
    drive: Mutex<OnBus>,
    period: Duration,
}

#[pymethods]
impl BusDrive {
    /// `by_clock`: whether currents are played by the clock; else as fast as they are answered.
    #[new]
    #[pyo3(signature = (setup, node, *, by_clock = true))]
    fn new(py: Python<'_>, setup: &LiveSetup, node: NodeOf, by_clock: bool) -> PyResult<Self> {
        let period = Duration::from_secs_f64(setup.setup().period_s());
        Ok(Self { drive: Mutex::new(Ports::default().connect(py, &node, setup.setup(), by_clock)?), period })
    }

    /// Plays currents in A, one a period, within a distance in m of the drive's end: load cell, drive, base, grip, current, time of each;
    /// why it ended early, if it did.
    fn play(&self, py: Python<'_>, currents: Vec<f64>, most: f64) -> (Vec<Played>, Option<String>) {
        py.detach(|| locked(&self.drive).play(&currents, most))
    }

    /// Powers the drive without a current, until it acts; why not, if it does not.
    fn power_up(&self, py: Python<'_>) -> Option<String> {
        py.detach(|| locked(&self.drive).power_up())
    }

    /// Sends a command in A, and waits for its answer: sensors of a sample, number of the drive's fault; nothing if none comes.
    fn exchange(&self, py: Python<'_>, command: f64, enable: bool) -> Option<([f64; SENSORS], u16)> {
        let answer = py.detach(|| locked(&self.drive).exchange(command, enable));
        answer.map(|(sampled, fault, _)| (sampled.sample.sensors, fault.0))
    }

    /// Times in s of answers to a stop, one a period.
    fn round_trips(&self, py: Python<'_>, count: usize) -> Vec<f64> {
        py.detach(|| locked(&self.drive).round_trips(count, self.period))
    }
}

fn locked(drive: &Mutex<OnBus>) -> MutexGuard<'_, OnBus> {
    drive.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What each node at a port states of itself: number, model, firmware, version of its registers, serial number.
#[pyfunction]
pub fn bus_nodes(py: Python<'_>, node: NodeOf) -> PyResult<Vec<Described>> {
    let settings = node.settings()?;
    let nodes = py.detach(|| opened(&node.port, settings.protocol).map(|mut bus| bus.nodes(&settings)))?;
    let mut nodes: Vec<_> = nodes.iter().map(described).collect();
    nodes.sort();
    Ok(nodes)
}

/// Number, model, firmware, version of its registers, serial number.
type Described = (u8, u32, u32, u32, String);

fn described(identity: &Identity) -> Described {
    (identity.node, identity.model, identity.firmware, identity.registers, identity.serial_text())
}
