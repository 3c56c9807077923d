//! Stops against a mass that meets a spring and damper, solved in closed form.

use crate::near::{ROUNDING, assert_near};
use forcefeel_model::contact::{Push, Stops, since_touch};

const STOPS: Stops<f64> = Stops { low: -0.3, high: 0.2, stiffness: 9e3, damping: 20.0 };

#[test]
fn stop_pushes_out_with_spring_and_damper_and_never_pulls() {
    for (x, v, force) in [
        (0.25, 0.0, -9e3 * 0.05),
        (0.25, 2.0, -(9e3 * 0.05 + 20.0 * 2.0)),
        (0.25, -10.0, -(9e3 * 0.05 - 20.0 * 10.0)),
        (0.25, -30.0, 0.0), // it goes out faster than the spring follows
        (-0.31, 0.0, 9e3 * 0.01),
        (-0.31, -3.0, 9e3 * 0.01 + 20.0 * 3.0),
        (-0.31, 5.0, 0.0),
        (0.2, 4.0, 0.0), // it has been left, by a stage of a step that began inside
        (0.1, 50.0, 0.0),
        (-0.3, -50.0, 0.0),
    ] {
        let touching = if x > 0.0 { 0.26 } else { -0.32 };
        assert_near(STOPS.force(touching, (x, v)), force, 1e-13); // 0.25 - 0.2 is off by a rounding of 0.25
        assert_near(STOPS.force(0.1, (x, v)), 0.0, 0.0);
    }
}

#[test]
fn both_stops_are_touched_beyond_and_not_at_their_place() {
    let touched = [-0.31, -0.3, 0.0, 0.2, 0.200_001].map(|x| STOPS.touch(x));
    assert_eq!(touched, [true, false, false, false, true]);
}

#[test]
fn what_has_not_touched_is_not_pushed() {
    // Within, outwards again, and what touched before: its force is in the step already.
    for way in [(0.0, 0.1), (0.1, 0.2), (0.21, 0.19), (0.21, 0.22), (-0.31, -0.35)] {
        let Push { velocity, displacement } = STOPS.push(way, 5.0, 1e-3, 1.0);
        assert_eq!((velocity.to_bits(), displacement.to_bits()), (0, 0));
    }
}

#[test]
fn lower_stop_is_the_upper_one_mirrored() {
    let mirrored = Stops { low: -0.2, high: 0.3, ..STOPS };
    let (up, down) = (STOPS.push((0.19, 0.23), 8.0, 5e-3, 0.7), mirrored.push((-0.19, -0.23), -8.0, 5e-3, 0.7));
    assert!(up.velocity < 0.0 && up.displacement < 0.0);
    assert_eq!((up.velocity, up.displacement), (-down.velocity, -down.displacement));
}

#[test]
fn touch_under_constant_velocity_is_timed_exactly() {
    let (x_0, v, h) = (0.1997, 0.8, 1e-3);
    let x: f64 = x_0 + v * h;
    let (time, at_touch) = since_touch(true, (x - 0.2, x - x_0), v, h);
    assert_near(time, (x - 0.2) / v, ROUNDING);
    assert_near(at_touch, v, 1e-12); // x - x_0 has three digits less than x
}

/// Position and velocity after `t` under the acceleration `a`.
fn free((x, v): (f64, f64), a: f64, t: f64) -> (f64, f64) {
    (x + v * t + 0.5 * a * t * t, v + a * t)
}

/// Time at which a mass from `x` with `v` under `a` reaches the upper stop.
fn reaches((x, v): (f64, f64), a: f64) -> f64 {
    let way = STOPS.high - x;
    2.0 * way / (v + f64::sqrt(v * v + 2.0 * a * way))
}

/// The same in the upper stop, from its edge with velocity `v`; `x'' = a - k d - c x'`.
fn in_stop(v: f64, a: f64, t: f64) -> (f64, f64) {
    let (k, c) = (STOPS.stiffness, STOPS.damping);
    let (rest, sigma) = (a / k, 0.5 * c);
    let w = f64::sqrt(k - sigma * sigma);
    // d = rest + exp(-sigma t) (A cos w t + B sin w t)
    let (a_0, b_0) = (-rest, (v - sigma * rest) / w);
    let (sine, cosine) = (w * t).sin_cos();
    let wave = a_0 * cosine + b_0 * sine;
    let slope = w * (b_0 * cosine - a_0 * sine);
    let decay = f64::exp(-sigma * t);
    (STOPS.high + rest + decay * wave, decay * (slope - sigma * wave))
}

/// How fast a quantity falls with the step: the least slope over halvings.
fn order(errors: &[f64]) -> f64 {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).fold(f64::INFINITY, f64::min)
}

const STEPS: [f64; 4] = [2e-3, 1e-3, 5e-4, 2.5e-4];

#[test]
fn time_since_touch_is_of_second_order_under_acceleration() {
    for share in [0.15, 0.5, 0.85] {
        let errors = STEPS.map(|h| {
            let (v, a) = (1.0, -150.0);
            let x_0 = STOPS.high - free((0.0, v), a, share * h).0;
            let (x, rate) = free((x_0, v), a, h);
            let (time, at_touch) = since_touch(true, (x - STOPS.high, x - x_0), rate, h);
            let touched = reaches((x_0, v), a);
            (time - (h - touched)).abs() / h + (at_touch - (v + a * touched)).abs()
        });
        assert!(order(&errors) > 1.9, "{share}: {errors:?}");
    }
}

