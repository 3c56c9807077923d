"""The page of a qualification, in the manner of a qualification test guide, and its folder."""

from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from forcefeel.conclusions import Conclusions
from forcefeel.json_values import json_text
from forcefeel.page import machine
from forcefeel.page.chromium import page_pdf
from forcefeel.page.folder import OutputFolder
from forcefeel.page.render import drawing, render
from forcefeel.page.table import Table
from forcefeel.qualification.page import plots as qualification_plots
from forcefeel.qualification.page import tables as qualification_tables
from forcefeel.qualification.plan.as_json import qualification_json
from forcefeel.qualification.plan.cockpit import CockpitQualification, cockpit_conclusions
from forcefeel.qualification.plan.result import Qualification, Result, Section
from forcefeel.qualification.plan.sentences import conclusions, outcome_counts, result_text, unverified_tests

PAGE, NUMBERS, PDF = "qualification.html", "results.json", "qualification.pdf"

FOLDER = OutputFolder("the qualification", (PAGE, NUMBERS, PDF))

_RELEASE = (
    "Position from each record's own steady state. Circles: evaluated times and overshoots; bars: tolerances around "
    "those of the reference; gray: the residual band, in which overshoots do not count."
)
_SWEEP = "Force over position, both directions. Gray: within tolerance of the reference."
_DYNAMIC = (
    "Extra force over the slow sweep at the same position, both directions. Gray: within tolerance of the reference."
)
_SMALL = "Body rate. Gray: within tolerance of the reference."
_MEANINGS = {"release": _RELEASE, "static": _SWEEP, "dynamic sweep": _DYNAMIC, "small inputs": _SMALL, "freeplay": ""}


@dataclass(frozen=True)
class ShownTest:
    """A test as the page shows it.

    Attributes:
        key: Its anchor.
        result: What came of it.
        summary: Its outcome in a sentence.
        drawing: Its plot; empty without a plot.
        meaning: How to read the plot.
        figures: Its features; ``None`` where nothing was compared.
    """

    key: str
    result: Result
    summary: str
    drawing: Markup
    meaning: str
    figures: Table | None


@dataclass(frozen=True)
class ShownSection:
    """A law as the page shows it; ``key`` is its anchor."""

    key: str
    section: Section
    outcome_counts: str
    tests: tuple[ShownTest, ...]


@dataclass(frozen=True)
class ShownAxis:
    """An axis of a cockpit as the page shows it; ``key`` is its anchor."""

    key: str
    qualification: Qualification
    conclusions: Conclusions
    sections: tuple[ShownSection, ...]
    conditions: Table
    parameters: Table


def qualification_page(
    qualification: Qualification | CockpitQualification, beside: tuple[str, ...], *, command: str = ""
) -> str:
    """The whole page; ``beside`` are the names of the files beside it."""
    if isinstance(qualification, CockpitQualification):
        return _cockpit_page(qualification, beside, command)
    return render(
        "qualification/page/qualification.html.j2",
        command=command,
        qualification=qualification,
        conclusions=conclusions(qualification),
        summary=qualification_tables.summary(qualification),
        sections=[_section(section, qualification) for section in qualification.sections],
        conditions=qualification_tables.conditions(qualification),
        provenance=qualification_tables.provenance(qualification),
        unverified=unverified_tests(qualification),
        parameters=machine.parameters(qualification.loader, qualification.system),
        beside=beside,
    )


def _cockpit_page(cockpit: CockpitQualification, beside: tuple[str, ...], command: str) -> str:
    """The test guide of a cockpit: an overview, then the sections of each axis."""
    axes = [
        ShownAxis(
            axis,
            qualification,
            conclusions(qualification),
            tuple(_section(section, qualification, axis) for section in qualification.sections),
            qualification_tables.conditions(qualification),
            machine.parameters(qualification.loader, qualification.system),
        )
        for axis, qualification in cockpit.axes.items()
    ]
    first = axes[0].qualification
    return render(
        "qualification/page/cockpit.html.j2",
        command=command,
        name=cockpit.name,
        qualification=first,
        conclusions=cockpit_conclusions(cockpit),
        overview=qualification_tables.axes(cockpit),
        tests_of_all=qualification_tables.over_axes(cockpit),
        link_checks=qualification_tables.link_checks(cockpit) if cockpit.links else None,
        axes=axes,
        provenance=qualification_tables.provenance(*cockpit.axes.values()),
        unverified=list(
            dict.fromkeys(test for qualification in cockpit.axes.values() for test in unverified_tests(qualification))
        ),
        beside=beside,
    )


def _section(section: Section, qualification: Qualification, axis: str = "") -> ShownSection:
    key = "-".join(filter(None, ("law", axis, section.name)))
    tests = tuple(_test(result, section, qualification, axis) for result in section.results)
    return ShownSection(key, section, outcome_counts(section), tests)


def _test(result: Result, section: Section, qualification: Qualification, axis: str) -> ShownTest:
    key = qualification_tables.anchor(section, result.trial, axis)
    picture = qualification_plots.drawn(result, qualification, section.name)
    return ShownTest(
        key=key,
        result=result,
        summary=result_text(result, qualification),
        drawing=Markup("") if picture is None else drawing(picture, f"plot-{key}"),
        meaning=_MEANINGS[result.trial.test.kind],
        figures=qualification_tables.figures(result, qualification.system) if result.verdicts else None,
    )


def write_qualification(
    qualification: Qualification | CockpitQualification, out: Path, *, pdf: bool = False, command: str = ""
) -> Path:
    """Writes ``qualification.html``, ``results.json`` and, with ``pdf``, ``qualification.pdf``.

    Existing files stay until the new ones are complete; other files in the folder are not changed.

    Args:
        qualification: The qualification to report, of a loader or of a cockpit: one test guide over its axes.
        out: The folder; created if it does not exist.
        pdf: Print the page too; requires Chromium.
        command: The command line, shown on the page.

    Returns:
        The path of the page.

    Raises:
        InputError: If ``out`` is a file or cannot be made or written, or the PDF cannot be printed.

    Example:
        >>> setup = ff.qualification.QualificationSetup(tests=("release-25-positive",))
        >>> qualification = ff.qualify_loader(ff.elevator(), setup)
        >>> ff.qualification.write_qualification(qualification, Path("my-tests")).parent.name
        'my-tests'
    """
    FOLDER.check(out)
    page = qualification_page(qualification, (NUMBERS, PDF) if pdf else (NUMBERS,), command=command)
    contents: dict[str, str | bytes] = {NUMBERS: json_text(qualification_json(qualification)), PAGE: page}
    if pdf:
        contents = {PDF: page_pdf(page), **contents}
    FOLDER.write(out, contents)
    return out / PAGE
