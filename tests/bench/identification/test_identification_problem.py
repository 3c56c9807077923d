"""The least-squares problem and its standard errors, on models whose answer is known without it."""

from dataclasses import dataclass, field

import numpy as np
import pytest
from scipy.stats import t as student

import forcefeel as ff
from forcefeel.bench.identification import search
from forcefeel.bench.identification.confidence import Confidence, confidence_of, half_widths, weak_directions
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.inseparable import inseparable_sets
from forcefeel.bench.identification.observations import Compared
from forcefeel.bench.identification.problem import DivergesError, Problem, _check_slopes
from forcefeel.bench.identification.unknowns import parameter_keys, starts, unknowns_of
from forcefeel.errors import InputError

SUMMED = 1e-12
"""Relative: sums over some hundred points and inverses of two equations; of the search's end only the square. Measured: 4e-15."""
FOUR_OF_A_THOUSAND = 4 / 2000**0.5
"""Relative: a thousand points tell a noise to 1 / sqrt(2000); four of them. Measured: 0.017."""
ROUNDING = 1e-7
"""Relative; what the search leaves, whose own precision is 1e-10 of the cost."""


@dataclass(frozen=True, eq=False)
class Straight:
    """``y = X theta`` with as many kinds of points as there are slices; ``theta`` in shares of the nominal values."""

    matrix: np.ndarray
    measured: np.ndarray
    scale: np.ndarray
    pieces: np.ndarray = None
    groups: tuple[slice, ...] = ()
    own: np.ndarray = field(default_factory=lambda: np.empty(0))
    data: object = None

    def __post_init__(self):
        object.__setattr__(self, "groups", self.groups or (slice(0, len(self.measured)),))

    @property
    def clusters(self):
        return np.arange(len(self.measured)) if self.pieces is None else self.pieces

    def residual(self, values, own):
        return self.compare(values, own).residual

    def compare(self, values, own):
        theta = np.concatenate([values / self.scale, own])
        return Compared(self.measured - self.matrix @ theta, -self.matrix / np.append(self.scale, np.ones(len(own))))


def unknowns(loader=None, keys="k,c"):
    return unknowns_of(
        loader or ff.elevator().with_tolerances(dict.fromkeys(ff.elevator().tolerances)), parameter_keys(keys)
    )


def scale_of(found):
    return np.array([it.nominal for it in found])


def straight(points=400, noise=0.05, seed=1, truth=(1.1, 0.8)):
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(points, 2))
    return matrix, matrix @ truth + noise * random.normal(size=points)


def test_fit_matches_linear_least_squares():
    matrix, measured = straight()
    asked = unknowns()
    problem = Problem(asked, [Straight(matrix, measured, scale_of(asked))], "linear")
    place = problem.search(problem.start(scale_of(asked)))
    expected, left, *_ = np.linalg.lstsq(matrix, measured, rcond=None)
    np.testing.assert_allclose(place.x, expected, rtol=ROUNDING)
    assert place.noise[0] == pytest.approx(np.sqrt(left[0] / len(measured)), rel=SUMMED)


def test_independent_errors_give_the_white_sandwich():
    matrix, measured = straight()
    asked = unknowns()
    problem = Problem(asked, [Straight(matrix, measured, scale_of(asked))], "linear")
    place = problem.search(problem.start(scale_of(asked)))
    residual = measured - matrix @ place.x
    bread = np.linalg.inv(matrix.T @ matrix)
    meat = (matrix * residual[:, None]).T @ (matrix * residual[:, None])
    points = len(measured)
    found = confidence_of(problem, place)
    covariance = found.covariance * np.outer(found.sizes, found.sizes)
    classical = np.diag(bread) * (residual @ residual) / points
    white = points / (points - 1) * bread @ meat @ bread
    raised = np.maximum(1, np.sqrt(classical / np.diag(white)))  # never surer than independent errors of one size are
    np.testing.assert_allclose(covariance, white * np.outer(raised, raised), rtol=SUMMED)
    assert found.quantile == pytest.approx(student.ppf(0.975, points - 2))
    # Errors of one size: White's are then close to the classical ones, to some 1 / sqrt(points).
    np.testing.assert_allclose(np.diag(covariance), classical, rtol=1 / np.sqrt(points))


@pytest.mark.slow
def test_correlated_errors_widen_the_intervals():
    """The interval holds the truth in 95 of 100 cases with errors that are the same within each piece, as no classical one does."""
    asked = unknowns()
    pieces, each, repetitions = 40, 25, 300
    inside = np.zeros(2, dtype=int)
    random = np.random.default_rng(7)
    truth = np.array([1.1, 0.8])
    for _ in range(repetitions):
        piece = np.repeat(np.arange(pieces), each)
        matrix = random.normal(size=(pieces, 2))[piece] + 0.2 * random.normal(size=(pieces * each, 2))
        measured = matrix @ truth + 0.1 * random.normal(size=pieces)[piece] + 0.02 * random.normal(size=pieces * each)
        problem = Problem(asked, [Straight(matrix, measured, scale_of(asked), piece)], "linear")
        place = problem.search(problem.start(scale_of(asked)))
        found = confidence_of(problem, place)
        inside += np.abs(place.x - truth) < found.quantile * found.deviation * found.sizes
        assert np.all(found.inflation > 2)  # what independent errors would say is several times too sure
    # 95 % of 300 is 285, its binomial deviation 3.8; pieces are few, so the sandwich is known to be a little narrow.
    assert np.all(np.abs(inside - 0.95 * repetitions) < 4 * 3.8)


