//! Load pressure in balance against the equations that it solves, and its lag against the oil's own equation, finely integrated.

use crate::draws::Draws;
use crate::near::{assert_near, assert_within};
use forcefeel_model::drive::hydraulic::pressure::{Balance, Flow};
use forcefeel_model::effects::Effects;
use forcefeel_model::parameters::Parameters;

/// The linear loader.
fn off() -> Effects {
    Effects::default()
}

/// Eq. (1) in place of eqs. (2), (4).
fn orifice() -> Effects {
    Effects { orifice: true, ..off() }
}

/// A loader with all that the balance knows of, within a factor of two of the elevator loader.
fn drawn(draws: &mut Draws) -> Parameters<f64> {
    let mut p = Parameters::elevator();
    for value in [
        &mut p.actuator.area,
        &mut p.actuator.oil_volume,
        &mut p.actuator.bulk_modulus,
        &mut p.linkage.stiffness,
        &mut p.linkage.damping,
        &mut p.valve.supply_pressure,
        &mut p.valve.pressure_gain,
    ] {
        *value *= 2.0_f64.powf(draws.uniform());
    }
    p.linkage.backlash = 5e-3;
    p.actuator.relief_pressure = 0.5 * p.valve.supply_pressure;
    p.actuator.relief_gain *= 2.0_f64.powf(draws.uniform()) * 1e-11;
    p
}

/// `b`: acceleration of the base per newton of the link, m/s² a newton.
fn per_link_force(p: &Parameters<f64>) -> f64 {
    p.column.base_acceleration(p.linkage.base_force(1.0), 0.0)
}

/// `kappa` in m/Pa: what the oil gives way at a standstill.
fn compressibility(p: &Parameters<f64>) -> f64 {
    p.actuator.oil_volume / (4.0 * p.actuator.bulk_modulus * p.actuator.area)
}

/// Flow past the piston, above the relief pressure.
fn relieved(p: &Parameters<f64>, effects: &Effects, pressure: f64) -> f64 {
    let over = (pressure.abs() - p.actuator.relief_pressure).max(0.0);
    if effects.relief { p.actuator.relief_gain * over.copysign(pressure) } else { 0.0 }
}

/// Flow that moves piston and oil at a no-load flow and a pressure: eq. (1) or eq. (4), less what the relief valve lets by.
fn flow(p: &Parameters<f64>, effects: &Effects, q_i: f64, pressure: f64) -> f64 {
    let valve = if effects.orifice {
        let rest = 1.0 - pressure * q_i.signum() / p.valve.supply_pressure;
        q_i * rest.abs().sqrt() * rest.signum()
    } else {
        q_i - p.valve.pressure_gain * pressure
    };
    valve - relieved(p, effects, pressure)
}

/// `z, q_i, q_i', x_b, w`, with pressures to either side of the supply's.
fn state(draws: &mut Draws, p: &Parameters<f64>) -> [f64; 5] {
    let far = 2.5 * p.valve.supply_pressure * p.actuator.area / p.linkage.stiffness;
    let x_b = 0.1 * draws.uniform();
    let z = p.linkage.ratio * x_b + far * draws.uniform();
    [z, 1.5e-3 * draws.uniform(), 0.0, x_b, 1.5 * draws.uniform()]
}

/// Eq. (9) with the spring's stretch `s`, less its right-hand side, as a share of its terms; `v` velocity of the base.
fn residual(p: &Parameters<f64>, found: &Flow<f64>, s: f64, v: f64) -> f64 {
    let piston_rate = found.flow / p.actuator.area;
    let terms = [
        p.actuator.area * found.pressure,
        p.linkage.stiffness * s,
        p.linkage.stiffness * compressibility(p) * found.pressure,
        p.linkage.damping * piston_rate,
        p.linkage.damping * p.linkage.ratio * v,
    ];
    let [left, spring, oil, valve, base] = terms;
    // A p = k (z - kappa p - alpha x_b) + c (q / A - alpha v)
    (left - (spring - oil) - (valve - base)).abs() / terms.map(f64::abs).iter().sum::<f64>()
}

/// Sums of terms some hundred times larger than what is left of them.
const RESIDUAL: f64 = 1e-13;

