"""``_core`` called with what it cannot mean: it refuses, or answers; it neither panics nor goes on for ever."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import forcefeel as ff
from forcefeel import _core

VALUES = ff.digital_elevator().si_values
LAW = _core.GainLaw.original(VALUES)
STILL = {"force": np.zeros((10, 2)), "fade": np.ones((10, 2))}
"""Ten steps in which nothing happens; the feel is the next one."""

HUGE = 2**31
SHARES = (0.05, 0.9, 0.1)
TIME = np.arange(50) * 0.01


def loops():
    return _core.Loops(VALUES, [3], np.full((20, 1), VALUES[3]), law=LAW)


def run(timing=(1, 1), threads=1, **given):
    return _core.Simulation(STILL, 5e-4, timing=timing, **given).run(VALUES[np.newaxis], threads=threads)


@pytest.mark.parametrize("threads", [0, 1024, HUGE, 2**64 - 1])
def test_no_more_threads_are_started_than_there_are_cores(threads):
    assert len(loops().stability(threads)) == len(loops().poles(threads)) == 20
    assert len(_core.released(loops(), np.zeros((20, 5)), 0.1, 1e-3, threads)) == 20
    measuring = _core.ReleaseMeasuring(TIME, SHARES, tail=10)
    assert len(measuring.features(np.tile(np.cos(9 * TIME), (3, 1)), threads)) == 3
    assert run(threads=threads)[0].shape[0] == 1
    assert _core.sampled_loops(VALUES[np.newaxis], 5e-4, (1, 1), threads=threads)[1].shape[0] == 1


@pytest.mark.parametrize("timing", [(0, 0), (HUGE, 0), (2**64 - 1, 2**64 - 1), (10_001, 0), (1, 8), (2, HUGE)])
def test_controller_timing_outside_bounds_is_refused(timing):
    for call in (
        lambda: run(timing),
        lambda: _core.sampled_loops(VALUES[np.newaxis], 5e-4, timing),
        lambda: _core.sampled_slopes(VALUES, [3], 5e-4, timing),
    ):
        with pytest.raises(
            ValueError, match="timing: expected 1 to 10000 steps in a period and a delay of less than 8"
        ):
            call()


@pytest.mark.parametrize("step_s", [0.0, -1e-3, np.nan, np.inf])
def test_nonpositive_or_nonfinite_step_is_refused(step_s):
    for call in (
        lambda: _core.Simulation(STILL, step_s),
        lambda: _core.sampled_loops(VALUES[np.newaxis], step_s, (1, 1)),
        lambda: _core.released(loops(), np.zeros((20, 5)), 0.1, step_s, 1),
    ):
        with pytest.raises(ValueError, match="step_s: expected a time above zero"):
            call()


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: _core.Simulation({}, 5e-4), "inputs: expected an input and a step at least"),
        (lambda: _core.Simulation({"force": np.zeros((0, 2))}, 5e-4), "inputs: expected an input and a step at least"),
        (lambda: _core.Simulation(STILL | {"trim": np.zeros((9, 2))}, 5e-4), "inputs: trim: expected shape"),
        (lambda: _core.Simulation(STILL | {"push": STILL["force"]}, 5e-4), "inputs: expected names out of force, trim"),
        (lambda: run(outputs=[99]), "outputs: expected at most"),
        (lambda: run(changes=[(5, 2, VALUES, None)]), "changes: expected each to begin where the one before is done"),
        (lambda: run(curve=(np.array([2.0, 1.0, 0.0]), np.zeros((2, 4)))), "curve: expected rising numbers"),
        (lambda: run(curve=(np.array([]), np.zeros((1, 4)))), "curve: expected rising numbers"),
        (lambda: _core.ReleaseMeasuring(TIME[::-1], SHARES, tail=1), "time: expected rising numbers"),
        (lambda: _core.ReleaseMeasuring(TIME[:0], SHARES, tail=1), "time: expected rising numbers"),
        (lambda: _core.ReleaseMeasuring(TIME, SHARES, tail=2**63), "tail: expected at most 50"),
        (lambda: _core.ReleaseMeasuring(TIME, SHARES, tail=1, held=2**64 - 1), "held: expected at most 50"),
        (lambda: _core.ReleaseMeasuring(TIME, SHARES, tail=1, hysteresis=-1.0), "hysteresis: expected a number"),
        (lambda: _core.ReleaseMeasuring(TIME, SHARES, tail=1, reach=np.inf), "reach: expected a number"),
        (lambda: _core.recursion(*(np.eye(1),) * 4, HUGE, None), "steps: expected at most 10000000"),
        (lambda: _core.recursion(*(np.eye(0),) * 4, 5, None), "h: expected a state and an input"),
    ],
)
def test_invalid_arguments_raise_argument_error(call, said):
    with pytest.raises(_core.ArgumentError, match=said):
        call()


COUNTS = st.one_of(st.integers(0, 9), st.sampled_from([2**k + d for k in (16, 31, 32, 53, 63) for d in (-1, 0)]))
NUMBERS = st.one_of(st.sampled_from([1e-3, 5e-4, 0.1, 1.0]), st.floats(width=64))
CALLS = {
    "simulation": lambda n, x: _core.Simulation(
        {
            name: np.resize(x[:3], (n[0] % 20, 2))
            for name in ("force", "trim", "stiffness_factor", "shaker", "fade", "test_signal", "command_signal")
        },
        x[0],
        every=n[1],
        outputs=[n[2]],
        start_force=x[1],
        held=(x[2], n[3]),
        timing=(n[4], n[5]),
        curve=(np.sort(x[3:6]), np.resize(x, (2, 4))),
    ).run(VALUES[np.newaxis] * x[6], seed=n[6], first_run=n[7], threads=n[8]),
    "loops": lambda n, x: _core.Loops(VALUES * x[0], [n[0]], np.resize(x, (3, 1))).poles(n[1]),
    "stability": lambda n, x: _core.Loops(VALUES * x[0], [n[0] % 20], np.resize(x, (3, 1))).stability(n[1]),
    "released": lambda n, x: _core.released(loops(), np.zeros((20, n[0] % 99)), x[0], x[1], n[1]),
    "linear runs": lambda n, x: loops().run(
        np.zeros((20, 1, n[0] % 20 + 1)),
        np.resize(x[:4], (n[0] % 20, 2)),
        x[4],
        every=n[1],
        outputs=[n[2]],
        force_scale=None,
        start_force=x[5],
        held=(x[6], n[3]),
        threads=n[4],
    ),
    "features": lambda n, x: _core.ReleaseMeasuring(
        np.cumsum(np.resize(x[:3], 30)), x[3:6], tail=n[0], held=n[1], free=n[2], reach=x[6], hysteresis=x[7]
    ).features(np.resize(x, (2, 30)), n[3]),
    "details": lambda n, x: _core.ReleaseMeasuring(
        TIME, SHARES, tail=n[0] % 60, held=n[1] % 60, free=n[2] % 60, reach=x[0], hysteresis=x[1]
    ).details(np.resize(x, 50)),
    "sampled loops": lambda n, x: _core.sampled_loops(VALUES[np.newaxis] * x[0], x[1], (n[0], n[1]), threads=n[2]),
    "sampled slopes": lambda n, x: _core.sampled_slopes(VALUES * x[0], [n[0]], x[1], (n[1], n[2])),
    "recursion": lambda n, x: _core.recursion(*(np.resize(x, (n[0] % 4,) * 2) for _ in range(4)), n[1] % 2**17, x[0]),
    "discretize": lambda n, x: _core.discretize(np.resize(x, (n[0] % 4,) * 2), np.ones((n[0] % 4, n[1] % 3)), x[0]),
    "schedule": lambda n, x: _core.schedule(
        np.resize(x, (4, 4)),
        np.resize(x, (4, 2)),
        np.resize(x, 4),
        x[0] if n[0] % 2 else None,
        np.resize(x, (n[1] % 4, 3)),
    ),
}


@pytest.mark.parametrize("name", CALLS)
@given(n=st.lists(COUNTS, min_size=9, max_size=9), x=st.lists(NUMBERS, min_size=8, max_size=8))
def test_random_counts_and_numbers_are_answered_or_refused(name, n, x):
    try:
        with np.errstate(all="ignore"):
            CALLS[name](n, np.array(x))
    except (ValueError, OverflowError):  # what is no count at all does not get as far as the engine
        pass
