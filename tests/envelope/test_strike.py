"""How fast a stop throws a column back: the hand's force by another integrator, the rates by single runs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel.envelope.contact import STOP_RAD, touch
from forcefeel.envelope.strike import RATE_RAD_PER_S, push_n, strikes
from forcefeel.loader.loader import FEEL_SETTING

STEEL = ff.envelope.Contact(True, 1e6, 0.02)
WITNESS_RTOL, WITNESS_ATOL = 1e-9, 1e-12
FORCE_SHARE = 1e-6
"""Of the rate: the two poles of critical damping are kept 1e-9 apart."""
SAME_SHARE = 1e-9
"""Of a rate, in a batch and in a single run."""


@pytest.mark.parametrize("damping", [0.0, 0.1, 0.7, 1.0, 1.5])
@pytest.mark.parametrize("hertz", [0.1, 3.0])
def test_a_hand_takes_the_feel_to_the_stop_at_the_rate(hertz: float, damping: float) -> None:
    loader, inertia = ff.digital_elevator(), 0.5
    omega = 2 * np.pi * hertz
    feel = np.array([inertia, 2 * damping * omega * inertia, omega**2 * inertia])
    torque = push_n(loader, feel[np.newaxis], STOP_RAD)[0] * loader["column.grip_arm"]

    def moves(_: float, state: np.ndarray) -> list[float]:
        return [state[1], (torque - feel[1] * state[1] - feel[2] * state[0]) / feel[0]]

    def there(_: float, state: np.ndarray) -> float:
        return state[0] - STOP_RAD

    there.terminal = True
    reached = solve_ivp(moves, (0.0, 1.0), [0.0, 0.0], events=there, rtol=WITNESS_RTOL, atol=WITNESS_ATOL)
    assert reached.y_events[0][0, 1] == pytest.approx(RATE_RAD_PER_S, rel=FORCE_SHARE)


@pytest.fixture(scope="module")
def light():
    """Feels of an eighth of the column's inertia, and their law."""
    loader = ff.digital_elevator()
    inertia = loader["column.inertia"] / 8
    feel = np.array([[inertia, 0.6 * omega * inertia, omega**2 * inertia] for omega in (2 * np.pi, 4 * np.pi)])
    return loader, feel, ff.Law.of("robust", loader, feel)


def test_a_stop_throws_a_light_feel_back_only_without_the_part_for_contact(light) -> None:
    loader, feel, law = light
    there = STEEL.on(loader)
    with_it, without = (strikes(there, each, feel, threads=1) for each in (law, law.without_contact()))
    assert not with_it.thrown_back.any()
    assert without.thrown_back.all()
    assert (without.back > 3 * without.came).all()


def test_rates_are_those_of_a_single_run(light) -> None:
    loader, feel, law = light
    struck = strikes(STEEL.on(loader), law, feel, threads=1)
    there = STEEL.on(loader).replace(dict(zip(FEEL_SETTING, feel[1].tolist(), strict=True)), si=True)
    force = ff.Step(f"{push_n(loader, feel, STOP_RAD)[1]} N")
    run = ff.simulate(there, ff.Scenario(force, duration_s=0.4), law.some(np.array([1]))).history
    angle, rate = (run[name].to_numpy() for name in ("column_angle_rad", "column_velocity_rad_per_s"))
    hit = int(np.argmax(angle >= STOP_RAD))
    assert struck.came[1] == pytest.approx(rate[:hit].max(), rel=SAME_SHARE)
    assert struck.back[1] == pytest.approx(-rate[hit:].min(), rel=SAME_SHARE)


def test_a_column_that_comes_to_no_stop_strikes_nothing(light) -> None:
    loader, feel, _ = light
    heavy = 100 * feel
    struck = strikes(STEEL.on(loader), ff.Law.of("robust", loader, heavy), heavy, threads=1)
    assert np.isnan(struck.came).all()
    assert not struck.thrown_back.any()


def test_a_setting_that_a_stop_throws_back_is_not_quiet_though_it_comes_to_rest() -> None:
    loader = ff.digital_elevator()
    inertia, omega = loader["column.inertia"] / 2, 4 * np.pi
    feel = np.array([[inertia, 0.6 * omega * inertia, omega**2 * inertia]])
    law = ff.Law.of("robust", loader, feel)
    for each, thrown in ((law, False), (law.without_contact(), True)):
        touched = touch(loader, each, feel, STEEL, None)
        assert not touched.swings_on.any()
        assert (touched.thrown_back == [thrown]).all()
        assert (touched.quiet == [not thrown]).all()
        assert (touched.margin < 0).all() == thrown
