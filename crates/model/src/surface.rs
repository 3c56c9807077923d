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
//! | hinge moment | `H = eta_h q S_h c_h (C_0 + C_alpha alpha_s + C(delta) + C_tau tau + C_rate delta' c_h / (2 V))` |
//! | over the angle | `C(delta) = C_delta delta`, or through `(delta_1, C_1) .. (delta_7, C_7)`, straight between, beyond the ends as beside them |
//! | air that gives | `C_alpha, C(delta), C_tau` times `1 / sqrt(1 - M^2)` (Prandtl, Glauert), and each times its factor by the table |
//! | over Mach | `f(M)` through `(0, 1), (M_1, f_1), (M_2, f_2), (M_3, f_3)`, straight between, beyond as at the last |
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
use crate::run::Inputs;

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

/// The numbers of a flight state by name, in the order of [`FlightState::from_numbers`].
pub const FLIGHT: [&str; 10] = [
    "dynamic_pressure",
    "true_airspeed",
    "angle_of_attack",
    "sideslip",
    "roll_rate",
    "pitch_rate",
    "yaw_rate",
    "load_factor",
    "mach",
    "tab",
];

impl<S> FlightState<S> {
    /// From its numbers in the order of [`FLIGHT`].
    pub fn from_numbers(
        [dynamic_pressure, true_airspeed, angle_of_attack, sideslip, roll, pitch, yaw, load_factor, mach, tab]: [S; 10],
    ) -> Self {
        let rates = [roll, pitch, yaw];
        Self { dynamic_pressure, true_airspeed, angle_of_attack, sideslip, rates, load_factor, mach, tab }
    }
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

impl Parameters<f64> {
    /// The inputs of a step that begins with the control at `theta`, and what its surface adds in the flights at the start and at the end.
    pub fn in_flight(&self, inputs: &Inputs, flights: &[FlightState; 2], theta: f64) -> Inputs {
        let [start, end] = [0, 1].map(|side: usize| self.hinge_moment(&flights[side], theta));
        let beside = |[before, after]: [f64; 2], of: fn(Added) -> f64| [before + of(start), after + of(end)];
        Inputs {
            added_force: beside(inputs.added_force, |of| of.force),
            added_stiffness: beside(inputs.added_stiffness, |of| of.stiffness),
            added_damping: beside(inputs.added_damping, |of| of.damping),
            ..*inputs
        }
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
        let [of_flow, of_deflection, of_tab] = surface.at_mach(flight.mach.abs()).map(|factor| grown * factor);
        let (per_flow, per_tab) = (of_flow * surface.per_flow, of_tab * surface.per_tab);
        let [by_deflection, slope] = surface.at_deflection(deflection).map(|of| of_deflection * of);
        let tab = flight.tab + surface.tab_gearing * deflection;
        let still = surface.at_zero + per_flow * flow + by_deflection + per_tab * tab;
        let slope = slope + surface.tab_gearing * per_tab;
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
    /// Factors of the coefficients of flow, deflection and tab by the table over the Mach number.
    #[inline(always)]
    fn at_mach(&self, mach: S) -> [S; 3] {
        let one = mach.constant(1.0);
        let ends = apart([self.mach_1, self.mach_2, self.mach_3]);
        let factors = [
            [self.flow_factor_1, self.flow_factor_2, self.flow_factor_3],
            [self.deflection_factor_1, self.deflection_factor_2, self.deflection_factor_3],
            [self.tab_factor_1, self.tab_factor_2, self.tab_factor_3],
        ];
        factors.map(|factors| {
            let (mut begin, mut before, mut factor) = (one.times(0.0), one, one);
            for (end, next) in ends.into_iter().zip(factors) {
                let share = ((mach - begin) / (end - begin)).clamp(one.times(0.0), one);
                factor = factor + share * (next - before);
                (begin, before) = (end, next);
            }
            factor
        })
    }

    /// Coefficient by the surface's own angle, and its slope.
    #[inline(always)]
    fn at_deflection(&self, deflection: S) -> [S; 2] {
        let far = deflection.constant(FAR);
        let angles = apart([
            self.deflection_1,
            self.deflection_2,
            self.deflection_3,
            self.deflection_4,
            self.deflection_5,
            self.deflection_6,
            self.deflection_7,
        ]);
        let coefficients = [
            self.coefficient_1,
            self.coefficient_2,
            self.coefficient_3,
            self.coefficient_4,
            self.coefficient_5,
            self.coefficient_6,
            self.coefficient_7,
        ]
        .map(|of| of.min(far));
        let rise = |k: usize| (coefficients[k + 1] - coefficients[k]) / (angles[k + 1] - angles[k]);
        let mut piece = rise(0);
        let (mut value, mut slope) = (coefficients[0] + piece * (deflection - angles[0]), piece);
        for k in 1..angles.len() - 1 {
            // The last piece goes on, also where fewer points are given.
            let next = S::select(angles[k + 1].less(far), rise(k), piece);
            value = value + (next - piece) * (deflection - angles[k]).max(far.zero());
            slope = S::select(angles[k].less(deflection), next, slope);
            piece = next;
        }
        let tabled = angles[1].less(far);
        [S::select(tabled, value, self.per_deflection * deflection), S::select(tabled, slope, self.per_deflection)]
    }
}

/// Points of a table: one that is not given is endless, here never reached, and apart from the others.
#[inline(always)]
fn apart<S: Scalar, const N: usize>(ends: [S; N]) -> [S; N] {
    let mut far = 0.0;
    ends.map(|end| {
        far += FAR;
        end.min(end.constant(far))
    })
}

/// Beyond every Mach number and angle.
const FAR: f64 = 1e30;
/// Mach number up to which the rule of Prandtl and Glauert is taken.
const MOST_MACH: f64 = 0.8;
/// Least divisor of a surface on soft cables, or with a soft tab.
const LEAST_GIVING: f64 = 1.0 / 16.0;
