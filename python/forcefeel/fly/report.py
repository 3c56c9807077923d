"""A loader's report in flight: held load factors and speeds, maneuvers, and the rules that apply to the aircraft."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from math import degrees, radians

import numpy as np

from forcefeel.conclusions import Conclusions, of_result
from forcefeel.errors import InputError
from forcefeel.fly.aircraft import Aircraft
from forcefeel.fly.case import FlightCase, HeldFlight
from forcefeel.fly.maneuvers import CHANGED, Maneuver, ManeuverRequest, fly_maneuver
from forcefeel.fly.rules import Compared, FlightVerdict, Outcome, Quantity, flight_rules, judge
from forcefeel.units import ANGLE, FORCE, LOAD_FACTOR, PERCENT, Unit, factor

FORCE_OVER_SPEED = Unit("N s/m", "N s/m", "lb/kt")

_PULLS = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Shares of the way from 1 g to the limit load factor."""
_SMALL = 2
"""Pulls from which the force per g is taken, and the largest force that a short maneuver needs."""
_OUT_OF_TRIM_S, _OUT_OF_TRIM_G = 3.0, ((1.0, 0.5, 0.0, -0.5, -1.0), (1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5))
"""Time for which the trim runs, and load factors from 1 g down and up: 14 CFR 25.255(a), (c)(1)."""
_OUT_OF_TRIM = "smallest force per g out of trim"
_HELD_G = 0.1
"""Load factor by which a held flight may be off."""
_SPEEDS = (0.85, 0.925, 1.075, 1.15)
"""Shares of the trim speed: 14 CFR 25.175(a)."""
_RELEASES = (0.85, 1.15)
_SIDESLIPS = (radians(2), radians(4))
_FREE_RETURN = ("light", "transport")
"""Categories whose rules ask for a free return."""
_EACH_SIDE = 2
"""Speeds above and below trim that 14 CFR Part 60 requires."""
HISTORIES = {
    "power": CHANGED,
    "flaps": CHANGED,
    "gear": CHANGED,
    "speed-brake": CHANGED,
    "short-period": {"pitch_attitude": ANGLE, "load_factor": LOAD_FACTOR},
}
"""Maneuvers whose time histories are compared."""


@dataclass(frozen=True)
class Point:
    """A load factor or a speed that was to be held.

    Attributes:
        label: Load factor, or share of the trim speed.
        held: The flight; none if it failed.
        fault: Why it failed.
    """

    label: str
    held: HeldFlight | None
    fault: str = ""


@dataclass(frozen=True, eq=False)
class FlightReport:
    """What was flown, and the verdicts.

    Attributes:
        case: Loader, aircraft and trimmed flight.
        pulls: Held load factors; the last is the limit load factor.
        speeds: Held speeds.
        maneuvers: Flown maneuvers.
        faults: Maneuvers that failed, with the reason.
        verdicts: Each rule that applies.

    Example:
        >>> case = ff.fly.FlightCase(ff.digital_elevator(), "c172p", 51.4, 900.0, "robust")
        >>> pull = ff.fly.fly_maneuver(case, "pull-up")
        >>> ff.fly.FlightReport(case, (), (), (pull,), {}, ()).fulfilled
        True
    """

    case: FlightCase = field(repr=False)
    pulls: tuple[Point, ...]
    speeds: tuple[Point, ...]
    maneuvers: tuple[Maneuver, ...]
    faults: dict[str, str]
    verdicts: tuple[FlightVerdict, ...]

    @property
    def fulfilled(self) -> bool:
        """Whether every row was flown and is met."""
        return all(verdict.outcome is Outcome.MET for verdict in self.verdicts)


