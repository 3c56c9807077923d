"""The modes of a motor on its link by name: what moves in each.

``m``, ``M`` rotor and column as masses at the drive's end · ``v_m``, ``alpha v_b`` their velocities there. A mode is the current
loop's where more than half of it is the current (participation ``l_i r_i`` of its eigenvectors), else what moves more:

    both as one             (m + M) |(m v_m + M alpha v_b) / (m + M)|^2
    against one another     m M / (m + M) |v_m - alpha v_b|^2

Source of the participation factors: I. J. Perez-Arriaga, G. C. Verghese, F. C. Schweppe, Selective Modal Analysis, IEEE Trans.
Power Apparatus and Systems 101 (1982) 3117-3125.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.linear.electric import BASE, BASE_RATE, CURRENT, POSITION, RATE, ElectricPlant
from forcefeel.linear.modes import Mode
from forcefeel.loader.loader import Loader, check_electric

CURRENT_LOOP, ON_THE_LINK, AS_ONE = "current loop", "rotor against column on the link", "rotor and column as one"
COLUMN_ON_LINK, ROTOR_ON_LINK = "column on the link, motor held", "rotor on the link, column held"


@dataclass(frozen=True)
class NamedMode(Mode):
    """A mode and what moves in it.

    Attributes:
        name: What moves.
    """

    name: str


def motor_modes(loader: Loader) -> tuple[NamedMode, ...]:
    """What a motor, its link and its column do by themselves, without a feel: the current loop, and what swings on the link.

    Returns:
        The current loop; rotor against column; the column with the motor held; the rotor with the column held. Two real
        poles of one swing are told as the oscillator of the same product and sum.

    Raises:
        InputError: If ``loader`` is no loader, or has a valve.

    Example:
        >>> for mode in ff.linear.motor_modes(ff.loader.electric("sidestick-roll")):
        ...     print(f"{mode.name}: {mode.frequency_rad_per_s / 6.2832:.1f} Hz, damping ratio {mode.damping_ratio:.2f}")
        current loop: 1000.0 Hz, damping ratio 1.00
        rotor against column on the link: 75.9 Hz, damping ratio 0.16
        column on the link, motor held: 48.7 Hz, damping ratio 0.10
        rotor on the link, column held: 58.2 Hz, damping ratio 0.12
    """
    check_electric(loader, "motor_modes", "linear.servo has what its servo does")
    a = ElectricPlant.of(loader).a
    moving = [POSITION, RATE, BASE, BASE_RATE]
    swings = sorted(np.linalg.eigvals(a[np.ix_(moving, moving)]), key=abs)[2:]  # the others move as one and are slower
    alone = {COLUMN_ON_LINK: [BASE, BASE_RATE], ROTOR_ON_LINK: [POSITION, RATE]}
    pairs = {ON_THE_LINK: swings, **{name: np.linalg.eigvals(a[np.ix_(own, own)]) for name, own in alone.items()}}
    return (
        _named(CURRENT_LOOP, complex(a[CURRENT, CURRENT])),
        *(_oscillator(name, *map(complex, poles)) for name, poles in pairs.items()),
    )


def named_modes(loader: Loader, a: NDArray[np.float64]) -> tuple[NamedMode, ...]:
    """The modes of a motor's model with state matrix ``a``, slowest first, a conjugate pair once."""
    plant = ElectricPlant.of(loader)
    poles, right = np.linalg.eig(a)
    left = np.linalg.inv(right)
    named = [
        _named(_moves(plant, right[:, k], float(abs(left[k, CURRENT] * right[CURRENT, k]))), complex(poles[k]))
        for k in np.argsort(np.abs(poles))
        if poles[k].imag >= 0
    ]
    return tuple(named)


def _moves(plant: ElectricPlant, vector: NDArray[np.complex128], current: float) -> str:
    if current > 0.5:
        return CURRENT_LOOP
    if len(vector) <= BASE_RATE:  # a rigid link
        return AS_ONE
    m, column = plant.rotor_mass, plant.column_mass
    rotor, base = vector[RATE], plant.ratio * vector[BASE_RATE]
    as_one = abs(m * rotor + column * base) ** 2 / (m + column)
    against = m * column / (m + column) * abs(rotor - base) ** 2
    return ON_THE_LINK if against > as_one else AS_ONE


def _named(name: str, s: complex) -> NamedMode:
    return NamedMode(s.real, s.imag, abs(s), -s.real / abs(s) if s else 0.0, name)


def _oscillator(name: str, first: complex, second: complex) -> NamedMode:
    w, mean = float(np.sqrt(abs(first * second))), (first + second).real / 2
    return NamedMode(mean, abs(first.imag), w, -mean / w, name)
