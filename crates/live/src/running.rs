//! A loop under way: its thread, the one that keeps what it tells, and what others see and ask of each axis.

use crate::axes::{Axes, AxesLink, Axis};
use crate::clock::{AtOnce, Monotonic, nanoseconds};
use crate::controller::Controller;
use crate::cycle::Cycles;
use crate::host_link::{self, HostStatus};
use crate::input_output::{Disturbance, InputOutput};
use crate::priority::{Granted, PRIORITY, ask};
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

/// How an axis is to run.
pub struct AxisPlan {
    /// Law, feel and supervisor.
    pub controller: Controller,
    /// The machine.
    pub machine: Box<dyn InputOutput>,
    /// Requests with the cycle before which each is taken.
    pub requests: Vec<(u64, LoopRequest)>,
    /// Beats of the clock from one of its cycles to the next.
    pub every: u64,
    /// Places of the axes that stop with it.
    pub stops: Vec<usize>,
}

/// How a loop is to run.
pub struct Plan {
    /// The axes, at least one.
    pub axes: Vec<AxisPlan>,
    /// Electronic links.
    pub links: Vec<AxesLink>,
    /// Of the clock, in s.
    pub period_s: f64,
    /// Where a host's packets come to.
    pub host: Option<UdpSocket>,
    /// By the clock, or as fast as it goes.
    pub real_time: bool,
    /// Beats after which it ends by itself.
    pub beats: u64,
    /// Where what it tells is kept.
    pub record: Option<Record>,
    /// Cycles from a row of it to the next.
    pub every: u64,
    /// Rows of each axis that are kept in memory.
    pub history: usize,
}

/// An axis of a loop under way. Where one ends, all do.
pub struct Running {
    asks: Mutex<(Producer<LoopRequest>, Producer<Disturbance>)>,
    status: Arc<Status>,
    rows: Arc<Mutex<VecDeque<Row>>>,
    recorded: Arc<Recorded>,
    granted: Arc<OnceLock<Granted>>,
    host_status: Option<Arc<HostStatus>>,
    threads: Arc<Mutex<Vec<JoinHandle<()>>>>,
}

/// What there is of the record.
#[derive(Default)]
struct Recorded {
    bytes: AtomicU64,
    /// Rows that it lacks because it ended before the loop.
    unrecorded: AtomicU64,
    /// Why the record ended before the loop.
    ended: OnceLock<String>,
}

/// Rows for which the ring has room: 3 s of a loop at 5 kHz.
const ROWS: usize = 1 << 14;
/// Requests and disturbances for which it has.
const REQUESTS: usize = 64;
/// How long what takes the rows sleeps, and so what a process that is killed loses of its record; by the clock the ring has room for 3 s.
const NAP: Duration = Duration::from_millis(5);
/// The same in virtual time, where the ring is full after some 6 ms; each time it wakes, it may cost a cycle some 50 us.
const VIRTUAL_NAP: Duration = Duration::from_millis(2);
/// Of how long a record has one check sum.
const CHUNK: Duration = Duration::from_millis(250);

impl Running {
    /// Begins; gives each axis.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn start(plan: Plan) -> io::Result<Vec<Self>> {
        let Plan { axes, links, period_s, host, real_time, beats, record, every, history } = plan;
        let (recorded, granted) = (Arc::new(Recorded::default()), Arc::new(OnceLock::new()));
        let threads = Arc::new(Mutex::new(Vec::new()));
        let (link, of_host) = host.map(|socket| host_link::between(socket, axes.len())).transpose()?.unzip();
        let host_status = link.as_ref().map(|link| Arc::clone(&link.host_status));
        let mut of_host = of_host.map(Vec::into_iter);
        let mut run = Axes { axes: Vec::new(), links, beats: 0 };
        let (mut kept, mut running) = (Vec::new(), Vec::new());
        for AxisPlan { controller, machine, requests: plan, every: beats, stops } in axes {
            let (requests, taken_requests) = RingBuffer::new(REQUESTS);
            let (disturbances, taken_disturbances) = RingBuffer::new(REQUESTS);
            let (rows, told_rows) = RingBuffer::new(ROWS);
            let (taken, told_requests) = RingBuffer::new(REQUESTS);
            let (status, in_memory) = (Arc::new(Status::default()), Arc::new(Mutex::default()));
            let cycles = Cycles {
                controller,
                machine,
                plan,
                requests: taken_requests,
                host: of_host.as_mut().and_then(Iterator::next),
                disturbances: taken_disturbances,
                rows,
                taken,
                status: Arc::clone(&status),
                planned: 0,
                patient: !real_time,
            };
            run.axes.push(Axis { cycles, every: beats, stops, stopped: false });
            let (rows, thinning) = (told_rows, Thinning::new(every));
            kept.push(KeptAxis { rows, requests: told_requests, thinning, in_memory: Arc::clone(&in_memory) });
            running.push(Self {
                asks: Mutex::new((requests, disturbances)),
                status,
                rows: in_memory,
                recorded: Arc::clone(&recorded),
                granted: Arc::clone(&granted),
                host_status: host_status.clone(),
                threads: Arc::clone(&threads),
            });
        }
        let statuses: Vec<_> = running.iter().map(|axis| Arc::clone(&axis.status)).collect();
        // What looks at the end of one looks at that of all: they end together.
        let looks_on = Arc::clone(&statuses[0]);
        let ends = Ended(statuses);
        let mut under_way = locked(&threads);
        under_way.push(thread::Builder::new().name("forcefeel-loop".into()).spawn(move || {
            let _ends = ends;
            let period_ns = nanoseconds(period_s);
            if real_time {
                let (given, _held) = ask(PRIORITY, true);
                let _ = granted.set(given);
                run.run(&mut Monotonic::new(period_s), period_ns, beats);
            } else {
                run.run(&mut AtOnce::new(period_s), period_ns, beats);
            }
        })?);
        let nap = if real_time { NAP } else { VIRTUAL_NAP };
        let keeper = Keeper { axes: kept, record, recorded, history, nap };
        let keeps = Arc::clone(&looks_on);
        // Of threads that are not given the loop ends where its axes are dropped.
        under_way.push(thread::Builder::new().name("forcefeel-record".into()).spawn(move || keeper.keep(&keeps))?);
        if let Some(link) = link {
            let listen = move || link.listen(&looks_on.ended);
            under_way.push(thread::Builder::new().name("forcefeel-host".into()).spawn(listen)?);
        }
        drop(under_way);
        Ok(running)
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

