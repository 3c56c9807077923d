"""Inputs of a scenario take text with a unit in place of a number in SI units."""

import dataclasses
import math
import pickle

import pytest

import forcefeel as ff
from forcefeel.errors import InputError

POUND = 4.4482216152605  # N, by definition


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (ff.Step("100 N"), ff.Step(100.0)),
        (ff.Step("100 lb", start_s="50 ms"), ff.Step(100 * POUND, 0.05)),
        (ff.simulation.Pulse("-20 N", "0 s", "0.2 s"), ff.simulation.Pulse(-20.0, 0.0, 0.2)),
        (ff.simulation.Doublet("10 N", "0.1 s", "0.2 s"), ff.simulation.Doublet(10.0, 0.1, 0.2)),
        (ff.simulation.StopToStop("10 N", "100 s"), ff.simulation.StopToStop(10.0, 100.0)),
        (ff.simulation.Chirp("10 N", "0.1 Hz", "5 Hz", "20 s"), ff.simulation.Chirp(10.0, 0.1, 5.0, 20.0)),
        (ff.Release("5 deg"), ff.Release(math.radians(5.0))),
    ],
    ids=lambda value: type(value).__name__,
)
def test_text_with_unit_is_converted_to_si(given, expected):
    for value, number in zip(dataclasses.astuple(given), dataclasses.astuple(expected), strict=True):
        assert value == (number if isinstance(number, str) else pytest.approx(number, rel=1e-12))  # digits of POUND


@pytest.mark.parametrize(
    ("text", "reason"), [("100", "has no unit"), ("100 s", "not a force"), ("much", "got .much."), ("", "got .")]
)
def test_bad_text_names_input_field_and_remedy(text, reason):
    with pytest.raises(InputError, match=rf"Step: force_n: expected a number with its unit such as '100 N'.*{reason}"):
        ff.Step(text)


def test_bounds_apply_to_text():
    with pytest.raises(InputError, match="start_s"):
        ff.Step("1 N", start_s="-1 s")


def test_a_required_field_stays_required():
    with pytest.raises(TypeError, match="force_n"):
        ff.Step()


def test_converted_input_is_a_plain_value():
    step = ff.Step("100 N")
    assert (step, hash(step)) == (ff.Step(100.0), hash(ff.Step(100.0)))
    assert pickle.loads(pickle.dumps(step)) == step
    assert dataclasses.replace(step, start_s="1 s") == ff.Step(100.0, 1.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        step.force_n = 1.0
