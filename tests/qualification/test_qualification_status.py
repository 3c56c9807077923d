"""What the tests of a programme come to as a whole: qualifies, does not qualify, incomplete with what is missing."""

import math
from dataclasses import replace
from itertools import combinations, product

import pytest

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.qualification import Outcome, load_rules
from forcefeel.qualification.plan import QualificationSetup, QualificationStatus, qualify_loader
from forcefeel.qualification.plan.plan import rule_plan
from forcefeel.qualification.plan.result import Result, Section
from forcefeel.qualification.plan.sentences import conclusions

STATIC, SURFACE, SMALL, TRIM = {"static"}, {"surface"}, {"small-inputs"}, {"trim-indicator", "trim-rate"}
UP, DOWN = ({f"release-{share}-{side}" for share in (25, 50)} for side in ("positive", "negative"))
SWEEPS = {"medium", "fast"}
RULE = load_rules("part60-a-2014")


def _enough(evaluated: set[str]) -> bool:
    """What Part 60 asks for in words: the static curves, small inputs, and a release each way or the alternate sweeps."""
    released = bool(evaluated & UP) and bool(evaluated & DOWN)
    return evaluated >= (STATIC | SURFACE | SMALL) and (released or evaluated >= SWEEPS)


def _section(outcomes, *, recorded=True, named=()):
    """A section whose tests came to this; those that are not mentioned were not evaluated."""
    planned = rule_plan(RULE, "pitch", recorded=recorded, named=named)
    results = (
        Result(trial, outcomes.get(trial.key, Outcome.NOT_EVALUATED), reason="nobody made it") for trial in planned.made
    )
    return Section("record", "recorded simulator", tuple(results), planned)


def _passed(keys):
    return dict.fromkeys(keys, Outcome.PASSED)


def test_record_set_is_complete_exactly_when_rule_is_met():
    keys = sorted(STATIC | SURFACE | SMALL | UP | DOWN | SWEEPS)
    sets = [set(some) for size in range(len(keys) + 1) for some in combinations(keys, size)]
    assert len(sets) == 2**9
    for some in sets:
        section = _section(_passed(some))
        assert (section.status is QualificationStatus.QUALIFIES) is _enough(some), some
        if not _enough(some):
            assert section.status is QualificationStatus.INCOMPLETE
            # Whatever is called missing completes it.
            added = {alternatives[0].key for alternatives in section.missing}
            assert _enough(some | added), some


@pytest.mark.parametrize("other", [Outcome.PASSED, Outcome.TOO_CLOSE, Outcome.NOT_EVALUATED])
def test_single_failure_does_not_qualify(other):
    keys = STATIC | SURFACE | SMALL | UP | DOWN | SWEEPS
    outcomes = dict.fromkeys(keys, other) | {"fast": Outcome.FAILED}
    assert _section(outcomes).status is QualificationStatus.DOES_NOT_QUALIFY


def test_too_close_test_leaves_qualification_incomplete_and_named():
    keys = STATIC | SURFACE | SMALL | UP | DOWN
    section = _section(_passed(keys) | {"release-50-negative": Outcome.TOO_CLOSE})
    assert section.status is QualificationStatus.INCOMPLETE
    assert [[trial.key for trial in one] for one in section.missing] == [["release-50-negative"]]


def test_simulated_loader_program_excludes_surface_and_body():
    loader, simulator = (rule_plan(RULE, "pitch", recorded=recorded) for recorded in (False, True))
    assert {trial.key for trial in loader.outside} == SURFACE | SMALL | TRIM
    assert {trial.key for trial in simulator.outside} == TRIM
    whole = {trial.key for trial in (*simulator.trials, *simulator.outside)}
    assert whole == {trial.key for trial in (*loader.trials, *loader.outside)}
    section = _section(_passed(STATIC | UP | DOWN | SWEEPS), recorded=False)
    assert section.status is QualificationStatus.QUALIFIES
    assert _section(_passed(STATIC | UP | DOWN | SWEEPS)).status is QualificationStatus.INCOMPLETE


