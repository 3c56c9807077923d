//! A sampled law with an observer against plain matrix arithmetic, on random numbers.

use crate::draws::Draws;
use crate::near::{ROUNDING, assert_near, assert_within};
use forcefeel_model::compensator::Compensator;
use forcefeel_model::contact_law::CONTACT_NUMBERS;
use forcefeel_model::known_friction::FRICTION_NUMBERS;
use forcefeel_model::observer::{Estimate, MOST_STATES, NUMBERS, Observer, SAMPLED};
use forcefeel_model::parameters::Parameters;

/// Signals that a state is moved by, or rests by: what is sampled and one more.
const SIGNALS: usize = SAMPLED + 1;
/// Length of `[xi; y; delta; delta']`.
const KNOWN: usize = MOST_STATES + SAMPLED + 2;
/// Where `B`, `c`, `t` and `R` begin among a law's numbers; `A` begins at zero.
const B: usize = MOST_STATES * MOST_STATES;
const C: usize = B + MOST_STATES * SIGNALS;
const T: usize = C + KNOWN;
const R: usize = T + KNOWN;

/// Command and torque per radian of the neutral.
const OF_NEUTRAL: usize = 2;

/// Errors of sums of some fourteen products of numbers of one size.
const SUM: f64 = 1e-14;
const DRAWS: usize = 50;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Row `row` of the matrix of so many columns that begins at `first`.
fn row(numbers: &[f64; NUMBERS], first: usize, row: usize, columns: usize) -> &[f64] {
    &numbers[first + row * columns..first + (row + 1) * columns]
}

fn random<const N: usize>(draws: &mut Draws) -> [f64; N] {
    core::array::from_fn(|_| draws.uniform())
}

/// A law, a state, a sample, a feel.
fn random_law(draws: &mut Draws) -> ([f64; NUMBERS], Estimate<f64>, [f64; SAMPLED], [f64; 2]) {
    (random(draws), random(draws), random(draws), random(draws))
}

#[test]
fn numbers_are_those_of_all_matrices() {
    assert_eq!(R + MOST_STATES * SIGNALS + OF_NEUTRAL + FRICTION_NUMBERS + CONTACT_NUMBERS, NUMBERS);
}

#[test]
fn law_says_the_products_of_its_rows() {
    let mut draws = Draws::new(1);
    for _ in 0..DRAWS {
        let (numbers, xi, y, feel) = random_law(&mut draws);
        let output = Observer::from_numbers(&numbers).output(&xi, &y, feel, None);
        let known = [xi.as_slice(), &y, &feel].concat();
        assert_within(output.command, dot(&numbers[C..T], &known), SUM);
        assert_within(output.torque, dot(&numbers[T..R], &known), SUM);
    }
}

#[test]
fn next_state_is_the_matrices_times_state_sample_and_answered_command() {
    let mut draws = Draws::new(2);
    for _ in 0..DRAWS {
        let (numbers, xi, y, [e, _]) = random_law(&mut draws);
        let next = Observer::from_numbers(&numbers).next(&xi, &y, e, None);
        let moved_by = [y.as_slice(), &[e]].concat();
        for (k, next) in next.into_iter().enumerate() {
            let (a, b) = (row(&numbers, 0, k, MOST_STATES), row(&numbers, B, k, SIGNALS));
            assert_within(next, dot(a, &xi) + dot(b, &moved_by), SUM);
        }
    }
}

#[test]
fn state_at_rest_is_the_matrix_times_sample_and_feel() {
    let mut draws = Draws::new(3);
    for _ in 0..DRAWS {
        let (numbers, _, y, [delta, _]) = random_law(&mut draws);
        let rest = Observer::from_numbers(&numbers).at_rest(&y, delta);
        let rests_by = [y.as_slice(), &[delta]].concat();
        for (k, xi) in rest.into_iter().enumerate() {
            assert_within(xi, dot(row(&numbers, R, k, SIGNALS), &rests_by), SUM);
        }
    }
}

#[test]
fn state_where_it_looks_on_is_the_one_that_comes_to_be() {
    let mut draws = Draws::new(9);
    for _ in 0..DRAWS {
        let (mut numbers, mut xi, y, [e, _]) = random_law(&mut draws);
        // Entries up to 1: a row's sum stays below 0.9, so what was there before is forgotten.
        numbers[..B].iter_mut().for_each(|entry| *entry *= 0.1);
        let law = Observer::from_numbers(&numbers);
        let output = law.initial_estimate(&y, e);
        for _ in 0..500 {
            xi = law.next(&xi, &y, e, None);
        }
        for k in 0..MOST_STATES {
            assert_within(output[k], xi[k], 100.0 * SUM); // sums of what is up to ten times as large
        }
    }
}

