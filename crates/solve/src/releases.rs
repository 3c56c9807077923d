//! Releases of many linear loops: held at an angle, at rest, then let go, the pilot's arm staying at the grip.
//!
//! | letter | meaning |
//! |---|---|
//! | `A` | state matrix of eq. (17), with the arm |
//! | `C` | row that gives the column's angle |
//! | `m_a`, `d_a`, `k_a` | mass, damping and spring rate of the arm at the grip |
//! | `J`, `R_p` | column's inertia, lever arm of the grip |
//!
//! Nothing pushes after the release, so sixteen samples come from one state, exactly: `y_{k+i} = C Phi^i x_k`,
//! `x_{k+16} = Phi^16 x_k`, `Phi = exp(A h)`. The state at the start is the one at rest under the hand that holds the grip.

use crate::balance::balance;
use crate::lanes::{LANES, Lanes};
use crate::loops::{Loops, Matrix, STATES, state_matrix, values_of};
use crate::return_on_vectors;
use crate::stability::{Verdict, hurwitz, verdict};
use crate::threads::{NoThreads, each};
use crate::transition::{Transition, Vector, combined, dot, product, solve, transposed};
use crate::wide::Fused;
use fearless_simd::{Level, Simd};
use forcefeel_model::loader::{Compliant, System};

/// Samples that come from one state.
const BLOCK: usize = 2 * LANES;

/// A state this far below where it began is nothing: numbers near the smallest that there are cost a hundred times as much.
const NOTHING: f64 = 1e-150;

/// States `x_b` and `x_b'` of eq. (17).
const BASE: usize = 6;
const BASE_RATE: usize = 7;

/// Releases of loops, each with the arm of its own parameters.
#[derive(Debug, Clone, Copy)]
pub struct Releases<'a> {
    /// The loops.
    pub loops: Loops<'a>,
    /// Angle in rad at which the grip is held.
    pub angle: f64,
    /// Time between samples in s.
    pub step_s: f64,
    /// Samples of a run, the first at the moment of the release; none where the verdicts are all that is asked for.
    pub samples: usize,
}

