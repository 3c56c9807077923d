"""Conclusions from a frontier, in sentences."""

from math import isclose, isfinite

from forcefeel.conclusions import Conclusions, of_result, share_text
from forcefeel.envelope.findings import WHOLE_NOMINAL, WHOLE_WORST, caveats, name_text
from forcefeel.frontier.hardware import GRIP_SENSOR, Gain
from forcefeel.frontier.motor_limits import MotorLimits
from forcefeel.frontier.result import Frontier, Limit
from forcefeel.frontier.tightening import KNOWN_BETTER
from forcefeel.frontier.valve_limits import ValveLimits
from forcefeel.laws.sampled.grip import GRIP
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.units import INERTIA as INERTIA_UNIT
from forcefeel.units import PERCENT, Unit, UnitSystem, to_text

GOAL = f"{100 * WHOLE_NOMINAL:.0f} % nominally and {100 * WHOLE_WORST:.0f} % in every case"

MILLISECONDS = Unit("s", "ms", "ms", "s")

_POINTS = 0.5e-2
"""Gain of a share from which on a sentence calls it one."""


@of_result
def frontier_conclusions(frontier: Frontier, units: UnitSystem) -> Conclusions:
    """The conclusions, with numbers in ``units``; ``good`` where the goal is reached at the full tolerances."""
    tight = frontier.tightening
    good = tight.nominal_is_enough and tight.worst >= WHOLE_WORST
    verdict = (
        f"With {name_text(frontier.law)} the loader renders {share_text(tight.nominal)} of {frontier.plan.settings.count:,} "
        f"programmed feels nominally and {share_text(tight.worst)} in every case. With {_inertia(frontier)} known to "
        f"{tolerance_text(frontier.inertia_tolerance)}, the bound on any linear law is "
        f"{share_text(float(frontier.possible.mean()))} (second-order responses)."
    )
    lines = [
        _limits(frontier),
        _goal(frontier),
        geometry_text(frontier),
        _dearest(frontier),
        _hardware(frontier),
        _drive(frontier, units),
    ]
    lines += [
        _smallest(frontier, units),
        _friction(frontier, units),
        _friction_bound(frontier, units),
        _sensor(frontier),
    ]
    lines += caveats(frontier.envelope)
    return Conclusions(good, verdict, tuple(line for line in lines if line))


def tolerance_text(share: float) -> str:
    """A tolerance to either side, as people say it."""
    return f"{to_text(PERCENT.from_si(share, UnitSystem.SI), 2)} %"


def geometry_text(frontier: Frontier) -> str:
    """What goes with the inertia's tolerance where the geometry is not known as well; empty where it is."""
    if _known_alike(frontier):
        return ""
    known = _known_text(frontier, frontier.inertia_tolerance)
    return f"The full tolerances are {known}; tightening reduces inertia and geometry by the same factor."


def _known_text(frontier: Frontier, inertia: float) -> str:
    """How well inertia and geometry are known where the inertia is known to a share."""
    if _known_alike(frontier):
        return f"{frontier.tightening.inertia_and_geometry.name} known to {tolerance_text(inertia)}"
    factor = inertia / frontier.inertia_tolerance
    known = {key: factor * frontier.levels.tolerances[key] for key in KNOWN_BETTER if key in frontier.levels.tolerances}
    return ", ".join(f"{key} known to {tolerance_text(tolerance)}" for key, tolerance in known.items())


def _known_alike(frontier: Frontier) -> bool:
    known = [tolerance for key, tolerance in frontier.levels.tolerances.items() if key in KNOWN_BETTER]
    return all(isclose(tolerance, frontier.inertia_tolerance, rel_tol=_SAME) for tolerance in known)


_SAME = 1e-9
"""Relative; tolerances that are the same but for rounding."""


def points_text(gain: float) -> str:
    """A gain in percentage points, with its sign."""
    return f"{100 * gain:+.1f}"


def _limits(frontier: Frontier) -> str:
    shares = {limit: share for limit, share in frontier.limit_shares.items() if share > 0 and limit is not Limit.NONE}
    if not shares:
        return "Every setting of the grid is rendered in every case."
    parts = [
        f"{frontier.text(limit)} ({share_text(share)})"
        for limit, share in sorted(shares.items(), key=lambda row: -row[1])
    ]
    beyond = frontier.beyond_bound
    more = (
        f" {share_text(beyond)} of the settings pass although no second-order response does: the bound does not apply there."
        if beyond
        else ""
    )
    return f"Limits of the other settings, as shares of all: {'; '.join(parts)}.{more}"


