"""Records of what moves: a loader under a law, or the programmed feel alone, released and swept."""

from dataclasses import dataclass, replace
from math import log, pi
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import feel_frequency
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.qualification import Record
from forcefeel.qualification.plan.sweep_force import SweepForce
from forcefeel.qualification.throw import Throw
from forcefeel.simulation import RunStatus, Scenario, simulate
from forcefeel.simulation.inputs import Force, Recorded, Release, Schedule

_SAMPLE_S = 1e-3
"""About the time between samples of what is simulated: whole periods of a digital controller; and the longest step."""

_SLOW_S, _SLOWER = 20.0, 10
"""Sweeps from this duration on are sampled so many times less often."""

_HELD_S = 0.1
"""About how long the grip is held before it is let go."""

_LEAST_S, _MOST_S, _PERIODS, _LEFT = 3.0, 60.0, 12, 1e-4
"""A release is recorded so long at least and at most, for so many periods, and until so little is left of its swing."""

SHORT = 0.97
"""Share of the throw that a sweep reaches: the force of a stop is no part of the feel."""

_ROUNDS, _NEAR, _MOST_FACTOR = 12, 5e-3, 4.0
"""Rounds in which the force is found that reaches so far, how near is near enough, largest change of a round."""


class Moved(Protocol):
    """Something that moves under a scenario."""

    def move(self, scenario: Scenario) -> NDArray[np.float64]:
        """Its angle at the samples, rad."""


class LoopError(InputError):
    """A simulated loader that does not stay within bounds: no bad input, but a failed test."""


@dataclass(frozen=True)
class SimulatedLoader:
    """A loader under a law.

    Attributes:
        loader: The loader, hands off.
        law: The law; ``None`` for the original loop.
    """

    loader: Loader
    law: Law

    def move(self, scenario: Scenario) -> NDArray[np.float64]:
        """The column's angle at the samples, rad.

        Raises:
            LoopError: If the run diverges, with the time.
        """
        run = simulate(self.loader, scenario, self.law)
        if run.status is RunStatus.DIVERGED:
            raise LoopError(run.note)
        return np.array(run.history["column_angle_rad"].values)


@dataclass(frozen=True)
class Motions:
    """Makes records.

    Attributes:
        dynamic_pressure_pa: For a feel that depends on it.
        sample_s: Time between samples.
    """

    dynamic_pressure_pa: float | None = None
    sample_s: float = _SAMPLE_S

    @classmethod
    def of(cls, loader: Loader, dynamic_pressure_pa: float | None) -> "Motions":
        """Those whose samples fall on the periods of a loader's controller."""
        period = loader["controller.period"]
        return cls(dynamic_pressure_pa, max(round(_SAMPLE_S / period), 1) * period if period else _SAMPLE_S)

    def release(self, moved: Moved, angle_rad: float, duration_s: float, name: str) -> Record:
        """Held at an angle, then let go."""
        held = round(_HELD_S / self.sample_s)
        samples = held + round(duration_s / self.sample_s)
        force = Release(angle_rad, held * self.sample_s)
        angle = moved.move(self._scenario(force, samples * self.sample_s, self.sample_s))
        return replace(_record(angle, self.sample_s, name), release_s=force.start_s)

    def forced(self, moved: Moved, force: Recorded, name: str) -> Record:
        """Moved by a force over time, from zero on."""
        duration = float(force.time_s[-1])
        sample_s = (_SLOWER if duration > _SLOW_S else 1) * self.sample_s
        duration = int(duration / sample_s * (1 + 1e-9)) * sample_s
        angle = moved.move(self._scenario(force, duration, sample_s))
        at = np.arange(len(angle)) * sample_s
        return _record(angle, sample_s, name, np.asarray(np.interp(at, force.time_s, force.force_n), dtype=np.float64))

    def swept(self, moved: Moved, throw: Throw, force: SweepForce, duration_s: float, name: str) -> Record:
        """A sweep to just short of the throw, whatever force that takes; of what cannot reach it, one far beyond the first.

        Args:
            moved: What moves.
            throw: How far.
            force: A first guess.
            duration_s: How long it lasts.
            name: Of the record.
        """
        for _ in range(_ROUNDS):
            record = self.forced(moved, force.over(duration_s), name)
            reached = max(-float(record.position.min()), 0.0), max(float(record.position.max()), 0.0)
            factors = [
                min(SHORT * target / came, _MOST_FACTOR) if came > 0 else _MOST_FACTOR
                for target, came in zip((-throw.low_rad, throw.high_rad), reached, strict=True)
            ]
            if all(abs(factor - 1) <= _NEAR for factor in factors):
                break
            force = force.scaled(*factors)
        return record

    def _scenario(self, force: Force, duration_s: float, sample_s: float) -> Scenario:
        pressure = self.dynamic_pressure_pa
        schedule = None if pressure is None else Schedule((0.0,), (pressure,))
        return Scenario(force, duration_s, min(sample_s, _SAMPLE_S), sample_s, dynamic_pressure_pa=schedule)


def first_force(loader: Loader, throw: Throw) -> SweepForce:
    """What the spring G alone takes at the throw: a first guess. ``F = G theta / R_p``."""
    per_angle = loader["feel.stiffness"] / loader["column.grip_arm"]
    return SweepForce(per_angle * throw.low_rad, per_angle * throw.high_rad)


def release_duration_s(loader: Loader) -> float:
    """How long a release of the programmed feel is worth recording."""
    frequency, damping = feel_frequency(loader.si_values)
    fades = log(1 / _LEFT) / (frequency * damping) if damping > 0 else _MOST_S
    if damping > 1:  # the slower of its two modes
        fades = log(1 / _LEFT) / (frequency * (damping - (damping**2 - 1) ** 0.5))
    return float(np.clip(max(fades, _PERIODS * 2 * pi / frequency), _LEAST_S, _MOST_S))


def _record(angle: NDArray[np.float64], sample_s: float, name: str, force: NDArray[np.float64] | None = None) -> Record:
    """What was simulated, whose numbers have neither noise nor steps."""
    time = np.arange(len(angle), dtype=np.float64) * sample_s
    return Record(time, angle, force, name=name, resolution=0.0, noise=0.0, force_resolution_n=0.0, force_noise_n=0.0)
