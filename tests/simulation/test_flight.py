"""A loader with a surface in flight, against the equation of control and hinge moment by an integrator of its own."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import forcefeel as ff
from forcefeel.loader.built_in import BUILT_IN
from tests.parametrization import mostly_slow

SURFACE = {
    "surface.area": 1.0,
    "surface.chord": 0.4,
    "surface.gearing": 1.3,
    "surface.per_deflection": -0.3,
    "surface.per_flow": -0.08,
    "surface.per_tab": -0.1,
    "surface.per_rate": -2.0,
    "surface.flow_per_attack": 0.6,
    "surface.pitch_arm": 4.0,
    "surface.bobweight": 12.0,
}
TIMES = np.array([0.0, 1.0, 4.0])
STATES = {
    "dynamic_pressure": np.array([800.0, 1500.0, 2500.0]),
    "true_airspeed": np.array([36.0, 50.0, 64.0]),
    "angle_of_attack": np.array([0.1, 0.06, 0.02]),
    "pitch_rate": np.array([0.0, 0.1, -0.1]),
    "load_factor": np.array([1.0, 1.4, 0.8]),
    "tab": np.array([0.0, 0.1, 0.1]),
}
MACH = np.array([0.3, 0.6, 0.9])
FOLLOWS_RAD = 2.5e-3
"""What the column is behind the programmed control at 1 rad/s: two milliseconds and their ripple."""
RESTS_RAD = 1e-4
"""What steps and noise of the sensors leave once it is slow."""


def alone(loader, release, table=lambda _: (1.0, 1.0, 1.0), of_angle=lambda delta: -0.3 * delta):
    """Angle of the programmed control over time: ``I theta'' + B theta' + G theta = k q S c C_h - R_p W n``."""
    inertia, damping, stiffness, arm = (
        loader[key] for key in ("feel.inertia", "feel.damping", "feel.stiffness", "column.grip_arm")
    )

    def motion(t, state):
        theta, rate = state
        now = {name: np.interp(t, TIMES, column) for name, column in {**STATES, "mach": MACH}.items()}
        flow = 0.6 * now["angle_of_attack"] + 4.0 * now["pitch_rate"] / now["true_airspeed"]
        of_flow, of_deflection, of_tab = table(now.get("mach", 0.0))
        coefficient = of_deflection * of_angle(1.3 * theta) - 0.08 * of_flow * flow - 0.1 * of_tab * now["tab"]
        coefficient += -2.0 * 1.3 * rate * 0.4 / (2 * now["true_airspeed"])
        torque = 1.3 * now["dynamic_pressure"] * 1.0 * 0.4 * coefficient - arm * 12.0 * now["load_factor"]
        return rate, (torque - damping * rate - stiffness * theta) / inertia

    sampled = np.arange(4001) * 1e-3
    tolerances = {"rtol": 1e-9, "atol": 1e-12}  # far below what the column is off
    return solve_ivp(motion, (0, 4), (release, 0.0), t_eval=sampled, max_step=0.01, **tolerances).y[0]


@pytest.mark.parametrize("name", mostly_slow(["elevator-2khz", "elevator-electric"]))
def test_column_with_a_surface_follows_hinge_moment_in_flight(name):
    loader = BUILT_IN[name]().replace(SURFACE, si=True)
    flight = ff.simulation.Flight(TIMES, STATES)
    scenario = ff.Scenario(ff.Release(0.08), duration_s=4.0, flight=flight)
    run = ff.simulate(loader, scenario, "robust")
    off = run.history["column_angle_rad"].to_numpy() - alone(loader, 0.08)
    assert np.abs(off).max() < FOLLOWS_RAD
    assert np.abs(off[2500:]).max() < RESTS_RAD
    still = ff.simulate(loader, ff.Scenario(ff.Release(0.08), duration_s=4.0), "robust").history["column_angle_rad"]
    assert np.abs(still.to_numpy() - alone(loader, 0.08)).max() > 9 * FOLLOWS_RAD, "the flight matters"


