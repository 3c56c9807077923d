"""A drive from a motor's data sheet: speed constants, terminal values, and what is refused."""

import math
from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader.data_sheet import TABLES, with_drive
from forcefeel.sizing.motor import HEAT, Motor

ROUNDING = 1e-9  # relative
PRINTED = 0.01  # relative: numbers of three digits, products of two and three of them
RPM = 2 * math.pi / 60
BLOCK = """
[motor]
speed_constant = "77.8 rpm/V"
inertia = "1.34 kg cm^2"
[winding]
resistance = "0.365 ohm"
inductance = "0.161 mH"
"""
"""A brushed motor of 0.123 N m/A, as a catalog has it."""
SINE = BLOCK.replace("resistance", "resistance_phase").replace("inductance", "inductance_phase")


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
    text = SINE.replace('speed_constant = "77.8 rpm/V"', f'speed_constant_{key} = "200 rpm/V"\nthree_phase = true')
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
            SINE.replace("[winding]", "three_phase = true\n[winding]"),
            "Expected speed_constant_peak or speed_constant_rms",
        ),
        (BLOCK.replace("speed_constant ", "speed_constant_rms "), "is of a motor with three phases"),
        (BLOCK.replace("inertia", 'torque_constant = "1 N m/A"\ninertia'), "stated in more than one way"),
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


# Published sheets, each checked by numbers of the sheet that the conversion has not read

DCX_22 = """
[motor]
speed_constant = "1370 rpm/V"
inertia = "9.37 g cm^2"
[winding]
resistance = "0.168 ohm"
inductance = "0.018 mH"
[current_loop]
bandwidth = "1 kHz"
supply_voltage = "9 V"
"""
"""maxon DCX 22 L, brushed, 9 V winding; sheet as typed off in github.com/mattchg/ELEC441, MotorSpecs.m."""


def test_brushed_sheet_gives_its_stall_torque_nominal_point_and_speed_without_load(sheet):
    loader = with_drive(ff.loader.electric("elevator-electric"), sheet(DCX_22))
    constant, resistance, voltage = loader["motor.torque_constant"], loader["winding.resistance"], 9.0
    assert constant == pytest.approx(6.95e-3, rel=PRINTED)
    capability = Motor(loader).capability
    assert capability.peak_torque_n_m == pytest.approx(0.371, rel=PRINTED)  # stall
    per_angle = loader["column.base_arm"] * loader["linkage.ratio"] / loader["column.grip_arm"]
    free = capability.fastest_m_per_s * per_angle / loader["transmission.travel"]
    assert free / RPM == pytest.approx(12300, rel=PRINTED)
    # The nominal point: 4 A, of which 118 mA are lost in friction, at 11,400 rpm and 27 mN m.
    assert (voltage - resistance * 4.0) / constant / RPM == pytest.approx(11400, rel=PRINTED)
    assert constant * (4.0 - 0.118) == pytest.approx(27e-3, rel=PRINTED)


EC_45 = """
[motor]
speed_constant = "380 rpm/V"
inertia = "135 g cm^2"
[winding]
resistance = "0.464 ohm"
inductance = "0.322 mH"
"""
"""maxon EC 45 flat 339285, block commutation; sheet as typed off in github.com/vhsabino/MATLAB, PIDMaxon/constants.m."""


def test_block_commutated_sheet_gives_its_torque_constant_and_mechanical_time_constant(sheet):
    loader = with_drive(ff.loader.electric("elevator-electric"), sheet(EC_45))
    constant = loader["motor.torque_constant"]
    assert constant == pytest.approx(25.1e-3, rel=PRINTED)
    slowing = loader["winding.resistance"] * loader["motor.inertia"] / constant**2
    assert slowing == pytest.approx(9.92e-3, rel=PRINTED)


SEIDEL = Path("examples/data-sheets/servo.toml").read_text(encoding="utf-8")
"""Kollmorgen Seidel 6SM107S-3000: K_E = 97 mV min, K_T = 1.6 N m/A, by the maker's legend r.m.s. between two terminals and of a
phase; 23 N m continuously, so 14.4 A r.m.s."""


def test_example_of_the_docs_is_the_file():
    assert SEIDEL.partition("\n")[2] in Path("docs/how-to/size.md").read_text(encoding="utf-8")


