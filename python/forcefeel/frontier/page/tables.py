"""Tables of a frontier: shares over tolerances, cost of each tolerance, gain from each part, edges."""

from math import isfinite

from forcefeel.conclusions import share_text
from forcefeel.envelope.settings import AXES
from forcefeel.envelope.tolerance_sentences import ends_text
from forcefeel.frontier.findings import MILLISECONDS, points_text, tolerance_text
from forcefeel.frontier.friction import FORCE
from forcefeel.frontier.motor_limits import MotorLimits
from forcefeel.frontier.result import Frontier
from forcefeel.frontier.valve_limits import ValveLimits
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.page.table import Cell, Table, heads, number, words
from forcefeel.page.typography import NONE, number_text, parameter_name, prose_html, quantity_text
from forcefeel.units import FLOW, INERTIA, UnitSystem

_MINUS = "\N{MINUS SIGN}"
_GAIN = "#CDE9DD"
_FELT = 5e-3
"""Smallest gain and loss of a highlighted cell."""


def tolerances(frontier: Frontier) -> Table:
    """Worst-case shares on every level, with the bound if computed for that tolerance."""
    geometry, every = frontier.tightening.inertia_and_geometry, frontier.tightening.all_in_proportion
    rows = []
    for tolerance, alone, together in zip(geometry.tolerances, geometry.shares, every.shares, strict=True):
        bound = [
            share
            for error, share in zip(frontier.bound.errors, frontier.bound.shares, strict=True)
            if abs(error - tolerance) < _SAME * tolerance
        ]
        cells = (share_text(alone), share_text(together), share_text(bound[0]) if bound else NONE)
        rows.append((words(f"±{tolerance_text(tolerance)}"), *map(number, cells)))
    exactly = (share_text(geometry.limit), share_text(every.limit), share_text(1.0))
    rows.append((words("exactly"), *map(number, exactly)))
    head = ("Inertia known to", "Inertia and geometry tightened", "All in proportion", "Bound on any linear law")
    return Table(heads(*head), tuple(rows))


_SAME = 1e-6
"""Relative difference of tolerances that counts as rounding."""


def friction(frontier: Frontier, system: UnitSystem) -> Table | None:
    """Possible share over the error of the column's dry friction; ``None`` without friction."""
    bound = frontier.friction_bound
    if bound is None:
        return None
    rows = tuple(
        (
            words(f"±{tolerance_text(error)}{', its tolerance' if error == bound.tolerance else ''}"),
            number(quantity_text(error * bound.friction_n, FORCE, system, 2)),
            number(share_text(share)),
        )
        for error, share in zip(bound.errors, bound.shares, strict=True)
    )
    return Table(heads("Friction known to", "Force at the hand off by at least", "Bound"), rows)


def costs(frontier: Frontier) -> Table:
    """Cost of each single tolerance and arm."""
    rows = []
    for cost in frontier.tightening.costs:
        known = isfinite(cost.tolerance)
        name = parameter_name(cost.name) if known else cost.name
        rows.append(
            (
                words(name),
                number(ends_text(frontier.plan.deviations[cost.name]).replace("-", _MINUS) if known else NONE),
                number(share_text(cost.passes)),
                number(share_text(cost.lost) if cost.lost else NONE),
                number(share_text(cost.only) if cost.only else NONE),
            )
        )
    return Table(heads("Off, all else nominal", "By", "Passes", "Lost", "Lost to nothing else"), tuple(rows))


def hardware(frontier: Frontier) -> Table:
    """Gain from each hardware change, the largest in the worst case first."""
    before = frontier.envelope.shares(frontier.law)
    rows = [
        (
            words("as it is"),
            number(share_text(before.worst_case_share)),
            number(NONE),
            number(share_text(before.nominal_share)),
            number(NONE),
            number(share_text(before.stable_worst)),
            number(NONE),
        )
    ]
    for gain in frontier.hardware:
        rows.append(
            (
                words(f"{gain.name}; {gain.remark}" if gain.remark else gain.name),
                number(share_text(gain.worst)),
                _points(gain.worst_gain),
                number(share_text(gain.nominal)),
                _points(gain.nominal_gain),
                number(share_text(gain.stable_worst)),
                _points(gain.stable_worst_gain),
            )
        )
    head = ("Change", "Passes in every case", "Points", "Passes nominally", "Points", "Stable in every case", "Points")
    return Table(heads(*head), tuple(rows))


