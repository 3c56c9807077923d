"""A loader's report in flight: held load factors and speeds, maneuvers, and the rules that apply to the aircraft."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise

import numpy as np

from forcefeel.conclusions import Conclusions, of_result
from forcefeel.errors import InputError
from forcefeel.fly.aircraft import Aircraft
from forcefeel.fly.case import FlightCase, HeldFlight
from forcefeel.fly.maneuvers import AIRSPEED, ALTITUDE, Maneuver, ManeuverRequest, fly_maneuver
from forcefeel.fly.rules import Compared, FlightVerdict, Outcome, Quantity, flight_rules, judge
from forcefeel.units import ANGLE, FORCE, PERCENT, RATIO, Unit, UnitSystem, factor

FORCE_OVER_SPEED = Unit("N s/m", "N s/m", "lb/kt")

_PULLS = (0.1, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Shares of the way from 1 g to the limit load factor."""
_SMALL = 2
"""Pulls from which the force per g is taken, and the largest force that a short maneuver needs."""
_HELD_G = 0.1
"""Load factor by which a held flight may be off."""
_SPEEDS = (0.85, 0.925, 1.075, 1.15)
"""Shares of the trim speed: 14 CFR 25.175(a)."""
_RELEASES = (0.85, 1.15)
_FREE_RETURN = ("light", "transport")
"""Categories whose rules ask for a free return."""
_EACH_SIDE = 2
"""Speeds above and below trim that 14 CFR Part 60 requires."""
_HISTORIES = {
    "power": {"calibrated_airspeed": AIRSPEED, "altitude": ALTITUDE, "pitch_attitude": ANGLE},
    "flaps": {"calibrated_airspeed": AIRSPEED, "altitude": ALTITUDE, "pitch_attitude": ANGLE},
    "short-period": {"pitch_attitude": ANGLE, "load_factor": RATIO},
}
"""Maneuvers whose time histories are compared."""


