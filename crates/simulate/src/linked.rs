//! Two loaders of one period side by side, their columns or their feels joined by a link.
//!
//! Each loader by itself is of the fourth order in the step, a pair on a shaft of the second. The torque of an electronic link is worked out at each sample from both programmed controls, which follow no sensor's
//! noise, and held for a period.

use crate::batch::Job;
use crate::noise::Noise;
use forcefeel_model::drive::{Drive, Kind};
use forcefeel_model::link::{LINK_ROWS, Priority};
use forcefeel_model::linked_feels::{LinkTimes, LinkedFeel, LinkedFeels};
use forcefeel_model::machine::{Inputs, Machine, Memory, Shared, State, StepStart};
use forcefeel_model::shaft::Shaft;
use forcefeel_model::transducers::SENSORS;
use forcefeel_solve::outputs::Output;

/// What joins two loaders, and what happens to it.
#[derive(Debug, Clone, Copy)]
pub struct Joint {
    /// Values of the link, in the order of its table.
    pub values: [f64; LINK_ROWS],
    /// Periods of delay of an electronic link; none for a mechanical one.
    pub delay: Option<usize>,
    /// Whether it stays open once it has given way.
    pub uncouples: bool,
    /// Step at which it is opened.
    pub disconnect: Option<usize>,
    /// Which column jams, the first or the second, and at which step.
    pub jam: Option<(usize, usize)>,
    /// Which pilot presses the priority button, and from which step on.
    pub button: Option<(usize, usize)>,
    /// Whether [`SAMPLED`] numbers follow the outputs of the joint.
    pub samples: bool,
}

/// What the laws and an electronic link were given and gave at the last sample: of each side the sensors and the command; the force of each
/// hand; 1 where the link is open.
pub const SAMPLED: usize = 2 * (SENSORS + 1) + 3;

/// What there is of a pair at a sample, beside the outputs of each: torque of the link on each column or feel in N m, force of each hand in N, 1
/// where the link has given way or is open; the pilot with priority, 1 or 2, else 0; 1 where both put in; and the angle that is commanded: of the
/// pilot with priority, else the mean.
pub const JOINT_OUTPUTS: [(&str, &str); 8] = [
    ("first_link_torque", "N m"),
    ("second_link_torque", "N m"),
    ("first_hand_force", "N"),
    ("second_hand_force", "N"),
    ("link_gives_way", ""),
    ("priority", ""),
    ("dual_input", ""),
    ("commanded_angle", "rad"),
];

/// A loader of a pair, whatever its drive.
pub trait Side {
    /// Angle of the column.
    fn angle(&self) -> f64;
    /// Angle and rate of the programmed control.
    fn programmed(&self) -> [f64; 2];
    /// Arm of the grip.
    fn grip_arm(&self) -> f64;
    /// How long its feel takes to come and to go.
    fn fade_time(&self) -> f64;
    /// Begins a step, under a torque on the column, or under a force at the grip in N and a damping on the feel.
    fn begin(&mut self, step: usize, on_column: f64, on_feel: [f64; 2]);
    /// Takes the step that has begun, the torque on the column ending so: angle and rate of the column. May be taken again.
    fn advance(&mut self, torque: f64) -> [f64; 2];
    /// The step is done: a hand may let go.
    fn done(&mut self, step: usize);
    /// Force of the hand on the grip at the start of the step that has begun.
    fn hand_force(&self) -> f64;
    /// Adds the outputs at the start of the step that has begun.
    fn outputs(&self, to: &mut Vec<f64>);
    /// Adds sensors and command of the last sample, under a digital controller.
    fn sampled(&self, to: &mut Vec<f64>);
    /// The column jams after the step that has begun.
    fn jam(&mut self);
}

struct Loader<'a, D: Drive<f64>> {
    job: &'a Job<'a>,
    run: usize,
    shared: Shared,
    machine: Machine<f64, D>,
    state: State<f64, D>,
    memory: Memory<f64>,
    held_until: usize,
    noise: Noise,
    step: Option<Step<D>>,
    grip_arm: f64,
    fade_time: f64,
    /// Sensors and command of the last sample.
    sampled: [f64; SENSORS + 1],
}

