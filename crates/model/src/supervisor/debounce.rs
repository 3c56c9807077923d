//! How long something has lasted.

/// Samples in a row in which a condition held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Debounce(u32);

impl Debounce {
    /// One sample more; whether it has now lasted for so many.
    #[inline(always)]
    pub fn holds(&mut self, condition: bool, samples: u32) -> bool {
        self.0 = if condition { self.0.saturating_add(1) } else { 0 };
        self.0 >= samples
    }
}
