//! What a run states of its drive's fault: a cycle without a sample says nothing of it.

use crate::loader::setup;
use forcefeel_live::clock::Woken;
use forcefeel_live::controller::Controller;
use forcefeel_live::cycle::Cycles;
use forcefeel_live::input_output::{Command, InputOutput, Sampled};
use forcefeel_live::status::Status;
use forcefeel_model::control::Sample;
use rtrb::RingBuffer;
use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

const OVERHEATED: u16 = 0x4000;

/// A machine at rest whose samples come with these faults; none is a cycle without a sample.
struct Complains(VecDeque<Option<u16>>);

impl InputOutput for Complains {
    fn read(&mut self) -> Option<Sampled> {
        self.0.pop_front().flatten().map(|drive_fault| Sampled {
            sample: Sample { sensors: [0.0; 4], pilot_force: 0.0 },
            periods: 1.0,
            delay: 0,
            emergency_stop: false,
            drive_fault,
            drive_acts: true,
        })
    }
    fn write(&mut self, _: &Command) {}
}

/// The fault that the run states after cycles with these.
fn stated(faults: &[Option<u16>]) -> u32 {
    let mut run = Cycles {
        controller: Controller::new(&setup()).expect("it has limits"),
        machine: Box::new(Complains(faults.iter().copied().collect())),
        plan: vec![],
        requests: RingBuffer::new(1).1,
        host: None,
        disturbances: RingBuffer::new(1).1,
        rows: RingBuffer::new(64).0,
        taken: RingBuffer::new(1).0,
        status: Arc::new(Status::default()),
        planned: 0,
        patient: false,
    };
    for _ in faults {
        run.cycle(Woken { late_ns: 0, missed: 0 });
    }
    run.status.drive_fault.load(Relaxed)
}

#[test]
fn a_fault_stays_over_a_cycle_without_a_sample_and_goes_with_a_sample_without_it() {
    let fault = Some(OVERHEATED);
    assert_eq!(stated(&[Some(0), fault]), u32::from(OVERHEATED));
    assert_eq!(stated(&[Some(0), fault, None, None]), u32::from(OVERHEATED));
    assert_eq!(stated(&[Some(0), fault, None, Some(0)]), 0);
}