#[test]
fn a_law_that_keeps_what_it_has_begins_with_nothing() {
    let mut numbers = [0.0; NUMBERS];
    numbers[0] = 1.0; // xi_0+ = xi_0
    let output = Observer::from_numbers(&numbers).initial_estimate(&[1.0; SAMPLED], 1.0);
    assert!(output.iter().all(|&xi: &f64| xi.abs() < f64::MIN_POSITIVE));
}

#[test]
fn torque_at_rest_is_what_the_law_says_of_its_state_at_rest() {
    let mut draws = Draws::new(4);
    for _ in 0..DRAWS {
        let (numbers, _, y, [delta, _]) = random_law(&mut draws);
        let law = Observer::from_numbers(&numbers);
        let output = dot(&law.torque_at_rest(), &[y.as_slice(), &[delta]].concat());
        let torque = law.output(&law.at_rest(&y, delta), &y, [delta, 0.0], None).torque;
        assert_within(output, torque, SUM);
    }
}

#[test]
fn command_per_feel_is_its_number_in_the_row() {
    let numbers: [f64; NUMBERS] = random(&mut Draws::new(5));
    let law = Observer::from_numbers(&numbers);
    assert_near(law.per_delta(), numbers[C + MOST_STATES + SAMPLED], 0.0);
    let by_delta = law.output(&[0.0; MOST_STATES], &[0.0; SAMPLED], [1.0, 0.0], None).command;
    assert_near(law.per_delta(), by_delta, 0.0);
}

#[test]
fn between_two_laws_is_what_the_law_of_numbers_between_theirs_says() {
    let mut draws = Draws::new(6);
    for share in [0.0, 0.3, 0.5, 0.9, 1.0] {
        let (from, xi, y, feel) = random_law(&mut draws);
        let to: [f64; NUMBERS] = random(&mut draws);
        let blended = core::array::from_fn(|k| (1.0 - share) * from[k] + share * to[k]);
        let output = |numbers: &[f64; NUMBERS]| Observer::from_numbers(numbers).output(&xi, &y, feel, None);
        let (output, expected) = (output(&from).lerp(output(&to), share), output(&blended));
        assert_within(output.command, expected.command, SUM);
        assert_within(output.torque, expected.torque, SUM);
    }
}

#[test]
fn law_without_states_says_what_the_gains_say_that_it_repeats() {
    let mut draws = Draws::new(7);
    let p = Parameters::elevator();
    let (area, arm) = (p.actuator.area, p.column.base_arm);
    for _ in 0..DRAWS {
        // It receives neither the base's rate nor the pilot's force.
        let [piston, pressure, delta, delta_rate, base] = random(&mut draws);
        let law = Compensator::state_feedback(&p, [piston, pressure, delta, delta_rate, base, 0.0, 0.0]);
        let mut numbers = [0.0; NUMBERS];
        // p = F_c / A, x_b = R_b theta
        numbers[C + MOST_STATES..T].copy_from_slice(&[pressure / area, piston, base * arm, 0.0, delta, delta_rate]);
        numbers[T + MOST_STATES] = -law.load_cell_arm;
        let (_, xi, y, feel) = random_law(&mut draws);
        let observer = Observer::from_numbers(&numbers);
        let output = observer.output(&xi, &y, feel, None);
        let [force, x_p, theta, _] = y;
        let e = law.command(&[x_p, force / area, feel[0], feel[1], arm * theta, 0.3, -0.7]);
        assert_within(output.command, e, SUM * (1.0 + pressure.abs() / area)); // A is 1.5e-3 m²
        assert_near(output.torque, law.feel_torque(force), ROUNDING);
        // Whatever its state was, it keeps none and rests without one.
        assert_eq!(
            (observer.next(&xi, &y, e, None), observer.at_rest(&y, feel[0])),
            ([0.0; MOST_STATES], [0.0; MOST_STATES])
        );
    }
}

#[test]
fn law_that_says_nothing_says_nothing() {
    let (_, xi, y, feel) = random_law(&mut Draws::new(8));
    let law = Observer::none(1.0);
    let output = law.output(&xi, &y, feel, None);
    assert_eq!((output.command, output.torque, law.per_delta()), (0.0, 0.0, 0.0));
    assert_eq!((law.next(&xi, &y, 1.0, None), law.at_rest(&y, 1.0)), ([0.0; MOST_STATES], [0.0; MOST_STATES]));
    assert!(law.torque_at_rest().iter().all(|&torque| torque.abs() < f64::MIN_POSITIVE));
}
