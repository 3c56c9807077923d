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
the loop, and a ``B_c`` of some ``K / w`` and ``sqrt(K I)`` is enough for each contact. ``w`` is the lower the more the loop lags by
drive, delay, hold and the slower sensor: on steel the lag of a 500 Hz encoder alone makes the loop swing at 130 Hz. Damping in
proportion to the stiffness of the environment: J. E. Colgate, G. G. Schenkel, J. Robotic Systems 14(1) (1997) 37-47.

A motor's rotor is a mass between this loop and the link, so that a light feel closes another loop at some 150 Hz: the load cell's
force moves the feel, ``delta'`` asks for current at once, and the rotor pulls at the load cell. ``damping_of_rotor`` bounds it.
``crates/model/src/contact_law.rs`` says when it acts and how it is given back.
"""

from dataclasses import replace
from math import pi, radians

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import CONTACT_SMOOTHING_S
from forcefeel.laws.sampled.plant import drive_lag_s, friction_off, link_stiffness
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import sample_variance, sensor_lag_s

BANDWIDTH = 0.45
"""``w`` times the loop's lag. At 0.4 one of the motors swings against a weakly damped contact, at 0.5 two others do."""

DAMPING_RATIO = 0.8
"""Of a motor's position loop: its rotor is a mass under ``k_x`` and ``k_v``."""

DAMPING = 2.0, 2.0
"""``B_c w / K`` and ``B_c^2 / (K I)``; the larger ``B_c`` counts. At a quarter of both contacts begin to swing."""

MARGIN = 1.5
"""Least gain margin of a motor's loop in contact. Without one light feels buzz at 120 to 160 Hz with all of the motor's current."""

_TOUCHED_N_PER_M, _TOUCHED_DAMPING = np.geomspace(1e3, 1e6, 7), 0.02
"""Stiffness at the grip and damping ratio of the contacts for which it holds."""

_FREQUENCIES = 400
"""At which it is looked for."""

FORCE_N = 6.7
"""Least force at the grip, either way, that counts as a push: 1.5 lb, and what the dry friction may be off."""

SIGMAS = 10.0
"""The same in standard deviations of the estimate's noise."""

RIPPLE = 0.12
"""Least change of that force between two turns that are quicker than a hand, of ``FORCE_N``."""

RIPPLE_SIGMAS = 8.0
"""The same in standard deviations of the noise."""

ENVIRONMENT_N_PER_M = 5000.0
"""Stiffness at the grip that no arm has: five times the firm arm's."""

SPEED = 0.5
"""Share of the speed at which the drive can follow a swing at its bandwidth: limited current and flow would make it swing on."""

QUICK_S, OF_PERIOD = 0.1, 0.25
"""Longest time between two sides of a swing, and the same as a share of the feel's period: no hand is as quick."""

NEAR_RAD, TRAVEL_RAD = radians(0.5), radians(1.0)
"""Distance from an end stop, or from the place of a contact, within which the column counts as near, and the travel away from the
contact over which its law is given back."""


_MOST_SPEED = 1e6
"""In rad/s, in place of infinity, which no law file holds."""


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


