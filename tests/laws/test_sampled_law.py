"""Sampled laws as data: rest by running them, rows as the engine takes them, what lies between two, what is refused."""

import numpy as np
import pytest

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.laws.sampled.sampled_law import MOST_STATES, OF_FRICTION, SAMPLED, SampledLaw

PERIOD, DELAY = 5e-4, 2e-4
ROUNDING = 1e-12
"""Share of the largest number by which two orders of the same sums of some twenty terms differ."""


def numbers(settings=3, n=7, seed=0):
    """Random laws that settle: every pole, their own command included, within half the unit circle."""
    rng = np.random.default_rng(seed)
    transition = rng.normal(size=(settings, n, n))
    transition *= 0.3 / np.linalg.norm(transition, ord=2, axis=(1, 2))[:, None, None]
    found = {
        "transition": transition,
        "input": rng.normal(size=(settings, n, 4)),
        "command": rng.normal(size=(settings, n + 5)),
        "torque": rng.normal(size=(settings, n + 5)),
        "friction": rng.normal(size=(settings, 2 * n + 19)),
        "neutral": rng.normal(size=(settings, 2)),
    }
    found["command"][:, :n] *= 0.02
    return found


def law(**options):
    return SampledLaw(PERIOD, DELAY, **numbers(**options))


def says(one, xi, y, feel):
    """T, e and the next state of one law, by its three equations."""
    z = np.concatenate([xi, y, feel])
    torque, e = one.torque[0] @ z, one.command[0] @ z
    return torque, e, one.transition[0] @ xi + one.input[0] @ np.append(y, e)


def read(row):
    """T, e and next as the engine reads a row: in the order of its documentation; nothing of the force at the grip."""
    sizes = [(9, 9), (9, 5), (15,), (15,), (9, 5), (2,), (38,), (11,)]
    ends = np.cumsum([np.prod(size) for size in sizes])
    parts = [part.reshape(size) for part, size in zip(np.split(row, ends[:-1]), sizes, strict=True)]
    places = [None, 3, 12, 12, 3, None, 12, None]
    assert not any(part[..., place].any() for part, place in zip(parts, places, strict=True) if place)
    return [
        part if place is None else np.delete(part, place, axis=-1) for part, place in zip(parts, places, strict=True)
    ]


@pytest.mark.parametrize("n", [1, 7, 9])
def test_settled_state_is_the_steady_state(n):
    laws = law(n=n)
    rng = np.random.default_rng(1)
    for k in range(laws.settings):
        one, y, delta = laws.some(k), rng.normal(size=3), rng.normal()
        xi = np.zeros(n)
        for _ in range(200):  # the slowest pole is below 0.6: 0.6^200 is nothing
            xi = says(one, xi, y, [delta, 0.0])[2]
        rest = one.settled[0] @ np.append(y, delta)
        np.testing.assert_allclose(xi, rest, rtol=0, atol=ROUNDING * np.abs(rest).max())


@pytest.mark.parametrize("n", [1, 7, 9])
def test_rows_pad_missing_states_with_zeros(n):
    laws = law(n=n)
    rows = laws.rows()
    assert rows.shape == (3, _core.OBSERVER_NUMBERS)
    assert rows.flags.c_contiguous
    rng = np.random.default_rng(2)
    for k, row in enumerate(rows):
        one, xi, y, feel = laws.some(k), rng.normal(size=n), rng.normal(size=3), rng.normal(size=2)
        transition, input_, command, torque, settled, neutral, friction, contact = read(row)
        wide = np.append(xi, rng.normal(size=MOST_STATES - n))  # whatever stands in the others
        z = np.concatenate([wide, y, feel])
        expected = says(one, xi, y, feel)
        after = transition @ wide + input_ @ np.append(y, command @ z)
        np.testing.assert_allclose([torque @ z, command @ z], expected[:2], rtol=ROUNDING)
        np.testing.assert_allclose(after[:n], expected[2], rtol=0, atol=ROUNDING * 10)
        assert not after[n:].any()
        np.testing.assert_array_equal(settled[:n], one.settled[0])
        assert not settled[n:].any()
        np.testing.assert_array_equal(neutral, one.neutral[0])
        np.testing.assert_array_equal(contact, one.contact[0])
        rate, enters, level = np.split(friction, [14, 23])
        np.testing.assert_array_equal(np.delete(rate, range(n, MOST_STATES)), one.friction[0, : n + 5])
        np.testing.assert_array_equal(enters[:n], one.friction[0, n + 5 : -OF_FRICTION])
        np.testing.assert_array_equal(level, one.friction[0, -OF_FRICTION:])
        assert not rate[n:MOST_STATES].any()
        assert not enters[n:].any()


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_blended_law_interpolates_the_outputs(share):
    one, two = law(settings=1), law(settings=1, seed=5)
    rng = np.random.default_rng(3)
    xi, y, feel = rng.normal(size=7), rng.normal(size=3), rng.normal(size=2)
    blend = one.between(two, share)
    z = np.concatenate([xi, y, feel])
    for name in ("torque", "command"):
        expected = (1 - share) * (getattr(one, name) @ z) + share * (getattr(two, name) @ z)
        np.testing.assert_allclose(getattr(blend, name) @ z, expected, rtol=ROUNDING)
    # For one command, as the amplifier answers it, the next states too.
    given = np.append(y, 0.7)
    expected = sum(
        weight * (each.transition[0] @ xi + each.input[0] @ given) for weight, each in ((1 - share, one), (share, two))
    )
    np.testing.assert_allclose(
        blend.transition[0] @ xi + blend.input[0] @ given, expected, rtol=0, atol=ROUNDING * np.abs(expected).max()
    )
    # At rest it is not between the two: it is the blended law that rests.
    rest = blend.settled[0] @ np.append(y, 0.2)
    np.testing.assert_allclose(says(blend, rest, y, [0.2, 0.0])[2], rest, rtol=0, atol=ROUNDING * np.abs(rest).max())


