"""Without effects the run is the linear model's own; an effect that is off changes no bit, in whatever lane."""

from dataclasses import replace

import control
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.simulation import Scenario, simulate, simulate_batch
from forcefeel.simulation.inputs import Pulse, Release, Step
from tests.nonlinear_witness import Machine
from tests.parametrization import mostly_slow
from tests.side_by_side import GAINS, LB, TRAVEL, law_of, loader_of, schedule
from tests.simulation.test_simulation_effects import EFFECTS

EXPONENTIAL = 1e-10
"""Of a step's largest value: two exponentials of one stiff matrix, over a thousand steps. Measured: 4e-11."""

KEEP = ("column_angle_rad", "load_pressure_pa", "valve_current_a")


@pytest.mark.parametrize("feedback", [False, True])
def test_linear_run_matches_forced_response(feedback):
    loader = ff.elevator()
    law = ff.linear.state_feedback(loader, ff.design_gains(loader).gains) if feedback else None
    run = simulate(loader, Scenario(Pulse(96 * LB, 0.1, 0.3), 1.0), law)
    assert run.method == "exact"
    model = ff.compliant_model(loader, law)
    time = np.arange(1001) * 1e-3
    # forced_response draws straight lines between samples; the pulse is the sum of runs under constant force.
    on = control.forced_response(model[:, 0], time, np.full(1001, 96 * LB)).outputs
    for name in ("column_angle_rad", "piston_position_m", "load_cell_force_n"):
        row = on[model.output_labels.index(name)]
        expected = np.concatenate([np.zeros(100), row[:901]]) - np.concatenate([np.zeros(400), row[:601]])
        scale = np.abs(row).max()
        np.testing.assert_allclose(run.history[name].values, expected, rtol=0, atol=EXPONENTIAL * scale)


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
@pytest.mark.parametrize("force", [Step(96 * LB, 0.1), Release(0.1)], ids=["step", "release"])
def test_stepped_engine_agrees_with_the_exact_run(gains, force):
    machine = Machine(gains=gains)
    exact = simulate(loader_of(machine), Scenario(force, 1.0), law_of(machine))
    harmless = replace(machine, current_limit=1e4)
    for step in (1e-3, 2.5e-4):
        stepped = simulate(loader_of(harmless), Scenario(force, 1.0, step), law_of(machine))
        assert (exact.method, stepped.method) == ("exact", "stepped")
        error = np.abs(stepped.history.column_angle_rad.values - exact.history.column_angle_rad.values).max()
        assert error < 1e-5 * TRAVEL  # the engine's accuracy; measured: 9e-7


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
@pytest.mark.parametrize("period", [0.0, 1e-3], ids=["analog", "digital"])
@pytest.mark.parametrize(
    "name",
    mostly_slow([name for name, effect in EFFECTS.items() if effect.signals is None and name != "force curve"], 4),
)
def test_lane_without_effect_is_bit_identical_to_run_without_effect(name, period, gains):
    """Two runs side by side, one with the effect and one without, against each alone."""
    fields = EFFECTS[name].fields
    off = Machine(gains=gains, orifice=fields.get("orifice", False), period=period, current_limit=1e4)
    on = replace(off, **fields)
    values = np.array([loader_of(machine).si_values for machine in (off, on, off)])
    law = law_of(off)
    for force in (Step(96 * LB, 0.05), Release(0.08)):
        scenario = Scenario(force, 0.25)
        both = simulate_batch(loader_of(on), scenario, values, law, keep=KEEP, threads=1)
        for lane in (0, 1):
            alone = simulate_batch(loader_of(on), scenario, values[lane : lane + 1], law, keep=KEEP, threads=1)
            for output in KEEP:
                np.testing.assert_array_equal(both[output].values[lane], alone[output].values[0])


def test_row_set_to_off_value_changes_no_bit():
    machine = Machine(orifice=True)
    loader = loader_of(machine)
    given = loader.replace({"column.coulomb_friction": None, "linkage.backlash": "0 in", "feel.hysteresis": "0 lb"})
    scenario = Scenario(Step(96 * LB, 0.1), 0.5, shaker=schedule([(0.0, 1.0)]))  # a shaker without force is none
    one, other = (simulate(x, scenario).history for x in (loader, given))
    plain = simulate(loader, Scenario(Step(96 * LB, 0.1), 0.5)).history
    for output in one.data_vars:
        np.testing.assert_array_equal(one[output].values, other[output].values)
        np.testing.assert_array_equal(one[output].values, plain[output].values)
