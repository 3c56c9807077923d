//! Dry friction against masses that slide, stick, break away and turn round, solved in closed form.

use crate::near::{ROUNDING, assert_near};
use forcefeel_model::dry_friction::{DryFriction, StickState};

const FRICTION: DryFriction<f64> = DryFriction { kinetic: 2.0, breakaway: 3.0, asymmetry: 0.0 };

/// A mass under dry friction in steps as the machine takes them: settled at the start of a step, then a Runge-Kutta step.
struct Mass {
    x: f64,
    v: f64,
    grip: StickState<f64>,
    h: f64,
    step: u32,
}

impl Mass {
    fn new(x: f64, v: f64, h: f64) -> Self {
        Self { x, v, grip: StickState { velocity: v, ..StickState::resting(&FRICTION) }, h, step: 0 }
    }

    fn time(&self) -> f64 {
        f64::from(self.step) * self.h
    }

    /// Settles what friction did under the friction-free acceleration `pull(t, x)`.
    fn settle(&mut self, pull: impl Fn(f64, f64) -> f64) {
        let a = pull(self.time(), self.x);
        let found = FRICTION.settled(&self.grip, self.v, a, (self.h, 1.0 / self.h));
        self.x += found.displacement;
        self.v = found.velocity;
        self.grip = FRICTION.grip(self.v, a);
    }

    fn step(&mut self, pull: impl Fn(f64, f64) -> f64) {
        self.settle(&pull);
        let (t, h, grip) = (self.time(), self.h, self.grip);
        let slope = |t: f64, x: f64, v: f64| if grip.stuck { (v, 0.0) } else { (v, pull(t, x) + grip.drag) };
        let k_1 = slope(t, self.x, self.v);
        let k_2 = slope(t + 0.5 * h, self.x + 0.5 * h * k_1.0, self.v + 0.5 * h * k_1.1);
        let k_3 = slope(t + 0.5 * h, self.x + 0.5 * h * k_2.0, self.v + 0.5 * h * k_2.1);
        let k_4 = slope(t + h, self.x + h * k_3.0, self.v + h * k_3.1);
        self.x += h / 6.0 * (k_1.0 + 2.0 * (k_2.0 + k_3.0) + k_4.0);
        self.v += h / 6.0 * (k_1.1 + 2.0 * (k_2.1 + k_3.1) + k_4.1);
        self.step += 1;
    }

    /// Place and velocity at a whole number of steps.
    fn run(mut self, until: f64, pull: impl Fn(f64, f64) -> f64 + Copy) -> (f64, f64) {
        while self.time() < until - 0.5 * self.h {
            self.step(pull);
        }
        self.settle(pull);
        (self.x, self.v)
    }
}

/// Largest errors over shifts of the event within the step, for each of these steps.
fn worst(steps: [f64; 3], error: impl Fn(f64, f64) -> f64) -> [f64; 3] {
    steps.map(|h| (0..40).map(|k| error(h, f64::from(k) / 40.0)).fold(0.0, f64::max))
}

const STEPS: [f64; 3] = [4e-3, 2e-3, 1e-3];

#[track_caller]
fn assert_second_order(errors: [f64; 3]) {
    for pair in errors.windows(2) {
        // Where the event lies in the step has its say, so a little below two.
        assert!((pair[0] / pair[1]).log2() > 1.7, "{errors:?}");
    }
}

#[test]
fn breakaway_is_at_least_the_friction_of_motion() {
    let friction = DryFriction::new(4.0, 1.0, 0.5);
    assert_eq!((friction.kinetic, friction.breakaway), (2.0, 2.0));
    let friction = DryFriction::new(4.0, 6.0, 0.5);
    assert_eq!((friction.kinetic, friction.breakaway), (2.0, 3.0));
    let half = friction.towards(&DryFriction { kinetic: 0.0, breakaway: 9.0, asymmetry: 0.0 }, 0.5);
    assert_eq!((half.kinetic, half.breakaway), (1.0, 6.0));
}

#[test]
fn sliding_mass_stops_after_v_squared_over_2_f() {
    for h in [1e-2, 3e-3, 1e-3] {
        for v in [0.5, 0.503, 0.51, -0.5] {
            let (x, rate) = Mass::new(0.0, v, h).run(0.3, |_, _| 0.0);
            assert_near(x, v * v.abs() / (2.0 * FRICTION.kinetic), 1e-12); // hundreds of sums
            assert_eq!(rate.to_bits(), 0.0_f64.to_bits());
        }
    }
}

#[test]
fn sliding_mass_on_a_spring_stops_where_half_its_swing_ends() {
    let (w, x_0) = (8.0, 0.1);
    let pull = |_: f64, x: f64| -w * w * x;
    // From rest at x_0 it swings about f / w^2 to -(x_0 - 2 f / w^2) and stays: there the spring pulls less than f_s.
    let rest = -(x_0 - 2.0 * FRICTION.kinetic / (w * w));
    assert!(w * w * rest.abs() < FRICTION.breakaway);
    let errors = worst(STEPS, |h, shift| {
        let mut mass = Mass::new(x_0, 0.0, h * (1.0 + 0.1 * shift));
        mass.grip = FRICTION.grip(0.0, pull(0.0, x_0));
        let (x, rate) = mass.run(0.6, pull);
        assert_eq!(rate.to_bits(), 0.0_f64.to_bits());
        (x - rest).abs()
    });
    assert_second_order(errors);
    assert!(errors[2] < 1e-5, "{errors:?}");
}

