"""Measures of a column's angle over time, where the answer is known: a column that goes somewhere, and one that comes back."""

import math
from dataclasses import fields

import numpy as np
import pytest

import forcefeel as ff
from forcefeel import _core
from forcefeel.loader.parameters import TABLE
from forcefeel.simulation import Scenario, simulate, simulate_batch
from forcefeel.simulation.inputs import Doublet, Pulse, Release, Step
from forcefeel.simulation.limits_met import known_measures, why_no_overshoot
from forcefeel.simulation.outcome import Measures, MotorMeasures, measures_of
from forcefeel.simulation.tables import measure_rows
from forcefeel.units import UnitSystem

H = 1e-3
OVERSHOOT = 1e-6
"""Relative: the polynomial's own error around a peak."""
ROUNDING_S = 1e-12
"""A number of steps times the step. Measured: 0."""
LANES = 1e-12
"""Relative: the same sums of one run and of many side by side. Measured: 0."""
FOUR_DIGITS = 5e-4
"""Relative, half a unit of the last one at worst."""
OUTPUTS = len(_core.simulation_outputs())
TIME = np.arange(4001) * H


def measures(angle, end):
    """The measures of a column's angle whose last force holds it at ``end``, all other outputs being zero."""
    values = np.zeros((OUTPUTS, len(angle)))
    values[0] = angle
    return Measures(*_core.simulation_measure(values, H, end).tolist())


def swing(zeta, omega=10.0):
    """A unit step's answer of second order less its end: exp(-z w t) (cos w_d t + z / sqrt(1 - z^2) sin w_d t)."""
    damped = omega * math.sqrt(1 - zeta**2)
    return np.exp(-zeta * omega * TIME) * (np.cos(damped * TIME) + zeta * omega / damped * np.sin(damped * TIME))


@pytest.mark.parametrize(("start", "end"), [(0.0, 0.2), (0.0, -0.2), (0.2, 0.0), (-0.1, 0.3)])
def test_measures_of_moved_column_are_relative_to_travel(start, end):
    """A step and a release alike: the overshoot of second order is exp(-pi z / sqrt(1 - z^2))."""
    zeta = 0.3
    found = measures(end + (start - end) * swing(zeta), end)
    assert found.overshoot == pytest.approx(math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2)), rel=OVERSHOOT)
    last = np.flatnonzero(np.abs(swing(zeta)) > 0.05)[-1] * H
    assert found.settling_time_s == pytest.approx(last, abs=2 * H)


@pytest.mark.parametrize("size", [1e-9, 0.1, 1.0])
def test_returning_column_settles_relative_to_largest_excursion(size):
    bump = np.exp(-2 * TIME) * np.sin(10 * TIME)
    found = measures(0.3 + size * bump, 0.3)
    assert math.isnan(found.overshoot)
    largest = np.abs(bump).max()
    assert found.settling_time_s == pytest.approx(np.flatnonzero(np.abs(bump) > 0.05 * largest)[-1] * H, abs=2 * H)
    assert found.final_angle_rad == pytest.approx(0.3, abs=math.exp(-8) * size)  # what is left of it at the end


@pytest.mark.parametrize(("left", "has"), [(0.04, False), (0.06, True)])
@pytest.mark.parametrize("side", [-1, 1])
def test_return_threshold_is_5_percent_of_largest_excursion(left, has, side):
    angle = side * np.where(TIME < 1.0, np.sin(math.pi * TIME) * (1 - left), 0.0) + side * left * np.minimum(TIME, 1.0)
    angle /= np.abs(angle).max()
    assert math.isfinite(measures(angle, float(angle[-1])).overshoot) == has


def test_motionless_column_is_settled_without_overshoot():
    found = measures(np.full(4001, 0.1), 0.1)
    assert (math.isnan(found.overshoot), found.settling_time_s) == (True, 0.0)


