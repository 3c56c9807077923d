"""The part of a law for contact: quiet against a stop and a clamp, where the law alone swings."""

import json
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.contact import STOP_RAD, Contact, swings_on
from forcefeel.envelope.settings import ListedSettings
from forcefeel.envelope.strike import push_n, strikes
from forcefeel.laws.sampled.contact_law import torque_noise
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.sensors import sample_variance
from tests import electric_witness as witness
from tests.parametrization import mostly_slow

QUIET_RAD = np.radians(0.5)
"""Range of the column's angle in the last half second; damped, it creeps towards the stop."""

NOISE_OF_STOP = 0.15
"""Range of the load cell's force over its mean where the column rests on a stop: its noise, and the stop's own vibration."""

WITNESS_RTOL = 1e-7
SAME_M = 1e-5
"""Of the drive's position, at rest and from run to run: a hundredth of the swing."""


def _light() -> ff.Loader:
    """A light feel of little damping: 400 lb in/rad, 1.5 Hz, 0.15."""
    return ff.digital_elevator().replace(_light_feel(), si=True)


def _light_feel() -> dict[str, float]:
    omega = 2 * np.pi * 1.5
    stiffness = 400 * 0.112985
    inertia = stiffness / omega**2
    return {"feel.stiffness": stiffness, "feel.inertia": inertia, "feel.damping": 2 * 0.15 * omega * inertia}


def _range_at_the_end(loader: ff.Loader, law: ff.Law, force: str) -> float:
    history = ff.simulate(loader, ff.Scenario(ff.Step(force), duration_s=8.0), law).history
    return float(np.ptp(history["column_angle_rad"].to_numpy()[-500:]))


@pytest.mark.parametrize("clamped", [False, True])
def test_a_light_feel_is_quiet_against_a_stop_and_in_a_clamp(clamped: bool) -> None:
    loader = _light()
    law = ff.Law.of("robust", loader)
    held = (
        {"pilot.arm_stiffness": 1e5, "pilot.arm_damping": 300.0}
        if clamped
        else {"column.stop_high": np.radians(5.0), "feel.hard_stop_high": np.pi}
    )
    there = loader.replace(held, si=True)
    assert _range_at_the_end(there, law.without_contact(), "1.8 lb") > 5 * QUIET_RAD
    assert _range_at_the_end(there, law, "1.8 lb") < QUIET_RAD


@pytest.mark.parametrize(
    ("name", "share", "hertz", "stiffness_n_per_m"),
    mostly_slow(
        [
            ("elevator-2khz", 0.01, 3.0, 3e3),
            ("elevator-electric", 0.01, 4.0, 1e4),
            ("aileron-wheel", 0.01, 2.0, 3e3),
            ("elevator-2khz", 0.01, 2.0, 3e3),
            ("elevator-electric", 0.025, 2.0, 3e3),
        ]
    ),
)
def test_a_light_feel_does_not_bounce_on_a_soft_stop(
    name: str, share: float, hertz: float, stiffness_n_per_m: float
) -> None:
    """Each push of the stop lasts longer than a blow. Without the rule for bounces the force is 29 to 684 lb."""
    loader = BUILT_IN[name]()
    feel = ListedSettings(np.array([[0.1, 2 * np.pi * hertz, share]])).feel(loader)
    law, stop = ff.Law.of("robust", loader, feel), Contact(True, stiffness_n_per_m, 0.02)
    assert swings_on(loader, law.without_contact(), feel, stop)[0].all()
    assert not swings_on(loader, law, feel, stop)[0].any()


def _on(name: str, setting: tuple[float, float, float], contact: Contact) -> ff.Loader:
    """A motor without noise, with a feel of a share of its largest stiffness, Hz and a damping ratio, in a contact."""
    free = ff.loader.electric(name).replace(QUIET | {"motor.cogging_torque": 0.0}, si=True)
    share, hertz, ratio = setting
    feel = ListedSettings(np.array([[ratio, 2 * np.pi * hertz, share]])).feel(free)[0]
    rows = dict(zip(("feel.inertia", "feel.damping", "feel.stiffness"), feel, strict=True))
    return contact.on(free).replace(rows, si=True).replace({"feel.breakout": None})


