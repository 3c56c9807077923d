"""State feedback with the load cell's loop in the plant: its Riccati equation, its loop against a witness, what it is for."""

import numpy as np
import pytest
import scipy.linalg

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.laws.sampled import load_cell_loop
from forcefeel.laws.sampled.load_cell_loop import design
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import FEEL_SETTING

PERIOD = 0.5e-3
WEIGHED = 0.05
"""Of a period: what the weight on the command leaves. Measured: 0.024."""
SOLVED = 1e-6
"""Of a pole: two solvers of one Riccati equation; two poles near zero are all but double, and known to the root of rounding."""


@pytest.fixture(scope="module")
def loader() -> ff.Loader:
    return ff.elevator().replace({"controller.period": "0.5 ms", "controller.delay": "0.5 ms"})


@pytest.fixture(scope="module")
def feel(loader: ff.Loader) -> np.ndarray:
    own = np.array([loader[key] for key in FEEL_SETTING])
    return own * np.array([[1.0, 1.0, 1.0], [0.05, 0.1, 0.2], [8.0, 3.0, 2.0]])


def witness(loader: ff.Loader, feel: np.ndarray, law: SampledLaw) -> np.ndarray:
    """The closed loop ``[x_p, p, x_b, x_b'; e_h; delta, delta']`` from the matrices of eq. (19), column by column.

    One period of the plant, of the computer and of the law, each by itself, the base's velocity taken as measured.
    """
    plant = ff.linear.design_plant(loader)
    kept = [0, 1, 4, 5]
    a, b = np.asarray(plant.A)[np.ix_(kept, kept)], np.asarray(plant.B)[kept]
    whole = scipy.linalg.expm(np.block([[a, b], [np.zeros((1, 5))]]) * PERIOD)
    inertia, damping, stiffness = feel
    w = scipy.linalg.expm(
        np.array([[0, 1, 0], [-stiffness / inertia, -damping / inertia, 1 / inertia], [0, 0, 0]]) * PERIOD
    )
    area, arm = loader["actuator.area"], loader["column.base_arm"]
    c, t = law.command[0], law.torque[0]
    rate = -c[0] * PERIOD / arm  # gain on x_b': the law has it as a difference of angles
    of_angle = c[4] + c[0]
    found = np.zeros((7, 7))
    for k in range(7):
        x = np.eye(7)[k]
        force, angle = area * x[1], x[2] / arm
        e = c[1] * x[4] + c[2] * force + c[3] * x[0] + of_angle * angle + rate * x[3] + c[5] * x[5] + c[6] * x[6]
        torque = t[2] * force + t[5] * x[5] + t[6] * x[6]
        found[:4, k] = (whole @ np.append(x[:4], x[4]))[:4]
        found[4, k] = e
        found[5:, k] = (w @ np.array([x[5], x[6], torque]))[:2]
    return found


def test_closed_loop_poles_match_the_optimal_feedback(loader: ff.Loader, feel: np.ndarray) -> None:
    """The stable eigenvalues of the symplectic pencil, which knows no gains, are the closed loop's poles."""
    laws = design(loader, feel)
    loop = load_cell_loop._Loop(loader, feel)
    q, r = np.zeros((7, 7)), 0.1 / 100 * loop.scale.command_v**2
    q[np.ix_([2, 5], [2, 5])] = [[1, -1], [-1, 1]]
    for k, setting in enumerate(feel):
        a, b = loop.transition[k], loop.input[:, None]
        left = np.block([[a, np.zeros((7, 7))], [-q, np.eye(7)]])
        right = np.block([[np.eye(7), b @ b.T / r], [np.zeros((7, 7)), a.T]])
        values = scipy.linalg.eigvals(left, right)
        best = values[np.abs(values) < 1]
        assert len(best) == 7
        for pole in np.linalg.eigvals(witness(loader, setting, laws.some(k))):
            assert np.abs(best - pole).min() < SOLVED


def test_computer_feel_excludes_the_column_inertia(loader: ff.Loader, feel: np.ndarray) -> None:
    """Under the torque that it hears, ``(I - J) delta'' + B delta' + G delta = -alpha R_b F_c``."""
    torque = design(loader, feel).torque
    arm, own = loader["linkage.ratio"] * loader["column.base_arm"], loader["column.inertia"]
    for (inertia, damping, stiffness), (_, _, per_force, per_piston, per_angle, per_delta, per_rate) in zip(
        feel, torque, strict=True
    ):
        force, delta, rate = 37.0, 0.11, -0.4
        heard = per_force * force + per_delta * delta + per_rate * rate
        acceleration = (heard - damping * rate - stiffness * delta) / inertia
        residual = (inertia - own) * acceleration + damping * rate + stiffness * delta + arm * force
        assert abs(residual) < 1e-10 * arm * force  # rounding
        assert per_piston == per_angle == 0.0


def test_release_oscillates_at_the_programmed_frequency(loader: ff.Loader) -> None:
    """What the report's laws miss by 20 % for the column's own inertia."""
    own = np.array([[loader[key] for key in FEEL_SETTING]])
    run = ff.simulate(loader, ff.Scenario(ff.Release(0.1), 3.0), design(loader, own))
    programmed = (
        2 * np.pi * np.sqrt(own[0, 0] / own[0, 2]) / np.sqrt(1 - (own[0, 1] / 2) ** 2 / (own[0, 0] * own[0, 2]))
    )
    assert run.measures.period_s == pytest.approx(programmed, rel=WEIGHED)
    report = ff.simulate(loader, ff.Scenario(ff.Release(0.1), 3.0), ff.design_gains(loader).law(loader))
    assert report.measures.period_s > 1.15 * programmed


def test_programmed_inertia_of_the_column_is_refused(loader: ff.Loader, feel: np.ndarray) -> None:
    same = feel.copy()
    same[1, 0] = loader["column.inertia"]
    with pytest.raises(InputError, match="row 1 programs the column's own inertia"):
        design(loader, same)


def test_analog_loader_is_refused(feel: np.ndarray) -> None:
    with pytest.raises(InputError, match=r"controller\.period: expected a sample period"):
        design(ff.elevator(), feel)
