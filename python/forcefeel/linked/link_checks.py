"""Checks of the link between two pilots' controls. No qualification rule has a test of it: these are forcefeel's own.

| check | what is done | limit |
|---|---|---|
| breakout | the second column is jammed, the first pushed slowly to a side and back | force beyond the feel's: 5 % of the row |
| stiffness | likewise, below the breakout | torque beyond the feel's per angle: 10 % of the row |
| re-engagement | likewise, on the way back | largest step of the link's force between two samples: 2 lb |
| release | both columns are released from one angle | position difference: 0.5 deg |
| release of the first | an arm holds the second, loosely and firmly | swing at 7 to 10 s: 0.9 of 4 to 7 s, half of 0 to 1 s |
| uncoupling | opposite hands open the link and push on | none: how far a column swings beyond where it comes to rest |

The force of a feel at rest is the model's (``_core.feel_held_along``).
"""

from dataclasses import replace
from math import inf, isfinite, nan, radians

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.laws.law import LawLike
from forcefeel.linked.engine import simulate_linked
from forcefeel.linked.result import SIDES, LinkedRun
from forcefeel.linked.scenario import Jam, LinkedScenario
from forcefeel.loader.arms import ARM_ROWS, ARMS, Arm
from forcefeel.loader.links import AfterBreakout, Link
from forcefeel.loader.loader import Loader
from forcefeel.loader.project import Project
from forcefeel.qualification.own_checks import OwnCheck
from forcefeel.simulation.inputs import Recorded, Release
from forcefeel.simulation.scenario import Scenario
from forcefeel.units import ANGLE, FORCE, RATIO, ROTARY_STIFFNESS, Unit, show

BREAKOUT, STIFFNESS = 0.05, 0.1
"""Largest deviations from the rows of the link, as shares."""

STEP_N, DIFFERENCE_RAD = 8.896, radians(0.5)
"""Largest step of the force at re-engagement, 2 lb, and largest difference of two released columns."""

LEFT, AT_END = 0.9, 0.5
"""Largest swing of the last three seconds of ten after a release: shares of the three before and of the first second.

What swings on has all of it; what swings in bursts may have less than in the three seconds before, but not than in the first.
"""

_RAMP_S, _BEYOND = 8.0, 1.4
"""Time of a slow push to its largest force, and that force as a share of what the breakout takes."""

_LOW, _HIGH = 0.3, 0.8
"""Part of the way to the breakout over which the stiffness is measured, from the force at which the feel lets the column go."""

_FEWEST = 8
"""Points of a line through a stiffness."""

_RELEASE_RAD, _RELEASE_S = radians(5.0), 2.0

_LETS_GO_S, _LET_GO_S = 3.0, 13.0
"""When the first hand lets go, and the end of that run."""

_STILL_RAD = 1e-4
"""A column that swings by less is at rest but for the sensors' noise."""

_Array = NDArray[np.float64]


def check_link(project: Project, name: str, law: LawLike = None) -> tuple[OwnCheck, ...]:
    """Checks a link of a project with both its loaders.

    Args:
        project: The project.
        name: Name of the link.
        law: Law of both loaders, as for ``simulate_linked``.

    Raises:
        InputError: If the link is an interconnect, whose two axes have no common angle; or as ``simulate_linked``.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> [check.passed for check in ff.linked.check_link(project, "pitch", "robust")]
        [True, True, True, True, True, True, True, True, True]
    """
    if name not in project.pilot_links:
        known = ", ".join(project.pilot_links) or "a link of two pilots in [links]"
        what = f"the interconnect {name}" if name in project.links else show(name)
        raise InputError(f"name: expected a link that joins one control of two pilots ({known}), got {what}")
    link = project.links[name]

    def run(scenario: LinkedScenario) -> LinkedRun:
        return simulate_linked(project, name, scenario, law)

    first = project.loaders[link.between[0]]
    checks = []
    for sign in (1.0, -1.0) if isfinite(link["breakout"]) else (1.0,):
        pushed = run(_pushed(link, first, sign))
        checks += _of_run(pushed, _pushed_checks(pushed, sign))
    release = Release(_RELEASE_RAD)
    released = run(LinkedScenario(Scenario(release, _RELEASE_S), second_force=release))
    apart = released.measures.largest_difference_rad
    checks += _of_run(released, [OwnCheck("position difference, both released", apart, 0.0, DIFFERENCE_RAD, ANGLE)])
    for arm in (Arm.LOOSE, Arm.FIRM):
        held = simulate_linked(_second_held(project, link, arm), name, _let_go(first), law)
        checks += _of_run(held, _swing_left(held, f"first released, second held: {arm}"))
    if isfinite(link["breakout"]) and link.after_breakout is AfterBreakout.UNCOUPLE:
        opposed = run(_opposed(link, first))
        checks += _of_run(opposed, [OwnCheck("swing beyond rest, uncoupling", _swing(opposed), nan, nan, ANGLE)])
    return tuple(checks)


def _of_run(run: LinkedRun, checks: list[OwnCheck]) -> list[OwnCheck]:
    """The checks, infinite if the run diverged."""
    return [replace(check, value=inf) for check in checks] if run.diverged else checks


def _breakout_force(link: Link, loader: Loader) -> float:
    """Force at the first grip that the breakout takes, with the feel's at the angle there.

    Without a breakout, that of the feel alone at the angle of a release, beyond the force at which it lets the column go.
    """
    if not isfinite(link["breakout"]):
        return float(np.sum(_feel_force(loader, np.array([0.0, _RELEASE_RAD]), 1.0)))
    angle = link["breakout"] / link["stiffness"] + link["play"] / 2
    return float(link["breakout"] / loader["column.grip_arm"] + _feel_force(loader, np.array([angle]), 1.0)[0])