def _with(law: ff.Law, place: int, number: float) -> ff.Law:
    """The law with another number in its part for contact."""
    contact = law.sampled.contact.copy()
    contact[:, place] = number
    return replace(law, numbers=replace(law.sampled, contact=contact))


_DAMPING, _RIPPLE, _THRESHOLD = 3, 5, 6  # places of B_c, T_r and T_min


@pytest.mark.parametrize("witnessed", mostly_slow([False, True]))
def test_a_motor_does_not_buzz_on_steel_under_a_light_feel(witnessed: bool) -> None:
    """Damping by the link and the position loop alone, 2 K / w, lets it buzz with all of its current."""
    there = _on("elevator-electric", (0.01, 4.0, 0.3), Contact(False, 1e6, 0.1))
    made = ff.Law.of("robust", there)
    for law, buzzes in ((made, False), (_with(made, _DAMPING, 155.0), True)):
        if witnessed:
            current = witness.simulate(there, law.sampled, lambda _: 8.0, 0.6, rtol=WITNESS_RTOL)["motor_current_a"]
        else:
            scenario = ff.Scenario(ff.Step("8 N"), 0.6, 5e-4, 5e-4)
            current = ff.simulate(there, scenario, law).history["motor_current_a"].to_numpy()
        assert (np.ptp(current[-100:]) > there["current_loop.current_limit"]) == buzzes


def test_a_weak_swing_that_goes_on_ends() -> None:
    """Tapped in a clamp a stick shook on, with less torque at the grip than a push has."""
    loader, clamp = BUILT_IN["sidestick-roll"](), Contact(False, 1e5, 0.5, 3.0)
    feel = ListedSettings(np.array([[0.7, 2 * np.pi * 1.5, 0.015]])).feel(loader)
    made = ff.Law.of("robust", loader, feel)
    for law, swings in ((made, False), (_with(made, _RIPPLE, 1e9), True)):
        assert swings_on(loader, law, feel, clamp)[0].all() == swings


@pytest.mark.parametrize(
    ("name", "setting"),
    [
        ("elevator-electric", (1.5, 2 * np.pi * 1.15, 0.0383)),
        ("elevator-2khz", (1.5, 2 * np.pi * 4.0, 0.0215)),
        ("elevator-2khz", (0.1, 2 * np.pi * 3.0, 0.01)),
    ],
)
def test_a_hand_that_comes_gently_to_steel_does_not_knock_on_it(name: str, setting: tuple[float, float, float]) -> None:
    """At 2 deg/s the drive threw the column back, and it came again, four times a second. Now that happens once."""
    loader = BUILT_IN[name]()
    feel = ListedSettings(np.array([setting])).feel(loader)
    assert not swings_on(loader, ff.Law.of("robust", loader, feel), feel, Contact(True, 1e6, 0.02))[0].any()


@pytest.mark.parametrize(
    ("name", "setting", "witnessed"),
    mostly_slow(
        [
            ("rudder-pedals", (0.05, 1.5, 0.3), False),
            ("rudder-pedals", (0.05, 1.5, 0.3), True),
            ("elevator-electric", (0.05, 2.0, 0.3), True),
        ]
    ),
)
def test_a_column_that_is_let_go_at_a_stop_comes_back_soon(
    name: str, setting: tuple[float, float, float], witnessed: bool
) -> None:
    """Under the damping of the contact alone a light feel creeps away from the stop, at 1 deg/s or less."""
    there = _on(name, setting, Contact(True, 1e6, 0.02))
    hold = there["feel.stiffness"] * np.radians(5.0) / there["column.grip_arm"] + 20.0
    time = np.arange(0, 1.601, 0.01)
    force = [0.0, 0.3, 0.6, 0.61], [0.0, hold, hold, 0.0]
    law = ff.Law.of("robust", there)
    scenario = ff.Scenario(ff.Recorded(time, np.interp(time, *force)), 1.6, 1.25e-4, 5e-4)
    angle = ff.simulate(there, scenario, law).history["column_angle_rad"].to_numpy()
    held, back = angle[1200], angle[2400]  # at 0.6 and 1.2 s
    assert held > np.radians(4.6)
    assert back < 0
    if witnessed:
        found = witness.simulate(there, law.sampled, lambda t: np.interp(t, *force), 1.6, rtol=WITNESS_RTOL)
        found = found["column_angle_rad"]
        assert np.abs(angle - found).max() < SAME_SHARE * np.ptp(angle)