#[test]
fn what_sticks_has_no_velocity_and_does_not_creep() {
    let mut mass = Mass::new(0.25, 0.0, 1e-3);
    let pull = |t: f64, _: f64| FRICTION.breakaway * (97.0 * t).sin();
    for _ in 0..5000 {
        mass.step(pull);
        assert_eq!((mass.x.to_bits(), mass.v.to_bits()), (0.25_f64.to_bits(), 0.0_f64.to_bits()));
    }
}

#[test]
fn mass_breaks_away_at_the_static_level_and_not_before() {
    let DryFriction { kinetic, breakaway, .. } = FRICTION;
    for sign in [1.0, -1.0] {
        let grip = FRICTION.grip(0.0, sign * breakaway);
        assert!(grip.stuck);
        let above = sign * breakaway * (1.0 + f64::EPSILON);
        let grip = FRICTION.grip(0.0, above);
        assert!(!grip.stuck);
        assert_near(grip.drag, -sign * kinetic, 0.0);
        assert_near(FRICTION.from_rest(sign * breakaway), 0.0, 0.0);
        assert_near(FRICTION.from_rest(above), above - sign * kinetic, ROUNDING);
    }
    // The pull grows by r a second: v = r (t^2 - t_b^2) / 2 - f (t - t_b) from t_b = f_s / r on.
    let rate = 25.0;
    let errors = worst(STEPS, |h, shift| {
        let until = 0.2;
        let start = shift * h * rate;
        let pull = |t: f64, _: f64| start + rate * t;
        let (x, v) = Mass::new(0.0, 0.0, h).run(until, pull);
        let (free, left) = ((breakaway - start) / rate, until - (breakaway - start) / rate);
        assert!(free > 0.0);
        let over = breakaway - kinetic;
        let (place, speed) =
            (over * left * left / 2.0 + rate * left.powi(3) / 6.0, over * left + rate * left * left / 2.0);
        assert_near(v, speed, 1e-11); // the pull is a straight line in time, so the velocity is exact but for rounding
        (x - place).abs()
    });
    assert_second_order(errors);
}

#[test]
fn mass_thrown_against_a_force_turns_round_without_resting() {
    // Up under -(g + f), down under -(g - f).
    let (g, v_0, until) = (20.0, 0.5, 0.06);
    let rise = v_0 / (g + FRICTION.kinetic);
    let down = until - rise;
    let speed = -(g - FRICTION.kinetic) * down;
    let place = 0.5 * v_0 * rise + 0.5 * speed * down;
    for h in [1e-3, 2e-3, 4e-3] {
        let (x, v) = Mass::new(0.0, v_0, h).run(until, |_, _| -g);
        assert_near(v, speed, 1e-12);
        assert_near(x, place, 1e-12); // two straight pieces of the velocity: exact
    }
}

#[test]
fn asymmetric_friction_stops_and_holds_each_way_by_its_own_level() {
    let friction = DryFriction { asymmetry: 0.25, ..FRICTION };
    for way in [1.0, -1.0] {
        let factor = 1.0 + 0.25 * way;
        assert_near(friction.grip(way, 0.0).drag, -way * factor * friction.kinetic, ROUNDING);
        let level = way * factor * friction.breakaway;
        assert!(friction.grip(0.0, level).stuck);
        assert!(!friction.grip(0.0, level * (1.0 + f64::EPSILON)).stuck);
        assert_near(friction.from_rest(2.0 * level), 2.0 * level - way * factor * friction.kinetic, ROUNDING);
        // A pull that grows evenly through the level half-way through a step frees it half a step before the end.
        let grip = StickState { pull: 0.8 * level, ..friction.grip(0.0, 0.8 * level) };
        let found = friction.settled(&grip, 0.0, 1.2 * level, (1e-3, 1e3));
        let mean = 1.1 * level - way * factor * friction.kinetic;
        assert_near(found.velocity, 0.5e-3 * mean, ROUNDING);
    }
    // Held by more the other way, then pulled beyond this way's level within one step: free from its start on at the earliest.
    let friction = DryFriction { asymmetry: -0.5, ..FRICTION };
    let grip = friction.grip(0.0, -3.5);
    let found = friction.settled(&grip, 0.0, 1.6, (1e-3, 1e3));
    assert!(found.velocity > 0.0 && found.velocity < 1e-3, "{found:?}");
}

#[test]
fn friction_never_drives() {
    for v in [-3.0, -1e-9, 0.0, 1e-9, 3.0] {
        for a in [-5.0, -2.5, 0.0, 2.5, 5.0] {
            let grip = FRICTION.grip(v, a);
            assert!(grip.drag * v <= 0.0);
            assert!(v != 0.0 || grip.drag * a <= 0.0);
            assert_eq!(grip.stuck, v == 0.0 && a.abs() <= FRICTION.breakaway);
        }
    }
}

#[test]
fn resting_mass_has_not_broken_away_just_now() {
    // At the first step the pull is beyond what breaks away: the mass leaves from that instant on, not from within a step before.
    let grip = StickState::resting(&FRICTION);
    let found = FRICTION.settled(&grip, 0.0, 10.0, (1e-3, 1e3));
    assert_eq!((found.velocity, found.displacement), (0.0, 0.0));
}

#[test]
fn without_friction_nothing_is_settled() {
    let none: DryFriction<f64> = DryFriction::new(0.0, 0.0, 1.0);
    let resting = StickState::resting(&none);
    assert!(!resting.stuck);
    for (v_0, v, a) in [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1.0, -1.0, -3.0), (-1.0, 1.0, 0.0)] {
        for grip in [StickState { velocity: v_0, ..resting }, none.grip(v_0, a)] {
            let found = none.settled(&grip, v, a, (1e-3, 1e3));
            assert!(!found.settled);
            assert_eq!((found.velocity, found.displacement), (v, 0.0));
        }
        assert!(!none.grip(v_0, a).stuck);
    }
}
