//! Noise of the sensors of one machine.

use crate::random::RandomStream;
use forcefeel_model::transducers::SENSORS;

/// Standard normal numbers: with a sensor at the grip or without, the others' noise is the same.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SensorNoise {
    /// For load cell, potentiometer and column sensor, in turn.
    pub column: RandomStream,
    /// For the force sensor at the grip.
    pub grip: RandomStream,
}

/// Numbers of streams from here on are those of the grip's sensors.
const OF_GRIP: u64 = 1 << 63;

impl SensorNoise {
    /// That of a run under a seed.
    pub fn new(seed: u64, run: u64) -> Self {
        Self { column: RandomStream::new(seed, run), grip: RandomStream::new(seed, run | OF_GRIP) }
    }

    /// A number for each sensor.
    #[inline]
    pub fn sample(&mut self) -> [f64; SENSORS] {
        let Self { column, grip } = self;
        [column.normal(), column.normal(), column.normal(), grip.normal()]
    }
}
