//! A loader live.

use crate::arrays::{rows, vector};
use crate::bus::{NodeOf, Ports};
use crate::errors::{ThreadsError, refused};
use crate::laws::{Laws, NamedLaw};
use crate::limits::{step, timing as in_steps};
use crate::simulate::{spring_curve, steps};
use forcefeel_live::axes::AxesLink;
use forcefeel_live::controller::Controller;
use forcefeel_live::host_link::HostStatus;
use forcefeel_live::input_output::{Command, Disturbance, Fault, InputOutput};
use forcefeel_live::record::{AxisOpening, EVERY, Opening, Record, Size};
use forcefeel_live::replay::{Contents, read, replay};
use forcefeel_live::request::LoopRequest;
use forcefeel_live::row::{COLUMNS, NAMES};
use forcefeel_live::running::{AxisPlan, Plan, Running};
use forcefeel_live::setup::{Setup, rows_of};
use forcefeel_live::simulated::{Script, Stepped, simulated};
use forcefeel_live::simulated_pair;
use forcefeel_live::status::{BUCKETS, Histogram};
use forcefeel_live::supervision::{STATES, trips};
use forcefeel_live::test_signal::TestSignal;
use forcefeel_live::udp::Udp;
use forcefeel_model::cancellation::CANCELLATION_NUMBERS;
use forcefeel_model::link::LINK_ROWS;
use forcefeel_model::linked_feels::LinkedFeels;
use forcefeel_model::logic::Named;
use forcefeel_model::parameters::{COUNT, Parameters};
use forcefeel_model::transducers::SENSORS;
use forcefeel_solve::start::Start;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::net::{ToSocketAddrs, UdpSocket};
use std::path::PathBuf;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

type Curve<'py> = (PyReadonlyArray1<'py, f64>, PyReadonlyArray2<'py, f64>);
type Array<'py> = Bound<'py, PyArray2<f64>>;
/// Name, cycle, numbers.
type Requested = (u64, String, Vec<f64>);

/// What a loop is made of: a loader's values, its law, when the controller acts.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct LiveSetup {
    setup: Setup,
    test_signal: TestSignal,
}

#[pymethods]
impl LiveSetup {
    #[new]
    #[pyo3(signature = (values, step_s, timing, *, law = None, gains = None, observers = None, curve = None, stiffness_factor = None, cancellation = None, supervised = true, rendered = None, softens = false, flap_trim = 0.0))]
    #[expect(clippy::too_many_arguments, reason = "keywords of a Python class")]
    fn new(
        values: PyReadonlyArray1<'_, f64>,
        step_s: f64,
        timing: (usize, usize),
        law: Option<NamedLaw>,
        gains: Option<PyReadonlyArray2<'_, f64>>,
        observers: Option<PyReadonlyArray2<'_, f64>>,
        curve: Option<Curve<'_>>,
        stiffness_factor: Option<Curve<'_>>,
        cancellation: Option<[f64; CANCELLATION_NUMBERS]>,
        supervised: bool,
        rendered: Option<PyReadonlyArray2<'_, f64>>,
        softens: bool,
        flap_trim: f64,
    ) -> PyResult<Self> {
        let values = vector::<COUNT>("values", &values)?;
        let laws = Laws::of(law, gains.as_ref(), observers.as_ref(), 1)?;
        let parameters = Parameters::from_values(&values);
        let observer = observers.as_ref().map(|numbers| rows("observers", numbers)).transpose()?;
        let points = |given: Option<Curve<'_>>| match given {
            Some((knots, coefficients)) => {
                spring_curve(&knots, &coefficients)?;
                Ok::<_, PyErr>(Some((knots.as_array().iter().copied().collect(), rows::<4>("curve", &coefficients)?)))
            }
            None => Ok(None),
        };
        let setup = Setup {
            values,
            gains: laws.law().compensator(&parameters, |of| of(0)),
            observer: observer.map(|numbers| numbers[0]),
            step_s: step(step_s)?,
            timing: in_steps(timing)?,
            curve: points(curve)?,
            factor: points(stiffness_factor)?,
            host: false,
            rendered: rendered.map_or_else(Vec::new, |of| rows_of(&of.as_array().iter().copied().collect::<Vec<_>>())),
            softens,
            flap_trim,
            cancellation,
            beginning: None,
            supervised,
        };
        Ok(Self { setup, test_signal: TestSignal::default() })
    }

    /// The same with a bench signal beside the law's command, which begins once the feel has been there for so many cycles.
    fn with_test_signal(&self, samples: Vec<f64>, settles: usize) -> Self {
        Self { setup: self.setup.clone(), test_signal: TestSignal::new(samples, settles) }
    }
}

