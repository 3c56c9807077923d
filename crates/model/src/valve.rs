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
    /// Orifice flow `q` in m³/s at current `i` in A and load pressure `p` in Pa, in all four quadrants.
    ///
    /// The oil comes from the supply through the orifice that the current opens, so a negative current sees the load pressure
    /// with its sign reversed; where the load presses harder than the supply, the oil flows back.
    #[inline(always)]
    pub fn orifice_flow(&self, i: S, p: S) -> S {
        let share = p.times_sign(i) / self.supply_pressure;
        // q = (q_r / i_r) i sqrt((p_s - p) / p_s)                                                          eq. (1)
        let rest = share.constant(1.0) - share;
        self.no_load_flow(i) * rest.abs().sqrt().times_sign(rest)
    }

    /// Flow in m³/s at current `i` in A and no load pressure.
    #[inline(always)]
    pub fn no_load_flow(&self, i: S) -> S {
        // q = (q_r / i_r) i                                                                 eq. (1) at p = 0
        self.rated_flow / self.rated_current * i
    }

    /// Flow `q_i` in m³/s that the current commands once the valve has settled.
    #[inline(always)]
    pub fn commanded_flow(&self, i: S) -> S {
        // q_i = C_i i                                                                          eq. (3) at rest
        self.current_gain * i
    }

    /// Second time derivative of the commanded flow `q_i`.
    #[inline(always)]
    pub fn flow_acceleration(&self, q_i: S, q_i_rate: S, i: S) -> S {
        let (zeta, w_n) = (self.damping_ratio, self.natural_frequency);
        // q_i'' = w_n^2 (C_i i - q_i) - 2 zeta w_n q_i'                                                    eq. (3)
        w_n * w_n * (self.commanded_flow(i) - q_i) - zeta.times(2.0) * w_n * q_i_rate
    }

    /// Flow `q` into the actuator in m³/s.
    #[inline(always)]
    pub fn flow(&self, q_i: S, p: S) -> S {
        // q = q_i - C_p p                                                                                  eq. (4)
        q_i - self.pressure_gain * p
    }
}

impl Valve<f64> {
    /// Gains `(C_i, C_p)` of eq. (2) in m³/(s A) and m⁵/(N s): exact slopes of eq. (1) at current `i_share * i_r` and pressure
    /// `p_share * p_s`.
    #[inline(always)]
    pub fn gains_at(&self, i_share: f64, p_share: f64) -> (f64, f64) {
        let dual = self.map(Dual::constant);
        let (i, p) = (i_share * self.rated_current, p_share * self.supply_pressure);
        let dq_di = dual.orifice_flow(Dual::variable(i), Dual::constant(p)).slope;
        let dq_dp = dual.orifice_flow(Dual::constant(i), Dual::variable(p)).slope;
        (dq_di, -dq_dp)
    }
}
