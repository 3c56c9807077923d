"""Verdicts on many releases at once, without uncertainties."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError
from forcefeel.qualification.release_batch import ReleaseBatch
from forcefeel.qualification.release_verdicts import Overdamped
from forcefeel.qualification.rules import Test
from forcefeel.qualification.tolerance import Tolerance
from forcefeel.qualification.verdicts import check_kind

_CYCLES, _OVERSHOOTS = 9, 16

NAMES = (
    "not measured",
    "not settled",
    *(f"P{n}" for n in range(_CYCLES)),
    *(f"A{k}" for k in range(1, _OVERSHOOTS + 1)),
    "first overshoot",
    "overshoots",
    "steady state",
    "Ad",
    "fall time",
    "rise time",
)
"""Quantities by which a run can fail, in the order of evaluation."""

_INDEX = {name: k for k, name in enumerate(NAMES)}
_ROUNDING = 1e-12
"""Rounding, as a share of a tolerance, by which a difference may exceed its limit."""

_Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BatchVerdicts:
    """Verdicts on releases, a row for each.

    Attributes:
        passed: Whether each run passes (runs,).
        evaluated: Whether each run could be evaluated; a run that could not does not pass (runs,).
        first_failing: Index in ``names`` of the first quantity by which each run fails; -1 where it passes (runs,).
        margin: ``1 - max(difference / tolerance)``: 1 for equal releases, 0 at the limit, negative beyond it (runs,).
            Minus infinity where a quantity is missing, NaN where the run was not evaluated.
        names: Quantities by which a run can fail.
    """

    passed: NDArray[np.bool_]
    evaluated: NDArray[np.bool_]
    first_failing: NDArray[np.int8]
    margin: _Array
    names: tuple[str, ...] = NAMES

    def __len__(self) -> int:
        return len(self.passed)


def judge_releases(
    batch: ReleaseBatch,
    reference: ReleaseBatch,
    test: Test,
    *,
    travel: float | None = None,
    overdamped: Overdamped = "fall time",
) -> BatchVerdicts:
    """Verdicts as of ``judge_release``, without uncertainties: no run is too close to call.

    Args:
        batch: Features of the releases.
        reference: Features of the reference releases: one for all, or one for each.
        test: A release test of a rule.
        travel: Total travel of the control, in the position's unit, where a tolerance is a share of it.
        overdamped: Quantity compared where the reference has no overshoot.

    Raises:
        InputError: If the number of references is neither 1 nor that of the runs, or the test is not a release test.

    Example:
        >>> after = np.arange(0, 6, 1 / 500)
        >>> runs = np.stack([0.2 * np.exp(-z * 12 * after) * np.cos(12 * after) for z in (0.2, 0.21, 0.4)])
        >>> batch = ff.qualification.measure_releases(after, runs)
        >>> test = ff.qualification.load_rules().of("release", "pitch")
        >>> ff.qualification.judge_releases(batch, ff.qualification.measure_releases(after, runs[:1]), test).passed.tolist()
        [True, True, False]
    """
    check_kind(test, "release")
    if len(reference) not in {1, len(batch)}:
        raise InputError(f"reference: expected one, or one for each of {len(batch)} runs, got {len(reference)}")
    settled = np.logical_and(batch.settled, reference.settled)
    measured = np.logical_and(batch.measured, reference.measured)
    shares = np.full((len(batch), len(NAMES)), -np.inf)
    with np.errstate(invalid="ignore", divide="ignore"):
        for tolerance in test.tolerances:
            for name, share in _shares(tolerance, test, batch, reference, travel, overdamped):
                shares[:, _INDEX[name]] = share
    shares[:, _INDEX["not measured"]] = np.where(measured, -np.inf, np.inf)
    shares[:, _INDEX["not settled"]] = np.where(settled, -np.inf, np.inf)
    beyond = shares > 1 + _ROUNDING
    fails: NDArray[np.bool_] = np.any(beyond, axis=1)
    first = np.where(fails, beyond.argmax(axis=1), -1).astype(np.int8)
    margin = np.where(settled, 1 - shares.max(axis=1), np.nan)
    return BatchVerdicts(np.logical_not(fails), settled, first, margin)


def _shares(
    tolerance: Tolerance,
    test: Test,
    batch: ReleaseBatch,
    reference: ReleaseBatch,
    travel: float | None,
    overdamped: Overdamped,
) -> Iterator[tuple[str, _Array]]:
    """Differences as shares of their tolerance; minus infinity if not compared, infinity if a quantity is missing."""
    count, quantity = reference.count, tolerance.quantity
    swings = count > 0
    largest = np.nan_to_num(reference.overshoots[:, 0])
    scales = {"A1": largest, "Ad": np.abs(reference.displacement)}

    def share(actual: _Array, expected: _Array, required: NDArray[np.bool_], n: int = 0) -> _Array:
        limit = tolerance.limit(scales.get(tolerance.relative_to or "", expected), n=n, travel=travel)
        ratio = np.abs(actual - expected) / limit
        return np.where(required, np.where(np.isnan(ratio), np.inf, ratio), -np.inf)

    if tolerance.relative_to == "Amax":
        scales["Amax"] = np.nan_to_num(reference.overshoots).max(axis=1)
    if quantity in {"P0", "Pn"}:
        measured_values, reference_values = batch.cycles_s, reference.cycles_s
        for n in (0,) if quantity == "P0" else range(1, _CYCLES):
            yield f"P{n}", share(measured_values[:, n], reference_values[:, n], swings & (count >= 2 * n), n)
    elif quantity in {"A1", "An"}:
        first_apart = test.tolerance("A1") is not None
        measured_values = np.nan_to_num(batch.overshoots)
        for k in range(_OVERSHOOTS):
            if not first_apart or (k == 0) is (quantity == "A1"):
                yield f"A{k + 1}", share(measured_values[:, k], reference.overshoots[:, k], count > k)
    elif quantity == "first overshoot":
        yield quantity, np.where(swings & ~(batch.count > 0), np.inf, -np.inf)
    elif quantity == "overshoots":
        yield quantity, share(batch.count, count, np.full(len(reference), True))
    elif quantity in {"steady state", "Ad"}:
        yield quantity, share(batch.displacement, reference.displacement, np.full(len(reference), True))
    elif quantity == overdamped:
        fall = quantity == "fall time"
        measured_values, reference_values = (
            (releases.fall_time_s if fall else releases.rise_time_s) for releases in (batch, reference)
        )
        yield quantity, share(measured_values, reference_values, ~swings)