/// Runs `check` over many loaders and states; it says which of `kinds` it met, and all must be.
fn over_states(kinds: usize, check: impl Fn(&Parameters<f64>, &Balance<f64>, [f64; 5]) -> usize) {
    let mut draws = Draws::new(3);
    let mut met = vec![0; kinds];
    for _ in 0..100 {
        let p = drawn(&mut draws);
        let balance = Balance::new(&p, per_link_force(&p));
        for _ in 0..40 {
            met[check(&p, &balance, state(&mut draws, &p))] += 1;
        }
    }
    assert!(met.iter().all(|&count| count >= 20), "{met:?}");
}

/// Velocity of the base, the impulse of the link's damper given back to it.
fn base_velocity(p: &Parameters<f64>, w: f64, pressure: f64) -> f64 {
    w - per_link_force(p) * p.linkage.damping * compressibility(p) * pressure
}

#[test]
fn pressure_and_flow_fulfil_link_and_orifice_in_all_four_quadrants_and_beyond_the_supply() {
    over_states(8, |p, balance, state| {
        let [z, q_i, _, x_b, w] = state;
        let found = balance.solve(&orifice(), &balance.moving(), true, state);
        let s = z - p.linkage.ratio * x_b;
        assert!(residual(p, &found, s, base_velocity(p, w, found.pressure)) < RESIDUAL);
        // sqrt|1 - p / p_s| is steep near zero.
        assert_within(found.flow, flow(p, &orifice(), q_i, found.pressure), 1e-7 * q_i.abs());
        let against = found.pressure * q_i > 0.0;
        let beyond = found.pressure.abs() > p.valve.supply_pressure;
        4 * usize::from(q_i > 0.0) + 2 * usize::from(against) + usize::from(beyond)
    });
}

#[test]
fn orifice_and_pressure_agree_to_rounding_when_the_flow_is_put_back() {
    over_states(2, |p, balance, state| {
        let found = balance.solve(&orifice(), &balance.moving(), true, state);
        // p = s p_s (1 - y |y|), q = q_i y
        let y = found.flow / state[1];
        let pressure = p.valve.supply_pressure * (1.0 - y * y.abs()) * state[1].signum();
        assert_within(
            found.pressure,
            pressure,
            1e-14 * (found.pressure.abs() + p.valve.supply_pressure) * (1.0 + y * y),
        );
        usize::from(y > 0.0)
    });
}

#[test]
fn linear_valve_is_eq_4() {
    over_states(1, |p, balance, state| {
        let [z, q_i, _, x_b, w] = state;
        let found = balance.solve(&off(), &balance.moving(), true, state);
        let s = z - p.linkage.ratio * x_b;
        assert!(residual(p, &found, s, base_velocity(p, w, found.pressure)) < RESIDUAL);
        assert_within(found.flow, flow(p, &off(), q_i, found.pressure), 1e-15 * (q_i.abs() + found.flow.abs()));
        0
    });
}

#[test]
fn base_that_sticks_does_not_move_the_link() {
    over_states(1, |p, balance, state| {
        for effects in [off(), orifice()] {
            let stuck = balance.side(&effects, true);
            let found = balance.solve(&effects, &stuck, true, state);
            let s = z_less_base(p, state);
            assert!(residual(p, &found, s, 0.0) < RESIDUAL);
            // Side by side with one that moves, each is its own.
            let moving = balance.solve(&effects, &balance.side(&effects, false), true, state);
            let alone = balance.solve(&effects, &balance.moving(), true, state);
            assert_eq!((moving.pressure, moving.flow), (alone.pressure, alone.flow));
        }
        0
    });
}

fn z_less_base(p: &Parameters<f64>, [z, _, _, x_b, _]: [f64; 5]) -> f64 {
    z - p.linkage.ratio * x_b
}

#[test]
fn relief_valve_lets_by_what_is_above_its_pressure_and_nothing_below() {
    for base in [off(), orifice()] {
        let effects = Effects { relief: true, ..base };
        over_states(3, |p, balance, state| {
            let (q_i, w) = (state[1], state[4]);
            let side = balance.side(&effects, false);
            let (found, closed) =
                (balance.solve(&effects, &side, true, state), balance.solve(&base, &side, true, state));
            let s = z_less_base(p, state);
            assert!(residual(p, &found, s, base_velocity(p, w, found.pressure)) < RESIDUAL);
            let scale =
                q_i.abs() + relieved(p, &effects, found.pressure).abs() + p.valve.pressure_gain * found.pressure.abs();
            assert_within(found.flow, flow(p, &effects, q_i, found.pressure), 1e-7 * scale);
            let open = found.pressure.abs() > p.actuator.relief_pressure;
            // What opens it is what would be above it, and no more than that is left.
            assert_eq!(open, closed.pressure.abs() > p.actuator.relief_pressure);
            if open {
                assert!(found.pressure.abs() < closed.pressure.abs());
                return 1 + usize::from(found.pressure > 0.0);
            }
            assert_eq!((found.pressure, found.flow), (closed.pressure, closed.flow));
            0
        });
    }
}

