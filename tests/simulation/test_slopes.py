"""Slopes along parameters: against a model written out by hand and a complex step, and against finite differences."""

import control
import numpy as np
import pytest
from scipy.linalg import expm

import forcefeel as ff
from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.bench.channels import INPUTS
from forcefeel.bench.experiments import Loop
from forcefeel.bench.identification.linear import channel_responses
from forcefeel.loader.parameters import INDEX, TABLE
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Recorded, Release, Schedule, Step
from forcefeel.simulation.scenario import Steps

LAWS = {"open": GainLaw.none, "position": GainLaw.position_loop, "original": GainLaw.original}
CHANNELS = dict(_core.channels())
LB = 4.4482216152605
DIGITAL = {"controller.period": "0.5 ms", "controller.delay": "0.5 ms"}

KEYS = [
    "amplifier.admittance",
    *(f"valve.{name}" for name in ("current_gain", "pressure_gain", "natural_frequency", "damping_ratio")),
    *(f"actuator.{name}" for name in ("area", "oil_volume", "bulk_modulus")),
    *(f"linkage.{name}" for name in ("ratio", "stiffness", "damping")),
    *(f"column.{name}" for name in ("inertia", "base_arm", "grip_arm")),
    *("load_cell.gain", "potentiometer.gain"),
    *(f"feel.{name}" for name in ("inertia", "damping", "stiffness", "maximum_stiffness")),
]
"""What the linear models depend on."""

EXACT = 1e-12
"""Relative: two routes without a step size, some hundred roundings apart."""


# The model by hand ---------------------------------------------------------------------------------------------------


def by_hand(values, linkage, law):
    """``A, B, C, D`` from eqs. (3)-(13) for inputs ``[e_T, F_p]``; values may be complex."""
    v = dict(zip(TABLE, values, strict=True))
    area, ratio, base_arm = v["actuator.area"], v["linkage.ratio"], v["column.base_arm"]
    stiff, damping = v["linkage.stiffness"], v["linkage.damping"]

    def at(x, e_test, force):
        if linkage == "rigid":
            x_p, x_p_rate, p, q_i, q_i_rate, delta, delta_rate = x
            x_b, x_b_rate = x_p / ratio, x_p_rate / ratio
        else:
            x_p, p, q_i, q_i_rate, delta, delta_rate, x_b, x_b_rate = x
            x_p_rate = (area * p - stiff * (x_p - ratio * x_b)) / damping + ratio * x_b_rate
        e, torque = e_test, 0.0
        if law != "open":
            e = e - v["potentiometer.gain"] * x_p
        if law == "original":
            e = e + delta
            torque = -v["feel.maximum_stiffness"] * v["load_cell.gain"] * area * p
        i = v["amplifier.admittance"] * e
        q = q_i - v["valve.pressure_gain"] * p
        w, zeta = v["valve.natural_frequency"], v["valve.damping_ratio"]
        push = base_arm * (v["column.grip_arm"] * force + ratio * base_arm * area * p) / v["column.inertia"]
        feel = (torque - v["feel.damping"] * delta_rate - v["feel.stiffness"] * delta) / v["feel.inertia"]
        oil = 4 * v["actuator.bulk_modulus"] / v["actuator.oil_volume"] * (q - area * x_p_rate)
        valve = [q_i_rate, w**2 * (v["valve.current_gain"] * i - q_i) - 2 * zeta * w * q_i_rate]
        if linkage == "rigid":
            rates = [x_p_rate, ratio * push, oil, *valve, delta_rate, feel]
        else:
            rates = [x_p_rate, oil, *valve, delta_rate, feel, x_b_rate, push]
        signals = [v["potentiometer.gain"] * x_p, -v["load_cell.gain"] * area * p]
        return np.array([*rates, x_b / base_arm, x_b_rate / base_arm, x_p, area * p, p, q, i, *signals])

    n = 7 if linkage == "rigid" else 8
    columns = np.array([at(column[:n], *column[n:]) for column in np.eye(n + 2)]).T
    return columns[:n, :n], columns[:n, n:], columns[n:, :n], columns[n:, n:]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("linkage", ["rigid", "compliant"])
