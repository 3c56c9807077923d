//! The whole machine step by step: in equilibrium, stuck, against its stops, mirrored, and under a digital controller.

use crate::near::{assert_near, assert_within};
use forcefeel_model::compensator::Compensator;
use forcefeel_model::controller::Timing;
use forcefeel_model::drive::hydraulic::{CURRENT, FLOW, PRESSURE};
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Inputs, Machine, Shared, Snapshot};
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::SENSORS;

const STEP: f64 = 1e-3;

/// Gains of the size that the design gives.
const GAINS: [f64; 7] = [-194.0, -3.8e-9, 22.0, 0.67, 19.9, -0.7, -1.5e-3];

/// The elevator loader with every optional row at its example, but what sets one side before the other, and without noise.
fn everything() -> Parameters<f64> {
    let mut p = Parameters::with_every_row();
    for one_sided in [
        &mut p.load_cell.offset,
        &mut p.potentiometer.offset,
        &mut p.column_sensor.offset,
        &mut p.feel.preload,
        &mut p.feel.detent_angle,
    ] {
        *one_sided = 0.0;
    }
    for noise in [&mut p.load_cell.noise, &mut p.potentiometer.noise, &mut p.column_sensor.noise] {
        *noise = 0.0;
    }
    p.controller.period = 0.0;
    p
}

fn still(force: f64) -> Inputs {
    Inputs { force: [force; 2], ..Inputs::NONE }
}

/// A machine with its state.
struct Run {
    machine: Machine<f64>,
    shared: Shared,
    law: Compensator<f64>,
}

impl Run {
    fn new(p: &Parameters<f64>, gains: Option<[f64; 7]>, timing: Option<Timing>) -> Self {
        let effects = Effects { sampled: timing.is_some(), ..Effects::of(&p.values()) };
        let shared = Shared { effects, step_s: STEP, timing, curve: None, cancellation: None };
        let law = gains.map_or_else(|| Compensator::original(p), |gains| Compensator::state_feedback(p, gains));
        Self { machine: Machine::new(p, law, &shared), shared, law }
    }

    /// What there is at the start of each step and at the end of the last, from rest at an angle. Compiled once for all inputs: a step is long.
    fn from(&self, theta: f64, steps: usize, inputs: &dyn Fn(usize) -> Inputs) -> Vec<Snapshot<f64>> {
        let equilibrium = self.machine.held_at(&self.shared, theta, 0.0, 1.0);
        let (mut state, mut memory) =
            (self.machine.start(&self.shared, &equilibrium), self.machine.remember(&self.shared, &equilibrium));
        let mut seen = Vec::new();
        for step in 0..=steps {
            let now = if step == steps { inputs(step).end() } else { inputs(step) };
            let step_start = self.machine.begin(&self.shared, &mut state, &mut memory, &now, &mut || [0.0; SENSORS]);
            seen.push(step_start.now);
            self.machine.advance(&self.shared, &mut state, &now, &step_start);
        }
        seen
    }

    fn angle(&self, now: &Snapshot<f64>) -> f64 {
        now.base * self.machine.per_base()
    }
}

const TIMING: Timing = Timing { period: 2, delay: 1 };

/// Both laws, analog and digital.
fn all_runs(p: &Parameters<f64>) -> impl Iterator<Item = Run> {
    let laws = [None, Some(GAINS)];
    laws.into_iter().flat_map(|gains| [None, Some(TIMING)].map(|timing| Run::new(p, gains, timing)))
}

#[test]
fn machine_at_rest_stays_at_rest_bit_for_bit() {
    for p in [Parameters::elevator(), everything()] {
        for run in all_runs(&p) {
            for now in run.from(0.0, 300, &|_| still(0.0)) {
                let all = [
                    now.base,
                    now.base_rate,
                    now.delta,
                    now.delta_rate,
                    now.position,
                    now.force,
                    now.signals[FLOW],
                    now.signals[CURRENT],
                ];
                assert!(all.iter().all(|&value| value == 0.0), "{now:?}");
            }
        }
    }
}

#[test]
fn machine_held_at_an_angle_is_at_rest() {
    let mut p = everything();
    // With dry friction it would rest in any case.
    (p.column.coulomb_friction, p.column.static_friction) = (0.0, 0.0);
    (p.feel.coulomb_friction, p.feel.static_friction) = (0.0, 0.0);
    for run in all_runs(&p) {
        let equilibrium = run.machine.held_at(&run.shared, 0.1, 0.0, 1.0);
        let seen = run.from(0.1, 300, &|_| still(equilibrium.pilot_force));
        // Converters of the example's 16 bits over 20 V move the digital command by 0.3 mV: 1e-4 rad of 7.6 V/in, 5.9 in/rad.
        let allowed = if run.shared.timing.is_some() { 1e-4 } else { 1e-11 };
        for now in seen {
            assert_within(run.angle(&now), 0.1, allowed);
        }
    }
}

#[test]
fn force_below_breakaway_moves_nothing_and_one_above_does() {
    let mut p = everything();
    p.linkage.backlash = 0.0;
    // A law that receives the pilot's force would move the servo under the resting column.
    let deaf = core::array::from_fn(|k| if k == 6 { 0.0 } else { GAINS[k] });
    for run in
        [None, Some(deaf)].into_iter().flat_map(|gains| [None, Some(TIMING)].map(|timing| Run::new(&p, gains, timing)))
    {
        let ramp = |newton_per_s: f64| {
            #[expect(clippy::cast_precision_loss, reason = "some hundreds of steps")]
            let at = move |step: usize| newton_per_s * STEP * step as f64;
            move |step: usize| Inputs { force: [at(step), at(step + 1)], ..still(0.0) }
        };
        let held = p.column.static_friction * (1.0 + p.column.friction_asymmetry);
        let seen = run.from(0.0, 200, &ramp(held / 0.2));
        assert!(seen[..200].iter().all(|now| now.base == 0.0 && now.base_rate == 0.0));
        let seen = run.from(0.0, 300, &ramp(held / 0.2));
        let broken = seen.iter().position(|now| now.base_rate != 0.0).expect("it breaks away");
        assert!((200..=202).contains(&broken), "{broken}");
        assert!(seen[300].base > 0.0);
    }
}

