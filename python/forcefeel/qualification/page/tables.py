"""The tables of a qualification: tests by outcome, figures with their margins, conditions, versions and files."""

import platform
from importlib.metadata import version
from math import isfinite

from markupsafe import Markup

from forcefeel.conclusions import capital
from forcefeel.page.table import Cell, Table, number, words
from forcefeel.page.typography import NONE, number_text, prose_html, unit_text
from forcefeel.qualification import Outcome, Verdict
from forcefeel.qualification.plan.cockpit import CockpitQualification
from forcefeel.qualification.plan.motions import SHORT
from forcefeel.qualification.plan.plan import RuleTestCase
from forcefeel.qualification.plan.result import Qualification, QualificationStatus, Result, Section
from forcefeel.qualification.plan.sentences import (
    UNITS,
    figure_text,
    quantity,
    recorded,
    unverified_tests,
    why_outside,
)
from forcefeel.units import UnitSystem

_MINUS = "\N{MINUS SIGN}"
_GOOD, _BAD, _OPEN, _NONE = "#E3F3EC", "#FBE3E0", "#FDF0D3", "#ECEEF1"
_BACKGROUNDS: dict[Outcome | QualificationStatus, str] = {
    Outcome.PASSED: _GOOD,
    Outcome.FAILED: _BAD,
    Outcome.TOO_CLOSE: _OPEN,
    Outcome.NOT_EVALUATED: _NONE,
    QualificationStatus.QUALIFIES: _GOOD,
    QualificationStatus.DOES_NOT_QUALIFY: _BAD,
    QualificationStatus.INCOMPLETE: _OPEN,
}
UNVERIFIED = Markup(" <small>unverified</small>")


def anchor(section: Section, trial: RuleTestCase, axis: str = "") -> str:
    """Where the page has a test; ``axis`` of a cockpit's."""
    return "-".join(filter(None, (axis, section.name, trial.key)))


def summary(qualification: Qualification) -> Table:
    """A row for each test of the rule with what it came to, a column for each law; each leads to its test."""
    head = (Cell("Test"), *(Cell(section.title) for section in qualification.sections), Cell("Number"))
    by_section = [
        (section, {result.trial.key: result for result in section.results}) for section in qualification.sections
    ]
    rows = []
    for trial in qualification.test_plan.trials:
        came = (_linked(section, results.get(trial.key)) for section, results in by_section)
        rows.append((words(trial.title), *came, _number(trial)))
    for trial in qualification.test_plan.outside:
        reason = f"cannot be simulated: {why_outside(trial, qualification)}"
        rows.append(
            (words(trial.title), *(Cell(reason, "words", _NONE) for _ in qualification.sections), _number(trial))
        )
    total = (words("All"), *(colored(section.status) for section in qualification.sections), Cell(""))
    return Table(head, (*rows, total), "outcomes")


def over_axes(cockpit: CockpitQualification) -> Table:
    """A row for each test of each axis and law, with what it came to; each leads to its test."""
    rows = tuple(
        (
            words(axis),
            words(result.trial.title),
            _linked(section, result, axis),
            words(section.title),
            _number(result.trial),
        )
        for axis, qualification in cockpit.axes.items()
        for section in qualification.sections
        for result in section.results
    )
    return Table(tuple(map(Cell, ("Axis", "Test", "Outcome", "Law", "Number"))), rows, "outcomes")


def axes(cockpit: CockpitQualification) -> Table:
    """A row for each axis and law: the loader, and how many tests came to what; each leads to its section."""
    rows = tuple(
        (
            Cell(Markup('<a href="#{}">{}</a>').format(axis, axis), "words"),
            colored(section.status),
            *(words(text) for text in (qualification.loader.name, qualification.loader.drive, section.title)),
            *(number(str(section.count(outcome))) for outcome in Outcome),
        )
        for axis, qualification in cockpit.axes.items()
        for section in qualification.sections
    )
    head = (
        *map(Cell, ("Axis", "Status", "Loader", "Drive", "Law")),
        *(Cell(capital(outcome), "number") for outcome in Outcome),
    )
    return Table(head, rows, "outcomes")


def link_checks(cockpit: CockpitQualification) -> Table:
    """A row for each check of each link."""
    rows = tuple(
        (
            words(name),
            words(check.name),
            words(check.outcome, bad=not check.passed),
            *map(number, check.texts(cockpit.system)),
        )
        for name, checks in cockpit.links.items()
        for check in checks
    )
    return Table((*map(Cell, ("Link", "Check", "Outcome")), Cell("Value", "number"), Cell("Limit", "number")), rows)


def _linked(section: Section, result: Result | None, axis: str = "") -> Cell:
    if result is None:
        return Cell("not requested", "", _NONE)
    link = Markup('<a href="#{}">{}</a>').format(anchor(section, result.trial, axis), str(result.outcome))
    return Cell(link, "", _BACKGROUNDS[result.outcome])


