"""``forcefeel design``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, FolderOptions, LoaderFile, LoaderOptions, OutputOptions, option, page_folder
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.recursion_options import RecursionOptions
from forcefeel.cli.terminal import answer
from forcefeel.json_values import json_value

_FOLDER = Path("forcefeel-report")


@dataclass(frozen=True, kw_only=True)
class DesignOptions(LoaderOptions, RecursionOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel design``."""

    out: Annotated[
        Path | None, option("Folder for report.html, results.json and the responses.", OUTPUT, default=str(_FOLDER))
    ] = None


def run(path: LoaderFile = None, /, *, options: DesignOptions = DesignOptions()) -> None:
    """Analyze a loader, design its law, and write the report.

    With a digital controller the newer laws are compared too, and the report shows the best one beside the 1974 gains. For an
    electric loader it shows the best law only: the 1974 gains, and the options of recursion (22), require a valve.

    Exit status 1 if no law is eligible, or an analog loader is unstable with the 1974 gains at the programmed setting.

    Example: forcefeel design elevator-2khz --out report
    """
    from forcefeel.choice import best_law, quick_choice
    from forcefeel.design import workflow
    from forcefeel.design.findings import conclusions
    from forcefeel.design.motor_design import design_motor
    from forcefeel.laws.law import ROBUST
    from forcefeel.loader.parameters import ELECTRIC

    loader, units = options.loader(path), options.units
    if (out := page_folder(options.out, _FOLDER)) is not None:
        from forcefeel.design.page.page import FOLDER, write_report

        FOLDER.check(out, replace=options.replace)  # before the work, not after it
    electric, digital = loader.drive == ELECTRIC, bool(loader["controller.period"])
    settings = None if electric else options.settings(loader)
    if electric:
        options.check_none(loader)
    called = (str(path or loader.name), *(word for change in options.set_ for word in ("--set", change)))
    with all_or_nothing("design", "steps", silent=options.json, even=False) as bar:
        own, of_laws = (() if electric else workflow.STEPS), (quick_choice.STEPS if digital else ())
        begin = bar.steps(len(own) + len(of_laws) + 1)
        servo = None if electric else workflow.design_servo(loader, settings, begin)
        tried = best_law(loader, units=units, called=called, progress=begin) if digital else None
        best = tried.best if tried else None
        design = servo or design_motor(loader, best.name if best else ROBUST)
        files = {}
        if out is not None:
            bar.describe("report")
            files["report"] = write_report(design, out, units, tried, command=options.command_line(path))
    concluded = conclusions(design, units, tried)
    answer(
        files,
        lambda: {"design": json_value(design, units), "laws": json_value(tried, units)},
        lambda terminal: terminal.conclude(concluded),
        as_json=options.json,
    )
    if not concluded.ok:
        raise SystemExit(BAD_ANSWER)
