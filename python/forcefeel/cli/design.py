"""``forcefeel design``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, FolderOptions, LoaderFile, LoaderOptions, OutputOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.recursion_options import RecursionOptions
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.json_values import json_value


@dataclass(frozen=True, kw_only=True)
class DesignOptions(LoaderOptions, RecursionOptions, FolderOptions, OutputOptions):
    """The options of ``forcefeel design``."""

    out: Annotated[Path, option("Folder for report.html, results.json and the responses.", OUTPUT)] = Path(
        "forcefeel-report"
    )


def run(path: LoaderFile = None, /, *, options: DesignOptions = DesignOptions()) -> None:
    """Analyse a loader, compensate it, and write the report.

    Exit status 1 if the compensated loader is unstable at the programmed setting.

    Example: forcefeel design my.toml --out report
    """
    from forcefeel.design import workflow
    from forcefeel.design.findings import conclusions
    from forcefeel.design.page import FOLDER, write_report

    loader = options.loader(path)
    FOLDER.check(options.out, replace=options.replace)  # before the work, not after it
    settings = options.settings(loader)
    with all_or_nothing("design", "steps", silent=options.json) as bar:
        found = workflow.design_loader(loader, settings, bar.steps(len(workflow.STEPS) + 1))
        bar.describe("report")
        page = write_report(found, options.out, options.units, command=options.command_line(path))
    if options.json:
        print_json({"report": str(page), "design": json_value(found, options.units)})
    else:
        Terminal().conclude(conclusions(found, options.units))
        print(f"report: {page}")
    if not found.acceptable:
        raise SystemExit(BAD_ANSWER)
