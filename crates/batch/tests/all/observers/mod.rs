//! Sampled laws with an observer: one that repeats static gains, and one that estimates.
#![allow(dead_code, reason = "each test file takes what it needs")]

use forcefeel_model::contact_law::CONTACT_NUMBERS;
use forcefeel_model::known_friction::FRICTION_NUMBERS;
use forcefeel_model::observer::{MOST_STATES, NUMBERS, SAMPLED};
use forcefeel_model::parameters::Parameters;
use nalgebra::{SMatrix, SVector};

/// Gains of the size that the design gives, deaf to the pilot's force, which no observer receives.
pub const DEAF: [f64; 7] = [-194.0, -3.8e-9, 22.0, 0.67, 19.9, -0.7, 0.0];

/// Places in a row of `[xi; y; delta; delta']`, and in one of `[y; e]`.
const FORCE: usize = MOST_STATES;
const PISTON: usize = FORCE + 1;
const ANGLE: usize = FORCE + 2;
const DELTA: usize = FORCE + SAMPLED;
const KNOWN: usize = DELTA + 2;
const COMMAND: usize = SAMPLED;

/// Places of what a law remembers: the angle as sampled last, what it makes up for at the command, the link's force too much.
const LAST: usize = 0;
const MISSING: usize = 1;
const EXCESS: usize = 2;

/// A law by its matrices: `A`, `B`, `c`, `t`.
#[derive(Clone)]
pub struct Sampled {
    transition: SMatrix<f64, MOST_STATES, MOST_STATES>,
    input: SMatrix<f64, MOST_STATES, { SAMPLED + 1 }>,
    command: SVector<f64, KNOWN>,
    torque: SVector<f64, KNOWN>,
}

impl Sampled {
    /// The law that repeats these gains for this loader at a period of so many seconds: it remembers the last angle for the
    /// velocity, `e = c x`, `T = -alpha R_b F_c`.
    pub fn repeating(p: &Parameters<f64>, gains: [f64; 7], period_s: f64) -> Self {
        let [piston, pressure, delta, delta_rate, base, base_rate, _] = gains;
        let arm = p.column.base_arm;
        let mut law = Self {
            transition: SMatrix::zeros(),
            input: SMatrix::zeros(),
            command: SVector::zeros(),
            torque: SVector::zeros(),
        };
        law.input[(LAST, ANGLE - FORCE)] = 1.0;
        law.command[LAST] = -base_rate * arm / period_s;
        law.command[FORCE] = pressure / p.actuator.area;
        law.command[PISTON] = piston;
        law.command[ANGLE] = arm * (base + base_rate / period_s);
        law.command[DELTA] = delta;
        law.command[DELTA + 1] = delta_rate;
        law.torque[FORCE] = -p.linkage.ratio * arm;
        law
    }

    /// The same with two estimates that leak: of what is missing at the command, which takes up all but a tenth of a constant
    /// command, and of what the load cell shows beyond the stretch of the link, a share of which the feel computer receives.
    pub fn estimating(p: &Parameters<f64>, gains: [f64; 7], period_s: f64, share: f64) -> Self {
        let mut law = Self::repeating(p, gains, period_s);
        let arm = p.column.base_arm;
        // d+ = (1 - l) d + 0.9 l e,  e = c x + d
        let leak = period_s / 0.5;
        law.transition[(MISSING, MISSING)] = 1.0 - leak;
        law.input[(MISSING, COMMAND)] = 0.9 * leak;
        law.command[MISSING] = 1.0;
        // s+ = (1 - l) s + l (F_c - k (x_p - alpha R_b theta)),  T = -alpha R_b (F_c + share s)
        let leak = period_s / 0.05;
        law.transition[(EXCESS, EXCESS)] = 1.0 - leak;
        law.input[(EXCESS, 0)] = leak;
        law.input[(EXCESS, 1)] = -leak * p.linkage.stiffness;
        law.input[(EXCESS, 2)] = leak * p.linkage.stiffness * p.linkage.ratio * arm;
        law.torque[EXCESS] = share * law.torque[FORCE];
        law
    }

    /// The law with the gain on the programmed displacement multiplied.
    pub fn further(mut self, factor: f64) -> Self {
        self.command[DELTA] *= factor;
        self
    }

    /// The law with estimates that learn and leak so many times faster.
    pub fn faster(mut self, factor: f64) -> Self {
        for k in [MISSING, EXCESS] {
            self.transition[(k, k)] = 1.0 - factor * (1.0 - self.transition[(k, k)]);
            self.input.row_mut(k).scale_mut(factor);
        }
        self
    }

    /// Its state at neutral.
    pub fn at_neutral() -> SVector<f64, MOST_STATES> {
        SVector::zeros()
    }

    /// Its state at the next sample and its command as the amplifier answers it, from state, sample and feel.
    pub fn replay(
        &self,
        xi: &SVector<f64, MOST_STATES>,
        y: [f64; SAMPLED],
        feel: [f64; 2],
        answered: impl Fn(f64) -> f64,
    ) -> (SVector<f64, MOST_STATES>, f64) {
        let known = SVector::from_iterator(xi.iter().copied().chain(y).chain(feel));
        let e = answered(self.command.dot(&known));
        (self.transition * xi + self.input * SVector::from([y[0], y[1], y[2], y[3], e]), e)
    }

    /// Its numbers in their order; of the state at rest, `(1 - A - b_e c_xi) xi = (B_y + b_e c_y) y + b_e c_delta delta`.
    pub fn numbers(&self) -> [f64; NUMBERS] {
        let by_command = self.input.column(COMMAND);
        let alone = SMatrix::identity() - self.transition - by_command * self.command.rows(0, MOST_STATES).transpose();
        let mut by_signal = by_command * self.command.rows(FORCE, SAMPLED + 1).transpose();
        for k in 0..SAMPLED {
            by_signal.column_mut(k).axpy(1.0, &self.input.column(k), 1.0);
        }
        let settled = alone.lu().solve(&by_signal).expect("a state at rest");
        // Column by column of the transposed is row by row.
        let (a, b, r) = (self.transition.transpose(), self.input.transpose(), settled.transpose());
        let of_neutral = [0.0; 2];
        let (friction, contact) = ([0.0; FRICTION_NUMBERS], [0.0; CONTACT_NUMBERS]);
        let parts = [
            a.as_slice(),
            b.as_slice(),
            self.command.as_slice(),
            self.torque.as_slice(),
            r.as_slice(),
            &of_neutral,
            &friction,
            &contact,
        ];
        parts.concat().try_into().expect("all numbers")
    }
}
