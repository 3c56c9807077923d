"""``forcefeel analyze``."""

from dataclasses import dataclass

from forcefeel.cli.each_axis import each_axis
from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.options import LoaderOptions, LoaderOrProject, OutputOptions
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.terminal import Terminal, print_json
from forcefeel.json_values import json_value


@dataclass(frozen=True, kw_only=True)
class AnalyzeOptions(LoaderOptions, OutputOptions):
    """The options of ``forcefeel analyze``."""


@each_axis()
def run(path: LoaderOrProject = None, /, *, options: AnalyzeOptions = AnalyzeOptions()) -> None:
    """Analyze the loader without a law: modes, margins, stability, response.

    With a valve this is the original position loop, with a motor the feel by current only.

    Exit status 1 if the loader is unstable at the programmed setting (compliant link).

    Example: forcefeel analyze my.toml --json > analysis.json
    """
    from forcefeel.cli import show, show_motor
    from forcefeel.design import workflow
    from forcefeel.design.motor import MotorAnalysis

    with all_or_nothing("analyze", silent=options.json):
        analysis = workflow.analyze(options.loader(path))
    if options.json:
        print_json(json_value(analysis, options.units))
    elif isinstance(analysis, MotorAnalysis):
        show_motor.motor_analysis(Terminal(), analysis, options.units)
    else:
        show.analysis(Terminal(), analysis, options.units)
    if not analysis.configuration("compliant").programmed.assessment.stable:
        raise SystemExit(BAD_ANSWER)
