"""``forcefeel bus``."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, LoaderFile, LoaderOptions, OutputOptions, option
from forcefeel.cli.terminal import Terminal, answer, titled

if TYPE_CHECKING:
    from collections.abc import Iterable

    from forcefeel.bus import BusCheck, Finding

CHECK = Group("Check", sort_key=10)


@dataclass(frozen=True, kw_only=True)
class BusOptions(LoaderOptions, OutputOptions):
    """The options of ``forcefeel bus``."""

    move: Annotated[
        bool,
        option(
            "Test the directions: the motor moves the column by about 1 deg with at most a tenth of its current.", CHECK
        ),
    ] = False
    out: Annotated[
        Path | None, option("Loader file to write, with the measured controller.delay.", OUTPUT, metavar="FILE")
    ] = None
    replace: Annotated[bool, option("Replace an existing file.", OUTPUT)] = False


def run(path: LoaderFile = None, /, *, options: BusOptions = BusOptions()) -> None:
    """Check a drive on its bus before the first run: nodes, delay and jitter, watchdog, directions, and this computer.

    The loader file's table [bus] names the drive. The check powers the drive without torque and lets its watchdog run out; with
    --move it moves the column. Exit status 1 if the drive is not ready; the computer's properties are advice.

    Example: forcefeel bus my-yoke.toml --move --out my-yoke-measured.toml
    """
    from forcefeel.bus.check import check_bus, with_delay
    from forcefeel.files import check_output_file, write_whole

    loader = options.loader(path)
    if options.out is not None:
        check_output_file(options.out, replace=options.replace)
    check = check_bus(loader, move=options.move)
    written: dict[str, Path] = {}
    if options.out is not None and check.delay.answers:
        write_whole(options.out, with_delay(loader, check.delay).to_toml(options.units))
        written = {"loader": options.out}
    answer(
        written,
        lambda: {**asdict(check), "ok": check.ok},
        lambda terminal: _show(terminal, check, moved=options.move),
        as_json=options.json,
    )
    if not check.ok:
        raise SystemExit(BAD_ANSWER)


def _show(terminal: Terminal, check: "BusCheck", *, moved: bool) -> None:
    table = titled("Nodes", "node", "model", "firmware", "registers", "serial")
    for node in check.nodes:
        table.add_row(str(node.node), str(node.model), hex(node.firmware), str(node.registers), node.serial)
    terminal.show(table)
    delay = check.delay
    times = (
        ", ".join(f"{1e6 * took:.0f} us" for took in (delay.median_s, delay.p99_s, delay.worst_s))
        if delay.answers
        else ""
    )
    terminal.print(f"- answers: {delay.answers:,} of {delay.commands:,}; median, 99 %, worst: {times}", highlight=False)
    terminal.print(f"- controller.delay: {1e3 * delay.delay_s:g} ms", highlight=False)
    _findings(terminal, (check.watchdog, *check.directions))
    if not moved:
        terminal.print("- directions: not tested; add --move with nothing in the column's way", highlight=False)
    terminal.print("This computer:", highlight=False)
    _findings(terminal, check.host)


def _findings(terminal: Terminal, findings: "Iterable[Finding]") -> None:
    for finding in findings:
        style = None if finding.ok else "bold red"
        remedy = f": {finding.remedy}" if finding.remedy else ""
        terminal.print(f"- {finding.name}: {finding.stated}{remedy}", style=style, highlight=False)