#[test]
fn link_with_play_pushes_at_one_end_pulls_at_the_other_and_neither_between() {
    for base in [off(), orifice()] {
        let effects = Effects { backlash: true, ..base };
        over_states(3, |p, balance, mut state| {
            state[0] = p.linkage.ratio * state[3] + 0.2 * z_less_base(p, state);
            let (q_i, w, half) = (state[1], state[4], 0.5 * p.linkage.backlash);
            let side = balance.moving();
            let found = balance.solve(&effects, &side, true, state);
            let s = z_less_base(p, state);
            assert!(found.pressure * s >= 0.0, "a link that pulls at the end where it pushes");
            let free = balance.solve(&effects, &side, false, state);
            assert_eq!((free.pressure, free.flow), (0.0, q_i));
            if found.pressure == 0.0 {
                assert_near(found.flow, q_i, 0.0);
                // Within its play, or it would have to pull at the end where it pushes.
                let stretched = (s.abs() - half).max(0.0).copysign(s);
                let would = balance.linked(&effects, &side, state[0], q_i, state[3], w);
                assert!(stretched == 0.0 || would.pressure * s <= 0.0);
                return 0;
            }
            assert!(s.abs() > half);
            let stretched = s - half.copysign(s);
            assert!(residual(p, &found, stretched, base_velocity(p, w, found.pressure)) < RESIDUAL);
            1 + usize::from(s > 0.0)
        });
    }
}

#[test]
fn link_without_play_is_the_one_without_the_effect_bit_for_bit() {
    let mut draws = Draws::new(5);
    for _ in 0..200 {
        let mut p = drawn(&mut draws);
        p.linkage.backlash = 0.0;
        let balance = Balance::new(&p, per_link_force(&p));
        let state = state(&mut draws, &p);
        for base in [off(), orifice()] {
            let effects = Effects { backlash: true, ..base };
            let touches = balance.touch(balance.stretch(state[0], state[3]));
            let (with, without) = (
                balance.solve(&effects, &balance.moving(), touches, state),
                balance.solve(&base, &balance.moving(), true, state),
            );
            assert!(touches);
            assert_eq!(
                (with.pressure.to_bits(), with.flow.to_bits()),
                (without.pressure.to_bits(), without.flow.to_bits())
            );
        }
    }
}

#[test]
fn loader_at_rest_is_in_balance() {
    let mut draws = Draws::new(8);
    for _ in 0..200 {
        let p = drawn(&mut draws);
        let balance = Balance::new(&p, per_link_force(&p));
        let pressure = 0.9 * p.valve.supply_pressure * draws.uniform();
        for base in [off(), orifice()] {
            let effects = Effects { relief: true, backlash: true, ..base };
            let (stretch, q_i) = (balance.stretch_at_rest(pressure), balance.leakage(&effects, pressure));
            let z = stretch + balance.compressibility * pressure + p.linkage.ratio * 0.03;
            let w = per_link_force(&p) * balance.impulse * pressure;
            let found = balance.solve(&effects, &balance.side(&effects, false), true, [z, q_i, 0.0, 0.03, w]);
            assert_near(found.pressure, pressure, 1e-9); // the orifice is steep where little passes
            assert_within(found.flow, 0.0, 1e-9 * (q_i.abs() + 1e-6));
            assert_near(balance.piston(z, pressure), stretch + p.linkage.ratio * 0.03, 1e-12);
        }
    }
}

/// A no-load flow that rises and falls.
fn swing(t: f64) -> f64 {
    4e-4 + 3e-4 * (400.0 * t).sin()
}

