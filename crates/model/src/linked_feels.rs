//! What both feel computers of an electronic link work out at a sample: force and damping on each feel, and which pilot has priority.

use crate::Scalar;
use crate::link::{ElectronicLink, LINK_ROWS, PilotLink, Priority};

/// An electronic link from sample to sample.
#[derive(Debug, Clone, Copy)]
pub struct LinkedFeels<S: Scalar> {
    /// The angles that it has seen.
    pub electronic: ElectronicLink<S>,
    /// Who has priority by force.
    pub priority: Priority<S>,
    /// Whether it is open.
    pub open: S::Mask,
    injected: [S; 2],
    grip_arms: [S; 2],
    uncouples: bool,
}

/// What it is given at a sample.
#[derive(Debug, Clone, Copy)]
pub struct LinkInputs<S: Scalar> {
    /// Angle and rate of both programmed controls.
    pub motion: [[S; 2]; 2],
    /// Force of each hand.
    pub hands: [S; 2],
    /// Whether each pilot presses the priority button.
    pub pressed: [S::Mask; 2],
    /// Whether it is to open; it stays open.
    pub disconnect: S::Mask,
}

/// What it gives.
#[derive(Debug, Clone, Copy)]
pub struct LinkOutputs<S: Scalar> {
    /// Torque on each feel in N m.
    pub torques: [S; 2],
    /// The same as a force at each grip in N.
    pub forces: [S; 2],
    /// Damping on each feel in N m s/rad.
    pub damping: [S; 2],
    /// Which pilot has priority.
    pub priority: [S::Mask; 2],
    /// Whether it is open or beyond its breakout.
    pub gives_way: S::Mask,
}

impl<S: Scalar> LinkedFeels<S> {
    /// From values in the order of its table, with so many periods `h` of delay, between controls that have rested so.
    pub fn new(
        values: &[S; LINK_ROWS],
        (delay, h): (usize, S),
        uncouples: bool,
        grip_arms: [S; 2],
        resting: [[S; 2]; 2],
    ) -> Self {
        let electronic = ElectronicLink::new(PilotLink::from_values(values), delay, resting);
        let (priority, injected) = (Priority::from_values(values), electronic.injected(h));
        Self { electronic, priority, open: h.less(h), injected, grip_arms, uncouples }
    }

    /// At a sample. A pilot with priority has the own feel alone, which the other's control follows.
    #[inline(always)]
    pub fn sampled(&mut self, inputs: &LinkInputs<S>) -> LinkOutputs<S> {
        let seen = self.electronic.sampled(inputs.motion);
        let link = self.electronic.link();
        let [gives_way, other] = seen.map(|[phi, _]| link.gives_way(phi));
        self.open = self.open | inputs.disconnect;
        if self.uncouples {
            self.open = self.open | gives_way | other;
        }
        let priority = self.priority.of_hands(inputs.hands, inputs.pressed);
        let on = |side: usize, number: S| S::select(self.open | priority[side], number.zero(), number);
        let torques = [0, 1].map(|side| on(side, link.on_each(link.torque(seen[side]))[side]));
        LinkOutputs {
            torques,
            forces: [0, 1].map(|side| torques[side] / self.grip_arms[side]),
            damping: [0, 1].map(|side| on(side, self.injected[side])),
            priority,
            gives_way: self.open | gives_way,
        }
    }
}
