"""The column led ahead of a heavy feel: by how much, what the hand then feels, and the clamp in which it swung on without."""

from collections.abc import Callable

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.contact import TAP_N, TAP_S, Contact
from forcefeel.envelope.grip import Grips
from forcefeel.envelope.settings import ListedSettings
from forcefeel.laws.sampled import advance
from forcefeel.loader.built_in import BUILT_IN
from tests import electric_witness as witness
from tests.laws.test_contact_law import WITNESS_RTOL, _on

FIRST_ORDER = 0.02
"""Of ``c T'``, beside what goes with ``T''`` at 0.2 Hz."""

PASSIVE_HZ = np.linspace(0.5, 4.5, 9)
"""To just below the frequency of the rule, which counts with the lag of slow torques."""

HEAVY = [("elevator-2khz", 1.0), ("elevator-electric", 0.3), ("rudder-pedals", 0.1), ("desktop-yoke", 0.3)]
"""Loaders, and shares of their largest stiffness."""


@pytest.fixture
def not_led(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    return lambda: monkeypatch.setattr(advance, "PASSIVE_TO_HZ", 1e-3)


def _slow(loader: ff.Loader, share: float) -> np.ndarray:
    """Of 0.8 Hz and a damping ratio of 0.1."""
    return ListedSettings(np.array([[0.1, 2 * np.pi * 0.8, share]])).feel(loader)


def _tap(time: float) -> float:
    return TAP_N if time < TAP_S else 0.0


def _admittance(loader: ff.Loader, feel: np.ndarray, hz: np.ndarray) -> np.ndarray:
    """At the column, in rad/s per N m."""
    at_grip = Grips.of(loader, ff.Law.of("robust", loader, feel), feel).admittance(0, hz)
    return at_grip / loader["column.grip_arm"] ** 2


@pytest.mark.parametrize("name", ["rudder-pedals", "desktop-yoke"])
def test_under_a_rising_torque_the_column_is_apart_as_its_admittance_has_it(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That of a feel which does not move is ``s^2 c``; one without damping is not led."""
    loader, found, torque_lag = BUILT_IN[name](), [], advance.torque_lag
    monkeypatch.setattr(advance, "torque_lag", lambda *given: found.append(torque_lag(*given)) or found[-1])
    feel = np.array([[1e5 * loader["column.inertia"], 0.0, 0.1 * loader["feel.maximum_stiffness"]]])
    hz = np.array([0.2])
    lag = -_admittance(loader, feel, hz).real / (2 * np.pi * hz) ** 2
    assert lag == pytest.approx(found[0], rel=FIRST_ORDER)


@pytest.mark.parametrize(("name", "share"), HEAVY)
def test_a_heavy_feel_gives_off_no_energy_at_the_grip(name: str, share: float, not_led: Callable[[], None]) -> None:
    loader = BUILT_IN[name]()
    feel = _slow(loader, share)
    assert (_admittance(loader, feel, PASSIVE_HZ).real > 0).all()
    not_led()
    assert _admittance(loader, feel, PASSIVE_HZ).real[-1] < 0


def test_a_heavy_feel_in_a_clamp_comes_to_rest_by_an_own_integrator(not_led: Callable[[], None]) -> None:
    """Without it the swing grew, too slow and too weak for contact, for 3 s."""
    there = _on("elevator-electric", (0.3, 0.8, 0.1), Contact(False, 1e4, 0.02))

    def last_over_first() -> float:
        law = ff.Law.of("robust", there).sampled
        angle = witness.simulate(there, law, _tap, 1.2, rtol=WITNESS_RTOL)["column_angle_rad"]
        third = len(angle) // 3
        return float(np.ptp(angle[-third:]) / np.ptp(angle[:third]))

    assert last_over_first() < 0.6
    not_led()
    assert last_over_first() > 0.95


def test_a_light_feel_and_a_quick_one_are_not_led(not_led: Callable[[], None]) -> None:
    """They are passive by themselves, or swing no slower in a clamp."""
    loader = ff.digital_elevator()
    feel = ListedSettings(np.array([[0.3, 2 * np.pi * 0.8, 0.02], [0.1, 2 * np.pi * 5.5, 0.5]])).feel(loader)
    law = ff.Law.of("robust", loader, feel).sampled
    not_led()
    np.testing.assert_array_equal(law.rows(), ff.Law.of("robust", loader, feel).sampled.rows())
