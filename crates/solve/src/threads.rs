//! Threads for work that falls into pieces.

use core::fmt;
use std::io;
use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, available_parallelism, scope};

/// The system gives no threads.
#[derive(Debug)]
pub struct NoThreads(io::Error);

impl fmt::Display for NoThreads {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "threads: the system gives none ({}); free some of its resources, or raise its limits", self.0)
    }
}

impl core::error::Error for NoThreads {}

/// Does `run` with each of `pieces` on so many threads, the one that calls among them: who is free takes the next. One at least, and no more
/// than there are cores: more would only wait for one another. How many this process may use is asked each time, since it may be held to
/// fewer for a while.
///
/// # Errors
/// If the system gives no threads; then nothing is done.
pub fn each<T: Send>(
    threads: usize,
    pieces: impl Iterator<Item = T> + Send,
    run: impl Fn(T) + Sync,
) -> Result<(), NoThreads> {
    let cores = available_parallelism().map_or(1, usize::from);
    let pieces = Mutex::new(Some(pieces));
    let next = || pieces.lock().unwrap_or_else(PoisonError::into_inner).as_mut()?.next();
    let work = || {
        while let Some(piece) = next() {
            run(piece);
        }
    };
    scope(|scope| {
        // Nobody begins before all are there.
        let mut waiting = pieces.lock().unwrap_or_else(PoisonError::into_inner);
        for _ in 1..threads.clamp(1, cores) {
            if let Err(error) = Builder::new().spawn_scoped(scope, work) {
                *waiting = None;
                return Err(NoThreads(error));
            }
        }
        drop(waiting);
        work();
        Ok(())
    })
}
