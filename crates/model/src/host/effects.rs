//! Autopilot, shaker, pusher, add-in force and trained faults, as what the feel is told.
//!
//! `theta` column angle · `G`, `G_q` the feel's spring rate, and with the factor on it · `F_a` force of the hand that overrides the
//! autopilot · `R_p` arm of the grip · `s` share of a switch, 0 to 1 · `theta_j` where the control jammed
//!
//! | what | torque about the pivot | source |
//! |---|---|---|
//! | autopilot | `s k_a (theta_a - theta)` within `R_p F_a`: a servo behind a slip clutch | 14 CFR 25.1329(l): overridden by hand |
//! | jam | `s k_j (theta_j - theta)` within `R_p F_j`: the breakout of the jam's release | 14 CFR 25.671(c) |
//! | pusher, add-in (hinge moment) | `s R_p F` | |
//! | disconnect | spring times `1 - s` | |
//! | power lost | spring times `1 - s`: what the surface does comes as the added force | |
//! | trim runs away | neutral moves at the host's rate | |
//!
//! The force that overrides is constant beyond `R_p F / k`, and there is no snap when the hand gives way: the spring is the clutch. No
//! switch acts at once: its share takes a tenth of a second, so no torque has a step.

use super::packet::{HOST_NUMBERS, switches};

/// What the feel is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// Commanded neutral in rad.
    pub neutral: f64,
    /// Factor on the spring.
    pub stiffness_factor: f64,
    /// Torque on the programmed control beside the hand's, in N m.
    pub torque: f64,
    /// The shaker's share, 0 to 1.
    pub shaker: f64,
}

/// Time that a switch takes, in s.
const SWITCH_S: f64 = 0.1;
/// Spring of an autopilot's servo and of a jam, as a multiple of the feel's: stiff beside it, and within what a law renders of it.
const SERVO: f64 = 4.0;
/// Farthest that a trim may run away, in rad.
const FARTHEST_RAD: f64 = 4.0;

/// What the effects remember.
#[derive(Debug, Clone, Copy)]
pub struct Effects {
    period_s: f64,
    grip_arm: f64,
    shares: [f64; SWITCHED.len()],
    jammed_at: f64,
    run_away: f64,
}

/// Switches that take their time.
const SWITCHED: [u32; 5] =
    [switches::AUTOPILOT, switches::PUSHER, switches::JAM, switches::DISCONNECT, switches::POWER_LOST];

impl Effects {
    /// None yet: of a grip with this arm in m.
    pub fn new(period_s: f64, grip_arm: f64) -> Self {
        Self { period_s, grip_arm, shares: [0.0; SWITCHED.len()], jammed_at: 0.0, run_away: 0.0 }
    }

    /// What the feel is told at a sample: the column's angle and the feel's spring rate in N m/rad, the stream's values and switches, the
    /// share of the feel that is there.
    pub fn step(&mut self, (angle, spring): (f64, f64), values: &[f64; HOST_NUMBERS], on: u32, share: f64) -> Told {
        let &[_, factor, trim, autopilot, autopilot_force, added, shaker, pusher, runaway, jam_force] = values;
        if on & switches::JAM == 0 && self.shares[2] == 0.0 {
            self.jammed_at = angle;
        }
        let step = self.period_s / SWITCH_S;
        for (share, switch) in self.shares.iter_mut().zip(SWITCHED) {
            *share = if on & switch != 0 { (*share + step).min(1.0) } else { (*share - step).max(0.0) };
        }
        let runs = on & switches::TRIM_RUNAWAY != 0;
        // When it is over the trim goes back at the rate that it ran away with, or a twentieth of a radian a second.
        let back = runaway.abs().max(0.05) * self.period_s;
        self.run_away = if runs {
            (self.run_away + runaway * self.period_s).clamp(-FARTHEST_RAD, FARTHEST_RAD)
        } else {
            self.run_away - self.run_away.clamp(-back, back)
        };
        let [of_autopilot, of_pusher, of_jam, disconnected, unpowered] = self.shares;
        let servo = |to: f64, force: f64| {
            let most = self.grip_arm * force;
            (SERVO * spring * (to - angle)).clamp(-most, most)
        };
        let torque = of_autopilot * servo(autopilot, autopilot_force)
            + of_jam * servo(self.jammed_at, jam_force)
            + self.grip_arm * (of_pusher * pusher + added);
        // Without its power the aircraft has no feel of its own: what the surface does comes as the added force.
        let left = (1.0 - disconnected) * (1.0 - unpowered);
        Told {
            neutral: trim + self.run_away,
            stiffness_factor: factor * left,
            torque: share * torque,
            shaker: share * shaker,
        }
    }
}
