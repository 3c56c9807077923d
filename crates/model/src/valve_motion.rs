//! Valve and amplifier in time: eqs. (3), (13) with the limits of current and flow.
//!
//! `e` amplifier input · `i` current · `q_i`, `q_i'` flow at no load and its rate · `w_n`, `zeta` of the flow response
//!
//! The equations are those of `amplifier.rs` and `valve.rs`; here they stand with their coefficients worked out for a run.

use crate::Scalar;
use crate::effects::Effects;
use crate::parameters::Parameters;

/// Coefficients of the valve's motion.
#[derive(Debug, Clone, Copy)]
pub struct ValveMotion<S> {
    admittance: S,
    current_limit: S,
    flow_limit: S,
    /// Flow at no load per current.
    pub flow_per_current: S,
    /// `w_n^2`.
    stiffness: S,
    /// `2 zeta w_n`.
    damping: S,
}

impl<S: Scalar> ValveMotion<S> {
    /// The coefficients of a loader, with the flow of eq. (1) or of eq. (4).
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, orifice: bool) -> Self {
        let Parameters { amplifier, valve, .. } = parameters;
        let one = valve.natural_frequency.constant(1.0);
        Self {
            admittance: amplifier.current(one),
            current_limit: amplifier.current_limit,
            flow_limit: valve.flow_limit,
            flow_per_current: if orifice { valve.no_load_flow(one) } else { valve.commanded_flow(one) },
            stiffness: -valve.flow_acceleration(one, one.zero(), one.zero()),
            damping: -valve.flow_acceleration(one.zero(), one, one.zero()),
        }
    }

    /// Valve current in A.
    #[inline(always)]
    pub fn current(&self, effects: &Effects, e: S) -> S {
        let i = self.admittance * e;
        if effects.saturation { i.within(self.current_limit) } else { i }
    }

    /// By how much the no-load flow's second time derivative changes with the command, from the current `i` on.
    #[inline(always)]
    pub fn flow_jump(&self, effects: &Effects, i: S, e_change: S) -> S {
        let changed = self.current(effects, i / self.admittance + e_change);
        let zero = i.zero();
        self.flow_acceleration(effects, zero, zero, changed) - self.flow_acceleration(effects, zero, zero, i)
    }

    /// Second time derivative of the no-load flow.
    #[inline(always)]
    pub fn flow_acceleration(&self, effects: &Effects, q_i: S, q_i_rate: S, i: S) -> S {
        let commanded = self.flow_per_current * i;
        let commanded = if effects.saturation { commanded.within(self.flow_limit) } else { commanded };
        // q_i'' = w_n^2 (q_cmd - q_i) - 2 zeta w_n q_i'                                                    eq. (3)
        self.stiffness * (commanded - q_i) - self.damping * q_i_rate
    }
}
