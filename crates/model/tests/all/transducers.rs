//! Lags of the sensors against the exact exponential; samples against their definition.

use crate::near::{ROUNDING, assert_near, assert_within};
use core::f64::consts::TAU;
use forcefeel_model::parameters::Parameters;
use forcefeel_model::transducers::{SENSORS, SensorReading, Transducers};
use forcefeel_model::units;

const H: f64 = 1e-3;
/// The series of the exponential and its ten squarings: some thousand roundings.
const DECAY: f64 = 1e-12;

/// Sensors with these bandwidths in rad/s.
fn sensors(bandwidths: [f64; 3]) -> Transducers<f64> {
    let mut parameters = Parameters::elevator();
    let [force, piston, column] = bandwidths;
    parameters.load_cell.bandwidth = force;
    parameters.potentiometer.bandwidth = piston;
    parameters.column_sensor.bandwidth = column;
    parameters.grip_sensor.bandwidth = column;
    Transducers::new(&parameters, H)
}

/// `f' = w (x - f)` after `t`, `x` going evenly from `x_0` by `slope` a second.
fn exact(w: f64, f_0: f64, x_0: f64, slope: f64, t: f64) -> f64 {
    let steady = |t: f64| x_0 + slope * (t - 1.0 / w);
    steady(t) + (f_0 - steady(0.0)) * (-w * t).exp()
}

#[test]
fn lag_is_the_exponential_for_what_changes_evenly() {
    for w in [0.6, 20.0, TAU * 100.0, TAU * 500.0, 6e5] {
        let sensors = sensors([w; 3]);
        for (f_0, x_0, slope) in [(0.0, 0.0, 1e3), (2.0, 1.0, 0.0), (-1.0, 3.0, -800.0)] {
            let before = SensorReading { measured: [x_0; SENSORS], shown: [f_0; SENSORS] };
            for (found, t) in [
                (sensors.after_half(&before, [x_0 + slope * 0.5 * H; SENSORS]), 0.5 * H),
                (sensors.after_whole(&before, [x_0 + slope * H; SENSORS], 0.0), H),
            ] {
                // (x - x_0) / (w h) cancels for the slow ones.
                for f in found {
                    // The steady slope / w of a slow sensor cancels.
                    assert_within(f, exact(w, f_0, x_0, slope, t), 0.1 * DECAY * (4.0 + (slope / w).abs()));
                }
            }
        }
    }
}

#[test]
fn two_halves_are_a_whole() {
    let sensors = sensors([TAU * 80.0, TAU * 300.0, 5.0]);
    let before = SensorReading { measured: [1.0, 2.0, 3.0, 4.0], shown: [0.5, 2.5, 3.0, 4.5] };
    let (middle, end) = ([1.5, 1.0, 3.5, 3.0], [2.0, 0.0, 4.0, 2.0]);
    let half_way = SensorReading { measured: middle, shown: sensors.after_half(&before, middle) };
    let (twice, once) = (sensors.after_half(&half_way, end), sensors.after_whole(&before, end, 0.0));
    for (twice, once) in twice.into_iter().zip(once) {
        assert_within(twice, once, 1e-11); // 3 / (w h) of the slow sensor cancels
    }
}

#[test]
fn sensor_without_a_lag_shows_what_it_measures() {
    let sensors = sensors([f64::INFINITY; 3]);
    let before = SensorReading { measured: [1.0, -2.0, 0.3, 7.0], shown: [0.7, 9.0, -4.0, 6.0] };
    let now = [1.1, -5.0, 0.31, 8.0];
    for shown in [sensors.after_whole(&before, now, 0.0), sensors.after_half(&before, now)] {
        assert_eq!(shown.map(f64::to_bits), now.map(f64::to_bits));
    }
    assert_near(sensors.column_rate(0.4, 7.0, 0.3), 7.0, 0.0);
}

#[test]
fn force_that_came_late_is_shown_as_late_as_that() {
    // Of a ramp that has long gone on a lag shows what was 1 / w ago, one that is `late` too what was that much earlier still.
    let (w, slope, late) = (TAU * 200.0, 4e3, 0.04);
    let sensors = sensors([w; 3]);
    let mut seen = SensorReading { measured: [0.0; SENSORS], shown: [0.0; SENSORS] };
    for k in 1..=100 {
        let measured = [slope * f64::from(k) * H; SENSORS];
        seen = SensorReading { measured, shown: sensors.after_whole(&seen, measured, late) };
    }
    let [force, piston, ..] = seen.shown;
    assert_near(force, slope * (100.0 * H - 1.0 / w - late * H), DECAY);
    assert_near(piston, slope * (100.0 * H - 1.0 / w), DECAY);
}

#[test]
fn tachometer_gives_the_rate_of_what_the_sensor_shows() {
    let (w, x, f) = (TAU * 40.0, 0.3, 0.28);
    assert_near(sensors([w; 3]).column_rate(x, 123.0, f), w * (x - f), ROUNDING);
}

#[test]
fn share_of_a_late_force_is_the_mean_of_what_the_lag_has_passed_on() {
    for w in [1.0, 200.0, TAU * 500.0, 1e6] {
        for time in [1e-9, 1e-5, 1e-3] {
            let decay: f64 = w * time;
            let expected = 1.0 + (-decay).exp_m1() / decay;
            // Below 1e-6 half of w T, which is off by a third of its square; above, the exponential cancels.
            assert_within(sensors([w; 3]).load_cell_share(time), expected, 0.2 * DECAY * (1.0 + 1.0 / decay.max(1e-6)));
        }
    }
    assert_near(sensors([f64::INFINITY; 3]).load_cell_share(1e-4), 1.0, 0.0);
}

#[test]
fn sample_has_offset_noise_and_resolution_of_each_sensor() {
    let mut parameters = Parameters::elevator();
    parameters.load_cell.offset = 2.0;
    parameters.load_cell.noise = 0.5;
    parameters.load_cell.resolution = 0.25;
    parameters.potentiometer.offset = -1e-3;
    parameters.column_sensor.offset = 0.01;
    parameters.column_sensor.noise = 0.002;
    parameters.grip_sensor.offset = 0.3;
    parameters.grip_sensor.noise = 0.1;
    parameters.grip_sensor.resolution = 0.25;
    let sensors = Transducers::new(&parameters, H);
    let arm = 10.0 * units::LENGTH.si_per_us;
    let [force, piston, base, grip] = sensors.sample([100.1, 0.05, 0.02, 10.0], [1.0, 3.0, -2.0, -1.0]);
    assert_near(force, 102.5, 0.0); // 100.1 + 2 + 0.5 = 102.6, to the nearest quarter
    assert_near(piston, 0.049, ROUNDING);
    assert_near(grip, 10.25, 0.0); // 10 + 0.3 - 0.1 = 10.2, to the nearest quarter
    assert_near(base, 0.02 + 0.01 * arm - 2.0 * 0.002 * arm, ROUNDING); // angles of the column, at its base
}
