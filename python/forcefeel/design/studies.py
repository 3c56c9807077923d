"""Claims of the report on its compensation that it does not show: paths that can be dropped, and insensitivity."""

from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel.design.assessment import Assessment, assess
from forcefeel.errors import InputError
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, DesignSettings
from forcefeel.linear.boundary import StabilityBoundary, smallest_stable_stiffness
from forcefeel.linear.models import state_feedback
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import PLANT_PARAMETERS
from forcefeel.units import PERCENT

CHANGES = (-0.20, -0.10, -0.05, 0.05, 0.10, 0.20)
"""Deviations at which the sensitivity is taken."""


@dataclass(frozen=True)
class DroppedPaths:
    """The compensated loop without some of its feedback paths.

    Attributes:
        paths: The gains set to zero, such as ``("c_2", "c_6")``.
        assessment: Rendering of the feel with the remaining paths.
        cost_increase: Growth of the cost index over the full set, as a share; NaN if unstable.
        boundary: Smallest stable G without them.
    """

    paths: tuple[str, ...]
    assessment: Assessment
    cost_increase: Annotated[float, PERCENT]
    boundary: StabilityBoundary


@dataclass(frozen=True)
class Deviation:
    """The compensated loop with one deviating gain or plant parameter.

    Attributes:
        quantity: ``c_1`` .. ``c_6``, or a key of the parameter table.
        change: Deviation as a share of the value.
        assessment: Rendering of the feel; ``None`` if the changed value is out of the parameter's range.
    """

    quantity: str
    change: Annotated[float, PERCENT]
    assessment: Assessment | None


def drop_paths(
    loader: Loader, gains: NDArray[np.float64], settings: DesignSettings | None = None
) -> tuple[DroppedPaths, ...]:
    """Every set of one to five of the six paths, dropped; singles first, then pairs, and so on.

    Args:
        loader: The loader.
        gains: SI gains c_1 .. c_6 of the full set; the others keep their values when some are dropped.
        settings: Weights of the cost index.

    Example:
        >>> loader = ff.elevator()
        >>> len(ff.design.drop_paths(loader, ff.design_gains(loader).gains)) > 1
        True
    """
    full = assess(loader, state_feedback(loader, gains[:6]), settings)
    rows = []
    for count in range(1, 6):
        for dropped in combinations(range(6), count):
            left = gains[:6].copy()
            left[list(dropped)] = 0.0
            law = state_feedback(loader, left)
            assessment = assess(loader, law, settings)
            paths = tuple(GAIN_SYMBOLS[k] for k in dropped)
            edge = smallest_stable_stiffness(loader, law=law)
            rows.append(DroppedPaths(paths, assessment, assessment.cost / full.cost - 1, edge))
    return tuple(rows)


def best_of_each_count(rows: tuple[DroppedPaths, ...]) -> tuple[DroppedPaths, ...]:
    """For each number of dropped paths the stable set that tracks best; counts without a stable set are left out."""
    best: dict[int, DroppedPaths] = {}
    for row in rows:
        count = len(row.paths)
        if row.assessment.stable and (
            count not in best or row.assessment.tracking_error < best[count].assessment.tracking_error
        ):
            best[count] = row
    return tuple(best.values())


VISIBLE_LOSS = 0.01
"""Growth of the tracking error, as a share of the deflection, that a pilot would not see: a tenth of the 10 % of force that
the static check of 14 CFR Part 60 (Table A2A, test 2.a.1.a) allows."""

STABILITY_LOSS = 0.10
"""Accepted growth of the smallest stable G for a simpler law; parameters are not known more accurately."""


def droppable(rows: tuple[DroppedPaths, ...], full: Assessment, boundary: StabilityBoundary) -> DroppedPaths | None:
    """The largest of ``rows``, sets from ``drop_paths``, that can be dropped without a visible loss of fidelity or stability.

    ``full`` is the rendering with all paths and ``boundary`` its smallest stable G; ``None`` without such a set.
    """
    error = full.tracking_error + VISIBLE_LOSS
    edge = boundary.stiffness_n_m_per_rad * (1 + STABILITY_LOSS)
    free = [
        row for row in rows if row.assessment.tracking_error <= error and row.boundary.stiffness_n_m_per_rad <= edge
    ]
    most = max((len(row.paths) for row in free), default=0)
    return min(
        (row for row in free if len(row.paths) == most), key=lambda row: row.assessment.tracking_error, default=None
    )


def sensitivity(
    loader: Loader, gains: NDArray[np.float64], settings: DesignSettings | None = None
) -> tuple[Deviation, ...]:
    """The compensated loop with each gain and each plant parameter at ``CHANGES``, one at a time.

    Gains and constants of the feel computer stay those of ``loader`` while the plant deviates, and so does the programmed
    feel.

    Args:
        loader: The loader that the gains were designed for.
        gains: SI gains c_1 .. c_6.
        settings: Weights of the cost index.

    Example:
        >>> loader = ff.elevator()
        >>> len(ff.design.sensitivity(loader, ff.design_gains(loader).gains)) > 1
        True
    """
    nominal = state_feedback(loader, gains[:6])
    rows = []
    for k, symbol in enumerate(GAIN_SYMBOLS[:6]):
        for change in CHANGES:
            changed = gains[:6].copy()
            changed[k] *= 1 + change
            rows.append(Deviation(symbol, change, assess(loader, state_feedback(loader, changed), settings)))
    for key in PLANT_PARAMETERS:
        for change in CHANGES:
            try:
                plant = loader.replace({key: loader[key] * (1 + change)}, si=True)
            except InputError:
                rows.append(Deviation(key, change, None))
                continue
            rows.append(Deviation(key, change, assess(plant, nominal, settings, programmed=loader)))
    return tuple(rows)


def worst(rows: tuple[Deviation, ...]) -> Deviation:
    """The worst deviation: an unstable loop before any stable one, then the largest tracking error."""

    def harm(row: Deviation) -> tuple[bool, float]:
        if row.assessment is None:
            return (False, -np.inf)
        assessment = row.assessment
        return (not assessment.stable, assessment.tracking_error if assessment.stable else assessment.abscissa_per_s)

    return max(rows, key=harm)
