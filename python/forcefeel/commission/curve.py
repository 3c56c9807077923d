"""The curve that shows what an identification is worth: one channel of the bench data beside the models."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.result import Fitted
from forcefeel.bench.responses import Response
from forcefeel.commission.result import Curve

_MOST_POINTS = 600
"""Points of a curve, at most: it lies in ``steps.json`` and on a page."""

_FIRST = ("column_angle", "load_cell_force")
"""Channels that are preferred: those that the pilot feels."""


def curve_of(fitted: Sequence[Fitted]) -> Curve:
    """The data set whose channel says most of the feel, measured, identified and by the loader file.

    Args:
        fitted: The data beside the models, at least one.
    """
    rank = {name: index for index, name in enumerate(_FIRST)}
    best = min(fitted, key=lambda data: (isinstance(data.data, Response), rank.get(data.channel, len(rank))))
    response = isinstance(best.data, Response)
    index = _extremes(np.real(best.measured))
    return Curve(
        data=best.data.name,
        channel=best.channel,
        response=response,
        at=tuple(best.at[index].tolist()),
        measured=_parts(best.measured[index], response=response),
        modelled=_parts(best.modelled[index], response=response),
        before=_parts(best.before[index], response=response),
    )


def _parts(values: NDArray[np.complex128] | NDArray[np.float64], *, response: bool) -> tuple[tuple[float, ...], ...]:
    """Gain and continuous phase of a response; the values of a record."""
    if response:
        return tuple(np.abs(values).tolist()), tuple(np.unwrap(np.angle(values)).tolist())
    return (tuple(np.real(values).tolist()),)


def _extremes(values: NDArray[np.float64]) -> NDArray[np.intp]:
    """All samples up to the limit; else the lowest and the highest of each stretch."""
    if len(values) <= _MOST_POINTS:
        return np.arange(len(values))
    stretches = np.array_split(np.arange(len(values)), _MOST_POINTS // 2)
    ends = [
        stretch[position] for stretch in stretches for position in (values[stretch].argmin(), values[stretch].argmax())
    ]
    return np.unique(np.array(ends))
