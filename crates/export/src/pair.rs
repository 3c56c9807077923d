//! Two controllers on an electronic link: its law traced, and all three run for reference.

use crate::controller::{
    ADDED, ANSWERS, Controller, FIRST_OF_LINK, Given, INPUTS, Job, LINK, Program, STIFFNESS_FACTOR,
};
use crate::emit::body_of;
use crate::trace::{Bank, Mask, Trace, traced};
use crate::writer::Writer;
use forcefeel_model::Scalar;
use forcefeel_model::link::LINK_ROWS;
use forcefeel_model::linked_feels::{LinkOutputs, LinkTimes, LinkedFeel, LinkedFeels};

/// Two laws and the link between their feels.
#[derive(Debug, Clone)]
pub struct Pair {
    /// The laws, of one period and precision, each [`linked`](Job::linked).
    pub jobs: [Job; 2],
    /// Values of the link, in the order of its table.
    pub values: [f64; LINK_ROWS],
    /// Periods from one control's sample to the other's feel computer.
    pub delay: usize,
    /// Whether the link stays open once it has given way.
    pub uncouples: bool,
}

/// What a pair is given at a sample.
#[derive(Debug, Clone, Copy)]
pub struct GivenPair {
    /// Each law.
    pub laws: [Given; 2],
    /// What the link is given: forces of the hands.
    pub hands: [f64; 2],
    /// Who presses the priority button.
    pub pressed: [bool; 2],
    /// Whether the link is to open.
    pub disconnect: bool,
}

/// Places of the middle and of the search for its rest among [`LINK`].
const MIDDLE: usize = 27;
const REST: usize = MIDDLE + 8;

/// Numbers of a link's answer: force at each grip, damping on each feel; 1 where each pilot has priority, where it gives way, is open.
pub const LINK_ANSWERS: usize = 8;

/// Numbers of a pair's answer: of both laws, then of the link.
pub const PAIR_ANSWERS: usize = 2 * ANSWERS + LINK_ANSWERS;

impl Pair {
    fn link<S: Scalar>(&self, number: impl Fn(f64) -> S) -> Link<S> {
        let arms = self.jobs.each_ref().map(|job| job.parameters(|_, of| number(of(0))).column.grip_arm);
        let first = &self.jobs[0];
        let LinkTimes { period, change } =
            LinkTimes::new(first.period_s, first.parameters(|_, of| of(0)).safety.fade_time);
        Link {
            feels: LinkedFeels::new(&self.values, &number, self.delay, self.uncouples),
            times: LinkTimes { period: number(period), change: number(change) },
            arms,
        }
    }

    /// Traces a sample of the link: ages of 0, 1, `d` and `d + 1` periods are all that it reads.
    pub fn program(&self) -> Program {
        let ((outputs, numbers), graph) = traced(self.jobs[0].single, 1, None, || {
            Trace::section("link");
            let known = |value: f64| Trace::known(&[value], Bank::All);
            let input = |k: usize| Trace::input(FIRST_OF_LINK + k);
            let flag = |name: &str| Mask::flag(FIRST_OF_LINK + LINK.iter().take_while(|&&of| of != name).count());
            let at = |age: usize| [0, 1].map(|side| [0, 1].map(|k| input(4 * age + 2 * side + k)));
            let zero = known(0.0);
            let Link { feels: mut link, times, arms } = self.link(known);
            link.electronic.recall(|age| match self.seen_at(age) {
                Some(place) => {
                    let [first, second] = at(place);
                    [first, second, [0, 1].map(|k| input(MIDDLE + 2 * place + k))]
                }
                None => [[zero; 2]; 3],
            });
            link.open = flag("open");
            link.priority.by_force = [flag("by_force[0]"), flag("by_force[1]")];
            let hands = [input(16), input(17)];
            (link.share, link.gains) = (input(18), [input(19), input(20)]);
            let pressed = [flag("button[0]"), flag("button[1]")];
            let sides = of_both(at(0), (hands, pressed), flag("disconnect"));
            let LinkOutputs { torques, damping, priority, gives_way } = link.sampled(&times, &sides);
            let forces = at_grips(torques, arms);
            let mut outputs = vec![
                ("torque[0]", torques[0].0),
                ("torque[1]", torques[1].0),
                ("force[0]", forces[0].0),
                ("force[1]", forces[1].0),
                ("damping[0]", damping[0].0),
                ("damping[1]", damping[1].0),
                ("priority[0]", priority[0].0),
                ("priority[1]", priority[1].0),
                ("gives_way", gives_way.0),
                ("dual_input", link.priority.dual_input(hands).0),
                ("open", link.open.0),
                ("share", link.share.0),
                ("gain[0]", link.gains[0].0),
                ("gain[1]", link.gains[1].0),
                ("by_force[0]", link.priority.by_force[0].0),
                ("by_force[1]", link.priority.by_force[1].0),
            ];
            if let Some(middle) = link.electronic.middle() {
                outputs.extend([("middle[0]", middle[0].0), ("middle[1]", middle[1].0)]);
            }
            (outputs, [torques, forces].as_flattened().iter().map(|number| number.0).collect())
        });
        Program { graph, outputs, numbers, next: Vec::new() }
    }

    /// Which of the ages that the link reads this is: 0, 1, `d` and `d + 1` periods.
    fn seen_at(&self, age: usize) -> Option<usize> {
        let ages = [0, 1, self.delay, self.delay + 1];
        ages.iter().position(|&of| of == age)
    }