impl LiveSetup {
    /// Its numbers.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }
}

/// What is done to a simulated machine: inputs by name, start force or held angle with its step, seed.
#[derive(FromPyObject)]
pub struct ScriptOf<'py>(BTreeMap<String, PyReadonlyArray2<'py, f64>>, f64, Option<(f64, usize)>, u64);

impl ScriptOf<'_> {
    pub fn script(&self) -> PyResult<Script> {
        let Self(inputs, start_force, held, seed) = self;
        let inputs = if inputs.is_empty() { vec![] } else { steps(inputs)?.0 };
        let start = held.map_or(Start::Under(*start_force), |(angle, until)| Start::Held(angle, until));
        Ok(Script { start, inputs, seed: *seed, ..Script::NONE })
    }
}

/// A record: path, most bytes and whether it is a ring, rows that are expected, cycles from a row to the next.
#[derive(FromPyObject)]
pub struct RecordOf(PathBuf, (u64, bool), u64, u64);

impl RecordOf {
    fn begin(self, mut axes: Vec<AxisOpening>) -> PyResult<(Record, u64)> {
        let Self(path, (most_bytes, ring), rows, every) = self;
        if every > 1 {
            for axis in &mut axes {
                axis.about.insert(EVERY.to_string(), every.to_string());
            }
        }
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos());
        let (start_ns, size) = (u64::try_from(now).unwrap_or(0), Size { most_bytes, rows, ring });
        let named = |error| PyOSError::new_err(format!("{}: {error}", path.display()));
        let opening = Opening { path: path.clone(), size, start_ns, axes };
        Ok((Record::create(opening).map_err(|error: std::io::Error| named(error))?, every))
    }
}

/// An axis: what its loop is made of, script of a simulated machine, address of a real one or its node on a bus, planned requests, beats
/// of the clock in its period, places of the axes that stop with it, prefix of its topics in a record and what is written about it.
#[derive(FromPyObject)]
pub struct AxisOf<'py>(
    PyRef<'py, LiveSetup>,
    Option<ScriptOf<'py>>,
    Option<RealMachine>,
    Vec<Requested>,
    u64,
    Vec<usize>,
    (String, BTreeMap<String, String>),
);

/// A link: places of both axes, values, periods of delay of an electronic one, whether it uncouples, whether it opens and closes as asked.
#[derive(FromPyObject)]
pub struct LinkOf([usize; 2], [f64; LINK_ROWS], Option<usize>, bool, bool);

/// A machine that is not in this process.
#[derive(FromPyObject)]
#[expect(clippy::large_enum_variant, reason = "one for each axis, read once")]
pub enum RealMachine {
    /// On a bus.
    Node(NodeOf),
    /// Over the network, at an address.
    Address(String),
}

/// What is at the other end of an axis.
enum Other {
    Simulated(Box<dyn Stepped>),
    Real(Box<dyn InputOutput>),
}

/// Connects to the machine of an axis, or makes a simulated one.
fn machine(
    py: Python<'_>,
    setup: &mut Setup,
    script: Script,
    real: Option<RealMachine>,
    ports: &mut Ports,
    by_clock: bool,
) -> PyResult<Other> {
    if let Some(RealMachine::Node(node)) = real {
        return Ok(Other::Real(Box::new(ports.connect(py, &node, setup, by_clock)?)));
    }
    if let Some(RealMachine::Address(address)) = real {
        let no = |why: String| PyOSError::new_err(format!("{address}: {why}"));
        let address = address.to_socket_addrs().map_err(|error| no(error.to_string()))?.next();
        let address = address.ok_or_else(|| no("is no address".to_string()))?;
        let machine = Udp::connect(address, by_clock.then(|| setup.period_s()));
        return Ok(Other::Real(Box::new(machine.map_err(|error| no(error.to_string()))?)));
    }
    let (machine, beginning) = simulated(setup, script);
    setup.beginning = Some(beginning);
    Ok(Other::Simulated(machine))
}