    /// What was received of a host; nothing where none is listened to.
    pub fn host_status(&self) -> Option<&HostStatus> {
        self.host_status.as_deref()
    }

    /// Bytes of the record, rows that it lacks because it ended before the loop, and why it did, if it did.
    pub fn recorded(&self) -> (u64, u64, Option<&str>) {
        let [bytes, lacks] = [&self.recorded.bytes, &self.recorded.unrecorded].map(|count| count.load(Relaxed));
        (bytes, lacks, self.recorded.ended.get().map(String::as_str))
    }

    /// The numbers of the newest `most` rows of cycles after `since`, one row after the other.
    pub fn history(&self, since: f64, most: usize) -> Vec<f64> {
        let rows = locked(&self.rows);
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
        // Whoever else waits for the end waits here.
        for thread in locked(&self.threads).drain(..) {
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

/// Says that all axes have ended, however they did.
struct Ended(Vec<Arc<Status>>);

impl Drop for Ended {
    fn drop(&mut self) {
        self.0.iter().for_each(|status| status.ended.store(true, Relaxed));
    }
}

/// What is in a lock; nobody leaves it half-written.
fn locked<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What an axis tells.
struct KeptAxis {
    rows: Consumer<Row>,
    requests: Consumer<(u64, LoopRequest)>,
    thinning: Thinning,
    in_memory: Arc<Mutex<VecDeque<Row>>>,
}

/// Takes what the loop tells, for memory and disk.
struct Keeper {
    axes: Vec<KeptAxis>,
    record: Option<Record>,
    recorded: Arc<Recorded>,
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
            if ended && self.axes.iter().all(|axis| axis.rows.is_empty() && axis.requests.is_empty()) {
                break;
            }
            thread::sleep(self.nap);
        }
        self.end(WITH_THE_RUN);
    }

    fn take(&mut self) {
        for place in 0..self.axes.len() {
            self.take_axis(place);
        }
    }

    fn take_axis(&mut self, place: usize) {
        // A request stands in the record before the row that it counts from: that row is told after it.
        let rows: usize = self.axes[place].rows.slots();
        while let Ok((cycle, request)) = self.axes[place].requests.pop() {
            self.write(|record| {
                record.request(place, cycle, &request);
                Ok(())
            });
        }
        for _ in 0..rows {
            let axis = &mut self.axes[place];
            let Ok(row) = axis.rows.pop() else { break };
            for row in axis.thinning.take(row) {
                if self.record.is_none() && self.recorded.ended.get().is_some() {
                    self.recorded.unrecorded.fetch_add(1, Relaxed);
                }
                self.write(|record| {
                    record.row(place, &row);
                    Ok(())
                });
            }
            let mut in_memory = locked(&self.axes[place].in_memory);
            if in_memory.len() >= self.history {
                in_memory.pop_front();
            }
            in_memory.push_back(row);
        }
    }

    /// Writes to the record, and ends it where that fails or it is full; a ring goes on.
    fn write(&mut self, write: impl FnOnce(&mut Record) -> io::Result<()>) {
        let Some(record) = &mut self.record else { return };
        let written = write(record);
        self.recorded.bytes.store(record.bytes(), Relaxed);
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
                    let _ = self.recorded.ended.set(why);
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
        self.recorded.unrecorded.fetch_add(taken - kept, Relaxed);
        let _ = self.recorded.ended.set(why);
    }
}