def test_a_column_that_shakes_in_a_firm_arm_swings_on_though_the_arm_hardly_shows_it() -> None:
    """By 1.5 deg at 50 Hz, with 15 lb at the load cell and 1 lb in the arm."""
    loader = ff.loader.electric("sidestick-roll")
    feel = ListedSettings(np.array([[0.7, 2 * np.pi * 3.0, 0.015]])).feel(loader)
    law, arm = ff.Law.of("robust", loader, feel), Contact(False, 1e3, 0.1)
    assert swings_on(loader, law.without_contact(), feel, arm)[0].all()
    assert not swings_on(loader, law, feel, arm)[0].any()


@pytest.mark.parametrize(("force_n", "rise_s"), [(150.0, 0.05), (200.0, 0.3), (300.0, 1.0)])
def test_a_stop_is_quiet_under_a_hand_that_pushes_on(force_n: float, rise_s: float) -> None:
    """The torque stays on one side; the hand is stronger than the drive, 146 N."""
    loader = ff.loader.electric("sidestick-pitch")
    law = ff.Law.of("robust", loader)
    time = np.arange(0.0, 4.0005, 5e-4)
    scenario = ff.Scenario(ff.simulation.Recorded(time, force_n * np.minimum(time / rise_s, 1)), 4.0, 5e-4, 5e-4)

    def swing(given: ff.Law) -> float:
        force = ff.simulate(loader, scenario, given).history["load_cell_force_n"].to_numpy()[-1000:]
        return float(np.ptp(force) / abs(force.mean()))

    assert swing(law.without_contact()) > 1.5
    assert swing(law) < NOISE_OF_STOP


def test_a_free_release_is_the_same_with_and_without_it() -> None:
    loader = ff.digital_elevator()
    law = ff.Law.of("robust", loader)
    runs = [
        ff.simulate(loader, ff.Scenario(ff.Release(0.17), duration_s=2.0), given).history["column_angle_rad"]
        for given in (law, law.without_contact())
    ]
    np.testing.assert_array_equal(*runs)


@pytest.mark.parametrize("name", ["elevator-2khz", "elevator-electric", "rudder-pedals"])
def test_a_column_that_struck_a_stop_rests_where_its_feel_balances_the_hand(name: str) -> None:
    loader = BUILT_IN[name]().replace({"column.stop_high": "12.5 deg"})
    angle = 0.95 * loader["column.stop_high"]
    force = loader["feel.stiffness"] * angle / loader["column.grip_arm"]
    run = ff.simulate(loader, ff.Scenario(ff.Step(force), duration_s=4.0), ff.Law.of("robust", loader)).history
    column = run["column_angle_rad"].to_numpy()
    assert column.max() > loader["column.stop_high"]
    # Without its offset the contact's law leaves the link's stretch and the drive's droop, 0.5 deg or more.
    assert abs(column[-200:].mean() - angle) < np.radians(0.05)


def test_a_hand_that_is_stronger_than_the_drive_lets_go_of_a_column_that_is_not_thrown() -> None:
    stop = np.radians(12.5)
    loader = ff.loader.electric("elevator-electric").replace({"current_loop.current_limit": "9 A"})
    force = 1.6 * loader["feel.stiffness"] * stop / loader["column.grip_arm"]
    pushed = ff.Scenario(ff.simulation.inputs.Pulse(force, 0.1, 6.0), duration_s=8.0)
    run = ff.simulate(loader, pushed, ff.Law.of("robust", loader)).history
    column, let_go = run["column_angle_rad"].to_numpy(), run["time_s"].to_numpy() > 6.1
    assert column.max() > stop
    # A feel of 2 Hz and a fifth of damping swings back by half; wound up, it was thrown into the other stop.
    assert column[let_go].min() > -0.53 * stop


