//! An electronic link between two running loaders: its torque acts in both feel computers, its share comes and goes with both feels.
//!
//! `s` share of the link · `s_1`, `s_2` shares of both feels · `T`, `c` torque and damping of the link, see
//! [`link`](crate::link) · `h` period · `t_f` time in which a feel comes
//!
//! `s` goes to `s_1 s_2` by at most `h / t_f` a period; each feel is given `s T` and the damping `s c`. `T` stays as it is once a feel is gone,
//! which jumps to its column then. So neither a start, a trip of one side, an opening nor a closing is felt as a step. A link that uncouples at
//! its breakout is open at once. The side with priority is given nothing, the other side all: either comes and goes over `t_f` too.

use crate::link::{ElectronicLink, LINK_ROWS, PilotLink, Priority};

/// One side of a link before a cycle.
#[derive(Debug, Clone, Copy)]
pub struct LinkedFeel {
    /// Angle and rate of its programmed control, in rad and rad/s.
    pub programmed: [f64; 2],
    /// Share of its feel that is there, 0 to 1.
    pub share: f64,
    /// Force of its hand in N.
    pub hand_force: f64,
    /// Whether its priority button is pressed.
    pub presses: bool,
    /// Whether the link was asked to hold or to open, since the last cycle.
    pub asked: Option<bool>,
}

/// An electronic link in a loop.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each holds by itself")]
pub struct FeelLink {
    link: PilotLink<f64>,
    feels: Option<ElectronicLink<f64>>,
    delay: usize,
    uncouples: bool,
    /// Whether it opens and closes as its axes are asked: one between two pilots.
    pub opens: bool,
    /// It has given way for good.
    uncoupled: bool,
    /// It is to hold.
    holds: bool,
    share: f64,
    /// Torque on each feel at a share of one.
    torques: [f64; 2],
    priority: Priority,
    /// What each side is given of the link: nothing where it has priority.
    gains: [f64; 2],
}

impl FeelLink {
    /// A link with values in the order of its table, and so many periods of delay.
    pub fn new(values: &[f64; LINK_ROWS], delay: usize, (uncouples, opens): (bool, bool)) -> Self {
        Self {
            link: PilotLink::from_values(values),
            feels: None,
            delay,
            uncouples,
            opens,
            uncoupled: false,
            holds: true,
            share: 0.0,
            torques: [0.0; 2],
            priority: Priority::from_values(values),
            gains: [1.0; 2],
        }
    }

    /// Before a cycle of both, of `period_s`, in which a feel comes by `change`: torque in N m and damping in N m s/rad on each.
    pub fn step(&mut self, (period_s, change): (f64, f64), sides: [LinkedFeel; 2]) -> [[f64; 2]; 2] {
        let programmed = sides.map(|side| side.programmed);
        let wanted = sides[0].share * sides[1].share;
        // Without supervisors both feels are there from the first sample on.
        let change = if self.feels.is_none() { 1.0 } else { change };
        let feels = self.feels.get_or_insert_with(|| ElectronicLink::new(self.link, self.delay, programmed));
        let seen = feels.sampled(programmed);
        for asked in sides.iter().filter_map(|side| side.asked) {
            (self.holds, self.uncoupled) = (asked, false);
        }
        let gives_way = seen.iter().any(|&[phi, _]| self.link.gives_way(phi));
        self.uncoupled |= self.uncouples && self.holds && self.share > 0.0 && gives_way;
        let goal = if self.holds { wanted } else { 0.0 };
        self.share = if self.uncoupled { 0.0 } else { self.share + (goal - self.share).clamp(-change, change) };
        let button = sides.iter().position(|side| side.presses);
        let holder = self.priority.sampled(sides.map(|side| side.hand_force), button);
        let damping = feels.injected(period_s);
        if wanted > 0.0 {
            self.torques = [0, 1].map(|side| self.link.on_each(self.link.torque(seen[side]))[side]);
        }
        [0, 1].map(|side| {
            let goal = f64::from(u8::from(holder != Some(side)));
            self.gains[side] += (goal - self.gains[side]).clamp(-change, change);
            [self.torques[side], damping[side]].map(|whole| self.gains[side] * self.share * whole)
        })
    }
}