#[test]
fn mirrored_machine_does_the_mirrored_thing() {
    let mut p = everything();
    p.column.friction_asymmetry = 0.0;
    (p.column.stop_low, p.column.stop_high) = (-0.1, 0.1);
    (p.feel.hard_stop_low, p.feel.hard_stop_high) = (-0.11, 0.11);
    (p.feel.soft_stop_low, p.feel.soft_stop_high) = (-0.08, 0.08);
    p.linkage.backlash = 2e-4;
    for run in all_runs(&p) {
        let swing =
            |sign: f64| move |step: usize| still(sign * if (step / 150).is_multiple_of(2) { 900.0 } else { -850.0 });
        let (one, other) = (run.from(0.0, 900, &swing(1.0)), run.from(0.0, 900, &swing(-1.0)));
        let furthest = one.iter().map(|now| run.angle(now).abs()).fold(0.0, f64::max);
        assert!(furthest > p.feel.soft_stop_high, "it reaches its stops: {furthest}");
        for (now, mirrored) in one.iter().zip(&other) {
            // A valve that has not moved yet has no sign, so 1 - p / p_s is rounded on either side of one.
            assert_within(now.base, -mirrored.base, 1e-14);
            assert_within(now.delta, -mirrored.delta, 1e-12); // up to 10 V
            assert_within(now.signals[PRESSURE], -mirrored.signals[PRESSURE], 1e-6); // up to 1e7 Pa
        }
    }
}

#[test]
fn stop_carries_what_pilot_and_link_leave() {
    let mut p = Parameters::elevator();
    (p.column.stop_low, p.column.stop_high) = (-0.15, 0.15);
    // The report's feel shakes against a column that a stop holds; a heavy one rests.
    (p.feel.inertia, p.feel.damping) = (50.0 * p.feel.inertia, 100.0 * p.feel.damping);
    for gains in [None, Some(GAINS)] {
        let run = Run::new(&p, gains, None);
        for force in [700.0, -700.0] {
            let seen = run.from(0.0, 4000, &|_| still(force));
            let last = &seen[4000];
            let depth = run.angle(last) - 0.15 * force.signum();
            assert!(depth * force > 0.0);
            // R_p F_p + alpha R_b F_c = k_stop d                                                        eq. (6) at rest
            let torque = p.column.pilot_torque(force) + p.linkage.base_force(last.force) * p.column.base_arm;
            assert_near(p.column.stop_stiffness * depth, torque, 1e-6); // still settling
        }
    }
}

#[test]
fn sensors_at_rest_show_no_end_stop_however_near() {
    let mut p = Parameters::with_every_row();
    let shown = |p: &Parameters<f64>| {
        let run = Run::new(p, None, Some(TIMING));
        run.machine.sensors_at_rest(&run.shared.effects)
    };
    (p.column.stop_low, p.column.stop_high) = (-0.3, 0.3);
    let far = shown(&p);
    (p.column.stop_low, p.column.stop_high) = (-0.01, 0.01);
    for (near, far) in shown(&p).as_flattened().iter().zip(far.as_flattened()) {
        assert_within(*near, *far, 0.0);
    }
}

#[test]
fn digital_command_stays_between_its_arrivals() {
    let timing = Timing { period: 4, delay: 3 };
    let mut p = Parameters::elevator();
    p.controller.period = 4.0 * STEP;
    let run = Run::new(&p, None, Some(timing));
    let seen = run.from(0.0, 200, &|_| still(400.0));
    for (step, pair) in (1..).zip(seen.windows(2)) {
        let arrives = step >= timing.delay && (step - timing.delay).is_multiple_of(timing.period);
        assert!(arrives || pair[0].signals[CURRENT].to_bits() == pair[1].signals[CURRENT].to_bits(), "step {step}");
        // The first sample saw a loader at rest; every later one one that moves.
        assert!(
            !arrives
                || step == timing.delay
                || pair[0].signals[CURRENT].to_bits() != pair[1].signals[CURRENT].to_bits(),
            "step {step}"
        );
        // The feel computer moves on at a sample, and stands until the next.
        assert!(step % timing.period == 1 || pair[0].delta.to_bits() == pair[1].delta.to_bits(), "step {step}");
    }
}

#[test]
fn load_cell_gives_eq_12_to_the_feel() {
    // Under a constant force the programmed displacement settles where its spring carries what the load cell shows.
    let p = Parameters::elevator();
    for gains in [None, Some(GAINS)] {
        let run = Run::new(&p, gains, None);
        let seen = run.from(0.0, 6000, &|_| still(300.0));
        let last = &seen[6000];
        assert_near(p.feel.stiffness * last.delta, run.law.feel_torque(last.force), 1e-6); // still settling
        assert!(last.delta > 0.0);
    }
}

#[test]
fn every_step_of_a_release_is_finite_at_two_milliseconds() {
    let p = everything();
    for mut run in all_runs(&p) {
        run.shared.step_s = 2e-3;
        run.machine = Machine::new(&p, run.law, &run.shared);
        for now in run.from(0.2, 1000, &|_| still(0.0)) {
            assert!(run.angle(&now).abs() < 0.25 && now.signals[PRESSURE].abs() < 2.0 * p.valve.supply_pressure);
        }
    }
}
