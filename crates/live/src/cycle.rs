//! A cycle of an axis: read, work, write. Nothing here allocates, locks, or calls the system but for the input and the output.

use crate::clock::Woken;
use crate::controller::Controller;
use crate::host_link::HostRings;
use crate::input_output::{Command, Disturbance, InputOutput};
use crate::request::LoopRequest;
use crate::row::Row;
use crate::status::Status;
use core::sync::atomic::Ordering::Relaxed;
use rtrb::{Consumer, Producer};
use std::sync::Arc;
use std::time::Instant;

/// A loop's ends of the rings, and what it runs.
pub struct Cycles {
    /// Law, feel, supervisor.
    pub controller: Controller,
    /// The machine.
    pub machine: Box<dyn InputOutput>,
    /// Requests with the cycle before which each is taken, in order; those of a replay.
    pub plan: Vec<(u64, LoopRequest)>,
    /// Requests of the moment.
    pub requests: Consumer<LoopRequest>,
    /// Packets of a host, and what it is told.
    pub host: Option<HostRings>,
    /// What is done to a simulated machine.
    pub disturbances: Consumer<Disturbance>,
    /// A row each cycle.
    pub rows: Producer<Row>,
    /// The requests that were taken, each with the number of the cycle from which it counts.
    pub taken: Producer<(u64, LoopRequest)>,
    /// What is seen of it at once.
    pub status: Arc<Status>,
    /// How many requests of the plan have been taken.
    pub planned: usize,
    /// Whether what looks on is waited for where its ring is full: in virtual time nothing is to be lost.
    pub patient: bool,
}

impl Cycles {
    /// Ends it: the drive is switched off.
    pub fn end(&mut self) {
        let cycle = self.controller.cycle();
        self.machine.write(&Command { cycle, command: 0.0, enable: false, state: 0 });
        self.status.ended.store(true, Relaxed);
    }

    /// One cycle.
    pub fn cycle(&mut self, Woken { late_ns, missed }: Woken) {
        let begun = Instant::now();
        self.take_wishes();
        while let Ok(disturbance) = self.disturbances.pop() {
            self.machine.disturb(disturbance);
        }
        let sampled = self.machine.read().map(|sampled| self.controller.checked(sampled));
        let (command, row) = self.controller.step(sampled.as_ref(), missed);
        self.machine.write(&command);
        if let Some(host) = &mut self.host
            && let Some(answer) = self.controller.answer(&row)
        {
            // A host that takes no answers goes without.
            let _ = host.answers.push(answer);
        }
        let work_ns = u64::try_from(begun.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.look(&row, sampled.is_none(), (late_ns, work_ns, missed));
        let row = Row { late_s: seconds(late_ns), work_s: seconds(work_ns), ..row };
        tell(&mut self.rows, row, &self.status, self.patient);
    }

    fn take_wishes(&mut self) {
        let cycle = self.controller.cycle();
        while let Some(&(_, request)) = self.plan.get(self.planned).filter(|(from, _)| *from <= cycle) {
            self.planned += 1;
            self.take(cycle, &request);
        }
        while let Ok(request) = self.requests.pop() {
            self.take(cycle, &request);
        }
        // One a cycle, so that what is told of them has its bounds.
        if let Some(packet) = self.host.as_mut().and_then(|host| host.packets.pop().ok()) {
            self.take(cycle, &LoopRequest::Host(packet));
        }
    }

    /// Takes a request that counts from a cycle on, and tells it.
    pub fn take(&mut self, cycle: u64, request: &LoopRequest) {
        self.controller.take(request);
        tell(&mut self.taken, (cycle, *request), &self.status, self.patient);
    }

    fn look(&self, row: &Row, silent: bool, (late_ns, work_ns, missed): (u64, u64, u64)) {
        let status = &self.status;
        let add = |to: &core::sync::atomic::AtomicU64, count| to.store(to.load(Relaxed) + count, Relaxed);
        status.late.count(late_ns);
        status.work.count(work_ns);
        add(&status.cycles, 1);
        add(&status.beats, 1 + missed);
        add(&status.missed, missed);
        add(&status.silent, u64::from(silent));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "they were whole numbers of 32 bits"
        )]
        let (state, trips, of_sample) = (row.state as u32, row.trips as u32, row.drive_fault as u32);
        status.state.store(state, Relaxed);
        status.trips.store(trips, Relaxed);
        status.softened.store(self.controller.softened(), Relaxed);
        let fault = match self.machine.fault() {
            0 => of_sample,
            fault => u32::from(fault),
        };
        // A cycle without a sample says nothing of it.
        if fault != 0 || (trips == 0 && !silent) {
            status.drive_fault.store(fault, Relaxed);
        }
    }
}

/// Puts something into a ring; what finds no room is lost, and counted.
fn tell<T>(ring: &mut Producer<T>, value: T, status: &Status, patient: bool) {
    while patient && ring.is_full() && !ring.is_abandoned() {
        std::thread::yield_now();
    }
    if ring.push(value).is_err() {
        status.lost.store(status.lost.load(Relaxed) + 1, Relaxed);
    }
}

#[expect(clippy::cast_precision_loss, reason = "less than 2^52 ns")]
fn seconds(ns: u64) -> f64 {
    ns as f64 * 1e-9
}
