//! Control column: eqs. (6), (7), (16), (18); in a run with friction, gravity, stops and the pilot's arm.
//!
//! `J` inertia, in a run the arm's included · `R_b`, `R_p` lever arms of base and grip · `F_p` pilot force · `F_c` force of the link ·
//! `x_b` displacement of the base · `v` its velocity · `theta` angle of the column · `U`, `phi_U` gravity torque and its angle ·
//! `m_a`, `d_a`, `k_a` the arm's mass, damping and spring rate at the grip · `F_c`, `F_s` dry friction and breakaway, `omega_s` Stribeck
//! velocity, `a_F` asymmetry
//!
//! Friction of the moving column: `(F_c + (F_s - F_c) exp(-(theta' / omega_s)^2)) (1 + a_F sgn theta') sgn theta'`. Without a Stribeck
//! velocity it falls with a jump, which is `dry_friction.rs` alone. With one, what holds and what slows down a slow motion are the
//! same there, and what the motion has less of it is a load: smooth, and nothing at rest. The curve: L. C. Bo, D. Pavelescu, Wear 82(3)
//! (1982) 277-289; with the exponent of two as in B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30(7) (1994)
//! 1083-1138.
//!
//! States of the compliant model: `x_b` and its rate.
//!
//! The linear models work out eq. (6) as it is written, a sum of torques over the inertia. A run works out what each cause gives by
//! itself, once, from that same equation: a division less at every stage, and rounded elsewhere, so both forms stay.

use crate::Scalar;
use crate::contact::Stops;
use crate::dry_friction::DryFriction;
use crate::effects::Effects;
use crate::parameters::{Column, Parameters};

impl<S: Scalar> Column<S> {
    /// Acceleration of the column's base in m/s², from the linkage's force on the base and the pilot's on the grip, in N.
    #[inline(always)]
    pub fn base_acceleration(&self, base_force: S, pilot_force: S) -> S {
        // J theta'' = R_p F_p + R_b (alpha A p), theta = x_b / R_b                                     eqs. (6), (7)
        (self.grip_arm * pilot_force + self.base_arm * base_force) * self.base_arm / self.inertia
    }

    /// Force at the grip in N that by itself turns the column with an angular acceleration in rad/s².
    #[inline(always)]
    pub fn grip_force(&self, acceleration: S) -> S {
        let (zero, one) = (acceleration.zero(), acceleration.constant(1.0));
        acceleration / self.angle(self.base_acceleration(zero, one))
    }

    /// Angle of the column in rad (small motions).
    #[inline(always)]
    pub fn angle(&self, x_b: S) -> S {
        // theta = x_b / R_b                                                                           eqs. (16), (18)
        x_b / self.base_arm
    }

    /// Torque of the pilot's force about the pivot in N m.
    #[inline(always)]
    pub fn pilot_torque(&self, pilot_force: S) -> S {
        // R_p F_p                                                                               eq. (6), first term
        self.grip_arm * pilot_force
    }
}

/// The column in a run: accelerations of the base per cause.
#[derive(Debug, Clone, Copy)]
pub struct ColumnMotion<S> {
    /// Per newton of the link's force.
    pub per_link_force: S,
    /// Per newton of pilot force.
    pub per_pilot_force: S,
    /// Per newton meter about the pivot.
    pub per_torque: S,
    /// Per velocity: viscous friction and the arm's damping.
    drag: S,
    /// Per displacement: the arm's spring.
    spring: S,
    /// Of gravity at its largest.
    gravity: S,
    gravity_angle: S,
    per_base: S,
    /// End stops.
    pub stops: Stops<S>,
    /// Dry friction.
    pub friction: DryFriction<S>,
    /// `F_s - F_c` of a friction that falls over a velocity, as acceleration.
    fall: S,
    /// Per Stribeck velocity of the base; zero without one.
    per_stribeck: S,
}

impl<S: Scalar> ColumnMotion<S> {
    /// The coefficients of a loader.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>) -> Self {
        let Parameters { column, linkage, pilot, .. } = parameters;
        let one = column.inertia.constant(1.0);
        let at_grip = column.grip_arm * column.grip_arm;
        // The hand does not leave the grip, so the arm moves with it.                     J + m_a R_p^2
        let whole = Column { inertia: column.inertia + pilot.arm_mass * at_grip, ..*column };
        let per_link_force = whole.base_acceleration(linkage.base_force(one), one.zero());
        let per_pilot_force = whole.base_acceleration(one.zero(), one);
        // Per torque about the pivot, and per angle.
        let (per_torque, per_base) = (per_pilot_force / column.grip_arm, whole.angle(one));
        let per_angle = per_torque * per_base;
        let jump = DryFriction::new(column.coulomb_friction, column.static_friction, per_pilot_force);
        let falls = one.zero().less(column.stribeck_velocity);
        let kinetic = S::select(falls, jump.breakaway, jump.kinetic);
        Self {
            per_link_force,
            per_pilot_force,
            per_torque,
            drag: (column.viscous_friction + pilot.arm_damping * at_grip) * per_angle,
            spring: pilot.arm_stiffness * at_grip * per_angle,
            gravity: column.gravity_torque * per_torque,
            gravity_angle: column.gravity_angle,
            per_base,
            stops: Stops {
                low: column.stop_low / per_base,
                high: column.stop_high / per_base,
                stiffness: column.stop_stiffness * per_angle,
                damping: column.stop_damping * per_angle,
            },
            friction: DryFriction { kinetic, asymmetry: column.friction_asymmetry, ..jump },
            fall: kinetic - jump.kinetic,
            per_stribeck: S::select(falls, per_base / S::select(falls, column.stribeck_velocity, one), one.zero()),
        }
    }

    /// Holds the column from now on, whatever moves it: dry friction that stops the velocity `v`, and what pulls as much as `pull`, in two
    /// steps of `h`, and that does not break away.
    pub fn jam(&mut self, [v, pull]: [S; 2], h: S) {
        let one = h.constant(1.0);
        let kinetic = v.abs() / h.times(2.0) + pull.abs().times(2.0) + one;
        self.friction = DryFriction { kinetic, breakaway: one / one.zero(), asymmetry: one.zero() };
        (self.fall, self.per_stribeck) = (one.zero(), one.zero());
    }

    /// Acceleration of the base, dry friction left out, in a step that began at `start`; `by_link`: what the link gives of it.
    #[inline(always)]
    pub fn acceleration(&self, effects: &Effects, (by_link, pilot_force): (S, S), (start, x_b): (S, S), v: S) -> S {
        by_link + self.per_pilot_force * pilot_force + self.loads(effects, start, x_b, v)
    }

    /// Acceleration by all but the link, the pilot's force and dry friction, in a step that began at `start`.
    #[inline(always)]
    pub fn loads(&self, effects: &Effects, start: S, x_b: S, v: S) -> S {
        let mut sum = x_b.zero();
        // U sin(phi_U + theta) - (B_c + d_a R_p^2) theta' - k_a R_p^2 theta
        if effects.gravity {
            sum = self.gravity * (self.gravity_angle + x_b * self.per_base).sin();
        }
        if effects.column_loads {
            sum = sum - self.drag * v - self.spring * x_b;
        }
        if effects.stribeck {
            // (F_s - F_c) (1 - exp(-(theta' / omega_s)^2)) (sgn theta' + a_F)
            let share = v * self.per_stribeck;
            let less = self.fall - self.fall * (share * share).decay();
            sum = sum + less.times_sign(v) + less * self.friction.asymmetry;
        }
        if effects.column_stops {
            sum = sum + self.stops.force(start, (x_b, v));
        }
        sum
    }
}
