"""The check of a flight schedule: its poles against other routes, and what it finds in schedules that are bad on purpose."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

import forcefeel as ff
from forcefeel._core import GainLaw
from forcefeel.flight_schedule import (
    FlightSchedule,
    ScheduleAxis,
    ScheduleCheck,
    check_schedule,
    design_schedule,
    second_order_feel,
)
from forcefeel.flight_schedule.findings import schedule_conclusions
from forcefeel.flight_schedule.releases import NOT_QUIET, PASSES
from forcefeel.flight_schedule.result import Part
from forcefeel.flight_schedule.transitions import Transitions, blended_feel
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loops.sampled_loop import sampled_loops

AXIS = ScheduleAxis("dynamic pressure", "lb/ft^2", (50, 100, 200))
REFINE = 4
ROUNDING = 1e-12
"""Of numbers near one: some ten operations, poles of matrices that differ in signs only. Measured: 1e-15."""
IN_COMPANY = 1e-12
"""Of the largest number: a setting's law has the same sums in whatever company. Measured: 0."""
FINE = 1e-5
"""Of a pole that swings with the feel: what steps of 0.1 ms and the slaved oil leave of the exact plant."""


@pytest.fixture(scope="module")
def loader() -> ff.Loader:
    return ff.elevator().replace({"controller.period": "0.5 ms", "controller.delay": "0.5 ms"})


def feel_of(loader: ff.Loader) -> np.ndarray:
    return second_order_feel(np.array([0.1, 0.2, 0.4]) * loader["feel.maximum_stiffness"], [1.0, 1.2, 1.5], 0.6)


@pytest.fixture(scope="module")
def schedule(loader: ff.Loader) -> FlightSchedule:
    return design_schedule(loader, [AXIS], feel_of(loader))


@pytest.fixture(scope="module")
def found(schedule: FlightSchedule) -> ScheduleCheck:
    return check_schedule(schedule, REFINE, changes={"linkage.stiffness": 0.2})


def turned(schedule: FlightSchedule, turns: Sequence[np.ndarray]) -> FlightSchedule:
    """The same law at every knot, the observer's state in coordinates ``t xi`` of the knot's own."""
    laws, n = schedule.laws, schedule.laws.states
    t = np.array(turns)
    back = np.linalg.inv(t)
    command, torque = laws.command.copy(), laws.torque.copy()
    for row in (command, torque):
        row[:, :n] = np.einsum("ki,kij->kj", row[:, :n], back)
    transition, taken = t @ laws.transition @ back, t @ laws.input
    return replace(schedule, laws=replace(laws, transition=transition, input=taken, command=command, torque=torque))


def flipped(schedule: FlightSchedule, *knots: int) -> FlightSchedule:
    """The observer's state with the other sign at some knots."""
    unit = np.eye(schedule.laws.states)
    return turned(schedule, [-unit if k in knots else unit for k in range(schedule.knots)])


