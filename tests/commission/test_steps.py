"""The steps of a folder: done once, made again where something changed; what a commissioning writes and says."""

import json
from dataclasses import dataclass, replace

import pytest

import forcefeel as ff
from forcefeel.commission.findings import commission_conclusions
from forcefeel.commission.page.page import check_folder, write_commission
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import (
    Commission,
    EnvelopeResult,
    Identified,
    IdentifiedParameter,
    LawChosen,
    RuleTests,
    WhatIf,
)
from forcefeel.commission.steps import STATE, State, digest


@dataclass(frozen=True)
class Found:
    value: float
    names: tuple[str, ...] = ()


class Step:
    def __init__(self):
        self.made = 0

    def __call__(self, folder):
        self.made += 1
        folder.mkdir(exist_ok=True)
        (folder / "a.txt").write_text("whole", encoding="utf-8")
        return Found(0.1, ("one", "two"))


def test_completed_step_is_reused_with_its_result(tmp_path):
    step = Step()
    first = State.of(tmp_path).step("1-one", "same", Found, step)
    again = State.of(tmp_path)
    assert again.step("1-one", "same", Found, step) == first
    assert (step.made, again.resumed) == (1, ["1-one"])


@pytest.mark.parametrize("spoil", ["inputs", "file", "missing", "state"])
def test_incomplete_or_outdated_step_is_repeated(tmp_path, spoil):
    step = Step()
    State.of(tmp_path).step("1-one", "same", Found, step)
    if spoil == "file":
        (tmp_path / "1-one" / "a.txt").write_text("half", encoding="utf-8")
    if spoil == "missing":
        (tmp_path / "1-one" / "a.txt").unlink()
    if spoil == "state":
        (tmp_path / STATE).write_text("{", encoding="utf-8")
    State.of(tmp_path).step("1-one", "other" if spoil == "inputs" else "same", Found, step)
    assert step.made == 2


def test_steps_after_a_repeated_step_are_repeated(tmp_path):
    first, second = Step(), Step()
    for inputs in ("a", "b", "b"):
        state = State.of(tmp_path)
        state.step("1-one", inputs, Found, first)
        state.step("2-two", "same", Found, second)
    assert (first.made, second.made) == (2, 2)


def test_interrupted_step_keeps_earlier_steps(tmp_path):
    first = Step()

    def interrupted(folder):
        raise KeyboardInterrupt

    for _ in range(2):
        state = State.of(tmp_path)
        state.step("1-one", "a", Found, first)
        with pytest.raises(KeyboardInterrupt):
            state.step("2-two", "a", Found, interrupted)
    assert first.made == 1
    assert digest("a", 1) != digest("a", 2)


LOADER = ff.digital_elevator()
INERTIA = IdentifiedParameter(
    "column.inertia", LOADER["column.inertia"], 1.1 * LOADER["column.inertia"], 2e-4, "identified"
)


@pytest.fixture
def commissioned(tmp_path):
    for name in ("1-identification", "2-law"):
        (tmp_path / name).mkdir()
    (tmp_path / "1-identification" / "loader.toml").write_text(LOADER.to_toml(), encoding="utf-8")
    law = ff.Law.of("robust", LOADER)
    law.save(tmp_path / "2-law" / "law.json")
    return Commission(
        CommissionPlan(),
        LOADER,
        Identified(True, "All 1 parameters are determined.", parameters=(INERTIA,)),
        LOADER,
        LawChosen("robust", "Take robust."),
        law,
        EnvelopeResult(96, 0.97, 0.6, 12, 0.96, 0.93),
        RuleTests(True, "a rule", "It qualifies.", {"static": "passed"}),
    )


def test_accepted_law_is_written(commissioned, tmp_path):
    page = write_commission(commissioned, tmp_path, command="forcefeel commission my.toml")
    text = page.read_text(encoding="utf-8")
    assert commissioned.ok
    assert "1 parameter of elevator-2khz is identified" in text
    assert "the law is robust" in text
    assert (tmp_path / "law.json").exists()
    assert not (tmp_path / "law-rejected.json").exists()
    found = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    assert (found["ok"], found["law"]["name"], found["envelope"]["passes"]) == (True, "robust", 0.97)
    check_folder(tmp_path, "forcefeel commission my.toml")  # the same may go on
    with pytest.raises(ff.InputError, match="--replace"):
        check_folder(tmp_path, "forcefeel commission other.toml")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"envelope": EnvelopeResult(96, 0.9, 0.5, 12, 0.89, 0.8, (), (WhatIf("no dry friction", 0.99),))},
            "below the required 95\N{NO-BREAK SPACE}%",
        ),
        (
            {"tested": RuleTests(False, "a rule", "It does not.", {"fast": "failed"}, ("Too slow.",))},
            "does not pass the rule",
        ),
        ({"identified": Identified(False, "One.", (), (INERTIA,), ("Noise is zero.",))}, "Do not use it"),
    ],
)
def test_rejected_law_is_written_as_rejected(commissioned, tmp_path, change, said):
    write_commission(commissioned, tmp_path)
    bad = replace(commissioned, **change)
    text = write_commission(bad, tmp_path).read_text(encoding="utf-8")
    assert not bad.ok
    assert said in text
    assert "no law meets the requirements" in text
    assert (tmp_path / "law-rejected.json").exists()
    assert not (tmp_path / "law.json").exists()


@pytest.mark.parametrize(
    ("parameters", "said"), [((), "0 parameters"), ((INERTIA,), "1 parameter"), ((INERTIA,) * 2, "2 parameters")]
)
def test_parameter_count_has_its_plural(commissioned, parameters, said):
    found = replace(commissioned, identified=Identified(True, "", parameters=parameters))
    verb = "is" if len(parameters) == 1 else "are"
    assert commission_conclusions(found).verdict.startswith(f"{said} of elevator-2khz {verb} identified")
