"""The exported C: compiled strictly, it gives the simulated controller's bits, and what is safe where it is given no number."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from benchmarks import export as cost

import forcefeel as ff
from forcefeel.export.c_code import traced_law
from forcefeel.export.golden import golden_inputs
from forcefeel.export.tunable import tunable_rows
from tests.export.toolchain import (
    BOARDS,
    CONVERTERS,
    GRIP_SENSOR,
    KNOTS,
    NONLINEAR,
    STRICT,
    for_board,
    motor,
    needs,
    on_board,
    run,
    valve,
    written,
)
from tests.parametrization import mostly_slow

ARGUED = {"misra-c2012-2.5", "misra-c2012-21.6", "misra-c2012-21.15"}
"""Rules of MISRA C:2012 that are broken, with the reasons in docs/how-to/export.md."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The valve's law in double precision, and its golden vectors compiled once: they are long."""
    needs("gcc")
    out = written(valve(), tmp_path_factory.mktemp("valve"))
    run(out, "gcc", *STRICT, "-c", "pitch_test.c")
    return out


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    """The motor's law in single precision."""
    needs("gcc")
    out = written(motor(), tmp_path_factory.mktemp("motor"), single=True)
    run(out, "gcc", *STRICT, "-c", "roll_test.c")
    return out


@pytest.mark.parametrize(("compiler", "level"), mostly_slow([("gcc", 0), ("gcc", 2), ("gcc", 3), ("clang", 2)]))
def test_schedule_with_every_nonlinear_part_matches_bitwise(folder, compiler, level):
    needs(compiler)
    run(folder, compiler, *STRICT, f"-O{level}", "-o", "program", "pitch_law.c", "pitch_test.o", "-lm")
    assert run(folder, "./program") == "pitch: 10000 samples, 0 differ\n"


@pytest.mark.slow
def test_law_with_a_sensor_at_the_grip_begins_a_contact_as_the_simulation(tmp_path):
    """At rest the hand's torque is a zero, whose sign is not kept."""
    needs("gcc")
    loader = ff.digital_elevator().replace(GRIP_SENSOR)
    written(ff.export.Exported.of("robust", loader, "pitch"), tmp_path)
    run(tmp_path, "gcc", *STRICT, "-O1", "-o", "program", "pitch_law.c", "pitch_test.c", "-lm")
    assert run(tmp_path, "./program") == "pitch: 10000 samples, 0 differ\n"


@pytest.mark.slow
@pytest.mark.parametrize("level", mostly_slow([0, 3]))
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_single_precision_motor_matches_bitwise(single, compiler, level):
    needs(compiler)
    run(single, compiler, *STRICT, f"-O{level}", "-o", "program", "roll_law.c", "roll_test.o", "-lm")
    assert run(single, "./program") == "roll: 10000 samples, 0 differ\n"


_FLIGHT = """#include "pitch_law.h"
#include <math.h>
#include <stdio.h>
int main(void) {
    pitch_flight flight = {2400.0, 70.0, 0.06, -0.03, 0.1, 0.2, -0.05, 1.4, 0.3, 0.05, 0.1};
    pitch_added out;
    printf("%d ", pitch_hinge_moment(&flight, &out));
    printf("%.17g %.17g %.17g ", out.added_force, out.added_stiffness, out.added_damping);
    flight.true_airspeed = NAN;
    const int status = pitch_hinge_moment(&flight, &out);
    printf("%d %g", status, out.added_stiffness);
    return 0;
}
"""


def test_hinge_moment_is_that_worked_out_by_hand_and_refuses_what_is_no_number(folder):
    """``T = k q S c (C_alpha f alpha_s + f C(delta) + C_tau f tau + C_rate delta' c / 2 V)``, less the cables' stretch."""
    needs("gcc")
    (folder / "flight.c").write_text(_FLIGHT, encoding="utf-8")
    run(folder, "gcc", *STRICT, "-O2", "-o", "flight", "flight.c", "pitch_law.c", "-lm")
    status, *numbers, refused, nothing = run(folder, "./flight").split()
    moment, theta, grown = 2400.0 * 1.0 * 0.4, 0.1, (1 - 0.3**2) ** -0.5
    of_mach = grown * 1.2  # halfway to 1.4 at Mach 0.6
    delta, k = 1.2 * (theta + 0.3 * theta**2 / 2), 1.2 * (1 + 0.3 * theta)
    of_deflection = of_mach * (-0.01 - 0.4 * (delta - 0.05))  # from -0.01 at 0.05 rad to -0.07 at 0.2 rad
    coefficient = of_deflection - 0.1 * grown * (0.6 * 0.06 + 4 * 0.2 / 70) - 0.1 * grown * 0.05
    slope = moment * (1.2 * 0.3 * coefficient - k**2 * 0.4 * of_mach)
    gives = 1 - slope / 20000
    stiffness, damping = -slope / gives, moment * k**2 * 0.5 * 0.4 / 140 / gives
    arm = ff.digital_elevator()["column.grip_arm"]
    force = (moment * k * coefficient / gives + stiffness * theta) / arm - 10 * 1.4
    assert [float(number) for number in numbers] == pytest.approx([force, stiffness, damping], rel=1e-12)  # rounding
    assert (status, refused, float(nothing)) == ("0", "2", 0.0)


