//! What a law takes for contact, and how it gives it back.

#![expect(clippy::float_cmp, reason = "a share at its end is exact")]

use forcefeel_model::contact_law::{ContactLaw, ContactState, LEAD_RAD};

const H: f64 = 5e-4;

/// How much farther the feel moves than the column: by more than one that follows it, and it does not turn round before the column.
const FARTHER: f64 = 1.05;

fn law() -> ContactLaw<f64> {
    let mut numbers = [0.15, 900.0, 0.0, 500.0, 40.0, 1.0, 4.0, 1900.0, 0.1, 0.01, 0.02].into_iter();
    ContactLaw::take(|| numbers.next().unwrap())
}

/// The contact after `seconds` under a torque and a column in time.
fn after(
    seconds: f64,
    torque: impl Fn(f64) -> f64,
    column: impl Fn(f64) -> [f64; 2],
    from: ContactState<f64>,
) -> ContactState<f64> {
    after_with(None, seconds, torque, column, from)
}

/// The same with known friction of at most this torque.
fn after_with(
    friction: Option<f64>,
    seconds: f64,
    torque: impl Fn(f64) -> f64,
    column: impl Fn(f64) -> [f64; 2],
    from: ContactState<f64>,
) -> ContactState<f64> {
    let mut state = from;
    let mut time = 0.0;
    while time < seconds {
        state = law()
            .noticed(
                (torque(time), friction),
                ([column(time)[0], FARTHER * column(time)[0], 0.0], None, true),
                state,
                [H, 1.0 / H],
            )
            .0;
        time += H;
    }
    state
}

fn swing(hertz: f64) -> impl Fn(f64) -> f64 {
    move |time| 20.0 * (core::f64::consts::TAU * hertz * time).sin()
}

fn still(_: f64) -> [f64; 2] {
    [0.0, 0.0]
}

fn free() -> ContactState<f64> {
    ContactState::free(0.0, 0.0)
}

#[test]
fn a_quick_swing_against_something_stiff_is_contact_and_a_hand_is_none() {
    assert_eq!(after(1.0, swing(12.0), still, free()).share, 1.0);
    assert_eq!(after(3.0, swing(2.0), still, free()).share, 0.0);
}

/// The share after a blow, then a weak swing of so many seconds in something as soft as an arm.
fn after_ripple(hertz: f64, peak: f64, seconds: f64, alone: bool) -> f64 {
    let mut state = after(1.2, |_| 0.0, still, after(0.1, swing(5.0), still, free()));
    let mut time = 0.0;
    while time < seconds {
        let torque = 0.05 * peak * swing(hertz)(time);
        (state, _) = law().noticed((torque, None), ([-torque / 500.0, 0.0, 0.0], None, alone), state, [H, 1.0 / H]);
        time += H;
    }
    state.share
}

#[test]
fn a_weak_swing_is_contact_where_it_is_quicker_than_a_hand_and_goes_on() {
    assert_eq!(after_ripple(30.0, 1.0, 1.0, true), 1.0);
    assert_eq!(after_ripple(30.0, 1.0, 0.5, true), 0.0, "thirty turns");
    assert_eq!(after_ripple(30.0, 0.4, 4.0, true), 0.0, "noise");
    assert_eq!(after_ripple(10.0, 1.0, 20.0, true), 0.0, "a hand that shakes");
    assert_eq!(after_ripple(30.0, 1.0, 4.0, false), 0.0, "a bench signal");
    assert_eq!(after_ripple(30.0, 30.0, 4.0, false), 1.0, "a stop on the bench");
}

#[test]
fn slow_swings_against_something_stiff_are_contact_where_they_go_on_and_none_where_they_decay() {
    let torque = |growth: f64| move |time: f64| (growth * time).exp() * swing(3.0)(time);
    assert_eq!(after(1.0, torque(0.5), still, free()).share, 0.0, "a hand may grow for a second");
    assert_eq!(after(3.0, torque(0.5), still, free()).share, 1.0);
    assert_eq!(after(3.0, torque(0.0), still, free()).share, 1.0);
    assert_eq!(after(6.0, torque(-0.4), still, free()).share, 0.0);
    let soft = |time: f64| [-torque(0.5)(time) / 500.0, 0.0];
    assert_eq!(after(3.0, torque(0.5), soft, free()).share, 0.0, "an arm");
}

