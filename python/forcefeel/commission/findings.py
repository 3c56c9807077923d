"""Conclusions from a commissioning, in sentences."""

from dataclasses import dataclass

from forcefeel.commission.result import AT_END, CARRIED, IDENTIFIED, NOTHING, UNSEEN, Commission, EnvelopeResult
from forcefeel.commission.steps import BENCH, ENVELOPE, IDENTIFICATION, LAW, TESTS
from forcefeel.conclusions import Conclusions, capital, of_result, share_text

GOOD_LAW, OTHER_LAW = "law.json", "law-rejected.json"
"""Name of the law's file: one that meets the requirements, and the best candidate of those that do not."""

_MOST = 3
"""Number of named what-ifs."""


@of_result
def commission_conclusions(commission: Commission) -> Conclusions:
    """The result in a sentence or two, and the remedies if it falls short."""
    lines = [
        *commission.identified.wanting,
        *(f"The next experiment: {parameter}" for parameter in commission.identified.advice),
    ]
    lines += commission.identified.noticed
    if commission.loader is not None:
        lines += [_sorted(commission, state) for state in (CARRIED, AT_END, NOTHING, UNSEEN)]
    if commission.envelope is not None:
        lines += [_envelope(commission), *_hardware_changes(commission)]
    if commission.tested is not None and not commission.tested.fulfilled:
        lines += commission.tested.reasons
    if commission.chosen is not None:
        lines += commission.chosen.findings[:1]
    lines.append(_handed(commission))
    return Conclusions(commission.ok, _verdict(commission), tuple(line for line in lines if line))


def _verdict(commission: Commission) -> str:
    name = commission.before.name
    if commission.loader is None:
        return f"{name} is not commissioned: {_small(commission.identified.verdict)}"
    identified = [parameter for parameter in commission.identified.parameters if parameter.state == IDENTIFIED]
    counted = (
        f"{len(identified)} parameter of {name} is"
        if len(identified) == 1
        else f"{len(identified)} parameters of {name} are"
    )
    text = f"{counted} identified"
    if (
        commission.chosen is None
        or not commission.chosen.name
        or commission.envelope is None
        or commission.tested is None
    ):
        return f"{text}, and no law is eligible: {_small(commission.chosen.verdict) if commission.chosen else ''}"
    law, envelope = commission.chosen.name, commission.envelope
    renders = (
        f"the law {law} renders {share_text(envelope.passes)} of the settings on the identified loader and "
        f"{share_text(envelope.drawn)} on average over machines with all its tolerances at once"
    )
    shortfall = "" if commission.reaches else f", below the required {share_text(commission.plan.share)}"
    tests = "passes the rule's tests" if commission.tested.fulfilled else "does not pass the rule's tests"
    end = (
        ""
        if commission.ok or not commission.identified.wanting
        else " Do not use it: the data leave a required parameter open."
    )
    joint = "and" if commission.tested.fulfilled is commission.reaches else "but"
    return f"{text}; {renders}{shortfall}, {joint} it {tests}.{end}"


def _small(text: str) -> str:
    """A sentence with a small first letter, for use after a colon."""
    first = text.partition(" ")[0]
    return text if first.isupper() or "." in first or not first[1:].islower() else text[:1].lower() + text[1:]


def _sorted(commission: Commission, state: str) -> str:
    keys = [parameter.key for parameter in commission.identified.parameters if parameter.state == state]
    if not keys:
        return ""
    named = f"{', '.join(keys[:-1])} and {keys[-1]}" if len(keys) > 1 else keys[0]
    if state == CARRIED:
        return (
            f"The records determine {named} only in products or ratios with other parameters: the file's "
            f"{'values are' if len(keys) > 1 else 'value is'} kept, and the estimates of the others compensate for "
            f"{'their' if len(keys) > 1 else 'its'} error."
        )
    if state == AT_END:
        return (
            f"{capital(named)} {'are' if len(keys) > 1 else 'is'} at the end of the valid range by the file and by the records, "
            "and counts as known."
        )
    if state == NOTHING:
        return f"The records show no {named}: the estimate is zero within its standard error, and the loader gets zero."
    return f"The records hardly show {named}: value and tolerance of the file are kept and count in the envelope."


