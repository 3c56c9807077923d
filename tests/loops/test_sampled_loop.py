"""Loops under a digital controller: against the exact plant, against the engine's runs, and their margins by trying them out."""

import numpy as np
import pytest
import scipy.linalg

import forcefeel as ff
from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loops.command_loop import CommandLoop
from forcefeel.loops.margins import loop_margins
from forcefeel.loops.sampled_loop import sampled_loops

LAWS = ("load-cell", "observer", "recovered", "h-infinity", "robust")
LIGHT = {"feel.inertia": "0.5 lb in s^2/rad", "feel.damping": "2 lb in s/rad", "feel.stiffness": "300 lb in/rad"}
FINE = 5e-3
"""Of a pole: what the slaved oil and steps of 0.1 ms leave of the exact plant."""


@pytest.fixture(scope="module")
def loader() -> ff.Loader:
    return ff.elevator().replace({"controller.period": "0.5 ms", "controller.delay": "0.5 ms"})


def own(loader: ff.Loader, name: str) -> SampledLaw:
    law = Law.of(name, loader).sampled
    assert law is not None
    return law


def exact_loop(loader: ff.Loader, law: SampledLaw, gain: float = 1.0) -> np.ndarray:
    """``[x (6); held command; delta, delta'; xi]`` over a period with one sample of delay.

    Eq. (17) by SciPy's exponential, the law and the computer multiplied out; ``gain`` is between controller and amplifier.
    """
    period = loader["controller.period"]
    model = ff.compliant_model(loader, GainLaw.none(loader.si_values))
    kept = [k for k, name in enumerate(model.state_labels) if not name.startswith("feel_")]
    a, b = np.asarray(model.A)[np.ix_(kept, kept)], np.asarray(model.B)[kept, 1:]
    plant = scipy.linalg.expm(np.block([[a, b], [np.zeros((1, 7))]]) * period)
    inertia, damping, stiffness = (loader[key] for key in FEEL_SETTING)
    feel = scipy.linalg.expm(
        np.array([[0, 1, 0], [-stiffness / inertia, -damping / inertia, 1 / inertia], [0, 0, 0]]) * period
    )
    n = law.states
    found = np.zeros((9 + n, 9 + n))
    for k in range(9 + n):
        x = np.eye(9 + n)[k]
        y = [loader["actuator.area"] * x[1], x[0], x[4] / loader["column.base_arm"]]
        known = np.concatenate([x[9:], y, x[7:9]])
        e, torque = law.command[0] @ known, law.torque[0] @ known
        found[:6, k] = (plant @ x[:7])[:6]
        found[6, k] = gain * e
        found[7:9, k] = (feel @ [x[7], x[8], torque])[:2]
        found[9:, k] = law.transition[0] @ x[9:] + law.input[0] @ [*y, e]
    return found


@pytest.mark.parametrize("name", LAWS)
def test_poles_match_exact_plant(loader: ff.Loader, name: str) -> None:
    law = own(loader, name)
    poles = sampled_loops(loader, law).poles[0]
    for pole in np.linalg.eigvals(exact_loop(loader, law)):
        if abs(pole) > 0.3:  # slower than some 0.4 ms: the oil's own pole is slaved
            assert np.abs(poles - pole).min() < FINE, pole


@pytest.mark.parametrize("name", LAWS)
def test_closed_loop_becomes_unstable_at_margins(loader: ff.Loader, name: str) -> None:
    """The gain between controller and amplifier is turned until a pole of the witness leaves the circle."""
    law = own(loader, name)
    margins = loop_margins(CommandLoop.sampled(sampled_loops(loader, law)))

    def largest(gain: float) -> float:
        return float(np.abs(np.linalg.eigvals(exact_loop(loader, law, gain))).max())

    for edge in (margins.gain_up, margins.gain_down):
        if 0 < edge < np.inf:
            inside, outside = edge**0.97, edge**1.03
            assert largest(inside) < 1 < largest(outside)


