//! A serial port, raw and without waiting: a real one, or a pseudo terminal that somebody else opens as one.

#[cfg(not(unix))]
pub use elsewhere::Serial;
#[cfg(unix)]
pub use unix::Serial;

#[cfg(unix)]
mod unix {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::fs::{FlockOperation, Mode, OFlags, fcntl_setfl, flock, open};
    use rustix::io::{Errno, read, write};
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
    use std::ffi::OsString;
    use std::io;
    use std::os::fd::{AsFd, OwnedFd};
    use std::os::unix::ffi::OsStringExt;
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    /// Of a moteus at a plain serial port; a USB adapter has a speed of its own.
    const BAUD: u32 = 921_600;

    /// An open port.
    #[derive(Debug)]
    pub struct Serial {
        port: OwnedFd,
        /// The other end of a pseudo terminal, kept open so that its settings stay where nobody has it open.
        _other: Option<OwnedFd>,
    }

    impl Serial {
        /// Opens a port, which nobody else has open.
        ///
        /// # Errors
        /// If there is none, or another program has it.
        pub fn open(path: &Path) -> io::Result<Self> {
            let port = open(path, OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC, Mode::empty())?;
            flock(&port, FlockOperation::NonBlockingLockExclusive)
                .map_err(|_| io::Error::other("another program has it open"))?;
            raw(&port)?;
            Ok(Self { port, _other: None })
        }

        /// A pseudo terminal, and the path at which others open its other end.
        ///
        /// # Errors
        /// If the system gives none.
        pub fn pseudo() -> io::Result<(Self, PathBuf)> {
            let port = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
            grantpt(&port)?;
            unlockpt(&port)?;
            let path = PathBuf::from(OsString::from_vec(ptsname(&port, Vec::new())?.into_bytes()));
            let other = open(&path, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty())?;
            raw(&other)?;
            fcntl_setfl(&port, OFlags::NONBLOCK)?;
            Ok((Self { port, _other: Some(other) }, path))
        }

        /// The bytes that have come, as many as there is room for.
        pub fn read(&self, bytes: &mut [u8]) -> usize {
            read(&self.port, bytes).unwrap_or(0)
        }

        /// Writes what there is room for; how many bytes that was.
        pub fn write(&self, bytes: &[u8]) -> usize {
            match write(&self.port, bytes) {
                Err(Errno::INTR) => self.write(bytes),
                written => written.unwrap_or(0),
            }
        }

        /// Waits until something has come, for so long at most.
        pub fn wait(&self, most: Duration) {
            let most = Timespec::try_from(most).ok();
            let _ = poll(&mut [PollFd::new(&self.port, PollFlags::IN)], most.as_ref());
        }
    }

    fn raw(port: impl AsFd) -> io::Result<()> {
        let mut settings = tcgetattr(&port).map_err(|_| io::Error::other("is no serial port"))?;
        settings.make_raw();
        settings.set_speed(BAUD)?;
        Ok(tcsetattr(&port, OptionalActions::Flush, &settings)?)
    }
}

#[cfg(not(unix))]
mod elsewhere {
    use std::io;
    use std::path::{Path, PathBuf};
    use std::time::Duration;

    /// No port.
    #[derive(Debug)]
    pub struct Serial;

    impl Serial {
        /// No port.
        ///
        /// # Errors
        /// Always.
        pub fn open(_: &Path) -> io::Result<Self> {
            Err(io::Error::new(io::ErrorKind::Unsupported, "expected Linux or macOS for a bus"))
        }

        /// No terminal.
        ///
        /// # Errors
        /// Always.
        pub fn pseudo() -> io::Result<(Self, PathBuf)> {
            Err(io::Error::new(io::ErrorKind::Unsupported, "expected Linux or macOS for a pseudo terminal"))
        }

        /// Nothing comes.
        pub fn read(&self, _: &mut [u8]) -> usize {
            0
        }

        /// Nothing goes.
        pub fn write(&self, _: &[u8]) -> usize {
            0
        }

        /// Nothing to wait for.
        pub fn wait(&self, _: Duration) {}
    }
}
