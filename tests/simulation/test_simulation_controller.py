"""The digital controller against the witness: delays, converters, limits, noise, and its analog limit."""

from dataclasses import replace

import numpy as np
import pytest

from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Doublet, HandsOff, Release, Step
from tests.nonlinear_witness import Machine, Signals, Solver
from tests.parametrization import mostly_slow
from tests.side_by_side import DEG, GAINS, LB, TRAVEL, Case, at_rest, held, law_of, loader_of
from tests.simulation.test_simulation_accuracy import CLAIM, FULL

ROUNDING = 1e-11
"""Of 128 steps: a few products. Measured: 3e-14."""

FORCE = ([(0.05, 96.0)], Step(96 * LB, 0.05), 0.4)
FLOOR = 1.5e-5
"""The slaving, and what the feel computer's one step per period leaves."""


@pytest.mark.slow
@pytest.mark.parametrize(("share", "gains"), mostly_slow([(0.0, None), (0.3, GAINS), (1.0, None), (2.5, GAINS)]))
def test_delay_matches_witness(share, gains):
    case = Case(Machine(gains=gains, orifice=True, period=1e-3, delay=share * 1e-3), *FORCE)
    assert max(case.errors(case.witness(), 1e-3, 2.5e-4)) < FLOOR


@pytest.mark.parametrize("period", mostly_slow([1e-3, 5e-4, 2e-4]))
def test_period_matches_witness(period):
    case = Case(
        Machine(gains=GAINS, orifice=True, period=period, coulomb_friction=2.0, feel_coulomb_friction=1.0), *FORCE
    )
    assert max(case.errors(case.witness(), 1e-3)) < FLOOR


@pytest.mark.slow
def test_converters_and_limits_match_witness():
    machine = Machine(
        period=1e-3, orifice=True, input_range=10.0, input_bits=14, output_range=1.0, output_bits=12, current_limit=1.2
    )
    case = Case(machine, *FORCE)
    assert max(case.errors(case.witness(), 1e-3)) < FLOOR


def test_command_is_multiple_of_converter_step():
    machine = Machine(period=2e-3, orifice=True, output_range=0.5, output_bits=8)
    run = simulate(loader_of(machine), Scenario(FORCE[1], 0.4), "original")
    steps = run.history.valve_current_a.values / 1.56e-3 / (2 * 0.5 / 2**8)
    np.testing.assert_allclose(steps, np.round(steps), rtol=0, atol=ROUNDING)
    assert np.abs(steps).max() == pytest.approx(2**7, abs=ROUNDING)


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
def test_short_period_converges_to_analog_loop(gains):
    machine = Machine(gains=gains, orifice=True)
    scenario = Scenario(FORCE[1], 0.4)
    analog = simulate(loader_of(machine), scenario, law_of(machine)).history.column_angle_rad.values
    errors = []
    for period in (1e-3, 5e-4, 2.5e-4):
        run = simulate(loader_of(replace(machine, period=period)), scenario, law_of(machine))
        errors.append(np.abs(run.history.column_angle_rad.values - analog).max())
    assert 1.7 < errors[0] / errors[1] < 2.3
    assert 1.7 < errors[1] / errors[2] < 2.3


@pytest.mark.slow
@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
def test_antiwindup_matches_witness(gains):
    machine = Machine(gains=gains, period=1e-3, orifice=True, current_limit=0.3)
    case = Case(replace(machine, antiwindup=100.0), *FORCE[:2], 1.5)
    reference = case.witness()
    without = Case(machine, *FORCE[:2], 1.5).engine(1e-3).history.column_angle_rad.values
    assert np.abs(without - reference["theta"]).max() > 1e-3
    # First order in the period (5.5e-4, 2.8e-4, 1.4e-4 at 1, 0.5, 0.25 ms, original loop): the witness lets delta drift through the
    # period, the engine moves it at the sample.
    assert max(case.errors(reference, 1e-3)) < 1e-3


@pytest.mark.parametrize("gains", [None, GAINS], ids=["original", "feedback"])
def test_antiwindup_lets_column_return_with_pilot(gains):
    """Without it the programmed control is far ahead of the column when the force turns, and the column comes back late."""
    found = []
    for rate in (0.0, 300.0):
        machine = Machine(gains=gains, period=5e-4, orifice=True, current_limit=1.0, antiwindup=rate)
        run = simulate(loader_of(machine), Scenario(Doublet(96 * LB, 0.05, 0.3), 2.0), law_of(machine))
        found.append(np.abs(run.history.column_angle_rad.values[1000:]).max())
    assert found[1] < 0.8 * found[0]


