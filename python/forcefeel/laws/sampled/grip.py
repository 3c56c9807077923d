"""The law for a force sensor at the grip: the feel hears the hand, the servo follows the feel.

``F_g`` what the sensor shows, ``K_g`` its gain · ``T = R_p F_g / K_g`` the hand's torque · ``T_f`` torque on the column beside it, of
friction and of what the model has wrong · ``d`` disturbance at the command · ``m = m_o R_p^2`` inertia outboard of the sensor

"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel.errors import InputError
from forcefeel.laws.sampled.feedforward import feed_forward, follow
from forcefeel.laws.sampled.observer import observe, observed, readings
from forcefeel.laws.sampled.observer_law import feel_rows, gains_of
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.sampled_compensator import SampledCompensator
from forcefeel.laws.sampled.tuning import Tuning
from forcefeel.loader.loader import Loader

GRIP = "grip"


def design(loader: Loader, feel: ArrayLike, tuning: Tuning) -> SampledCompensator:
    rows = feel_rows(feel)
    plant = SampledPlant.of(loader)
    places, scale = plant.places, plant.scale
    m, settings = places.observed, len(rows)
    gains = gains_of(plant, rows, loader["column.inertia"], tuning)
    ahead = feed_forward(plant, rows)
    enters = np.append(plant.by_torque, 0.0)[:, None]
    load_states, load_command = follow(plant, np.ones((1, 1, 1)), enters, np.zeros(1))
    # of w = [delta, delta', T, d] and T_f
    k = gains.regulator
    of_w = ahead.command + np.einsum("sj,sjw->sw", k, ahead.states)
    of_load = load_command[0, 0] + k @ load_states[0, :, 0]
    of_estimate = np.zeros((settings, m))
    of_estimate[:, places.regulated] = -k
    of_estimate[:, places.torque] += of_load
    of_estimate[:, places.disturbance] += of_w[:, 3]
    # signals: xi (m), F_c, x_p, theta, F_g, delta, delta'
    per_force = loader["column.grip_arm"] / loader["grip_sensor.gain"]  # N m per N shown
    transition = observed(plant)
    kept = np.eye(m) - gains.observer @ readings(plant)
    taken = gains.observer / scale.sampled
    hand = np.zeros((m, 1))
    hand[: places.count, 0] = plant.by_torque * per_force / scale.torque_n_m
    by_command = np.zeros((m, 1))
    by_command[: places.count, 0], by_command[places.held] = plant.by_command, 1.0
    estimate = np.concatenate([kept, taken], axis=2)
    command = np.concatenate(
        [np.einsum("sj,sjk->sk", of_estimate, estimate), of_w[:, [2]] * per_force / scale.torque_n_m, of_w[:, :2]], axis=1
    )
    torque = np.zeros((settings, m + 6))
    torque[:, m + 3] = per_force
    ones = np.ones((settings, 1, 1))
    return SampledCompensator(
        period_s=plant.period_s,
        delay_s=plant.delay_s,
        transition=transition @ kept,
        input=np.concatenate([transition @ taken, hand * ones, by_command / scale.command_v * ones], axis=2),
        command=command * scale.command_v,
        torque=torque,
    )