@pytest.mark.parametrize("law", ["grip", "robust"])
@pytest.mark.parametrize("name", ["sidestick-pitch", "elevator-electric"])
def test_a_hand_that_pushes_a_column_with_a_sensor_at_the_grip_into_its_end_stop(name: str, law: str) -> None:
    """The drive holds the force of the feel's spring against the hand, and the stop the rest.

    The feel had gone on, and the drive pushed the column into the stop with all its current.
    """
    loader = ff.loader.electric(name).replace({"grip_sensor.gain": 1.0})
    arm, stop = loader["column.grip_arm"], loader["column.stop_high"]
    spring = loader["feel.stiffness"] * stop
    time = np.arange(0.0, 2.0005, 5e-4)
    pushed = ff.simulation.Recorded(time, 1.25 * spring / arm * np.minimum(time / 0.3, 1))
    run = ff.simulate(loader, ff.Scenario(pushed, 2.0, 5e-4, 5e-4), ff.Law.of(law, loader)).history
    column, feel, force = (
        run[name].to_numpy()[-1000:] for name in ("column_angle_rad", "feel_position_rad", "load_cell_force_n")
    )
    lever = loader["linkage.ratio"] * loader["column.base_arm"]
    assert column.mean() > stop
    assert np.ptp(column) < QUIET_RAD
    assert feel.mean() == pytest.approx(stop, abs=np.radians(1.0))  # it went on by a quarter, 3 deg and more
    assert -1.1 * spring < lever * force.mean() < 0  # with the hand's push it would be positive


QUIET = {
    f"{sensor}.{row}": 0.0
    for sensor in ("load_cell", "potentiometer", "column_sensor")
    for row in ("noise", "resolution")
}


@pytest.mark.slow
def test_an_independent_integrator_finds_the_same_strike_and_the_same_rest() -> None:
    stop = {
        "column.stop_high": np.radians(5.0),
        "column.stop_stiffness": 6e4,
        "column.stop_damping": 100.0,
        "feel.hard_stop_high": np.pi,
    }
    loader = ff.loader.electric("elevator-electric").replace(
        _light_feel() | stop | QUIET | {"motor.cogging_torque": 0.0}, si=True
    )
    law = ff.Law.of("robust", loader)
    force, duration = 8.0, 0.5
    run = ff.simulate(loader, ff.Scenario(ff.Step(f"{force} N"), duration, 5e-4, 5e-4), law).history
    found = witness.simulate(loader, law.sampled, lambda _: force, duration)["column_angle_rad"]
    angle = run["column_angle_rad"].to_numpy()
    depth = angle.max() - np.radians(5.0)
    assert depth > 1e-3  # it struck, with some 80 N
    assert np.abs(angle - found).max() < 0.01 * depth


RATE_SHARE = 0.01
"""Of a rate from angles 0.5 ms apart, beside one in between."""


def test_an_independent_integrator_finds_the_same_rate_from_a_stop() -> None:
    free = ff.loader.electric("elevator-electric").replace(QUIET | {"motor.cogging_torque": 0.0}, si=True)
    inertia, omega = 0.1 * free["column.inertia"], 3 * np.pi
    feel = np.array([[inertia, 0.6 * omega * inertia, omega**2 * inertia]])
    there = Contact(True, 1e5, 0.1).on(free).replace(dict(zip(FEEL_SETTING, feel[0].tolist(), strict=True)), si=True)
    law, force = ff.Law.of("robust", there), push_n(there, feel, STOP_RAD)[0]
    struck = strikes(there, law, feel, threads=1)
    angle = witness.simulate(there, law.sampled, lambda _: force, 0.4)["column_angle_rad"]
    rate, hit = np.gradient(angle, 5e-4), int(np.argmax(angle >= STOP_RAD))
    assert struck.came[0] == pytest.approx(rate[:hit].max(), rel=RATE_SHARE)
    assert struck.back[0] == pytest.approx(-rate[hit:].min(), rel=RATE_SHARE)


