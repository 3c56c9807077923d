"""``forcefeel commission``."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Group

from forcefeel.cli.bench_data import DATA, BenchOptions
from forcefeel.cli.each_axis import each_axis, shaft_notes
from forcefeel.cli.exit_status import BAD_ANSWER, INTERRUPTED
from forcefeel.cli.options import (
    EDITION,
    OUTPUT,
    FolderOptions,
    LoaderOptions,
    LoaderOrProject,
    OutputOptions,
    ThreadOptions,
    option,
)
from forcefeel.cli.progress import Bar
from forcefeel.cli.scenario_text import value
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.files import Kind, input_kind

if TYPE_CHECKING:
    from forcefeel.bench.records import BenchRecord
    from forcefeel.bench.responses import Response
    from forcefeel.commission import Commission, CommissionPlan, StepWriters
    from forcefeel.loader.loader import Loader

BENCH = Group("Bench", sort_key=20)
ASKED = Group("Request", sort_key=30)


@dataclass(frozen=True, kw_only=True)
class CommissionOptions(BenchOptions, LoaderOptions, FolderOptions, ThreadOptions, OutputOptions):
    """The options of ``forcefeel commission``."""

    data: Annotated[
        tuple[Path, ...],
        option(
            "Bench data, as for identify: a time record or a frequency response. Repeatable.",
            DATA,
            metavar="FILE",
        ),
    ] = ()
    own_instruments: Annotated[
        bool,
        option(
            "The records are from separate fast instruments. By default the lag of the loader's own sensors is removed.",
            DATA,
        ),
    ] = False
    simulate_bench: Annotated[
        Path | None,
        option("Loader file of a machine to simulate as the bench.", BENCH, metavar="TRUTH.toml"),
    ] = None
    machine: Annotated[
        Literal["bus"] | None,
        option(
            "Play the bench signal on the drive of the file's table [bus] first: the motor moves the column. Hands off.",
            BENCH,
        ),
    ] = None
    time_s: Annotated[
        float, option("Length of a record that is simulated, or made on the bus, s.", BENCH, "--time")
    ] = 60.0
    rate_hz: Annotated[
        float, option("Sample rate of the simulated record, 1/s; on the bus it is the controller's.", BENCH, "--rate")
    ] = 1000.0
    seed: Annotated[int, option("Seed of the simulated sensor noise.", BENCH)] = 1974
    required_share: Annotated[
        str,
        option(
            "Required share of settings, weighted evenly on logarithmic axes, that the law renders: on the identified "
            "loader, and on average over machines drawn from all its tolerances.",
            ASKED,
        ),
    ] = "95 %"
    fit: Annotated[
        str,
        option(
            "Parameters to identify, such as k,c,J,C_i.",
            ASKED,
            default="all that the data determine",
            metavar="PARAMETERS",
        ),
    ] = ""
    starts: Annotated[int, option("Number of starting points of the fit.", ASKED)] = 1
    rule: Annotated[str, option("Edition of the rule.", ASKED, metavar="EDITION")] = EDITION
    grid: Annotated[
        tuple[str, ...],
        option(
            "Settings along an axis. Defaults: 'stiffness=1..100 %:6:log' (of G_max), 'frequency=0.5..4 Hz:4:log', "
            "'damping=0.1, 0.3, 0.7, 1.5'. Repeatable.",
            ASKED,
            metavar="AXIS=VALUES",
        ),
    ] = ()
    draws: Annotated[int, option("Number of machines drawn from all tolerances.", ASKED)] = 12
    out: Annotated[
        Path, option("Folder for commission.html, loader.toml, the law and a folder for each step.", OUTPUT)
    ] = Path("forcefeel-commission")

    def plan(self) -> "CommissionPlan":
        """The plan of these options.

        Raises:
            InputError: If an option is bad.
        """
        from forcefeel.choice.score import COARSE
        from forcefeel.commission import CommissionPlan
        from forcefeel.sweep import text

        return CommissionPlan(
            share=value("--required-share", self.required_share, "", "95 %"),
            fit=tuple(symbol.strip() for symbol in self.fit.split(",") if symbol.strip()),
            starts=self.starts,
            rule=self.rule,
            grid={**COARSE, **text.assignments("--grid", self.grid, "stiffness=1..100 %:6:log")},
            draws=self.draws,
            own_instruments=self.own_instruments,
            units=self.units,
            threads=self.threads,
        )

    def measured(self) -> "list[Response | BenchRecord]":
        """The bench data that are given.

        Raises:
            InputError: If there are none and no machine to record, or both, or a file is bad.
        """
        given = sum(map(bool, (self.data, self.simulate_bench, self.machine)))
        if given != 1:
            raise InputError(
                "--data: expected bench data, or in their place --machine bus, or --simulate-bench with a machine to simulate, and "
                + ("one only; leave the others out" if given else "got none; give one")
            )
        return self.read(self.data)


@each_axis(notes=shaft_notes)
def run(path: LoaderOrProject = None, /, *, options: CommissionOptions = CommissionOptions()) -> None:
    """Commission a loader: identify it from bench data, choose the law, check the envelope, run the rule's tests.

    With --machine bus it records the machine on the bus of its drive first. Writes a folder for each step and one page with the
    result. After an interruption, run it again to resume. Exit status 1 if a required parameter is not determined, or the law
    misses the required share or fails a test. The law file is then named law-rejected.json.

    Example: forcefeel commission my.toml --data bench.csv --out commissioned
    """
    from forcefeel.commission import commission_loader, write_commission
    from forcefeel.commission.as_json import commission_json
    from forcefeel.commission.page.page import check_folder
    from forcefeel.commission.simulated_bench import BenchTime
    from forcefeel.loader.built_in import open_loader

    inputs = [
        path_given
        for path_given in (path, options.simulate_bench, *options.data)
        if path_given is not None and input_kind(path_given) is Kind.FILE
    ]
    command = options.command_line(path)
    check_folder(options.out, command, replace=options.replace, inputs=inputs)  # before the work, not after it
    loader, data, plan = options.loader(path), options.measured(), options.plan()
    truth = None if options.simulate_bench is None else open_loader(options.simulate_bench)
    with Bar("commission", "steps", silent=options.json, even=False) as bar:

        def show_step(step: str, what: str) -> None:
            bar.describe(f"{step}: {what}")
            bar.show(int(step[0]), 5)

        try:
            commission = commission_loader(
                loader,
                data,
                options.out,
                plan,
                bench=truth,
                record=None if options.machine is None else lambda: _record(loader, options.time_s),
                bench_time=BenchTime(options.time_s, options.rate_hz, options.seed),
                progress=show_step,
                writers=_step_pages(plan),
            )
        except KeyboardInterrupt:
            bar.stop()
            print(f"\nforcefeel: interrupted; the same command goes on in {options.out}", file=sys.stderr)
            raise SystemExit(INTERRUPTED) from None
        bar.describe("report")
        page = write_commission(commission, options.out, command=command)
    answer(
        {"page": page, "loader_file": _there(options.out, "loader.toml"), "law_file": law_file(options.out)},
        lambda: commission_json(commission),
        lambda terminal: _show(terminal, commission),
        as_json=options.json,
    )
    if not commission.ok:
        raise SystemExit(BAD_ANSWER)


def _record(loader: "Loader", time_s: float) -> "BenchRecord":
    from forcefeel.bus import record

    return record(loader, time_s)


def _step_pages(plan: "CommissionPlan") -> "StepWriters":
    """The page and the results of each step, in its folder."""
    from forcefeel.bench.identification.page.page import write_identification
    from forcefeel.choice.page.page import write_choice
    from forcefeel.commission import StepWriters
    from forcefeel.envelope.page.page import write_envelope
    from forcefeel.qualification.page.page import write_qualification

    units = plan.units
    return StepWriters(
        identification=lambda identification, folder: write_identification(identification, folder, units, replace=True),
        law=lambda scores, choice, folder: write_choice(scores, choice, folder, units, replace=True),
        envelope=lambda envelope, folder: write_envelope(envelope, folder, units, replace=True),
        tests=write_qualification,
    )


def _there(out: Path, name: str) -> Path | None:
    return out / name if input_kind(out / name) else None


def law_file(out: Path) -> Path | None:
    """The law that was written, accepted or not."""
    return _there(out, "law.json") or _there(out, "law-rejected.json")


def _show(console: Terminal, commission: "Commission") -> None:
    from forcefeel.commission.findings import commission_conclusions, glance

    table = titled(f"{commission.before.name}, commissioned", "step", "result", "ok")
    for row in glance(commission):
        table.add_row(row.title, row.result, row.ok)
    console.show(table)
    console.conclude(commission_conclusions(commission))
