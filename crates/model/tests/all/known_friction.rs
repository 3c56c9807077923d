//! Dry friction that a law knows: given back in motion, a play at rest that lets go, learnt where no hand is.

use crate::near::assert_within;
use forcefeel_model::contact_law::CONTACT_NUMBERS;
use forcefeel_model::known_friction::{FRICTION_NUMBERS, FrictionState, LEVEL_FROM_END};
use forcefeel_model::observer::{LawOutput, MOST_STATES, NUMBERS, Observer, SAMPLED};

/// `F`, `U` in N m, `v_s` in rad/s.
const LEVEL: f64 = 3.5;
/// Friction is larger by it towards positive angles, and smaller towards negative ones.
const ASYMMETRY: f64 = 0.2;
/// `beta`, `omega_s` in rad/s.
const BREAKAWAY: f64 = 0.3;
const STRIBECK: f64 = 0.05;
const UNCERTAIN: f64 = 0.7;
const SLOW: f64 = 1e-3;
/// `g_-`, `g_+`, `a` in 1/(N m), `q` in N m, `c`.
const LEAST: f64 = -0.1;
const MOST: f64 = 0.2;
const GAIN: f64 = 0.003;
const HAND: f64 = 5.5;
const BLUR: f64 = 0.05;
/// `d`.
const TRUST: f64 = 2e-3;
/// `v_r` in rad/s.
const REST: f64 = 7e-4;
/// A controller of 1 kHz.
const PERIOD: f64 = 1e-3;
/// Length of `[xi; y; delta; delta']`.
const KNOWN: usize = MOST_STATES + SAMPLED + 2;
/// Command and torque per radian of the neutral.
const OF_NEUTRAL: usize = 2;
const TORQUE: usize = NUMBERS - CONTACT_NUMBERS - FRICTION_NUMBERS - OF_NEUTRAL - MOST_STATES * (SAMPLED + 1) - KNOWN;
const RATE: usize = NUMBERS - CONTACT_NUMBERS - FRICTION_NUMBERS;

/// A law whose first state is the torque on the column, its second the column's rate, and which moves the first by the friction.
fn law(level: f64, leak: f64) -> Observer<f64> {
    law_that_states([level, level, 0.0, 0.0], leak)
}

/// The same with friction by direction that falls over a rate.
fn law_that_states(stated: [f64; 4], leak: f64) -> Observer<f64> {
    let mut numbers = [0.0; NUMBERS];
    numbers[TORQUE] = 1.0;
    numbers[RATE + 1] = 1.0;
    numbers[RATE + KNOWN] = -0.25;
    let learning = [LEAST, MOST, GAIN, HAND, BLUR, TRUST, REST];
    let uncertain = if stated[0] == 0.0 { 0.0 } else { UNCERTAIN };
    let known = [stated.as_slice(), &[uncertain, SLOW, leak], &learning].concat();
    let first = NUMBERS - CONTACT_NUMBERS - LEVEL_FROM_END;
    numbers[first..NUMBERS - CONTACT_NUMBERS].copy_from_slice(&known);
    Observer::from_numbers(&numbers)
}

fn output(law: &Observer<f64>, torque: f64, rate: f64, feel_torque: f64) -> LawOutput<f64> {
    let mut xi = [0.0; MOST_STATES];
    (xi[0], xi[1]) = (torque, rate);
    law.output(&xi, &[0.0; SAMPLED], [0.0; 2], Some(FrictionState::initial(feel_torque)))
}

#[test]
fn in_motion_the_friction_is_told_to_the_plant_and_the_hand_is_received_whatever_was_received_before() {
    let law = law(LEVEL, 0.01);
    for rate in [0.1, 1.0, -0.1, -1.0] {
        for feel_torque in [-20.0, 0.0, 20.0] {
            let output = output(&law, 2.0, rate, feel_torque);
            // f is within (v_s / v)^2 / 2 of F.
            assert_within(output.friction, LEVEL * rate.signum(), LEVEL * SLOW * SLOW / rate / rate);
            // What was received is as near as the level may be off.
            let received = 2.0 + (feel_torque * 0.99 - 2.0).clamp(-UNCERTAIN, UNCERTAIN);
            assert_within(output.torque, received, LEVEL * SLOW * SLOW / rate / rate);
            let next = law.next(&[0.0; MOST_STATES], &[0.0; SAMPLED], 0.0, Some(output.friction));
            assert_within(next[0], -0.25 * output.friction, 1e-15);
        }
    }
}

