"""Runs of the nonlinear loader for the experiment of a record, with slopes, at the record's times."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from forcefeel import _core
from forcefeel.bench.channels import outputs
from forcefeel.bench.experiments import Drive, Loop
from forcefeel.bench.identification.linear import bench_law, loop_law
from forcefeel.bench.records import BenchRecord
from forcefeel.errors import InputError
from forcefeel.laws.law import Law, LawLike
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.loader.timing import controller_steps, longest_step_s
from forcefeel.qualification import load_rules
from forcefeel.qualification.let_go import find_release
from forcefeel.qualification.records import Record
from forcefeel.simulation.engine import prepared
from forcefeel.simulation.inputs import Recorded, Release, Schedule
from forcefeel.simulation.scenario import Scenario
from forcefeel.threads import cores

FINE_STEP_S, COARSE_STEP_S = 5e-4, 1e-3
"""Longest steps of the engine for a fine and a coarse search. A record of a minute with 1 % of noise determines parameters to
1e-4; steps of 1 ms cause as large an error if friction reverses often."""

_OF_STABLE = 1 / 3
"""Share, for a close look, of the longest step in which a motor on its link may be run: a step of all of it, stable as it is, puts
a column's inertia off by 0.05 %, five standard errors of a record of 4 s."""

_NOISE_AND_STEPS = [
    index for key, index in INDEX.items() if key.endswith((".noise", ".resolution", ".input_bits", ".output_bits"))
]
"""Positions of the noise and resolution of sensors and converters."""

_STAND_IN = {"potentiometer": "piston_position", "load_cell": "load_cell_force", "motor_angle": "drive_position"}
"""The output of a run without slopes in place of a proportional sensor signal."""

_EVEN = 1e-6
"""Tolerance of even times, as a share of a step, for times read from a file."""

_AT_ONCE = 6
"""Parameters of a core in one call of the engine, which runs them together, in a quarter of a second for a minute of record: Ctrl-C
waits for its end."""

_TAIL = 0.1
"""Final share of a release's record with the column at rest."""


