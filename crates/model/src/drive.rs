//! A drive: what moves the end of the linkage, and what a loader in time asks of it.
//!
//! | drive | file |
//! |---|---|
//! | servo valve and piston | [`hydraulic`] |
//! | motor, current loop and transmission | [`electric`] |
//!
//! A drive carries three numbers through a step, its share of `plant`; the other two are the column's: displacement of the base, and
//! its velocity with what the drive's own quick part takes of it given back (`w`). What a drive does to the link follows from these
//! numbers without a time derivative: its *balance*. *Effort* is what it does so with in equilibrium: load pressure of oil, force of a motor.
//!
//! Which drive a machine has is part of its type, chosen once for many runs: a step does not ask.

pub mod electric;
pub mod hydraulic;
mod kind;

pub use crate::run::SIGNALS;
pub use kind::{Kind, OfElectric, OfHydraulic};

use core::fmt::Debug;

use crate::Scalar;
use crate::channels;
use crate::column::ColumnMotion;
use crate::compensator::Compensator;
use crate::controller::Converters;
use crate::effects::Effects;
use crate::parameters::Parameters;
use crate::run::{Shared, Slow, Snapshot, State, StepFraction, StepStart};
use crate::transducers::Transducers;

/// What a drive, the column and the feel are to one another.
#[derive(Debug, Clone, Copy)]
pub struct Coupling<S: Scalar> {
    /// Acceleration of the base per newton of the link's force.
    pub base_per_force: S,
    /// Acceleration of the feel per newton that it hears at once, without a lag or a sample between.
    pub feel_per_force: S,
    /// Whether it hears the load cell so.
    pub direct: S::Mask,
}

/// Where a drive holds on to the column.
#[derive(Debug, Clone, Copy)]
pub struct Link<S> {
    /// `alpha`: travel of the drive per travel of the base.
    pub ratio: S,
    /// Half of the free play in m.
    pub half_play: S,
    /// `1 / k` in m/N.
    pub per_stiffness: S,
}

/// What is seen of a drive at one instant.
#[derive(Debug, Clone, Copy)]
pub struct DriveSignals<S> {
    /// Displacement of its end in m.
    pub position: S,
    /// Force on the load cell in N.
    pub force: S,
    /// Its own quantities, in the order of its `SIGNALS`.
    pub signals: [S; SIGNALS],
}

/// The rest of a loader, which a drive moves: column, sensors, law and feel.
#[derive(Debug, Clone, Copy)]
pub struct Neighbors<'a, S: Scalar> {
    /// The column.
    pub column: &'a ColumnMotion<S>,
    /// The sensors.
    pub transducers: &'a Transducers<S>,
    /// The law's gains.
    pub law: &'a Compensator<S>,
    /// Acceleration of the feel per torque.
    pub feel_per_torque: S,
    /// Length of a step in s.
    pub step: S,
    /// One over it.
    pub per_step: S,
}

/// A drive in time. `plant` is what a step carries: three numbers of the drive, `x_b`, `w`.
pub trait Drive<S: Scalar>: Copy + Debug {
    /// What is seen of it over time: name and SI unit of its position, then of its own quantities.
    const NAMES: &'static [(&'static str, &'static str)];
    /// Which of its quantities a run tells the peaks of.
    const PEAKS: [usize; 3];
    /// Whether it is the command that holds its effort, so that a limit of the one is a limit of the other.
    const COMMAND_HOLDS: bool;
    /// What is measured of it on a bench: name and SI unit.
    const CHANNELS: &'static [(&'static str, &'static str)];

    /// What it does while something holds or moves the base.
    type Side: Copy + Debug;
    /// What it does in balance.
    type Balance: Copy + Debug;
    /// What it remembers from step to step, beside its three numbers.
    type Memory: Copy + Debug;

    /// The drive of a loader.
    fn new(parameters: &Parameters<S>, shared: &Shared, coupling: &Coupling<S>) -> Self;
    /// What is between it and a digital controller.
    fn converters(parameters: &Parameters<S>) -> Converters<S>;
    /// Where it holds on to the column.
    fn link(&self) -> Link<S>;
    /// Force on the load cell per effort.
    fn force_per_effort(&self) -> S;

    /// The side where some bases are stuck.
    fn side(&self, effects: &Effects, stuck: S::Mask) -> Self::Side;
    /// The side where every base moves.
    fn moving(&self) -> Self::Side;
    /// Whether the link is beyond its play.
    fn touches(&self, plant: &[S; 5]) -> S::Mask;
    /// What the drive does; `touches`: where the link may push or pull at all.
    fn balance(&self, effects: &Effects, side: &Self::Side, touches: S::Mask, plant: &[S; 5]) -> Self::Balance;
    /// What is seen of that; `left`: what the last step left.
    fn seen(&self, plant: &[S; 5], balance: &Self::Balance, left: S) -> DriveSignals<S>;
    /// What the last step left: by how much a pressure is behind, or how warm a winding is.
    fn left(memory: &Self::Memory) -> S;