def _goal(frontier: Frontier) -> str:
    tight = frontier.tightening
    if not tight.nominal_is_enough:
        return (
            f"Tighter tolerances alone do not reach the goal of {GOAL}: they do not change the nominal share of "
            f"{share_text(tight.nominal)}. " + _reach(frontier)
        )
    if tight.worst >= WHOLE_WORST:
        return f"The goal of {GOAL} is reached at the full tolerances."
    return _reach(frontier) + _pair(frontier)


def _reach(frontier: Frontier) -> str:
    path = frontier.tightening.inertia_and_geometry
    goal = f"{100 * WHOLE_WORST:.0f} %"
    if isfinite(path.needed):
        return (
            f"The worst case reaches {goal} with {_known_text(frontier, path.needed)} (interpolated between two computed "
            "tolerances), with full tolerances of all other parameters."
        )
    if path.limit >= WHOLE_WORST:
        finest = _known_text(frontier, path.tolerances[-1])
        return (
            f"The worst case does not reach {goal} with {finest}, the tightest computed; at zero tolerance it is "
            f"{share_text(path.limit)}."
        )
    return f"With zero tolerance of {path.name} the worst case is still {share_text(path.limit)}: {_rest(frontier)}."


def _rest(frontier: Frontier) -> str:
    """What limits the worst case once inertia and geometry are known exactly."""
    if frontier.tightening.nominal < WHOLE_WORST:
        return "the nominal share itself limits it"
    others = [cost for cost in frontier.tightening.costs if cost.name not in KNOWN_BETTER and cost.lost > 0]
    if not others:
        return "the other tolerances limit it"
    dearest = max(others, key=lambda cost: cost.lost)
    return f"the other tolerances limit it, most of all {dearest.name}, which loses {share_text(dearest.lost)} of all settings"


def _pair(frontier: Frontier) -> str:
    pair = frontier.tightening.pair
    if pair is None:
        return ""
    others, known = tolerance_text(pair.others), _known_text(frontier, pair.inertia_and_geometry)
    return f" With all other tolerances reduced to {others} and {known}, it is {share_text(pair.share)}."


def _dearest(frontier: Frontier) -> str:
    dearest = max(frontier.tightening.costs, key=lambda cost: cost.lost)
    if dearest.lost <= 0:
        return "No single tolerance loses a setting that passes nominally."
    text = f"The most costly single tolerance is that of {dearest.name}, which loses {share_text(dearest.lost)} of all settings"
    only = max(frontier.tightening.costs, key=lambda cost: cost.only)
    if only.only > 0:
        return f"{text}; {only.name} alone loses {share_text(only.only)}, which no other case loses."
    path = frontier.tightening.inertia_and_geometry
    together = path.limit - path.shares[0]
    return (
        f"{text}. No setting is lost to one tolerance alone, so a zero tolerance of one parameter gains nothing; zero "
        "tolerances of "
        f"{path.name} together gain {100 * together:.1f} points."
    )


def _hardware(frontier: Frontier) -> str:
    gains = [gain for gain in frontier.hardware if gain.worst_gain >= _POINTS]
    best = max(frontier.hardware, key=lambda gain: gain.nominal_gain, default=None)
    nominal = (
        f" The largest nominal gain comes from {best.name}, {points_text(best.nominal_gain)} points."
        if best is not None and best.nominal_gain >= _POINTS
        else " No change gains half a point nominally."
    )
    if not gains:
        return "No tested hardware change gains half a point in the worst case." + nominal
    return f"The largest gains in the worst case come from {_listed(gains[:3])}.{nominal}"


def _listed(gains: list[Gain]) -> str:
    return ", then ".join(f"{gain.name} ({points_text(gain.worst_gain)} points)" for gain in gains)


def _drive(frontier: Frontier, units: UnitSystem) -> str:
    drive = frontier.drive
    return _motor(drive, units) if isinstance(drive, MotorLimits) else _valve(drive, units)


def _motor(motor: MotorLimits, units: UnitSystem) -> str:
    milliseconds = to_text(MILLISECONDS.from_si(motor.longest_unload_s, units), 2)
    unload = (
        f" At the release the rotor needs up to {milliseconds} ms to unload the link, "
        f"{share_text(motor.longest_unload_of_period)} of a period at most; the column moves freely until then."
        if motor.longest_unload_s
        else ""
    )
    hold = share_text(motor.largest_hold)
    if motor.forbidden.any():
        return (
            f"The motor excludes {share_text(motor.forbidden_share)} of the settings for every law: at rest they take up "
            f"to {hold} of its largest current or voltage, the ideal releases up to "
            f"{share_text(float(motor.demand.max()))}.{unload}"
        )
    beyond = (
        f"; {share_text(motor.beyond_ideal_share)} of the ideal releases are beyond it, which the tolerances allow"
        if motor.beyond_ideal_share
        else ""
    )
    return (
        f"The motor excludes no setting: the ideal releases take at most {share_text(float(motor.demand.max()))} of its largest "
        f"current or voltage, holding takes at most {hold}{beyond}.{unload}"
    )


