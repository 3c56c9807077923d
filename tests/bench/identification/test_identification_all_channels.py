"""Fits to records that share no line with the engine, for what a bench may measure: right to within their own standard errors."""

from functools import cache

import bench_machine
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord
from tests import witness
from tests.parametrization import mostly_slow

TRUTH = {
    "linkage.stiffness": (5230.0, "lb/in", "link_stiffness"),
    "linkage.damping": (19.4, "lb s/in", "link_damping"),
    "column.inertia": (40.6, "lb in s^2", "inertia"),
    "valve.current_gain": (4.87, "in^3/(s mA)", "current_gain"),
    "column.coulomb_friction": (1.3, "lb", "coulomb_friction"),
}
BREAKAWAY_LB, LIMIT_MA = 1.8, 15.0
ERRORS = 4  # standard errors
SECONDS, RATE_HZ, PERIOD_S, NOISE, VOLTS = 15.0, 1000.0, 10.0, 0.01, 3.0

SETS = (
    "column_angle piston_position load_pressure",
    "column_angle load_cell_force",
    "load_pressure",
    " ".join(bench_machine.SI),
)


CONTROLLER = bench_machine.Controller(5e-4, delay=1)


@cache
def recorded(drive="test_signal", controller=None):
    """15 s of the closed servo under a multisine of 0.2 to 40 Hz, every channel with 1 % of noise, SI units."""
    random = np.random.default_rng(7)
    time_s = np.arange(round(SECONDS * RATE_HZ) + 1) / RATE_HZ
    lines = np.unique(np.rint(np.geomspace(0.2, 40.0, 60) * PERIOD_S)) / PERIOD_S
    wave = sum(np.cos(2 * np.pi * (f * time_s + random.random())) for f in lines)
    signal = VOLTS * wave / np.sqrt(len(lines) / 2) * np.clip(time_s, 0, 1)
    values = {name: value for value, _, name in TRUTH.values()}
    machine = bench_machine.Machine(**values, static_friction=BREAKAWAY_LB, current_limit=LIMIT_MA)
    run = bench_machine.run(machine, "servo-closed", RATE_HZ, controller=controller, **{drive: signal})
    channels = {drive: signal}
    for name, (exact,) in run.items():
        noisy = exact + NOISE * exact.std() * random.standard_normal(len(exact))
        channels[name] = bench_machine.SI[name] * noisy
    return time_s, channels


@pytest.fixture(scope="module")
def loader():
    """The file: the report's machine, a guess of its friction."""
    loader = ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances))
    friction = {"column.coulomb_friction": "1.8 lb", "column.static_friction": f"{BREAKAWAY_LB} lb"}
    return loader.replace({**friction, "amplifier.current_limit": f"{LIMIT_MA} mA"}, si=True)


def apart(loader, record):
    """Standard errors between what is identified and what the machine is."""
    found = ff.identify(loader, [record], tuple(TRUTH), starts=1)
    machine = loader.replace({key: f"{value} {unit}" for key, (value, unit, _) in TRUTH.items()})
    return {it.unknown.symbol: (it.value - machine[it.unknown.key]) / it.deviation for it in found.estimates}


def record_of(names, drive="test_signal", controller=None, said=None):
    """The record with these channels; ``said``: the drive that its file tells of."""
    time_s, channels = recorded(drive, controller)
    said = said or drive
    seen = {said: channels[drive], **{name: channels[name] for name in names.split()}}
    return BenchRecord("multisine", Experiment.read(f"servo-closed {said}"), time_s, seen)


@pytest.mark.slow
@pytest.mark.parametrize("measured", mostly_slow(SETS))
def test_every_parameter_is_within_its_standard_errors(loader, measured):
    found = apart(loader, record_of(measured))
    assert max(abs(it) for it in found.values()) < ERRORS, found


@pytest.mark.slow
@pytest.mark.parametrize(("drive", "other"), [("test_signal", "command_signal"), ("command_signal", "test_signal")])
def test_signal_input_point_matters_under_a_digital_controller(loader, drive, other):
    digital = loader.replace({"controller.period": "0.5 ms", "controller.delay": "0.5 ms"})
    channels = "column_angle piston_position load_pressure"
    found = apart(digital, record_of(channels, drive, CONTROLLER))
    assert max(abs(it) for it in found.values()) < ERRORS, found
    misled = apart(digital, record_of(channels, drive, CONTROLLER, said=other))
    assert max(abs(it) for it in misled.values()) > 5 * ERRORS


def test_bench_machine_units_match_the_reference():
    assert (bench_machine.LBF, bench_machine.INCH) == (witness.LBF, witness.INCH)
