"""Inputs of a run: forces, trim, dynamic pressure, shaker, changes of the feel."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isfinite, pi

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError, expect, expect_number, type_text
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import Loader
from forcefeel.loader.timing import WHOLE, controller_steps
from forcefeel.simulation.inputs import Flight, Force, HandsOff, Recorded, Release, Sampled, Schedule
from forcefeel.simulation.inputs.sampled import Grid

SHORTEST_STEP_S, LONGEST_STEP_S = 1e-5, 2e-3
"""Steps that the engine takes; beyond, the column on its linkage is no longer followed well."""

MOST_STEPS = 5_000_000
"""Longest run, in steps: some five seconds of computing, and 400 MB of inputs."""

LATEST_S = 1e6
"""Latest end of a change of the feel, far beyond any run: its step is still a number that the engine can count to."""

LARGEST_SEED = 2**63 - 1
"""Largest seed."""


@dataclass(frozen=True)
class FeelChange:
    """The feel is programmed anew while the column moves.

    The acceleration that the feel asks for goes over from the old to the new smoothly, as 3 s^2 - 2 s^3, so that neither the force
    nor its rate jumps. Hard stops, the velocity limit and the trim rate hold from the end of the change on: a stop lets a control
    beyond it come back, and a limit takes hold over some hundredths of a second.

    Attributes:
        at_s: Start time.
        changes: New values of ``feel.`` rows, as ``Loader.replace`` takes them.
        fade_s: Duration.
        law: The sampled law that goes with the new feel; its numbers change along with the feel. By default the
            law stays.

    Example:
        >>> softer = ff.simulation.FeelChange(0.5, {"feel.stiffness": "6000 lb in/rad"})
        >>> ff.simulate(ff.elevator(), ff.Scenario(ff.Step(50.0), feel_changes=(softer,))).method
        'stepped'
    """

    at_s: float
    changes: Mapping[str, str | float | bool | None]
    fade_s: float = 0.5
    law: Law | SampledLaw | None = None


@dataclass(frozen=True)
class Scenario:
    """The inputs of one run.

    Attributes:
        force: The pilot's force over time, or a release.
        duration_s: Length of the run.
        step_s: Longest step of the engine; with a digital controller the step divides its period.
        sample_s: Time between two samples of the history: whole steps, or half a step. In the middle of a step they are those of
            the cubic through its ends.
        trim_rad: Commanded neutral of the feel over time; it is followed at ``feel.trim_rate``.
        dynamic_pressure_pa: Dynamic pressure over time, for a feel whose stiffness depends on it.
        flight: Flight state over time, for a loader with a surface.
        shaker: How far the stick shaker is on over time, 0 to 1.
        test_signal_v: Voltage over time at the amplifier's input, beside the command; of a motor a current in A.
        command_signal_v: Voltage over time that the law adds to its command; a digital controller adds what it finds of it at a
            sample, and sends it on with the command.
        feel_changes: Changes of the feel, in order, none beginning before the last is done.
        seed: Seed of the sensors' noise.

    Raises:
        InputError: If a time is out of range.

    Example:
        >>> scenario = ff.Scenario(ff.Step(100.0), duration_s=1.0)
        >>> ff.simulate(ff.elevator(), scenario).history.sizes["time_s"]
        1001
    """

    force: Force = field(default_factory=HandsOff)
    duration_s: float = 2.0
    step_s: float = 1e-3
    sample_s: float = 1e-3
    trim_rad: Schedule | None = None
    dynamic_pressure_pa: Schedule | None = None
    flight: Flight | None = None
    shaker: Schedule | None = None
    test_signal_v: Schedule | None = None
    command_signal_v: Schedule | None = None
    feel_changes: tuple[FeelChange, ...] = ()
    seed: int = 0

    def __post_init__(self) -> None:
        self._check_types()
        if not SHORTEST_STEP_S <= self.step_s <= LONGEST_STEP_S:
            raise InputError(f"step_s: expected {SHORTEST_STEP_S:g} to {LONGEST_STEP_S:g} s, got {self.step_s:g}")
        for name in ("duration_s", "sample_s"):
            value = getattr(self, name)
            if not (isfinite(value) and value > 0):
                raise InputError(f"{name}: expected a time above 0, got {value:g}")
        if not 0 <= self.seed <= LARGEST_SEED:
            raise InputError(f"seed: expected a whole number from 0 to {LARGEST_SEED:,}, got {self.seed}")
        end = 0.0
        for change in self.feel_changes:
            if not (change.fade_s > 0 and change.at_s >= end):
                raise InputError(
                    f"feel_changes: expected changes that take time and do not overlap, got {change.fade_s:g} s from "
                    f"{change.at_s:g} s on, where {end:g} s is the earliest"
                )
            end = change.at_s + change.fade_s
            if end > LATEST_S:
                raise InputError(f"feel_changes: expected changes that are done by {LATEST_S:g} s, got {end:g} s")

    def _check_types(self) -> None:
        if isinstance(self.force, type) or not callable(getattr(self.force, "sample", None)):
            example = "Step(100.0) or Release(0.1), or Recorded(time_s, force_n) of arrays"
            raise InputError(f"force: expected what the pilot does, such as {example}, got {type_text(self.force)}")
        for name in ("duration_s", "step_s", "sample_s"):
            expect_number(name, getattr(self, name))
        expect_number("seed", self.seed, whole=True)
        for name in ("trim_rad", "dynamic_pressure_pa", "shaker", "test_signal_v", "command_signal_v"):
            if (value := getattr(self, name)) is not None and not callable(getattr(value, "sample", None)):
                raise InputError(
                    f"{name}: expected values over time, simulation.Schedule(times_s, values), got {type_text(value)}"
                )
        if self.flight is not None:
            expect("flight", self.flight, Flight, "a simulation.Flight")
        expect("feel_changes", self.feel_changes, (tuple, list), "a tuple of simulation.FeelChange")
        for change in self.feel_changes:
            expect("feel_changes", change, FeelChange, "a tuple of simulation.FeelChange")


def on_samples(scenario: Scenario) -> Scenario:
    """The scenario in steps no longer than the time between its samples, for what is exact at any step."""
    return replace(scenario, step_s=min(scenario.step_s, scenario.sample_s))


@dataclass(frozen=True)
class Steps:
    """A scenario on the engine's steps.

    Attributes:
        step_s: The step.
        every: Steps between two samples of the history; 0 for two samples a step.
        inputs: By the engine's name, (steps, 2) at start and end of each step: force; trim, stiffness_factor, shaker, fade,
            test_signal, command_signal and the numbers of the flight where there is such a thing.
        timing: Steps in the controller's period and in its delay; ``None`` for an analog law.
        start_force_n: Force under which the run begins at rest.
        held: Angle in rad at which the grip is held, and the step at which it is let go; ``None`` but for a release.
        changes: For each change of the feel its first step, the step at which it is done, and the values afterwards.
    """

    step_s: float
    every: int
    inputs: dict[str, NDArray[np.float64]]
    timing: tuple[int, int] | None
    start_force_n: float
    held: tuple[float, int] | None
    changes: list[tuple[int, int, NDArray[np.float64]]]

    @classmethod
    def of(cls, scenario: Scenario, loader: Loader) -> "Steps":
        """Puts the scenario on steps for a loader and its controller.

        Raises:
            InputError: If a time does not fall on a step, or the feel asks for a dynamic pressure that is not given.
        """
        step_s, timing = _step(scenario, loader)
        grid = Grid.of(scenario.duration_s, step_s)
        if grid.steps > MOST_STEPS:
            raise InputError(
                f"duration_s: expected at most {MOST_STEPS} steps of {step_s:g} s, got {scenario.duration_s:g} s"
            )
        every = _steps_per_sample(scenario.sample_s, step_s)
        if every and grid.steps % every:
            raise InputError(
                f"duration_s: expected a multiple of the {scenario.sample_s:g} s between samples, got {scenario.duration_s:g} s"
            )
        span = scenario.duration_s, step_s
        signals = {
            "trim": scenario.trim_rad,
            "test_signal": scenario.test_signal_v,
            "command_signal": scenario.command_signal_v,
        }
        inputs = {"force": scenario.force.sample(*span).pairs} | {
            name: signal.sample(*span).pairs for name, signal in signals.items() if signal is not None
        }
        if (factor := _stiffness_factor(scenario, loader, span)) is not None:
            inputs["stiffness_factor"] = factor.pairs
        if scenario.flight is not None:
            inputs |= scenario.flight.pairs(loader, *span)
        if scenario.shaker is not None:
            on, angle = (
                scenario.shaker.sample(*span),
                2 * pi * (loader["feel.shaker_frequency"] / (2 * pi)) * grid.times_s,
            )
            inputs["shaker"] = Sampled(on.start * np.sin(angle[:-1]), on.end * np.sin(angle[1:])).pairs
        changes = []
        changed = loader
        for change in scenario.feel_changes:
            before, changed = changed, changed.replace(_only_feel(change.changes), si=True)
            if scenario.trim_rad is not None and isfinite(before["feel.trim_rate"]) > isfinite(
                changed["feel.trim_rate"]
            ):
                raise InputError(
                    "feel.trim_rate: switched off while trim is given, the neutral would jump to its command; "
                    "give a rate, such as 50 deg/s"
                )
            begin, end = (grid.index("feel change", time) for time in (change.at_s, change.at_s + change.fade_s))
            if end <= begin:
                raise InputError(
                    f"feel change: expected to take a step of {step_s:g} s at least, got {change.fade_s:g} s"
                )
            share = np.clip((np.arange(grid.steps + 1) - begin) / (end - begin), 0.0, 1.0)
            fade = share**2 * (3 - 2 * share)
            fades = inputs.setdefault("fade", np.zeros((grid.steps, 2)))
            fades[begin:end] = Sampled(fade[:-1], fade[1:]).pairs[begin:end]
            changes.append((begin, end, changed.si_values))
        force = scenario.force
        held = (force.angle_rad, grid.index("release", force.start_s)) if isinstance(force, Release) else None
        start_force = float(inputs["force"][0, 0]) if isinstance(force, Recorded) else 0.0
        return cls(step_s, every, inputs, timing, start_force, held, changes)


def _steps_per_sample(sample_s: float, step_s: float) -> int:
    steps = sample_s / step_s
    if abs(steps - 0.5) <= WHOLE:
        return 0
    if round(steps) < 1 or abs(steps - round(steps)) > WHOLE * steps:
        raise InputError(
            f"sample_s: expected whole steps of {step_s:g} s, or half a step, between samples, got {sample_s:g} s"
        )
    return round(steps)


def _only_feel(changes: Mapping[str, str | float | bool | None]) -> Mapping[str, str | float | bool | None]:
    for key in changes:
        if not key.startswith("feel."):
            raise InputError(f"feel change: expected rows of the feel such as feel.stiffness, got {key!r}")
    return changes


def _stiffness_factor(scenario: Scenario, loader: Loader, span: tuple[float, float]) -> Sampled | None:
    curve, pressure = loader.stiffness_factor, scenario.dynamic_pressure_pa
    if curve is None:
        if pressure is not None:
            raise InputError(
                "dynamic pressure: the loader has no feel.stiffness_factor that depends on it; leave it out"
            )
        return None
    if pressure is None:
        raise InputError("dynamic pressure: the loader's feel.stiffness_factor depends on it; give it")
    sampled = pressure.sample(*span)
    return Sampled(curve.held(sampled.start), curve.held(sampled.end))


def _step(scenario: Scenario, loader: Loader) -> tuple[float, tuple[int, int] | None]:
    """The engine's step, and the controller's period and delay in steps."""
    return (scenario.step_s, None) if loader["controller.period"] == 0 else controller_steps(loader, scenario.step_s)
