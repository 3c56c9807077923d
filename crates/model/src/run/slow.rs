//! What the Runge-Kutta step carries, and its sums.

use crate::Scalar;

/// What the Runge-Kutta step carries.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Slow<S> {
    /// `z, q_i, q_i', x_b, w`.
    pub plant: [S; 5],
    /// `delta, u`.
    pub feel: [S; 2],
}

impl<S: Scalar> Slow<S> {
    /// `self + by rates`; without the feel, which a digital controller runs by itself.
    #[inline(always)]
    pub fn moved(&self, rates: &Self, by: S, with_feel: bool) -> Self {
        let (a, b) = (&self.plant, &rates.plant);
        let plant = [a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2], a[3] + by * b[3], a[4] + by * b[4]];
        let (a, b) = (&self.feel, &rates.feel);
        let feel = if with_feel { [a[0] + by * b[0], a[1] + by * b[1]] } else { *a };
        Self { plant, feel }
    }

    /// `self` half-way between two instants with their rates, `h` apart.
    #[inline(always)]
    pub fn middle((a, rate_a): (&Self, &Self), (b, rate_b): (&Self, &Self), h: S) -> Self {
        let eighth = h.times(0.125);
        let plant = |k: usize| cubic((a.plant[k], rate_a.plant[k]), (b.plant[k], rate_b.plant[k]), eighth);
        let feel = |k: usize| cubic((a.feel[k], rate_a.feel[k]), (b.feel[k], rate_b.feel[k]), eighth);
        Self { plant: [plant(0), plant(1), plant(2), plant(3), plant(4)], feel: [feel(0), feel(1)] }
    }

    /// `k_1 + 2 k_2 + 2 k_3 + k_4`.
    #[inline(always)]
    pub fn weighted([k_1, k_2, k_3, k_4]: &[Self; 4]) -> Self {
        let sum = |a: S, b: S, c: S, d: S| {
            let twice = b + c;
            (a + d) + (twice + twice)
        };
        let plant = |k: usize| sum(k_1.plant[k], k_2.plant[k], k_3.plant[k], k_4.plant[k]);
        let feel = |k: usize| sum(k_1.feel[k], k_2.feel[k], k_3.feel[k], k_4.feel[k]);
        Self { plant: [plant(0), plant(1), plant(2), plant(3), plant(4)], feel: [feel(0), feel(1)] }
    }
}

/// The cubic through both ends of an interval, `(value, rate)`, at its middle: `(x_0 + x_1) / 2 + h (x'_0 - x'_1) / 8`.
#[inline(always)]
pub fn cubic<S: Scalar>((x_0, rate_0): (S, S), (x_1, rate_1): (S, S), eighth_of_h: S) -> S {
    (x_0 + x_1).times(0.5) + (rate_0 - rate_1) * eighth_of_h
}
