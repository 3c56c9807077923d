//! A CAN interface of Linux, such as `can0`. No bus has been tried with it yet.

use crate::carrier::Carrier;
use forcefeel_bus::frame::Frame;
use forcefeel_bus::line::Line;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use socketcan::{CanAnyFrame, CanFdFrame, CanFdSocket, CanFrame, EmbeddedFrame, Frame as _, Socket, SocketOptions};
use std::io;
use std::time::Duration;

/// An open interface.
#[derive(Debug)]
pub struct SocketCan(CanFdSocket);

impl SocketCan {
    /// Opens an interface, which is up.
    ///
    /// # Errors
    /// If there is none.
    pub fn open(name: &str) -> io::Result<Self> {
        let socket = CanFdSocket::open(name)?;
        socket.set_nonblocking(true)?;
        socket.set_error_filter_accept_all()?;
        Ok(Self(socket))
    }
}

impl Carrier for SocketCan {
    fn send(&mut self, frame: &Frame) {
        let made = if frame.fd {
            CanFdFrame::from_raw_id(frame.id, frame.data()).map(CanAnyFrame::from)
        } else if frame.remote {
            CanFrame::remote_from_raw_id(frame.id, 8).map(CanAnyFrame::from)
        } else {
            CanFrame::from_raw_id(frame.id, frame.data()).map(CanAnyFrame::from)
        };
        // One that finds no room is lost.
        let _ = made.map(|made| self.0.write_frame(&made));
    }

    fn next(&mut self) -> Option<Line> {
        let came = self.0.read_frame().ok()?;
        let of = |mut frame: Frame| {
            frame.extended = came.is_extended();
            Line::Frame(frame)
        };
        Some(match &came {
            CanAnyFrame::Normal(data) => of(Frame::new(came.raw_id(), data.data())),
            CanAnyFrame::Fd(data) => of(Frame::fd(came.raw_id(), data.data())),
            CanAnyFrame::Remote(_) => Line::Other,
            CanAnyFrame::Error(_) => Line::Error,
        })
    }

    fn wait(&self, most: Duration) {
        let most = Timespec::try_from(most).ok();
        let _ = poll(&mut [PollFd::new(&self.0, PollFlags::IN)], most.as_ref());
    }
}
