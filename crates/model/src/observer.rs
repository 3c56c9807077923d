//! Sampled law with an observer, as data: what a digital controller runs in place of fixed gains.
//!
//! `xi` its state · `y = [F_c, x_p, theta, F_g]` what is sampled · `delta`, `delta'` the feel computer's displacement and rate ·
//! `e` command · `T` torque that the feel computer receives
//!
//! | | |
//! |---|---|
//! | `T = t [xi; y; delta; delta'] + t_n n` | torque; `n` the feel's neutral |
//! | `e = c [xi; y; delta; delta'] + c_n n` | command |
//! | `xi+ = A xi + B [y; e]` | state at the next sample, with `e` as the amplifier answers it |
//! | `xi = R [y; delta]` | state in the equilibrium of the loop that it closes, with `e` its own command |
//! | `xi = A xi + B [y; e]` | state where it only looks on, for long |
//!
//! Regulators, Kalman filters, feed-forward from the feel and disturbance estimates are all sets of numbers of this one law,
//! so the step need not know which it runs. Coordinates of `xi` are the law's own. What a law knows of the column's dry friction stands
//! in [`crate::known_friction`], and what it does against something stiff in [`crate::contact_law`].

pub use crate::law_vector::{Estimate, MOST_STATES, SAMPLED};

use crate::Scalar;
use crate::contact_law::{CONTACT_NUMBERS, ContactLaw, THRESHOLD_FROM_END};
use crate::known_friction::{FRICTION_NUMBERS, FrictionState, KnownFriction, LEVEL_FROM_END};
use crate::law_vector::{KNOWN, product, quotient};

/// Numbers of a law, in the order of [`Observer::from_numbers`].
pub const NUMBERS: usize =
    MOST_STATES * (MOST_STATES + 2 * (SAMPLED + 1)) + 2 * KNOWN + 2 + FRICTION_NUMBERS + CONTACT_NUMBERS;

/// Whether the law of these numbers knows of dry friction.
pub fn knows_friction(numbers: &[f64; NUMBERS]) -> bool {
    numbers[NUMBERS - CONTACT_NUMBERS - LEVEL_FROM_END] != 0.0
}

/// Whether the law of these numbers knows of contact.
pub fn knows_contact(numbers: &[f64; NUMBERS]) -> bool {
    numbers[NUMBERS - THRESHOLD_FROM_END] != 0.0
}

/// One law.
#[derive(Debug, Clone, Copy)]
pub struct Observer<S> {
    transition: [[S; MOST_STATES]; MOST_STATES],
    input: [[S; SAMPLED + 1]; MOST_STATES],
    /// Which of `[xi; y; e]` the next state depends on.
    matters: [bool; MOST_STATES + SAMPLED + 1],
    command: [S; KNOWN],
    torque: [S; KNOWN],
    settled: [[S; SAMPLED + 1]; MOST_STATES],
    neutral: [S; 2],
    /// The dry friction that it knows.
    pub friction: KnownFriction<S>,
    /// What it does in contact.
    pub contact: ContactLaw<S>,
}

/// What a law says at a sample.
#[derive(Debug, Clone, Copy)]
pub struct LawOutput<S> {
    /// Command `e` in V.
    pub command: S,
    /// Torque `T` in N m.
    pub torque: S,
    /// Friction that the observer's plant is told, in N m.
    pub friction: S,
    /// What the law recalls at the next sample.
    pub friction_state: FrictionState<S>,
}

