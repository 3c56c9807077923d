"""The part of a sampled law that takes over while the column is against something stiff.

A law with an observer makes the column follow the feel, and believes the column to be free. A clamp or a stop closes another loop:
the feel goes on while the column cannot, the drive integrates the difference, and the load cell's force moves the feel. In contact
the drive follows the feel in place of the column, the feel takes the load cell's torque, and its damping is raised:

    e = k_x (alpha R_b delta - x) + k_v (alpha R_b delta' - x'),     k_v = 0 for a valve
    T = -alpha R_b F_c
    I delta'' + (B + B_c) delta' + ... = T

``x`` position of the drive's end · ``w`` bandwidth of that position loop · ``K = k (alpha R_b)^2`` stiffness of the link at the
column

Whatever the column touches, seen from the drive it is at most as stiff as the link. ``K w / ((s + w) (I s^2 + B_c s + G))`` bounds
the loop, and a ``B_c`` of some ``K / w`` and ``sqrt(K I)`` is enough for each contact. Damping in proportion to the stiffness of
the environment: J. E. Colgate, G. G. Schenkel, J. Robotic Systems 14(1) (1997) 37-47. ``crates/model/src/contact_law.rs`` says when
it acts and how it is given back.
"""

from dataclasses import replace
from math import pi, radians

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.sampled.plant import drive_lag_s, link_stiffness
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC

BANDWIDTH = 0.45
"""``w`` times the drive's lag. At 0.4 one of the motors swings against a weakly damped contact, at 0.5 two others do."""

DAMPING_RATIO = 0.8
"""Of a motor's position loop: its rotor is a mass under ``k_x`` and ``k_v``."""

DAMPING = 2.0, 2.0
"""``B_c w / K`` and ``B_c^2 / (K I)``; the larger ``B_c`` counts. At a quarter of both contacts begin to swing."""

FORCE_N = 4.5
"""Least force at the grip, either way, that counts as a swing: 1 lb."""

QUICK_S, OF_PERIOD = 0.1, 0.25
"""Longest time between two sides of a swing, and the same as a share of the feel's period: no hand is as quick."""

NEAR_RAD, TRAVEL_RAD = radians(0.5), radians(1.0)
"""Distance from the place of the contact up to which its law stays, and the travel away from it over which it is given back."""


def position_gains(loader: Loader, bandwidth: float) -> tuple[float, float, float]:
    """``k_x`` in V/m (A/m), ``k_v`` in V s/m (A s/m), and the bandwidth in rad/s against slow motion of the feel."""
    if loader.drive == ELECTRIC:
        # M x'' = k_f e with the rotor as a mass at the link's end.
        travel = loader["transmission.travel"]
        per_ampere = loader["motor.torque_constant"] / travel
        mass = loader["motor.inertia"] / travel**2
        damping = 2 * DAMPING_RATIO
        return mass * bandwidth**2 / per_ampere, damping * bandwidth * mass / per_ampere, bandwidth / damping
    # A x' = K_2 C_i e                                                                              eqs. (2), (5)
    per_volt = loader["amplifier.admittance"] * loader["valve.current_gain"] / loader["actuator.area"]
    return bandwidth / per_volt, 0.0, bandwidth


def with_contact(law: SampledLaw, loader: Loader, feel: NDArray[np.float64]) -> SampledLaw:
    """The law with its part for contact, for settings I, B, G in SI units, a row each.

    No design has it yet: ``Law.with_contact`` adds it. It mistakes some free releases for contact (``benchmarks/contact.py``).

    Example:
        >>> import forcefeel as ff
        >>> loader = ff.digital_elevator()
        >>> ff.Law.of("robust", loader).with_contact(loader).sampled.knows_contact
        True
    """
    inertia, damping, stiffness = feel.T
    k_x, k_v, bandwidth = position_gains(loader, BANDWIDTH / drive_lag_s(loader))
    link = link_stiffness(loader)
    enough = np.maximum(DAMPING[0] * link / bandwidth, np.sqrt(DAMPING[1] * link * inertia))
    quick = np.minimum(QUICK_S, OF_PERIOD * 2 * pi * np.sqrt(inertia / stiffness))
    # A stick shaker swings a hand that holds the grip.
    force = max(FORCE_N, 2 * loader["feel.shaker_force"]) * loader["column.grip_arm"]
    columns = (
        loader["linkage.ratio"] * loader["column.base_arm"],
        k_x,
        k_v,
        np.maximum(enough - damping, 0.0),
        force,
        quick,
        NEAR_RAD,
        TRAVEL_RAD,
    )
    return replace(law, contact=np.column_stack([np.broadcast_to(column, inertia.shape) for column in columns]))
