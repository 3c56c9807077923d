"""C of an electronic link: it gives the bits of the simulated pair, and opens where it is given no number."""

from dataclasses import replace

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.export.pair_code import PAIR_PART
from forcefeel.loader.links import LINK_TABLE
from tests.export.toolchain import STRICT, needs, run
from tests.linked.pairs import project
from tests.parametrization import mostly_slow

COMMANDS, OPEN, RECORDED_OPEN = ((0, 4), (4, 9)), 15, 12
"""Columns of the answers and of what a run recorded: commands of both laws, and whether the link is open."""


BODY = {"middle_inertia": 0.05, "middle_damping": 0.1, "middle_stiffness": 4.0}


def pair(name="linked-sticks", after="override", **rows):
    """The laws of a project on its first electronic link, SI rows of the link changed."""
    axes = project(name)
    link = next(link for link in axes.links.values() if link.kind == "electronic")
    values = np.array([rows.get(row, link[row]) for row in LINK_TABLE])
    link = replace(link, values=values, after_breakout=ff.linked.AfterBreakout(after))
    axes = replace(axes, links={link.name: link})
    sides = [ff.export.Exported.of("robust", axes.loaders[axis], f"s{k}") for k, axis in enumerate(link.between)]
    return ff.export.PairExport.of(axes, link, "x", tuple(replace(side, linked=True) for side in sides))


def written(exported, out, **options):
    for axis, side in zip(exported.link.between, exported.sides, strict=True):
        ff.export.write_export(side, ff.export.Target.C, out / axis, **options)
    ff.export.write_pair(exported, out / "link", **options)
    return out / "link"


@pytest.mark.parametrize(
    "rows",
    [
        {},
        {"after": "uncouple"},
        {"priority_force": 20.0, "breakout": np.inf},
        {"delay": 2e-3, "breakout": 2.0, "stiffness_after": 40.0, "play": 0.01, "injected_damping": 0.3},
        {"name": "transport"},
        BODY,
        {"middle_inertia": 0.05, "middle_stiffness": 4.0, "delay": 2e-3, "injected_damping": 0.3, "play": 0.01},
    ],
)
def test_pair_has_the_bits_of_its_simulation(rows):
    """Commands of both laws over 2,000 cycles each: beyond the breakout, with priority, and after a disconnect."""
    exported = pair(**rows)
    given, sampled = exported.recorded()
    traced = exported.traced(single=False)
    answers = np.vstack([traced.answers(given[k : k + PAIR_PART]) for k in range(0, len(given), PAIR_PART)])
    for answer, recorded in COMMANDS:
        np.testing.assert_array_equal(answers[:, answer], sampled[:, recorded])
        assert np.abs(sampled[:PAIR_PART, recorded]).max() > 1.0
    np.testing.assert_array_equal(answers[:, OPEN], sampled[:, RECORDED_OPEN])
    by_force, by_button, gave_way, opened = answers[:, 12:].mean(axis=0)
    assert by_button > 0.1
    assert opened == (gave_way if "after" in rows else pytest.approx(1 / 6))
    assert gave_way >= opened
    assert (by_force > 0) == ("priority_force" in rows)


@pytest.mark.slow
@pytest.mark.parametrize("single", [False, True])
def test_compiled_pair_matches_bitwise(tmp_path, single):
    needs("gcc")
    folder = written(pair(priority_force=20.0), tmp_path, single=single)
    for level in (0, 2):
        printed = run(folder, "make", "-B", "test", "CC=gcc", f"CFLAGS=-O{level}")
        assert "x_stick_pitch_link: 6000 samples, 0 differ\n" in printed
    run(folder, "make", "CC=gcc")
    assert len(run(folder, "./x_stick_pitch_link_main").splitlines()) == 4


