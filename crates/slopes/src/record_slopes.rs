//! Records of a bench and their slopes: how a run's channels change with a parameter, exactly.
//!
//! Every run goes once for some parameters, on dual numbers along each of them; these parts of a run go over the threads. The equilibrium
//! that a run begins from moves with the parameters, too. Dry friction, orifice, stops and limits stay as they are: between two
//! switches a run is smooth.
//!
//! Noise and the steps of sensors and converters are left out: noise has no model, and a staircase no slope.
//!
//! No vector lanes: a step on eight dual numbers at once takes the compiler longer than all else together. An array of slopes compiles as
//! fast as one slope, and the baseline vector instructions compute two of them at a time.

use crate::along_each;
use forcefeel_model::drive::{Drive, Kind};
use forcefeel_model::dual::{Along, Dual};
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Inputs, Machine, Shared, Snapshot, State};
use forcefeel_model::parameters::{DriveKind, Parameters};
use forcefeel_model::transducers::SENSORS;
use forcefeel_model::with_drive;
use forcefeel_simulate::batch::{Job, Sampling};
use forcefeel_simulate::run::{FeelChange, Middles, Record, run};
use forcefeel_solve::smooth::without_steps;
use forcefeel_solve::threads::{NoThreads, each};

/// Parameters per run: a fit of 11, a usual number, gives two runs, one for each of two cores.
const TOGETHER: usize = 6;

/// A number with its slopes along those parameters.
type Sloped = Dual<f64, Along<TOGETHER>>;

/// What is to be run, and what is wanted of it.
#[derive(Debug, Clone)]
pub struct SlopeJob<'a> {
    /// The runs; their outputs and their noise are of no account.
    pub job: Job<'a>,
    /// Places of the parameters in the table, one at least.
    pub keys: &'a [usize],
    /// Which of the [`CHANNELS`](forcefeel_model::channels::CHANNELS).
    pub channels: &'a [usize],
}

impl SlopeJob<'_> {
    /// Numbers of a run, or of its slopes along one parameter: channel by channel, sample by sample.
    fn size(&self) -> usize {
        self.channels.len() * self.job.samples()
    }

    /// Runs them all on so many threads. Fills `slopes` run by run, parameter by parameter, and returns the channels run by run.
    ///
    /// # Errors
    /// If the system gives no threads.
    ///
    /// # Panics
    /// If `slopes` has not the size of what is asked for.
    pub fn run(&self, threads: usize, slopes: &mut [f64]) -> Result<Vec<f64>, NoThreads> {
        let keys = self.keys.len();
        assert_eq!(slopes.len(), self.job.values.len() * keys * self.size(), "slopes");
        if slopes.is_empty() {
            return Ok(Vec::new());
        }
        let mut channels = vec![0.0; self.job.values.len() * self.size()];
        let mut channels_of_run = channels.chunks_mut(self.size());
        let parts = slopes.chunks_mut(keys * self.size()).enumerate().flat_map(|(run, slopes)| {
            // The first part of a run takes its channels down, too.
            let mut values = channels_of_run.next();
            let parts = slopes.chunks_mut(TOGETHER * self.size()).zip(self.keys.chunks(TOGETHER));
            parts.map(move |(slopes, keys)| (run, keys, slopes, values.take().unwrap_or_default()))
        });
        each(threads, parts, |(run, keys, slopes, values)| self.part(run, keys, slopes, values))?;
        Ok(channels)
    }

    /// The slopes of one run along some parameters, and its channels where there is room for them.
    fn part(&self, run_index: usize, keys: &[usize], slopes: &mut [f64], values: &mut [f64]) {
        with_drive!(DriveKind::of(&self.job.values[run_index]), K => self.part_with::<K>(run_index, keys, slopes, values));
    }

    fn part_with<K: Kind>(&self, run_index: usize, keys: &[usize], slopes: &mut [f64], values: &mut [f64]) {
        let job = &self.job;
        let constant = |value: f64| Sloped::along(value, |_| false);
        let wide = |of: &dyn Fn(usize) -> f64| constant(of(run_index));
        let parameters = without_steps(along_each(&job.values[run_index], keys));
        let shared = Shared { effects: Effects { noise: false, ..job.shared.effects }, ..job.shared.clone() };
        let mut machine: Machine<Sloped, K::Of<Sloped>> =
            Machine::new(&parameters, job.law.compensator(&parameters, wide), &shared);
        if let Some(observer) = job.law.observer(wide) {
            machine = machine.with_observer(observer);
        }
        if let Some(scale) = job.force_scale {
            machine = machine.with_force_scale(wide(&|run| scale[run]));
        }
        let changes: Vec<FeelChange<Sloped>> = job.changes.iter().map(|change| change.of(&parameters)).collect();
        let in_flight =
            |step: usize, inputs: &Inputs, machine: &Machine<_, K::Of<Sloped>>, state: &State<_, K::Of<Sloped>>| {
                Some(job.in_flight(run_index, step, inputs, machine.programmed_motion(state)[0].value))
            };
        let around = (in_flight, || [constant(0.0); SENSORS]);
        let mut recorder = Recorder { job: self, parameters: &parameters, sample: 0, slopes, values };
        let beginning = job.start.of(&machine, &shared, job.inputs);
        run(&mut machine, &shared, &beginning, job.inputs, &changes, around, &mut recorder);
    }
}

/// Takes down the channels of a part of a run.
struct Recorder<'a> {
    job: &'a SlopeJob<'a>,
    parameters: &'a Parameters<Sloped>,
    /// The next sample.
    sample: usize,
    slopes: &'a mut [f64],
    values: &'a mut [f64],
}

impl<D: Drive<Sloped>> Record<Sloped, D> for Recorder<'_> {
    fn middles(&self) -> Middles {
        if self.job.job.sampling == Sampling::Halves { Middles::All } else { Middles::None }
    }

    fn see_base(&mut self, _: Sloped) {}

    fn see(&mut self, instant: usize, now: &Snapshot<Sloped, D>) {
        let every = if let Sampling::Every(steps) = self.job.job.sampling { steps } else { 1 };
        if !instant.is_multiple_of(every) {
            return;
        }
        let (channels, samples) = (D::channels(now, self.parameters), self.job.job.samples());
        for (row, &channel) in self.job.channels.iter().enumerate() {
            let place = row * samples + self.sample;
            let Dual { value, slope: Along(slopes) } = channels[channel];
            for (of_key, slope) in self.slopes.chunks_mut(self.job.size()).zip(slopes) {
                of_key[place] = slope;
            }
            if let Some(kept) = self.values.get_mut(place) {
                *kept = value;
            }
        }
        self.sample += 1;
    }
}
