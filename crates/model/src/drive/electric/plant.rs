//! Motor, linkage and column as a linear system, and what a bench measures of them.
//!
//! States `x_m, x_m', i, x_b, x_b'`; inputs `F_p, e`; the feel is what a digital controller runs.

use super::Electric;
use crate::Scalar;
use crate::column::ColumnMotion;
use crate::drive::{Contact, Coupling, Drive, Motion};
use crate::effects::Effects;
use crate::loader::System;
use crate::parameters::Parameters;
use crate::run::Shared;

/// Outputs of the plant: `theta` (rad), `x_m` (m), `F_c` (N), `i` (A), `u` (V), `omega` (rad/s).
pub const OUTPUTS: usize = 6;

/// Motor, linkage and column, limits, friction and cogging left out.
#[derive(Debug, Clone, Copy)]
pub struct ElectricPlant<S: Scalar> {
    drive: Electric<S>,
    column: ColumnMotion<S>,
    per_base: S,
}

impl<S: Scalar> ElectricPlant<S> {
    /// That of a loader.
    pub fn new(parameters: &Parameters<S>) -> Self {
        let (column, one) = (ColumnMotion::new(parameters), parameters.column.inertia.constant(1.0));
        let coupling =
            Coupling { base_per_force: column.per_link_force, feel_per_force: one.zero(), direct: one.less(one) };
        let shared = Shared { effects: Effects::default(), step_s: 1.0, timing: None, curve: None, cancellation: None };
        Self { drive: Electric::new(parameters, &shared, &coupling), column, per_base: parameters.column.angle(one) }
    }

    fn force(&self, x: &[S; 5]) -> S {
        self.drive.balance(&Effects::default(), &self.drive.moving(), self.drive.touches(x), x)
    }
}

impl<S: Scalar> System<S, 5, 2, OUTPUTS> for ElectricPlant<S> {
    fn derivative(&self, x: &[S; 5], &[pilot_force, e]: &[S; 2]) -> [S; 5] {
        let &[x_m, v_m, i, _, base_rate] = x;
        let force = self.force(x);
        let v_m_rate = self.drive.acceleration(&Effects::default(), [x_m, v_m, i], force);
        let pull = self.drive.pull(self.column.per_link_force, &force) + self.column.per_pilot_force * pilot_force;
        [v_m, v_m_rate, self.drive.current.rate(i, e), base_rate, pull]
    }

    fn outputs(&self, x: &[S; 5], &[_, e]: &[S; 2]) -> [S; OUTPUTS] {
        let &[x_m, v_m, i, base, _] = x;
        let force = self.force(x);
        let speed = v_m * self.drive.per_travel;
        let voltage =
            self.drive.current.voltage(&Effects::default(), &self.drive.current.warm(e.zero()), (i, speed), e);
        [base * self.per_base, x_m, force, i, voltage, speed]
    }
}
