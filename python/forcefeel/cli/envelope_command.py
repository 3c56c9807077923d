"""What ``forcefeel envelope`` does."""

from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from forcefeel.cli.given_loader import given_deviations, given_loader
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.conclusions import share_text
from forcefeel.envelope import Envelope
from forcefeel.envelope.as_json import envelope_json
from forcefeel.envelope.draws import Draws
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.plan import Plan, make_plan
from forcefeel.envelope.result import MOST
from forcefeel.envelope.run import compute
from forcefeel.errors import InputError
from forcefeel.laws.law import names_for
from forcefeel.qualification import DEFAULT_EDITION
from forcefeel.sweep import text
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
    draws: Draws
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
            "changes": given_deviations(loader, self.off),
            "draws": self.draws,
        }
        return make_plan(loader, names, grid, **options)


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
    from forcefeel.envelope.page.folder import FOLDER, write_envelope  # noqa: PLC0415  Plotly

    plan = options.plan(path)
    FOLDER.check(options.out, replace=options.replace)  # before the work, not after it
    with all_or_nothing(silent=as_json) as bar:
        found = compute(plan, threads=options.threads, progress=bar.show)
        bar.describe("report")
        page = write_envelope(found, options.out, units, replace=options.replace)
    if as_json:
        print_json({"page": str(page), **envelope_json(found, units)})
    else:
        _show(Terminal(), found, units)
        print(f"page: {page}")


def _show(console: Console, found: Envelope, units: UnitSystem) -> None:
    table = Table("compensator", title="Shares of the settings", title_justify="left", title_style="bold")
    for name in ("stable", "passes", "stable in every case", "passes in every case"):
        table.add_column(name, justify="right")
    for name in found.compensators:
        one = found.shares(name)
        table.add_row(name, *map(share_text, (one.stable, one.passes, one.stable_worst, one.passes_worst)))
    console.print(table)
    if found.plan.machines:
        console.print(_drawn(found))
    said = envelope_conclusions(found, units)
    console.print(said.verdict, style="bold", highlight=False)
    for finding in said.findings:
        console.print(f"- {finding}", highlight=False)


def _drawn(found: Envelope) -> Table:
    machines = f"{len(found.plan.machines):,} machines {'at the corners' if found.plan.draws.corners else 'at random'}"
    table = Table("compensator", title=f"All tolerances at once, {machines}", title_justify="left", title_style="bold")
    most = share_text(MOST)
    for name in (f"settings, in {most} of machines", f"machines, at {most} of settings", "a machine, on average"):
        table.add_column(name, justify="right")
    for name in found.compensators:
        one = found.drawn_shares(name)
        table.add_row(name, *map(share_text, (one.settings, one.good, one.passes)))
    return table
