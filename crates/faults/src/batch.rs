//! Many cases over the cores.

use crate::case::Case;
use crate::oracle::{Outcome, judge};
use crate::run::{LawOf, Moving, run};
use forcefeel_model::drive::Kind;
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::{COUNT, DriveKind, Parameters};
use forcefeel_model::with_drive;
use forcefeel_solve::threads::{NoThreads, each};

/// Loaders with a law each: one with an observer, or none for the original loop.
#[derive(Debug, Clone, Copy)]
pub struct Loaders<'a> {
    /// Values, in the order of the parameter table.
    pub values: &'a [[f64; COUNT]],
    /// Numbers of the laws.
    pub observers: Option<&'a [[f64; NUMBERS]]>,
}

impl Loaders<'_> {
    /// The case of a number with so many faults, 0 to 2; nothing where the loader cannot be supervised.
    pub fn outcome(&self, seed: (u64, u64), faults: u8) -> Option<Outcome> {
        let case = match faults {
            0 => Case::legal(self.values, seed),
            count => Case::drawn(self.values, seed, count > 1),
        };
        let law = self.observers.map(|laws| &laws[case.loader]);
        let kind = DriveKind::of(&case.values);
        with_drive!(kind, K => of_drive::<K>(&case, law, kind))
    }

    /// The outcomes of the cases `first..first + count`.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn outcomes(
        &self,
        seed: u64,
        (first, count): (u64, u64),
        faults: u8,
        threads: usize,
    ) -> Result<Vec<Option<Outcome>>, NoThreads> {
        let mut outcomes = Vec::new();
        outcomes.resize_with(usize::try_from(count).unwrap_or(usize::MAX), || None);
        each(threads, (first..).zip(&mut outcomes), |(number, outcome)| {
            *outcome = self.outcome((seed, number), faults);
        })?;
        Ok(outcomes)
    }
}

fn of_drive<K: Kind>(case: &Case, law: LawOf<'_>, kind: DriveKind) -> Option<Outcome> {
    let (limits, rows) = run::<K::Of<f64>>(case, law, kind)?;
    let moving = Moving::of(&Parameters::from_values(&case.values), kind, &limits);
    Some(judge(case, &limits, &moving, &rows))
}