def test_an_independent_integrator_finds_the_same_gentle_strike() -> None:
    """The column comes to steel at 2 deg/s, is thrown back by half a degree, and creeps there again."""
    there = _on("elevator-electric", (0.0383, 1.15, 1.5), Contact(True, 1e6, 0.02))
    law, force_n, duration_s = ff.Law.of("robust", there), 8.0, 1.2
    found = witness.simulate(there, law.sampled, lambda _: force_n, duration_s, rtol=WITNESS_RTOL)["column_angle_rad"]
    scenario = ff.Scenario(ff.Step(f"{force_n} N"), duration_s, 1.25e-4, 5e-4)
    angle = ff.simulate(there, scenario, law).history["column_angle_rad"].to_numpy()
    rebound = angle.max() - angle[np.argmax(angle) :].min()
    assert 0.4 < np.degrees(rebound) < 0.6
    assert np.abs(angle - found).max() < 0.01 * rebound


def test_an_independent_integrator_finds_the_same_feel_that_is_kept_near_its_column() -> None:
    """Of a law that notices no contact, on a soft stop, where the drive swings at its limit."""
    hertz, stop, force_n = 5.0, (3e3, 0.1), 8.0
    free = ff.loader.electric("elevator-electric")
    omega = 2 * np.pi * hertz
    inertia = (stiffness := 0.04 * free["feel.stiffness"]) / omega**2
    light = {"feel.stiffness": stiffness, "feel.inertia": inertia, "feel.damping": 0.2 * omega * inertia}
    loader = Contact(True, *stop).on(free).replace(light | QUIET | {"motor.cogging_torque": 0.0}, si=True)
    law = _with(_with(ff.Law.of("robust", loader), _THRESHOLD, 1e9), _RIPPLE, 1e9)
    run = ff.simulate(loader, ff.Scenario(ff.Step(f"{force_n} N"), 0.5, 1.25e-4, 5e-4), law).history
    feel, column = run["feel_position_rad"].to_numpy(), run["column_angle_rad"].to_numpy()
    farther_out = ((feel - column) * np.sign(feel)).max()
    assert np.abs(feel - column).max() > LEAD_RAD
    assert farther_out < LEAD_RAD + UNTIL_SAMPLE_RAD
    found = witness.simulate(loader, law.sampled, lambda _: force_n, 0.5, rtol=WITNESS_RTOL)["column_angle_rad"]
    assert np.abs(column - found).max() < SAME_SHARE * np.ptp(column)


@pytest.mark.parametrize(
    ("name", "share", "stiffness"),
    mostly_slow(
        [
            ("elevator-2khz", 0.1, 1e6),
            ("aileron-wheel", 0.1, 1e6),
            ("desktop-yoke", 0.12, 1e4),
            ("elevator-2khz", 0.3, 1e6),
        ],
        fast=2,
    ),
)
def test_a_stop_does_not_throw_the_column_of_a_light_feel_back_with_more_speed_than_it_had(
    name: str, share: float, stiffness: float
) -> None:
    """The stop takes the whole column's momentum. Without its part for contact the law throws it back 6 to 28 times as fast."""
    free, hits_s = BUILT_IN[name](), 0.2
    inertia, rate = share * free["column.inertia"], np.radians(5.0) / 0.1
    spring = inertia * (2 * np.pi * 1.5) ** 2
    light = {"feel.inertia": inertia, "feel.damping": 0.6 * np.sqrt(inertia * spring), "feel.stiffness": spring}
    loader = Contact(True, stiffness, 0.1).on(free).replace(light, si=True)
    force = 1.5 * inertia * rate / 0.1 / free["column.grip_arm"]
    push = ff.Scenario(ff.simulation.Pulse(f"{force} N", start_s=0.05, width_s=hits_s - 0.05), 0.6, 1.25e-4, 5e-4)
    law = ff.Law.of("robust", loader)
    angle = ff.simulate(loader, push, law).history["column_angle_rad"].to_numpy()
    speed = np.gradient(angle, 5e-4)
    struck = np.argmax(angle >= np.radians(5.0))
    assert struck > 0
    assert -speed[struck:].min() < 1.8 * speed[:struck].max()