/// An error of the system with the axis of a project that has it.
fn of_axis(py: Python<'_>, prefix: &str, error: PyErr) -> PyErr {
    match prefix.strip_prefix('/') {
        Some(axis) if error.is_instance_of::<PyOSError>(py) => {
            PyOSError::new_err(format!("axes.{axis}: {}", error.value(py)))
        }
        _ => error,
    }
}

/// Joins simulated machines by the shafts of the mechanical links; a real one has its own.
fn join(machines: Vec<Other>, links: &[LinkOf]) -> PyResult<Vec<Box<dyn InputOutput>>> {
    let mut machines: Vec<_> = machines.into_iter().map(Some).collect();
    let mut joined: BTreeMap<usize, Box<dyn InputOutput>> = BTreeMap::new();
    for LinkOf(sides, values, _, uncouples, _) in links.iter().filter(|link| link.2.is_none()) {
        match sides.map(|side| machines.get_mut(side).and_then(Option::take)) {
            [Some(Other::Simulated(first)), Some(Other::Simulated(second))] => {
                joined.extend(sides.iter().copied().zip(simulated_pair::joined([first, second], values, *uncouples)));
            }
            [Some(Other::Real(first)), Some(Other::Real(second))] => {
                joined.extend(sides.iter().copied().zip([first, second]));
            }
            _ => return Err(refused("links: expected two simulated machines or two real ones, each with one link")),
        }
    }
    let all = machines.into_iter().enumerate().filter_map(|(place, machine)| match machine {
        Some(Other::Simulated(machine)) => Some(machine as Box<dyn InputOutput>),
        Some(Other::Real(machine)) => Some(machine),
        None => joined.remove(&place),
    });
    Ok(all.collect())
}

/// Starts a loop with all its axes, each over UDP where it has an address, on a bus where it has a node, else with the machine simulated; gives each axis.
///
/// `period_s`: of the clock. `host`: where an aircraft simulator is listened to.
#[pyfunction]
#[pyo3(signature = (axes, period_s, *, links = vec![], host = None, real_time = true, beats = None, record = None, history = 120_000))]
#[expect(clippy::too_many_arguments, reason = "keywords of a Python function")]
pub fn start_loops(
    py: Python<'_>,
    axes: Vec<AxisOf<'_>>,
    period_s: f64,
    links: Vec<LinkOf>,
    host: Option<String>,
    real_time: bool,
    beats: Option<u64>,
    record: Option<RecordOf>,
    history: usize,
) -> PyResult<Vec<LiveLoop>> {
    let host = host.map(|at| UdpSocket::bind(&at).map_err(|error| PyOSError::new_err(format!("{at}: {error}"))));
    let host = host.transpose()?;
    let places = axes.len();
    let (mut machines, mut openings, mut rest) = (vec![], vec![], vec![]);
    let mut ports = Ports::default();
    for AxisOf(setup, script, real, requests, every, stops, (prefix, about)) in axes {
        let test_signal = setup.test_signal.clone();
        let mut setup = setup.setup.clone();
        let place = machines.len();
        let linked = links.iter().any(|link| link.2.is_none() && link.0.contains(&place));
        let script = script.map_or(Ok(Script::NONE), |script| script.script())?;
        let script = Script { stream: place as u64, linked, ..script };
        let made = machine(py, &mut setup, script, real, &mut ports, real_time);
        machines.push(made.map_err(|error| of_axis(py, &prefix, error))?);
        setup.host = host.is_some();
        let requests = requests.iter().map(|(cycle, name, numbers)| Ok((*cycle, request_of(name, numbers)?)));
        let requests = requests.collect::<PyResult<_>>()?;
        let mut controller = Controller::new(&setup).map_err(refused)?;
        controller.excite(test_signal);
        openings.push(AxisOpening { prefix, about, setup: setup.numbers() });
        if every == 0 || stops.iter().any(|&place| place >= places) {
            return Err(refused("axes: expected a beat or more in a period, and places of axes"));
        }
        rest.push((controller, requests, every, stops));
    }
    let machines = join(machines, &links)?;
    let electronic = links.iter().filter_map(|LinkOf(sides, values, delay, uncouples, opens)| {
        let feels = |delay| LinkedFeels::new(values, |value| value, delay, *uncouples);
        delay.map(|delay| AxesLink { between: *sides, opens: *opens, feels: feels(delay) })
    });
    let links: Vec<_> = electronic.collect();
    if places == 0
        || links.iter().any(|AxesLink { between: [one, other], .. }| one == other || one.max(other) >= &places)
    {
        return Err(refused("axes: expected one or more, and links between two of them"));
    }
    let of_axes = rest.into_iter().zip(machines);
    let axes = of_axes.map(|((controller, requests, every, stops), machine)| AxisPlan {
        controller,
        machine,
        requests,
        every,
        stops,
    });
    let axes = axes.collect();
    let (record, every) = record.map(|record| record.begin(openings)).transpose()?.unzip();
    let (every, beats) = (every.unwrap_or(1), beats.unwrap_or(u64::MAX));
    let plan = Plan { axes, links, period_s, host, real_time, beats, record, every, history };
    let running = Running::start(plan).map_err(|error| ThreadsError::new_err(error.to_string()))?;
    Ok(running.into_iter().map(|running| LiveLoop { running }).collect())
}

