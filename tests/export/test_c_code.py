"""The exported C: compiled strictly, it gives the simulated controller's bits, and what is safe where it is given no number."""

import shutil
import subprocess
from pathlib import Path

import pytest

import forcefeel as ff

KNOTS = Path(__file__).parents[2] / "examples" / "schedule" / "knots.csv"
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-ffp-contract=off")
NONLINEAR = {
    "feel.breakout": "2 lb",
    "feel.coulomb_friction": "1 lb",
    "feel.static_friction": "1.5 lb",
    "feel.detent_force": "2 lb",
    "feel.detent_angle": "3 deg",
    "feel.hysteresis": "1 lb",
    "feel.deadband": "0.2 deg",
    "feel.soft_stop_high": "4 deg",
    "feel.hard_stop_high": "6 deg",
    "feel.velocity_limit": "60 deg/s",
    "feel.trim_rate": "2 deg/s",
    "feel.shaker_force": "5 lb",
    "column.coulomb_friction": "1 lb",
}
CONVERTERS = {
    "controller.input_range": "10 V",
    "controller.input_bits": 16,
    "controller.output_range": "10 V",
    "controller.output_bits": 16,
    "controller.antiwindup": "50 1/s",
}

pytestmark = pytest.mark.skipif(
    not shutil.which("cc"), reason="no C compiler on the machine: the exported C is not run"
)


def valve():
    loader = ff.digital_elevator().replace(NONLINEAR | CONVERTERS)
    return ff.export.Exported.of("robust", loader, "pitch", ff.flight_schedule.read_knots(KNOTS).feel[:2])


def motor():
    loader = ff.loader.electric("elevator-electric").replace(NONLINEAR | {"motor.cogging_torque": "0.1 N m"})
    return ff.export.Exported.of("robust", loader, "roll")


def compiled(out, *sources, level="-O0"):
    done = subprocess.run(
        ["cc", *STRICT, level, "-o", "program", *sources, "-lm"], cwd=out, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    return subprocess.run([str(out / "program")], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    out = tmp_path_factory.mktemp("valve")
    ff.export.write_export(valve(), ff.export.Target.C, out)
    return out


def test_a_schedule_with_every_nonlinear_part_gives_the_same_bits(folder):
    done = compiled(folder, "pitch_test.c", "pitch_law.c")
    assert done.stdout == "pitch: 10002 samples, 0 differ\n"
    assert done.returncode == 0


def test_a_motor_in_single_precision_gives_the_same_bits(tmp_path):
    ff.export.write_export(motor(), ff.export.Target.C, tmp_path, single=True)
    done = compiled(tmp_path, "roll_test.c", "roll_law.c", level="-O2")
    assert done.stdout == "roll: 10002 samples, 0 differ\n"


def test_another_number_in_the_data_is_found_out(folder, tmp_path):
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    data = tmp_path / "pitch_data.h"
    text = data.read_text(encoding="utf-8")
    first = text.split("{{", 1)[1].split(",", 1)[0]
    data.write_text(text.replace(first, f"{float(first.strip('()')) * (1 + 1e-12)!r}", 1), encoding="utf-8")
    assert compiled(tmp_path, "pitch_test.c", "pitch_law.c").returncode == 1


NO_NUMBER = """
#include "pitch_law.h"
#include <math.h>
int main(void)
{
    pitch_state state = { 0 };
    pitch_input in = { 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0U, 1U };
    pitch_output out;
    int wrong = 0;
    wrong += pitch_law_step(&state, &in, &out) != pitch_NOT_READY || out.command != 0.0;
    wrong += pitch_law_reset(&state, &in) != pitch_OK;
    in.force = 5.0;
    wrong += pitch_law_step(&state, &in, &out) != pitch_OK || out.command == 0.0;
    in.force = (double)NAN;
    wrong += pitch_law_step(&state, &in, &out) != pitch_BAD_INPUT || out.command != 0.0;
    in.force = (double)INFINITY;
    wrong += pitch_law_step(&state, &in, &out) != pitch_BAD_INPUT || out.command != 0.0;
    in.force = 5.0;
    in.to = 2U;
    wrong += pitch_law_step(&state, &in, &out) != pitch_BAD_INPUT || out.command != 0.0;
    in.to = 1U;
    wrong += pitch_law_step(&state, &in, &out) != pitch_OK;
    return wrong;
}
"""


def test_what_is_no_number_gives_the_safe_output_and_leaves_the_state(folder):
    (folder / "none.c").write_text(NO_NUMBER, encoding="utf-8")
    assert compiled(folder, "none.c", "pitch_law.c").returncode == 0


def test_an_analog_law_is_refused():
    with pytest.raises(ff.InputError, match="is an analog law, and C runs on a digital target"):
        ff.export.write_export(ff.export.Exported.of("converged", ff.elevator()), ff.export.Target.C, Path("none"))
