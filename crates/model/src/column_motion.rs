//! Motion of the column's base under everything that pulls at it: eqs. (6), (7) with friction, gravity, stops and an arm.
//!
//! `x_b` displacement of the base · `v` its velocity · `F_c` force of the link · `F_p` pilot force · `J` inertia, the arm's included ·
//! `U`, `phi_U` gravity torque and its angle · `m_a`, `d_a`, `k_a` the arm's mass, damping and spring rate at the grip
//!
//! The equations are those of `column.rs`; here they stand with their coefficients worked out once for a run.

use crate::Scalar;
use crate::contact::Stops;
use crate::dry_friction::DryFriction;
use crate::effects::Effects;
use crate::parameters::{Column, Parameters};

/// Accelerations of the base per cause.
#[derive(Debug, Clone, Copy)]
pub struct ColumnMotion<S> {
    /// Per newton of the link's force.
    pub per_link_force: S,
    /// Per newton of pilot force.
    pub per_pilot_force: S,
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
        Self {
            per_link_force,
            per_pilot_force,
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
            friction: DryFriction::new(column.coulomb_friction, column.static_friction, per_pilot_force),
        }
    }

    /// Acceleration by all but the link, the pilot's force and dry friction, in a step that began at `start`.
    #[inline(always)]
    pub fn loads(&self, effects: &Effects, start: S, x_b: S, v: S) -> S {
        let mut sum = x_b.zero();
        if effects.column_loads {
            let lean = self.gravity_angle + x_b * self.per_base;
            // U sin(phi_U + theta) - (B_c + d_a R_p^2) theta' - k_a R_p^2 theta
            sum = self.gravity * lean.sin() - self.drag * v - self.spring * x_b;
        }
        if effects.column_stops {
            sum = sum + self.stops.force(self.stops.touch(start), x_b, v);
        }
        sum
    }
}
