"""A drive from a motor's data sheet: speed constants, terminal values, and what is refused."""

import math

import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader.data_sheet import TABLES, with_drive

ROUNDING = 1e-9  # relative
BLOCK = """
[motor]
speed_constant = "77.8 rpm/V"
inertia = "1.34 kg cm^2"
[winding]
resistance = "0.365 ohm"
inductance = "0.161 mH"
"""
"""A brushed motor of 0.123 N m/A, as a catalog has it."""


@pytest.fixture
def sheet(tmp_path):
    def write(text):
        path = tmp_path / "sheet.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_catalog_speed_and_torque_constants_agree(sheet):
    """The catalog's 77.8 rpm/V and 0.123 N m/A are one number, to the three digits printed."""
    loader = with_drive(ff.loader.electric("elevator-electric"), sheet(BLOCK))
    assert loader["motor.torque_constant"] == pytest.approx(60 / (2 * math.pi) / 77.8, rel=ROUNDING)
    assert loader["motor.torque_constant"] == pytest.approx(0.123, rel=5e-3)  # three digits
    assert loader["winding.resistance"] == pytest.approx(0.365, rel=ROUNDING)
    assert loader.source.endswith("drive from sheet.toml")


@pytest.mark.parametrize(("key", "volts"), [("peak", 1.0), ("rms", math.sqrt(0.5))])
def test_speed_constant_of_three_phases_balances_power(sheet, key, volts):
    """At no load the peak of a phase is 1/sqrt(3) of that between two; torque times speed is 3/2 of its peak power."""
    text = BLOCK.replace('speed_constant = "77.8 rpm/V"', f'speed_constant_{key} = "200 rpm/V"\nthree_phase = true')
    loader = with_drive(ff.loader.electric("elevator-electric"), sheet(text))
    speed, peak_of_phase = 200 * 2 * math.pi / 60, 1 / volts / math.sqrt(3)
    if key == "rms":  # one r.m.s. volt has a peak of sqrt(2)
        assert peak_of_phase == pytest.approx(math.sqrt(2 / 3))
    assert loader["motor.torque_constant"] * speed == pytest.approx(1.5 * peak_of_phase, rel=ROUNDING)


def test_table_replaces_the_loaders_as_a_whole(sheet):
    base = ff.loader.electric("elevator-electric")
    loader = with_drive(base, sheet(BLOCK))
    assert base["motor.three_phase"] == 1
    assert loader["motor.three_phase"] == 0
    assert loader["winding.temperature_coefficient"] == 0 < base["winding.temperature_coefficient"]
    assert loader["transmission.travel"] == pytest.approx(base["transmission.travel"], rel=ROUNDING)
    assert not [key for key in loader.tolerances if key.startswith(("motor.", "winding."))]
    assert ff.Law.of("robust", loader) is not None


@pytest.mark.parametrize(
    ("text", "needed"),
    [
        ('[feel]\ninertia = "1 kg m^2"', f"expected some of the tables {', '.join(TABLES)}, got 'feel'"),
        ("", "expected some of the tables"),
        ('[motor]\nspeed_constant = "77.8 rpm/V"', "sheet.toml: motor.inertia: missing value"),
        (BLOCK.replace("rpm/V", "V"), "'V' measures a voltage, not a speed per voltage"),
        (
            BLOCK.replace("[winding]", "three_phase = true\n[winding]"),
            "expected speed_constant_peak or speed_constant_rms",
        ),
        (BLOCK.replace("speed_constant ", "speed_constant_rms "), "is of a motor with three phases"),
        (BLOCK.replace("inertia", 'torque_constant = "1 N m/A"\ninertia'), "given both ways at once"),
    ],
)
def test_bad_data_sheet_is_named(sheet, text, needed):
    with pytest.raises(InputError) as refused:
        with_drive(ff.loader.electric("elevator-electric"), sheet(text))
    assert needed in str(refused.value)


def test_loader_with_a_valve_is_refused(sheet):
    with pytest.raises(
        InputError, match="a data sheet takes a loader with an electric drive, and elevator-2khz has a hyd"
    ):
        with_drive(ff.digital_elevator(), sheet(BLOCK))
