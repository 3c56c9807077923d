"""The integrator behind the synthetic bench, proved by the nonlinear witness, by its own order and by what cannot be otherwise."""

import ast
from dataclasses import replace
from functools import cache
from pathlib import Path

import bench_machine
import exact_steps
import numpy as np
import pytest
from bench_machine import Controller, Machine, held, run

from tests import nonlinear_witness, witness

pytestmark = pytest.mark.slow

FRICTION, BREAKAWAY, LIMIT = 1.3, 1.9, 6.0  # lb, lb, mA: both column and amplifier switch often
MACHINE = Machine(
    link_stiffness=5230.0,
    link_damping=19.4,
    inertia=40.6,
    current_gain=4.87,
    coulomb_friction=FRICTION,
    static_friction=BREAKAWAY,
    current_limit=LIMIT,
)
WITNESS = nonlinear_witness.Machine(
    link_stiffness=5230.0,
    link_damping=19.4,
    column_inertia=40.6,
    current_gain=4.87,
    coulomb_friction=FRICTION,
    static_friction=BREAKAWAY,
    current_limit=LIMIT,
)
K3 = witness.K3
GAINS = {"servo-open": (0.0,) * 7, "servo-closed": (-K3, *[0.0] * 6), "loader": None}
CHANNELS = {
    "column_angle": "theta",
    "column_velocity": "theta_rate",
    "piston_position": "x_p",
    "load_cell_force": "link_force",
    "load_pressure": "p",
    "actuator_flow": "flow",
    "valve_current": "current",
}

RATE_HZ, DURATION_S = 500.0, 0.7
TIME_S = np.arange(round(DURATION_S * RATE_HZ) + 1) / RATE_HZ
BEHIND_S = TIME_S + 1e-11
"""Just behind the samples, where what jumps there has jumped."""
RUN_S = DURATION_S + 1e-6
SOLVER = nonlinear_witness.Solver("LSODA", 1e-10)
IN_COMPANY = 1e-12
"""Of the largest value: the same sums alone and side by side. Measured: 0."""
APART = 1e-7
"""Of a channel's largest value; the witness' own error after some tens of switches, and 4 us squared, are below it."""


def wave(size, lowest=0.4, highest=40.0):
    """Lines evenly spread in the logarithm of their frequency, at the samples; it comes softly."""
    random = np.random.default_rng(1974)
    lines = np.geomspace(lowest, highest, 20)
    parts = [np.sin(2 * np.pi * (f * TIME_S + random.random())) for f in lines]
    return size * np.sum(parts, axis=0) / np.sqrt(len(lines) / 2) * np.clip(5 * TIME_S, 0, 1)


def straight(values):
    """A signal of the witness that runs straight between the samples; its kinks are ends of pieces."""
    return (lambda t: float(np.interp(t, TIME_S, values))), TIME_S.tolist()


DRIVES = {"force": wave(25.0), "test_signal": wave(4.0)}
"""lb, V."""


@cache
def witnessed(loop, drive, **changes):
    """The witness under one of `DRIVES`."""
    machine = replace(WITNESS, gains=GAINS[loop], **changes)
    force, signal = (straight(DRIVES[drive]) if drive == it else () for it in ("force", "test_signal"))
    signals = nonlinear_witness.Signals(test_signal=signal)
    return nonlinear_witness.simulate(machine, force, RUN_S, BEHIND_S, signals=signals, solver=SOLVER)


def check(found, expected, apart=APART):
    for channel, column in CHANNELS.items():
        scale = np.abs(expected[column]).max()
        np.testing.assert_allclose(found[channel][0], expected[column], rtol=0, atol=apart * scale, err_msg=channel)
    assert np.array_equal(found["potentiometer"], K3 * found["piston_position"])
    assert np.array_equal(found["load_cell"], -0.005 * found["load_cell_force"])


@pytest.mark.parametrize(
    ("loop", "drive"),
    [
        ("servo-open", "test_signal"),
        ("servo-closed", "test_signal"),
        ("servo-closed", "force"),
        ("loader", "force"),
        ("loader", "test_signal"),
    ],
)
def test_every_channel_matches_the_reference(loop, drive):
    expected = witnessed(loop, drive)
    found = run(MACHINE, loop, RATE_HZ, **{drive: DRIVES[drive]})
    check(found, expected)
    # The run went through every mode that the experiment can bring about.
    rate = found["column_velocity"][0]
    assert ((rate > 0).any(), (rate == 0).sum() > 5, (rate < 0).any()) == (True, True, True)
    assert (np.abs(found["valve_current"]) == LIMIT).any() == (drive == "test_signal")


@pytest.mark.parametrize("loop", ["servo-closed", "loader"])
def test_release_matches_the_reference(loop):
    machine = replace(WITNESS, gains=GAINS[loop])
    start = nonlinear_witness.release(machine, 0.05)
    expected = nonlinear_witness.simulate(machine, (), RUN_S, BEHIND_S, start, solver=SOLVER)
    check(run(MACHINE, loop, RATE_HZ, force=0 * TIME_S, start=held(MACHINE, loop, 0.05)), expected)


def test_open_servo_has_no_held_start():
    with pytest.raises(ValueError, match="no rest"):
        held(MACHINE, "servo-open", 0.05)


@pytest.mark.parametrize(
    ("loop", "period", "delay"), [("servo-closed", 5e-4, 0), ("loader", 5e-4, 1), ("servo-closed", 4e-3, 1)]
)
def test_digital_controller_matches_the_reference(loop, period, delay):
    drive = "force" if loop == "loader" else "test_signal"
    expected = witnessed(loop, drive, period=period, delay=period * delay)
    check(run(MACHINE, loop, RATE_HZ, controller=Controller(period, delay), **{drive: DRIVES[drive]}), expected)