def test_only_named_tests_run_and_others_stay_missing():
    section = _section(_passed(STATIC), named=("static",))
    assert [result.trial.key for result in section.results] == ["static"]
    assert section.fulfilled
    assert section.status is QualificationStatus.INCOMPLETE
    assert "surface" in {trial.key for one in section.missing for trial in one}
    for outcome in (Outcome.FAILED, Outcome.TOO_CLOSE, Outcome.NOT_EVALUATED):
        assert not _section({"static": outcome}, named=("static",)).fulfilled
    # Who names all of them has named the programme.
    keys = sorted(STATIC | UP | DOWN | SWEEPS)
    assert _section(_passed(keys), recorded=False, named=keys).status is QualificationStatus.QUALIFIES
    # Without names, passing a part is not enough.
    assert not _section(_passed(STATIC)).fulfilled


@pytest.mark.parametrize(
    ("named", "said"),
    [
        (("wheel",), "test: unknown test 'wheel'; expected some of static, release-25-positive, "),
        (("trim-rate",), "test: expected some of static, "),
        (
            ("surface",),
            "test: surface cannot be simulated: a control loader has no surface",
        ),
    ],
)
def test_unavailable_test_name_is_refused(named, said):
    with pytest.raises(InputError, match=said):
        rule_plan(RULE, "pitch", recorded=False, named=named)


@pytest.mark.parametrize(
    ("edition", "axis"),
    [
        *product(("part60-c-2014", "part60-d-2014"), ("pitch", "roll", "yaw", "collective")),
        *product(("part60-a-2014", "part60-a-2016"), ("pitch", "roll", "yaw", "nosewheel", "brake")),
    ],
)
def test_program_contains_every_test_of_axis(edition, axis):
    rules = load_rules(edition)
    planned = rule_plan(rules, axis, recorded=False)
    numbers = {trial.test.number for trial in (*planned.trials, *planned.outside)}
    assert numbers == {test.number for test in rules.tests if test.axis == axis}


def test_freeplay_of_a_helicopter_is_measured_at_the_grip():
    """A dead band of phi to either side is ``2 R_p phi`` there; 0.1 in may be off."""
    loader = ff.elevator()
    arm = loader["column.grip_arm"]
    setup = QualificationSetup(laws=("published",), rule="part60-c-2014", tests=("freeplay",))
    found = qualify_loader(loader.replace({"feel.deadband": "1 deg"}), setup)
    (result,) = found.sections[0].results
    (verdict,) = result.verdicts
    assert verdict.tolerance == pytest.approx(0.1 * 0.0254)
    for figure, side in ((verdict.measured, result.measured), (verdict.reference, result.reference)):
        assert (figure.unit, side.features.freeplay.unit) == ("m", "rad")
        assert figure.value == pytest.approx(arm * side.features.freeplay.value, rel=1e-12)  # a product, rounded
        assert figure.value == pytest.approx(arm * 2 * math.radians(1), rel=0.2)  # of the right size: no factor is lost


def test_conclusions_use_status_words():
    said = {}
    for name, outcomes in {
        "qualifies": _passed(STATIC | SURFACE | SMALL | UP | DOWN),
        "does not qualify": {"static": Outcome.FAILED},
        "incomplete": _passed(STATIC),
    }.items():
        section = _section(outcomes)
        found = replace(_found(), sections=(section,), test_plan=section.test_plan)
        said[name] = conclusions(found)
        assert str(found.status) == name
        assert said[name].verdict.count(name) == 1
        assert said[name].ok is (name == "qualifies")
    missing = said["incomplete"].verdict
    for keys in ("surface", "release-25-positive or release-50-positive", "small-inputs"):
        assert keys in missing
    assert "static" not in missing
    assert "medium and fast can replace the releases" in missing


def _found():
    return qualify_loader(ff.elevator(), QualificationSetup(laws=("published",), tests=("release-25-positive",)))