/// A step that has begun.
struct Step<D: Drive<f64>> {
    inputs: Inputs,
    start: StepStart<f64, D>,
    before: State<f64, D>,
}

/// The loader of a run of a job as a side of a pair; a jam of its column may come.
pub fn side<'a, K: Kind>(job: &'a Job<'a>, run: usize) -> Box<dyn Side + 'a>
where
    K::Of<f64>: 'a,
{
    let (parameters, machine) = job.machines::<f64, K>(|of| of(run));
    let shared = job.shared.clone();
    let beginning = job.beginning::<K>(run);
    let equilibrium = &beginning.equilibrium;
    let (mut state, memory) = (machine.start(&shared, equilibrium), machine.remember(&shared, equilibrium));
    Machine::<f64, K::Of<f64>>::hold(&mut state, equilibrium);
    if beginning.held_until == 0 {
        Machine::<f64, K::Of<f64>>::let_go(&mut state);
    }
    let (seed, stream) = job.noise;
    let noise = Noise::new(seed, &[stream.unwrap_or(0)], shared.effects.grip_sensor);
    Box::new(Loader {
        job,
        run,
        shared,
        machine,
        state,
        memory,
        held_until: beginning.held_until,
        noise,
        step: None,
        grip_arm: parameters.column.grip_arm,
        fade_time: parameters.safety.fade_time,
        sampled: [0.0; SENSORS + 1],
    })
}

impl<D: Drive<f64>> Side for Loader<'_, D> {
    fn angle(&self) -> f64 {
        self.machine.column_angle(&self.state)
    }

    fn programmed(&self) -> [f64; 2] {
        self.machine.programmed_motion(&self.state)
    }

    fn grip_arm(&self) -> f64 {
        self.grip_arm
    }

    fn fade_time(&self) -> f64 {
        self.fade_time
    }

    fn begin(&mut self, step: usize, on_column: f64, [force, damping]: [f64; 2]) {
        let given = self.job.inputs;
        let inputs = given.get(step).copied().unwrap_or_else(|| given[given.len() - 1].end());
        let mut inputs = self.job.in_flight(self.run, step, &inputs, self.programmed()[0]);
        inputs.link_torque = [on_column; 2];
        inputs.added_force = inputs.added_force.map(|other| other + force);
        inputs.added_damping = inputs.added_damping.map(|other| other + damping);
        let (noise, mut normal) = (&mut self.noise, [0.0; SENSORS]);
        let start =
            self.machine.begin_compiled_once(&self.shared, &mut self.state, &mut self.memory, &inputs, &mut || {
                normal = noise.next::<f64>(());
                normal
            });
        if let Some(sample) = self.shared.timing.and_then(|timing| timing.sample_at(step)) {
            let sensors = self.machine.sampled(&self.shared, &self.state, &mut || normal);
            let command = self.machine.control().within_range(self.memory.command(sample));
            self.sampled = [0, 1, 2, 3, 4].map(|k| sensors.get(k).copied().unwrap_or(command));
        }
        self.step = Some(Step { inputs, start, before: self.state });
    }

    fn advance(&mut self, torque: f64) -> [f64; 2] {
        let Some(Step { inputs, start, before }) = &mut self.step else { return [self.angle(), 0.0] };
        inputs.link_torque[1] = torque;
        self.state = *before;
        self.machine.advance_compiled_once(&self.shared, &mut self.state, inputs, start);
        self.machine.column_motion(&self.shared, &self.state, start)
    }

    fn done(&mut self, step: usize) {
        if step + 1 == self.held_until {
            Machine::<f64, D>::let_go(&mut self.state);
        }
    }

    fn hand_force(&self) -> f64 {
        self.step.as_ref().map_or(0.0, |step| self.machine.hand_force(&step.start.now))
    }

    fn outputs(&self, to: &mut Vec<f64>) {
        let Some(Step { start, .. }) = &self.step else { return };
        let per_base = self.machine.per_base();
        to.extend(self.job.outputs.iter().map(|&output| Output::at(output).of(&start.now, per_base)));
    }

    fn sampled(&self, to: &mut Vec<f64>) {
        to.extend(self.sampled);
    }

    fn jam(&mut self) {
        if let Some(Step { start, .. }) = &self.step {
            self.machine.jam(start);
        }
    }
}

