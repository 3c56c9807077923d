"""What no law renders: by the drive's fastest fall and the noise of a law that renders, held against runs of every law."""

from math import radians

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import minimize

import forcefeel as ff
from forcefeel.envelope.as_json import envelope_json
from forcefeel.envelope.findings import envelope_conclusions
from forcefeel.envelope.forbidden import COVERED, NOISE, THROW, angle_variance, forbidden, noise_floor
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute
from forcefeel.loader.sensors import sample_variance
from forcefeel.sizing.fastest import Fastest, Limit
from tests.parametrization import mostly_slow

GRID = {"stiffness": "2, 20, 100 %", "frequency": "0.7, 4 Hz", "damping": "0.1, 1"}
SLOW = ff.digital_elevator().replace({"valve.flow_limit": "18 in^3/s"})
HALF = np.array([1 / 2])
EXACT = 1e-9
"""Of the integrator."""
FINE = 1e-3
COARSE = 0.02
"""Of 60 frequencies, added up by trapezoids, from 0.01 of the feel's on."""
"""Relative; a fall is cut into some thousand moments."""


def planned(loader, angle_deg=10.0, laws=("robust",), **more):
    return make_plan(loader, laws, GRID, changes={}, arms=(), angle_rad=radians(angle_deg), **more)


def test_fastest_fall_matches_an_independent_integration():
    """J theta'' = -k (theta - x), x' = -v, by an integrator; k in series with the oil."""
    g = SLOW.__getitem__
    lever = g("linkage.ratio") * g("column.base_arm")
    oil = g("actuator.area") ** 2 * 4 * g("actuator.bulk_modulus") / g("actuator.oil_volume")
    k = lever**2 / (1 / g("linkage.stiffness") + 1 / oil)
    speed = g("valve.flow_limit") / g("actuator.area") / lever
    theta, stiffness = radians(10), 0.3 * g("feel.maximum_stiffness")

    def crosses(level):
        def event(_, state):
            return state[0] - level * theta

        event.terminal = True
        return event

    def rates(t, state):
        return state[1], -k / g("column.inertia") * (state[0] - (theta - stiffness * theta / k - speed * t))

    high, low = (
        solve_ivp(rates, (0, 1), (theta, 0), events=crosses(level), rtol=EXACT, atol=EXACT).t_events[0][0]
        for level in (0.9, 0)
    )
    found, _ = Fastest.of(SLOW).fall_s(theta, np.array([stiffness]), 0.9, 0.0)
    assert found[0] == pytest.approx(low - high, rel=FINE)


def test_force_limit_alone_gives_constant_acceleration():
    motor = ff.loader.electric("sidestick-roll")
    fastest = Fastest.of(motor)
    _, found = fastest.fall_s(0.2, np.array([5.0]), 0.9, 0.0)
    way, a = 0.2 * motor["column.grip_arm"], fastest.force_n / fastest.mass_kg
    assert found[0] == pytest.approx(np.sqrt(2 * way / a) - np.sqrt(0.2 * way / a))


def test_drive_without_limits_forbids_nothing():
    for loader in (ff.elevator(), ff.elevator().replace({"controller.period": "0.5 ms", "controller.delay": "0.5 ms"})):
        laws = ("published",)
        assert not forbidden(planned(loader, laws=laws), threads=1).settings.any()


@pytest.mark.parametrize(
    ("loader", "laws", "reason"),
    mostly_slow(
        [
            (SLOW, ("robust", "agile", "observer"), Limit.FLOW),
            (
                ff.digital_elevator().replace({"amplifier.current_limit": "0.8 mA"}),
                ("robust", "observer"),
                Limit.CURRENT,
            ),
            (
                ff.digital_elevator().replace({"valve.supply_pressure": "90 psi"}),
                ("robust", "observer"),
                Limit.PRESSURE,
            ),
            (
                ff.loader.electric("rudder-pedals").replace({"current_loop.current_limit": 5.0}, si=True),
                ("robust", "observer"),
                Limit.TORQUE,
            ),
            (
                ff.loader.electric("sidestick-pitch").replace({"current_loop.voltage_limit": 2.0}, si=True),
                ("robust", "observer"),
                None,
            ),
            (
                ff.digital_elevator().replace({"linkage.stiffness": "900 lb/in", "valve.flow_limit": "40 in^3/s"}),
                ("robust", "agile", "observer"),
                THROW,
            ),
            (
                ff.loader.electric("sidestick-pitch").replace({"linkage.stiffness": 60000.0}, si=True),
                ("robust", "observer"),
                THROW,
            ),
        ],
        2,
    ),
)
def test_no_law_passes_settings_forbidden_by_the_drive(loader, laws, reason):
    plan = planned(loader, laws=laws)
    found = compute(plan, threads=1)
    which = found.forbidden.settings
    assert 0 < which.sum() < len(which)
    assert reason is None or str(reason) in found.forbidden.counts
    for law in laws:
        assert not found.passes(law)[0][which].any()


