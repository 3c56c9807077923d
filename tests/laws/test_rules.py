"""What tunes ``robust`` from the loader: what it follows, by how much, and what it does not follow."""

from dataclasses import fields, replace
from math import pi, radians, sqrt

import numpy as np
import pytest
from scipy.linalg import solve_discrete_lyapunov

import forcefeel as ff
from forcefeel.envelope.cases import REFERENCE_ARMS
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.result import UNSTABLE
from forcefeel.envelope.run import compute
from forcefeel.laws.law import Law
from forcefeel.laws.sampled import design, robust_tuning
from forcefeel.laws.sampled.plant import SampledPlant
from forcefeel.laws.sampled.rules import Units
from forcefeel.laws.sampled.sampled_law import SAMPLED
from forcefeel.laws.sampled.tuning import Power, Tuning
from forcefeel.loader.arms import ARM_ROWS, ARMS, Arm
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.known import machine_rows
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.sensors import sample_variance
from forcefeel.loader.tolerances import Distribution, Tolerance
from forcefeel.loops import sampled_loops

FEEL = [[6.8, 34.3, 1085.0]]
SAME = 1e-6
"""Relative; the Riccati equations are solved in units of other size."""

LIGHT = [[0.05, 0.05, 2.0]]
UNHEARD = 0.01
"""Of what the feel hears of the load cell otherwise."""
HALF = 0.5
"""Of eight light feels."""

WHEELS = "elevator-electric", "aileron-wheel", "rudder-pedals", "desktop-yoke"

FRICTION = "column.coulomb_friction"
AS_QUIET = 0.2
"""The power -3/2 holds of a filter that is fast beside the plant."""
RENDERED = 0.8
"""Of eight settings, at most."""

CLOSE = 0.1
"""Decades; the declared ones are rounded to what a data sheet says."""


@pytest.fixture(scope="module")
def loader() -> ff.Loader:
    return ff.digital_elevator()


@pytest.fixture(scope="module")
def motor() -> ff.Loader:
    return ff.loader.electric("aileron-wheel")


def test_law_ignores_pressure_and_current_absent_from_its_plant(loader: ff.Loader) -> None:
    other = loader.replace(
        {"valve.supply_pressure": 2 * loader["valve.supply_pressure"], "valve.rated_current": "20 mA"}, si=True
    )
    one, two = (ff.laws.law_design("robust").design(each, FEEL) for each in (loader, other))
    of_samples = slice(one.states, None)
    np.testing.assert_allclose(two.command[:, of_samples], one.command[:, of_samples], rtol=SAME)
    np.testing.assert_allclose(two.torque[:, of_samples], one.torque[:, of_samples], rtol=SAME, atol=SAME)


def test_hundredfold_noise_raises_the_tuning_by_one_decade(loader: ff.Loader) -> None:
    keys = ("column_sensor.noise", "column_sensor.resolution")
    noisy = loader.replace({key: 100 * loader[key] for key in keys}, si=True)
    before, after = robust_tuning(loader), robust_tuning(noisy)
    assert after.angle_noise.decades - before.angle_noise.decades == pytest.approx(1.0)
    assert after.pressure_noise == before.pressure_noise


def test_sensor_without_noise_uses_the_default_noise(loader: ff.Loader) -> None:
    silent = loader.replace(
        {f"{sensor}.{row}": None for sensor in ("load_cell", "column_sensor") for row in ("noise", "resolution")}
    )
    for name in ("angle_noise", "pressure_noise"):
        found, declared = (getattr(robust_tuning(each), name).decades for each in (silent, loader))
        assert abs(found - declared) < CLOSE


def test_tuning_units_are_lag_and_column_torque(loader: ff.Loader) -> None:
    """In SI units, by hand: 2 * 0.9 / 377 rad/s and 0.75 ms of delay and hold."""
    lag = 2 * 0.9 / 377 + 0.5e-3 + 0.25e-3
    found, force = Units.of(loader), loader["actuator.area"] * loader["valve.supply_pressure"]
    torque = loader["linkage.ratio"] * loader["column.base_arm"] * force
    assert found.torque == pytest.approx(loader["column.inertia"] / lag**2 / torque)
    assert found.time**2 * found.torque == pytest.approx(1.0)