def fly_rules(case: FlightCase, progress: Callable[[str], None] = lambda _: None) -> FlightReport:
    """Flies what the rules that apply to the aircraft need, and judges them.

    Args:
        case: Loader, aircraft and trimmed flight.
        progress: Called with the name of each step.

    Raises:
        InputError: If the trimmed flight itself fails; what fails later is named in its row.

    Example:
        >>> try:
        ...     ff.fly.fly_rules(ff.fly.FlightCase(ff.elevator(), "c172p", 51.4, 900.0, "robust"))
        ... except ff.InputError as error:
        ...     print(str(error).partition(";")[0])
        controller.period: a live loop requires 0.2 to 4 ms, got none: its controller is analog
    """
    if case.axis != "pitch":
        return _fly_lateral_rules(case, progress)
    data, beyond = case.trim.data, case.trim.data.limit_load_factor - 1
    progress("load factors")
    case.held(case.at())  # what cannot fly at all is refused here
    load_factors = [1 + share * beyond for share in _PULLS]
    pulls = [_point(case, f"{n:.3g} g", partial(case.at, load_factor=n)) for n in load_factors]
    progress("speeds")
    speeds = [
        _point(case, f"{100 * share:.4g} % of the trim speed", partial(case.at, share * case.speed_m_per_s))
        for share in _SPEEDS
    ]
    requests = [(name, ManeuverRequest()) for name in (*HISTORIES, "phugoid") if name not in case.without]
    if data.category in _FREE_RETURN:
        requests += [("release", ManeuverRequest(off_trim=share)) for share in _RELEASES]
    maneuvers, faults = _fly_maneuvers(case, requests, progress)
    flown: dict[str, Quantity | str] = {**_of_pulls(pulls, data.limit_load_factor), **_of_speeds(case, speeds)}
    flown |= {"largest force": _largest_force((*pulls[:_SMALL], *speeds))}
    flown |= _of_maneuvers(maneuvers, faults)
    if data.category == "transport":
        progress("out of trim")
        flown[_OUT_OF_TRIM] = out_of_trim(case)
    conditions = {"n_L - 1": beyond, "weight": (data.maximum_weight_n or 0.0) * factor("N", "lb")}
    applying = [rule for rule in flight_rules() if rule.applies(data) and rule.maneuver not in case.without]
    if data.category == "military" and not isinstance(flown["force per g"], str):
        conditions["n / alpha"] = _n_per_alpha(case)
    verdicts = tuple(verdict for rule in applying for verdict in judge(rule, flown, conditions))
    return FlightReport(case, tuple(pulls), tuple(speeds), tuple(maneuvers), faults, verdicts)


def _fly_lateral_rules(case: FlightCase, progress: Callable[[str], None]) -> FlightReport:
    """Of wheel or pedals: a roll or yaw rate, and steady sideslips."""
    rate = f"{case.axis}-rate"
    requests = [(rate, ManeuverRequest()), *(("sideslip", ManeuverRequest(sideslip_rad=slip)) for slip in _SIDESLIPS)]
    maneuvers, faults = _fly_maneuvers(case, requests, progress)
    of = {name: [maneuver for maneuver in maneuvers if maneuver.name == name] for name in (rate, "sideslip")}
    flown: dict[str, Quantity | str] = {}
    measures = {rate: (f"largest {case.axis} rate", "force"), "sideslip": ("sideslip", "bank", "force")}
    for name, measure in ((name, measure) for name, measures in measures.items() for measure in measures):
        flown[f"{name}: {measure}"] = faults.get(name) or _measured(of[name], measure)
    largest = [
        Compared(maneuver.label, *(float(np.abs(each.force_n).max()) for each in (maneuver.flown, maneuver.alone)))
        for maneuver in maneuvers
    ]
    flown["largest force"] = next(iter(faults.values()), "") or Quantity(FORCE, tuple(largest))
    verdicts = tuple(
        verdict for rule in flight_rules() if rule.applies(case.trim.data) for verdict in judge(rule, flown, {})
    )
    return FlightReport(case, (), (), tuple(maneuvers), faults, verdicts)


def _fly_maneuvers(
    case: FlightCase, requests: list[tuple[str, ManeuverRequest]], progress: Callable[[str], None]
) -> tuple[list[Maneuver], dict[str, str]]:
    """The flown maneuvers, and why others failed."""
    maneuvers: list[Maneuver] = []
    faults: dict[str, str] = {}
    for name, request in requests:
        progress(name)
        try:
            maneuvers.append(fly_maneuver(case, name, request))
        except InputError as error:
            faults[name] = str(error)
    return maneuvers, faults


def _point(case: FlightCase, label: str, trimmed: Callable[[], Aircraft]) -> Point:
    try:
        begins = trimmed()
        load_factor = begins.state()["load_factor"]
        held = case.held(begins)
    except InputError as error:
        return Point(label, None, str(error))
    if abs(held.load_factor - load_factor) > _HELD_G:
        fault = f"the pilot held {held.load_factor:.2f} g instead of {load_factor:.2f} g: the column does not follow the hand"
        return Point(label, None, fault)
    return Point(label, held)


def _of_pulls(pulls: list[Point], limit_load_factor: float) -> dict[str, Quantity | str]:
    """Quantities over load factor; a pull is counted positive."""
    if fault := _first_fault(pulls[:_SMALL]):
        return dict.fromkeys(("force over load factor", "force per g", "force at the limit load factor"), fault)
    flown = [point.held for point in pulls if point.held]
    last, label = flown[-1], f"{flown[-1].load_factor:.2f} g"
    left = 0.0 if pulls[-1].held else limit_load_factor - last.load_factor
    if left:
        label = f"extrapolated from {label}, the most that trims and is held"
    at_end = _slope("", "load_factor", *flown[-2:])
    forces = (last.force_n + at_end.with_loader * left, last.feel_n + at_end.feel * left)
    label_of_slope = f"{flown[0].load_factor:.2f} to {flown[1].load_factor:.2f} g"
    per_g = _slope(label_of_slope, "load_factor", *flown[:_SMALL])
    return {
        "force over load factor": Quantity(FORCE, tuple(_force(f"{held.load_factor:.2f} g", held) for held in flown)),
        "force per g": Quantity(FORCE, (Compared(label_of_slope, -per_g.with_loader, -per_g.feel),)),
        "force at the limit load factor": Quantity(FORCE, (Compared(label, -forces[0], -forces[1]),)),
    }


