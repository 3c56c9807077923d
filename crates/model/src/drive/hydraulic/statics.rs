//! Valve and piston at the grip: what a force at a speed takes of them, and what they give. Eqs. (1)-(5), (9) at an even speed.
//!
//! `F` force at the grip, `v` its speed along the force · `l = alpha R_b / R_p` · `A` piston · `p` load pressure · `q` flow into the
//! actuator, `q_i` the flow at no load that the spool lets through for it · `k` link · `kappa` give of the oil at the piston

use super::pressure::Balance;
use super::valve::ValveMotion;
use crate::Scalar;
use crate::effects::Effects;
use crate::parameters::Parameters;

/// Valve and piston of one loader, seen from the grip.
#[derive(Debug, Clone, Copy)]
pub struct ValveStatics<S> {
    parameters: Parameters<S>,
    motion: ValveMotion<S>,
    orifice: bool,
    /// `l A`: force at the grip in N per Pa, and flow in m³/s per speed of the grip.
    pub force_per_pressure: S,
    /// Oil in m³ that a rise of the load pressure by one Pa takes, into the link and into itself.
    pub oil_compliance: S,
}

impl<S: Scalar> ValveStatics<S> {
    /// Those of a loader with these effects.
    pub fn new(parameters: &Parameters<S>, effects: &Effects) -> Self {
        let Parameters { actuator, linkage, column, .. } = parameters;
        let one = actuator.area.constant(1.0);
        let balance = Balance::new(parameters, one.zero());
        Self {
            parameters: *parameters,
            motion: ValveMotion::new(parameters, effects.orifice),
            orifice: effects.orifice,
            force_per_pressure: actuator.force(linkage.per_grip(column)),
            // A z, with z = (A / k + kappa) p of a base that stands still                             eqs. (5), (9)
            oil_compliance: actuator.swept(balance.per_stiffness * actuator.force(one) + balance.compressibility),
        }
    }

    /// Flow in m³/s at the current `i` and no load, whatever the spool's stroke.
    pub fn no_load_flow(&self, i: S) -> S {
        self.motion.flow_per_current * i
    }

    /// Load pressure at which the flow `q_i` at no load comes to rest; of the orifice that of the supply, whatever the flow.
    pub fn stall_pressure(&self, q_i: S) -> S {
        let valve = &self.parameters.valve;
        if self.orifice { valve.supply_pressure } else { q_i / (-valve.flow(q_i.zero(), q_i.constant(1.0))) }
    }

    /// Flow into the actuator of a spool open for `q_i` at no load, against the load pressure `p`.
    pub fn flow(&self, q_i: S, p: S) -> S {
        let valve = &self.parameters.valve;
        if self.orifice {
            valve.orifice_flow(q_i / valve.no_load_flow(q_i.constant(1.0)), p)
        } else {
            valve.flow(q_i, p)
        }
    }

    /// Flow at no load for which the spool must be open to let `q` through against `p`, a magnitude; infinite where the load presses
    /// harder than the supply.
    pub fn needed(&self, q: S, p: S) -> S {
        let (zero, one) = (q.zero(), q.constant(1.0));
        // q is proportional to q_i, eq. (1), or less than it by C_p p, eq. (4).
        let open = one.times_sign(q);
        let through = self.flow(open, p) * open;
        let flows = zero.less(q.abs());
        let needed =
            if self.orifice { S::select(flows, q.abs() / through, zero) } else { (q - self.flow(zero, p)).abs() };
        let beyond = flows & !p.times_sign(q).less(self.parameters.valve.supply_pressure);
        S::select(beyond, one / zero, needed)
    }

    /// Load pressure and flow at no load that the force `f` at the grip takes while it moves at the speed `v` along it; before it moves on,
    /// where it rests.
    pub fn taken(&self, f: S, v: S) -> [S; 2] {
        let zero = v.zero();
        let along = S::select(zero.less(v.abs()), v, f);
        let rub = S::select(zero.less(along.abs()), self.parameters.actuator.seal_friction.times_sign(along), zero);
        // p = F / (l A) + F_seal sgn v / A, q = A l v
        let p = f / self.force_per_pressure + rub / self.parameters.actuator.area;
        [p, self.needed(self.force_per_pressure * v, p)]
    }
}