def _number(trial: RuleTestCase) -> Cell:
    return Cell(trial.test.number + (Markup("") if trial.verified else UNVERIFIED))


def colored(came: Outcome | QualificationStatus) -> Cell:
    """What a test or a whole came to, in its color."""
    return Cell(str(came), "", _BACKGROUNDS[came])


def figures(result: Result, system: UnitSystem) -> Table:
    """The features of a test: verdict, measured, reference, difference, tolerance, uncertainty, margin."""
    numbers = ("Measured", "Reference", "Difference", "Tolerance", "Uncertainty", "Margin")
    head = (
        *(Cell(name) for name in ("Feature", "Verdict", "Unit")),
        *(Cell(name, "number") for name in numbers),
        Cell("Rule"),
    )
    return Table(head, tuple(_figure_row(verdict, result, system) for verdict in result.verdicts))


def _figure_row(verdict: Verdict, result: Result, system: UnitSystem) -> tuple[Cell, ...]:
    name = Markup("{}").format(verdict.quantity)
    if verdict.at is not None:
        small = quantity(verdict.at, "rad" if result.trial.test.kind != "small inputs" else "s", system)
        name += Markup(" <small>at {}</small>").format(small.replace("-", _MINUS))
    reason = Markup(" <small>{}</small>").format(verdict.reason) if verdict.reason else Markup("")
    rule = prose_html(verdict.rule.text(system)) + (Markup("") if verdict.verified else UNVERIFIED)
    numbers = (verdict.difference, verdict.tolerance, verdict.uncertainty, verdict.margin)
    return (
        Cell(name),
        Cell(Markup("{}").format(str(verdict.outcome)) + reason, "words", _BACKGROUNDS[verdict.outcome]),
        Cell(unit_text(UNITS[verdict.unit].shown(system)) or ""),
        *(number(figure_text(figure, system).replace("-", _MINUS)) for figure in (verdict.measured, verdict.reference)),
        *(number(_value(value, verdict.unit, system)) for value in numbers),
        words(rule),
    )


def _value(value: float, unit: str, system: UnitSystem) -> str:
    return number_text(UNITS[unit].from_si(value, system), 3) if isfinite(value) else NONE


def conditions(qualification: Qualification) -> Table:
    """By which rule, of which control, under which conditions."""
    rules, system = qualification.rules, qualification.system
    least, most = (100 * share for share in rules.release.deflection)
    low, high = (quantity(end, "rad", system) for end in (qualification.throw.low_rad, qualification.throw.high_rad))
    unverified = ", ".join(unverified_tests(qualification))
    made = qualification.test_plan.made
    required = dict.fromkeys(condition for trial in made for condition in trial.test.conditions)
    feel = "that was recorded" if recorded(qualification, "record") else "that the loader programs, hands off"
    sweeps = ", ".join(f"{sweep.name} {sweep.duration_s[0]:g} to {sweep.duration_s[1]:g} s" for sweep in rules.sweeps)
    rows = [
        ("Rule", f"{rules.title}, edition {rules.edition}, {rules.category}"),
        ("Axis", qualification.axis),
        ("Rows verified against the document", f"all but {unverified}" if unverified else "all"),
        (
            "Releases",
            f"from {least:g} to {most:g} % of the throw, both directions; residual band {100 * rules.release.residual_band:g} %",
        ),
        ("Sweeps", f"to {100 * SHORT:g} % of the throw and back: {sweeps}"),
        ("Throw", f"from {low} to {high}: {qualification.throw.source}"),
        ("Reference", qualification.reference),
        ("Required conditions", "; ".join(required)),
        ("Tested condition", f"the one feel {feel}; repeat the tests for the feel of each required flight condition"),
    ]
    if qualification.omitted:
        rows.append(("Omitted rows of the loader", ", ".join(qualification.omitted)))
    rows.append(("Sources", "; ".join(dict.fromkeys(trial.test.source for trial in made))))
    return Table((Cell("Item"), Cell("Value")), tuple((Cell(name), words(prose_html(text))) for name, text in rows))


def provenance(*qualifications: Qualification) -> Table:
    """Date, versions, loaders, files with their hashes."""
    rows = [
        ("Date", qualifications[0].day.isoformat()),
        ("forcefeel", version("forcefeel")),
        ("Python, NumPy", f"{platform.python_version()}, {version('numpy')}"),
        *(
            ("Loader", f"{qualification.loader.name}: {qualification.loader.source}")
            for qualification in qualifications
        ),
    ]
    for qualification in qualifications:
        for name, file in qualification.files.items():
            if file.path is not None:
                rows.append((name, f"{file.path.name}, SHA-256 {file.sha256}"))
    return Table((Cell("Item"), Cell("Value")), tuple((Cell(name), words(text)) for name, text in rows), "provenance")
