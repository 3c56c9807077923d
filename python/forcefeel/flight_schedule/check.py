"""Check of a flight schedule at its knots, between them, and during changes of the setting.

Stability is that of the sampled loop's poles, with delay, at each fixed point: a changing setting is assumed to be slow compared
with the loop. Points between those of the refined grid are not checked.
"""

from collections.abc import Callable, Mapping, Sequence
from math import prod

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import NOMINAL, REFERENCE_ARMS, Case, PilotArm, make_cases
from forcefeel.envelope.deviations import Deviation, chosen_deviations
from forcefeel.envelope.machines import feel_json
from forcefeel.errors import InputError
from forcefeel.flight_schedule.axes import cells, mesh, place_text
from forcefeel.flight_schedule.poles import Poles, loops_of, poles_of
from forcefeel.flight_schedule.releases import PASSES, ReleaseTest
from forcefeel.flight_schedule.result import CheckedMargins, CheckedRelease, Part, PartResult, ScheduleCheck
from forcefeel.flight_schedule.schedule import FlightSchedule
from forcefeel.flight_schedule.transitions import Transitions
from forcefeel.laws.sampled.law_designs import law_design
from forcefeel.loader.loader import Loader
from forcefeel.loops.command_loop import CommandLoop
from forcefeel.loops.margins import loop_margins
from forcefeel.qualification import DEFAULT_EDITION, load_rules
from forcefeel.threads import threads_or_cores
from forcefeel.units import show

MOST_LOOPS = 2_000_000
"""Largest number of loops of a check: some minutes."""

Progress = Callable[[int, int], None]
"""Called with the numbers of completed and of all loops."""


def check_schedule(
    schedule: FlightSchedule,
    refine: int = 10,
    *,
    changes: Mapping[str, float | Deviation] | None = None,
    arms: Sequence[PilotArm] = REFERENCE_ARMS,
    rule: str = DEFAULT_EDITION,
    threads: int | None = None,
    progress: Progress = lambda done, total: None,
) -> ScheduleCheck:
    """Check the stability, the margins and the density of knots of a schedule.

    Args:
        schedule: The schedule.
        refine: Number of intervals between two knots, 2 or more.
        changes: Deviations of the plant parameters, one at a time, as in ``find_envelope``; default: the loader's tolerances,
            otherwise assumed ones.
        arms: Arms at the grip of the nominal plant, in addition to hands off.
        rule: Edition of the rule with the required release test.
        threads: Number of threads; default: all cores. The results do not depend on it.
        progress: Called with the numbers of completed and of all loops.

    Returns:
        The check. It omits optional rows of the feel and an arm of the loader, as an envelope does.

    Raises:
        InputError: If an argument is invalid, or with more than ``MOST_LOOPS`` loops.

    Example:
        >>> pressure = ff.flight_schedule.ScheduleAxis("pressure", "lb/ft^2", (50, 100))
        >>> feel = ff.flight_schedule.second_order_feel([500.0, 1000.0], [1.0, 1.5], 0.6)
        >>> schedule = ff.flight_schedule.design_schedule(ff.digital_elevator(), [pressure], feel)
        >>> bool(ff.flight_schedule.check_schedule(schedule, refine=2, changes={}, arms=()).stable)
        True
    """
    if isinstance(refine, bool) or not isinstance(refine, int) or not 2 <= refine <= MOST_LOOPS:
        raise InputError(f"refine: expected a whole number from 2 to {MOST_LOOPS:,}, got {show(refine)}")
    loader, _ = feel_json(schedule.loader)
    deviations = chosen_deviations(loader, changes)
    cases = make_cases(deviations, arms)
    threads = threads_or_cores(threads)
    test = ReleaseTest.of(load_rules(rule), schedule.loader)
    transitions = Transitions.of(schedule, refine)
    count = _check_count(schedule, refine, len(transitions.ends), len(cases))
    where = mesh([axis.refined(refine) for axis in schedule.axes])
    steps = mesh([np.arange((len(axis.values) - 1) * refine + 1.0) for axis in schedule.axes])
    knot = np.asarray((steps % refine == 0).all(axis=1), dtype=np.bool_)
    done = 0

    def advance(loops: int) -> None:
        nonlocal done
        done += loops
        progress(done, count)

    advance(0)
    poles = poles_of(loader, *schedule.between(where), cases, threads=threads, progress=advance)
    during = poles_of(loader, *transitions.loops(schedule), cases, threads=threads, progress=advance)
    parts = _parts(schedule, cases, (where, knot, poles), (transitions, during))
    return ScheduleCheck(
        schedule=schedule,
        refine=refine,
        deviations=deviations,
        cases=cases,
        where=where,
        knot=knot,
        poles=poles,
        transitions=transitions,
        during=during,
        parts=parts,
        remedy_helps=_remedy_helps(schedule, loader, cases, where, poles),
        margins=_margins(schedule, loader, where, poles),
        test=test,
        releases=_releases(schedule, loader, test, threads),
    )


