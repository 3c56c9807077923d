"""Lead time of the column with a heavy feel, which keeps the loader passive in a stiff clamp.

The drive needs time to balance the estimated torque, and meanwhile the column deflects: a rising torque ``T`` moves it away from
the feel by ``c T'``. This takes ``w^2 c`` from the real part of the admittance at the grip. Near the frequency of a stiff clamp a
heavy feel has less than that, so that the loader gives off energy and the oscillation does not decay. A column that leads the feel
by a time ``a`` has more,

    theta = delta + a delta',    Re Y = w^2 [B + a (I w^2 - G)] / |D|^2 - w^2 c,    D = G - I w^2 + j w B

and with ``a = (c |D|^2 - B) / (I w^2 - G)`` the loader is passive up to ``w``. Below its natural frequency the feel has less
damping by ``a G``: a share ``s`` at most, and of a well damped one what that is of a damping ratio of 0.1. Feels that are
passive up to ``w`` have no lead.

``delta + a delta'`` obeys the equation of the feel, so that the feed-forward stays, with it and its rate in place of ``delta`` and
``delta'``. Passive impedance as the condition of stable contact: J. E. Colgate, N. Hogan, Int. J. Control 48 (1988) 65-88.
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel.laws.sampled.feedforward import against_torque
from forcefeel.laws.sampled.observer import observed, observed_input, readings
from forcefeel.laws.sampled.plant import SampledPlant

PASSIVE_TO_HZ = 5.0
"""``w / 2 pi``: heavy feels swing in stiff clamps at 3 to 5 Hz; what swings faster the part for contact notices. Of the 2,400
settings of an envelope of the elevator at 2 kHz 6 % swing on in one of 24 contacts without it, at 4.5 Hz 3.5 %, at 5 Hz 2.3 %,
at 5.5 Hz 2.2 %; of those of five motors 1.3 to 3.2 % without it, at 5 Hz 0.3 to 0.8 %."""

LESS_DAMPING = 0.15
"""``s``. At 0.25 and 0.5 as many contacts swing on."""


_Array = NDArray[np.float64]


def time_ahead(plant: SampledPlant, feel: _Array, regulator: _Array, observer: _Array, of_estimate: _Array) -> _Array:
    """``a`` in s for settings I, B, G in SI units, a row each.

    Args:
        plant: What the law is designed for.
        feel: The settings.
        regulator: K, (settings, n + 1).
        observer: L, (settings, m, 3).
        of_estimate: What the command is of the observer's estimate, (settings, m).

    Raises:
        numpy.linalg.LinAlgError: If the plant cannot stand still under a torque.
    """
    still = of_estimate.copy()
    still[:, plant.places.torque] = against_torque(plant, regulator)
    inertia, damping, stiffness = feel.T
    w = 2 * np.pi * PASSIVE_TO_HZ
    beyond = inertia * w**2 - stiffness
    missing = torque_lag(plant, observer, still) * (beyond**2 + (w * damping) ** 2) - damping
    most = LESS_DAMPING * np.minimum(damping / stiffness, 0.2 * np.sqrt(inertia / stiffness))
    # A feel that is quicker than w by itself swings no slower in a clamp.
    slow = beyond > 0
    return np.where(slow, np.clip(missing / np.where(slow, beyond, 1.0), 0.0, most), 0.0)


def torque_lag(plant: SampledPlant, observer: _Array, of_estimate: _Array) -> _Array:
    """``c`` in rad s/(N m): deflection under a torque that rises by 1 N m/s, of a column that is to stand still.

    Of the loop ``z+ = M z + g T``, z of plant and observer, under ``T = k`` at sample k the motion ``z = z_1 k + z_0`` is
    ``z_1 = (1 - M)^-1 g``, ``z_0 = -(1 - M)^-1 z_1``.
    """
    places, n = plant.places, len(plant.transition)
    taken = observer @ readings(plant)
    kept = np.eye(places.observed) - taken
    shown = taken[..., places.regulated]  # of the plant and its held command, which is no reading
    after = observed(plant) + observed_input(plant)[:, None] * of_estimate[:, None, :]
    loop = np.empty((len(of_estimate), n + places.observed, n + places.observed))
    moved = plant.input[:, None] * of_estimate[:, None, :]
    loop[:, :n, :n], loop[:, :n, n:] = plant.transition + moved @ shown, moved @ kept
    loop[:, n:, :n], loop[:, n:, n:] = after @ shown, after @ kept
    enters = np.zeros(n + places.observed)
    enters[: places.count] = plant.by_torque
    rest = np.eye(n + places.observed) - loop
    rising = np.linalg.solve(rest, enters[:, None])
    apart = -np.linalg.solve(rest, rising)[:, places.base, 0]
    return np.asarray(apart * plant.period_s / plant.scale.torque_n_m)


def led(time_s: _Array, feel: _Array, of_feel: _Array) -> tuple[_Array, _Array]:
    """Gains on delta and delta', (settings, 2), and additional gain on the torque in N m, (settings,), with the lead ``a``.

    Args:
        time_s: ``a``, (settings,).
        feel: I, B, G in SI units, a row each.
        of_feel: Gains on delta and delta' without it, (settings, 2).
    """
    inertia, damping, stiffness = feel.T
    of_angle, of_rate = of_feel.T
    # The rate of what is followed: delta' + a delta'', delta'' by eq. (11).
    by_torque = of_rate * time_s / inertia
    ahead = np.column_stack([of_angle - stiffness * by_torque, of_rate + time_s * of_angle - damping * by_torque])
    return ahead, by_torque
