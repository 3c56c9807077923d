//! Motor: torque from current, cogging, friction and inertia.
//!
//! `K_t` torque constant · `i` current · `phi` angle of the motor · `T_k`, `N_k`, `phi_k` amplitude, periods a turn and phase of
//! cogging · `B_m` viscous friction · `T_c`, `T_s` dry friction, moving and at rest · `J_m` inertia · `r` travel per radian

use crate::Scalar;
use crate::dry_friction::DryFriction;
use crate::effects::Effects;
use crate::parameters::{Motor, Parameters};

impl<S: Scalar> Motor<S> {
    /// Torque on the rotor in N m by the current `i` in A alone.
    #[inline(always)]
    pub fn torque(&self, i: S) -> S {
        self.torque_constant * i
    }

    /// Back-EMF of a phase in V at the speed `omega` in rad/s.
    #[inline(always)]
    pub fn back_emf(&self, omega: S) -> S {
        // K_t i omega = n (K_e omega) i: what the current takes from the winding, the rotor gets
        self.torque_constant / self.power_factor() * omega
    }

    /// `n`: electrical power per voltage and current, 3/2 in peak values of three phases.
    #[inline(always)]
    pub fn power_factor(&self) -> S {
        self.three_phase.times(0.5) + self.three_phase.constant(1.0)
    }

    /// Cogging torque in N m at the angle `phi`: the slots draw the magnets towards them.
    #[inline(always)]
    pub fn cogging(&self, phi: S) -> S {
        // T_1 sin(N_1 phi + phi_1) + T_2 sin(N_2 phi + phi_2)
        let first =
            Harmonic { amplitude: self.cogging_torque, periods: self.cogging_periods, phase: self.cogging_phase };
        let second =
            Harmonic { amplitude: self.cogging_torque_2, periods: self.cogging_periods_2, phase: self.cogging_phase_2 };
        first.at(phi) + second.at(phi)
    }
}

/// What repeats itself over a turn of the motor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonic<S> {
    /// `T_k`.
    pub amplitude: S,
    /// `N_k` per turn.
    pub periods: S,
    /// `phi_k` in rad at the motor's zero.
    pub phase: S,
}

impl<S: Copy> Harmonic<S> {
    /// The same in another number type.
    #[inline(always)]
    pub fn map<T>(&self, convert: impl Fn(S) -> T) -> Harmonic<T> {
        Harmonic { amplitude: convert(self.amplitude), periods: convert(self.periods), phase: convert(self.phase) }
    }
}

impl<S: Scalar> Harmonic<S> {
    /// Its value at the motor's angle `phi`.
    #[inline(always)]
    pub fn at(&self, phi: S) -> S {
        self.amplitude * (self.periods * phi + self.phase).sin()
    }
}

/// The rotor in a run, at the drive's end.
#[derive(Debug, Clone, Copy)]
pub struct Rotor<S> {
    motor: Motor<S>,
    /// `K_t` in N m/A.
    pub torque_constant: S,
    /// `r / J_m`: acceleration of the drive's end per torque.
    per_torque: S,
    /// `r^2 / J_m`: per force.
    per_force: S,
    /// `B_m / J_m`.
    drag: S,
    kinetic: S,
    breakaway: S,
}

impl<S: Scalar> Rotor<S> {
    /// The coefficients of a loader.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>) -> Self {
        let Parameters { motor, transmission, brake, .. } = parameters;
        let r = transmission.travel;
        let braked = brake.engaged * brake.torque;
        Self {
            motor: *motor,
            torque_constant: motor.torque_constant,
            per_torque: r / motor.inertia,
            per_force: r * r / motor.inertia,
            drag: motor.viscous_friction / motor.inertia,
            kinetic: motor.coulomb_friction + braked,
            breakaway: motor.static_friction.max(motor.coulomb_friction) + braked,
        }
    }

    /// Torque in N m, friction left out.
    #[inline(always)]
    pub fn torque(&self, effects: &Effects, phi: S, i: S) -> S {
        let torque = self.motor.torque(i);
        if effects.cogging { torque + self.motor.cogging(phi) } else { torque }
    }

    /// Acceleration of the drive's end, dry friction left out, against the link's force.
    #[inline(always)]
    pub fn acceleration(&self, torque: S, v_m: S, force: S) -> S {
        self.per_torque * torque - self.per_force * force - self.drag * v_m
    }

    /// Dry friction where the transmission loses `lost` N m of torque.
    #[inline(always)]
    pub fn friction(&self, lost: S) -> DryFriction<S> {
        DryFriction::new(self.kinetic + lost, self.breakaway + lost, self.per_torque)
    }
}
