"""What a design is tuned by: weights and noises, in the units of ``plant.Scale``, each a power of the programmed inertia.

A heavy feel moves slowly and a light one fast, so one set of numbers for all does worse than numbers that follow
``I / J``. White noises are densities, so that a tuning means the same at another sample period.
"""

from dataclasses import dataclass, fields, replace

import numpy as np

from forcefeel.errors import InputError

SCHEDULED = (-2.0, 2.0)
"""Decades of I / J over which the numbers follow it; beyond, they stay as at the end."""

STRETCHED = 20.0
"""By how much the square of G / k counts beside one: a feel of a fifth of the link's stiffness nearly doubles a number."""

MOST_DECADES = 20
"""Numbers farther from one drown the others in rounding."""


@dataclass(frozen=True)
class Power:
    """The number ``10^(decades + slope log10(I / J)) [1 + STRETCHED (G / k)^2]^throw (1 + K)^arm``, I / J within ``SCHEDULED``.

    ``G / k`` is the programmed stiffness as a share of the link's at the column: by so much of a release's angle the link is
    stretched, and the energy in it, which goes with the square, throws the column as the hand lets go. ``K`` is the gain of the
    loop that an arm closes over the estimate of its torque, ``SampledPlant.arm_gain``.

    Raises:
        InputError: If decades, slope, throw or arm are beyond ``MOST_DECADES``.

    Example:
        >>> ff.laws.Power(decades=-2.0, slope=0.5).decades
        -2.0
    """

    decades: float
    slope: float = 0.0
    throw: float = 0.0
    arm: float = 0.0

    def __post_init__(self) -> None:
        for name in ("decades", "slope", "throw", "arm"):
            if not abs(getattr(self, name)) <= MOST_DECADES:
                raise InputError(
                    f"{name}: expected a number from -{MOST_DECADES} to {MOST_DECADES}, got {getattr(self, name):g}"
                )

    def at(self, inertia_ratio: float, stretch: float = 0.0, arm_gain: float = 0.0) -> float:
        """The number for a programmed inertia of so many of the column's, a stiffness of so many of the link's, and a gain K."""
        power = self.decades + self.slope * np.clip(np.log10(inertia_ratio), *SCHEDULED)
        return float(10**power * (1 + STRETCHED * stretch**2) ** self.throw * (1 + arm_gain) ** self.arm)

    def times(self, decades: float) -> "Power":
        """The same number so many decades higher."""
        return replace(self, decades=self.decades + decades)

    def towards(self, other: "Power", share: float) -> "Power":
        """Interpolation in decades; the other tuning at a share of one."""
        parts = {
            row.name: (1 - share) * getattr(self, row.name) + share * getattr(other, row.name) for row in fields(self)
        }
        return Power(**parts)


@dataclass(frozen=True)
class Tuning:
    """Weights of the regulator and noises of the observer, in the units of ``plant.Scale``.

    Attributes:
        command_weight: Weight of the squared command beside that of the squared error of the angle, which is one.
        input_noise: Noise at the plant's input, a density. The more of it, the nearer the loop comes to the regulator's
            own margins: loop transfer recovery.
        torque_walk: Random walk of the pilot's torque, per root of time: how fast the observer believes that it changes.
        disturbance_walk: Random walk of the disturbance at the command, likewise: how fast offsets are learned.
        flow_walk: Noise of the valve's flow or the motor's current, a density.
        pressure_noise: Noise of the load cell, as pressure or, of a motor, as force, a density.
        angle_noise: Noise of the column's angle, a density.
        piston_noise: Noise of the position of piston or motor, a density; ``None`` leaves it out. A law with it relies on stiffness
            and ratio of the link too: that position less the column's is the link's stretch.
        rate_weight: Weight of the squared error of the angle's rate; ``None`` for none.

    Example:
        >>> from dataclasses import replace
        >>> from forcefeel.laws.sampled.tuning import OBSERVER
        >>> replace(OBSERVER, command_weight=ff.laws.Power(-3.0)).command_weight.decades
        -3.0
    """

    command_weight: Power
    input_noise: Power
    torque_walk: Power
    disturbance_walk: Power
    flow_walk: Power
    pressure_noise: Power
    angle_noise: Power
    piston_noise: Power | None = None
    rate_weight: Power | None = None

    def __post_init__(self) -> None:
        for row in fields(self):
            given, optional = getattr(self, row.name), row.default is None
            if not (isinstance(given, Power) or (optional and given is None)):
                raise InputError(f"{row.name}: expected a Power{' or None' if optional else ''}, got {given!r}")

    def towards(self, other: "Tuning", share: float) -> "Tuning":
        """Interpolation, number by number; a number that this tuning leaves out stays out."""
        given = {row.name: getattr(self, row.name) for row in fields(self)}
        between = {
            name: power.towards(getattr(other, name), share) for name, power in given.items() if power is not None
        }
        return replace(self, **between)


OBSERVER = Tuning(
    command_weight=Power(-3.03),
    input_noise=Power(-1.97),
    torque_walk=Power(-1.94),
    disturbance_walk=Power(-2.65),
    flow_walk=Power(-3.88),
    pressure_noise=Power(-4.91),
    angle_noise=Power(-5.99),
    piston_noise=Power(-5.99),
)
"""Every sensor trusted and hardly any noise at the plant's input: good on the plant that it was made for."""

RECOVERED = replace(OBSERVER, input_noise=Power(0.03))
"""The same with a hundred times the noise at the plant's input."""

MOTOR_RATE_WEIGHT = Power(-0.7)
"""Weight of the rate error in both designs for a motor, which lacks the oil that damps a valve's column. Without it, the
stretched link throws the column of a heavy feel at release, and a light feel overshoots if friction is higher than stated.
Over 40 machines drawn from ``elevator-electric`` with 1 lb, 95.9 % of the settings pass instead of 95.2 %, and 90.8 %
instead of 89.9 % after a drift of the friction by a fifth. At -1 and -0.4 decades: 95.7 and 95.8 %, 91.0 and 91.3 %."""
