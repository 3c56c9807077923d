"""What the motor forbids: current and voltage of the ideal by hand and by the engine, and loaders that cannot follow."""

import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.frontier.as_json import frontier_json
from forcefeel.frontier.findings import frontier_conclusions
from forcefeel.frontier.hardware import CHANGES
from forcefeel.frontier.motor_limits import motor_limits
from forcefeel.frontier.page.page import frontier_page
from forcefeel.frontier.result import Limit
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Release

GRID = {"stiffness": "10, 100 %", "frequency": "1, 4 Hz", "damping": "0.2, 1"}
SAMPLED = 2e-3  # relative; the largest of the samples beside a closed form
FOLLOWED = 0.15  # relative; a law follows the ideal so well


def plan_of(**changes):
    return make_plan(ff.loader.electric("sidestick-roll").replace(changes, si=True), ("robust",), GRID)


def shares(loader, feel, angle):
    """Largest share of current and voltage of an ideal release, and of the hold, equation by equation."""
    inertia, damping, stiffness = feel
    time = np.linspace(0, 2 * np.pi / np.sqrt(stiffness / inertia), 20_001)
    roots = np.roots([inertia, damping, stiffness]).astype(complex)
    roots[1] += (roots[0] == roots[1]) * 1e-6
    amounts = np.linalg.solve(np.vstack([np.ones(2), roots]), [angle, 0])
    rate, acceleration = ((np.exp(np.outer(time, roots)) * roots**n @ amounts).real for n in (1, 2))
    g = loader.__getitem__
    lever, r, kt = g("linkage.ratio") * g("column.base_arm"), g("transmission.travel"), g("motor.torque_constant")
    torque = r * g("column.inertia") * acceleration / lever + g("motor.inertia") * lever / r * acceleration
    current = torque / kt
    voltage = g("winding.resistance") * current + kt / 1.5 * lever / r * rate
    limits = g("current_loop.current_limit"), g("current_loop.voltage_limit")
    moving = max(np.abs(current).max() / limits[0], np.abs(voltage).max() / limits[1])
    held = r * stiffness * angle / lever / kt
    return moving, max(held / limits[0], g("winding.resistance") * held / limits[1])


@pytest.mark.parametrize("changes", [{}, {"current_loop.voltage_limit": 0.6}])
def test_ideal_current_and_voltage_match_the_equations(changes):
    plan = plan_of(**changes)
    found = motor_limits(plan, threads=1)
    expected = [shares(plan.loader, feel, plan.release_rad) for feel in plan.settings.feel(plan.loader)]
    np.testing.assert_allclose(np.transpose([found.demand, found.hold]), expected, rtol=SAMPLED)


def test_engine_current_matches_the_ideal():
    """After the first instants, in which the rotor takes the hand's torque off the link."""
    plan = plan_of()
    found, loader = motor_limits(plan, threads=1), plan.loader
    # Neither stiffness nor damping changes the peak, which is the first instant; the stiff, least damped swing repeats it.
    rows = plan.settings.rows
    stiffest = int(np.lexsort((-rows[:, 0], rows[:, 2], rows[:, 1]))[-1])
    inertia, damping, stiffness = plan.settings.feel(loader)[stiffest].tolist()
    own = loader.replace({"feel.inertia": inertia, "feel.damping": damping, "feel.stiffness": stiffness}, si=True)
    run = simulate(own, Scenario(Release(plan.release_rad), 0.5, 1e-4, 5e-4), "robust").history
    current = run.motor_current_a.values / loader["current_loop.current_limit"]
    settled = run.time_s.values > run.time_s.values[np.argmax(run.pilot_force_n.values == 0)] + 0.02
    assert np.abs(current[settled]).max() == pytest.approx(found.demand[stiffest], rel=FOLLOWED)


def test_settings_beyond_holding_or_tracking_limits_are_forbidden():
    weak = motor_limits(plan_of(**{"current_loop.current_limit": 6.0}), threads=1)
    assert 0 < weak.forbidden.sum() < len(weak.forbidden)
    assert weak.forbidden[weak.hold > 1].all()
    none = motor_limits(plan_of(**{"current_loop.current_limit": None, "current_loop.voltage_limit": None}), threads=1)
    assert (none.demand.max(), none.longest_unload_s, none.forbidden.any()) == (0, 0, False)


def test_unload_time_is_a_lower_bound_for_the_engine():
    """All the current that there is, against a column that is held: the link's force falls no faster."""
    plan = plan_of()
    loader = plan.loader
    found = motor_limits(plan, threads=1)
    feel = plan.settings.feel(loader)
    worst = int(np.argmax(found.unload_s))
    g = loader.__getitem__
    lever = g("linkage.ratio") * g("column.base_arm")
    held = feel[worst, 2] * plan.release_rad / lever
    jump = abs(1 - g("column.inertia") / feel[worst, 0]) * held
    mass = g("motor.inertia") / g("transmission.travel") ** 2
    largest = g("motor.torque_constant") / g("transmission.travel") * g("current_loop.current_limit")
    time = np.linspace(0, 2 * found.unload_s[worst], 20_001)
    w = np.sqrt(g("linkage.stiffness") / mass)
    # m x'' = -F_m - k x from the held stretch, undamped: x + F_m / k swings down from F_h / k + F_m / k
    force = (held + largest) * np.cos(w * time) - largest
    fastest = time[np.argmax(force <= held - jump)]
    assert found.unload_s[worst] <= fastest
    assert found.unload_s[worst] == pytest.approx(fastest, rel=0.1)  # the bound holds the force of the stretch


def test_motor_frontier_names_the_motor():
    loader = ff.loader.electric("sidestick-roll").replace({"current_loop.current_limit": 6.0}, si=True)
    grid = {"stiffness": "20, 100 %", "frequency": "2, 4 Hz", "damping": "0.4, 0.7"}
    found = ff.find_frontier(loader, grid=grid, changes={"column.inertia": 0.2}, arms=())
    assert found.drive.forbidden.any()
    told = frontier_conclusions(found, ff.UnitSystem.SI)
    said = " ".join((told.verdict, *told.findings))
    assert "The motor excludes" in said
    assert found.text(Limit.DRIVE) == "forbidden by the motor"
    page = frontier_page(found, ff.UnitSystem.SI)
    assert "Demand on the motor" in page
    assert "valve" not in page[page.index("<main") :].lower() + said.lower()
    kept = frontier_json(found, ff.UnitSystem.SI)
    assert kept["motor"]["peak_force"]["unit"] == "N"
    assert "valve" not in kept
    tried = {gain.name for gain in found.hardware}
    assert {"rotor half as heavy", "current loop twice as fast", "largest current and voltage +50 %"} < tried
    assert not {change.name for change in CHANGES if "valve" in change.name or "supply" in change.name} & tried
