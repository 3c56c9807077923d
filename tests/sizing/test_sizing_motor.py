"""Motor and valve at the grip: against runs of the engine, against the equations of the heat, and by closed forms."""

from math import inf, isnan

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel.sizing.demand import programmed_force
from forcefeel.sizing.motor import HEAT, Motor
from forcefeel.sizing.valve import Valve

ENGINE = 1e-2  # relative; an equilibrium beside the end of a run
ROUNDING = 1e-9  # relative
FINE = {"rtol": 1e-10, "atol": 1e-9}  # K; beside which the comparison is coarse
INTEGRATED = 1e-5  # relative; of a fine integration
_SENSORS = [
    f"{one}.{row}" for one in ("load_cell", "potentiometer", "column_sensor") for row in ("noise", "resolution")
]
ELECTRIC = ff.loader.electric("elevator-electric").replace(dict.fromkeys(_SENSORS))
STEP_S = 1e-4
"""Fine beside the lag of the current loop, 0.16 ms."""
LOSSY = ELECTRIC.replace(
    {
        "motor.coulomb_friction": "0.1 N m",
        "motor.viscous_friction": "0.002 N m s/rad",
        "transmission.efficiency": "0.9",
        "transmission.backdriving_efficiency": "0.8",
    }
)


def _held(loader: ff.Loader) -> dict[str, float]:
    """Where a loader stands under a force of 100 N."""
    scenario = ff.Scenario(ff.Step(100.0), duration_s=3.0, step_s=STEP_S, sample_s=0.01)
    end = ff.simulate(loader, scenario, "observer").history.isel(time_s=-1)
    return {str(name): float(value) for name, value in end.items()}


def test_holding_demand_matches_settled_run():
    end = _held(ELECTRIC)
    needs = Motor(ELECTRIC).needs(np.array([100.0]), np.zeros(1), held=True)
    assert needs.current_a == pytest.approx(-end["motor_current_a"], rel=ENGINE)
    assert needs.voltage_v == pytest.approx(-end["motor_voltage_v"], rel=ENGINE)


def test_programmed_force_matches_settled_run():
    """With breakout and deadband: the force at the grip that belongs to the angle where the column stands."""
    loader = ELECTRIC.replace({"feel.breakout": "20 N", "feel.deadband": "0.5 deg"})
    assert programmed_force(loader, _held(loader)["column_angle_rad"]) == pytest.approx(100.0, rel=ENGINE)


def test_speed_demand_matches_simulated_run():
    """Of a release with viscous friction, where the speed is largest: nothing is accelerated there; the winding's lag is known."""
    loader = ELECTRIC.replace({"motor.viscous_friction": "0.02 N m s/rad"})
    motor, history = (
        Motor(loader),
        ff.simulate(loader, ff.Scenario(ff.Release(0.1), 0.4, STEP_S, STEP_S), "observer").history,
    )
    current = history.motor_current_a.to_numpy()
    lag = loader["winding.inductance"] * np.gradient(current, history.time_s.to_numpy())
    turns = history.motor_speed_rad_per_s.to_numpy()
    at = [int(np.abs(turns).argmax())]
    force, speed = motor.statics.per_grip * history.load_cell_force_n.to_numpy()[at], turns[at] / motor.statics.gear
    torque = motor.torque(force, speed)
    assert abs(torque[0]) > 2 * abs(force[0] / motor.statics.gear), "friction takes most of it"
    assert current[at] * loader["motor.torque_constant"] == pytest.approx(torque, rel=ENGINE)
    assert history.motor_voltage_v.to_numpy()[at] - lag[at] == pytest.approx(
        motor.voltage(current[at], speed), rel=ENGINE
    )


@pytest.mark.parametrize("current", [4.0, 5.5, 12.0])
def test_winding_temperature_matches_thermal_equations(current):
    """``C_w T_w' = P - (T_w - T_h) / R_wh``, ``C_h T_h' = (T_w - T_h) / R_wh - T_h / R_ha``, by an integrator."""
    motor, row = Motor(ELECTRIC), ELECTRIC
    hot = row["winding.temperature_coefficient"]

    def rates(_: float, state: np.ndarray) -> list[float]:
        winding, housing = state
        power = 1.5 * row["winding.resistance"] * (1 + hot * winding) * current**2
        inner = (winding - housing) / row["thermal.winding_resistance"]
        return [
            (power - inner) / row["thermal.winding_capacity"],
            (inner - housing / row["thermal.housing_resistance"]) / row["thermal.housing_capacity"],
        ]

    def derates(_: float, state: np.ndarray) -> float:
        return float(state[0] - (row["thermal.derating_from"] - row["thermal.ambient"]))

    derates.terminal = True
    found = solve_ivp(rates, (0.0, 1e5), [0.0, 0.0], "LSODA", events=derates, **FINE)
    if found.t_events[0].size:
        assert motor.derates_after_s(current) == pytest.approx(found.t_events[0][0], rel=INTEGRATED)
    else:
        assert motor.derates_after_s(current) == inf
        assert motor.winding_degc(current) == pytest.approx(found.y[0, -1] + row["thermal.ambient"], rel=INTEGRATED)


