//! A loader live in steps: law, feel, supervisor and simulated machine go on when they are told to, beside an aircraft in the same process.

use crate::errors::refused;
use crate::live::{LiveSetup, ScriptOf, disturbance_of, request_of};
use forcefeel_live::controller::Controller;
use forcefeel_live::input_output::InputOutput;
use forcefeel_live::request::LoopRequest;
use forcefeel_live::row::COLUMNS;
use forcefeel_live::simulated::{Script, simulated};
use forcefeel_model::host::FromHost;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

struct Steps {
    controller: Controller,
    machine: Box<dyn InputOutput>,
    answer: Option<Vec<u8>>,
}

/// A loop whose cycles are asked for.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct LockStep {
    steps: Mutex<Steps>,
}

#[pymethods]
impl LockStep {
    /// Before its first cycle, its machine simulated, a host listened to.
    #[new]
    #[pyo3(signature = (setup, *, script = None))]
    fn new(setup: &LiveSetup, script: Option<ScriptOf<'_>>) -> PyResult<Self> {
        let mut setup = setup.setup().clone();
        let script = script.map_or(Ok(Script::NONE), |script| script.script())?;
        let (machine, beginning) = simulated(&setup, script);
        (setup.beginning, setup.host) = (Some(beginning), true);
        let controller = Controller::new(&setup).map_err(refused)?;
        Ok(Self { steps: Mutex::new(Steps { controller, machine, answer: None }) })
    }

    /// So many cycles, (cycles, columns), the first of which takes a host's packet where there is one.
    #[pyo3(signature = (cycles, packet = None))]
    fn run<'py>(&self, py: Python<'py>, cycles: usize, packet: Option<&[u8]>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let packet = packet.map(FromHost::decode).transpose();
        let packet = packet.map_err(|why| refused(format!("packet: not one of docs/reference/host.md ({why:?})")))?;
        let numbers = py.detach(|| {
            let mut steps = self.steps();
            let Steps { controller, machine, answer } = &mut *steps;
            if let Some(packet) = packet {
                controller.take(&LoopRequest::Host(packet));
            }
            let mut numbers = Vec::with_capacity(cycles * COLUMNS);
            for _ in 0..cycles {
                let sampled = machine.read();
                let (command, row) = controller.step(sampled.as_ref(), 0);
                machine.write(&command);
                if let Some(told) = controller.answer(&row) {
                    *answer = Some(told.encode().to_vec());
                }
                numbers.extend(row.numbers());
            }
            numbers
        });
        PyArray1::from_vec(py, numbers).reshape([cycles, COLUMNS])
    }

    /// What the loader answered last; nothing before the first packet.
    #[getter]
    fn answer(&self) -> Option<Vec<u8>> {
        self.steps().answer.clone()
    }

    /// Asks something of the loop by name, with its numbers, from the next cycle on.
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arguments over by value")]
    fn request(&self, name: &str, numbers: Vec<f64>) -> PyResult<()> {
        let request = request_of(name, &numbers)?;
        self.steps().controller.take(&request);
        Ok(())
    }

    /// Does something to the machine.
    #[pyo3(signature = (name, sensor = 0, number = None))]
    fn disturb(&self, name: &str, sensor: usize, number: Option<f64>) -> PyResult<()> {
        let disturbance = disturbance_of(name, sensor, number)?;
        self.steps().machine.disturb(disturbance);
        Ok(())
    }
}

impl LockStep {
    fn steps(&self) -> MutexGuard<'_, Steps> {
        self.steps.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