impl<S: Scalar> Observer<S> {
    /// The law of these numbers: `A` and `B` row by row, `c`, `t`, `R` row by row, `c_n`, `t_n`, then those of the friction and of
    /// the contact; SI units.
    #[inline(always)]
    pub fn from_numbers(numbers: &[S; NUMBERS]) -> Self {
        let mut next = 0;
        let mut take = || {
            next += 1;
            numbers[next - 1]
        };
        let zero = numbers[0].zero();
        let mut law = Self::none(zero);
        for row in &mut law.transition {
            for entry in row {
                *entry = take();
            }
        }
        for row in &mut law.input {
            for entry in row {
                *entry = take();
            }
        }
        for entry in &mut law.command {
            *entry = take();
        }
        for entry in &mut law.torque {
            *entry = take();
        }
        for row in &mut law.settled {
            for entry in row {
                *entry = take();
            }
        }
        law.matters = core::array::from_fn(|k| {
            let of =
                |row: usize| if k < MOST_STATES { law.transition[row][k] } else { law.input[row][k - MOST_STATES] };
            (0..MOST_STATES).any(|row| S::any(zero.less(of(row).abs())))
        });
        law.neutral = [take(), take()];
        law.friction = KnownFriction::take(&mut take);
        law.contact = ContactLaw::take(take);
        law
    }

    /// A law that says nothing.
    #[inline(always)]
    pub fn none(like: S) -> Self {
        let zero = like.zero();
        Self {
            transition: [[zero; MOST_STATES]; MOST_STATES],
            input: [[zero; SAMPLED + 1]; MOST_STATES],
            matters: [false; MOST_STATES + SAMPLED + 1],
            command: [zero; KNOWN],
            torque: [zero; KNOWN],
            settled: [[zero; SAMPLED + 1]; MOST_STATES],
            neutral: [zero; 2],
            friction: KnownFriction::none(zero),
            contact: ContactLaw::none(zero),
        }
    }

    /// Command and torque at a sample, where friction is known and this is recalled, or where none is.
    #[inline(always)]
    pub fn output(
        &self,
        xi: &Estimate<S>,
        y: &[S; SAMPLED],
        feel: [S; 2],
        friction_state: Option<FrictionState<S>>,
    ) -> LawOutput<S> {
        S::section("observer");
        let command = product(&self.command, xi, y, feel).named("law_command");
        let estimated = product(&self.torque, xi, y, feel).named("estimated_torque");
        S::section("friction");
        let (friction_state, friction) = match friction_state {
            Some(friction_state) => self.friction.friction_torque(estimated, (xi, y, feel), friction_state),
            None => (FrictionState::initial(estimated), estimated.zero()),
        };
        LawOutput { command, torque: friction_state.feel_torque, friction, friction_state }
    }

    /// The state at the next sample, where the amplifier answers the command as `e` and the friction is known, or is not.
    #[expect(clippy::needless_range_loop, reason = "iterators are not sure to be compiled into the lanes' loop")]
    #[inline(always)]
    pub fn next(&self, xi: &Estimate<S>, y: &[S; SAMPLED], e: S, friction: Option<S>) -> Estimate<S> {
        let mut next = [e.zero(); MOST_STATES];
        // Column by column: the sums stay in registers, and what nothing depends on costs nothing.
        if self.matters[MOST_STATES + SAMPLED] {
            for row in 0..MOST_STATES {
                next[row] = next[row] + self.input[row][SAMPLED] * e;
            }
        }
        for k in 0..SAMPLED {
            if self.matters[MOST_STATES + k] {
                for row in 0..MOST_STATES {
                    next[row] = next[row] + self.input[row][k] * y[k];
                }
            }
        }
        for k in 0..MOST_STATES {
            if self.matters[k] {
                for row in 0..MOST_STATES {
                    next[row] = next[row] + self.transition[row][k] * xi[k];
                }
            }
        }
        if let Some(friction) = friction {
            for row in 0..MOST_STATES {
                next[row] = next[row] + self.friction.moves(row, friction);
            }
        }
        next
    }

