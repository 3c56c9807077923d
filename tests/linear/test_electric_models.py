"""The linear models of an electric loader against the witness's equations, closed forms, and the engine itself."""

import numpy as np
import pytest
from scipy.linalg import expm

import forcefeel as ff
from forcefeel.errors import InputError
from forcefeel.laws import SampledLaw
from forcefeel.linear import Linkage
from forcefeel.linear.electric_modes import (
    AS_ONE,
    COLUMN_ON_LINK,
    CURRENT_LOOP,
    ON_THE_LINK,
    ROTOR_ON_LINK,
    named_modes,
)
from forcefeel.linear.models import loader_model, open_loop_model, plant_model
from forcefeel.linear.sampled_feel import sampled_feel
from forcefeel.linear.step import step_outputs
from forcefeel.loader.parameters import TABLE
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Schedule
from tests import electric_witness as witness

ROUNDING = 1e-9
"""Relative, of poles of 6000 beside 2 and of differences of linear equations."""
RIGID = 1e-3
"""Relative, of a link ten thousand times as stiff."""
FINE = 2e-3
"""Of the deflection, sampled every 0.05 ms beside continuous. Measured: 3e-4; 8e-4 on another built-in loader."""

NAMES = ("elevator-electric", "aileron-wheel", "rudder-pedals", "sidestick-pitch", "sidestick-roll", "desktop-yoke")
RAW = {
    f"{sensor}.{name}": None
    for sensor in ("load_cell", "potentiometer", "column_sensor")
    for name in ("noise", "resolution")
} | {
    key: None
    for key in TABLE
    if key.startswith(("current_loop.", "thermal.", "column.stop", "winding.temp")) and "bandwidth" not in key
}
DRAWN = (
    "motor.torque_constant",
    "motor.inertia",
    "current_loop.bandwidth",
    "transmission.travel",
    "linkage.stiffness",
    "linkage.damping",
    "column.inertia",
    "column.base_arm",
)


def linear(name, **changes):
    """A built-in loader without what is not linear."""
    loader = ff.loader.electric(name)
    off = {key: value for key, value in RAW.items() if key in loader.given}
    return loader.replace({**off, **changes}, si=True)


def drawn(seed):
    """One that is not built in: parameters within a factor of two of one that is, a transmission that gives, drag."""
    random = np.random.default_rng(seed)
    loader = linear(NAMES[seed % len(NAMES)])
    factors = 2.0 ** random.uniform(-1, 1, len(DRAWN))
    changes = {key: loader[key] * factor for key, factor in zip(DRAWN, factors, strict=True)}
    changes["transmission.stiffness"] = loader["linkage.stiffness"] * random.uniform(0.5, 5)
    return loader.replace(
        {**changes, "motor.viscous_friction": loader["motor.inertia"] * random.uniform(0.1, 5)}, si=True
    )


def of_witness(loader):
    """A, B of the witness by central differences; its equations are linear here, so any step does."""
    plant = witness.Plant(loader)

    def rates(x, force, e):
        return np.array(plant.rates([*x, *np.zeros(5)], e, force)[:5])

    still = np.zeros(5)
    a = np.array([(rates(row, 0, 0) - rates(-row, 0, 0)) / 2 for row in np.eye(5)]).T
    b = np.array([(rates(still, f, e) - rates(still, -f, -e)) / 2 for f, e in ((1, 0), (0, 1))]).T
    return a, b


@pytest.mark.parametrize("seed", range(6))
def test_plant_equals_witness_jacobian(seed):
    loader = drawn(seed)
    found, (a, b) = plant_model(loader, Linkage.COMPLIANT), of_witness(loader)
    np.testing.assert_allclose(found.A, a, rtol=ROUNDING, atol=ROUNDING * np.abs(a).max())
    np.testing.assert_allclose(found.B, b, rtol=ROUNDING)
    assert ff.linear.plant(loader).output_labels == list(found.output_labels)


