"""``forcefeel identify``."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Group

from forcefeel.cli.bench_data import DATA, BenchOptions
from forcefeel.cli.each_axis import each_axis, shaft_notes
from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.law_option import ORIGINAL, chosen_law
from forcefeel.cli.options import (
    OUTPUT,
    BenchLawOption,
    FolderOptions,
    LoaderOptions,
    LoaderOrProject,
    OutputOptions,
    filled,
    option,
)
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.bench.identification.as_json import FitSettings
    from forcefeel.bench.identification.result import Estimate, Identification
    from forcefeel.bench.records import BenchRecord
    from forcefeel.bench.responses import Response
    from forcefeel.laws.law import Law
    from forcefeel.loader.loader import Loader

_NONE = "-"

FIT = Group("Fit", sort_key=20)


class IdentifyLoss(StrEnum):
    """What large residuals cost."""

    HUBER = "huber"
    LINEAR = "linear"
    SOFT_L1 = "soft_l1"
    CAUCHY = "cauchy"


@dataclass(frozen=True, kw_only=True)
class IdentifyOptions(BenchOptions, LoaderOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel identify``."""

    data: Annotated[
        tuple[Path, ...],
        option(
            "Bench data: a frequency response (CSV) or a time record (CSV, Parquet, MATLAB, or MCAP of forcefeel run). "
            "Repeatable.",
            DATA,
            metavar="FILE",
        ),
    ]
    fit: Annotated[
        str,
        option(
            "Parameters to fit, by symbol or name: k,c,J,C_i; for a motor K_t,J_m,k,c,J.",
            FIT,
            metavar="PARAMETERS",
        ),
    ]
    starts: Annotated[
        int,
        option(
            "Number of starting points: the file's values, then others within the tolerances.",
            FIT,
        ),
    ] = 5
    loss: Annotated[
        IdentifyLoss,
        option(
            "Loss of large residuals: huber reduces the weight of those beyond three deviations, linear is least squares.",
            FIT,
        ),
    ] = IdentifyLoss.HUBER
    no_priors: Annotated[
        bool, option("Use the file's normal tolerances as bounds only, not as prior knowledge.", FIT)
    ] = False
    as_responses: Annotated[
        bool,
        option("Convert records to frequency responses and fit the linear model to those.", FIT, "--responses"),
    ] = False
    law: BenchLawOption = None
    out: Annotated[Path, option("Folder for loader.toml, identification.html and results.json.", OUTPUT)] = Path(
        "forcefeel-identified"
    )

    def settings(self, loader: "Loader", law: "Law | None") -> "FitSettings":
        """How the fit is to be made."""
        from forcefeel.bench.identification.as_json import FitSettings
        from forcefeel.bench.identification.linear import bench_law

        named = bench_law(None, loader) if law is None else law.name
        return filled(FitSettings, self, priors=not self.no_priors, law=str(self.law or named))

    def fixed_law(self, loader: "Loader", data: "Sequence[Response | BenchRecord]") -> "Law | None":
        """The law of the whole loader in the data; ``None`` for ``bench_law``.

        Where none is given, the law is the one that live runs among the data state.

        Raises:
            InputError: If it is of no use to these data or cannot be designed.
        """
        from forcefeel.bench.experiments import Loop
        from forcefeel.bench.run_law import law_of_runs
        from forcefeel.loader.parameters import HYDRAULIC

        if self.law is None and (law := law_of_runs(data, loader)) is not None:
            return law
        if self.law is None or (self.law == ORIGINAL and loader.drive == HYDRAULIC):
            return None
        if all(measurement.experiment.loop is not Loop.LOADER for measurement in data):
            raise InputError("--law: is the law of the whole loader, and all data are of the servo alone; leave it out")
        return chosen_law(self.law, loader)