def test_linear_models_and_slopes_match_explicit_formulas(linkage, law):
    values = ff.elevator().si_values
    every = range(len(TABLE))
    found = _core.linear_slopes(values, every, linkage=linkage, law=law)
    for matrix, expected in zip(found[:4], by_hand(values, linkage, law), strict=True):
        np.testing.assert_allclose(matrix, expected, rtol=EXACT)
    moved = set()
    for k, key in enumerate(TABLE):
        if not np.isfinite(values[k]):
            continue
        # A complex step has no difference to round: Im f(x + i h) / h.
        along = values.astype(complex)
        along[k] += 1e-30j
        for slope, by_step in zip(found[4:], by_hand(along, linkage, law), strict=True):
            np.testing.assert_allclose(slope[k], by_step.imag / 1e-30, rtol=EXACT)
            if np.any(slope[k]):
                moved.add(key)
    unmoved = {"linkage.stiffness", "linkage.damping"} if linkage == "rigid" else set()
    unmoved |= {"feel.maximum_stiffness"} if law != "original" else set()
    assert moved == set(KEYS) - unmoved


@pytest.mark.parametrize("law", LAWS)
def test_linear_models_equal_models_without_slopes(law):
    values = ff.elevator().si_values
    for linkage in ("rigid", "compliant"):
        a, b, c, _, *_ = _core.linear_slopes(values, [], linkage=linkage, law=law)
        matrices = getattr(_core, linkage)(values, LAWS[law](values))
        np.testing.assert_array_equal(a, matrices[0])
        np.testing.assert_array_equal(b, matrices[1][:, ::-1])
        np.testing.assert_array_equal(c[[0, 2, 3, 7, 6, 5]], matrices[2][[0, 2, 3, 4, 5, 6]])


def test_fixed_law_is_independent_of_parameters():
    values, gain = ff.elevator().si_values, INDEX["potentiometer.gain"]
    by_name = _core.linear_slopes(values, [gain], linkage="compliant", law="position")
    fixed = _core.linear_slopes(values, [gain], linkage="compliant", law=GainLaw.position_loop(values))
    np.testing.assert_array_equal(by_name[0], fixed[0])
    assert np.any(by_name[4])
    assert not np.any(fixed[4])


# From one period to the next -----------------------------------------------------------------------------------------

DIFFERENCE = 1e-4
"""Relative step of a central difference; with Richardson's extrapolation its error is the fourth power, 1e-16, and its rounding
1e-16 / 1e-4 of what is differenced."""


def differenced(of, values, key, step=DIFFERENCE):
    """Slope of ``of`` along a parameter: two central differences, extrapolated."""

    def central(share):
        up, down = values.copy(), values.copy()
        up[INDEX[key]] *= 1 + share
        down[INDEX[key]] *= 1 - share
        return (of(up) - of(down)) / (up[INDEX[key]] - down[INDEX[key]])

    return (4 * central(step / 2) - central(step)) / 3


@pytest.mark.parametrize("lag", [False, True], ids=["plain", "lagging"])
@pytest.mark.parametrize("law", LAWS)
def test_period_slopes_match_finite_differences(law, lag):
    loader = ff.elevator().replace(
        {"controller.period": "1 ms", "controller.delay": "0.5 ms", "pilot.arm_mass": "5 lbm"}
    )
    if lag:
        loader = loader.replace({"load_cell.bandwidth": "300 Hz", "potentiometer.bandwidth": "400 Hz"})
    timing, step_s, values = (2, 1), 5e-4, loader.si_values

    def model(values):
        return whole(_core.sampled_slopes(values, [], step_s, timing, law=law))

    keys = [*KEYS, "pilot.arm_mass"] + ["load_cell.bandwidth", "potentiometer.bandwidth"] * lag
    found = _core.sampled_slopes(values, [INDEX[key] for key in keys], step_s, timing, law=law)
    size = np.abs(model(values))
    for k, key in enumerate(keys):
        relative = loader[key] * whole([slopes[k] for slopes in found[4:]])
        off = np.abs(relative - loader[key] * differenced(model, values, key))
        # 1e-16 / 1e-4 of an entry; the pressure's rate is a difference that loses two digits, a sensor's exponential a 1024th
        # power, which loses three and a bit.
        assert np.all(off <= 1e-8 * (size + np.abs(relative))), key


