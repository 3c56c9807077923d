//! A reversible control surface: its hinge moment in flight, as what the programmed control meets beside its own feel.
//!
//! `theta` angle of the control · `delta` of the surface · `q` dynamic pressure · `V` true airspeed · `S_h`, `c_h` area and chord behind
//! the hinge · `alpha_s` angle of attack at the surface · `tau` angle of its tab · `n` load factor · `R_p` arm of the grip
//!
//! | | equation |
//! |---|---|
//! | gearing | `d delta / d theta = k = k_h (1 + k_h' theta)` |
//! | flow | `alpha_s = a_h alpha + b_h beta + i_h + (l_p p + l_q q + l_r r) / V` |
//! | tab | `tau = tau_host + k_tau delta + T / k_tab` |
//! | hinge moment | `H = eta_h q S_h c_h (C_0 + C_alpha alpha_s + C_delta delta + C_tau tau + C_rate delta' c_h / (2 V))` |
//! | air that gives | `C_alpha, C_delta, C_tau` times `1 / sqrt(1 - M^2)` (Prandtl, Glauert), and each times its factor by the table |
//! | table | `f(M)` through `(0, 1), (M_1, f_1), (M_2, f_2), (M_3, f_3)`, straight between, beyond as at the last |
//! | torque on the control | `T = s_h k H` by virtual work, of which the share `s_h` reaches it |
//! | cables | the surface stands where a control at `theta + T / k_cable` has it |
//! | bobweight | `W_b n` at the grip, towards negative angles |
//!
//! A moment is positive that turns the surface to positive angles, so a surface that trails has `C_delta < 0`. Around the control's angle of
//! this sample `T = A_0 + A_1 theta + A_2 theta'`; tab and cables, which give way to `T`, divide all three by
//! `1 - A_1 / k_cable - s_h k eta_h q S_h c_h C_tau / k_tab`: they are quick beside the control, and have no motion of their own.
//!
//! Source: B. Etkin and L. D. Reid, Dynamics of Flight: Stability and Control, 3rd edition (1996), section 2.5 (hinge moments), 2.7 (stick
//! force, tabs).

use crate::Scalar;
use crate::parameters::{Parameters, Surface};

/// How an aircraft flies, as far as a surface feels it; SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlightState<S = f64> {
    /// Dynamic pressure in Pa.
    pub dynamic_pressure: S,
    /// True airspeed in m/s.
    pub true_airspeed: S,
    /// Angle of attack in rad.
    pub angle_of_attack: S,
    /// Sideslip in rad.
    pub sideslip: S,
    /// Rates of roll, pitch and yaw in rad/s.
    pub rates: [S; 3],
    /// Load factor.
    pub load_factor: S,
    /// Mach number.
    pub mach: S,
    /// Angle of the trim tab in rad.
    pub tab: S,
}

/// What the programmed control meets beside its own feel: `T_s = R_p F - G_s theta - B_s theta'`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Added<S = f64> {
    /// Force at the grip in N.
    pub force: S,
    /// Spring rate in N m/rad about an angle of zero.
    pub stiffness: S,
    /// Damping in N m s/rad.
    pub damping: S,
}

impl Added {
    /// Nothing.
    pub const NONE: Self = Self { force: 0.0, stiffness: 0.0, damping: 0.0 };
}

impl Surface<f64> {
    /// Whether there is anything that a flight acts on.
    pub fn is_there(&self) -> bool {
        self.area != 0.0 || self.bobweight != 0.0
    }
}

impl<S: Scalar> Parameters<S> {
    /// What the hinge moment of the loader's surface, and its bobweight, are to a control at the angle `theta`.
    #[inline(always)]
    pub fn hinge_moment(&self, flight: &FlightState<S>, theta: S) -> Added<S> {
        let (surface, arm) = (&self.surface, self.column.grip_arm);
        let one = theta.constant(1.0);
        // Below walking pace the rates of the flow mean nothing, and the pressure is none.
        let speed = flight.true_airspeed.max(one);
        let gearing = surface.gearing * (one + surface.gearing_change * theta);
        let deflection = surface.gearing * (theta + (surface.gearing_change * theta * theta).times(0.5));
        let [roll, pitch, yaw] = flight.rates;
        let turning = surface.roll_arm * roll + surface.pitch_arm * pitch + surface.yaw_arm * yaw;
        let flow = surface.flow_per_attack * flight.angle_of_attack
            + surface.flow_per_sideslip * flight.sideslip
            + surface.incidence
            + turning / speed;
        let moment = surface.share * surface.pressure_ratio * flight.dynamic_pressure * surface.area * surface.chord;
        let mach = surface.compressible * flight.mach.abs().min(one.times(MOST_MACH));
        let grown = one / (one - mach * mach).sqrt();
        let [per_flow, per_deflection, per_tab] = surface.at_mach(flight.mach.abs()).map(|of| grown * of);
        let slope = per_deflection + surface.tab_gearing * per_tab;
        let still = surface.at_zero + per_flow * flow + per_tab * flight.tab + slope * deflection;
        let per_theta = moment * (surface.gearing * surface.gearing_change * still + gearing * gearing * slope);
        let per_rate = moment * gearing * gearing * surface.per_rate * surface.chord / speed.times(2.0);
        let gives = one - per_theta / surface.cable_stiffness - moment * gearing * per_tab / surface.tab_stiffness;
        // What gives way to more than all of its moment does not trail: it stays unstable, and finite.
        let gives = gives.max(one.times(LEAST_GIVING));
        let [torque, per_theta, per_rate] = [moment * gearing * still, per_theta, per_rate].map(|of| of / gives);
        Added {
            force: (torque - per_theta * theta) / arm - surface.bobweight * flight.load_factor,
            stiffness: -per_theta,
            damping: -per_rate,
        }
    }
}

impl<S: Scalar> Surface<S> {
    /// `C_alpha`, `C_delta`, `C_tau` by the table over the Mach number.
    #[inline(always)]
    fn at_mach(&self, mach: S) -> [S; 3] {
        let one = mach.constant(1.0);
        // A Mach number that is not given is endless; here it is never reached, and apart from the others.
        let ends =
            [(self.mach_1, 1e30), (self.mach_2, 2e30), (self.mach_3, 3e30)].map(|(end, far)| end.min(one.times(far)));
        let factors = [
            (self.per_flow, [self.flow_factor_1, self.flow_factor_2, self.flow_factor_3]),
            (self.per_deflection, [self.deflection_factor_1, self.deflection_factor_2, self.deflection_factor_3]),
            (self.per_tab, [self.tab_factor_1, self.tab_factor_2, self.tab_factor_3]),
        ];
        factors.map(|(coefficient, factors)| {
            let (mut begin, mut before, mut factor) = (one.times(0.0), one, one);
            for (end, next) in ends.into_iter().zip(factors) {
                let share = ((mach - begin) / (end - begin)).clamp(one.times(0.0), one);
                factor = factor + share * (next - before);
                (begin, before) = (end, next);
            }
            coefficient * factor
        })
    }
}

/// Mach number up to which the rule of Prandtl and Glauert is taken.
const MOST_MACH: f64 = 0.8;
/// Least divisor of a surface on soft cables, or with a soft tab.
const LEAST_GIVING: f64 = 1.0 / 16.0;
