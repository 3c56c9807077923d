"""Settings of a drive: by the equations of scale and limits, in the units of CiA 402's objects."""

import csv
import math

import pytest

import forcefeel as ff
from forcefeel.export.drive_sheet import COLUMNS, drive_csv, drive_page, drive_settings
from forcefeel.loader.parameters import table

TWELVE_DIGITS = 5e-12


@pytest.fixture(scope="module")
def motor():
    return ff.loader.electric("elevator-electric").replace({"column.stop_low": "-10 deg", "column.stop_high": "12 deg"})


@pytest.fixture(scope="module")
def sheet(motor):
    read = list(csv.reader(drive_csv(drive_settings(motor)).splitlines()))
    assert tuple(read[0]) == COLUMNS
    return {row[4] or row[1]: (float(row[2]) if row[2] != "off" else math.inf, row[3], row[5]) for row in read[1:]}


def test_objects_of_cia_402_have_their_values(motor, sheet):
    """A ballscrew of 20 mm: the column's base moves 0.254 m per radian, the drive's end 0.59 of that."""
    revolutions = 0.254 * 0.59 / 0.020
    assert sheet["0x6060"][0] == 10
    assert sheet["0x6092"][0] == pytest.approx(0.020, rel=TWELVE_DIGITS)
    assert sheet["0x608F"][0] == pytest.approx(0.020 / 1.5e-7, rel=TWELVE_DIGITS)
    assert sheet["0x607D:1"][0] == pytest.approx(math.radians(-10) * revolutions, rel=TWELVE_DIGITS)
    assert sheet["0x607D:2"][0] == pytest.approx(math.radians(12) * revolutions, rel=TWELVE_DIGITS)
    assert sheet["0x6080"][0] == pytest.approx(math.radians(600) * revolutions * 60, rel=TWELVE_DIGITS)
    assert sheet["0x6073"][:2] == (19.0, "A")
    constant = motor["motor.torque_constant"]
    assert sheet["0x6072"][0] == pytest.approx(19.0 * constant, rel=TWELVE_DIGITS)
    assert sheet["0x6087"][0] == pytest.approx(1000.0 * 19.0 * constant, rel=TWELVE_DIGITS)
    assert sheet["0x60C2:1 = 5, :2 = -4"][0] == 0.0005


def test_motor_and_loop_are_in_the_units_of_a_data_sheet(motor, sheet):
    constant = motor["motor.torque_constant"]
    assert sheet["torque constant, per r.m.s. ampere"][0] == pytest.approx(constant * math.sqrt(2), rel=TWELVE_DIGITS)
    assert sheet["bandwidth of the current loop"][:2] == (pytest.approx(1000.0, rel=TWELVE_DIGITS), "Hz")


def test_supervisor_lists_every_row_with_its_default(motor):
    values = {setting.rows: setting.value for setting in drive_settings(motor)}
    safety = {key for key in table(motor.drive) if key.startswith("safety.")}
    assert len(safety) > 30
    assert {key: values[key] for key in safety} == {key: motor[key] for key in safety}


def test_valve_has_its_amplifier_and_no_objects():
    settings = drive_settings(ff.digital_elevator())
    assert not any(setting.coe for setting in settings)
    assert "amplifier.current_limit" in {setting.rows for setting in settings}


def test_page_shows_each_setting(motor):
    settings = drive_settings(motor)
    page = drive_page(motor, settings, "roll")
    assert page.count("<tr>") == len(settings) + len({setting.group for setting in settings})
    assert "0x6087" in page
