"""The exported C where its caller or compiler is wrong: it is refused, by a status or before it compiles."""

import re

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.export.c_code import traced_law
from forcefeel.simulation import HandsOff, Recorded, Schedule
from tests.export.toolchain import STRICT, needs, run, written

LAX = ("-std=c99", "-O2", "-ffp-contract=off")
"""As a caller may compile."""

ROUNDING = 1e-7
"""Volts or amperes, of some: what differences of equilibria leave, each found to rounding."""

QUIET = {f"{sensor}.noise": None for sensor in ("load_cell", "potentiometer", "column_sensor")}


@pytest.fixture(scope="module")
def loader():
    return ff.digital_elevator()


@pytest.fixture(scope="module")
def folder(loader, tmp_path_factory):
    """A law of one setting, which reads no force at the grip."""
    needs("gcc")
    return written(ff.export.Exported.of("robust", loader, "pitch"), tmp_path_factory.mktemp("plain"))


def built_and_run(folder, main, *flags, compiler="gcc", beside=()):
    """Runs a program around the law, which ends with how much was wrong."""
    (folder / "caller.c").write_text(main, encoding="utf-8")
    run(folder, compiler, *(flags or STRICT), "-o", "caller", "caller.c", "pitch_law.c", *beside, "-lm")
    run(folder, "./caller")


@pytest.mark.parametrize("flag", ["-ffinite-math-only", "-ffast-math"])
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_finite_math_only_compilation_is_refused(folder, compiler, flag):
    needs(compiler)
    said = run(folder, compiler, *LAX, flag, "-c", "-o", "refused.o", "pitch_law.c", status=1)
    assert f"compile without {flag}" in said


BITS = """
#include "pitch_law.h"
#include <stdint.h>
#include <string.h>
static double of_bits(uint64_t bits)
{
    double x;
    (void)memcpy(&x, &bits, sizeof x);
    return x;
}
int main(void)
{
    static pitch_state state;
    static const uint64_t none[] = {
        0x7FF8000000000000U, 0xFFF8000000000000U, 0x7FF0000000000001U, 0x7FF0000000000000U, 0xFFF0000000000000U
    };
    pitch_input in = { 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0 };
    pitch_output out;
    int wrong = pitch_law_reset(&state, &in) != pitch_OK;
    for (unsigned k = 0U; k < 5U; ++k) {
        in.force = of_bits(none[k]);
        out.command = 1.0;
        wrong += (pitch_law_step(&state, &in, &out) != pitch_BAD_INPUT) || (out.command != 0.0);
    }
    return wrong;
}
"""


@pytest.mark.parametrize(
    ("compiler", "flag"),
    [("gcc", "-O0"), ("gcc", "-O3"), ("gcc", "-fno-signed-zeros"), ("clang", "-O2"), ("clang", "-fno-honor-nans")],
)
def test_nan_is_detected_by_its_bits(folder, compiler, flag):
    """``-fno-honor-nans`` of clang lets no macro say that comparisons no longer see what is no number."""
    needs(compiler)
    built_and_run(folder, BITS, *LAX, flag, compiler=compiler)


RANGES = """
#include "pitch_law.h"
static int outside(const pitch_state *begun, pitch_input in)
{
    pitch_state state = *begun;
    pitch_output out = { 1.0, 1.0, 1.0, 1.0, pitch_OK };
    return ((pitch_law_step(&state, &in, &out) == pitch_BAD_INPUT) && (out.command == 0.0)) ? 0 : 1;
}
int main(void)
{
    static pitch_state state;
    const pitch_input good = { 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0 };
    pitch_input in = good;
    pitch_output out;
    int wrong = pitch_law_reset(&state, &in) != pitch_OK;
    OUTSIDE
    in = good;
    INSIDE
    wrong += pitch_law_step(&state, &in, &out) != pitch_OK;
    return wrong;
}
"""


def test_inputs_beyond_the_sensor_range_are_refused(folder, loader):
    ranges = {
        "force": [s * loader["safety.force_range"] for s in (-1, 1)],
        "base": [s * loader["safety.angle_range"] * loader["column.base_arm"] for s in (-1, 1)],
        "trim": [-np.pi, np.pi],
        "stiffness_factor": [0.0, 100.0],
    }
    outside = "".join(
        f"in = good; in.{name} = {value + sign * (abs(value) + 1e-3) * 1e-9!r}; wrong += outside(&state, in);\n"
        for name, (low, high) in ranges.items()
        for sign, value in ((-1, low), (1, high))
    )
    outside += "in = good; in.force = 1e6; wrong += outside(&state, in);\n"
    outside += "in = good; in.stiffness_factor = -5.0; wrong += outside(&state, in);\n"
    inside = "".join(
        f"in.{name} = {value * (1 - 1e-9)!r}; wrong += pitch_law_reset(&state, &in) != pitch_OK;\n"
        for name, values in ranges.items()
        for value in values
    )
    inside += "in = good; in.stiffness_factor = -0.0;\n"
    built_and_run(folder, RANGES.replace("OUTSIDE", outside).replace("INSIDE", inside))
    header = (folder / "pitch_law.h").read_text(encoding="utf-8")
    assert re.search(r"force;.*-11120\.6 to 11120\.6", header)
    assert re.search(r"stiffness_factor;.*0 to 100", header)


