"""Tables of an envelope: shares, failures, loss in each case, smallest feel, passivity."""

from collections.abc import Mapping
from itertools import product
from math import isfinite

from markupsafe import Markup

from forcefeel.conclusions import capital, interval_text, share_text
from forcefeel.envelope.cases import Kind
from forcefeel.envelope.cockpit.cockpit import SHARES, CockpitEnvelope
from forcefeel.envelope.cockpit.pair import PairEnvelope
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


def shares(envelope: Envelope) -> Table:
    """Shares of all settings for each law."""
    rows = []
    for name in envelope.laws:
        law_shares = envelope.shares(name)
        numbers = (law_shares.stable, law_shares.nominal_share, law_shares.stable_worst, law_shares.worst_case_share)
        rows.append((words(capital(name)), *(number(share_text(share)) for share in numbers)))
    head = ("Law", "Stable", "Passes", "Stable in every case", "Passes in every case")
    return Table(heads(*head), tuple(rows))


def allowed(envelope: Envelope) -> Table:
    """Shares of the settings that no limit forbids to every law."""
    rows = []
    for name in envelope.laws:
        law_shares = envelope.allowed_shares(name)
        numbers = (
            share_text(share) if isfinite(share) else NONE
            for share in (law_shares.nominal_share, law_shares.worst_case_share)
        )
        rows.append((words(capital(name)), number(f"{law_shares.settings:,}"), *map(number, numbers)))
    return Table(heads("Law", "Settings allowed", "Of these passes", "Of these in every case"), tuple(rows))


def by_angle(envelope: Envelope, system: UnitSystem) -> Table:
    """Nominal shares over the release angle."""
    rows = [
        (
            number(quantity_text(point.release_rad, ANGLE, system, 3)),
            number(share_text(point.allowed)),
            *(number(share_text(share)) for share in point.passes.values()),
        )
        for point in envelope.by_angle
    ]
    head = ("Released from", "Allowed", *(f"{capital(name)} passes" for name in envelope.laws))
    return Table(tuple(Cell(text, "number") for text in head), tuple(rows))


def contacts(envelope: Envelope) -> Table:
    """Share of the settings that are quiet, a row for each kind of contact and law, a column for each stiffness."""
    planned = envelope.plan.contacts
    stiffnesses = sorted({contact.stiffness_n_per_m for contact in planned})
    kinds = dict.fromkeys((contact.kind, contact.damping_ratio, contact.mass_kg) for contact in planned)
    rows = []
    for law, (kind, ratio, mass) in product(envelope.laws, kinds):
        shares = envelope.contact_shares(law).by_contact
        what = f"{capital(kind)}, damping {ratio:g}{f', {mass:g} kg at the grip' if mass else ''}"
        of = {
            c.stiffness_n_per_m: shares[c.name]
            for c in planned
            if (c.kind, c.damping_ratio, c.mass_kg) == (kind, ratio, mass)
        }
        cells = (
            Cell(share_text(of[k]), "number", _heat(1 - of[k])) if k in of else Cell(NONE, "number")
            for k in stiffnesses
        )
        rows.append((words(capital(law)), words(what), *cells))
    head = (*heads("Law"), Cell("Contact"), *heads("", *(f"{k:,.0f} N/m" for k in stiffnesses))[1:])
    return Table(head, tuple(rows))


def axes(cockpit: CockpitEnvelope, pages: Mapping[str, str]) -> Table:
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
        for row in cockpit.rows
    )
    shares = heads("", *map(capital, SHARES))[1:]
    head = (
        Cell("Axis"),
        Cell("Law"),
        Cell("Released from", "number"),
        *shares,
        *map(Cell, ("Largest loss comes from", "Loader", "Drive")),
    )
    return Table(head, rows)


def arms_of_pair(pair: PairEnvelope) -> Table:
    """Share of the settings rendered alone that pass, a row for the first pilot's arm, a column for the second's."""
    shares = {(row.first, row.second): row.passes for row in pair.rows}
    rows = tuple(
        (
            words(capital(first)),
            *(
                Cell(share_text(shares[first, second]), "number", _heat(1 - shares[first, second]))
                for second in pair.arms
            ),
        )
        for first in pair.arms
        if shares
    )
    first, second = pair.link.between
    return Table(heads(f"{capital(first)}, arm", *(f"{second}: {arm}" for arm in pair.arms)), rows)


def drawn(envelope: Envelope) -> Table:
    """Shares for each law on machines with all tolerances at once."""
    rows = []
    for name in envelope.laws:
        law_shares = envelope.drawn_shares(name)
        sure = interval_text(law_shares.good_low, law_shares.good_high)
        good = f"{share_text(law_shares.good)} ({sure})"
        numbers = (share_text(law_shares.settings), good, share_text(law_shares.passes), share_text(law_shares.least))
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