def whole(matrices):
    """``[A, B; C, D]``; D has one column for all the steps of a period that B has."""
    a, b, c, d = matrices[:4]
    return np.block([[a, b], [c, d, np.zeros((len(d), b.shape[1] - d.shape[1]))]])


@pytest.mark.parametrize("law", LAWS)
def test_period_matrices_equal_matrices_without_slopes(law):
    loader = ff.elevator().replace(DIGITAL)
    period = loader["controller.period"]
    m, b, *_ = _core.sampled_slopes(loader.si_values, [], period, (1, 1), law=law)
    _, matrices = _core.sampled_loops(loader.si_values[np.newaxis], period, (1, 1), law=law)
    np.testing.assert_array_equal(np.hstack([m, b[:, :2]]), matrices[0])


@pytest.mark.parametrize(("push", "within"), [(0.0, 1e-9), (20.0, 1e-5)])
@pytest.mark.parametrize("law", LAWS)
def test_period_matrices_reproduce_samples_of_run(law, push, within):
    """Some hundred periods of roundings, on pressures that are differences of ten times their size; a force that comes with a jump
    is a period old to the matrix, and not to the oil."""
    loader = ff.elevator().replace(DIGITAL)
    volts = 0.2 * np.sin(np.arange(301) * 0.13)
    # The pilot pushes from the start on.
    inputs = {"force": np.full((300, 2), push), "command_signal": np.column_stack([volts[:-1], volts[1:]])}
    simulation = _core.Simulation(inputs, 5e-4, timing=(1, 1))
    run, _ = simulation.slopes(loader.si_values[np.newaxis], [0], channels=range(9), law=law)
    m, b, c, d, *_ = _core.sampled_slopes(loader.si_values, [], 5e-4, (1, 1), law=law)
    x, found = np.zeros(len(m)), np.empty((9, 300))
    for k in range(300):
        u = np.array([volts[k], push])
        found[:, k] = c @ x + d[:, :2] @ u
        x = m @ x + b[:, :2] @ u
    for k, name in enumerate(CHANNELS):
        size = np.abs(found[k]).max()
        np.testing.assert_allclose(run[0, k, 1:-1], found[k, 1:], rtol=0, atol=within * size, err_msg=name)


# Records -------------------------------------------------------------------------------------------------------------


def engine(loader, scenario, **more):
    steps = Steps.of(scenario, loader)
    return _core.Simulation(
        steps.inputs,
        steps.step_s,
        every=steps.every,
        start_force=steps.start_force_n,
        held=steps.held,
        timing=steps.timing,
        **more,
    )


def swept(volts, duration_s=0.5):
    """A voltage that sweeps from 1 to 20 Hz."""
    time = np.linspace(0, duration_s, round(duration_s * 1e3) + 1)
    return Schedule(time, volts * np.sin(2 * np.pi * (time + 19 * time**2 / (2 * duration_s))))


ORIFICE = {"valve.orifice": True}
FRICTION = {"column.coulomb_friction": "3 lb", "column.static_friction": "4 lb"}
SEALS = {"actuator.seal_friction": "5 lb", "column.friction_asymmetry": 0.2}
PUSH = Recorded((0.0, 0.1, 0.25, 0.5), (10.0, 150.0, -170.0, 30.0))

RECORDS = {
    "open, orifice": (ORIFICE, Scenario(test_signal_v=swept(1.0), duration_s=0.5), "open"),
    "position": ({}, Scenario(test_signal_v=swept(0.3), duration_s=0.5), "position"),
    "position, digital": (DIGITAL, Scenario(test_signal_v=swept(0.3), duration_s=0.5), "position"),
    "original, digital": (DIGITAL | ORIFICE, Scenario(Step(96 * LB, 0.05), duration_s=0.5), "original"),
    "release": (ORIFICE, Scenario(Release(0.1, 0.05), duration_s=0.5), "original"),
    "release of the servo": ({}, Scenario(Release(0.05, 0.05), duration_s=0.5), "position"),
    "begun under a force": ({"column.gravity_torque": "100 lb in"}, Scenario(PUSH, duration_s=0.5), "original"),
    "servo under a force": (ORIFICE, Scenario(PUSH, duration_s=0.5), "position"),
    "friction": (FRICTION, Scenario(PUSH, duration_s=0.5), "original"),
    "friction, digital": (DIGITAL | FRICTION, Scenario(PUSH, duration_s=0.5), "original"),
    "friction with seals": (DIGITAL | FRICTION | SEALS, Scenario(test_signal_v=swept(0.3), duration_s=0.5), "position"),
}
ORIFICE_KEYS = ["valve.rated_flow", "valve.rated_current", "valve.supply_pressure"]


