"""Compute a frontier: bound, limits of the drive, the law at all tolerance levels, hardware changes."""

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
from forcefeel.frontier.tolerance_levels import FACTORS, ToleranceLevels, level_releases, run_levels
from forcefeel.frontier.valve_limits import valve_limits
from forcefeel.laws.law_file import LAW_FILE
from forcefeel.laws.sampled.grip import GRIP
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import has_grip_sensor

Progress = Callable[[str, int, int], None]
"""Called with the current step and the numbers of completed and of all releases."""

DEFAULT_GRID: Mapping[str, str] = {
    "stiffness": "1.39..72 %:7:log",
    "frequency": "0.616..3.25 Hz:5:log",
    "damping": "0.1, 0.4, 0.7, 1.5",
}
"""140 settings with 300 to 550 releases each: the middles of 7 by 5 cells of 1 to 100 % and 0.5 to 4 Hz. A coarse grid from edge to
edge would overweight the edges, where the inertia is smallest."""


def find_frontier(
    loader: Loader,
    law: str | None = None,
    grid: Mapping[str, str | Sequence[float]] | None = None,
    *,
    threads: int | None = None,
    progress: Progress = lambda what, done, total: None,
    **options: Unpack[PlanOptions],
) -> Frontier:
    """Compute which feels this hardware cannot render, why, and the gains from tighter tolerances or other parts.

    Args:
        loader: The loader, as in ``find_envelope``.
        law: Name of a law of ``law.NAMED_LAWS``; default: ``robust``, ``grip`` with a sensor at the grip, ``published`` without a
            digital controller.
        grid: Axes, as in ``find_envelope``; default: ``DEFAULT_GRID``.
        threads: Number of threads; default: all cores. The results do not depend on it.
        progress: Called with the current step and the numbers of completed and of all releases.
        options: ``rule``, ``changes``, ``arms``, ``angle_rad``, as in ``find_envelope``.

    Returns:
        The frontier.

    Raises:
        InputError: If an argument is invalid, or if ``changes`` lacks the column's inertia.

    Example:
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
    """Plan of a frontier's envelope; arguments as in ``find_frontier``."""
    check_loader(loader)
    expect("law", law or "", str, "the name of a law, such as robust")
    expect("grid", grid or {}, Mapping, 'values by axis such as {"stiffness": "1..100 %:40:log"}')
    sampled = GRIP if has_grip_sensor(loader) else "robust"
    name = law or (sampled if loader["controller.period"] else "published")
    if name.endswith(LAW_FILE):
        raise InputError(
            f"law: expected the name of a design, which each changed machine requires, got {name}, a single law"
        )
    plan = make_plan(loader, (name,), {**DEFAULT_GRID, **(grid or {})}, **options)
    if INERTIA not in plan.deviations:
        raise InputError(f"{INERTIA}: expected a tolerance, required for the bound; add it, for example 20 %")
    if (size := plan.deviations[INERTIA].size) >= 1:
        raise InputError(f"{INERTIA}: expected a tolerance of less than 100 % to either side, got {100 * size:.4g} %")
    return plan


def compute_frontier(
    plan: Plan, *, threads: int | None = None, progress: Progress = lambda what, done, total: None
) -> Frontier:
    """Compute the frontier of a plan with one law; arguments as in ``find_frontier``."""
    at_levels = level_releases(plan)
    total = at_levels + hardware_releases(plan)
    levels = run_levels(plan, FACTORS, threads=threads, progress=lambda now, _: progress("tolerances", now, total))
    gains = hardware(levels, threads=threads, progress=lambda now, _: progress("hardware", at_levels + now, total))
    progress("bound", total, total)
    return Frontier(
        levels=levels,
        bound=inertia_bound(plan, _errors(levels), lean=plan.deviations[INERTIA].lean, threads=threads),
        tightening=tightening(levels),
        drive=(motor_limits if plan.loader.drive == ELECTRIC else valve_limits)(plan, threads=threads),
        friction=smallest_friction(plan),
        friction_bound=friction_bound(plan, threads=threads),
        hardware=gains,
    )


def _errors(levels: ToleranceLevels) -> list[float]:
    """Errors of the inertia at which the bound is computed: for the curve, and the tolerance on every level."""
    tolerances = [factor * levels.tolerances[INERTIA] for factor in levels.factors]
    others = [error for error in ERRORS if not any(isclose(error, other) for other in tolerances)]
    return sorted([*tolerances, *others])
