"""``forcefeel size`` as a user types it, and what follows from a sizing."""

import json
import re
from math import isnan, radians

import pytest

import forcefeel as ff
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.sizing.control_forces import control_forces
from forcefeel.sizing.demand import Duration
from forcefeel.sizing.findings import enough
from forcefeel.sizing.motor import HEAT
from forcefeel.units import TORQUE
from tests.command_line import runs

POUND_N = 4.4482216152605
ROUNDING = 1e-9  # relative
SHOWN = 5e-3  # relative; three digits


run = runs("size")


def test_built_in_loaders_are_large_enough():
    for name, make in BUILT_IN.items():
        assert ff.sizing.size_drive(make()).ok, name


def test_written_files_agree_with_printed_json(run, tmp_path):
    status, out, err = run("elevator-electric", "--json", "--units", "si")
    found = json.loads(out)
    assert (status, err) == (0, "")
    folder = tmp_path / "forcefeel-size"
    assert {one.name for one in folder.iterdir()} == {"size.html", "results.json", "plotly.min.js"}
    stored = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    assert {key: value for key, value in found.items() if key != "page"} == stored
    assert found["ok"]
    assert found["axis"] == "pitch"
    assert found["demands"][0]["force"] == {"value": pytest.approx(60 * POUND_N, rel=ROUNDING), "unit": "N"}
    assert run("elevator-electric")[0] == 2  # the folder is there
    assert run("elevator-electric", "--replace")[0] == 0


def test_motor_too_small_for_programmed_force_has_remedy(run):
    """And what would does: with the named travel the motor holds the force, to the digits that are shown."""
    given = ("elevator-electric", "--set", "pilot.force=600 N", "--units", "si")
    status, out, err = run(*given)
    said = " ".join(out.split())
    assert (status, err) == (1, "")
    assert "The motor is too small for the programmed feel: the pilot's force, 600 N, takes 154 % of its limit." in said
    (travel,) = re.findall(r"a transmission\.travel of ([0-9.]+) cm per radian in place of 0\.318 cm", said)
    loader = ff.loader.electric("elevator-electric").replace({"pilot.force": "600 N"})
    would = ff.sizing.size_drive(loader.replace({"transmission.travel": f"{travel} cm"}))
    assert 1 - SHOWN <= would.demands[0].of_peak <= 1
    torque = ff.sizing.size_drive(loader).demands[0].remedy.torque_n_m
    assert f"takes {torque:.1f} N m at the motor; its peak limit is 6.58 N m" in said


def test_displayed_remedy_is_sufficient(run):
    """Rounded to the side that passes, in either units: 1.577 cm, or 0.6209 in, are told as a little less."""
    loader = ff.loader.electric("desktop-yoke")
    for units, unit in (("si", "cm"), ("us", "in")):
        said = " ".join(run("desktop-yoke", "--units", units, "--replace")[1].split())
        (travel,) = re.findall(rf"a transmission\.travel of ([0-9.]+) {unit} per radian", said)
        would = ff.sizing.size_drive(loader.replace({"transmission.travel": f"{travel} {unit}"}))
        (short,) = (one for one in would.demands if one.name == "25.143(d) short term, two hands")
        assert 1 - 2 * SHOWN <= short.of_peak <= 1
        assert "the motor turns 26.8 % faster." in said


@pytest.mark.parametrize(
    ("value", "least", "most"),
    [
        (14.4602, "14.5 N m", "14.4 N m"),
        (12.3, "12.3 N m", "12.3 N m"),
        (9.996, "10 N m", "9.99 N m"),
        (1234.5, "1240 N m", "1230 N m"),
    ],
)
def test_sufficient_value_is_rounded_to_passing_side(value, least, most):
    assert enough(value, TORQUE, ff.UnitSystem.SI) == least
    assert enough(value, TORQUE, ff.UnitSystem.SI, most=True) == most


def test_small_speed_increase_is_stated_in_percent(run):
    said = " ".join(run("elevator-electric", "--set", "pilot.force=390 N", "--units", "si")[1].split())
    assert re.search(r"and the motor turns 0\.[0-9]+ % faster\.", said)


def test_valve_too_small_has_piston_remedy():
    loader = ff.digital_elevator().replace({"valve.supply_pressure": "200 lb/in^2"})
    found = ff.sizing.size_drive(loader)
    assert not found.ok
    would = loader.replace({"actuator.area": found.demands[0].remedy.area_m2}, si=True)
    assert ff.sizing.size_drive(would).demands[0].of_peak == pytest.approx(1.0, rel=ROUNDING)


