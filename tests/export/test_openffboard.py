"""Commands for an OpenFFBoard: parsed by the firmware's rules, and the torque by its equations, written down from its source."""

import math
import re
from collections import defaultdict

import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.export.openffboard import BoardFeel, openffboard_files

HALF_A_COUNT = 0.5 / 400  # relative; the smallest coefficient here is above 400
STOPS = {"column.stop_low": "-60 deg", "column.stop_high": "90 deg"}


class Board:
    """Firmware 1.17.1 as far as the commands reach: CmdParser.cpp, SerialFFB.cpp, EffectsCalculator.cpp, Axis.cpp."""

    def __init__(self, text):
        self.values, self.effects, self.active = defaultdict(dict), [], False
        for word in re.split(r"[;\n\r ]", text):
            if len(word) > 2:
                self.command(word)

    def command(self, word):
        match = re.fullmatch(r"(\w+)\.(\d)\.(\w+)(?:=(-?\d+)(?:\?(\d+))?)?", word)
        assert match, word
        name, instance, command, value, address = match.groups()
        assert instance == "0"
        if name != "fxm":
            assert address is None
            self.values[name][command] = int(value)
            if command == "filterProfile_id":
                for effect in self.effects:
                    effect["filter"] = True
        elif command == "reset":
            self.effects, self.active = [], False
        elif command == "new":
            self.effects.append({"type": int(value), "state": 0, "filter": int(value) == 8})
        elif command == "ffbstate":
            self.active = value == "1"
        else:
            self.effects[int(address)][command] = int(value)

    def counts(self, angle, speed, acceleration):
        """Torque in counts at an angle in deg, a speed in deg/s and an acceleration in deg/s^2."""
        axis, gains = self.values["axis"], self.values["fx"]
        assert self.active
        assert (axis["fxratio"], axis["expo"], axis["axisdamper"], axis["axisfriction"], axis["axisinertia"]) == (
            255,
            0,
            0,
            0,
            0,
        )
        total = 0.0
        for effect in self.effects:
            assert effect["state"] == 1
            assert effect["filter"]  # process() of a null pointer otherwise
            coefficient = effect["coeff"]
            if effect["type"] == 11:
                fast, full = abs(speed * 45), gains["frictionPctSpeedToRampup"] / 100 * 32767
                ramp = 1.0 if fast >= full else (1 + math.sin(math.pi * (fast / full - 0.5))) / 2
                force = coefficient * ramp * math.copysign(1, speed) * (gains["friction"] + 1) / 256
            else:
                metric, gain, scale = {
                    8: (65535 / axis["degrees"] * angle, gains["spring"], 16.0),
                    9: (speed * 40, gains["damper"], 4.0),
                    10: (acceleration * 4, gains["inertia"], 2.0),
                }[effect["type"]]
                metric = math.copysign(max(abs(metric) - effect["deadzone"], 0.0), metric)
                force = coefficient / 32767 * (gain + 1) / 256 * scale * metric
            total += min(max(force, -effect["sat"]), effect["sat"])
        return total


@pytest.fixture(scope="module")
def yoke():
    return ff.loader.electric("desktop-yoke").replace({**STOPS, "feel.coulomb_friction": "4 N"})


def board_of(loader):
    exported = ff.export.Exported.of("torque-mode", loader, "roll")
    return Board(openffboard_files(exported)["roll_openffboard.txt"]), BoardFeel.of(exported)


def test_board_gives_the_programmed_torque_by_the_firmwares_equations(yoke):
    board, _ = board_of(yoke)
    torque = 25.0 * 0.456 * 0.040 / 0.020  # motor at 25 A, geared by base arm and belt
    machine = 0.01 + 80e-4 * (0.040 / 0.020) ** 2
    for angle, speed, acceleration in ((20.0, 30.0, 0.0), (-15.0, 10.0, 500.0), (5.0, -40.0, -300.0)):
        theta, omega, alpha = map(math.radians, (angle, speed, acceleration))
        wanted = (
            yoke["feel.stiffness"] * theta + yoke["feel.damping"] * omega + (yoke["feel.inertia"] - machine) * alpha
        )
        wanted += math.copysign(4.0 * 0.130, speed)
        assert board.counts(angle, speed, acceleration) / 32767 * torque == pytest.approx(
            wanted, abs=HALF_A_COUNT * torque / 10
        )


@pytest.mark.parametrize("number", range(4))
def test_each_coefficient_is_right_to_half_a_count(yoke, number):
    _, feel = board_of(yoke)
    effect = feel.effects[number]
    assert effect.rendered == pytest.approx(effect.needed, rel=HALF_A_COUNT)


def test_range_is_that_of_the_wider_side(yoke):
    assert board_of(yoke)[0].values["axis"]["degrees"] == 180
    narrow = yoke.replace({"feel.hard_stop_low": "-30 deg", "feel.hard_stop_high": "40.2 deg"})
    assert board_of(narrow)[0].values["axis"]["degrees"] == 81


def test_dead_band_leaves_the_spring_out(yoke):
    board, _ = board_of(yoke.replace({"feel.deadband": "3 deg", "feel.coulomb_friction": None}))
    assert board.counts(2.9, 0.0, 0.0) == 0.0
    assert board.counts(4.0, 0.0, 0.0) > 0.0


def test_encoder_at_the_motor_has_the_transmissions_ratio(yoke):
    assert board_of(yoke)[1].reduction == pytest.approx(0.5)


def test_every_row_that_is_lost_has_a_line(yoke):
    lost = {
        "feel.breakout": "3 N",
        "feel.soft_stop_high": "50 deg",
        "feel.velocity_limit": "200 deg/s",
        "feel.hysteresis": "1 N",
    }
    lines = "\n".join(board_of(yoke.replace(lost))[1].lost())
    for key in (*lost, "law: none", "supervisor (safety.*): none"):
        assert key in lines
    assert "the board adds at most" not in lines


def test_light_and_strong_feels_are_told(yoke):
    strong = yoke.replace({"feel.damping": "9 N m s/rad", "feel.inertia": "0.02 N m s^2/rad"})
    board, feel = board_of(strong)
    lines = "\n".join(feel.lost())
    assert "feel.inertia = 0.02 N m s^2/rad: the machine has 0.042 N m s^2/rad by itself" in lines
    assert "feel.damping: the board adds at most" in lines
    assert [effect["coeff"] for effect in board.effects[1:3]] == [32767, 0]


@pytest.mark.parametrize(
    ("loader", "needed"),
    [
        (ff.digital_elevator(), "--to openffboard takes a loader with an electric drive"),
        (ff.loader.electric("desktop-yoke"), "the range of the axis is unknown"),
        (
            ff.loader.electric("desktop-yoke").replace({**STOPS, "current_loop.current_limit": None}),
            "current_loop.current_limit: missing",
        ),
    ],
)
def test_what_leaves_the_numbers_open_is_refused(loader, needed):
    with pytest.raises(InputError, match=needed):
        openffboard_files(ff.export.Exported.of("robust", loader, "roll"))


def test_export_writes_both_files(yoke, tmp_path):
    exported = ff.export.Exported.of("torque-mode", yoke, "roll")
    files = ff.export.write_export(exported, ff.export.Target.OPENFFBOARD, tmp_path / "board")
    assert list(files) == ["roll_openffboard.txt", "roll_openffboard.md"]
    page = files["roll_openffboard.md"].read_text(encoding="utf-8")
    assert "`axis.0.reduction=1?2`" in page
    assert "## Not rendered" in page
