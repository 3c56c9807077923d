"""Conclusions from the check of a flight schedule, in sentences."""

from forcefeel.conclusions import Conclusions, of_result
from forcefeel.envelope.tolerance_sentences import tolerance_sentences
from forcefeel.flight_schedule.result import CheckedRelease, Part, PartResult, ScheduleCheck
from forcefeel.units import to_text

_MOST_NAMED = 3
"""Places that a sentence names; the table has all."""

LEAK = (
    "Places are ranked by their oscillating poles: a real pole just below 1 is mostly the leak of the observer's disturbance "
    "estimate."
)


@of_result
def schedule_conclusions(check: ScheduleCheck) -> Conclusions:
    """Conclusions; ``ok`` if every checked loop is stable."""
    verdict = _stable(check) if check.stable else _unstable(check)
    lines = [_knots(check), _between(check), _margins(check), _nearest(check)]
    return Conclusions(check.stable, verdict, (*(line for line in lines if line), *_caveats(check)))


def _stable(check: ScheduleCheck) -> str:
    loops = sum(part.loops for part in check.parts)
    between = _count(int((~check.knot).sum()), "place")
    changes = _count(len(check.transitions.ends), "change")
    return (
        f"All {loops:,} checked loops are stable: at {check.schedule.knots:,} knots, at {between} between them and during "
        f"{changes}, with the nominal plant and in {_count(len(check.cases) - 1, 'other case')}."
    )


def _unstable(check: ScheduleCheck) -> str:
    bad = [part for part in check.parts if part.unstable]
    counts = ", ".join(f"{part.unstable:,} of {part.loops:,} loops {part.part}" for part in bad)
    worst = max(bad, key=lambda part: part.critical)
    size = to_text(worst.critical, 5)
    where = f"The worst place is {worst.place} in the case {worst.case}, with a pole of magnitude {size}."
    return f"Not stable: {counts}. {where} {_remedy(check, worst)}"


def _remedy(check: ScheduleCheck, worst: PartResult) -> str:
    between = check.part(Part.BETWEEN)
    if check.part(Part.KNOTS).unstable or check.remedy_helps is False:
        return (
            "A law designed for the unstable place is unstable there too, so more knots do not help: use another law or a less "
            "demanding feel."
        )
    if between.unstable:
        return f"A law designed for {between.place} is stable there: add a knot."
    return f"Change in steps from knot to knot, not from end to end as at {worst.place}."


def _nearest(check: ScheduleCheck) -> str:
    if not check.stable:
        return ""
    worst = check.worst
    return (
        f"The least stable place is {worst.place} in the case {worst.case}: its largest oscillating pole has magnitude "
        f"{to_text(worst.critical, 5)}."
    )


def _margins(check: ScheduleCheck) -> str:
    stable = [margin for margin in check.margins if margin.margins.disk > 0]
    if not stable:
        return ""
    gain = min(stable, key=lambda margin: margin.margins.gain_up)
    delay = min(stable, key=lambda margin: margin.margins.delay_s)
    factor, more = to_text(gain.margins.gain_up, 3), to_text(1e3 * delay.margins.delay_s, 2)
    return (
        f"Smallest margins of the nominal loop at {_count(len(stable), 'place')}: gain {factor} times at {gain.place}; delay "
        f"{more} ms beyond that of the controller at {delay.place}."
    )


def _knots(check: ScheduleCheck) -> str:
    knots = [release for release in check.releases if release.knot]
    failing = [release for release in knots if not release.passes]
    good = f"{len(knots) - len(failing):,} of {len(knots):,} knots"
    text = f"The release is within tolerance, and the column quiet in contact, at {good}"
    return f"{text}. It fails at {_named(failing)}." if failing else f"{text}."


def _between(check: ScheduleCheck) -> str:
    middle = [release for release in check.releases if not release.knot]
    failing = [release for release in middle if not release.passes]
    lost = [release for release in failing if release.lost]
    text = f"Midway between knots this holds at {len(middle) - len(failing):,} of {_count(len(middle), 'place')}"
    if not failing:
        return f"{text}: the knots are dense enough."
    if lost:
        return f"{text}. Add a knot where only a law of its own passes: {_named(lost)}."
    return f"{text}. It fails at {_named(failing)}; a law of its own fails there too, so more knots do not help."


def _count(number: int, what: str) -> str:
    return f"{number:,} {what}" if number == 1 else f"{number:,} {what}s"


def _named(places: list[CheckedRelease]) -> str:
    named = "; ".join(f"{release.place} ({release.outcome})" for release in places[:_MOST_NAMED])
    more = len(places) - _MOST_NAMED
    return f"{named}; and {more:,} more" if more > 0 else named


def _caveats(check: ScheduleCheck) -> tuple[str, ...]:
    test = check.test.rules.of("release", "pitch")
    rows = [test.is_verified(tolerance) for tolerance in test.tolerances]
    ranked = [LEAK] if any(part.largest > part.critical for part in check.parts) else []
    lines = [
        *ranked,
        *tolerance_sentences(check.schedule.loader, check.deviations),
        "Each place is checked with a constant setting. Settings that change as fast as the loop, and places between the checked "
        "ones, are not covered.",
    ]
    if not (all(rows) and check.test.rules.release.verified):
        lines.append(f"Not verified against a source: {check.test.rules.title} ({check.test.rules.edition}).")
    unverified = [case.name for case in check.cases if not case.verified]
    if unverified:
        lines.append(f"Not verified against a source: {', '.join(unverified)}.")
    return tuple(lines)