_LINK = """#include "x_stick_pitch_link.h"
#include <stdio.h>
int main(void) {
    static x_stick_pitch_link_state state;
    x_stick_pitch_link_input in;
    x_stick_pitch_link_output out;
    int flags[3];
    double *const a = in.motion.angle, *const r = in.motion.rate;
    for (int k = 0; scanf("%la %la %la %la %la %la", a, r, a + 1, r + 1, in.hand, in.hand + 1) == 6; ++k) {
        if (scanf("%d %d %d", flags, flags + 1, flags + 2) != 3) { return 1; }
        in.button[0] = flags[0] != 0;
        in.button[1] = flags[1] != 0;
        in.disconnect = flags[2] != 0;
        if (k == 0) { x_stick_pitch_link_reset(&state, &in.motion); }
        const int status = x_stick_pitch_link_step(&state, &in, &out);
        printf("%d %a %a %a %a ", status, out.force[0], out.force[1], out.damping[0], out.damping[1]);
        printf("%d %d %d %d\\n", out.priority[0], out.priority[1], out.gives_way, out.open);
    }
    return 0;
}
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("delay", "after", "middle"),
    mostly_slow([(2, "uncouple", {}), (7, "override", {}), (1, "uncouple", BODY)]),
)
def test_link_alone_answers_random_input_with_the_bits_of_the_core(tmp_path, delay, after, middle):
    needs("gcc")
    draws = np.random.default_rng(delay)
    rows = {"stiffness": 300.0, "damping": 2.0, "breakout": 30.0, "play": 0.02, "stiffness_after": 40.0}
    more = {"priority_force": 20.0, "injected_damping": 0.5, "delay": delay * 5e-4}
    exported = pair(after=after, **rows, **more, **middle)
    folder = written(exported, tmp_path)
    (folder / "random.c").write_text(_LINK, encoding="utf-8")
    laws = [f"../{axis}" for axis in exported.link.between]
    sources = ["x_stick_pitch_link.c", f"{laws[0]}/s0_law.c", f"{laws[1]}/s1_law.c"]
    run(folder, "gcc", *STRICT, *(f"-I{law}" for law in laws), "-o", "random", "random.c", *sources, "-lm")
    given = np.zeros((1600, 9))
    given[:, :4] = draws.normal(size=(1600, 4)).cumsum(axis=0) * [0.01, 0.3, 0.01, 0.3]
    given[:, 4:6] = draws.normal(scale=20.0, size=(1600, 2))
    given[:, 6:8] = draws.random((1600, 2)) < 0.1
    given[500:, 8] = 1.0
    lines = [
        " ".join([number.hex() for number in row[:6]] + [f"{flag:.0f}" for flag in row[6:]]) for row in given.tolist()
    ]
    (folder / "given.txt").write_text("\n".join(lines), encoding="utf-8")
    printed = run(folder, "sh", "-c", "./random < given.txt").splitlines()
    answers = [[float.fromhex(word) for word in line.split()] for line in printed]
    expected = exported.traced(single=False).link_answers(given)
    np.testing.assert_array_equal(np.array(answers), np.column_stack([np.zeros(len(given)), expected]))
    assert 0.1 < expected[:400, 6].mean() <= 1.0
    assert expected[:, 4:6].any(axis=0).all()
    # A disconnect fades within half a second.
    assert expected[1490, :4].any() == (after == "override")
    assert not expected[1501:, :4].any()


_NO_NUMBER = """#include "x_stick_pitch_link.h"
#include <math.h>
int main(void) {
    static x_stick_pitch_link_pair_state state;
    x_stick_pitch_link_pair_input in = { .first = { .stiffness_factor = 1.0 }, .second = { .stiffness_factor = 1.0 } };
    x_stick_pitch_link_pair_output out;
    int wrong = 0;
    wrong += x_stick_pitch_link_pair_step(&state, &in, &out) != x_stick_pitch_link_NOT_READY || out.first.command != 0.0;
    wrong += x_stick_pitch_link_pair_reset(&state, &in) != x_stick_pitch_link_OK;
    in.first.force = 10.0;
    for (int k = 0; k < 100; ++k) { wrong += x_stick_pitch_link_pair_step(&state, &in, &out) != x_stick_pitch_link_OK; }
    wrong += out.link.open || out.link.force[1] == 0.0;
    in.hand[0] = (double)NAN;
    wrong += x_stick_pitch_link_pair_step(&state, &in, &out) != x_stick_pitch_link_BAD_INPUT || out.link.force[1] != 0.0;
    in.hand[0] = 0.0;
    wrong += x_stick_pitch_link_pair_step(&state, &in, &out) != x_stick_pitch_link_OK || !out.link.open;
    wrong += x_stick_pitch_link_pair_reset(&state, &in) != x_stick_pitch_link_OK;
    in.second.force = (double)NAN;
    wrong += x_stick_pitch_link_pair_step(&state, &in, &out) != x_stick_pitch_link_BAD_LAW || out.second.command != 0.0;
    wrong += out.first.status != s0_OK;
    in.second.force = 0.0;
    wrong += x_stick_pitch_link_pair_step(&state, &in, &out) != x_stick_pitch_link_OK || !out.link.open;
    return wrong;
}
"""


def test_link_opens_at_a_hand_or_a_sensor_that_is_no_number(tmp_path):
    needs("gcc")
    exported = pair()
    folder = written(exported, tmp_path)
    (folder / "none.c").write_text(_NO_NUMBER, encoding="utf-8")
    laws = [f"../{axis}" for axis in exported.link.between]
    sources = ["x_stick_pitch_link.c", f"{laws[0]}/s0_law.c", f"{laws[1]}/s1_law.c"]
    run(folder, "gcc", *STRICT, *(f"-I{law}" for law in laws), "-o", "none", "none.c", *sources, "-lm")
    run(folder, "./none")


@pytest.mark.slow
def test_project_exports_its_links(forcefeel, tmp_path):
    sticks = f"{ff.__path__[0]}/../../examples/cockpit/linked-sticks.toml"
    status, out, _ = forcefeel("export", sticks, "--to", "c", "--law", "robust", "--out", "code")
    assert (status, "electronic link of stick-pitch and stick-pitch-first-officer" in out) == (0, True)
    needs("gcc")
    assert "6000 samples, 0 differ" in run(tmp_path / "code" / "stick-pitch-link", "make", "test", "CC=gcc")


@pytest.mark.slow
def test_shaft_is_noted_as_in_the_machine(forcefeel, tmp_path):
    column = f"{ff.__path__[0]}/../../examples/cockpit/transport-column.toml"
    status, *_ = forcefeel("export", column, "--to", "c", "--law", "robust", "--out", "code")
    files = list((tmp_path / "code" / "pitch-link").iterdir())
    assert (status, [file.name for file in files]) == (0, ["README.md"])
    assert "This link is a shaft: it is in the machine." in files[0].read_text(encoding="utf-8")
