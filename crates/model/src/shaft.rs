//! A shaft between two columns, with the body at its middle if it has one, from step to step.
//!
//! Its torque on each changes evenly through a step, from its value at the start to that at the end. The end is found twice: first from the rates at
//! the start, then from a step under that torque. So a pair is of the second order in the step, whatever the order of its columns.

use crate::link::{LINK_ROWS, Middle, PilotLink};

/// Times that a step is taken under a torque that ends as the last one found it.
const CORRECTIONS: usize = 2;

/// Angle and rate.
type Motion = [f64; 2];

/// A shaft, and where it is.
#[derive(Debug, Clone, Copy)]
pub struct Shaft {
    /// The whole of it, or the half on each side of the middle.
    link: PilotLink<f64>,
    middle: Option<Middle<f64>>,
    uncouples: bool,
    /// Whether it is open; both halves are then.
    pub open: bool,
    columns: [Motion; 2],
    body: Motion,
}

impl Shaft {
    /// From values in the order of its table, between columns at rest at two angles; whether it stays open once it has given way.
    pub fn new(values: &[f64; LINK_ROWS], uncouples: bool, angles: [f64; 2]) -> Self {
        let (link, middle) = PilotLink::parted(values, |value| value);
        let body = middle.map_or([0.0; 2], |middle| middle.resting(&link, angles));
        Self { link, middle, uncouples, open: false, columns: angles.map(|angle| [angle, 0.0]), body }
    }

    /// A rate in rad/s that no mode of columns on a shaft is above, from its values and the inverse inertia of each.
    pub fn fastest(values: &[f64; LINK_ROWS], [first, second]: [f64; 2]) -> f64 {
        let (link, middle) = PilotLink::parted(values, |value| value);
        let of_both = first + link.on_each(link.on_each(1.0)[1])[1] * second;
        // The largest eigenvalue of a sum of springs is at most the sum of theirs.
        link.rate(of_both + middle.map_or(0.0, |middle| 2.0 * middle.per_inertia()))
    }

    /// Torque on the first column, on the second, and on the body, of columns and a body that move so.
    fn torques(&self, [first, second]: [Motion; 2], body: Motion) -> [f64; 3] {
        if self.open {
            return [0.0; 3];
        }
        if self.middle.is_none() {
            let [on_first, on_second] = self.link.on_each(self.link.torque(self.link.beyond(first, second)));
            return [on_first, on_second, 0.0];
        }
        let of_first = self.link.torque([first[0] - body[0], first[1] - body[1]]);
        let of_second = self.link.torque(self.link.beyond(body, second));
        [-of_first, self.link.on_each(of_second)[1], of_first - of_second]
    }

    /// Torque on each column at the start of the step.
    pub fn on_each(&self) -> [f64; 2] {
        let [on_first, on_second, _] = self.torques(self.columns, self.body);
        [on_first, on_second]
    }

    /// Takes a step of `h`: `advance` takes the step of both columns, the torques on them ending so, and gives angle and rate of each. It is called anew
    /// for each better torque.
    pub fn step(&mut self, h: f64, mut advance: impl FnMut([f64; 2]) -> [Motion; 2]) {
        let carried = |[angle, rate]: Motion| [angle + h * rate, rate];
        let start = self.torques(self.columns, self.body);
        let (mut columns, mut body) = (self.columns.map(carried), carried(self.body));
        for _ in 0..CORRECTIONS {
            let [on_first, on_second, on_body] = self.torques(columns, body);
            columns = advance([on_first, on_second]);
            if let Some(middle) = self.middle {
                body = middle.advance(self.body, h, f64::midpoint(start[2], on_body));
            }
        }
        (self.columns, self.body) = (columns, body);
        self.open |= self.uncouples && self.gives_way();
    }

    /// Whether a part of it is beyond its breakout.
    pub fn gives_way(&self) -> bool {
        let [first, second] = self.columns;
        let parts = if self.middle.is_some() {
            [first[0] - self.body[0], self.link.beyond(self.body, second)[0]]
        } else {
            [self.link.beyond(first, second)[0]; 2]
        };
        parts.iter().any(|&phi| self.link.gives_way(phi))
    }
}