RECORD_STEP = 1e-5
"""Relative step of the differences, so small that nothing switches a step of the run earlier or later."""
RECORD_ERROR = 5e-8
"""Of what is recorded: 1e-16 / 1e-5, with three digits for pressures and flows that are differences of larger ones."""


@pytest.mark.parametrize("name", RECORDS)
def test_record_slopes_match_finite_differences(name):
    changes, scenario, law = RECORDS[name]
    loader = ff.elevator().replace(changes, si=True)
    keys = [key for key in KEYS if key not in ("valve.current_gain", "valve.pressure_gain") or "orifice" not in name]
    keys += ORIFICE_KEYS * ("valve.orifice" in changes) + ["column.coulomb_friction"] * ("friction" in name)
    keys += [*SEALS] * ("seals" in name)
    simulation = engine(loader, scenario)
    row = loader.si_values[np.newaxis]
    histories, slopes = simulation.slopes(row, [INDEX[key] for key in keys], channels=range(9), law=law, threads=2)
    assert np.all(np.isfinite(slopes))

    def record(values):
        return simulation.slopes(values[np.newaxis], [0], channels=range(9), law=law)[0][0]

    np.testing.assert_array_equal(histories[0], record(loader.si_values))
    size = np.abs(histories[0]).max(axis=1, keepdims=True)
    for k, key in enumerate(keys):
        relative = slopes[0, k] * loader[key]
        off = np.abs(relative - differenced(record, loader.si_values, key, RECORD_STEP) * loader[key])
        most = np.abs(relative).max(axis=1, keepdims=True)
        assert np.all(off <= RECORD_ERROR * (size + most)), (key, list(CHANNELS)[np.argmax((off / size).max(axis=1))])


@pytest.mark.parametrize("name", RECORDS)
def test_channels_match_run_outputs(name):
    changes, scenario, law = RECORDS[name]
    loader = ff.elevator().replace(changes, si=True)
    outputs = [k for k, (output, _) in enumerate(_core.simulation_outputs()) if output in CHANNELS]
    channels = [list(CHANNELS).index(_core.simulation_outputs()[k][0]) for k in outputs]
    assert len(channels) == 7
    values = np.repeat(loader.si_values[np.newaxis], 3, axis=0)
    values[:, INDEX["column.inertia"]] *= [0.9, 1.0, 1.1]
    simulation = engine(loader, scenario, outputs=outputs)
    _, expected = simulation.run(values, law=law, threads=2)
    found, slopes = simulation.slopes(values, [3, INDEX["column.inertia"]], channels=channels, law=law, threads=2)
    # Bits but for the column's angle, which a run multiplies by 1 / R_b and a bench divides by R_b.
    angles = [channels.index(k) for k in (0, 1)]
    np.testing.assert_array_equal(np.delete(found, angles, axis=1), np.delete(expected, angles, axis=1))
    np.testing.assert_allclose(found[:, angles], expected[:, angles], rtol=2 * np.finfo(float).eps, atol=0)
    for run in range(3):
        alone, slope = simulation.slopes(values[run : run + 1], [INDEX["column.inertia"]], channels=channels, law=law)
        np.testing.assert_array_equal(alone[0], found[run])
        np.testing.assert_array_equal(slope[0, 0], slopes[run, 1])


