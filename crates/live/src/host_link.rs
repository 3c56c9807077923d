//! The socket of an aircraft simulator, in a thread of its own: it receives, checks, and hands packets to the loop by a ring; what the
//! loop has to tell comes back by another.
//!
//! Of several axes a datagram has a packet for each, one after the other in their order, and so has the answer.
//!
//! One host: who spoke first. Another one takes over once that is silent for a second and a person accepts it. What is damaged, of another
//! version, out of order, out of range or of another sender is counted and left out.

use core::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use forcefeel_model::host::packet::{FROM_HOST_BYTES, TO_HOST_BYTES, is_newer};
use forcefeel_model::host::{FromHost, ToHost};
use rtrb::{Consumer, Producer, RingBuffer};
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Packets and answers for which there is room.
const ROOM: usize = 16;
/// How long a packet is waited for before the end is looked for.
const LOOKS: Duration = Duration::from_millis(20);
/// How long an answer is waited for: some cycles of a slow loop.
const ANSWERED: Duration = Duration::from_millis(20);
/// Between two looks for it.
const NAP: Duration = Duration::from_micros(200);
/// Silence after which another host is listened to, and any sequence number is new.
const GONE: Duration = Duration::from_secs(1);

/// The loop's ends of the rings.
pub struct HostRings {
    /// What the host sent.
    pub packets: Consumer<FromHost>,
    /// What it is told.
    pub answers: Producer<ToHost>,
}

/// What is seen of a host.
#[derive(Debug)]
pub struct HostStatus {
    /// Where it is listened to.
    pub at: SocketAddr,
    /// Packets that were handed on.
    pub packets: AtomicU64,
    /// Packets that were left out.
    pub refused: AtomicU64,
    last: Mutex<Option<(SocketAddr, Option<Instant>)>>,
    /// Who else speaks since the host is silent.
    waiting: Mutex<Option<SocketAddr>>,
}

impl HostStatus {
    /// The host, and how long ago it spoke; one that a person has just accepted has not spoken yet.
    pub fn last(&self) -> Option<(SocketAddr, Option<Duration>)> {
        let last = *self.last.lock().unwrap_or_else(PoisonError::into_inner);
        last.map(|(address, at)| (address, at.map(|at| at.elapsed())))
    }

    /// Who else speaks, and waits for a person to accept it.
    pub fn waiting(&self) -> Option<SocketAddr> {
        *self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A person accepts the sender that waits as the host; whether one did.
    pub fn accept(&self) -> bool {
        let accepted = self.waiting.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(address) = accepted {
            *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some((address, None));
        }
        accepted.is_some()
    }

    fn waits(&self, address: Option<SocketAddr>) {
        *self.waiting.lock().unwrap_or_else(PoisonError::into_inner) = address;
    }

    fn speaks(&self, address: SocketAddr) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some((address, Some(Instant::now())));
    }
}

/// The thread's side.
pub struct Link {
    socket: UdpSocket,
    /// Of each axis.
    rings: Vec<(Producer<FromHost>, Consumer<ToHost>)>,
    sequence: u32,
    /// What others see of it.
    pub host_status: Arc<HostStatus>,
}

/// A link over a socket, and the loop's ends of its rings, of so many axes.
///
/// # Errors
/// If the socket is none that can be waited at.
pub fn between(socket: UdpSocket, axes: usize) -> io::Result<(Link, Vec<HostRings>)> {
    socket.set_read_timeout(Some(LOOKS))?;
    let at = socket.local_addr()?;
    let rings = (0..axes).map(|_| {
        let (packets, taken) = RingBuffer::new(ROOM);
        let (replies, answers) = RingBuffer::new(ROOM);
        ((packets, answers), HostRings { packets: taken, answers: replies })
    });
    let (rings, of_loop) = rings.unzip();
    let host_status = Arc::new(HostStatus {
        at,
        packets: AtomicU64::new(0),
        refused: AtomicU64::new(0),
        last: Mutex::default(),
        waiting: Mutex::default(),
    });
    Ok((Link { socket, rings, sequence: 0, host_status }, of_loop))
}

impl Link {
    /// Listens until the loop has ended.
    pub fn listen(mut self, ended: &AtomicBool) {
        let mut bytes = vec![0; FROM_HOST_BYTES * self.rings.len() + 1];
        while !ended.load(Relaxed) {
            // Nothing came in time, or an earlier answer found nobody: both leave nothing to do.
            let Ok((count, from)) = self.socket.recv_from(&mut bytes) else { continue };
            let packets: Option<Vec<_>> =
                bytes[..count].chunks(FROM_HOST_BYTES).map(|packet| FromHost::decode(packet).ok()).collect();
            let taken = packets.is_some_and(|packets| self.take(&packets, from));
            let counter = if taken { &self.host_status.packets } else { &self.host_status.refused };
            counter.fetch_add(1, Relaxed);
            if taken {
                self.answer(from, ended);
            }
        }
    }

    /// Hands packets on, one of each axis, if they are the next of the one host.
    fn take(&mut self, packets: &[FromHost], from: SocketAddr) -> bool {
        let Some(&FromHost { sequence, .. }) = packets.first() else { return false };
        if packets.len() != self.rings.len() || packets.iter().any(|packet| packet.sequence != sequence) {
            return false;
        }
        if let Some((address, ago)) = self.host_status.last() {
            let speaks = ago.is_some_and(|ago| ago < GONE);
            if address != from && !speaks {
                self.host_status.waits(Some(from));
            }
            if address != from || (speaks && !is_newer(sequence, self.sequence)) {
                return false;
            }
        }
        // An answer that came too late is no answer to this.
        for (_, answers) in &mut self.rings {
            while answers.pop().is_ok() {}
        }
        if self.rings.iter().any(|(ring, _)| ring.is_full()) {
            return false;
        }
        for ((ring, _), packet) in self.rings.iter_mut().zip(packets) {
            // There is room: nobody else puts anything into it.
            let _ = ring.push(*packet);
        }
        self.sequence = sequence;
        self.host_status.speaks(from);
        self.host_status.waits(None);
        true
    }

    /// Sends the loop's answer when it is there; a loop that gives none in time is left alone.
    fn answer(&mut self, to: SocketAddr, ended: &AtomicBool) {
        let until = Instant::now() + ANSWERED;
        let mut answer = Vec::with_capacity(TO_HOST_BYTES * self.rings.len());
        for (_, answers) in &mut self.rings {
            loop {
                if let Ok(of_axis) = answers.pop() {
                    answer.extend(of_axis.encode());
                    break;
                }
                if Instant::now() >= until || ended.load(Relaxed) {
                    return;
                }
                thread::sleep(NAP);
            }
        }
        // A host that cannot be reached misses it, and sends again.
        let _ = self.socket.send_to(&answer, to);
    }
}
