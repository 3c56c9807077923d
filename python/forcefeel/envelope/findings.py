"""Conclusions from an envelope, in sentences."""

from collections.abc import Sequence
from math import inf, isfinite, isnan

import numpy as np
from numpy.typing import NDArray

from forcefeel.conclusions import Conclusions, capital, interval_text, of_result, share_text
from forcefeel.envelope.cases import Kind
from forcefeel.envelope.forbidden_sentences import forbidden_sentences
from forcefeel.envelope.result import MOST, Envelope, Shares
from forcefeel.envelope.settings import AXES, Axis
from forcefeel.envelope.softening import SoftenedShares
from forcefeel.envelope.tolerance_sentences import silent_sentences, tolerance_sentences
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import ANGLE, FORCE, INERTIA, UnitSystem, to_text

_MOST_NAMED = 2
"""Laws that the verdict names; of more, it names the best."""

WHOLE_NOMINAL, WHOLE_WORST = 0.95, 0.90
"""Shares from which on a law is said to render the envelope: nominally, and in every case."""


@of_result
def envelope_conclusions(envelope: Envelope, units: UnitSystem) -> Conclusions:
    """Conclusions, with numbers in ``units``; ``ok`` if a law renders the envelope. The five most important findings come first."""
    best = _best(envelope)
    if envelope.forbidden.settings.all():
        count = envelope.plan.settings.count
        verdict = f"No law renders any of {count:,} programmed feels, released from {_angle(envelope, units)}."
    else:
        named = envelope.laws if len(envelope.laws) <= _MOST_NAMED else (best.law,)
        each = ", ".join(
            f"{share_text(law.nominal_share)} with {name_text(law.law)} ({share_text(law.worst_case_share)} in every case)"
            for law in map(envelope.allowed_shares, named)
        )
        among = "" if named == envelope.laws else f", the best of {len(envelope.laws)} laws"
        verdict = f"Within tolerance: {each}{among}, of {_feels(envelope)}, released from {_angle(envelope, units)}."
    others = [name for name in envelope.laws if name != best.law]
    lines = [*forbidden_sentences(envelope.forbidden, units), _fails(envelope, best.law), _worst(envelope, best.law)]
    lines += [_softened(shares) for shares in envelope.softened]
    lines += [_in_contact(envelope, best.law, units)] if envelope.plan.contacts else []
    lines += [_drawn(envelope, best.law)] if envelope.plan.machines else []
    lines += [_smallest(envelope, best.law, units), _passive(envelope)]
    lines += [_by_angle(envelope, best.law, units)] if envelope.smaller else []
    lines += [line for name in others for line in (_fails(envelope, name), _worst(envelope, name))]
    lines += [_counted(envelope, units), *caveats(envelope)]
    return Conclusions(renders(envelope), verdict, tuple(filter(None, lines)))


def renders(envelope: Envelope) -> bool:
    """Whether the best of the laws renders the envelope."""
    best = _best(envelope)
    quiet = envelope.contact_shares(best.law).quiet if envelope.plan.contacts else 1.0
    return best.nominal_share >= WHOLE_NOMINAL and min(best.worst_case_share, quiet) >= WHOLE_WORST


def _best(envelope: Envelope) -> Shares:
    return max(map(envelope.shares, envelope.laws), key=lambda shares: (shares.worst_case_share, shares.nominal_share))


def name_text(name: str) -> str:
    """What a law is called in a sentence."""
    return {
        "original": "the original loop",
        "published": "the published gains",
        "converged": "the converged gains",
    }.get(name, name)


def caveats(envelope: Envelope) -> tuple[str, ...]:
    """What the figures do not cover."""
    plan = envelope.plan
    lines = [*envelope.law_remarks, *tolerance_sentences(plan.given, plan.deviations), *silent_sentences(plan.loader)]
    what = [] if plan.rule_verified else [f"{plan.rules.title} ({plan.rules.edition})"]
    what += [case.name for case in plan.cases if not case.verified]
    if what:
        lines.append(f"Not verified against a source: {', '.join(what)}.")
    if plan.omitted:
        rows = ", ".join(plan.omitted)
        lines.append(f"Omitted, because an envelope programs only I, B and G: {rows}.")
    if not plan.linear:
        loop = "sampled loop, its delay included" if plan.loader["controller.period"] else "linear model"
        lines.append(
            f"The releases are simulated with the loader's optional rows. Stability is that of the {loop}; a setting that is "
            "unstable there counts as unstable."
        )
    return tuple(lines)


