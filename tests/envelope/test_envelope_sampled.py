"""The envelope under a digital controller: stability and releases against the exact plant, and what the methods are known for."""

import numpy as np
import pytest
import scipy.linalg

import forcefeel as ff
from forcefeel._core import GainLaw
from forcefeel.envelope.deviations import deviations_of
from forcefeel.envelope.grip import Grips
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.releases import Record, released
from forcefeel.errors import InputError
from forcefeel.laws.law import Law, names_for
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.loader.arms import ARM_ROWS
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import HYDRAULIC
from forcefeel.qualification.plan import QualificationSetup, qualify_loader
from forcefeel.qualification.plan.result import QualificationStatus
from tests.parametrization import mostly_slow

GRID = {"stiffness": "3, 10, 40 %", "frequency": "0.7, 2, 3.5 Hz", "damping": "0.2, 0.9"}
NEAR = 4e-3
"""Of the deflection: the engine's steps of 0.5 ms and its slaved oil against the exact plant."""
EDGE = 2e-3
"""Of a pole's magnitude about one, within which either verdict may stand."""


@pytest.fixture(scope="module")
def loader() -> ff.Loader:
    return ff.elevator().replace({"controller.period": "0.5 ms", "controller.delay": "0.5 ms"})


def exact(loader, law, values, setting):
    """Loop over a period of a machine that is off (``values``) under the law of a setting; and its base's place, held and let go.

    ``[x (6); held command; delta, delta'; xi]``: eq. (17) with the arm, by SciPy's exponential.
    """
    period = loader["controller.period"]
    machine = loader.replace(values, si=True)
    mass, damper, spring = (machine[row] * machine["column.grip_arm"] ** 2 for row in ARM_ROWS)
    model = ff.compliant_model(machine.replace(dict.fromkeys(ARM_ROWS, 0.0), si=True), GainLaw.none(machine.si_values))
    kept = [k for k, name in enumerate(model.state_labels) if not name.startswith("feel_")]
    a, b = np.array(model.A)[np.ix_(kept, kept)], np.array(model.B)[kept]
    share = machine["column.inertia"] / (machine["column.inertia"] + mass)
    a[5], b[5] = share * a[5], share * b[5]
    a[5, 4] -= spring / (machine["column.inertia"] + mass)
    a[5, 5] -= damper / (machine["column.inertia"] + mass)
    plant = scipy.linalg.expm(np.block([[a, b], [np.zeros((2, 8))]]) * period)
    inertia, damping, stiffness = setting
    feel = scipy.linalg.expm(
        np.array([[0, 1, 0], [-stiffness / inertia, -damping / inertia, 1 / inertia], [0, 0, 0]]) * period
    )
    n = law.states
    loop, push = np.zeros((9 + n, 9 + n)), np.zeros(9 + n)
    push[:6] = plant[:6, 6]
    for k in range(9 + n):
        x = np.eye(9 + n)[k]
        y = [machine["actuator.area"] * x[1], x[0], x[4] / machine["column.base_arm"]]
        known = np.concatenate([x[9:], y, x[7:9]])
        e, torque = law.command[0] @ known, law.torque[0] @ known
        loop[:6, k] = plant[:6, :6] @ x[:6] + plant[:6, 7] * x[6]
        loop[6, k] = e
        loop[7:9, k] = (feel @ [x[7], x[8], torque])[:2]
        loop[9:, k] = law.transition[0] @ x[9:] + law.input[0] @ [*y, e]
    held = np.linalg.solve(np.eye(9 + n) - loop, push)
    row = np.zeros(9 + n)
    row[4] = 1 / machine["column.base_arm"]
    return loop, held, row


@pytest.mark.parametrize(
    "name",
    mostly_slow(
        [name for name, method in LAW_DESIGNS.items() if HYDRAULIC in method.drives and not method.needs_grip_sensor]
    ),
)
def test_verdicts_and_releases_match_the_exact_plant(loader: ff.Loader, name: str) -> None:
    plan = make_plan(loader, (name,), GRID)
    feel = plan.settings.feel(plan.loader)
    laws = Law.of(LAW_DESIGNS[name], plan.loader, feel)
    draw = np.random.default_rng(4)
    record = Record(1e-3, 1500)
    followed = 0
    for place in (0, *draw.choice(np.arange(1, len(plan.cases)), 4, replace=False)):
        case = plan.cases[place]
        values = {case.parameter: plan.loader[case.parameter] * (1 + case.change)} if case.parameter else {}
        values |= dict(zip(ARM_ROWS, case.arm.values, strict=True)) if case.arm else {}
        stable, angles = released(plan, (case,), feel, laws, record, 1)
        for k in draw.choice(len(feel), 5, replace=False):
            loop, state, row = exact(plan.loader, laws.single(plan.loader, k).sampled, values, feel[k])
            largest = np.abs(np.linalg.eigvals(loop)).max()
            if abs(largest - 1) > EDGE:
                assert stable[k] == (largest < 1), (case.name, k, largest)
            if not (stable[k] and largest < 1):
                continue
            state = state / (row @ state) * plan.release_rad
            path = []
            for _ in range(record.samples):
                path.append(row @ state)
                state = loop @ (loop @ state)
            np.testing.assert_allclose(angles[k], path, atol=NEAR * plan.release_rad, err_msg=f"{case.name} {k}")
            followed += 1
    assert followed > 8


