//! A bench signal beside the law's command.

use forcefeel_live::test_signal::TestSignal;

#[test]
fn a_signal_begins_when_the_feel_has_been_there_for_long_and_never_again() {
    let mut signal = TestSignal::new(vec![1.0, 2.0, 3.0], 2);
    let states = [true, false, true, true, true, true, false, true, true, true, true];
    let given: Vec<_> = states.iter().map(|&active| signal.next(active)).collect();
    assert_eq!(given, [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
}

#[test]
fn it_is_ahead_until_its_last_sample_or_until_the_feel_goes() {
    let ahead = |states: &[bool]| {
        let mut signal = TestSignal::new(vec![1.0, 2.0], 1);
        for &active in states {
            signal.next(active);
        }
        signal.is_ahead()
    };
    assert!(!TestSignal::default().is_ahead(), "a run without one");
    assert!(ahead(&[]) && ahead(&[false]) && ahead(&[true, true]));
    assert!(!ahead(&[true, true, true]));
    assert!(!ahead(&[true, true, false]));
}
