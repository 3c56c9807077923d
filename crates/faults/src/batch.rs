//! Many cases over the cores.

use crate::case::Case;
use crate::oracle::{Outcome, judge};
use crate::pair::{self, Joint, PairOutcome};
use crate::run::{LawOf, Loaders, run};
use forcefeel_model::drive::Kind;
use forcefeel_model::parameters::DriveKind;
use forcefeel_model::with_drive;
use forcefeel_solve::threads::{NoThreads, each};

impl Loaders<'_> {
    /// The case of a number with so many faults, 0 to 2; nothing where the loader cannot be supervised.
    pub fn outcome(&self, seed: (u64, u64), faults: u8) -> Option<Outcome> {
        let case = match faults {
            // Five numbers in a row have the five things that a hand does: of every other five.
            0 if (seed.1 / 5).is_multiple_of(2) => Case::legal(self.values, seed).in_environment(),
            0 => Case::legal(self.values, seed),
            count => Case::drawn(self.values, seed, count > 1).in_environment(),
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
        many((first, count), threads, |number| self.outcome((seed, number), faults))
    }

    /// The outcomes of the cases `first..first + count` of loaders on these links.
    ///
    /// # Errors
    /// If the system gives no threads.
    pub fn pair_outcomes(
        &self,
        joints: &[Joint],
        seed: u64,
        cases: (u64, u64),
        faults: u8,
        threads: usize,
    ) -> Result<Vec<Option<PairOutcome>>, NoThreads> {
        many(cases, threads, |number| pair::outcome(joints, *self, (seed, number), faults))
    }
}

fn many<T: Send>(
    (first, count): (u64, u64),
    threads: usize,
    outcome: impl Fn(u64) -> Option<T> + Sync,
) -> Result<Vec<Option<T>>, NoThreads> {
    let mut outcomes = Vec::new();
    outcomes.resize_with(usize::try_from(count).unwrap_or(usize::MAX), || None);
    each(threads, (first..).zip(&mut outcomes), |(number, at)| *at = outcome(number))?;
    Ok(outcomes)
}

fn of_drive<K: Kind>(case: &Case, law: LawOf<'_>, kind: DriveKind) -> Option<Outcome> {
    let record = run::<K::Of<f64>>(case, law, kind)?;
    Some(judge(case, &record.limits, &record.moving, &record.rows))
}
