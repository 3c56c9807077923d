"""The options that describe what is done to a loader, and which law drives it: the same for every command that simulates.

A command asks, in this order, ``nominal = options.loader(path)``, ``options.scenario(nominal)`` and ``options.law_of(nominal)``.
"""

from dataclasses import dataclass, replace
from math import floor, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Group

from forcefeel.cli.bench_data import options_named
from forcefeel.cli.law_option import chosen_law
from forcefeel.cli.options import LOADER, RARE, LawOption, LoaderOptions, option
from forcefeel.cli.scenario_inputs import DURATION_S, OPTIONS, InputKind, InputOptions, Spacing
from forcefeel.cli.scenario_text import assignments, over_time, seconds
from forcefeel.errors import InputError
from forcefeel.loader.arms import ARM_ROWS, ARMS, Arm
from forcefeel.tables.column_names import ColumnNames
from forcefeel.units import show

if TYPE_CHECKING:
    from forcefeel.laws.law import Law
    from forcefeel.loader.loader import Loader
    from forcefeel.simulation import FeelChange, Scenario
    from forcefeel.simulation.inputs import Flight, Recorded, Schedule


STEP_S, SAMPLE_S, FADE_S = 1e-3, 1e-3, 0.5

MOST_STEPS = 2_000_000
"""Longest run: a history of 160 MB with all samples kept."""

ROUNDING = 1e-6
"""Of a sample; a recording that ends so little before a sample covers it."""


INPUT = Group("Pilot's input", sort_key=10)
SCENARIO = Group("Scenario", sort_key=20)


