"""``forcefeel bus``."""

import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, LoaderOptions, LoaderOrProject, OutputOptions, option
from forcefeel.cli.terminal import Output, Terminal, answer, titled
from forcefeel.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from forcefeel.bus import BusCheck, CockpitBusCheck, Finding
    from forcefeel.bus.check import Confirm
    from forcefeel.loader.loader import Loader
    from forcefeel.loader.project import Project

CHECK = Group("Check", sort_key=10)


@dataclass(frozen=True, kw_only=True)
class BusOptions(LoaderOptions, OutputOptions):
    """The options of ``forcefeel bus``."""

    move: Annotated[
        bool,
        option(
            "Test the directions: the motor moves the column by about 1 deg with at most a tenth of its current. Asks a person.",
            CHECK,
        ),
    ] = False
    yes: Annotated[
        bool, option("With --move: the travel is free and the positive direction is known; ask nothing.", CHECK)
    ] = False
    out: Annotated[
        Path | None,
        option(
            "Loader file to write, with the measured controller.delay; of a project one for each axis, such as FILE-pitch.",
            OUTPUT,
            metavar="FILE",
        ),
    ] = None
    replace: Annotated[bool, option("Replace an existing file.", OUTPUT)] = False

    def files(self, axes: "Iterable[str]") -> dict[str, Path]:
        """The loader file of each axis, the empty name being that of one loader.

        Raises:
            InputError: If a file is there, or cannot be written.
        """
        from forcefeel.files import check_output_file

        if (out := self.out) is None:
            return {}
        files = {axis: out.with_stem(f"{out.stem}-{axis}") if axis else out for axis in axes}
        for file in files.values():
            check_output_file(file, replace=self.replace)
        return files


def run(path: LoaderOrProject = None, /, *, options: BusOptions = BusOptions()) -> None:
    """Check a drive on its bus before the first run: nodes, delay and jitter, watchdog, directions, and this computer.

    The loader file's table [bus] names the drive. The check powers the drive without torque and lets its watchdog run out; with
    --move it asks whether the travel is free, moves the column, and asks whether that was its positive direction. Of a project it
    checks the drives of all axes in turn. Exit status 1 if a drive is not ready; the computer's properties are advice.

    Example: forcefeel bus my-yoke.toml --move --out my-yoke-measured.toml
    """
    from forcefeel.bus.check import check_bus
    from forcefeel.bus.cockpit import check_cockpit

    confirm = _confirm(options)
    if project := options.project(path):
        files = options.files(project.loaders)
        cockpit = check_cockpit(project, move=options.move, confirm=confirm)
        axes = cockpit.axes
        written = _written(files, project.loaders, axes, options)
        answer(
            written,
            lambda: {"axes": {axis: asdict(check) for axis, check in axes.items()}, "ok": cockpit.ok},
            lambda terminal: _show_cockpit(terminal, project, cockpit, moved=options.move),
            as_json=options.json,
        )
        ok = cockpit.ok
    else:
        loader = options.loader(path)
        files = options.files([""])
        check = check_bus(loader, move=options.move, confirm=confirm)
        written = _written(files, {"": loader}, {"": check}, options)
        answer(
            {"loader": written.get("")} if written else {},
            lambda: {**asdict(check), "ok": check.ok},
            lambda terminal: _show(terminal, check, moved=options.move),
            as_json=options.json,
        )
        ok = check.ok
    if not ok:
        raise SystemExit(BAD_ANSWER)


def _confirm(options: BusOptions) -> "Confirm | None":
    """Who confirms that the column may move: a person at the terminal, unless the option did.

    Raises:
        InputError: If there is neither.
    """
    if not options.move or options.yes:
        return None
    if not sys.stdin.isatty():
        raise InputError(
            "--move: expected a person at the terminal to confirm the motion; add --yes if the travel is free"
        )
    from rich.prompt import Confirm
    from rich.text import Text

    from forcefeel.printable import visible

    console = Output(stderr=True)

    def ask(question: str) -> bool:
        try:
            return Confirm.ask(Text(visible(question)), console=console, default=False)
        except EOFError:
            return False

    return ask


