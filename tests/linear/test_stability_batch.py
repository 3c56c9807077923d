"""Verdicts on many loops against NumPy's eigenvalues, and against polynomials of unlimited precision near the axis."""

import math
from fractions import Fraction
from itertools import zip_longest

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import forcefeel as ff
from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.parameters import INDEX, PLANT_PARAMETERS
from forcefeel.sweep.stability import damping_map, stability_batch
from tests import side_by_side
from tests.nonlinear_witness import Machine
from tests.side_by_side import GAINS, LB

LOADER = ff.elevator()
KEYS = (
    *(key for key in PLANT_PARAMETERS if key != "column.grip_arm"),  # of the force alone
    *("load_cell.gain", "potentiometer.gain", "feel.inertia", "feel.damping", "feel.stiffness"),
)
NUMPYS = 1e-9
"""Relative, and a hundredth of it beside zero: eigenvalues of two solvers, over five decades. Measured: 1e-11 and 6e-13."""
TRUSTED = 1e-10
"""Distance from the axis, as a share of the largest pole, from which double precision's eigenvalues settle the sign."""


def law_of(name):
    return None if name == "original" else side_by_side.law_of(Machine(gains=GAINS))


def matrix(values, law):
    return _core.compliant(values, law or _core.GainLaw.original(values))[0]


def row(varied, k):
    values = LOADER.si_values.copy()
    for key, column in varied.items():
        values[INDEX[key]] = column[k]
    return values


def spread(count, decades, keys=KEYS, seed=0):
    rng = np.random.default_rng(seed)
    return {key: LOADER[key] * 10 ** rng.uniform(-decades, decades, count) for key in keys}


@pytest.mark.parametrize("law", ["original", "feedback"])
@pytest.mark.parametrize("decades", [0.1, 0.5, 1.0])
def test_verdicts_match_eigenvalues(law, decades):
    varied = spread(1500, decades)
    found = stability_batch(LOADER, varied, law_of(law))
    poles = np.array([np.linalg.eigvals(matrix(row(varied, k), law_of(law))) for k in range(1500)])
    abscissa, size = poles.real.max(axis=1), np.abs(poles).max(axis=1)
    clear = np.abs(abscissa) > TRUSTED * size
    assert clear.sum() > 1400
    np.testing.assert_array_equal(found.stable.values[clear], abscissa[clear] < 0)
    assert found.proved.values.mean() > 0.999
    assert found.stable.values.any()
    assert not found.stable.values.all() or decades < 0.5


@pytest.mark.slow
@given(
    st.lists(st.sampled_from(KEYS), min_size=2, max_size=5, unique=True),
    st.lists(st.floats(-3, 3), min_size=5, max_size=5),
    st.sampled_from(["original", "feedback"]),
)
def test_verdicts_match_for_parameters_varied_over_decades(keys, decades, law):
    varied = {key: np.array([LOADER[key] * 10**share]) for key, share in zip(keys, decades, strict=False)}
    found = stability_batch(LOADER, varied, law_of(law), threads=1)
    assert bool(found.stable[0]) == hurwitz(matrix(row(varied, 0), law_of(law)))


def test_verdict_is_exact_at_stability_limit():
    """Between two neighbors in double precision one of which is stable: exact fractions know which."""
    for key, decades in (("load_cell.gain", 2), ("actuator.bulk_modulus", -4), ("column.inertia", 3)):
        low, high = sorted((LOADER[key], LOADER[key] * 10**decades))
        for _ in range(14):
            points = np.linspace(low, high, 33)
            stable = stability_batch(LOADER, {key: points}).stable.values
            edge = int(np.flatnonzero(stable[1:] != stable[:-1])[0])
            low, high = points[edge], points[edge + 1]
        assert high - low <= 2 * np.spacing(high)
        points = np.array([low - 3 * np.spacing(low), low, high, high + 3 * np.spacing(high)])
        found = stability_batch(LOADER, {key: points})
        exact = [hurwitz(matrix(row({key: points}, k), None)) for k in range(4)]
        assert len(set(exact)) == 2
        np.testing.assert_array_equal(found.stable.values, exact)
        assert found.proved.values.all()


def hurwitz(a):
    """Whether all eigenvalues are left of the axis, by exact fractions: Faddeev and Leverrier, then Routh."""
    n = len(a)
    a = [[Fraction(float(entry)) for entry in line] for line in a]
    coefficients, m = [Fraction(1)], [[Fraction(0)] * n for _ in range(n)]
    for k in range(1, n + 1):
        for i in range(n):
            m[i][i] += coefficients[-1]
        m = product(a, m)
        coefficients.append(-sum(m[i][i] for i in range(n)) / k)
    above, line = coefficients[0::2], coefficients[1::2]
    while line:
        if line[0] <= 0:
            return False
        ratio = above[0] / line[0]
        rest = [up - ratio * down for up, down in zip_longest(above[1:], line[1:], fillvalue=Fraction(0))]
        above, line = line, rest
    return True


