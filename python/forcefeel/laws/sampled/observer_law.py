"""Regulator, feed-forward and observer put together: one sampled law for each setting.

    xi^ = (1 - L C) xi + L y,      T = T_p^
    e   = Gamma_w w - K ([x^; e_h] - Pi w),    w = [delta; delta'; T_p^; d^]

with the feel a moment ahead, ``laws.sampled.advance``, in the place of ``delta``, ``delta'``.

The feel computer takes the pilot's torque that the observer estimates: the load cell's once the column is at rest, and not
what it takes to move the column's own inertia. The estimate has integral action on what is at the command.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.laws.sampled.advance import led, time_ahead
from forcefeel.laws.sampled.contact_law import with_contact
from forcefeel.laws.sampled.feedforward import feed_forward
from forcefeel.laws.sampled.known_friction import known_friction
from forcefeel.laws.sampled.neutral import trimmed
from forcefeel.laws.sampled.observer import observe, observed, observed_input, readings
from forcefeel.laws.sampled.plant import Places, SampledPlant, link_stiffness
from forcefeel.laws.sampled.regulator import regulate
from forcefeel.laws.sampled.sampled_law import SAMPLED, SampledLaw
from forcefeel.laws.sampled.tuning import Tuning
from forcefeel.loader.feel_settings import setting_rows
from forcefeel.loader.loader import Loader


def design(loader: Loader, feel: ArrayLike, tuning: Tuning) -> SampledLaw:
    """The laws for many settings of one loader.

    Args:
        loader: The loader, with ``controller.period`` and ``controller.delay``; its own feel and arm are not used, nor is
            anything that its linear model leaves out.
        feel: I, B, G in SI units (N m s^2/rad, N m s/rad, N m/rad), a row per setting.
        tuning: Weights and noises.

    Returns:
        A law for each setting, of nine states for a valve, of eight for a motor. All are in the same coordinates, so laws of one
        loader and any tuning can be interpolated.

    Raises:
        InputError: If the loader has no period or a delay longer than that, a setting is not a row of three finite numbers
            with I > 0, B >= 0, G > 0, or there is no law in double precision.
    """
    return design_with(_gains, loader, feel, tuning)


@dataclass(frozen=True, eq=False)
class Gains:
    """K, (settings, n + 1), and L, (settings, m, 3)."""

    regulator: NDArray[np.float64] = field(repr=False)
    observer: NDArray[np.float64] = field(repr=False)


GainFunction = Callable[[SampledPlant, NDArray[np.float64], Loader, Any], Gains]
"""Gains for each setting of the feel of a loader, from a tuning."""


def design_with(gains_of: GainFunction, loader: Loader, feel: ArrayLike, tuning: object) -> SampledLaw:
    """As ``design``, with other gains."""
    rows = feel_rows(feel)
    plant = SampledPlant.of(loader)
    try:
        ahead = feed_forward(plant, rows)
        gains = gains_of(plant, rows, loader, tuning)
        of_estimate, of_feel = followed(plant.places, gains.regulator, ahead.states, ahead.command)
        time_s = time_ahead(plant, rows, gains.regulator, gains.observer, of_estimate)
    except np.linalg.LinAlgError as error:
        raise InputError(
            f"tuning: no law in double precision ({error}); make the spread of weights and noises smaller"
        ) from error
    of_feel, of_torque = led(time_s, rows, of_feel)
    of_estimate[:, plant.places.torque] += of_torque * plant.scale.torque_n_m
    law = assemble(plant, gains, of_estimate, of_feel)
    return with_contact(trimmed(law, loader), loader, rows)


def _gains(plant: SampledPlant, feel: NDArray[np.float64], loader: Loader, tuning: Tuning) -> Gains:
    """The gains of each setting: the observers once for each inertia, and the regulators where the weights do not ask for more."""
    inertias, of_inertia = np.unique(feel[:, 0], return_inverse=True)
    observers = [observe(plant, tuning, inertia / loader["column.inertia"]).gains for inertia in inertias.tolist()]
    thrown = tuning.command_weight.throw or (tuning.rate_weight is not None and tuning.rate_weight.throw)
    asked = feel[:, [0, 2]] / (loader["column.inertia"], link_stiffness(loader)) * (1.0, bool(thrown))
    kinds, of_kind = np.unique(asked, axis=0, return_inverse=True)
    regulators = [regulate(plant, tuning, *kind).gains for kind in kinds.tolist()]
    return Gains(np.array(regulators)[of_kind], np.array(observers)[of_inertia])


def followed(
    places: Places, gains: NDArray[np.float64], states: NDArray[np.float64], command: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What the command is of the estimate, (settings, m), and of delta, delta', (settings, 2), in the plant's units."""
    of_w = command + np.einsum("sj,sjw->sw", gains, states)
    of_estimate = np.zeros((len(gains), places.observed))
    of_estimate[:, places.regulated] = -gains
    of_estimate[:, [places.torque, places.disturbance]] += of_w[:, 2:]
    return of_estimate, of_w[:, :2]


def assemble(
    plant: SampledPlant, gains: Gains, of_estimate: NDArray[np.float64], of_feel: NDArray[np.float64]
) -> SampledLaw:
    """The law as data: signals and what it says in SI units, its state in the plant's."""
    settings, scale, places = len(gains.regulator), plant.scale, plant.places
    transition = observed(plant)
    kept = np.eye(places.observed) - gains.observer @ readings(plant)  # what the estimate keeps of xi
    taken = gains.observer / scale.sampled  # and what it takes of y
    by_command = observed_input(plant)[:, None]
    estimate = np.concatenate([kept, taken], axis=2)
    command = np.concatenate([np.einsum("sj,sjk->sk", of_estimate, estimate), of_feel], axis=1)
    torque = np.zeros((settings, places.observed + SAMPLED + 2))
    torque[:, : places.observed + SAMPLED] = estimate[:, places.torque]
    return SampledLaw(
        friction=known_friction(plant, estimate),
        period_s=plant.period_s,
        delay_s=plant.delay_s,
        transition=transition @ kept,
        input=np.concatenate([transition @ taken, np.tile(by_command / scale.command_v, (settings, 1, 1))], axis=2),
        command=command * scale.command_v,
        torque=torque * scale.torque_n_m,
    )


def feel_rows(feel: ArrayLike) -> NDArray[np.float64]:
    """Settings I, B, G as an array, a row each and one at least.

    Raises:
        InputError: If a setting is missing or is not three finite numbers with I > 0, B >= 0, G > 0.
    """
    rows = setting_rows(feel, "feel")
    if not len(rows):
        raise InputError(f"feel: expected one row of I, B, G at least, got shape {rows.shape}")
    return rows
