"""Overshoot, period and settling of every built-in loader beside its programmed feel alone: within 1 %, or no number.

    I x'' + B x' + G x + T sign(x') = 0,  T = R_p F_c

From an extremum ``a`` on it swings around ``s = T / G`` of the side that it left: ``x = s + (a - s) phi(t)``, with
``phi = exp(-z w t) (cos w_d t + z w / w_d sin w_d t)``, for half a period ``pi / w_d``. So friction leaves the time from one
extremum to the next as it is, and moves the crossings.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy.linalg
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

import forcefeel as ff
from forcefeel._core import GainLaw
from forcefeel.linear.models import Linkage, loader_model
from forcefeel.linear.step import equilibrium
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.sensors import sensors_of
from forcefeel.simulation import Scenario, run_conclusions, simulate, simulate_batch
from forcefeel.simulation.inputs import HandsOff, Release, Step
from forcefeel.simulation.limits_met import why_no_overshoot
from forcefeel.units import UnitSystem
from tests.parametrization import mostly_slow

ONE_PERCENT = 0.01
"""What a number that is shown is good to: readers compare it with the programmed one."""
ROOT_S = 1e-9
"""Of a crossing by halving: far below a thousandth of any period."""
FADED = 1e-6
"""Share of the release below which a swing of the closed form is none."""
BAND = 0.05
"""Of the rules, within which a column has settled."""
NEAR_BAND = 0.1
"""An extremum within this share of the band's edge may lie on either side of it: the settling time jumps by half a swing there."""

SIDESTICKS = ("sidestick-pitch", "sidestick-roll")
"""On the breakout's ramp of 0.1 deg these swing at 10 Hz and more, which their loops follow to some 10 %: here they have none, and
below 5 deg, where a release takes all that the motor gives."""
ANGLE_DEG = dict.fromkeys(SIDESTICKS, 1.0)
FRICTION_SHARE = dict.fromkeys(SIDESTICKS, 0.01)
"""Programmed friction, as a share of the spring's torque at the release, 4 % of the others: a sidestick's overshoot is a tenth of
its way, and its loop renders friction to some hundredths of that."""
DURATIONS_S = [1.0, 1.4, 2.0, 3.3, 5.0, 10.0]
MODES = ["quiet", "noise", "friction", "noise and friction"]
DIGITAL = [name for name, made in BUILT_IN.items() if made()["controller.period"]]


@dataclass(frozen=True)
class Feel:
    """The programmed feel alone, by its closed form."""

    inertia: float
    damping: float
    stiffness: float
    friction: float

    @classmethod
    def of(cls, loader):
        rows = [loader[f"feel.{row}"] for row in ("inertia", "damping", "stiffness")]
        return cls(*rows, loader["column.grip_arm"] * loader["feel.coulomb_friction"])

    @property
    def decay(self):
        return self.damping / (2 * self.inertia)

    @property
    def damped(self):
        return math.sqrt(self.stiffness / self.inertia - self.decay**2)

    def phi(self, time):
        return np.exp(-self.decay * time) * (
            np.cos(self.damped * time) + self.decay / self.damped * np.sin(self.damped * time)
        )

    def swings(self, angle):
        """Extrema half a period apart, the release first, and the instants at which it passes zero."""
        half, held = math.pi / self.damped, self.friction / self.stiffness
        extrema, crossings = [angle], []
        while abs(extrema[-1]) > max(held, FADED * angle):
            last = extrema[-1]
            center = math.copysign(held, last)
            extrema.append(center + (last - center) * self.phi(half))
            if extrema[-1] * last < 0:
                crosses = brentq(lambda t, c=center, a=last: c + (a - c) * self.phi(t), 0.0, half, xtol=ROOT_S)
                crossings.append((len(extrema) - 2) * half + crosses)
        return extrema, crossings


def _angle(name):
    return math.radians(ANGLE_DEG.get(name, 5.0))


def _quiet(loader):
    return loader.replace({f"{sensor}.noise": None for sensor in sensors_of(loader)})