@pytest.mark.parametrize("seed", range(6))
def test_current_control_leaves_masses_on_feel_spring(seed):
    """``(J + J_m g^2) s^2 (1 + s / w_c) + B_m g^2 s (1 + s / w_c) + B s + G = 0`` with a rigid link."""
    loader = drawn(seed)
    row = loader.__getitem__
    gear = (row("linkage.ratio") * row("column.base_arm") / row("transmission.travel")) ** 2
    inertia, drag = row("column.inertia") + row("motor.inertia") * gear, row("motor.viscous_friction") * gear
    machine = np.polymul([inertia, drag, 0], [1 / row("current_loop.bandwidth"), 1])
    expected = np.roots(np.polyadd(machine, [row("feel.damping"), row("feel.stiffness")]))
    rigid = loader_model(loader, None, Linkage.RIGID)
    np.testing.assert_allclose(np.sort_complex(np.linalg.eigvals(rigid.A)), np.sort_complex(expected), rtol=ROUNDING)
    stiff = loader.replace(
        {
            "transmission.stiffness": None,
            **{f"linkage.{name}": 1e4 * row(f"linkage.{name}") for name in ("stiffness", "damping")},
        },
        si=True,
    )
    slow = sorted(np.linalg.eigvals(loader_model(stiff, None, Linkage.COMPLIANT).A), key=abs)[:2]
    np.testing.assert_allclose(np.sort_complex(slow), np.sort_complex(sorted(expected, key=abs)[:2]), rtol=RIGID)


@pytest.mark.parametrize("seed", range(6))
def test_link_mode_frequency_matches_closed_form(seed):
    loader = drawn(seed).replace({"motor.viscous_friction": None})
    row = loader.__getitem__
    k = 1 / (1 / row("linkage.stiffness") + 1 / row("transmission.stiffness"))
    c = row("linkage.damping") * k / row("linkage.stiffness")
    rotor = row("motor.inertia") / row("transmission.travel") ** 2
    column = row("column.inertia") / (row("linkage.ratio") * row("column.base_arm")) ** 2
    found = {mode.name: mode for mode in ff.linear.motor_modes(loader)}
    for name, compliance in (
        (ON_THE_LINK, 1 / rotor + 1 / column),
        (COLUMN_ON_LINK, 1 / column),
        (ROTOR_ON_LINK, 1 / rotor),
    ):
        assert found[name].frequency_rad_per_s == pytest.approx(np.sqrt(k * compliance), rel=ROUNDING)
        assert found[name].damping_ratio == pytest.approx(c / 2 * np.sqrt(compliance / k), rel=ROUNDING)
    assert found[CURRENT_LOOP].real_per_s == pytest.approx(-row("current_loop.bandwidth"), rel=ROUNDING)


def test_mode_names_follow_moving_masses():
    loader = linear("rudder-pedals")
    for linkage, names in (
        (Linkage.RIGID, [AS_ONE, AS_ONE, CURRENT_LOOP]),
        (Linkage.COMPLIANT, [AS_ONE, AS_ONE, ON_THE_LINK, CURRENT_LOOP]),
    ):
        assert [mode.name for mode in named_modes(loader, loader_model(loader, None, linkage).A)] == names


def test_command_loop_closes_to_model():
    for linkage in Linkage:
        opened = open_loop_model(linear("sidestick-roll"), linkage)
        closed = loader_model(linear("sidestick-roll"), None, linkage)
        np.testing.assert_allclose(opened.A - opened.B @ opened.C, closed.A, rtol=ROUNDING)


@pytest.mark.parametrize("periods", [0.0, 0.3, 1.0, 2.4])
def test_sampled_feel_matches_explicit_loop(periods):
    period = 5e-4
    loader = linear("sidestick-roll", **{"controller.period": period, "controller.delay": periods * period})
    a, b = of_witness(loader)
    gains = _gains(loader)
    state, before, commands = np.array([1e-3, 0.1, 0.0, 2e-3, -0.1]), 5e-4, [0.3, -0.2, 0.1, 0.05]
    matrix = sampled_feel(loader, rigid=False)
    found = np.array([*state, before, *commands[: len(matrix) - 6]])
    asked = [(-(k + 1.0), one) for k, one in enumerate(commands)]  # when, in periods, and what; the youngest first
    for sample in range(40):
        asked.insert(0, (sample, -(gains[0] * state[0] + gains[1] * (state[0] - before) / period)))
        before = state[0]
        for part in range(10):  # tenths of a period, on which every delay here falls
            moment = sample + (part + 0.5) / 10
            held = next(one for at, one in asked if at + periods <= moment)
            state = _moved(a, b[:, 1], period / 10, state, held)
        found = matrix @ found
        np.testing.assert_allclose(found[:5], state, rtol=1e-8, atol=1e-10)  # a hundred exponentials of rounding