def test_noise_has_its_deviation_and_depends_on_seed():
    """The load cell's noise seen in c_2 p of a law that does nothing else, through the amplifier to the current."""
    sigma, loader = (
        2.0,
        loader_of(Machine(period=1e-3, coulomb_friction=1e3)).replace({"load_cell.noise": 2.0}, si=True),
    )
    gain = 1e-9
    law = law_of(Machine(gains=(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)))
    law = type(law)([0.0, gain, 0.0, 0.0, 0.0, 0.0, 0.0], law.load_cell_arm, "rad")
    one, again, other = (
        simulate(loader, Scenario(HandsOff(), 5.0, seed=seed), law).history.valve_current_a.values for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(one, again)
    assert not np.any(one[1:] == other[1:])
    seen = one[1:] / loader["amplifier.admittance"] / gain * loader["actuator.area"]
    seen = seen - np.mean(seen)
    # 5000 samples: the spread is known to one part in a hundred (1 / sqrt(2 n)), four of them allowed.
    assert np.std(seen) == pytest.approx(sigma, rel=0.04)
    assert abs(np.corrcoef(seen[1:], seen[:-1])[0, 1]) < 4 / np.sqrt(len(seen))


def digital(gains, period, **changes):
    """Every nonlinearity, sampled sensors with lag and resolution, a delay that is no whole number of periods, converters."""
    machine = replace(FULL, gains=gains, period=period, delay=0.4 * period, output_range=10.0, output_bits=16)
    resolutions = {"load_cell_resolution": 0.02, "potentiometer_resolution": 1e-4, "column_sensor_resolution": 2e-5}
    if gains is None:  # the witness reads the column's sensor through a converter too, the engine does not
        resolutions |= {"input_range": 10.0, "input_bits": 16}
    return replace(machine, **resolutions | changes)


SIGNALS = Signals(
    trim=[(0.0, 0.0), (0.4, 1.5 * DEG)],
    dynamic_pressure=[(0.0, 100.0), (0.6, 250.0)],
    shaker=[(0.7, 1.0), (0.95, 0.0)],
)
"""One after another, while the column still moves: the witness starts anew at each sample, so that a second of it is dear."""


def digital_step(machine, duration=1.2):
    return Case(machine, [(0.1, 96.0)], Step(96 * LB, 0.1), duration, at_rest(machine, SIGNALS), SIGNALS)


def digital_release(machine, duration=1.2):
    """Let go after a while: before its first command arrives, the witness has the command of the first sample."""
    start = held(machine, 8 * DEG, SIGNALS)
    return Case(machine, [(0.0, start["force"]), (0.05, 0.0)], Release(8 * DEG, 0.05), duration, start, SIGNALS)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case_of", "gains"),
    mostly_slow([(digital_step, None), (digital_release, GAINS)]),
    ids=["step-original", "release-feedback"],
)
def test_all_effects_match_witness_with_digital_controller(case_of, gains):
    events = []
    case = case_of(digital(gains, 5e-4))
    reference = case.witness(Solver("LSODA", 1e-9, events))
    wanted = {"rest", "break-away", "feel rest", "slider dragged", "slider left", "sign of q_i", "velocity limit"}
    wanted |= {"soft stop", "hard stop", "relief"} if case_of is digital_step else {"contact"}
    assert wanted <= {name for _, name in events}
    errors = case.errors(reference, 1e-3, 5e-4, 1e-4)  # the first two in steps of what divides period and delay
    assert max(errors) < CLAIM  # found 2.5e-5, 1e-5, 7e-6, 3e-5


@pytest.mark.slow
def test_antiwindup_with_all_effects_is_first_order_in_period():
    """As alone, see above. Without the velocity limit: under it the witness's control does not slow down when it gives way.

    The column is back after 0.4 s, where the errors are largest.
    """
    errors = []
    for period in (1e-3, 5e-4):
        case = digital_release(digital(None, period, antiwindup=100.0, feel_velocity_limit=np.inf), 0.6)
        errors += case.errors(case.witness(Solver("LSODA", 1e-9)), 1e-3)
    assert errors[0] < 4e-4  # found 2.2e-4, 1.2e-4; and 5.6e-5 at 0.25 ms
    assert errors[0] / errors[1] > 1.5


@pytest.mark.parametrize("gains", mostly_slow([GAINS, None]), ids=["feedback", "original"])
def test_step_of_the_plant_under_a_digital_controller_is_of_second_order(gains):
    """What the samples see lags, and a sensor takes its input for a straight line over a step."""
    machine = Machine(
        gains=gains,
        orifice=True,
        period=2e-3,
        gravity_torque=100.0,
        arm_mass=2.0,
        feel_quadratic_damping=200.0,
        load_cell_bandwidth=2 * np.pi * 50,
        potentiometer_bandwidth=2 * np.pi * 500,
    )
    case = Case(machine, *FORCE)
    reference = case.witness()["theta"][::2]
    errors = [
        np.abs(case.engine(h, 2e-3).history.column_angle_rad.values - reference).max() for h in (2e-3, 1e-3, 5e-4)
    ]
    assert min(errors[0] / errors[1], errors[1] / errors[2]) > 3.0
    assert errors[0] / TRAVEL < CLAIM