/// A law that knows friction as it is.
fn as_it_is(leak: f64) -> Observer<f64> {
    let [negative, positive] = [1.0 - ASYMMETRY, 1.0 + ASYMMETRY].map(|share| share * LEVEL);
    law_that_states([negative, positive, BREAKAWAY, 1.0 / STRIBECK], leak)
}

#[test]
fn friction_by_direction_falls_from_breakaway_as_stribeck_states() {
    let (law, initial) = (as_it_is(0.0), FrictionState::initial(0.0));
    let learnt = FrictionState { learnt: [-0.05, 0.1], ..initial };
    for (state, share) in [(initial, [1.0, 1.0]), (learnt, [0.95, 1.1])] {
        for rate in [0.02, 0.05, 0.1, 0.3, 2.0] {
            for way in [-1.0, 1.0] {
                let fall = (-(rate / STRIBECK) * (rate / STRIBECK)).exp();
                let level = LEVEL * (1.0 + ASYMMETRY * way) * share[usize::from(way > 0.0)];
                let mut xi = [0.0; MOST_STATES];
                xi[1] = rate * way;
                let friction = law.output(&xi, &[0.0; SAMPLED], [0.0; 2], Some(state)).friction;
                // The series to its fourth term.
                assert_within(friction, level * (1.0 + BREAKAWAY * fall) * way, 0.026 * BREAKAWAY * level);
            }
        }
    }
}

#[test]
fn at_rest_friction_as_it_is_holds_what_breakaway_of_either_direction_holds() {
    let law = as_it_is(0.0);
    for way in [-1.0, 1.0] {
        // With the hand off, friction against a motion towards negative angles is estimated as a push to positive ones.
        let play = LEVEL * (1.0 - ASYMMETRY * way) * (1.0 + BREAKAWAY) + UNCERTAIN;
        assert_within(output(&law, play * way, 0.0, 0.0).torque, 0.0, 1e-14);
        assert_within(output(&law, (play + 1.0) * way, 0.0, 0.0).torque, way, 1e-14);
    }
}

#[test]
fn at_rest_what_is_received_stays_until_the_friction_cannot_hold_it() {
    let (law, play) = (law(LEVEL, 0.0), LEVEL + UNCERTAIN);
    let mut feel_torque = 0.0;
    for (torque, expected) in
        [(play, 0.0), (-play, 0.0), (play + 1.0, 1.0), (1.0, 1.0), (1.0 - play, 1.0), (-play - 2.0, -2.0)]
    {
        feel_torque = output(&law, torque, 0.0, feel_torque).torque;
        assert_within(feel_torque, expected, 1e-14);
    }
}

#[test]
fn at_rest_what_is_received_drifts_to_what_is_measured_under_a_hand_and_else_to_nothing() {
    let (leak, torque) = (0.025, 2.0);
    let law = law(LEVEL, leak);
    for (push, end) in [(HAND + 1.0, torque), (HAND - 1.0, 0.0)] {
        let mut state = FrictionState { push, ..FrictionState::initial(1.0) };
        for n in 1..=200 {
            state = FrictionState { push, ..at(&law, [torque, 0.0], state) };
            assert_within(state.feel_torque, end + (1.0 - end) * (1.0 - leak).powi(n), 1e-13);
        }
    }
}