/// Counts of the steps of durations, and the longest duration in ns.
type Counted = (Vec<u64>, u64);

/// An axis of a loop under way.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct LiveLoop {
    running: Running,
}

#[pymethods]
impl LiveLoop {
    /// Asks something of the loop by name, with its numbers; whether there was room for it, or a host to accept.
    #[expect(clippy::needless_pass_by_value, reason = "PyO3 hands arguments over by value")]
    fn request(&self, name: &str, numbers: Vec<f64>) -> PyResult<bool> {
        if name == "accept_host" {
            return Ok(self.running.host_status().is_some_and(HostStatus::accept));
        }
        if name == "softened" {
            return Ok(true); // what the sessions tell each other of the feel that follows
        }
        Ok(self.running.request(request_of(name, &numbers)?))
    }

    /// Does something to a simulated machine; whether there was room for it.
    #[pyo3(signature = (name, sensor = 0, number = None))]
    fn disturb(&self, name: &str, sensor: usize, number: Option<f64>) -> PyResult<bool> {
        Ok(self.running.disturb(disturbance_of(name, sensor, number)?))
    }

    /// Cycles, beats, missed ones, cycles without a sample, rows that were lost, place of the state, bits of the trips, number of what
    /// the drive complains of, whether it has ended.
    fn status(&self) -> (u64, u64, u64, u64, u64, u32, u32, u32, bool) {
        let status = self.running.status();
        let [cycles, beats, missed, silent, lost] =
            [&status.cycles, &status.beats, &status.missed, &status.silent, &status.lost].map(|it| it.load(Relaxed));
        let [state, trips, fault] = [&status.state, &status.trips, &status.drive_fault].map(|it| it.load(Relaxed));
        (cycles, beats, missed, silent, lost, state, trips, fault, status.ended.load(Relaxed))
    }

    /// Bytes of the record, rows that it lacks because it ended before the loop, and why it did, if it did.
    fn recorded(&self) -> (u64, u64, Option<String>) {
        let (bytes, lacks, ended) = self.running.recorded();
        (bytes, lacks, ended.map(str::to_string))
    }