    /// Traces a step of the search for the angle at which the middle rests between controls at rest; nothing without a middle.
    pub fn halving(&self) -> Option<Program> {
        let ((outputs, numbers), graph) = traced(self.jobs[0].single, 1, None, || {
            Trace::section("link");
            let input = |k: usize| Trace::input(FIRST_OF_LINK + REST + k);
            let Link { feels, .. } = self.link(|value: f64| Trace::known(&[value], Bank::All));
            let of = feels.electronic.halved([input(0), input(1)], [input(2), input(3)]);
            let outputs = of.map_or_else(Vec::new, |[between, half]| {
                vec![
                    ("between[0]", between[0].0),
                    ("between[1]", between[1].0),
                    ("half[0]", half[0].0),
                    ("half[1]", half[1].0),
                ]
            });
            let numbers = outputs.iter().map(|&(_, number)| number).collect();
            (outputs, numbers)
        });
        (!outputs.is_empty()).then(|| Program { graph, outputs, numbers, next: Vec::new() })
    }

    /// The bodies in C of a sample of the link and of a step of that search; the names begin with `name`.
    pub fn source(&self, name: &str) -> (String, Option<String>) {
        let body = |program: &Program| body_of(&mut Writer::new(name, self.jobs[0].single), program);
        (body(&self.program()), self.halving().as_ref().map(body))
    }

    /// What a pair answers sample by sample, from rest where all sensors show zero.
    pub fn answers(&self, given: &[GivenPair]) -> Vec<[f64; PAIR_ANSWERS]> {
        if self.jobs[0].single { self.run(0.0f32, given) } else { self.run(0.0f64, given) }
    }

    fn run<S: Scalar<Mask = bool> + Into<f64>>(&self, like: S, given: &[GivenPair]) -> Vec<[f64; PAIR_ANSWERS]> {
        let mut rest = Given { inputs: [0.0; INPUTS.len()], settings: (0, 0) };
        rest.inputs[STIFFNESS_FACTOR] = 1.0;
        let mut controllers = self.jobs.each_ref().map(|job| Controller::new(job, like, &rest));
        let number = |value: f64| like.constant(value);
        let Link { feels: mut link, times, arms } = self.link(number);
        let step = |one: &GivenPair| {
            let programmed = controllers.each_ref().map(Controller::programmed);
            let sides = of_both(programmed, (one.hands.map(number), one.pressed), one.disconnect);
            let LinkOutputs { torques, damping, priority, gives_way } = link.sampled(&times, &sides);
            let forces = at_grips(torques, arms);
            let mut answer = [0.0; PAIR_ANSWERS];
            for side in 0..2 {
                let mut given = one.laws[side];
                for (place, more) in [(ADDED, forces[side]), (INPUTS.len() - 1, damping[side])] {
                    given.inputs[place] = (number(given.inputs[place]) + more).into();
                }
                let law = controllers[side].step(&given).map(Into::into);
                answer[side * ANSWERS..(side + 1) * ANSWERS].copy_from_slice(&law);
                answer[2 * ANSWERS + side] = forces[side].into();
                answer[2 * ANSWERS + 2 + side] = damping[side].into();
                answer[2 * ANSWERS + 4 + side] = f64::from(u8::from(priority[side]));
            }
            answer[2 * ANSWERS + 6..].copy_from_slice(&[gives_way, link.open].map(|flag| f64::from(u8::from(flag))));
            answer
        };
        given.iter().map(step).collect()
    }
}

/// A link with its times and the arms of both grips.
struct Link<S: Scalar> {
    feels: LinkedFeels<S>,
    times: LinkTimes<S>,
    arms: [S; 2],
}

/// Torques on both feels, as a force at each grip.
fn at_grips<S: Scalar>(torques: [S; 2], arms: [S; 2]) -> [S; 2] {
    [0, 1].map(|side: usize| torques[side] / arms[side])
}

/// Both sides of a link whose feels are there in full.
fn of_both<S: Scalar>(
    programmed: [[S; 2]; 2],
    (hands, pressed): ([S; 2], [S::Mask; 2]),
    opens: S::Mask,
) -> [LinkedFeel<S>; 2] {
    let zero = hands[0].zero();
    [0, 1].map(|side| LinkedFeel {
        programmed: programmed[side],
        share: zero.constant(1.0),
        hand_force: hands[side],
        presses: pressed[side],
        opens,
        closes: zero.less(zero),
    })
}

/// What a link answers to motion, hands, buttons and disconnect, sample by sample, from rest at the first motion.
pub type LinkRow = [f64; 9];

impl Pair {
    /// Answers of the link alone to rows of angle and rate of both, hands, buttons and disconnect.
    pub fn link_answers(&self, rows: &[LinkRow]) -> Vec<[f64; LINK_ANSWERS]> {
        if self.jobs[0].single { self.link_run(0.0f32, rows) } else { self.link_run(0.0f64, rows) }
    }

    fn link_run<S: Scalar<Mask = bool> + Into<f64>>(&self, like: S, rows: &[LinkRow]) -> Vec<[f64; LINK_ANSWERS]> {
        let number = |value: f64| like.constant(value);
        let motion = |row: &LinkRow| [[row[0], row[1]], [row[2], row[3]]].map(|side| side.map(number));
        let Link { feels: mut link, times, arms } = self.link(number);
        let step = |row: &LinkRow| {
            let pressed = [row[6] > 0.0, row[7] > 0.0];
            let sides = of_both(motion(row), ([row[4], row[5]].map(number), pressed), row[8] > 0.0);
            let LinkOutputs { torques, damping, priority, gives_way } = link.sampled(&times, &sides);
            let forces = at_grips(torques, arms);
            let flags = [priority[0], priority[1], gives_way, link.open].map(|flag| f64::from(u8::from(flag)));
            let numbers = [forces, damping].as_flattened().iter().map(|&number| number.into()).collect::<Vec<f64>>();
            core::array::from_fn(|k| if k < 4 { numbers[k] } else { flags[k - 4] })
        };
        rows.iter().map(step).collect()
    }
}