LIMIT = """
#include "pitch_law.h"
int main(void)
{
    static pitch_state state;
    pitch_input in = { 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0 };
    pitch_output out;
    double most = 0.0;
    int wrong = pitch_law_reset(&state, &in) != pitch_OK;
    for (unsigned k = 0U; k < 2000U; ++k) {
        in.force = ((k & 8U) != 0U) ? 11000.0 : -11000.0;
        wrong += pitch_law_step(&state, &in, &out) != pitch_OK;
        most = (out.command > most) ? out.command : most;
        wrong += (out.command > VOLTS) || (out.command < -VOLTS);
    }
    wrong += most < (1.0 - 1e-12) * VOLTS;
    return wrong;
}
"""


def test_command_stays_within_the_amplifier_range(folder, loader):
    volts = loader["amplifier.current_limit"] / loader["amplifier.admittance"]
    built_and_run(folder, LIMIT.replace("VOLTS", repr(volts)))


FILLED = """
#include "pitch_law.h"
#include <string.h>
int main(void)
{
    static pitch_state state;
    static const int bytes[] = { 0x00, 0x01, 0x41, 0x55, 0xAA, 0xFF };
    const pitch_input in = { 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0 };
    pitch_output out;
    int wrong = 0;
    for (unsigned k = 0U; k < 6U; ++k) {
        (void)memset(&state, bytes[k], sizeof state);
        out.command = 1.0;
        wrong += (pitch_law_step(&state, &in, &out) != pitch_NOT_READY) || (out.command != 0.0) || (out.feel_angle != 0.0);
    }
    wrong += (pitch_law_reset(&state, &in) != pitch_OK) || (pitch_law_step(&state, &in, &out) != pitch_OK);
    return wrong;
}
"""


def test_uninitialized_memory_is_not_ready(folder):
    built_and_run(folder, FILLED)


UNUSED = """
#include "pitch_law.h"
#include <math.h>
int main(void)
{
    static pitch_state state;
    pitch_input in = { 0.0, 0.0, 0.0, (double)NAN, 0.0, 1.0, 0.0 };
    pitch_output out;
    int wrong = pitch_law_reset(&state, &in) != pitch_OK;
    in.force = 5.0;
    wrong += (pitch_law_step(&state, &in, &out) != pitch_OK) || (out.command == 0.0);
    return wrong;
}
"""


def test_unused_input_may_have_any_value(folder):
    built_and_run(folder, UNUSED)
    assert re.search(r"grip;.*not read", (folder / "pitch_law.h").read_text(encoding="utf-8"))


def test_cpp_program_links_with_the_law(folder):
    needs("g++")
    (folder / "caller.cpp").write_text(UNUSED.replace("math.h", "cmath"), encoding="utf-8")
    run(folder, "gcc", *STRICT, "-c", "-o", "law.o", "pitch_law.c")
    run(
        folder,
        "g++",
        "-std=c++11",
        "-Wall",
        "-Wextra",
        "-Wpedantic",
        "-Werror",
        "-o",
        "cpp",
        "caller.cpp",
        "law.o",
        "-lm",
    )
    run(folder, "./cpp")


def test_every_golden_column_is_named(folder):
    golden = (folder / "pitch_golden.h").read_text(encoding="utf-8")
    tables = re.findall(r"/\* ([^*]+) \*/\nstatic const \w+(?: \w+)? golden_\w+\[GOLDEN\]\[(\d+)\]", golden)
    assert len(tables) == 2
    for named, columns in tables:
        assert len(named.split(", ")) == int(columns)


TRIM_RAD = 0.03
SHORT_S = 0.02
STARTS = {
    "untouched": ff.Scenario(HandsOff(), SHORT_S),
    "under a force": ff.Scenario(Recorded((0.0, SHORT_S), (80.0, 80.0)), SHORT_S),
    "held aside": ff.Scenario(ff.Release(0.05, start_s=SHORT_S / 2), SHORT_S),
    "trimmed": ff.Scenario(HandsOff(), SHORT_S, trim_rad=Schedule((0.0,), (TRIM_RAD,))),
}


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("drive", ["valve", "motor"])
def test_reset_starts_like_the_simulator(loader, drive, start):
    """Reset with what the sensors show at the start of a run, the law gives the command that holds the loader there."""
    machine = loader if drive == "valve" else ff.loader.electric("elevator-electric")
    machine = machine.replace(
        QUIET | {"feel.preload": "1 lb", "feel.breakout": "2 lb", "column.gravity_torque": "3 N m"}, si=True
    )
    law = ff.Law.of("robust", machine)
    history = ff.simulate(machine, STARTS[start], law).history
    position, current, per_ampere = ("drive_position_m", "motor_current_a", 1.0)
    if drive == "valve":
        position, current, per_ampere = "piston_position_m", "valve_current_a", 1 / machine["amplifier.admittance"]
    given = np.zeros((2, 11))
    given[:, 0] = history.load_cell_force_n.values[0]
    given[:, 1] = history[position].values[0]
    given[:, 2] = history.column_angle_rad.values[0] * machine["column.base_arm"]
    given[:, 4:6] = TRIM_RAD * (start == "trimmed"), 1.0
    found = traced_law(machine, law, law.sampled, single=False).answers(given, [(0, 0)] * 2)
    holding = history[current].values[0] * per_ampere
    assert found[:, 0] == pytest.approx(holding, abs=ROUNDING)
    assert found[0, 2] == pytest.approx(
        history.feel_position_rad.values[0], abs=1e-9
    )  # an angle that was found to rounding