def _check_count(schedule: FlightSchedule, refine: int, changes: int, cases: int) -> int:
    """Number of loops; at most ``MOST_LOOPS``."""
    places = prod((len(axis.values) - 1) * refine + 1 for axis in schedule.axes)
    count = (places + changes * (refine - 1)) * cases
    if count > MOST_LOOPS:
        raise InputError(
            f"refine: expected at most {MOST_LOOPS:,} loops, got {count:,}: {places:,} places and {changes:,} changes in "
            f"{cases} cases; take a smaller refine or fewer knots"
        )
    return count


def _parts(
    schedule: FlightSchedule,
    cases: Sequence[Case],
    still: tuple[NDArray[np.float64], NDArray[np.bool_], Poles],
    moving: tuple[Transitions, Poles],
) -> tuple[PartResult, ...]:
    where, knot, poles = still
    transitions, during = moving

    def part_result(part: Part, poles: Poles, which: NDArray[np.bool_], place_of: Callable[[int], str]) -> PartResult:
        critical, largest = poles.critical[:, which], poles.largest[:, which]
        case, loop = _largest_of(critical)
        return PartResult(
            part=part,
            loops=largest.size,
            unstable=int((largest >= 1).sum()),
            place=place_of(int(np.flatnonzero(which)[loop])),
            case=cases[case].name,
            critical=float(critical[case, loop]),
            largest=float(largest.max()),
        )

    def at(loop: int) -> str:
        return place_text(schedule.axes, where[loop])

    def on_the_way(loop: int) -> str:
        change, share = divmod(loop, len(transitions.shares))
        start, end = (place_text(schedule.axes, schedule.where[k]) for k in transitions.ends[change])
        return f"{100 * transitions.shares[share]:.3g} % of the way from {start} to {end}"

    return (
        part_result(Part.KNOTS, poles, knot, at),
        part_result(Part.BETWEEN, poles, ~knot, at),
        part_result(Part.CHANGES, during, np.full(during.largest.shape[1], True), on_the_way),
    )


def _largest_of(values: NDArray[np.float64]) -> tuple[int, int]:
    """Row and column of the largest value."""
    row, column = divmod(int(values.argmax()), values.shape[1])
    return row, column


def _remedy_helps(
    schedule: FlightSchedule, loader: Loader, cases: Sequence[Case], where: NDArray[np.float64], poles: Poles
) -> bool | None:
    """Whether a law designed for the worst point is stable there, in the worst case; ``None`` if all loops are stable."""
    case, loop = _largest_of(poles.largest)
    if poles.largest[case, loop] < 1:
        return None
    feel, _ = schedule.between(where[[loop]])
    own = law_design(schedule.law).design(loader, feel)
    return bool(loops_of(loader, feel, own, cases[case], threads=1).stable[0])


def _margins(
    schedule: FlightSchedule, loader: Loader, where: NDArray[np.float64], poles: Poles
) -> tuple[CheckedMargins, ...]:
    """Margins at the corners, the middle and the worst point of the nominal plant."""
    ends = mesh([(axis.values[0], axis.values[-1]) for axis in schedule.axes])
    middle = mesh([[axis.refined(2)[len(axis.values) - 1]] for axis in schedule.axes])
    worst = where[[int(poles.critical[0].argmax())]]
    points = np.unique(np.vstack([ends, middle, worst]), axis=0)
    feel, laws = schedule.between(points)
    loops = loops_of(loader, feel, laws, NOMINAL, threads=1)
    return tuple(
        CheckedMargins(place_text(schedule.axes, point), loop_margins(CommandLoop.sampled(loops, k)))
        for k, point in enumerate(points)
    )


def _releases(schedule: FlightSchedule, loader: Loader, test: ReleaseTest, threads: int) -> tuple[CheckedRelease, ...]:
    """Releases at each knot and in the middle of each cell, there also with a law designed for it if the schedule's fails."""
    middle = mesh(tuple(cells(schedule.axes)))
    where = np.vstack([schedule.where, middle])
    feel, laws = schedule.between(where)
    outcomes = test.outcomes(loader, feel, laws, threads)
    designed = list(outcomes)
    failing = [k for k in range(schedule.knots, len(where)) if outcomes[k] != PASSES]
    if failing:
        own = law_design(schedule.law).design(loader, feel[failing])
        for k, outcome in zip(failing, test.outcomes(loader, feel[failing], own, threads), strict=True):
            designed[k] = outcome
    return tuple(
        CheckedRelease(place_text(schedule.axes, point), k < schedule.knots, outcomes[k], designed[k])
        for k, point in enumerate(where)
    )
