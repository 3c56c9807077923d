"""Conclusions from a qualification, in sentences."""

from math import isfinite

from forcefeel.conclusions import Conclusions, capital, of_result
from forcefeel.qualification import Outcome, Verdict
from forcefeel.qualification.figures import Figure
from forcefeel.qualification.plan.plan import OF_THE_AIRCRAFT, RuleTestCase, is_by_hand
from forcefeel.qualification.plan.result import Qualification, QualificationStatus, Result, Section
from forcefeel.qualification.release import ReleaseFeatures
from forcefeel.sizing.too_small import too_small_text
from forcefeel.units import ANGLE, ANGULAR_VELOCITY, FORCE, LENGTH, RATIO, SECONDS, Unit, UnitSystem, to_text

UNITS = {
    "s": SECONDS,
    "rad": ANGLE,
    "m": LENGTH,
    "N": FORCE,
    "": RATIO,
    "rad/s": ANGULAR_VELOCITY,
    "N/rad": Unit("N/rad", "N/deg", "lb/deg"),
    "N/m": Unit("N/m", "N/cm", "lb/in"),
}
"""Displayed units of the figures, by their SI unit."""

_ORDER = ("P0", "P1", "fall time", "rise time")
"""What a sentence speaks of first."""


def quantity(value: float, unit: str, system: UnitSystem, digits: int = 3) -> str:
    """A figure with its unit."""
    measured_in = UNITS[unit]
    return f"{to_text(measured_in.from_si(value, system), digits)} {measured_in.shown(system)}".strip()


@of_result
def conclusions(found: Qualification) -> Conclusions:
    """Conclusions; ``ok`` if the loader qualifies, or passes the requested tests where only some were requested."""
    if len(found.sections) == 1:
        lines = reasons(found.sections[0], found)
    else:
        lines = [" ".join([standing_text(one), *reasons(one, found)]) for one in found.sections]
    remarks = [section.law_remark for section in found.sections if section.law_remark]
    return Conclusions(found.fulfilled, _verdict(found), (*lines, *remarks, *caveats(found)))


def rule_text(found: Qualification) -> str:
    """The rule, its edition, and whether it is verified against the document."""
    rows = [trial.test.is_verified(one) for trial in found.test_plan.made for one in trial.test.tolerances]
    unverified = "" if all(rows) else ", in part unverified" if any(rows) else ", unverified"
    return f"{found.rules.title} ({found.rules.edition}{unverified})"


def _verdict(found: Qualification) -> str:
    rule = f"By {rule_text(found)}"
    if len(found.sections) == 1:
        (section,) = found.sections
        return _sentence(f"{rule} {_standing(section)}")
    good = [section.title for section in found.sections if section.fulfilled]
    short = any(section.status is not QualificationStatus.QUALIFIES for section in found.sections if section.fulfilled)
    does = "passed the requested tests" if short else f"qualif{'y' if len(good) > 1 else 'ies'}"
    number = f"{len(good)} of {len(found.sections)} laws" if good else f"none of {len(found.sections)} laws"
    return _sentence(f"{rule} {number} {does}{': ' if good else ''}{', '.join(good)}{_asked(found)}")


def _asked(found: Qualification | Section) -> str:
    """What alone was asked for."""
    return f" (requested: {', '.join(found.test_plan.named)})" if found.test_plan.named else ""


def standing_text(section: Section) -> str:
    """What the tests of a section come to, in a sentence."""
    return _sentence(_standing(section))


def _standing(section: Section) -> str:
    """What the tests of a section come to, with what is missing and what alone was made."""
    came = outcome_counts(section) + _asked(section)
    match section.status:
        case QualificationStatus.QUALIFIES:
            rest = "; the rule requires no more" if section.count(Outcome.NOT_EVALUATED) else ""
            return f"{_titled(section)} qualifies: {came}{rest}"
        case QualificationStatus.DOES_NOT_QUALIFY:
            return f"{_titled(section)} does not qualify: {came}"
        case QualificationStatus.INCOMPLETE:
            return f"the qualification of {_titled(section)} is incomplete: {came}. Missing: {missing_text(section)}"


