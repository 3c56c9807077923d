"""Rows that a program tunes in the exported C: the bits of an export of a file with those values, and range checks."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.export import tunable
from forcefeel.export.sections import SECTIONS
from forcefeel.laws.sampled.sampled_law import NUMBERS
from tests.command_line import runs
from tests.export.toolchain import CONVERTERS, NONLINEAR, STRICT, motor, needs, run, written
from tests.pages import OnDemand
from tests.parametrization import mostly_slow

VALVE = ff.digital_elevator().replace(NONLINEAR | CONVERTERS, si=True)
STICK = ff.loader.electric("sidestick-pitch").replace({"feel.breakout": "2 N"})
RANGES = {
    "feel.breakout": "0..20 N",
    "feel.breakout_travel": "0.05..0.4 deg",
    "feel.coulomb_friction": "0..5 N",
    "feel.static_friction": "5..12 N",
    "feel.quadratic_damping": "0..20 N m s^2/rad^2",
    "feel.deadband": "0..1 deg",
    "feel.preload": "-10..10 N",
    "feel.hysteresis": "0..8 N",
    "feel.hysteresis_travel": "0.1..0.5 deg",
    "feel.detent_force": "0..15 N",
    "feel.detent_angle": "-4..4 deg",
    "feel.detent_travel": "0.5..2 deg",
    "feel.soft_stop_low": "-5..-3 deg",
    "feel.soft_stop_high": "3..5 deg",
    "feel.soft_stop_stiffness": "2000..8000 N m/rad",
    "feel.soft_stop_damping": "0..20 N m s/rad",
    "feel.hard_stop_low": "-8..-5.5 deg",
    "feel.hard_stop_high": "5.5..8 deg",
    "feel.velocity_limit": "20..90 deg/s",
    "feel.trim_rate": "1..10 deg/s",
}
"""Every row that can be tuned."""
ON_STICK = {"feel.breakout": "0..6 N", "feel.deadband": "0..1 deg", "feel.coulomb_friction": "0..1 N"}
"""Rows that the loader's file has and rows that it has not: these are off in it."""

DRIVER = """
#include "{name}_law.h"
#include "{golden}"
#include <stdio.h>
int main(void) {{
    static {name}_state state;
    const {name}_tuning tuning = {{ {values} }};
    unsigned int wrong = 0U;
    for (unsigned int k = 0U; k < GOLDEN; ++k) {{
        const {name}_real *const g = golden_in[k];
        const {name}_real *const must = golden_out[k];
        const {name}_input in = {{ g[0], g[1], g[2], g[3], g[4], g[5], g[6] }};
        {name}_output out;
        if ((k % GOLDEN_PART) == 0U) {{
            wrong += {name}_law_reset(&state, &tuning, &in) != {name}_OK;
        }}
        wrong += ({name}_law_step(&state, &in, &out) != {name}_OK) || (out.command != must[0]) || (out.torque != must[1])
            || (out.feel_angle != must[2]) || (out.feel_rate != must[3]);
    }}
    printf("%u differ\\n", wrong);
    return (wrong == 0U) ? 0 : 1;
}}
"""


def texts(ranges):
    return [f"{key}={span}" for key, span in ranges.items()]


def tuned(loader, ranges, name):
    return ff.export.Exported.of("robust", loader, name, tunable=texts(ranges))


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """A valve's law with every row in double precision, a motor's with a few in single, and one with curve, cogging and link."""

    def roll():
        curved, ranges = motor(), ["feel.breakout=0..20 N", "feel.hard_stop_high=5.5..30 deg"]
        rows = tunable.tunable_rows(ranges, curved.loader, curved.law)
        return replace(curved, tunable=rows, linked=True)

    made = {
        "valve": lambda: tuned(VALVE, RANGES, "valve"),
        "stick": lambda: tuned(STICK, ON_STICK, "stick"),
        "roll": roll,
    }
    return OnDemand(lambda name: written(made[name](), tmp_path_factory.mktemp(name), single=name != "valve"))


