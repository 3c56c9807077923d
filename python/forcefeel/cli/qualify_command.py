"""What ``forcefeel qualify`` does."""

from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table

from forcefeel.cli.bench_data import options_named
from forcefeel.cli.given_loader import given_loader
from forcefeel.cli.law_option import ORIGINAL
from forcefeel.cli.qualify_options import ControlAxis, Overdamped
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.errors import InputError
from forcefeel.laws.law import names_for
from forcefeel.loader.loader import Loader
from forcefeel.qualification import DEFAULT_EDITION, Outcome
from forcefeel.qualification.programme import Qualification, QualificationSetup, qualify_loader
from forcefeel.qualification.programme.as_json import qualification_json
from forcefeel.qualification.programme.sentences import conclusions
from forcefeel.units import UnitSystem, parse


@dataclass(frozen=True)
class QualifyOptions:
    """The options as given; ``None`` is not given."""

    rule: str | None
    tests: list[str] | None
    axis: ControlAxis
    throw: str | None
    overdamped: Overdamped
    dynamic_pressure: str | None
    references: list[str] | None
    records: list[str] | None
    columns: list[str] | None
    units: list[str] | None
    laws: list[str] | None
    compare: bool
    changes: list[str] | None
    out: Path
    pdf: bool
    simulator: str
    operator: str

    def setup(self, loader: Loader, units: UnitSystem) -> QualificationSetup:
        """How a loader is qualified.

        Raises:
            InputError: If an option is bad or does not go with another.
        """
        for option, given in (("--compensator", self.laws), ("--compare", self.compare)):
            if given and self.records:
                raise InputError(
                    f"{option}: is about the simulated loader, and --record takes its place; leave one out"
                )
        if self.laws and self.compare:
            raise InputError("--compare: takes every law, and --compensator some; leave one out")
        return QualificationSetup(
            laws=names_for(loader) if self.compare else tuple(self.laws or [ORIGINAL]),
            rule=self.rule or DEFAULT_EDITION,
            axis=self.axis.value,
            throw_rad=_value("--throw", self.throw, "rad", "18 deg"),
            references=tuple(self.references or ()),
            records=tuple(self.records or ()),
            tests=tuple(self.tests or ()),
            columns=tuple(self.columns or ()),
            units=tuple(self.units or ()),
            dynamic_pressure_pa=_value("--dynamic-pressure", self.dynamic_pressure, "Pa", "5 kPa"),
            overdamped=self.overdamped.value,
            system=units,
            simulator=self.simulator,
            operator=self.operator,
        )


def run_qualify(path: Path | None, options: QualifyOptions, units: UnitSystem, *, as_json: bool) -> None:
    """Makes the tests, writes the folder and shows what came of them."""
    from forcefeel.page.chromium import find_chromium  # noqa: PLC0415
    from forcefeel.qualification.page.folder import FOLDER, write_qualification  # noqa: PLC0415

    FOLDER.check(options.out)  # before the work, not after it
    if options.pdf:
        find_chromium()
    loader = given_loader(path, options.changes)
    with options_named():
        found = qualify_loader(loader, options.setup(loader, units))
    page = write_qualification(found, options.out, pdf=options.pdf)
    if as_json:
        print_json({"page": str(page), **qualification_json(found)})
    else:
        _show(Terminal(), found)
        print(f"page: {page}")
    if not found.fulfilled:
        raise typer.Exit(1)


def _show(console: Console, found: Qualification) -> None:
    title = f"{found.loader.name}, {found.rules.title} ({found.rules.edition}), {found.axis}"
    console.print((_tests if len(found.sections) <= _SIDE_BY_SIDE else _counts)(found, title))
    said = conclusions(found)
    console.print(said.verdict, style="bold" if said.good else "bold red", highlight=False)
    for finding in said.findings:
        console.print(f"- {finding}", highlight=False)


_SIDE_BY_SIDE = 3
"""Laws whose outcomes a terminal shows test by test."""


def _tests(found: Qualification, title: str) -> Table:
    """Test by test, a column for each law."""
    table = Table("test", title=title, title_justify="left", title_style="bold")
    for section in found.sections:
        table.add_column(section.title)
    table.add_column("number")
    for results in zip(*(section.results for section in found.sections), strict=True):
        trial = results[0].trial
        table.add_row(trial.key, *(str(one.outcome) for one in results), trial.test.number)
    return table


def _counts(found: Qualification, title: str) -> Table:
    """What each law came to, and how many tests came to what."""
    table = Table("law", "standing", title=title, title_justify="left", title_style="bold")
    for outcome in Outcome:
        table.add_column(str(outcome), justify="right")
    for section in found.sections:
        counts = (str(section.count(outcome)) for outcome in Outcome)
        table.add_row(section.title, str(section.standing), *counts)
    return table


def _value(option: str, given: str | None, unit: str, example: str) -> float | None:
    if given is None:
        return None
    try:
        return parse(given, unit, example)
    except InputError as error:
        raise InputError(f"{option}: {error}") from error