def known(motor: ff.Loader, share: float) -> ff.Loader:
    """Each parameter may be less by so much."""
    lows = {key: (1 - share) * motor[key] for key in machine_rows(motor)}
    return motor.with_tolerances({key: Tolerance(Distribution.UNIFORM, low, motor[key]) for key, low in lows.items()})


def test_quick_valve_with_slow_sensors_is_stable(loader: ff.Loader) -> None:
    """With little flow noise, the lag of the load cell moved the filter's pole near -1 out of the unit circle."""
    faster = {"valve.natural_frequency": 1.2, "actuator.area": 1.18, "actuator.oil_volume": 0.74}
    slow = dict.fromkeys(
        (f"{sensor}.bandwidth" for sensor in ("load_cell", "potentiometer", "column_sensor")), "500 Hz"
    )
    quick = loader.replace({key: factor * loader[key] for key, factor in faster.items()}, si=True).replace(slow)
    loops = sampled_loops(quick, "robust")
    assert loops.stable.all()
    assert loops.poles.real.min() > -0.8  # measured: -0.76; -1.001 before


def test_known_motor_needs_no_load_cell(motor: ff.Loader) -> None:
    """Ten times its noise then hardly moves the command; of a motor known to 20 % the law is the one without tolerances."""
    exact, usual = known(motor, 0.01), known(motor, 0.2)
    assert robust_tuning(usual) == robust_tuning(motor.with_tolerances(dict.fromkeys(motor.tolerances)))
    gains = []
    for one in (exact, usual):
        law = ff.laws.law_design("robust").design(one, LIGHT)
        cell = law.states
        gains.append(abs(float(law.torque[0, cell])))
    assert gains[0] < UNHEARD * gains[1]


def test_tuning_is_log_linear_between_tolerances(motor: ff.Loader) -> None:
    at = [robust_tuning(known(motor, share)).pressure_noise.decades for share in (0.01, sqrt(0.01 * 0.2), 0.2)]
    assert at[1] == pytest.approx((at[0] + at[2]) / 2)
    assert robust_tuning(known(motor, 0.001)) == robust_tuning(known(motor, 0.005))


@pytest.mark.parametrize(
    "row", [{"column.coulomb_friction": "1 N"}, {"load_cell.bandwidth": "500 Hz"}, {"grip_sensor.gain": 1.0}]
)
def test_nonlinear_row_makes_the_loader_less_known(motor: ff.Loader, row: dict) -> None:
    usual = known(motor, 0.2).replace(row, si=True)
    assert robust_tuning(known(motor, 0.01).replace(row, si=True)) == robust_tuning(usual)


def test_single_unknown_parameter_counts_as_unknown(motor: ff.Loader) -> None:
    rest = known(motor, 0.01).with_tolerances({"motor.inertia": None})
    assert robust_tuning(rest) == robust_tuning(known(motor, 0.2))


def test_known_motor_renders_light_feels_below_load_cell_noise(motor: ff.Loader) -> None:
    """Of an aileron's wheel from 2 deg."""
    grid = {"stiffness": "1, 3 %", "frequency": "1, 4 Hz", "damping": "0.1, 1.5"}
    shares = []
    for one in (known(motor, 0.01), known(motor, 0.2)):
        plan = make_plan(one, ["robust"], grid, changes={}, arms=(), angle_rad=radians(2))
        shares.append(compute(plan).shares("robust").nominal_share)
    assert shares[0] == 1.0
    assert shares[1] <= HALF


