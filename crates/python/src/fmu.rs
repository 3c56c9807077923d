//! The variables of an FMU, for what writes its description.

use crate::arrays::vector;
use crate::errors::refused;
use forcefeel_fmu::variables::{
    INPUTS, Kind, OPTIONS, OPTIONS_FROM, OUTPUTS, PARAMETERS, Signal, inputs, is_switch, is_tunable, options, range,
    rows, seen,
};
use forcefeel_model::parameters::{DriveKind, TABLE};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

/// A variable of an FMU.
#[pyclass(frozen, get_all, module = "forcefeel._core")]
pub struct FmuVariable {
    /// How the library knows it.
    reference: u32,
    name: String,
    meaning: &'static str,
    /// SI unit; empty for a pure number.
    unit: &'static str,
    causality: &'static str,
    variability: &'static str,
    /// `Real`, `Integer` or `Boolean`.
    kind: &'static str,
    /// In the SI unit; nothing for an output.
    start: Option<f64>,
    /// Smallest and largest value.
    range: Option<(f64, f64)>,
}

/// The variables of an FMU of this kind of a loader with these values and so many settings of the feel, the time left out.
#[pyfunction]
pub fn fmu_variables(kind: &str, values: PyReadonlyArray1<'_, f64>, settings: usize) -> PyResult<Vec<FmuVariable>> {
    let names = Kind::NAMES.map(|(name, _)| name);
    let Some((_, kind)) = Kind::NAMES.into_iter().find(|(name, _)| *name == kind) else {
        return Err(refused(format!("kind: expected {}, got {kind:?}", names.join(", "))));
    };
    let values = vector("values", &values)?;
    let drive = DriveKind::of(&values);
    let signals = |from: u32, signals: Vec<Signal>, causality: &'static str| {
        (from..).zip(signals).map(move |(reference, signal)| FmuVariable {
            reference,
            name: signal.name.to_string(),
            meaning: signal.meaning,
            unit: signal.unit,
            causality,
            variability: if signal.continuous { "continuous" } else { "discrete" },
            kind: "Real",
            start: (causality == "input").then_some(signal.start),
            range: (causality == "input").then_some(signal.range),
        })
    };
    let options = options(kind, settings).into_iter().map(|place| {
        let option = &OPTIONS[place];
        #[expect(clippy::cast_precision_loss, reason = "a number of settings")]
        let most = if option.name == "setting" { settings as f64 } else { option.range.1 };
        FmuVariable {
            reference: reference(OPTIONS_FROM, place),
            name: option.name.to_string(),
            meaning: option.meaning,
            unit: option.unit,
            causality: "parameter",
            variability: variability(option.tunable),
            kind: if option.whole { "Integer" } else { "Real" },
            start: Some(option.start),
            range: Some((option.range.0, most)),
        }
    });
    let rows = rows(kind, drive, &values).into_iter().map(|place| {
        let row = &TABLE[place];
        FmuVariable {
            reference: reference(PARAMETERS, place),
            name: format!("{}.{}", row.part, row.name),
            meaning: row.meaning,
            unit: if is_switch(row) { "" } else { row.unit.si },
            causality: "parameter",
            variability: variability(is_tunable(row)),
            kind: if is_switch(row) { "Boolean" } else { "Real" },
            start: Some(values[place]),
            range: (!is_switch(row)).then(|| range(row)),
        }
    });
    let inputs = signals(INPUTS, inputs(kind, &values), "input");
    let outputs = signals(OUTPUTS, seen(kind, drive), "output");
    Ok(inputs.chain(outputs).chain(options).chain(rows).collect())
}

fn variability(tunable: bool) -> &'static str {
    if tunable { "tunable" } else { "fixed" }
}

#[expect(clippy::cast_possible_truncation, reason = "a place in a table")]
fn reference(from: u32, place: usize) -> u32 {
    from + place as u32
}