def _gains(loader):
    lever = loader["linkage.ratio"] * loader["column.base_arm"]
    per_ampere = loader["motor.torque_constant"] / loader["transmission.travel"]
    return [loader[key] / (per_ampere * lever**2) for key in ("feel.stiffness", "feel.damping")]


def _moved(a, b, time_s, state, held):
    whole = np.zeros((6, 6))
    whole[:5, :5], whole[:5, 5] = a, b
    return (expm(whole * time_s) @ np.append(state, held))[:5]


def by_current(loader):
    """The feel by current alone as a law of the engine: its state is the position at the sample before."""
    g, d = _gains(loader)
    period = loader["controller.period"]
    command, torque = np.zeros((1, 6)), np.zeros((1, 6))
    command[0, [0, 2]] = d / period, -(g + d / period)
    torque[0, 1] = -0.1  # the feel computer runs, and nobody listens
    entry = np.zeros((1, 1, 4))
    entry[0, 0, 1] = 1.0
    return SampledLaw(period, loader["controller.delay"], np.zeros((1, 1, 1)), entry, command, torque)


def pushed(loader, duration_s, step_s, sample_s):
    force = loader["pilot.force"]
    scenario = Scenario(Schedule((0.0, duration_s), (force, force)), duration_s, step_s, sample_s)
    return simulate(loader, scenario, by_current(loader)).history


def test_linear_step_matches_engine_for_small_steps():
    fine = 5e-5
    loader = linear("aileron-wheel", **{"controller.period": fine, "controller.delay": None})
    history = pushed(loader, 0.5, fine, fine)
    angle = history.column_angle_rad.values
    model = loader_model(loader, None, Linkage.COMPLIANT)
    _, continuous = step_outputs(model, loader["pilot.force"], 0.5, len(angle))
    peak = angle.max()
    assert np.abs(angle - continuous[0]).max() / peak < FINE
    current = continuous[list(model.output_labels).index("motor_current_a")]
    assert (
        np.abs(history.motor_current_a.values - current).max() / np.abs(current).max() < 5 * FINE
    )  # an edge at the start


def test_largest_stable_stiffness_matches_engine():
    loader = linear("aileron-wheel")
    edge = ff.linear.largest_stable_stiffness(loader)
    swings = []
    for share in (0.97, 1.03):
        scaled = loader.scale_feel(share * edge.stiffness_n_m_per_rad / loader["feel.stiffness"])
        history = pushed(scaled, 0.5, 1e-4, 5e-4)
        current = history.motor_current_a.values
        swings.append(np.ptp(current[-100:]) / np.ptp(current[-300:-200]))
        if share > 1:
            spectrum = np.abs(np.fft.rfft(np.diff(current[-400:])))
            found = np.fft.rfftfreq(399, 5e-4)[spectrum.argmax()]
            assert found == pytest.approx(edge.frequency_rad_per_s / 2 / np.pi, abs=6)  # lines 5 Hz apart
    assert swings[0] < 0.9
    assert swings[1] > 1.1


@pytest.mark.parametrize(
    "call",
    [
        lambda motor: ff.linear.servo(motor, Linkage.COMPLIANT, closed=True),
        ff.linear.design_plant,
        ff.linear.smallest_stable_stiffness,
        lambda motor: ff.linear.state_feedback(motor, np.zeros(6)),
        lambda motor: ff.compliant_model(motor, ff.laws.GainLaw.original(ff.elevator().si_values)),
        lambda motor: motor.plot_bode(ff.laws.GainLaw.original(ff.elevator().si_values)),
        lambda motor: ff.sweep.stability_batch(motor, {"feel.stiffness": [1.0, 2.0]}),
        lambda motor: ff.simulation.simulate_linear_batch(
            motor, Scenario(Schedule((0.0, 1.0), (1.0, 1.0)), 1.0), motor.si_values[None]
        ),
        lambda _: ff.linear.largest_stable_stiffness(ff.elevator()),
        lambda _: ff.linear.motor_modes(ff.elevator()),
    ],
)
def test_function_for_other_drive_raises_input_error(call):
    with pytest.raises(InputError, match=r"takes a loader with an? (hydraulic|electric) drive"):
        call(ff.loader.electric("sidestick-roll"))