def _loader(name, mode):
    loader = BUILT_IN[name]()
    if name in SIDESTICKS:
        loader = loader.replace({"feel.breakout": None})
    if "noise" not in mode:
        loader = _quiet(loader)
    if "friction" in mode:
        torque = FRICTION_SHARE.get(name, 0.04) * loader["feel.stiffness"] * _angle(name)
        loader = loader.replace({"feel.coulomb_friction": torque / loader["column.grip_arm"]}, si=True)
    return loader


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", DIGITAL)
def test_release_measures_match_feel_within_1_percent_or_are_nan(name, mode):
    loader, angle = _loader(name, mode), _angle(name)
    law, feel = ff.laws.Law.of("robust", loader), Feel.of(loader)
    extrema, crossings = feel.swings(angle)
    overshoots = periods = 0
    for duration_s in DURATIONS_S:
        run = simulate(loader, Scenario(Release(angle), duration_s), law)
        found = run.measures
        assert found.equilibrium_angle_rad == 0.0
        if math.isfinite(found.overshoot):
            overshoots += 1
            assert found.overshoot == pytest.approx(-extrema[1] / angle, rel=ONE_PERCENT), duration_s
        if math.isfinite(found.period_s):
            periods += 1
            cycles = int(found.periods)
            mean = (crossings[2 * cycles] - crossings[0]) / cycles
            assert found.period_s == pytest.approx(mean, rel=ONE_PERCENT), duration_s
            assert found.period_s == pytest.approx(2 * math.pi / feel.damped, rel=ONE_PERCENT), duration_s
    hidden = why_no_overshoot(run) == "the noise of the sensors hides it"
    assert overshoots == (0 if hidden else len(DURATIONS_S))
    if mode == "quiet" and name not in SIDESTICKS:
        assert periods >= len(DURATIONS_S) - 1  # the slowest has not passed three times within 1 s


@pytest.mark.parametrize("duration_s", mostly_slow(DURATIONS_S, 2))
@pytest.mark.parametrize("force", [Release(0.1), Step(300.0)], ids=["release", "step"])
def test_linear_loader_measures_match_exponential_or_are_nan(force, duration_s):
    """The original loop swings as ``exp(A t)`` says, not as its feel: read from a spline through that, twenty times as fine."""
    loader = ff.elevator()
    model = loader_model(loader, GainLaw.original(loader.si_values), Linkage.COMPLIANT)
    per_force = equilibrium(model)
    per_angle = float(np.asarray(model.C)[0] @ per_force)
    rest = per_angle * force.force_n if isinstance(force, Step) else 0.0
    first = 0.0 if isinstance(force, Step) else force.angle_rad
    time = np.arange(0.0, duration_s, 1e-3 / 20)
    phi = scipy.linalg.expm(np.asarray(model.A) * time[1])
    states = [per_force * ((first - rest) / per_angle)]
    for _ in time[1:]:
        states.append(phi @ states[-1])
    off = CubicSpline(time, np.asarray(states) @ np.asarray(model.C)[0])
    tops = np.sign(rest - first) * off(off.derivative().roots(extrapolate=False))
    crossings = off.roots(extrapolate=False)
    found = simulate(loader, Scenario(replace(force, start_s=0.0), duration_s), None).measures
    assert found.equilibrium_angle_rad == pytest.approx(rest, abs=ROUNDING_RAD)
    assert found.overshoot == pytest.approx(tops.max() / abs(rest - first), rel=ONE_PERCENT)
    assert (
        math.isfinite(found.period_s) or duration_s < 2.0
    )  # the link's own swing at 11 Hz still has a part in the first extrema
    if math.isfinite(found.period_s):
        cycles = int(found.periods)
        assert found.period_s == pytest.approx((crossings[2 * cycles] - crossings[0]) / cycles, rel=ONE_PERCENT)


