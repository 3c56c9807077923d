"""What ``forcefeel envelope`` does."""

import json
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from forcefeel.cli.given_loader import given_loader
from forcefeel.cli.progress import all_or_nothing
from forcefeel.designs.setting_laws import names_for
from forcefeel.envelopes import Envelope
from forcefeel.envelopes.cases import changes_of
from forcefeel.envelopes.findings import envelope_conclusions
from forcefeel.envelopes.plain import plain_envelope
from forcefeel.envelopes.plan import Plan, make_plan
from forcefeel.envelopes.run import compute
from forcefeel.errors import InputError
from forcefeel.loader import Loader
from forcefeel.qualification import DEFAULT_EDITION
from forcefeel.sweep import text
from forcefeel.sweep.findings import share_text
from forcefeel.units import ANGLE, UnitSystem, parse


@dataclass(frozen=True)
class EnvelopeOptions:
    """The options as given; ``None`` is not given."""

    grid: list[str] | None
    compensators: list[str] | None
    compare: bool
    rule: str | None
    angle: str | None
    off: list[str] | None
    changes: list[str] | None
    out: Path
    replace: bool
    threads: int | None

    def plan(self, path: Path | None) -> Plan:
        """What is to be computed.

        Raises:
            InputError: If an option is bad or does not go with another.
        """
        if self.compare and self.compensators:
            raise InputError("--compare and --compensator: given both; --compare takes all, leave one out")
        loader = given_loader(path, self.changes)
        names = names_for(loader) if self.compare else tuple(self.compensators or ("published",))
        grid = text.assignments("--grid", self.grid, "stiffness=1..100 %:25:log")
        options = {
            "rule": self.rule or DEFAULT_EDITION,
            "angle_rad": release_angle(self.angle),
            "changes": self._off(loader),
        }
        return make_plan(loader, names, grid, **options)

    def _off(self, loader: Loader) -> dict[str, float]:
        """How far each parameter of the plant is off."""
        found = dict(changes_of(loader))
        for key, given in text.assignments("--off", self.off, "column.inertia=2 %").items():
            if given == "none":
                found.pop(key, None)
                continue
            try:
                found[key] = parse(given, "", "2 %")
            except InputError as error:
                raise InputError(f"--off: {key}: {error}") from error
        return found


def release_angle(given: str | None) -> float | None:
    """The angle of a release in rad; ``None`` if it is not given.

    Raises:
        InputError: If it is no angle.
    """
    try:
        return None if given is None else parse(given, ANGLE.si, "10 deg")
    except InputError as error:
        raise InputError(f"--angle: {error}") from error


def run_envelope(path: Path | None, options: EnvelopeOptions, units: UnitSystem, *, as_json: bool) -> None:
    """Computes an envelope and writes its folder."""
    from forcefeel.report.envelope_folder import check_envelope_folder, write_envelope  # noqa: PLC0415  Plotly

    plan = options.plan(path)
    check_envelope_folder(options.out, replace=options.replace)  # before the work, not after it
    with all_or_nothing(silent=as_json) as bar:
        found = compute(plan, threads=options.threads, progress=bar.show)
        bar.describe("report")
        page = write_envelope(found, options.out, units, replace=options.replace)
    if as_json:
        print(json.dumps({"page": str(page), **plain_envelope(found, units)}, indent=2, allow_nan=False))
    else:
        _show(Console(), found, units)
        print(f"page: {page}")


def _show(console: Console, found: Envelope, units: UnitSystem) -> None:
    table = Table("compensator", title="Shares of the settings", title_justify="left", title_style="bold")
    for name in ("stable", "passes", "stable in every case", "passes in every case"):
        table.add_column(name, justify="right")
    for name in found.compensators:
        one = found.shares(name)
        table.add_row(name, *map(share_text, (one.stable, one.passes, one.stable_worst, one.passes_worst)))
    console.print(table)
    said = envelope_conclusions(found, units)
    console.print(said.verdict, style="bold", highlight=False)
    for finding in said.findings:
        console.print(f"- {finding}", highlight=False)
