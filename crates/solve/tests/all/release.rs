//! Features of releases and the polynomial behind them, where the answer is exact.

use forcefeel_solve::local_fit::LocalFit;
use forcefeel_solve::release::{FEATURE_GROUPS, FEATURES, Measuring};

/// What double precision leaves of a polynomial of fourth degree.
const EXACT: f64 = 1e-12;

/// What a polynomial through six samples leaves of a swing, in s and in what it is of.
const FITTED: f64 = 1e-6;

/// A column of these names in the features.
fn column(name: &str) -> usize {
    FEATURE_GROUPS.iter().take_while(|(group, ..)| *group != name).map(|(_, columns, _)| columns).sum()
}

#[test]
fn a_polynomial_of_fourth_degree_is_met_at_uneven_times() {
    let time = [0.0, 0.1, 0.25, 0.3, 0.52, 0.6, 0.71];
    let polynomial = |t: f64| 3.0 - t + 2.0 * t * t - 5.0 * t.powi(3) + 0.5 * t.powi(4);
    let fit = LocalFit::new(&time, &time.map(polynomial));
    let level = polynomial(0.41);
    let found = fit.crossing(level, 0.3).unwrap();
    assert!((found.time - 0.41).abs() < EXACT);
    assert!((found.value - level).abs() < EXACT);
    let slope = -1.0 + 4.0 * 0.41 - 15.0 * 0.41_f64.powi(2) + 2.0 * 0.41_f64.powi(3);
    assert!((found.slope - slope).abs() < 100.0 * EXACT);
    assert!(found.noise > 0.0 && found.noise < 1.0);
    assert!(fit.crossing(1e3, 0.3).is_none());
}

#[test]
fn an_extremum_of_a_parabola() {
    let time = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    let found = LocalFit::new(&time, &time.map(|t| 7.0 - (t - 2.2) * (t - 2.2))).extremum(2.0).unwrap();
    assert!((found.time - 2.2).abs() < EXACT && (found.value - 7.0).abs() < EXACT);
}

#[test]
fn five_samples_are_met_and_their_noise_goes_through() {
    let time = [0.0, 1.0, 2.0, 3.0, 4.0];
    let found = LocalFit::new(&time, &[0.0, 1.0, 0.0, -1.0, 0.0]).crossing(0.0, 2.1).unwrap();
    assert!((found.time - 2.0).abs() < EXACT && (found.noise - 1.0).abs() < EXACT);
}

/// Damping ratio and natural frequency in rad/s of a column of second order.
const ZETA: f64 = 0.2;
const OMEGA: f64 = 10.0;

/// Its frequency in swinging, in rad/s.
fn damped() -> f64 {
    OMEGA * (1.0 - ZETA * ZETA).sqrt()
}

/// So many samples of its release by 0.3, each millisecond: times and positions about 2.
fn released(samples: i32) -> (Vec<f64>, Vec<f64>) {
    let way =
        |t: f64| (-ZETA * OMEGA * t).exp() * ((damped() * t).cos() + ZETA * OMEGA / damped() * (damped() * t).sin());
    let time: Vec<f64> = (0..samples).map(|k| f64::from(k) * 1e-3).collect();
    let position = time.iter().map(|t| 2.0 - 0.3 * way(*t)).collect();
    (time, position)
}

fn measuring(time: &[f64], tail: usize) -> Measuring<'_> {
    Measuring { time, held: 1, free: 0, tail, band: 0.05, high: 0.9, low: 0.1, reach: 0.0, hysteresis: 0.0 }
}

#[test]
fn a_record_that_ends_early_is_measured_around_a_known_steady_state() {
    let (zeta, omega, damped) = (ZETA, OMEGA, damped());
    let lasts = 2.0 * std::f64::consts::PI / damped;
    let (time, position) = released(1100);
    let measuring = measuring(&time, 1);
    let found = measuring.measure_around(&position, 2.0);
    let (size, at) = found.overshoots_beyond().next().unwrap();
    assert!((size - 0.3 * (-std::f64::consts::PI * zeta * omega / damped).exp()).abs() < FITTED);
    assert!((at - 0.5 * lasts).abs() < FITTED);
    let period = found.period(0.0, 0.01).unwrap();
    assert!((period.mean - lasts).abs() < FITTED && period.cycles == 1 && period.uncertainty == 0.0);
    // Noise puts the two crossings off, each by itself.
    let noisy = found.period(1e-3, 0.01).unwrap().uncertainty;
    let first = 1e-3 / (0.3 * omega * (-zeta * omega * (std::f64::consts::FRAC_PI_2 + zeta.asin()) / damped).exp());
    assert!((noisy / first.hypot(first * (zeta * omega * lasts).exp()) - 1.0).abs() < 0.01, "{noisy}");
    // Crossings that differ from extrema by more than asked for are of no one period.
    assert!(measuring.measure_around(&position, 1.99).period(0.0, 1e-3).is_none());
}

#[test]
fn a_column_of_second_order() {
    let (zeta, omega, damped) = (ZETA, OMEGA, damped());
    let (time, position) = released(6000);
    let measuring = measuring(&time, 600);
    let found = measuring.measure(&position).values;
    // The tail still swings by exp(-10.8).
    let near = |name: &str, k: usize, expected: f64, within: f64| {
        assert!((found[column(name) + k] - expected).abs() < within, "{name}: {}", found[column(name) + k]);
    };
    near("steady", 0, 2.0, 1e-5);
    near("displacement", 0, -0.3, 1e-5);
    near("count", 0, 4.0, 0.5);
    let first = (std::f64::consts::FRAC_PI_2 + zeta.asin()) / damped;
    near("crossings", 0, first, 1e-5);
    near("crossings", 2, first + 2.0 * std::f64::consts::PI / damped, 1e-4);
    near("overshoots", 0, 0.3 * (-std::f64::consts::PI * zeta * omega / damped).exp(), 1e-5);
    let all = measuring.measure_all(&[position.clone(), vec![f64::NAN; 6000], position].concat(), 2).expect("threads");
    // Bit by bit: what is not there is not a number.
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&all[..FEATURES]), bits(&found));
    assert_eq!(bits(&all[2 * FEATURES..]), bits(&found));
    assert!(all[FEATURES..2 * FEATURES].iter().all(|value| value.is_nan()));
}