def _envelope(commission: Commission) -> str:
    envelope = commission.envelope
    if envelope is None:
        return ""
    return (
        f"Share of {envelope.settings} settings, weighted by equal logarithmic steps: {share_text(envelope.passes)} nominally, "
        f"{share_text(envelope.every_case)} in every case, pilots' arms included; {_drawn(envelope)}."
    )


def _drawn(envelope: EnvelopeResult) -> str:
    """Share rendered by the worst machine with joint tolerances."""
    least = share_text(envelope.drawn_least)
    if envelope.machines == 1:
        return f"the one machine with joint tolerances renders {least}"
    return f"of {envelope.machines} machines with joint tolerances the worst renders {least}"


def _hardware_changes(commission: Commission) -> list[str]:
    """Changes of the machine that would render more."""
    if commission.envelope is None or commission.reaches:
        return []
    if not commission.envelope.what_ifs:
        return ["No tested hardware change (friction, sensors, controller, limits of the drive) increases the share."]
    most = sorted(commission.envelope.what_ifs, key=lambda what_if: -what_if.passes)[:_MOST]
    parts = [f"{what_if.change}: {share_text(what_if.passes)}" for what_if in most]
    sufficient = next(
        (what_if for what_if in commission.envelope.what_ifs if what_if.passes >= commission.plan.share), None
    )
    required = share_text(commission.plan.share)
    least = (
        f"The smallest change that reaches {required}: {sufficient.change}, {share_text(sufficient.passes)}."
        if sufficient
        else f"No single change reaches {required}."
    )
    return [
        f"Hardware changes, one at a time, each with a law designed for it: {'; '.join(parts)}.",
        least,
    ]


def _handed(commission: Commission) -> str:
    if commission.law is None:
        return "There is no law."
    if commission.ok:
        return f"Results: loader.toml and {GOOD_LAW}, the law for the loader's own setting and those of the grid."
    return f"No law meets the requirements; the best candidate is in {OTHER_LAW}."


@dataclass(frozen=True)
class Row:
    """Summary of one step.

    Attributes:
        title: The step.
        result: Its result.
        ok: Yes or no.
        page: Its page, within the whole folder; empty without one.
    """

    title: str
    result: str
    ok: str
    page: str = ""


@of_result
def glance(commission: Commission) -> tuple[Row, ...]:
    """A row for each step."""
    rows = [Row("bench", f"record of {commission.bench}", "yes", f"{BENCH}/bench.csv")] if commission.bench else []
    determined = [parameter for parameter in commission.identified.parameters if parameter.state == IDENTIFIED]
    worst = max((parameter.error for parameter in determined), default=0.0)
    what = (
        f"{len(determined)} parameter{'s' * (len(determined) > 1)}, to {_percent(worst)} at worst"
        if determined
        else "no loader"
    )
    wanting = f"; {len(commission.identified.wanting)} missing" if commission.identified.wanting else ""
    rows.append(
        Row("identification", what + wanting, _yes(commission.identified.ok), f"{IDENTIFICATION}/identification.html")
    )
    if commission.chosen is not None:
        rows.append(
            Row(
                "law",
                commission.chosen.name or "none is eligible",
                _yes(bool(commission.chosen.name)),
                f"{LAW}/law.html",
            )
        )
    if commission.envelope is not None:
        nominal, joint = share_text(commission.envelope.passes), share_text(commission.envelope.drawn)
        shares = f"{nominal} nominal, {joint} with joint tolerances"
        rows.append(Row("envelope", shares, _yes(commission.reaches), f"{ENVELOPE}/envelope.html"))
    if commission.tested is not None:
        passed = sum(outcome == "passed" for outcome in commission.tested.outcomes.values())
        result = f"{passed} of {len(commission.tested.outcomes)} passed"
        rows.append(Row("tests of the rule", result, _yes(commission.tested.fulfilled), f"{TESTS}/qualification.html"))
    return tuple(rows)


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def _yes(ok: bool) -> str:
    return "yes" if ok else "no"
