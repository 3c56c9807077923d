"""Verdicts on many releases at once, without uncertainties."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.qualification.release import REST
from forcefeel.qualification.release_batch import ReleaseBatch
from forcefeel.qualification.release_verdicts import Overdamped
from forcefeel.qualification.rules import Test
from forcefeel.qualification.verdicts import check_kind
from forcefeel.units import UnitSystem

_QUANTITIES, _BASES, _NAMES = _core.release_rule_names()

NAMES = tuple(_NAMES)
"""Quantities by which a run can fail, in the order of evaluation."""

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
    first, evaluated, margin = _core.judge_releases(
        batch.values,
        reference.values,
        ((batch.release_s, batch.end_s), (reference.release_s, reference.end_s)),
        tolerance_rows(test, travel),
        rests_fall_times=REST,
        by_rise_time=overdamped == "rise time",
    )
    return BatchVerdicts(first < 0, evaluated, first, margin)


def tolerance_rows(test: Test, travel: float | None = None) -> _Array:
    """The tolerances of a release test as the kernel takes them: the rows of ``_core.judge_releases``."""
    rows = [
        (
            _QUANTITIES.index(tolerance.quantity),
            _BASES.index(tolerance.relative_to or "itself"),
            tolerance.relative,
            tolerance.grows is not None,
            tolerance.absolute and tolerance.absolute.si(UnitSystem.US, travel),
        )
        for tolerance in test.tolerances
    ]
    return np.array(rows, dtype=np.float64)  # NaN for what is not stated
