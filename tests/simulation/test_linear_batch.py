"""Linear runs of many loaders against python-control, SciPy's exponential, and the single run."""

import control
import numpy as np
import pytest
from scipy.linalg import expm, matrix_balance

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Chirp, Doublet, Pulse, Recorded, Release, Step
from forcefeel.simulation.linear import simulate_linear_batch
from forcefeel.simulation.outcome import outputs
from tests import side_by_side
from tests.linear.test_stability_batch import KEYS
from tests.nonlinear_witness import Machine
from tests.side_by_side import GAINS, LB

LOADER = ff.elevator()
LAW = side_by_side.law_of(Machine(gains=GAINS))
STEP = Scenario(Step(96 * LB, 0.1), 1.0)
EXACT = 1e-10
"""Share of the largest value that two ways to take 1,000 exact steps differ by."""


OF_CONTROL = 1e-8
"""The same against python-control, which does not balance the matrix before it takes the exponential."""


def draws(count, share=0.2, seed=0):
    rng = np.random.default_rng(seed)
    values = np.tile(LOADER.si_values, (count, 1))
    values[:, [INDEX[key] for key in KEYS]] *= rng.uniform(1 - share, 1 + share, (count, len(KEYS)))
    return values


def assert_close(found, expected, share=EXACT):
    np.testing.assert_allclose(found, expected, rtol=0, atol=share * (np.abs(expected).max() or 1.0))


@pytest.mark.parametrize("law", [None, LAW], ids=["original", "feedback"])
def test_runs_match_forced_response(law):
    values = draws(11)
    names = ("column_angle_rad", "piston_position_m", "load_cell_force_n", "valve_current_a")
    found = simulate_linear_batch(LOADER, STEP, values, law, keep=names)
    time = np.arange(1001) * 1e-3
    for run in range(11):
        model = ff.compliant_model(Loader("one", "here", values[run]), law)
        on = control.forced_response(model[:, 0], time[:901], np.full(901, 96 * LB)).outputs
        for name in names:
            expected = np.concatenate([np.zeros(100), on[model.output_labels.index(name)]])
            assert_close(found[name].values[run], expected, OF_CONTROL)


@pytest.mark.parametrize("law", [None, LAW], ids=["original", "feedback"])
@pytest.mark.parametrize(
    "force",
    [
        Pulse(50.0, 0.033, 0.4),
        Doublet(50.0, 0.1, 0.2),
        Chirp(100.0, 0.5, 20.0, 0.5),
        Release(0.1, 0.25),
        Recorded(np.array([0.0, 0.3, 0.5, 1.0]), np.array([40.0, 40.0, -30.0, 90.0])),
    ],
    ids=lambda force: type(force).__name__,
)
def test_batch_runs_equal_single_runs(force, law):
    values = draws(9, seed=1)
    for scenario in (Scenario(force, 1.0), Scenario(force, 1.0, step_s=5e-4, sample_s=2e-3)):
        keep = tuple(outputs("V" if law is None else "rad"))
        found = simulate_linear_batch(LOADER, scenario, values, law, keep=keep)
        for run in (0, 8):
            single = simulate(Loader("one", "here", values[run]), scenario, law)
            assert single.method == "exact"
            np.testing.assert_array_equal(found.time_s, single.history.time_s)
            for name in keep:
                assert found[name].attrs["units"] == single.history[name].attrs["units"]
                # A release starts from a state solved for: its smallest outputs are differences of larger ones.
                share = 100 * EXACT if isinstance(force, Release) else EXACT
                assert_close(found[name].values[run], single.history[name].values, share)


def test_step_matches_scipy_matrix_exponential():
    values = draws(3, seed=2)
    found = simulate_linear_batch(LOADER, STEP, values).column_angle_rad.values
    for run in range(3):
        model = ff.compliant_model(Loader("one", "here", values[run]))
        a, (scale, _) = matrix_balance(model.A, permute=False, separate=True)
        block = np.zeros((9, 9))
        block[:8, :8], block[:8, 8] = a, model.B[:, 0] / scale * 96 * LB
        for k in (101, 150, 600, 1000):
            expected = (model.C[0] * scale) @ expm(block * (k - 100) * 1e-3)[:8, 8]
            assert abs(found[run, k] - expected) < EXACT


@pytest.mark.parametrize("threads", [2, 3])
def test_bits_do_not_depend_on_threads_or_neighbors(threads):
    values = draws(21)
    for force in (Step(96 * LB, 0.1), Chirp(100.0, 0.5, 20.0, 0.5), Release(0.1)):
        scenario = Scenario(force, 0.5)
        one = simulate_linear_batch(LOADER, scenario, values, threads=1).column_angle_rad.values
        other = simulate_linear_batch(LOADER, scenario, values[::-1], threads=threads).column_angle_rad.values
        np.testing.assert_array_equal(one, other[::-1])
        alone = simulate_linear_batch(LOADER, scenario, values[[7]]).column_angle_rad.values
        np.testing.assert_array_equal(one[[7]], alone)


def test_gains_for_each_run_and_force_scaled():
    values = draws(5)
    values[:, INDEX["pilot.force"]] *= np.arange(1, 6)
    found = simulate_linear_batch(LOADER, STEP, values, np.tile(LAW.gains, (5, 1)))
    for run in range(5):
        loader = Loader("one", "here", values[run])
        single = simulate(
            loader, STEP, ff.linear.state_feedback(loader, np.array(LAW.gains))
        ).history.column_angle_rad.values
        assert_close(found.column_angle_rad.values[run], single * (run + 1))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"loader": LOADER.replace({"valve.orifice": True})}, "simulate_batch"),
        ({"values": draws(2)[:, :5]}, "a row of"),
        ({"values": draws(2) * np.nan}, "optional|linear model|finite"),
        ({"law": np.zeros((3, 7))}, r"\(2, 7\)"),
        ({"keep": ("angle",)}, "column_angle_rad"),
        ({"scenario": Scenario(Step(1.0, 0.1), 1000.0), "values": np.tile(LOADER.si_values, (600, 1))}, "GiB"),
    ],
)
def test_bad_input_is_named(change, said):
    given = {"loader": LOADER, "scenario": STEP, "values": draws(2), **change}
    with pytest.raises(InputError, match=said):
        simulate_linear_batch(**given)


def test_an_unstable_loop_diverges_at_its_time():
    values = np.tile(LOADER.si_values, (3, 1))
    values[1, [INDEX[key] for key in ("feel.inertia", "feel.damping", "feel.stiffness")]] *= 0.05
    scenario = Scenario(Step(96 * LB, 0.1), 3.0)
    found = simulate_linear_batch(LOADER, scenario, values, keep=("piston_position_m",))
    single = simulate(Loader("one", "here", values[1]), scenario)
    assert single.status == "diverged"
    np.testing.assert_array_equal(found.diverged_at_s, [np.inf, single.measures.diverged_at_s, np.inf])
    np.testing.assert_array_equal(np.isnan(found.piston_position_m[1]), found.time_s >= single.measures.diverged_at_s)
    assert not np.isnan(found.piston_position_m[::2]).any()
