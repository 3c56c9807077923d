//! Laws of runs, as Python gives them, and the effects in play under them.

use crate::arrays::rows;
use crate::errors::refused;
use crate::model::GainLaw;
use forcefeel_model::compensator::Compensator as Gains;
use forcefeel_model::effects::Effects;
use forcefeel_model::observer::NUMBERS;
use forcefeel_model::parameters::COUNT;
use forcefeel_solve::law::Law;
use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// A law for all runs: by name, made of each run's own parameters, or as fixed numbers.
#[derive(Clone, Copy)]
pub enum NamedLaw {
    Original,
    Position,
    Open,
    Fixed(Gains<f64>),
}

impl NamedLaw {
    pub fn law(self) -> Law<'static> {
        match self {
            Self::Original => Law::Original,
            Self::Position => Law::Position,
            Self::Open => Law::Open,
            Self::Fixed(law) => Law::Fixed(law),
        }
    }
}

impl<'py> FromPyObject<'_, 'py> for NamedLaw {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(law) = given.cast::<GainLaw>() {
            return Ok(Self::Fixed(law.get().law()));
        }
        let name: String = given.extract().map_err(|_| {
            PyTypeError::new_err("law: expected a GainLaw or its name, 'open', 'position' or 'original'")
        })?;
        match name.as_str() {
            "original" => Ok(Self::Original),
            "position" => Ok(Self::Position),
            "open" => Ok(Self::Open),
            other => Err(refused(format!("law: expected 'open', 'position' or 'original', got {other:?}"))),
        }
    }
}

/// The laws of many runs.
pub struct Laws {
    law: Option<NamedLaw>,
    gains: Option<Vec<[f64; 7]>>,
    observers: Option<Vec<[f64; NUMBERS]>>,
}

impl Laws {
    pub fn of(
        law: Option<NamedLaw>,
        gains: Option<&PyReadonlyArray2<'_, f64>>,
        observers: Option<&PyReadonlyArray2<'_, f64>>,
        runs: usize,
    ) -> PyResult<Self> {
        let gains = gains.map(|gains| rows::<7>("gains", gains)).transpose()?;
        let observers = observers.map(|observers| rows::<NUMBERS>("observers", observers)).transpose()?;
        check_runs("gains", gains.as_ref().map(Vec::len), runs)?;
        // One observer may serve all runs.
        check_runs("observers", observers.as_ref().map(Vec::len).filter(|&laws| laws != 1), runs)?;
        Ok(Self { law, gains, observers })
    }

    pub fn law(&self) -> Law<'_> {
        match self {
            Self { observers: Some(observers), .. } => Law::Observers(observers),
            Self { gains: Some(gains), .. } => Law::Gains(gains),
            Self { law: Some(law), .. } => law.law(),
            _ => Law::Original,
        }
    }
}

/// The effects in play for any of these loaders under a law.
pub fn effects_of<'a>(values: impl Iterator<Item = &'a [f64; COUNT]>, law: &Law<'_>) -> Effects {
    let mut effects = values.map(Effects::of).reduce(Effects::or).unwrap_or_default();
    effects.feedback = law.feeds_back();
    effects.observer = matches!(law, Law::Observers(_));
    effects.known_friction = law.knows_friction();
    effects.contact_law = law.knows_contact();
    effects
}

/// Refuses another number of rows than there are runs.
pub fn check_runs(name: &str, count: Option<usize>, runs: usize) -> PyResult<()> {
    match count {
        Some(count) if count != runs => Err(refused(format!("{name}: expected {runs} rows, got {count}"))),
        _ => Ok(()),
    }
}
