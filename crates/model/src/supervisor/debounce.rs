//! How long something has lasted.

use crate::Logic;
use crate::logic::Count;

/// Samples in a row in which a condition held.
#[derive(Debug, Clone, Copy)]
pub(super) struct Debounce<S: Logic> {
    pub(super) samples: S::Count,
}

crate::logic::memory! { Debounce { count samples; } }

impl<S: Logic> Debounce<S> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { samples: S::Count::none() }
    }

    /// One sample more; whether it has now lasted for so many.
    #[inline(always)]
    pub(super) fn holds(&mut self, condition: S::Mask, samples: u32) -> S::Mask {
        self.samples = self.samples.in_a_row(condition);
        self.samples.at_least(samples)
    }
}
