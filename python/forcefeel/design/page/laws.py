"""Tables of the law: gains, dropped paths, sensitivity with darker cells for a worse feel."""

import math

from markupsafe import Markup

from forcefeel.design.assessment import Assessment
from forcefeel.design.page.glance import edge, smallest
from forcefeel.design.studies import CHANGES, Deviation, DroppedPaths, best_of_each_count
from forcefeel.design.workflow import Design
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, GAIN_UNITS, GainDesign, gains_in
from forcefeel.linear.boundary import StabilityBoundary
from forcefeel.loader.parameters import TABLE
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import (
    NONE,
    change_text,
    number_text,
    percent_text,
    quantity_text,
    symbol_html,
    unit_text,
)
from forcefeel.units import HERTZ, RATIO, SECONDS, UnitSystem

STATES = (
    ("x_p", "piston displacement"),
    ("p", "load pressure"),
    ("delta", "programmed deflection"),
    ("delta'", "its rate"),
    ("x_b", "displacement of the column's base"),
    ("x_b'", "its rate"),
    ("F_p", "pilot force (not measured, so not fed back)"),
)
"""What each gain acts on, in the order of ``GAIN_SYMBOLS``."""


def gains(design: Design, system: UnitSystem) -> Table:
    """The gains that close the loop, beside those of the published horizon and of an endless one."""
    laws = (design.compensation, design.published, design.converged)
    gain_values = [gains_in(system, law.gains) for law in laws]
    rows = tuple(
        (
            Cell(symbol_html(symbol)),
            words(Markup("{}, {}").format(symbol_html(state), meaning)),
            *(number(number_text(float(values[k]))) for values in gain_values),
            Cell(unit_text(GAIN_UNITS[k].shown(system))),
        )
        for k, (symbol, (state, meaning)) in enumerate(zip(GAIN_SYMBOLS, STATES, strict=True))
    )
    numbers = heads("", "Chosen", "Published horizon", "Converged")[1:]
    return Table((Cell("Gain"), Cell("acts on"), *numbers, Cell("Unit")), rows)


def laws(design: Design, system: UnitSystem) -> Table:
    """Settings of recursion (22) for each set of gains, and its result."""
    named = (("chosen", design.compensation), ("published horizon", design.published), ("converged", design.converged))
    head = heads(
        "Gains", "Step", "Horizon", "Steps", "Position weight", symbol_html("R_1"), symbol_html("R_2"), "Residual"
    )
    return Table(head, tuple((Cell(name), *_law(law, system)) for name, law in named))


def _law(law: GainDesign, system: UnitSystem) -> tuple[Cell, ...]:
    settings = law.settings
    weights = ("[Q] given", "[Q] given") if settings.q is not None else (settings.position_weight, settings.r1)
    horizon = str(law.status) if settings.horizon_s is None else quantity_text(settings.horizon_s, SECONDS, system)
    weight_texts = [weight if isinstance(weight, str) else number_text(weight) for weight in (*weights, settings.r2)]
    cells = (quantity_text(settings.step_s, SECONDS, system), horizon, str(law.steps), *weight_texts)
    return tuple(number(text) for text in (*cells, number_text(law.riccati_residual, 2)))


def dropped(design: Design, system: UnitSystem) -> Table:
    """The full set, each single path dropped, then the best set for each number of dropped paths."""
    singles = [row for row in design.dropped if len(row.paths) == 1]
    best = [row for row in best_of_each_count(design.dropped) if len(row.paths) > 1]
    full = design.configuration("compensated").programmed.assessment
    limit = _edge(design.configuration("compensated").boundary, system)
    first = (words("none (full set)"), *_rendering(full, system), number(NONE), limit)
    named = [*(_dropped(row, system) for row in singles), *(_dropped(row, system, best=True) for row in best)]
    return Table(_dropped_head(system), (first, *named))


def all_dropped(design: Design, system: UnitSystem) -> Table:
    """Every set of dropped paths."""
    return Table(_dropped_head(system), tuple(_dropped(row, system) for row in design.dropped))


def _dropped_head(system: UnitSystem) -> tuple[Cell, ...]:
    return heads(
        "Dropped",
        "Deviation from the ideal",
        "Error at rest",
        "Frequency",
        "Least damping ratio",
        "Growth of the cost index",
        smallest(system),
    )


def _dropped(row: DroppedPaths, system: UnitSystem, *, best: bool = False) -> tuple[Cell, ...]:
    paths = Markup(", ").join(symbol_html(path) for path in row.paths)
    name = Markup("{} <small>(best of {} dropped)</small>").format(paths, len(row.paths)) if best else paths
    cost = number(percent_text(row.cost_increase, signed=True))
    return (words(name), *_rendering(row.assessment, system), cost, _edge(row.boundary, system))


def _edge(boundary: StabilityBoundary, system: UnitSystem) -> Cell:
    return number(edge(boundary, system), bad=math.isinf(boundary.stiffness_n_m_per_rad))


def _rendering(assessment: Assessment, system: UnitSystem) -> tuple[Cell, ...]:
    if not assessment.stable:
        return (number("unstable", bad=True), *(number(NONE) for _ in range(3)))
    return (
        number(percent_text(assessment.tracking_error)),
        number(percent_text(assessment.static_error, signed=True)),
        number(quantity_text(assessment.frequency_rad_per_s, HERTZ, system, 3)),
        number(quantity_text(assessment.least_damping_ratio, RATIO, system, 3)),
    )


def sensitivity(design: Design) -> Table:
    """Deviation from the ideal by quantity and change; the most harmful first among gains and plant."""
    by_quantity: dict[str, dict[float, Deviation]] = {}
    for row in design.deviations:
        by_quantity.setdefault(row.quantity, {})[row.change] = row
    full = design.configuration("compensated").programmed.assessment.tracking_error
    largest = max((_error(row) for row in design.deviations if math.isfinite(_error(row))), default=full)
    order = sorted(
        by_quantity.items(), key=lambda item: (item[0] not in GAIN_SYMBOLS, -max(map(_error, item[1].values())))
    )
    rows = tuple(
        (_quantity(key), *(heat(by_change.get(change), full, largest) for change in CHANGES))
        for key, by_change in order
    )
    changes = map(change_text, CHANGES)
    return Table(heads("Quantity, off by", *changes), rows, "heat")


def _error(row: Deviation) -> float:
    if row.assessment is None:
        return -math.inf
    return row.assessment.tracking_error if row.assessment.stable else math.inf


def _quantity(key: str) -> Cell:
    if key in GAIN_SYMBOLS:
        return Cell(Markup("{} <small>gain</small>").format(symbol_html(key)), "words")
    part, name = (word.replace("_", " ") for word in key.split("."))
    return Cell(Markup("{} <small>{} {}</small>").format(symbol_html(TABLE[key].symbol), part, name), "words")


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