def _angle(envelope: Envelope, units: UnitSystem) -> str:
    """Where the column is let go: the smaller, the more the sensors' noise counts."""
    return angle_text(envelope.plan.release_rad, units)


def angle_text(angle_rad: float, units: UnitSystem) -> str:
    """An angle of release as people read it."""
    return f"{to_text(ANGLE.from_si(angle_rad, units), 3)} {ANGLE.shown(units)}"


def _feels(envelope: Envelope) -> str:
    """What the shares are of."""
    count = envelope.plan.settings.count
    if not (counts := envelope.forbidden.counts):
        return f"{count:,} programmed feels"
    *others, last = counts
    limits = f"{', '.join(others)} and {last} allow" if others else f"{last} allows"
    return f"the {count - sum(counts.values()):,} of {count:,} programmed feels that {limits}"


def _in_contact(envelope: Envelope, name: str, units: UnitSystem) -> str:
    """Whether the settings are quiet against something stiff, where fewest are, and how fast a stop throws a column back."""
    shares = envelope.contact_shares(name)
    count = len(envelope.plan.contacts)
    if shares.quiet == 1:
        returns = (
            f" A stop returns a column at up to {_times(shares.fastest_return)} its rate."
            if not isnan(shares.fastest_return)
            else ""
        )
        quiet = f"With {name_text(name)} every setting is quiet in all {count} contacts, clamps and stops of 1e3 to 1e6 N/m."
        return quiet + returns
    worst = min(shares.by_contact, key=shares.by_contact.__getitem__)
    force = f"{to_text(FORCE.from_si(shares.largest_force_n, units), 3)} {FORCE.shown(units)}"
    thrown = (
        f" A stop throws the column back at {share_text(shares.thrown_back)} of the settings, at up to "
        f"{_times(shares.fastest_return)} the rate at which it is struck."
        if shares.thrown_back
        else ""
    )
    return (
        f"With {name_text(name)} {share_text(shares.quiet)} of the settings are quiet in all {count} contacts; fewest, "
        f"{share_text(shares.by_contact[worst])}, in: {worst}. The largest force is {force}.{thrown}"
    )


def _times(ratio: float) -> str:
    return f"{to_text(ratio, 2)} times"


def _softened(shares: SoftenedShares) -> str:
    """What a softened feel gains."""
    least = f", to {share_text(shares.least)} of their stiffness at least" if shares.softened else ""
    return (
        f"{_sentence(shares.law)} renders {share_text(shares.as_programmed)} of the settings as programmed, "
        f"{share_text(shares.softened)} softened to what the drive renders{least}, and {share_text(shares.not_rendered)} "
        "not at all."
    )


def _by_angle(envelope: Envelope, name: str, units: UnitSystem) -> str:
    """How the share falls for small releases."""
    own, *others = envelope.by_angle
    each = ", ".join(
        f"{share_text(point.passes[name])} from {angle_text(point.release_rad, units)}" for point in others
    )
    return (
        f"Share by release angle, nominal plant, {name_text(name)}: {share_text(own.passes[name])} from "
        f"{angle_text(own.release_rad, units)}, {each}."
    )


def _fails(envelope: Envelope, name: str) -> str:
    shares = envelope.shares(name)
    failing = {kind: share for kind, share in envelope.failure_shares(name).items() if share > 0}
    if not failing:
        return f"{_sentence(name)}: stable and within tolerance at every setting with the nominal plant."
    order = sorted(failing, key=lambda kind: -failing[kind])
    parts = [f"{kind} at {share_text(failing[kind])}" for kind in order]
    return (
        f"{_sentence(name)}: stable at {share_text(shares.stable)} of the settings. First failures: {', '.join(parts)}."
    )