#[test]
fn a_slow_column_is_held_where_the_spring_has_less_than_what_is_uncertain() {
    let law = law(LEVEL, 0.1);
    let friction = &law.friction;
    for (rate, spring, rests) in [
        (0.0, 0.0, true),
        (-0.9 * REST, 0.9 * UNCERTAIN, true),
        (0.9 * REST, -1.1 * UNCERTAIN, false),
        (-1.1 * REST, 0.0, false),
    ] {
        assert_eq!(friction.holds([rate, spring], 1.0, (0.9, PERIOD)).0, rests);
    }
    // Periods until `s` exceeds a half: time constants of 60 ms, of ten turning intervals of a light feel, and of 2 s in motion.
    let held_after = |per_inertia: f64, rate: f64, turns: usize| {
        let mut s = 0.0;
        (1..10_000).find(|k| {
            let rate = if k % turns == 0 { 0.0 } else { rate };
            let (holds, next) = friction.holds([rate, 0.0], per_inertia, (s, PERIOD));
            s = next;
            holds
        })
    };
    assert_eq!(held_after(1e-6, 0.0, 1), Some(42));
    let turn = 5e-4;
    assert_eq!(held_after(2.0 * REST / (UNCERTAIN * turn), 0.0, 1), Some(4));
    // In motion, with a turning point every 500 periods: held at the first one after 2 s times ln 2.
    assert_eq!(held_after(1e-6, 2.0 * REST, 500), Some(1500));
    // Above the threshold of the spring torque `s` decays.
    assert_within(friction.holds([0.0, 2.0 * UNCERTAIN], 1.0, (0.8, 0.5)).1, 0.6, 1e-14);
    // Its load cell shows no more than friction and a hand can hold.
    for (share, push, held) in [(0.9, 0.0, 0.9), (1.1, 0.0, 1.0), (-3.0, 1.5, -2.5), (2.0, -1.5, 2.0)] {
        assert_within(law.friction.at_rest(share * HAND, push * HAND), held * HAND, 1e-14);
    }
}

#[test]
fn an_error_of_the_rate_does_not_drive_the_feel_with_the_hand_off() {
    let law = law(LEVEL, 0.0);
    // The torque estimate has not followed the rate yet.
    for torque in [-0.9 * UNCERTAIN, 0.0, 0.9 * UNCERTAIN] {
        for share in -80..=80 {
            assert_within(output(&law, torque, 0.1 * SLOW * f64::from(share), 0.0).torque, 0.0, 0.0);
        }
    }
}

/// What is recalled after a sample of the hand's torque and rate.
fn at(law: &Observer<f64>, [torque, rate]: [f64; 2], state: FrictionState<f64>) -> FrictionState<f64> {
    let mut xi = [0.0; MOST_STATES];
    (xi[0], xi[1]) = (torque, rate);
    law.output(&xi, &[0.0; SAMPLED], [0.0; 2], Some(state)).friction_state
}

#[test]
fn law_without_friction_beside_one_with_it_receives_all() {
    let law = law(0.0, 0.0);
    for rate in [0.0, 1e-3, -2.0] {
        let output = output(&law, 1.7, rate, -5.0);
        assert!(output.friction.abs() < f64::MIN_POSITIVE);
        assert_within(output.torque, 1.7, 0.0);
    }
}

/// Place of a rate's direction.
fn way(rate: f64) -> usize {
    usize::from(rate >= 0.0)
}

/// What was learnt after so many samples at a torque and a rate, from what was recalled.
fn learnt(from: FrictionState<f64>, samples: usize, torque: impl Fn(f64) -> f64, rate: f64) -> FrictionState<f64> {
    let law = law(LEVEL, 0.0);
    let mut friction_state = from;
    let mut xi = [0.0; MOST_STATES];
    for _ in 0..samples {
        (xi[0], xi[1]) = (torque(friction_state.learnt[way(rate)]), rate);
        friction_state = law.output(&xi, &[0.0; SAMPLED], [0.0; 2], Some(friction_state)).friction_state;
    }
    friction_state
}

