"""The curve that shows what an identification is worth: one channel of the bench data beside the models."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.result import Fitted
from forcefeel.bench.responses import Response
from forcefeel.commission.result import Curve

_MOST_POINTS = 600
"""Points of a curve, at most: it lies in ``steps.json`` and on a page."""

_SWINGS = 6
"""Crossings of the mean before and after the middle of what is shown of a record."""

_FIRST = ("column_angle", "load_cell_force")
"""Channels that are preferred: those that the pilot feels."""


def curve_of(fitted: Sequence[Fitted]) -> Curve:
    """The data set, of one at least, whose channel says most of the feel: measured, identified and by the loader file."""
    rank = {name: index for index, name in enumerate(_FIRST)}
    best = min(fitted, key=lambda data: (isinstance(data.data, Response), rank.get(data.channel, len(rank))))
    response = isinstance(best.data, Response)
    index = np.arange(len(best.at)) if response else _stretch(best)
    return Curve(
        data=best.data.name,
        channel=best.channel,
        response=response,
        at=tuple(best.at[index].tolist()),
        measured=_parts(best.measured[index], response=response),
        modeled=_parts(best.modeled[index], response=response),
        before=_parts(best.before[index], response=response),
    )


def _parts(values: NDArray[np.complex128] | NDArray[np.float64], *, response: bool) -> tuple[tuple[float, ...], ...]:
    """Gain and continuous phase of a response; the values of a record."""
    if response:
        return tuple(np.abs(values).tolist()), tuple(np.unwrap(np.angle(values)).tolist())
    return (tuple(np.real(values).tolist()),)


def _stretch(record: Fitted) -> NDArray[np.intp]:
    """A few swings about the time where identification changes the model most, thinned to the limit."""
    measured = np.real(record.measured)
    swings = np.flatnonzero(np.diff(np.sign(measured - measured.mean())))
    begin, end = 0, len(measured)
    if len(swings) > 2 * _SWINGS:
        largest = int(np.abs(np.real(record.modeled) - np.real(record.before)).argmax())
        first = int(np.clip(np.searchsorted(swings, largest) - _SWINGS, 0, len(swings) - 2 * _SWINGS))
        begin, end = int(swings[first]), int(swings[first + 2 * _SWINGS - 1])
    return np.arange(begin, end, max(1, -(-(end - begin) // _MOST_POINTS)))
