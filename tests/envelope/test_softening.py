"""Settings softened to what the drive renders: the limit by an independent integration, and what a law renders of them."""

from math import radians

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute
from forcefeel.envelope.softening import LEAST, largest_share, soften, softening, with_share
from forcefeel.loader.parameters import INDEX

SLOW = ff.digital_elevator().replace({"valve.flow_limit": "18 in^3/s"})
STICK = ff.loader.electric("sidestick-pitch")
GRID = {"stiffness": "10, 50, 100 %", "frequency": "2, 4 Hz", "damping": "0.1, 0.7"}
FEEL = ("feel.inertia", "feel.damping", "feel.stiffness")
HALVED = 0.004
"""Relative: ten halvings of a factor of ten, and the samples of a motion."""
EXACT = 1e-9
"""Of the integrator."""


def largest_flow(loader, angle):
    """Largest flow at no load over a release, eqs. (1), (5)-(9), by an integrator."""
    g = loader.__getitem__
    inertia, damping, stiffness = map(g, FEEL)
    lever, area, column = g("linkage.ratio") * g("column.base_arm"), g("actuator.area"), g("column.inertia")
    times = np.linspace(0.0, 2.0, 4001)
    rates = lambda _, x: (x[1], -(damping * x[1] + stiffness * x[0]) / inertia)  # noqa: E731
    theta, velocity = solve_ivp(rates, (0, 2), (angle, 0), t_eval=times, rtol=EXACT, atol=EXACT).y
    acceleration = -(damping * velocity + stiffness * theta) / inertia
    jerk = -(damping * acceleration + stiffness * velocity) / inertia
    pressure, pressure_rate = (column * term / (lever * area) for term in (acceleration, jerk))
    oil = g("actuator.oil_volume") / (4 * g("actuator.bulk_modulus"))
    flow = area * (lever * velocity + area * pressure_rate / g("linkage.stiffness")) + oil * pressure_rate
    return np.max(np.abs(flow) / np.sqrt(1 - np.sign(flow) * pressure / g("valve.supply_pressure")))


def test_softened_release_takes_all_of_the_valves_flow():
    softened = soften(SLOW)
    assert softened.reason == "the valve's flow"
    assert largest_flow(SLOW, radians(10)) > 1.2 * SLOW["valve.flow_limit"]
    assert largest_flow(softened.loader, radians(10)) == pytest.approx(SLOW["valve.flow_limit"], rel=HALVED)

    inertia, damping, stiffness = ([loader[key] for loader in (softened.loader, SLOW)] for key in FEEL)
    assert inertia[0] == inertia[1]
    assert damping[0] / damping[1] == pytest.approx(np.sqrt(stiffness[0] / stiffness[1]))


def test_softened_stick_is_held_at_its_stop_by_the_largest_current():
    stiff = STICK.replace({"feel.stiffness": 2 * STICK["feel.stiffness"]}, si=True)
    g = soften(stiff).loader.__getitem__
    end = max(g("column.stop_high"), -g("column.stop_low"))
    link = g("feel.stiffness") * end / (g("linkage.ratio") * g("column.base_arm"))
    current = link * g("transmission.travel") / g("motor.torque_constant")
    # What the feel's own rows, its breakout and friction, and the transmission take beside the spring is less than a tenth.
    assert 0.9 < current / g("current_loop.current_limit") < 1.0 + HALVED


@pytest.mark.parametrize("loader", [ff.elevator(), ff.digital_elevator(), STICK])
def test_feel_within_the_drives_capability_stays(loader):
    softened = soften(loader)
    assert (softened.loader, softened.reason, softened.sentence(ff.UnitSystem.US)) == (loader, "", "")


def test_feel_that_no_share_of_is_rendered_raises_input_error():
    weak = SLOW.replace({"valve.flow_limit": "1 in^3/s"})
    with pytest.raises(ff.InputError, match="does not render 10% of its stiffness because of the valve's flow"):
        soften(weak)


def test_largest_share_is_the_softened_feel_of_a_stiffer_one():
    most = largest_share(STICK, 8.0)
    assert 1 < most < 8
    stiffer = soften(with_share(STICK, 8.0)).loader
    assert stiffer["feel.stiffness"] == pytest.approx(most * STICK["feel.stiffness"], rel=2 * HALVED)
    assert largest_share(ff.elevator(), 8.0) == 8.0


def test_softened_settings_are_rendered_that_failed_as_programmed():
    plan = make_plan(SLOW, ["robust"], GRID, changes={}, arms=(), angle_rad=radians(10), soften=True)
    limits = softening(plan)
    over = limits.reason >= 0
    assert 0 < over.sum() < len(over)
    assert (limits.share[~over] == 1).all()
    assert ((limits.share[over] >= LEAST) & (limits.share[over] < 1)).all()
    # As a loader's own feel.
    row = int(np.flatnonzero(over)[0])
    values = SLOW.si_values.copy()
    values[[INDEX[key] for key in FEEL]] = plan.settings.feel(plan.loader)[row]
    own = soften(SLOW.replace({key: values[INDEX[key]] for key in FEEL}, si=True))
    assert own.loader["feel.stiffness"] / values[INDEX["feel.stiffness"]] == pytest.approx(
        limits.share[row], rel=HALVED
    )

    envelope = compute(plan, threads=1)
    (shares,) = envelope.softened
    assert shares.as_programmed == envelope.shares("robust").nominal_share
    assert shares.as_programmed + shares.softened + shares.not_rendered == pytest.approx(1.0)
    failed = over & ~envelope.passes("robust")[0]
    assert shares.softened > 0.8 * failed.mean() > 0
    assert shares.least == limits.share[over & np.isfinite(limits.share)].min()


def test_envelope_without_the_option_softens_nothing():
    plan = make_plan(SLOW, ["robust"], GRID, changes={}, arms=(), angle_rad=radians(10))
    assert compute(plan, threads=1).softened == ()
