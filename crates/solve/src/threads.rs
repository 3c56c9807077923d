//! Threads for work that falls into pieces.

use core::fmt;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::thread::available_parallelism;

/// The system gives no threads.
#[derive(Debug)]
pub struct NoThreads(ThreadPoolBuildError);

impl fmt::Display for NoThreads {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "threads: the system gives none ({}); free some of its resources, or raise its limits", self.0)
    }
}

impl core::error::Error for NoThreads {}

/// A pool of so many threads, but one at least, and no more than there are cores: more would only wait for one another. How many this
/// process may use is asked each time, since it may be held to fewer for a while.
///
/// # Errors
/// If the system gives no threads.
pub fn pool(threads: usize) -> Result<ThreadPool, NoThreads> {
    let cores = available_parallelism().map_or(1, usize::from);
    ThreadPoolBuilder::new().num_threads(threads.clamp(1, cores)).build().map_err(NoThreads)
}
