//! The link: its torque by closed forms, and that it gives no energy.

use crate::draws::Draws;
use forcefeel_model::electronic_link::ElectronicLink;
use forcefeel_model::link::{LINK_ROWS, LINK_TABLE, PilotLink};
use forcefeel_model::shaft::Shaft;

const RUNS: u64 = 10_000;
const FEW: u64 = 1000;
const STEPS: usize = 1500;
const STEP_S: f64 = 1e-3;
/// Place of the ratio in a link's values.
const RATIO: usize = 7;
/// Place of the first row of a body at the middle.
const BODY: usize = 8;
/// Of the energy that passes through the link: the sum over steps takes a kink of the torque for a straight line.
const SUM_ERROR: f64 = 2e-3;
/// The same with a body, whose step is of the second order.
const BODY_ERROR: f64 = 1e-2;

#[test]
fn the_torque_has_play_a_breakout_and_a_ramp_after_it() {
    // k, c, p, M_b, k_a
    let link = PilotLink::from_values(&[200.0, 3.0, 0.02, 10.0, 50.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let cases: [(f64, f64); 6] = [(0.009, 0.0), (0.03, 4.0), (-0.03, -4.0), (0.06, 10.0), (0.08, 11.0), (-0.08, -11.0)];
    for (phi, expected) in cases {
        assert!((link.torque([phi, 0.0]) - expected).abs() < 1e-12, "{phi}");
        assert!((link.torque([phi, 2.0]) - expected - 6.0).abs() < 1e-12, "{phi}");
        assert_eq!(link.gives_way(phi), phi.abs() > 0.0601, "{phi}");
    }
    let stiff = PilotLink::from_values(&[200.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!((stiff.torque([3.0, 0.0]) - 600.0).abs() < 1e-9);
    assert!(!stiff.gives_way(1e9));
}

#[test]
fn the_table_holds_its_own_values() {
    for row in LINK_TABLE {
        assert!(row.minimum_us <= row.default_us && row.default_us <= row.maximum_us, "{}", row.name);
        let off = if row.name == "ratio" { 1.0_f64 } else { 0.0 };
        let bits = [off, f64::INFINITY].map(f64::to_bits);
        assert!(row.off_us.is_none_or(|value| bits.contains(&value.to_bits())), "{}", row.name);
    }
}

/// Angles of a control that begins at zero: three sines of random size, up to some Hz.
fn motion(draws: &mut Draws) -> Vec<f64> {
    let sines: Vec<_> = (0..3).map(|_| [0.1 * draws.uniform(), 25.0 * draws.uniform()]).collect();
    let at = |step: usize| {
        let time = f64::from(u32::try_from(step).expect("few")) * STEP_S;
        sines.iter().map(|[size, frequency]| size * (frequency * time).sin()).sum()
    };
    (0..=STEPS).map(at).collect()
}

fn step(draws: &mut Draws) -> usize {
    usize::try_from(draws.whole(1, 2 * i32::try_from(STEPS).expect("few"))).expect("from one on")
}

/// A random link, its two motions, and when it is disconnected; one column jams at times.
fn drawn(draws: &mut Draws) -> ([f64; LINK_ROWS], [Vec<f64>; 2], usize) {
    let between = |draws: &mut Draws, high: f64| draws.uniform().abs() * high;
    let mut values = [0.0; LINK_ROWS];
    values[RATIO] = 2.0 * draws.uniform();
    for (value, high) in values.iter_mut().zip([2000.0, 20.0, 0.05, 100.0, 500.0]) {
        *value = between(draws, high);
    }
    let mut motions = [motion(draws), motion(draws)];
    let jam = step(draws);
    let jammed = &mut motions[usize::from(draws.uniform() > 0.0)];
    for k in jam..=STEPS {
        jammed[k] = jammed[jam];
    }
    (values, motions, step(draws))
}

#[test]
fn no_energy_comes_out_of_a_mechanical_link() {
    for run in 0..RUNS {
        let draws = &mut Draws::new(run);
        let (values, [first, second], disconnect) = drawn(draws);
        let (link, uncouples) = (PilotLink::from_values(&values), draws.uniform() > 0.0);
        let (mut out, mut through, mut open) = (0.0, 0.0, false);
        let phi: Vec<_> = first.iter().zip(&second).map(|(a, b)| a - values[RATIO] * b).collect();
        for k in 0..STEPS {
            open = open || k >= disconnect || uncouples && link.gives_way(phi[k]);
            let moved = phi[k + 1] - phi[k];
            let ends = [phi[k], phi[k + 1]].map(|at| if open { 0.0 } else { link.torque([at, moved / STEP_S]) });
            let [on_first, on_second] = link.on_each(0.5 * (ends[0] + ends[1]));
            let work = on_first * (first[k + 1] - first[k]) + on_second * (second[k + 1] - second[k]);
            (out, through) = (out + work, through + f64::abs(work));
            assert!(out <= SUM_ERROR * through, "run {run}, step {k}: {out} J of {through} J");
        }
    }
}

/// Energy out of an electronic link at its largest, over that which passes; no damping where `injected` is zero.
fn electronic_energy(run: u64, injected: f64) -> f64 {
    let draws = &mut Draws::new(run);
    let (mut values, [first, second], disconnect) = drawn(draws);
    let delay = usize::try_from(draws.whole(1, 20)).expect("positive");
    // The bound is that of a spring: a damper over a delay is another's.
    (values[1], values[6]) = (0.0, injected);
    let mut link = ElectronicLink::new(&values, |value| value, delay);
    let dampings = link.injected(STEP_S);
    let (mut out, mut most, mut through) = (0.0, 0.0f64, 0.0);
    for k in 0..STEPS {
        let seen = link.sampled([[first[k], 0.0], [second[k], 0.0]], STEP_S);
        if k >= disconnect {
            break;
        }
        let moved = [first[k + 1] - first[k], second[k + 1] - second[k]];
        let torques = [0, 1].map(|side| link.link().on_each(link.link().torque(seen[side]))[side]);
        for ((torque, damping), moved) in torques.into_iter().zip(dampings).zip(moved) {
            // A rate that changes within the period takes more than its mean.
            out += torque * moved - damping * moved * moved / STEP_S;
            through += f64::abs(torque * moved);
        }
        most = most.max(out);
    }
    most / f64::max(through, f64::MIN_POSITIVE)
}

#[test]
fn no_energy_comes_out_of_an_electronic_link_with_injected_damping() {
    for run in 0..RUNS {
        let share = electronic_energy(run, f64::INFINITY);
        assert!(share <= SUM_ERROR, "run {run}: {share}");
    }
    let active = (0..FEW).filter(|&run| electronic_energy(run, 0.0) > SUM_ERROR).count();
    assert!(active > 100, "the delay alone gives energy: {active} runs of {FEW}");
}

/// As [`drawn`], with a body at the middle whose own rate is slow beside the step.
fn with_body(draws: &mut Draws) -> ([f64; LINK_ROWS], [Vec<f64>; 2], usize) {
    let (mut values, motions, opens) = drawn(draws);
    let [inertia, damping, stiffness] = [0.5, 0.0, 0.0].map(|low| low + 20.0 * draws.uniform().abs());
    values[BODY..BODY + 3].copy_from_slice(&[inertia, damping, 20.0 * stiffness]);
    (values, motions, opens)
}

#[test]
fn no_energy_comes_out_of_a_shaft_with_a_body_at_its_middle() {
    for run in 0..RUNS {
        let draws = &mut Draws::new(run);
        let (values, [first, second], disconnect) = with_body(draws);
        let mut shaft = Shaft::new(&values, draws.uniform() > 0.0, [first[0], second[0]]);
        let (mut out, mut through) = (0.0, 0.0);
        for k in 0..STEPS {
            shaft.open |= k >= disconnect;
            let moved = [first[k + 1] - first[k], second[k + 1] - second[k]];
            let start = shaft.on_each();
            let mut end = start;
            shaft.step(STEP_S, |on_each| {
                end = on_each;
                [[first[k + 1], moved[0] / STEP_S], [second[k + 1], moved[1] / STEP_S]]
            });
            let work: f64 = (0..2).map(|side| 0.5 * (start[side] + end[side]) * moved[side]).sum();
            (out, through) = (out + work, through + f64::abs(work));
            assert!(out <= BODY_ERROR * through, "run {run}, step {k}: {out} J of {through} J");
        }
    }
}

#[test]
fn no_energy_comes_out_of_an_electronic_link_with_a_body_and_injected_damping() {
    for run in 0..FEW {
        let draws = &mut Draws::new(run);
        let (mut values, [first, second], opens) = with_body(draws);
        let delay = usize::try_from(draws.whole(1, 20)).expect("positive");
        (values[1], values[6]) = (0.0, f64::INFINITY);
        let mut link = ElectronicLink::new(&values, |value| value, delay);
        let dampings = link.injected(STEP_S);
        let (mut out, mut through) = (0.0, 0.0);
        for k in 0..STEPS.min(opens) {
            let seen = link.sampled([[first[k], 0.0], [second[k], 0.0]], STEP_S);
            for (side, of) in [&first, &second].into_iter().enumerate() {
                let moved = of[k + 1] - of[k];
                let torque = link.link().on_each(link.link().torque(seen[side]))[side];
                out += torque * moved - dampings[side] * moved * moved / STEP_S;
                through += f64::abs(torque * moved);
            }
            assert!(out <= BODY_ERROR * through, "run {run}, step {k}: {out} J of {through} J");
        }
    }
}
