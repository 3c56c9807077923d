"""What the check of a flight schedule says, in sentences."""

from forcefeel.conclusions import Conclusions, of_result
from forcefeel.envelope.tolerance_sentences import tolerance_sentences
from forcefeel.flight_schedule.result import CheckedRelease, Part, PartResult, ScheduleCheck
from forcefeel.units import to_text

_MOST_NAMED = 3
"""Places that a sentence names; the table has all."""

LEAK = (
    "A pole of a stable loop that is real and just below 1 is mostly the observer's leak, by which it forgets a disturbance; "
    "places are therefore ranked by the poles that swing."
)


@of_result
def schedule_conclusions(check: ScheduleCheck) -> Conclusions:
    """The conclusions; ``good`` where every loop that was checked is stable."""
    verdict = _stable(check) if check.stable else _unstable(check)
    lines = [_knots(check), _between(check), _margins(check), _nearest(check)]
    return Conclusions(check.stable, verdict, (*(line for line in lines if line), *_caveats(check)))


def _stable(check: ScheduleCheck) -> str:
    loops = sum(part.loops for part in check.parts)
    between = _count(int((~check.knot).sum()), "place")
    changes = _count(len(check.transitions.ends), "change")
    return (
        f"Stable wherever it was checked: at {check.schedule.knots:,} knots, at {between} between them and during {changes}, "
        f"with the nominal plant and in {_count(len(check.cases) - 1, 'other case')}, {loops:,} loops in all."
    )


def _unstable(check: ScheduleCheck) -> str:
    bad = [part for part in check.parts if part.unstable]
    counts = ", ".join(f"{part.unstable:,} of {part.loops:,} loops {part.part}" for part in bad)
    worst = max(bad, key=lambda part: part.critical)
    size = to_text(worst.critical, 5)
    where = f"Worst is {worst.place} in the case {worst.case}, with a pole of magnitude {size}."
    return f"Not stable: {counts}. {where} {_remedy(check, worst)}"


def _remedy(check: ScheduleCheck, worst: PartResult) -> str:
    between = check.part(Part.BETWEEN)
    if check.part(Part.KNOTS).unstable or check.remedy_helps is False:
        return (
            "A law that is designed for an unstable place is unstable there too, so more knots do not help: take another law, "
            "or a feel that asks for less."
        )
    if between.unstable:
        return f"A law that is designed for {between.place} is stable there: add a knot."
    return f"Go in steps: let changes to the knots in between follow each other, and none go from end to end as at {worst.place}."


def _nearest(check: ScheduleCheck) -> str:
    if not check.stable:
        return ""
    worst = check.worst
    return (
        f"Nearest to the edge is {worst.place} in the case {worst.case}: its largest pole that swings has the magnitude "
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
        f"Of {_count(len(stable), 'place')} the nominal loop has its least gain margin, a factor of {factor}, at {gain.place}, "
        f"and its least delay margin, {more} ms beyond the controller's own, at {delay.place}."
    )


def _knots(check: ScheduleCheck) -> str:
    knots = [release for release in check.releases if release.knot]
    failing = [knot for knot in knots if not knot.passes]
    text = f"At {len(knots) - len(failing):,} of {len(knots):,} knots the release is within tolerance"
    return f"{text}; it is not at {_named(failing)}." if failing else f"{text}."


def _between(check: ScheduleCheck) -> str:
    middle = [release for release in check.releases if not release.knot]
    failing = [release for release in middle if not release.passes]
    lost = [release for release in failing if release.lost]
    text = f"In the middle between knots it is at {len(middle) - len(failing):,} of {_count(len(middle), 'place')}"
    if not failing:
        return f"{text}: the knots are dense enough for it."
    if lost:
        return f"{text}. A law of its own passes where the interpolated one fails: add a knot at {_named(lost)}."
    return f"{text}; where it is not, {_named(failing)}, a law of its own fails too, so more knots do not help."


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
        "Each place is checked as if the setting stood still there: one that moves as fast as the loop itself is not covered, "
        "nor is what lies between the places.",
    ]
    if not (all(rows) and check.test.rules.release.verified):
        lines.append(f"Not verified against a source: {check.test.rules.title} ({check.test.rules.edition}).")
    unverified = [case.name for case in check.cases if not case.verified]
    if unverified:
        lines.append(f"Not verified against a source: {', '.join(unverified)}.")
    return tuple(lines)
