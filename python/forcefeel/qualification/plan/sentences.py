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

_ROUNDING = 1e-4
"""Share of the tolerance below which the programmed feel has none of a quantity: what is left is rounding."""


def quantity(value: float, unit: str, system: UnitSystem, digits: int = 3) -> str:
    """A figure with its unit."""
    measured_in = UNITS[unit]
    return f"{to_text(measured_in.from_si(value, system), digits)} {measured_in.shown(system)}".strip()


@of_result
def conclusions(qualification: Qualification) -> Conclusions:
    """Conclusions; ``ok`` if the loader qualifies, or passes the requested tests where only some were requested."""
    if len(qualification.sections) == 1:
        lines = reasons(qualification.sections[0], qualification)
    else:
        lines = [
            " ".join([standing_text(section), *reasons(section, qualification)]) for section in qualification.sections
        ]
    remarks = [section.law_remark for section in qualification.sections if section.law_remark]
    return Conclusions(qualification.fulfilled, _verdict(qualification), (*lines, *remarks, *caveats(qualification)))


def rule_text(qualification: Qualification) -> str:
    """The rule, its edition, and whether it is verified against the document."""
    rows = [
        trial.test.is_verified(tolerance)
        for trial in qualification.test_plan.made
        for tolerance in trial.test.tolerances
    ]
    unverified = "" if all(rows) else ", in part unverified" if any(rows) else ", unverified"
    return f"{qualification.rules.title} ({qualification.rules.edition}{unverified})"


def _verdict(qualification: Qualification) -> str:
    rule = f"By {rule_text(qualification)}"
    if len(qualification.sections) == 1:
        (section,) = qualification.sections
        return _sentence(f"{rule} {_standing(section)}")
    good = [section.title for section in qualification.sections if section.fulfilled]
    short = any(
        section.status is not QualificationStatus.QUALIFIES for section in qualification.sections if section.fulfilled
    )
    does = "passed the requested tests" if short else f"qualif{'y' if len(good) > 1 else 'ies'}"
    number = (
        f"{len(good)} of {len(qualification.sections)} laws" if good else f"none of {len(qualification.sections)} laws"
    )
    return _sentence(f"{rule} {number} {does}{': ' if good else ''}{', '.join(good)}{_requested(qualification)}")


def _requested(tested: Qualification | Section) -> str:
    """What alone was asked for."""
    return f" (requested: {', '.join(tested.test_plan.named)})" if tested.test_plan.named else ""


def standing_text(section: Section) -> str:
    """What the tests of a section come to, in a sentence."""
    return _sentence(_standing(section))


def _standing(section: Section) -> str:
    """What the tests of a section come to, with what is missing and what alone was made."""
    came = outcome_counts(section) + _requested(section)
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
    """Missing tests of a whole test plan, by the reason; alternatives are joined by *or*."""
    results = {result.trial.key: result for result in section.results}
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
    return result.reason or next(
        verdict.reason for verdict in result.verdicts if verdict.outcome is Outcome.NOT_EVALUATED
    )


def outcome_counts(section: Section) -> str:
    """How many tests came to what: ``1 of 7 tests passed, 6 failed``."""
    others = (Outcome.FAILED, Outcome.TOO_CLOSE, Outcome.NOT_EVALUATED)
    parts = [f"{section.count(Outcome.PASSED)} of {len(section.results)} tests passed"]
    return ", ".join(parts + [f"{number} {outcome}" for outcome in others if (number := section.count(outcome))])


def reasons(section: Section, qualification: Qualification) -> list[str]:
    """Why a section does not qualify: the first release and the first sweep that are off."""
    bad = [result for result in section.results if result.outcome in (Outcome.FAILED, Outcome.TOO_CLOSE)]
    releases = [result for result in bad if result.trial.test.kind == "release"]
    sweeps = [result for result in bad if result.trial.test.kind != "release"]
    return [
        f"{results[0].trial.title}: {result_text(results[0], qualification)}"
        for results in (releases, sweeps)
        if results
    ]


def result_text(result: Result, qualification: Qualification) -> str:
    """What a test came to, in a sentence."""
    system = qualification.system
    if result.reason:
        return _sentence(result.reason)
    bad = [verdict for verdict in result.verdicts if verdict.outcome is Outcome.FAILED]
    bad = bad or [verdict for verdict in result.verdicts if verdict.outcome is Outcome.TOO_CLOSE]
    if not bad:
        missing = [verdict for verdict in result.verdicts if verdict.outcome is Outcome.NOT_EVALUATED]
        if missing:
            return _sentence(f"{missing[0].quantity} was not evaluated: {missing[0].reason}")
        return "All within tolerance; " + _closest(result, system)
    first = min(
        bad,
        key=lambda verdict: (
            _ORDER.index(verdict.quantity) if verdict.quantity in _ORDER else len(_ORDER),
            _share(verdict),
        ),
    )
    others = [verdict.quantity for verdict in bad if verdict is not first]
    close = first.outcome is Outcome.TOO_CLOSE
    text = _sentence(f"{'too close to call: ' if close else ''}{_deviation_text(first, result, qualification)}")
    if not others or close:
        return text
    return f"{text} Also out of tolerance: {', '.join(others)}."