def damping_of_rotor(loader: Loader, bandwidth: float, inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """``B_c`` in N m s/rad by which a motor's loop in contact has its gain margin ``m``, for each inertia of a feel.

    The loop is ``L = H / (I s + B_c)``. ``J_m`` is the rotor at the column and ``N`` its position loop. ``D`` is the lag of the
    current, ``P`` of the encoder, ``C`` of the load cell. ``K_e`` is the link in series with the column and what that touches:

        H = K_e C D N / (s (J_m s^2 + K_e + D P N)),   N = J_m (w^2 + 2 z w s),   K_e = K Z / (Z + K),   Z = J s^2 + c s + K_c

    At the frequency at which ``L`` is ``-1 / m``, ``I = -m Im(H) / w`` and ``B_c = -m Re(H)``: a curve over the frequency, which
    gives the ``B_c`` of each ``I``. Of several the largest counts. Of a valve, whose piston no force of the link moves, it is 0.
    """
    if loader.drive != ELECTRIC:
        return np.zeros_like(inertia)
    period, arm = loader["controller.period"], loader["column.grip_arm"]
    link, column = link_stiffness(loader), loader["column.inertia"]
    rotor = (
        loader["motor.inertia"]
        * (loader["linkage.ratio"] * loader["column.base_arm"] / loader["transmission.travel"]) ** 2
    )
    s = 1j * np.geomspace(bandwidth / 30, pi / period, _FREQUENCIES)
    held = np.exp(-s * (loader["controller.delay"] + period / 2)) / (1 + s / loader["current_loop.bandwidth"])
    load_cell, encoder = (1 / (1 + s / loader[f"{sensor}.bandwidth"]) for sensor in ("load_cell", "potentiometer"))
    # The rate of the position is the last period's difference.
    stiff, damped = rotor * bandwidth**2, 2 * DAMPING_RATIO * rotor * bandwidth
    answered = held * encoder * (stiff + damped * (1 - np.exp(-s * period)) / period)
    enough = np.zeros_like(inertia)
    for touched in _TOUCHED_N_PER_M * arm**2:
        free = column * s**2 + 2 * _TOUCHED_DAMPING * np.sqrt(touched * column) * s + touched
        spring = link * free / (free + link)
        h = spring * load_cell * held * (stiff + damped * s) / (s * (rotor * s**2 + spring + answered))
        beyond = -MARGIN * h.imag / s.imag - inertia[:, None]
        crosses = beyond[:, 1:] * beyond[:, :-1] <= 0
        needed = np.maximum(-MARGIN * h.real, 0.0)
        enough = np.maximum(enough, (crosses * np.maximum(needed[1:], needed[:-1])).max(axis=1))
    return enough


def fastest(loader: Loader, bandwidth: float) -> float:
    """Speed of the feel in rad/s that a drive can follow while it swings at ``bandwidth`` in rad/s: no limit is infinity."""
    travel = loader["linkage.ratio"] * loader["column.base_arm"]
    if loader.drive == ELECTRIC:
        # M x'' = k_f i_max, and x'' is w x' in a swing.
        end = loader["transmission.travel"]
        force = loader["current_loop.current_limit"] * loader["motor.torque_constant"] / end
        return force * end**2 / loader["motor.inertia"] / bandwidth / travel
    return loader["valve.rated_flow"] / loader["actuator.area"] / travel


def torque_noise(law: SampledLaw, loader: Loader) -> NDArray[np.float64]:
    """Standard deviation of the smoothed torque estimate by the noise of the sensors, of each setting in N m.

    Noise moves the estimate by the observer's own error, whatever the command does: ``xi+ = A xi + B n``, ``T = t [xi; n]``,
    ``s+ = s + g (T - s)``. Covariance by doubling, ``P = P + M P M'``, ``M = M^2``.
    """
    sensors, states, share = law.sampled, law.states, min(law.period_s / CONTACT_SMOOTHING_S, 1.0)
    move = np.zeros((law.settings, states + 1, states + 1))
    move[:, :states, :states] = law.transition
    move[:, states, :states], move[:, states, states] = share * law.torque[:, :states], 1 - share
    noise = np.zeros((law.settings, states + 1, sensors))
    noise[:, :states] = law.input[:, :, :sensors]
    noise[:, states] = share * law.torque[:, states : states + sensors]
    covariance = noise * sample_variance(loader)[:sensors] @ noise.transpose(0, 2, 1)
    for _ in range(_DOUBLINGS):
        covariance = covariance + move @ covariance @ move.transpose(0, 2, 1)
        move = move @ move
    return np.asarray(np.sqrt(covariance[:, states, states]))


_DOUBLINGS = 14
"""16,384 periods: an observer has settled long before."""


def with_contact(law: SampledLaw, loader: Loader, feel: NDArray[np.float64]) -> SampledLaw:
    """The law with its part for contact, for settings I, B, G in SI units, a row each.

    Example:
        >>> import forcefeel as ff
        >>> loader = ff.digital_elevator()
        >>> ff.Law.of("robust", loader).sampled.knows_contact
        True
    """
    inertia, damping, stiffness = feel.T
    own = BANDWIDTH / (drive_lag_s(loader) + sensor_lag_s(loader))
    k_x, k_v, bandwidth = position_gains(loader, own)
    link = link_stiffness(loader)
    enough = np.maximum(DAMPING[0] * link / bandwidth, np.sqrt(DAMPING[1] * link * inertia))
    enough = np.maximum(enough, damping_of_rotor(loader, own, inertia))
    quick = np.minimum(QUICK_S, OF_PERIOD * 2 * pi * np.sqrt(inertia / stiffness))
    # A stick shaker swings a hand that holds the grip.
    arm = loader["column.grip_arm"]
    shaken = 2 * loader["feel.shaker_force"]
    push = FORCE_N + max(friction_off(loader))
    noise = torque_noise(law, loader)
    columns = (
        loader["linkage.ratio"] * loader["column.base_arm"],
        k_x,
        k_v,
        np.maximum(enough - damping, 0.0),
        min(SPEED * fastest(loader, own), _MOST_SPEED),
        np.maximum(max(RIPPLE * push, shaken) * arm, RIPPLE_SIGMAS * noise),
        np.maximum(max(push, shaken) * arm, SIGMAS * noise),
        ENVIRONMENT_N_PER_M * arm**2,
        quick,
        NEAR_RAD,
        TRAVEL_RAD,
    )
    return replace(law, contact=np.column_stack([np.broadcast_to(column, inertia.shape) for column in columns]))
