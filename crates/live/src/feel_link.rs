//! An electronic link between two running loaders: its torque acts in both feel computers, its share comes and goes with both feels.
//!
//! `s` share of the link · `s_1`, `s_2` shares of both feels · `T`, `c` torque and damping of the link, see
//! [`forcefeel_model::link`] · `h` period · `t_f` time in which a feel comes
//!
//! `s` goes to `s_1 s_2` by at most `h / t_f` a period; each feel is given `s T` and the damping `s c`. `T` stays as it is once a feel is gone,
//! which jumps to its column then. So neither a start, a trip of one side, an opening nor a closing is felt as a step. A link that uncouples at
//! its breakout is open at once. The side with priority is given nothing, the other side all: either comes and goes over `t_f` too.

use crate::controller::Controller;
use forcefeel_model::link::{ElectronicLink, LINK_ROWS, PilotLink, Priority};

/// An electronic link in a loop.
#[derive(Debug, Clone)]
#[expect(clippy::struct_excessive_bools, reason = "each holds by itself")]
pub struct FeelLink {
    /// Places of its axes.
    pub sides: [usize; 2],
    link: PilotLink<f64>,
    feels: Option<ElectronicLink<f64>>,
    delay: usize,
    uncouples: bool,
    /// Whether it opens and closes as its axes are asked: one between two pilots.
    opens: bool,
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
    /// A link between the axes at `sides` with values in the order of its table, and so many periods of delay.
    pub fn new(sides: [usize; 2], values: &[f64; LINK_ROWS], delay: usize, (uncouples, opens): (bool, bool)) -> Self {
        Self {
            sides,
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

    /// Before a cycle of both: what each is given.
    pub fn step(&mut self, first: &mut Controller, second: &mut Controller) {
        let programmed = [first.programmed(), second.programmed()];
        let wanted = first.share() * second.share();
        let begins = self.feels.is_none();
        let feels = self.feels.get_or_insert_with(|| ElectronicLink::new(self.link, self.delay, programmed));
        let seen = feels.sampled(programmed);
        let asked = if self.opens { [first.link_asked(), second.link_asked()] } else { [None; 2] };
        for asked in asked.into_iter().flatten() {
            (self.holds, self.uncoupled) = (asked, false);
        }
        let gives_way = seen.iter().any(|&[phi, _]| self.link.gives_way(phi));
        self.uncoupled |= self.uncouples && self.holds && self.share > 0.0 && gives_way;
        let goal = if self.holds { wanted } else { 0.0 };
        // Without supervisors both feels are there from the first sample on.
        let change = if begins { 1.0 } else { first.fade_share() };
        self.share = if self.uncoupled { 0.0 } else { self.share + (goal - self.share).clamp(-change, change) };
        let button = [first.presses(), second.presses()].iter().position(|&pressed| pressed);
        let holder = self.priority.sampled([first.hand_force(), second.hand_force()], button);
        for (side, gain) in self.gains.iter_mut().enumerate() {
            let goal = f64::from(u8::from(holder != Some(side)));
            *gain += (goal - *gain).clamp(-change, change);
        }
        let [on_first, on_second] = self.gains.map(|gain| gain * self.share);
        let damping = feels.injected(first.period_s());
        if wanted > 0.0 {
            self.torques = [0, 1].map(|side| self.link.on_each(self.link.torque(seen[side]))[side]);
        }
        first.link([on_first * self.torques[0], on_first * damping[0]]);
        second.link([on_second * self.torques[1], on_second * damping[1]]);
    }
}