SAME_SHARE = 1e-3
"""Of a swing, from run to run: the engine at steps of 0.5 ms is 2.4e-3 away, and a tenth if it notices a sample late."""

LEAD_RAD, UNTIL_SAMPLE_RAD = 0.05, 0.005

SOFT_STOP = {"column.stop_stiffness": 6e3, "column.stop_damping": 5.0, "motor.cogging_torque": 0.0}


def _push(at: float) -> float:
    """A hand in N that is at 200 N after 0.3 s."""
    return 200.0 * min(at / 0.3, 1.0)


def _blow(at: float) -> float:
    """A hand in N that has let go when the feel comes to the stop by its own motion."""
    return 400.0 * float(np.interp(at, [0.0, 0.02, 0.04, 0.06], [0.0, 1.0, 1.0, 0.0]))


def _under(hand: Callable[[float], float], duration: float) -> ff.Scenario:
    time = np.arange(0.0, duration + 3e-4, 5e-4)
    return ff.Scenario(ff.simulation.Recorded(time, np.vectorize(hand)(time)), duration, 5e-4, 5e-4)


@pytest.mark.parametrize(("hand", "duration"), mostly_slow([(_blow, 0.2), (_push, 0.6)]), ids=["blow", "push"])
def test_an_independent_integrator_finds_the_same_end_stop_under_a_sensor_at_the_grip(
    hand: Callable[[float], float], duration: float
) -> None:
    loader = ff.loader.electric("sidestick-pitch").replace(SOFT_STOP | QUIET | {"grip_sensor.gain": 1.0}, si=True)
    loader = loader.replace({"feel.breakout": None})
    law = ff.Law.of("grip", loader)
    run = ff.simulate(loader, _under(hand, duration), law).history["column_angle_rad"].to_numpy()
    found = witness.simulate(loader, law.sampled, hand, duration, rtol=1e-7)["column_angle_rad"]  # far below the depth
    depth = run.max() - loader["column.stop_high"]
    assert depth > 3e-3  # 200 N at the soft stop
    assert np.abs(run - found).max() < 0.02 * depth  # a touch between two samples


@pytest.mark.slow
@pytest.mark.parametrize("rests", mostly_slow([True, False]))
def test_an_independent_integrator_finds_the_same_rest_under_a_hand_that_pushes_on(rests: bool) -> None:
    """200 N into the stop of a stick: the drive swings by 1.3 mm without the part for contact, by 3 um with it."""
    loader = ff.loader.electric("sidestick-pitch").replace(SOFT_STOP | QUIET, si=True).replace({"feel.breakout": None})
    made = ff.Law.of("robust", loader)
    law = made if rests else made.without_contact()
    run = ff.simulate(loader, _under(_push, 1.2), law).history["drive_position_m"].to_numpy()
    found = witness.simulate(loader, law.sampled, _push, 1.2, rtol=1e-7)["drive_position_m"]  # far below the swing
    assert np.abs(run - found).max() < SAME_M
    assert [np.ptp(position[-400:]) < SAME_M for position in (run, found)] == [rests] * 2


LAG = {f"{sensor}.bandwidth": "500 Hz" for sensor in ("load_cell", "potentiometer", "column_sensor")}


def _feels(loader: ff.Loader) -> np.ndarray:
    """I, B, G: 4, 20 and 100 % of the loader's stiffness, 1 and 2.5 Hz, damping 0.3 and 0.7."""
    rows = []
    for share, hertz, ratio in product((0.04, 0.2, 1.0), (1.0, 2.5), (0.3, 0.7)):
        stiffness, omega = share * loader["feel.stiffness"], 2 * np.pi * hertz
        rows.append((stiffness / omega**2, 2 * ratio * stiffness / omega, stiffness))
    return np.array(rows)


