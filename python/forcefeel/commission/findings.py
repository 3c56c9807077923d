"""Conclusions from a commissioning, in sentences."""

from dataclasses import dataclass

from forcefeel.commission.result import AT_END, CARRIED, IDENTIFIED, NOTHING, UNSEEN, Checked, Commission
from forcefeel.commission.steps import BENCH, ENVELOPE, IDENTIFICATION, LAW, TESTS
from forcefeel.conclusions import Conclusions, capital, of_result, share_text

GOOD_LAW, OTHER_LAW = "law.json", "law-rejected.json"
"""Name of the law's file: one that meets the requirements, and the best candidate of those that do not."""

_MOST = 3
"""What-ifs that are named."""


@of_result
def commission_conclusions(found: Commission) -> Conclusions:
    """The result in a sentence or two, and the remedies if it falls short."""
    lines = [*found.identified.wanting, *(f"The next experiment: {one}" for one in found.identified.advice)]
    lines += found.identified.noticed
    if found.loader is not None:
        lines += [_sorted(found, state) for state in (CARRIED, AT_END, NOTHING, UNSEEN)]
    if found.checked is not None:
        lines += [_envelope(found), *_more(found)]
    if found.tested is not None and not found.tested.fulfilled:
        lines += found.tested.reasons
    if found.chosen is not None:
        lines += found.chosen.findings[:1]
    lines.append(_handed(found))
    return Conclusions(found.good, _verdict(found), tuple(line for line in lines if line))


def _verdict(found: Commission) -> str:
    name = found.before.name
    if found.loader is None:
        return f"{name} is not commissioned: {_small(found.identified.verdict)}"
    known = [one for one in found.identified.parameters if one.state == IDENTIFIED]
    counted = f"{len(known)} parameter of {name} is" if len(known) == 1 else f"{len(known)} parameters of {name} are"
    said = f"{counted} identified"
    if found.chosen is None or not found.chosen.name or found.checked is None or found.tested is None:
        return f"{said}, and no law is eligible: {_small(found.chosen.verdict) if found.chosen else ''}"
    law, checked = found.chosen.name, found.checked
    renders = (
        f"the law {law} renders {share_text(checked.passes)} of the settings on the identified loader and "
        f"{share_text(checked.drawn)} on average over machines with all its tolerances at once"
    )
    asked = "" if found.reaches else f", below the required {share_text(found.plan.share)}"
    tests = "passes the rule's tests" if found.tested.fulfilled else "does not pass the rule's tests"
    end = (
        ""
        if found.good or not found.identified.wanting
        else " Do not use it: the data leave a required parameter open."
    )
    joint = "and" if found.tested.fulfilled is found.reaches else "but"
    return f"{said}; {renders}{asked}, {joint} it {tests}.{end}"


def _small(text: str) -> str:
    """A sentence after a colon."""
    first = text.partition(" ")[0]
    return text if first.isupper() or "." in first or not first[1:].islower() else text[:1].lower() + text[1:]


def _sorted(found: Commission, state: str) -> str:
    keys = [one.key for one in found.identified.parameters if one.state == state]
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


def _envelope(found: Commission) -> str:
    one = found.checked
    if one is None:
        return ""
    return (
        f"Share of {one.settings} settings, weighted by equal logarithmic steps: {share_text(one.passes)} nominally, "
        f"{share_text(one.every_case)} in every case, pilots' arms included; {_drawn(one)}."
    )


def _drawn(checked: Checked) -> str:
    """What the machines with all tolerances at once render."""
    least = share_text(checked.drawn_least)
    if checked.machines == 1:
        return f"the one machine with all tolerances at once renders {least}"
    return f"of {checked.machines} machines with all tolerances at once the worst renders {least}"


def _more(found: Commission) -> list[str]:
    """What would make it pass more."""
    if found.checked is None or found.reaches:
        return []
    if not found.checked.what_ifs:
        return ["No tested hardware change (friction, sensors, controller, limits of the drive) increases the share."]
    most = sorted(found.checked.what_ifs, key=lambda one: -one.passes)[:_MOST]
    parts = [f"{one.change}: {share_text(one.passes)}" for one in most]
    enough = next((one for one in found.checked.what_ifs if one.passes >= found.plan.share), None)
    asked = share_text(found.plan.share)
    least = (
        f"The smallest change that reaches {asked}: {enough.change}, {share_text(enough.passes)}."
        if enough
        else f"No single change reaches {asked}."
    )
    return [
        f"Hardware changes, one at a time, each with a law designed for it: {'; '.join(parts)}.",
        least,
    ]


def _handed(found: Commission) -> str:
    if found.law is None:
        return "There is no law."
    if found.good:
        return f"Results: loader.toml and {GOOD_LAW}, the law for the loader's own setting and those of the grid."
    return f"No law meets the requirements; the best candidate is in {OTHER_LAW}."


@dataclass(frozen=True)
class Row:
    """One step at a glance.

    Attributes:
        title: Which step.
        result: What it came to.
        good: Yes or no.
        page: Its page, within the whole folder; empty if it has none.
    """

    title: str
    result: str
    good: str
    page: str = ""


@of_result
def glance(found: Commission) -> tuple[Row, ...]:
    """Each step in a line."""
    rows = (
        [Row("bench, simulated", "record of the simulated machine", "yes", f"{BENCH}/bench.csv")]
        if BENCH in found.folders
        else []
    )
    determined = [one for one in found.identified.parameters if one.state == IDENTIFIED]
    what = (
        f"{len(determined)} parameter{'s' * (len(determined) > 1)}, to {_percent(max(one.error for one in determined))} at worst"
        if determined
        else "no loader"
    )
    wanting = f"; {len(found.identified.wanting)} missing" if found.identified.wanting else ""
    rows.append(
        Row("identification", what + wanting, _yes(found.identified.good), f"{IDENTIFICATION}/identification.html")
    )
    if found.chosen is not None:
        rows.append(
            Row("law", found.chosen.name or "none is eligible", _yes(bool(found.chosen.name)), f"{LAW}/compensate.html")
        )
    if found.checked is not None:
        shares = (
            f"{share_text(found.checked.passes)} nominal, {share_text(found.checked.drawn)} with all tolerances at once"
        )
        rows.append(Row("envelope", shares, _yes(found.reaches), f"{ENVELOPE}/envelope.html"))
    if found.tested is not None:
        passed = sum(one == "passed" for one in found.tested.outcomes.values())
        result = f"{passed} of {len(found.tested.outcomes)} passed"
        rows.append(Row("tests of the rule", result, _yes(found.tested.fulfilled), f"{TESTS}/qualification.html"))
    return tuple(rows)


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def _yes(good: bool) -> str:
    return "yes" if good else "no"
