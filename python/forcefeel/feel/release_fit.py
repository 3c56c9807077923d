"""Frequency and damping from a recorded release: the programmed feel alone, simulated, through the samples by least squares.

The engine moves the feel with its curve, breakout and friction, so that friction does not count as damping.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import feel_from_frequency
from forcefeel.errors import InputError
from forcefeel.feel.plan import FeelPlan
from forcefeel.feel.result import ReleaseFit
from forcefeel.loader.loader import Loader
from forcefeel.qualification import Record, measure_release
from forcefeel.qualification.plan.feel_alone import FeelAlone
from forcefeel.qualification.plan.motions import Motions
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.units import HERTZ, UnitSystem, to_text

_Array = NDArray[np.float64]

_SAMPLE_S = 2e-3
"""Time between samples of the simulated release."""
_STEP = 1e-3
"""Relative step of the sensitivities, above the engine's error of stepping."""
_STIFF = 60.0
"""Largest ratio of the natural frequency to that of the first guess, and its inverse the smallest."""
_MOST_RATIO = 5.0
"""Largest damping ratio."""
_RATIOS = np.geomspace(0.3, 4.0, 14)
"""Damping ratios that are tried for a bound."""
_KNOWN = 0.1
"""Largest relative half interval of a frequency from a release without overshoot."""
_QUANTILE = 1.96
"""Standard uncertainties that hold the true value with 95 %; a record has many samples."""


def fit_release(loader: Loader, plan: FeelPlan) -> ReleaseFit:
    """Frequency and damping of the release of a plan.

    Args:
        loader: The loader with the fitted feel at rest.
        plan: The request, with a release.

    Raises:
        InputError: If there is no release in the record, or it does not oscillate and neither frequency nor damping is stated.
    """
    assert plan.release is not None  # the caller asks for it
    features = measure_release(plan.release)
    released = _Released(loader, plan, features)
    numbers, uncertainty, scatter = released.fitted()
    values = dict(zip(released.names, zip(numbers.tolist(), uncertainty.tolist(), strict=True), strict=True))
    if not features.underdamped and {"frequency", "ratio"} <= values.keys():
        ratio, known = values["ratio"]
        # Dry friction may hold a feel before it overshoots; its first movement then tells the frequency.
        if ratio + known >= 1 or values["frequency"][1] > _KNOWN:
            raise InputError(released.without_swing())
    frequency, stated_ratio = plan.frequency_rad_per_s, plan.damping_ratio
    if frequency is None:
        log_frequency, known = values["frequency"]
        frequency = math.exp(log_frequency)
        of_frequency = frequency, frequency * known
    else:
        of_frequency = frequency, None
    time, angle = released.moved(numbers)
    return ReleaseFit(
        plan.release,
        of_frequency,
        values["ratio"] if stated_ratio is None else (stated_ratio, None),
        values["offset"][0],
        time,
        angle,
        scatter,
    )


