//! A loop under way: its thread, the one that keeps what it tells, and what others see and ask of it.

use crate::clock::{AtOnce, Monotonic};
use crate::controller::Controller;
use crate::cycle::Cycles;
use crate::host_link::{self, HostStatus};
use crate::input_output::{Disturbance, InputOutput};
use crate::priority::{Granted, ask};
use crate::record::{Record, WITH_THE_RUN};
use crate::request::LoopRequest;
use crate::row::{COLUMNS, Row};
use crate::status::Status;
use crate::thinning::Thinning;
use core::sync::atomic::{AtomicU64, Ordering::Relaxed};
use rtrb::{Consumer, Producer, RingBuffer};
use std::collections::VecDeque;
use std::io;
use std::net::UdpSocket;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// How a loop is to run.
pub struct Plan {
    /// Law, feel and supervisor.
    pub controller: Controller,
    /// The machine.
    pub machine: Box<dyn InputOutput>,
    /// Where a host's packets come to.
    pub host: Option<UdpSocket>,
    /// Wishes with the cycle before which each is taken.
    pub requests: Vec<(u64, LoopRequest)>,
    /// By the clock, or as fast as it goes.
    pub real_time: bool,
    /// Cycles after which it ends by itself.
    pub cycles: u64,
    /// Where what it tells is kept.
    pub record: Option<Record>,
    /// Cycles from a row of it to the next.
    pub every: u64,
    /// Rows that are kept in memory.
    pub history: usize,
}

/// A loop under way.
pub struct Running {
    asks: Mutex<(Producer<LoopRequest>, Producer<Disturbance>)>,
    status: Arc<Status>,
    kept: Arc<RecordedCycle>,
    granted: Arc<OnceLock<Granted>>,
    host_status: Option<Arc<HostStatus>>,
    threads: Mutex<Vec<JoinHandle<()>>>,
}

/// What is kept of it.
#[derive(Default)]
struct RecordedCycle {
    rows: Mutex<VecDeque<Row>>,
    recorded: AtomicU64,
    /// Rows that it lacks because it ended before the loop.
    unrecorded: AtomicU64,
    /// Why the record ended before the loop.
    record_ended: OnceLock<String>,
}

/// Rows for which the ring has room: 3 s of a loop at 5 kHz.
const ROWS: usize = 1 << 14;
/// Wishes and disturbances for which it has.
const WISHES: usize = 64;
/// How long what takes the rows sleeps, and so what a process that is killed loses of its record; by the clock the ring has room for 3 s.
const NAP: Duration = Duration::from_millis(5);
/// The same in virtual time, where the ring is full after some 6 ms; each time it wakes, it may cost a cycle some 50 us.
const VIRTUAL_NAP: Duration = Duration::from_millis(2);
/// Of how long a record has one check sum.
const CHUNK: Duration = Duration::from_millis(250);

impl Running {
    /// Begins.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn start(plan: Plan) -> io::Result<Self> {
        let (requests, taken_wishes) = RingBuffer::new(WISHES);
        let (disturbances, taken_disturbances) = RingBuffer::new(WISHES);
        let (rows, told_rows) = RingBuffer::new(ROWS);
        let (taken, told_wishes) = RingBuffer::new(WISHES);
        let status = Arc::new(Status::default());
        let (kept, granted) = (Arc::new(RecordedCycle::default()), Arc::new(OnceLock::new()));
        let Plan { controller, machine, host, requests: planned, real_time, cycles, record, every, history } = plan;
        let period_s = controller.period_s();
        let (link, of_host) = host.map(host_link::between).transpose()?.unzip();
        let host_status = link.as_ref().map(|link| Arc::clone(&link.host_status));
        let mut run = Cycles {
            controller,
            machine,
            plan: planned,
            requests: taken_wishes,
            host: of_host,
            disturbances: taken_disturbances,
            rows,
            taken,
            status: Arc::clone(&status),
            planned: 0,
            patient: !real_time,
        };
        let given = Arc::clone(&granted);
        let ends = Ended(Arc::clone(&status));
        let looper = thread::Builder::new().name("forcefeel-loop".into()).spawn(move || {
            let _ends = ends;
            if real_time {
                let (granted, _held) = ask();
                let _ = given.set(granted);
                run.run(&mut Monotonic::new(period_s), cycles);
            } else {
                run.run(&mut AtOnce::new(period_s), cycles);
            }
        })?;
        let keeper = Keeper {
            rows: told_rows,
            requests: told_wishes,
            record,
            thinning: Thinning::new(every),
            kept: Arc::clone(&kept),
            history,
            nap: if real_time { NAP } else { VIRTUAL_NAP },
        };
        let looks_on = Arc::clone(&status);
        let keeping = thread::Builder::new().name("forcefeel-record".into()).spawn(move || keeper.keep(&looks_on));
        let looks_on = Arc::clone(&status);
        let listening = link.map(|link| {
            thread::Builder::new().name("forcefeel-host".into()).spawn(move || link.listen(&looks_on.ended))
        });
        let mut threads = vec![looper];
        for one in [Some(keeping), listening].into_iter().flatten() {
            match one {
                Ok(thread) => threads.push(thread),
                Err(error) => {
                    status.end.store(true, Relaxed);
                    for thread in threads {
                        let _ = thread.join();
                    }
                    return Err(error);
                }
            }
        }
        let (asks, threads) = (Mutex::new((requests, disturbances)), Mutex::new(threads));
        Ok(Self { asks, status, kept, granted, host_status, threads })
    }

    /// Asks something of the loop; whether there was room for it.
    pub fn request(&self, request: LoopRequest) -> bool {
        locked(&self.asks).0.push(request).is_ok()
    }

    /// Does something to a simulated machine; whether there was room for it.
    pub fn disturb(&self, disturbance: Disturbance) -> bool {
        locked(&self.asks).1.push(disturbance).is_ok()
    }

    /// How it does.
    pub fn status(&self) -> &Status {
        &self.status
    }

    /// What the system gave its thread; nothing in virtual time, or before it began.
    pub fn granted(&self) -> Option<&Granted> {
        self.granted.get()
    }

    /// What was heard of a host; nothing where none is listened to.
    pub fn host_status(&self) -> Option<&HostStatus> {
        self.host_status.as_deref()
    }

    /// Bytes of the record, rows that it lacks because it ended before the loop, and why it did, if it did.
    pub fn recorded(&self) -> (u64, u64, Option<&str>) {
        let [bytes, lacks] = [&self.kept.recorded, &self.kept.unrecorded].map(|count| count.load(Relaxed));
        (bytes, lacks, self.kept.record_ended.get().map(String::as_str))
    }

    /// The numbers of the newest `most` rows of cycles after `since`, one row after the other.
    pub fn history(&self, since: f64, most: usize) -> Vec<f64> {
        let rows = locked(&self.kept.rows);
        let first = rows.partition_point(|row| row.cycle <= since).max(rows.len().saturating_sub(most));
        let mut numbers = Vec::with_capacity((rows.len() - first) * COLUMNS);
        rows.range(first..).for_each(|row| numbers.extend(row.numbers()));
        numbers
    }

    /// Ends the loop, its drive off, and waits until its record is closed.
    pub fn end(&self) {
        self.status.end.store(true, Relaxed);
        self.join();
    }

    /// Waits until it has ended by itself.
    pub fn join(&self) {
        let threads: Vec<_> = locked(&self.threads).drain(..).collect();
        for thread in threads {
            // A thread that panicked has said why, and is over.
            let _ = thread.join();
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.end();
    }
}

