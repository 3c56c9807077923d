//! The histogram of durations: every duration lies within the edges of the step that counts it.

use forcefeel_live::status::{BUCKETS, Histogram};

#[test]
fn a_duration_lies_within_its_step() {
    for ns in
        (0..200).chain((8..34).flat_map(|octave| [-1, 0, 1, 77].map(|by| ((1_i64 << octave) + by).unsigned_abs())))
    {
        let histogram = Histogram::default();
        histogram.count(ns);
        let step = histogram.counts().iter().position(|&count| count == 1).expect("it is counted");
        assert!(Histogram::edge_ns(step) <= ns && ns < Histogram::edge_ns(step + 1), "{ns} in step {step}");
    }
}

#[test]
fn the_longest_is_counted_in_the_last_step() {
    let histogram = Histogram::default();
    histogram.count(u64::MAX);
    assert_eq!(histogram.counts()[BUCKETS - 1], 1);
}