def test_delay_beyond_margin_is_unstable(loader: ff.Loader) -> None:
    """Whole samples of delay are put between: stable with fewer than the margin, unstable with more."""
    law = own(loader, "robust")
    loop = exact_loop(loader, law)
    period, margin = loader["controller.period"], loop_margins(CommandLoop.sampled(sampled_loops(loader, law))).delay_s
    for samples in (int(margin / period), int(margin / period) + 1):
        n = len(loop)
        longer = np.zeros((n + samples, n + samples))
        longer[:n, :n] = loop
        if samples:
            longer[n, :n], longer[6, :n] = loop[6], 0.0
            for k in range(1, samples):
                longer[n + k, n + k - 1] = 1.0
            longer[6, n + samples - 1] = 1.0
        stable = np.abs(np.linalg.eigvals(longer)).max() < 1
        assert stable == (samples * period < margin)


@pytest.mark.parametrize("name", ["original", "published", *LAWS])
def test_period_map_matches_engine(loader: ff.Loader, name: str) -> None:
    """A push that stays: samples of the engine's run against powers of the map, whose steps are five times as short."""
    law = Law.of(name, loader)
    loops = sampled_loops(loader, law)
    force = 10.0
    state, angles = np.zeros(loops.matrix.shape[1]), [0.0]
    for _ in range(400):
        state = loops.matrix[0] @ state + loops.by_force[0] * force
        angles.append(state[loops.base] / loader["column.base_arm"])
    run = ff.simulate(loader, ff.Scenario(ff.Step(force, 0.0), 0.2, step_s=1e-4, sample_s=5e-4), law)
    found = run.history["column_angle_rad"].values
    np.testing.assert_allclose(
        found, angles, atol=2e-3 * np.abs(found).max()
    )  # the step's jump falls between the samples


def test_original_loop_converges_to_analog_loop() -> None:
    analog = np.linalg.eigvals(ff.compliant_model(ff.elevator()).A)
    slow = analog[np.abs(analog) < 100]
    errors = []
    for period in (0.4e-3, 0.1e-3):
        loader = ff.elevator().replace({"controller.period": period}, si=True)
        poles = sampled_loops(loader, "original").poles[0]
        s = np.log(poles[np.abs(poles) > 0.3]) / period
        errors.append(max(np.abs(s - pole).min() for pole in slow))
    assert errors[0] < 0.1 * 100
    assert errors[1] < 0.3 * errors[0]  # of the first order in the period


def test_nonlinear_effects_without_slope_are_excluded(loader: ff.Loader) -> None:
    law = own(loader, "robust")
    rough = loader.replace(
        {
            "column.coulomb_friction": "3 lb",
            "linkage.backlash": "0.002 in",
            "load_cell.resolution": "0.05 lb",
            "column_sensor.resolution": "1e-4 deg",
            "load_cell.noise": "0.1 lb",
        }
    )
    np.testing.assert_array_equal(sampled_loops(rough, law).matrix, sampled_loops(loader, law).matrix)


def test_unstable_loop_has_no_margins(loader: ff.Loader) -> None:
    unstable = sampled_loops(loader.replace(LIGHT), "original")
    assert not unstable.stable[0]
    margins = loop_margins(CommandLoop.sampled(unstable))
    assert (margins.gain_up, margins.delay_s) == (1.0, 0.0)


def test_analog_loader_and_foreign_law_are_refused(loader: ff.Loader) -> None:
    with pytest.raises(InputError, match=r"controller\.period: expected a sample period"):
        sampled_loops(ff.elevator(), None)
    slower = loader.replace({"controller.period": "1 ms"})
    with pytest.raises(InputError, match=r"made for a controller\.period of 0\.5 ms, the loader has 1 ms"):
        sampled_loops(slower, own(loader, "robust"))


def test_loops_of_both_drives_side_by_side_are_the_loops_of_each(loader: ff.Loader) -> None:
    both = [other.si_values for other in (loader, ff.loader.electric("elevator-electric"))]
    mixed = np.array([both[k] for k in (0, 1, 1, 0, 1, 0, 0, 1, 1, 1, 0)])
    gains = np.array([[-194.0, -3.8e-9, 22.0, 0.67, 19.9, -0.7, -1.5e-3]])

    def periods(values: np.ndarray) -> tuple[list[int], np.ndarray]:
        return _core.sampled_loops(values, 2.5e-4, (2, 1), gains=np.repeat(gains, len(values), axis=0), threads=2)

    states, matrices = periods(mixed)
    for values in both:
        own, alone = periods(values[np.newaxis])
        columns = [states.index(state) for state in own]
        inputs = [len(states), len(states) + 1]
        for found in matrices[(mixed == values).all(axis=1)]:
            np.testing.assert_array_equal(found[np.ix_(columns, columns + inputs)], alone[0])
