"""The tables of an envelope: one number each, what fails, what each case costs, what can be rendered, passivity."""

from collections.abc import Mapping
from math import isfinite

from markupsafe import Markup

from forcefeel.conclusions import capital, interval_text, share_text
from forcefeel.envelope.cases import Kind
from forcefeel.envelope.cockpit import SHARES, CockpitEnvelope
from forcefeel.envelope.passivity import ARM_HZ, HIGHEST_HZ
from forcefeel.envelope.result import MOST, Envelope, Failure
from forcefeel.envelope.settings import AXES
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import (
    NONE,
    heading_text,
    number_text,
    parameter_name,
    prose_html,
    quantity_text,
    value_text,
)
from forcefeel.units import ANGLE, HERTZ, INERTIA, UnitSystem

_BAD = (240, 140, 60)


def shares(found: Envelope) -> Table:
    """One number each."""
    rows = []
    for name in found.laws:
        one = found.shares(name)
        numbers = (one.stable, one.nominal_share, one.stable_worst, one.worst_case_share)
        rows.append((words(capital(name)), *(number(share_text(share)) for share in numbers)))
    head = ("Law", "Stable", "Passes", "Stable in every case", "Passes in every case")
    return Table(heads(*head), tuple(rows))


def allowed(found: Envelope) -> Table:
    """The shares of the settings that no limit forbids to every law."""
    rows = []
    for name in found.laws:
        one = found.allowed_shares(name)
        numbers = (
            share_text(share) if isfinite(share) else NONE for share in (one.nominal_share, one.worst_case_share)
        )
        rows.append((words(capital(name)), number(f"{one.settings:,}"), *map(number, numbers)))
    return Table(heads("Law", "Settings allowed", "Of these passes", "Of these in every case"), tuple(rows))


def by_angle(found: Envelope, system: UnitSystem) -> Table:
    """The nominal shares over the release's angle."""
    rows = [
        (
            number(quantity_text(one.release_rad, ANGLE, system, 3)),
            number(share_text(one.allowed)),
            *(number(share_text(share)) for share in one.passes.values()),
        )
        for one in found.by_angle
    ]
    head = ("Released from", "Allowed", *(f"{capital(name)} passes" for name in found.laws))
    return Table(tuple(Cell(text, "number") for text in head), tuple(rows))


def axes(found: CockpitEnvelope, pages: Mapping[str, str]) -> Table:
    """A row for each axis and law of a cockpit; ``pages`` has the page of each axis."""
    rows = tuple(
        (
            Cell(Markup('<a href="{}">{}</a>').format(pages[row.axis], row.axis), "words"),
            words(row.law),
            number(quantity_text(row.release_rad, ANGLE, UnitSystem.SI, 3)),
            *(number(text) for text in row.shares),
            words(prose_html(row.worst_text)),
            words(row.loader),
            words(row.drive),
        )
        for row in found.rows
    )
    shares = heads("", *map(capital, SHARES))[1:]
    head = (
        Cell("Axis"),
        Cell("Law"),
        Cell("Released from", "number"),
        *shares,
        *map(Cell, ("Most is lost with", "Loader", "Drive")),
    )
    return Table(head, rows)


def drawn(found: Envelope) -> Table:
    """One number each, on machines with all tolerances at once."""
    rows = []
    for name in found.laws:
        one = found.drawn_shares(name)
        sure = interval_text(one.good_low, one.good_high)
        good = f"{share_text(one.good)} ({sure})"
        numbers = (share_text(one.settings), good, share_text(one.passes), share_text(one.least))
        rows.append((words(capital(name)), *map(number, numbers)))
    most = share_text(MOST)
    head = (
        "Law",
        f"Settings that pass in {most} of the machines",
        f"Machines that pass at {most} of the settings",
        "A machine passes at, on average",
        "The worst machine passes at",
    )
    return Table(heads(*head), tuple(rows))


def counted(found: Envelope) -> Table:
    """The shares by two weights of the grid's points."""
    rows = []
    for name in found.laws:
        one, even = found.shares(name), found.even_shares(name)
        numbers = (one.nominal_share, even.nominal_share, one.worst_case_share, even.worst_case_share)
        rows.append((words(capital(name)), *(number(share_text(share)) for share in numbers)))
    head = ("Law", "Passes: by points", "in proportion", "In every case: by points", "in proportion")
    return Table(heads(*head), tuple(rows))


def failures(found: Envelope) -> Table:
    """What fails first with the nominal plant, as shares of all settings."""
    shown = {name: found.failure_shares(name) for name in found.laws}
    kinds = [kind for kind in Failure if any(row[kind] for row in shown.values())]
    rows = [
        (words(capital(kind)), *(number(share_text(row[kind]) if row[kind] else NONE) for row in shown.values()))
        for kind in kinds
    ]
    return Table(heads("First failure", *(capital(name) for name in shown)), tuple(rows))