    /// The state where sensors and command have been the same for long: `(1 - A) xi = B [y; e]`.
    ///
    /// [`at_rest`](Self::at_rest) is no such state. It asks which command the law itself would settle at, and a law that integrates what the sensors are
    /// apart settles, where they and the feel are apart by their noise, at thousands of volts.
    #[expect(clippy::needless_range_loop, reason = "rows and columns by their numbers, as in the equation")]
    pub fn initial_estimate(&self, y: &[S; SAMPLED], e: S) -> Estimate<S> {
        let (zero, one) = (e.zero(), e.constant(1.0));
        let mut rows = self.transition;
        let mut right = self.next(&[zero; MOST_STATES], y, e, None);
        for k in 0..MOST_STATES {
            for j in 0..MOST_STATES {
                rows[k][j] = if k == j { one - rows[k][j] } else { -rows[k][j] };
            }
        }
        // Gauss: the largest of each column comes to the diagonal.
        for k in 0..MOST_STATES {
            for below in k + 1..MOST_STATES {
                if S::any(rows[k][k].abs().less(rows[below][k].abs())) {
                    rows.swap(k, below);
                    right.swap(k, below);
                }
                let share = quotient(rows[below][k], rows[k][k]);
                for j in k..MOST_STATES {
                    rows[below][j] = rows[below][j] - share * rows[k][j];
                }
                right[below] = right[below] - share * right[k];
            }
        }
        for k in (0..MOST_STATES).rev() {
            for j in k + 1..MOST_STATES {
                right[k] = right[k] - rows[k][j] * right[j];
            }
            right[k] = quotient(right[k], rows[k][k]);
        }
        right
    }

    /// The state in the equilibrium of the loop that it closes.
    #[inline(always)]
    pub fn at_rest(&self, y: &[S; SAMPLED], delta: S) -> Estimate<S> {
        let mut xi = [delta.zero(); MOST_STATES];
        for (entry, r) in xi.iter_mut().zip(&self.settled) {
            *entry = r[0] * y[0] + r[1] * y[1] + r[2] * y[2] + r[3] * y[3] + r[SAMPLED] * delta;
        }
        xi
    }

    /// Torque at rest per newton of the load cell, per meter of the piston, per radian of the column, per newton at the grip and per
    /// radian of the feel.
    #[inline(always)]
    pub fn torque_at_rest(&self) -> [S; SAMPLED + 1] {
        let t = &self.torque;
        let mut per = core::array::from_fn(|k| t[MOST_STATES + k]);
        for (entry, r) in t.iter().zip(&self.settled) {
            for (sum, r) in per.iter_mut().zip(r) {
                *sum = *sum + *entry * *r;
            }
        }
        per
    }

    /// Command and torque per radian of the feel's neutral.
    #[inline(always)]
    pub fn per_neutral(&self) -> [S; 2] {
        self.neutral
    }

    /// Displacement at which a feel whose neutral is at zero asks for the same command.
    #[inline(always)]
    pub fn untrimmed(&self, delta: S, neutral: S) -> S {
        delta + quotient(self.neutral[0], self.per_delta()) * neutral
    }

    /// Torque in equilibrium by the feel's displacement and neutral alone.
    #[inline(always)]
    pub fn feel_torque_at_rest(&self, delta: S, neutral: S) -> S {
        let (direct, [.., whole]) = (self.torque[MOST_STATES + SAMPLED], self.torque_at_rest());
        direct * delta + (whole - direct) * self.untrimmed(delta, neutral) + self.neutral[1] * neutral
    }

    /// Command per radian of the feel.
    #[inline(always)]
    pub fn per_delta(&self) -> S {
        self.command[MOST_STATES + SAMPLED]
    }

    /// Command per rate of the feel.
    #[inline(always)]
    pub fn per_rate(&self) -> S {
        self.command[MOST_STATES + SAMPLED + 1]
    }
}

impl<S: Scalar> LawOutput<S> {
    /// Of a law of gains alone.
    #[inline(always)]
    pub fn of_gains(command: S, torque: S) -> Self {
        Self { command, torque, friction: torque.zero(), friction_state: FrictionState::initial(torque) }
    }

    /// Between what two laws say: what a law says whose numbers are between theirs.
    #[inline(always)]
    pub fn lerp(self, next: Self, share: f64) -> Self {
        Self {
            command: self.command + (next.command - self.command).times(share),
            torque: self.torque + (next.torque - self.torque).times(share),
            friction: self.friction + (next.friction - self.friction).times(share),
            friction_state: self.friction_state.lerp(next.friction_state, share),
        }
    }
}