@dataclass(frozen=True, kw_only=True)
class ScenarioOptions(LoaderOptions):
    """The options as given; ``None`` is not given. Values with units are text."""

    input: Annotated[InputKind | None, option("Pilot's input.", INPUT, default="step")] = None
    force: Annotated[
        str | None,
        option("Largest force, such as '20 lb'.", INPUT, default="pilot.force of the loader", metavar="FORCE"),
    ] = None
    start: Annotated[
        str | None,
        option(
            "Start of the input; for a release, the time at which the grip is released.",
            INPUT,
            default="0.1 s; release 0 s",
            metavar="TIME",
        ),
    ] = None
    width: Annotated[
        str | None, option("Length of a pulse or of each half of a doublet.", RARE, default="0.5 s", metavar="TIME")
    ] = None
    angle: Annotated[
        str | None, option("Release: angle from which the grip is released, such as '10 deg'.", INPUT, metavar="ANGLE")
    ] = None
    input_duration: Annotated[
        str | None,
        option(
            "Length of a stop-to-stop sweep or a chirp; period of a multisine.",
            RARE,
            default="the whole run",
            metavar="TIME",
        ),
    ] = None
    from_: Annotated[
        str | None,
        option(
            "First frequency of a chirp, or lowest of a multisine.",
            INPUT,
            "--from",
            default="0.2 Hz",
            metavar="FREQUENCY",
        ),
    ] = None
    to: Annotated[
        str | None,
        option("Last frequency of a chirp, or highest of a multisine.", INPUT, default="20 Hz", metavar="FREQUENCY"),
    ] = None
    spacing: Annotated[Spacing | None, option("Frequency of a chirp over time.", RARE, default="linear")] = None
    lines: Annotated[
        str | None,
        option(
            "Frequencies of a multisine, such as '0.5 Hz, 1.5 Hz'.",
            RARE,
            default="all multiples of 1/period in the band",
            metavar="FREQUENCIES",
        ),
    ] = None
    record: Annotated[
        Path | None,
        option(
            "Recorded force (CSV, Parquet, MATLAB), with columns such as 'time (s),force (lb)'. The run starts at its "
            "first point.",
            INPUT,
            metavar="FILE",
        ),
    ] = None
    column: Annotated[
        tuple[str, ...],
        option(
            "Column of the file of --record, such as 'force=F1'. Repeatable.",
            RARE,
            metavar="NAME=NAME",
        ),
    ] = ()
    unit: Annotated[
        tuple[str, ...],
        option("Unit of a column without one in its header, such as 'F1=lb'. Repeatable.", RARE, metavar="NAME=UNIT"),
    ] = ()
    duration: Annotated[
        str | None,
        option(
            "Length of the run.",
            SCENARIO,
            default="2 s; stop-to-stop 100 s, chirp 20 s, multisine 10 s, recordings their full length",
            metavar="TIME",
        ),
    ] = None
    trim: Annotated[
        str | None,
        option(
            "Commanded neutral over time, such as '0 s: 0 deg, 1 s: 5 deg', joined by straight lines. Two points at one "
            "time make a step.",
            RARE,
            metavar="OVER_TIME",
        ),
    ] = None
    dynamic_pressure: Annotated[
        str | None,
        option(
            "Dynamic pressure over time, as for --trim, or one value such as '5 kPa'; for a loader with "
            "feel.stiffness_factor.",
            SCENARIO,
            metavar="OVER_TIME",
        ),
    ] = None
    flight: Annotated[
        Path | None,
        option(
            "Flight over time (CSV, Parquet, MATLAB), with columns such as 'time (s),dynamic pressure (Pa),true airspeed "
            "(m/s)'; for a loader with a surface.",
            SCENARIO,
            metavar="FILE",
        ),
    ] = None
    shaker: Annotated[
        str | None,
        option(
            "Amplitude of the stick shaker over time, 0 to 1, such as '1 s: 0, 1 s: 1'; for a loader with "
            "feel.shaker_force.",
            RARE,
            metavar="OVER_TIME",
        ),
    ] = None
    change: Annotated[
        tuple[str, ...],
        option(
            "Change of the feel, such as '1 s: feel.stiffness=5000 lb in/rad, feel.damping=200 lb in s/rad'. Repeatable.",
            SCENARIO,
            metavar="CHANGE",
        ),
    ] = ()
    fade_time: Annotated[str | None, option("Duration of each --change.", RARE, default="0.5 s", metavar="TIME")] = None
    step: Annotated[
        str | None,
        option(
            "Longest step of the engine. With a digital controller the step divides its period.",
            RARE,
            default="1 ms",
            metavar="TIME",
        ),
    ] = None
    sample: Annotated[
        str | None, option("Sample interval of the result.", RARE, default="about 1 ms", metavar="TIME")
    ] = None
    seed: Annotated[int, option("Seed of all random numbers.", RARE)] = 0
    arm: Annotated[
        Arm | None,
        option(
            "Pilot's arm at the grip: loose (1 kg, 10 N s/m, 50 N/m), firm (two hands, 3 kg, 40 N s/m, 1000 N/m; "
            "unverified), or hands-off.",
            LOADER,
            default="the loader's",
        ),
    ] = None
    law: LawOption = None

    def changed(self, loader: "Loader") -> "Loader":
        """``loader`` with ``--set`` and ``--arm``; the other methods ask for this one.

        Raises:
            InputError: If a value is bad.
        """
        return self.armed("--arm", super().changed(loader), self.arm)

    def armed(self, option: str, loader: "Loader", arm: Arm | None) -> "Loader":
        """``loader`` with an arm at its grip; as it is without one.

        Raises:
            InputError: If ``--set`` sets an arm's rows too.
        """
        if arm is None:
            return loader
        changes = assignments("--set", self.set_)
        for row in ARM_ROWS:
            if row in changes:
                raise InputError(f"{option}: sets {row}, and so does --set; leave one out")
        return loader.replace(dict(zip(ARM_ROWS, ARMS[arm], strict=True)), si=True)

    def law_of(self, loader: "Loader") -> "Law":
        """The law, designed for ``loader`` or read from its file.

        Raises:
            InputError: If it cannot be designed or read, or is for another controller.
        """
        return chosen_law(self.law, loader)

    def scenario(self, loader: "Loader") -> "Scenario":
        """What is done to ``loader``.

        Raises:
            InputError: If an option is bad, missing, or does not go with another or with the loader.
        """
        recorded = self._recorded()
        bare = self._bare(loader)
        grid_s = _grid(bare, loader)
        bare = replace(bare, sample_s=self._sample(grid_s))
        bare = replace(bare, duration_s=self._duration(recorded, bare.sample_s))
        if bare.duration_s > MOST_STEPS * grid_s * (1 + ROUNDING):
            raise InputError(
                f"--duration: expected at most {MOST_STEPS} steps of {grid_s:g} s, {MOST_STEPS * grid_s:g} s, got "
                f"{bare.duration_s:g} s; take a larger --step, or a shorter run"
            )
        if recorded is not None:
            return replace(bare, force=recorded)
        kind = self.input or InputKind.STEP
        options = InputOptions(kind, self._input_options(), loader["pilot.force"], bare.duration_s, grid_s)
        return replace(bare, force=options.build())

    def _bare(self, loader: "Loader") -> "Scenario":
        """The scenario without the pilot."""
        from forcefeel.simulation import Scenario

        return Scenario(
            step_s=STEP_S if self.step is None else seconds("--step", self.step),
            trim_rad=_schedule("--trim", self.trim, "rad", "5 deg"),
            dynamic_pressure_pa=_schedule("--dynamic-pressure", self.dynamic_pressure, "Pa", "5 kPa"),
            flight=self._flight(),
            shaker=self._shaker(loader),
            feel_changes=self._changes(),
            seed=self.seed,
        )

    def _sample(self, grid_s: float) -> float:
        """Time between samples; where it is not given, a whole number of steps."""
        if self.sample is None:
            return max(round(SAMPLE_S / grid_s), 1) * grid_s
        sample_s = seconds("--sample", self.sample)
        steps = sample_s / grid_s
        if sample_s > 0 and not (isfinite(steps) and round(steps) >= 1 and abs(steps - round(steps)) <= ROUNDING):
            raise InputError(f"--sample: expected a multiple of the engine's step of {grid_s:g} s, got {sample_s:g} s")
        return sample_s

    def _duration(self, recorded: "Recorded | None", sample_s: float) -> float:
        """Length of the run; where it is not given, a whole number of samples."""
        if self.duration is not None:
            return seconds("--duration", self.duration)
        if recorded is not None:
            return max(floor(float(recorded.time_s[-1]) / sample_s + ROUNDING), 1) * sample_s
        return max(round(DURATION_S[self.input or InputKind.STEP] / sample_s), 1) * sample_s

    def _input_options(self) -> dict[str, str]:
        """The options of the input that are given, by name."""
        named = {"--from": self.from_} | {
            name: getattr(self, name[2:].replace("-", "_")) for name in OPTIONS if name != "--from"
        }
        return {name: text for name, text in named.items() if text is not None}

    def _recorded(self) -> "Recorded | None":
        stems = [] if self.record is None else [self.record.stem]
        names = ColumnNames.of(self.column, self.unit, stems)
        if self.record is None:
            return None
        for name in (*(["--input"] if self.input else []), *self._input_options()):
            raise InputError(f"{name}: given with --record, which is the pilot's input; leave one out")
        from forcefeel.simulation.inputs import read_recorded

        with options_named():
            return read_recorded(self.record, **names.arguments(self.record.stem)).from_zero()

    def _flight(self) -> "Flight | None":
        if self.flight is None:
            return None
        from forcefeel.simulation.inputs import read_flight

        return read_flight(self.flight)

    def _shaker(self, loader: "Loader") -> "Schedule | None":
        on = _schedule("--shaker", self.shaker, "", "1")
        if on is not None and not all(0 <= share <= 1 for share in on.values):
            raise InputError(
                f"--shaker: expected shares from 0 to 1, got {', '.join(f'{share:g}' for share in on.values)}"
            )
        if on is not None and loader["feel.shaker_force"] == 0:
            raise InputError(
                "--shaker: the loader has no feel.shaker_force; add --set 'feel.shaker_force=10 lb' or leave it out"
            )
        return on

    def _changes(self) -> "tuple[FeelChange, ...]":
        from forcefeel.simulation import FeelChange

        if self.fade_time is not None and not self.change:
            raise InputError("--fade-time: requires a --change; add one or leave it out")
        fade_s = FADE_S if self.fade_time is None else seconds("--fade-time", self.fade_time)
        feel_changes = []
        for text in self.change or ():
            time, colon, values = text.partition(":")
            if not colon:
                example = "1 s: feel.stiffness=5000 lb in/rad"
                raise InputError(
                    f"--change: expected a time, a colon and new values such as {example!r}, got {show(text)}"
                )
            changes = assignments("--change", tuple(values.split(",")))
            feel_changes.append(FeelChange(seconds("--change", time.strip()), changes, fade_s))
        return tuple(feel_changes)


def _grid(scenario: "Scenario", loader: "Loader") -> float:
    """The engine's step for ``loader``."""
    from forcefeel.simulation.scenario import Steps

    period = loader["controller.period"]
    if period == 0:
        return scenario.step_s
    return Steps.of(replace(scenario, duration_s=period, sample_s=period, feel_changes=()), loader).step_s


def _schedule(option: str, text: str | None, unit_si: str, example: str) -> "Schedule | None":
    if text is None:
        return None
    from forcefeel.simulation.inputs import Schedule

    return Schedule(*over_time(option, text, unit_si, example), name=option)
