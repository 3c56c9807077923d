//! Motor and transmission at the grip: what a force at a speed takes of them, what they give, and how warm that makes them.
//!
//! `F` force at the grip, `v` its speed along the force · `l = alpha R_b / R_p` · `f = F / l` force on the link, `v_m = l v` speed of
//! the drive's end · `i` current, `u` voltage of a phase · `T_w`, `T_h` winding and housing over the temperature around
//!
//! These are the rotor's and the winding's equations without acceleration, at a current that stays; of dry friction, what slows down
//! a rotor that moves on. Cogging is left out.

use super::Electric;
use crate::Scalar;
use crate::drive::{Coupling, Drive};
use crate::effects::Effects;
use crate::loader::System;
use crate::parameters::Parameters;
use crate::run::Shared;

/// Motor and transmission of one loader, seen from the grip.
#[derive(Debug, Clone, Copy)]
pub struct MotorStatics<S> {
    drive: Electric<S>,
    /// `l`: travel of the drive's end per travel of the grip.
    pub per_grip: S,
}

impl<S: Scalar> MotorStatics<S> {
    /// Those of a loader.
    pub fn new(parameters: &Parameters<S>) -> Self {
        let one = parameters.column.inertia.constant(1.0);
        let coupling = Coupling { base_per_force: one, feel_per_force: one.zero(), direct: one.less(one) };
        // No step is taken: its length goes into nothing that stands still.
        let shared = Shared { effects: Effects::default(), step_s: 1.0, timing: None, curve: None, cancellation: None };
        Self {
            drive: Electric::new(parameters, &shared, &coupling),
            per_grip: parameters.linkage.per_grip(&parameters.column),
        }
    }

    /// Radians of the motor per meter of the grip: newtons at the grip per newton meter.
    pub fn gear(&self) -> S {
        self.per_grip * self.drive.per_travel
    }

    /// The rotor at the grip, kg.
    pub fn added_mass(&self) -> S {
        let zero = self.per_grip.zero();
        // l^2 J_m / r^2: what a force on the link accelerates
        -(self.per_grip * self.per_grip) / self.drive.rotor.acceleration(zero, zero, self.drive.one)
    }

    /// Acceleration of the drive's end by the torque of a current, against the force on the link, dry friction along the motion included.
    fn acceleration(&self, torque: S, (f, v_m, way): (S, S, S)) -> S {
        let friction = self.drive.friction(f, way).kinetic.times_sign(way);
        let moves = way.zero().less(way.abs());
        self.drive.rotor.acceleration(torque, v_m, f) - S::select(moves, friction, way.zero())
    }

    /// Torque, current and voltage that the force `f` at the grip takes while it moves at the speed `v` along it; before it moves on,
    /// where it rests.
    pub fn taken(&self, f: S, v: S) -> [S; 3] {
        let (zero, one) = (v.zero(), self.drive.one);
        let along = S::select(zero.less(v.abs()), v, f);
        let at = (f / self.per_grip, self.per_grip * v, along);
        // The acceleration is straight in the torque.
        let torque = -self.acceleration(zero, at) / self.drive.rotor.acceleration(one, zero, zero);
        let current = torque / self.drive.rotor.torque_constant;
        [torque, current, self.voltage(current, v)]
    }

    /// Voltage of a cold phase at a current that stays and a speed of the grip.
    pub fn voltage(&self, current: S, v: S) -> S {
        let winding = self.drive.current.warm(v.zero());
        self.drive.current.voltage(&Effects::default(), &winding, (current, self.gear() * v), current)
    }

    /// Current of a cold phase that stays under the voltage `u` at a speed of the grip.
    pub fn current(&self, u: S, v: S) -> S {
        (u - self.voltage(v.zero(), v)) / self.voltage(self.drive.one, v.zero())
    }

    /// Torque of a current.
    pub fn torque(&self, current: S) -> S {
        self.drive.rotor.torque_constant * current
    }

    /// Force that a current drives the grip with at a speed along it; zero where friction takes all.
    pub fn given(&self, current: S, v: S) -> S {
        let (zero, one) = (v.zero(), self.drive.one);
        let left = |torque: S, f: S| self.acceleration(torque, (f, self.per_grip * v, one));
        // Straight in a force that the motor drives.
        let per_force = left(zero, zero) - left(zero, one);
        let force = left(self.torque(current), zero) / per_force * self.per_grip;
        force - force.min(zero)
    }

    /// Speed of the grip at which the voltage `u` and friction leave no force.
    pub fn fastest(&self, u: S) -> S {
        let (zero, one) = (u.zero(), self.drive.one);
        let left = |v: S| self.acceleration(self.torque(self.current(u, v)), (zero, self.per_grip * v, one));
        let (standing, moving) = (left(zero), left(one));
        (standing / (standing - moving)).max(zero)
    }
}

/// Temperatures over that around of a motor whose current stays; states `T_w, T_h`, input the square of the current.
impl<S: Scalar> System<S, 2, 1, 0> for MotorStatics<S> {
    fn derivative(&self, x: &[S; 2], &[squared]: &[S; 1]) -> [S; 2] {
        let power = self.drive.current.heat(&self.drive.current.warm(x[0]), squared);
        self.drive.warming.rates(*x, power)
    }

    fn outputs(&self, _: &[S; 2], _: &[S; 1]) -> [S; 0] {
        []
    }
}
