"""Eqs. (15), (17), (19) as printed, entry by entry, with the report's letters (``C_1`` read as ``C_i``).

An independent copy of the model, the reference for its Jacobians. Units are those of the letters; ``delta`` is a voltage in (15)
and (17), an angle in (19).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel.loader.loader import Loader


@dataclass(frozen=True)
class Letters:
    """The report's letters, in SI units."""

    A: float
    B: float
    c: float
    Ci: float
    Cp: float
    G: float
    Gmax: float
    I: float  # noqa: E741  the report's letter
    J: float
    k: float
    K1: float
    K2: float
    K3: float
    Rb: float
    Rp: float
    VE: float
    alpha: float
    beta: float
    zeta: float
    wn: float


def letters(loader: Loader) -> Letters:
    """The letters of ``loader``."""
    return Letters(
        A=loader["actuator.area"],
        B=loader["feel.damping"],
        c=loader["linkage.damping"],
        Ci=loader["valve.current_gain"],
        Cp=loader["valve.pressure_gain"],
        G=loader["feel.stiffness"],
        Gmax=loader["feel.maximum_stiffness"],
        I=loader["feel.inertia"],
        J=loader["column.inertia"],
        k=loader["linkage.stiffness"],
        K1=loader["load_cell.gain"],
        K2=loader["amplifier.admittance"],
        K3=loader["potentiometer.gain"],
        Rb=loader["column.base_arm"],
        Rp=loader["column.grip_arm"],
        VE=loader["actuator.oil_volume"],
        alpha=loader["linkage.ratio"],
        beta=loader["actuator.bulk_modulus"],
        zeta=loader["valve.damping_ratio"],
        wn=loader["valve.natural_frequency"],
    )


def rigid(s: Letters) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """State matrix and input column of eq. (15)."""
    a = np.array(
        [
            [0, 1, 0, 0, 0, 0, 0],
            [0, 0, s.alpha**2 * s.Rb**2 * s.A / s.J, 0, 0, 0, 0],
            [0, -4 * s.A * s.beta / s.VE, -4 * s.beta * s.Cp / s.VE, 4 * s.beta / s.VE, 0, 0, 0],
            [0, 0, 0, 0, 1, 0, 0],
            [-s.Ci * s.wn**2 * s.K2 * s.K3, 0, 0, -(s.wn**2), -2 * s.zeta * s.wn, s.Ci * s.wn**2 * s.K2, 0],
            [0, 0, 0, 0, 0, 0, 1],
            [0, 0, s.K1 * s.Gmax * s.A / s.I, 0, 0, -s.G / s.I, -s.B / s.I],
        ]
    )
    return a, np.array([0, s.alpha * s.Rb * s.Rp / s.J, 0, 0, 0, 0, 0])


def compliant(s: Letters) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """State matrix and input column of eq. (17)."""
    stiff = 4 * s.A * s.beta * s.k / (s.VE * s.c)
    a = np.array(
        [
            [-s.k / s.c, s.A / s.c, 0, 0, 0, 0, s.alpha * s.k / s.c, s.alpha],
            [
                stiff,
                -4 * s.beta * (s.A**2 + s.Cp * s.c) / (s.VE * s.c),
                4 * s.beta / s.VE,
                0,
                0,
                0,
                -stiff * s.alpha,
                -4 * s.A * s.beta * s.alpha / s.VE,
            ],
            [0, 0, 0, 1, 0, 0, 0, 0],
            [-s.Ci * s.wn**2 * s.K2 * s.K3, 0, -(s.wn**2), -2 * s.zeta * s.wn, s.Ci * s.wn**2 * s.K2, 0, 0, 0],
            [0, 0, 0, 0, 0, 1, 0, 0],
            [0, s.K1 * s.Gmax * s.A / s.I, 0, 0, -s.G / s.I, -s.B / s.I, 0, 0],
            [0, 0, 0, 0, 0, 0, 0, 1],
            [0, s.alpha * s.Rb**2 * s.A / s.J, 0, 0, 0, 0, 0, 0],
        ]
    )
    return a, np.array([0, 0, 0, 0, 0, 0, 0, s.Rb * s.Rp / s.J])


def design_plant(s: Letters) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """State matrix and input column of eq. (19)."""
    stiff = 4 * s.A * s.beta * s.k / (s.VE * s.c)
    a = np.array(
        [
            [-s.k / s.c, s.A / s.c, 0, 0, s.alpha * s.k / s.c, s.alpha, 0],
            [
                stiff,
                -4 * s.beta * (s.A**2 + s.Cp * s.c) / (s.VE * s.c),
                0,
                0,
                -stiff * s.alpha,
                -4 * s.A * s.alpha * s.beta / s.VE,
                0,
            ],
            [0, 0, 0, 1, 0, 0, 0],
            [0, 0, -s.G / s.I, -s.B / s.I, 0, 0, s.Gmax / s.I],
            [0, 0, 0, 0, 0, 1, 0],
            [0, s.alpha * s.Rb**2 * s.A / s.J, 0, 0, 0, 0, s.Rp * s.Rb / s.J],
            [0, 0, 0, 0, 0, 0, 0],
        ]
    )
    return a, np.array([0, 4 * s.beta * s.Ci * s.K2 / s.VE, 0, 0, 0, 0, 0])
