"""What a controller adds to its command so that a known disturbance of the drive is not felt: data of a law.

``T_k, N_k, phi_k`` harmonics of cogging, as the loader file states them · ``x`` sampled position of the drive's end, ``v``
its last period's difference · ``r`` travel per radian of the motor · ``t`` lead · ``T_c`` dry friction of the motor · ``delta'``
programmed rate, ``w_s`` slow

    e_c = T_c / K_t delta' / sqrt(delta'^2 + w_s^2)
          - sum of T_k / K_t sin(N_k (x + v t) / r + phi_k),    t = tau + T / 2 + 1 / w_c + 1 / f_x

The lead takes the motor to where it will be in the middle of the current that the sample makes: delay, half a period of holding,
the lags of current loop and encoder. The friction goes with the programmed rate, which the motor follows. ``crates/model/src/
cancellation.rs`` runs it. A law's observer is not told: to it the motor has neither.
"""

from dataclasses import dataclass
from math import isfinite

from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import current_lag_s
from forcefeel.loader.tolerances import ASSUMED
from forcefeel.units import show

Harmonic = tuple[float, float, float]
"""Amplitude in A, periods per turn, phase in rad."""

HARMONICS = 2
"""As the motor's table has them."""

SLOW_RAD_PER_S = 2e-2
"""w_s of the column: below it the friction is given back in proportion, so that noise does not make it chatter."""


@dataclass(frozen=True)
class Cancellation:
    """A drive's known disturbance, as a law gives it back.

    Attributes:
        per_travel_rad_per_m: Angle of the motor per travel of the drive's end.
        lead_s: From the sample to the middle of its current.
        cogging: Two harmonics: current that holds the cogging at its crest, in A, periods per turn, phase in rad.
        friction_a: Current that overcomes the least dry friction that the motor may have: too much would drive it on.
        slow_rad_per_s: Rate of the column below which it is given back in proportion.

    Raises:
        InputError: If a number is not finite, travel, lead or slow rate is not above zero, or there are not two harmonics.

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
    friction_a: float = 0.0
    slow_rad_per_s: float = SLOW_RAD_PER_S

    def __post_init__(self) -> None:
        if len(self.cogging) != HARMONICS or any(len(harmonic) != 3 for harmonic in self.cogging):
            raise InputError(
                f"cancellation: expected {HARMONICS} harmonics of amplitude, periods and phase, got {show(self.cogging)}"
            )
        if not (
            all(map(isfinite, self.numbers)) and min(self.per_travel_rad_per_m, self.lead_s, self.slow_rad_per_s) > 0
        ):
            raise InputError(
                f"cancellation: expected finite numbers, travel, lead and slow rate above 0, got {show(self.numbers)}"
            )

    @classmethod
    def of(cls, loader: Loader) -> "Cancellation | None":
        """That of the cogging and the motor's dry friction which a loader file states; ``None`` where it states none."""
        known = ("motor.cogging_torque", "motor.cogging_torque_2", "motor.coulomb_friction")
        if loader.drive != ELECTRIC or not any(loader[row] for row in known):
            return None
        per_ampere = loader["motor.torque_constant"]
        rows = [[loader[f"motor.cogging_{row}{n}"] for row in ("torque", "periods", "phase")] for n in ("", "_2")]
        return cls(
            per_travel_rad_per_m=1 / loader["transmission.travel"],
            lead_s=current_lag_s(loader),
            cogging=tuple((-torque / per_ampere, periods, phase) for torque, periods, phase in rows),
            friction_a=_least_friction(loader) / per_ampere,
            slow_rad_per_s=SLOW_RAD_PER_S,
        )

    @property
    def numbers(self) -> list[float]:
        """As the engine takes them."""
        cogging = (number for harmonic in self.cogging for number in harmonic)
        return [self.per_travel_rad_per_m, self.lead_s, *cogging, self.friction_a, self.slow_rad_per_s]


def _least_friction(loader: Loader) -> float:
    """The motor's dry friction in N m at the lower end of its tolerance, stated or assumed."""
    key = "motor.coulomb_friction"
    if key in loader.tolerances:
        return min(max(loader.tolerances[key].ends[0], 0.0), loader[key])
    return (1 - ASSUMED) * loader[key]
