//! When a cycle begins: at the beat of an absolute clock, or at once.

/// What makes a loop wait.
pub trait Clock {
    /// Waits for the next beat.
    fn wait(&mut self) -> Woken;
    /// Nanoseconds since the start.
    fn now_ns(&self) -> u64;
}

/// How a wait ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Woken {
    /// How late, in ns.
    pub late_ns: u64,
    /// Whole beats that went by meanwhile: they are counted, and not made up for.
    pub missed: u64,
}

/// Virtual time: every beat is there at once.
#[derive(Debug, Clone, Copy)]
pub struct AtOnce {
    beats: u64,
    period_ns: u64,
}

impl AtOnce {
    /// Beats `period_s` apart.
    pub fn new(period_s: f64) -> Self {
        Self { beats: 0, period_ns: nanoseconds(period_s) }
    }
}

impl Clock for AtOnce {
    fn wait(&mut self) -> Woken {
        self.beats += 1;
        Woken { late_ns: 0, missed: 0 }
    }

    fn now_ns(&self) -> u64 {
        self.beats * self.period_ns
    }
}

/// Real time: the monotonic clock of the machine.
#[derive(Debug)]
pub struct Monotonic {
    /// What beats are waited for and lateness is counted from. One origin: of two, taken a page fault apart, each beat would seem late by as
    /// much.
    start: system::Start,
    period_ns: u64,
    /// Beat that is waited for next, in ns from the start.
    next_ns: u64,
}

impl Monotonic {
    /// Beats `period_s` apart, from now on.
    pub fn new(period_s: f64) -> Self {
        let period_ns = nanoseconds(period_s);
        Self { start: system::Start::now(), period_ns, next_ns: period_ns }
    }
}

impl Clock for Monotonic {
    fn wait(&mut self) -> Woken {
        self.start.sleep_until(self.next_ns);
        let late_ns = self.now_ns().saturating_sub(self.next_ns);
        let missed = late_ns / self.period_ns;
        self.next_ns += (missed + 1) * self.period_ns;
        Woken { late_ns, missed }
    }

    fn now_ns(&self) -> u64 {
        self.start.elapsed_ns()
    }
}

/// Nanoseconds of a period.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a period of 1 us to 1 s")]
pub fn nanoseconds(period_s: f64) -> u64 {
    ((period_s * 1e9).round() as u64).max(1)
}

#[cfg(target_os = "linux")]
mod system {
    use rustix::thread::{ClockId, clock_nanosleep_absolute};
    use rustix::time::{Timespec, clock_gettime};

    /// A moment of the system's clock.
    #[derive(Debug)]
    pub struct Start(Timespec);

    impl Start {
        pub fn now() -> Self {
            Self(clock_gettime(rustix::time::ClockId::Monotonic))
        }

        pub fn elapsed_ns(&self) -> u64 {
            let now = Self::now().0;
            let ns = (now.tv_sec - self.0.tv_sec) * SECOND_I + now.tv_nsec - self.0.tv_nsec;
            u64::try_from(ns).unwrap_or(0)
        }

        /// Sleeps until an absolute time, so that no error adds up.
        pub fn sleep_until(&self, ns: u64) {
            let (s, ns) = (i64::try_from(ns / SECOND).unwrap_or(i64::MAX), i64::try_from(ns % SECOND).unwrap_or(0));
            let sum = self.0.tv_nsec + ns;
            let carry = i64::from(sum >= SECOND_I);
            let then = Timespec { tv_sec: self.0.tv_sec + s + carry, tv_nsec: sum - carry * SECOND_I };
            // A signal ends the sleep early; the time is absolute, so it is slept on.
            while clock_nanosleep_absolute(ClockId::Monotonic, &then)
                .is_err_and(|error| error == rustix::io::Errno::INTR)
            {}
        }
    }

    const SECOND: u64 = 1_000_000_000;
    const SECOND_I: i64 = 1_000_000_000;
}

#[cfg(not(target_os = "linux"))]
mod system {
    use std::time::{Duration, Instant};

    /// A moment; other systems than Linux are for trying out.
    #[derive(Debug)]
    pub struct Start(Instant);

    impl Start {
        pub fn now() -> Self {
            Self(Instant::now())
        }

        /// Nanoseconds since, for less than 500 years.
        pub fn elapsed_ns(&self) -> u64 {
            u64::try_from(self.0.elapsed().as_nanos()).unwrap_or(u64::MAX)
        }

        pub fn sleep_until(&self, ns: u64) {
            std::thread::sleep((self.0 + Duration::from_nanos(ns)).saturating_duration_since(Instant::now()));
        }
    }
}