def test_batched_pairs_equal_single_pairs():
    loader = ff.elevator().replace(ORIFICE)
    simulation = engine(loader, Scenario(PUSH, duration_s=0.5, sample_s=0.005))
    values = np.repeat(loader.si_values[np.newaxis], 7, axis=0)
    values[:, INDEX["linkage.stiffness"]] *= np.linspace(0.7, 1.3, 7)
    keys = [INDEX[key] for key in ("linkage.stiffness", "column.inertia", "valve.rated_flow")]
    histories, slopes = simulation.slopes(values, keys, channels=[0, 4], threads=2)
    assert (histories.shape, slopes.shape) == ((7, 2, 101), (7, 3, 2, 101))
    for run in range(7):
        for k, key in enumerate(keys):
            alone, slope = simulation.slopes(values[run : run + 1], [key], channels=[0, 4])
            np.testing.assert_array_equal(alone[0], histories[run])
            np.testing.assert_array_equal(slope[0, 0], slopes[run, k])


def test_sensor_noise_and_resolution_are_excluded():
    plain = ff.elevator().replace(DIGITAL)
    rough = plain.replace(
        {
            "load_cell.noise": "1 lb",
            "load_cell.resolution": "0.5 lb",
            "controller.input_bits": 8,
            "controller.input_range": "10 V",
        },
        si=True,
    )
    scenario = Scenario(Step(96 * LB, 0.05), duration_s=0.2)
    keys = [INDEX["column.inertia"]]
    found, expected = (
        engine(it, scenario).slopes(it.si_values[np.newaxis], keys, channels=[0, 8]) for it in (rough, plain)
    )
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)


# A test signal in a run ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", LAWS)
def test_run_with_small_test_signal_matches_linear_model(law):
    loader = ff.elevator()
    drives = LAWS[law](loader.si_values)
    signal = swept(0.01)
    run = simulate(loader, Scenario(test_signal_v=signal, duration_s=0.5, step_s=2.5e-4, sample_s=1e-3), drives)
    assert run.method == "stepped"
    time = np.asarray(signal.times_s)
    model = ff.compliant_model(loader, drives)
    expected = control.forced_response(model[:, 1], time, signal.values)
    for name in ("column_angle_rad", "piston_position_m", "load_cell_force_n", "valve_current_a"):
        row = expected.outputs[model.output_labels.index(name)]
        # The engine's own accuracy is 1e-5 of full travel.
        np.testing.assert_allclose(run.history[name].values, row, rtol=0, atol=2e-4 * np.abs(row).max(), err_msg=name)


@pytest.mark.parametrize(("place", "arrives"), [("test_signal_v", 3), ("command_signal_v", 5)])
def test_only_command_signal_is_sampled_and_delayed(place, arrives):
    """A step at 3 ms: at the amplifier it is there at once, on the command at the sample of 4 ms and a millisecond later."""
    loader = ff.elevator().replace({"controller.period": "2 ms", "controller.delay": "1 ms"})
    signal = Schedule((0.0, 0.0031, 0.0031, 1.0), (0.0, 0.0, 0.5, 0.5))
    with pytest.raises(ff.InputError):
        Steps.of(Scenario(duration_s=0.1, **{place: signal}), loader)
    signal = Schedule((0.0, 0.003, 0.003, 1.0), (0.0, 0.0, 0.5, 0.5))
    simulation = engine(loader, Scenario(duration_s=0.1, **{place: signal}))
    (found,), _ = simulation.slopes(loader.si_values[np.newaxis], [0], channels=[6], law="open")
    expected = np.where(np.arange(101) >= arrives, 0.5 * loader["amplifier.admittance"], 0.0)
    np.testing.assert_array_equal(found[0], expected)


