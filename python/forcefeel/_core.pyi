"""The Rust model and solvers.

Numbers are in SI units. `values` holds a loader's values in the order of the rows of `parameters()` that stand in no
other row's stead. Matrices come as `(A, B, C, D)` of eqs. (14a), (14b).
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import ClassVar, Literal, Self, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "BOUND_RAD",
    "CONTACT_SMOOTHING_S",
    "FMU_CLOCK",
    "MOST_LINK_DELAY",
    "MOST_RECURSION_STEPS",
    "OBSERVER_NUMBERS",
    "PERIOD_BASE",
    "PERIOD_COMMAND",
    "PERIOD_SHOWN",
    "ArgumentError",
    "AxisSource",
    "BoardAxis",
    "BusDrive",
    "BusEmulator",
    "ExportedLaw",
    "ExportedPair",
    "FlownFeel",
    "FmuVariable",
    "GainLaw",
    "LawSource",
    "LiveLoop",
    "LiveMachine",
    "LiveSetup",
    "LockStep",
    "Loops",
    "MotorStatics",
    "Parameter",
    "Recursion",
    "ReleaseMeasuring",
    "Simulation",
    "ThreadsError",
    "ValveStatics",
    "balanced",
    "board_sources",
    "bus_frames",
    "bus_kinds",
    "bus_nodes",
    "channels",
    "column_grip_force",
    "compliant",
    "design_plant",
    "discretize",
    "drive_fault",
    "electric_plant",
    "exponential",
    "fastest_on_shaft",
    "fault_kinds",
    "feel_frequencies",
    "feel_frequency",
    "feel_from_frequencies",
    "feel_from_frequency",
    "feel_held_along",
    "feel_held_between",
    "feel_held_in_flight",
    "feel_steps",
    "feel_transitions",
    "fmu_variables",
    "frequency_response",
    "grip_force",
    "hinge_moment",
    "host_answer",
    "host_numbers",
    "host_packet",
    "host_request",
    "host_switches",
    "ideal_feel",
    "inside_unit_circle",
    "judge_releases",
    "linear_slopes",
    "link_parameters",
    "linkage_from_resonance",
    "linked_feels",
    "linked_outputs",
    "live_columns",
    "live_record",
    "live_replay",
    "live_states",
    "live_trips",
    "orifice_flow",
    "parameters",
    "parts",
    "propagated",
    "recursion",
    "release_feature_groups",
    "release_rule_names",
    "released",
    "rigid",
    "safety_functions",
    "sampled_loops",
    "sampled_slopes",
    "schedule",
    "simulate_linked",
    "simulation_measure",
    "simulation_measures",
    "simulation_outputs",
    "start_loops",
    "stationary",
    "supervised_faults",
    "supervised_pair_faults",
    "valve_gains",
]

_Array: TypeAlias = NDArray[np.float64]

OBSERVER_NUMBERS: int
"""Numbers of a sampled law with an observer."""
CONTACT_SMOOTHING_S: float
"""Time constant over which a law smooths the torque by which it notices contact."""
PERIOD_BASE: int
"""Place of the column's base among the states of a period."""
PERIOD_COMMAND: int
"""Place of the youngest command."""
PERIOD_SHOWN: int
"""Place of the first of what the sensors showed."""
MOST_RECURSION_STEPS: int
"""Longest recursion (22)."""
MOST_LINK_DELAY: int
"""Most periods of delay of an electronic link."""
BOUND_RAD: float
FMU_CLOCK: int
"""A column that turns so far has no model."""
_Matrices: TypeAlias = tuple[_Array, _Array, _Array, _Array]
_Sloped: TypeAlias = tuple[_Array, _Array, _Array, _Array, _Array, _Array, _Array, _Array]
_Law: TypeAlias = GainLaw | Literal["open", "position", "original"]

class ArgumentError(ValueError):
    """An argument has no meaning; the message names it."""

class ThreadsError(RuntimeError):
    """The system gives no threads."""

