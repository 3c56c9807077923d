"""The envelope against slow routes: single runs, closed forms, NumPy's poles, python-control's frequency response."""

import dataclasses
import typing

import control
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.envelope import passivity, releases
from forcefeel.envelope.cases import Kind, PilotArm
from forcefeel.envelope.deviations import CHANGES
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.plan import Plan, make_plan
from forcefeel.envelope.result import PASSES, UNSTABLE, Failure, failure_of
from forcefeel.errors import InputError
from forcefeel.laws.analog.recursion import NAMED_DESIGNS, DesignSettings
from forcefeel.laws.law import Law
from forcefeel.loader.arms import ARM_ROWS
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import INDEX
from forcefeel.qualification.batch_verdicts import NAMES
from forcefeel.simulation import Scenario
from forcefeel.simulation.inputs import Release
from tests.release_witness import features, ideal, least_margin

GRID = {"stiffness": "1..100 %:7:log", "frequency": "0.5..4 Hz:4:log", "damping": "0.1, 0.4, 0.8, 1.5"}
EDGE = 1e-6  # relative; of a frequency so near to a band's end it is not asked on which side it lies
ROUNDING = 1e-9  # of an admittance: a real part below that has no sure sign
WITNESSED = 30  # settings in random cases that the slow route judges
NEAR = (
    0.02  # share of its tolerance by which the two routes may differ: the stepped runs with an arm are good to 1e-5 rad
)


@pytest.fixture(scope="module")
def found():
    return ff.find_envelope(ff.elevator(), grid=GRID)


def _machine(found, name_of_law, case, setting):
    """The loader of a case at a setting, and the law that was designed for its nominal plant."""
    nominal = ff.elevator()
    feel = dict(zip(FEEL_SETTING, found.plan.settings.feel(nominal)[setting].tolist(), strict=True))
    nominal = nominal.replace(feel, si=True)
    law = {
        "original": lambda: None,
        "published": lambda: ff.design_gains(nominal).law(nominal),
        "converged": lambda: ff.design_gains(nominal, DesignSettings()).law(nominal),
    }[name_of_law]()
    changes = {case.parameter: nominal[case.parameter] * (1 + case.change)} if case.parameter else {}
    changes |= dict(zip(ARM_ROWS, case.arm.values, strict=True)) if case.arm else {}
    return nominal.replace(changes, si=True), law


@pytest.mark.slow
def test_random_settings_match_single_runs(found):
    rng = np.random.default_rng(1974)
    plan, seen = found.plan, {"passes": 0, "fails": 0, "arms": 0}
    for _ in range(WITNESSED):
        name_of_law = str(rng.choice(found.laws))
        place, setting = int(rng.integers(len(plan.cases))), int(rng.integers(plan.settings.count))
        case = plan.cases[place]
        outcome = found.outcomes[found.codes(name_of_law)[place, setting]]
        loader, law = _machine(found, name_of_law, case, setting)
        record = releases.Record.of(plan.settings.rows[setting, 1], plan.settings.damping[0])
        scenario = Scenario(Release(plan.release_rad), record.duration_s, 5e-4, 1e-3)
        run = ff.simulate(loader, scenario, law)
        if outcome == UNSTABLE:
            angle = run.history.column_angle_rad.values
            assert run.status == "diverged" or np.abs(angle[-200:]).max() > 0.01 * plan.release_rad
            continue
        arm = np.array(case.arm.values if case.arm else (0.0, 0.0, 0.0)) * ff.elevator()["column.grip_arm"] ** 2
        feel = plan.settings.feel(plan.loader)[setting] + arm
        time = run.history.time_s.values
        wanted = features(time, ideal(feel, plan.release_rad, time))
        margin = least_margin(features(time, run.history.column_angle_rad.values), wanted)
        if failure_of(outcome) is Failure.REST or abs(margin) < NEAR:
            continue
        assert (margin > 0) == (outcome == PASSES), (name_of_law, case.name, setting, outcome, margin)
        seen["passes" if margin > 0 else "fails"] += 1
        seen["arms"] += case.kind is Kind.ARM
    assert min(seen.values()) >= 3  # the draw has some of each


