//! Many runs: groups of sixteen, side by side in vector lanes.
//!
//! A run's numbers depend on its own parameters, its seed and its index alone, never on its neighbors or on the number of
//! threads. A last group that is not full is filled up with copies of its last run.

use crate::measures::{MEASURES, Peaks, Samples, measure};
use crate::noise::Noise;
use crate::run::{FeelChange, Middles, Record, run};
use fearless_simd::{Level, Simd};
use forcefeel_model::Scalar;
use forcefeel_model::drive::{Drive, Kind};
use forcefeel_model::machine::{Inputs, Machine, Shared, Snapshot, State};
use forcefeel_model::observer::{NUMBERS, Observer};
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::surface::FlightState;
use forcefeel_solve::lanes::{FOUR_LANES, FourLanes, LANES, Lanes};
use forcefeel_solve::law::Law;
use forcefeel_solve::outputs::Output;
use forcefeel_solve::rest::{angle_at_rest, is_pulled};
use forcefeel_solve::return_on_vectors;
use forcefeel_solve::start::{Beginning, Start};
use forcefeel_solve::wide::Wide;

/// Runs of a group at most.
pub const WIDTH: usize = 2 * LANES;

/// The measures of one run, in the order of [`MEASURES`].
pub type Values = [f64; MEASURES.len()];

/// A change of the feel for all runs: the values of [`Feel`](forcefeel_model::parameters::Feel) among `values` count.
#[derive(Debug, Clone, Copy)]
pub struct Change {
    /// Step at which it begins, and step at which it is done.
    pub steps: (usize, usize),
    /// Values of the parameter table that hold afterwards.
    pub values: [f64; COUNT],
    /// The law with an observer that holds afterwards; the one of before if there is none.
    pub observer: Option<[f64; NUMBERS]>,
}

/// When samples of the outputs are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Every so many steps.
    Every(usize),
    /// At the start and in the middle of each step.
    Halves,
}

/// What is to be run.
#[derive(Debug, Clone)]
pub struct Job<'a> {
    /// What all runs share.
    pub shared: Shared,
    /// Where each begins.
    pub start: Start,
    /// Inputs of every step.
    pub inputs: &'a [Inputs],
    /// The flight at the start and at the end of every step, in which each run has its surface's hinge moment; empty without one.
    pub flights: &'a [[FlightState; 2]],
    /// Parameters of each run, in the order of the table.
    pub values: &'a [[f64; COUNT]],
    /// Laws.
    pub law: Law<'a>,
    /// Factor on the pilot's force for each run; none is one for all.
    pub force_scale: Option<&'a [f64]>,
    /// Changes of the feel, in order.
    pub changes: &'a [Change],
    /// Seed of the noise, and index of the first run; none gives all of them the noise of run 0.
    pub noise: (u64, Option<u64>),
    /// What the sensors' noise moves a column by, r.m.s. in rad: no swing that small is measured.
    pub angle_noise: f64,
    /// When to take samples.
    pub sampling: Sampling,
    /// Which of the [`outputs`](forcefeel_solve::outputs::outputs) to keep.
    pub outputs: &'a [usize],
}