@final
class Parameter:
    """One row of the parameter table."""

    @property
    def part(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def symbol(self) -> str: ...
    @property
    def meaning(self) -> str: ...
    @property
    def unit_si(self) -> str: ...
    @property
    def unit_metric(self) -> str: ...
    @property
    def unit_us(self) -> str: ...
    @property
    def default_us(self) -> float: ...
    @property
    def default_si(self) -> float: ...
    @property
    def off_us(self) -> float | None: ...
    @property
    def off_si(self) -> float | None: ...
    @property
    def minimum_us(self) -> float: ...
    @property
    def maximum_us(self) -> float: ...
    @property
    def minimum_si(self) -> float: ...
    @property
    def maximum_si(self) -> float: ...
    @property
    def source(self) -> str: ...
    @property
    def instead_of(self) -> list[str]: ...
    @property
    def drive(self) -> str | None: ...

@final
class GainLaw:
    """The law that drives the servo amplifier: seven gains on the design plant's states and the load cell's scale.

    Gains in V per SI unit of x_p, p, delta, delta', x_b, x_b', F_p; ``load_cell_arm`` in m (m V/rad where delta is a
    voltage); ``displacement_unit``, of delta, "V" or "rad".
    """

    def __new__(cls, gains: Sequence[float], load_cell_arm: float, displacement_unit: str = "rad") -> GainLaw: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __getnewargs__(self) -> tuple[list[float], float, str]: ...
    @staticmethod
    def none(values: _Array) -> GainLaw: ...
    @staticmethod
    def position_loop(values: _Array) -> GainLaw: ...
    @staticmethod
    def original(values: _Array) -> GainLaw: ...
    @staticmethod
    def state_feedback(values: _Array, gains: Sequence[float]) -> GainLaw: ...
    @property
    def gains(self) -> list[float]: ...
    @property
    def load_cell_arm(self) -> float: ...
    @property
    def displacement_unit(self) -> str: ...

@final
class Loops:
    """Closed loops of eq. (17) that share ``common`` but for the parameters at ``columns``: a row of ``varied`` for each.

    One ``law`` for all, or state-feedback ``gains`` (loops, 7); neither is the original loop of each one's parameters.
    """

    def __new__(
        cls,
        common: _Array,
        columns: Sequence[int],
        varied: _Array,
        *,
        law: GainLaw | None = None,
        gains: _Array | None = None,
    ) -> Self: ...
    def stability(self, threads: int) -> NDArray[np.uint8]: ...
    def poles(self, threads: int) -> _Array: ...
    def run(
        self,
        histories: _Array,
        force: _Array,
        step_s: float,
        *,
        every: int,
        outputs: Sequence[int],
        force_scale: _Array | None,
        start_force: float,
        held: tuple[float, int] | None,
        threads: int,
    ) -> None: ...

@final
class Recursion:
    """How recursion (22) ended, and its gains."""

    @property
    def gains(self) -> _Array: ...
    @property
    def cost(self) -> _Array: ...
    @property
    def steps(self) -> int: ...
    @property
    def change(self) -> float: ...
    @property
    def status(self) -> str: ...

@final
class LawSource:
    """The parts of C that follow from the trace of a controller's period."""

    @property
    def states(self) -> list[tuple[str, bool]]: ...
    @property
    def inputs(self) -> list[tuple[str, tuple[float, float]]]: ...
    @property
    def functions(self) -> list[str]: ...
    @property
    def step(self) -> str: ...
    @property
    def reset(self) -> str: ...
    @property
    def hinge_moment(self) -> str: ...
    @property
    def same(self) -> tuple[str, list[str]]: ...
    @property
    def own(self) -> tuple[str, list[str]]: ...
    @property
    def operations(self) -> tuple[int, int]: ...

@final
class AxisSource:
    """The parts of C that follow from the trace of an axis: law, feel and supervisor."""

    @property
    def states(self) -> list[tuple[str, str, float]]: ...
    @property
    def functions(self) -> list[str]: ...
    @property
    def members(self) -> list[tuple[str, str]]: ...
    @property
    def period(self) -> str: ...
    @property
    def own(self) -> tuple[str, list[str]]: ...
    @property
    def operations(self) -> int: ...

@final
class ExportedLaw:
    """A law with its feel on a digital controller, traced or run for reference."""

    def __new__(
        cls,
        values: _Array,
        observers: _Array,
        *,
        states: int,
        period_s: float,
        single: bool,
        linked: bool = False,
        tunable: Sequence[tuple[int, tuple[float, float]]] = ...,
        curve: tuple[_Array, _Array] | None = None,
        cancellation: Sequence[float] | None = None,
    ) -> Self: ...
    def source(self, name: str) -> LawSource: ...
    def axis_source(self, name: str) -> AxisSource: ...
    def added(self, flights: _Array) -> _Array: ...
    def answers(self, inputs: _Array, settings: Sequence[tuple[int, int]]) -> _Array: ...

@final
class ExportedPair:
    """Two laws on an electronic link, traced or run for reference."""

    def __new__(
        cls, first: ExportedLaw, second: ExportedLaw, values: _Array, *, delay: int, uncouples: bool
    ) -> Self: ...
    HALVINGS: ClassVar[int]
    def source(self, name: str) -> tuple[str, str | None]: ...
    def answers(self, inputs: _Array) -> _Array: ...
    def link_answers(self, inputs: _Array) -> _Array: ...

@final
class BoardAxis:
    """One axis on a board: what its library takes of loader and law, and what it must answer."""

    def __new__(
        cls,
        values: _Array,
        laws: _Array,
        *,
        period_s: float,
        curve: tuple[_Array, _Array] | None = None,
        cancellation: Sequence[float] | None = None,
    ) -> Self: ...
    def loader(
        self,
    ) -> tuple[float, list[list[float]], list[float], list[float], list[list[float]], int, int]: ...
    def answers(
        self, inputs: _Array, words: Sequence[Sequence[int]], *, single: bool
    ) -> tuple[_Array, NDArray[np.uint32]]: ...
    def added(self, flown: _Array, *, single: bool) -> _Array: ...

def board_sources() -> list[tuple[str, str]]: ...

@final
class FmuVariable:
    """A variable of an FMU: how the library knows it, and what its description says of it."""

    @property
    def reference(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def meaning(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def causality(self) -> str: ...
    @property
    def variability(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def start(self) -> float | None: ...
    @property
    def range(self) -> tuple[float, float] | None: ...

def fmu_variables(kind: str, values: _Array, settings: int) -> list[FmuVariable]: ...

@final
class ReleaseMeasuring:
    """How releases are measured: residual band, upper and lower share of the way; see ``forcefeel.qualification``."""

    def __new__(
        cls,
        time: _Array,
        shares: Sequence[float],
        *,
        tail: int,
        held: int = 1,
        free: int = 0,
        reach: float = 0.0,
        hysteresis: float = 0.0,
    ) -> Self: ...
    def features(self, position: _Array, threads: int = 1) -> _Array: ...
    def details(self, position: _Array) -> _Array: ...

@final
class Simulation:
    """What stays the same over the runs of a simulation.

    ``inputs`` are by name (steps, 2), at the start and at the end of each step: force, trim, stiffness_factor, shaker, fade,
    test_signal, command_signal. Of those that are not given there is nothing: zero, but a factor of one.
    """

    def __new__(
        cls,
        inputs: dict[str, _Array],
        step_s: float,
        *,
        every: int = 1,
        outputs: Sequence[int] = ...,
        start_force: float = 0.0,
        held: tuple[float, int] | None = None,
        timing: tuple[int, int] | None = None,
        curve: tuple[_Array, _Array] | None = None,
        cancellation: Sequence[float] | None = None,
        changes: Sequence[tuple[int, int, _Array, _Array | None]] = ...,
    ) -> Self: ...
    def run(
        self,
        values: _Array,
        *,
        law: _Law | None = None,
        gains: _Array | None = None,
        observers: _Array | None = None,
        force_scale: _Array | None = None,
        seed: int = 0,
        first_run: int | None = None,
        angle_noise: float = 0.0,
        threads: int = 1,
    ) -> tuple[_Array, _Array]: ...
    def slopes(
        self,
        values: _Array,
        keys: Sequence[int],
        *,
        channels: Sequence[int],
        law: _Law | None = None,
        observers: _Array | None = None,
        threads: int = 1,
    ) -> tuple[_Array, _Array]:
        """What ``channels`` of a bench show, and its exact slopes along the parameters at ``keys``.

        Returns histories (runs, channels, samples) and slopes (runs, keys, channels, samples). Noise and the steps of sensors
        and converters are left out. What a change of the feel programs does not move with the parameters.
        """
    def feel_alone(self, values: _Array, longest_s: float) -> _Array:
        """Angle (steps + 1) of the programmed feel alone of one loader, in parts of a step no longer than so much."""

def sampled_loops(
    values: _Array,
    step_s: float,
    timing: tuple[int, int],
    *,
    law: _Law | None = None,
    gains: _Array | None = None,
    observers: _Array | None = None,
    threads: int = 1,
) -> tuple[list[int], _Array]:
    """The loop under a digital controller: `x+ = M x + b_e e_T + b_F F_p`.

    Returns the places of the states that are kept, and `[M, b_e, b_F]` of a period of each loader (loops, states, states + 2),
    with a test signal on the command and a pilot force that stays through the period.
    """

def grip_force(values: _Array, moments: _Array) -> _Array:
    """What the grip's sensor shows, `K_g (F_p - (m_a + m_o) R_p theta'' - d_a R_p theta' - k_a R_p theta)`, its offset left out.

    Of moments `F_p, theta, theta', theta''`, (moments, 4).
    """

def channels(drive: str = "hydraulic") -> list[tuple[str, str]]:
    """Name and SI unit of each channel of a bench with a loader of this drive."""

def linear_slopes(values: _Array, keys: Sequence[int], *, linkage: Literal["rigid", "compliant"], law: _Law) -> _Sloped:
    """The loader on a bench in continuous time, `x' = A x + B u`, `y = C x + D u`, and its exact slopes along parameters.

    Inputs are the test signal in V and the pilot's force in N, outputs the `channels`, states those of `rigid` or `compliant`.
    A law by name is made of the values and moves with them: "open" leaves the amplifier without a command, "position" closes the
    servo's position loop, "original" is eq. (13). Those of a GainLaw stand.

    Returns `(A, B, C, D, dA, dB, dC, dD)`, the slopes with a leading axis over `keys`, places in the parameter table.
    """

def sampled_slopes(
    values: _Array,
    keys: Sequence[int],
    step_s: float,
    timing: tuple[int, int],
    *,
    law: _Law | None = None,
    observers: _Array | None = None,
) -> _Sloped:
    """The same for the loader under a digital controller, from one period to the next: `x+ = M x + B u`, `y = C x + D u`.

    `y` is what the channels show at the start of a period, the sample; the states are those of `sampled_loops` and what the
    channels see besides. Steps of sensors and converters are left out, and so is what holds or touches.
    """

def parameters() -> list[Parameter]: ...
def link_parameters() -> list[Parameter]: ...
def linked_feels(
    first: _Array,
    second: _Array,
    values: _Array,
    release: tuple[float, float],
    samples: int,
    *,
    uncouples: bool = False,
    threads: int = 1,
) -> _Array:
    """Angles (pairs, 2, samples) of two feels each, rows I, B, G, on a link without delay, let go together.

    ``release``: angle, and time between samples. ``values``: of the link, in the order of ``link_parameters``.
    """

def linked_outputs() -> list[tuple[str, str]]: ...
def fastest_on_shaft(values: _Array, inertias: tuple[float, float]) -> float:
    """A rate in rad/s that no mode of two columns on a shaft is above, from its values and the inertia of each column."""

def simulate_linked(
    first: tuple[Simulation, _Array, _Law | None, _Array | None, _Array | None],
    second: tuple[Simulation, _Array, _Law | None, _Array | None, _Array | None],
    values: _Array,
    *,
    delay: int | None = None,
    uncouples: bool = False,
    disconnect: int | None = None,
    jam: tuple[int, int] | None = None,
    button: tuple[int, int] | None = None,
    samples: bool = False,
    threads: int = 1,
) -> _Array:
    """Outputs (pairs, samples, outputs) of pairs of loaders joined by links: of the first, of the second, ``linked_outputs``.

    A side is its simulation, and the values and the law of each pair, the law by name, as gains or as observers. Both have one
    step, one period and one length. ``values``: of each link, in the order of ``link_parameters``; ``delay``: periods of an
    electronic link, a mechanical one without; ``uncouples``: what has given way stays open; ``disconnect``: a step; ``jam``: side
    0 or 1, and a step; ``button``: likewise, who has priority from then on. With ``samples`` numbers of the last sample follow: of
    each side four sensors and the command, the force of both hands, and 1 if the link is open.
    """

def parts() -> list[tuple[str, str]]: ...
def released(loops: Loops, angles: _Array, angle: float, step_s: float, threads: int) -> NDArray[np.uint8]:
    """Fills `angles` (loops, samples) with the column's angle from a release at `angle` on, the pilot's arm at the grip.

    Returns a code for each loop, as `Loops.stability`; where it is not stable its angles are not numbers.
    """

def rigid(values: _Array, law: GainLaw) -> _Matrices: ...
def compliant(values: _Array, law: GainLaw) -> _Matrices: ...
def design_plant(values: _Array, pilot_arm: float) -> _Matrices: ...
def electric_plant(values: _Array) -> _Matrices: ...
def ideal_feel(values: _Array) -> _Matrices: ...
def inside_unit_circle(matrices: _Array, threads: int) -> NDArray[np.int8]:
    """Whether all eigenvalues of each matrix (count, n, n) are inside the unit circle: 1, 0, or -1 where its powers do not tell."""

def orifice_flow(values: _Array, current: _Array, pressure: _Array) -> _Array: ...
def valve_gains(values: _Array, current_share: float, pressure_share: float) -> tuple[float, float]: ...
def linkage_from_resonance(values: _Array, frequency: float, damping_ratio: float) -> tuple[float, float]: ...
def feel_from_frequency(frequency: float, damping_ratio: float, stiffness: float) -> tuple[float, float]: ...
def feel_from_frequencies(frequency: _Array, damping_ratio: _Array, stiffness: _Array) -> tuple[_Array, _Array]: ...
def feel_frequency(values: _Array) -> tuple[float, float]: ...
def feel_frequencies(settings: _Array) -> tuple[_Array, _Array]: ...
def feel_held_between(
    values: _Array, angles: _Array, stiffness_factor: float = 1.0, *, curve: tuple[_Array, _Array] | None = None
) -> _Array:
    """Lowest and highest force at the grip, (angles, 2), that hold the programmed feel at angles, eq. (11) at rest.

    Hysteresis, shaker and dry friction act to either side; the neutral is at zero.
    """

def hinge_moment(values: _Array, flight: _Array) -> _Array:
    """Force at the grip, N, spring, N m/rad, and damping, N m s/rad, (states, 3), of the hinge moment of the loader's surface.

    ``flight``: dynamic pressure, true airspeed, angle of attack, sideslip, rates of roll, pitch and yaw, load factor, Mach number,
    angle of the tab, angle of the control; (states, 11), SI units.
    """

def feel_held_in_flight(values: _Array, flight: _Array) -> _Array:
    """Force at the grip, N, (states,), that holds feel and hinge moment, without friction; ``flight`` as in ``hinge_moment``."""

@final
class FlownFeel:
    """The programmed feel with its surface in flight, from rest at an angle; eq. (11) and ``surface.rs``."""

    def __new__(cls, values: _Array, angle: float) -> FlownFeel: ...
    def run(self, force: float, flight: _Array, steps: int, step_s: float) -> float:
        """Angle, rad, after steps under a force at the grip in a flight state, which has no angle of the control."""

def feel_held_along(
    values: _Array, angles: _Array, directions: _Array, *, curve: tuple[_Array, _Array] | None = None
) -> _Array:
    """Force at the grip (angles,) that moves the programmed feel slowly along a path, eq. (11) at rest.

    Dry friction acts against each angle's direction, +1 or -1; 0 is without it. The hysteresis begins at the first angle.
    """

def column_grip_force(values: _Array, acceleration: _Array) -> _Array:
    """Force at the grip that by itself turns the column with each angular acceleration, eq. (6)."""

@final
class ValveStatics:
    """Valve and piston of a loader, seen from the grip: eqs. (1)-(5) at an even speed."""

    def __new__(cls, values: _Array) -> ValveStatics: ...
    @property
    def force_per_pressure(self) -> float:
        """Force at the grip per load pressure, N/Pa; flow per speed of the grip, m^3/m."""
    @property
    def oil_compliance(self) -> float:
        """Oil that a rise of the load pressure takes, m^3/Pa: into the link and into itself."""
    def no_load_flow(self, current: float) -> float:
        """Flow in m^3/s at a current in A and no load, whatever the spool's stroke."""
    def stall_pressure(self, flow: float) -> float:
        """Load pressure in Pa at which so much flow at no load comes to rest."""
    def flow(self, no_load: _Array, pressure: _Array) -> _Array:
        """Flow into the actuator at each pair of a flow at no load and a load pressure."""
    def needed(self, flow: _Array, pressure: _Array) -> _Array:
        """Flow at no load that lets each flow into the actuator through against its load pressure; infinite where there is none."""
    def taken(self, force: _Array, speed: _Array) -> list[_Array]:
        """Load pressure, and flow at no load, of each force at the grip and its speed along it."""

@final
class MotorStatics:
    """Motor and transmission of a loader, seen from the grip, at an even speed and a current that stays; cogging left out."""

    def __new__(cls, values: _Array) -> MotorStatics: ...
    @property
    def per_grip(self) -> float:
        """Travel of the drive's end per travel of the grip."""
    @property
    def gear(self) -> float:
        """Radians of the motor per meter of the grip."""
    @property
    def added_mass(self) -> float:
        """The rotor at the grip, kg."""
    def taken(self, force: _Array, speed: _Array) -> list[_Array]:
        """Torque, current and voltage of each force at the grip and its speed along it."""
    def voltage(self, current: _Array, speed: _Array) -> _Array:
        """Voltage of a cold phase at each current and speed of the grip."""
    def current(self, voltage: _Array, speed: _Array) -> _Array:
        """Current of a cold phase under each voltage, at each speed of the grip."""
    def given(self, current: _Array, speed: _Array) -> _Array:
        """Force at the grip of each current at its speed along it; zero where friction takes all."""
    def torque(self, current: float) -> float:
        """Torque of a current."""
    def fastest(self, voltage: float) -> float:
        """Speed of the grip at which a voltage and friction leave no force."""
    def warming(self, current: float) -> tuple[_Array, _Array]:
        """`(A, b)` of `T' = A T + b`, winding and housing over the temperature around, at a current that stays."""

def feel_transitions(settings: _Array, times: _Array) -> _Array:
    """``exp(W t)`` (settings, times, 2, 2) of the unforced feel of each row I, B, G, eq. (11), on its displacement and its rate."""

def feel_steps(settings: _Array, period: float) -> _Array:
    """``[Phi, Gamma]`` (settings, 2, 3) of the feel of each row I, B, G over a period under a torque that stays."""

def discretize(a: _Array, b: _Array, step: float) -> tuple[_Array, _Array]: ...
def exponential(a: _Array) -> _Array: ...
def propagated(phi: _Array, start: _Array, inputs: _Array) -> _Array:
    """The states (steps + 1, n) of ``x_{k+1} = phi x_k + v_k`` from ``start`` on, with ``v_k`` the rows of ``inputs``."""

def balanced(a: _Array) -> tuple[_Array, _Array]: ...
def frequency_response(a: _Array, b: _Array, c: _Array, points: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """``c (p - a)^-1 b`` at each of ``points``, complex numbers ``p``."""

def recursion(phi: _Array, h: _Array, q: _Array, r: _Array, steps: int, tolerance: float | None) -> Recursion: ...
def stationary(phi: _Array, h: _Array, q: _Array, r: _Array) -> tuple[_Array, float] | None:
    """Cost at which recursion (22) stands still, by doubling, and its residual; none if a state does not decay."""

def schedule(closed: _Array, coupling: _Array, gain_row: _Array, period: float | None, settings: _Array) -> _Array: ...
def release_feature_groups() -> list[tuple[str, int, str]]: ...
def release_rule_names() -> tuple[list[str], list[str], list[str]]:
    """Quantities of tolerances, bases of their shares, and the quantities by which a release can fail, in order."""

def judge_releases(
    values: _Array,
    reference: _Array,
    times: Sequence[Sequence[float]],
    tolerances: _Array,
    *,
    rests_fall_times: float,
    by_rise_time: bool = False,
) -> tuple[NDArray[np.int8], NDArray[np.bool_], _Array]:
    """Verdicts on releases: place of the first failing quantity or -1, whether it was evaluated, margin.

    ``values``, ``reference``: features (runs, features); one reference for all, or one for each.
    ``times``: for each side, when it is let go and when its record ends. ``tolerances`` (rows, 5): places of quantity and base,
    share, 1 where it grows with the cycle, amount in SI units; NaN where there is none.
    """

def simulation_outputs(drive: str = "hydraulic") -> list[tuple[str, str]]: ...
def simulation_measures(drive: str = "hydraulic") -> list[tuple[str, str]]: ...
def simulation_measure(outputs: _Array, dt: float, rest: float, *, free: int = 0, noise: float = 0.0) -> _Array:
    """The measures of one run (outputs, samples), whose last force holds the column at `rest`; from sample `free` on it is free.

    `noise` is what the sensors' noise moves the column by, r.m.s.
    """

@final
class LiveSetup:
    """What a loop is made of: a loader's values, its law, when the controller acts."""

    def __new__(
        cls,
        values: _Array,
        step_s: float,
        timing: tuple[int, int],
        *,
        law: _Law | None = None,
        gains: _Array | None = None,
        observers: _Array | None = None,
        curve: tuple[_Array, _Array] | None = None,
        stiffness_factor: tuple[_Array, _Array] | None = None,
        cancellation: Sequence[float] | None = None,
        supervised: bool = True,
        rendered: _Array | None = None,
        softens: bool = False,
        flap_trim: float = 0.0,
    ) -> Self: ...
    def with_test_signal(self, samples: Sequence[float], settles: int) -> LiveSetup:
        """The same with a bench signal beside the law's command, which begins once the feel has been there for so many cycles."""

_Script: TypeAlias = tuple[dict[str, _Array], float, tuple[float, int] | None, int]
_Requested: TypeAlias = tuple[int, str, list[float]]

@final
class LiveLoop:
    """An axis of a loop under way."""

    def request(self, name: str, numbers: Sequence[float]) -> bool: ...
    def disturb(self, name: str, sensor: int = 0, number: float | None = None) -> bool: ...
    def status(self) -> tuple[int, int, int, int, int, int, int, int, bool]: ...
    def recorded(self) -> tuple[int, int, str | None]: ...
    def host_status(self) -> tuple[str, tuple[int, int, int], tuple[str, float | None] | None, str | None] | None: ...
    def history(self, since: float, most: int) -> _Array: ...
    def timing(self) -> tuple[list[int], tuple[list[int], int], tuple[list[int], int]]: ...
    def refused(self) -> list[str | None] | None: ...
    def end(self) -> None: ...

@final
class LiveMachine:
    """The nonlinear machine of a loader on its own, for another process to drive."""

    def __new__(cls, setup: LiveSetup, *, script: _Script | None = None) -> Self: ...
    def read(self) -> list[float] | None: ...
    def write(self, command: float, enable: bool) -> None: ...
    def disturb(self, name: str, sensor: int = 0, number: float | None = None) -> None: ...

_Node: TypeAlias = Mapping[str, str | float | tuple[int, int] | None]

@final
class BusEmulator:
    """Machines of loaders as nodes of a bus, behind a pseudo terminal or on a network interface."""

    def __new__(
        cls, nodes: Sequence[tuple[LiveSetup, _Node, _Script | None]], *, by_clock: bool = True, power_s: float = 0.0
    ) -> Self: ...
    @property
    def port(self) -> Path: ...
    def break_wire(self, name: str, every: int, by: int) -> None: ...
    def fail(self, axis: int, code: int) -> None: ...
    def restart(self, axis: int) -> None: ...
    def add_twin(self, axis: int) -> None: ...
    def disturb(self, axis: int, name: str, sensor: int = 0, number: float | None = None) -> None: ...
    def seen(self) -> list[list[float]]: ...
    def end(self) -> None: ...

@final
class BusDrive:
    """The drive of a loader on its bus, without a loop."""

    def __new__(cls, setup: LiveSetup, node: _Node, *, by_clock: bool = True) -> Self: ...
    def play(self, currents: Sequence[float], most: float) -> tuple[list[list[float]], str | None]: ...
    def power_up(self) -> str | None: ...
    def exchange(self, command: float, enable: bool) -> tuple[list[float], int] | None: ...
    def round_trips(self, count: int) -> list[float]: ...

def bus_nodes(node: _Node) -> list[tuple[int, int, int, int, str]]: ...
def bus_frames(node: _Node) -> list[tuple[str, int, int, float, float | None]]: ...
def bus_kinds() -> list[tuple[str, int, int]]: ...
def drive_fault(number: int) -> tuple[str, str] | None: ...

@final
class LockStep:
    """A loop whose cycles are asked for, its machine simulated, a host listened to."""

    def __new__(cls, setup: LiveSetup, *, script: _Script | None = None) -> Self: ...
    def run(self, cycles: int, packet: bytes | None = None) -> _Array: ...
    @property
    def answer(self) -> bytes | None: ...
    def request(self, name: str, numbers: Sequence[float]) -> None: ...
    def disturb(self, name: str, sensor: int = 0, number: float | None = None) -> None: ...

def host_numbers() -> list[tuple[str, str, float, float, float]]: ...
def host_switches() -> dict[str, int]: ...
def host_packet(sequence: int, switches: int, numbers: Mapping[str, float]) -> bytes: ...
def host_answer(packet: bytes) -> tuple[int, int, list[float]] | None: ...
def host_request(packet: bytes) -> tuple[int, int, dict[str, float]] | None: ...
def live_columns() -> list[str]: ...
def live_states() -> list[str]: ...
def live_trips() -> list[tuple[str, str]]: ...
def start_loops(
    axes: Sequence[
        tuple[
            LiveSetup,
            _Script | None,
            str | _Node | None,
            Sequence[_Requested],
            int,
            Sequence[int],
            tuple[str, Mapping[str, str]],
        ]
    ],
    period_s: float,
    *,
    links: Sequence[tuple[tuple[int, int], Sequence[float], int | None, bool, bool]] = ...,
    host: str | None = None,
    real_time: bool = True,
    beats: int | None = None,
    record: tuple[Path, tuple[int, bool], int, int] | None = None,
    history: int = 120_000,
) -> list[LiveLoop]: ...
def live_record(
    data: bytes,
    axis: str | None = None,
) -> tuple[dict[str, str], list[str], _Array, list[_Requested], str | None, str | None]: ...
def live_replay(
    data: bytes,
    axis: str | None = None,
) -> tuple[int, tuple[int, str, float, float] | None, int | None, str | None, str | None]: ...
def safety_functions(
    values: NDArray[np.float64], drive: str, period_s: float
) -> list[tuple[str, str, int, bool, str]]: ...
def fault_kinds() -> list[str]: ...
def supervised_faults(
    values: NDArray[np.float64],
    observers: NDArray[np.float64] | None = None,
    *,
    seed: int = 0,
    first: int = 0,
    count: int = 1000,
    faults: int = 1,
    threads: int = 1,
) -> NDArray[np.float64]: ...
def supervised_pair_faults(
    values: NDArray[np.float64],
    observers: NDArray[np.float64] | None,
    links: Sequence[tuple[Sequence[int], Sequence[float], int | None, bool]],
    *,
    seed: int = 0,
    first: int = 0,
    count: int = 1000,
    faults: int = 1,
    threads: int = 1,
) -> NDArray[np.float64]: ...
