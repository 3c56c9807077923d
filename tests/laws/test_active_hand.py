"""A hand that pushes quickly or taps while nothing touches: the column follows the feel, and the law sees no contact."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import cont2discrete, dlsim

import forcefeel as ff
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.simulation.inputs import Recorded
from tests.parametrization import mostly_slow

SECONDS, STEP_S, KEPT = 12.0, 5e-4, 10
LARGEST_RAD, PUSH_N, SHAKE_N, TAP_N = np.radians(6.0), 267.0, 44.0, 178.0
FIRST_TAP_S, BETWEEN_TAPS_S = 0.5, 0.9
OFF = 0.05
"""Of the largest angle; measured: 0.03 and less. Where the law takes the hand for contact 0.6 to 1."""


TIME_S = np.arange(0.0, SECONDS + STEP_S, KEPT * STEP_S)


def multisine(most_hz: float) -> NDArray[np.float64]:
    """Equal shares from 0.1 Hz up, its largest one, that begins within a second."""
    hertz = np.arange(0.1, most_hz + 0.05, 0.1)
    phases = np.random.default_rng(1).uniform(0, 2 * np.pi, len(hertz))
    push = np.cos(2 * np.pi * np.outer(TIME_S, hertz) + phases).sum(axis=1)
    return np.asarray(push / np.abs(push).max() * np.minimum(TIME_S, 1.0))


def taps(width_s: float) -> NDArray[np.float64]:
    """Half a sine each, two to one side and one to the other: most meet a column that still swings."""
    which, since = np.divmod(TIME_S - FIRST_TAP_S, BETWEEN_TAPS_S)
    tapped = (which >= 0) & (since < width_s)
    return np.where(tapped, np.where(which % 3 == 1, -1.0, 1.0) * np.sin(np.pi * since / width_s), 0.0)


def ideal(torque: NDArray[np.float64], feel: tuple[float, float, float]) -> NDArray[np.float64]:
    """Angle of ``I theta'' + B theta' + G theta = T`` at the samples of T, straight between them."""
    inertia, damping, stiffness = feel
    a = np.array([[0.0, 1.0], [-stiffness / inertia, -damping / inertia]])
    system = cont2discrete((a, np.array([[0.0], [1 / inertia]]), np.eye(1, 2), np.zeros((1, 1))), STEP_S, "foh")
    between = np.interp(np.arange(KEPT * (len(torque) - 1) + 1) / KEPT, np.arange(len(torque)), torque)
    return np.asarray(dlsim(system, between[:, None])[1][::KEPT, 0])


def beside_ideal(name: str, setting: tuple[float, float, float], push: NDArray[np.float64], largest_n: float) -> float:
    """Largest difference of the column to the ideal, of the ideal's largest angle; setting: share of G, Hz, damping ratio."""
    loader, (share, hertz, ratio) = BUILT_IN[name](), setting
    stiffness, omega = share * loader["feel.maximum_stiffness"], 2 * np.pi * hertz
    feel = stiffness / omega**2, 2 * ratio * stiffness / omega, stiffness
    loader = loader.replace(dict(zip(("feel.inertia", "feel.damping", "feel.stiffness"), feel, strict=True)), si=True)
    angle = ideal(loader["column.grip_arm"] * push, feel)
    force = min(LARGEST_RAD / np.abs(angle).max(), largest_n)
    scenario = ff.Scenario(Recorded(TIME_S, force * push), SECONDS, STEP_S, KEPT * STEP_S)
    history = ff.simulate(loader, scenario, ff.Law.of("robust", loader)).history
    return float(np.abs(history["column_angle_rad"].values - force * angle).max() / np.abs(force * angle).max())


@pytest.mark.parametrize(
    ("name", "setting", "most_hz", "largest_n"),
    mostly_slow(
        [
            ("elevator-2khz", (0.33, 0.8, 0.1), 2.0, PUSH_N),
            ("elevator-2khz", (0.1, 0.8, 0.3), 5.0, SHAKE_N),
            ("rudder-pedals", (0.1, 0.8, 0.7), 2.0, PUSH_N),
            ("elevator-2khz", (0.33, 1.5, 0.7), 3.0, PUSH_N),
            ("elevator-2khz", (0.33, 2.2, 0.7), 2.0, PUSH_N),
            ("rudder-pedals", (0.35, 0.8, 0.7), 3.0, PUSH_N),
            ("elevator-2khz", (0.33, 1.5, 0.3), 5.0, SHAKE_N),
            ("rudder-pedals", (0.1, 0.8, 0.7), 5.0, SHAKE_N),
            ("elevator-2khz", (0.1, 0.8, 0.3), 4.0, SHAKE_N),
        ]
    ),
)
def test_quick_hand_is_no_contact(
    name: str, setting: tuple[float, float, float], most_hz: float, largest_n: float
) -> None:
    """Quick and stiff as a stop, since the heavy feel hardly moves: the law damped it to a standstill."""
    assert beside_ideal(name, setting, multisine(most_hz), largest_n) < OFF


@pytest.mark.parametrize(
    ("name", "setting", "width_s"),
    mostly_slow(
        [
            ("elevator-2khz", (0.33, 2.2, 0.1), 0.08),
            ("rudder-pedals", (0.03, 0.8, 0.7), 0.04),
            ("elevator-2khz", (0.33, 3.0, 0.1), 0.04),
            ("elevator-2khz", (0.03, 0.8, 0.1), 0.08),
        ]
    ),
)
def test_taps_are_no_contact(name: str, setting: tuple[float, float, float], width_s: float) -> None:
    """A tap against the motion throws the column back as a stop does, but faster than it came."""
    assert beside_ideal(name, setting, taps(width_s), TAP_N) < OFF