@pytest.mark.slow
def test_coefficients_follow_the_table_over_mach():
    rows = {"mach_1": 0.4, "flow_factor_1": 0.5, "deflection_factor_1": 1.5, "tab_factor_1": 3.0}
    rows |= {"mach_2": 0.8, "flow_factor_2": 4.0, "deflection_factor_2": 2.5, "tab_factor_2": -2.0}
    loader = ff.digital_elevator().replace(SURFACE | {f"surface.{key}": value for key, value in rows.items()}, si=True)

    def table(mach):
        columns = ((1, 0.5, 4.0), (1, 1.5, 2.5), (1, 3.0, -2.0))
        return tuple(np.interp(mach, (0, 0.4, 0.8), column) for column in columns)

    flight = ff.simulation.Flight(TIMES, {**STATES, "mach": MACH})
    run = ff.simulate(loader, ff.Scenario(ff.Release(0.08), duration_s=4.0, flight=flight), "robust")
    off = run.history["column_angle_rad"].to_numpy() - alone(loader, 0.08, table)
    assert np.abs(off).max() < FOLLOWS_RAD
    assert np.abs(off[2500:]).max() < RESTS_RAD
    assert np.abs(off + alone(loader, 0.08, table) - alone(loader, 0.08)).max() > 5 * FOLLOWS_RAD, "the table matters"


ANGLES = (-0.2, -0.06, -0.03, 0.0, 0.03, 0.06, 0.2)
COEFFICIENTS = (0.2, 0.018, 0.004, -0.002, -0.006, -0.02, -0.26)
TABLE = {f"surface.deflection_{k}": angle for k, angle in enumerate(ANGLES, 1)}
TABLE |= {f"surface.coefficient_{k}": coefficient for k, coefficient in enumerate(COEFFICIENTS, 1)}


@pytest.mark.parametrize("name", mostly_slow(["elevator-electric", "elevator-2khz"]))
def test_column_follows_a_hinge_moment_that_steepens_with_the_angle(name):
    loader = BUILT_IN[name]().replace(SURFACE | TABLE | {"surface.per_deflection": None}, si=True)
    assert max(ANGLES) > 1.3 * 0.08, "the table is as wide as the motion"
    must = alone(loader, 0.08, of_angle=lambda delta: np.interp(delta, ANGLES, COEFFICIENTS))
    scenario = ff.Scenario(ff.Release(0.08), duration_s=4.0, flight=ff.simulation.Flight(TIMES, STATES))
    off = ff.simulate(loader, scenario, "robust").history["column_angle_rad"].to_numpy() - must
    assert np.abs(off).max() < FOLLOWS_RAD
    assert np.abs(off[2500:]).max() < RESTS_RAD
    straight = np.abs(must - alone(loader, 0.08))
    assert straight.max() > 3 * FOLLOWS_RAD, "the table matters"
    assert straight[2500:].max() > 30 * RESTS_RAD, "and at rest"


@pytest.mark.parametrize(
    ("changes", "part"),
    [
        (TABLE, "surface.per_deflection: stands beside a table over the same angle, from surface.deflection_1 on"),
        (
            {"surface.deflection_1": -0.1, "surface.deflection_2": 0.1, "surface.coefficient_2": 0.1},
            "surface.deflection_1: has no effect without surface.coefficient_1",
        ),
        ({"surface.coefficient_2": 0.1}, "surface.coefficient_2: has no effect without surface.deflection_2"),
        (TABLE | {"surface.deflection_4": -0.1}, "surface.deflection_3: expected less than surface.deflection_4"),
        ({"surface.deflection_1": 0.1, "surface.coefficient_1": 0.0}, "has no effect without surface.deflection_2"),
    ],
)
def test_bad_table_over_the_angle_is_named(changes, part):
    with pytest.raises(ff.InputError, match=part):
        ff.digital_elevator().replace(SURFACE | changes, si=True)


