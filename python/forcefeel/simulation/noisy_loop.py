"""What the sensors' noise does to the column, from the linear loop.

``x+ = M x + N v``, ``v = [F_c; x_p; theta]`` noise of the samples, white, of variance ``V`` · ``P`` covariance of ``x``

    P = M P M' + N V N',    theta = c x

``V`` has ``sigma^2 + d^2 / 12`` for a sensor of noise ``sigma`` and smallest step ``d``: rounding adds nearly white noise where
the sample's own noise is no smaller than some half of the step (B. Widrow, 1956). Converters' steps are left out.

``N`` comes from the step that runs the loop: what a lagging sensor showed a step ago enters a sample by ``exp(-w h)``, as noise
does by one. A sensor without a lag is given one for this alone.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.sensors import sample_variance, sensors_of
from forcefeel.loader.timing import controller_steps

_SHOWN = _core.PERIOD_SHOWN
"""Place among the states of a period of what the first sensor showed; after the commands under way, the base as sampled last, the
load pressure and what the sensors measured (``crates/model/src/machine/period.rs``)."""

_STEP_S = 1e-4
_MOST_DOUBLINGS = 60
_DONE = 1e-14


@dataclass(frozen=True, eq=False)
class NoisyLoop:
    """A loop and how the noise of its sensors enters.

    Attributes:
        matrix: M, (states, states).
        by_sample: N, (states, sensors), per N, m and rad, and per N at the grip.
        variance: Of a sample of each sensor, (sensors,).
        angle: c, (states,), rad.
        period_s: Sample period.
    """

    matrix: NDArray[np.float64] = field(repr=False)
    by_sample: NDArray[np.float64] = field(repr=False)
    variance: NDArray[np.float64]
    angle: NDArray[np.float64] = field(repr=False)
    period_s: float

    @classmethod
    def of(cls, loader: Loader, law: Law) -> "NoisyLoop":
        """The loop of a loader with a digital controller under one law."""
        arm = loader["column.base_arm"]
        units = [1.0, 1.0, arm, 1.0]  # of F_c, x_p, theta at the base, F_g
        matrix, base, by_sample = _matrices(loader, law)
        angle = np.zeros(len(matrix))
        angle[base] = 1 / arm
        return cls(
            matrix, by_sample * units[: by_sample.shape[1]], sample_variance(loader), angle, loader["controller.period"]
        )

    @property
    def stable(self) -> bool:
        """Whether all poles are inside the unit circle."""
        return bool(np.abs(np.linalg.eigvals(self.matrix)).max() < 1)

    def covariance(self) -> NDArray[np.float64]:
        """P of a stable loop, as the sum of ``M^k N V N' M'^k``, twice as many terms at each turn."""
        power = self.matrix
        total = (self.by_sample * self.variance) @ self.by_sample.T
        for _ in range(_MOST_DOUBLINGS):
            more = power @ total @ power.T
            total = total + more
            if np.all(np.diag(more) <= _DONE * np.diag(total)):
                break
            power = power @ power
        return np.asarray(total)

    def angle_rms(self) -> float:
        """R.m.s. of the column's angle in rad; infinite where the loop is not stable."""
        return float(np.sqrt(self.angle @ self.covariance() @ self.angle)) if self.stable else np.inf

    def filtered_rms(self, before: float, now: float, after: float) -> float:
        """R.m.s. of ``before theta(k-1) + now theta(k) + after theta(k+1)``; infinite where the loop is not stable."""
        if not self.stable:
            return np.inf
        c_m = self.angle @ self.matrix
        of_state = before * self.angle + now * c_m + after * (c_m @ self.matrix)
        first = (now * self.angle + after * c_m) @ self.by_sample
        second = after * self.angle @ self.by_sample
        by_noise = (first**2 + second**2) @ self.variance
        return float(np.sqrt(of_state @ self.covariance() @ of_state + by_noise))


def angle_noise_rad(loader: Loader, law: Law) -> float:
    """R.m.s. of the column's angle by the sensors' noise, hands off, in rad.

    Zero of a loader without noise or sampled controller, and of an unstable loop: it moves by itself.
    """
    if not loader["controller.period"] or not any(loader[f"{sensor}.noise"] for sensor in sensors_of(loader)):
        return 0.0
    angle_rms = NoisyLoop.of(loader, law).angle_rms()
    return angle_rms if np.isfinite(angle_rms) else 0.0


def _matrices(loader: Loader, law: Law) -> tuple[NDArray[np.float64], int, NDArray[np.float64]]:
    """M, the place of the base among the states that matter, and N on them, per N, m, m at the base, and per N at the grip."""
    step_s, timing = controller_steps(loader, _STEP_S)
    keys = [f"{sensor}.bandwidth" for sensor in sensors_of(loader)]
    lagging = loader.replace({key: 1 / step_s for key in keys if np.isinf(loader[key])}, si=True)
    keywords = law.engine(loader)
    states, loop = _core.sampled_loops(loader.si_values[np.newaxis], step_s, timing, **keywords)
    wide, lagging_loop = _core.sampled_loops(lagging.si_values[np.newaxis], step_s, timing, **keywords)
    columns = np.zeros((len(states), len(keys)))
    rows = [wide.index(state) for state in states]
    for sensor, key in enumerate(keys):
        if _SHOWN + sensor not in wide:
            continue  # no law asks this sensor
        index = wide.index(_SHOWN + sensor)
        kept = np.exp(-lagging[key] * step_s)
        column = lagging_loop[0, :, index].copy()
        column[index] -= kept ** timing[0]  # what the sensor itself remembers
        columns[:, sensor] = column[rows] / kept
    return loop[0, :, : len(states)], states.index(_core.PERIOD_BASE), columns