impl Releases<'_> {
    /// Fills `angles`, run by run, with the column's angle, and tells of each loop whether it is stable. The angles of a loop that
    /// is not stable are not numbers. A loop's numbers depend on its own parameters alone.
    ///
    /// # Errors
    /// If the system gives no threads.
    ///
    /// # Panics
    /// If `angles` is not of that size.
    pub fn run(&self, threads: usize, mut angles: &mut [f64]) -> Result<Vec<Verdict>, NoThreads> {
        assert_eq!(angles.len(), self.samples * self.loops.count, "a number for each run and sample");
        let mut verdicts = vec![Verdict::Unknown; self.loops.count];
        let mut groups = Vec::with_capacity(self.loops.count.div_ceil(LANES));
        for (group, verdicts) in verdicts.chunks_mut(LANES).enumerate() {
            let (room, rest) = angles.split_at_mut(self.samples * verdicts.len());
            groups.push((group * LANES, verdicts, room));
            angles = rest;
        }
        let level = Level::new();
        each(threads, groups.into_iter(), |(first, verdicts, angles)| self.dispatch(level, first, verdicts, angles))?;
        Ok(verdicts)
    }

    fn dispatch(&self, level: Level, first: usize, verdicts: &mut [Verdict], angles: &mut [f64]) {
        return_on_vectors!(level, simd => self.vectorized(simd, first, verdicts, angles));
        for (k, verdict) in verdicts.iter_mut().enumerate() {
            let run = k * self.samples..(k + 1) * self.samples;
            self.group::<f64>((), first + k, core::slice::from_mut(verdict), &mut angles[run]);
        }
    }

    #[inline(always)]
    fn vectorized<S: Simd>(&self, simd: S, first: usize, verdicts: &mut [Verdict], angles: &mut [f64]) {
        simd.vectorize(
            #[inline(always)]
            || self.group::<Lanes<S>>(simd, first, verdicts, angles),
        );
    }

    #[inline(always)]
    fn group<T: Fused>(&self, token: T::Token, first: usize, verdicts: &mut [Verdict], angles: &mut [f64]) {
        let model = self.loops.models::<T>(token, first);
        let (mut a, mut b) = with_arm(&model);
        let balanced = balance(&mut a);
        let (stable, unstable) = hurwitz(&a);
        let one = values_of::<T>(token, 1.0);
        let zero = one.zero();
        let code = T::select(stable, one, T::select(unstable, zero, one.constant(f64::NAN)));
        code.scatter(|lane, code| {
            if let Some(place) = verdicts.get_mut(lane) {
                *place = self.settled(first + lane, code);
            }
        });
        if verdicts.iter().any(|&verdict| is_stable(verdict)) && self.samples > 0 {
            for j in 0..STATES {
                b[j] = b[j] / balanced[j];
            }
            let mut row = [zero; STATES];
            // theta = x_b / R_b                                                                           eq. (18)
            row[BASE] = model.parameters.column.angle(one) * balanced[BASE];
            let at_rest = solve(&a, &b);
            let factor = one.constant(self.angle) / dot(&row, &at_rest);
            let start = at_rest.map(
                #[inline(always)]
                |entry| entry * factor,
            );
            self.let_go(&Transition::new(&a, &[zero; STATES], self.step_s).phi, &row, start, angles);
        }
        for (lane, verdict) in verdicts.iter().enumerate() {
            if !is_stable(*verdict) {
                angles[lane * self.samples..(lane + 1) * self.samples].fill(f64::NAN);
            }
        }
    }

    /// The verdict of one loop from its code: one, zero, or neither.
    fn settled(&self, run: usize, code: f64) -> Verdict {
        if code.is_nan() {
            return verdict(&with_arm(&self.loops.models::<f64>((), run)).0);
        }
        if code > 0.5 { Verdict::Stable } else { Verdict::Unstable }
    }

    /// Writes the samples of the free response from `x` on.
    #[inline(always)]
    fn let_go<T: Fused>(&self, phi: &Matrix<T>, row: &Vector<T>, mut x: Vector<T>, angles: &mut [f64]) {
        let none = [row[0].zero(); STATES];
        let mut rows = [*row; STATES];
        for i in 1..STATES {
            rows[i] = combined(&rows[i - 1], phi, none);
        }
        let phi2 = product(phi, phi);
        let phi4 = product(&phi2, &phi2);
        let half = product(&phi4, &phi4);
        let ahead = [transposed(&rows), transposed(&product(&rows, &half))];
        let advance = transposed(&product(&half, &half));
        let least = size(&x).times(NOTHING);
        for sample in (0..self.samples).step_by(BLOCK) {
            self.keep(angles, sample, combined(&x, &ahead[0], none));
            self.keep(angles, sample + LANES, combined(&x, &ahead[1], none));
            x = combined(&x, &advance, none);
            let gone = size(&x).less(least);
            for entry in &mut x {
                *entry = T::select(gone, none[0], *entry);
            }
        }
    }

    /// Writes eight samples of each run, or as many as are left.
    #[inline(always)]
    fn keep<T: Fused>(&self, angles: &mut [f64], sample: usize, values: [T; LANES]) {
        let count = LANES.min(self.samples.saturating_sub(sample));
        T::by_run(
            values,
            #[inline(always)]
            |lane, values| {
                let at = lane * self.samples + sample;
                if let Some(place) = angles.get_mut(at..at + count) {
                    place.copy_from_slice(&values[..count]);
                }
            },
        );
    }
}

/// Whether all poles are left of the axis.
pub fn is_stable(verdict: Verdict) -> bool {
    matches!(verdict, Verdict::Stable | Verdict::StableByPoles)
}

/// The state matrix of eq. (17) and its column for the pilot's force, with the arm at the grip.
///
/// `(J + m_a R_p^2) theta'' = ... - d_a R_p^2 theta' - k_a R_p^2 theta`
#[inline(always)]
fn with_arm<T: Fused>(model: &Compliant<T>) -> (Matrix<T>, Vector<T>) {
    let (column, pilot) = (&model.parameters.column, &model.parameters.pilot);
    let zero = column.inertia.zero();
    let at_grip = column.grip_arm * column.grip_arm;
    let inertia = column.inertia + pilot.arm_mass * at_grip;
    let share = column.inertia / inertia;
    let mut a = state_matrix(model);
    let mut b = model.derivative(&[zero; STATES], &[zero.constant(1.0), zero]);
    for entry in &mut a[BASE_RATE] {
        *entry = *entry * share;
    }
    b[BASE_RATE] = b[BASE_RATE] * share;
    a[BASE_RATE][BASE] = a[BASE_RATE][BASE] - pilot.arm_stiffness * at_grip / inertia;
    a[BASE_RATE][BASE_RATE] = a[BASE_RATE][BASE_RATE] - pilot.arm_damping * at_grip / inertia;
    (a, b)
}

/// The sum of the magnitudes.
#[inline(always)]
fn size<T: Fused>(x: &Vector<T>) -> T {
    let mut sum = x[0].zero();
    for entry in x {
        sum = sum + entry.abs();
    }
    sum
}