def test_subset_of_laws_is_selected():
    laws = law(settings=5)
    assert (laws.settings, laws.states) == (5, 7)
    for which, places in ((2, [2]), (slice(1, 3), [1, 2]), ([4, 0], [4, 0]), (np.arange(5) > 2, [3, 4])):
        chosen = laws.some(which)
        np.testing.assert_array_equal(chosen.rows(), laws.rows()[places])
        assert (chosen.period_s, chosen.delay_s) == (PERIOD, DELAY)
        assert not any(array.flags.writeable for array in (chosen.transition, chosen.settled))


def test_law_numbers_are_copied_and_read_only():
    given = numbers()
    laws = SampledLaw(PERIOD, DELAY, **given)
    before = laws.rows()
    given["transition"][:] = 0.0
    np.testing.assert_array_equal(laws.rows(), before)
    with pytest.raises(ValueError, match="read-only"):
        laws.command[0] = 1.0


def integrating():
    """A law whose first state sums up its signals for ever."""
    found = numbers()
    found["transition"][1, 0] = np.eye(7)[0]
    found["input"][1, 0, SAMPLED] = 0.0
    return found


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"period_s": 0.0}, "period_s: expected a time above 0"),
        ({"period_s": np.nan}, "period_s"),
        ({"delay_s": 2 * PERIOD}, r"delay_s: expected 0 to the period of 0\.0005 s, got 0\.001"),
        ({"delay_s": -1e-6}, "delay_s"),
        ({"transition": np.zeros((3, 10, 10))}, "1 to 9 states"),
        ({"transition": np.zeros((7, 7))}, r"\(settings, n, n\)"),
        ({"input": np.zeros((3, 7, 3))}, r"input: expected the shape \(3, 7, 4\), got \(3, 7, 3\)"),
        ({"command": np.zeros((3, 10))}, r"command: expected the shape \(3, 12\)"),
        ({"torque": np.zeros((2, 12))}, r"torque: expected the shape \(3, 12\)"),
        ({"friction": np.zeros((3, 9))}, r"friction: expected the shape \(3, 33\), got \(3, 9\)"),
        ({"torque": [["a"] * 12] * 3}, "torque: expected an array of numbers"),
        ({"command": np.full((3, 12), np.inf)}, "command: expected finite numbers.* setting 0"),
        (integrating(), "pole at 1 in setting 1"),
    ],
)
def test_invalid_law_numbers_raise_input_error(change, said):
    with pytest.raises(InputError, match=said):
        SampledLaw(**{"period_s": PERIOD, "delay_s": DELAY, **numbers(), **change})


def test_incompatible_laws_cannot_be_blended():
    one = law(settings=1)
    slow = SampledLaw(2 * PERIOD, DELAY, **numbers(settings=1))
    for other, share, said in (
        (slow, 0.5, "period_s 0.0005"),
        (law(settings=1, n=6), 0.5, "states 7"),
        (law(), 0.5, "two single laws, got 1 and 3"),
        (one, 1.5, "share: expected a number from 0 to 1"),
        (one, np.nan, "share"),
    ):
        with pytest.raises(InputError, match=said):
            one.between(other, share)