def product(a, b):
    columns = list(zip(*b, strict=True))
    return [[sum(x * y for x, y in zip(line, column, strict=True)) for column in columns] for line in a]


def test_exact_fraction_check_of_known_polynomials():
    swing = np.kron(np.eye(3), [[0.0, 1.0], [-4.0, -1.0]])
    assert hurwitz(swing)
    swing[1, 1] = 0.0
    assert not hurwitz(swing)


@pytest.mark.parametrize("threads", [2, 3])
def test_verdicts_do_not_depend_on_threads_or_neighbors(threads):
    varied = spread(2003, 1.0, KEYS[:4])
    one = stability_batch(LOADER, varied, threads=1)
    other = stability_batch(LOADER, {key: values[::-1] for key, values in varied.items()}, threads=threads)
    for name in ("stable", "proved"):
        np.testing.assert_array_equal(one[name].values, other[name].values[::-1])


def test_gains_for_each_loop():
    law = law_of("feedback")
    gains = np.array([law.gains, np.array(law.gains) * -1.0])
    varied = {"feel.stiffness": np.full(2, LOADER["feel.stiffness"])}
    found = stability_batch(LOADER, varied, gains)
    for k in range(2):
        own = ff.linear.state_feedback(LOADER, gains[k])
        assert bool(found.stable[k]) == (np.linalg.eigvals(matrix(LOADER.si_values, own)).real.max() < 0)
    assert found.stable.values.tolist() == [True, False]


def test_result_states_loader_and_parameter_units():
    found = stability_batch(LOADER, {"feel.damping": [100.0, 200.0]})
    assert found["feel.damping"].attrs["units"] == "N m s/rad"
    assert found.attrs["loader"] == LOADER.name


@pytest.mark.parametrize(
    ("varied", "gains", "said"),
    [
        ({}, None, "at least one"),
        ({"feel.stifness": [1.0]}, None, "unknown parameter"),
        ({"column.coulomb_friction": [1.0]}, None, "no part of the linear model"),
        ({"feel.stiffness": [1.0, np.nan]}, None, "finite"),
        ({"feel.stiffness": []}, None, "one value for each loop"),
        ({"feel.stiffness": 3.0}, None, "one value for each loop"),
        ({"feel.stiffness": [1.0, 2.0], "feel.damping": [1.0]}, None, "one value for each loop"),
        ({"feel.stiffness": [1.0, 2.0]}, np.zeros((1, 7)), r"\(2, 7\)"),
    ],
)
def test_bad_input_is_named(varied, gains, said):
    with pytest.raises(InputError, match=said):
        stability_batch(LOADER, varied, gains)


@pytest.mark.parametrize("law", [None, "feedback"])
def test_damping_map_matches_numpy_poles(law):
    grids = {"feel.stiffness": tuple(np.geomspace(30, 3000, 7)), "feel.damping": tuple(np.linspace(1, 60, 5))}
    sweep = ff.Sweep(LOADER, ff.Scenario(ff.Step(96 * LB), 1.0), grids=grids, law=law and law_of(law))
    found = damping_map(sweep)
    assert found.dims == tuple(grids)
    for place in np.ndindex(7, 5):
        values = LOADER.si_values.copy()
        for key, k in zip(grids, place, strict=True):
            values[INDEX[key]] = grids[key][k]
        poles = np.linalg.eigvals(matrix(values, law and law_of(law)))
        assert math.isclose(
            found.values[place], np.min(-poles.real / np.abs(poles)), rel_tol=NUMPYS, abs_tol=NUMPYS / 100
        )


def test_damping_map_of_a_law_designed_for_each_setting():
    stiffness = tuple(np.geomspace(300, 3000, 4))
    sweep = ff.Sweep(
        LOADER,
        ff.Scenario(ff.Step(96 * LB), 1.0),
        grids={"feel.stiffness": stiffness},
        law=ff.laws.DesignSettings(),
    )
    found = damping_map(sweep)
    for k, value in enumerate(stiffness):
        values = row({"feel.stiffness": stiffness}, k)
        gains = sweep.law_of(values[np.newaxis]).numbers.gains[0]
        poles = np.linalg.eigvals(matrix(values, ff.linear.state_feedback(LOADER, gains)))
        assert math.isclose(found.values[k], np.min(-poles.real / np.abs(poles)), rel_tol=NUMPYS), value
