"""What each command does."""

import io
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from forcefeel.cli import show
from forcefeel.cli.options import Coupling
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.design import workflow
from forcefeel.design.assessment import assess, peaks
from forcefeel.design.findings import conclusions
from forcefeel.errors import InputError, shortened
from forcefeel.files import MOST_TEXT_BYTES, read_input, write_whole
from forcefeel.json_values import json_value
from forcefeel.laws.analog.recursion import PUBLISHED_HORIZON_S, DesignSettings, published_settings
from forcefeel.laws.analog.recursion import compensate as run_recursion
from forcefeel.laws.law import Law
from forcefeel.loader.built_in import BUILT_IN, open_loader
from forcefeel.loader.loader import Loader
from forcefeel.reproduction import Verdict, markdown
from forcefeel.reproduction import reproduce as run_reproduction
from forcefeel.units import UnitSystem


@dataclass(frozen=True)
class Options:
    """The options of recursion (22), as given; ``None`` is not given."""

    horizon_s: float | None
    converge: bool
    step_s: float | None
    tolerance: float | None
    position_weight: float | None
    r1: float | None
    r2: float | None
    pilot_coupling: Coupling | None
    q: Path | None

    def settings(self, loader: Loader) -> DesignSettings:
        """The settings for ``loader``: the published ones, changed as asked."""
        self._check()
        coupling = self.pilot_coupling or (Coupling.COLUMN if self.converge else Coupling.REPORT)
        base = (
            published_settings(loader) if coupling is Coupling.REPORT else DesignSettings(horizon_s=PUBLISHED_HORIZON_S)
        )
        names = ("horizon_s", "step_s", "tolerance", "position_weight", "r1", "r2")
        given: dict[str, float | None] = {name: value for name in names if (value := getattr(self, name)) is not None}
        if self.converge:
            given["horizon_s"] = None
        return replace(base, q=_read_q(self.q), **given)  # type: ignore[arg-type]

    def _check(self) -> None:
        if self.converge and self.horizon_s is not None:
            raise InputError("--converge and --horizon: given both; an endless horizon has no length, leave one out")
        if self.tolerance is not None and not self.converge:
            raise InputError("--tolerance: is for --converge; a horizon ends by its length")
        if self.q is not None and (self.position_weight is not None or self.r1 is not None):
            raise InputError("--q: gives [Q] whole; leave out --position-weight and --r1")


def new(path: Path, built_in: str, units: UnitSystem, *, as_json: bool, force: bool) -> None:
    """Writes a built-in loader."""
    if built_in not in BUILT_IN:
        raise InputError(f"--built-in: expected {' or '.join(BUILT_IN)}, got {built_in!r}")
    if path.is_dir():
        raise InputError(f"{path}: is a folder; expected the name of a file to write")
    if path.exists() and not force:
        raise InputError(f"{path}: is there already; choose another name, or --force to replace it")
    loader = BUILT_IN[built_in]()
    write_whole(path, loader.to_toml(units))
    if as_json:
        print_json({"loader_file": str(path), **loader.as_json(units)})
    else:
        print(f"wrote {path}")


def design(path: Path | None, options: Options, out: Path, units: UnitSystem, *, as_json: bool) -> None:
    """Designs and writes the report."""
    from forcefeel.design.page import FOLDER, write_report  # noqa: PLC0415  Plotly is only needed here

    loader = _loader(path)
    FOLDER.check(out)  # before the work, not after it
    settings = options.settings(loader)
    with Steps(len(workflow.STEPS)) as progress:
        found = workflow.design(loader, settings, progress.step)
        progress.step("report")
        page = write_report(found, out, units)
    if as_json:
        print_json({"report": str(page), "design": json_value(found, units)})
    else:
        show.conclusions(Terminal(), conclusions(found, units))
        print(f"report: {page}")
    _exit(good=found.acceptable)


def analyze(path: Path | None, units: UnitSystem, *, as_json: bool) -> None:
    """Analyses the original system."""
    found = workflow.analyze(_loader(path))
    if as_json:
        print_json(json_value(found, units))
    else:
        show.analysis(Terminal(), found, units)
    _exit(good=found.configuration("compliant").programmed.assessment.stable)


def compensate(loader: Loader, options: Options, units: UnitSystem, *, save_law: Path | None, as_json: bool) -> None:
    """Computes gains and closes the loop; gains that the recursion reached go to their file."""
    settings = options.settings(loader)
    with Steps(1) as progress:
        progress.step("recursion (22)")
        found = run_recursion(loader, settings)
    law = found.compensator(loader)
    judged = assess(loader, law, found.settings)
    demand = peaks(loader, law) if judged.stable else None
    saved = save_law if found.reached else None
    if saved:
        Law.of(settings, loader, name="recursion (22)").save(saved)
    if as_json:
        parts = {"loader": loader, "compensation": found, "assessment": judged, "peaks": demand}
        files = {"law_file": str(saved)} if saved else {}
        print_json(json_value({**files, **parts}, units))
    else:
        show.compensation(Terminal(), loader, found, judged, demand, units)
        if saved:
            print(f"law file: {saved}")
    _exit(good=found.reached and judged.stable)


def reproduce(units: UnitSystem, *, as_json: bool, as_markdown: bool) -> None:
    """Compares with the 1974 report."""
    with Steps(len(workflow.STEPS)) as progress:
        sections = run_reproduction(progress.step)
    if as_json:
        print_json(json_value(sections, units))
    elif as_markdown:
        print(markdown(sections), end="")
    else:
        show.reproduction(Terminal(), sections)
    _exit(good=all(row.verdict is not Verdict.OPEN for section in sections for row in section.rows))


def _read_q(path: Path | None) -> tuple[tuple[float, ...], ...] | None:
    if path is None:
        return None
    data = read_input(path, MOST_TEXT_BYTES, "[Q] as CSV, 7 rows of 7 numbers")
    try:
        with warnings.catch_warnings(action="error"):  # NumPy only warns of an empty file
            return tuple(tuple(row) for row in np.loadtxt(io.BytesIO(data), delimiter=",", ndmin=2).tolist())
    except (ValueError, UserWarning) as error:
        raise InputError(f"{path}: expected [Q] as CSV, 7 rows of 7 numbers: {shortened(str(error), 120)}") from error


def _loader(path: Path | None) -> Loader:
    return open_loader(path)


def _exit(*, good: bool) -> None:
    if not good:
        raise typer.Exit(1)


class Steps:
    """A bar on the terminal's error stream; nothing where that is no terminal."""

    def __init__(self, steps: int) -> None:
        columns = (
            SpinnerColumn(),
            TextColumn("{task.description}"),
            *Progress.get_default_columns()[1:3],
            TimeElapsedColumn(),
        )
        console = Console(stderr=True)
        self._bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
        self._task = self._bar.add_task("", total=steps + 1)

    def step(self, name: str) -> None:
        """One step begins: the one before is done."""
        self._bar.update(self._task, description=name)
        self._bar.advance(self._task)

    def __enter__(self) -> "Steps":
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()
