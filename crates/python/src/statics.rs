//! Statics: what holds the feel, and what motor or valve give at the grip for a force and a speed.

use crate::arrays::{Matrix, rows, to_numpy, vector};
use crate::errors::refused;
use crate::simulate::spring_curve;
use forcefeel_model::compensator::Compensator;
use forcefeel_model::drive::electric::statics::MotorStatics as OfMotor;
use forcefeel_model::drive::hydraulic::statics::ValveStatics as OfValve;
use forcefeel_model::dual::Dual;
use forcefeel_model::effects::Effects;
use forcefeel_model::feel::{FeelConditions, FeelLaw};
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::surface::{Added, FlightState};
use forcefeel_solve::linearize;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

type Values<'py> = PyReadonlyArray1<'py, f64>;
type Row<'py> = Bound<'py, PyArray1<f64>>;

/// Lowest and highest force at the grip, (angles, 2), that hold the programmed feel at angles with a factor on its spring.
#[pyfunction]
#[pyo3(signature = (values, angles, stiffness_factor = 1.0, *, curve = None))]
pub fn feel_held_between<'py>(
    py: Python<'py>,
    values: Values<'py>,
    angles: Values<'py>,
    stiffness_factor: f64,
    curve: Option<(Values<'py>, PyReadonlyArray2<'py, f64>)>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values = vector::<COUNT>("values", &values)?;
    let (parameters, effects) = (Parameters::from_values(&values), Effects::of(&values));
    let curve = curve.map(|(knots, coefficients)| spring_curve(&knots, &coefficients)).transpose()?;
    // The feel of the column's torque, whose displacement is the angle.
    let feel = FeelLaw::new(&parameters, &Compensator::state_feedback(&parameters, [0.0; 7]));
    let held = |&angle: &f64| feel.held_between(&effects, curve.as_ref(), angle, (0.0, stiffness_factor)).to_vec();
    Ok(PyArray2::from_vec2(py, &angles.as_array().iter().map(held).collect::<Vec<_>>())?)
}

/// Force at the grip in N, spring in N m/rad and damping in N m s/rad, (states, 3), that the hinge moment of the loader's surface is to a
/// control at an angle.
///
/// `flight`: dynamic pressure, true airspeed, angle of attack, sideslip, rates of roll, pitch and yaw, load factor, Mach number, angle of the
/// tab, and the control's angle; a row for each state.
#[pyfunction]
pub fn hinge_moment<'py>(
    py: Python<'py>,
    values: Values<'py>,
    flight: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let parameters = Parameters::from_values(&vector::<COUNT>("values", &values)?);
    let added = |row: &[f64; 11]| {
        let (state, theta) = (core::array::from_fn(|k| row[k]), row[10]);
        let Added { force, stiffness, damping } = parameters.hinge_moment(&FlightState::from_numbers(state), theta);
        vec![force, stiffness, damping]
    };
    Ok(PyArray2::from_vec2(py, &rows("flight", &flight)?.iter().map(added).collect::<Vec<_>>())?)
}

/// Force at the grip that moves the programmed feel slowly along a path, at each of its angles in the direction +1 or -1, 0 without
/// friction; the hysteresis begins at the first angle.
#[pyfunction]
#[pyo3(signature = (values, angles, directions, *, curve = None))]
pub fn feel_held_along<'py>(
    py: Python<'py>,
    values: Values<'py>,
    angles: Values<'py>,
    directions: Values<'py>,
    curve: Option<(Values<'py>, PyReadonlyArray2<'py, f64>)>,
) -> PyResult<Row<'py>> {
    let values = vector::<COUNT>("values", &values)?;
    let (parameters, effects) = (Parameters::from_values(&values), Effects::of(&values));
    let curve = curve.map(|(knots, coefficients)| spring_curve(&knots, &coefficients)).transpose()?;
    let feel = FeelLaw::new(&parameters, &Compensator::state_feedback(&parameters, [0.0; 7]));
    let mut slider = None;
    let [forces] = pairs(py, "angles and directions", (&angles, &directions), |angle, direction| {
        let at = feel.dragged(*slider.get_or_insert(angle), angle);
        slider = Some(at);
        let conditions = FeelConditions { slider: at, ..FeelConditions::at_rest(0.0, 1.0, angle) };
        [feel.held(&effects, curve.as_ref(), angle, direction, &conditions)]
    })?;
    Ok(forces)
}

/// Force at the grip in N that by itself turns the column with each angular acceleration in rad/s^2.
#[pyfunction]
pub fn column_grip_force<'py>(py: Python<'py>, values: Values<'py>, acceleration: Values<'py>) -> PyResult<Row<'py>> {
    let column = Parameters::from_values(&vector::<COUNT>("values", &values)?).column;
    Ok(PyArray1::from_iter(py, acceleration.as_array().iter().map(|&of| column.grip_force(of))))
}

/// Each pair of two arrays through `of`, or a `ArgumentError` that names both.
fn pairs<'py, const N: usize>(
    py: Python<'py>,
    names: &str,
    (a, b): (&Values<'_>, &Values<'_>),
    mut of: impl FnMut(f64, f64) -> [f64; N],
) -> PyResult<[Row<'py>; N]> {
    let (a, b) = (a.as_array(), b.as_array());
    if a.len() != b.len() {
        return Err(refused(format!("{names}: expected as many of each, got {} and {}", a.len(), b.len())));
    }
    let rows: Vec<[f64; N]> = a.iter().zip(b).map(|(&a, &b)| of(a, b)).collect();
    Ok(core::array::from_fn(|k| PyArray1::from_iter(py, rows.iter().map(|row| row[k]))))
}

