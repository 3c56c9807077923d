//! The parameter table and the models.

use crate::arrays::{Matrix, rows, to_numpy, vector};
use crate::errors::refused;
use forcefeel_model::compensator::{Compensator as Law, Displacement};
use forcefeel_model::drive::electric::plant::ElectricPlant;
use forcefeel_model::dual::Dual;
use forcefeel_model::grip_sensor::GripForce;
use forcefeel_model::loader::{Compliant, DesignPlant, IdealFeel, Rigid, System};
use forcefeel_model::parameters::{
    ALTERNATIVES, COUNT, DriveKind, Feel, Linkage, PARTS, Parameter as Row, Parameters, TABLE,
};
use forcefeel_solve::linearize as jacobians;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

const HYDRAULIC: &str = "hydraulic";
const ELECTRIC: &str = "electric";

/// The kind of drive of this name.
pub fn drive_of(name: &str) -> PyResult<DriveKind> {
    match name {
        HYDRAULIC => Ok(DriveKind::Hydraulic),
        ELECTRIC => Ok(DriveKind::Electric),
        other => Err(refused(format!("drive: expected '{HYDRAULIC}' or '{ELECTRIC}', got {other:?}"))),
    }
}

/// One row of the parameter table.
#[pyclass(frozen, get_all, module = "forcefeel._core")]
pub struct Parameter {
    part: &'static str,
    name: &'static str,
    symbol: &'static str,
    meaning: &'static str,
    unit_si: &'static str,
    unit_metric: &'static str,
    unit_us: &'static str,
    default_us: f64,
    default_si: f64,
    off_us: Option<f64>,
    off_si: Option<f64>,
    minimum_us: f64,
    maximum_us: f64,
    minimum_si: f64,
    maximum_si: f64,
    source: &'static str,
    instead_of: Vec<&'static str>,
    drive: Option<&'static str>,
}

pub fn row(row: &Row) -> Parameter {
    Parameter {
        part: row.part,
        name: row.name,
        symbol: row.symbol,
        meaning: row.meaning,
        unit_si: row.unit.si,
        unit_metric: row.unit.metric,
        unit_us: row.unit.us,
        default_us: row.default_us,
        default_si: row.default_si(),
        off_us: row.off_us,
        off_si: row.off_si(),
        minimum_us: row.minimum_us,
        maximum_us: row.maximum_us,
        minimum_si: row.minimum_us * row.unit.si_per_us,
        maximum_si: row.maximum_us * row.unit.si_per_us,
        source: row.source,
        instead_of: row.instead_of.to_vec(),
        drive: row.drive().map(|kind| match kind {
            DriveKind::Hydraulic => HYDRAULIC,
            DriveKind::Electric => ELECTRIC,
        }),
    }
}

/// The parameter table: first the rows that make a loader, in order, then the alternatives.
#[pyfunction]
pub fn parameters() -> Vec<Parameter> {
    TABLE.iter().chain(ALTERNATIVES).map(row).collect()
}

/// The parts of a loader and what each is.
#[pyfunction]
pub fn parts() -> Vec<(&'static str, &'static str)> {
    PARTS.to_vec()
}

type Values<'py> = PyReadonlyArray1<'py, f64>;
/// Inertia and damping, one of each for every feel.
pub type Columns<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);
type Matrices<'py> = (Matrix<'py>, Matrix<'py>, Matrix<'py>, Matrix<'py>);

fn loader(values: &Values<'_>) -> PyResult<Parameters<f64>> {
    Ok(Parameters::from_values(&vector::<COUNT>("values", values)?))
}

/// What the grip's sensor shows at moments of the pilot's force, the column's angle, its rate and its acceleration, (moments, 4).
#[pyfunction]
pub fn grip_force<'py>(
    py: Python<'py>,
    values: Values<'py>,
    moments: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let parameters = loader(&values)?;
    let (sensor, per_base) = (GripForce::new(&parameters), parameters.column.angle(1.0));
    let shown = |[force, motion @ ..]: [f64; 4]| sensor.shown(force, motion.map(|angle| angle / per_base));
    Ok(PyArray1::from_iter(py, rows::<4>("moments", &moments)?.into_iter().map(shown)))
}