impl Job<'_> {
    /// Samples of a run.
    pub fn samples(&self) -> usize {
        match self.sampling {
            Sampling::Every(steps) => self.inputs.len() / steps + 1,
            Sampling::Halves => 2 * self.inputs.len() + 1,
        }
    }

    /// The group of runs from `first` on, on the widest instructions that the machine has; a run alone needs none. `measures` has room for each,
    /// and so has `histories`, if any outputs are to be kept.
    pub fn group_on_vectors<K: Kind>(
        &self,
        level: Level,
        first: usize,
        measures: &mut [Values],
        histories: &mut [f64],
    ) {
        // A flight asks for the angle of each.
        if self.values.len() > 1 && self.flights.is_empty() {
            return_on_vectors!(
                level,
                simd => self.vectorized::<_, crate::pair::Pair<Lanes<_>>, K>(simd, first, measures, histories),
                simd => self.in_fours::<_, K>(simd, first, measures, histories)
            );
        }
        let size = self.outputs.len() * self.samples();
        for (k, measures) in measures.iter_mut().enumerate() {
            let histories = &mut histories[k * size..(k + 1) * size];
            self.group::<f64, K>((), first + k, core::slice::from_mut(measures), histories);
        }
    }

    /// Four by four, where eight would take several registers for a number: a step's instructions and numbers stay in the nearest caches.
    fn in_fours<S: Simd, K: Kind>(&self, simd: S, first: usize, measures: &mut [Values], histories: &mut [f64]) {
        let size = self.outputs.len() * self.samples();
        for (part, measures) in measures.chunks_mut(FOUR_LANES).enumerate() {
            let from = part * FOUR_LANES;
            let histories = &mut histories[from * size..(from + measures.len()) * size];
            self.vectorized::<_, FourLanes<S>, K>(simd, first + from, measures, histories);
        }
    }

    #[inline(always)]
    fn vectorized<S: Simd, T: Wide<Token = S>, K: Kind>(
        &self,
        simd: S,
        first: usize,
        measures: &mut [Values],
        histories: &mut [f64],
    ) {
        simd.vectorize(
            #[inline(always)]
            || self.group::<T, K>(simd, first, measures, histories),
        );
    }

    /// The loaders of a group of runs, and their parameters.
    #[inline(always)]
    pub(crate) fn machines<T: Scalar, K: Kind>(
        &self,
        wide: impl Fn(&dyn Fn(usize) -> f64) -> T + Copy,
    ) -> (Parameters<T>, Machine<T, K::Of<T>>) {
        let parameters = Parameters::from_values(&core::array::from_fn(|k| wide(&|run| self.values[run][k])));
        let mut machine = Machine::new(&parameters, self.law.compensator(&parameters, wide), &self.shared);
        if let Some(observer) = self.law.observer(wide) {
            machine = machine.with_observer(observer);
        }
        if let Some(scale) = self.force_scale {
            machine = machine.with_force_scale(wide(&|run| scale[run]));
        }
        (parameters, machine)
    }

    /// The inputs of a step of a run, in the flight if there is one, with its programmed control at an angle.
    pub fn in_flight(&self, run: usize, step: usize, inputs: &Inputs, angle: f64) -> Inputs {
        let Some(&[_, last]) = self.flights.last() else { return *inputs };
        let flight = self.flights.get(step).copied().unwrap_or([last; 2]);
        Parameters::from_values(&self.values[run]).in_flight(inputs, &flight, angle)
    }

    /// Where a run begins, found for it alone: a search in lanes would be compiled for each of the vector instructions.
    pub(crate) fn beginning<K: Kind>(&self, run: usize) -> Beginning<f64> {
        self.start.of(&self.machines::<f64, K>(|of| of(run)).1, &self.shared, self.inputs)
    }

    /// The angle at which the last inputs hold the column of a run, dry friction aside; `mean` is near it where the run has settled.
    fn angle_at_rest<K: Kind>(&self, run: usize, beginning: &Beginning<f64>, mean: f64) -> f64 {
        let (steps, last) = (self.inputs.len(), self.inputs.last().unwrap_or(&Inputs::NONE));
        match self.start {
            Start::Held(angle, until) if until >= steps => return angle,
            _ => {}
        }
        let moved = !self.flights.is_empty()
            || [last.shaker, last.added_force, last.added_stiffness, last.test_signal, last.command_signal]
                .iter()
                .any(|it| it[1] != 0.0);
        let changing = self.changes.iter().any(|change| change.steps.0 < steps && steps < change.steps.1);
        if moved || changing {
            return f64::NAN;
        }
        if !is_pulled(&self.shared, last.force[1], last.trim[1]) {
            return 0.0;
        }
        let (parameters, mut machine) = self.machines::<f64, K>(|of| of(run));
        let mut state = machine.start(&self.shared, &beginning.equilibrium);
        for change in self.changes.iter().filter(|change| change.steps.1 <= steps) {
            let change = change.of(&parameters);
            machine.fade_to(&change.parameters, change.observer.as_ref());
            machine.faded(&self.shared, &mut state);
        }
        angle_at_rest(&machine, &self.shared, last, &beginning.equilibrium, mean)
    }

    #[inline(always)]
    fn group<T: Wide, K: Kind>(&self, token: T::Token, first: usize, measures: &mut [Values], histories: &mut [f64]) {
        let member = |lane: usize| (first + lane).min(self.values.len() - 1);
        let wide = |of: &dyn Fn(usize) -> f64| T::gather(token, |lane| of(member(lane)));
        let (parameters, mut machine) = self.machines::<T, K>(wide);
        let changes: Vec<FeelChange<T>> = self.changes.iter().map(|change| change.of(&parameters)).collect();
        let (seed, first_run) = self.noise;
        let streams: Vec<u64> =
            first_run.map_or(vec![0], |first_run| (0..T::RUNS).map(|lane| first_run + member(lane) as u64).collect());
        let mut noise = Noise::new(seed, &streams, self.shared.effects.grip_sensor);
        let per_base = machine.per_base();
        let mut recorder = Recorder {
            job: self,
            per_base,
            per_delta: machine.per_delta(),
            peaks: Peaks::new(per_base).with_stops(&parameters),
            angles: Vec::with_capacity(self.samples()),
            kept: Vec::with_capacity(self.samples() * self.outputs.len()),
        };
        let runs = first..(first + T::RUNS).min(self.values.len());
        let beginnings: Vec<_> = runs.map(|run| self.beginning::<K>(run)).collect();
        let beginning = Beginning::gathered(token, &beginnings);
        let in_flight = |step: usize, inputs: &Inputs, machine: &Machine<_, K::Of<T>>, state: &State<_, K::Of<T>>| {
            let mut flown = None;
            if !self.flights.is_empty() {
                let [angle, _] = machine.programmed_motion(state);
                angle.scatter(|_, angle| flown = Some(self.in_flight(first, step, inputs, angle)));
            }
            flown
        };
        let around = (in_flight, || noise.next(token));
        run(&mut machine, &self.shared, &beginning, self.inputs, &changes, around, &mut recorder);
        recorder.write(histories);
        let Recorder { peaks, angles, .. } = recorder;
        let held = beginning.held_until;
        let (dt, free) = match self.sampling {
            Sampling::Every(steps) => (number(steps) * self.shared.step_s, held.div_ceil(steps)),
            Sampling::Halves => (0.5 * self.shared.step_s, 2 * held),
        };
        let samples = Samples { dt, free: free.min(angles.len() - 1), noise: self.angle_noise };
        let rest = |lane: usize, mean: f64| {
            let beginning = &beginnings[lane.min(beginnings.len() - 1)];
            self.angle_at_rest::<K>(member(lane), beginning, mean)
        };
        for (k, found) in measure(token, &angles, &samples, &peaks, rest).values().into_iter().enumerate() {
            found.scatter(|lane, value| {
                if let Some(run) = measures.get_mut(lane) {
                    run[k] = value;
                }
            });
        }
    }
}

