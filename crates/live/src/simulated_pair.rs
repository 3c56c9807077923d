//! Two simulated machines with a shaft between their columns, each to its own controller as if it were alone.
//!
//! Both go on to their next sample together, as in a simulation of the pair.

use crate::input_output::{Command, Disturbance, InputOutput, Sampled};
use crate::simulated::Stepped;
use forcefeel_model::link::LINK_ROWS;
use forcefeel_model::shaft::Shaft;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

struct Pair {
    sides: [Box<dyn Stepped>; 2],
    shaft: Shaft,
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
            let [on_first, on_second] = self.shaft.on_each();
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
        self.shaft.step(h, |on_each| [first.advance(on_each[0]), second.advance(on_each[1])]);
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

/// Both machines with a shaft between their columns, from its values in the order of their table; whether it stays open once it has given way.
pub fn joined(sides: [Box<dyn Stepped>; 2], values: &[f64; LINK_ROWS], uncouples: bool) -> [Box<dyn InputOutput>; 2] {
    let shaft = Shaft::new(values, uncouples, [sides[0].angle(), sides[1].angle()]);
    let pair = Pair { sides, shaft, begun: false, fresh: [false; 2] };
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
            Disturbance::Link(holds) => pair.shaft.open = !holds,
            other => pair.sides[self.place].disturb(other),
        }
    }
}
