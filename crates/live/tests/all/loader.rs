//! The report's loader in its own position loop, under a digital controller at 2 kHz.

use forcefeel_live::setup::Setup;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::controller::Timing;
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters, TABLE};

pub const PERIOD_S: f64 = 5e-4;

/// Supervised, without a host.
pub fn setup() -> Setup {
    let values: [f64; COUNT] = core::array::from_fn(|k| match (TABLE[k].part, TABLE[k].name) {
        ("controller", "period") => PERIOD_S,
        // Rows of the other drive are off, or zero.
        _ if TABLE[k].drive() == Some(DriveKind::Electric) => TABLE[k].off_si().unwrap_or(0.0),
        _ => TABLE[k].off_si().unwrap_or_else(|| TABLE[k].default_si()),
    });
    Setup {
        values,
        gains: Compensator::original(&Parameters::from_values(&values)),
        observer: None,
        step_s: PERIOD_S,
        timing: Timing { period: 1, delay: 1 },
        curve: None,
        factor: None,
        host: false,
        rendered: vec![],
        softens: false,
        flap_trim: 0.0,
        cancellation: None,
        beginning: None,
        supervised: true,
    }
}
