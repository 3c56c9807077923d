//! Faults in the report's loader under its original loop: each is stopped in time, and nothing goes beyond its bounds.

use forcefeel_faults::fault::Kind;
use forcefeel_faults::run::Loaders;
use forcefeel_model::parameters::{Controller, Parameters};

#[test]
fn a_thousand_single_faults_and_as_many_pairs() {
    let elevator = Parameters::elevator();
    let controller = Controller { period: 1e-3, ..elevator.controller };
    let values = [Parameters { controller, ..elevator }.values()];
    let loaders = Loaders { values: &values, observers: None };
    for faults in [1, 2] {
        let outcomes = loaders.outcomes(1, (0, 1000), faults, 2).expect("threads");
        let mut stopped = 0;
        for (number, outcome) in outcomes.iter().enumerate() {
            let outcome = outcome.as_ref().expect("a loader that can be supervised");
            assert_eq!(outcome.wrong.bits(), 0, "case {number}: {:?} {outcome:?}", outcome.kinds.map(|k| Kind::ALL[k]));
            stopped += usize::from(outcome.stopped.is_some());
        }
        assert!(stopped > 600, "only {stopped} were stopped");
    }
}
