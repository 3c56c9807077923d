"""How soon the link throws a column that is let go: held against an integrator, and against commands that are not the largest."""

from math import radians

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import linprog

import forcefeel as ff
from forcefeel.sizing.letting_go import falls_through_s

ANGLE, LEVEL = radians(10), 0.9
SOFT = ff.digital_elevator().replace({"linkage.stiffness": "700 lb/in", "valve.flow_limit": "40 in^3/s"})
MOTOR = ff.loader.electric("sidestick-pitch").replace({"linkage.stiffness": 60000.0}, si=True)
DESK = {
    "motor.torque_constant": 0.56,
    "motor.inertia": 0.0138,
    "winding.resistance": 0.133,
    "winding.inductance": 0.82e-3,
    "current_loop.current_limit": 42.0,
    "linkage.ratio": 0.58,
    "linkage.stiffness": 96.7e3,
    "linkage.damping": 127.0,
    "column.inertia": 0.0056,
    "column.base_arm": 0.0589,
}
YOKE = ff.loader.electric("desktop-yoke").replace(DESK, si=True)
"""A heavy rotor on a soft link, whose column is thrown through 0.9 by how slowly the voltage lets the current rise: 25 A/ms."""
FINE = 0.02
"""Relative; a swing is cut into moments, and the first after the fall is told."""
EXACT = 1e-8
"""Of the integrator."""


def falls_through(loader, command):
    """When the column of a loader falls through the level, its drive given a share of the largest command at each time."""
    g = loader.__getitem__
    lever = g("linkage.ratio") * g("column.base_arm")
    held, delay = g("feel.maximum_stiffness") * ANGLE, g("controller.delay") + g("controller.period")
    force = held / lever

    def link(column, rate, end, end_rate):
        return g("linkage.stiffness") * (lever * column - end) + g("linkage.damping") * (lever * rate - end_rate)

    def valve(t, state):
        column, rate, piston, pressure, flow, flow_rate = state
        w, asked = g("valve.natural_frequency"), command(t - delay) * g("amplifier.current_limit") if t > delay else 0.0
        gain = g("valve.rated_flow") / g("valve.rated_current")
        jerk = w**2 * (gain * asked - flow) - 2 * g("valve.damping_ratio") * w * flow_rate
        # The piston has no mass: F = p A, and its speed is what the link's damper then asks for.
        speed = lever * rate - (pressure * g("actuator.area") - g("linkage.stiffness") * (lever * column - piston)) / g(
            "linkage.damping"
        )
        through = min(flow, g("valve.flow_limit")) * np.sqrt(1 + pressure / g("valve.supply_pressure"))
        oil = 4 * g("actuator.bulk_modulus") / g("actuator.oil_volume")
        rates = -pressure * g("actuator.area") * lever / g("column.inertia"), speed
        return [rate, rates[0], rates[1], oil * (g("actuator.area") * speed - through), flow_rate, jerk]

    def motor(t, state):
        column, rate, end, end_rate, current = state
        per_ampere = g("motor.torque_constant") / g("transmission.travel")
        mass = g("motor.inertia") / g("transmission.travel") ** 2
        most = g("current_loop.current_limit")
        asked = command(t - delay) * most if t > delay else -force / per_ampere
        pulls = link(column, rate, end, end_rate)
        moves = (per_ampere * current + pulls) / mass
        lag = g("current_loop.bandwidth") * (asked - current)
        return [rate, -lever * pulls / g("column.inertia"), end_rate, moves, lag]

    end = lever * ANGLE - force / g("linkage.stiffness")
    electric = loader.drive == "electric"
    per_ampere = g("motor.torque_constant") / g("transmission.travel") if electric else 1.0
    rest = [0.0, -force / per_ampere] if electric else [force / g("actuator.area"), 0.0, 0.0]

    def through(t, state):
        return state[0] - LEVEL * ANGLE

    through.terminal = True
    swing = 2 * np.pi * np.sqrt(g("column.inertia") / g("linkage.stiffness")) / lever
    start = [ANGLE, 0.0, end, *rest]
    found = solve_ivp(
        motor if electric else valve, (0, swing), start, "LSODA", events=through, rtol=EXACT, atol=EXACT * ANGLE
    )
    return found.t_events[0][0] if len(found.t_events[0]) else np.inf


@pytest.mark.parametrize("loader", [SOFT, MOTOR])
def test_no_command_holds_column_beyond_fall_time(loader):
    (latest,) = falls_through_s(loader, ANGLE, np.array([loader["feel.maximum_stiffness"]]), LEVEL)
    assert falls_through(loader, lambda t: 1.0) <= latest * (1 + FINE) < np.inf
    random = np.random.default_rng(1)
    for _ in range(5):
        pieces = random.uniform(-1, 1, 8)
        assert falls_through(loader, lambda t, pieces=pieces: pieces[min(int(t / 2e-3), 7)]) <= latest * (1 + FINE)


