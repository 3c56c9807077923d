//! What holds between two packets, and when there are none.
//!
//! `u` what a packet says · `y` what holds · `n` samples that the last packets were apart · `h` period
//!
//! When a packet comes, `y` sets out from where it is and reaches `u` in a straight line over as long as the packets are apart, so `y` has
//! no steps whatever the host's rate, and is late by one packet. A packet that comes later than that finds `y` waiting at `u`.
//! While the simulator stands still (total freeze, reposition: ARINC 610), `y` holds; after it `y` takes a second to reach `u`.
//! Packets out of order are left out. Silence is the supervisor's matter: `age` tells it, and its `host_share` leads from `y` to what
//! holds without a host.

use super::packet::{FROM_HOST, FromHost, HOST_NUMBERS, is_newer, switches};

/// Longest time over which a packet's values are approached, in s: of a host with 30 packets a second one may be lost.
const LONGEST_S: f64 = 0.07;
/// Time over which they are approached after a freeze, in s.
const THAWS_S: f64 = 1.0;

/// What came of the packets so far.
#[derive(Debug, Clone, Copy)]
pub struct Stream {
    last: Option<FromHost>,
    now: [f64; HOST_NUMBERS],
    step: [f64; HOST_NUMBERS],
    left: u32,
    age: u32,
    longest: u32,
    /// Samples that are left of the approach after a freeze, and all of them.
    thaws: u32,
    thawing: u32,
    /// Packets that were left out: old, or twice the same.
    pub stale: u32,
}

impl Stream {
    /// Nothing has come yet; a loop with this period in s.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of samples; it saturates")]
    pub fn new(period_s: f64) -> Self {
        Self {
            last: None,
            now: FROM_HOST.map(|(.., none)| f64::from(none)),
            step: [0.0; HOST_NUMBERS],
            left: 0,
            age: 0,
            longest: (LONGEST_S / period_s).max(1.0) as u32,
            thaws: 0,
            thawing: (THAWS_S / period_s).max(1.0) as u32,
            stale: 0,
        }
    }

    /// A packet has come.
    pub fn take(&mut self, packet: &FromHost) {
        // A host that was started anew begins at any number: once it was silent for so long, all are new.
        let silent = self.age > 2 * self.longest;
        if self.last.is_some_and(|last| !silent && !is_newer(packet.sequence, last.sequence)) {
            self.stale = self.stale.saturating_add(1);
            return;
        }
        // The first one has none before it: as slowly as any.
        let over = if self.last.is_none() { self.longest } else { self.age.clamp(1, self.longest) };
        (self.last, self.age) = (Some(*packet), 0);
        if packet.has(switches::FREEZE) {
            (self.left, self.thaws) = (0, self.thawing);
            return;
        }
        let over = over.max(self.thaws);
        for ((step, now), number) in self.step.iter_mut().zip(self.now).zip(packet.numbers) {
            *step = (f64::from(number) - now) / f64::from(over);
        }
        self.left = over;
    }

    /// One sample on.
    pub fn step(&mut self) {
        self.age = self.age.saturating_add(1);
        if !self.last.is_some_and(|last| last.has(switches::FREEZE)) {
            self.thaws = self.thaws.saturating_sub(1);
        }
        let Some(last) = &self.last else { return };
        if self.left == 0 {
            return;
        }
        self.left -= 1;
        for ((now, step), number) in self.now.iter_mut().zip(self.step).zip(last.numbers) {
            // At its end the value is the packet's own, without what rounding left.
            *now = if self.left == 0 { f64::from(number) } else { *now + step };
        }
    }

    /// Samples since the last packet; nothing before the first.
    pub fn age(&self) -> Option<u32> {
        self.last.map(|_| self.age)
    }

    /// What holds now, of which the host has `share` and the default the rest.
    pub fn values(&self, share: f64) -> [f64; HOST_NUMBERS] {
        core::array::from_fn(|k| {
            let none = f64::from(FROM_HOST[k].4);
            none + share * (self.now[k] - none)
        })
    }

    /// The switches of the last packet; off once the host has no share any more.
    pub fn switches(&self, share: f64) -> u32 {
        self.last.filter(|_| share > 0.0).map_or(0, |last| last.switches)
    }
}