/// The law that drives the servo amplifier, as data.
#[pyclass(frozen, eq, module = "forcefeel._core")]
#[derive(PartialEq)]
pub struct GainLaw(Law<f64>);

impl GainLaw {
    pub fn law(&self) -> Law<f64> {
        self.0
    }

    fn dual(&self) -> Law<Dual> {
        self.0.map(Dual::constant)
    }
}

#[pymethods]
impl GainLaw {
    #[new]
    #[pyo3(signature = (gains, load_cell_arm, displacement_unit = "rad"))]
    fn new(gains: [f64; 7], load_cell_arm: f64, displacement_unit: &str) -> PyResult<Self> {
        let displacement = match displacement_unit {
            "V" => Displacement::Volts,
            "rad" => Displacement::Radians,
            other => {
                return Err(refused(format!("displacement_unit: expected 'V' or 'rad', got {other:?}")));
            }
        };
        Ok(Self(Law { gains, load_cell_arm, displacement }))
    }
    #[staticmethod]
    fn none(values: Values<'_>) -> PyResult<Self> {
        Ok(Self(Law::none(&loader(&values)?)))
    }
    #[staticmethod]
    fn position_loop(values: Values<'_>) -> PyResult<Self> {
        Ok(Self(Law::position_loop(&loader(&values)?)))
    }
    #[staticmethod]
    fn original(values: Values<'_>) -> PyResult<Self> {
        Ok(Self(Law::original(&loader(&values)?)))
    }
    #[staticmethod]
    fn state_feedback(values: Values<'_>, gains: [f64; 7]) -> PyResult<Self> {
        Ok(Self(Law::state_feedback(&loader(&values)?, gains)))
    }
    #[getter]
    fn gains(&self) -> [f64; 7] {
        self.0.gains
    }
    #[getter]
    fn load_cell_arm(&self) -> f64 {
        self.0.load_cell_arm
    }
    #[getter]
    fn displacement_unit(&self) -> &'static str {
        match self.0.displacement {
            Displacement::Volts => "V",
            Displacement::Radians => "rad",
        }
    }
    fn __repr__(&self) -> String {
        let Law { gains, load_cell_arm, .. } = self.0;
        format!("GainLaw({gains:?}, {load_cell_arm:?}, {:?})", self.displacement_unit())
    }
    fn __getnewargs__(&self) -> ([f64; 7], f64, &'static str) {
        (self.0.gains, self.0.load_cell_arm, self.displacement_unit())
    }
}

fn matrices<'py, const X: usize, const U: usize, const Y: usize>(
    py: Python<'py>,
    system: &impl System<Dual, X, U, Y>,
) -> PyResult<Matrices<'py>> {
    let m = jacobians(system, &[0.0; X], &[0.0; U]);
    Ok((to_numpy(py, &m.a)?, to_numpy(py, &m.b)?, to_numpy(py, &m.c)?, to_numpy(py, &m.d)?))
}

/// Matrices of the loader with a rigid link, eq. (15).
#[pyfunction]
pub fn rigid<'py>(py: Python<'py>, values: Values<'py>, law: &GainLaw) -> PyResult<Matrices<'py>> {
    matrices(py, &Rigid { parameters: loader(&values)?.map(Dual::constant), compensator: law.dual() })
}

/// Matrices of the loader with a compliant link, eq. (17).
#[pyfunction]
pub fn compliant<'py>(py: Python<'py>, values: Values<'py>, law: &GainLaw) -> PyResult<Matrices<'py>> {
    matrices(py, &Compliant { parameters: loader(&values)?.map(Dual::constant), compensator: law.dual() })
}

