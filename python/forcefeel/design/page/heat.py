"""Cells of the sensitivity table; a worse feel has a darker cell."""

import math

from forcefeel.design.studies import Deviation
from forcefeel.page.table import Cell
from forcefeel.page.typography import percent_text

_CALM, _HOT, _BETTER = (255, 255, 255), (240, 140, 60), (205, 227, 243)


def heat(row: Deviation | None, full: float, largest: float) -> Cell:
    """The cell of one deviation.

    Args:
        row: The deviation.
        full: Deviation from the ideal with nothing off its value.
        largest: The largest of the table.
    """
    if row is None or row.assessment is None:
        return Cell("out of range", "number")
    if not row.assessment.stable:
        return Cell("unstable", "number bad")
    error = row.assessment.tracking_error
    return Cell(percent_text(error), "number", _background(error, full, largest))


def _background(error: float, full: float, largest: float) -> str:
    if not math.isfinite(full) or largest <= full:
        return ""
    share = (error - full) / (largest - full)
    # The root lets small differences show beside a very large one.
    share, toward = (math.sqrt(share), _HOT) if share > 0 else (min(1.0, math.sqrt(-share) * 2), _BETTER)
    mixed = (round(low + share * (high - low)) for low, high in zip(_CALM, toward, strict=True))
    return "#" + "".join(f"{channel:02X}" for channel in mixed)
