//! Room on the disk, taken before it is needed, so that what is written into it cannot fail for want of it.

use std::fs::File;
use std::io;

/// Takes the bytes of a file from `from` to `to`; its length stays.
///
/// # Errors
/// If the disk has not so many.
#[cfg(target_os = "linux")]
pub fn reserve(file: &File, from: u64, to: u64) -> io::Result<()> {
    use rustix::fs::{FallocateFlags, fallocate, fstatvfs};
    use rustix::io::Errno;
    if to <= from {
        return Ok(());
    }
    match fallocate(file, FallocateFlags::KEEP_SIZE, from, to - from) {
        // A file system that cannot set room aside can still say how much there is.
        Err(Errno::OPNOTSUPP | Errno::NOSYS) => {
            let disk = fstatvfs(file)?;
            if disk.f_bavail.saturating_mul(disk.f_frsize) < to - from {
                return Err(Errno::NOSPC.into());
            }
            Ok(())
        }
        taken => Ok(taken?),
    }
}

/// Other systems than Linux are for trying out.
///
/// # Errors
/// None.
#[cfg(not(target_os = "linux"))]
pub fn reserve(_file: &File, _from: u64, _to: u64) -> io::Result<()> {
    Ok(())
}