/// Matrices of the plant for the design, eq. (19).
#[pyfunction]
pub fn design_plant<'py>(py: Python<'py>, values: Values<'py>, pilot_arm: f64) -> PyResult<Matrices<'py>> {
    matrices(
        py,
        &DesignPlant { parameters: loader(&values)?.map(Dual::constant), pilot_arm: Dual::constant(pilot_arm) },
    )
}

/// Matrices of motor, linkage and column of an electric loader; states `x_m, x_m', i, x_b, x_b'`, inputs `F_p, e`, outputs `theta`,
/// `x_m`, `F_c`, `i`, `u`, `omega`.
#[pyfunction]
pub fn electric_plant<'py>(py: Python<'py>, values: Values<'py>) -> PyResult<Matrices<'py>> {
    matrices(py, &ElectricPlant::new(&loader(&values)?.map(Dual::constant)))
}

/// Matrices of the programmed feel, eq. (11).
#[pyfunction]
pub fn ideal_feel<'py>(py: Python<'py>, values: Values<'py>) -> PyResult<Matrices<'py>> {
    matrices(py, &IdealFeel { parameters: loader(&values)?.map(Dual::constant) })
}

/// Orifice flow of eq. (1) at each pair of current and load pressure.
#[pyfunction]
pub fn orifice_flow<'py>(
    py: Python<'py>,
    values: Values<'py>,
    current: Values<'py>,
    pressure: Values<'py>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let valve = loader(&values)?.valve;
    let (i, p) = (current.as_array(), pressure.as_array());
    Ok(PyArray1::from_iter(py, i.iter().zip(p).map(|(&i, &p)| valve.orifice_flow(i, p))))
}

/// `(C_i, C_p)` of eq. (2) at an operating point given as shares of rated current and supply pressure.
#[pyfunction]
pub fn valve_gains(values: Values<'_>, current_share: f64, pressure_share: f64) -> PyResult<(f64, f64)> {
    Ok(loader(&values)?.valve.gains_at(current_share, pressure_share))
}

/// `(k, c)` of a link on which the column swings at `frequency` rad/s with `damping_ratio`.
#[pyfunction]
pub fn linkage_from_resonance(values: Values<'_>, frequency: f64, damping_ratio: f64) -> PyResult<(f64, f64)> {
    let Parameters { linkage, column, .. } = loader(&values)?;
    Ok(Linkage::from_resonance(linkage.ratio, &column, frequency, damping_ratio))
}

/// `(I, B)` of a feel of this natural frequency in rad/s, damping ratio and stiffness.
#[pyfunction]
pub fn feel_from_frequency(frequency: f64, damping_ratio: f64, stiffness: f64) -> (f64, f64) {
    Feel::from_frequency(frequency, damping_ratio, stiffness)
}

/// `I` and `B` of feels of these natural frequencies in rad/s, damping ratios and stiffnesses, as many of each.
#[pyfunction]
pub fn feel_from_frequencies<'py>(
    py: Python<'py>,
    frequency: Values<'py>,
    damping_ratio: Values<'py>,
    stiffness: Values<'py>,
) -> PyResult<Columns<'py>> {
    let (w, zeta, g) = (frequency.as_array(), damping_ratio.as_array(), stiffness.as_array());
    if w.len() != zeta.len() || w.len() != g.len() {
        let lengths = (w.len(), zeta.len(), g.len());
        return Err(refused(format!("frequency, damping_ratio, stiffness: expected as many of each, got {lengths:?}")));
    }
    let of = |((&w, &zeta), &g)| Feel::from_frequency(w, zeta, g);
    let (inertia, damping) = w.iter().zip(zeta).zip(g).map(of).unzip();
    Ok((PyArray1::from_vec(py, inertia), PyArray1::from_vec(py, damping)))
}

/// Natural frequency in rad/s and damping ratio of the programmed feel.
#[pyfunction]
pub fn feel_frequency(values: Values<'_>) -> PyResult<(f64, f64)> {
    Ok(loader(&values)?.feel.frequency())
}