@pytest.mark.parametrize("name", WHEELS)
def test_motor_holds_still_under_every_arm_at_a_light_feel(name: str) -> None:
    """The gain ``K`` of the arm's loop is two; without the exponents ``arm`` the firm arm swings at 50 to 160 Hz."""
    motor, arms = ff.loader.electric(name), (*(ARMS[arm] for arm in (Arm.LOOSE, Arm.FIRM)), (0.8, 5.5, 30.0))
    column, held = motor["column.inertia"], ARMS[Arm.FIRM][0] * motor["column.grip_arm"] ** 2
    inertia = column / (1 + 2 * (column + held) / held)
    feel = np.array([[inertia, 0.4 * 2 * pi * inertia, (2 * pi) ** 2 * inertia]])  # 1 Hz, damping ratio 0.2
    tuning = robust_tuning(motor)
    numbers = {row.name: getattr(tuning, row.name) for row in fields(tuning) if getattr(tuning, row.name) is not None}
    without = replace(tuning, **{key: replace(power, arm=0.0) for key, power in numbers.items()})
    for numbers_, stable in ((tuning, True), (without, False)):
        law = Law.of(design(motor, feel, numbers_), motor, feel)
        rows = motor.rows((*FEEL_SETTING, *ARM_ROWS), np.hstack([np.tile(feel, (3, 1)), np.array(arms)]))
        loops = sampled_loops(motor, law.some(np.zeros(3, dtype=int)), rows)
        assert loops.stable.all() == stable


def test_agile_law_of_a_known_stick_bears_a_firm_arm_where_robust_swings() -> None:
    stick = known(ff.loader.electric("sidestick-pitch"), 0.01)
    grid = {"stiffness": "30, 100 %", "frequency": "1, 4 Hz", "damping": "0.4, 1.2"}
    firm = [arm for arm in REFERENCE_ARMS if arm.name == Arm.FIRM]
    found = compute(make_plan(stick, ["robust", "agile"], grid, changes={}, arms=firm))
    stable = {law: (found.codes(law)[-1] != found.outcomes.index(UNSTABLE)).mean() for law in found.laws}
    assert stable["agile"] == 1.0
    assert stable["robust"] <= HALF


def test_arm_gain_is_that_of_the_loop_which_a_firm_arm_closes(motor: ff.Loader) -> None:
    """Column and arm under ``F T_p``, ``F`` one: the ratio of what acts through the filter to what acts without."""
    plant, ratio = SampledPlant.of(motor), 0.4
    column, held = motor["column.inertia"], 3.0 * motor["column.grip_arm"] ** 2
    # (J + m) s^2 theta = (J / I - 1) F T_p,  T_p = -m s^2 theta
    assert plant.arm_gain(ratio) == pytest.approx((1 / ratio - 1) * held / (column + held))
    assert plant.arm_gain(1.5) == 0.0
    assert Power(-1.0, arm=-2.0).at(1.0, arm_gain=3.0) == pytest.approx(0.1 / 16)


def test_tuning_depends_on_link_stretch() -> None:
    """Of a motor the command counts more with it, of a valve less and the rate more."""
    stretched = 1 + 20 * 0.25
    for throw in (1.0, -0.7):
        weight = Power(-1.0, throw=throw)
        assert weight.at(1.0, 0.5) == pytest.approx(0.1 * stretched**throw)
        assert weight.at(1.0) == pytest.approx(0.1)
    with pytest.raises(ff.InputError, match="throw: expected a number from -20 to 20"):
        Power(0.0, throw=np.inf)


def test_robust_law_recovers_a_column_thrown_by_its_link(loader: ff.Loader) -> None:
    """From 2 deg, with a slow valve; with weights that knew nothing of the link a third of these was felt too short."""
    keys = {"linkage.stiffness": 1 / 6, "valve.natural_frequency": 0.3}
    soft = loader.replace({key: share * loader[key] for key, share in keys.items()}, si=True)
    grid = {"stiffness": "80, 100 %", "frequency": "0.5, 1, 2 Hz", "damping": "0.1, 0.4"}
    plan = make_plan(soft, ["robust"], grid, changes={}, arms=(), angle_rad=radians(2))
    assert compute(plan).shares("robust").nominal_share == 1.0


