"""Tables of a flight schedule: checked parts, knots, middles between knots, margins."""

from math import isfinite

import numpy as np

from forcefeel import _core
from forcefeel.flight_schedule.as_json import FEEL_UNITS
from forcefeel.flight_schedule.result import ScheduleCheck
from forcefeel.flight_schedule.schedule import FlightSchedule
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import NONE, heading_text, number_text, prose_html, unit_text, value_text
from forcefeel.units import UnitSystem

MOST_ROWS = 100
"""Largest number of rows in a table; the files contain all."""


def parts(check: ScheduleCheck) -> Table:
    """Checked parts, and the loop closest to instability in each."""
    rows = []
    for part in check.parts:
        rows.append(
            (
                words(f"{part.part[:1].upper()}{part.part[1:]}"),
                number(f"{part.loops:,}"),
                number(f"{part.unstable:,}" if part.unstable else "0", bad=bool(part.unstable)),
                words(prose_html(part.place)),
                words(prose_html(part.case)),
                number(_magnitude(part.critical)),
                number(_magnitude(part.largest), bad=part.largest >= 1),
            )
        )
    head = (
        *heads("Where", "Loops", "Unstable"),
        Cell("Nearest to the edge"),
        Cell("Case"),
        *(Cell(text, "number") for text in ("Pole there", "Largest pole of all")),
    )
    return Table(head, tuple(rows))


def knots(check: ScheduleCheck, units: UnitSystem) -> Table:
    """Feel, poles and release of every knot."""
    schedule = check.schedule
    frequency, damping = _core.feel_frequencies(schedule.rows)
    critical, outcomes = (
        check.poles.critical[:, check.knot],
        [release.outcome for release in check.releases if release.knot],
    )
    rows = []
    for k in range(min(schedule.knots, MOST_ROWS)):
        point = [number(number_text(value)) for value in schedule.where[k]]
        feel = zip(schedule.rows[k], FEEL_UNITS, strict=True)
        rows.append(
            (
                Cell(point[0].text),
                *point[1:],
                *(number(value_text(float(value), feel_unit, units)) for value, feel_unit in feel),
                number(number_text(float(frequency[k]) / (2 * np.pi), 3)),
                number(number_text(float(damping[k]), 3)),
                words(outcomes[k], bad=outcomes[k] != "passes"),
                number(_magnitude(float(critical[0, k])), bad=critical[0, k] >= 1),
                number(_magnitude(float(critical[:, k].max())), bad=critical[:, k].max() >= 1),
            )
        )
    names = [_axis_head(schedule, k) for k in range(len(schedule.axes))]
    names += [heading_text(symbol, feel_unit, units) for symbol, feel_unit in zip("IBG", FEEL_UNITS, strict=True)]
    names += ["Frequency, Hz", "Damping ratio"]
    poles = (Cell(name, "number") for name in ("Pole, nominal", "Pole, worst case"))
    return Table((*heads(*names), Cell("Release"), *poles), tuple(rows))


def middle(check: ScheduleCheck) -> Table:
    """Releases in the middle between knots, with the interpolated law and with a law designed for the point; failures first."""
    places = sorted(
        (release for release in check.releases if not release.knot),
        key=lambda release: (release.passes, not release.lost),
    )
    rows = [
        (
            words(prose_html(release.place)),
            words(release.outcome, bad=not release.passes),
            words(release.designed, bad=release.lost),
        )
        for release in places[:MOST_ROWS]
    ]
    return Table((Cell("Place"), Cell("Interpolated law"), Cell("Law of its own")), tuple(rows))


def margins(check: ScheduleCheck) -> Table:
    """Margins on the nominal plant."""
    rows = []
    for margin in check.margins:
        loop = margin.margins
        crossover = loop.crossover_rad_per_s / (2 * np.pi)
        rows.append(
            (
                words(prose_html(margin.place)),
                number(number_text(loop.gain_up, 3)),
                number(number_text(loop.gain_down, 3)),
                number(number_text(float(np.degrees(loop.phase_rad)), 3)),
                number(number_text(1e3 * loop.delay_s, 3)),
                number(number_text(loop.disk, 3)),
                number(number_text(crossover, 3) if isfinite(crossover) else NONE),
            )
        )
    head = ("Place", "Gain up to", "Gain down to", "Phase, deg", "Delay, ms", "Disk", "Crossover, Hz")
    return Table(heads(*head), tuple(rows))


def axes(schedule: FlightSchedule) -> Table:
    """The axes."""
    rows = [
        (
            words(axis.name),
            number(number_text(axis.values[0])),
            number(number_text(axis.values[-1])),
            Cell(unit_text(axis.unit) or NONE),
            number(f"{len(axis.values):,}"),
        )
        for axis in schedule.axes
    ]
    head = (Cell("Axis"), Cell("From", "number"), Cell("To", "number"), Cell("Unit"), Cell("Knots", "number"))
    return Table(head, tuple(rows))


def _axis_head(schedule: FlightSchedule, k: int) -> str:
    axis = schedule.axes[k]
    unit = unit_text(axis.unit)
    title = f"{axis.name[:1].upper()}{axis.name[1:]}"
    return f"{title}, {unit}" if unit else title


def _magnitude(value: float) -> str:
    """A pole's magnitude; near 1 by what is missing, since 0.99999997 is not 1."""
    missing = 1 - value
    return f"1 − {number_text(missing, 2)}" if 0 < missing < _NEAR else number_text(value, 5)


_NEAR = 1e-4
