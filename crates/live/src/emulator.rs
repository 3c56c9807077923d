//! Machines of loaders as nodes of a bus: behind a pseudo terminal that any client of the bus opens, or on a network interface.
//!
//! By the clock the machines go on by themselves, in steps finer than a sample. Without one each machine takes a period at each command
//! for its node: then a loop in virtual time and its machine go together, and repeat to the bit.

use crate::emulated_axis::{Axis, Place};
use crate::emulated_wire::{EmulatorRequest, Shared, Terminals, Wire, locked};
use crate::priority::{PRIORITY, ask};
use core::sync::atomic::Ordering::Relaxed;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};

/// A bus under way.
pub struct Emulator {
    port: PathBuf,
    shared: Arc<Shared>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

impl Emulator {
    /// Begins; on EtherCAT at an interface, otherwise at a terminal that the system names. The drives take `power_s` to act.
    ///
    /// # Errors
    /// If the system gives no terminal, interface or thread.
    pub fn start(places: Vec<Place>, interface: &str, by_clock: bool, power_s: f64) -> io::Result<Self> {
        let adapter = places.first().and_then(|(_, node, _)| node.protocol.adapter());
        let (terminals, port) = Terminals::open(adapter, interface)?;
        let shared = Arc::new(Shared::default());
        let sees = Arc::clone(&shared);
        let thread = thread::Builder::new().name("forcefeel-emulator".into()).spawn(move || {
            // By the clock a machine is not held up by others, nor holds up a loop on this computer.
            let _held = by_clock.then(|| ask(PRIORITY - 1, false));
            let count = places.len();
            let axes = places.into_iter().zip(1..);
            let axes = axes.map(|(place, number)| Axis::new(place, number == count, power_s)).collect();
            Wire::new(terminals, axes, sees).run(by_clock);
        })?;
        Ok(Self { port, shared, thread: Mutex::new(Some(thread)) })
    }

    /// Where clients open it.
    pub fn port(&self) -> &Path {
        &self.port
    }

    /// Has something happen.
    pub fn ask(&self, asked: EmulatorRequest) {
        locked(&self.shared.asked).push(asked);
    }

    /// Command in A and angle of the column in rad of each machine.
    pub fn seen(&self) -> Vec<[f64; 2]> {
        locked(&self.shared.seen).clone()
    }

    /// Ends it.
    pub fn end(&self) {
        self.shared.end.store(true, Relaxed);
        if let Some(thread) = locked(&self.thread).take() {
            // A thread that panicked has said why, and is over.
            let _ = thread.join();
        }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        self.end();
    }
}
