//! Linear runs of many loops: exact at every sample, a run in each lane.
//!
//! `x_{k+1} = Phi x_k + Gamma u_k + R (u'_k - u_k)`, `y_k = C x_k + D u_k`, where the pilot's force runs straight from `u_k` to `u'_k`
//! within step `k` ([`transition`](crate::transition)). While the force stands still, sixteen samples come from one state:
//!
//! `y_{k+i} = C Phi^i x_k + (D + C (1 + ... + Phi^{i-1}) Gamma) u`, `x_{k+16} = Phi^16 x_k + (1 + ... + Phi^15) Gamma u`
//!
//! which takes nine products a sample and output instead of the seventy-two of a step, none of which waits for another.

use crate::balance::balance;
use crate::lanes::{LANES, Lanes};
use crate::loops::{Loops, Matrix, STATES, state_matrix, values_of};
use crate::outputs::Output;
use crate::return_on_vectors;
use crate::start::Start;
use crate::threads::{NoThreads, each};
use crate::transition::{Transition, Vector, combined, dot, plus_times, product, solve, times_vector, transposed};
use crate::wide::Fused;
use fearless_simd::{Level, Simd};
use forcefeel_model::loader::{Compliant, System};

/// Samples that come from one state.
const BLOCK: usize = 2 * LANES;
const _: () = assert!(LANES == STATES, "eight samples are combined as the eight states are");

/// What is to be run.
#[derive(Debug, Clone)]
pub struct LinearJob<'a> {
    /// The loops.
    pub loops: Loops<'a>,
    /// Factor on the pilot's force for each; none is one for all.
    pub force_scale: Option<&'a [f64]>,
    /// Pilot's force at the start and at the end of each step, in N.
    pub force: &'a [[f64; 2]],
    /// Length of a step in s.
    pub step_s: f64,
    /// Where each begins.
    pub start: Start,
    /// A sample every so many steps.
    pub every: usize,
    /// Which of the [`OUTPUTS`](crate::outputs::OUTPUTS) to keep.
    pub outputs: &'a [usize],
}

/// How an output depends on state and force.
#[derive(Debug, Clone, Copy)]
struct Row<T> {
    row: Vector<T>,
    direct: T,
}

/// Eight samples of an output, ahead of a state: what each entry of the state and the force give to them.
struct Ahead<T> {
    states: Matrix<T>,
    force: Vector<T>,
}

/// A step under a force that stands still: what each entry of the state and the force give to the next state.
struct Advance<T> {
    states: Matrix<T>,
    force: Vector<T>,
}

impl<T: Fused> Advance<T> {
    #[inline(always)]
    fn of(step: &Transition<T>) -> Self {
        Self { states: transposed(&step.phi), force: step.level }
    }
}

/// `sum force + x rows`: eight samples, or the next state.
#[inline(always)]
fn under<T: Fused>(force: T, per_force: &Vector<T>, x: &Vector<T>, rows: &Matrix<T>) -> Vector<T> {
    combined(x, rows, plus_times([force.zero(); STATES], force, per_force))
}

