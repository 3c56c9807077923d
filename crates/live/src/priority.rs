//! What makes a thread run on time, and what the system gives of it.

/// What the loop's thread was given.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Granted {
    /// First in, first out, at this priority; why not.
    pub fifo: Result<u8, String>,
    /// All memory stays in the machine; why not.
    pub locked: Result<(), String>,
}

/// The priority that is asked for: below the kernel's own threads at 99, above most else.
pub const PRIORITY: u8 = 80;

/// Asks for both, for the thread that calls.
#[cfg(target_os = "linux")]
pub fn ask() -> Granted {
    use rustix::mm::{MlockAllFlags, mlockall};
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
        thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let wanted = PRIORITY.try_into().map(ThreadPriority::Crossplatform);
    let fifo = wanted
        .and_then(|wanted| {
            set_thread_priority_and_policy(thread_native_id(), wanted, policy).map_err(|error| format!("{error:?}"))
        })
        .map(|()| PRIORITY);
    // Pages that a Python process never touches need not be fetched.
    let flags = MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT;
    let locked = mlockall(flags).map_err(|error| error.to_string());
    Granted { fifo, locked }
}

/// Lets the memory go again.
pub fn give_back() {
    #[cfg(target_os = "linux")]
    // Nothing is lost where it fails.
    let _ = rustix::mm::munlockall();
}

/// Other systems than Linux are for trying out.
#[cfg(not(target_os = "linux"))]
pub fn ask() -> Granted {
    let none = || "only on Linux".to_string();
    Granted { fifo: Err(none()), locked: Err(none()) }
}