def test_stability_matches_numpy_poles(found):
    plan = found.plan
    feel = plan.settings.feel(plan.loader)
    for name_of_law in found.laws:
        laws = Law.of(NAMED_DESIGNS[name_of_law](plan.loader), plan.loader, feel)
        for place, case in enumerate(plan.cases):
            if case.kind is Kind.PLANT and case.parameter not in {
                "linkage.ratio",
                "valve.current_gain",
                "column.inertia",
            }:
                continue
            stable = found.stable(name_of_law)[place]
            for setting in range(0, plan.settings.count, 3):
                values = plan.loader.si_values.copy()
                values[[INDEX[key] for key in FEEL_SETTING]] = feel[setting]
                law = laws.single(plan.loader, setting).numbers.law  # with the nominal plant's geometry
                if case.parameter:
                    values[INDEX[case.parameter]] *= 1 + case.change
                a = ff._core.compliant(values, law or ff.laws.GainLaw.original(values))[0]
                if case.arm:
                    a = _with_arm(a, values, case.arm)
                poles = np.linalg.eigvals(a)
                if abs(poles.real.max()) > 1e-9 * np.abs(poles).max():  # rounding of the largest
                    assert stable[setting] == (poles.real.max() < 0)


def _with_arm(a, values, arm):
    """The arm as a force on the base: ``(J + m R_p^2) theta'' + d R_p^2 theta' + k R_p^2 theta = ...``."""
    grip, inertia = values[INDEX["column.grip_arm"]], values[INDEX["column.inertia"]]
    mass, damping, stiffness = np.array(arm.values) * grip**2
    left = np.eye(8)
    left[7, 7] = 1 + mass / inertia
    right = a.copy()
    right[7, 6] -= stiffness / inertia
    right[7, 7] -= damping / inertia
    return np.linalg.solve(left, right)


@pytest.mark.parametrize("name_of_law", NAMED_DESIGNS)
def test_passivity_matches_the_frequency_response(found, name_of_law):
    grip = found.passivity[name_of_law]
    loader = ff.elevator()
    law = Law.of(NAMED_DESIGNS[name_of_law](loader), loader, np.array([[loader[key] for key in FEEL_SETTING]]))
    model = ff.compliant_model(loader, law.numbers.gain_law(loader))[0, 0]
    grid = np.geomspace(0.1, 300.0, 2000)
    s = 2j * np.pi * grid
    admittance = loader["column.grip_arm"] * s * control.frequency_response(model, s.imag).frdata[0, 0]
    inside = np.zeros(len(grid), dtype=bool)
    for low, high in grip.bands_hz:
        inside |= (grid > low) & (grid < high)
    edges = [edge for band in grip.bands_hz for edge in band]
    away = np.all([abs(grid / edge - 1) > EDGE for edge in edges], axis=0) if edges else np.full(len(grid), True)
    np.testing.assert_array_equal(inside[away], (admittance.real < -ROUNDING * np.abs(admittance))[away])
    np.testing.assert_allclose(
        np.interp(1.0, grip.frequency_hz, np.abs(grip.impedance)),
        np.interp(1.0, grid, 1 / np.abs(admittance)),
        rtol=1e-3,  # both are interpolated between the lines of a grid; measured: 7e-5
    )


@pytest.mark.slow
def test_batched_passivity_matches_single_settings(found):
    plan = found.plan
    feel = plan.settings.feel(plan.loader)
    law = NAMED_DESIGNS["converged"](plan.loader)
    laws = Law.of(law, plan.loader, feel)
    frequency = np.geomspace(passivity.LOWEST_HZ, passivity.HIGHEST_HZ, 60)
    good = 0
    for setting, row in enumerate(feel):
        loader = plan.loader.replace(dict(zip(FEEL_SETTING, row.tolist(), strict=True)), si=True)
        model = ff.compliant_model(loader, laws.numbers.gain_law(plan.loader, setting))
        s = 2j * np.pi * frequency
        admittance = s * control.frequency_response(model[0, 0], s.imag).frdata[0, 0]
        good += model.poles().real.max() < 0 and np.all(admittance.real > -1e-6 * np.abs(admittance))
    assert abs(found.passivity["converged"].settings - good / len(feel)) <= 1 / len(feel)  # one at the edge


@pytest.mark.parametrize("damping", [0.1, 0.7, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.5])
def test_ideal_response_matches_the_closed_form(damping):
    w, time = 2 * np.pi * 2.0, np.arange(1500) * 1e-3
    feel = np.array([[1 / w**2, 2 * damping / w, 1.0]])
    critical = (1 + w * time) * np.exp(-w * time)
    closed = critical if abs(damping - 1) < 1e-6 else ideal(feel[0], 1.0, time)
    np.testing.assert_allclose(ideal_releases(feel, 1.0, 1e-3, 1500)[0], closed, atol=1e-8)  # 1e-9 off critical