@pytest.mark.parametrize("delay_ms", [0.5, 1.0, 1.5])
def test_sampled_loop_responses_match_plant_integrals(delay_ms):
    """``Gamma = int exp(A (T - s)) b exp(j w s) ds`` of what comes in at the amplifier; the command's staircase by two such."""
    period, delay = 2e-3, delay_ms * 1e-3
    loader = ff.elevator().replace({"controller.period": "2 ms", "controller.delay": f"{delay_ms} ms"})
    a, b, c, d = by_hand(ff.elevator().si_values, "compliant", "open")
    b, d = b[:, 0], d[:, 0]
    gain = b @ (by_hand(ff.elevator().si_values, "compliant", "position")[0] - a) / (b @ b)

    def over(time):
        """``exp(A t)``, and its integral times b."""
        whole = expm(time * np.block([[a, b[:, np.newaxis]], [np.zeros(len(a) + 1)]]))
        return whole[:-1, :-1], whole[:-1, -1]

    (phi, _), (_, late) = over(period), over(period - delay)
    early = over(period)[1] - late
    frequency = np.array([0.5, 3.0, 12.0, 40.0])
    found = channel_responses(loader, Loop.SERVO_CLOSED, (), frequency)
    for k, omega in enumerate(2 * np.pi * frequency):
        z = np.exp(1j * omega * period)
        gamma = np.linalg.solve(1j * omega * np.eye(len(a)) - a, (z * np.eye(len(a)) - phi) @ b)
        # The command of this sample e = g x + e_C comes after the delay; until then the last one is held.
        held = gain / z
        loop = z * np.eye(len(a)) - phi - np.outer(early, held) - np.outer(late, gain)
        for name, drives, through in (
            ("test_signal", gamma, 1.0),
            ("command_signal", early / z + late, 1 / z),
        ):
            x = np.linalg.solve(loop, drives)
            expected = c @ x + d * (held @ x + through)
            value = found.value[:, list(INPUTS).index(name), k]
            # At 40 Hz a step of 1 ms is good to 4e-4 of itself.
            np.testing.assert_allclose(value, expected, rtol=6e-4, err_msg=f"{name} {frequency[k]}")


def test_open_servo_starts_at_neutral_for_any_force():
    loader = ff.elevator().replace({"column.gravity_torque": "100 lb in"})
    (found,), _ = engine(loader, Scenario(PUSH, duration_s=0.5)).slopes(
        loader.si_values[np.newaxis], [0], channels=[0, 4], law="open"
    )
    np.testing.assert_array_equal(found[:, 0], 0.0)
    assert np.all(np.isfinite(found))
    assert found[0, -1] != 0.0


# Errors --------------------------------------------------------------------------------------------------------------


def test_invalid_arguments_are_refused():
    values = ff.elevator().si_values
    for bad, message in (
        ({"linkage": "stiff"}, "linkage: expected 'rigid' or 'compliant', got \"stiff\""),
        ({"law": "closed"}, "law: expected 'open', 'position' or 'original', got \"closed\""),
        ({"keys": [len(TABLE)]}, f"keys: expected places of parameters below {len(TABLE)}, got {len(TABLE)}"),
        ({"values": values[1:]}, f"values: expected {len(TABLE)} values, got {len(TABLE) - 1}"),
    ):
        given = {"values": values, "keys": [0], "linkage": "rigid", "law": "open"} | bad
        with pytest.raises(ValueError, match=message):
            _core.linear_slopes(**given)
    with pytest.raises(TypeError, match="law: expected a GainLaw or its name"):
        _core.linear_slopes(values, [0], linkage="rigid", law=3)
    with pytest.raises(ValueError, match="keys: expected places"):
        _core.sampled_slopes(values, [1000], 1e-3, (1, 1))
    with pytest.raises(ValueError, match="observers: expected rows"):
        _core.sampled_slopes(values, [0], 1e-3, (1, 1), observers=np.zeros((1, 3)))


def test_invalid_simulation_arguments_raise_value_error():
    values = ff.elevator().si_values[np.newaxis]
    with pytest.raises(ValueError, match=r"inputs: trim: expected shape \(4, 2\) as of the others, got \(5, 2\)"):
        _core.Simulation({"force": np.zeros((4, 2)), "trim": np.zeros((5, 2))}, 1e-3)
    simulation = _core.Simulation({"force": np.zeros((4, 2))}, 1e-3)
    for keys, channels, message in (
        ([], [0], "keys: expected one at least"),
        ([1000], [0], "keys: expected places of parameters"),
        ([0], [9], "channels: expected places of channels below 9, got 9"),
    ):
        with pytest.raises(ValueError, match=message):
            simulation.slopes(values, keys, channels=channels)
    with pytest.raises(ValueError, match="law: expected 'open'"):
        simulation.run(values, law="closed")
    with pytest.raises(ValueError, match="values: expected rows"):
        simulation.slopes(values[:, 1:], [0], channels=[0])