/// Takes down what is asked of a group of runs.
struct Recorder<'a, T> {
    job: &'a Job<'a>,
    per_base: T,
    /// Programmed angle per programmed displacement.
    per_delta: T,
    peaks: Peaks<T>,
    angles: Vec<T>,
    /// Sample by sample the outputs that are kept.
    kept: Vec<T>,
}

impl<T: Wide, D: Drive<T>> Record<T, D> for Recorder<'_, T> {
    #[inline(always)]
    fn middles(&self) -> Middles {
        match self.job.sampling {
            Sampling::Every(_) => Middles::None,
            Sampling::Halves if self.job.outputs.iter().all(|&output| Output::at(output) == Output::ColumnAngle) => {
                Middles::Base
            }
            Sampling::Halves => Middles::All,
        }
    }

    #[inline(always)]
    fn see_base(&mut self, base: T) {
        let angle = base * self.per_base;
        self.angles.push(angle);
        for _ in self.job.outputs {
            self.kept.push(angle);
        }
    }

    #[inline(always)]
    fn see(&mut self, instant: usize, now: &Snapshot<T, D>) {
        let angle = now.base * self.per_base;
        let (share, every) = match self.job.sampling {
            Sampling::Every(steps) => (1.0, steps),
            Sampling::Halves => (0.5, 1),
        };
        let time = number(instant) * share * self.job.shared.step_s;
        // The middles give no peaks, or these would depend on what is kept.
        if self.job.sampling != Sampling::Halves || instant.is_multiple_of(2) {
            let programmed = now.delta * self.per_delta;
            self.peaks.see(angle, programmed, D::PEAKS.map(|k| now.signals[k]), time);
        }
        if instant.is_multiple_of(every) {
            self.angles.push(angle);
            for &output in self.job.outputs {
                self.kept.push(Output::at(output).of(now, self.per_base));
            }
        }
    }
}

impl<T: Wide> Recorder<'_, T> {
    /// Writes run by run what was taken down sample by sample, a cache line at a time.
    fn write(&self, histories: &mut [f64]) {
        let (outputs, samples) = (self.job.outputs.len(), self.job.samples());
        let members = histories.len() / (outputs * samples).max(1);
        for row in 0..outputs {
            for block in (0..samples).step_by(CACHE_LINE) {
                for sample in block..samples.min(block + CACHE_LINE) {
                    self.kept[sample * outputs + row].scatter(|lane, value| {
                        if lane < members {
                            histories[(lane * outputs + row) * samples + sample] = value;
                        }
                    });
                }
            }
        }
    }
}

/// Numbers in a cache line.
const CACHE_LINE: usize = 8;

impl Change {
    /// The same for a run with these parameters.
    #[inline(always)]
    pub fn of<S: Scalar>(&self, parameters: &Parameters<S>) -> FeelChange<S> {
        let like = parameters.column.inertia;
        let changed = Parameters::from_values(&self.values.map(|value| like.constant(value)));
        FeelChange {
            steps: self.steps,
            parameters: Parameters { feel: changed.feel, ..*parameters },
            observer: self.observer.map(|numbers| Observer::from_numbers(&numbers.map(|number| like.constant(number)))),
        }
    }
}

#[inline]
#[expect(clippy::cast_precision_loss, reason = "a number of steps, far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
