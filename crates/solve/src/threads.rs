//! Threads for work that falls into pieces.

use core::fmt;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::sync::LazyLock;
use std::thread::available_parallelism;

/// Cores that this process may use.
static CORES: LazyLock<usize> = LazyLock::new(|| available_parallelism().map_or(1, usize::from));

/// The system gives no threads.
#[derive(Debug)]
pub struct NoThreads(ThreadPoolBuildError);

impl fmt::Display for NoThreads {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "threads: the system gives none ({}); free some of its resources, or raise its limits", self.0)
    }
}

impl core::error::Error for NoThreads {}

/// A pool of so many threads, but one at least, and no more than there are cores: more would only wait for one another.
pub(crate) fn pool(threads: usize) -> Result<ThreadPool, NoThreads> {
    ThreadPoolBuilder::new().num_threads(threads.clamp(1, *CORES)).build().map_err(NoThreads)
}
