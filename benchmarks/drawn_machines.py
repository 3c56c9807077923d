"""Machines that are not what their loader file says, and their records from an integrator that shares no line with the engine."""

import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "bench"))

import bench_machine

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord
from forcefeel.simulation.inputs import Multisine

FITTED = {
    "linkage.stiffness": ("link_stiffness", "lb/in"),
    "linkage.damping": ("link_damping", "lb s/in"),
    "column.inertia": ("inertia", "lb in s^2"),
    "valve.current_gain": ("current_gain", "in^3/(s mA)"),
    "column.coulomb_friction": ("coulomb_friction", "lb"),
}
"""What is to be identified: its name in ``bench_machine`` and its unit there."""

OTHERS = {
    "amplifier.admittance": ("admittance", "mA/V"),
    "valve.pressure_gain": ("pressure_gain", "in^5/(lb s)"),
    "valve.natural_frequency": ("valve_frequency", "rad/s"),
    "valve.damping_ratio": ("valve_damping", ""),
    "actuator.area": ("area", "in^2"),
    "actuator.oil_volume": ("oil_volume", "in^3"),
    "actuator.bulk_modulus": ("bulk_modulus", "lb/in^2"),
    "linkage.ratio": ("ratio", ""),
    "column.base_arm": ("base_arm", "in"),
    "column.grip_arm": ("grip_arm", "in"),
    "potentiometer.gain": ("potentiometer_gain", "V/in"),
    "load_cell.gain": ("load_cell_gain", "V/lb"),
}
"""What else makes the closed servo, likewise."""

CHANNELS = tuple(bench_machine.SI)
SPREAD, NOISE = 0.2, 0.01
TIME_S, RATE_HZ, PERIOD_S = 60.0, 1000.0, 10.0
PEAK_V, FROM_HZ, TO_HZ, LINES = 2.0, 0.2, 40.0, 60
FRICTION_LB, BREAKAWAY_LB, CURRENT_LIMIT_MA = 1.5, 2.0, 15.0

FILE = np.array([*(getattr(bench_machine.Machine(), name) for name, _ in list(FITTED.values())[:-1]), FRICTION_LB])
"""Values of `FITTED` in the loader file."""

FACTOR = 2.0
"""The other parameters of further loaders are the built-in one's times 1/2 to 2."""
SLOWEST_PER_S = 1.0
"""A draw whose position loop settles more slowly, or not at all, is no servo; another is taken."""


@dataclass(frozen=True)
class Drawn:
    """One loader as its file has it, and machines of it.

    Attributes:
        others: Values of `OTHERS` in their units, in the file and in every machine.
        truth: Values of `FITTED` in their units, (machines, 5); the file has `FILE`.
    """

    others: dict[str, float]
    truth: np.ndarray

    @cached_property
    def loader(self):
        """The loader as its file has it."""
        values = dict(zip(FITTED, FILE.tolist(), strict=True)) | self.others
        units = {key: unit for key, (_, unit) in (FITTED | OTHERS).items()}
        texts = {key: f"{value!r} {units[key]}" if units[key] else value for key, value in values.items()}
        friction = {"column.static_friction": f"{BREAKAWAY_LB} lb", "amplifier.current_limit": f"{CURRENT_LIMIT_MA} mA"}
        report = ff.elevator()
        return report.with_tolerances(dict.fromkeys(report.tolerances)).replace(texts | friction, si=True)

    @property
    def truth_si(self):
        """The same in SI units."""
        return self.truth * np.array([self.loader[key] for key in FITTED]) / FILE

    def machine(self, which=slice(None)):
        """The machines."""
        names = [name for name, _ in FITTED.values()]
        return bench_machine.Machine(
            **dict(zip(names, self.truth[which].T, strict=True)),
            **{OTHERS[key][0]: value for key, value in self.others.items()},
            static_friction=BREAKAWAY_LB,
            current_limit=CURRENT_LIMIT_MA,
        )


def machines(how_many, seed=1974):
    """Machines of the built-in loader, each with its own values of `FITTED` within `SPREAD` of the file's."""
    return Drawn({}, FILE * _spread(np.random.default_rng(seed), how_many))


def further_loaders(how_many, seed=2024):
    """Loaders whose other parameters are the built-in one's times 1/2 to 2, one machine of each."""
    random, report, loaders = np.random.default_rng(seed), bench_machine.Machine(), []
    while len(loaders) < how_many:
        factors = FACTOR ** random.uniform(-1, 1, len(OTHERS))
        others = {
            key: float(getattr(report, name) * factor)
            for (key, (name, _)), factor in zip(OTHERS.items(), factors, strict=True)
        }
        others["linkage.ratio"] = min(others["linkage.ratio"], 1.0)  # l_2 / (l_1 + l_2)
        drawn = Drawn(others, FILE * _spread(random, 1))
        filed = Drawn(others, FILE[np.newaxis])
        if (
            max(bench_machine.poles(loader.machine(), "servo-closed").real.max() for loader in (drawn, filed))
            < -SLOWEST_PER_S
        ):
            loaders.append(drawn)
    return loaders


def _spread(random, how_many):
    return 1 + SPREAD * random.uniform(-1, 1, (how_many, len(FITTED)))


def test_signal(drawn):
    """Times and a multisine that comes softly, in V; the piston is sent as far on every loader."""
    lines = np.unique(np.rint(np.geomspace(FROM_HZ, TO_HZ, LINES) * PERIOD_S)) / PERIOD_S
    time_s = np.arange(round(TIME_S * RATE_HZ) + 1) / RATE_HZ
    wave = Multisine(PEAK_V, tuple(lines.tolist()), PERIOD_S, seed=1).sample(TIME_S, 1 / RATE_HZ)
    report = bench_machine.Machine().potentiometer_gain
    size = drawn.others.get("potentiometer.gain", report) / report
    return time_s, size * np.append(wave.start, wave.end[-1]) * np.clip(time_s, 0, 1)


def records(drawn, which, seed):
    """A record of each of the machines ``which`` with every channel, SI units, with noise."""
    time_s, signal = test_signal(drawn)
    exact = bench_machine.run(drawn.machine(which), "servo-closed", RATE_HZ, test_signal=signal)
    random = np.random.default_rng([*np.atleast_1d(seed), which.start])
    readings = {}
    for channel, values in exact.items():
        size = NOISE * values.std(axis=1, keepdims=True)
        readings[channel] = bench_machine.SI[channel] * (values + size * random.standard_normal(values.shape))
    for k in range(len(drawn.truth[which])):
        channels = {"test_signal": signal, **{channel: values[k] for channel, values in readings.items()}}
        yield BenchRecord(f"machine {which.start + k}", Experiment.read("servo-closed"), time_s, channels)
