//! Autopilot, shaker, pusher, added force and trained faults, as what the feel is told.
//!
//! `theta` angle of the programmed control · `G` the feel's spring rate · `S(theta)` torque that holds the control there against its whole
//! feel · `F_a` largest force of the autopilot · `R_p` arm of the grip · `s` share of a switch, 0 to 1 · `theta_j` where the control
//! jammed · `T_h` torques of pusher and added force
//!
//! | what | torque about the pivot | source |
//! |---|---|---|
//! | autopilot, `T_a` | `s (S(theta_a) - T_h + 4 G (theta_a - theta))` within `s R_p F_a`: a servo behind a slip clutch | 14 CFR 25.1329(l): overridden by hand |
//! | jam | `s (S(theta_j) - T_h - T_a + 4 G (theta_j - theta))` within `s R_p F_j`: the breakout of the jam's release | 14 CFR 25.671(c) |
//! | pusher, added force | `s R_p F` | |
//! | disconnect | spring times `1 - s` | |
//! | power lost | spring times `1 - s` | |
//! | trim runs away | neutral moves at the host's rate | |
//!
//! Both carry what loads the control at their place, so it comes to rest there and not where two springs balance. It does where the force
//! is enough for that load; else, or under a hand that pushes harder, the clutch slips: the force stays the same, and nothing snaps when
//! the hand gives way. The load is that of the place, not that of the control: carried at the measured angle it would take the feel's spring
//! away, and with it what holds a control that is overridden. The springs are the programmed control's, as the feel is: closed over the
//! measured column they would have the lag of law and drive, and leave it hardly damped. No switch acts at once: its share takes a tenth of
//! a second, so no torque has a step.

use super::packet::{HOST_NUMBERS, switches};

/// How the programmed control is held.
#[derive(Debug, Clone, Copy)]
pub struct Held<F> {
    /// Its angle in rad.
    pub angle: f64,
    /// The feel's spring rate in N m/rad.
    pub spring: f64,
    /// `S / R_p`: force at the grip in N that holds it at an angle in rad where its spring has a factor.
    pub force: F,
}

/// What the feel is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeelCommand {
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
pub struct HostEffects {
    period_s: f64,
    grip_arm: f64,
    shares: [f64; SWITCHED.len()],
    jammed_at: f64,
    run_away: f64,
}

/// Switches that take their time.
const SWITCHED: [u32; 5] =
    [switches::AUTOPILOT, switches::PUSHER, switches::JAM, switches::DISCONNECT, switches::POWER_LOST];

impl HostEffects {
    /// None yet: of a grip with this arm in m.
    pub fn new(period_s: f64, grip_arm: f64) -> Self {
        Self { period_s, grip_arm, shares: [0.0; SWITCHED.len()], jammed_at: 0.0, run_away: 0.0 }
    }

    /// What the feel is told at a sample: how the control is held, the stream's values and switches, the share of the feel that is there.
    pub fn step<F: Fn(f64, f64) -> f64>(
        &mut self,
        Held { angle, spring, force: holding }: &Held<F>,
        values: &[f64; HOST_NUMBERS],
        on: u32,
        share: f64,
    ) -> FeelCommand {
        let &[_, factor, trim, autopilot, autopilot_force, added, shaker, pusher, runaway, jam_force, ..] = values;
        if on & switches::JAM == 0 && self.shares[2] == 0.0 {
            self.jammed_at = *angle;
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
        // Without its power the aircraft has no feel of its own.
        let left = (1.0 - disconnected) * (1.0 - unpowered);
        let stiffness_factor = factor * left;
        let servo = |of: f64, to: f64, force: f64, others: f64| {
            if of == 0.0 {
                return 0.0;
            }
            let most = self.grip_arm * force;
            let load = self.grip_arm * holding(to, stiffness_factor) - others;
            of * (load + SERVO * spring * (to - angle)).clamp(-most, most)
        };
        let others = self.grip_arm * (of_pusher * pusher + added);
        let others = others + servo(of_autopilot, autopilot, autopilot_force, others);
        let torque = others + servo(of_jam, self.jammed_at, jam_force, others);
        FeelCommand { neutral: trim + self.run_away, stiffness_factor, torque: share * torque, shaker: share * shaker }
    }
}