def counted(envelope: Envelope) -> Table:
    """Shares with two weights of the grid points."""
    rows = []
    for name in envelope.laws:
        points, even = envelope.shares(name), envelope.even_shares(name)
        numbers = (points.nominal_share, even.nominal_share, points.worst_case_share, even.worst_case_share)
        rows.append((words(capital(name)), *(number(share_text(share)) for share in numbers)))
    head = ("Law", "Passes: by points", "in proportion", "In every case: by points", "in proportion")
    return Table(heads(*head), tuple(rows))


def failures(envelope: Envelope) -> Table:
    """First failures with the nominal plant, as shares of all settings."""
    by_law = {name: envelope.failure_shares(name) for name in envelope.laws}
    kinds = [kind for kind in Failure if any(row[kind] for row in by_law.values())]
    rows = [
        (words(capital(kind)), *(number(share_text(row[kind]) if row[kind] else NONE) for row in by_law.values()))
        for kind in kinds
    ]
    return Table(heads("First failure", *(capital(name) for name in by_law)), tuple(rows))


def cases(envelope: Envelope) -> Table:
    """Settings within tolerance in each case, and the share of nominal passes that is lost."""
    by_law = [envelope.case_shares(name) for name in envelope.laws]
    rows = []
    for k, case in enumerate(envelope.plan.cases):
        cells = []
        for column in by_law:
            case_shares = column[k]
            share = 0.0 if not isfinite(case_shares.lost) else case_shares.lost
            cells += [number(share_text(case_shares.stable)), number(share_text(case_shares.passes))]
            known = isfinite(case_shares.lost) and case.kind is not Kind.NOMINAL
            cells.append(Cell(share_text(case_shares.lost) if known else NONE, "number", _heat(share)))
        if case.kind is Kind.PLANT:
            change = f"{'+' if case.change > 0 else '−'}{number_text(100 * abs(case.change), 3)}\N{NO-BREAK SPACE}%"
            named = words(parameter_name(case.parameter) + f" {change}")
        else:
            named = words(capital(case.name) + ("" if case.verified else " (not verified)"))
        rows.append((named, *cells))
    head = [Cell("Case")]
    for name in envelope.laws:
        head += [Cell(f"{capital(name)}: {figure}", "number") for figure in ("stable", "passes", "lost")]
    return Table(tuple(head), tuple(rows))


def smallest(envelope: Envelope, system: UnitSystem) -> Table:
    """Smallest inertia and stiffness."""
    stiffness = unit(TABLE["feel.stiffness"])
    rows = []
    for name in envelope.laws:
        for worst in (False, True):
            edge = envelope.smallest(name, worst=worst)
            known = isfinite(edge.inertia_n_m_s2_per_rad)
            rows.append(
                (
                    words(f"{capital(name)}, {'in every case' if worst else 'nominally'}"),
                    number(value_text(edge.inertia_n_m_s2_per_rad, INERTIA, system)),
                    number(number_text(edge.inertia_share, 3) if known else NONE),
                    number(value_text(edge.stiffness_n_m_per_rad, stiffness, system)),
                    number(share_text(edge.stiffness_share) if known else NONE),
                    number(value_text(edge.frequency_rad_per_s, HERTZ, system)),
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


def passive(envelope: Envelope) -> Table:
    """Frequency bands in which the grip is not passive."""
    rows = []
    for name in envelope.laws:
        grip = envelope.passivity[name]
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


def grid(envelope: Envelope, system: UnitSystem) -> Table:
    """The settings."""
    rows = []
    for name, axis in AXES.items():
        values = getattr(envelope.plan.settings, name)
        ends = (number(number_text(axis.unit.from_si(value, system), 3)) for value in (values[0], values[-1]))
        rows.append(
            (words(prose_html(capital(axis.title))), *ends, Cell(axis.unit.shown(system)), number(str(len(values))))
        )
    head = (Cell("Axis"), Cell("From", "number"), Cell("To", "number"), Cell("Unit"), Cell("Values", "number"))
    return Table(head, tuple(rows))


def arms(envelope: Envelope) -> Table:
    """The arms at the grip."""
    rows = [
        (
            words(capital(case.name)),
            *(number(number_text(value)) for value in case.arm.values),
            Cell("yes" if case.verified else "no", "" if case.verified else "bad"),
        )
        for case in envelope.plan.cases
        if case.arm
    ]
    return Table((*heads("Arm", "Mass, kg", "Damper, N s/m", "Spring, N/m"), Cell("Verified")), tuple(rows))


def _heat(share: float) -> str:
    """Cell color: darker for a larger loss."""
    if share <= 0:
        return ""
    mixed = (round(255 + share**0.5 * (channel - 255)) for channel in _BAD)
    return "#" + "".join(f"{channel:02X}" for channel in mixed)
