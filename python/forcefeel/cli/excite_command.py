"""What ``forcefeel excite`` does."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, get_args

import typer
from rich.console import Console
from rich.table import Table

from forcefeel.bench.channels import CHANNELS, channel
from forcefeel.bench.excitation import Excitation, ExcitationPlan, NotSeparableError, excite, write_excitation
from forcefeel.bench.excitation.as_json import excitation_json
from forcefeel.bench.excitation.bench_file import check_excitation_file
from forcefeel.bench.excitation.limits import KINDS
from forcefeel.bench.excitation.plan import Kind
from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.bench.identification.digits import percent
from forcefeel.cli.given_loader import given_law, given_loader
from forcefeel.cli.law_option import ORIGINAL
from forcefeel.cli.scenario_text import value
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE, with_unit
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.laws.law import Law

_EXAMPLES = {"current": "12 mA", "travel": "8 deg", "force": "1500 lb"}
_DRIVE_EXAMPLES = {Drive.TEST_SIGNAL: "5 V", Drive.COMMAND_SIGNAL: "5 V", Drive.PILOT_FORCE: "50 lb"}


@dataclass(frozen=True)
class ExciteOptions:
    """The options as given; ``None`` is not given.

    Attributes:
        limits: By name, as text.
    """

    fit: str
    experiment: str
    measure: str | None
    noise: list[str] | None
    kind: str
    span: tuple[float, float]
    band: tuple[float | None, float | None]
    limits: dict[str, str | None]
    law: str | None
    changes: list[str] | None
    out: Path
    replace: bool

    def fixed_law(self, loader: Loader, experiment: Experiment) -> "Law | None":
        """The law of the whole loader; ``None`` is the original one.

        Raises:
            InputError: If it is of no use to this experiment or cannot be designed.
        """
        if self.law in (None, ORIGINAL):
            return None
        if experiment.loop is not Loop.LOADER:  # first: what its design lacks is no matter then
            raise InputError(
                f"--compensator: is the law of the whole loader, and {experiment} is of the servo alone; leave it out"
            )
        return given_law(self.law, loader)

    def plan(self, drive: Drive) -> ExcitationPlan:
        """What is wanted, SI units.

        Raises:
            InputError: If an option is bad.
        """
        known = ExcitationPlan()
        share, noise = _noise(self.noise or [])
        measured = known.measured if self.measure is None else tuple(map(channel, self.measure.split(",")))
        kind: Kind = next(it for it in get_args(Kind) if it == self.kind)
        return ExcitationPlan(
            kind,
            *self.span,
            *self.band,
            measured,
            known.noise_share if share is None else share,
            noise,
            {name: _limit(name, given, drive) for name, given in self.limits.items() if given is not None},
        )


def run_excite(path: Path | None, options: ExciteOptions, units: UnitSystem, *, as_json: bool) -> None:
    """Designs an excitation and writes it for the bench."""
    check_excitation_file(options.out, replace=options.replace)  # before the work, not after it
    experiment = Experiment.read(options.experiment)
    loader = given_loader(path, options.changes)
    law = options.fixed_law(loader, experiment)
    try:
        found = excite(loader, options.fit, experiment, options.plan(experiment.drive), law)
    except NotSeparableError as error:
        print(f"forcefeel: {error}", file=sys.stderr)
        raise typer.Exit(1) from None
    write_excitation(found, options.out, units, replace=options.replace)
    if as_json:
        print_json({"file": str(options.out), **excitation_json(found, units)})
    else:
        _show(Terminal(), found, units)
        print(f"file: {options.out}")
    if found.vague:
        raise typer.Exit(1)


def _noise(given: list[str]) -> tuple[float | None, dict[str, float]]:
    """The share of all channels, if it is given, and the noise of single ones, SI units."""
    share, single = None, {}
    for text in given:
        name, equals, said = text.rpartition("=")
        if not equals:
            if share is not None:
                raise InputError(f"--noise: expected one share for all channels, got another, {text!r}; leave one out")
            share = value("--noise", text.strip(), "", "1 %")
        else:
            single[channel(name)] = value("--noise", said.strip(), CHANNELS[channel(name)], "0.01 deg")
    return share, single


def _limit(name: str, given: str, drive: Drive) -> float:
    channel = KINDS.get(name, str(drive))
    return value(
        f"--limit-{name}", given.strip(), CHANNELS[channel], _EXAMPLES.get(name, _DRIVE_EXAMPLES.get(drive, ""))
    )


def _show(console: Console, found: Excitation, units: UnitSystem) -> None:
    parameters = Table("parameter", title="Predicted standard errors", title_justify="left", title_style="bold")
    for name in ("symbol", "value", "standard error"):
        parameters.add_column(name, justify="right")
    for key, error in found.standard_errors.items():
        parameters.add_row(key, TABLE[key].symbol, with_unit(TABLE[key], found.loader[key], units, 4), percent(error))
    limits = Table("limit", title="Peaks on the loader", title_justify="left", title_style="bold")
    for name in ("peak", "limit", "used"):
        limits.add_column(name, justify="right")
    limits.add_column("where from")
    for use in found.uses:
        limit = use.limit
        limits.add_row(
            limit.channel.replace("_", " "),
            limit.shown(use.peak, units),
            limit.shown(limit.value, units),
            f"{use.share:.0%}",
            limit.reason,
        )
    console.print(f"{found.experiment}: {found.words}", highlight=False)
    console.print(parameters)
    console.print(limits)
    console.print(found.verdict, style="bold red" if found.vague else "bold", highlight=False)
    for finding in found.findings(units):
        console.print(f"- {finding}", highlight=False)
