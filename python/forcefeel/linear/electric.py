"""The plant of an electric loader as matrices, and the feel by current alone, which is what its motor does without a law.

``x_m`` drive's end · ``i`` current, ``e`` its command · ``x_b`` base of the column · ``F`` force on the link · ``alpha R_b``
travel of the drive's end per radian of the column · ``r`` travel per radian of the motor · ``K_t`` torque constant · ``J_m``,
``J`` inertia of rotor and column

The matrices are the exact Jacobian of the engine's equations; nothing here repeats them.

**Rigid link.** The link's force enters along one direction, ``A = A_0 + b_F c_F``, ``F = c_F x``. Where the link does not give it
is what keeps ``x_m = alpha x_b``:

    w (A_0 x + B u + b_F F) = 0,      w x = x_m' - alpha x_b'

**Feel by current alone.** Spring and damper of the programmed feel by the motor's torque at its own position, continuous in time;
no load cell, no observer. The inertia that is felt is then the machine's, and the link is in series with G:

    e = -(r / K_t) (G x_m + B x_m') / (alpha R_b)^2
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.loader import Loader

STATES = (
    "drive_position_m",
    "drive_velocity_m_per_s",
    "motor_current_a",
    "base_position_m",
    "base_velocity_m_per_s",
)
"""Of the plant; a rigid link leaves the first three."""

OUTPUTS = (
    "column_angle_rad",
    "drive_position_m",
    "load_cell_force_n",
    "motor_current_a",
    "motor_voltage_v",
    "motor_speed_rad_per_s",
)

POSITION, RATE, CURRENT, BASE, BASE_RATE = range(len(STATES))
_ANGLE, _FORCE = OUTPUTS.index("column_angle_rad"), OUTPUTS.index("load_cell_force_n")
_OWN = slice(0, BASE)
"""The drive's own states."""

_Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ElectricPlant:
    """``x' = A x + B [F_p, e]``, ``y = C x + D [F_p, e]`` of motor, transmission, link and column, limits and friction left out.

    Attributes:
        a, b, c, d: A, B, C, D.
        ratio, lever: ``alpha``, and ``alpha R_b`` in m/rad.
        force_per_ampere: ``K_t / r`` in N/A.
        stiffness: Of link and transmission in N/m.
        rotor_mass, column_mass: ``J_m / r^2`` and ``J / (alpha R_b)^2`` in kg, as masses at the drive's end.
    """

    a: _Matrix
    b: _Matrix
    c: _Matrix
    d: _Matrix
    ratio: float
    lever: float
    force_per_ampere: float
    stiffness: float
    rotor_mass: float
    column_mass: float

    @classmethod
    def of(cls, loader: Loader, *, rigid: bool = False) -> "ElectricPlant":
        """The plant of an electric loader."""
        a, b, c, d = _core.electric_plant(loader.si_values)
        stiffness = c[_FORCE, POSITION]
        ratio = -c[_FORCE, BASE] / stiffness
        by_force = np.zeros(len(a))
        # What the drive's position does to either mass, it does through the link.
        by_force[[RATE, BASE_RATE]] = a[[RATE, BASE_RATE], POSITION] / stiffness
        matrices = _rigid((a, b, c, d), by_force, ratio) if rigid else (a, b, c, d)
        return cls(
            *matrices,
            ratio=float(ratio),
            lever=float(ratio / c[_ANGLE, BASE]),
            force_per_ampere=float(-a[RATE, CURRENT] / by_force[RATE]),
            stiffness=float(stiffness),
            rotor_mass=float(-1 / by_force[RATE]),
            column_mass=float(1 / (ratio * by_force[BASE_RATE])),
        )

    @property
    def states(self) -> tuple[str, ...]:
        """Names of its states."""
        return STATES[: len(self.a)]

    def feel_by_current(self, loader: Loader) -> _Matrix:
        """The row ``K`` of ``e = -K x``, (states,), A per state."""
        per_travel = 1 / (self.lever**2 * self.force_per_ampere)
        row = np.zeros(len(self.a))
        row[POSITION], row[RATE] = (per_travel * loader[key] for key in ("feel.stiffness", "feel.damping"))
        return row

    def column_held(self) -> "ElectricPlant":
        """The motor on a link whose other end a firm hand holds still."""
        return replace(self, a=self.a[_OWN, _OWN], b=self.b[_OWN], c=self.c[:, _OWN])


def _rigid(
    matrices: tuple[_Matrix, _Matrix, _Matrix, _Matrix], by_force: _Matrix, ratio: float
) -> tuple[_Matrix, _Matrix, _Matrix, _Matrix]:
    """The plant with both ends of the link moving as one: states ``x_m, x_m', i``."""
    a, b, c, d = matrices
    free = a - np.outer(by_force, c[_FORCE])
    apart = np.zeros(len(a))
    apart[[RATE, BASE_RATE]] = 1.0, -ratio
    force, direct = (-(apart @ part) / (apart @ by_force) for part in (free, b))
    whole = np.eye(len(a))[:, _OWN]
    whole[BASE, POSITION] = whole[BASE_RATE, RATE] = 1 / ratio
    c, d = c.copy(), d.copy()
    c[_FORCE], d[_FORCE] = force, direct
    return (
        ((free + np.outer(by_force, force)) @ whole)[_OWN],
        (b + np.outer(by_force, direct))[_OWN],
        c @ whole,
        d,
    )