def _deviation_text(verdict: Verdict, result: Result, qualification: Qualification) -> str:
    """A quantity that is off."""
    system, name = qualification.system, verdict.quantity
    if verdict.measured is None or verdict.reference is None or not isfinite(verdict.difference):
        return f"{name}: {verdict.reason}" if verdict.reason else f"{name} is missing"
    actual, expected, unit = verdict.measured.value, verdict.reference.value, verdict.unit
    origin = "recorded" if recorded(qualification, "reference") else "programmed"
    if unit == "s":
        off = f"{to_text(100 * abs(verdict.difference) / expected, 2)} % too {'long' if actual > expected else 'short'}"
        text = f"{name} is {off}: {quantity(actual, unit, system)}, {quantity(expected, unit, system)} {origin}"
        frequencies = _frequencies(result)
        if frequencies is None:
            return text
        return f"{text} (frequency {frequencies[0]} Hz, {frequencies[1]} Hz {origin})"
    if abs(expected) < _ROUNDING * abs(verdict.tolerance):
        expected = 0.0
    allowed = quantity(verdict.tolerance, unit, system)
    where = "" if verdict.at is None else f" at {quantity(verdict.at, _at_unit(result), system)}"
    return (
        f"{name} is {quantity(actual, unit, system)}{where}, {quantity(expected, unit, system)} {origin}; the "
        f"allowed difference is {allowed or '0'}"
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
    known = [verdict for verdict in result.verdicts if isfinite(verdict.margin) and verdict.tolerance > 0]
    if not known:
        return "no figure was compared."
    least = min(known, key=_share)
    return f"the closest is {least.quantity}, with {to_text(100 * _share(least), 2)} % of its tolerance left."


def _share(verdict: Verdict) -> float:
    """Margin as a share of the tolerance."""
    return verdict.margin / verdict.tolerance if isfinite(verdict.margin) and verdict.tolerance > 0 else 0.0


def caveats(qualification: Qualification) -> tuple[str, ...]:
    """What else a reader must know."""
    small = "" if recorded(qualification, "record") else too_small_text(qualification.loader, qualification.system)
    lines = [small] if small else []
    by_hand = [trial for trial in qualification.test_plan.outside if is_by_hand(trial)]
    if outside := [trial for trial in qualification.test_plan.outside if trial not in by_hand]:
        tests = ", ".join(
            f"{trial.key} ({trial.test.number}; {why_outside(trial, qualification)})" for trial in outside
        )
        lines.append(f"Tests that cannot be simulated: {tests}. Evaluate them on records of the simulator.")
    if by_hand:
        tests = ", ".join(f"{trial.key} ({trial.test.number})" for trial in by_hand)
        lines.append(f"Tests to be judged by hand on the simulator: {tests}.")
    lines.append(f"Reference: {qualification.reference}.")
    low, high = (
        quantity(end, "rad", qualification.system)
        for end in (qualification.throw.low_rad, qualification.throw.high_rad)
    )
    lines.append(f"Throw: {low} to {high}, {qualification.throw.source}.")
    if unverified := unverified_tests(qualification):
        lines.append(f"Not verified against the document: {', '.join(unverified)} of {qualification.rules.title}.")
    if qualification.omitted:
        lines.append(f"Hands off: {', '.join(qualification.omitted)} of the loader are omitted.")
    return tuple(lines)


def why_outside(trial: RuleTestCase, qualification: Qualification) -> str:
    """Why a test of the rule is not simulated."""
    return "judged by hand" if recorded(qualification, "record") else OF_THE_AIRCRAFT[trial.key]


def unverified_tests(qualification: Qualification) -> list[str]:
    """Numbers of the tests with rows that are not verified, and the durations of the sweeps."""
    made = qualification.test_plan.made
    numbers = list(dict.fromkeys(f"test {trial.test.number}" for trial in made if not trial.verified))
    swept = any(trial.sweep for trial in made)
    durations = (
        ["the durations of the sweeps"]
        if swept and not all(sweep.verified for sweep in qualification.rules.sweeps)
        else []
    )
    release = [] if qualification.rules.release.verified else ["the shares of a release"]
    return [*numbers, *durations, *release]


def figure_text(figure: Figure | None, system: UnitSystem) -> str:
    """A figure as a table has it, without its unit; a dash without a figure."""
    if figure is None or not figure.known:
        return "–"
    return to_text(UNITS[figure.unit].from_si(figure.value, system), 4)


def recorded(qualification: Qualification, kind: str) -> bool:
    """Whether there were files of a ``record`` or a ``reference``."""
    return any(name.startswith(kind) for name in qualification.files)


def _sentence(text: str) -> str:
    return capital(text).rstrip(".") + "."