def _valve(valve: ValveLimits, units: UnitSystem) -> str:
    milliseconds = to_text(MILLISECONDS.from_si(valve.longest_unload_s, units), 2)
    unload = (
        f" At the release the valve needs up to {milliseconds} ms to unload the link, "
        f"{share_text(valve.longest_unload_of_period)} of a period at most."
    )
    if valve.forbidden.any():
        return f"The valve excludes {share_text(valve.forbidden_share)} of the settings for every law.{unload}"
    return (
        f"The valve excludes no setting: the ideal releases take at most {share_text(float(valve.demand.max()))} of its "
        f"flow.{unload}"
        if valve.beyond_ideal_share == 0
        else f"The valve excludes no setting: {share_text(valve.beyond_ideal_share)} of the ideal releases are beyond its "
        "flow, but a "
        f"response within the tolerances is not.{unload}"
    )


def _smallest(frontier: Frontier, units: UnitSystem) -> str:
    edge = frontier.smallest
    if not isfinite(edge.inertia_n_m_s2_per_rad):
        return "No setting of the grid is rendered in every case."
    inertia = f"{to_text(INERTIA_UNIT.from_si(edge.inertia_n_m_s2_per_rad, units), 3)} {INERTIA_UNIT.shown(units)}"
    return (
        f"The smallest inertia rendered in every case is I = {inertia}, {to_text(edge.inertia_share, 2)} times the column's own. "
        f"Stiffness ranges from {share_text(edge.stiffness_share)} to {share_text(frontier.largest_stiffness)} of G_max, on a "
        "grid from "
        f"{share_text(frontier.plan.settings.stiffness[0])} to {share_text(frontier.plan.settings.stiffness[-1])}."
    )


def _friction(frontier: Frontier, units: UnitSystem) -> str:
    friction = frontier.friction
    if not isfinite(friction.felt_n):
        return "At the loader's own setting the run diverges under a slow push: friction was not evaluated."
    felt, noise = (_force(value, units) for value in (friction.felt_n, friction.noise_n))
    own = f", where the column's own dry friction is {_force(friction.column_n, units)}" if friction.column_n else ""
    return (
        f"Friction, play and lag at the grip at the loader's own setting, with no friction programmed: {felt}{own}. The noise "
        "floor "
        f"is {noise} r.m.s."
    )


def _friction_bound(frontier: Frontier, units: UnitSystem) -> str:
    bound = frontier.friction_bound
    if bound is None:
        return ""
    known = f"{_force(bound.friction_n, units)} known to {tolerance_text(bound.tolerance)}"
    return (
        f"With the column's dry friction of {known}, a law that must also work for a hand with a steady drag renders "
        f"{share_text(bound.share)} of the settings. Its force error at one end of the tolerance is "
        f"{_force(bound.off_n, units)} or more. A law that learns the friction hands off can exceed this bound, but attenuates a "
        "steady drag of the hand."
    )


def _force(value: float, units: UnitSystem) -> str:
    force_unit = unit(TABLE["pilot.force"])
    return f"{to_text(force_unit.from_si(value, units), 2)} {force_unit.shown(units)}"


def _inertia(frontier: Frontier) -> str:
    at_grip = has_grip_sensor(frontier.plan.loader)
    return "the mass outboard of the grip's sensor" if at_grip else "the column's inertia"


def _sensor(frontier: Frontier) -> str:
    if has_grip_sensor(frontier.plan.loader):
        return (
            "The force sensor at the grip distinguishes a heavier column from a hand: only the inertia outboard of the sensor "
            "bounds "
            "a law. The remaining limit is the drive, and its speed under a light feel with a heavy arm."
        )
    text = (
        "The bound applies to linear laws, and to adaptive laws if the hand may hold any mass. A force sensor at the grip removes "
        "it: the law then distinguishes a heavier column from a hand."
    )
    gain = next((row for row in frontier.hardware if row.name == GRIP_SENSOR), None)
    if gain is None:
        return text
    return (
        f"{text} With such a sensor and law {GRIP} the loader renders {share_text(gain.nominal)} nominally and "
        f"{share_text(gain.worst)} in every case, with all tolerances."
    )
