//! The whole loader in time: one step of plant, controller and feel.
//!
//! `z` piston displacement with the oil uncompressed · `p` load pressure, slaved · `q_i`, `q_i'` no-load flow and its rate ·
//! `x_b`, `v` base and its velocity · `delta`, `delta'` programmed displacement and its rate · `I` impulse of the link's damper ·
//! `w = v + b I`, `u = delta' - (r / I_feel) I` the velocities that do not see the oil's pole, see `pressure.rs` · `h` step
//!
//! One step is the classical Runge-Kutta step of fourth order on `z, q_i, q_i', x_b, w` and, under the analog law, `delta, u`, with the
//! load pressure solved at every stage: fixed cost, no iteration, and no step so long that the oil makes it unstable. Dry
//! friction holds its direction through a step; what it did inside the last step is settled at the start of the next. So do
//! stops and the link's play hold their touch, and what touched inside a step is made good at its end, see `machine/touch.rs`.

mod digital;
mod equilibrium;
mod feel;
mod friction;
mod limited;
mod linked;
mod look;
mod middle;
pub mod period;
mod pilot;
mod sensors;
mod step;
mod touch;

pub use crate::run::{Inputs, SEARCH_RAD, Shared, StepFraction};
pub use digital::Memory;
pub use equilibrium::{EQUILIBRIUM_NUMBERS, Equilibrium};

use crate::Scalar;
use crate::column::ColumnMotion;
use crate::compensator::Compensator;
use crate::control::Control;
use crate::drive::hydraulic::Hydraulic;
use crate::drive::{Coupling, Drive, Motion, Neighbors};
use crate::feel::FeelLaw;
use crate::grip_sensor::GripForce;
use crate::observer::Observer;
use crate::parameters::Parameters;
use crate::run;
use crate::transducers::Transducers;

/// One loader, ready to run: its coefficients worked out.
#[derive(Debug, Clone, Copy)]
pub struct Machine<S: Scalar, D: Drive<S> = Hydraulic<S>> {
    pub(crate) control: Control<S>,
    pub(crate) drive: D,
    pub(crate) column: ColumnMotion<S>,
    pub(crate) transducers: Transducers<S>,
    grip: GripForce<S>,
    force_scale: S,
    pub(crate) step: S,
    pub(crate) per_step: S,
}

/// State of a machine with this drive between two steps.
pub type State<S, D = Hydraulic<S>> = run::RunState<S, <D as Motion<S>>::Memory>;

/// Quantities of a machine with this drive at one instant.
pub type Snapshot<S, D = Hydraulic<S>> = run::RunSnapshot<S, <D as Motion<S>>::Balance>;

/// Start of a step of a machine with this drive.
pub type StepStart<S, D = Hydraulic<S>> = run::RunStepStart<S, <D as Motion<S>>::Balance, <D as Motion<S>>::Side>;

/// What there is where a controller may sample.
#[derive(Debug, Clone, Copy)]
pub struct SamplingPoint<S: Scalar, D: Drive<S> = Hydraulic<S>> {
    /// What there is now.
    pub now: Snapshot<S, D>,
    side: D::Side,
}

impl<S: Scalar, D: Drive<S>> Machine<S, D> {
    /// The loader with these parameters under this law, in steps of `shared.step_s`.
    #[inline(always)]
    pub fn new(parameters: &Parameters<S>, law: Compensator<S>, shared: &Shared) -> Self {
        let column = ColumnMotion::new(parameters);
        let feel = FeelLaw::new(parameters, &law);
        let one = parameters.column.inertia.constant(1.0);
        // A sampled load cell, or one with a lag, keeps what is quick in the drive from the feel computer.
        let analog = if shared.timing.is_none() { one } else { one.zero() };
        let direct = !parameters.load_cell.bandwidth.less(one / one.zero()) & one.zero().less(analog);
        let sensed_arm = S::select(direct, law.load_cell_arm, one.zero());
        let coupling =
            Coupling { base_per_force: column.per_link_force, feel_per_force: sensed_arm * feel.per_torque, direct };
        let drive = D::new(parameters, shared, &coupling);
        let observer = Observer::none(one);
        let control = Control {
            law,
            observer,
            next_observer: observer,
            feel,
            next_feel: feel,
            converters: D::converters(parameters),
            per_base: parameters.column.angle(one),
            ends: [parameters.column.stop_low, parameters.column.stop_high],
            force_per_effort: drive.force_per_effort(),
        };
        Self {
            control,
            drive,
            column,
            transducers: Transducers::new(parameters, shared.step_s),
            grip: GripForce::new(parameters),
            force_scale: one,
            step: one.constant(shared.step_s),
            per_step: one.constant(1.0 / shared.step_s),
        }
    }

    /// The loader around its drive.
    #[inline(always)]
    fn neighbors(&self) -> Neighbors<'_, S> {
        Neighbors {
            column: &self.column,
            transducers: &self.transducers,
            law: &self.control.law,
            feel_per_torque: self.control.feel.per_torque,
            step: self.step,
            per_step: self.per_step,
        }
    }

    /// The same loader with the pilot's force multiplied.
    #[inline(always)]
    pub fn with_force_scale(self, force_scale: S) -> Self {
        Self { force_scale, ..self }
    }

    /// The same loader under a sampled law with an observer; the gains of its law are not used.
    #[inline(always)]
    pub fn with_observer(self, observer: Observer<S>) -> Self {
        let control = Control { observer, next_observer: observer, ..self.control };
        Self { control, ..self }
    }

    /// What a digital controller works out at a sample, on its own.
    #[inline(always)]
    pub fn control(&self) -> &Control<S> {
        &self.control
    }

    /// Programmed angle in rad per programmed displacement.
    #[inline(always)]
    pub fn per_delta(&self) -> S {
        self.step.constant(1.0) / self.control.feel.per_angle
    }

    /// Column angle in rad per displacement of the base in m.
    #[inline(always)]
    pub fn per_base(&self) -> S {
        self.control.per_base
    }
}
