"""FMUs of a loader with a surface: a flight at their inputs gives a simulation's bits."""

import platform
import sys

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

import forcefeel as ff
from forcefeel._core import host_numbers
from tests.export.fmus import STEP_S, Imported, unzipped
from tests.export.toolchain import NONLINEAR, SURFACE
from tests.parametrization import mostly_slow

pytestmark = pytest.mark.skipif(
    (sys.platform, platform.machine()) != ("linux", "x86_64"), reason="FMUs are made on Linux x86_64 so far"
)

LASTS_S = 0.3
TIMES = np.array([0.0, 0.12, LASTS_S])
STATES = {
    "dynamic_pressure": np.array([800.0, 1500.0, 2500.0]),
    "true_airspeed": np.array([36.0, 50.0, 64.0]),
    "angle_of_attack": np.array([0.1, 0.06, 0.02]),
    "pitch_rate": np.array([0.0, 0.1, -0.1]),
    "load_factor": np.array([1.0, 1.4, 0.8]),
    "mach": np.array([0.1, 0.3, 0.7]),
    "tab": np.array([0.0, 0.1, 0.1]),
}
RELEASE = {"start_angle": 0.1, "held_until": 0.02}


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """The FMUs, the angle of the column in a simulated flight, and the flight at the start of each step."""
    loader = ff.digital_elevator().replace(NONLINEAR | SURFACE, si=True)
    exported = ff.export.Exported.of("robust", loader, "pitch")
    out = tmp_path_factory.mktemp("flown")
    ff.export.write_export(exported, ff.export.Target.FMU, out)
    flight = ff.simulation.Flight(TIMES, STATES)
    release = ff.simulation.inputs.Release(0.1, start_s=0.02)
    scenario = ff.Scenario(release, duration_s=LASTS_S, sample_s=STEP_S, flight=flight)
    angles = ff.simulate(exported.loader, scenario, exported.law).history["column_angle_rad"].to_numpy()
    pairs = flight.pairs(loader, LASTS_S, STEP_S)
    steps = [{name: float(pair[k, 0]) for name, pair in pairs.items()} for k in range(len(angles) - 1)]
    return out, angles, steps


@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_loader_in_flight_matches_simulate_bitwise(flown, version):
    out, angles, steps = flown
    with (
        Imported(unzipped(out, f"pitch_loader_{version}")) as run,
        Imported(unzipped(out, f"pitch_loader_{version}")) as still,
    ):
        run.begin(**RELEASE)
        still.begin(**RELEASE)
        got = run.get("column_angle")
        for step in steps:
            run.set(**step)
            run.step()
            still.step()
            got += run.get("column_angle")
        assert got == angles.tolist()
        assert abs(still.get("column_angle")[0] - got[-1]) > 0.01, "the flight matters"  # rad, of 0.1


@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_law_in_flight_beside_the_machine_is_the_loader(flown, version):
    out, angles, steps = flown
    sensed = [f"sensed_{name}" for name in ("load_cell_force", "drive_position", "column_base", "grip_force")]
    with (
        Imported(unzipped(out, f"pitch_law_{version}")) as law,
        Imported(unzipped(out, f"pitch_machine_{version}")) as machine,
    ):
        law.begin(start_angle=0.1)
        machine.begin(**RELEASE)
        for step in steps:
            law.set(**step, **dict(zip(sensed, machine.get(*sensed), strict=True)))
            law.step()
            machine.set(command=law.get("command")[0])
            machine.step()
        assert machine.get("column_angle") == [angles[-1]]


@pytest.mark.parametrize("version", mostly_slow(["fmi2", "fmi3"]))
def test_flight_has_the_names_units_and_ranges_of_the_packet(flown, version):
    out, _, steps = flown
    packet = {name: numbers for name, *numbers in host_numbers()}
    for kind, has in (("loader", True), ("law", True), ("machine", False)):
        path = out / f"pitch_{kind}_{version}.fmu"
        assert validate_fmu(str(path)) == []
        inputs = {
            it.name: it for it in fmpy.read_model_description(str(path)).modelVariables if it.causality == "input"
        }
        assert set(steps[0]) <= set(inputs) if has else not set(steps[0]) & set(inputs)
        for name in steps[0] if has else ():
            unit, low, high, start = packet[name]
            it = inputs[name]
            assert (it.unit or "", float(it.min), float(it.max), float(it.start)) == (unit, low, high, start)


def test_flight_that_is_none_is_refused_by_name(flown):
    with Imported(unzipped(flown[0], "pitch_loader_fmi3")) as run:
        run.begin()
        with pytest.raises(FMICallException):
            run.set(dynamic_pressure=-1.0)
        assert any("dynamic_pressure: expected a number from 0 to 200000 Pa, got -1" in it for it in run.messages)
