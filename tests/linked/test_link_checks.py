"""forcefeel's own checks of a link: right by hand, and able to fail."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from tests.linked.pairs import EXAMPLES, LB, LB_IN, project

TRANSPORT, UNCOUPLING = (str(Path(EXAMPLES, f"{name}.toml").resolve()) for name in ("transport-column", "uncoupling"))

SLOW, RUBS = 0.01, 0.1
"""Of a slow push against a link of known rows; of friction that is beyond the breakout where the hand moves on."""


def changed(name, **rows):
    """A ready project, both of its loaders changed."""
    axes = project(name)
    loaders = {axis: loader.replace(rows) for axis, loader in axes.loaders.items()}
    return replace(axes, loaders=loaders)


def by_name(axes, link="pitch", law="robust"):
    return {check.name: check for check in ff.linked.check_link(axes, link, law)}


def test_breakout_and_stiffness_are_those_of_the_rows_by_hand():
    checks = by_name(project("transport-column"))
    for side in ("up", "down"):
        assert checks[f"breakout, {side}"].value == pytest.approx(1000 / 31.375 * LB, rel=SLOW)
    assert checks["stiffness"].value == pytest.approx(20000 * LB_IN, rel=SLOW)
    assert all(check.passed for check in checks.values())


def test_stiffness_is_measured_beyond_the_friction_of_the_feel():
    """3 lb of friction hold the lever, and its spring has less than 1 lb at 5 deg: half of the push moved nothing."""
    checks = by_name(project("helicopter"), "collective")
    assert checks["stiffness"].value == pytest.approx(8000 * LB_IN, rel=SLOW)
    assert all(check.passed for check in checks.values())


def test_uncoupling_link_has_its_swing_measured_without_a_limit():
    swing = by_name(project("uncoupling"))["swing beyond rest, uncoupling"]
    assert swing.outcome == "measured"
    # Feels of 2 Hz, damped by a fifth, overshoot a step by half at most.
    assert 0 < swing.value < 0.5 * np.radians(21)


def test_friction_that_the_law_does_not_know_fails_the_breakout():
    checks = by_name(changed("transport-column", **{"column.coulomb_friction": "4 lb"}), law=law_without_friction())
    assert not checks["breakout, up"].passed
    assert checks["breakout, up"].value - 1000 / 31.375 * LB == pytest.approx(4 * LB, rel=RUBS)


def law_without_friction():
    return ff.Law.of("robust", project("transport-column").loaders["pitch"])


def test_link_that_is_out_of_reach_is_told():
    checks = by_name(changed("uncoupling", **{"column.stop_high": "5 deg", "column.stop_low": "-5 deg"}))
    assert checks["breakout, up"].texts(ff.UnitSystem.US)[0] == "did not give way"
    assert not checks["breakout, up"].passed


def with_link(axes, name, kind=None, **rows):
    """The project with other values of a link, SI."""
    link = axes.links[name]
    values = np.array([rows.get(row, link[row]) for row in ff.loader.links.LINK_TABLE])
    return replace(axes, links={name: replace(link, values=values, kind=kind or link.kind)})


def test_stiffness_is_checked_without_a_breakout():
    axes = with_link(project("transport-column"), "pitch", breakout=np.inf)
    checks = by_name(axes)
    assert checks["stiffness"].value == pytest.approx(20000 * LB_IN, rel=SLOW)
    assert not any(name.startswith(("breakout", "largest step")) for name in checks)


def test_run_that_diverged_fails_and_says_so():
    late = {"kind": ff.linked.LinkKind.ELECTRONIC, "delay": 0.02, "stiffness": 2e5, "breakout": np.inf}
    axes = with_link(project("uncoupling"), "pitch", **late)
    # Without limits, which would end the swing.
    linear = ff.elevator().replace({"controller.period": "0.5 ms", "controller.delay": "0.5 ms"})
    checks = by_name(replace(axes, loaders=dict.fromkeys(axes.loaders, linear)), law="load-cell")
    released = checks["position difference, both released"]
    assert (released.outcome, released.texts(ff.UnitSystem.US)[0]) == ("failed", "diverged")
    assert not any(check.passed for check in checks.values())


@pytest.mark.slow
def test_json_has_no_limits_where_there_are_none(forcefeel, tmp_path):
    _, text, _ = forcefeel("qualify", UNCOUPLING, "--law", "robust", "--out", str(tmp_path / "out"), "--json")
    swing = json.loads(text)["links"]["pitch"][-1]
    assert (swing["check"], swing["outcome"]) == ("swing beyond rest, uncoupling", "measured")
    assert swing["value"]["unit"] == "deg"
    assert swing["low"] is swing["high"] is None


def test_link_that_swings_on_in_the_hand_of_the_second_pilot_fails():
    axes = project("linked-sticks")
    # Of 20 ms; 2.5 to 25 times its largest stable stiffness. The part for contact interrupts the swings of the stiffer ones.
    for stiffness in (500.0, 1000.0, 2000.0, 3000.0, 5000.0):
        checks = by_name(with_link(axes, "stick-pitch", delay=0.02, stiffness=stiffness, breakout=1e4), "stick-pitch")
        assert not any(swings_out(checks, arm) for arm in ("loose", "firm"))
    assert swings_out(by_name(axes, "stick-pitch"), "loose")


def swings_out(checks, arm):
    """Whether a link's swing in the hand of the second pilot ends, by both checks."""
    ends = [checks[f"swing {what}, first released, second held: {arm}"].passed for what in ("left", "at the end")]
    return all(ends)


def test_qualify_checks_the_links_of_a_project(forcefeel, tmp_path):
    out = str(tmp_path / "out")
    status, text, _ = forcefeel("qualify", TRANSPORT, "--law", "robust", "--out", out, "--json")
    links = json.loads(text)["links"]["pitch"]
    assert status == 0
    assert [check["outcome"] for check in links] == ["passed"] * 9
    assert links[0]["value"]["unit"] == "lb"
    page = (tmp_path / "out" / "qualification.html").read_text(encoding="utf-8")
    assert "position difference, both released" in page


def test_qualify_with_some_tests_leaves_links_alone(forcefeel, tmp_path):
    one = ("--test", "release-25-positive", "--out", str(tmp_path / "out"), "--law", "robust", "--json")
    status, text, _ = forcefeel("qualify", TRANSPORT, *one)
    assert (status, json.loads(text)["links"]) == (0, {})
