"""The pilot's torque by an H-infinity filter: the least error under the worst disturbance, in place of the least on average.

As ``observer``, with the same signals, but what is not known is a signal of bounded energy and not noise: ``w = W^1/2 n_w`` on
plant, torque and disturbance, ``v = R^1/2 n_v`` on what is sampled, ``n`` whatever hurts most. The filter keeps the gain from
``n`` to the error of the torque's estimate ``M xi^`` below gamma at every frequency,

    sum of  |T_p - T_p^|^2  <  gamma^2 (sum of  |n_w|^2 + |n_v|^2)

    P = A (P^-1 + C' R^-1 C - gamma^-2 M' M)^-1 A' + W,    gamma^2 > M (P^-1 + C' R^-1 C)^-1 M'
    L = P C' (R + C P C')^-1

B. Hassibi, A. H. Sayed, T. Kailath, Linear Estimation in Krein Spaces - Part II: Applications, IEEE Trans. Automatic Control 41
(1996) 34-49. With gamma without end it is the Kalman filter. The feel computer is driven by this estimate and by nothing else, so
that a bound on it, over all frequencies, is one on what the model's errors do to the feel. Regulator and feed-forward are those
of ``laws``.
"""

from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.laws.sampled.observer import observed, process_noise, readings, sensor_noise
from forcefeel.laws.sampled.observer_law import Gains, design_with
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.regulator import regulate
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.laws.sampled.tuning import OBSERVER, Power, Tuning
from forcefeel.linear.riccati import residual, stationary
from forcefeel.loader.loader import Loader

ABOVE_LEAST = 1.05
"""gamma beside the least that any filter reaches: at the least itself the equation is singular."""

FOUND = 1e-3
"""Share of the least gamma to which it is found."""

_MOST_DOUBLINGS = 20
"""Of gamma, from the Kalman filter's own deviation of the torque, before there is held to be none."""

_ROUNDING = 1e-9
"""Of the least eigenvalue of P, beside one."""

H_INFINITY = replace(
    OBSERVER,
    piston_noise=None,
    input_noise=Power(1.0),
    torque_walk=Power(-0.25),
    disturbance_walk=Power(-1.3),
    angle_noise=Power(-6.5),
)
"""Without the potentiometer, with much disturbance at the plant's input and a quick torque; the same for every feel. By hand, on
the elevator at 2 kHz with one sample of delay: some forty trials on two to nine dozen settings. The numbers matter more than
gamma: a Kalman filter with the same ones, and a torque that is quicker by a quarter of a decade, renders as many settings."""


@dataclass(frozen=True, eq=False)
class TorqueFilter:
    """The filter, in the units of the plant, and how well it is proved.

    Attributes:
        gains: L, (m, 3), on what is sampled: F_c, x_p, theta; the column of what is not trusted is zero.
        matrix: P of x, T_p, d before the sample, (m - 1, m - 1).
        level: gamma.
        least: The least gamma, to ``FOUND``.
        riccati_residual: Residual of the Riccati equation, as a share of P.
    """

    gains: NDArray[np.float64] = field(repr=False)
    matrix: NDArray[np.float64] = field(repr=False)
    level: float
    least: float
    riccati_residual: float