@dataclass(frozen=True, eq=False)
class _Released:
    """A recorded release and the programmed feel."""

    loader: Loader
    plan: FeelPlan
    features: ReleaseFeatures

    @property
    def record(self) -> Record:
        assert self.plan.release is not None  # as above
        return self.plan.release

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The unknowns: logarithm of the frequency, damping ratio, shift of time in s, offset of the position in rad."""
        open_ = {"frequency": self.plan.frequency_rad_per_s is None, "ratio": self.plan.damping_ratio is None}
        return (*(name for name, unknown in open_.items() if unknown), "shift", "offset")

    @cached_property
    def start(self) -> dict[str, float]:
        """First guess, by the cycles, or by the fall time if there are none."""
        features = self.features
        period = features.cycles[1].value if len(features.cycles) > 1 else 4 * features.fall_time.value
        overshoot = features.overshoots[0].value / abs(features.displacement.value) if features.overshoots else 0.0
        decay = -math.log(min(max(overshoot, 1e-3), 0.95))
        ratio = decay / math.hypot(math.pi, decay) if features.underdamped else 1.0
        frequency = 2 * math.pi / period / math.sqrt(max(1 - ratio**2, 0.1))
        offset = features.steady.value if not self.loader["feel.coulomb_friction"] else 0.0
        return {"frequency": math.log(frequency), "ratio": ratio, "shift": 0.0, "offset": offset}

    @cached_property
    def window(self) -> NDArray[np.bool_]:
        """Samples after the release."""
        mask: NDArray[np.bool_] = self.record.time_s >= self.features.release_s.value
        return mask

    def candidate(self, log_frequency: float, ratio: float) -> Loader:
        """The loader with another frequency and damping ratio."""
        inertia, damping = feel_from_frequency(math.exp(log_frequency), ratio, self.loader["feel.stiffness"])
        return self.loader.replace({"feel.inertia": inertia, "feel.damping": damping}, si=True)

    def moved(self, numbers: _Array) -> tuple[_Array, _Array]:
        """Times and positions of the feel's release, as the record has them."""
        named = dict(zip(self.names, numbers.tolist(), strict=True))
        frequency, ratio = self.plan.frequency_rad_per_s, self.plan.damping_ratio
        log_frequency = named["frequency"] if frequency is None else math.log(frequency)
        loader = self.candidate(log_frequency, named["ratio"] if ratio is None else ratio)
        held = self.features.steady.value + self.features.displacement.value
        lasts = float(self.record.time_s[-1]) - self.features.release_s.value + 0.2
        release = Motions(None, _SAMPLE_S).release(FeelAlone(loader), held - named["offset"], lasts, "programmed feel")
        assert release.release_s is not None  # it is simulated
        later = self.features.release_s.value + named["shift"] - release.release_s
        return release.time_s + later, release.position + named["offset"]

    def residual(self, numbers: _Array) -> _Array:
        """The feel's position minus the record's, as a share of the displacement."""
        time, angle = self.moved(numbers)
        at = self.record.time_s[self.window]
        missed = np.interp(at, time, angle) - self.record.position[self.window]
        return np.asarray(missed / abs(self.features.displacement.value))

    def fitted(self) -> tuple[_Array, _Array, float]:
        """The unknowns, halves of their intervals, and the scatter in rad."""
        run = self._run(self.residual, self.names)
        missed = run.fun
        squares = float(missed @ missed)
        # Residuals of neighbors are correlated where the feel differs from the aircraft's.
        alike = float(np.clip(missed[1:] @ missed[:-1] / max(squares, 1e-30), 0.0, 1 - 1 / len(missed)))
        variance = squares / max(len(missed) - len(run.x), 1) * (1 + alike) / (1 - alike)
        covariance = np.linalg.pinv(run.jac.T @ run.jac) * variance
        scatter = math.sqrt(squares / len(missed)) * abs(self.features.displacement.value)
        return run.x, _QUANTILE * np.sqrt(np.diag(covariance)), scatter

    def _run(self, residual: Callable[[_Array], _Array], names: tuple[str, ...]) -> Any:
        from scipy.optimize import least_squares  # noqa: PLC0415  SciPy waits until there is a record

        start, swing = self.start, abs(self.features.displacement.value)
        reach = {"frequency": math.log(_STIFF), "shift": self.features.fall_time.value, "offset": swing / 2}
        low = [0.0 if name == "ratio" else start[name] - reach[name] for name in names]
        high = [_MOST_RATIO if name == "ratio" else start[name] + reach[name] for name in names]
        scale = {"frequency": 0.1, "ratio": 0.1, "shift": 0.01, "offset": 0.01 * swing}
        # SciPy steps relative to each number, and an offset may be zero: it moves multiples of the scales.
        sizes = np.array([scale[name] for name in names])
        begin = np.array([start[name] for name in names])
        run = least_squares(
            lambda moved: residual(begin + sizes * (moved - 1)),
            np.ones(len(names)),
            bounds=((np.array(low) - begin) / sizes + 1, (np.array(high) - begin) / sizes + 1),
            diff_step=_STEP,
            xtol=1e-6,
            ftol=1e-9,
            max_nfev=40,
        )
        run.x = begin + sizes * (run.x - 1)
        run.jac = run.jac / sizes
        return run

    def without_swing(self) -> str:
        """That a release does not oscillate, with the bound that it gives on the damping ratio."""
        names = tuple(name for name in self.names if name != "ratio")
        costs = []
        for ratio in _RATIOS.tolist():

            def at(numbers: _Array, ratio: float = ratio) -> _Array:
                return self.residual(np.insert(numbers, self.names.index("ratio"), ratio))

            costs.append(2 * float(self._run(at, names).cost))
        least, count = min(costs), int(self.window.sum())
        good = np.array(costs) <= least * (1 + _QUANTILE**2 * 2 / max(count - len(names), 1)) + 1e-12 * count
        bound = float(_RATIOS[int(np.argmax(good))])
        slow = HERTZ.from_si(math.exp(self.start["frequency"]), UnitSystem.SI)
        return (
            f"{self.record.name}: does not oscillate; it only bounds the damping ratio, at least {to_text(bound, 2)}, and leaves "
            f"the frequency open (near {to_text(slow, 2)} Hz by its fall time); expected an overshoot; state --frequency, then the "
            "damping ratio follows from the release, or state --frequency and --damping and leave the release out"
        )
