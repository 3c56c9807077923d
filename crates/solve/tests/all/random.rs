//! Streams of random numbers: each of its own, and normal.
//!
//! Bounds are five standard deviations of the mean over so many numbers; the seeds are fixed.

use forcefeel_solve::random::RandomStream;
use forcefeel_solve::sensor_noise::SensorNoise;

const COUNT: u32 = 40_000;

/// As many numbers of a stream.
fn numbers(mut stream: RandomStream) -> Vec<f64> {
    (0..COUNT).map(|_| stream.normal()).collect()
}

/// Mean over the numbers, of which each has this variance, in standard deviations of such a mean.
fn mean(numbers: impl Iterator<Item = f64>, variance: f64) -> f64 {
    numbers.sum::<f64>() / (f64::from(COUNT) * variance).sqrt()
}

#[test]
fn numbers_of_a_stream_are_standard_normal_and_uncorrelated() {
    for run in [0, 1, 2, 99_999] {
        let numbers = numbers(RandomStream::new(7, run));
        let power = |k: i32| numbers.iter().map(move |number| number.powi(k));
        // Variances of x, x^2 - 1, x^3 and x^4 - 3.
        let moments = [
            mean(power(1), 1.0),
            mean(power(2).map(|square| square - 1.0), 2.0),
            mean(power(3), 15.0),
            mean(power(4).map(|fourth| fourth - 3.0), 96.0),
        ];
        let lagged = [1, 2, 3, 6].map(|lag| mean(numbers.iter().zip(&numbers[lag..]).map(|(a, b)| a * b), 1.0));
        assert!(moments.iter().chain(&lagged).all(|deviation| deviation.abs() < 5.0), "{moments:?} {lagged:?}");
    }
}

#[test]
fn runs_seeds_and_sensors_share_nothing() {
    let of = |seed, run| numbers(RandomStream::new(seed, run));
    let first = of(0, 0);
    let neighbors =
        [of(0, 1), of(0, 2), of(0, 1 << 32), of(1, 0), of(u64::MAX, 0), numbers(SensorNoise::new(0, 0).grip)];
    for other in &neighbors {
        for lag in 0..4 {
            let ahead = mean(first.iter().zip(&other[lag..]).map(|(a, b)| a * b), 1.0);
            let behind = mean(first[lag..].iter().zip(other).map(|(a, b)| a * b), 1.0);
            assert!(ahead.abs().max(behind.abs()) < 5.0, "{lag}: {ahead} {behind}");
        }
    }
}

#[test]
fn first_numbers_of_many_runs_are_as_independent_as_those_of_one() {
    let firsts: Vec<_> = (0..u64::from(COUNT)).map(|run| RandomStream::new(0, run).normal()).collect();
    let deviations = [
        mean(firsts.iter().copied(), 1.0),
        mean(firsts.iter().map(|x| x * x - 1.0), 2.0),
        mean(firsts.iter().zip(&firsts[1..]).map(|(a, b)| a * b), 1.0),
    ];
    assert!(deviations.iter().all(|deviation| deviation.abs() < 5.0), "{deviations:?}");
}
