"""What follows from a result is worked out once, kept with it, and handed to terminal, JSON and page alike."""

import dataclasses
from importlib import import_module

import pytest

import forcefeel as ff
from forcefeel.conclusions import capital, of_result
from tests.parametrization import mostly_slow

US, SI = ff.UnitSystem.US, ff.UnitSystem.SI


@dataclasses.dataclass(frozen=True)
class Result:
    number: int


@pytest.fixture
def counted():
    """A finding that tells how often it was worked out."""
    calls = []

    @of_result
    def finding(result, units):
        calls.append((result.number, units))
        return object()

    return finding, calls


def test_conclusions_are_computed_once_per_result_and_units(counted):
    finding, calls = counted
    one, same = Result(1), Result(1)
    assert finding(one, US) is finding(one, US)
    assert finding(one, SI) is not finding(one, US)
    assert finding(same, US) is not finding(one, US)
    assert calls == [(1, US), (1, SI), (1, US)]


def test_changed_result_has_no_cached_conclusions(counted):
    finding, calls = counted
    one = Result(1)
    finding(one, US)
    finding(dataclasses.replace(one, number=2), US)
    assert calls == [(1, US), (2, US)]


COMMANDS = {
    "simulate": ("forcefeel.simulation.findings", ("simulate", "elevator-1974")),
    "design": ("forcefeel.design.findings", ("design", "elevator-1974")),
    "qualify": ("forcefeel.qualification.plan.sentences", ("qualify", "elevator-1974")),
}


@pytest.mark.parametrize("printed", [(), ("--json",)], ids=["terminal", "json"])
@pytest.mark.parametrize("command", mostly_slow(COMMANDS))
def test_command_computes_conclusions_once(command, printed, forcefeel, monkeypatch):
    where, words = COMMANDS[command]
    module = import_module(where)
    original, calls = module._verdict, []
    monkeypatch.setattr(module, "_verdict", lambda *given, **options: calls.append(1) or original(*given, **options))
    forcefeel(words[0], *words[1:], "--out", "out", *printed)
    assert len(calls) == 1


@pytest.mark.parametrize(
    ("text", "begun"),
    [
        ("robust", "Robust"),
        ("robust (law.json)", "Robust (law.json)"),
        ("law.json", "law.json"),
        ("law.json: 3", "law.json: 3"),
    ],
)
def test_sentence_is_capitalized_except_for_file_name(text, begun):
    assert capital(text) == begun