@pytest.mark.parametrize("name", mostly_slow(["valve", "stick", "roll"]))
def test_tuned_law_matches_bitwise_while_it_is_tuned(folders, name):
    needs("gcc")
    run(folders[name], "gcc", *STRICT, "-O2", "-o", "program", f"{name}_law.c", f"{name}_test.c", "-lm")
    assert run(folders[name], "./program") == f"{name}: 15000 samples, 0 differ\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "loader", "ranges", "share"),
    mostly_slow(
        [
            (name, loader, ranges, share)
            for share in (0.3, None, 1.0, 0.0)
            for name, loader, ranges in (("valve", VALVE, RANGES), ("stick", STICK, ON_STICK))
        ],
        2,
    ),
)
def test_tuned_law_gives_the_bits_of_an_export_of_the_changed_file(folders, name, loader, ranges, share, tmp_path):
    """Its law designed anew, its golden vectors a simulation of that file; none: the file's own values."""
    needs("gcc")
    rows = tunable.tunable_rows(texts(ranges), loader, ff.Law.of("robust", loader))
    own = {row.key: loader[row.key] if share is None else row.low + share * (row.high - row.low) for row in rows}
    single = name == "stick"
    written(ff.export.Exported.of("robust", tunable.tuned(loader, own), name), tmp_path / "changed", single=single)
    values = ", ".join(f"{value!r}F" if single else repr(value) for value in own.values())
    program = DRIVER.format(name=name, golden=tmp_path / "changed" / f"{name}_golden.h", values=values)
    (tmp_path / "driver.c").write_text(program, encoding="utf-8")
    folder = folders[name]
    run(tmp_path, "gcc", *STRICT, f"-I{folder}", "-o", "driver", "driver.c", folder / f"{name}_law.c", "-lm")
    assert run(tmp_path, "./driver") == "0 differ\n"


REFUSALS = """
#include "stick_law.h"
#include <math.h>
static int same(const stick_tuning *tuning, const stick_state *state)
{
    return (tuning->breakout == state->tuning.breakout) && (tuning->deadband == state->tuning.deadband);
}
int main(void)
{
    stick_state state = { 0 };
    const stick_input in = { 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F };
    stick_tuning tuning = stick_file_tuning;
    const float bad[] = { -1e-6F, 6.00001F, NAN, INFINITY };
    int wrong = stick_law_tune(&state, &tuning) != stick_NOT_READY;
    wrong += stick_law_reset(&state, &tuning, &in) != stick_OK;
    tuning.breakout = 6.0F;
    wrong += (stick_law_tune(&state, &tuning) != stick_OK) || !same(&tuning, &state);
    const stick_tuning before = tuning;
    for (unsigned int k = 0U; k < 4U; ++k) {
        tuning.deadband = 0.01F;
        tuning.breakout = bad[k];
        wrong += (stick_law_tune(&state, &tuning) != stick_BAD_INPUT) || !same(&before, &state);
        stick_output out;
        wrong += stick_law_step(&state, &in, &out) != stick_OK;
        stick_state other = { 0 };
        wrong += stick_law_reset(&other, &tuning, &in) != stick_BAD_INPUT;
        wrong += stick_law_step(&other, &in, &out) != stick_NOT_READY;
    }
    return wrong;
}
"""


def test_value_out_of_its_range_is_refused_and_changes_nothing(folders):
    needs("gcc")
    (folders["stick"] / "refusals.c").write_text(REFUSALS, encoding="utf-8")
    run(folders["stick"], "gcc", *STRICT, "-o", "refusals", "refusals.c", "stick_law.c", "-lm")
    run(folders["stick"], "./refusals")


def test_header_and_readme_state_row_unit_range_and_file_value(folders):
    header = (folders["stick"] / "stick_law.h").read_text(encoding="utf-8")
    assert re.search(r"stick_real breakout; /\* feel.breakout in N: .*; 0.0 to 6.0, file 2.0 \*/", header)
    assert "| `breakout` | `feel.breakout` | N | 0.0 | 6.0 | 2.0 |" in (folders["stick"] / "README.md").read_text(
        encoding="utf-8"
    )


def test_statements_of_tuned_rows_are_mapped(folders):
    document = json.loads((folders["valve"] / "trace.json").read_text(encoding="utf-8"))
    assert {statement["section"] for statement in document["statements"]} <= SECTIONS.keys()
    named = {row for statement in document["statements"] for row in statement["rows"]}
    assert named >= RANGES.keys()