    /// Of a host: where it is listened to, packets that were handed on, that were left out, and that were softened, who it is and how many seconds ago it
    /// spoke, and who else waits to be accepted; nothing where none is listened to.
    #[expect(clippy::type_complexity, reason = "a tuple for Python, which takes it apart at once")]
    fn host_status(&self) -> Option<(String, [u64; 3], Option<(String, Option<f64>)>, Option<String>)> {
        self.running.host_status().map(|host_status| {
            let last = host_status.last().map(|(address, ago)| (address.to_string(), ago.map(|ago| ago.as_secs_f64())));
            let waits = host_status.waiting().map(|address| address.to_string());
            let softened = &self.running.status().softened;
            let counts = [&host_status.packets, &host_status.refused, softened].map(|it| it.load(Relaxed));
            (host_status.at.to_string(), counts, last, waits)
        })
    }

    /// The newest `most` rows of cycles after `since`.
    fn history<'py>(&self, py: Python<'py>, since: f64, most: usize) -> PyResult<Array<'py>> {
        let numbers = py.detach(|| self.running.history(since, most));
        PyArray1::from_slice(py, &numbers).reshape([numbers.len() / COLUMNS, COLUMNS])
    }

    /// Least durations of the steps in ns, with the end of the last; how often the thread woke so late, and how late at most; how often it
    /// worked so long, and how long at most.
    fn timing(&self) -> (Vec<u64>, Counted, Counted) {
        let status = self.running.status();
        let edges = (0..=BUCKETS).map(Histogram::edge_ns).collect();
        let of = |histogram: &Histogram| (histogram.counts().to_vec(), histogram.worst_ns());
        (edges, of(&status.late), of(&status.work))
    }

    /// Why the thread got no priority, no locked memory, no processor that stays awake, none of its own, each nothing where it did; nothing in virtual time.
    fn refused(&self) -> Option<[Option<String>; 4]> {
        self.running
            .granted()
            .map(|given| [&given.fifo, &given.locked, &given.awake, &given.pinned].map(|it| it.as_ref().err().cloned()))
    }

    /// Ends the loop with all its axes, their drives off, and closes the record.
    fn end(&self, py: Python<'_>) {
        py.detach(|| self.running.end());
    }
}

/// The nonlinear machine of a loader on its own, for another process to drive.
#[pyclass(frozen, module = "forcefeel._core")]
pub struct LiveMachine {
    machine: Mutex<Box<dyn InputOutput>>,
}

#[pymethods]
impl LiveMachine {
    #[new]
    #[pyo3(signature = (setup, *, script = None))]
    fn new(setup: &LiveSetup, script: Option<ScriptOf<'_>>) -> PyResult<Self> {
        let script = script.map_or(Ok(Script::NONE), |script| script.script())?;
        let (machine, _) = simulated(&setup.setup, script);
        Ok(Self { machine: Mutex::new(machine) })
    }

    /// Goes on to the next sample: load cell, drive, base of the column, pilot's force, force sensor at the grip; nothing where the sensors are silent.
    fn read(&self) -> Option<[f64; SENSORS + 1]> {
        let sampled = self.machine.lock().unwrap_or_else(PoisonError::into_inner).read()?;
        let [force, position, base, grip] = sampled.sample.sensors;
        Some([force, position, base, sampled.sample.pilot_force, grip])
    }

    /// The command that answers the sample.
    fn write(&self, command: f64, enable: bool) {
        let command = Command { cycle: 0, command, enable, state: 0 };
        self.machine.lock().unwrap_or_else(PoisonError::into_inner).write(&command);
    }

    /// Does something to it.
    #[pyo3(signature = (name, sensor = 0, number = None))]
    fn disturb(&self, name: &str, sensor: usize, number: Option<f64>) -> PyResult<()> {
        let disturbance = disturbance_of(name, sensor, number)?;
        self.machine.lock().unwrap_or_else(PoisonError::into_inner).disturb(disturbance);
        Ok(())
    }
}

pub fn request_of(name: &str, numbers: &[f64]) -> PyResult<LoopRequest> {
    LoopRequest::of(name, numbers)
        .ok_or_else(|| refused(format!("request: {name:?} with {} numbers is none", numbers.len())))
}

/// Whole cycles, as a number from Python.
fn cycles_of(number: f64) -> PyResult<usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked to be small and not negative")]
    (0.0..=1e3)
        .contains(&number)
        .then_some(number as usize)
        .ok_or_else(|| refused(format!("number: expected 0 to 1000 cycles, got {number}")))
}

