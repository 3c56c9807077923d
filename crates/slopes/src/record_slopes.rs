//! Records of a bench and their slopes: how a run's channels change with a parameter, exactly.
//!
//! Every run goes once for each parameter, on dual numbers along it; these pairs of run and parameter go over the threads. The equilibrium that
//! a run begins from moves with the parameters, too. Dry friction, orifice, stops and limits stay as they are: between two
//! switches a run is smooth.
//!
//! Noise and the steps of sensors and converters are left out: noise has no model, and a staircase no slope.
//!
//! No vector lanes: a step on eight dual numbers at once takes the compiler longer than all else together.

use crate::along;
use forcefeel_model::drive::{Drive, Kind};
use forcefeel_model::dual::Dual;
use forcefeel_model::effects::Effects;
use forcefeel_model::machine::{Inputs, Machine, Shared, Snapshot, State};
use forcefeel_model::parameters::{DriveKind, Parameters};
use forcefeel_model::transducers::SENSORS;
use forcefeel_model::with_drive;
use forcefeel_simulate::batch::{Job, Sampling};
use forcefeel_simulate::run::{FeelChange, Middles, Record, run};
use forcefeel_solve::smooth::without_steps;
use forcefeel_solve::threads::{NoThreads, each};

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
    /// Numbers of a run, or of the slopes of a pair: channel by channel, sample by sample.
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
        // The first pair of a run takes its channels down, too.
        let pairs = slopes.chunks_mut(self.size()).enumerate().map(|(pair, slopes)| {
            let values = if pair % keys == 0 { channels_of_run.next() } else { None };
            (pair, slopes, values.unwrap_or_default())
        });
        each(threads, pairs, |(pair, slopes, values)| self.pair(pair / keys, self.keys[pair % keys], slopes, values))?;
        Ok(channels)
    }

    /// The slopes of one run along one parameter, and its channels where there is room for them.
    fn pair(&self, run_index: usize, key: usize, slopes: &mut [f64], values: &mut [f64]) {
        with_drive!(DriveKind::of(&self.job.values[run_index]), K => self.pair_with::<K>(run_index, key, slopes, values));
    }

    fn pair_with<K: Kind>(&self, run_index: usize, key: usize, slopes: &mut [f64], values: &mut [f64]) {
        let job = &self.job;
        let wide = |of: &dyn Fn(usize) -> f64| Dual::constant(of(run_index));
        let parameters = without_steps(along(&job.values[run_index], Some(key)));
        let shared = Shared { effects: Effects { noise: false, ..job.shared.effects }, ..job.shared.clone() };
        let mut machine: Machine<Dual, K::Of<Dual>> =
            Machine::new(&parameters, job.law.compensator(&parameters, wide), &shared);
        if let Some(observer) = job.law.observer(wide) {
            machine = machine.with_observer(observer);
        }
        if let Some(scale) = job.force_scale {
            machine = machine.with_force_scale(wide(&|run| scale[run]));
        }
        let changes: Vec<FeelChange<Dual>> = job.changes.iter().map(|change| change.of(&parameters)).collect();
        let in_flight =
            |step: usize, inputs: &Inputs, machine: &Machine<_, K::Of<Dual>>, state: &State<_, K::Of<Dual>>| {
                Some(job.in_flight(run_index, step, inputs, machine.programmed_motion(state)[0].value))
            };
        let around = (in_flight, || [Dual::constant(0.0); SENSORS]);
        let mut recorder = Recorder { job: self, parameters: &parameters, sample: 0, slopes, values };
        let beginning = job.start.of(&machine, &shared, job.inputs);
        run(&mut machine, &shared, &beginning, job.inputs, &changes, around, &mut recorder);
    }
}

/// Takes down the channels of a pair.
struct Recorder<'a> {
    job: &'a SlopeJob<'a>,
    parameters: &'a Parameters<Dual>,
    /// The next sample.
    sample: usize,
    slopes: &'a mut [f64],
    values: &'a mut [f64],
}

impl<D: Drive<Dual>> Record<Dual, D> for Recorder<'_> {
    fn middles(&self) -> Middles {
        if self.job.job.sampling == Sampling::Halves { Middles::All } else { Middles::None }
    }

    fn see_base(&mut self, _: Dual) {}

    fn see(&mut self, instant: usize, now: &Snapshot<Dual, D>) {
        let every = if let Sampling::Every(steps) = self.job.job.sampling { steps } else { 1 };
        if !instant.is_multiple_of(every) {
            return;
        }
        let (channels, samples) = (D::channels(now, self.parameters), self.job.job.samples());
        for (row, &channel) in self.job.channels.iter().enumerate() {
            let place = row * samples + self.sample;
            self.slopes[place] = channels[channel].slope;
            if let Some(value) = self.values.get_mut(place) {
                *value = channels[channel].value;
            }
        }
        self.sample += 1;
    }
}
