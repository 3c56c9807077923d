"""The options that describe what is done to a loader, and which law drives it: the same for every command that simulates.

A command takes them as one argument::

    @app.command()
    @with_scenario
    def simulate(loader: LoaderFile = None, *, scenario: ScenarioOptions) -> None: ...

and asks, in this order, ``nominal = scenario.changed(load(path))``, ``scenario.scenario(nominal)`` and
``scenario.compensator(nominal)``.
"""

import inspect
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import wraps
from math import floor, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

import typer

from forcefeel.cli.bench_data import options_named
from forcefeel.cli.given_loader import given_law
from forcefeel.cli.law_option import METAVAR, law_name
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
    from forcefeel.simulation.inputs import Recorded, Schedule


STEP_S, SAMPLE_S, FADE_S = 1e-3, 1e-3, 0.5

MOST_STEPS = 2_000_000
"""Longest run: a history of 160 MB with all samples kept."""

ROUNDING = 1e-6
"""Of a sample; a recording that ends so little before a sample covers it."""


_METAVARS = {
    "--compensator": METAVAR,
    "--force": "FORCE",
    "--angle": "ANGLE",
    "--from": "FREQUENCY",
    "--to": "FREQUENCY",
    "--lines": "FREQUENCIES",
    "--record": "FILE",
    "--column": "time|force=NAME",
    "--unit": "NAME=UNIT",
    "--trim": "TIME: ANGLE, ...",
    "--dynamic-pressure": "TIME: PRESSURE, ...",
    "--shaker": "TIME: SHARE, ...",
    "--change": "TIME: NAME=VALUE, ...",
    "--set": "NAME=VALUE",
    "--input": None,
    "--spacing": None,
    "--arm": None,
}


def _option(name: str, help: str, panel: str, **more: Any) -> Any:  # noqa: A002  Typer's word
    metavar = _METAVARS.get(name, "TIME")
    return typer.Option(name, help=help, metavar=metavar, rich_help_panel=panel, show_default=False, **more)


_INPUT, _SCENARIO, _LOADER = "Pilot's input", "Scenario", "Loader and law"