def cases(found: Envelope) -> Table:
    """What each case leaves: settings within tolerance, and of those that are nominally, the share that is lost."""
    shown = [found.case_shares(name) for name in found.laws]
    rows = []
    for place, case in enumerate(found.plan.cases):
        cells = []
        for column in shown:
            one = column[place]
            share = 0.0 if not isfinite(one.lost) else one.lost
            cells += [number(share_text(one.stable)), number(share_text(one.passes))]
            known = isfinite(one.lost) and case.kind is not Kind.NOMINAL
            cells.append(Cell(share_text(one.lost) if known else NONE, "number", _heat(share)))
        if case.kind is Kind.PLANT:
            change = f"{'+' if case.change > 0 else '−'}{number_text(100 * abs(case.change), 3)}\N{NO-BREAK SPACE}%"
            named = words(parameter_name(case.parameter) + f" {change}")
        else:
            named = words(capital(case.name) + ("" if case.verified else " (not verified)"))
        rows.append((named, *cells))
    head = [Cell("Case")]
    for name in found.laws:
        head += [Cell(f"{capital(name)}: {what}", "number") for what in ("stable", "passes", "lost")]
    return Table(tuple(head), tuple(rows))


def smallest(found: Envelope, system: UnitSystem) -> Table:
    """Smallest inertia and stiffness."""
    stiffness = unit(TABLE["feel.stiffness"])
    rows = []
    for name in found.laws:
        for worst in (False, True):
            one = found.smallest(name, worst=worst)
            known = isfinite(one.inertia_n_m_s2_per_rad)
            rows.append(
                (
                    words(f"{capital(name)}, {'in every case' if worst else 'nominally'}"),
                    number(value_text(one.inertia_n_m_s2_per_rad, INERTIA, system)),
                    number(number_text(one.inertia_share, 3) if known else NONE),
                    number(value_text(one.stiffness_n_m_per_rad, stiffness, system)),
                    number(share_text(one.stiffness_share) if known else NONE),
                    number(value_text(one.frequency_rad_per_s, HERTZ, system)),
                )
            )
    head = (
        "Passes",
        heading_text("Smallest I", INERTIA, system),
        "times the column's",
        heading_text("Smallest G", stiffness, system),
        prose_html("share of G_max"),
        "Highest frequency, Hz",
    )
    return Table(heads(*head), tuple(rows))


def passive(found: Envelope) -> Table:
    """Where the grip is not passive."""
    rows = []
    for name in found.laws:
        grip = found.passivity[name]
        bands = ", ".join(f"{number_text(low, 3)} to {number_text(high, 3)}" for low, high in grip.bands_hz)
        state = (bands or f"none up to {number_text(HIGHEST_HZ)}") if grip.stable else "unstable"
        rows.append(
            (
                words(capital(name)),
                number(state, bad=bool(bands) or not grip.stable),
                number(share_text(grip.settings)),
                number(share_text(grip.settings_below_arm)),
            )
        )
    below = f"Settings passive up to {number_text(ARM_HZ)} Hz"
    return Table(heads("Law", "Not passive, Hz, at the loader's setting", "Settings passive", below), tuple(rows))


def grid(found: Envelope, system: UnitSystem) -> Table:
    """The settings."""
    rows = []
    for name, axis in AXES.items():
        values = getattr(found.plan.settings, name)
        ends = (number(number_text(axis.unit.from_si(value, system), 3)) for value in (values[0], values[-1]))
        rows.append(
            (words(prose_html(capital(axis.title))), *ends, Cell(axis.unit.shown(system)), number(str(len(values))))
        )
    head = (Cell("Axis"), Cell("From", "number"), Cell("To", "number"), Cell("Unit"), Cell("Values", "number"))
    return Table(head, tuple(rows))


def arms(found: Envelope) -> Table:
    """The arms at the grip."""
    rows = [
        (
            words(capital(case.name)),
            *(number(number_text(value)) for value in case.arm.values),
            Cell("yes" if case.verified else "no", "" if case.verified else "bad"),
        )
        for case in found.plan.cases
        if case.arm
    ]
    return Table((*heads("Arm", "Mass, kg", "Damper, N s/m", "Spring, N/m"), Cell("Verified")), tuple(rows))


def _heat(share: float) -> str:
    """The more is lost, the darker."""
    if share <= 0:
        return ""
    mixed = (round(255 + share**0.5 * (channel - 255)) for channel in _BAD)
    return "#" + "".join(f"{channel:02X}" for channel in mixed)