FORCES = {
    "doublet": Doublet(100.0, 0.1, 0.3),
    "pulse": Pulse(100.0, 0.1, 0.3),
    "release": Release(0.1, 0.1),
    "step": Step(100.0, 0.1),
}


@pytest.mark.parametrize("name", FORCES)
def test_returning_inputs_have_no_overshoot_measure(name):
    run = simulate(ff.elevator(), Scenario(FORCES[name], 4.0))
    returns = name in {"doublet", "pulse"}
    assert math.isnan(run.measures.overshoot) == returns
    rows = {row[0]: row[1:] for row in measure_rows(run, UnitSystem.SI)}
    assert ("overshoot" in rows) != returns
    assert rows.get("overshoot (the input leads to no new place)", ("–", "")) == ("–", "")
    assert float(rows["within 5 % from"][0]) == pytest.approx(run.measures.settling_time_s, rel=FOUR_DIGITS)
    angle = run.history.column_angle_rad.values
    end, excursion = run.measures.equilibrium_angle_rad, np.abs(angle - angle[0]).max()
    band = 0.05 * (excursion if returns else abs(end - angle[0]))
    assert run.measures.settling_time_s == pytest.approx(
        np.flatnonzero(np.abs(angle - end) > band)[-1] * H, abs=ROUNDING_S
    )
    assert 0.3 < run.measures.settling_time_s < 3.5


def test_batch_lanes_choose_measures_independently():
    """Pulls of all sizes side by side: dry friction lets some columns go, and holds others where they began."""
    loader = ff.elevator().replace({"column.coulomb_friction": "10 lb", "valve.orifice": True})
    values = np.tile(loader.si_values, (17, 1))
    values[:, list(TABLE).index("pilot.force")] *= np.linspace(0.1, 1.0, 17)
    found = simulate_batch(loader, Scenario(Step(150.0, 0.1), 3.0), values, keep=["column_angle_rad"])
    for k, angle in enumerate(found.column_angle_rad.values):
        alone = measures(angle, float(found.equilibrium_angle_rad[k]))
        for name in ("overshoot", "settling_time_s", "period_s", "periods"):
            assert float(found[name][k]) == pytest.approx(getattr(alone, name), rel=LANES, nan_ok=True)
    held = np.isnan(found.overshoot.values)
    assert held.any()
    assert not held.all()


def test_step_held_by_friction_states_missing_overshoot():
    """Held by friction: the pull never breaks away."""
    loader = ff.elevator().replace({"column.coulomb_friction": "40 lb"})
    run = simulate(loader, Scenario(Step(50.0, 0.1), 1.0))
    assert why_no_overshoot(run) == "the column ended where it began"
    assert ("overshoot (the column ended where it began)", "–", "") in measure_rows(run, UnitSystem.SI)
    assert "undefined" not in " ".join(sum(measure_rows(run, UnitSystem.US), ()))


def test_verdict_states_step_against_return():
    trim = ff.simulation.Schedule((0.0, 1.0, 1.0), (0.0, 0.0, -0.1))
    loader = ff.elevator()
    pull = Scenario(Step(100.0, 0.1), 6.0)
    angle = simulate(loader.replace({"feel.hysteresis_travel": None}), pull).measures.final_angle_rad
    back = Scenario(Step(100.0, 0.1), 6.0, trim_rad=ff.simulation.Schedule(trim.times_s, (0.0, 0.0, -angle)))
    run = simulate(loader, back)
    assert math.isnan(run.measures.overshoot)
    verdict = ff.simulation.run_conclusions(run, UnitSystem.SI).verdict
    assert "Settled at" in verdict
    assert "the column ended where it began" in verdict
    assert "undefined" not in verdict


def test_measures_list_matches_fields():
    for drive, kind in (("hydraulic", Measures), ("electric", MotorMeasures)):
        assert list(measures_of(drive)) == [field.name for field in fields(kind)]
    step = simulate(ff.elevator(), Scenario(Step(100.0, 0.1)))
    assert known_measures(step) == step.measures