#[test]
fn a_soft_swing_is_contact_where_it_grows_and_none_where_it_decays() {
    let (hertz, soft) = (12.0, 500.0);
    let torque = |growth: f64| move |time: f64| (growth * time).exp() * swing(hertz)(time);
    let column = |growth: f64| move |time: f64| [-torque(growth)(time) / soft, 0.0];
    assert_eq!(after(0.5, torque(6.0), column(6.0), free()).share, 1.0);
    assert_eq!(after(0.5, torque(-3.0), column(-3.0), free()).share, 0.0);
    assert_eq!(after(1.0, torque(0.0), column(0.0), free()).share, 0.0, "an arm swings for a while");
    assert_eq!(after(2.0, torque(0.0), column(0.0), free()).share, 1.0, "and not for ever");
    assert_eq!(after(4.0, torque(-2.0), column(-2.0), free()).share, 0.0);
}

#[test]
fn a_quick_swing_in_which_the_column_follows_the_feel_is_a_hand_however_little_it_moves() {
    let (torque, column) = (swing(12.0), |time: f64| -1e-5 * swing(12.0)(time));
    let share = |feel: &dyn Fn(f64) -> f64| {
        let (mut state, mut time) = (free(), 0.0);
        while time < 0.5 {
            let angles = [column(time), feel(time), 0.0];
            state = law().noticed((torque(time), None), (angles, None, true), state, [H, 1.0 / H]).0;
            time += H;
        }
        state.share
    };
    assert_eq!(share(&|time| 1.02 * column(time)), 0.0);
    assert_eq!(share(&|time| 1.05 * column(time)), 1.0);
    assert_eq!(share(&|_| 0.0), 1.0);
}

#[test]
fn a_short_push_that_turns_the_motion_is_contact_and_one_along_it_is_none() {
    let blow = |time: f64| if (0.1..0.11).contains(&time) { -60.0 } else { 0.0 };
    let bounces = |time: f64| [if time < 0.105 { time } else { 0.21 - time }, 0.0];
    assert_eq!(after(0.3, blow, bounces, free()).share, 1.0);
    assert_eq!(after(0.3, blow, |time| [-time, -1.0], free()).share, 0.0);
}

#[test]
fn a_longer_push_that_throws_the_column_back_faster_than_it_came_is_a_hand() {
    let push = |time: f64| if (0.1..0.15).contains(&time) { -60.0 } else { 0.0 };
    let thrown = |back: f64| move |time: f64| [0.1 * time.min(0.12) - 0.1 * back * (time - 0.12).max(0.0), 0.0];
    assert_eq!(after(0.3, push, thrown(1.0), free()).share, 1.0);
    assert_eq!(after(0.3, push, thrown(2.2), free()).share, 0.0);
}

#[test]
fn small_turns_under_a_push_are_contact_but_of_a_column_that_known_friction_holds() {
    let torque = |time: f64| 20.0 + 0.2 * swing(12.0)(time);
    let share = |friction, column: fn(f64) -> [f64; 2]| after_with(friction, 1.0, torque, column, free()).share;
    assert_eq!(share(None, still), 1.0);
    assert_eq!(share(Some(4.0), still), 0.0);
    assert_eq!(share(Some(2.8), still), 1.0, "friction causes smaller ones");
    assert_eq!(share(Some(4.0), |time| [-1.5e-3 / 20.0 * swing(12.0)(time), 0.0]), 1.0, "too fast to stick");
}

#[test]
fn swings_against_known_friction_are_no_contact_and_larger_ones_are() {
    let share = |friction, column: fn(f64) -> [f64; 2]| {
        after_with(Some(friction), 1.0, |time| 0.5 * swing(12.0)(time), column, free()).share
    };
    assert_eq!(share(11.0, still), 0.0);
    assert_eq!(share(9.0, still), 1.0);
    assert_eq!(share(11.0, |time| [-1.5e-3 / 20.0 * swing(12.0)(time), 0.0]), 1.0, "too fast to stick");
}

#[test]
fn a_release_is_no_contact() {
    let held = ContactState::free(190.0, 0.17);
    assert_eq!(after(0.3, |_| 0.0, |time| [0.17 - time, -1.0], held).share, 0.0);
}

#[test]
fn a_column_that_stays_keeps_it_and_one_that_goes_away_gives_it_back() {
    let touched = after(1.0, swing(12.0), still, free());
    assert_eq!(after(5.0, |_| 10.0, still, touched).share, 1.0);
    let half = after(0.4, |_| 10.0, |time| [0.1 * time, 0.1], touched);
    let gone = after(1.0, |_| 10.0, |time| [0.1 * time, 0.1], touched);
    assert!((0.3..0.9).contains(&half.share), "{}", half.share);
    assert_eq!(gone.share, 0.0);
}