def test_readme_formats_times_for_readers(single):
    assert "| period, delay | 0.5 ms, 0.5 ms from sample to command |" in (single / "README.md").read_text(
        encoding="utf-8"
    )


def test_too_heavy_feel_has_golden_inputs():
    """A desktop yoke cannot hold the elevator's spring at 0.1 rad; the release begins where it can."""
    heavy = ff.flight_schedule.read_knots(KNOTS).feel[:1]
    given, _ = golden_inputs(ff.export.Exported.of("robust", ff.loader.electric("desktop-yoke"), "yoke", heavy))
    assert np.isfinite(given).all()
    assert np.abs(given[:3000, 0]).max() > 1.0


@pytest.mark.parametrize("core", mostly_slow(BOARDS))
def test_emulated_board_matches_bitwise(single, core):
    needs("arm-none-eabi-gcc", "qemu-system-arm")
    for_board(single, core, "board.elf", "roll_test.c", "roll_law.c", flags=STRICT)
    assert on_board(single, core, "board.elf") == "roll: 10000 samples, 0 differ\n"


MOST_BYTES = 12_400
"""Of code and data of four settings; docs/how-to/export.md states 12.0 KiB."""


@pytest.mark.slow
def test_period_and_law_stay_within_instruction_and_size_budgets(tmp_path):
    """Most of any golden sample, with every nonlinear part of the feel; size of four settings with every part."""
    needs("arm-none-eabi-gcc", "qemu-system-arm")
    every = ff.digital_elevator().replace(NONLINEAR | CONVERTERS, si=True)
    feel = ff.export.Exported.of("robust", ff.digital_elevator().replace(cost.FEEL, si=True), "law")
    most, size, _ = cost.of_c(feel, tmp_path / "feel")
    assert 600 < most <= cost.MOST * cost.STATED["C, every nonlinear part of the feel"]
    knots = ff.flight_schedule.read_knots(KNOTS).feel
    four = written(ff.export.Exported.of("robust", every, "law", knots), tmp_path / "four", single=True)
    cost.stack(four, "law_law.c")
    assert size < cost.code_and_data(four, "law.o") <= MOST_BYTES


def test_two_axes_in_one_program_match(folder, single, tmp_path):
    """Valve and motor, double and single, with their headers in one file, too."""
    (tmp_path / "both.c").write_text(
        '#include "pitch_law.h"\n#include "roll_law.h"\nint pitch_test(void);\nint roll_test(void);\n'
        "int main(void)\n{\n    return ((pitch_test() == 0) && (roll_test() == 0)) ? 0 : 1;\n}\n",
        encoding="utf-8",
    )
    objects = []
    for axis, out in (("pitch", folder), ("roll", single)):
        renamed = tmp_path / f"{axis}_test.o"
        run(out, "objcopy", "--redefine-sym", f"main={axis}_test", f"{axis}_test.o", renamed)
        objects += [renamed, out / f"{axis}_law.c"]
    run(tmp_path, "gcc", *STRICT, f"-I{folder}", f"-I{single}", "-o", "both", "both.c", *objects, "-lm")
    assert run(tmp_path, "./both") == "pitch: 10000 samples, 0 differ\nroll: 10000 samples, 0 differ\n"


def test_sanitizers_find_no_errors(folder):
    sanitize = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g")
    run(folder, "gcc", *STRICT, *sanitize, "-o", "sanitized", "pitch_law.c", "pitch_test.o", "-lm")
    assert run(folder, "./sanitized") == "pitch: 10000 samples, 0 differ\n"


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    """The valve's law in single precision, for two settings: its numbers are tables."""
    return written(valve(), tmp_path_factory.mktemp("several"), single=True)