def test_release_beyond_voltage_limit_is_stated(run):
    status, out, _ = run("elevator-electric", "--set", "current_loop.voltage_limit=21 V", "--angle", "20 deg")
    assert status == 1
    said = " ".join(out.split())
    assert re.search(
        r"The release from 20 deg, up to 7[0-9.]+ lb and 104 in/s, takes 4[0-9.]+ V and 1[0-9.]+ A; the limit is 21 V and 19 A",
        said,
    )


def test_continuous_torque_is_unknown_without_thermal_data():
    loader = ff.loader.electric("elevator-electric")
    found = ff.sizing.size_drive(loader.replace(dict.fromkeys([*HEAT, "winding.temperature_coefficient"])))
    assert found.missing == HEAT
    assert all(isnan(one.of_continuous) for one in found.demands)
    said = ff.sizing.sizing_conclusions(found, ff.UnitSystem.SI).findings
    assert any(
        "can make every force but long term of 14 CFR 25.143(d) in pitch; long term is unknown." in line
        for line in said
    )
    assert any(line.startswith(f"The continuous torque is unknown: state {', '.join(HEAT)}") for line in said)


def test_pilot_force_rule_depends_on_axis():
    """14 CFR 25.143(d): short term by two hands, one hand, long term; lb."""
    expected = {"pitch": [75, 50, 10], "roll": [50, 25, 5], "yaw": [150, 20], "stick": []}
    loader = ff.loader.electric("rudder-pedals")
    assert ff.sizing.SizingPlan.of(loader).axis == "yaw"
    for axis, forces in expected.items():
        rows = [one for one in ff.sizing.size_drive(loader, axis).demands if not one.programmed]
        assert [one.force_n / POUND_N for one in rows] == pytest.approx(forces, rel=ROUNDING)
        assert [one.duration for one in rows[-1:]] == [Duration.LONG] * bool(rows)
    assert not any(row.verified for row in control_forces())


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (("--axis", "tail"), "--axis: expected pitch, roll, yaw, stick or collective, got 'tail'"),
        (("--angle", "0 deg"), "release_rad: expected an angle above 0, up to 90 deg, got 0 deg"),
        (("--set", "motor.inertia=1 kg m^2"), "motor.inertia: is of a loader with an electric drive"),
    ],
)
def test_bad_input_is_named(run, given, told):
    status, _, err = run(*given)
    assert status == 2
    assert told in err


@pytest.mark.slow
def test_a_project_has_a_row_for_each_axis(run, tmp_path):
    (tmp_path / "own.toml").write_text(ff.digital_elevator().to_toml(), encoding="utf-8")
    project = '[axes]\npitch = "own.toml"\nyaw = "rudder-pedals"\nstick-roll = "sidestick-roll"\n'
    (tmp_path / "cockpit.toml").write_text(project, encoding="utf-8")
    status, out, err = run("cockpit.toml", "--json")
    found = json.loads(out)
    assert (status, err) == (0, "")
    assert {axis: one["axis"] for axis, one in found["axes"].items()} == {
        "pitch": "pitch",
        "yaw": "yaw",
        "stick-roll": "stick",
    }
    alone = json.loads(run("rudder-pedals", "--json", "--out", "alone")[1])
    del alone["page"]
    assert found["axes"]["yaw"] == alone
    said = " ".join(run("cockpit.toml", "--replace")[1].split())
    assert "Every drive of the cockpit is large enough for its programmed feel." in said


def test_project_with_undersized_drive_exits_with_status_1(run, tmp_path):
    small = ff.loader.electric("desktop-yoke").replace({"pilot.force": "250 N"})
    (tmp_path / "small.toml").write_text(small.to_toml(), encoding="utf-8")
    (tmp_path / "cockpit.toml").write_text('[axes]\nroll = "small.toml"\nyaw = "rudder-pedals"\n', encoding="utf-8")
    status, out, _ = run("cockpit.toml")
    assert status == 1
    assert "Too small for the programmed feel: the drive of roll." in " ".join(out.split())


def test_feel_demand_uses_stop_of_each_side():
    """A soft stop on the nearer side, beyond which the farther end does not lie."""
    stops = {"column.stop_low": "-15 deg", "column.stop_high": "12 deg", "feel.soft_stop_high": "13 deg"}
    loader = ff.loader.electric("elevator-electric").replace(stops)
    found = {one.name: one for one in ff.sizing.size_drive(loader).demands}["feel at its stop, -15 deg"]
    expected = loader["feel.stiffness"] * radians(15.0) / loader["column.grip_arm"]
    assert found.force_n == pytest.approx(expected, rel=ROUNDING)