def test_robust_law_renders_with_a_20_bit_encoder(loader: ff.Loader) -> None:
    """With weights of another encoder it was half of these, and none from 2 deg at the lowest stiffness."""
    step = f"{360 / 2**20} deg"
    coarse = loader.replace({"column_sensor.noise": step, "column_sensor.resolution": step}, si=True)
    grid = {"stiffness": "1..100 %:4:log", "frequency": "1, 4 Hz", "damping": "0.1, 0.7"}
    plan = make_plan(coarse, ["robust"], grid, changes={}, arms=())
    assert compute(plan).shares("robust").nominal_share >= 15 / 16


def rate_noise(loader: ff.Loader, tuning: Tuning) -> float:
    """R.m.s. in rad/s of the estimated rate from the sensors' noise: ``P = A P A' + B R B'``, of a law that gives friction back."""
    law = design(loader, FEEL, tuning)
    noise = np.diag(sample_variance(loader) * (1.0, 0.0, 1.0))
    by_sensors = law.input[0, :, :SAMPLED]
    of_state = solve_discrete_lyapunov(law.transition[0], by_sensors @ noise @ by_sensors.T)
    row = law.friction[0]
    of_xi, of_y = row[: law.states], row[law.states : law.states + SAMPLED]
    return float(np.sqrt(of_xi @ of_state @ of_xi + of_y @ noise @ of_y))


def with_encoder(loader: ff.Loader, bits: int) -> ff.Loader:
    return loader.replace(dict.fromkeys(("column_sensor.noise", "column_sensor.resolution"), 2 * pi / 2**bits), si=True)


def test_friction_rate_noise_does_not_grow_with_a_coarse_encoder(loader: ff.Loader) -> None:
    rubbing = loader.replace({FRICTION: "2 lb"})
    quiet = rate_noise(with_encoder(rubbing, 21), robust_tuning(with_encoder(loader, 21)))
    for bits in (17, 19):
        coarse = with_encoder(rubbing, bits)
        assert rate_noise(coarse, robust_tuning(coarse)) == pytest.approx(quiet, rel=AS_QUIET)
        assert rate_noise(coarse, robust_tuning(with_encoder(loader, bits))) > 2 * quiet


def test_slower_rate_estimate_renders_feels_lost_to_noise(loader: ff.Loader) -> None:
    coarse = with_encoder(loader, 18).replace({FRICTION: "2.5 lb"}).with_tolerances({FRICTION: "1 %"})
    laws = {"slower": robust_tuning(coarse), "as without friction": robust_tuning(with_encoder(loader, 18))}
    grid = {"stiffness": "2.5, 5 %", "frequency": "1, 3 Hz", "damping": "0.2, 1"}
    tuned = {name: ff.laws.tuned(name, "", one) for name, one in laws.items()}
    found = compute(make_plan(coarse, tuned, grid, changes={}, arms=()))
    slower, other = (found.shares(name).nominal_share for name in laws)
    assert slower == 1.0
    assert other <= RENDERED


@pytest.mark.parametrize(
    ("name", "shifts"), [("elevator-2khz", {"torque_walk", "disturbance_walk"}), ("aileron-wheel", {"angle_noise"})]
)
def test_friction_makes_the_filter_calmer_whatever_its_size(name: str, shifts: set[str]) -> None:
    """With an encoder of 21 bits and more by a constant; with a grip sensor, whose law gives none back, not at all."""
    loader = BUILT_IN[name]()
    without, little, much = (robust_tuning(loader.replace({FRICTION: force})) for force in ("0 lb", "0.1 lb", "2 lb"))
    assert little == much
    changed = {row.name for row in fields(much) if getattr(much, row.name) != getattr(without, row.name)}
    assert changed == shifts
    calmer = {"torque_walk": -1, "disturbance_walk": -1, "angle_noise": 1}
    assert all(calmer[row] * (getattr(much, row).decades - getattr(without, row).decades) > 0 for row in shifts)
    at_grip = loader.replace({"grip_sensor.gain": 1.0})
    assert robust_tuning(at_grip.replace({FRICTION: "2 lb"})) == robust_tuning(at_grip)
