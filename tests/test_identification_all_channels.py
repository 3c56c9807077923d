"""Fits to records that share no line with the engine, for what a bench may measure: right to within their own standard errors."""

from functools import cache

import bench_machine
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord
from tests import witness

TRUTH = {
    "linkage.stiffness": (5230.0, "lb/in", "link_stiffness"),
    "linkage.damping": (19.4, "lb s/in", "link_damping"),
    "column.inertia": (40.6, "lb in s^2", "inertia"),
    "valve.current_gain": (4.87, "in^3/(s mA)", "current_gain"),
    "column.coulomb_friction": (1.3, "lb", "coulomb_friction"),
}
BREAKAWAY_LB, LIMIT_MA = 1.8, 15.0
ERRORS = 4  # standard errors
SECONDS, RATE_HZ, PERIOD_S, NOISE, VOLTS = 20.0, 1000.0, 10.0, 0.01, 3.0

SETS = (
    "column_angle piston_position",
    "column_angle piston_position load_pressure",
    "column_angle load_cell_force",
    "column_angle actuator_flow",
    "load_pressure",
    " ".join(bench_machine.SI),
)


@cache
def recorded():
    """20 s of the closed servo under a multisine of 0.2 to 40 Hz, every channel with 1 % of noise, SI units."""
    random = np.random.default_rng(7)
    time_s = np.arange(round(SECONDS * RATE_HZ) + 1) / RATE_HZ
    lines = np.unique(np.rint(np.geomspace(0.2, 40.0, 60) * PERIOD_S)) / PERIOD_S
    wave = sum(np.cos(2 * np.pi * (f * time_s + random.random())) for f in lines)
    signal = VOLTS * wave / np.sqrt(len(lines) / 2) * np.clip(time_s, 0, 1)
    values = {name: value for value, _, name in TRUTH.values()}
    machine = bench_machine.Machine(**values, static_friction=BREAKAWAY_LB, current_limit=LIMIT_MA)
    channels = {"test_signal": signal}
    for name, (exact,) in bench_machine.run(machine, "servo-closed", RATE_HZ, test_signal=signal).items():
        noisy = exact + NOISE * exact.std() * random.standard_normal(len(exact))
        channels[name] = bench_machine.SI[name] * noisy
    return time_s, channels


@pytest.fixture(scope="module")
def loader():
    """The file: the report's machine, a guess of its friction."""
    loader = ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))
    friction = {"column.coulomb_friction": "1.8 lb", "column.static_friction": f"{BREAKAWAY_LB} lb"}
    return loader.replace({**friction, "amplifier.current_limit": f"{LIMIT_MA} mA"})


@pytest.mark.parametrize("measured", SETS)
def test_every_parameter_is_within_its_standard_errors(loader, measured):
    time_s, channels = recorded()
    seen = {name: channels[name] for name in ("test_signal", *measured.split())}
    record = BenchRecord("multisine", Experiment.read("servo-closed"), time_s, seen)
    found = ff.identify(loader, [record], tuple(TRUTH), starts=1)
    machine = loader.replace({key: f"{value} {unit}" for key, (value, unit, _) in TRUTH.items()})
    apart = {it.unknown.symbol: (it.value - machine[it.unknown.key]) / it.deviation for it in found.estimates}
    assert max(abs(it) for it in apart.values()) < ERRORS, apart


def test_its_units_are_those_of_the_other_witness():
    assert (bench_machine.LBF, bench_machine.INCH) == (witness.LBF, witness.INCH)