def _settled_s(feel, angle):
    """When a feel without friction is within 5 % for good; not a number where a swing nearly touches the edge of the band."""
    extrema, _ = feel.swings(angle)
    if any(abs(abs(extremum) / angle - BAND) < NEAR_BAND * BAND for extremum in extrema):
        return math.nan
    time = np.arange(0.0, len(extrema) * math.pi / feel.damped, 1e-4)
    return float(time[np.flatnonzero(np.abs(feel.phi(time)) > BAND)[-1]])


@pytest.mark.parametrize("mode", ["quiet", "noise"])
@pytest.mark.parametrize("name", DIGITAL)
def test_settling_time_matches_closed_form_or_is_nan(name, mode):
    loader, angle = _loader(name, mode), _angle(name)
    expected = _settled_s(Feel.of(loader), angle)
    if math.isnan(expected):
        pytest.skip("a swing touches the edge of the band")
    law = ff.laws.Law.of("robust", loader)
    for duration_s in DURATIONS_S:
        run = simulate(loader, Scenario(Release(angle), duration_s), law)
        if run.status is ff.simulation.RunStatus.SETTLED:
            assert run.measures.settling_time_s == pytest.approx(expected, rel=ONE_PERCENT), duration_s
    assert run.status is ff.simulation.RunStatus.SETTLED


ROUNDING_RAD = 1e-9
"""Of an equilibrium from two solutions of the same equations."""


@pytest.mark.parametrize("name", DIGITAL)
def test_equilibrium_matches_end_of_long_frictionless_run(name):
    """A weight, an offset of a sensor and a force move it; the search in the loader's equations meets what time gives."""
    loader = _quiet(BUILT_IN[name]()).replace({"load_cell.offset": "3 N", "column.gravity_torque": "2 N m"})
    force = loader["feel.stiffness"] / loader["column.grip_arm"] * _angle(name)
    run = simulate(loader, Scenario(Step(force, 0.1), 10.0), "robust")
    far = abs(run.measures.final_angle_rad)
    assert far > 0
    assert run.measures.equilibrium_angle_rad == pytest.approx(run.measures.final_angle_rad, rel=ONE_PERCENT)


@pytest.mark.parametrize("force_lb", [60.0, 100.0])
def test_column_on_a_stop_has_no_overshoot_and_no_frequency(force_lb):
    loader = BUILT_IN["elevator-electric"]()
    run = simulate(loader, Scenario(Step(force_lb * 4.4482216152605, 0.1), 2.0), "robust")
    told = run_conclusions(run, UnitSystem.US)
    assert math.isnan(run.measures.overshoot)
    assert math.isnan(run.measures.period_s)
    assert "no overshoot to measure: the column met a stop" in told.verdict
    assert "Hz" not in " ".join((told.verdict, *told.findings))


@pytest.mark.parametrize("force", [HandsOff(), Release(1e-5), Step(0.01, 0.1)], ids=["hands-off", "release", "step"])
@pytest.mark.parametrize("name", DIGITAL)
def test_verdict_states_motion_within_noise(name, force):
    loader = BUILT_IN[name]()
    run = simulate(loader, Scenario(force, 1.0), "robust")
    told = run_conclusions(run, UnitSystem.SI)
    assert "moved only within the sensors' noise" in told.verdict
    assert "Hz" not in " ".join((told.verdict, *told.findings))


def test_batch_and_sweep_measures_equal_single_run():
    loader = BUILT_IN["elevator-electric"]().replace({"feel.coulomb_friction": "1 N"})
    scenario = Scenario(Release(0.1), 1.4)
    run = simulate(loader, scenario, "robust")
    values = np.tile(loader.si_values, (3, 1))
    batch = simulate_batch(loader, scenario, values, "robust")
    sweep = ff.run_sweep(ff.Sweep(loader, scenario, "robust", runs=3, vary={"column.inertia": "1 %"}))
    for name in ("overshoot", "period_s", "periods", "settling_time_s", "equilibrium_angle_rad"):
        expected = getattr(run.measures, name)
        assert math.isfinite(expected)
        assert float(batch[name][0]) == expected
        assert getattr(sweep.nominal, name) == expected
