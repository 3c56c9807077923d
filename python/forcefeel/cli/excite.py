"""``forcefeel excite``."""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Group

from forcefeel.cli.each_axis import each_axis
from forcefeel.cli.exit_status import BAD_ANSWER
from forcefeel.cli.law_option import ORIGINAL, chosen_law
from forcefeel.cli.options import OUTPUT, BenchLawOption, LoaderOptions, LoaderOrProject, OutputOptions, filled, option
from forcefeel.cli.progress import all_or_nothing
from forcefeel.cli.scenario_text import value
from forcefeel.cli.terminal import Terminal, answer, titled
from forcefeel.errors import InputError
from forcefeel.units import UnitSystem

if TYPE_CHECKING:
    from forcefeel.bench.excitation import Excitation, ExcitationPlan
    from forcefeel.bench.experiments import Drive, Experiment
    from forcefeel.laws.law import Law
    from forcefeel.loader.loader import Loader

_EXAMPLES = {
    "valve_current": "12 mA",
    "motor_current": "12 A",
    "motor_voltage": "40 V",
    "motor_speed": "600 deg/s",
    "column_angle": "8 deg",
    "load_cell_force": "1500 lb",
    "test_signal": "5 V",
    "command_signal": "5 V",
    "test_current": "5 A",
    "command_current": "5 A",
    "pilot_force": "50 lb",
}


ASKED = Group("Request", sort_key=10)
SIGNAL = Group("Signal", sort_key=20)
LIMITS = Group("Limits", sort_key=30)
MACHINE = Group("Machine", sort_key=40)


