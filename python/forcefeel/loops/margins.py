"""The margins of a loop from its frequency response: what it bears at its command before it is on the edge of stability.

``L`` loop opened at the command · ``S = 1 / (1 + L)`` · ``T`` period · ``p = jw``, or ``e^(jwT)`` of a sampled loop

| margin | is |
|---|---|
| gain | ``-1 / L`` where ``L`` is real and below zero |
| phase | the angle from ``-1`` to ``L`` where ``abs(L) = 1`` |
| delay | the lag that ``L`` bears there, over ``w`` |
| disk | ``a = 1 / max abs(S - 1/2)``: gain and phase together; the gain alone may change by ``(2 + a) / (2 - a)`` either way |

``R(p) = L / (1 + L) = -c (p - M)^-1 b`` of the closed loop, which has no pole where it is asked, is solved at each frequency as it
stands, and ``1 / L = (1 - R) / R``. Polynomials of twenty poles about ``z = 1`` lose the digits that margins are made of.

Source of the disk: P. Seiler, A. Packard, P. Gahinet, An Introduction to Disk Margins, IEEE Control Systems 40 (2020) 78-95.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import balanced, frequency_response
from forcefeel.linear.frequency import crossings
from forcefeel.loops.command_loop import HIGHEST_ANALOG_RAD_PER_S, CommandLoop
from forcefeel.units import ANGLE, HERTZ, RATIO, SECONDS

LOWEST_RAD_PER_S, FREQUENCIES = 1e-3, 1500
"""From where, and how many even steps in proportion, to half the sampling rate."""

_ABOUT_POLE = np.concatenate([-np.geomspace(0.2, 1e-3, 12), [0.0], np.geomspace(1e-3, 0.2, 12)])
"""Frequencies about each pole, as shares of its own: the loop turns fast there."""

_NOTHING = 1e-6
"""A gain that counts as zero: a loop that integrates has a pole at rest without it, but for rounding."""


@dataclass(frozen=True)
class LoopMargins:
    """What a loop bears at its command, one thing at a time, before it is on the edge of stability.

    Attributes:
        gain_up: Factor by which the loop's gain may grow; infinite where it may without end.
        gain_down: Factor to which it may fall; zero where it may fall to nothing.
        phase_rad: Least lag or lead.
        delay_s: Least delay in addition to the controller's own.
        disk: Largest of Seiler, Packard and Gahinet's disks (skew 0), within which gain and phase may change together.
        crossover_rad_per_s: Highest frequency at which the gain is one.
    """

    gain_up: Annotated[float, RATIO]
    gain_down: Annotated[float, RATIO]
    phase_rad: Annotated[float, ANGLE]
    delay_s: Annotated[float, SECONDS]
    disk: Annotated[float, RATIO]
    crossover_rad_per_s: Annotated[float, HERTZ]


def loop_margins(loop: CommandLoop) -> LoopMargins:
    """The margins of a stable loop; all zero, gains one, where it is not stable.

    Example:
        >>> loader = ff.digital_elevator()
        >>> law = ff.Law.of("robust", loader)
        >>> ff.loops.loop_margins(ff.loops.command_loops(loader, law, law.feel)[0]).gain_up > 1
        True
    """
    if not loop.stable:
        return LoopMargins(1.0, 1.0, 0.0, 0.0, 0.0, np.nan)
    seen = _Response(loop)
    w = seen.frequencies()
    inverse = seen.inverse(w)
    gains = seen.edges(w, inverse)
    crossovers = crossings(w, np.log(np.abs(inverse)), lambda frequency: float(np.log(abs(seen.single(frequency)))))
    lags = np.array([np.angle(-1 / seen.single(crossover)) % (2 * np.pi) for crossover in crossovers])
    return LoopMargins(
        gain_up=min((gain for gain in gains if gain > 1), default=np.inf),
        gain_down=max((gain for gain in gains if _NOTHING < gain < 1), default=0.0),
        phase_rad=float(np.minimum(lags, 2 * np.pi - lags).min(initial=np.inf)),
        delay_s=float((lags / np.array(crossovers)).min(initial=np.inf)),
        disk=float(1 / np.abs(inverse / (1 + inverse) - 0.5).max()),
        crossover_rad_per_s=max(crossovers, default=np.nan),
    )


def minimum_margins(margins: Sequence[LoopMargins]) -> LoopMargins:
    """The least of each margin over several loops, and the highest crossover."""
    return LoopMargins(
        gain_up=min(each.gain_up for each in margins),
        gain_down=max(each.gain_down for each in margins),
        phase_rad=min(each.phase_rad for each in margins),
        delay_s=min(each.delay_s for each in margins),
        disk=min(each.disk for each in margins),
        crossover_rad_per_s=max(each.crossover_rad_per_s for each in margins),
    )


class _Response:
    """The frequency response of one closed loop from its command."""

    def __init__(self, loop: CommandLoop) -> None:
        self._period_s = loop.period_s
        self._matrix, scale = balanced(loop.matrix)
        self._c, self._b = loop.command * scale, loop.by_command / scale
        opened = np.linalg.eigvals(self._matrix - np.outer(self._b, self._c))
        self._poles = np.concatenate([loop.poles, opened])

    def frequencies(self) -> NDArray[np.float64]:
        """Where to look: evenly in proportion, and about each pole, opened and closed."""
        if self._period_s is None:
            highest, turning = HIGHEST_ANALOG_RAD_PER_S, np.abs(self._poles.imag)
        else:
            highest, turning = np.pi / self._period_s, np.abs(np.angle(self._poles)) / self._period_s
        about = np.outer(turning[turning > LOWEST_RAD_PER_S], 1 + _ABOUT_POLE).ravel()
        grid = np.union1d(np.geomspace(LOWEST_RAD_PER_S, highest, FREQUENCIES), about)
        return np.asarray(grid[grid <= highest])

    def inverse(self, w: NDArray[np.float64]) -> NDArray[np.complex128]:
        """1 / L at frequencies in rad/s."""
        points = 1j * w if self._period_s is None else np.exp(1j * w * self._period_s)
        return self._solved(np.asarray(points, dtype=np.complex128))

    def single(self, w: float) -> complex:
        """1 / L at one frequency."""
        return complex(self.inverse(np.array([w]))[0])

    def edges(self, w: NDArray[np.float64], inverse: NDArray[np.complex128]) -> list[float]:
        """The factors on the gain at which a pole is on the edge: on the way round, at rest and at half the sampling rate."""
        ends = np.array([0j] if self._period_s is None else [1 + 0j, -1 + 0j])
        turning = [
            self.single(frequency).real
            for frequency in crossings(w, inverse.imag, lambda frequency: self.single(frequency).imag)
        ]
        return [-gain for gain in (*turning, *self._solved(ends).real.tolist())]

    def _solved(self, points: NDArray[np.complex128]) -> NDArray[np.complex128]:
        loop_response = -frequency_response(self._matrix, self._b, self._c, points)
        return np.asarray((1 - loop_response) / loop_response)
