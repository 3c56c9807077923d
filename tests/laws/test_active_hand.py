"""Hands beside the programmed feel: quick ones and taps are no contact, and one that leaves a stop has its column back soon."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import cont2discrete, dlsim

import forcefeel as ff
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import FEEL_SETTING
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


def with_feel(loader: ff.Loader, setting: tuple[float, float, float]) -> tuple[ff.Loader, tuple[float, float, float]]:
    """The loader with a feel, and its I, B, G; setting: share of G, Hz, damping ratio."""
    share, hertz, ratio = setting
    stiffness, omega = share * loader["feel.maximum_stiffness"], 2 * np.pi * hertz
    feel = stiffness / omega**2, 2 * ratio * stiffness / omega, stiffness
    return loader.replace(dict(zip(FEEL_SETTING, feel, strict=True)), si=True), feel


def beside_ideal(name: str, setting: tuple[float, float, float], push: NDArray[np.float64], largest_n: float) -> float:
    """Largest difference of the column to the ideal, of the ideal's largest angle."""
    loader, feel = with_feel(BUILT_IN[name](), setting)
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
            ("elevator-2khz", (0.33, 1.5, 0.1), 5.0, SHAKE_N),
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
            ("rudder-pedals", (0.33, 3.0, 0.1), 0.08),
        ]
    ),
)
def test_taps_are_no_contact(name: str, setting: tuple[float, float, float], width_s: float) -> None:
    """A tap against the motion throws the column back as a stop does, but faster than it came."""
    assert beside_ideal(name, setting, taps(width_s), TAP_N) < OFF


STOP_RAD, LEFT_RAD, STIFF_N_PER_M, STOP_RATIO = np.radians(5.0), np.radians(3.0), 1e5, 0.1
LEANS_N, LEANS_S, PULLS_N = 44.0, 4.0, -44.0
"""The hand leans on a stop with more than the feel asks for there, then pulls."""
LATE_S = {0.5: 0.22, 2.0: 0.51}
"""By the time in s over which the hand changes from one to the other. Measured: at most 0.19 and 0.45; at least 0.27 and 0.57 where
the pull of the hand is taken for a push of the contact."""


def late_at_leaving(name: str, setting: tuple[float, float, float], change_s: float) -> float:
    """Time in s by which a column passes an angle later than the ideal on its way from the stop."""
    loader, feel = with_feel(BUILT_IN[name](), setting)
    arm, inertia = loader["column.grip_arm"], loader["column.inertia"]
    stop = STIFF_N_PER_M * arm**2
    rows = {"stop_high": STOP_RAD, "stop_stiffness": stop, "stop_damping": 2 * STOP_RATIO * np.sqrt(stop * inertia)}
    # The feel does not know of it.
    loader = loader.replace(
        {f"column.{row}": value for row, value in rows.items()} | {"feel.hard_stop_high": np.pi}, si=True
    )
    balance = feel[2] * STOP_RAD / arm
    marks = [0.0, LEANS_S / 2, LEANS_S, LEANS_S + change_s]
    force = np.interp(TIME_S, marks, [0.0, balance + LEANS_N, balance + LEANS_N, PULLS_N])
    history = ff.simulate(
        loader, ff.Scenario(Recorded(TIME_S, force), SECONDS, STEP_S, KEPT * STEP_S), ff.Law.of("robust", loader)
    ).history
    # From when the hand pushes less than the feel does.
    leaves = (TIME_S > LEANS_S) & (force < balance)
    left = STOP_RAD + ideal(arm * np.where(leaves, force - balance, 0.0), feel) < LEFT_RAD
    has_left = (TIME_S > LEANS_S) & (history["column_angle_rad"].values < LEFT_RAD)
    return float(TIME_S[has_left.argmax()] - TIME_S[left.argmax()]) if has_left.any() else np.inf


@pytest.mark.parametrize("change_s", LATE_S)
@pytest.mark.parametrize(
    ("name", "setting"),
    mostly_slow(
        [
            ("elevator-2khz", (0.03, 1.5, 0.3)),
            ("elevator-electric", (0.2, 0.8, 0.3)),
            ("rudder-pedals", (0.1, 1.5, 0.3)),
        ]
    ),
)
def test_column_leaves_a_stop_soon(name: str, setting: tuple[float, float, float], change_s: float) -> None:
    """In contact the feel is damped a hundred times as much; a hand that pulls the column away is to have it back."""
    assert late_at_leaving(name, setting, change_s) < LATE_S[change_s]
