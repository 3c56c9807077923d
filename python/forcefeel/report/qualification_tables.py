"""The tables of a qualification: tests by outcome, figures with their margins, conditions, versions and files."""

import platform
from importlib.metadata import version
from math import isfinite

from markupsafe import Markup

from forcefeel.qualification import Outcome, Verdict
from forcefeel.qualify.motions import SHORT
from forcefeel.qualify.result import Qualification, Result
from forcefeel.qualify.words import UNITS, figure_text, quantity, unverified_tests
from forcefeel.report.table import Cell, Table, number, words
from forcefeel.report.typography import NONE, number_text, prose_html, unit_text
from forcefeel.units import UnitSystem

_MINUS = "\N{MINUS SIGN}"
_BACKGROUNDS = {
    Outcome.PASSED: "#E3F3EC",
    Outcome.FAILED: "#FBE3E0",
    Outcome.TOO_CLOSE: "#FDF0D3",
    Outcome.NOT_EVALUATED: "#ECEEF1",
}
UNVERIFIED = Markup(" <small>unverified</small>")


def summary(found: Qualification) -> Table:
    """A row for each test, a column for each law."""
    head = (Cell("Test"), Cell("What"), *(Cell(section.title) for section in found.sections))
    rows = []
    for results in zip(*(section.results for section in found.sections), strict=True):
        trial = results[0].trial
        mark = Markup("") if results[0].verified else UNVERIFIED
        rows.append((Cell(trial.test.number + mark), words(trial.title), *(outcome(one.outcome) for one in results)))
    total = (Cell(""), words("all"), *(outcome(section.outcome) for section in found.sections))
    return Table(head, (*rows, total), "outcomes")


def outcome(came: Outcome) -> Cell:
    """An outcome in its colour."""
    return Cell(str(came), background=_BACKGROUNDS[came])


def figures(result: Result, system: UnitSystem) -> Table:
    """The features of a test: measured, reference, difference, tolerance, uncertainty, margin, verdict."""
    head = (
        Cell("Feature"),
        Cell("Unit"),
        *(
            Cell(name, "number")
            for name in ("Measured", "Reference", "Difference", "Tolerance", "Uncertainty", "Margin")
        ),
        Cell("Verdict"),
        Cell("Rule"),
    )
    return Table(head, tuple(_figure_row(one, result, system) for one in result.verdicts))


def _figure_row(verdict: Verdict, result: Result, system: UnitSystem) -> tuple[Cell, ...]:
    name = Markup("{}").format(verdict.quantity)
    if verdict.at is not None:
        small = quantity(verdict.at, "rad" if result.trial.test.kind != "small inputs" else "s", system)
        name += Markup(" <small>at {}</small>").format(small.replace("-", _MINUS))
    said = str(verdict.outcome)
    rule = prose_html(verdict.rule.text(system)) + (Markup("") if verdict.verified else UNVERIFIED)
    numbers = (verdict.difference, verdict.tolerance, verdict.uncertainty, verdict.margin)
    return (
        Cell(name),
        Cell(unit_text(UNITS[verdict.unit].shown(system)) or ""),
        *(number(figure_text(one, system).replace("-", _MINUS)) for one in (verdict.measured, verdict.reference)),
        *(number(_value(value, verdict.unit, system)) for value in numbers),
        Cell(
            Markup("{}").format(said) + (Markup(" <small>{}</small>").format(verdict.reason) if verdict.reason else ""),
            "words",
            _BACKGROUNDS[verdict.outcome],
        ),
        words(rule),
    )


def _value(value: float, unit: str, system: UnitSystem) -> str:
    return number_text(UNITS[unit].from_si(value, system), 3) if isfinite(value) else NONE


def conditions(found: Qualification) -> Table:
    """By which rule, of which control, under which conditions."""
    rules, system = found.rules, found.system
    least, most = (100 * share for share in rules.release.deflection)
    low, high = (quantity(end, "rad", system) for end in (found.throw.low_rad, found.throw.high_rad))
    unverified = ", ".join(unverified_tests(found))
    asked = list(dict.fromkeys(one for result in found.sections[0].results for one in result.trial.test.conditions))
    sweeps = ", ".join(f"{one.name} {one.duration_s[0]:g} to {one.duration_s[1]:g} s" for one in rules.sweeps)
    rows = [
        ("Rule", f"{rules.title}, edition {rules.edition}, {rules.category}"),
        ("Axis", found.axis),
        ("Rows held against the document", f"all but {unverified}" if unverified else "all"),
        (
            "Releases",
            f"from {least:g} to {most:g} % of the throw, both directions; residual band {100 * rules.release.residual_band:g} %",
        ),
        ("Sweeps", f"to {100 * SHORT:g} % of the throw and back: {sweeps}"),
        ("Throw", f"from {low} to {high}: {found.throw.source}"),
        ("Reference", found.reference),
        ("Conditions the rule asks for", "; ".join(asked)),
        (
            "Conditions here",
            "the one feel that the loader programs, hands off: repeat for each feel of the flight conditions asked for",
        ),
    ]
    if found.left_out:
        rows.append(("Left out of the loader", ", ".join(found.left_out)))
    sources = list(dict.fromkeys(result.trial.test.source for result in found.sections[0].results))
    rows.append(("Sources", "; ".join(sources)))
    return Table((Cell("What"), Cell("Here")), tuple((Cell(name), words(prose_html(text))) for name, text in rows))


def provenance(found: Qualification) -> Table:
    """Date, versions, loader, files with their hashes."""
    rows = [
        ("Date", found.day.isoformat()),
        ("forcefeel", version("forcefeel")),
        ("Python, NumPy", f"{platform.python_version()}, {version('numpy')}"),
        ("Loader", f"{found.loader.name}: {found.loader.source}"),
    ]
    for name, given in found.files.items():
        if given.path is not None:
            rows.append((name, f"{given.path.name}, SHA-256 {given.sha256}"))
    return Table((Cell("What"), Cell("Which")), tuple((Cell(name), words(text)) for name, text in rows), "provenance")
