"""The parameter sheet: every number of law, limits and filters, in both systems of units."""

import csv
from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.export.parameter_sheet import COLUMNS, observer_sheet, parameter_sheet
from forcefeel.laws.sampled.sampled_law import OF_FRICTION
from forcefeel.units import factor

FEEL = np.array([[6.8, 34.0, 1085.0], [4.0, 25.0, 800.0]])


def rows(exported):
    """Of both sheets, which share no row."""
    sheets = [list(csv.reader(sheet(exported).splitlines())) for sheet in (parameter_sheet, observer_sheet)]
    assert all(tuple(read[0]) == COLUMNS for read in sheets)
    listed = [row for read in sheets for row in read[1:]]
    keyed = {(row[0], row[2]): row for row in listed}
    assert len(keyed) == len(listed)
    return keyed


@pytest.fixture(scope="module")
def sampled():
    loader = ff.digital_elevator().replace({"column.coulomb_friction": "1 lb", "feel.breakout": "2 lb"})
    exported = ff.export.Exported.of("robust", loader, "pitch", FEEL)
    return exported, rows(exported)


def test_each_setting_lists_all_law_numbers_exactly(sampled):
    exported, sheet = sampled
    law = exported.law.sampled
    n = law.states
    for place in range(2):
        setting = str(place + 1)
        for name, array in (("command", law.command), ("torque", law.torque)):
            found = [float(sheet[setting, f"law.{name}_{k + 1}"][4]) for k in range(n + 5)]
            assert np.array_equal(found, array[place])
        neutral = [float(sheet[setting, f"law.{name}_neutral"][4]) for name in ("command", "torque")]
        assert neutral == law.neutral[place].tolist()
        for name, array in (("transition", law.transition), ("input", law.input), ("settled", law.settled)):
            shape = array[place].shape
            found = [
                [float(sheet[setting, f"law.{name}_{i + 1}_{j + 1}"][4]) for j in range(shape[1])] for i in range(n)
            ]
            assert np.array_equal(found, array[place])
        assert float(sheet[setting, "law.friction_level_negative"][4]) == law.friction[place, -OF_FRICTION]
        assert [float(sheet[setting, f"feel.{row}"][4]) for row in ("inertia", "damping", "stiffness")] == list(
            FEEL[place]
        )


def test_both_unit_systems_state_the_same_values(sampled):
    for _, _, name, _, si, unit_si, us, unit_us in sampled[1].values():
        if si == "off" or unit_si == unit_us:
            assert us == "off" or float(us) == pytest.approx(float(si), rel=1e-9), name  # ten digits
            continue
        assert float(us) == pytest.approx(float(si) * factor(unit_si, unit_us), rel=1e-9), name  # ten digits


def test_sheet_lists_limits_filters_and_nonlinear_feel(sampled):
    sheet = sampled[1]
    assert sheet["", "controller.period"][4:6] == ["0.0005", "s"]
    assert sheet["", "amplifier.current_limit"][4:] == ["0.015", "A", "15", "mA"]
    assert sheet["", "feel.breakout"][6:] == ["2", "lb"]
    assert sheet["", "load_cell.bandwidth"][4] == "off"


def test_motor_sheet_has_its_limits_and_a_command_in_amperes():
    sheet = rows(ff.export.Exported.of("robust", ff.loader.electric("elevator-electric"), "pitch"))
    assert ("", "current_loop.current_limit") in sheet
    assert ("", "valve.flow_limit") not in sheet
    assert sheet["1", "law.command_9"][5] == "A/N"


def test_sheet_lists_the_gains_of_an_analog_law():
    loader = ff.elevator()
    exported = ff.export.Exported.of("converged", loader, "pitch")
    sheet = rows(exported)
    found = [float(sheet["1", f"law.c_{k}"][4]) for k in range(1, 8)]
    assert found == list(exported.law.numbers.gain_law(loader).gains)
    assert sheet["1", "law.c_1"][7] == "V/in"


def test_law_with_grip_sensor_names_its_columns():
    exported = ff.export.Exported.of("grip", ff.digital_elevator().replace({"grip_sensor.gain": 1.0}, si=True), "pitch")
    sheet, law = rows(exported), exported.law.sampled
    place = law.states + 4
    row = sheet["1", f"law.torque_{place}"]
    assert row[3] == "torque on grip force"
    assert (float(row[4]), row[5]) == (law.torque[0, place - 1], "N m/N")
    assert sheet["1", "law.input_1_5"][3] == "xi_1 on command"


def test_sheet_lists_supervisor_limits_cogging_and_curve():
    loader = ff.loader.electric("desktop-yoke").replace({"motor.cogging_torque": "0.1 N m"})
    curve = ff.loader.Curve((-0.3, 0.0, 0.3), (-2.0, 0.0, 2.5))
    exported = ff.export.Exported.of("robust", replace(loader, force_curve=curve), "yoke")
    sheet = rows(exported)
    assert sheet["", "safety.force_limit"][6:] == ["50", "lb"]
    assert float(sheet["", "cancellation.lead"][4]) == exported.law.cancellation.lead_s
    assert [sheet["", f"force_curve.{what}_3"][4] for what in ("angle", "force")] == ["0.3", "2.5"]