/// Valve and piston of a loader, seen from the grip.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct ValveStatics(OfValve<f64>);

#[pymethods]
impl ValveStatics {
    #[new]
    fn new(values: Values<'_>) -> PyResult<Self> {
        let values = vector::<COUNT>("values", &values)?;
        Ok(Self(OfValve::new(&Parameters::from_values(&values), &Effects::of(&values))))
    }
    /// Force at the grip per load pressure, N/Pa; flow per speed of the grip, m^3/m.
    #[getter]
    fn force_per_pressure(&self) -> f64 {
        self.0.force_per_pressure
    }
    /// Oil that a rise of the load pressure takes, m^3/Pa: into the link and into itself.
    #[getter]
    fn oil_compliance(&self) -> f64 {
        self.0.oil_compliance
    }
    /// Flow in m^3/s at a current in A and no load, whatever the spool's stroke.
    fn no_load_flow(&self, current: f64) -> f64 {
        self.0.no_load_flow(current)
    }
    /// Load pressure in Pa at which so much flow at no load comes to rest.
    fn stall_pressure(&self, flow: f64) -> f64 {
        self.0.stall_pressure(flow)
    }
    /// Flow into the actuator at each pair of a flow at no load and a load pressure.
    fn flow<'py>(&self, py: Python<'py>, no_load: Values<'py>, pressure: Values<'py>) -> PyResult<Row<'py>> {
        let [flow] = pairs(py, "no_load, pressure", (&no_load, &pressure), |flow, p| [self.0.flow(flow, p)])?;
        Ok(flow)
    }
    /// Flow at no load that lets each flow into the actuator through against its load pressure; infinite where there is none.
    fn needed<'py>(&self, py: Python<'py>, flow: Values<'py>, pressure: Values<'py>) -> PyResult<Row<'py>> {
        let [needed] = pairs(py, "flow, pressure", (&flow, &pressure), |q, p| [self.0.needed(q, p)])?;
        Ok(needed)
    }
    /// Load pressure, and flow at no load, of each force at the grip and its speed along it.
    fn taken<'py>(&self, py: Python<'py>, force: Values<'py>, speed: Values<'py>) -> PyResult<[Row<'py>; 2]> {
        pairs(py, "force, speed", (&force, &speed), |f, v| self.0.taken(f, v))
    }
}

/// Motor and transmission of a loader, seen from the grip.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct MotorStatics {
    statics: OfMotor<f64>,
    sloped: OfMotor<Dual>,
}

#[pymethods]
impl MotorStatics {
    #[new]
    fn new(values: Values<'_>) -> PyResult<Self> {
        let parameters = Parameters::from_values(&vector::<COUNT>("values", &values)?);
        Ok(Self { statics: OfMotor::new(&parameters), sloped: OfMotor::new(&parameters.map(Dual::constant)) })
    }
    /// Travel of the drive's end per travel of the grip.
    #[getter]
    fn per_grip(&self) -> f64 {
        self.statics.per_grip
    }
    /// Radians of the motor per meter of the grip.
    #[getter]
    fn gear(&self) -> f64 {
        self.statics.gear()
    }
    /// The rotor at the grip, kg.
    #[getter]
    fn added_mass(&self) -> f64 {
        self.statics.added_mass()
    }
    /// Torque, current and voltage of each force at the grip and its speed along it.
    fn taken<'py>(&self, py: Python<'py>, force: Values<'py>, speed: Values<'py>) -> PyResult<[Row<'py>; 3]> {
        pairs(py, "force, speed", (&force, &speed), |f, v| self.statics.taken(f, v))
    }
    /// Voltage of a cold phase at each current and speed of the grip.
    fn voltage<'py>(&self, py: Python<'py>, current: Values<'py>, speed: Values<'py>) -> PyResult<Row<'py>> {
        let [voltage] = pairs(py, "current, speed", (&current, &speed), |i, v| [self.statics.voltage(i, v)])?;
        Ok(voltage)
    }
    /// Current of a cold phase under each voltage, at each speed of the grip.
    fn current<'py>(&self, py: Python<'py>, voltage: Values<'py>, speed: Values<'py>) -> PyResult<Row<'py>> {
        let [current] = pairs(py, "voltage, speed", (&voltage, &speed), |u, v| [self.statics.current(u, v)])?;
        Ok(current)
    }
    /// Force at the grip of each current at its speed along it.
    fn given<'py>(&self, py: Python<'py>, current: Values<'py>, speed: Values<'py>) -> PyResult<Row<'py>> {
        let [force] = pairs(py, "current, speed", (&current, &speed), |i, v| [self.statics.given(i, v)])?;
        Ok(force)
    }
    /// Torque of a current.
    fn torque(&self, current: f64) -> f64 {
        self.statics.torque(current)
    }
    /// Speed of the grip at which a voltage and friction leave no force.
    fn fastest(&self, voltage: f64) -> f64 {
        self.statics.fastest(voltage)
    }
    /// `(A, b)` of `T' = A T + b`, winding and housing over the temperature around, at a current that stays.
    fn warming<'py>(&self, py: Python<'py>, current: f64) -> PyResult<(Matrix<'py>, Matrix<'py>)> {
        let squared = current * current;
        let matrices = linearize(&self.sloped, &[0.0; 2], &[squared]);
        Ok((to_numpy(py, &matrices.a)?, to_numpy(py, &(matrices.b * squared))?))
    }
}
