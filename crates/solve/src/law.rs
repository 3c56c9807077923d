//! The laws of many runs or loops.

use forcefeel_model::Scalar;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::observer::{NUMBERS, Observer, knows_contact, knows_friction};
use forcefeel_model::parameters::Parameters;

/// The law of each run.
#[derive(Debug, Clone, Copy)]
pub enum Law<'a> {
    /// The original position loop, with each run's own parameters.
    Original,
    /// The position loop without the feel computer, with each run's own parameters.
    Position,
    /// No law: the servo's amplifier is open.
    Open,
    /// One law for all runs: what was designed for the nominal loader meets each.
    Fixed(Compensator<f64>),
    /// State feedback with gains `c_1 .. c_7` for each run, the load cell's arm by its own geometry.
    Gains(&'a [[f64; 7]]),
    /// A sampled law with an observer for each run, or one for all.
    Observers(&'a [[f64; NUMBERS]]),
}

impl Law<'_> {
    /// Whether more than piston and programmed displacement is fed back.
    pub fn feeds_back(&self) -> bool {
        match self {
            Self::Original | Self::Position | Self::Open | Self::Observers(_) => false,
            Self::Fixed(law) => [1, 3, 4, 5, 6].iter().any(|&k| law.gains[k] != 0.0),
            Self::Gains(_) => true,
        }
    }

    /// Whether the law of a run knows of dry friction.
    pub fn knows_friction(&self) -> bool {
        matches!(self, Self::Observers(laws) if laws.iter().any(knows_friction))
    }

    /// Whether the law of a run knows of contact.
    pub fn knows_contact(&self) -> bool {
        matches!(self, Self::Observers(laws) if laws.iter().any(knows_contact))
    }

    /// The gains of a group's runs; none under an observer, whose feel is driven by the column's torque.
    #[inline(always)]
    pub fn compensator<T: Scalar>(
        &self,
        parameters: &Parameters<T>,
        wide: impl Fn(&dyn Fn(usize) -> f64) -> T,
    ) -> Compensator<T> {
        let zero = parameters.column.inertia.zero();
        match self {
            Self::Original => Compensator::original(parameters),
            Self::Position => Compensator::position_loop(parameters),
            Self::Open => Compensator::none(parameters),
            Self::Fixed(law) => law.map(|value| zero.constant(value)),
            Self::Gains(gains) => {
                Compensator::state_feedback(parameters, core::array::from_fn(|k| wide(&|run| gains[run][k])))
            }
            Self::Observers(_) => Compensator::state_feedback(parameters, [zero; 7]),
        }
    }

    /// The observers of a group's runs.
    #[inline(always)]
    pub fn observer<T: Scalar>(&self, wide: impl Fn(&dyn Fn(usize) -> f64) -> T) -> Option<Observer<T>> {
        let Self::Observers(laws) = self else { return None };
        let of = |run: usize| &laws[run.min(laws.len() - 1)];
        Some(Observer::from_numbers(&core::array::from_fn(|k| wide(&|run| of(run)[k]))))
    }
}