impl LinearJob<'_> {
    /// Samples of a run.
    pub fn samples(&self) -> usize {
        self.force.len() / self.every + 1
    }

    /// Fills `histories`, run by run, output by output, sample by sample, on so many threads.
    ///
    /// # Errors
    /// If the system gives no threads.
    ///
    /// # Panics
    /// If `histories` is not of that size.
    pub fn run(&self, threads: usize, histories: &mut [f64]) -> Result<(), NoThreads> {
        let size = self.outputs.len() * self.samples();
        assert_eq!(histories.len(), size * self.loops.count, "a number for each run, output and sample");
        if histories.is_empty() {
            return Ok(());
        }
        let level = Level::new();
        let still = self.still();
        let groups = histories.chunks_mut(LANES * size).enumerate();
        each(threads, groups, |(group, histories)| self.dispatch(level, &still, group * LANES, histories))
    }

    /// For each sample but the last, how many samples the force stands still from there on.
    #[expect(clippy::float_cmp, reason = "a force that stands still is the same to the last bit")]
    fn still(&self) -> Vec<usize> {
        let held = |step: usize| matches!(self.start, Start::Held(_, until) if step < until);
        let mut still = vec![0; self.samples() - 1];
        let mut after = 0;
        for sample in (0..still.len()).rev() {
            let steps = sample * self.every..(sample + 1) * self.every;
            let force = self.force[steps.start][0];
            let same = |step: usize| self.force[step] == [force; 2] && held(step) == held(steps.start);
            let goes_on = after > 0 && self.force[steps.end][0] == force && held(steps.end) == held(steps.start);
            after = if !steps.clone().all(same) {
                0
            } else if goes_on {
                after + 1
            } else {
                1
            };
            still[sample] = after;
        }
        still
    }

    fn dispatch(&self, level: Level, still: &[usize], first: usize, histories: &mut [f64]) {
        return_on_vectors!(level, simd => self.vectorized(simd, still, first, histories));
        let size = self.outputs.len() * self.samples();
        for (k, history) in histories.chunks_mut(size).enumerate() {
            self.group::<f64>((), still, first + k, history);
        }
    }

    #[inline(always)]
    fn vectorized<S: Simd>(&self, simd: S, still: &[usize], first: usize, histories: &mut [f64]) {
        simd.vectorize(
            #[inline(always)]
            || self.group::<Lanes<S>>(simd, still, first, histories),
        );
    }

    #[inline(always)]
    fn group<T: Fused>(&self, token: T::Token, still: &[usize], first: usize, histories: &mut [f64]) {
        let last = self.loops.count - 1;
        let model = self.loops.models::<T>(token, first);
        let zero = values_of::<T>(token, 0.0);
        let scale = match self.force_scale {
            Some(scale) => T::gather(token, |lane| scale[(first + lane).min(last)]),
            None => zero.constant(1.0),
        };
        let mut a = state_matrix(&model);
        let balanced = balance(&mut a);
        let mut b = model.derivative(&[zero; STATES], &[scale, zero]);
        for j in 0..STATES {
            b[j] = b[j] / balanced[j];
        }
        let mut outputs = Vec::with_capacity(self.outputs.len());
        for &output in self.outputs {
            outputs.push(row_of(&model, Output::at(output), &balanced, scale));
        }
        let step = Transition::new(&a, &b, self.step_s);
        let (x, hand, until) = match self.start {
            Start::Under(0.0) => ([zero; STATES], zero, 0),
            Start::Under(force) => (scaled(&solve(&a, &b), zero.constant(-force)), zero, 0),
            Start::Held(held, until) => {
                let per_force = scaled(&solve(&a, &b), zero.constant(-1.0));
                let hand =
                    zero.constant(held) / dot(&row_of(&model, Output::ColumnAngle, &balanced, scale).row, &per_force);
                (scaled(&per_force, hand), hand, until)
            }
        };
        let run = Run { job: self, still, step, outputs, hand, until };
        run.go(x, histories);
    }
}

/// A group of runs under way.
struct Run<'a, T> {
    job: &'a LinearJob<'a>,
    still: &'a [usize],
    step: Transition<T>,
    outputs: Vec<Row<T>>,
    /// Force of the hand that holds the column, over the steps before `until`.
    hand: T,
    until: usize,
}

