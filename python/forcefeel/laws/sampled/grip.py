"""The law for a force sensor at the grip: the hand's force drives the feel, and the servo follows it.

``F_g`` force that the sensor shows · ``K_g`` its gain · ``m = m_o R_p^2`` inertia outboard of it · ``T`` the hand's torque ·
``T_f`` torque on the column beside it · ``d`` disturbance at the command · ``x^`` the plant as estimated

What moves the feel is measured beyond friction, inertia and drive of the column:

    T = R_p F_g / K_g + m theta''^

and ``theta''^`` is what the observer's plant does over the period, ``(r (Phi - 1) x^ + g T) / h``. So the feel takes notice of
nothing that the loader file has wrong but the sensor's gain and, by ``m`` alone, the inertia. What is left is to make a column
follow a motion that is known: ``delta``, ``delta'`` and, by ``T``, ``delta''`` at every sample,

    e = Gamma_w w - K ([x^; e_h] - Pi w),    w = [delta; delta'; T; T_f^; d^]

with the regulator equations of ``feedforward``. The observer is told of ``T`` and estimates ``T_f`` in its place: friction, an
inertia or a ratio that are off. That estimate is used by the servo and never by the feel.

**Weights.** An arm of the inertia ``m_a`` moves with the grip, and what moves it is missing at the sensor:
``(I + m_a H) theta'' + ... = 0``, where ``H`` is what the servo makes of ``delta``. A light feel is unstable with a heavy arm
where ``|H| > I / m_a`` at a lag of 180 deg, so the regulator is the softer the lighter the feel; and as fast as its natural
frequency asks for, since a slow one begins its release late.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.laws.sampled.contact_law import with_contact
from forcefeel.laws.sampled.feedforward import against_torque, feed_forward
from forcefeel.laws.sampled.neutral import trimmed
from forcefeel.laws.sampled.observer import observe, observed, observed_input, readings
from forcefeel.laws.sampled.observer_law import feel_rows
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.regulator import regulate
from forcefeel.laws.sampled.sampled_law import SAMPLED, SampledLaw
from forcefeel.laws.sampled.tuning import Tuning
from forcefeel.loader.loader import Loader
from forcefeel.loader.sensors import has_grip_sensor

GRIP = "grip"
"""The name of the method."""

_DELTA, _RATE, _HAND, _DISTURBANCE = range(4)
"""Places in w of ``feed_forward``."""


def design(loader: Loader, feel: ArrayLike, tuning: Tuning, by_frequency: float = 0.0) -> SampledLaw:
    """The laws for many settings of one loader.

    Args:
        loader: The loader, with ``grip_sensor.gain`` and ``controller.period``; its own feel and arm are not used.
        feel: I, B, G in SI units, a row per setting.
        tuning: Weights and noises; the torque's walk is that of T_f.
        by_frequency: Power of the feel's natural frequency, in the plant's unit of time, by which the command's weight goes.

    Raises:
        InputError: If the loader has no such sensor, no period or a delay longer than that, a row is bad, or there is no law in
            double precision.
    """
    if not has_grip_sensor(loader):
        raise InputError(f"law: {no_sensor(loader)}")
    rows, plant = feel_rows(feel), SampledPlant.of(loader)
    try:
        gains = _Gains.of(plant, rows, loader["column.inertia"], tuning, by_frequency)
        of_estimate, of_feel, of_hand = _followed(plant, rows, gains.regulator)
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"tuning: no law in double precision ({error}); make the spread of weights and noises smaller"
        ) from error
    scale, places, settings = plant.scale, plant.places, len(rows)
    kept = np.eye(places.observed) - gains.observer @ readings(plant)
    taken = np.insert(gains.observer / scale.sampled, SAMPLED, 0.0, axis=2)  # F_g is no reading of the observer's
    estimate = np.concatenate([kept, taken], axis=2)
    hand = _hand(loader, plant, estimate)
    command = np.concatenate(
        [np.einsum("sj,sjk->sk", of_estimate, estimate) + of_hand[:, None] * hand, of_feel], axis=1
    )
    by_hand, by_command = np.zeros((places.observed, 1)), observed_input(plant)[:, None]
    by_hand[: places.count, 0] = plant.by_torque
    after = observed(plant) @ estimate + by_hand * hand[:, None, :]
    of_command = np.tile(by_command / scale.command_v, (settings, 1, 1))
    law = SampledLaw(
        period_s=plant.period_s,
        delay_s=plant.delay_s,
        transition=after[:, :, : places.observed],
        input=np.concatenate([after[:, :, places.observed :], of_command], axis=2),
        command=command * scale.command_v,
        torque=np.hstack([hand * scale.torque_n_m, np.zeros((settings, 2))]),
    )
    return with_contact(trimmed(law, loader), loader, rows)


def no_sensor(loader: Loader) -> str:
    """What is wrong with the law on a loader without such a sensor."""
    return (
        f"{GRIP} needs a force sensor at the grip, and {loader.name} has none; give grip_sensor.gain, 1 where it is calibrated, "
        "or take another law, such as robust"
    )


def _hand(loader: Loader, plant: SampledPlant, estimate: NDArray[np.float64]) -> NDArray[np.float64]:
    """T on xi and y, (settings, m + 4), in the plant's unit of torque.

    ``T = (R_p F_g / K_g + m a) / (1 - m g)``, a the rate that the estimate gains in a period, g what a unit of torque adds to it.
    """
    scale, places = plant.scale, plant.places
    inertia = loader["grip_sensor.mass"] * loader["column.grip_arm"] ** 2
    per_rate = (
        inertia / scale.time_s / plant.period_s / scale.torque_n_m
    )  # T per rate of the base, in the plant's units
    gained = observed(plant)[places.base_rate].copy()
    gained[places.base_rate] -= 1.0
    gained[places.held] += plant.by_command[places.base_rate]  # at rest the next command is the one before
    hand = per_rate * np.einsum("j,sjk->sk", gained, estimate)
    hand[:, places.observed + SAMPLED] += loader["column.grip_arm"] / loader["grip_sensor.gain"] / scale.torque_n_m
    return np.asarray(hand / (1 - per_rate * plant.by_torque[places.base_rate]))


def _followed(
    plant: SampledPlant, feel: NDArray[np.float64], gains: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """What the command is of the estimate, (settings, m), of delta and delta', (settings, 2), and of T, (settings,)."""
    ahead, places = feed_forward(plant, feel), plant.places
    of_w = ahead.command + np.einsum("sj,sjw->sw", gains, ahead.states)
    of_estimate = np.zeros((len(feel), places.observed))
    of_estimate[:, places.regulated] = -gains
    of_estimate[:, places.torque] = against_torque(plant, gains)
    of_estimate[:, places.disturbance] += of_w[:, _DISTURBANCE]
    return of_estimate, of_w[:, [_DELTA, _RATE]], of_w[:, _HAND]