def test_sine_sheet_gives_its_torque_constant_and_its_continuous_torque(sheet):
    loader = with_drive(ff.loader.electric("elevator-electric"), sheet(SEIDEL))
    constant = loader["motor.torque_constant"]
    assert constant * math.sqrt(2) == pytest.approx(1.6, rel=PRINTED)
    # The power of three phases at 1000 rpm, worked out with r.m.s. values alone.
    phase = 97.0 / math.sqrt(3)
    assert constant * math.sqrt(2) * 10.0 * 1000 * RPM == pytest.approx(3 * phase * 10.0, rel=ROUNDING)
    assert loader["current_loop.voltage_limit"] == pytest.approx(310 / math.sqrt(3), rel=ROUNDING)
    motor = Motor(loader.replace(dict.fromkeys(HEAT)))  # without heat, the drive limits
    assert motor.capability.continuous_torque_n_m == pytest.approx(23.0, rel=PRINTED)
    assert motor.capability.peak_torque_n_m == pytest.approx(2 * 23.0, rel=PRINTED)
    lasting = loader["current_loop.continuous_current"]
    assert motor.derates_after_s(1.001 * lasting) == 5.0
    assert math.isnan(motor.derates_after_s(0.999 * lasting))


def test_servo_sheet_with_voltage_per_speed_is_block_commutated(sheet):
    """The reference's AC servo prints 0.49 N m/A, 51 V/krpm, 4.52 A and 2.2 N m at stall: the numbers of two terminals."""
    text = BLOCK.replace('speed_constant = "77.8 rpm/V"', 'voltage_constant = "51 V/krpm"')
    constant = with_drive(ff.loader.electric("elevator-electric"), sheet(text))["motor.torque_constant"]
    assert constant == pytest.approx(0.49, rel=PRINTED)
    assert constant * 4.52 == pytest.approx(2.2, rel=PRINTED)


GEAR = """
[transmission]
radius = "20 mm"
gear_ratio = 5.0
backlash_angle = "3 arcmin"
efficiency = 0.9
backdriving_efficiency = 0.89
"""


def test_gear_scales_travel_and_play_by_radius_and_ratio(sheet):
    loader = with_drive(ff.loader.electric("elevator-electric"), sheet(GEAR))
    turns = 7.3  # of the motor
    assert turns * 2 * math.pi * loader["transmission.travel"] == pytest.approx(
        turns / 5 * math.pi * 0.040, rel=ROUNDING
    )
    assert loader["transmission.backlash"] == pytest.approx(0.020 * math.radians(3 / 60), rel=ROUNDING)
    lead = with_drive(loader, sheet('[transmission]\nlead = "10 mm"\ngear_ratio = 2.0'))
    assert lead["transmission.travel"] == pytest.approx(0.010 / 2 / (2 * math.pi), rel=ROUNDING)
    assert lead["transmission.backlash"] == 0


def test_drive_with_a_continuous_current_alone_has_no_larger_one(sheet):
    loop = '[current_loop]\nbandwidth = "1 kHz"\ncontinuous_current_rms = "10 A"'
    loader = with_drive(ff.loader.electric("elevator-electric"), sheet(loop))
    assert loader["current_loop.current_limit"] == pytest.approx(10 * math.sqrt(2), rel=ROUNDING)
    assert loader["current_loop.continuous_current"] == loader["current_loop.peak_time"] == math.inf


THREE = "[motor]\nthree_phase = true\n"


@pytest.mark.parametrize(
    ("text", "question"),
    [
        (
            f'{THREE}torque_constant = "1 N m/A"\ninertia = "1 kg cm^2"',
            "per peak or per r.m.s. ampere, 1.41 times apart?",
        ),
        (
            f'{THREE}voltage_constant = "97 V/krpm"\ninertia = "1 kg cm^2"',
            "per peak or per r.m.s. volt between two of them",
        ),
        (f'{THREE}voltage_constant_rms = "97 mV min"\ninertia = "1 kg cm^2"', "does not measure a voltage per speed"),
        (
            '[winding]\nresistance = "1 ohm"\ninductance = "1 mH"',
            "winding.resistance: of a phase or between two, a factor of 2?",
        ),
        (
            '[current_loop]\ncurrent_limit = "10 A"',
            "current_loop.current_limit: peak or r.m.s. of a phase, 1.41 times apart?",
        ),
        ('[current_loop]\ncurrent_limit_rms = "10 A"', "current_loop.current_limit_rms: for how long?"),
        ('[current_loop]\nvoltage_limit = "48 V"', "of a phase or of the supply, 1.73 times apart?"),
        (
            '[current_loop]\nbandwidth = "1 kHz"\ncurrent_limit_rms = "5 A"\ncontinuous_current_rms = "6 A"\npeak_time = "1 s"',
            "current_loop.continuous_current: expected less than current_limit, 7.07107 A peak, got 8.48528 A peak",
        ),
        ('[transmission]\nradius = "2 cm"\nefficiency = 0.8', "and from the output to the motor?"),
    ],
)
def test_number_that_a_sheet_leaves_open_is_refused_with_its_question(sheet, text, question):
    with pytest.raises(InputError) as refused:
        with_drive(ff.loader.electric("elevator-electric"), sheet(text))
    assert question in str(refused.value)