@pytest.mark.parametrize("delay", [0, 1])
def test_command_signal_is_sampled_and_delayed_like_the_command(delay):
    """The witness' law has a gain on the pilot's force: with a grip arm of nothing, the force is the signal."""
    arm, period = 1e-9, 1e-3
    friction = {
        name: value * 31.375 / arm for name, value in (("coulomb_friction", FRICTION), ("static_friction", BREAKAWAY))
    }
    machine = replace(
        WITNESS, gains=(-K3, *[0.0] * 5, 1.0), grip_arm=arm, period=period, delay=delay * period, **friction
    )
    expected = nonlinear_witness.simulate(machine, straight(DRIVES["test_signal"]), RUN_S, BEHIND_S, solver=SOLVER)
    controller = Controller(period, delay)
    inside, outside = (
        run(MACHINE, "servo-closed", RATE_HZ, controller=controller, **{place: DRIVES["test_signal"]})
        for place in ("command_signal", "test_signal")
    )
    check(inside, expected)
    assert np.abs(outside["column_angle"][0] - expected["theta"]).max() > 1e-2 * np.abs(expected["theta"]).max()


def test_analog_law_adds_both_signals_at_the_same_point():
    found = (
        run(MACHINE, "servo-closed", RATE_HZ, **{it: DRIVES["test_signal"]}) for it in ("command_signal", "test_signal")
    )
    inside, outside = (it["load_pressure"] for it in found)
    assert np.array_equal(inside, outside)


def test_staircase_input_keeps_its_values():
    steps = list(zip(TIME_S.tolist(), DRIVES["test_signal"].tolist(), strict=True))
    machine = replace(WITNESS, gains=GAINS["servo-closed"])
    signals = nonlinear_witness.Signals(test_signal=steps)
    expected = nonlinear_witness.simulate(machine, (), RUN_S, BEHIND_S, signals=signals, solver=SOLVER)
    check(run(MACHINE, "servo-closed", RATE_HZ, test_signal=DRIVES["test_signal"], staircase=True), expected)


def test_integrator_is_of_second_order_in_step_size():
    """Whatever else a step does is exact, so parts of a quarter have a sixteenth of the error, on the way through many switches."""
    size = {channel: np.abs(witnessed("servo-closed", "force")[column]).max() for channel, column in CHANNELS.items()}
    exact = run(MACHINE, "servo-closed", RATE_HZ, force=DRIVES["force"], smallest_s=2e-3 / 2**13)
    for channel in ("column_angle", "piston_position", "load_pressure"):
        error = [
            np.abs(
                run(MACHINE, "servo-closed", RATE_HZ, force=DRIVES["force"], smallest_s=part)[channel] - exact[channel]
            )
            for part in (2e-3 / 2**6, 2e-3 / 2**10)
        ]
        errors = [np.sqrt(np.mean(it**2)) for it in error]
        assert errors[0] < 5e-6 * size[channel]  # measured: 5e-7
        assert errors[1] < errors[0] / 60  # of the first order it would be 16, of the second 256, less what chance does


def test_result_does_not_depend_on_step():
    """Samples between those of the drive change nothing but the places at which a switch is looked for."""
    between = np.arange(4 * (len(TIME_S) - 1) + 1) / (4 * RATE_HZ)
    force = np.interp(between, TIME_S, DRIVES["force"])
    fine = run(MACHINE, "loader", 4 * RATE_HZ, force=force)
    coarse = run(MACHINE, "loader", RATE_HZ, force=DRIVES["force"])
    for channel, values in coarse.items():
        assert np.abs(fine[channel][:, ::4] - values).max() < APART * np.abs(values).max()


def test_batched_machines_match_single_machines():
    stiffness, friction = np.array([5000.0, 7000.0, 6000.0]), np.array([0.0, 1.0, 3.0])
    many = replace(MACHINE, link_stiffness=stiffness, coulomb_friction=friction, static_friction=2 * friction)
    signals = DRIVES["test_signal"] * np.array([[1.0], [0.5], [2.0]])
    together = run(many, "servo-closed", RATE_HZ, test_signal=signals)
    for k in range(3):
        alone = replace(
            MACHINE, link_stiffness=stiffness[k], coulomb_friction=friction[k], static_friction=2 * friction[k]
        )
        for channel, values in run(alone, "servo-closed", RATE_HZ, test_signal=signals[k]).items():
            np.testing.assert_allclose(together[channel][k], values[0], rtol=0, atol=IN_COMPANY * np.abs(values).max())


def test_invalid_loop_name_or_period_raises_value_error():
    with pytest.raises(ValueError, match=r"servo-open.*got 'servo'"):
        run(MACHINE, "servo", RATE_HZ, force=DRIVES["force"])
    with pytest.raises(ValueError, match="period"):
        run(MACHINE, "servo-closed", RATE_HZ, force=DRIVES["force"], controller=Controller(3e-3))


@pytest.mark.parametrize("module", [bench_machine, exact_steps])
def test_bench_machine_imports_no_engine_code(module):
    tree = ast.parse(Path(module.__file__).read_text(encoding="utf-8"))
    names = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    own = {"math", "collections", "dataclasses", "itertools", "numpy", "scipy", "exact_steps"}
    assert {name.split(".")[0] for name in names} <= own