def rotation(angle: float, n: int) -> np.ndarray:
    """The first with the second state by an angle, the third with the fourth, and so on."""
    plane = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return scipy.linalg.block_diag(*[plane] * (n // 2), *[[1.0]] * (n % 2))


def exact_poles(loader: ff.Loader, law: SampledLaw) -> np.ndarray:
    """Poles of the sampled loop with one sample of delay: eq. (17) and the feel by SciPy's exponential, put together here."""
    period = loader["controller.period"]
    model = ff.compliant_model(loader, GainLaw.none(loader.si_values))
    kept = [k for k, name in enumerate(model.state_labels) if not name.startswith("feel_")]
    a, b = np.asarray(model.A)[np.ix_(kept, kept)], np.asarray(model.B)[kept, 1:]
    plant = scipy.linalg.expm(np.block([[a, b], [np.zeros((1, 7))]]) * period)
    i, d, g = (loader[key] for key in FEEL_SETTING)
    feel = scipy.linalg.expm(np.array([[0, 1, 0], [-g / i, -d / i, 1 / i], [0, 0, 0]]) * period)
    columns = []
    for x in np.eye(9 + law.states):
        y = [loader["actuator.area"] * x[1], x[0], x[4] / loader["column.base_arm"]]
        known = np.concatenate([x[9:], y, x[7:9]])
        e, torque = law.command[0] @ known, law.torque[0] @ known
        xi = law.transition[0] @ x[9:] + law.input[0] @ [*y, e]
        columns.append(np.concatenate([(plant @ x[:7])[:6], [e], (feel @ [x[7], x[8], torque])[:2], xi]))
    return np.linalg.eigvals(np.column_stack(columns))


def test_poles_between_knots_match_the_exact_loop(schedule: FlightSchedule, found: ScheduleCheck) -> None:
    for place in (0, 2, 5, 8):  # a knot, a middle, others
        there = schedule.at(dynamic_pressure=float(found.where[place, 0]))
        poles = exact_poles(there.loader, there.law)
        swinging = np.abs(poles[np.abs(np.angle(poles)) > 1e-9]).max()  # off the positive axis but for rounding
        assert found.poles.largest[0, place] == pytest.approx(np.abs(poles).max(), abs=FINE)
        assert found.poles.swinging[0, place] == pytest.approx(swinging, abs=FINE)


def test_cases_vary_the_plant_under_the_nominal_law(schedule: FlightSchedule, found: ScheduleCheck) -> None:
    names = [case.name for case in found.cases]
    assert names[:3] == ["nominal", "linkage.stiffness -20 %", "linkage.stiffness +20 %"]
    assert names[3:] == ["light arm", "loose arm", "firm arm"]
    there = schedule.at(dynamic_pressure=150)
    off = there.loader.replace({"linkage.stiffness": 0.8 * there.loader["linkage.stiffness"]}, si=True)
    poles = sampled_loops(off, there.law).poles[0]
    place = int(np.flatnonzero(found.where[:, 0] == 150)[0])
    assert found.poles.largest[1, place] == pytest.approx(np.abs(poles).max(), abs=1e-12)  # the same arithmetic


def test_grid_is_refined_and_contains_every_knot(found: ScheduleCheck) -> None:
    np.testing.assert_array_equal(found.where[found.knot, 0], AXIS.values)
    np.testing.assert_allclose(found.where[:, 0], [50, 62.5, 75, 87.5, 100, 125, 150, 175, 200])
    assert found.poles.largest.shape == (6, 9)
    assert [part.loops for part in found.parts] == [6 * 3, 6 * 6, 6 * 3 * 3]  # three changes, three shares each


def test_valid_schedule_is_stable_and_dense(found: ScheduleCheck) -> None:
    assert found.stable
    assert found.dense
    assert found.remedy_helps is None
    assert (found.poles.largest < 1).all()
    assert [one.passes for one in found.releases] == [True] * 5
    said = schedule_conclusions(found)
    assert said.ok
    assert "loops are stable: at 3 knots, at 6 places between them and during 3 changes" in said.verdict
    assert "the knots are dense enough" in " ".join(said.findings)


def test_margins_are_computed_at_knots_and_midpoints(found: ScheduleCheck) -> None:
    places = [one.place for one in found.margins]
    for pressure in (50, 100, 200):
        assert f"dynamic pressure {pressure} lb/ft^2" in places
    for one in found.margins:
        assert 0 < one.margins.disk < np.inf


def test_instability_between_stable_knots_is_detected(schedule: FlightSchedule) -> None:
    """Halfway between two laws whose observers' coordinates differ in sign, the command no longer hears the observer."""
    found = check_schedule(flipped(schedule, 1), REFINE, changes={}, arms=())
    assert found.part(Part.KNOTS).unstable == 0
    assert not found.stable
    between = found.part(Part.BETWEEN)
    assert between.unstable > 0
    assert between.largest > 1
    assert found.remedy_helps
    said = schedule_conclusions(found)
    assert not said.ok
    assert "A law designed for" in said.verdict
    assert f"{between.place} is stable there: add a knot." in said.verdict
    lost = [one for one in found.releases if not one.passes]
    assert [one.knot for one in lost] == [False, False]
    assert all(one.lost for one in lost)
    assert "Add a knot where only a law of its own passes: dynamic pressure 75 lb/ft^2" in " ".join(said.findings)


def test_common_sign_flip_of_coordinates_changes_nothing(schedule: FlightSchedule) -> None:
    """The schedule of the test before is bad for its mixed signs alone."""
    both = flipped(schedule, 0, 1, 2)
    one, two = (check_schedule(each, REFINE, changes={}, arms=()) for each in (schedule, both))
    np.testing.assert_allclose(two.poles.largest, one.poles.largest, rtol=0, atol=ROUNDING)


def test_unstable_full_range_change_is_detected(loader: ff.Loader) -> None:
    """Coordinates turn by half a turn over the schedule: little between neighbors, from end to end they cancel."""
    knots = 121  # an observer's coordinates bear little
    axis = ScheduleAxis("mach", "", tuple(np.linspace(0.2, 0.8, knots)))
    schedule = design_schedule(loader, [axis], np.tile(feel_of(loader)[1], (knots, 1)), "observer")
    angles = np.linspace(0, np.pi, knots)
    slowly = turned(schedule, [rotation(angle, schedule.laws.states) for angle in angles])
    found = check_schedule(slowly, 2, changes={}, arms=())
    assert [part.unstable > 0 for part in found.parts] == [False, False, True]
    assert found.part(Part.CHANGES).place == "50 % of the way from mach 0.2 to mach 0.8"
    verdict = schedule_conclusions(found).verdict
    assert "Change in steps" in verdict
    assert "as at 50 % of the way from mach 0.2 to mach 0.8" in verdict


def test_more_knots_do_not_fix_unstable_knots(loader: ff.Loader) -> None:
    """An observer that trusts the potentiometer loses a soft feel where the linkage's ratio is off."""
    schedule = design_schedule(loader, [AXIS], 0.2 * feel_of(loader), "observer")
    found = check_schedule(schedule, 2, changes={"linkage.ratio": 0.2}, arms=())
    assert found.part(Part.KNOTS).unstable > 0
    assert found.remedy_helps is False
    assert "more knots do not help" in schedule_conclusions(found).verdict


def test_partial_change_blends_two_accelerations() -> None:
    """``(1 - s) (T - B_0 v - G_0 x) / I_0 + s (T - B_1 v - G_1 x) / I_1`` at random."""
    draw = np.random.default_rng(5)
    start, end = draw.uniform(0.5, 2.0, (2, 20, 3))
    s, (torque, x, v) = draw.uniform(0, 1, 20), draw.normal(size=(3, 20))

    def acceleration(feel: np.ndarray) -> np.ndarray:
        return (torque - feel[:, 1] * v - feel[:, 2] * x) / feel[:, 0]

    expected = (1 - s) * acceleration(start) + s * acceleration(end)
    np.testing.assert_allclose(acceleration(blended_feel(start, end, s)), expected, rtol=ROUNDING, atol=ROUNDING)


def test_changes_connect_neighbors_and_corners() -> None:
    loader = ff.digital_elevator()
    axes = [AXIS, ScheduleAxis("flaps", "deg", (0, 20))]
    feel = second_order_feel(np.full((3, 2), 800.0), 1.5, 0.6)
    schedule = design_schedule(loader, axes, feel, "observer")
    ends = [tuple(pair) for pair in Transitions.of(schedule, 2).ends.tolist()]
    along_pressure, along_flaps = {(0, 2), (2, 4), (1, 3), (3, 5)}, {(0, 1), (2, 3), (4, 5)}
    corners = {(0, 1), (0, 4), (0, 5), (1, 4), (1, 5), (4, 5)}
    assert set(ends) == along_pressure | along_flaps | corners
    assert len(ends) == len(set(ends))


def test_batched_design_of_1000_knots_matches_single_designs(loader: ff.Loader) -> None:
    """As many as there are: each is the law that would be designed alone."""
    count = 1000
    axis = ScheduleAxis("mach", "", tuple(np.linspace(0.2, 0.9, count)))
    stiffness = np.geomspace(0.05, 1, count) * loader["feel.maximum_stiffness"]
    inertia = 5.0  # one, so that the test is fast; docs/how-to/flight-schedule.md says what a thousand inertias take
    feel = np.column_stack([np.full(count, inertia), 0.6 * 2 * np.sqrt(stiffness * inertia), stiffness])
    schedule = design_schedule(loader, [axis], feel)
    alone = LAW_DESIGNS["robust"].design(loader, feel[[617]])
    close = IN_COMPANY * np.abs(alone.command[0]).max()
    np.testing.assert_allclose(schedule.laws.command[617], alone.command[0], rtol=0, atol=close)


def test_a_place_that_swings_on_in_contact_does_not_count() -> None:
    """Light feels of little damping: their releases pass, and without the part for contact a clamp keeps them swinging."""
    loader = ff.digital_elevator()
    feel = second_order_feel(np.array([0.014, 0.028]) * loader["feel.maximum_stiffness"], [1.5, 1.5], 0.15)
    schedule = design_schedule(loader, [ScheduleAxis("pressure", "lb/ft^2", (50, 100))], feel)
    alone = replace(schedule, laws=replace(schedule.laws, contact=np.empty(0)))
    outcomes = [
        {release.outcome for release in check_schedule(given, 2, changes={}, arms=()).releases}
        for given in (schedule, alone)
    ]
    assert outcomes == [{PASSES}, {NOT_QUIET}]


def test_a_schedule_whose_releases_all_fail_is_checked() -> None:
    """Feels of an elevator, which the motor of a sidestick does not hold."""
    axis = ScheduleAxis("pressure", "lb/ft^2", (50, 100))
    feel = second_order_feel(np.array([3000.0, 6000.0]), [1.0, 1.5], 0.6)
    schedule = design_schedule(ff.loader.electric("sidestick-pitch"), [axis], feel)
    outcomes = [release.outcome for release in check_schedule(schedule, 2, changes={}, arms=()).releases]
    assert not {PASSES, NOT_QUIET} & set(outcomes)