def _worst(envelope: Envelope, name: str) -> str:
    rows = [row for kind in (Kind.PLANT, Kind.ARM) if (row := envelope.worst_case(name, kind)) is not None]
    if not rows:
        return ""
    parts = [f"{row.case} ({share_text(row.lost)})" for row in rows]
    return f"With {name_text(name)}, the largest loss of nominal passes comes from {' and from the '.join(parts)}."


def _drawn(envelope: Envelope, name: str) -> str:
    drawn, most = envelope.drawn_shares(name), share_text(MOST)
    where = "at the corners of" if envelope.plan.draws.corners else "at random within"
    interval = interval_text(drawn.good_low, drawn.good_high)
    return (
        f"All tolerances at once ({drawn.machines:,} machines {where} them, hands off, {name_text(name)}): a machine passes at "
        f"{share_text(drawn.passes)} of the settings on average, the worst machine at {share_text(drawn.least)}. "
        f"{share_text(drawn.settings)} of the settings pass in at least {most} of the machines. {share_text(drawn.good)} of the "
        f"machines (95 % confidence: {interval}) pass at {most} of the settings or more."
    )


def _counted(envelope: Envelope, units: UnitSystem) -> str:
    """By which grid the shares count, and what another weight of its points would give."""
    settings = envelope.plan.settings
    grid = "; ".join(
        f"{axis.title} {spacing_text(axis, getattr(settings, name), units)}" for name, axis in AXES.items()
    )
    others = ", ".join(
        f"{share_text(shares.nominal_share)} with {name_text(shares.law)} ({share_text(shares.worst_case_share)} in every case)"
        for shares in map(envelope.even_shares, envelope.laws)
    )
    return (
        f"Every point of the grid counts the same: {grid}. With weights by equal logarithmic steps along all three axes, the "
        f"shares are {others}."
    )


def spacing_text(axis: Axis, values: Sequence[float], units: UnitSystem) -> str:
    """The values of an axis, or how many there are from where to where."""
    texts = [to_text(axis.unit.from_si(value, units), 3) for value in values]
    name = f" {axis.unit.shown(units)}".rstrip()
    even = [
        kind for kind, step in (("in proportion", np.diff(np.log(values))), ("evenly", np.diff(values))) if _equal(step)
    ]
    if even and len(values) > _FEW:
        return f"{texts[0]} to {texts[-1]}{name}, {len(values)} values {even[0]}"
    return f"{', '.join(texts)}{name}"


_FEW = 3
"""Values that are listed however they are spaced."""


def _equal(steps: NDArray[np.float64]) -> bool:
    return bool(np.ptp(steps) < _SAME * steps.max())


_SAME = 1e-6
"""Relative; steps that are the same but for rounding."""


def _smallest(envelope: Envelope, name: str, units: UnitSystem) -> str:
    edge = envelope.smallest(name)
    if not isfinite(edge.inertia_n_m_s2_per_rad):
        return ""
    stiffness = unit(TABLE["feel.stiffness"])
    inertia_text = f"{to_text(INERTIA.from_si(edge.inertia_n_m_s2_per_rad, units), 3)} {INERTIA.shown(units)}"
    stiffness_text = f"{to_text(stiffness.from_si(edge.stiffness_n_m_per_rad, units), 3)} {stiffness.shown(units)}"
    return (
        f"Smallest feel that passes with {name_text(name)}: inertia I = {inertia_text}, {to_text(edge.inertia_share, 2)} times "
        f"that of the column; stiffness G = {stiffness_text}, {share_text(edge.stiffness_share)} of G_max."
    )


def _passive(envelope: Envelope) -> str:
    states = []
    for name in envelope.laws:
        grip = envelope.passivity[name]
        if not grip.stable:
            state = "unstable"
        elif grip.first_hz == inf:
            state = "passive"
        else:
            low, high = grip.bands_hz[0]
            state = f"not passive from {to_text(low, 3)} to {to_text(high, 3)} Hz"
        states.append(f"{state} with {name_text(name)}")
    return f"Impedance at the grip at the loader's own setting, hands off: {', '.join(states)}."


def _sentence(name: str) -> str:
    return capital(name_text(name))
