//! Two programmed feels joined by a link without delay and let go together from one angle: a pair of perfect loaders.
//!
//! `w+ = Phi w + Gamma T` exactly for each feel, eq. (11), where `T` is the mean of the link's torque at both ends of a step: of the second order in the
//! step.

use forcefeel_model::link::LINK_ROWS;
use forcefeel_model::parameters::Feel;
use forcefeel_model::shaft::Shaft;
use forcefeel_solve::feel_transition::feel_step;

/// Largest step times the rate of both feels on the link.
const MOST_TURN: f64 = 0.1;

/// Angles of both feels let go from `angle`, a sample every `step_s`: those of the first, then those of the second, into `angles`.
pub fn feel_pair(
    feels: [&Feel<f64>; 2],
    values: &[f64; LINK_ROWS],
    uncouples: bool,
    (angle, step_s): (f64, f64),
    angles: &mut [f64],
) {
    let own = feels.map(|feel| (feel.stiffness / feel.inertia).sqrt().max(feel.damping / feel.inertia));
    let rate = Shaft::fastest(values, feels.map(|feel| 1.0 / feel.inertia)).max(own[0]).max(own[1]);
    let parts = (step_s * rate / MOST_TURN).ceil().max(1.0);
    let h = step_s / parts;
    let steps = feels.map(|feel| feel_step(feel, h));
    let step = |side: usize, [delta, rate]: [f64; 2], torque: f64| {
        let matrix = &steps[side];
        [0, 1].map(|k| matrix[(k, 0)] * delta + matrix[(k, 1)] * rate + matrix[(k, 2)] * torque)
    };
    let mut at = [[angle, 0.0]; 2];
    let mut shaft = Shaft::new(values, uncouples, [angle; 2]);
    let (first, second) = angles.split_at_mut(angles.len() / 2);
    for (first, second) in first.iter_mut().zip(second) {
        [*first, *second] = [at[0][0], at[1][0]];
        for _ in 0..whole(parts) {
            let (start, mut next) = (shaft.on_each(), at);
            shaft.step(h, |end| {
                next = [0, 1].map(|side| step(side, at[side], f64::midpoint(start[side], end[side])));
                next
            });
            at = next;
        }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number above zero")]
fn whole(number: f64) -> usize {
    number as usize
}