def test_parameter_seen_by_a_single_piece_keeps_its_noise_error():
    """A parameter that acts in one piece only: there the fit makes its score vanish, so pieces alone would call it certain."""
    random = np.random.default_rng(8)
    piece = np.repeat(np.arange(40), 25)
    matrix = np.column_stack([random.normal(size=1000), np.where(piece == 3, random.normal(size=1000), 0.0)])
    measured = matrix @ [1.1, 0.8] + 0.05 * random.normal(size=1000)
    asked = unknowns()
    problem = Problem(asked, [Straight(matrix, measured, scale_of(asked), piece)], "linear")
    place = problem.search(problem.start(scale_of(asked)))
    found = confidence_of(problem, place)
    classical = np.sqrt(np.diag(np.linalg.inv(matrix.T @ matrix))) * place.noise[0]
    assert found.deviation[1] * found.sizes[1] == pytest.approx(classical[1], rel=SUMMED)
    assert found.inflation[1] == 1.0


def test_outliers_hardly_change_a_robust_fit():
    matrix, measured = straight(noise=0.01)
    measured[::20] += 3.0
    asked = unknowns()

    def error(loss):
        problem = Problem(asked, [Straight(matrix, measured, scale_of(asked))], loss)
        return np.abs(problem.search(problem.start(scale_of(asked))).x - [1.1, 0.8]).max()

    assert error("linear") > 0.02
    for loss in ("huber", "soft_l1", "cauchy"):
        assert error(loss) < 0.005, loss


def test_noise_of_each_kind_is_estimated_and_weighted():
    """Two kinds of points, one ten times noisier: generalised least squares with the noise that was put in."""
    random = np.random.default_rng(3)
    matrix = random.normal(size=(2000, 2))
    noise = np.repeat([0.01, 0.1], 1000)
    measured = matrix @ [1.1, 0.8] + noise * random.normal(size=2000)
    asked = unknowns()
    it = Straight(matrix, measured, scale_of(asked), groups=(slice(0, 1000), slice(1000, 2000)))
    problem = Problem(asked, [it], "linear")
    place = problem.search(problem.start(scale_of(asked)))
    np.testing.assert_allclose(place.noise, [0.01, 0.1], rtol=FOUR_OF_A_THOUSAND)
    weighted = matrix / noise[:, None]
    expected = np.linalg.lstsq(weighted, measured / noise, rcond=None)[0]
    # The noise is known to 1 / sqrt(2000) here, what it moves the estimate by is of second order.
    np.testing.assert_allclose(place.x, expected, atol=0.1 * 0.01 / np.sqrt(1000))


def test_normal_tolerance_is_a_prior_and_others_are_bounds():
    loader = ff.elevator().with_tolerances(
        {"linkage.stiffness": {"normal": "5 %", "low": "-20 %", "high": "20 %"}, "linkage.damping": "10 %"}
    )
    asked = unknowns(loader)
    assert asked[0].prior == pytest.approx((loader["linkage.stiffness"], 0.05 * loader["linkage.stiffness"]))
    assert asked[1].prior is None
    matrix, measured = straight(noise=0.05)
    problem = Problem(asked, [Straight(matrix, measured, scale_of(asked))], "linear")
    place = problem.search(problem.start(scale_of(asked)))
    assert place.x[1] == pytest.approx(0.9)  # the truth, 0.8, is out of bounds
    assert place.at_bound.tolist() == [False, True]
    # With c held at 0.9 k is the mean of data and prior, weighted with their information.
    sigma = place.noise[0]
    data, told = matrix[:, 0] @ matrix[:, 0] / sigma**2, 1 / 0.05**2
    expected = (matrix[:, 0] @ (measured - 0.9 * matrix[:, 1]) / sigma**2 + told * 1.0) / (data + told)
    assert place.x[0] == pytest.approx(expected, rel=ROUNDING)
    without = Problem(asked, problem.observations, "linear", priors=False)
    assert without.prior_rows(place.x)[0].size == 0


def test_nuisance_parameters_are_estimated_and_removed():
    random = np.random.default_rng(5)
    matrix = random.normal(size=(300, 3))
    measured = matrix @ [1.1, 0.8, 4.0] + 0.01 * random.normal(size=300)
    asked = unknowns()
    problem = Problem(asked, [Straight(matrix, measured, scale_of(asked), own=np.zeros(1))], "linear")
    place = problem.search(problem.start(scale_of(asked)))
    np.testing.assert_allclose(place.x, np.linalg.lstsq(matrix, measured, rcond=None)[0], rtol=ROUNDING)
    found = confidence_of(problem, place)
    whole = np.linalg.inv(matrix.T @ matrix) * place.noise[0] ** 2
    shares = found.sizes / found.inflation
    np.testing.assert_allclose(np.linalg.inv(found.information) * np.outer(shares, shares), whole[:2, :2], rtol=SUMMED)