def out_of_trim(case: FlightCase) -> Quantity | str:
    """Slopes of the force over load factor with the tab run to either side for three seconds; a pull is counted positive.

    From 1 g down and up to where JSBSim no longer trims, which each label states.
    """
    rate = case.trim.data.trim_rate_rad_per_s
    if rate is None or not case.feel["surface.per_tab"]:
        return "the aircraft has no flight.trim_rate with surface.per_tab: a tab that runs"
    slopes: list[Compared] = []
    for tab in (-rate * _OUT_OF_TRIM_S, rate * _OUT_OF_TRIM_S):
        points: dict[float, Point] = {}
        for side in _OUT_OF_TRIM_G:
            for n in side:
                points[n] = points.get(n) or _point(case, f"{n:g} g", partial(case.at, load_factor=n, tab_rad=tab))
                if not points[n].held:
                    break
        if fault := _first_fault(points[n] for side in _OUT_OF_TRIM_G for n in side[:2] if n in points):
            return fault
        held = [held for n in sorted(points) if (held := points[n].held)]
        span = f"{round(held[0].load_factor, 1) + 0.0:.1f} to {held[-1].load_factor:.1f} g flown"
        for less, more in pairwise(held):
            ends = [round(each.load_factor, 2) + 0.0 for each in (less, more)]
            label = f"{ends[0]:.2f} to {ends[1]:.2f} g, tab {degrees(tab):+.3g} deg; {span}"
            slope = _slope(label, "load_factor", less, more)
            slopes.append(Compared(label, -slope.with_loader, -slope.feel))
    return Quantity(FORCE, tuple(slopes))


def _of_speeds(case: FlightCase, speeds: list[Point]) -> dict[str, Quantity | str]:
    """Quantities over speed; a push above trim and a pull below count positive."""
    trim, fault = case.speed_m_per_s, _first_fault(speeds)
    flown = [(point.label, point.held) for point in speeds if point.held]
    sides = [sum(sign * (held.speed_m_per_s - trim) > 0 for _, held in flown) for sign in (1, -1)]
    over = Quantity(FORCE, tuple(_force(label, held) for label, held in flown))
    numbers = {"force over speed": over if min(sides) >= _EACH_SIDE else fault}
    names = ("smallest force towards the speed", "smallest force over speed", "average force over speed")
    if fault:
        return numbers | dict.fromkeys(names, fault)
    towards = tuple(_force(label, held, float(np.sign(held.speed_m_per_s - trim))) for label, held in flown)
    # The trimmed flight itself has no force.
    still = HeldFlight(trim, 1.0, 0.0, 0.0, 0.0)
    in_order = sorted((*(held for _, held in flown), still), key=lambda held: held.speed_m_per_s)
    shares = [f"{100 * held.speed_m_per_s / trim:.0f}" for held in in_order]
    parts = [(f"{shares[k]} to {shares[k + 1]} %", in_order[k], in_order[k + 1]) for k in range(len(flown))]
    slopes = tuple(_slope(label, "speed_m_per_s", slow, fast) for label, slow, fast in parts)
    average = _slope(f"{shares[0]} to {shares[-1]} % of the trim speed", "speed_m_per_s", in_order[0], in_order[-1])
    quantities = (Quantity(FORCE, towards), Quantity(FORCE_OVER_SPEED, slopes), Quantity(FORCE_OVER_SPEED, (average,)))
    return numbers | dict(zip(names, quantities, strict=True))


def _first_fault(points: Iterable[Point]) -> str:
    return next((point.fault for point in points if not point.held), "")


def _force(label: str, held: HeldFlight, sign: float = 1.0) -> Compared:
    return Compared(label, sign * held.force_n, sign * held.feel_n)


def _slope(label: str, over: str, first: HeldFlight, second: HeldFlight) -> Compared:
    gained = getattr(second, over) - getattr(first, over)
    return Compared(label, (second.force_n - first.force_n) / gained, (second.feel_n - first.feel_n) / gained)