@pytest.mark.parametrize(
    "name", ["sidestick-pitch", "sidestick-roll", "aileron-wheel", "desktop-yoke", "elevator-electric"]
)
def test_sensors_of_500_hz_leave_the_column_quiet_on_steel(name: str) -> None:
    """With the bandwidth of ideal sensors the sticks swing on at 130 Hz in 4 to 12 of these 12 settings."""
    loader = ff.loader.electric(name).replace(LAG)
    feel = _feels(loader)
    law = ff.Law.of("robust", loader, feel)
    for contact in (Contact(False, 1e5, 0.02), Contact(False, 1e6, 0.02), Contact(True, 1e6, 0.02)):
        assert not swings_on(loader, law, feel, contact)[0].any(), contact.name


@pytest.mark.slow
def test_an_independent_integrator_finds_a_stick_with_slow_sensors_at_rest_on_steel() -> None:
    """40 N onto a stop of 1e6 N/m: made for ideal sensors, the law swings by 0.13 mm and 92 N there."""
    stick = ff.loader.electric("sidestick-pitch").replace(LAG).replace({"feel.breakout": None})
    inertia, damping, stiffness = _feels(stick)[1]
    on_steel = (
        Contact(True, 1e6, 0.02)
        .on(stick)
        .replace(
            QUIET
            | {
                "motor.cogging_torque": 0.0,
                "feel.inertia": inertia,
                "feel.damping": damping,
                "feel.stiffness": stiffness,
            },
            si=True,
        )
    )
    law = ff.Law.of("robust", on_steel)
    run = ff.simulate(on_steel, ff.Scenario(ff.Step("40 N"), 0.6, 5e-4, 5e-4), law).history["drive_position_m"]
    found = witness.simulate(on_steel, law.sampled, lambda _: 40.0, 0.6, rtol=WITNESS_RTOL)["drive_position_m"]
    for position in (run.to_numpy(), found):
        assert np.ptp(position[-200:]) < SAME_M
    assert abs(run.to_numpy()[-1] - found[-1]) < SAME_M


@pytest.mark.slow
def test_the_noise_of_the_torque_is_that_of_a_simulated_observer() -> None:
    loader = ff.digital_elevator()
    law = ff.Law.of("robust", loader).sampled
    sigma = np.sqrt(sample_variance(loader))
    random, xi, smooth, seen = np.random.default_rng(1), np.zeros(law.states), 0.0, []
    for _ in range(40_000):
        noise = sigma * random.standard_normal(3)
        torque = float(law.torque[0, : law.states + 3] @ np.append(xi, noise))
        xi = law.transition[0] @ xi + law.input[0, :, :3] @ noise
        smooth += (torque - smooth) * law.period_s / 0.004
        seen.append(smooth)
    # 38,000 samples of 8 periods' memory tell a deviation to some 2 %.
    assert torque_noise(law, loader)[0] == pytest.approx(np.std(seen[2000:]), rel=0.05)


def test_a_law_file_keeps_it(tmp_path: object) -> None:
    loader = ff.digital_elevator()
    law = ff.Law.of("robust", loader)
    path = f"{tmp_path}/law.json"
    law.save(path)
    np.testing.assert_array_equal(ff.Law.of(path, loader).sampled.contact, law.sampled.contact)
    stated = json.loads(Path(path).read_text(encoding="utf-8"))
    assert len(stated["units"]["contact"]) == len(stated["contact"][0])


def test_a_law_of_gains_has_none() -> None:
    law = ff.Law.of("original", ff.elevator())
    assert law.without_contact() is law


@pytest.mark.parametrize("name", ["torque-mode", "load-cell"])
def test_a_law_that_estimates_no_hand_from_the_load_cell_has_none(name: str) -> None:
    law = ff.Law.of(name, ff.loader.electric("elevator-electric"))
    assert not law.sampled.knows_contact
