"""``forcefeel export``."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from forcefeel.cli.each_axis import each_axis
from forcefeel.cli.options import OUTPUT, FolderOptions, JsonOptions, LawOption, LoaderOptions, LoaderOrProject, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.release_options import ASKED
from forcefeel.cli.terminal import Terminal, answer
from forcefeel.errors import InputError

if TYPE_CHECKING:
    from forcefeel.export import Exported
    from forcefeel.loader.project import Project


@dataclass(frozen=True, kw_only=True)
class ExportOptions(LoaderOptions, FolderOptions, JsonOptions):
    """The options of ``forcefeel export``."""

    to: Annotated[
        Literal["c", "firmware", "fmu", "matlab", "openffboard", "st", "table"],
        option(
            "Target. c: law and feel as C99. firmware: law, feel and supervisor as a static library. fmu: loader, law and "
            "machine as FMI 2.0 and 3.0. matlab: matrices and scripts that close the loop in Python, MATLAB or Octave. "
            "openffboard: spring, damper, inertia and friction as commands of that firmware. "
            "st: law and feel as Structured Text of IEC 61131-3. "
            "table: settings of a drive with their CoE objects, parameters and observer, as CSV.",
            ASKED,
        ),
    ]
    law: LawOption = None
    knots: Annotated[
        Path | None,
        option(
            "CSV of settings, as for forcefeel schedule, with a law for each. Default: the loader's own setting.",
            ASKED,
            metavar="FILE",
        ),
    ] = None
    name: Annotated[str, option("Prefix of file names and of the names in them, a C identifier.", ASKED)] = "loader"
    single: Annotated[bool, option("With --to c or firmware: single precision (float).", ASKED)] = False
    measure: Annotated[
        bool,
        option(
            "With --to c: measure stack and instructions of a step on each installed target, and state them in README and header.",
            ASKED,
        ),
    ] = False
    linked: Annotated[
        bool,
        option(
            "With --to c: the law takes force, spring and damping beside the feel, as an electronic link of a project gives them.",
            ASKED,
        ),
    ] = False
    supervisor: Annotated[
        bool,
        option("With --to c: also write law, feel and supervisor as one step.", ASKED),
    ] = False
    tunable: Annotated[
        tuple[str, ...],
        option(
            "With --to c: a row of the feel that the program may tune, and its range, else the parameter table's. Repeatable.",
            ASKED,
            metavar="PART.NAME[=LOW..HIGH UNIT]",
        ),
    ] = ()
    target: Annotated[
        str | None,
        option(
            "With --to firmware: the Rust target, such as thumbv7em-none-eabihf. Default: this machine.",
            ASKED,
            metavar="TRIPLE",
        ),
    ] = None
    board: Annotated[
        Literal["stm32f405"] | None,
        option(
            "With --to firmware: a whole project for this board, in single precision: start, interrupt, watchdog, telemetry.",
            ASKED,
        ),
    ] = None
    out: Annotated[Path, option("Folder for the exported files.", OUTPUT)] = Path("forcefeel-export")

    def exported(self, path: Path | None) -> "Exported":
        """The law with its loader.

        Raises:
            InputError: If an option, the loader or the law is bad, or the two do not go together.
        """
        from forcefeel.export import Exported
        from forcefeel.export.openffboard import check_board_loader
        from forcefeel.flight_schedule import read_knots

        loader = self.loader(path)
        if self.to == "openffboard":
            check_board_loader(loader)
        feel = None if self.knots is None else read_knots(self.knots).feel
        try:
            exported = Exported.of(self.law, loader, self.name, feel, tunable=self.tunable)
            return replace(exported, linked=self.linked, supervised=self.supervisor)
        except InputError as error:
            raise _spelled(error) from error


def _spelled(error: InputError) -> InputError:
    """What is wrong, told by the option that says it."""
    text = str(error)
    for argument, option_name in (
        ("law: ", "--law: "),
        ("tunable: ", "--tunable: "),
        ("supervisor: ", "--supervisor: "),
        ("name: ", "--name: "),
        ("target: ", "--target: "),
        ("to: ", "--to: "),
    ):
        if text.startswith(argument):
            return InputError(option_name + text.removeprefix(argument))
    return error


def _of_axis(project: "Project", options: ExportOptions, axis: str) -> ExportOptions:
    """The options with names of the axis, so that the code of several axes goes into one program."""
    own = axis.replace("-first-officer", "-2").replace("-", "_")
    links = [link for link in project.links.values() if axis in link.between]
    electronic = any(link.kind == "electronic" for link in links)
    if electronic and options.tunable:
        raise InputError(
            f"--tunable: axis {axis} is linked, and the code of a link has fixed feels; export the axis alone, or leave it out"
        )
    return replace(options, name=f"{options.name}_{own}", linked=options.to == "c" and (options.linked or electronic))


def _of_links(project: "Project", options: ExportOptions) -> dict[str, Any]:
    """Writes the code of the links of a project."""
    from forcefeel.export import PairExport, write_pair

    if options.to != "c":
        return {}
    results = {}
    for link in project.links.values():
        own = {axis: _of_axis(project, options, axis) for axis in link.between}
        first, second = (own[axis].exported(project.paths[axis]) for axis in link.between)
        pair = PairExport.of(project, link, options.name, (first, second))
        out = options.out / f"{link.name}-link"
        with all_or_nothing("export", silent=options.json) as bar:
            bar.describe(f"link {link.name}")
            files = write_pair(pair, out, replace=options.replace, single=options.single)
        if not options.json:
            print(f"\n{link.name}-link\n{link.kind} link of {' and '.join(link.between)}")
            print(*(f"- {name}" for name in files), f"folder: {out}", sep="\n")
        results[link.name] = {"folder": str(out), "files": list(files)}
    return results


@each_axis(of_axis=_of_axis, of_links=_of_links)
def run(path: LoaderOrProject = None, /, *, options: ExportOptions) -> None:
    """Export a law as C, firmware, FMU, matrices, Structured Text or a table, with test vectors that prove equal results.

    --to openffboard exports the feel alone.

    Example: forcefeel export elevator-2khz --law robust --to matlab --name pitch --out pitch
    """
    from forcefeel.export import Target, export_folder, write_export

    if options.single and options.to not in {"c", "firmware"}:
        raise InputError(f"--single: is for --to c and firmware, and --to is {options.to}; leave it out")
    if options.measure and options.to != "c":
        raise InputError(f"--measure: is for --to c, and --to is {options.to}; leave it out")
    if options.linked and options.to != "c":
        raise InputError(f"--linked: is for --to c, and --to is {options.to}; leave it out")
    if options.tunable and options.to != "c":
        raise InputError(f"--tunable: is for --to c, and --to is {options.to}; leave it out")
    if options.supervisor and options.to != "c":
        raise InputError(f"--supervisor: is for --to c, and --to is {options.to}; leave it out")
    if options.target is not None and options.to != "firmware":
        raise InputError(f"--target: is for --to firmware, and --to is {options.to}; leave it out")
    if options.board is not None and options.to != "firmware":
        raise InputError(f"--board: is for --to firmware, and --to is {options.to}; leave it out")
    if options.board is not None and options.target is not None:
        raise InputError(f"--board: has its own target, and --target is {options.target}; leave one of them out")
    target, triple = Target(options.to), options.board or options.target
    folder = export_folder(target, options.name, triple=triple, supervised=options.supervisor)
    folder.check(options.out, replace=options.replace)
    with all_or_nothing("export", silent=options.json) as bar:
        bar.describe("law")
        exported = options.exported(path)
        bar.describe(f"files for {target}")
        try:
            files = write_export(
                exported,
                target,
                options.out,
                replace=options.replace,
                single=options.single or options.board is not None,
                measure=options.measure,
                triple=triple,
            )
        except InputError as error:
            raise _spelled(error) from error
    answer(
        {"folder": options.out},
        lambda: {
            "files": list(files),
            "law": exported.law.name,
            "loader": exported.loader.name,
            **_settings(exported, options.to),
        },
        lambda terminal: _show(terminal, exported, options, list(files)),
        as_json=options.json,
    )


def _settings(exported: "Exported", target: str) -> dict[str, Any]:
    from forcefeel.export.openffboard import BoardFeel

    lost = {"not_rendered": list(BoardFeel.of(exported).lost())} if target == "openffboard" else {}
    return {"settings": len(exported.settings), "loader_sha256": exported.loader.fingerprint, **lost}


def _show(console: Terminal, exported: "Exported", options: ExportOptions, files: list[str]) -> None:
    from forcefeel.export.firmware_board import BOARD_TARGET
    from forcefeel.export.firmware_library import library_origin, target_of
    from forcefeel.export.fmu_files import libraries
    from forcefeel.export.openffboard import BoardFeel

    law, loader, settings = exported.law, exported.loader, len(exported.settings)
    time = f"every {law.period_s * 1e3:.6g} ms" if law.period_s else "in continuous time"
    console.print(f"{law.name} for {loader.name}, {time}", style="bold", highlight=False)
    console.print(f"loader {loader.fingerprint[:12]}, settings of the feel: {settings}", highlight=False)
    for name in files:
        console.print(f"- {name}", highlight=False)
    if options.to == "fmu":
        names = ", ".join(platform.name for platform in libraries())
        console.print(f"Libraries for {names}.", highlight=False)
    if options.to == "firmware":
        triple = BOARD_TARGET if options.board else target_of(options.target)
        console.print(library_origin(triple, single=options.single or options.board is not None), highlight=False)
    if options.to == "openffboard":
        console.print("The feel alone; not rendered:", highlight=False)
        for line in BoardFeel.of(exported).lost():
            console.print(f"- {line}", highlight=False)