def test_motor_fall_time_is_exact():
    (latest,) = falls_through_s(MOTOR, ANGLE, np.array([MOTOR["feel.maximum_stiffness"]]), LEVEL)
    assert np.isfinite(latest)
    assert falls_through(MOTOR, lambda t: 1.0) == pytest.approx(latest, rel=FINE)


def test_valve_fall_time_is_exact():
    """The spool's rise and the load's help are all in it."""
    (latest,) = falls_through_s(SOFT, ANGLE, np.array([SOFT["feel.maximum_stiffness"]]), LEVEL)
    assert falls_through(SOFT, lambda t: 1.0) == pytest.approx(latest, rel=FINE)


def test_fall_time_of_stiff_link_or_unknown_loader_is_infinite():
    stiffness = np.array([SOFT["feel.maximum_stiffness"]])
    assert np.isinf(falls_through_s(ff.digital_elevator(), ANGLE, stiffness / 10, LEVEL)).all()
    unknown = SOFT.replace({"linkage.backlash": "0.01 in"}), SOFT.replace({"valve.orifice": False})
    assert np.isfinite(falls_through_s(SOFT, ANGLE, stiffness, LEVEL)).all()
    assert np.isinf([falls_through_s(one, ANGLE, stiffness, LEVEL) for one in unknown]).all()


def highest(loader, until, volts):
    """Where any commands within the limits can have the column at a time, as a share of the angle: a linear program.

    Over commands that stay through a period each, of ``J theta'' = -T``, ``J_r x'' = K i + T``, ``i' = w (e - i)`` with
    ``T = k (theta - x) + D (theta' - x')``, ``|e| <= i_max`` and ``|R i + K_e omega + w L (e - i)| <= u_max``, all at the column.
    """
    g = loader.__getitem__
    lever = g("linkage.ratio") * g("column.base_arm")
    k, damping, w = g("linkage.stiffness") * lever**2, g("linkage.damping") * lever**2, g("current_loop.bandwidth")
    turns = lever / g("transmission.travel")
    rotor, per_ampere = g("motor.inertia") * turns**2, g("motor.torque_constant") * turns
    pull = np.array([k, damping, -k, -damping, 0.0])
    matrix = np.zeros((6, 6))
    matrix[0, 1] = matrix[2, 3] = 1.0
    matrix[1, :5], matrix[3, :5] = -pull / g("column.inertia"), pull / rotor
    matrix[3, 4], matrix[4, 4:] = per_ampere / rotor, [-w, w]
    gain = w * g("winding.inductance")
    voltage = np.array([0, 0, 0, per_ampere / 1.5, g("winding.resistance") - gain, gain])
    period, parts = g("controller.period"), 8
    step = expm(matrix * period / parts)
    held = -g("feel.maximum_stiffness") * ANGLE
    commands = round(until / period)
    unseen = round((g("controller.delay") + period) / period)
    # Each row: the state without commands, and what each command adds to it.
    state = np.zeros((6, commands + 1))
    state[:, 0] = [ANGLE, 0, ANGLE + held / k, 0, held / per_ampere, held / per_ampere]
    rows = []
    for number in range(commands):
        if number >= unseen:
            state[5] = 0.0
            state[5, 1 + number] = 1.0
        for _ in range(parts):
            if number >= unseen:
                rows.append(voltage @ state)
            state = step @ state
    limits = np.array(rows)
    above = np.vstack([limits[:, 1:], -limits[:, 1:]]) if volts else None
    room = np.append(*(g("current_loop.voltage_limit") + sign * limits[:, 0] for sign in (-1, 1))) if volts else None
    most = g("current_loop.current_limit")
    found = linprog(-state[0, 1:], A_ub=above, b_ub=room, bounds=[(-most, most)] * commands)
    assert found.status == 0
    return (state[0, 0] - found.fun) / ANGLE


def test_no_command_within_limits_prevents_fall():
    """By what the voltage takes away alone: a linear program over all commands, which knows no law, without it stays above."""
    stiffness, period = np.array([YOKE["feel.maximum_stiffness"]]), YOKE["controller.period"]
    (latest,) = falls_through_s(YOKE, ANGLE, stiffness, LEVEL)
    until = period * np.ceil(latest / period)
    assert highest(YOKE, until, volts=True) < LEVEL <= highest(YOKE, until, volts=False)
    assert np.isinf(falls_through_s(YOKE.replace({"current_loop.voltage_limit": None}), ANGLE, stiffness, LEVEL)).all()
