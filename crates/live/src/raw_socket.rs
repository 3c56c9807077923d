//! A network interface of Linux for frames of EtherCAT alone, without waiting.

use forcefeel_bus::ethercat::datagram::ETHERTYPE;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::fs::{FlockOperation, Mode, OFlags, flock, open};
use rustix::net::netdevice::name_to_index;
use socket2::{Domain, Protocol, SockAddr, SockAddrStorage, Socket, Type};
use std::io;
use std::os::fd::OwnedFd;
use std::time::Duration;

/// An open interface.
#[derive(Debug)]
pub struct RawSocket {
    socket: Socket,
    /// Held while it is open.
    _lock: OwnedFd,
}

impl RawSocket {
    /// Opens an interface, which nobody else has open for this.
    ///
    /// # Errors
    /// If there is none, another program has it, or raw sockets are not permitted.
    pub fn open(name: &str) -> io::Result<Self> {
        let path = format!("/sys/class/net/{name}/ifindex");
        let lock = open(path, OFlags::RDONLY | OFlags::CLOEXEC, Mode::empty()).map_err(|_| {
            io::Error::new(io::ErrorKind::NotFound, "expected a network interface, got none of this name; see ip link")
        })?;
        flock(&lock, FlockOperation::NonBlockingLockExclusive)
            .map_err(|_| io::Error::other("another program has it open"))?;
        let kind = Type::RAW.nonblocking().cloexec();
        // With protocol zero nothing comes before it is bound to the interface.
        let socket = Socket::new(Domain::PACKET, kind, Some(Protocol::from(0))).map_err(|error| {
            let why = "raw sockets are not permitted; run as root, or give the program CAP_NET_RAW";
            if error.kind() == io::ErrorKind::PermissionDenied { io::Error::new(error.kind(), why) } else { error }
        })?;
        let index = name_to_index(&socket, name)?;
        socket.bind(&address(index)?)?;
        Ok(Self { socket, _lock: lock })
    }

    /// Sends a frame, or loses it.
    pub fn send(&self, frame: &[u8]) {
        let _ = self.socket.send(frame);
    }

    /// The frame that has come next: its number of bytes; nothing if there is none.
    pub fn receive(&self, bytes: &mut [u8]) -> Option<usize> {
        rustix::io::read(&self.socket, bytes).ok().filter(|count| *count > 0)
    }

    /// Waits until something has come, for so long at most.
    pub fn wait(&self, most: Duration) {
        let most = Timespec::try_from(most).ok();
        let _ = poll(&mut [PollFd::new(&self.socket, PollFlags::IN)], most.as_ref());
    }
}

/// Frames of EtherCAT at the interface of a number.
#[expect(unsafe_code, reason = "none of the libraries makes an address of this family")]
fn address(interface: u32) -> io::Result<SockAddr> {
    let whole = |_| io::Error::from(io::ErrorKind::InvalidInput);
    let of_frames = libc::sockaddr_ll {
        sll_family: libc::AF_PACKET.try_into().map_err(whole)?,
        sll_protocol: ETHERTYPE.to_be(),
        sll_ifindex: interface.try_into().map_err(whole)?,
        sll_hatype: 0,
        sll_pkttype: 0,
        sll_halen: 0,
        sll_addr: [0; 8],
    };
    let size = size_of_val(&of_frames).try_into().map_err(whole)?;
    let mut storage = SockAddrStorage::zeroed();
    // SAFETY: the storage has room for an address of any family, and this one, of that size, is whole.
    Ok(unsafe {
        *storage.view_as() = of_frames;
        SockAddr::new(storage, size)
    })
}