impl<T: Fused> Run<'_, T> {
    #[inline(always)]
    fn go(&self, mut x: Vector<T>, histories: &mut [f64]) {
        let (every, samples) = (self.job.every, self.job.samples());
        let (sample_step, block_step, ahead) = self.ahead();
        let fine_step = Advance::of(&self.step);
        let mut pending = vec![[self.hand; LANES]; self.outputs.len()];
        let mut sample = 0;
        while sample < samples - 1 {
            let at = sample * every;
            let force = self.force(at, self.job.force[at][0]);
            if self.still[sample] >= BLOCK {
                for (k, [first, second]) in ahead.iter().enumerate() {
                    self.keep(histories, k, sample, under(force, &first.force, &x, &first.states));
                    self.keep(histories, k, sample + LANES, under(force, &second.force, &x, &second.states));
                }
                x = under(force, &block_step.force, &x, &block_step.states);
                sample += BLOCK;
                continue;
            }
            if sample + LANES < samples {
                for i in 0..LANES {
                    let force = self.force((sample + i) * every, self.job.force[(sample + i) * every][0]);
                    for (output, pending) in self.outputs.iter().zip(&mut pending) {
                        pending[i] = output.direct.mul_add(force, dot(&output.row, &x));
                    }
                    x = self.next(sample + i, x, &fine_step, &sample_step);
                }
                for (k, &pending) in pending.iter().enumerate() {
                    self.keep(histories, k, sample, pending);
                }
                sample += LANES;
                continue;
            }
            self.see(histories, sample, &x, force);
            x = self.next(sample, x, &fine_step, &sample_step);
            sample += 1;
        }
        let end = self.job.force.len() - 1;
        self.see(histories, sample, &x, self.force(end, self.job.force[end][1]));
    }

    /// The state a sample later.
    #[inline(always)]
    fn next(&self, sample: usize, mut x: Vector<T>, fine: &Advance<T>, coarse: &Advance<T>) -> Vector<T> {
        let at = sample * self.job.every;
        if self.still[sample] > 0 {
            return under(self.force(at, self.job.force[at][0]), &coarse.force, &x, &coarse.states);
        }
        for step in at..at + self.job.every {
            let [now, then] = self.job.force[step];
            x = under(self.force(step, now), &fine.force, &x, &fine.states);
            x = plus_times(x, self.hand.constant(then - now), &self.step.ramp);
        }
        x
    }

    /// The force `force` at a step, with the hand's where it holds the column.
    #[inline(always)]
    fn force(&self, step: usize, force: f64) -> T {
        let force = self.hand.constant(force);
        if step < self.until { force + self.hand } else { force }
    }

    /// The step over a sample and over a block, and each output over both halves of a block.
    #[inline(always)]
    fn ahead(&self) -> (Advance<T>, Advance<T>, Vec<[Ahead<T>; 2]>) {
        let mut sample = self.step;
        for _ in 1..self.job.every {
            sample.level = times_vector(&self.step.phi, &sample.level, &self.step.level);
            sample.phi = product(&self.step.phi, &sample.phi);
        }
        let half = sample.doubled().doubled().doubled();
        let mut all = Vec::with_capacity(self.outputs.len());
        for output in &self.outputs {
            // Row i: of C Phi^i, and what a force of one gives to sample i.
            let (mut rows, mut force) = ([output.row; STATES], [output.direct; LANES]);
            for i in 1..LANES {
                force[i] = force[i - 1] + dot(&rows[i - 1], &sample.level);
                rows[i] = combined(&rows[i - 1], &sample.phi, [force[0].zero(); STATES]);
            }
            let later = times_vector(&rows, &half.level, &force);
            let first = Ahead { states: transposed(&rows), force };
            let second = Ahead { states: transposed(&product(&rows, &half.phi)), force: later };
            all.push([first, second]);
        }
        (Advance::of(&sample), Advance::of(&half.doubled()), all)
    }

    /// Writes eight samples of an output.
    #[inline(always)]
    fn keep(&self, histories: &mut [f64], output: usize, sample: usize, values: [T; LANES]) {
        let (outputs, samples) = (self.outputs.len(), self.job.samples());
        T::by_run(
            values,
            #[inline(always)]
            |lane, values| {
                let at = (lane * outputs + output) * samples + sample;
                if let Some(place) = histories.get_mut(at..at + LANES) {
                    place.copy_from_slice(values);
                }
            },
        );
    }

    /// Writes one sample of every output.
    #[inline(always)]
    fn see(&self, histories: &mut [f64], sample: usize, x: &Vector<T>, force: T) {
        let (outputs, samples) = (self.outputs.len(), self.job.samples());
        for (k, output) in self.outputs.iter().enumerate() {
            (dot(&output.row, x) + output.direct * force).scatter(
                #[inline(always)]
                |lane, value| {
                    if let Some(place) = histories.get_mut((lane * outputs + k) * samples + sample) {
                        *place = value;
                    }
                },
            );
        }
    }
}

/// `factor x`.
#[inline(always)]
fn scaled<T: Fused>(x: &Vector<T>, factor: T) -> Vector<T> {
    plus_times([factor.zero(); STATES], factor, x)
}

/// One of the outputs as a row on the balanced state, and its factor on the force.
#[inline(always)]
fn row_of<T: Fused>(model: &Compliant<T>, output: Output, balanced: &Vector<T>, scale: T) -> Row<T> {
    let zero = scale.zero();
    let one = scale.constant(1.0);
    let (mut row, mut x) = ([zero; STATES], [zero; STATES]);
    for j in 0..STATES {
        x[j] = one;
        row[j] = signal(model, output, &x, zero) * balanced[j];
        x[j] = zero;
    }
    Row { row, direct: signal(model, output, &x, scale) }
}

/// One of the outputs at the state `x` under `force`.
#[inline(always)]
fn signal<T: Fused>(model: &Compliant<T>, output: Output, x: &Vector<T>, force: T) -> T {
    let [theta, delta, x_p, force_c, _, current, flow] = model.outputs(x, &[force, force.zero()]);
    let &[_, pressure, _, _, _, delta_rate, _, base_rate] = x;
    match output {
        Output::ColumnAngle => theta,
        Output::ColumnVelocity => model.parameters.column.angle(base_rate),
        Output::FeelPosition => delta,
        Output::FeelVelocity => delta_rate,
        Output::DrivePosition => x_p,
        Output::LoadCellForce => force_c,
        Output::FirstSignal => pressure,
        Output::SecondSignal => flow,
        Output::ThirdSignal => current,
        Output::PilotForce => force,
        Output::FourthSignal => force.zero(),
    }
}
