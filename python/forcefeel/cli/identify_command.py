"""What ``forcefeel identify`` does."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import typer
from rich.console import Console
from rich.table import Table

from forcefeel.bench.experiments import Loop
from forcefeel.bench.identification.as_json import FitSettings, identification_json
from forcefeel.bench.identification.digits import error, estimated, interval, nominal, relative_error, rounded, unit_of
from forcefeel.bench.identification.findings import identification_conclusions
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.result import Estimate, Identification, Status, data_of
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.cli.bench_data import BenchData
from forcefeel.cli.given_loader import given_law, given_loader
from forcefeel.cli.identify_options import IdentifyLoss
from forcefeel.cli.law_option import ORIGINAL
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.errors import InputError
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import Loader
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.laws.law import Law

_NONE = "-"
_DATA = Sequence[Response | BenchRecord]


@dataclass(frozen=True)
class IdentifyOptions:
    """The options as given; ``None`` is not given."""

    data: BenchData
    fit: str
    starts: int
    loss: IdentifyLoss
    no_priors: bool
    as_responses: bool
    law: str | None
    changes: list[str] | None
    out: Path
    replace: bool

    @property
    def settings(self) -> FitSettings:
        """How the fit is to be made."""
        law = str(self.law or ORIGINAL)
        return FitSettings(str(self.loss), self.starts, not self.no_priors, self.as_responses, law)

    def fixed_law(self, loader: Loader, data: _DATA) -> "Law | None":
        """The law of the whole loader in the data; ``None`` is the original one.

        Raises:
            InputError: If it is of no use to these data or cannot be designed.
        """
        if self.law in (None, ORIGINAL):
            return None
        if all(one.experiment.loop is not Loop.LOADER for one in data):
            raise InputError(
                "--compensator: is the law of the whole loader, and all data are of the servo alone; leave it out"
            )
        return given_law(self.law, loader)


def run_identify(path: Path | None, options: IdentifyOptions, units: UnitSystem, *, as_json: bool) -> None:
    """Identifies a loader and writes the folder."""
    from forcefeel.bench.identification.page.folder import FOLDER, LOADER, write_identification  # noqa: PLC0415

    inputs = [*_loader_file(path), *options.data.files]
    FOLDER.check(options.out, replace=options.replace, inputs=inputs)  # before the work, not after it
    loader, data = given_loader(path, options.changes), options.data.read()
    law = options.fixed_law(loader, data)
    settings = options.settings
    with all_or_nothing(silent=as_json) as bar:
        bar.describe("identify")
        found = identify(
            loader,
            data,
            options.fit,
            law=law,
            starts=settings.starts,
            loss=options.loss.value,
            priors=settings.priors,
            as_responses=settings.as_responses,
            progress=bar.show,
        )
        bar.describe("report")
        page = write_identification(
            found,
            options.out,
            units,
            settings,
            estimated=_estimated(found, data),
            inputs=inputs,
            replace=options.replace,
        )
    written = None if found.loader is None else options.out / LOADER
    if as_json:
        paths = {"page": str(page), "loader_file": written and str(written)}
        print_json({**paths, **identification_json(found, units, settings)})
    else:
        _show(Terminal(), found, units)
        print(f"page: {page}")
        if written:
            print(f"loader: {written}")
    if found.loader is None:
        raise typer.Exit(1)


def _percent(share: float) -> str:
    return rounded(100 * share, 2) if math.isfinite(share) else _NONE


def _loader_file(path: Path | None) -> list[Path]:
    """The loader file, where it is one and not a built-in loader."""
    return [] if path is None or (str(path) in BUILT_IN and not path.exists()) else [path]


def _estimated(found: Identification, given: _DATA) -> list[Response]:
    """Responses that were not given but estimated from records."""
    own = {id(one) for one in given}
    return [one for one in data_of(found.fitted) if isinstance(one, Response) and id(one) not in own]


_COLUMNS: Mapping[str, Literal["left", "right"]] = {
    "parameter": "left",
    "file": "right",
    "estimate": "right",
    "unit": "right",
    "error": "right",
    "error, %": "right",
    "95 % interval": "right",
    "status": "left",
}
_WIDE, _WIDE_ONLY = 120, ("error", "95 % interval")
"""Characters from which on a terminal has room for all columns, and those that the page has too."""


def _show(console: Console, found: Identification, units: UnitSystem) -> None:
    table = Table(
        title=f"{found.before.name}, identified; error is the standard error", title_justify="left", title_style="bold"
    )
    narrow = console.width < _WIDE
    shown = [name for name in _COLUMNS if not narrow or name not in _WIDE_ONLY]
    for name in shown:
        table.add_column(name, justify=_COLUMNS[name], no_wrap=name != "unit")
    for one in found.estimates:
        row = dict(zip(_COLUMNS, _row(one, units), strict=True))
        table.add_row(*(row[name] for name in shown))
    console.print(table)
    said = identification_conclusions(found, units)
    console.print(said.verdict, style="bold" if said.good else "bold red", highlight=False)
    for finding in said.findings:
        console.print(f"- {finding}", highlight=False)


def _row(one: Estimate, units: UnitSystem) -> tuple[str, ...]:
    unknown = one.unknown
    start = (f"{unknown.symbol} {unknown.key}", nominal(one, units))
    if one.status is Status.UNDETERMINED:
        return (*start, _NONE, unit_of(one, units), *[_NONE] * 3, str(one.status))
    return (
        *start,
        estimated(one, one.value, units),
        unit_of(one, units),
        error(one, units),
        _percent(relative_error(one)),
        interval(one, units),
        str(one.status),
    )
