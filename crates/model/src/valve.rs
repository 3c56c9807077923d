//! Control valve: eqs. (1)-(4).
//!
//! `q_r`, `i_r`, `p_s` rated flow, rated current, supply pressure · `C_i`, `C_p` current and pressure gain at the operating
//! point · `w_n`, `zeta` natural frequency and damping ratio of the flow response · `i` current · `p` load pressure ·
//! `q` flow into the actuator · `q_i` the part of it that the current commands
//!
//! States: `q_i` and its rate.

use crate::Scalar;
use crate::dual::Dual;
use crate::parameters::Valve;

impl<S: Scalar> Valve<S> {
    /// Orifice flow `q` in m³/s at current `i` in A and load pressure `p` in Pa; asks for `p <= p_s`.
    pub fn orifice_flow(&self, i: S, p: S) -> S {
        // q = (q_r / i_r) i sqrt((p_s - p) / p_s)                                                          eq. (1)
        self.rated_flow / self.rated_current * i * ((self.supply_pressure - p) / self.supply_pressure).sqrt()
    }

    /// Flow `q_i` in m³/s that the current commands once the valve has settled.
    pub fn commanded_flow(&self, i: S) -> S {
        // q_i = C_i i                                                                          eq. (3) at rest
        self.current_gain * i
    }

    /// Second time derivative of the commanded flow `q_i`.
    pub fn flow_acceleration(&self, q_i: S, q_i_rate: S, i: S) -> S {
        let (zeta, w_n) = (self.damping_ratio, self.natural_frequency);
        // q_i'' = w_n^2 (C_i i - q_i) - 2 zeta w_n q_i'                                                    eq. (3)
        w_n * w_n * (self.commanded_flow(i) - q_i) - S::constant(2.0) * zeta * w_n * q_i_rate
    }

    /// Flow `q` into the actuator in m³/s.
    pub fn flow(&self, q_i: S, p: S) -> S {
        // q = q_i - C_p p                                                                                  eq. (4)
        q_i - self.pressure_gain * p
    }
}

impl Valve<f64> {
    /// Gains `(C_i, C_p)` of eq. (2) in m³/(s A) and m⁵/(N s): exact slopes of eq. (1) at current `i_share * i_r` and pressure
    /// `p_share * p_s`.
    pub fn gains_at(&self, i_share: f64, p_share: f64) -> (f64, f64) {
        let dual = self.map(Dual::constant);
        let (i, p) = (i_share * self.rated_current, p_share * self.supply_pressure);
        let dq_di = dual.orifice_flow(Dual::variable(i), Dual::constant(p)).slope;
        let dq_dp = dual.orifice_flow(Dual::constant(i), Dual::variable(p)).slope;
        (dq_di, -dq_dp)
    }
}