/// `z, x_b, w` after 20 ms of [`swing`] from a common start: with the oil's own equation, and with the pressure slaved in steps of
/// 1 ms, what lags made good after each or not.
fn oil_and_slaved(p: &Parameters<f64>, effects: &Effects, stuck: bool) -> [[f64; 3]; 3] {
    let b = if stuck { 0.0 } else { per_link_force(p) };
    let balance = Balance::new(p, per_link_force(p));
    let (kappa, area, ratio, impulse) = (compressibility(p), p.actuator.area, p.linkage.ratio, balance.impulse);
    let (steps, parts, h) = (20, 1000, 1e-6);
    let side = balance.side(effects, stuck);
    // c kappa p' = k (z - kappa p - alpha x_b) + c (q / A - alpha v) - A p,  v' = b A p
    let oil = |t: f64, [z, x_b, v, pressure]: [f64; 4]| {
        let q = flow(p, effects, swing(t), pressure);
        let link =
            p.linkage.stiffness * (z - kappa * pressure - ratio * x_b) + p.linkage.damping * (q / area - ratio * v);
        [q / area, v, b * area * pressure, (link - area * pressure) / (p.linkage.damping * kappa)]
    };
    let at = |t: f64, [z, x_b, w, _]: [f64; 4]| balance.solve(effects, &side, true, [z, swing(t), 0.0, x_b, w]);
    let quasi_steady = |t: f64, x: [f64; 4]| {
        let found = at(t, x);
        [found.flow / area, x[2] - b * impulse * found.pressure, b * area * found.pressure, 0.0]
    };
    let first = at(0.0, [0.0; 4]).pressure;
    let mut truth = [0.0, 0.0, -b * impulse * first, first];
    let (mut plain, mut mended, mut before) = ([0.0; 4], [0.0; 4], first);
    for step in 0..steps {
        for part in 0..parts {
            let t = f64::from(step * parts + part) * h;
            truth = runge_kutta(&oil, t, truth, h);
            plain = runge_kutta(&quasi_steady, t, plain, h);
            mended = runge_kutta(&quasi_steady, t, mended, h);
        }
        let t = f64::from((step + 1) * parts) * h;
        let now = at(t, mended);
        let yielding = balance.yielding(effects, &side, swing(t), &now);
        let lag = balance.lagging(&yielding, now.pressure - before);
        mended[0] += lag.piston;
        mended[2] += b * impulse * lag.pressure;
        before = now.pressure;
    }
    [
        [truth[0], truth[1], truth[2] + b * impulse * truth[3]],
        [plain[0], plain[1], plain[2]],
        [mended[0], mended[1], mended[2]],
    ]
}

fn runge_kutta(slope: &impl Fn(f64, [f64; 4]) -> [f64; 4], t: f64, x: [f64; 4], h: f64) -> [f64; 4] {
    let moved = |k: [f64; 4], by: f64| core::array::from_fn(|i| x[i] + by * k[i]);
    let k_1 = slope(t, x);
    let k_2 = slope(t + 0.5 * h, moved(k_1, 0.5 * h));
    let k_3 = slope(t + 0.5 * h, moved(k_2, 0.5 * h));
    let k_4 = slope(t + h, moved(k_3, h));
    core::array::from_fn(|i| x[i] + h / 6.0 * (k_1[i] + 2.0 * (k_2[i] + k_3[i]) + k_4[i]))
}

#[test]
fn lag_adds_up_to_what_the_oil_s_own_equation_says() {
    let mut p = Parameters::elevator();
    p.actuator.relief_pressure = 2e5;
    p.actuator.relief_gain = 2e-10;
    let (linear, relief) = (off(), Effects { relief: true, ..off() });
    let opened = Effects { relief: true, ..orifice() };
    for (name, effects) in [("linear", linear), ("orifice", orifice()), ("relief", relief), ("orifice, relief", opened)]
    {
        for stuck in [false, true] {
            let [truth, plain, mended] = oil_and_slaved(&p, &effects, stuck);
            for (k, state) in ["z", "x_b", "w"].iter().enumerate().take(if stuck { 1 } else { 3 }) {
                let (without, with) = ((plain[k] - truth[k]).abs(), (mended[k] - truth[k]).abs());
                // Fifteen times at least; most of what is left is the next order of the lag.
                assert!(with < 0.1 * without, "{name}, {stuck}, {state}: {with:e} of {without:e}");
            }
        }
    }
}

