"""One machine in the engine and in its nonlinear witness: the same numbers, the same inputs, the same start.

Angles in rad; what a caller gives is in the witness's U.S. units.
"""

import math
from dataclasses import dataclass, fields, replace

import numpy as np
from scipy.optimize import brentq

import forcefeel as ff
from forcefeel.loader.parameters import TABLE
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import HandsOff, Schedule
from tests import nonlinear_witness as witness
from tests.nonlinear_witness import Machine, Signals, Solver

LB, IN, DEG = 4.4482216152605, 0.0254, math.radians(1)
PSI = LB / IN**2
TRAVEL = 0.70
"""Full travel of the column in rad: errors are shares of it."""

GAINS = (-4.93, -0.000026, 22.02, 0.669, 0.506, -0.018, -0.0065)
"""Published state feedback in V per in, lb/in^2, rad, rad/s, in, in/s, lb."""

WITNESS = Solver("LSODA", 1e-9)
"""Accurate to some 1e-8 rad, a hundredth of what the engine is asked for."""

_ROWS = {
    "amplifier": "admittance current_limit",
    "valve": "current_gain pressure_gain rated_flow rated_current supply_pressure orifice flow_limit",
    "actuator": "area oil_volume bulk_modulus relief_pressure relief_gain seal_friction",
    "linkage": "ratio backlash",
    "column": "base_arm grip_arm viscous_friction gravity_torque gravity_angle stop_low stop_high stop_stiffness stop_damping "
    "coulomb_friction static_friction stribeck_velocity friction_asymmetry",
    "controller": "period delay input_range input_bits output_range output_bits antiwindup",
    "pilot": "arm_mass arm_damping arm_stiffness",
}
_OTHERS = {
    "valve_damping_ratio": "valve.damping_ratio",
    "valve_frequency": "valve.natural_frequency",
    "link_stiffness": "linkage.stiffness",
    "link_damping": "linkage.damping",
    "column_inertia": "column.inertia",
    "maximum_stiffness": "feel.maximum_stiffness",
}
_PREFIXES = ("feel", "load_cell", "potentiometer", "column_sensor")
_NO_ROW = {"gains", "orifice_smoothing", "feel_curve", "feel_q"}
_SI_ALREADY = {"deg", "deg/s", "Hz", "ms"}  # the witness has rad, rad/s, s


def _keys():
    """Row of the parameter table for each field of a `Machine`."""
    keys = _OTHERS | {name: f"{part}.{name}" for part, names in _ROWS.items() for name in names.split()}
    for name in (field.name for field in fields(Machine)):
        part = next((prefix for prefix in _PREFIXES if name.startswith(prefix + "_")), None)
        if name not in keys and name not in _NO_ROW:
            keys[name] = f"{part}.{name.removeprefix(part + '_')}"
    return keys


KEYS = _keys()


def _si(name, value):
    if math.isinf(value):
        return None
    if name == "feel_shaker_frequency":
        return 2 * math.pi * value
    row = TABLE[KEYS[name]]
    return value if row.unit_us in _SI_ALREADY else value * row.default_si / row.default_us


def loader_of(machine):
    """The elevator loader with the fields of a machine that differ from the default."""
    off, changes = Machine(), {}
    for name, key in KEYS.items():
        value = getattr(machine, name)
        if value != getattr(off, name):
            changes[key] = value if name == "orifice" else _si(name, value)
    curves = {}
    if machine.feel_curve:
        angles, forces = machine.feel_curve
        curves["force_curve"] = ff.loader.Curve(angles, tuple(LB * force for force in forces))
    if machine.feel_q:
        curves["stiffness_factor"] = ff.loader.Curve(*machine.feel_q)
    return replace(ff.elevator().replace(changes, si=True), **curves)


def law_of(machine):
    """The machine's law; by its name for the original loop."""
    if machine.gains is None:
        return "original"
    units = (1 / IN, 1 / PSI, 1.0, 1.0, 1 / IN, 1 / IN, 1 / LB)
    gains = [gain * unit for gain, unit in zip(machine.gains, units, strict=True)]
    return ff.laws.GainLaw(gains, machine.ratio * machine.base_arm * IN, "rad")


def schedule(steps):
    """Steps of the witness as an input of the engine."""
    if not steps:
        return None
    times, values, last = [], [], 0.0
    for time, value in steps:
        times += [time, time] if time > 0 else [time]
        values += [last, value] if time > 0 else [value]
        last = value
    return Schedule(tuple(times), tuple(values))


def at_rest(machine, signals=None):
    """The witness's state at rest hands off, as the engine starts: its hysteresis relaxed."""
    angle = brentq(
        lambda angle: held(machine, angle, signals)["force"], -0.05, 0.05, xtol=1e-15, rtol=1e-14
    )  # some bits
    return held(machine, angle, signals)


def held(machine, angle, signals=None):
    """The same with the grip held at an angle."""
    given = signals or Signals()
    first = [next((value for time, value in steps if time <= 0), 0.0) for steps in (given.trim, given.dynamic_pressure)]
    start = witness.release(replace(machine, feel_hysteresis=0.0), angle, *first)
    return start | {"slider": start["delta"] / machine.volts_per_angle}


@dataclass(frozen=True)
class Case:
    """A machine and what is done to it.

    ``force``: steps [(time, lb), ...] of the witness; ``engine_force``: the same for the engine; ``start``: the witness's state.
    """

    machine: Machine
    force: list
    engine_force: object
    duration: float = 0.6
    start: dict | None = None
    signals: Signals | None = None

    def engine(self, step_s=1e-3, sample_s=1e-3):
        """The engine's run."""
        given = self.signals or Signals()
        inputs = {
            "trim_rad": schedule(given.trim),
            "dynamic_pressure_pa": schedule(given.dynamic_pressure),
            "shaker": schedule(given.shaker),
        }
        scenario = Scenario(self.engine_force, self.duration, step_s, sample_s, **inputs)
        return simulate(loader_of(self.machine), scenario, law_of(self.machine))

    def witness(self, solver=WITNESS):
        """The witness's run, a sample every millisecond."""
        times = np.arange(round(self.duration * 1000) + 1) / 1000
        return witness.simulate(
            self.machine, self.force, self.duration, times, self.start, signals=self.signals, solver=solver
        )

    def errors(self, reference, *steps_s):
        """Largest error of the column angle at each step, as share of the travel."""
        return [
            float(np.abs(self.engine(step).history.column_angle_rad.values - reference["theta"]).max()) / TRAVEL
            for step in steps_s
        ]


def idle(duration=0.6):
    """Nobody at the grip, for both."""
    return {"force": [], "engine_force": HandsOff(), "duration": duration}
