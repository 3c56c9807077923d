//! Machines emulated behind a bus.

use crate::bus::NodeOf;
use crate::errors::refused;
use crate::live::{LiveSetup, ScriptOf, disturbance_of};
use forcefeel_live::emulated_wire::{EmulatorRequest, WireFault};
use forcefeel_live::emulator::Emulator;
use forcefeel_live::simulated::Script;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::path::PathBuf;

/// Machines of loaders as nodes of a bus, behind a pseudo terminal or on a network interface.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct BusEmulator {
    emulator: Emulator,
    axes: usize,
}

#[pymethods]
impl BusEmulator {
    /// `by_clock`: whether the machines go on by themselves; else each takes a period at a command for its node. `power_s`: time that a
    /// drive takes to act once it is enabled.
    #[new]
    #[pyo3(signature = (nodes, *, by_clock = true, power_s = 0.0))]
    fn new(
        nodes: Vec<(PyRef<'_, LiveSetup>, NodeOf, Option<ScriptOf<'_>>)>,
        by_clock: bool,
        power_s: f64,
    ) -> PyResult<Self> {
        let axes = nodes.len();
        let interface = nodes.first().map_or_else(String::new, |(_, node, _)| node.port.clone());
        let places = nodes.into_iter().map(|(setup, node, script)| {
            let script = script.map_or(Ok(Script::NONE), |script| script.script())?;
            Ok((setup.setup().clone(), node.settings()?, script))
        });
        let places = places.collect::<PyResult<Vec<_>>>()?;
        let emulator = Emulator::start(places, &interface, by_clock, power_s);
        let emulator = emulator.map_err(|error| PyOSError::new_err(error.to_string()))?;
        Ok(Self { emulator, axes })
    }

    /// Where clients open it.
    #[getter]
    fn port(&self) -> PathBuf {
        self.emulator.port().to_path_buf()
    }

    /// Something wrong with each so manieth answer, `by` commands where it is late; nothing where the name is empty.
    fn break_wire(&self, name: &str, every: u32, by: usize) -> PyResult<()> {
        let fault = match name {
            "" => None,
            "lost" => Some(WireFault::Lost),
            "late" => Some(WireFault::Late(by)),
            "repeated" => Some(WireFault::Repeated),
            "corrupt" => Some(WireFault::Corrupt),
            "gone" => Some(WireFault::Gone),
            "bus_off" => Some(WireFault::BusOff),
            "miscounted" => Some(WireFault::Miscounted),
            other => return Err(refused(format!("name: {other:?} is none"))),
        };
        self.emulator.ask(EmulatorRequest::Wire(fault.map(|fault| (fault, every.max(1)))));
        Ok(())
    }

    /// A drive fails with the maker's code.
    fn fail(&self, axis: usize, code: u16) -> PyResult<()> {
        self.emulator.ask(EmulatorRequest::Fail(self.of(axis)?, code));
        Ok(())
    }

    /// A drive loses its supply for a moment.
    fn restart(&self, axis: usize) -> PyResult<()> {
        self.emulator.ask(EmulatorRequest::Restart(self.of(axis)?));
        Ok(())
    }

    /// A second drive has the number of one.
    fn add_twin(&self, axis: usize) -> PyResult<()> {
        self.emulator.ask(EmulatorRequest::Twin(self.of(axis)?));
        Ok(())
    }

    /// Does something to a machine.
    #[pyo3(signature = (axis, name, sensor = 0, number = None))]
    fn disturb(&self, axis: usize, name: &str, sensor: usize, number: Option<f64>) -> PyResult<()> {
        self.emulator.ask(EmulatorRequest::Machine(self.of(axis)?, disturbance_of(name, sensor, number)?));
        Ok(())
    }

    /// Command in A and angle of the column in rad of each machine.
    fn seen(&self) -> Vec<[f64; 2]> {
        self.emulator.seen()
    }

    /// Ends it.
    fn end(&self, py: Python<'_>) {
        py.detach(|| self.emulator.end());
    }
}

impl BusEmulator {
    fn of(&self, axis: usize) -> PyResult<usize> {
        (axis < self.axes).then_some(axis).ok_or_else(|| refused(format!("axis: expected a place below {}", self.axes)))
    }
}
