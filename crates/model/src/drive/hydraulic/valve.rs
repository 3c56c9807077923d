//! Control valve: eqs. (1)-(4); in a run with its limits, and with what of amplifier and valve can be worked out once.
//!
//! `q_r`, `i_r`, `p_s` rated flow, rated current, supply pressure · `C_i`, `C_p` current and pressure gain at the operating
//! point · `w_n`, `zeta` natural frequency and damping ratio of the flow response · `e` amplifier input · `i` current ·
//! `p` load pressure · `q` flow into the actuator · `q_i` the part of it that the current commands, the flow at no load
//!
//! States: `q_i` and its rate.

use crate::Scalar;
use crate::dual::Dual;
use crate::effects::Effects;
use crate::parameters::{Parameters, Valve};

/// How the flow `q_i` follows what is commanded: eq. (3), of the linear models and of a run.
#[derive(Debug, Clone, Copy)]
struct Response<S> {
    /// `w_n^2`.
    stiffness: S,
    /// `2 zeta w_n`.
    damping: S,
}

impl<S: Scalar> Response<S> {
    /// Second time derivative of `q_i`.
    #[inline(always)]
    fn acceleration(&self, commanded: S, q_i: S, q_i_rate: S) -> S {
        // q_i'' = w_n^2 (q_cmd - q_i) - 2 zeta w_n q_i'                                                    eq. (3)
        self.stiffness * (commanded - q_i) - self.damping * q_i_rate
    }
}

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
        self.response().acceleration(self.commanded_flow(i), q_i, q_i_rate)
    }

    #[inline(always)]
    fn response(&self) -> Response<S> {
        let (zeta, w_n) = (self.damping_ratio, self.natural_frequency);
        Response { stiffness: w_n * w_n, damping: zeta.times(2.0) * w_n }
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

/// Amplifier and valve in a run: eqs. (3), (13) with the limits of current and flow.
#[derive(Debug, Clone, Copy)]
pub struct ValveMotion<S> {
    admittance: S,
    current_limit: S,
    flow_limit: S,
    /// Flow at no load per current.
    pub flow_per_current: S,
    response: Response<S>,
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
            response: valve.response(),
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
        self.response.acceleration(commanded, q_i, q_i_rate)
    }
}