#[test]
fn pressure_and_flow_are_behind_their_balance() {
    // Under a flow that swings, the base stuck or moving; the oil's own equation in steps far below its pole's 38 us, ours in steps
    // of that size and of many times it.
    let mut p = Parameters::elevator();
    p.actuator.relief_pressure = 2e5;
    p.actuator.relief_gain = 2e-10;
    let relief = |effects: Effects| Effects { relief: true, ..effects };
    let b = per_link_force(&p);
    let (kappa, area, ratio, h) = (compressibility(&p), p.actuator.area, p.linkage.ratio, 2e-6);
    let impulse = p.linkage.damping * kappa;
    let (omega, peak) = (120.0, 2e-4);
    let q_i = |t: f64| peak * (1.1 + (omega * t).sin());
    // What is left is the next order of the lag; the relief valve has a corner where it opens.
    for (name, effects, share) in
        [("linear", off(), 0.02), ("orifice", orifice(), 0.02), ("relief", relief(off()), 1.0)]
    {
        let balance = Balance::new(&p, b);
        for (stuck, every) in [(true, 10), (false, 10), (true, 500), (false, 500)] {
            let side = balance.side(&effects, stuck);
            let moves = f64::from(u8::from(!stuck));
            let oil = |t: f64, [z, x_b, v, pressure]: [f64; 4]| {
                let q = flow(&p, &effects, q_i(t), pressure);
                let link = p.linkage.stiffness * (z - kappa * pressure - ratio * x_b)
                    + p.linkage.damping * (q / area - ratio * v);
                let pole = (link - area * pressure) / (p.linkage.damping * kappa);
                [q / area, moves * v, moves * b * area * pressure, pole]
            };
            let at = |t: f64, [z, x_b, w]: [f64; 3]| balance.solve(&effects, &side, true, [z, q_i(t), 0.0, x_b, w]);
            let mut before = at(0.0, [0.0; 3]).pressure;
            let (mut x, mut lag) = ([0.0, 0.0, 0.0, before], 0.0);
            let (mut apart, mut flows, mut left, mut flow_left) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
            let step = h * f64::from(every);
            for k in 1..=20_000 {
                x = runge_kutta(&oil, f64::from(k - 1) * h, x, h);
                if k % every > 0 {
                    continue;
                }
                let t = f64::from(k) * h;
                let [z, x_b, v, pressure] = x;
                let quasi_steady = at(t, [z, x_b, v + moves * b * impulse * pressure]);
                let q_rate = peak * omega * (omega * t).cos();
                let rates =
                    [quasi_steady.flow / area, q_rate, 0.0, moves * v, moves * b * area * quasi_steady.pressure];
                let yielding = balance.yielding(&effects, &side, q_i(t), &quasi_steady);
                let rate = balance.slaved_rate(&side, &yielding, (q_i(t), &quasi_steady), &rates);
                let change = (lag, quasi_steady.pressure - before, rate);
                let found = balance.behind(&yielding, &quasi_steady, change, (step, 1.0 / step));
                (before, lag) = (quasi_steady.pressure, quasi_steady.pressure - found.pressure);
                if k < 1000 {
                    continue; // the swing begins with a corner
                }
                let through = flow(&p, &effects, q_i(t), pressure);
                apart = apart.max((quasi_steady.pressure - pressure).abs());
                left = left.max((found.pressure - pressure).abs());
                flows = flows.max((quasi_steady.flow - through).abs());
                flow_left = flow_left.max((found.flow - through).abs());
            }
            assert!(left < share * apart, "{name}, {stuck}, {every}: {left:e} Pa of {apart:e}");
            assert!(flow_left < share * flows, "{name}, {stuck}, {every}: {flow_left:e} m^3/s of {flows:e}");
        }
    }
}

#[test]
fn lag_dies_away_as_the_oil_s_pole() {
    // From a lag that nothing feeds, in steps of a fraction of the time constant and of many.
    let p = Parameters::elevator();
    let balance = Balance::new(&p, per_link_force(&p));
    let side = balance.side(&off(), true);
    let quasi_steady = balance.solve(&off(), &side, true, [0.0; 5]);
    let yielding = balance.yielding(&off(), &side, 0.0, &quasi_steady);
    let time = p.linkage.damping * compressibility(&p)
        / (p.actuator.area
            + p.linkage.stiffness * compressibility(&p)
            + p.linkage.damping / p.actuator.area * p.valve.pressure_gain);
    for share in [0.01, 0.3, 1.0, 30.0] {
        let step = share * time;
        let found = balance.behind(&yielding, &quasi_steady, (1e5, 0.0, 0.0), (step, 1.0 / step));
        assert_within(found.pressure, -1e5 * f64::exp(-share), 1e5 * 0.008);
    }
}