@pytest.mark.slow
def test_results_do_not_depend_on_threads_or_chunks(found, monkeypatch):
    monkeypatch.setattr(releases, "_CHUNK_BYTES", 2**18)
    again = ff.find_envelope(ff.elevator(), grid=GRID, threads=1)
    assert again.data.identical(found.data)


def test_release_is_bit_identical_in_any_batch(found):
    plan = found.plan
    feel = plan.settings.feel(plan.loader)
    laws = Law.of(NAMED_DESIGNS["published"](plan.loader), plan.loader, feel)
    record = releases.Record(2e-3, 333)
    case = plan.cases[-1]
    stable, angles = releases.released(plan, (case,), feel, laws, record, 2)
    assert stable.any()
    assert not stable.all()
    assert np.isnan(angles[~stable]).all()
    np.testing.assert_allclose(angles[stable, 0], plan.release_rad, rtol=1e-9)  # rounding of the state at rest
    for which in (slice(3, 4), slice(5, 40), slice(11, 18)):
        alone = releases.released(plan, (case,), feel[which], laws.some(which), record, 1)
        np.testing.assert_array_equal(alone[0], stable[which])
        np.testing.assert_array_equal(alone[1], angles[which])


def test_shares_are_counts(found):
    for name in found.laws:
        shares, cases = found.shares(name), found.case_shares(name)
        outcome = found.data["outcome"].sel(law=name)
        assert shares.nominal_share == float((outcome.sel(case="nominal") == 0).mean()) == cases[0].passes
        assert shares.worst_case_share == float((outcome == 0).all("case").mean())
        assert shares.worst_case_share <= min(row.passes for row in cases)
        assert shares.stable_worst <= min(row.stable for row in cases)
        assert cases[0].lost == 0
        reasons = found.failure_shares(name)
        assert sum(reasons.values()) == pytest.approx(1 - shares.nominal_share)
        assert reasons[Failure.UNSTABLE] == pytest.approx(1 - shares.stable)
        np.testing.assert_array_equal(found.failures(name, worst=True) < 0, (outcome == 0).all("case"))


@pytest.mark.slow
def test_default_grid_matches_the_independent_calculation():
    """Issue 5's own linear reckoning: 60 % stable and 22 % within tolerance, 75 % and 18 %; its grid is not stated."""
    found = ff.find_envelope(ff.elevator(), ("original", "published"), changes={}, arms=())
    original, published = (found.shares(name) for name in found.laws)
    spacing = 0.04  # what another spacing of as many points does to a share
    assert (original.stable, original.nominal_share) == pytest.approx((0.60, 0.22), abs=spacing)
    assert (published.stable, published.nominal_share) == pytest.approx((0.75, 0.18), abs=spacing)


def test_every_outcome_has_a_reason():
    assert failure_of(PASSES) is None
    limits = {Failure.DRIVE, Failure.NOISE}  # not of the rule
    assert {failure_of(name) for name in (UNSTABLE, *NAMES)} == set(Failure) - limits
    assert failure_of("P0") is Failure.FIRST_CROSSING
    assert failure_of("A3") is Failure.OVERSHOOTS


def test_each_case_varies_one_parameter(found):
    cases = found.plan.cases
    assert [case.kind for case in cases] == [Kind.NOMINAL] + [Kind.PLANT] * 28 + [Kind.ARM] * 3
    assert {case.parameter for case in cases if case.parameter} == set(CHANGES) - {
        "column.coulomb_friction"
    }  # it has none
    valve = [case.change for case in cases if case.parameter == "valve.current_gain"]
    assert valve == pytest.approx([-0.3, 0.3])  # the file's shares, back from SI values
    assert not found.case("firm arm").verified


def test_grip_arm_does_not_change_hands_off_releases(found):
    codes = found.codes("published")
    names = [case.name for case in found.plan.cases]
    for name in ("column.grip_arm -1 %", "column.grip_arm +1 %"):
        np.testing.assert_array_equal(codes[names.index(name)], codes[0])