@dataclass(frozen=True, eq=False)
class _Gains:
    """K, (settings, n + 1), and L, (settings, m, 3)."""

    regulator: NDArray[np.float64]
    observer: NDArray[np.float64]

    @classmethod
    def of(
        cls, plant: SampledPlant, feel: NDArray[np.float64], column_inertia: float, tuning: Tuning, by_frequency: float
    ) -> "_Gains":
        """The regulators once for each inertia and natural frequency, the observers once for each inertia."""
        ratio, frequency = feel[:, 0] / column_inertia, np.sqrt(feel[:, 2] / feel[:, 0]) * plant.scale.time_s
        kinds, of_kind = np.unique(np.column_stack([ratio, frequency]).round(_DIGITS), axis=0, return_inverse=True)
        weight = tuning.command_weight

        def weighed(own: float) -> Tuning:
            return replace(tuning, command_weight=weight.times(by_frequency * float(np.log10(own))))

        regulators = np.array([regulate(plant, weighed(own), ratio).gains for ratio, own in kinds.tolist()])
        ratios, of_ratio = np.unique(ratio, return_inverse=True)
        observers = np.array([observe(plant, tuning, ratio).gains for ratio in ratios.tolist()])
        return cls(regulators[of_kind], observers[of_ratio])


_DIGITS = 12
"""Natural frequencies that are the same but for rounding have one regulator."""