def _feel_force(loader: Loader, angle_rad: _Array, sign: float) -> _Array:
    """Force at the grip of the programmed feel, moved slowly to a side."""
    curve = loader.force_curve.arrays if loader.force_curve else None
    return _core.feel_held_along(loader.si_values, angle_rad, np.full(len(angle_rad), sign), curve=curve)


def _pushed(link: Link, loader: Loader, sign: float) -> LinkedScenario:
    """The first column pushed slowly beyond the breakout and back, the second jammed."""
    force = sign * _BEYOND * _breakout_force(link, loader)
    ramp = Recorded(np.array([0.0, _RAMP_S, 2 * _RAMP_S]), np.array([0.0, force, 0.0]))
    return LinkedScenario(Scenario(ramp, 2 * _RAMP_S), jam=Jam(link.between[1], 0.01))


def _opposed(link: Link, loader: Loader) -> LinkedScenario:
    """Opposite hands that open the link within a second and stay."""
    force = _BEYOND * _breakout_force(link, loader)
    hands = [Recorded(np.array([0.0, 1.0, 6.0]), np.array([0.0, sign * force, sign * force])) for sign in (1.0, -1.0)]
    return LinkedScenario(Scenario(hands[0], 6.0), second_force=hands[1])


def _second_held(project: Project, link: Link, arm: Arm) -> Project:
    """The project with an arm at the second grip."""
    axis = link.between[1]
    held = project.loaders[axis].replace(dict(zip(ARM_ROWS, ARMS[arm], strict=True)), si=True)
    return replace(project, loaders={**project.loaders, axis: held})


def _let_go(loader: Loader) -> LinkedScenario:
    """A hand that pushes the first column as far as its feel alone goes to the angle of a release, and lets go."""
    force = float(_feel_force(loader, np.array([_RELEASE_RAD]), 1.0)[0])
    let_go = _LETS_GO_S + 0.001
    times = np.sort(np.append(np.arange(_LET_GO_S + 1), let_go))
    hand = np.interp(times, [0.0, 2.0, _LETS_GO_S, let_go], [0.0, force, force, 0.0])
    return LinkedScenario(Scenario(Recorded(times, hand), _LET_GO_S))


def _swing_left(run: LinkedRun, what: str) -> list[OwnCheck]:
    """Swing of both columns at the end of ten seconds after the release, beside that before and that of the first."""
    first, before, end = (_largest_swing(run, *part) for part in ((0, 1), (4, 7), (7, 10)))
    left = 0.0 if end < _STILL_RAD else end / before if isfinite(end) else inf
    return [
        OwnCheck(f"swing left, {what}", left, 0.0, LEFT, RATIO),
        OwnCheck(f"swing at the end, {what}", end, 0.0, AT_END * first, ANGLE),
    ]


def _largest_swing(run: LinkedRun, begin: float, end: float) -> float:
    """From peak to peak, of that column which swings more, between two times after the release."""
    since = run.outputs["time_s"] - _LETS_GO_S
    part = (since >= begin) & (since < end)
    return max(float(np.ptp(run.outputs[f"{side}_column_angle_rad"][part])) for side in SIDES)


def _pushed_checks(run: LinkedRun, sign: float) -> list[OwnCheck]:
    link, loader = run.link, run.loaders[0]
    arm, side = loader["column.grip_arm"], "up" if sign > 0 else "down"
    outputs = run.outputs
    beyond = outputs["link_gives_way"] > 0
    out = int(np.argmax(beyond)) if beyond.any() else None
    angle = outputs["first_column_angle_rad"]
    of_link = sign * (outputs["first_hand_force_n"] - _feel_force(loader, angle, sign))
    row = link["breakout"] / arm
    at_breakout = nan if out is None else float(of_link[out])
    checks = [_within(f"breakout, {side}", at_breakout, row, BREAKOUT, FORCE)] if isfinite(row) else []
    if not isfinite(row):
        out = len(angle) // 2  # the top of the push
    if sign > 0:
        slope = _slope(angle, of_link * arm, outputs["first_hand_force_n"], loader, out)
        checks.append(_within("stiffness", slope, link.stiffness_to_jam, STIFFNESS, ROTARY_STIFFNESS))
        if isfinite(row) and link.after_breakout is AfterBreakout.OVERRIDE:
            back = outputs["first_link_torque_n_m"][len(angle) // 2 :]
            step = float(np.abs(np.diff(back)).max()) / arm
            checks.append(OwnCheck("largest step of force, re-engagement", step, 0.0, STEP_N, FORCE))
    return checks


def _slope(angle: _Array, torque: _Array, force: _Array, loader: Loader, out: int | None) -> float:
    """Torque of the link per angle on the way to where it gives way."""
    if not out:
        return nan
    lets_go = float(_feel_force(loader, np.array([0.0]), 1.0)[0])
    share = (force[:out] - lets_go) / (force[out] - lets_go)
    part = (share > _LOW) & (share < _HIGH)
    if np.count_nonzero(part) < _FEWEST:  # a swing goes past it
        return nan
    return float(np.polyfit(angle[:out][part], torque[:out][part], 1)[0])


def _within(name: str, value: float, row: float, share: float, unit: Unit) -> OwnCheck:
    return OwnCheck(name, value, (1 - share) * row, (1 + share) * row, unit)


def _swing(run: LinkedRun) -> float:
    """Largest angle of a column beyond where it comes to rest."""
    measures = run.measures
    ends = {"first": measures.first_final_angle_rad, "second": measures.second_final_angle_rad}
    return max(
        float(np.max(np.sign(end) * run.outputs[f"{side}_column_angle_rad"]) - abs(end)) for side, end in ends.items()
    )