#[test]
fn a_hand_that_pulls_the_column_away_after_a_rest_gets_it_at_once_and_the_next_swing_does_not() {
    let touched = after(1.0, swing(12.0), still, free());
    let leaves = |time: f64| [-0.1 * time, -0.1];
    let rested = after(1.0, |_| 10.0, still, touched);
    assert_eq!(after(0.25, |time| 10.0 - 200.0 * time, leaves, rested).share, 0.0);
    let swung = after(0.05, |_| 10.0, still, touched);
    assert_eq!(after(0.25, |time| 10.0 - 200.0 * time, leaves, swung).share, 1.0);
}

#[test]
fn a_column_is_held_by_what_the_torque_falls_from_its_rest() {
    let touched = after(1.0, swing(12.0), still, free());
    let leaves = |time: f64| [-0.1 * time, -0.1];
    let leant_on = after(1.0, |_| 60.0, still, touched);
    assert_eq!(after(0.6, |_| 60.0, leaves, leant_on).share, 0.0, "a stiff feel takes it back");
    let spring = |time: f64| 60.0 + 4e3 * 0.1 * time;
    assert!(after(0.6, spring, leaves, leant_on).share > 0.98);
}

#[test]
fn the_noise_of_a_column_at_rest_beside_the_place_gives_nothing_back() {
    let touched = after(1.0, swing(12.0), still, free());
    let step = |time: f64| (time / H).round() % 2.0;
    let beside = |time: f64| [0.015 + 1e-5 * step(time), 0.0];
    let later = after(5.0, |_| 10.0, beside, touched);
    assert!(later.share > 0.99, "{}", later.share);
}

#[test]
fn a_feel_that_runs_ahead_is_held_at_its_lead() {
    let beside = |feel| law().follow(feel, ([0.0; 2], 0.0));
    assert_eq!(beside([0.04, 3.0]), [0.04, 3.0]);
    assert_eq!(beside([0.3, 3.0]), [LEAD_RAD, 0.0]);
    assert_eq!(beside([0.3, -3.0]), [LEAD_RAD, -3.0], "on its way back");
    assert_eq!(ContactLaw::none(0.0).follow([9.0, 3.0], ([0.0; 2], 0.0)), [9.0, 3.0], "of no contact");
    let held_out = law().follow([0.2, 0.0], ([0.4, 0.0], 0.0));
    assert_eq!(held_out, [0.2, 0.0], "by a hand that is stronger than the drive");
}

/// The share of the contact, and how far the column is from its place, 7 ms after a torque against the motion began to rise by `rise`, in N m per
/// ms, at a column that moves at `rate` in rad/s and slows down by `slows`, and a feel that does by `turns`, in rad/s per ms.
fn struck(rise: f64, rate: f64, [slows, turns]: [f64; 2]) -> [f64; 2] {
    let mut state = free();
    let [mut column, mut feel] = [[0.0, rate]; 2];
    for step in 0..214 {
        let since = f64::from(step - 200) * H;
        if since > 0.0 {
            column[1] -= slows * 1e3 * H;
            feel[1] -= turns * 1e3 * H;
        }
        for [angle, rate] in [&mut column, &mut feel] {
            *angle += *rate * H;
        }
        let torque = -1e3 * rise * since.max(0.0);
        (state, _) = law().noticed((torque, None), ([column[0], feel[0], feel[1]], None, true), state, [H, 1.0 / H]);
    }
    [state.share, column[0] - state.place]
}

#[test]
fn a_column_that_a_stop_ahead_of_its_feel_slows_down_is_in_contact_while_the_torque_rises() {
    assert_eq!(struck(40.0, 1.0, [0.3, 2.0])[0], 1.0);
    assert_eq!(struck(40.0, 1.0, [0.3, 0.3])[0], 0.0, "under a hand the feel turns with its column");
    assert_eq!(struck(40.0, 1.0, [0.0, 0.2])[0], 0.0, "an arm swings with a light column, which does not slow down");
    assert_eq!(struck(1.0, 0.3, [0.03, 0.5])[0], 1.0, "of a light column, before the torque is a push");
    assert_eq!(struck(1.0, 1.0, [0.03, 0.5])[0], 0.0, "as soft as an arm");
    // The column has moved by 0.03 rad since the last push.
    assert!(struck(1.0, 0.3, [0.03, 0.5])[1].abs() < 2e-3);
}