def _written(
    files: "dict[str, Path]", loaders: "Mapping[str, Loader]", checks: "Mapping[str, BusCheck]", options: BusOptions
) -> "dict[str, Path]":
    """Writes the loader of each axis with its measured delay; one that answers too late, or whose bus is too slow, has none."""
    from forcefeel.bus.check import with_delay
    from forcefeel.files import write_whole

    measured = {axis: file for axis, file in files.items() if checks[axis].load.ok and checks[axis].delay.ok}
    for axis, file in measured.items():
        write_whole(file, with_delay(loaders[axis], checks[axis].delay).to_toml(options.units))
    return measured


def _show(terminal: Terminal, check: "BusCheck", *, moved: bool) -> None:
    table = titled("Nodes", "node", "model", "firmware", "registers", "serial")
    for node in check.nodes:
        table.add_row(str(node.node), str(node.model), hex(node.firmware), str(node.registers), node.serial)
    terminal.show(table)
    terminal.print(
        f"- answers: {check.delay.answers:,} of {check.delay.commands:,}; median, 99 %, worst: {_times(check)}",
        highlight=False,
    )
    _findings(terminal, (_load_finding(check), _delay_finding(check), check.watchdog, *check.directions))
    _advice(terminal, check.host, moved=moved)


def _show_cockpit(terminal: Terminal, project: "Project", cockpit: "CockpitBusCheck", *, moved: bool) -> None:
    table = titled(
        f"{project.name}: the drives of its axes",
        "axis",
        "port",
        "node",
        "serial",
        "median, 99 %, worst",
    )
    for axis, check in cockpit.axes.items():
        bus = project.loaders[axis].bus
        if bus is None:
            continue
        serials = ", ".join(node.serial for node in check.nodes if node.node == bus.node)
        table.add_row(axis, bus.port, str(bus.node), serials, _times(check))
    terminal.show(table, ["serial"])
    for axis, check in cockpit.axes.items():
        findings = (_load_finding(check), _delay_finding(check), check.watchdog, *check.directions)
        _findings(terminal, findings, f"{axis}: ")
    for port, nodes in cockpit.others.items():
        for node in nodes:
            terminal.print(f"- {port}: node {node.node} belongs to no axis", highlight=False)
    _advice(terminal, cockpit.host, moved=moved)


def _load_finding(check: "BusCheck") -> "Finding":
    from forcefeel.bus import Finding

    load = check.load
    time_us, period_us = 1e6 * load.time_s, 1e6 * load.period_s
    stated, remedy = f"{time_us:.0f} us of {period_us:.0f} us a period", ""
    if not load.ok:
        stated += ", expected at most the period"
        remedy = f"set controller.period to {time_us / 1e3:.3g} ms or more, or give axes a port of their own"
    return Finding("bus load", load.ok, stated, remedy)


def _delay_finding(check: "BusCheck") -> "Finding":
    from forcefeel.bus import Finding

    delay = check.delay
    stated, remedy = f"{1e3 * delay.delay_s:g} ms" if delay.answers else "no answer", ""
    if delay.answers and not delay.ok:
        stated += f", expected at most {1e3 * delay.limit_s:g} ms"
        remedy = "set a longer controller.period, or prepare this computer as below"
    return Finding("controller.delay", delay.ok, stated, remedy)


def _times(check: "BusCheck") -> str:
    delay = check.delay
    if not delay.answers:
        return "no answer"
    return ", ".join(f"{1e6 * took:.0f} us" for took in (delay.median_s, delay.p99_s, delay.worst_s))


def _advice(terminal: Terminal, host: "tuple[Finding, ...]", *, moved: bool) -> None:
    if not moved:
        terminal.print("- directions: not tested; add --move with nothing in the column's way", highlight=False)
    terminal.print("This computer:", highlight=False)
    _findings(terminal, host)


def _findings(terminal: Terminal, findings: "Iterable[Finding]", of: str = "") -> None:
    for finding in findings:
        style = None if finding.ok else "bold red"
        remedy = f": {finding.remedy}" if finding.remedy else ""
        terminal.print(f"- {of}{finding.name}: {finding.stated}{remedy}", style=style, highlight=False)
