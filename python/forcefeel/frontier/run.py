"""Computes a frontier: the bound, the drive's limits, the law on the ladder of tolerances, the changes of the hardware."""

from collections.abc import Callable, Mapping, Sequence
from math import isclose
from typing import Unpack

from forcefeel.envelope.plan import Plan, PlanOptions, make_plan
from forcefeel.errors import InputError, expect
from forcefeel.frontier.bound import ERRORS, inertia_bound
from forcefeel.frontier.friction import smallest_friction
from forcefeel.frontier.friction_bound import friction_bound
from forcefeel.frontier.hardware import hardware, hardware_releases
from forcefeel.frontier.motor_limits import motor_limits
from forcefeel.frontier.result import Frontier
from forcefeel.frontier.tightening import INERTIA, tightening
from forcefeel.frontier.tolerance_levels import FACTORS, Rungs, climb, rung_releases
from forcefeel.frontier.valve_limits import valve_limits
from forcefeel.laws.law_file import LAW_FILE
from forcefeel.laws.sampled.grip import GRIP
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import has_grip_sensor

Progress = Callable[[str, int, int], None]
"""Called with what is being done, the releases that are done and all there are."""

DEFAULT_GRID: Mapping[str, str] = {
    "stiffness": "1.39..72 %:7:log",
    "frequency": "0.616..3.25 Hz:5:log",
    "damping": "0.1, 0.4, 0.7, 1.5",
}
"""140 settings, each released some 550 times: the middles of 7 by 5 cells of 1 to 100 % and 0.5 to 4 Hz, so that each stands for a
cell. A coarse grid from edge to edge gives the edges more than their share, where the inertia is smallest."""


def find_frontier(
    loader: Loader,
    law: str | None = None,
    grid: Mapping[str, str | Sequence[float]] | None = None,
    *,
    threads: int | None = None,
    progress: Progress = lambda what, done, total: None,
    **options: Unpack[PlanOptions],
) -> Frontier:
    """What cannot be rendered on this hardware and why, and what tighter tolerances or other parts would buy.

    Args:
        loader: The loader, as ``envelope`` takes it.
        law: Name of a law of ``law.NAMED_LAWS``; if not given ``robust``, ``grip`` with a sensor at the grip,
            ``published`` without a digital controller.
        grid: Axes as ``envelope`` takes them; ``DEFAULT_GRID`` where not given.
        threads: How many; all cores if not given. The numbers do not depend on it.
        progress: Called with what is being done, the releases that are done and all there are.
        options: ``rule``, ``changes``, ``arms``, ``angle_rad`` of ``envelope``.

    Returns:
        The frontier.

    Raises:
        InputError: If an argument is bad; if ``changes`` leaves the column's inertia out.

    Example:
        >>> import forcefeel as ff
        >>> grid = {"stiffness": "20, 100 %", "frequency": "1.5, 3 Hz", "damping": "0.3, 0.7"}
        >>> frontier = ff.find_frontier(ff.elevator(), "published", grid, changes={"column.inertia": 0.2}, arms=())
        >>> frontier.law, frontier.inertia_tolerance
        ('published', 0.2)
    """
    return compute_frontier(frontier_plan(loader, law, grid, **options), threads=threads, progress=progress)


def frontier_plan(
    loader: Loader,
    law: str | None = None,
    grid: Mapping[str, str | Sequence[float]] | None = None,
    **options: Unpack[PlanOptions],
) -> Plan:
    """The envelope that a frontier is about; arguments as ``find_frontier``."""
    check_loader(loader)
    expect("law", law or "", str, "the name of a law, such as robust")
    expect("grid", grid or {}, Mapping, 'values by axis such as {"stiffness": "1..100 %:40:log"}')
    sampled = GRIP if has_grip_sensor(loader) else "robust"
    name = law or (sampled if loader["controller.period"] else "published")
    if name.endswith(LAW_FILE):
        raise InputError(f"law: is designed anew for each changed machine, and {name} is one law; give a design's name")
    plan = make_plan(loader, (name,), {**DEFAULT_GRID, **(grid or {})}, **options)
    if INERTIA not in plan.deviations:
        raise InputError(f"{INERTIA}: expected a tolerance, which the bound is about; add it, for example 20 %")
    if (size := plan.deviations[INERTIA].size) >= 1:
        raise InputError(f"{INERTIA}: expected a tolerance of less than 100 % to either side, got {100 * size:.4g} %")
    return plan


def compute_frontier(
    plan: Plan, *, threads: int | None = None, progress: Progress = lambda what, done, total: None
) -> Frontier:
    """Computes the frontier of a plan of one law; arguments as ``find_frontier``."""
    climbing = rung_releases(plan)
    total = climbing + hardware_releases(plan)
    rungs = climb(plan, FACTORS, threads=threads, progress=lambda now, _: progress("tolerances", now, total))
    gains = hardware(rungs, threads=threads, progress=lambda now, _: progress("hardware", climbing + now, total))
    progress("bound", total, total)
    return Frontier(
        rungs=rungs,
        bound=inertia_bound(plan, _errors(rungs), lean=plan.deviations[INERTIA].lean, threads=threads),
        tightening=tightening(rungs),
        drive=(motor_limits if plan.loader.drive == ELECTRIC else valve_limits)(plan, threads=threads),
        friction=smallest_friction(plan),
        friction_bound=friction_bound(plan, threads=threads),
        hardware=gains,
    )


def _errors(rungs: Rungs) -> list[float]:
    """Errors of the inertia at which the bound is asked: some for the curve, and the tolerance on every rung."""
    tolerances = [factor * rungs.tolerances[INERTIA] for factor in rungs.factors]
    others = [error for error in ERRORS if not any(isclose(error, other) for other in tolerances)]
    return sorted([*tolerances, *others])