def _largest_force(points: tuple[Point, ...]) -> Quantity | str:
    """Of what a pilot holds for a short time; large load factors are not among it."""
    forces = [_force(point.label, point.held) for point in points if point.held]
    sizes = tuple(Compared(force.label, abs(force.with_loader), abs(force.feel)) for force in forces)
    return _first_fault(points) or Quantity(FORCE, sizes)


def _of_maneuvers(maneuvers: list[Maneuver], faults: dict[str, str]) -> dict[str, Quantity | str]:
    """Largest differences of time histories, the free return, the phugoid."""
    numbers: dict[str, Quantity | str] = {}
    flown = {maneuver.name: maneuver for maneuver in maneuvers}
    for name, row, unit in ((name, row, unit) for name, rows in HISTORIES.items() for row, unit in rows.items()):
        key = f"{name}: {row.replace('_', ' ')}"
        if name not in flown:
            numbers[key] = faults.get(name, "")
            continue
        with_loader, alone = flown[name].flown.states[row], flown[name].alone.states[row]
        worst = int(np.argmax(np.abs(with_loader - alone)))
        time = f"{flown[name].flown.time_s[worst]:.1f} s"
        numbers[key] = Quantity(unit, (Compared(time, float(with_loader[worst]), float(alone[worst])),))
    for key in ("period", "damping ratio"):
        numbers[f"phugoid: {key}"] = faults.get("phugoid") or _measured([flown["phugoid"]], key)
    releases = [maneuver for maneuver in maneuvers if maneuver.name == "release"]
    numbers["free return"] = faults.get("release") or _measured(releases, "off the trim speed")
    return numbers


def _measured(maneuvers: list[Maneuver], name: str) -> Quantity | str:
    """The sizes of a measure."""
    measures = [
        (maneuver.label, measure) for maneuver in maneuvers for measure in maneuver.measures if measure.name == name
    ]
    if not measures:
        return "no swing was found in the free motion"
    unit = PERCENT if name == "off the trim speed" else measures[0][1].unit
    points = tuple(Compared(label, abs(measure.with_loader), abs(measure.alone)) for label, measure in measures)
    if name == "force":  # the hand's own is that of the maneuver; the feel's is that of the same states
        feel = _measured(maneuvers, "force of the programmed feel in the same states")
        assert not isinstance(feel, str)
        points = tuple(replace(point, feel=same.with_loader) for point, same in zip(points, feel.points, strict=True))
    return Quantity(unit, points)


def _n_per_alpha(case: FlightCase) -> float:
    """Load factor per angle of attack at constant speed, 1/rad, from pull-ups that JSBSim trims."""
    beyond = case.trim.data.limit_load_factor - 1
    states = [case.at(load_factor=1 + share * beyond).state() for share in _PULLS[:_SMALL]]
    gained = [states[1][name] - states[0][name] for name in ("load_factor", "angle_of_attack")]
    return gained[0] / gained[1]


@of_result
def flight_conclusions(report: FlightReport) -> Conclusions:
    """What the rules came to, in sentences."""
    verdicts = report.verdicts
    count = {outcome: sum(verdict.outcome is outcome for verdict in verdicts) for outcome in Outcome}
    parts = [f"{number} {outcome}" for outcome, number in count.items() if number and outcome is not Outcome.MET]
    met = f"{count[Outcome.MET]} of {len(verdicts)} rows met"
    rows = f"all {len(verdicts)} rows met" if report.fulfilled else ", ".join((met, *parts))
    findings = [
        f"{verdict.rule.label}, {verdict.rule.name.lower()}: {verdict.outcome}, {verdict.where}."
        for verdict in verdicts
        if verdict.outcome is not Outcome.MET
    ]
    findings += [
        f"{verdict.rule.label} allows more than the force itself: it proves little of this control."
        for verdict in verdicts
        if verdict.loose
    ]
    findings += [
        f"{verdict.rule.label}: {verdict.where.rpartition('; ')[2]} of -1 to 2.5 g; beyond, JSBSim does not trim the aircraft."
        for verdict in verdicts
        if verdict.quantity == _OUT_OF_TRIM and verdict.unit
    ]
    if any(not verdict.rule.verified for verdict in verdicts):
        findings.append("Rows marked as unverified are to be confirmed against the document.")
    for name in report.case.without if report.case.axis == "pitch" else ():
        number = {"flaps": "2.c.2", "speed-brake": "2.c.3", "gear": "2.c.4"}[name]
        lever = name.replace("-", " ")
        findings.append(f"JSBSim's {report.case.aircraft} has no {lever} that a lever moves: {number} does not apply.")
    findings.append(f"The numbers of the aircraft's {report.case.axis} control are illustrative.")
    name = f"{report.case.loader.name} as the {report.case.axis} control of {report.case.aircraft}"
    return Conclusions(report.fulfilled, f"{name}: {rows}.", tuple(findings))