@dataclass(frozen=True, kw_only=True)
class ExciteOptions(LoaderOptions, OutputOptions):
    """The options of ``forcefeel excite``."""

    fit: Annotated[
        str,
        option(
            "Parameters to determine, by symbol or part.name: k,c,J,C_i; for a motor K_t,J_m,k,c,J.",
            ASKED,
            metavar="PARAMETERS",
        ),
    ]
    experiment: Annotated[
        str | None,
        option(
            "Loop and drive: servo-open, servo-closed (test signal at the amplifier), loader (force at the grip). Other "
            "drives: 'loader test_signal', or 'servo-closed command_signal' if the controller adds the signal to its "
            "command. Motors: motor-open (current only), 'loader test_current', 'loader command_current'.",
            ASKED,
            default="servo-closed; 'loader command_current' for an electric loader",
            metavar="EXPERIMENT",
        ),
    ] = None
    measure: Annotated[
        str | None,
        option(
            "Recorded channels.",
            ASKED,
            default="column_angle,piston_position,load_pressure; for an electric loader "
            "column_angle,drive_position,load_cell_force,motor_current",
            metavar="CHANNELS",
        ),
    ] = None
    noise: Annotated[
        tuple[str, ...],
        option(
            "White noise: a share of each channel's r.m.s. for equal lines at the limits, or of one channel, such as "
            "'column_angle=0.01 deg'. Repeatable.",
            ASKED,
            default="1 %",
            metavar="[CHANNEL=]NOISE",
        ),
    ] = ()
    signal: Annotated[Literal["multisine", "chirp"], option("Kind of signal.", SIGNAL)] = "multisine"
    time_s: Annotated[float, option("Length of the signal, s: six periods or more.", SIGNAL, "--time")] = 60.0
    rate_hz: Annotated[
        float, option("Sample rate, 1/s: four per cycle of the highest line or more.", SIGNAL, "--rate")
    ] = 1000.0
    from_hz: Annotated[
        float | None,
        option("Lowest frequency, Hz.", SIGNAL, "--from", default="one cycle per period; 4 Hz for motor-open"),
    ] = None
    to_hz: Annotated[
        float | None,
        option(
            "Highest frequency, Hz.",
            SIGNAL,
            "--to",
            default="the valve's natural frequency or the current loop's bandwidth, or a quarter of the rate",
        ),
    ] = None
    limit_current: Annotated[
        str | None,
        option(
            "Largest current of valve or motor.",
            LIMITS,
            default="80 % of the amplifier's limit or the valve's rating",
            metavar="CURRENT",
        ),
    ] = None
    limit_voltage: Annotated[
        str | None,
        option("Largest voltage of a motor.", LIMITS, default="80 % of its limit", metavar="VOLTAGE"),
    ] = None
    limit_speed: Annotated[
        str | None,
        option("Largest speed of a motor.", LIMITS, default="80 % of its no-load speed", metavar="SPEED"),
    ] = None
    limit_travel: Annotated[
        str | None,
        option("Largest column angle.", LIMITS, default="10 deg, or 80 % of the angle to an end stop", metavar="ANGLE"),
    ] = None
    limit_force: Annotated[
        str | None,
        option(
            "Largest force at the load cell.",
            LIMITS,
            default="two thirds of supply pressure times piston area; 80 % of what the motor's largest current holds",
            metavar="FORCE",
        ),
    ] = None
    limit_drive: Annotated[
        str | None,
        option(
            "Largest test signal, current or force at the grip.",
            LIMITS,
            default="10 V or the controller's range, 80 % of the motor's largest current; pilot.force",
            metavar="VALUE",
        ),
    ] = None
    law: BenchLawOption = None
    machine: Annotated[
        Literal["bus"] | None,
        option(
            "Play the signal on the drive of the file's table [bus], and write what its sensors show: the motor moves the column. "
            "For motor-open at the controller's rate.",
            MACHINE,
            default="none: the file has the signal alone",
        ),
    ] = None
    out: Annotated[Path, option("CSV file for the bench.", OUTPUT)] = Path("forcefeel-excite.csv")
    replace: Annotated[bool, option("Replace an existing file.", OUTPUT)] = False

    def fixed_law(self, loader: "Loader", experiment: "Experiment") -> "Law | None":
        """The law of the whole loader; ``None`` for ``bench_law``.

        Raises:
            InputError: If it is of no use to this experiment or cannot be designed.
        """
        from forcefeel.bench.experiments import Loop
        from forcefeel.loader.parameters import HYDRAULIC

        if self.law is None or (self.law == ORIGINAL and loader.drive == HYDRAULIC):
            return None
        if experiment.loop is not Loop.LOADER:  # first: what its design lacks is no matter then
            raise InputError(
                f"--law: is the law of the whole loader, and {experiment} is of the servo alone; leave it out"
            )
        return chosen_law(self.law, loader)

    def plan(self, drive: "Drive", loader: "Loader") -> "ExcitationPlan":
        """What is wanted of a loader under that drive of the bench, SI units.

        Raises:
            InputError: If an option is bad.
        """
        from forcefeel.bench.channels import channel
        from forcefeel.bench.excitation import ExcitationPlan

        share, noise = _noise(self.noise)
        given: dict[str, Any] = {} if share is None else {"noise_share": share}
        if self.measure is not None:
            given["measured"] = tuple(map(channel, self.measure.split(",")))
        limits = {
            "current": self.limit_current,
            "voltage": self.limit_voltage,
            "speed": self.limit_speed,
            "travel": self.limit_travel,
            "force": self.limit_force,
            "drive": self.limit_drive,
        }
        limits_si = {name: _limit(name, text, drive, loader) for name, text in limits.items() if text is not None}
        return filled(ExcitationPlan, self, noise=noise, limits=limits_si, **given)


