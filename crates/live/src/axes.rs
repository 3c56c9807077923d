//! The axes of a cockpit in one loop: one thread, one clock, the electronic links between them, and what stops with what.

use crate::clock::{Clock, Woken};
use crate::cycle::Cycles;
use crate::request::LoopRequest;
use core::sync::atomic::Ordering::Relaxed;
use forcefeel_model::linked_feels::LinkedFeels;
use forcefeel_model::supervisor::Function;

/// An axis of a loop.
pub struct Axis {
    /// What it runs.
    pub cycles: Cycles,
    /// Beats of the clock from one of its cycles to the next.
    pub every: u64,
    /// Places of the axes that stop with it.
    pub stops: Vec<usize>,
    /// Whether it was stopped after the last beat.
    pub stopped: bool,
}

/// An electronic link between two axes.
pub struct AxesLink {
    /// Places of its axes.
    pub between: [usize; 2],
    /// Whether it opens and closes as its axes are asked: one between two pilots.
    pub opens: bool,
    /// The link.
    pub feels: LinkedFeels<f64>,
}

/// All axes of a loop.
pub struct Axes {
    /// The axes, at least one.
    pub axes: Vec<Axis>,
    /// Electronic links.
    pub links: Vec<AxesLink>,
    /// Beats so far, those that were missed among them.
    pub beats: u64,
}

impl Axes {
    /// Runs so many beats, or until an axis is asked to end; then all drives are switched off.
    pub fn run(&mut self, clock: &mut impl Clock, period_ns: u64, most: u64) {
        for _ in 0..most {
            if self.axes.iter().any(|axis| axis.cycles.status.end.load(Relaxed)) {
                break;
            }
            let woken = clock.wait();
            self.beat(woken, period_ns);
        }
        for axis in &mut self.axes {
            axis.cycles.end();
        }
    }

    /// One beat: a cycle of each axis that has one now.
    pub fn beat(&mut self, woken: Woken, period_ns: u64) {
        let before = self.beats;
        self.beats += 1 + woken.missed;
        for AxesLink { between: [first, second], opens, feels } in &mut self.links {
            let (first, second) = (*first, *second);
            if due(self.axes[first].every, [before, self.beats], woken, period_ns).is_some()
                && let Ok([one, other]) = self.axes.get_disjoint_mut([first, second])
            {
                let [one, other] = [&mut one.cycles.controller, &mut other.cycles.controller];
                let given = feels.sampled(&one.link_times(), &[one.linked(*opens), other.linked(*opens)]);
                one.link([given.torques[0], given.damping[0]]);
                other.link([given.torques[1], given.damping[1]]);
            }
        }
        for axis in &mut self.axes {
            if let Some(woken) = due(axis.every, [before, self.beats], woken, period_ns) {
                axis.cycles.cycle(woken);
            }
        }
        self.stop_others();
    }

    /// Stops what is to stop with an axis that was stopped in this beat; an emergency stop stops all.
    fn stop_others(&mut self) {
        for place in 0..self.axes.len() {
            let by = self.axes[place].cycles.controller.stopped_by();
            let newly = !by.is_empty() && !self.axes[place].stopped;
            self.axes[place].stopped = !by.is_empty();
            for other in 0..self.axes.len() {
                let stops = by.has(Function::EmergencyStop) || self.axes[place].stops.contains(&other);
                let cycles = &mut self.axes[other].cycles;
                if newly && stops && other != place && cycles.controller.stopped_by().is_empty() {
                    cycles.take(cycles.controller.cycle(), &LoopRequest::OtherAxis);
                }
            }
        }
    }
}

/// How an axis with a cycle each so many beats wakes between two counts of beats: the newest of its beats there is its cycle, those before
/// were missed; nothing where there is none.
pub fn due(every: u64, [before, now]: [u64; 2], woken: Woken, period_ns: u64) -> Option<Woken> {
    let cycles = now / every - before / every;
    let first = (before / every + 1) * every;
    (cycles > 0)
        .then(|| Woken { late_ns: woken.late_ns.saturating_sub((first - before - 1) * period_ns), missed: cycles - 1 })
}