#[test]
fn what_is_left_of_a_hand_that_is_off_is_learnt_whichever_way_it_moves() {
    let initial = FrictionState::initial(0.0);
    for (off, rate) in [(0.1, 1.0), (0.1, -1.0), (-0.05, 1.0), (-0.05, -1.0)] {
        // T_o = (C - C_true) sgn v
        let output = learnt(initial, 2000, |learnt| LEVEL * (learnt - off) * rate.signum(), rate);
        assert_within(output.learnt[way(rate)], off, 1e-5);
        // The other direction has half of it.
        assert_within(output.learnt[way(-rate)], off / 2.0, 1e-5);
        let short = learnt(initial, 100, |learnt| LEVEL * (learnt - off) * rate.signum(), rate);
        let short = short.learnt[way(rate)] / off;
        assert!(0.0 < short && short < 1.0);
    }
}

#[test]
fn both_directions_are_learnt_where_they_differ() {
    let off = [-0.03, 0.1];
    let mut state = FrictionState::initial(0.0);
    // Each time that the column turns, half of the error of the turn before is left in the other direction.
    for swing in 0..24 {
        let rate = if swing % 2 == 0 { 1.0 } else { -1.0 };
        state = learnt(state, 2000, |learnt| LEVEL * (learnt - off[way(rate)]) * rate.signum(), rate);
    }
    for (learnt, off) in state.learnt.into_iter().zip(off) {
        assert_within(learnt, off, 1e-5);
    }
}

#[test]
fn what_has_held_for_a_while_is_trusted_and_a_push_takes_back_the_rest() {
    let held = learnt(FrictionState { learnt: [0.1; 2], ..FrictionState::initial(0.0) }, 400, |_| 0.0, 1.0);
    // The column's way of late is 4/5 after 31 samples.
    for k in 0..2 {
        assert_within(held.learnt[k], 0.1, 0.0);
        assert_within(held.trusted[k], 0.1 * (1.0 - (1.0 - TRUST).powi(400 - 32)), 1e-3);
    }
    let pushed = learnt(FrictionState { push: 2.0 * HAND, ..held }, 200, |_| 2.0 * HAND, 1.0);
    for k in 0..2 {
        let trusted = held.trusted[k];
        assert_within(pushed.trusted[k], trusted, 0.0);
        assert_within(pushed.learnt[k], trusted + (0.1 - trusted) * (1.0 - BLUR).powi(200), 1e-12);
    }
}

#[test]
fn what_a_slow_column_teaches_is_not_trusted() {
    let taught = |rate| learnt(FrictionState::initial(0.0), 400, |_| -0.5, rate);
    assert!(taught(0.03).learnt[1] > 0.1 && taught(0.07).trusted[1] > 0.0);
    assert_within(taught(0.03).trusted[1], 0.0, 0.0);
}

#[test]
fn it_stays_within_its_bounds() {
    for (torque, bound) in [(-2.0, MOST), (2.0, LEAST)] {
        assert_within(learnt(FrictionState::initial(0.0), 2000, |_| torque, 1.0).learnt[1], bound, 1e-14);
    }
}

#[test]
fn nothing_is_learnt_at_rest_or_under_a_hand() {
    let initial = FrictionState::initial(0.0);
    for (torque, rate) in [(1.0, 0.0), (1.0, 0.5 * SLOW), (-1.0, -SLOW)] {
        assert_within(learnt(initial, 500, |_| torque, rate).learnt[way(rate)], 0.0, 0.0);
    }
    // A hand that has pushed for a while; until then it may have been the friction.
    let pushed = learnt(FrictionState::initial(2.0 * HAND), 1, |_| 2.0 * HAND, 1.0);
    assert_within(learnt(pushed, 500, |_| 2.0 * HAND, 1.0).learnt[1], pushed.learnt[1], 0.0);
    // In motion one with more than the friction.
    let hand = 1.1 * LEVEL;
    let moved = FrictionState { push: hand, way: 1.0, learnt: [0.05; 2], ..initial };
    assert_within(learnt(moved, 500, |_| hand, 1.0).learnt[1], 0.05 * (1.0 - BLUR).powi(500), 1e-15);
    // One that has turned round has to go on for a while.
    let forth = learnt(initial, 500, |_| 0.0, 1.0);
    assert_within(learnt(forth, 20, |_| 1.0, -1.0).learnt[0], 0.0, 0.0);
}
