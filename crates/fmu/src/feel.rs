//! Changes of the feel while an FMU runs, as a live loop and a simulation make them: its force goes over as `3 s^2 - 2 s^3` of the
//! share `s` of the change that is over, so that neither the force nor its rate jumps.

use serde::{Deserialize, Serialize};

/// What the feel is programmed to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Programmed {
    /// Values of the parameter table, of which those of the feel count.
    pub values: Vec<f64>,
    /// Place of the setting whose law holds.
    pub setting: usize,
}

/// A change under way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Change {
    pub to: Programmed,
    pub begin: usize,
    pub end: usize,
}

/// The feel over time, which is counted in steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Feel {
    pub now: Programmed,
    pub change: Option<Change>,
    /// What was asked for last; it begins when no change is under way.
    waiting: Option<Programmed>,
}

impl Feel {
    pub fn new(now: Programmed) -> Self {
        Self { now, change: None, waiting: None }
    }

    /// Asks for another feel.
    pub fn ask(&mut self, wanted: Programmed) {
        self.waiting = Some(wanted);
    }

    /// The feel that was asked for last.
    pub fn wanted(&self) -> &Programmed {
        let under_way = self.change.as_ref().map(|change| &change.to);
        self.waiting.as_ref().or(under_way).unwrap_or(&self.now)
    }

    /// Begins the change that waits, if none is under way, over so many steps: the feel to go over to.
    pub fn begin(&mut self, step: usize, steps: usize) -> Option<&Programmed> {
        if self.change.is_none()
            && let Some(to) = self.waiting.take()
        {
            let change = self.change.insert(Change { to, begin: step, end: step.saturating_add(steps.max(1)) });
            return Some(&change.to);
        }
        None
    }

    /// Ends the change that is over.
    pub fn end(&mut self, step: usize) -> bool {
        if let Some(change) = self.change.take_if(|change| step >= change.end) {
            self.now = change.to;
            return true;
        }
        false
    }

    /// How far a change is at a step.
    pub fn fade(&self, step: usize) -> f64 {
        self.change.as_ref().map_or(0.0, |&Change { begin, end, .. }| {
            let share = (count(step.saturating_sub(begin)) / count(end - begin)).min(1.0);
            share * share * (3.0 - 2.0 * share)
        })
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of steps, far below 2^52")]
pub(crate) fn count(steps: usize) -> f64 {
    steps as f64
}
