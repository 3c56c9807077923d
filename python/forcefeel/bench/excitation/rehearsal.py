"""The excitation on the nonlinear loader, and its largest scale within the limits."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, inf, isfinite

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.bench.channels import CHANNELS
from forcefeel.bench.excitation.limits import KINDS, STATED, Limit
from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.bench.identification.linear import bench_law
from forcefeel.bench.identification.record_run import driven, engine_step_s
from forcefeel.errors import InputError
from forcefeel.laws.law import LawLike
from forcefeel.loader.loader import Loader
from forcefeel.loader.timing import WHOLE
from forcefeel.simulation import RunStatus, Scenario, simulate
from forcefeel.simulation.engine import prepared
from forcefeel.simulation.inputs import Recorded, Schedule
from forcefeel.simulation.outcome import named
from forcefeel.units import UnitSystem

NEAR = 0.97
"""Sufficient share of the binding limit."""

_AIM = 0.985  # between NEAR and 1
_TRIALS = 16
_MOST_CHANGE = 4.0  # of the scale in a trial: a loader with friction or stops is not linear


@dataclass(frozen=True, eq=False)
class Bench:
    """A loader in an experiment.

    Attributes:
        loader: The loader.
        experiment: Loop and drive.
        law: The law of the whole loader.
        rate_hz: Samples per second of the signal.
    """

    loader: Loader
    experiment: Experiment
    law: LawLike
    rate_hz: float

    def peaks(self, signal: NDArray[np.float64], limits: Sequence[Limit]) -> tuple[float, ...]:
        """Largest magnitude of each limited channel in a run from rest through the signal; infinite if it diverged.

        Args:
            signal: Volts, amperes or newtons at every sample, straight between, (samples,).
            limits: The limits.
        """
        step_s = engine_step_s(self.loader, 1 / self.rate_hz)
        steps = ceil((len(signal) - 1) / self.rate_hz / step_s - WHOLE)
        scenario = self._scenario(signal, steps, step_s)
        if self.experiment.loop is Loop.MOTOR_OPEN:
            seen = self._open(scenario)
        else:
            run = simulate(self.loader, scenario, self._law())
            limited = KINDS[self.loader.drive].values()
            seen = {channel: run.outputs[named(channel, CHANNELS[channel])] for channel in limited}
            if run.status is RunStatus.DIVERGED:
                return (inf,) * len(limits)
        seen[str(self.experiment.drive)] = signal
        peaks = (float(np.abs(seen[limit.channel]).max()) for limit in limits)
        return tuple(peak if isfinite(peak) else inf for peak in peaks)

    def _open(self, scenario: Scenario) -> dict[str, NDArray[np.float64]]:
        """Histories of a motor without a law."""
        names = [name for name, _ in _core.simulation_outputs(self.loader.drive)]
        engine = prepared(self.loader, scenario, range(len(names)))
        _, histories = engine.run(self.loader.si_values[np.newaxis], law="open", threads=1)
        return dict(zip(names, histories[0], strict=True))

    def _scenario(self, signal: NDArray[np.float64], steps: int, step_s: float) -> Scenario:
        """The signal, then its last value for a step, because the run may last a step longer."""
        times = np.append(np.arange(len(signal)) / self.rate_hz, len(signal) / self.rate_hz + step_s)
        values = np.append(signal, signal[-1])
        if self.experiment.drive is Drive.PILOT_FORCE:
            run = Scenario(force=Recorded(times, values, "excitation"))
        else:
            run = driven(self.experiment.drive, Schedule(tuple(times.tolist()), tuple(values.tolist()), "excitation"))
        return replace(run, duration_s=steps * step_s, step_s=step_s, sample_s=step_s)

    def _law(self) -> LawLike:
        match self.experiment.loop:
            case Loop.SERVO_OPEN | Loop.MOTOR_OPEN:
                return GainLaw.none(self.loader.si_values)
            case Loop.SERVO_CLOSED:
                return GainLaw.position_loop(self.loader.si_values)
            case Loop.LOADER:
                return bench_law(self.law, self.loader)


def beside_noise(bench: Bench, samples: int, limits: Sequence[Limit]) -> tuple[Limit, ...]:
    """The limits with the noise at rest counted in a motor's default voltage.

    A law makes voltage of the rates of its sensors' noise, whether there is a signal or not.

    Args:
        bench: The loader in its experiment.
        samples: Samples of the signal, so that the noise has as long to peak.
        limits: The limits; one that was stated stays.
    """
    if bench.experiment.loop is not Loop.LOADER or all(_fixed(limit) for limit in limits):
        return tuple(limits)
    peaks = bench.peaks(np.zeros(samples), limits)
    return tuple(limit if _fixed(limit) else limit.beside(peak) for limit, peak in zip(limits, peaks, strict=True))


def _fixed(limit: Limit) -> bool:
    return limit.name != "voltage" or limit.reason == STATED


def fit_to_limits(
    bench: Bench, signal: NDArray[np.float64], limits: Sequence[Limit]
) -> tuple[float, tuple[float, ...]]:
    """The scale at which the largest peak of the nonlinear loader is just within its limit.

    Args:
        bench: The loader in its experiment.
        signal: The signal at scale 1, of about the largest permitted size, (samples,).
        limits: The limits.

    Returns:
        The scale, and the peaks there.

    Raises:
        InputError: If the loader exceeds a limit or diverges at any scale.
    """
    scale, best = 1.0, (0.0, (0.0,) * len(limits))
    for _ in range(_TRIALS):
        peaks = bench.peaks(scale * signal, limits)
        used = max(limit.used(peak) for peak, limit in zip(peaks, limits, strict=True))
        if used <= 1 and scale > best[0]:
            best = scale, peaks
        if NEAR <= used <= 1:
            break
        scale *= float(np.clip(_AIM / max(used, 1 / _MOST_CHANGE**2), 1 / _MOST_CHANGE, _MOST_CHANGE))
    if not best[0]:
        if not np.isfinite(peaks).all():
            raise InputError(
                f"experiment: {bench.experiment} runs away however small the excitation is; its loop is unstable, so take another "
                "or give the law that makes it stable"
            )
        worst = max(zip(peaks, limits, strict=True), key=lambda pair: pair[1].used(pair[0]))
        raise InputError(
            f"limits: {bench.experiment} exceeds the {worst[1].name} of {worst[1].text(worst[1].value, UnitSystem.US)} however "
            f"small the excitation is ({worst[1].text(worst[0], UnitSystem.US)}); raise the limit (--limit-{worst[1].name}) "
            "or take another experiment (--experiment)"
        )
    return best