#[test]
fn push_makes_good_a_touch_inside_a_step_to_second_order() {
    for share in [0.1, 0.5, 0.9] {
        for (v, a) in [(1.5, 0.0), (1.5, -200.0), (0.7, 300.0)] {
            let errors = STEPS.map(|h| {
                let x_0 = STOPS.high - free((0.0, v), a, share * h).0;
                let (x, rate) = free((x_0, v), a, h);
                let push = STOPS.push((x_0, x), rate, h, 1.0);
                let touched = reaches((x_0, v), a);
                let (x_exact, rate_exact) = in_stop(v + a * touched, a, h - touched);
                [(x + push.displacement - x_exact).abs(), (rate + push.velocity - rate_exact).abs()]
            });
            // The stop changes the velocity in proportion to h, the place to h^2: what is left is an order smaller.
            let [place, speed] = [0, 1].map(|k| order(&errors.map(|error| error[k])));
            assert!(speed > 1.9 && place > 2.7, "{share}, {v}, {a}: {speed:.2}, {place:.2} {errors:?}");
        }
    }
}

#[test]
fn push_scales_with_the_acceleration_per_force() {
    let heavy = Stops { stiffness: STOPS.stiffness * 4.0, damping: STOPS.damping * 4.0, ..STOPS };
    let (one, other) = (STOPS.push((0.199, 0.201), 2.0, 1e-3, 1.0), heavy.push((0.199, 0.201), 2.0, 1e-3, 0.25));
    assert_eq!((one.velocity, one.displacement), (other.velocity, other.displacement));
}

/// A mass that flies freely, touches and bounces, in steps as the machine takes them; the force on it is `a` beside the stop's.
fn bounce((mut x, mut v): (f64, f64), a: f64, h: f64, until: f64) -> (f64, f64) {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundreds of steps")]
    for _ in 0..(until / h).round() as usize {
        let x_0 = x;
        let pull = |x: f64, v: f64| a + STOPS.force(x_0, (x, v));
        let k_1 = (v, pull(x, v));
        let k_2 = (v + 0.5 * h * k_1.1, pull(x + 0.5 * h * k_1.0, v + 0.5 * h * k_1.1));
        let k_3 = (v + 0.5 * h * k_2.1, pull(x + 0.5 * h * k_2.0, v + 0.5 * h * k_2.1));
        let k_4 = (v + h * k_3.1, pull(x + h * k_3.0, v + h * k_3.1));
        x += h / 6.0 * (k_1.0 + 2.0 * (k_2.0 + k_3.0) + k_4.0);
        v += h / 6.0 * (k_1.1 + 2.0 * (k_2.1 + k_3.1) + k_4.1);
        let push = STOPS.push((x_0, x), v, h, 1.0);
        (x, v) = (x + push.displacement, v + push.velocity);
    }
    (x, v)
}

#[test]
fn mass_comes_back_from_the_stop_as_in_closed_form() {
    let (v, a, until) = (1.3, -2.0, 0.06);
    for start in [0.19, 0.1911, 0.1923, 0.1937] {
        let touched = reaches((start, v), a);
        let at_touch = v + a * touched;
        // It leaves where -(k d + c d') turns to a pull, the first time after it has turned round.
        let (mut inside, mut out) = (0.5 * core::f64::consts::PI / STOPS.stiffness.sqrt(), until - touched);
        for _ in 0..80 {
            let t = 0.5 * (inside + out);
            let (x, rate) = in_stop(at_touch, a, t);
            let pushes = STOPS.stiffness * (x - STOPS.high) + STOPS.damping * rate > 0.0;
            (inside, out) = if pushes { (t, out) } else { (inside, t) };
        }
        let (x, rate) = free(in_stop(at_touch, a, inside), a, until - touched - inside);
        assert!(x < STOPS.high && rate < -0.7 * at_touch, "it has come back: {x}, {rate}");
        let errors = [1e-3, 5e-4, 2.5e-4, 1.25e-4].map(|h| {
            let found = bounce((start, v), a, h, until);
            (found.1 - rate).abs() / at_touch
        });
        assert!(errors[0] < 2e-3 && errors[3] < 4e-5, "{start}: {errors:?}");
    }
}

#[test]
fn stop_gives_no_energy() {
    // Without damping, over places of the touch within the step: what comes back is what went in, to second order.
    let undamped = Stops { damping: 0.0, ..STOPS };
    for h in [1e-3, 2e-3] {
        let mut worst = 0.0_f64;
        for k in 0..50 {
            let (mut x, mut v) = (0.2 - h * (1.0 + f64::from(k) / 50.0), 1.0);
            for _ in 0..60 {
                let x_0 = x;
                let pull = |x: f64| undamped.force(x_0, (x, 0.0));
                let (k_1, k_2) = ((v, pull(x)), (v + 0.5 * h * pull(x), pull(x + 0.5 * h * v)));
                let k_3 = (v + 0.5 * h * k_2.1, pull(x + 0.5 * h * k_2.0));
                let k_4 = (v + h * k_3.1, pull(x + h * k_3.0));
                x += h / 6.0 * (k_1.0 + 2.0 * (k_2.0 + k_3.0) + k_4.0);
                v += h / 6.0 * (k_1.1 + 2.0 * (k_2.1 + k_3.1) + k_4.1);
                let push = undamped.push((x_0, x), v, h, 1.0);
                (x, v) = (x + push.displacement, v + push.velocity);
            }
            worst = worst.max(v * v - 1.0);
        }
        assert!(worst < 2e3 * h * h, "{h}: {worst}");
    }
}
