//! Temperatures of winding and housing, two masses in a row.
//!
//! `T_w`, `T_h` over the temperature around · `P` heat of the winding · `C_w`, `C_h` heat capacities · `R_wh`, `R_ha` thermal
//! resistances from the winding to the housing and from that to the air
//!
//! `C_w T_w' = P - (T_w - T_h) / R_wh`, `C_h T_h' = (T_w - T_h) / R_wh - T_h / R_ha`

use crate::Scalar;
use crate::parameters::Parameters;

/// Two thermal masses over steps of one length.
#[derive(Debug, Clone, Copy)]
pub struct Warming<S> {
    /// Temperature around in degrees Celsius.
    pub ambient: S,
    /// `h / C_w`.
    per_power: S,
    /// What a step makes of `T_w + h P / C_w` and `T_h`, row by row.
    step: [[S; 2]; 2],
}

impl<S: Scalar> Warming<S> {
    /// The coefficients of a loader in steps of `step_s` seconds.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, step_s: f64) -> Self {
        let thermal = &parameters.thermal;
        let one = thermal.ambient.constant(1.0);
        let h = one.constant(step_s);
        let [of_winding, of_housing] = [h / thermal.winding_capacity, h / thermal.housing_capacity];
        let [inner, outer] = [one / thermal.winding_resistance, one / thermal.housing_resistance];
        // T_w+ = T_w + h T_w'+, T_h+ = T_h + h T_h'+: the rates at the end, so that a mass may be as small as it likes
        let [a, b, c] = [of_winding * inner, of_housing * inner, of_housing * outer];
        let per_determinant = one / ((one + a) * (one + b + c) - a * b);
        let step = [[one + b + c, a], [b, one + a]].map(|row| row.map(|entry| entry * per_determinant));
        Self { ambient: thermal.ambient, per_power: of_winding, step }
    }

    /// The temperatures a step later, of the first order in it: minutes beside a step.
    #[inline(always)]
    pub fn after(&self, [winding, housing]: [S; 2], power: S) -> [S; 2] {
        let heated = winding + self.per_power * power;
        self.step.map(|[by_winding, by_housing]| by_winding * heated + by_housing * housing)
    }
}