/// Says that the loop has ended, however it did.
struct Ended(Arc<Status>);

impl Drop for Ended {
    fn drop(&mut self) {
        self.0.ended.store(true, Relaxed);
    }
}

/// What is in a lock; nobody leaves it half-written.
fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes what the loop tells, for memory and disk.
struct Keeper {
    rows: Consumer<Row>,
    requests: Consumer<(u64, LoopRequest)>,
    record: Option<Record>,
    thinning: Thinning,
    kept: Arc<RecordedCycle>,
    history: usize,
    nap: Duration,
}

impl Keeper {
    fn keep(mut self, status: &Status) {
        let mut chunk = Instant::now();
        loop {
            // Looked at first: what was told before the end is taken below.
            let ended = status.ended.load(Relaxed);
            self.take();
            if chunk.elapsed() >= CHUNK {
                self.write(Record::end_chunk);
                chunk = Instant::now();
            } else {
                self.write(Record::flush);
            }
            if ended && self.rows.is_empty() && self.requests.is_empty() {
                break;
            }
            thread::sleep(self.nap);
        }
        self.end(WITH_THE_RUN);
    }

    fn take(&mut self) {
        // A request stands in the record before the row that it counts from: that row is told after it.
        let rows: usize = self.rows.slots();
        while let Ok((cycle, request)) = self.requests.pop() {
            self.write(|record| {
                record.request(cycle, &request);
                Ok(())
            });
        }
        for _ in 0..rows {
            let Ok(row) = self.rows.pop() else { break };
            for row in self.thinning.take(row) {
                if self.record.is_none() && self.kept.record_ended.get().is_some() {
                    self.kept.unrecorded.fetch_add(1, Relaxed);
                }
                self.write(|record| {
                    record.row(&row);
                    Ok(())
                });
            }
            let mut kept = locked(&self.kept.rows);
            if kept.len() >= self.history {
                kept.pop_front();
            }
            kept.push_back(row);
        }
    }

    /// Writes to the record, and ends it where that fails or it is full; a ring goes on.
    fn write(&mut self, write: impl FnOnce(&mut Record) -> io::Result<()>) {
        let Some(record) = &mut self.record else { return };
        let written = write(record);
        self.kept.recorded.store(record.bytes(), Relaxed);
        let (full, rows) = (record.full(), record.rows());
        match written {
            Err(error) => self.ended_early(rows, error.to_string()),
            Ok(()) if full.is_some() && record.turns() => match self.record.take().map(Record::next_part).transpose() {
                Ok(next) => self.record = next,
                Err((rows, error)) => self.ended_early(rows, error.to_string()),
            },
            Ok(()) => {
                if let Some(why) = full {
                    self.end(&why);
                    let _ = self.kept.record_ended.set(why);
                }
            }
        }
    }

    /// Ends the record, for the reason that is written into it.
    fn end(&mut self, why: &str) {
        let Some(record) = self.record.take() else { return };
        let taken = record.rows().0;
        if let Err((kept, error)) = record.finish(why) {
            self.ended_early((taken, kept), error.to_string());
        }
    }

    /// Takes note of a record that could not be written: what is not in its file is lost.
    fn ended_early(&mut self, (taken, kept): (u64, u64), why: String) {
        self.record = None;
        self.kept.unrecorded.fetch_add(taken - kept, Relaxed);
        let _ = self.kept.record_ended.set(why);
    }
}
