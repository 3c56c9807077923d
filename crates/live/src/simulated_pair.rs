//! Two simulated machines with a shaft between their columns, each to its own controller as if it were alone.
//!
//! Both go on to their next sample together, the torque of the shaft changing evenly through each step, as in a simulation of the pair.

use crate::input_output::{Command, Disturbance, InputOutput, Sampled};
use crate::simulated::Stepped;
use forcefeel_model::link::PilotLink;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

struct Pair {
    sides: [Box<dyn Stepped>; 2],
    link: PilotLink<f64>,
    uncouples: bool,
    open: bool,
    /// Angle and rate of the first column beyond the second.
    beyond: [f64; 2],
    /// Whether a step of both has begun, and whose sample there has not been read.
    begun: bool,
    fresh: [bool; 2],
}

impl Pair {
    /// Goes on to the next sample of both, whose periods are one.
    fn go_on(&mut self) {
        loop {
            if self.begun {
                self.step();
            }
            let torque = if self.open { 0.0 } else { self.link.torque(self.beyond) };
            let [on_first, on_second] = self.link.on_each(torque);
            let [first, second] = &mut self.sides;
            self.begun = true;
            if first.arrive(on_first) | second.arrive(on_second) {
                self.fresh = [true; 2];
                return;
            }
        }
    }

    fn step(&mut self) {
        self.sides.iter_mut().for_each(|side| side.set_out());
        let (h, [first, second]) = (self.sides[0].step_s(), &mut self.sides);
        self.beyond = self.link.step(!self.open, self.beyond, h, |[on_first, on_second]| {
            [first.advance(on_first), second.advance(on_second)]
        });
        self.open |= self.uncouples && self.link.gives_way(self.beyond[0]);
        self.sides.iter_mut().for_each(|side| side.done());
    }
}

struct Side {
    pair: Arc<Mutex<Pair>>,
    place: usize,
}

impl Side {
    /// Nobody else waits for it: one thread reads both.
    fn pair(&self) -> MutexGuard<'_, Pair> {
        self.pair.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Both machines with a shaft between their columns.
pub fn joined(sides: [Box<dyn Stepped>; 2], link: PilotLink<f64>, uncouples: bool) -> [Box<dyn InputOutput>; 2] {
    let beyond = link.beyond([sides[0].angle(), 0.0], [sides[1].angle(), 0.0]);
    let pair = Pair { sides, link, uncouples, open: false, beyond, begun: false, fresh: [false; 2] };
    let pair = Arc::new(Mutex::new(pair));
    [0, 1].map(|place| Box::new(Side { pair: Arc::clone(&pair), place }) as Box<dyn InputOutput>)
}

impl InputOutput for Side {
    fn read(&mut self) -> Option<Sampled> {
        let mut pair = self.pair();
        if !pair.fresh[self.place] {
            pair.go_on();
        }
        pair.fresh[self.place] = false;
        pair.sides[self.place].sample()
    }

    fn write(&mut self, command: &Command) {
        self.pair().sides[self.place].write(command);
    }

    fn disturb(&mut self, disturbance: Disturbance) {
        let mut pair = self.pair();
        match disturbance {
            Disturbance::Link(holds) => pair.open = !holds,
            other => pair.sides[self.place].disturb(other),
        }
    }
}