def edges(frontier: Frontier, system: UnitSystem) -> Table:
    """Edges of the rendered settings, and capability of the drive."""
    edge, friction = frontier.smallest, frontier.friction
    stiffness = unit(TABLE["feel.stiffness"])
    known = isfinite(edge.inertia_n_m_s2_per_rad)
    largest = frontier.largest_stiffness * frontier.plan.loader["feel.maximum_stiffness"]
    rows = (
        (
            "Smallest inertia rendered in every case",
            quantity_text(edge.inertia_n_m_s2_per_rad, INERTIA, system, 3) if known else NONE,
            f"{number_text(edge.inertia_share, 2)} times the column's own" if known else "",
        ),
        (
            "Smallest stiffness rendered in every case",
            quantity_text(edge.stiffness_n_m_per_rad, stiffness, system, 3) if known else NONE,
            f"{share_text(edge.stiffness_share)} of the largest" if known else "",
        ),
        (
            "Largest stiffness rendered in every case",
            quantity_text(largest, stiffness, system, 3) if known else NONE,
            f"{share_text(frontier.largest_stiffness)} of the largest" if known else "",
        ),
        (
            "Friction, play and lag felt with no friction programmed",
            quantity_text(friction.felt_n, FORCE, system, 2) if isfinite(friction.felt_n) else NONE,
            "half the width of the loop of a slow push, less that of the ideal",
        ),
        (
            "Noise at the grip, r.m.s.",
            quantity_text(friction.noise_n, FORCE, system, 2) if isfinite(friction.noise_n) else NONE,
            "as force; a smaller programmed friction is lost in it",
        ),
        (
            "Column's own dry friction",
            quantity_text(friction.column_n, FORCE, system, 2),
            "at the grip, beyond every sensor: a law that does not know of it leaves all of it",
        ),
        *_drive(frontier, system),
    )
    return Table(
        (Cell("Edge"), Cell("Value", "number"), Cell("")),
        tuple((words(what), number(value), words(remark)) for what, value, remark in rows),
    )


_Row = tuple[str, str, str]


def _drive(frontier: Frontier, system: UnitSystem) -> tuple[_Row, ...]:
    drive = frontier.drive
    gives = _motor(drive, system) if isinstance(drive, MotorLimits) else (_valve(drive, system),)
    takes = (
        "Time to take the hand's torque off the link, at most"
        if isinstance(drive, ValveLimits)
        else "Time to take the hand's torque off the link, at least, in the worst setting",
        quantity_text(drive.longest_unload_s, MILLISECONDS, system, 2),
        f"{share_text(drive.longest_unload_of_period)} of a period at most",
    )
    return (*gives, takes)


def _motor(motor: MotorLimits, system: UnitSystem) -> tuple[_Row, ...]:
    known = isfinite(motor.peak_force_n)
    return (
        (
            "Force of the motor at its largest current, at rest",
            quantity_text(motor.peak_force_n, FORCE, system, 3) if known else NONE,
            f"the settings ask for at most {share_text(motor.largest_hold)} of current or voltage at the angle of the release",
        ),
        (
            "Largest current or voltage of an ideal release",
            share_text(float(motor.demand.max())),
            "of what there is, for column and rotor",
        ),
    )


def _valve(valve: ValveLimits, system: UnitSystem) -> _Row:
    return (
        "Flow that the valve lets through at no load",
        quantity_text(valve.flow_m3_per_s, FLOW, system, 3),
        f"the ideal releases ask for at most {share_text(float(valve.demand.max()))} of it"
        if isfinite(float(valve.demand.max()))
        else "some ideal releases ask for more than the supply's pressure",
    )


def grid(frontier: Frontier, system: UnitSystem) -> Table:
    """The settings."""
    rows = []
    for name, axis in AXES.items():
        values = [number_text(axis.unit.from_si(value, system), 3) for value in getattr(frontier.plan.settings, name)]
        title = axis.title[:1].upper() + axis.title[1:]
        rows.append((words(prose_html(title)), words(", ".join(values)), Cell(axis.unit.shown(system))))
    return Table((Cell("Axis"), Cell("Values"), Cell("Unit")), tuple(rows))


def _points(gain: float) -> Cell:
    return Cell(points_text(gain).replace("-", _MINUS), "number", _GAIN if gain >= _FELT else "")