def _titled(section: Section) -> str:
    """The title as a sentence has it: a law by its name without an article."""
    return section.title if section.title.startswith("law ") else f"the {section.title}"


def missing_text(section: Section) -> str:
    """What a whole programme lacks, by the reason; tests of which one would do with an *or* between them."""
    results = {one.trial.key: one for one in section.results}
    why: dict[str, list[str]] = {}
    for group in section.missing:
        reasons = dict.fromkeys(_why_missing(results.get(trial.key)) for trial in group)
        why.setdefault("; ".join(reasons), []).append(" or ".join(trial.key for trial in group))
    text = "; ".join(f"{', '.join(keys)} ({reason})" for reason, keys in why.items())
    alternate = [trial.key for trial in section.test_plan.trials if trial.test.kind == "dynamic sweep"]
    releases = [group[0].key for group in section.missing if group[0].test.kind == "release"]
    if alternate and any(_why_missing(results.get(key)) != Outcome.TOO_CLOSE for key in releases):
        text += f"; {' and '.join(alternate)} can replace the releases"
    return text


def _why_missing(result: Result | None) -> str:
    if result is None:
        return "not requested"
    if result.outcome is Outcome.TOO_CLOSE:
        return str(Outcome.TOO_CLOSE)
    return result.reason or next(one.reason for one in result.verdicts if one.outcome is Outcome.NOT_EVALUATED)


def outcome_counts(section: Section) -> str:
    """How many tests came to what: ``1 of 7 tests passed, 6 failed``."""
    others = (Outcome.FAILED, Outcome.TOO_CLOSE, Outcome.NOT_EVALUATED)
    parts = [f"{section.count(Outcome.PASSED)} of {len(section.results)} tests passed"]
    return ", ".join(parts + [f"{number} {outcome}" for outcome in others if (number := section.count(outcome))])


def reasons(section: Section, found: Qualification) -> list[str]:
    """Why a section does not qualify: the first release and the first sweep that are off."""
    bad = [one for one in section.results if one.outcome in (Outcome.FAILED, Outcome.TOO_CLOSE)]
    releases = [one for one in bad if one.trial.test.kind == "release"]
    sweeps = [one for one in bad if one.trial.test.kind != "release"]
    return [f"{one[0].trial.title}: {result_text(one[0], found)}" for one in (releases, sweeps) if one]


def result_text(result: Result, found: Qualification) -> str:
    """What a test came to, in a sentence."""
    system = found.system
    if result.reason:
        return _sentence(result.reason)
    bad = [one for one in result.verdicts if one.outcome is Outcome.FAILED]
    bad = bad or [one for one in result.verdicts if one.outcome is Outcome.TOO_CLOSE]
    if not bad:
        missing = [one for one in result.verdicts if one.outcome is Outcome.NOT_EVALUATED]
        if missing:
            return _sentence(f"{missing[0].quantity} was not evaluated: {missing[0].reason}")
        return "All within tolerance; " + _closest(result, system)
    first = min(
        bad, key=lambda one: (_ORDER.index(one.quantity) if one.quantity in _ORDER else len(_ORDER), _share(one))
    )
    others = [one.quantity for one in bad if one is not first]
    close = first.outcome is Outcome.TOO_CLOSE
    told = _sentence(f"{'too close to call: ' if close else ''}{_told(first, result, found)}")
    if not others or close:
        return told
    return f"{told} Also out of tolerance: {', '.join(others)}."


def _told(verdict: Verdict, result: Result, found: Qualification) -> str:
    """A quantity that is off."""
    system, name = found.system, verdict.quantity
    if verdict.measured is None or verdict.reference is None or not isfinite(verdict.difference):
        return f"{name}: {verdict.reason}" if verdict.reason else f"{name} is missing"
    mine, theirs, unit = verdict.measured.value, verdict.reference.value, verdict.unit
    asked = "recorded" if recorded(found, "reference") else "programmed"
    if unit == "s":
        off = f"{to_text(100 * abs(verdict.difference) / theirs, 2)} % too {'long' if mine > theirs else 'short'}"
        told = f"{name} is {off}: {quantity(mine, unit, system)}, {quantity(theirs, unit, system)} {asked}"
        frequencies = _frequencies(result)
        if frequencies is None:
            return told
        return f"{told} (frequency {frequencies[0]} Hz, {frequencies[1]} Hz {asked})"
    allowed = quantity(verdict.tolerance, unit, system)
    where = "" if verdict.at is None else f" at {quantity(verdict.at, _at_unit(result), system)}"
    return (
        f"{name} is {quantity(mine, unit, system)}{where}, {quantity(theirs, unit, system)} {asked}; the allowed difference is "
        f"{allowed or '0'}"
    )