@dataclass(frozen=True)
class Point:
    """A load factor or a speed that was to be held.

    Attributes:
        target: Load factor, or calibrated airspeed, m/s.
        held: The flight; none if it failed.
        fault: Why it failed.
    """

    target: float
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
    maneuvers: tuple[Maneuver, ...] = field(repr=False)
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
        >>> case = ff.fly.FlightCase(ff.digital_elevator(), "T38", 154.0, 3048.0, "robust")
        >>> ff.fly.fly_rules(case).pulls[0].held.load_factor > 1.5
        True
    """
    data, beyond = case.trim.data, case.trim.data.limit_load_factor - 1
    progress("load factors")
    pulls = [_point(case, n, partial(case.at, load_factor=n)) for n in (1 + share * beyond for share in _PULLS)]
    progress("speeds")
    speeds = [_point(case, v, partial(case.at, v)) for v in (share * case.speed_m_per_s for share in _SPEEDS)]
    maneuvers: list[Maneuver] = []
    faults: dict[str, str] = {}
    requests = [(name, ManeuverRequest()) for name in _HISTORIES]
    if data.category in _FREE_RETURN:
        requests += [("release", ManeuverRequest(off_trim=share)) for share in _RELEASES]
    for name, request in requests:
        progress(name)
        try:
            maneuvers.append(fly_maneuver(case, name, request))
        except InputError as error:
            faults[name] = str(error)
    flown: dict[str, Quantity | str] = {**_of_pulls(pulls, data.limit_load_factor), **_of_speeds(case, speeds)}
    flown |= {"largest force": _largest_force((*pulls[:_SMALL], *speeds))}
    flown |= _of_maneuvers(case, maneuvers, faults)
    conditions = {"n_L - 1": beyond, "weight": (data.maximum_weight_n or 0.0) * factor("N", "lb")}
    applying = [rule for rule in flight_rules() if rule.applies(data)]
    if data.category == "military" and not isinstance(flown["force per g"], str):
        conditions["n / alpha"] = _n_per_alpha(case)
    verdicts = tuple(verdict for rule in applying for verdict in judge(rule, flown, conditions))
    return FlightReport(case, tuple(pulls), tuple(speeds), tuple(maneuvers), faults, verdicts)


def _point(case: FlightCase, target: float, trimmed: Callable[[], Aircraft]) -> Point:
    try:
        begins = trimmed()
        load_factor = begins.state()["load_factor"]
        held = case.held(begins)
    except InputError as error:
        return Point(target, None, str(error))
    if abs(held.load_factor - load_factor) > _HELD_G:
        fault = f"the pilot held {held.load_factor:.2f} g instead of {load_factor:.2f} g: the column does not follow the hand"
        return Point(target, None, fault)
    return Point(target, held)


def _of_pulls(pulls: list[Point], limit_load_factor: float) -> dict[str, Quantity | str]:
    """Quantities over load factor; a pull is counted positive."""
    flown = [point.held for point in pulls if point.held]
    faults = [point.fault for point in pulls[:_SMALL] if not point.held]
    if faults:
        names = ("force over load factor", "force per g", "force at the limit load factor")
        return dict.fromkeys(names, faults[0])
    compared = tuple(Compared(f"{held.load_factor:.2f} g", held.force_n, held.feel_n) for held in flown)
    first, second = flown[:_SMALL]
    last = flown[-1]
    per_g, at_end = _pull_per_g(first, second), _pull_per_g(flown[-2], last)
    left = limit_load_factor - last.load_factor if pulls[-1].held is None else 0.0
    label = (
        f"extrapolated from {last.load_factor:.2f} g, the most that trims and is held"
        if left
        else f"{last.load_factor:.2f} g"
    )
    at_limit = Compared(label, -last.force_n + at_end[0] * left, -last.feel_n + at_end[1] * left)
    label = f"{first.load_factor:.2f} to {second.load_factor:.2f} g"
    return {
        "force over load factor": Quantity(FORCE, compared),
        "force per g": Quantity(FORCE, (Compared(label, *per_g),)),
        "force at the limit load factor": Quantity(FORCE, (at_limit,)),
    }


def _pull_per_g(first: HeldFlight, second: HeldFlight) -> tuple[float, float]:
    """With the loader, and of the feel."""
    gained = second.load_factor - first.load_factor
    return (first.force_n - second.force_n) / gained, (first.feel_n - second.feel_n) / gained


def _of_speeds(case: FlightCase, speeds: list[Point]) -> dict[str, Quantity | str]:
    """Quantities over speed; a push above trim and a pull below count positive."""
    trim = case.speed_m_per_s
    flown = [point.held for point in speeds if point.held]
    fault = next((point.fault for point in speeds if not point.held), "")

    def label(held: HeldFlight) -> str:
        return f"{100 * held.speed_m_per_s / trim:.0f} % of the trim speed"

    sides = [sum(sign * (held.speed_m_per_s - trim) > 0 for held in flown) for sign in (1, -1)]
    over = tuple(Compared(label(held), held.force_n, held.feel_n) for held in flown)
    numbers: dict[str, Quantity | str] = {
        "force over speed": Quantity(FORCE, over) if min(sides) >= _EACH_SIDE else fault
    }
    names = ("smallest force towards the speed", "smallest force over speed", "average force over speed")
    if fault:
        return numbers | dict.fromkeys(names, fault)
    towards = tuple(
        Compared(label(held), *(np.sign(held.speed_m_per_s - trim) * force for force in (held.force_n, held.feel_n)))
        for held in flown
    )
    # The trimmed flight itself has no force.
    still = HeldFlight(trim, 1.0, 0.0, 0.0, 0.0)
    in_order = sorted((*flown, still), key=lambda held: held.speed_m_per_s)
    slopes = tuple(
        _slope(f"{label(a).removesuffix(' of the trim speed')} to {label(b)}", a, b) for a, b in pairwise(in_order)
    )
    average = _slope(f"{label(in_order[0])} to {label(in_order[-1])}", in_order[0], in_order[-1])
    quantities = (Quantity(FORCE, towards), Quantity(FORCE_OVER_SPEED, slopes), Quantity(FORCE_OVER_SPEED, (average,)))
    return numbers | dict(zip(names, quantities, strict=True))


def _slope(label: str, slow: HeldFlight, fast: HeldFlight) -> Compared:
    gained = fast.speed_m_per_s - slow.speed_m_per_s
    return Compared(label, (fast.force_n - slow.force_n) / gained, (fast.feel_n - slow.feel_n) / gained)


def _largest_force(points: tuple[Point, ...]) -> Quantity | str:
    """Of what a pilot holds for a short time; the limit load factor is not among it."""
    if fault := next((point.fault for point in points if not point.held), ""):
        return fault
    return Quantity(
        FORCE,
        tuple(
            Compared(
                f"{held.load_factor:.2f} g, {AIRSPEED.from_si(held.speed_m_per_s, UnitSystem.US):.0f} kt",
                abs(held.force_n),
                abs(held.feel_n),
            )
            for held in (point.held for point in points)
            if held
        ),
    )


def _of_maneuvers(case: FlightCase, maneuvers: list[Maneuver], faults: dict[str, str]) -> dict[str, Quantity | str]:
    numbers: dict[str, Quantity | str] = {}
    for name, rows in _HISTORIES.items():
        maneuver = next((maneuver for maneuver in maneuvers if maneuver.name == name), None)
        for row, unit in rows.items():
            key = f"{name}: {row.replace('_', ' ')}"
            if maneuver is None:
                numbers[key] = faults[name]
                continue
            with_loader, alone = maneuver.flown.states[row], maneuver.alone.states[row]
            worst = int(np.argmax(np.abs(with_loader - alone)))
            time = f"{maneuver.flown.time_s[worst]:.1f} s"
            numbers[key] = Quantity(unit, (Compared(time, float(with_loader[worst]), float(alone[worst])),))
    releases = [maneuver for maneuver in maneuvers if maneuver.name == "release"]
    returns = tuple(
        Compared(maneuver.label, abs(measure.with_loader), abs(measure.alone))
        for maneuver in releases
        for measure in maneuver.measures
        if measure.name == "off the trim speed"
    )
    numbers["free return"] = faults.get("release") or Quantity(PERCENT, returns)
    return numbers


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
    rows = f"all {len(verdicts)} rows met" if report.fulfilled else f"{', '.join(parts)} of {len(verdicts)} rows"
    findings = [
        f"{verdict.rule.document} {verdict.rule.number}, {verdict.rule.name.lower()}: {verdict.outcome}, {verdict.where}."
        for verdict in verdicts
        if verdict.outcome is not Outcome.MET
    ]
    findings += [
        f"{verdict.rule.number} allows more than the force itself: it proves little of this control."
        for verdict in verdicts
        if verdict.loose
    ]
    if any(not verdict.rule.verified for verdict in verdicts):
        findings.append("Rows marked as unverified are to be confirmed against the document.")
    findings.append("The numbers of the aircraft's pitch control are illustrative.")
    name = report.case.loader.name
    return Conclusions(report.fulfilled, f"{name} with {report.case.aircraft}: {rows}.", tuple(findings))