@each_axis()
def run(path: LoaderOrProject = None, /, *, options: ExciteOptions) -> None:
    """Design the bench signal that determines the chosen parameters best within the limits of the loader.

    Writes a CSV file for the bench. forcefeel identify reads it once the measured columns are added; with --machine bus the drive
    plays the signal and adds them. Exit status 1 if the experiment cannot separate the parameters (no file is written) or does
    not determine one.

    Example: forcefeel excite elevator-2khz --fit k,c,J,C_i --time 60 --rate 1000 --out excite.csv
    """
    from forcefeel.bench.excitation import NotSeparableError, excite, write_excitation
    from forcefeel.bench.excitation.as_json import excitation_json
    from forcefeel.bench.excitation.bench_file import check_excitation_file
    from forcefeel.bench.excitation.excite import USUAL
    from forcefeel.bench.experiments import Experiment, check_experiment
    from forcefeel.bench.record_csv import record_csv
    from forcefeel.bus.bench_record import play
    from forcefeel.files import write_whole

    check_excitation_file(options.out, replace=options.replace)  # before the work, not after it
    given = None if options.experiment is None else Experiment.read(options.experiment)
    loader = options.loader(path)
    experiment = given or Experiment.read(USUAL[loader.drive])
    check_experiment(experiment, loader, "--experiment")
    with all_or_nothing("excite", silent=options.json) as bar:
        bar.describe("law")
        law = options.fixed_law(loader, experiment)
        plan = options.plan(experiment.drive, loader)
        try:
            excitation = excite(loader, options.fit, experiment, plan, law, progress=bar.describe)
        except NotSeparableError as error:
            bar.stop()
            print(f"forcefeel: {error}", file=sys.stderr)
            raise SystemExit(BAD_ANSWER) from None
        bar.describe("file")
        if options.machine is None:
            write_excitation(excitation, options.out, options.units, replace=options.replace)
        else:
            bar.describe("record")
            write_whole(options.out, record_csv(play(excitation)))
    answer(
        {"file": options.out},
        lambda: excitation_json(excitation, options.units),
        lambda terminal: _show(terminal, excitation, options.units),
        as_json=options.json,
    )
    if excitation.vague:
        raise SystemExit(BAD_ANSWER)


def _noise(given: tuple[str, ...]) -> tuple[float | None, dict[str, float]]:
    """The share of all channels, if it is given, and the noise of single ones, SI units."""
    from forcefeel.bench.channels import CHANNELS, channel

    share, single = None, {}
    for text in given:
        name, equals, noise = text.rpartition("=")
        if not equals:
            if share is not None:
                raise InputError(f"--noise: expected one share for all channels, got another, {text!r}; leave one out")
            share = value("--noise", text.strip(), "", "1 %")
        else:
            single[channel(name)] = value("--noise", noise.strip(), CHANNELS[channel(name)], "0.01 deg")
    return share, single


def _limit(name: str, given: str, drive: "Drive", loader: "Loader") -> float:
    from forcefeel.bench.channels import CHANNELS
    from forcefeel.bench.excitation.limits import KINDS
    from forcefeel.loader.parameters import ELECTRIC

    channel = {**KINDS[ELECTRIC], **KINDS[loader.drive]}.get(name, str(drive))
    return value(f"--limit-{name}", given.strip(), CHANNELS[channel], _EXAMPLES[channel])


def _show(console: Terminal, excitation: "Excitation", units: UnitSystem) -> None:
    from forcefeel.bench.identification.digits import percent
    from forcefeel.loader.parameters import TABLE, with_unit

    parameters = titled("Predicted standard errors", "parameter", numbers=("symbol", "value", "standard error"))
    for key, error in excitation.standard_errors.items():
        parameters.add_row(
            key, TABLE[key].symbol, with_unit(TABLE[key], excitation.loader[key], units, 4), percent(error)
        )
    limits = titled("Peaks on the loader", "limit", numbers=("peak", "limit", "used"))
    limits.add_column("where from")
    for use in excitation.uses:
        limit = use.limit
        limits.add_row(
            limit.channel.replace("_", " "),
            limit.text(use.peak, units),
            limit.text(limit.value, units),
            f"{use.share:.0%}",
            limit.reason,
        )
    console.print(f"{excitation.experiment}: {excitation.words}", highlight=False)
    console.show(parameters)
    console.show(limits)
    console.print(excitation.verdict, style="bold red" if excitation.vague else "bold", highlight=False)
    for finding in excitation.findings(units):
        console.print(f"- {finding}", highlight=False)