def sure(information, clear=(True, True), estimates=(1.0, 1.0)):
    """Confidence of which only the information counts."""
    return Confidence(np.eye(2), np.ones(2), np.array(estimates), 1.96, information, np.ones(2), np.array(clear))


def test_pair_observable_only_as_a_product_is_named():
    """Slopes of (1, 1) in shares: only the product stays, so each alone is not determined."""
    information = np.array([[1.0, 1.0], [1.0, 1.0]]) * 1e6
    assert np.isinf(half_widths(information)).all()
    (found,) = inseparable_sets(unknowns(), sure(information))
    assert found.sentence == "The data cannot tell k from c: only their product k c is determined."
    assert set(found.keys) == {"linkage.stiffness", "linkage.damping"}
    # Shares are of the file's values where those are larger; a product is one all the same.
    half = np.outer([2.0, 1.0], [2.0, 1.0]) * 1e6
    (smaller,) = inseparable_sets(unknowns(), sure(half, estimates=(0.5, 1.0)))
    assert "only their product" in smaller.sentence
    (ratio,) = inseparable_sets(unknowns(), sure(np.array([[1.0, -1.0], [-1.0, 1.0]]) * 1e6))
    assert "only their ratio" in ratio.sentence


def test_parameter_without_effect_is_named_alone():
    (found,) = inseparable_sets(unknowns(), sure(np.diag([1e6, 0.0])))
    assert found.keys == ("linkage.damping",)
    assert "do not see c" in found.sentence
    widths = half_widths(np.diag([1e6, 0.0]))
    assert widths[0] == pytest.approx(1e-3)
    assert np.isinf(widths[1])


def test_two_weak_directions_leave_both_parameters_undetermined():
    turned = np.array([[1.0, 0.35], [-0.35, 1.0]])
    (found,) = inseparable_sets(unknowns(), sure(turned.T @ np.diag([1e-3, 1e-4]) @ turned))
    assert found.sentence == "The data determine neither k nor c."


def test_cost_without_minimum_is_not_reported_as_unobservable():
    (found,) = inseparable_sets(unknowns(), sure(np.diag([1e6, 0.0]), (True, False)))
    assert "no clear minimum in c" in found.sentence


def test_weak_direction_limit_is_applied():
    information = np.diag([1 / 0.1**2, 1 / 0.3**2])
    assert len(weak_directions(information, 0.31)) == 0
    assert len(weak_directions(information, 0.29)) == 1


def test_symbols_and_rows_name_the_parameters():
    assert parameter_keys("k, c,J ,C_i") == (
        "linkage.stiffness",
        "linkage.damping",
        "column.inertia",
        "valve.current_gain",
    )
    assert parameter_keys(["valve.current_gain"]) == ("valve.current_gain",)
    for given, said in (
        ("", "got none"),
        ("k,linkage.stiffness", "stands twice"),
        ("K", "did you mean k (linkage.stiffness)?"),
        ("stiffnes", "did you mean"),
    ):
        with pytest.raises(InputError, match=said.replace("(", r"\(").replace(")", r"\)").replace("?", r"\?")):
            parameter_keys(given)


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("valve.orifice", "is a switch"),
        ("controller.period", "is a setting of the controller"),
        ("F_c", "to begin from"),
    ],
)
def test_parameter_that_cannot_be_fitted_raises_input_error(key, said):
    with pytest.raises(InputError, match=said):
        unknowns_of(ff.elevator(), parameter_keys(key))


def test_starts_begin_at_the_file_and_stay_within_tolerance():
    asked = unknowns_of(ff.elevator(), parameter_keys("k,c,J"))
    found = starts(asked, 9)
    assert found.shape == (9, 3)
    np.testing.assert_array_equal(found[0], [it.nominal for it in asked])
    for j in (0, 2):  # the elevator's 20 %; c has none
        assert np.all((found[:, j] >= asked[j].low) & (found[:, j] <= asked[j].high))
        assert np.ptp(found[:, j]) > 0.3 * asked[j].nominal
    assert np.all((found[:, 1] >= asked[1].nominal / 2) & (found[:, 1] <= 2 * asked[1].nominal))
    np.testing.assert_array_equal(found, starts(asked, 9))


def test_search_that_comes_to_an_unstable_loop_is_refused_by_name(monkeypatch):
    """Limits bound the motion of an unstable loop, and its derivatives grow beyond all numbers."""
    for slopes in ([1.0, -1e13], [np.nan, 0.0]):
        with pytest.raises(ff.InputError, match="the search came to an unstable loop"):
            _check_slopes(np.array(slopes))
    _check_slopes(np.array([1e9, -1e9]))

    def settled(problem, x, *, coarse):
        raise DivergesError("unstable")

    monkeypatch.setattr(search, "_settled", settled)
    with pytest.raises(ff.InputError, match="diverges from the file's values and from every other start on"):
        identify(ff.elevator(), [ff.read_bench_data("examples/bench/sweep.csv")], "G", starts=1)