def test_continuous_current_is_derating_limit():
    motor = Motor(ELECTRIC)
    assert motor.winding_degc(motor.continuous_current_a) == pytest.approx(
        ELECTRIC["thermal.derating_from"], rel=ROUNDING
    )
    assert motor.winding_degc(100.0) == inf  # the resistance grows faster than it cools
    assert (
        0 < motor.derates_after_s(1e3) < motor.derates_after_s(100.0) < 1.0
    )  # s; some hundred times the continuous heat


@pytest.mark.parametrize("loader", [ELECTRIC, LOSSY])
def test_force_and_current_are_inverse(loader):
    """At each point of the curve, the torque of the force is that of the current, and there one limit is reached."""
    motor = Motor(loader)
    speed, force = motor.curve(inf, loader["current_loop.current_limit"])
    inner = slice(None, -1)  # at its end there is no force
    np.testing.assert_allclose(motor.share(force, speed)[inner], 1.0, rtol=ROUNDING)
    assert force[0] == pytest.approx(motor.capability.peak_force_n)
    assert force[-1] == pytest.approx(0.0, abs=ROUNDING * force[0])
    assert speed[-1] == motor.capability.fastest_m_per_s


def test_rotor_mass_at_grip_is_inertia_times_squared_ratio():
    capability = Motor(ELECTRIC).capability
    expected = ELECTRIC["motor.inertia"] * (capability.peak_force_n / capability.peak_torque_n_m) ** 2
    assert capability.added_mass_kg == pytest.approx(expected, rel=ROUNDING)


def test_losses_reduce_demand_of_driving_load():
    motor = Motor(LOSSY)
    force, speed = np.array([100.0, 100.0]), np.array([0.5, -0.5])
    driven, driving = motor.torque(force, speed)
    load, drag = 100.0 / motor.statics.gear, 0.002 * motor.statics.gear * 0.5
    assert driven == pytest.approx(load / 0.9 + 0.1 + drag, rel=ROUNDING)
    assert driving == pytest.approx(load * 0.8 - 0.1 - drag, rel=ROUNDING)


@pytest.mark.parametrize("loader", [ff.elevator(), ff.digital_elevator()])
def test_valve_curve_uses_full_flow(loader):
    """Along the curve the flow at no load that a point takes is all that the spool lets through."""
    valve = Valve(loader)
    speed, force = valve.curve()
    moving = speed > 0
    flow = [
        valve.needs(f, v, held=False).flow_m3_per_s
        for f, v in zip(force[moving, None], speed[moving, None], strict=True)
    ]
    np.testing.assert_allclose(flow, valve.capability.flow_m3_per_s, rtol=ROUNDING)
    assert force[0] == pytest.approx(valve.capability.peak_force_n)
    assert speed[-1] == pytest.approx(valve.capability.fastest_m_per_s)


def test_motor_without_thermal_data_has_no_continuous_force():
    capability = Motor(ELECTRIC.replace(dict.fromkeys([*HEAT, "winding.temperature_coefficient"]))).capability
    assert isnan(capability.continuous_force_n)
    assert capability.peak_force_n == Motor(ELECTRIC).capability.peak_force_n


PEAKED = {"current_loop.continuous_current": "4 A", "current_loop.peak_time": "3 s"}


def test_drive_limits_what_is_held_where_the_winding_lasts_longer():
    """A winding that holds 8 A and more without end, behind a drive that gives 4 A."""
    alone, behind = (Motor(loader) for loader in (ELECTRIC, ELECTRIC.replace(PEAKED)))
    assert alone.capability.continuous_current_a > 4.0
    assert behind.capability.continuous_current_a == pytest.approx(4.0, rel=ROUNDING)
    assert behind.capability.continuous_torque_n_m == pytest.approx(
        4.0 * ELECTRIC["motor.torque_constant"], rel=ROUNDING
    )
    assert behind.capability.peak_force_n == alone.capability.peak_force_n
    assert behind.derates_after_s(3.9) == alone.derates_after_s(3.9) == inf
    assert behind.derates_after_s(4.1) == 3.0
    hot = 1000.0  # A; here the winding is first
    assert behind.derates_after_s(hot) == alone.derates_after_s(hot) < 3.0


def test_holding_beyond_the_drives_continuous_current_is_told():
    current = Motor(ELECTRIC).needs(np.array([ELECTRIC["pilot.force"]]), np.zeros(1), held=True).current_a
    loader = ELECTRIC.replace({**PEAKED, "current_loop.continuous_current": f"{current / 3} A"})
    sizing = ff.sizing.size_drive(loader)
    text = " ".join(ff.sizing.sizing_conclusions(sizing, ff.UnitSystem.SI).findings)
    assert f"The drive gives {current:.3g} A for 3 s, {current / 3:.3g} A continuously: the pilot's force" in text
    held = next(demand for demand in sizing.demands if demand.name == "pilot's force")
    assert held.of_continuous == pytest.approx(3.0, rel=ROUNDING)
    assert held.needs.derates_after_s == 3.0