pub fn disturbance_of(name: &str, sensor: usize, number: Option<f64>) -> PyResult<Disturbance> {
    if sensor >= SENSORS {
        return Err(refused(format!("sensor: expected a place below {SENSORS}, got {sensor}")));
    }
    Ok(match name {
        "force" => Disturbance::Force(number.unwrap_or(0.0)),
        "hold_at" => Disturbance::HoldAt(number),
        "no_samples" => Disturbance::Fault(Fault::Silent),
        "stuck" => Disturbance::Fault(Fault::Stuck(sensor)),
        "not_a_number" => Disturbance::Fault(Fault::NotANumber(sensor)),
        "jump" => Disturbance::Fault(Fault::Jump(sensor, number.unwrap_or(0.0))),
        "spike" => Disturbance::Fault(Fault::Spike(sensor, number.unwrap_or(0.0))),
        "reversed" => Disturbance::Fault(Fault::Reversed(sensor)),
        "hardover" => Disturbance::Fault(Fault::Hardover(number.unwrap_or(0.0))),
        "late" => Disturbance::Fault(Fault::Late(cycles_of(number.unwrap_or(0.0))?)),
        "ignores_command" => Disturbance::Fault(Fault::Deaf),
        "link" => Disturbance::Link(number != Some(0.0)),
        "repair" => Disturbance::Repair,
        other => {
            return Err(refused(format!(
                "name: expected force, hold_at, no_samples, stuck, not_a_number, jump, spike, reversed, late, ignores_command, hardover, link or repair, got {other:?}"
            )));
        }
    })
}

/// Names of the columns of a live run.
#[pyfunction]
pub fn live_columns() -> Vec<&'static str> {
    NAMES.to_vec()
}

/// Names of the supervisor's states.
#[pyfunction]
pub fn live_states() -> Vec<&'static str> {
    STATES.iter().map(|state| state.name()).collect()
}

/// Name and sentence of each of the supervisor's trips.
#[pyfunction]
pub fn live_trips() -> Vec<(&'static str, &'static str)> {
    trips()
}

/// A record, or that of an axis in it: what was written about it, its columns, its rows, its requests, why the file breaks off if it does, why it ended if it says so.
#[pyfunction]
#[pyo3(signature = (data, axis = None))]
#[expect(clippy::type_complexity, reason = "a tuple for Python, which takes it apart at once")]
pub fn live_record<'py>(
    py: Python<'py>,
    data: &[u8],
    axis: Option<&str>,
) -> PyResult<(BTreeMap<String, String>, Vec<String>, Array<'py>, Vec<Requested>, Option<String>, Option<String>)> {
    let Contents { about, columns, rows, requests, broken, ended, .. } =
        py.detach(|| read(data, axis)).map_err(refused)?;
    let shape = [rows.len() / columns.len().max(1), columns.len()];
    let named = |(cycle, request): &(u64, LoopRequest)| {
        let (name, numbers) = request.numbers();
        (*cycle, name.to_string(), numbers)
    };
    let requests = requests.iter().map(named).collect();
    Ok((about, columns, PyArray1::from_vec(py, rows).reshape(shape)?, requests, broken, ended))
}

/// Cycles of a record that were run again, the first number that differs (cycle, column, as recorded, as replayed), the first cycle that is
/// missing, why the file breaks off if it does, why it ended if it says so.
#[pyfunction]
#[pyo3(signature = (data, axis = None))]
#[expect(clippy::type_complexity, reason = "a tuple for Python, which takes it apart at once")]
pub fn live_replay(
    py: Python<'_>,
    data: &[u8],
    axis: Option<&str>,
) -> PyResult<(u64, Option<(u64, &'static str, f64, f64)>, Option<u64>, Option<String>, Option<String>)> {
    let again = || {
        let contents = read(data, axis)?;
        Ok::<_, String>((replay(&contents)?, contents.broken, contents.ended))
    };
    let (address, broken, ended) = py.detach(again).map_err(refused)?;
    Ok((address.cycles, address.difference, address.gap, broken, ended))
}