/// Whether pushes of 60 ms are a contact's that throw a column of 6 rad/s back, so many, one each period, on one side or on either in turn.
fn bounces_on(count: f64, period: f64, sides: f64) -> bool {
    let (mut state, mut angle, mut touched) = (free(), 0.0, false);
    for step in 0..6000 {
        let time = f64::from(step) * H;
        let (which, since) = ((time / period).floor(), time % period);
        let side = if which % sides < 1.0 { 1.0 } else { -1.0 };
        let next = if (which + 1.0) % sides < 1.0 { 1.0 } else { -1.0 };
        // It moves before the first.
        let pushed = since < 0.06 && which > 0.0 && which <= count;
        let phase = core::f64::consts::PI * since / 0.06;
        let torque = if pushed { 80.0 * side * phase.sin() } else { 0.0 };
        let rate = if pushed {
            -6.0 * side * phase.cos()
        } else if since < 0.5 * period {
            6.0 * side
        } else {
            -6.0 * next
        };
        angle += rate * H;
        let now;
        (state, now) = law().noticed((torque, None), ([angle, angle, 0.0], None, true), state, [H, 1.0 / H]);
        touched |= now;
    }
    touched
}

#[test]
fn a_column_that_bounces_on_is_in_contact() {
    assert!(bounces_on(4.0, 0.2, 1.0));
    assert!(!bounces_on(3.0, 0.2, 1.0), "three");
    assert!(!bounces_on(9.0, 0.2, 2.0), "a hand that shakes, on both sides");
    assert!(!bounces_on(5.0, 0.6, 1.0), "a hand that taps");
}

#[test]
fn a_column_that_a_spring_pushes_back_keeps_it() {
    let touched = after(1.0, swing(12.0), still, free());
    let spring = 4e3;
    let pushed_back = after(2.0, |time| 60.0 - spring * 0.1 * time, |time| [0.1 * time, 0.1], touched);
    assert_eq!(pushed_back.share, 1.0);
}

/// The contact 0.4 s after swings beyond 0.02 rad, during which the column creeps away at 0.02 rad/s under a torque and `B_c`.
fn crept(torque: f64) -> ContactState<f64> {
    let mut state = after(1.0, swing(12.0), |_| [0.02, 0.0], free());
    for step in 0..800 {
        let angle = 0.02 - 0.02 * f64::from(step) * H;
        (state, _) = law().noticed((torque, None), ([angle, angle, -0.02], None, true), state, [H, 1.0 / H]);
    }
    state
}

#[test]
fn a_column_that_is_let_go_is_free_though_it_creeps() {
    assert_eq!(crept(0.0).share, 0.0);
    assert_eq!(crept(-4.0).share, 0.0, "a hand that holds less than half of the damping");
    assert!(crept(-7.0).share > 0.5, "of the damping, 10 N m, it is more than half");
    let mut swings = after(1.0, swing(12.0), |_| [0.02, 0.0], free());
    for step in 0..800 {
        let time = f64::from(step) * H;
        let angle = 0.02 - 0.02 * time;
        (swings, _) = law().noticed(
            (7.0 * swing(20.0)(time).signum(), None),
            ([angle, angle, -0.02], None, true),
            swings,
            [H, 1.0 / H],
        );
    }
    assert!(swings.share > 0.5, "the torque is small for less than 60 ms at a time");
}

#[test]
fn a_ripple_is_a_contact_where_the_column_is_and_not_where_a_push_was_before() {
    let pushed = after(0.2, |time| if time < 0.1 { 60.0 } else { 0.0 }, |time| [0.2 * time, 0.2], free());
    let ripples = after(3.0, |time| 0.05 * swing(60.0)(time), |_| [0.04, 0.0], pushed);
    assert_eq!(ripples.share, 1.0);
    assert!((ripples.place - 0.04).abs() < 1e-9);
}

#[test]
fn the_damping_takes_speed_and_never_turns_it() {
    let left = law().damped(1.0, 2.0, 1.0 / 0.1, H);
    assert!((left - 2.0 / 3.5).abs() < 1e-12, "2 / (1 + 500 * 10 * 0.0005), got {left}");
    assert_eq!(law().damped(0.0, 2.0, 10.0, H), 2.0);
    assert_eq!(law().damped(1.0, -1e3, 0.01, H), -40.0, "the drive's speed");
}
