"""What the valve forbids: the flow of the ideal by another integrator and by the engine, and loaders that cannot follow."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.frontier.valve_limits import valve_limits
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Release
from forcefeel.sizing.valve import Valve

GRID = {"stiffness": "1, 10, 100 %", "frequency": "1, 4 Hz", "damping": "0.2, 1"}
ROUNDING = 1e-12  # relative; one product
WITNESSED = {"rtol": 1e-11, "atol": 1e-13}  # of a path that is then differenced twice over 1/40 000 of its period
SAMPLED = 2e-3  # relative; the largest of the samples beside that of a fine integration
FOLLOWED = 0.1  # relative; a law follows the ideal so well


@pytest.fixture(scope="module")
def plan():
    return make_plan(ff.digital_elevator(), ("robust",), GRID)


def _demand(loader, feel, angle):
    """Largest flow at no load by Runge-Kutta and differences: eqs. (1), (5), (6), (9) written out."""
    inertia, damping, stiffness = feel
    end = 2 * np.pi / np.sqrt(stiffness / inertia)
    time = np.linspace(0, end, 40_001)
    found = solve_ivp(
        lambda _, x: [x[1], -(damping * x[1] + stiffness * x[0]) / inertia],
        (0, end),
        [angle, 0.0],
        t_eval=time,
        **WITNESSED,
    )
    theta = found.y[0]
    pressure = loader["column.inertia"] * np.gradient(found.y[1], time) / _lever(loader)
    pressure[:2] = pressure[-2:] = 0.0  # one-sided differences
    force = loader["actuator.area"] * pressure
    piston = loader["linkage.ratio"] * loader["column.base_arm"] * theta + force / loader["linkage.stiffness"]
    flow = loader["actuator.area"] * np.gradient(piston, time)
    flow += loader["actuator.oil_volume"] / (4 * loader["actuator.bulk_modulus"]) * np.gradient(pressure, time)
    share = np.sign(flow) * pressure / loader["valve.supply_pressure"]
    assert np.all(share[4:-4] < 1)
    return float((np.abs(flow) / np.sqrt(1 - share))[4:-4].max())


def _lever(loader):
    return loader["linkage.ratio"] * loader["column.base_arm"] * loader["actuator.area"]


def test_ideal_flow_matches_another_integrator(plan):
    found, loader = valve_limits(plan, threads=1), plan.loader
    for setting, feel in enumerate(plan.settings.feel(loader)):
        expected = _demand(loader, feel, plan.release_rad) / found.flow_m3_per_s
        assert found.demand[setting] == pytest.approx(expected, rel=SAMPLED), feel


def test_flow_under_a_law_matches_the_ideal(plan):
    """The engine, with a column held and let go at the loader's own setting, some time after the link has let go."""
    loader = plan.loader
    own = np.array([loader[key] for key in FEEL_SETTING])
    law = LAW_DESIGNS["robust"].design(loader, own[None])
    run = simulate(loader, Scenario(Release(plan.release_rad), 0.5), law).history
    later = run["time_s"].values > 0.06
    flow, pressure = (run[name].values[later] for name in ("actuator_flow_m3_per_s", "load_pressure_pa"))
    assert Valve(loader).statics.needed(flow, pressure).max() == pytest.approx(
        _demand(loader, own, plan.release_rad), rel=FOLLOWED
    )


def test_small_flow_limit_scales_demand_and_forbids_settings(plan):
    none = valve_limits(plan, threads=1)
    assert none.forbidden_share == 0
    assert none.longest_unload_of_period < 0.05
    slow = plan.given.replace({"valve.flow_limit": "0.5 in^3/s"})
    found = valve_limits(make_plan(slow, ("robust",), GRID), threads=1)
    assert found.flow_m3_per_s == pytest.approx(none.flow_m3_per_s / 200)
    np.testing.assert_allclose(found.demand, 200 * none.demand, rtol=ROUNDING)
    assert 0.5 < found.forbidden_share <= 1
    assert np.all(found.demand[found.forbidden] > 1)


def test_forbidden_settings_fail_in_the_engine():
    """A loader with so small a spool that some settings are forbidden: no law that there is passes them."""
    loader = ff.digital_elevator().replace({"valve.flow_limit": "18 in^3/s"})
    grid = {"stiffness": "10, 100 %", "frequency": "1, 4 Hz", "damping": "0.2, 1"}
    for name in ("robust", "observer"):
        found = ff.find_envelope(loader, (name,), grid, changes={}, arms=())
        limits = valve_limits(found.plan, threads=1)
        assert 0 < limits.forbidden_share < 1
        passes = found.passes(name)[0]
        assert passes.any()
        assert not np.any(passes & limits.forbidden)


def test_unload_time_matches_link_stretch_and_oil(plan):
    """Heavier feels than the column unload the link, and the time is that of its stretch and its oil."""
    found, loader = valve_limits(plan, threads=1), plan.loader
    feel = plan.settings.feel(loader)
    inertia, _, stiffness = feel.T
    torque = np.abs(1 - loader["column.inertia"] / inertia) * stiffness * plan.release_rad
    force = torque / (loader["linkage.ratio"] * loader["column.base_arm"])
    swept = loader["actuator.area"] * force / loader["linkage.stiffness"]
    squeezed = loader["actuator.oil_volume"] / (4 * loader["actuator.bulk_modulus"]) * force / loader["actuator.area"]
    least = (swept + squeezed) / found.flow_m3_per_s
    # At no load; against the load pressure, which is below 60 % of the supply's, at most 1 / sqrt(0.4) as long.
    assert np.all(found.unload_s >= least * 0.79)
    assert np.all(found.unload_s <= least * 1.6)


def test_linear_valve_gains_replace_the_orifice():
    loader = ff.elevator()
    assert Valve(loader).flow_m3_per_s == pytest.approx(loader["valve.current_gain"] * loader["valve.rated_current"])
    flow, pressure = np.array([1e-4, -1e-4, 1e-4]), np.array([1e6, 1e6, 2 * loader["valve.supply_pressure"]])
    expected = np.abs(flow[:2] + loader["valve.pressure_gain"] * 1e6)
    np.testing.assert_allclose(Valve(loader).statics.needed(flow, pressure)[:2], expected)
    assert Valve(loader).statics.needed(flow, pressure)[2] == np.inf
    assert Valve(loader).statics.oil_compliance > 0
