"""``forcefeel reproduce``."""

from dataclasses import dataclass
from typing import Annotated

from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import OUTPUT, OutputOptions, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.json_values import json_value


@dataclass(frozen=True, kw_only=True)
class ReproduceOptions(OutputOptions):
    """The options of ``forcefeel reproduce``."""

    markdown: Annotated[bool, option("Print the table as Markdown.", OUTPUT)] = False


def run(*, options: ReproduceOptions = ReproduceOptions()) -> None:
    """Compare the numbers and claims of the 1974 report with the models.

    Exit status 1 if a number differs without a known reason.

    Example: forcefeel reproduce
    """
    from forcefeel.cli import show
    from forcefeel.design import workflow
    from forcefeel.reproduction import Verdict, markdown, reproduce

    with all_or_nothing("reproduce", "steps", silent=options.json, even=False) as bar:
        sections = reproduce(bar.steps(len(workflow.STEPS)))
    if options.json:
        print_json(json_value(sections, options.units))
    elif options.markdown:
        print(markdown(sections), end="")
    else:
        show.reproduction(Terminal(), sections)
    if any(row.verdict is Verdict.OPEN for section in sections for row in section.rows):
        raise SystemExit(BAD_ANSWER)