def test_noise_floor_matches_its_transfer_function():
    """|J s^2 H - 1|^2, added up by quadrature."""
    plan = planned(ff.digital_elevator())
    g, found = plan.loader.__getitem__, noise_floor(plan)
    for place in (0, 7):
        inertia, damping, stiffness = plan.settings.feel(plan.loader)[place]
        w = plan.settings.rows[place, 1]

        def density(omega, inertia=inertia, damping=damping, stiffness=stiffness):
            s = 1j * omega
            return abs(g("column.inertia") * s**2 / (inertia * s**2 + damping * s + stiffness) - 1) ** 2

        area, _ = quad(density, 0, 2 * w, points=[w], limit=500)
        expected = angle_variance(plan.loader) * g("controller.period") / np.pi * area
        assert found[place] ** 2 == pytest.approx(expected, rel=FINE)


def test_grip_sensor_noise_floor_is_the_minimum_over_all_laws():
    """Over what angle and grip's force are each given, ``T_l = C (theta + n) + D (T_p - m s^2 theta + n_g)``, by a search."""
    sensor = {"grip_sensor.gain": 0.9, "grip_sensor.noise": "0.05 lb", "grip_sensor.mass": "2 lbm"}
    plan = planned(ff.digital_elevator().replace(sensor, si=True))
    g, bare = plan.loader.__getitem__, angle_variance(plan.loader)
    force = sample_variance(plan.loader)[-1] * (g("column.grip_arm") / g("grip_sensor.gain")) ** 2
    outboard = g("grip_sensor.mass") * g("column.grip_arm") ** 2
    inertia, damping, stiffness = plan.settings.feel(plan.loader)[7]
    w = plan.settings.rows[7, 1]

    def least(omega):
        s = 1j * omega
        ideal = 1 / (inertia * s**2 + damping * s + stiffness)

        def density(parts):
            hears = complex(*parts)
            follows = g("column.inertia") * s**2 + hears * outboard * s**2 - (1 + hears) / ideal
            moved = ideal / (1 + hears)
            return abs(follows * moved) ** 2 * bare / scale + abs(hears * moved) ** 2 * force / scale

        scale = abs(ideal) ** 2 * force
        return min(minimize(density, start).fun for start in ([-0.5, 0.1], [1.0, 0.3])) * scale

    omega = np.linspace(0.01, 2, 60) * w
    expected = np.trapezoid([least(one) for one in omega], omega) * g("controller.period") / np.pi
    assert noise_floor(plan)[7] ** 2 == pytest.approx(expected, rel=COARSE)
    assert noise_floor(plan)[7] < noise_floor(planned(ff.digital_elevator()))[7]


def test_noise_forbids_light_small_feels_and_no_law_passes_them():
    rows = {f"{sensor}.{row}": "0.3 deg" for sensor in ("column_sensor",) for row in ("noise", "resolution")}
    coarse = {"potentiometer.noise": "0.1 in", "potentiometer.resolution": "0.1 in"}
    loader = ff.digital_elevator().replace(rows | coarse, si=True)
    found = compute(planned(loader, 2.0, ("robust", "observer")), threads=1)
    which = found.forbidden.of(NOISE)
    assert 0 < which.sum() < len(which)
    assert (found.forbidden.noise_rad[which] > COVERED * 0.05 * radians(2)).all()
    for law in found.laws:
        assert not found.passes(law)[0][which].any()


def test_forbidden_settings_are_counted_separately():
    found = ff.find_envelope(SLOW, ["robust"], GRID, changes={}, arms=(), smaller_rad=(radians(2),))
    count, allowed = int(found.forbidden.settings.sum()), found.allowed_shares("robust")
    assert allowed.settings == 12 - count
    assert allowed.nominal_share * allowed.settings == pytest.approx(found.shares("robust").nominal_share * 12)
    told = envelope_conclusions(found, ff.UnitSystem.US)
    feels = f"of the {12 - count} of 12 programmed feels that the valve's flow allows, released from 10 deg."
    assert told.verdict.endswith(feels)
    assert told.findings[0].startswith(f"No law renders {count} of 12 settings because of the valve's flow")
    kept = envelope_json(found, ff.UnitSystem.US)
    assert kept["forbidden"] == {"the valve's flow": count}
    own, small = kept["laws"]["robust"]["nominal_by_release_angle"]
    assert (own["release_angle"]["value"], small["release_angle"]["value"]) == pytest.approx((10, 2))
    assert small["allowed"] > own["allowed"]
    assert [one.release_rad for one in found.by_angle] == pytest.approx([radians(10), radians(2)])


def test_smaller_releases_are_below_the_default_release():
    plan = planned(SLOW, 2.0).with_smaller_releases()
    assert plan.smaller_rad == pytest.approx([radians(1), radians(0.5)])
    assert plan.releases == 3 * plan.usual_releases(plan.cases[0])
    assert planned(ff.elevator(), laws=("published",)).with_smaller_releases().smaller_rad == ()
    with pytest.raises(ff.InputError, match="smaller_rad: expected an angle above 0 and up to 90 deg"):
        planned(SLOW, smaller_rad=(0.0,))