@dataclass(frozen=True, eq=False)
class Filtering:
    """What a filter is made for: ``xi+ = A xi + w``, ``y = C xi + v``, in the units of the plant.

    Attributes:
        transition: A of x, T_p, d, (m - 1, m - 1).
        reads: C of the trusted sensors, (trusted, m - 1).
        process: W, (m - 1, m - 1).
        sensors: R, (trusted, trusted).
        trusted: Which of F_c, x_p, theta those are.
        torque: Place of T_p.
    """

    transition: NDArray[np.float64] = field(repr=False)
    reads: NDArray[np.float64] = field(repr=False)
    process: NDArray[np.float64] = field(repr=False)
    sensors: NDArray[np.float64] = field(repr=False)
    trusted: list[int]
    torque: int

    @classmethod
    def of(cls, plant: SampledPlant, tuning: Tuning, inertia_ratio: float) -> "Filtering":
        """What the observer is made for, with the same tuning."""
        noise, trusted = sensor_noise(plant, tuning, inertia_ratio)
        estimated = plant.places.estimated
        return cls(
            transition=observed(plant)[estimated, estimated],
            reads=readings(plant)[trusted][:, estimated],
            process=process_noise(plant, tuning, inertia_ratio),
            sensors=np.diag(noise**2),
            trusted=trusted,
            torque=plant.places.torque,
        )

    def matrix(self, level: float) -> NDArray[np.float64]:
        """P for a gamma; for an infinite one the Kalman filter's covariance.

        Raises:
            numpy.linalg.LinAlgError: If no filter keeps the gain below it, or none in double precision.
        """
        p, _ = stationary(self.transition.T, *self._equation(level))
        unit = np.sqrt(np.abs(np.diag(p)))
        if not (
            np.linalg.eigvalsh(p / np.outer(unit, unit)).min() > -_ROUNDING
            and self._updated(p)[self.torque, self.torque] < level**2
        ):
            raise np.linalg.LinAlgError("H-infinity filter: gamma is too small")
        return p

    def gains(self, p: NDArray[np.float64]) -> NDArray[np.float64]:
        """L, (m - 1, trusted)."""
        return np.asarray(np.linalg.solve(self.sensors + self.reads @ p @ self.reads.T, self.reads @ p)).T

    def residual(self, level: float, p: NDArray[np.float64]) -> float:
        """How far ``p`` is from solving the equation, as a share of its largest number."""
        return residual(self.transition.T, *self._equation(level), p)

    def least(self) -> float:
        """The least gamma, to ``FOUND``: bisection between one that there is no filter for and one that there is.

        Raises:
            numpy.linalg.LinAlgError: If there is no filter at all in double precision.
        """
        # With the sample, the Kalman filter's deviation: P grows as gamma falls, so gamma is above it.
        below = float(np.sqrt(self._updated(self.matrix(np.inf))[self.torque, self.torque]))
        above = 2 * below
        for _ in range(_MOST_DOUBLINGS):
            if self._reached(above):
                break
            below, above = above, 2 * above
        else:
            raise np.linalg.LinAlgError("H-infinity filter: no gamma is large enough")
        while above > (1 + FOUND) * below:
            middle = float(np.sqrt(below * above))
            below, above = (below, middle) if self._reached(middle) else (middle, above)
        return above

    def _reached(self, level: float) -> bool:
        try:
            self.matrix(level)
        except np.linalg.LinAlgError:
            return False
        return True

    def _equation(self, level: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The equation as a Riccati equation's b, q, r: the torque as one more sensor, of variance ``-gamma^2``."""
        if np.isinf(level):
            return self.reads.T, self.process, self.sensors
        torque = np.eye(1, len(self.process), self.torque)
        r = np.diag(np.append(np.diag(self.sensors), -(level**2)))
        return np.vstack([self.reads, torque]).T, self.process, r

    def _updated(self, p: NDArray[np.float64]) -> NDArray[np.float64]:
        """``(P^-1 + C' R^-1 C)^-1``: P with the sample."""
        return np.asarray(p - self.gains(p) @ self.reads @ p)


def filter_torque(plant: SampledPlant, tuning: Tuning, inertia_ratio: float) -> TorqueFilter:
    """The filter for a programmed inertia of so many of the column's, at ``ABOVE_LEAST``.

    Raises:
        numpy.linalg.LinAlgError: If it has no solution in double precision.
    """
    made_for = Filtering.of(plant, tuning, inertia_ratio)
    least = made_for.least()
    level = ABOVE_LEAST * least
    p = made_for.matrix(level)
    gains = np.zeros((plant.places.observed, len(readings(plant))))
    gains[plant.places.estimated, made_for.trusted] = made_for.gains(p)
    return TorqueFilter(gains, p, level, least, made_for.residual(level, p))


def design(loader: Loader, feel: ArrayLike, tuning: Tuning = H_INFINITY) -> SampledLaw:
    """The laws for many settings of one loader; arguments, returns and errors as ``laws.design``."""
    return design_with(_gains, loader, feel, tuning)


def _gains(plant: SampledPlant, feel: NDArray[np.float64], loader: Loader, tuning: Tuning) -> Gains:
    """The gains of each setting; the equations once for each set of numbers that the tuning comes to."""
    ratios = feel[:, 0] / loader["column.inertia"]
    powers = [power for row in fields(tuning) if (power := getattr(tuning, row.name)) is not None]
    numbers = np.array([[power.at(ratio) for power in powers] for ratio in ratios.tolist()])
    _, first, of_setting = np.unique(numbers, axis=0, return_index=True, return_inverse=True)
    regulators = np.array([regulate(plant, tuning, ratio).gains for ratio in ratios[first].tolist()])
    filters = np.array([filter_torque(plant, tuning, ratio).gains for ratio in ratios[first].tolist()])
    return Gains(regulators[of_setting], filters[of_setting])
