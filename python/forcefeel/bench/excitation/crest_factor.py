"""Phases of a multisine with low peaks in several signals at once: valve current, travel and force.

Minimize ``L_p = (mean over time and signals of |y_c / limit_c|^2p)^(1/2p)`` over the phases, for rising p: it goes to the largest
peak in shares of its limit. It starts from the best of some multisines that were clipped for one signal each.

Source: P. Guillaume, J. Schoukens, R. Pintelon and I. Kollar, Crest-Factor Minimization Using Nonlinear Chebyshev Approximation
Methods, IEEE Trans. Instrumentation and Measurement 40 (1991).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len
from scipy.optimize import minimize

from forcefeel.simulation.inputs import Multisine

_SEEDS = range(1977, 1981)  # of the clipped multisines; the same spectrum gives the same signal
_POWERS = (8, 32)  # p; a larger one lowers the peaks by 1 % more in twice the time
_ITERATIONS = 200
_POINTS = 8  # per cycle of the highest line


@dataclass(frozen=True, eq=False)
class PeakProblem:
    """Signals whose peaks are minimized.

    Attributes:
        harmonics: Cycles of each line in a period, rising, (lines,).
        amplitude: Amplitudes of the signals' lines with their own phase, in shares of their limits, (signals, lines), complex.
    """

    harmonics: NDArray[np.int64]
    amplitude: NDArray[np.complex128]

    def waves(self, phases: NDArray[np.float64]) -> NDArray[np.float64]:
        """The signals over one period at phases (lines,), (signals, points)."""
        points = next_fast_len(_POINTS * int(self.harmonics[-1]), real=True)
        spectrum = np.zeros((len(self.amplitude), points // 2 + 1), dtype=np.complex128)
        spectrum[:, self.harmonics] = self.amplitude * np.exp(1j * phases) * points / 2
        return np.fft.irfft(spectrum, points, axis=1)

    def peak(self, phases: NDArray[np.float64]) -> float:
        """The largest peak, as a share of its limit."""
        return float(np.abs(self.waves(phases)).max())

    def norm(self, phases: NDArray[np.float64], p: int) -> tuple[float, NDArray[np.float64]]:
        """The value of ln L_p and its slope by the phases, (lines,)."""
        y = self.waves(phases)
        largest = float(np.abs(y).max())
        z = y / largest
        mean = float(np.mean(z ** (2 * p)))
        by_value = z ** (2 * p - 1) / (largest * mean * y.size)
        # y = Re sum a exp(j phi) exp(j w t), so the slope by phi is sum over t of by_value Re(j a exp(j phi) exp(j w t)).
        spectrum = np.fft.rfft(by_value, axis=1)[:, self.harmonics].conj()
        slope = np.sum(np.real(1j * self.amplitude * np.exp(1j * phases) * spectrum), axis=0)
        return float(np.log(mean) / (2 * p) + np.log(largest)), slope


def low_crest_phases(problem: PeakProblem) -> NDArray[np.float64]:
    """Phases at which the largest of the peaks is low, rad, (lines,)."""
    phases = min((phase for k in range(len(problem.amplitude)) for phase in _clipped(problem, k)), key=problem.peak)
    for p in _POWERS:
        solution = minimize(
            problem.norm, phases, args=(p,), jac=True, method="L-BFGS-B", options={"maxiter": _ITERATIONS}
        )
        phases = min(phases, solution.x, key=problem.peak)
    return phases


def _clipped(problem: PeakProblem, signal: int) -> list[NDArray[np.float64]]:
    """Phases of multisines that were clipped for one signal."""
    weights = np.abs(problem.amplitude[signal])
    lines, relative = tuple(problem.harmonics.astype(float)), tuple(weights / weights.max())
    turned = np.angle(problem.amplitude[signal])
    return [Multisine(1.0, lines, 1.0, seed, relative).phases_rad - turned for seed in _SEEDS]
