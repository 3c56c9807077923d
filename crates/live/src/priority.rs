//! What makes a thread run on time, and what the system gives of it.

/// What the loop's thread was given; where it was not, why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Granted {
    /// First in, first out, at [`PRIORITY`].
    pub fifo: Result<(), String>,
    /// All memory stays in the machine.
    pub locked: Result<(), String>,
    /// The processor does not fall asleep so deeply between cycles that it wakes late.
    pub awake: Result<(), String>,
    /// It stays on a processor that is isolated from other work.
    pub pinned: Result<(), String>,
}

/// The priority that is asked for: below the kernel's own threads at 99, above most else.
pub const PRIORITY: u8 = 80;

/// What was given is given back where this is dropped; the priority ends with its thread.
#[derive(Debug)]
pub struct Held {
    #[cfg(target_os = "linux")]
    _awake: Option<std::fs::File>,
}

/// Asks for all of them, for the thread that calls, at a priority up to [`PRIORITY`]; `pins`: also for one processor.
#[cfg(target_os = "linux")]
pub fn ask(priority: u8, pins: bool) -> (Granted, Held) {
    use rustix::mm::{MlockAllFlags, mlockall};
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
        thread_native_id,
    };
    let policy = ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo);
    let wanted = priority.try_into().map(ThreadPriority::Crossplatform);
    let fifo = wanted.and_then(|wanted| {
        set_thread_priority_and_policy(thread_native_id(), wanted, policy).map_err(|error| format!("{error:?}"))
    });
    // Pages that a Python process never touches need not be fetched.
    let flags = MlockAllFlags::CURRENT | MlockAllFlags::FUTURE | MlockAllFlags::ONFAULT;
    let locked = mlockall(flags).map_err(|error| error.to_string());
    let (awake, file) = keep_awake().map_or_else(|error| (Err(error.to_string()), None), |file| (Ok(()), Some(file)));
    let isolated = || std::fs::read_to_string("/sys/devices/system/cpu/isolated").unwrap_or_default();
    let pinned = if pins { pin(&isolated()) } else { Err("not asked for".into()) };
    (Granted { fifo, locked, awake, pinned }, Held { _awake: file })
}

/// Keeps the thread that calls on the last processor of a list such as `1-3,6`, of those that are isolated.
///
/// Without an isolated processor the thread is not pinned: pinned to a shared one, six axes at 2 kHz missed 34 periods in eight runs of 6 s,
/// and 20 if the kernel chose the processor.
///
/// # Errors
/// If there is none, or the system refuses.
#[cfg(target_os = "linux")]
pub fn pin(isolated: &str) -> Result<(), String> {
    use rustix::thread::{CpuSet, sched_setaffinity};
    let last = isolated.trim().rsplit([',', '-']).next().and_then(|last| last.parse().ok());
    let Some(processor) = last.filter(|processor| *processor < CpuSet::MAX_CPU) else {
        return Err("no isolated processor".into());
    };
    let mut set = CpuSet::new();
    set.set(processor);
    sched_setaffinity(None, &set).map_err(|error| error.to_string())
}

/// Asks that no processor take longer than 0 us to wake, for as long as the file is open: Linux' "PM quality of service". Without it an idle
/// processor halts between two cycles, and the wake-up comes some ten microseconds later.
#[cfg(target_os = "linux")]
fn keep_awake() -> std::io::Result<std::fs::File> {
    use std::io::Write;
    let mut file = std::fs::OpenOptions::new().write(true).open("/dev/cpu_dma_latency")?;
    file.write_all(&0_i32.to_ne_bytes())?;
    Ok(file)
}

#[cfg(target_os = "linux")]
impl Drop for Held {
    fn drop(&mut self) {
        // Nothing is lost where it fails.
        let _ = rustix::mm::munlockall();
    }
}

/// Other systems than Linux are for trying out.
#[cfg(not(target_os = "linux"))]
pub fn ask(_: u8, _: bool) -> (Granted, Held) {
    let none = || Err("only on Linux".to_string());
    (Granted { fifo: none(), locked: none(), awake: none(), pinned: none() }, Held {})
}