def test_runs_side_by_side_have_each_the_hinge_moment_of_its_own_surface():
    loader = ff.digital_elevator().replace(SURFACE, si=True)
    flight = ff.simulation.Flight(TIMES, STATES)
    scenario = ff.Scenario(ff.Release(0.08), duration_s=1.0, flight=flight)
    other = loader.replace({"surface.area": 2.0}, si=True)
    values = np.array([loader.si_values, other.si_values])
    together = ff.simulation.simulate_batch(
        loader, scenario, values, "robust", keep=["column_angle_rad"], first_run=None
    )
    for run, each in enumerate((loader, other)):
        single = ff.simulate(each, scenario, ff.Law.of("robust", loader)).history["column_angle_rad"]
        assert np.array_equal(together["column_angle_rad"][run], single)


@pytest.mark.parametrize(
    ("changes", "part"),
    [
        ({"mach_1": 0.9, "mach_2": 0.8}, "surface.mach_1: expected less than surface.mach_2"),
        ({"mach_2": 0.8}, "surface.mach_1: expected less than surface.mach_2"),
        ({"deflection_factor_3": 2.0}, "surface.deflection_factor_3: has no effect without surface.mach_3"),
        ({"mach_1": -1.0}, "surface.mach_1: expected 0.001 to 10, got -1"),
    ],
)
def test_bad_table_over_mach_is_named(changes, part):
    with pytest.raises(ff.InputError, match=part):
        ff.digital_elevator().replace(SURFACE | {f"surface.{key}": value for key, value in changes.items()}, si=True)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("0,1500,50", "expected two rows of numbers at least, got 1"),
        ("0,1500,50\n1,1500,50", "expected a flight of all the run, 0 s to 2 s, got 0 s to 1 s"),
        ("0,1500,50\n1,nan,50\n2,1500,50", "dynamic_pressure"),
        ("0,1500,50\n0,1500,50\n2,1500,50", "time"),
    ],
)
def test_bad_flight_is_named(forcefeel, rows, message):
    Path("flight.csv").write_text(f"time (s),dynamic pressure (Pa),true airspeed (m/s)\n{rows}\n", encoding="utf-8")
    surface = [word for key, value in SURFACE.items() for word in ("--set", f"{key}={value}{_UNITS.get(key, '')}")]
    status, out, err = forcefeel("simulate", "elevator-2khz", "--law", "robust", "--flight", "flight.csv", *surface)
    assert (status, out) == (2, "")
    assert message in err


_UNITS = {
    "surface.area": " m^2",
    "surface.chord": " m",
    "surface.pitch_arm": " m",
    "surface.bobweight": " N",
    "surface.per_deflection": " 1/rad",
    "surface.per_flow": " 1/rad",
    "surface.per_tab": " 1/rad",
    "surface.per_rate": " 1/rad",
}


def test_flight_without_a_surface_or_without_units_is_refused(forcefeel):
    Path("flight.csv").write_text(
        "time (s),dynamic pressure (Pa),true airspeed (kt)\n0,1500,97\n9,1500,97\n", encoding="utf-8"
    )
    status, out, err = forcefeel("simulate", "elevator-2khz", "--law", "robust", "--flight", "flight.csv")
    assert (status, out) == (2, "")
    assert "the loader has no surface" in err
    Path("flight.csv").write_text(
        "time (s),dynamic pressure,true airspeed (kt)\n0,1500,97\n9,1500,97\n", encoding="utf-8"
    )
    status, out, err = forcefeel("simulate", "elevator-2khz", "--law", "robust", "--flight", "flight.csv")
    assert (status, out) == (2, "")
    assert "dynamic_pressure" in err
    with pytest.raises(ff.InputError, match="expected names out of dynamic_pressure"):
        ff.simulation.Flight(TIMES, {"altitude": TIMES})
    with pytest.raises(ff.InputError, match="columns of one length"):
        ff.simulation.Flight(TIMES, {"mach": TIMES[1:]})
