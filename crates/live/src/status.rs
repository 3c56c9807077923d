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
    /// The supervisor's state.
    pub state: AtomicU32,
    /// The supervisor's trips.
    pub trips: AtomicU32,
    /// The loop is asked to end.
    pub end: AtomicBool,
    /// It has ended.
    pub ended: AtomicBool,
    /// How late the thread woke.
    pub late: Histogram,
    /// How long it worked.
    pub work: Histogram,
}

/// Counts of durations, in steps that grow with the duration: eight to each doubling.
#[derive(Debug)]
pub struct Histogram([AtomicU64; BUCKETS]);

/// Steps of a histogram: up to 2^35 ns, 34 s.
pub const BUCKETS: usize = (35 - FINE as usize + 1) << FINE;

/// Steps in a doubling, as a power of two.
const FINE: u32 = 3;

impl Default for Histogram {
    fn default() -> Self {
        Self([const { AtomicU64::new(0) }; BUCKETS])
    }
}

impl Histogram {
    /// Counts a duration.
    pub fn count(&self, ns: u64) {
        let bucket = &self.0[bucket(ns)];
        // One thread writes: no need to add in one go.
        bucket.store(bucket.load(Ordering::Relaxed) + 1, Ordering::Relaxed);
    }

    /// The counts.
    pub fn counts(&self) -> [u64; BUCKETS] {
        core::array::from_fn(|k| self.0[k].load(Ordering::Relaxed))
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
    let found = if octave < FINE {
        ns
    } else {
        let part = (ns >> (octave - FINE)) & ((1 << FINE) - 1);
        (u64::from(octave - FINE + 1) << FINE) + part
    };
    usize::try_from(found).map_or(BUCKETS - 1, |found| found.min(BUCKETS - 1))
}