@pytest.mark.parametrize("row", ["feel.breakout", "feel.static_friction", "feel.detent_force", "feel.soft_stop_high"])
def test_law_of_a_motor_with_a_force_sensor_does_not_depend_on_a_steep_row(row):
    """Row by row for a valve: ``tests/laws/test_made_for.py``."""
    laws = [ff.Law.of("robust", STICK.replace({row: value}, si=True)).sampled for value in (0.05, 2.0)]
    for numbers in NUMBERS:
        assert np.array_equal(getattr(laws[0], numbers), getattr(laws[1], numbers))


export = runs("export")


@pytest.mark.parametrize(
    ("loader", "law", "words", "expected"),
    [
        ("elevator-2khz", "robust", ["feel.stiffness"], "robust is designed for its value; export settings with knots"),
        ("elevator-2khz", "robust", ["feel.shaker_force=1..2 lb"], "scale the input shaker"),
        ("elevator-2khz", "robust", ["feel.maximum_stiffness"], "the C has no such number"),
        ("elevator-2khz", "robust", ["feel.brakeout=0..1 lb"], "did you mean feel.breakout?"),
        ("elevator-2khz", "robust", ["column.inertia"], "expected a row of the feel"),
        ("elevator-2khz", "robust", ["feel.breakout=1"], "feel.breakout: expected a range such as '4..8 lb', got '1'"),
        ("elevator-2khz", "robust", ["feel.breakout=0..5 m"], "expected a range such as '4..8 lb', got '0..5 m'"),
        (
            "elevator-2khz",
            "robust",
            ["feel.breakout=5..1 lb"],
            "expected a least and a greatest value within 0 to 10000 lb",
        ),
        ("elevator-2khz", "robust", ["feel.breakout=-1..1 lb"], "expected a least and a greatest value within"),
        (
            "elevator-2khz",
            "robust",
            ["feel.breakout=1..5 lb"],
            "expected a range that holds the loader's own value, 0 lb (off)",
        ),
        ("elevator-2khz", "robust", ["feel.hard_stop_high=1..5 deg"], "holds the loader's own value, inf deg (off)"),
        ("elevator-2khz", "robust", ["feel.deadband", "feel.deadband"], "feel.deadband is given twice; give it once"),
        ("elevator-2khz", "robust", ["feel.detent_travel=0.5..2 deg"], "somewhere in the ranges"),
        ("desktop-yoke", "torque-mode", ["feel.breakout=0..5 N"], "designed for the steepest slope of the feel"),
    ],
)
def test_bad_row_or_range_is_refused(export, loader, law, words, expected):
    options = [word for text in words for word in ("--tunable", text)]
    status, _, error = export(loader, "--law", law, "--to", "c", *options, "--out", "out")
    assert status == 2
    assert error.startswith("error: --tunable: ") or "--tunable: " in error
    assert expected in " ".join(error.split())


def test_linked_axis_is_refused_before_anything_is_written(export, tmp_path):
    path = Path(__file__).parents[2] / "examples" / "cockpit" / "linked-sticks.toml"
    status, _, error = export(path, "--to", "c", "--tunable", "feel.deadband=0..1 deg", "--out", "out")
    assert (status, "--tunable: axis stick-pitch is linked" in error) == (2, True)
    assert list(tmp_path.iterdir()) == []
    project = ff.loader.read_project(path)
    sides = (tuned(STICK, ON_STICK, "first"), tuned(STICK, ON_STICK, "second"))
    with pytest.raises(ff.InputError, match="an electronic link has fixed feels"):
        ff.export.PairExport.of(project, project.links["stick-pitch"], "cockpit", sides)


def test_tuning_is_for_c_and_one_setting(export):
    status, _, error = export("elevator-2khz", "--to", "st", "--tunable", "feel.deadband", "--out", "out")
    assert (status, "--tunable: is for --to c" in error) == (2, True)
    exported = tuned(VALVE, {"feel.deadband": "0..1 deg"}, "law")
    with pytest.raises(ff.InputError, match="is for the target c"):
        ff.export.write_export(exported, ff.export.Target.TABLE, "none")
    feel = np.array([[8.0, 60.0, 325.0], [6.8, 34.0, 1085.0]])
    with pytest.raises(ff.InputError, match="expected a law of one setting, got 2"):
        ff.export.Exported.of("robust", VALVE, "law", feel, tunable=["feel.deadband"])