def test_laws_trusting_the_potentiometer_fail_on_a_softer_link(loader: ff.Loader) -> None:
    changes = {"linkage.stiffness": 0.2}
    found = ff.find_envelope(loader, ("observer", "recovered", "robust"), GRID, changes=changes, arms=())
    lost = {name: found.shares(name).stable - found.shares(name).stable_worst for name in found.laws}
    assert lost["recovered"] > 0.9
    assert lost["observer"] > 0.1
    assert lost["robust"] == 0.0


def test_sampled_grip_converges_to_analog_as_period_vanishes() -> None:
    frequency = np.array([0.3, 2.0, 11.0])
    own = np.array([[ff.elevator()[key] for key in FEEL_SETTING]])
    analog = Grips.of(ff.elevator(), Law("original"), own).admittance(0, frequency)
    errors = []
    for period in ("0.4 ms", "0.1 ms"):
        grips = Grips.of(ff.elevator().replace({"controller.period": period}, si=True), Law("original"), own)
        errors.append(float(np.abs(grips.admittance(0, frequency) / analog - 1).max()))
    assert errors[0] < 0.1
    assert errors[1] < 0.3 * errors[0]  # of the first order in the period


def test_residues_match_the_admittance(loader: ff.Loader) -> None:
    feel = make_plan(loader, ("robust",), GRID).settings.feel(loader)[[2, 11]]
    grips = Grips.of(loader, Law.of(LAW_DESIGNS["robust"], loader, feel), feel)
    frequency = np.geomspace(0.1, 300, 20)
    poles, residues = grips.poles_and_residues()
    for k in range(len(feel)):
        summed = (residues[k, :, None] / (grips.points(frequency) - poles[k][:, None])).sum(axis=0) * grips.factor(
            frequency
        )
        np.testing.assert_allclose(
            summed, grips.admittance(k, frequency), rtol=1e-4
        )  # poles near z = 1 and 0 in one sum


def test_orifice_rows_replace_the_valve_gains() -> None:
    found = {key: one.size for key, one in deviations_of(ff.digital_elevator()).items()}
    assert (found["valve.rated_flow"], found["valve.supply_pressure"]) == pytest.approx((0.3, 0.2))
    assert "valve.current_gain" not in found
    assert deviations_of(ff.elevator())["valve.current_gain"].size == pytest.approx(0.3)


@pytest.mark.slow
def test_robust_law_qualifies_the_loader() -> None:
    loader = ff.digital_elevator()
    found = qualify_loader(loader, QualificationSetup(laws=("published", "robust")))
    assert [section.name for section in found.sections if section.status is QualificationStatus.QUALIFIES] == ["robust"]


def test_analog_loader_accepts_only_the_laws_of_the_report(loader: ff.Loader) -> None:
    assert names_for(ff.elevator()) == ("original", "published", "converged")
    assert set(names_for(loader)) == {*names_for(ff.elevator()), *LAW_DESIGNS} - {"torque-mode", "grip"}
    with pytest.raises(InputError, match=r"controller\.period: expected a sample period, got none"):
        Law.of("robust", ff.elevator())
    with pytest.raises(InputError, match="law: expected original, published"):
        Law.of("best", loader)


def test_page_states_that_every_setting_passes(tmp_path):
    grid = {"stiffness": "10, 100 %", "frequency": "1, 2 Hz", "damping": "0.3, 0.7"}
    few = ff.find_envelope(ff.digital_elevator(), ["robust"], grid, changes={}, arms=(), contacts=())
    text = ff.envelope.write_envelope(few, tmp_path, ff.UnitSystem.US).read_text(encoding="utf-8")
    assert "With the nominal plant every setting passes." in text
    assert "First failure</th>" not in text


def test_feel_with_the_largest_damping_ratio_settles() -> None:
    """It creeps back in nine periods, of which the rule needs the last five at rest."""
    grid = {"stiffness": "20, 100 %", "frequency": "1, 2 Hz", "damping": "2, 3"}
    envelope = ff.find_envelope(ff.digital_elevator(), ["robust"], grid, changes={}, arms=())
    assert envelope.shares("robust").nominal_share == 1