/// Runs a pair through `steps` steps, a sample every so many: adds sample by sample the outputs of the first, of the second and of the joint
/// to `rows`.
pub fn run_pair(
    mut sides: [Box<dyn Side + '_>; 2],
    joint: &Joint,
    job: &Job<'_>,
    (steps, every): (usize, usize),
    rows: &mut Vec<f64>,
) {
    let mut electronic =
        joint.delay.map(|delay| LinkedFeels::new(&joint.values, |value| value, delay, joint.uncouples));
    let times = LinkTimes::new(job.shared.period_s(), sides[0].fade_time());
    let (priority, mut holder) = (Priority::from_values(&joint.values), None);
    let angles = [sides[0].angle(), sides[1].angle()];
    let mut shaft = joint.delay.is_none().then(|| Shaft::new(&joint.values, joint.uncouples, angles));
    let mut open = false;
    let (mut on_feel, mut torques, mut sampled_hands) = ([[0.0; 2]; 2], [0.0; 2], [0.0; 2]);
    let mut gives_way = false;
    for step in 0..=steps {
        open = open || joint.disconnect.is_some_and(|disconnect| step >= disconnect);
        let sampled = job.shared.timing.and_then(|timing| timing.sample_at(step));
        if let (Some(electronic), Some(_)) = (&mut electronic, sampled) {
            // As of the step before: a controller has no newer force.
            sampled_hands = [sides[0].hand_force(), sides[1].hand_force()];
            let feels = [0, 1].map(|side: usize| LinkedFeel {
                programmed: sides[side].programmed(),
                share: 1.0,
                hand_force: sampled_hands[side],
                presses: joint.button.is_some_and(|(by, from)| by == side && step >= from),
                opens: open,
                closes: false,
            });
            let given = electronic.sampled(&times, &feels);
            on_feel = [0, 1].map(|side: usize| [given.torques[side] / sides[side].grip_arm(), given.damping[side]]);
            (torques, open, gives_way) = (given.torques, electronic.open, given.gives_way);
            holder = given.priority.iter().position(|&has| has);
        }
        let on_columns = shaft.as_mut().map_or([0.0; 2], |shaft| {
            shaft.open = open;
            gives_way = shaft.gives_way();
            shaft.on_each()
        });
        for (side, (on_column, on_feel)) in sides.iter_mut().zip(on_columns.into_iter().zip(on_feel)) {
            side.begin(step, on_column, on_feel);
        }
        if step % every == 0 {
            for side in &sides {
                side.outputs(rows);
            }
            let hands = [0, 1].map(|side: usize| sides[side].hand_force());
            let angles = [0, 1].map(|side: usize| sides[side].angle());
            rows.extend([torques[0] + on_columns[0], torques[1] + on_columns[1]]);
            rows.extend(hands);
            rows.push(f64::from(u8::from(open || gives_way)));
            rows.push(holder.map_or(0.0, |side| if side == 0 { 1.0 } else { 2.0 }));
            rows.push(f64::from(u8::from(priority.dual_input(hands))));
            rows.push(holder.map_or(f64::midpoint(angles[0], angles[1]), |side| angles[side]));
            if joint.samples {
                for side in &sides {
                    side.sampled(rows);
                }
                rows.extend(sampled_hands);
                rows.push(f64::from(u8::from(open)));
            }
        }
        let [first, second] = &mut sides;
        if let Some(shaft) = &mut shaft {
            shaft.step(job.shared.step_s, |on_each| [first.advance(on_each[0]), second.advance(on_each[1])]);
            open = shaft.open;
        } else {
            first.advance(0.0);
            second.advance(0.0);
        }
        for side in &mut sides {
            side.done(step);
        }
        if let Some((side, _)) = joint.jam.filter(|&(_, jam)| jam == step + 1) {
            sides[side].jam();
        }
    }
}