@each_axis(notes=shaft_notes)
def run(path: LoaderOrProject = None, /, *, options: IdentifyOptions) -> None:
    """Estimate loader parameters and standard errors from bench data.

    The loader file is not changed. Exit status 1 if the data do not determine a parameter, or the residual is larger than the
    noise. In the first case no loader file is written; the page names the parameters that cannot be separated, and the experiment
    that separates them.

    Example: forcefeel identify my.toml --data closed.csv --data release.mat --fit k,c,J,C_i --out identified
    """
    from forcefeel.bench.identification.as_json import identification_json
    from forcefeel.bench.identification.findings import identification_conclusions
    from forcefeel.bench.identification.fit import identify
    from forcefeel.bench.identification.page.page import FOLDER, LOADER, write_identification

    inputs = [*_loader_file(path), *options.data]
    FOLDER.check(options.out, replace=options.replace, inputs=inputs)  # before the work, not after it
    loader, data = options.loader(path), options.read(options.data)
    law = options.fixed_law(loader, data)
    settings = options.settings(loader, law)
    with all_or_nothing("identify", "searches", silent=options.json, even=False) as bar:
        identification = identify(
            loader,
            data,
            options.fit,
            progress=bar.show,
            **{**asdict(settings), "law": law},
        )
        bar.describe("report")
        page = write_identification(
            identification,
            options.out,
            options.units,
            settings,
            estimated=_estimated(identification, data),
            inputs=inputs,
            replace=options.replace,
            command=options.command_line(path),
        )
    written = None if identification.loader is None else options.out / LOADER
    answer(
        {"page": page, "loader_file": written},
        lambda: identification_json(identification, options.units, settings),
        lambda terminal: _show(terminal, identification, options.units),
        as_json=options.json,
    )
    if not identification_conclusions(identification, options.units).ok:
        raise SystemExit(BAD_ANSWER)


def _percent(share: float) -> str:
    from forcefeel.bench.identification.digits import rounded

    return rounded(100 * share, 2) if math.isfinite(share) else _NONE


def _loader_file(path: Path | None) -> list[Path]:
    """The loader file, where it is one and not a built-in loader."""
    from forcefeel.loader.built_in import is_built_in

    return [] if path is None or is_built_in(path) else [path]


def _estimated(identification: "Identification", given: "Sequence[Response | BenchRecord]") -> "list[Response]":
    """Responses that were not given but estimated from records."""
    from forcefeel.bench.identification.result import data_of
    from forcefeel.bench.responses import Response

    own = {id(measurement) for measurement in given}
    return [
        measurement
        for measurement in data_of(identification.fitted)
        if isinstance(measurement, Response) and id(measurement) not in own
    ]


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


def _show(console: Terminal, identification: "Identification", units: UnitSystem) -> None:
    from forcefeel.bench.identification.findings import identification_conclusions

    table = titled(f"{identification.before.name}, identified; error is the standard error")
    for name, justify in _COLUMNS.items():
        table.add_column(name, justify=justify, no_wrap=True)
    for estimate in identification.estimates:
        table.add_row(*_row(estimate, units))
    console.show(table, on_the_page=("error", "95 % interval"))
    console.conclude(identification_conclusions(identification, units))


def _row(estimate: "Estimate", units: UnitSystem) -> tuple[str, ...]:
    from forcefeel.bench.identification.digits import error, estimated, interval, nominal, relative_error, unit_of
    from forcefeel.bench.identification.result import Status

    unknown = estimate.unknown
    start = (f"{unknown.symbol} {unknown.key}", nominal(estimate, units))
    if estimate.status is Status.UNDETERMINED:
        return (*start, _NONE, unit_of(estimate, units), *[_NONE] * 3, str(estimate.status))
    return (
        *start,
        estimated(estimate, estimate.value, units),
        unit_of(estimate, units),
        error(estimate, units),
        _NONE if unknown.is_phase else _percent(relative_error(estimate)),
        interval(estimate, units),
        str(estimate.status),
    )