@pytest.mark.slow
@pytest.mark.timeout(900)  # 70 s of processor time, nine tenths of it cppcheck's own analysis of values
def test_misra_rules_hold_except_for_documented_deviations(several, tmp_path):
    """Several settings with every part, a tuned motor, and a supervised one of two settings, linked to one program: their names
    must not meet.

    The checker takes a second for each part of a feel, so that the motor has only its own: its curve and its cogging.
    """
    needs("cppcheck")
    plain = motor({})
    rows = tunable_rows(["feel.deadband=0..1 deg"], plain.loader, plain.law)
    single = written(replace(plain, tunable=rows), tmp_path / "tuned", single=True)
    # As gcc for the board sees it: each configuration is checked anew, and takes as long.
    asked = ("--addon=misra", "--std=c99", "--enable=style,warning,performance,portability", "-D__GNUC__=12", "--quiet")
    both = ff.export.Exported.of("robust", plain.loader, "yaw", plain.settings * [[1.0], [1.5]])
    supervised = written(replace(both, supervised=True), tmp_path / "supervised", single=True)
    sources = [several / "pitch_law.c", single / "roll_law.c", supervised / "yaw_axis.c", several / "pitch_main.c"]
    text = run(single, "cppcheck", *asked, "--template={id}", *sources)
    found = set(re.findall(r"^\S+$", text, re.MULTILINE))
    assert found == ARGUED


def test_make_prints_a_stack_bound(folder):
    found = re.search(r"pitch_law_step: at most (\d+) bytes of stack", run(folder, "make", "stack", "CC=gcc"))
    frames = (folder / "pitch_law.su").read_text(encoding="utf-8").splitlines()
    assert found
    assert int(found[1]) == sum(int(line.split("\t")[1]) for line in frames) > 0
    # gcc: of what is bounded too, as arguments that are pushed are, the size is a reliable maximum.
    assert {line.split("\t")[2] for line in frames} <= {"static", "dynamic,bounded"}


def test_example_program_prints_commands(folder):
    run(folder, "make", "CC=gcc")
    lines = run(folder, "./pitch_main").splitlines()
    assert len(lines) == 4
    assert all(re.fullmatch(r"-?\d\S* V", line) for line in lines)


def test_modified_data_are_detected(folder, tmp_path):
    data = (folder / "pitch_data.h").read_text(encoding="utf-8")
    members, numbers = data.split("pitch_numbers = {", 1)
    first = numbers.split("{{", 1)[1].split(",", 1)[0]
    other = numbers.replace(first, f"{float(first.strip('()')) * (1 + 1e-12)!r}", 1)
    (tmp_path / "pitch_data.h").write_text(f"{members}pitch_numbers = {{{other}", encoding="utf-8")
    for name in ("pitch_law.c", "pitch_law.h"):
        (tmp_path / name).write_bytes((folder / name).read_bytes())
    run(tmp_path, "gcc", *STRICT, "-o", "program", "pitch_law.c", folder / "pitch_test.o", "-lm")
    run(tmp_path, "./program", status=1)


NO_NUMBER = """
#include "pitch_law.h"
#include <math.h>
int main(void)
{
    pitch_state state = { 0 };
    pitch_input in = { 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0U, 1U, 0.0, 0.0, 0.0 };
    pitch_output out;
    int wrong = 0;
    wrong += pitch_law_step(&state, &in, &out) != pitch_NOT_READY || out.command != 0.0;
    wrong += pitch_law_reset(&state, &in) != pitch_OK;
    in.force = 5.0;
    in.position = 1e-4;
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


def test_nan_input_gives_safe_output_and_keeps_the_state(folder):
    (folder / "none.c").write_text(NO_NUMBER, encoding="utf-8")
    run(folder, "gcc", *STRICT, "-o", "none", "none.c", "pitch_law.c", "-lm")
    run(folder, "./none")


def test_analog_law_is_refused():
    with pytest.raises(ff.InputError, match="is an analog law, and the target is digital"):
        ff.export.write_export(ff.export.Exported.of("converged", ff.elevator()), ff.export.Target.C, Path("none"))


@pytest.mark.parametrize("loader", [ff.digital_elevator(), ff.loader.electric("sidestick-pitch")])
def test_law_started_off_neutral_gives_a_small_command(loader):
    """Sensors off by a bit: a law closed on them would have asked for a million amperes."""
    law = ff.Law.of("robust", loader)
    angle = 0.1
    base = angle * loader["column.base_arm"]
    given = np.zeros((4, 11))
    given[:, :3] = 0.0, loader["linkage.ratio"] * base, base
    given[:, 4:6] = angle, 1.0
    noise = np.random.default_rng(1).normal(size=(4, 3))
    given[:, :3] += noise * [loader[f"{sensor}.noise"] for sensor in ("load_cell", "potentiometer", "column_sensor")]
    command = traced_law(loader, law, law.sampled, single=False).answers(given, [(0, 0)] * 4)[:, 0]
    most = loader["current_loop.current_limit"] if loader.drive == "electric" else 10.0
    assert np.abs(command).max() < 0.2 * most  # later the law finds that the column does not follow
