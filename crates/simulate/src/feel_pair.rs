//! Two programmed feels joined by a link without delay and let go together from one angle: a pair of perfect loaders.
//!
//! `w+ = Phi w + Gamma T` exactly for each feel, eq. (11), where `T` is the mean of the link's torque at both ends of a step. The end is found twice, as
//! in [`linked`](crate::linked), so the pair is of the second order in the step.

use forcefeel_model::link::{CORRECTIONS, PilotLink};
use forcefeel_model::parameters::Feel;
use forcefeel_solve::feel_transition::feel_step;

/// Largest step times the rate of both feels on the link.
const MOST_TURN: f64 = 0.1;

/// Angles of both feels let go from `angle`, a sample every `step_s`: those of the first, then those of the second, into `angles`.
pub fn feel_pair(
    feels: [&Feel<f64>; 2],
    link: &PilotLink<f64>,
    uncouples: bool,
    (angle, step_s): (f64, f64),
    angles: &mut [f64],
) {
    let per_inertia: f64 = feels.iter().map(|feel| 1.0 / feel.inertia).sum();
    let own = feels.map(|feel| (feel.stiffness / feel.inertia).sqrt().max(feel.damping / feel.inertia));
    let rate = link.rate(per_inertia).max(own[0]).max(own[1]);
    let parts = (step_s * rate / MOST_TURN).ceil().max(1.0);
    let steps = feels.map(|feel| feel_step(feel, step_s / parts));
    let step = |side: usize, [delta, rate]: [f64; 2], torque: f64| {
        let matrix = &steps[side];
        [0, 1].map(|k| matrix[(k, 0)] * delta + matrix[(k, 1)] * rate + matrix[(k, 2)] * torque)
    };
    let mut at = [[angle, 0.0]; 2];
    let mut open = false;
    let (first, second) = angles.split_at_mut(angles.len() / 2);
    for (first, second) in first.iter_mut().zip(second) {
        [*first, *second] = [at[0][0], at[1][0]];
        for _ in 0..whole(parts) {
            let torque = |at: [[f64; 2]; 2]| if open { 0.0 } else { link.torque(link.beyond(at[0], at[1])) };
            let start = torque(at);
            let mut mean = start;
            let mut next = at;
            for _ in 0..=CORRECTIONS {
                let on_each = link.on_each(mean);
                next = [0, 1].map(|side| step(side, at[side], on_each[side]));
                mean = f64::midpoint(start, torque(next));
            }
            at = next;
            open = open || uncouples && link.gives_way(link.beyond(at[0], at[1])[0]);
        }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number above zero")]
fn whole(number: f64) -> usize {
    number as usize
}
