//! Where a run would rest in the end: where the pilot's last force holds the column, dry friction aside.

use forcefeel_model::drive::Drive;
use forcefeel_model::machine::{Equilibrium, Inputs, Machine, SEARCH_RAD, Shared};

/// Secants that are tried; two are the rule.
const SECANTS: usize = 6;
/// Share of the way at which they have met: what is left is a share of this step in turn.
const MET: f64 = 1e-4;

/// Whether anything pulls the loader off zero.
pub fn is_pulled(shared: &Shared, force: f64, trim: f64) -> bool {
    shared.effects.biased || force != 0.0 || trim != 0.0
}

/// Angle in rad at which the loader rests under the end of `last`, dry friction aside; not a number where nothing brings it back.
///
/// By secants from the equilibrium `start` and the angle `near`, which meet in a step or two where the springs are straight; by
/// [`Machine::held_by`] where they are not.
pub fn angle_at_rest<D: Drive<f64>>(
    machine: &Machine<f64, D>,
    shared: &Shared,
    last: &Inputs,
    start: &Equilibrium<f64>,
    near: f64,
) -> f64 {
    let (force, trim, factor) = (machine.force(last.force[1]), last.trim[1], last.stiffness_factor[1]);
    if machine.drifts() {
        return f64::NAN;
    }
    let angle_of = |equilibrium: &Equilibrium<f64>| equilibrium.base() * machine.per_base();
    let beyond = |angle: f64| machine.held_at(shared, angle, trim, factor).pilot_force - force;
    let (first, mut angle) = (angle_of(start), near);
    let mut before = (first, start.pilot_force - force);
    for _ in 0..SECANTS {
        let now = beyond(angle);
        let step = now * (angle - before.0) / (before.1 - now);
        if step.abs() <= MET * (angle - first).abs() {
            return angle + step;
        }
        before = (angle, now);
        angle += step;
        if angle.is_nan() || angle.abs() >= SEARCH_RAD {
            break;
        }
    }
    angle_of(&machine.held_by(shared, force, trim, factor))
}
