//! Comparison of floating-point numbers.
#![allow(dead_code, reason = "each test file takes what it needs")]

/// Asserts that `actual` is within the share `relative` of `expected`; an expected zero must be met exactly.
pub fn assert_near(actual: f64, expected: f64, relative: f64) {
    let error = (actual - expected).abs();
    assert!(error <= relative * expected.abs(), "expected {expected:e} to {relative:e}, got {actual:e}");
}

/// Asserts that `actual` is within `absolute` of `expected`: for printed digits, and for sums that cancel.
pub fn assert_within(actual: f64, expected: f64, absolute: f64) {
    let error = (actual - expected).abs();
    assert!(error <= absolute, "expected {expected:e} within {absolute:e}, got {actual:e}");
}

/// A few roundings of double precision.
pub const ROUNDING: f64 = 1e-14;