@dataclass(frozen=True)
class ScenarioOptions:
    """The options as given; ``None`` is not given. Values with units are text."""

    input: Annotated[InputKind | None, _option("--input", "What the pilot does.  [default: step]", _INPUT)] = None
    force: Annotated[
        str | None,
        _option("--force", "Greatest force, such as '20 lb'.  [default: pilot.force of the loader]", _INPUT),
    ] = None
    start: Annotated[
        str | None,
        _option(
            "--start", "When it begins; of a release, when the grip is let go.  [default: 0.1 s; release 0 s]", _INPUT
        ),
    ] = None
    width: Annotated[
        str | None, _option("--width", "Length of a pulse, of each half of a doublet.  [default: 0.5 s]", _INPUT)
    ] = None
    angle: Annotated[
        str | None,
        _option("--angle", "Release: angle at which the grip is held, such as '10 deg'.", _INPUT),
    ] = None
    lasts: Annotated[
        str | None,
        _option(
            "--lasts",
            "Length of a stop-to-stop sweep or a chirp, period of a multisine.  [default: all the run]",
            _INPUT,
        ),
    ] = None
    from_: Annotated[
        str | None, _option("--from", "First frequency of a chirp, lowest of a multisine.  [default: 0.2 Hz]", _INPUT)
    ] = None
    to: Annotated[
        str | None, _option("--to", "Last frequency of a chirp, highest of a multisine.  [default: 20 Hz]", _INPUT)
    ] = None
    spacing: Annotated[
        Spacing | None, _option("--spacing", "How a chirp's frequency runs.  [default: linear]", _INPUT)
    ] = None
    lines: Annotated[
        str | None,
        _option(
            "--lines",
            "Frequencies of a multisine, such as '0.5 Hz, 1.5 Hz'.  [default: all multiples of one over its period in the band]",
            _INPUT,
        ),
    ] = None
    record: Annotated[
        Path | None,
        _option(
            "--record",
            "File of a recorded force (CSV, Parquet, MATLAB), columns such as 'time (s),force (lb)'; its first point is the "
            "start of the run.",
            _INPUT,
        ),
    ] = None
    column: Annotated[
        list[str] | None,
        _option(
            "--column", "What the file of --record calls a column, such as 'force=F1'. May be given again.", _INPUT
        ),
    ] = None
    unit: Annotated[
        list[str] | None,
        _option("--unit", "Unit of a column whose header has none, such as 'F1=lb'. May be given again.", _INPUT),
    ] = None
    duration: Annotated[
        str | None,
        _option(
            "--duration",
            "Length of the run.  [default: 2 s; stop-to-stop 100 s, chirp 20 s, multisine 10 s, a recording all of it]",
            _SCENARIO,
        ),
    ] = None
    trim: Annotated[
        str | None,
        _option(
            "--trim",
            "Commanded neutral over time, such as '0 s: 0 deg, 1 s: 5 deg': straight lines; two points at one time are a jump.",
            _SCENARIO,
        ),
    ] = None
    dynamic_pressure: Annotated[
        str | None,
        _option(
            "--dynamic-pressure",
            "Dynamic pressure over time, as --trim, or one value such as '5 kPa'; for a loader with feel.stiffness_factor.",
            _SCENARIO,
        ),
    ] = None
    shaker: Annotated[
        str | None,
        _option(
            "--shaker",
            "How far the stick shaker is on over time, 0 to 1, such as '1 s: 0, 1 s: 1'; for a loader with feel.shaker_force.",
            _SCENARIO,
        ),
    ] = None
    change: Annotated[
        list[str] | None,
        _option(
            "--change",
            "The feel is programmed anew, such as '1 s: feel.stiffness=5000 lb in/rad, feel.damping=200 lb in s/rad'. "
            "May be given again.",
            _SCENARIO,
        ),
    ] = None
    over: Annotated[str | None, _option("--over", "How long each --change takes.  [default: 0.5 s]", _SCENARIO)] = None
    step: Annotated[
        str | None,
        _option(
            "--step",
            "Longest step of the engine; with a digital controller the step divides its period.  [default: 1 ms]",
            _SCENARIO,
        ),
    ] = None
    sample: Annotated[
        str | None, _option("--sample", "Time between two samples of the result.  [default: about 1 ms]", _SCENARIO)
    ] = None
    seed: Annotated[int, typer.Option("--seed", help="Seed of all that is random.", rich_help_panel=_SCENARIO)] = 0
    set_: Annotated[
        list[str] | None,
        _option(
            "--set",
            "Changes a value of the loader, such as 'column.coulomb_friction=3 lb', 'controller.period=0.5 ms', "
            "'valve.orifice=true', 'feel.breakout=off'. May be given again.",
            _LOADER,
        ),
    ] = None
    arm: Annotated[
        Arm | None,
        _option(
            "--arm",
            "The pilot's arm at the grip: loose 1 kg, 10 N s/m, 50 N/m; firm, two hands 3 kg, 40 N s/m, 1000 N/m (this "
            "set is unverified); hands-off none.  [default: the loader's]",
            _LOADER,
        ),
    ] = None
    law: Annotated[
        str | None,
        _option(
            "--compensator",
            "The law: the original position loop, or one that is designed for this loader: feedback gains of recursion (22), over "
            "the published or an endless horizon, or a sampled law; or the file of one, from `compensate --save-law`.  "
            "[default: original]",
            _LOADER,
            parser=law_name,
        ),
    ] = None

    def changed(self, loader: "Loader") -> "Loader":
        """The loader with ``--set`` and ``--arm``; the other methods ask for this one.

        Raises:
            InputError: If a value is bad.
        """
        changes = assignments("--set", tuple(self.set_ or ()))
        if self.arm is not None:
            for row in ARM_ROWS:
                if row in changes:
                    raise InputError(f"--arm: sets {row}, and so does --set; leave one out")
            changes |= dict(zip(ARM_ROWS, ARMS[self.arm], strict=True))
        return loader.replace(changes) if changes else loader

    def law_of(self, loader: "Loader") -> "Law":
        """The law, designed for ``loader`` or read from its file.

        Raises:
            InputError: If it cannot be designed or read, or is for another controller.
        """
        return given_law(self.law, loader)

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
        options = InputOptions(kind, self._given(), loader["pilot.force"], bare.duration_s, grid_s)
        return replace(bare, force=options.build())

    def _bare(self, loader: "Loader") -> "Scenario":
        """The scenario without the pilot."""
        from forcefeel.simulation import Scenario  # noqa: PLC0415

        return Scenario(
            step_s=STEP_S if self.step is None else seconds("--step", self.step),
            trim_rad=_schedule("--trim", self.trim, "rad", "5 deg"),
            dynamic_pressure_pa=_schedule("--dynamic-pressure", self.dynamic_pressure, "Pa", "5 kPa"),
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

    def _given(self) -> dict[str, str]:
        """The options of the input that are given, by name."""
        named = {"--from": self.from_} | {name: getattr(self, name[2:]) for name in OPTIONS if name != "--from"}
        return {name: text for name, text in named.items() if text is not None}

    def _recorded(self) -> "Recorded | None":
        stems = [] if self.record is None else [self.record.stem]
        names = ColumnNames.of(self.column, self.unit, stems)
        if self.record is None:
            return None
        for option in (*(["--input"] if self.input else []), *self._given()):
            raise InputError(f"{option}: given with --record, which is the pilot's input; leave one out")
        from forcefeel.simulation.inputs import read_recorded  # noqa: PLC0415

        with options_named():
            return read_recorded(self.record, **names.arguments(self.record.stem)).from_zero()

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
        from forcefeel.simulation import FeelChange  # noqa: PLC0415

        if self.over is not None and not self.change:
            raise InputError("--over: is how long a --change takes, and there is none; leave it out")
        over_s = FADE_S if self.over is None else seconds("--over", self.over)
        found = []
        for text in self.change or ():
            time, colon, values = text.partition(":")
            if not colon:
                example = "1 s: feel.stiffness=5000 lb in/rad"
                raise InputError(
                    f"--change: expected a time, a colon and new values such as {example!r}, got {show(text)}"
                )
            changes = assignments("--change", tuple(values.split(",")))
            found.append(FeelChange(seconds("--change", time.strip()), changes, over_s))
        return tuple(found)


def with_scenario(command: Callable[..., None]) -> Callable[..., None]:
    """``command`` with an option for each field of its argument ``scenario``."""
    signature = inspect.signature(command)
    hints = get_type_hints(ScenarioOptions, include_extras=True)
    names = [field.name for field in fields(ScenarioOptions)]
    options = [
        inspect.Parameter(
            field.name, inspect.Parameter.KEYWORD_ONLY, default=field.default, annotation=hints[field.name]
        )
        for field in fields(ScenarioOptions)
    ]

    @wraps(command)
    def taking_options(**given: Any) -> None:
        chosen = ScenarioOptions(**{name: given.pop(name) for name in names})
        command(**given, scenario=chosen)

    own = [
        parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY)
        for name, parameter in signature.parameters.items()
        if name != "scenario"
    ]
    taking_options.__signature__ = signature.replace(parameters=[*own, *options])  # type: ignore[attr-defined]
    return taking_options


def _grid(scenario: "Scenario", loader: "Loader") -> float:
    """The engine's step for ``loader``."""
    from forcefeel.simulation.scenario import Steps  # noqa: PLC0415

    period = loader["controller.period"]
    if period == 0:
        return scenario.step_s
    return Steps.of(replace(scenario, duration_s=period, sample_s=period, feel_changes=()), loader).step_s


def _schedule(option: str, text: str | None, unit_si: str, example: str) -> "Schedule | None":
    if text is None:
        return None
    from forcefeel.simulation.inputs import Schedule  # noqa: PLC0415

    return Schedule(*over_time(option, text, unit_si, example), name=option)
