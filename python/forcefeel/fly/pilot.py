"""A pilot by the crossover model.

``Y_p = K (1 + T_L s + 1 / (T_I s)) e^(-tau s) / (s^2 / w_n^2 + 2 zeta_n s / w_n + 1)``

`K` gain, N per unit of the error · `T_L` lead · `T_I` time of the slow trimming term · `tau` effective delay of seeing and
deciding · `w_n`, `zeta_n` neuromuscular lag of the arm.

Near the crossover frequency pilot and aircraft together are `Y_p Y_c = w_c e^(-tau s) / s`: the gain is `w_c` over that of the
aircraft.

Source: D. T. McRuer and E. S. Krendel, Mathematical Models of Human Pilot Behavior, AGARD-AG-188 (1974).
"""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from forcefeel.fly.aircraft import FRAME_S

_DELAY_S = 0.2
_ARM_RAD_PER_S, _ARM_DAMPING = 15.0, 0.7
_PARTS = 2
"""Steps of the arm in a frame."""


@dataclass
class CrossoverPilot:
    """A pilot that holds a quantity.

    Attributes:
        error: The error from the time and what the pilot sees.
        gain: Force for a unit of the error, N.
        lead_s: Lead.
        integral_s: Time of the slow trimming term.
        known_n: Force that the pilot knows to be right at a time, as by practice; the error corrects it.

    Example:
        >>> pilot = ff.fly.CrossoverPilot(lambda time, seen: 1.2 - seen["load_factor"], -10.0, 0.0, 1.0)
        >>> round(pilot(0.0, {"load_factor": 1.0}), 3) + 0  # the delay is not over
        0.0
    """

    error: Callable[[float, Mapping[str, float]], float]
    gain: float
    lead_s: float
    integral_s: float
    known_n: Callable[[float], float] = lambda _: 0.0

    def __post_init__(self) -> None:
        self._seen = deque([0.0] * round(_DELAY_S / FRAME_S))
        self._last: float | None = None
        self._sum = 0.0
        self._arm = [self.known_n(0.0), 0.0]

    def __call__(self, time_s: float, seen: Mapping[str, float]) -> float:
        """Force of the hand, N, at a frame."""
        error = self.error(time_s, seen)
        rate = 0.0 if self._last is None else (error - self._last) / FRAME_S
        self._last = error
        self._sum += error * FRAME_S
        self._seen.append(self.gain * (error + self.lead_s * rate + self._sum / self.integral_s))
        wanted = self.known_n(time_s) + self._seen.popleft()
        h = FRAME_S / _PARTS
        for _ in range(_PARTS):
            force, speed = self._arm
            speed += h * _ARM_RAD_PER_S * (_ARM_RAD_PER_S * (wanted - force) - 2 * _ARM_DAMPING * speed)
            self._arm = [force + h * speed, speed]
        return self._arm[0]
