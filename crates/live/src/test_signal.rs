//! A bench signal beside the law's command, while the feel is there.

/// Samples that are added to the law's command, one a cycle.
#[derive(Debug, Clone, Default)]
pub struct TestSignal {
    samples: Vec<f64>,
    /// Cycles in a row in which the feel was there.
    active: usize,
    /// So many before it begins.
    settles: usize,
}

impl TestSignal {
    /// Samples in V, or A of a motor, that begin after so many cycles with the feel there.
    pub fn new(samples: Vec<f64>, settles: usize) -> Self {
        Self { samples, active: 0, settles }
    }

    /// Whether a sample is still to come.
    pub fn is_ahead(&self) -> bool {
        self.active < self.settles + self.samples.len() && !self.samples.is_empty()
    }

    /// What is added in this cycle. Once begun it does not begin again: where the feel goes it is over.
    pub fn next(&mut self, active: bool) -> f64 {
        if active {
            self.active += 1;
        } else if self.active > self.settles {
            self.samples.clear();
        } else {
            self.active = 0;
        }
        let place = self.active.checked_sub(self.settles + 1);
        place.filter(|_| active).and_then(|place| self.samples.get(place)).copied().unwrap_or(0.0)
    }
}
