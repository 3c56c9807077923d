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
        let [low, high] = [step, step + 1].map(Histogram::edge_ns);
        assert!(low <= ns && ns < high, "{ns} in step {step}");
        // The stated error of a quantile, which is the end of its step; steps of whole nanoseconds are no narrower.
        assert!((high - low) * 64 <= low.max(64), "{ns} in step {step}");
    }
}

#[test]
fn the_longest_is_known_to_the_nanosecond() {
    let histogram = Histogram::default();
    assert_eq!(histogram.worst_ns(), 0);
    for ns in [17, 184_767_123, 5000] {
        histogram.count(ns);
    }
    assert_eq!(histogram.worst_ns(), 184_767_123);
}

#[test]
fn the_longest_is_counted_in_the_last_step() {
    let histogram = Histogram::default();
    histogram.count(u64::MAX);
    assert_eq!(histogram.counts()[BUCKETS - 1], 1);
}
