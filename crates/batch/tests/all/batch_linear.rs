//! The step in its linear limit against the matrix exponential, and how its error falls with the step.

use crate::runs::{GAINS, job, order, pushed, run};
use forcefeel_model::Scalar;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::dual::Dual;
use forcefeel_model::loader::Compliant;
use forcefeel_model::machine::Inputs;
use forcefeel_model::parameters::Parameters;
use forcefeel_simulate::batch::Job;
use forcefeel_solve::law::Law;
use forcefeel_solve::{StateSpace, linearize};
use nalgebra::{DMatrix, DVector};

/// Full travel in rad.
const TRAVEL: f64 = 0.7;
/// Length of the run in s, and distance of the points between which the force is straight.
const DURATION: f64 = 0.8;
const POINTS: f64 = 4e-3;

fn law_of<S: Scalar>(p: &Parameters<S>, gains: Option<[f64; 7]>) -> Compensator<S> {
    let like = p.column.inertia;
    gains.map_or_else(
        || Compensator::original(p),
        |gains| Compensator::state_feedback(p, gains.map(|gain| like.constant(gain))),
    )
}

/// Force at the points: a jump at once, then a chirp.
fn force(point: u32) -> f64 {
    let t = f64::from(point) * POINTS;
    200.0 + 150.0 * (30.0 * t * (1.0 + t)).sin()
}

fn inputs(h: f64) -> Vec<Inputs> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a handful")]
    let [parts, points] = [POINTS / h, DURATION / POINTS].map(|count| count.round() as u32);
    let at =
        |point: u32, part: u32| force(point) + (force(point + 1) - force(point)) * f64::from(part) / f64::from(parts);
    (0..points).flat_map(|point| (0..parts).map(move |part| pushed([at(point, part), at(point, part + 1)]))).collect()
}

/// Column angle at the points by the exponential of the linear model, force and slope among its states.
fn exact(p: &Parameters<f64>, gains: Option<[f64; 7]>) -> Vec<f64> {
    let parameters = p.map(|value| Dual::constant(1.0).constant(value));
    let compensator = law_of(&parameters, gains);
    let model: StateSpace = linearize(&Compliant { parameters, compensator }, &[0.0; 8], &[0.0; 2]);
    let mut whole = DMatrix::zeros(10, 10);
    whole.view_mut((0, 0), (8, 8)).copy_from(&(&model.a * POINTS));
    whole.view_mut((0, 8), (8, 1)).copy_from(&(model.b.column(0) * POINTS));
    whole[(8, 9)] = 1.0;
    let transition = whole.exp();
    let mut x = DVector::zeros(8);
    let mut angles = Vec::new();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundreds of points")]
    for point in 0..(DURATION / POINTS).round() as u32 {
        angles.push((model.c.row(0) * &x)[0]);
        let mut all = DVector::zeros(10);
        all.rows_mut(0, 8).copy_from(&x);
        (all[8], all[9]) = (force(point), force(point + 1) - force(point));
        x = (&transition * all).rows(0, 8).into_owned();
    }
    angles.push((model.c.row(0) * &x)[0]);
    angles
}

/// Largest error of the column angle at the points with this step, as a share of the travel.
fn error(p: &Parameters<f64>, gains: Option<[f64; 7]>, exact: &[f64], h: f64) -> f64 {
    let (inputs, values) = (inputs(h), [p.values()]);
    let mut job = Job { law: Law::Fixed(law_of(p, gains)), outputs: &[0], ..job(&inputs, &values, None) };
    job.shared.step_s = h;
    let (_, angles) = run(&job, 1);
    let parts = (angles.len() - 1) / (exact.len() - 1);
    let off = |(k, exact): (usize, &f64)| (angles[k * parts] - exact).abs();
    exact.iter().enumerate().map(off).fold(0.0, f64::max) / TRAVEL
}

const LAWS: [Option<[f64; 7]>; 2] = [None, Some(GAINS)];

#[test]
fn linear_limit_is_the_matrix_exponential_but_for_the_slaving() {
    let p = Parameters::elevator();
    for gains in LAWS {
        let exact = exact(&p, gains);
        assert!(exact.iter().fold(0.0, |most: f64, angle| most.max(angle.abs())) > 0.05);
        // At 2 ms the step itself is seen; below, what slaving the pressure costs at any step.
        for (h, allowed) in [(2e-3, 5e-6), (1e-3, 4e-6), (2.5e-4, 4e-6)] {
            let error = error(&p, gains, &exact, h);
            assert!(error < allowed, "{h}: {error:e}");
        }
    }
}

#[test]
fn step_is_of_fourth_order_where_nothing_is_slaved() {
    // Without the link's damper there is no oil pole.
    let mut p = Parameters::elevator();
    p.linkage.damping *= 1e-4;
    for gains in LAWS {
        let exact = exact(&p, gains);
        let errors = [4e-3, 2e-3, 1e-3].map(|h| error(&p, gains, &exact, h));
        assert!(order(&errors) > 3.7, "{errors:?}");
        assert!(errors[2] < 3e-7, "{errors:?}");
    }
}