def test_loader_with_optional_rows_is_simulated():
    rows = {"valve.orifice": True, "column.stop_low": "-12 deg", "column.stop_high": "12 deg", "feel.breakout": "1 lb"}
    loader = ff.elevator().replace(rows | {"feel.breakout_travel": "0.5 deg"})
    grid = {"stiffness": "10, 60, 100 %", "frequency": "1, 3 Hz", "damping": "0.4, 1.2"}
    found = ff.find_envelope(
        loader, ("published",), grid, changes={"linkage.ratio": 0.2}, arms=(PilotArm("loose", 1.0, 10.0, 50.0, True),)
    )
    plan = found.plan
    assert not plan.linear
    assert plan.omitted == ("feel.breakout", "feel.breakout_travel")
    assert plan.release_rad == pytest.approx(np.radians(6.0))
    assert plan.throw.travel_rad == pytest.approx(np.radians(24.0))
    feel = plan.settings.feel(plan.loader)
    place, case = next((k, case) for k, case in enumerate(plan.cases) if case.name == "linkage.ratio -20 %")
    record = releases.Record.of(plan.settings.rows[0, 1], plan.settings.damping[0])
    which = np.flatnonzero(plan.settings.rows[:, 1] == plan.settings.frequency[0])
    laws = Law.of(NAMED_DESIGNS["published"](plan.loader), plan.loader, feel)
    stable, angles = releases.released(plan, (case,), feel[which], laws.some(which), record, 1)
    np.testing.assert_array_equal(stable, found.stable("published")[place, which])
    for k in np.flatnonzero(stable):
        nominal = plan.loader.replace(dict(zip(FEEL_SETTING, feel[which[k]].tolist(), strict=True)), si=True)
        law = ff.design_gains(nominal).law(nominal)
        machine = nominal.replace({"linkage.ratio": nominal["linkage.ratio"] * 0.8}, si=True)
        run = ff.simulate(
            machine, Scenario(Release(plan.release_rad), record.duration_s, record.step_s / 2, record.step_s), law
        )
        np.testing.assert_allclose(angles[k], run.history.column_angle_rad.values, atol=2e-5)  # the engine's accuracy


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"grid": {"stifness": "1..100 %:5"}}, "unknown axis"),
        ({"grid": {"stiffness": "1..100 %"}}, "from..to:count"),
        ({"grid": {"stiffness": "1..100 %:5:lin"}}, "from..to:count"),
        ({"grid": {"stiffness": "100..1 %:5"}}, "below the last"),
        ({"grid": {"stiffness": "1..100 lb:5"}}, "stiffness"),
        ({"grid": {"frequency": "0.5..40 Hz:5"}}, "expected values from"),
        ({"grid": {"frequency": "0.5..4:5"}}, "has no unit"),
        ({"grid": {"damping": "0..1:5:log"}}, "above 0 with log"),
        ({"grid": {"damping": [0.2]}}, "two or more rising"),
        ({"grid": {"damping": [0.2, float("nan")]}}, "rising"),
        ({"grid": {"damping": "0.1..1.5:1000", "frequency": "0.5..4 Hz:1000"}}, "at most"),
        ({"laws": ("best",)}, "original, published, converged"),
        ({"laws": ()}, "different ones"),
        ({"laws": ("original", "original")}, "different ones"),
        ({"laws": "published"}, "list of names"),
        ({"laws": {"mine": 3}}, "expected a law, its name"),
        ({"rule": "part60-z"}, "part60-a-2014"),
        ({"changes": {"feel.stiffness": 0.2}}, "feel and pilot are not part of the plant"),
        ({"changes": {"linkage.stifness": 0.2}}, "linkage.stiffness"),
        ({"changes": {"linkage.stiffness": 1.5}}, "below 1"),
        ({"arms": (PilotArm("bad", -1.0, 0.0, 0.0, True),)}, "0 or more"),
        ({"arms": (PilotArm("same", 1.0, 0.0, 0.0, True),) * 2}, "same name"),
        ({"angle_rad": 0.0}, "above 0"),
        ({"angle_rad": float("inf")}, "above 0"),
    ],
)
def test_invalid_input_is_named(arguments, message):
    with pytest.raises(InputError, match=message):
        make_plan(ff.elevator(), **arguments)


@pytest.mark.parametrize(
    "function",
    [ff.find_envelope, ff.envelope.make_plan, ff.find_frontier, ff.choice.score_laws],
    ids=lambda it: it.__name__,
)
def test_plan_options_are_typed_and_unknown_options_are_refused(function):
    """Each by its name and type, so that a slip is seen before anything runs; and refused where it runs."""
    (options,) = typing.get_args(typing.get_type_hints(function)["options"])
    of_plan = {field.name: field.type for field in dataclasses.fields(Plan) if field.init}
    asked = {name: kind for name, kind in of_plan.items() if name not in {"given", "laws", "settings"}}
    assert typing.get_type_hints(options) == {name: typing.get_type_hints(Plan)[name] for name in asked}
    with pytest.raises(TypeError, match="angle_rat"):
        function(ff.elevator(), angle_rat=0.1)
