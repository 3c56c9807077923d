"""What a controller adds to its command so that a known disturbance of the drive is not felt: data of a law.

``T_k, N_k, phi_k`` harmonics of cogging, as the loader file states them · ``x`` sampled position of the drive's end, ``v``
its last period's difference · ``r`` travel per radian of the motor · ``t`` lead

    e_c = - sum of T_k / K_t sin(N_k (x + v t) / r + phi_k),    t = tau + T / 2 + 1 / w_c + 1 / f_x

The lead takes the motor to where it will be in the middle of the current that the sample makes: delay, half a period of holding,
the lags of current loop and encoder. ``crates/model/src/cancellation.rs`` runs it. A law's observer is not told: to it the motor
has no cogging. Dry friction of the drive, once a law gives it back, belongs here too.
"""

from dataclasses import dataclass
from math import isfinite

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import current_lag_s
from forcefeel.units import show

Harmonic = tuple[float, float, float]
"""Amplitude in A, periods per turn, phase in rad."""

HARMONICS = 2
"""As the motor's table has them."""


@dataclass(frozen=True)
class Cancellation:
    """A drive's known disturbance, as a law gives it back.

    Attributes:
        per_travel_rad_per_m: Angle of the motor per travel of the drive's end.
        lead_s: From the sample to the middle of its current.
        cogging: Two harmonics: current that holds the cogging at its crest, in A, periods per turn, phase in rad.

    Raises:
        InputError: If a number is not finite, the travel or the lead is not above zero, or there are not two harmonics.

    Example:
        >>> from forcefeel.laws.cancellation import Cancellation
        >>> from forcefeel.loader.built_in import BUILT_IN
        >>> yoke = BUILT_IN["desktop-yoke"]()
        >>> Cancellation.of(yoke) is None
        True
        >>> round(Cancellation.of(yoke.replace({"motor.cogging_torque": 0.1})).lead_s * 1e3, 3)
        1.068
    """

    per_travel_rad_per_m: float
    lead_s: float
    cogging: tuple[Harmonic, ...]

    def __post_init__(self) -> None:
        if len(self.cogging) != HARMONICS or any(len(one) != 3 for one in self.cogging):
            raise InputError(
                f"cancellation: expected {HARMONICS} harmonics of amplitude, periods and phase, got {show(self.cogging)}"
            )
        if not (all(map(isfinite, self.numbers)) and self.per_travel_rad_per_m > 0 and self.lead_s > 0):
            raise InputError(
                f"cancellation: expected finite numbers, travel and lead above 0, got {show(self.numbers)}"
            )

    @classmethod
    def of(cls, loader: Loader) -> "Cancellation | None":
        """That of the cogging which a loader file states; ``None`` where it states none."""
        if loader.drive != ELECTRIC or not (loader["motor.cogging_torque"] or loader["motor.cogging_torque_2"]):
            return None
        per_ampere = loader["motor.torque_constant"]
        rows = [[loader[f"motor.cogging_{row}{n}"] for row in ("torque", "periods", "phase")] for n in ("", "_2")]
        return cls(
            per_travel_rad_per_m=1 / loader["transmission.travel"],
            lead_s=current_lag_s(loader),
            cogging=tuple((-torque / per_ampere, periods, phase) for torque, periods, phase in rows),
        )

    @property
    def numbers(self) -> list[float]:
        """As the engine takes them."""
        return [self.per_travel_rad_per_m, self.lead_s, *(number for one in self.cogging for number in one)]
