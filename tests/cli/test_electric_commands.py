"""Commands on an electric loader: what each does, or that it says what does."""

import json

import numpy as np
import pytest

from forcefeel.cli.exit_status import BAD_INPUT
from forcefeel.envelope.deviations import deviations_of
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.parameters import HYDRAULIC, parts

LOADER = "sidestick-roll"
OF_A_VALVE = set(parts(HYDRAULIC)) - set(parts("electric"))


@pytest.mark.parametrize(
    ("command", "more"),
    [
        ("law", ("--law", "report")),
        ("law", ("--law", "report", "--converge")),
    ],
)
def test_hydraulic_command_refuses_a_motor_and_lists_alternatives(forcefeel, command, more):
    status, out, error = forcefeel(command, LOADER, *more)
    assert (status, out) == (BAD_INPUT, "")
    assert "has an electric drive" in error
    assert "design, law, simulate" in error


def test_analyze_names_the_modes_of_the_motor(forcefeel):
    status, out, _ = forcefeel("analyze", LOADER)
    assert status == 0
    for text in (
        "rotor against column on the link",
        "largest stable G",
        "By current alone",
        "is for a valve and does not apply",
    ):
        assert text in " ".join(out.split())
    status, out, _ = forcefeel("analyze", LOADER, "--json", "--units", "si")
    assert [mode["name"] for mode in json.loads(out)["configurations"][0]["programmed"]["modes"]][-1] == "current loop"


def test_design_refuses_the_options_of_recursion_22(forcefeel, tmp_path):
    status, out, error = forcefeel("design", LOADER, "--converge")
    assert (status, out) == (BAD_INPUT, "")
    assert "leave its options out" in error
    assert list(tmp_path.iterdir()) == []


def test_law_reports_the_demand_on_the_motor(forcefeel, tmp_path):
    status, out, _ = forcefeel("law", LOADER, "--law", "robust", "--save-law", "law.json")
    assert status == 0
    assert "% of the current and" in out
    assert "% of the voltage available" in " ".join(out.split())
    found = json.loads((tmp_path / "forcefeel-law" / "results.json").read_text(encoding="utf-8"))
    assert '"demand": {"current"' in json.dumps(found)
    assert '"pressure"' not in json.dumps(found)


def test_qualification_uses_the_law_of_the_drive(forcefeel):
    status, out, _ = forcefeel("qualify", LOADER, "--test", "release-25-positive", "--set", "feel.breakout=off")
    assert status == 0
    assert "law robust" in out


@pytest.mark.slow
def test_sweep_has_the_measures_of_the_motor(forcefeel, tmp_path):
    status, out, _ = forcefeel("sweep", LOADER, "--runs", "16", "--duration", "0.3", "--out", "s")
    assert status == 0
    assert "% of the largest current and" in " ".join(out.split())
    kept = json.loads((tmp_path / "s" / "summary.json").read_text(encoding="utf-8"))["measures"]
    assert kept["peak_current_a"]["unit"] == "A"
    assert {"peak_voltage_v", "peak_speed_rad_per_s"} < set(kept)
    assert "peak_flow_m3_per_s" not in kept


def test_deviations_are_of_existing_parts_only():
    loader = BUILT_IN[LOADER]()
    off = deviations_of(loader)
    assert {"motor.torque_constant", "motor.inertia"} < set(off)
    assert not OF_A_VALVE & {key.partition(".")[0] for key in off}
    assert np.isclose(off["motor.inertia"].size, 0.1)  # as the file says
