//! A release beside the programmed feel's, and the verdict of a rule.

use forcefeel_model::parameters::Feel;
use forcefeel_solve::feel_transition::feel_transition;
use forcefeel_solve::release::Measuring;
use forcefeel_solve::release_verdict::{Measured, Quantity, ReleaseTest, ReleaseVerdict, TOLERANCE_NUMBERS, Tolerance};

/// Most tolerances of a test.
const MOST_TOLERANCES: usize = 10;

/// A rule on releases, as the page writes it.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Rule {
    /// Residual band, and shares of the displacement between which the way back is timed.
    shares: [f64; 3],
    /// Share of the record whose mean is the steady state.
    tail: f64,
    /// Fall times for which a release at rest stays in the residual band.
    rests_fall_times: f64,
    /// Number of tolerances.
    count: f64,
    /// [`Tolerance::of`].
    tolerances: [[f64; TOLERANCE_NUMBERS]; MOST_TOLERANCES],
}

impl Rule {
    /// The verdict on a release whose first sample is the last one held, a sample every `step_s`, beside the programmed feel's.
    pub fn judge(&self, angles: &[f64], ideal: &[f64], step_s: f64) -> ReleaseVerdict {
        let time: Vec<f64> = (0..angles.len()).map(|k| number(k) * step_s).collect();
        let [band, high, low] = self.shares;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of the samples")]
        let tail = (self.tail * number(angles.len().saturating_sub(1))) as usize;
        let measuring = Measuring {
            time: &time,
            held: 1,
            free: 0,
            tail: tail.max(1),
            band,
            high,
            low,
            reach: 0.0,
            hysteresis: 0.0,
        };
        let stated = self.tolerances.iter().enumerate().filter(|(k, _)| number(*k) < self.count);
        let test = ReleaseTest {
            tolerances: stated.filter_map(|(_, numbers)| Tolerance::of(numbers)).collect(),
            rests_fall_times: self.rests_fall_times,
            overdamped: Quantity::FallTime,
        };
        let [actual, reference] = [angles, ideal].map(|angles| measuring.measure(angles).values);
        let end_s = time.last().copied().unwrap_or(0.0);
        let of = |values| Measured { values, release_s: 0.0, end_s };
        test.judge(&of(&actual), &of(&reference))
    }
}

/// Fills `angles` with the programmed feel's release at `held_rad`, a sample every `step_s`.
pub fn ideal(feel: &Feel<f64>, held_rad: f64, step_s: f64, angles: &mut [f64]) {
    for (k, angle) in angles.iter_mut().enumerate() {
        *angle = held_rad * feel_transition(feel, number(k) * step_s)[(0, 0)];
    }
}

#[expect(clippy::cast_precision_loss, reason = "a number of samples, far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
