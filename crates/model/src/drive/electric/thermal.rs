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
    /// `1 / C_w` and `1 / C_h`.
    per_heat: [S; 2],
    /// `1 / R_wh` and `1 / R_ha`.
    conducts: [S; 2],
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
        let (zero, h) = (one.zero(), one.constant(step_s));
        let per_heat = [thermal.winding_capacity, thermal.housing_capacity].map(|capacity| one / capacity);
        let conducts = [thermal.winding_resistance, thermal.housing_resistance].map(|resistance| one / resistance);
        let per_power = h * per_heat[0];
        let continuous = Self { ambient: thermal.ambient, per_heat, conducts, per_power, step: [[zero; 2]; 2] };
        // T+ = T + h T'+: the rates at the end, so that a mass may be as small as it likes; (1 - h A) T+ = T, column by column
        let [[a, b], [c, d]] = [[one, zero], [zero, one]].map(|unit| {
            let rates = continuous.rates(unit, zero);
            [unit[0] - h * rates[0], unit[1] - h * rates[1]]
        });
        let per_determinant = one / (a * d - b * c);
        let step = [[d, -c], [-b, a]].map(|row| row.map(|entry| entry * per_determinant));
        Self { step, ..continuous }
    }

    /// Rates of the temperatures in K/s under the heat `power` of the winding.
    #[inline(always)]
    pub fn rates(&self, [winding, housing]: [S; 2], power: S) -> [S; 2] {
        // C_w T_w' = P - (T_w - T_h) / R_wh, C_h T_h' = (T_w - T_h) / R_wh - T_h / R_ha
        let inwards = (winding - housing) * self.conducts[0];
        [(power - inwards) * self.per_heat[0], (inwards - housing * self.conducts[1]) * self.per_heat[1]]
    }

    /// The temperatures a step later, of the first order in it: minutes beside a step.
    #[inline(always)]
    pub fn after(&self, [winding, housing]: [S; 2], power: S) -> [S; 2] {
        let heated = winding + self.per_power * power;
        self.step.map(|[by_winding, by_housing]| by_winding * heated + by_housing * housing)
    }
}
