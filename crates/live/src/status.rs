//! What the rest of the process sees of the loop at once: numbers that the loop's thread writes without a lock.

use core::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};

/// How the loop does.
#[derive(Debug, Default)]
pub struct Status {
    /// Cycles worked out.
    pub cycles: AtomicU64,
    /// Beats of the clock, those that were missed among them.
    pub beats: AtomicU64,
    /// Beats that were missed.
    pub missed: AtomicU64,
    /// Cycles without a sample.
    pub silent: AtomicU64,
    /// Rows that found no room in their ring.
    pub lost: AtomicU64,
    /// Packets of a host that were softened.
    pub softened: AtomicU64,
    /// The supervisor's state.
    pub state: AtomicU32,
    /// The supervisor's trips.
    pub trips: AtomicU32,
    /// What drive or bus complained of last, in the table of faults; zero once nothing is tripped and all is well.
    pub drive_fault: AtomicU32,
    /// The loop is asked to end.
    pub end: AtomicBool,
    /// It has ended.
    pub ended: AtomicBool,
    /// How late the thread woke.
    pub late: Histogram,
    /// How long it worked.
    pub work: Histogram,
}

/// Counts of durations, in steps that grow with the duration, and the longest of them. A step is no wider than a 64th of what it begins
/// with, so its end is above a duration in it by no more than that.
#[derive(Debug)]
pub struct Histogram {
    counts: [AtomicU64; BUCKETS],
    worst_ns: AtomicU64,
}

/// Steps of a histogram: up to 2^35 ns, 34 s.
pub const BUCKETS: usize = (35 - FINE as usize + 1) << FINE;

/// Steps in a doubling, as a power of two.
const FINE: u32 = 6;

impl Default for Histogram {
    fn default() -> Self {
        Self { counts: [const { AtomicU64::new(0) }; BUCKETS], worst_ns: AtomicU64::new(0) }
    }
}

impl Histogram {
    /// Counts a duration.
    pub fn count(&self, ns: u64) {
        let bucket = &self.counts[bucket(ns)];
        // One thread writes: no need to add in one go.
        bucket.store(bucket.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
        self.worst_ns.store(self.worst_ns().max(ns), Ordering::Relaxed);
    }

    /// The counts.
    pub fn counts(&self) -> [u64; BUCKETS] {
        core::array::from_fn(|k| self.counts[k].load(Ordering::Relaxed))
    }

    /// The longest duration in ns; zero before the first.
    pub fn worst_ns(&self) -> u64 {
        self.worst_ns.load(Ordering::Relaxed)
    }

    /// Least duration of a step in ns; one step more than there are ends the last.
    pub fn edge_ns(step: usize) -> u64 {
        let fine = 1 << FINE;
        if step < fine {
            return step as u64;
        }
        let (octave, part) = (step / fine - 1, step % fine);
        ((fine + part) as u64) << octave
    }
}

/// Step that a duration falls in.
fn bucket(ns: u64) -> usize {
    let octave = (ns | 1).ilog2();
    let bucket = if octave < FINE {
        ns
    } else {
        let part = (ns >> (octave - FINE)) & ((1 << FINE) - 1);
        (u64::from(octave - FINE + 1) << FINE) + part
    };
    usize::try_from(bucket).map_or(BUCKETS - 1, |bucket| bucket.min(BUCKETS - 1))
}
