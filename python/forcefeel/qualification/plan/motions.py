"""Simulated records of releases and sweeps: of a loader under a law, or of the programmed feel alone."""

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
"""Approximate sample time of simulated records, rounded to whole controller periods; also the longest step."""

_SLOW_S, _SLOWER = 20.0, 10
"""Duration above which sweeps are sampled less often, and the factor."""

_HELD_S = 0.1
"""Approximate time for which the grip is held before the release."""

_LEAST_S, _MOST_S, _PERIODS, _LEFT = 3.0, 60.0, 12, 1e-4
"""Shortest and longest record of a release, its number of periods, and the residual swing at its end."""

SHORT = 0.97
"""Share of the throw that a sweep reaches; the force of a stop is not part of the feel."""

_HELD_SHARE, _BEYOND_FRICTION = 0.5, 1.05
"""Share of the throw beyond which a control at the end of a sweep is held by its friction, and the force that brings it back."""

_ROUNDS, _NEAR, _MOST_FACTOR = 12, 5e-3, 4.0
"""Iterations of the sweep's force, their tolerance, and the largest change in one iteration."""


class Moved(Protocol):
    """A system whose response to a scenario can be simulated."""

    def move(self, scenario: Scenario) -> NDArray[np.float64]:
        """Angle at the samples, rad."""


class LoopError(InputError):
    """A simulated loader diverges: a failed test, not an invalid input."""


@dataclass(frozen=True)
class SimulatedLoader:
    """A loader under a law.

    Attributes:
        loader: The loader, hands off.
        law: The law.
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
        return np.array(run.outputs["column_angle_rad"])


@dataclass(frozen=True)
class Motions:
    """Simulates records.

    Attributes:
        dynamic_pressure_pa: Dynamic pressure, for a feel that depends on it.
        sample_s: Time between samples.
    """

    dynamic_pressure_pa: float | None = None
    sample_s: float = _SAMPLE_S

    @classmethod
    def of(cls, loader: Loader, dynamic_pressure_pa: float | None) -> "Motions":
        """Motions sampled at whole periods of a loader's controller."""
        period = loader["controller.period"]
        return cls(dynamic_pressure_pa, max(round(_SAMPLE_S / period), 1) * period if period else _SAMPLE_S)

    def release(self, moved: Moved, angle_rad: float, duration_s: float, name: str) -> Record:
        """A record of a release from an angle."""
        held = round(_HELD_S / self.sample_s)
        samples = held + round(duration_s / self.sample_s)
        force = Release(angle_rad, held * self.sample_s)
        angle = moved.move(self._scenario(force, samples * self.sample_s, self.sample_s))
        return replace(_record(angle, self.sample_s, name), release_s=force.start_s)

    def forced(self, moved: Moved, force: Recorded, name: str) -> Record:
        """A record under a force that starts at time zero."""
        duration = float(force.time_s[-1])
        sample_s = (_SLOWER if duration > _SLOW_S else 1) * self.sample_s
        duration = int(duration / sample_s * (1 + 1e-9)) * sample_s
        angle = moved.move(self._scenario(force, duration, sample_s))
        at = np.arange(len(angle)) * sample_s
        return _record(angle, sample_s, name, np.asarray(np.interp(at, force.time_s, force.force_n), dtype=np.float64))

    def swept(self, moved: Moved, throw: Throw, force: SweepForce, duration_s: float, name: str) -> Record:
        """A sweep to just short of the throw, with an iterated force; the force is limited if the throw is not reached.

        Args:
            moved: The simulated system.
            throw: Travel to reach.
            force: Initial guess.
            duration_s: Duration.
            name: Name of the record.
        """
        tries: tuple[list[tuple[float, float]], ...] = ([], [])
        for _ in range(_ROUNDS):
            record = self.forced(moved, force.over(duration_s), name)
            reached = max(-float(record.position.min()), 0.0), max(float(record.position.max()), 0.0)
            sides = zip(tries, (-force.low_n, force.high_n), (-throw.low_rad, throw.high_rad), reached, strict=True)
            factors = [_factor(tried, size, SHORT * target, came) for tried, size, target, came in sides]
            held = not force.end_n and float(record.position[-1]) < _HELD_SHARE * throw.low_rad
            if not held and all(abs(factor - 1) <= _NEAR for factor in factors):
                break
            force = force.scaled(*factors)
            if held:
                force = replace(force, end_n=_friction(record))
        return record

    def _scenario(self, force: Force, duration_s: float, sample_s: float) -> Scenario:
        pressure = self.dynamic_pressure_pa
        schedule = None if pressure is None else Schedule((0.0,), (pressure,))
        return Scenario(force, duration_s, min(sample_s, _SAMPLE_S), sample_s, dynamic_pressure_pa=schedule)


def _factor(tried: list[tuple[float, float]], size: float, target: float, came: float) -> float:
    """Factor on a force that came so far; ``tried`` has those before, and is given this one.

    In proportion, but where friction holds the control at a force that was tried: then by the line between two tries.
    """
    tried.append((size, came))
    below = max((attempt for attempt in tried if attempt[1] < target), default=None)
    above = min((attempt for attempt in tried if attempt[1] >= target), default=None)
    if below and above and any(reached < _NEAR * target for _, reached in tried):
        share = (target - below[1]) / (above[1] - below[1])
        return (below[0] + share * (above[0] - below[0])) / size
    return min(target / came, _MOST_FACTOR) if came > 0 else _MOST_FACTOR


def _friction(record: Record) -> float:
    """Force that moves a control up through neutral: that of the way down, turned, and a little more for what damps it."""
    down = int(record.position.argmax())
    at = down + int((record.position[down:] <= 0).argmax())
    return float(-_BEYOND_FRICTION * record.force_n[at]) if record.force_n is not None else 0.0


def first_force(loader: Loader, throw: Throw) -> SweepForce:
    """Force of the spring G alone at the throw, an initial guess: ``F = G theta / R_p``."""
    per_angle = loader["feel.stiffness"] / loader["column.grip_arm"]
    return SweepForce(per_angle * throw.low_rad, per_angle * throw.high_rad)


def release_duration_s(loader: Loader) -> float:
    """Record length of a release of the programmed feel, s."""
    frequency, damping = feel_frequency(loader.si_values)
    fades = log(1 / _LEFT) / (frequency * damping) if damping > 0 else _MOST_S
    if damping > 1:  # the slower of its two modes
        fades = log(1 / _LEFT) / (frequency * (damping - (damping**2 - 1) ** 0.5))
    return float(np.clip(max(fades, _PERIODS * 2 * pi / frequency), _LEAST_S, _MOST_S))


def _record(angle: NDArray[np.float64], sample_s: float, name: str, force: NDArray[np.float64] | None = None) -> Record:
    """A record of a simulation, without noise and quantization."""
    time = np.arange(len(angle), dtype=np.float64) * sample_s
    return Record(time, angle, force, name=name, resolution=0.0, noise=0.0, force_resolution_n=0.0, force_noise_n=0.0)