    /// Velocity of the base.
    fn base_velocity(&self, w: S, balance: &Self::Balance) -> S;
    /// `w` of a velocity.
    fn base_momentum(&self, velocity: S, balance: &Self::Balance) -> S;
    /// Rate of the feel.
    fn feel_velocity(&self, u: S, balance: &Self::Balance) -> S;
    /// `u` of a rate.
    fn feel_momentum(&self, rate: S, balance: &Self::Balance) -> S;
    /// The feel now answers a torque with `to`, which was `from`; by how much `u` changes where its rate stays.
    fn feel_changed(&mut self, from: S, to: S, balance: &Self::Balance) -> S;

    /// Acceleration of the base by the link.
    fn pull(&self, base_per_force: S, balance: &Self::Balance) -> S;
    /// Rates of its three numbers under the command `e`, which `now` then knows of.
    fn rates(
        &self,
        effects: &Effects,
        memory: &Self::Memory,
        plant: (&[S; 5], StepFraction),
        e: S,
        now: &mut Snapshot<S, Self::Balance>,
    ) -> [S; 3];
    /// By how much the rate of the third changes with the command.
    fn command_jump(&self, effects: &Effects, now: &Snapshot<S, Self::Balance>, e_change: S) -> S;
    /// Force that a feel which hears the load cell directly is moved by.
    fn heard(&self, force: S, now: &Snapshot<S, Self::Balance>) -> S;

    /// Effort of a force, in equilibrium.
    fn effort(&self, force: S) -> S;
    /// Effort at which the link is stretched by so much.
    fn effort_of_stretch(&self, stretch: S) -> S;
    /// Length by which the link is stretched at rest, its play included.
    fn stretch_at_rest(&self, effort: S) -> S;
    /// What the command asks for beyond what holds the drive's end at its position under its effort: zero in equilibrium.
    fn residual(&self, effects: &Effects, e: S, at: (S, S)) -> S;
    /// Its three numbers, `w`, `u` and its memory at rest.
    fn at_rest(&self, effects: &Effects, position: S, effort: S) -> ([S; 3], [S; 2], Self::Memory);

    /// At the start of a step: what it was behind by the end of the last one.
    fn catch_up(
        &self,
        neighbors: &Neighbors<'_, S>,
        effects: &Effects,
        side: &Self::Side,
        state: &mut State<S, Self::Memory>,
        now: &mut Snapshot<S, Self::Balance>,
    );
    /// At the start of a step: its own dry friction, first what it did inside the last one; and what of it goes by itself through
    /// the step.
    #[inline(always)]
    fn settle(
        &self,
        _: &Neighbors<'_, S>,
        _: &Effects,
        _: &mut State<S, Self::Memory>,
        _: &mut Snapshot<S, Self::Balance>,
        _: &mut Slow<S>,
    ) {
    }
    /// Adds its own dry friction to the rates.
    #[inline(always)]
    fn resist(_: &Effects, _: &Self::Memory, _: &mut Slow<S>) {}
    /// At the end of a step: what changes slowly.
    #[inline(always)]
    fn end_step(&self, _: &Effects, _: &mut State<S, Self::Memory>, _: &StepStart<S, Self::Balance, Self::Side>) {}
    /// What is seen half-way between the starts of two steps.
    fn seen_between(
        &self,
        plant: &[S; 5],
        balance: &Self::Balance,
        between: [&Snapshot<S, Self::Balance>; 2],
        digital: bool,
    ) -> DriveSignals<S>;
    /// At the end of a step: the link met the end of its play on the way.
    fn close_play(
        &self,
        neighbors: &Neighbors<'_, S>,
        shared: &Shared,
        state: &mut State<S, Self::Memory>,
        start: &[S; 5],
        begun: &StepStart<S, Self::Balance, Self::Side>,
    );

    /// What is measured on a bench, in the order of [`CHANNELS`](Self::CHANNELS).
    fn channels(now: &Snapshot<S, Self::Balance>, parameters: &Parameters<S>) -> [S; channels::COUNT];

    /// Its memory as numbers.
    fn remembered(memory: &Self::Memory) -> [S; REMEMBERED];
    /// The memory that these make out.
    fn remember(memory: &mut Self::Memory, numbers: [S; REMEMBERED]);
}

/// Numbers of a drive's memory that a linear loop depends on.
pub const REMEMBERED: usize = 2;