def _frequencies(result: Result) -> tuple[str, str] | None:
    """Of the first full cycle, of both; ``None`` where one of them has none."""
    both = []
    for side in (result.measured, result.reference):
        if side is None or not isinstance(side.features, ReleaseFeatures) or len(side.features.cycles) < 2:
            return None
        both.append(to_text(1 / side.features.cycles[1].value, 3))
    return both[0], both[1]


def _at_unit(result: Result) -> str:
    if result.trial.test.kind == "small inputs":
        return "s"
    return "rad" if result.measured is None else result.measured.record.position_unit


def _closest(result: Result, system: UnitSystem) -> str:
    known = [one for one in result.verdicts if isfinite(one.margin) and one.tolerance > 0]
    if not known:
        return "no figure was compared."
    least = min(known, key=_share)
    return f"the closest is {least.quantity}, with {to_text(100 * _share(least), 2)} % of its tolerance left."


def _share(verdict: Verdict) -> float:
    """Margin as a share of the tolerance."""
    return verdict.margin / verdict.tolerance if isfinite(verdict.margin) and verdict.tolerance > 0 else 0.0


def caveats(found: Qualification) -> tuple[str, ...]:
    """What else a reader must know."""
    small = "" if recorded(found, "record") else too_small_text(found.loader, found.system)
    lines = [small] if small else []
    by_hand = [trial for trial in found.test_plan.outside if is_by_hand(trial)]
    if outside := [trial for trial in found.test_plan.outside if trial not in by_hand]:
        tests = ", ".join(f"{trial.key} ({trial.test.number}; {why_outside(trial, found)})" for trial in outside)
        lines.append(f"Tests that cannot be simulated: {tests}. Evaluate them on records of the simulator.")
    if by_hand:
        tests = ", ".join(f"{trial.key} ({trial.test.number})" for trial in by_hand)
        lines.append(f"Tests to be judged by hand on the simulator: {tests}.")
    lines.append(f"Reference: {found.reference}.")
    low, high = (quantity(end, "rad", found.system) for end in (found.throw.low_rad, found.throw.high_rad))
    lines.append(f"Throw: {low} to {high}, {found.throw.source}.")
    if unverified := unverified_tests(found):
        lines.append(f"Not verified against the document: {', '.join(unverified)} of {found.rules.title}.")
    if found.omitted:
        lines.append(f"Hands off: {', '.join(found.omitted)} of the loader are omitted.")
    return tuple(lines)


def why_outside(trial: RuleTestCase, found: Qualification) -> str:
    """Why a test of the rule is not simulated."""
    return "judged by hand" if recorded(found, "record") else OF_THE_AIRCRAFT[trial.key]


def unverified_tests(found: Qualification) -> list[str]:
    """Numbers of the tests with rows that are not verified, and the durations of the sweeps."""
    made = found.test_plan.made
    numbers = list(dict.fromkeys(f"test {trial.test.number}" for trial in made if not trial.verified))
    swept = any(trial.sweep for trial in made)
    durations = ["the durations of the sweeps"] if swept and not all(one.verified for one in found.rules.sweeps) else []
    release = [] if found.rules.release.verified else ["the shares of a release"]
    return [*numbers, *durations, *release]


def figure_text(figure: Figure | None, system: UnitSystem) -> str:
    """A figure as a table has it, without its unit; a dash where there is none."""
    if figure is None or not figure.known:
        return "–"
    return to_text(UNITS[figure.unit].from_si(figure.value, system), 4)


def recorded(found: Qualification, kind: str) -> bool:
    """Whether there were files of a ``record`` or a ``reference``."""
    return any(name.startswith(kind) for name in found.files)


def _sentence(text: str) -> str:
    return capital(text).rstrip(".") + "."
