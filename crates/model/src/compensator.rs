//! Compensator: the law that drives the servo amplifier, as data.
//!
//! `e` amplifier input · `c_1 .. c_7` gains on `x_p`, `p`, `delta`, `delta'`, `x_b`, `x_b'`, `F_p` · `T` torque that the feel
//! computer sees · `F_c` load cell force
//!
//! The report's original position loop, eq. (13), and its compensation, `e = c x` of eq. (20), are two sets of numbers of
//! the one law `e = c_1 x_p + ... + c_7 F_p`, `T = -r F_c`, so the rest of the model need not know which it runs.

use crate::Scalar;
use crate::parameters::Parameters;

/// What the feel computer's displacement `delta` stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Displacement {
    /// A voltage, eqs. (12), (13).
    Volts,
    /// An angle, eqs. (19), (21).
    Radians,
}

/// Gains on `[x_p, p, delta, delta', x_b, x_b', F_p]` and the load cell's scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensator<S> {
    /// Gains `c_1 .. c_7` in V per SI unit of `[x_p, p, delta, delta', x_b, x_b', F_p]`.
    pub gains: [S; 7],
    /// Torque that the feel computer sees per newton of load cell force, sign reversed: m, or m V/rad where `delta` is a
    /// voltage.
    pub load_cell_arm: S,
    /// What `delta` stands for.
    pub displacement: Displacement,
}

impl<S: Copy> Compensator<S> {
    /// The same law in another number type.
    #[inline(always)]
    pub fn map<T>(&self, convert: impl Fn(S) -> T) -> Compensator<T> {
        Compensator {
            gains: self.gains.map(&convert),
            load_cell_arm: convert(self.load_cell_arm),
            displacement: self.displacement,
        }
    }
}

impl<S: Scalar> Compensator<S> {
    /// Servo alone: amplifier open, feel computer deaf.
    #[inline(always)]
    pub fn none(parameters: &Parameters<S>) -> Self {
        let zero = parameters.amplifier.admittance.zero();
        Self { gains: [zero; 7], load_cell_arm: zero, displacement: Displacement::Volts }
    }

    /// The servo's position loop without the feel computer.
    #[inline(always)]
    pub fn position_loop(parameters: &Parameters<S>) -> Self {
        let mut law = Self::none(parameters);
        // e = -e_P = -K_3 x_p                                                       eq. (13) with delta = 0
        let one = parameters.potentiometer.gain.constant(1.0);
        law.gains[0] = -parameters.potentiometer.signal(one);
        law
    }

    /// The original system; `delta` in V.
    #[inline(always)]
    pub fn original(parameters: &Parameters<S>) -> Self {
        let mut law = Self::position_loop(parameters);
        // e = delta - K_3 x_p                                                                         eq. (13)
        let one = law.gains[2].constant(1.0);
        law.gains[2] = one;
        // T = -G_max K_1 F_c                                                                          eq. (12)
        law.load_cell_arm = -parameters.feel.analog_torque(parameters.load_cell.signal(one));
        law
    }

    /// Feedback of the design plant's states; `delta` in rad, so the computer sees the column's torque.
    #[inline(always)]
    pub fn state_feedback(parameters: &Parameters<S>, gains: [S; 7]) -> Self {
        // T = -alpha R_b F_c                                            eq. (6) at rest: T = R_p F_p
        let load_cell_arm = parameters.linkage.base_force(parameters.column.base_arm);
        Self { gains, load_cell_arm, displacement: Displacement::Radians }
    }

    /// Amplifier input `e` in V from `[x_p, p, delta, delta', x_b, x_b', F_p]`.
    #[inline(always)]
    pub fn command(&self, x: &[S; 7]) -> S {
        let c = &self.gains;
        // e = c x                                                                        page of eq. (20)
        c[0] * x[0] + c[1] * x[1] + c[2] * x[2] + c[3] * x[3] + c[4] * x[4] + c[5] * x[5] + c[6] * x[6]
    }

    /// The same for a law that feeds back piston and programmed displacement alone, as the original one.
    #[inline(always)]
    pub fn follow(&self, x_p: S, delta: S) -> S {
        self.gains[0] * x_p + self.gains[2] * delta
    }

    /// Torque `T` that the feel computer sees.
    #[inline(always)]
    pub fn feel_torque(&self, f_c: S) -> S {
        -self.load_cell_arm * f_c
    }
}
