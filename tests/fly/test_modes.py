"""Stick-free modes flown in time, against eigenvalues of JSBSim's derivatives with column and hinge moment, written here."""

import jsbsim
import numpy as np
import pytest

import forcefeel as ff

FT, KNOT = 0.3048, 1852 / 3600
STATES = ("Vt", "Alpha", "Theta", "Q", "Alt")
CASES = {  # speed, kt; C_alpha, C_delta with its tab; area, chord, arm of the tail; boost share; elevator per command
    "c172p": (100.0, -0.1, -0.3, 14.5 * FT**2, 1.2 * FT, 15.7 * FT, 1.0, 0.40135),
    "737": (250.0, -0.08, -0.3, 70 * FT**2, 2.4 * FT, 48 * FT, 0.1, 0.3),
}
FLOWN_S = 100.0
"""One and a half swings of the phugoid."""
CLOSE = (0.01, 0.01, 0.02)
"""Phugoid, short period, column, whose damping loses 1.5 % to the frame of 2 ms beside a short period as quick as itself."""


def stick_free(name, loader):
    """Eigenvalues of aircraft and column; the tab takes the torque off at trim, whose change with pressure is left."""
    knots, per_flow, per_deflection, area, chord, tail, share, travel = CASES[name]
    model = jsbsim.FGFDMExec(None)
    model.set_debug_level(0)
    model.load_model(name)
    model["ic/vc-kts"], model["ic/h-sl-ft"], model["ic/gamma-deg"] = knots, 900 / FT, 0.0
    model.run_ic()
    model["propulsion/set-running"] = -1
    model["simulation/do_simple_trim"] = 1
    speed, alpha = model["velocities/vt-fps"] * FT, model["aero/alpha-rad"]
    pressure, mach = model["aero/qbar-psf"] * 4.4482216152605 / FT**2, model["velocities/mach"]
    grown = (1 - mach**2) ** -0.5 if name == "737" else 1.0
    moment = share * pressure * area * chord
    linear = jsbsim.FGLinearization(model)
    kept = [linear.x_names.index(state) for state in STATES]
    free = np.zeros((7, 7))
    free[:5, :5] = np.array(linear.system_matrix)[np.ix_(kept, kept)]
    free[:5, 5] = np.array(linear.input_matrix)[kept, 2] / travel
    free[5, 6] = 1.0
    # With the Mach number the part of the flow grows, and the tab's does not.
    by_speed = per_flow * 0.6 * alpha * grown * mach**2 / (1 - mach**2) / speed if name == "737" else 0.0
    free[6, 0] = moment * by_speed * FT
    free[6, 1] = moment * grown * per_flow * 0.6
    free[6, 3] = moment * grown * per_flow * tail / speed
    free[6, 5] = moment * grown * per_deflection - loader["feel.stiffness"]
    free[6, 6] = moment * -0.5 * chord / (2 * speed) - loader["feel.damping"]
    free[6] /= loader["feel.inertia"]
    values = np.linalg.eigvals(free)
    return sorted(values[values.imag > 0], key=abs)


@pytest.mark.slow
def test_free_modes_are_those_of_the_linear_model():
    name, frame = "737", ff.fly.FRAME_S
    speed, hand = CASES[name][0] * KNOT, np.zeros(round(FLOWN_S / frame))
    hand[: round(2 / frame)] = -5.0
    flown = ff.fly.fly(
        ff.digital_elevator(), ff.fly.Aircraft(name, speed, 900.0), hand, ff.fly.FlightOptions(alone=True)
    )
    rows = flown.states | {"column": flown.angle_rad}
    swings = np.array([rows["true_airspeed"] - rows["true_airspeed"][0]])[:, round(6 / frame) :: 200]
    (phugoid,) = (mode for mode in ff.fly.free_modes(swings, 200 * frame, 4) if mode.damping_ratio > 0.02)
    quick = np.array([rows[key] - rows[key][0] for key in ("pitch_rate", "load_factor", "angle_of_attack", "column")])
    quick = quick[:, round(2.02 / frame) : round(8.02 / frame) : 8]
    fast = [mode for mode in ff.fly.free_modes(quick, 8 * frame, 6) if mode.frequency_rad_per_s > 1]
    modes = sorted((phugoid, *fast), key=lambda mode: mode.frequency_rad_per_s)
    for mode, pole, close in zip(modes, stick_free(name, flown.loader), CLOSE, strict=True):
        assert mode.frequency_rad_per_s == pytest.approx(abs(pole), rel=close)
        assert mode.damping_ratio == pytest.approx(-pole.real / abs(pole), rel=close)
