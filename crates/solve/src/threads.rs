//! Threads for work that falls into pieces.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::LazyLock;
use std::thread::available_parallelism;

/// Cores that this process may use.
static CORES: LazyLock<usize> = LazyLock::new(|| available_parallelism().map_or(1, usize::from));

/// A pool of so many threads, but one at least, and no more than there are cores: more would only wait for one another.
///
/// # Panics
/// If the system gives no threads.
pub(crate) fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads.clamp(1, *CORES)).build().expect("threads")
}