@dataclass(frozen=True, eq=False)
class Histories:
    """Channels at a record's times, SI units.

    Attributes:
        value: (channels, samples).
        slopes: Derivatives by each parameter, (keys, channels, samples).
        rate: Derivatives by time, (channels, samples).
    """

    value: NDArray[np.float64]
    slopes: NDArray[np.float64]
    rate: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RecordRun:
    """Simulation of a record.

    Attributes:
        record: The record.
        loader: The loader with its effects, curves and controller.
        law: The law of the whole loader.
        longest_step_s: Longest step of the engine.
        sensors_noisy: Whether the controller's sensors have their noise and resolution; such runs have no slopes.

    Raises:
        InputError: When run, if a stated release is missing or a force is stated to be a staircase.
    """

    record: BenchRecord
    loader: Loader
    law: LawLike
    longest_step_s: float = FINE_STEP_S
    sensors_noisy: bool = False

    @cached_property
    def channels(self) -> tuple[str, ...]:
        """The measured channels."""
        return tuple(name for name in outputs(self.loader.drive) if name in self.record.channels)

    @cached_property
    def used(self) -> NDArray[np.bool_]:
        """Compared samples: all, or those after the release of the grip, (record's samples,)."""
        return np.asarray(self.record.time_s > self._let_go[1]) if self.released else self.record.time_s >= -math.inf

    @cached_property
    def time_s(self) -> NDArray[np.float64]:
        """Their times from the start of the run."""
        start = self._let_go[1] if self.released else float(self.record.time_s[0])
        return self.record.time_s[self.used] - start

    @property
    def released(self) -> bool:
        """Whether the grip is released; the run then begins there."""
        return self.record.experiment.drive is Drive.RELEASE

    def at(self, values: NDArray[np.float64], keys: Sequence[str], later_s: float = 0.0) -> Histories:
        """The channels of a loader with these SI values, in the order of the table.

        Args:
            values: (parameters,).
            keys: Rows of the requested slopes.
            later_s: Delay of the release after its detected time.
        """
        value, slopes = self._sloped(values, keys) if keys or not self._output_positions else self._alone(values)
        if self.on_samples:
            return Histories(value, slopes, np.zeros_like(value))
        if not (np.isfinite(value).all() and np.isfinite(slopes).all()):
            lost = np.full((len(value), len(self.time_s)), np.nan)
            return Histories(lost, np.full((len(keys), *lost.shape), np.nan), lost)
        at = np.maximum(self.time_s - later_s, 0.0)
        course = CubicSpline(np.arange(value.shape[1]) * self._sample_s, value, axis=1)
        bent = CubicSpline(np.arange(value.shape[1]) * self._sample_s, slopes, axis=2)
        return Histories(course(at), bent(at), course(at, 1))

    def together(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The channels of several loaders, (loaders, parameters), as ``at``; only if ``on_samples``."""
        return self._runs(values) if self._output_positions else np.array([self.at(row, ()).value for row in values])

    def noise_and_step_error(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Difference of a record of a loader with these values from ``at``: sensors' noise in the loop, and the engine's steps.

        A run with the noise and the resolution of the controller's sensors, in half the engine's step, less the model's own run.
        Noise of the bench's own sensors is not included.

        Args:
            values: (parameters,).

        Returns:
            The differences, (channels, samples); zero if a run diverges, or without a digital controller.
        """
        if not self.loader["controller.period"]:
            return np.zeros((len(self.channels), len(self.time_s)))
        stand_ins = [_STAND_IN.get(name, name) for name in self.channels]
        others = {name: samples for name, samples in self.record.channels.items() if name not in self.channels}
        record = replace(self.record, channels=others | {name: np.zeros_like(self.record.time_s) for name in stand_ins})
        exact = replace(self, record=record)
        rows = [exact.channels.index(name) for name in stand_ins]
        noisy = replace(exact, longest_step_s=self._step_s / 2, sensors_noisy=True)
        plain, other = (run.at(values, ()).value[rows] for run in (exact, noisy))
        difference = other - plain
        if stand_ins != list(self.channels):
            modeled = self.at(values, ()).value
            gain = np.std(modeled, axis=1) / np.maximum(np.std(plain, axis=1), np.finfo(np.float64).tiny)
            difference *= gain[:, np.newaxis]
        return difference if np.isfinite(difference).all() else np.zeros_like(difference)

    def _sloped(
        self, values: NDArray[np.float64], keys: Sequence[str]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Channels and their slopes, from a run on dual numbers for each parameter, at least one."""
        order = [list(outputs(self.loader.drive)).index(name) for name in self.channels]
        columns, size = [INDEX[key] for key in keys], _AT_ONCE * cores()
        parts = [
            self._engine.slopes(values[np.newaxis], some, channels=order, **self._law, threads=cores())
            for some in (columns[first : first + size] or [0] for first in range(0, max(len(columns), 1), size))
        ]
        return parts[0][0][0], np.concatenate([slopes[0] for _, slopes in parts])[: len(columns)]

    def _alone(self, values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The channels, from a run without slopes."""
        value = self._runs(values[np.newaxis])[0]
        return value, np.empty((0, *value.shape))

    def _runs(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        exact = values.copy()
        if not self.sensors_noisy:
            exact[:, _NOISE_AND_STEPS] = 0.0  # they have no slopes, and are excluded from the values too
        law: dict[str, Any] = {
            name: np.repeat(values, len(exact), axis=0) if name == "observers" else values
            for name, values in self._law.items()
        }
        return self._engine.run(exact, **law, threads=cores())[1]

    @cached_property
    def _output_positions(self) -> list[int]:
        """Positions of the channels in the outputs of a run without slopes; empty if one is missing."""
        names = [name for name, _ in _core.simulation_outputs(self.loader.drive)]
        return [names.index(name) for name in self.channels] if set(self.channels) <= set(names) else []

    @cached_property
    def _whole(self) -> Law | None:
        """The law of the whole loader, where the record is of it."""
        if self.record.experiment.loop is not Loop.LOADER:
            return None
        return Law.of(bench_law(self.law, self.loader), self.loader)

    @cached_property
    def _law(self) -> dict[str, Any]:
        return loop_law(self.loader, self.record.experiment.loop, self._whole or self.law)

    @cached_property
    def _step_s(self) -> float:
        return engine_step_s(self.loader, float(np.median(np.diff(self.record.time_s))), self.longest_step_s)

    @cached_property
    def on_samples(self) -> bool:
        """Whether the run begins with the record, and its samples are at whole steps, evenly."""
        return not self.released and self._even

    @cached_property
    def _even(self) -> bool:
        every = (self.time_s[-1] - self.time_s[0]) / (len(self.time_s) - 1) / self._step_s
        even = np.arange(len(self.time_s)) * round(every) * self._step_s
        return round(every) >= 1 and bool(np.max(np.abs(self.time_s - even)) < _EVEN * self._step_s * len(even))

    @cached_property
    def _sample_s(self) -> float:
        """Time between two samples of the engine."""
        if not self.on_samples:
            return self._step_s
        return round(float(self.time_s[1]) / self._step_s) * self._step_s

    @cached_property
    def _engine(self) -> _core.Simulation:
        samples = math.ceil(float(self.time_s[-1]) / self._sample_s - _EVEN)
        scenario = replace(
            self._scenario, duration_s=samples * self._sample_s, step_s=self._step_s, sample_s=self._sample_s
        )
        return prepared(self.loader, scenario, self._output_positions, self._whole)

    @property
    def _scenario(self) -> Scenario:
        if self.released:
            return Scenario(force=Release(self._let_go[0]))
        record, drive = self.record, self.record.experiment.drive
        time_s, signal = self.time_s, record.channels[drive]
        # The run may last a sample longer than the record; the drive keeps its last value.
        time_s, signal = np.append(time_s, time_s[-1] + 2 * self._sample_s), np.append(signal, signal[-1])
        if drive is Drive.PILOT_FORCE:
            if record.hold == "staircase":
                raise InputError(
                    f"{record.name}: hold: expected straight for a force at the grip, got staircase; leave it out"
                )
            return Scenario(force=Recorded(time_s, signal, record.name))
        if record.hold == "staircase":
            time_s, signal = np.repeat(time_s, 2)[1:], np.repeat(signal, 2)[:-1]
        return driven(drive, Schedule(tuple(time_s.tolist()), tuple(signal.tolist()), record.name))

    @cached_property
    def _let_go(self) -> tuple[float, float]:
        """Angle of the held grip, rad, and time of its release, s."""
        angle = self.record.channels["column_angle"]
        motion = Record(self.record.time_s, angle, name=self.record.name)
        release = find_release(motion, _TAIL, load_rules().release)
        return float(np.mean(angle[: release.held])), release.time_s


def driven(drive: Drive, signal: Schedule) -> Scenario:
    """A run under a voltage or a current over time, at the input of the experiment."""
    if drive in (Drive.COMMAND_SIGNAL, Drive.COMMAND_CURRENT):
        return Scenario(command_signal_v=signal)
    return Scenario(test_signal_v=signal)


def engine_step_s(loader: Loader, between_s: float, longest_s: float = COARSE_STEP_S) -> float:
    """The engine's step for this sample time: a fraction of the controller's period, or of the sample time."""
    if loader["controller.period"]:
        close = longest_s <= FINE_STEP_S
        return controller_steps(loader, min(longest_s, _OF_STABLE * longest_step_s(loader)) if close else longest_s)[0]
    return between_s / math.ceil(between_s / longest_s - _EVEN)
