"""Sentences on settings that no law renders: number, reason, margin and remedy."""

from math import degrees

import numpy as np

from forcefeel.envelope.forbidden import NOISE, THROW, Forbidden
from forcefeel.sizing.fastest import Limit
from forcefeel.units import UnitSystem, to_text


def forbidden_sentences(forbidden: Forbidden, units: UnitSystem) -> tuple[str, ...]:
    """A sentence for each reason; none if every setting is allowed."""
    return tuple(_sentence(forbidden, reason, count, units) for reason, count in forbidden.counts.items())


def _sentence(forbidden: Forbidden, reason: str, count: int, units: UnitSystem) -> str:
    which = forbidden.of(reason)
    head = f"No law renders {count:,} of {len(which):,} settings because of {reason}: "
    if reason == NOISE:
        worst = forbidden.noise_rad[which].max()
        return head + (
            f"the noise moves the column by up to {to_text(degrees(worst), 2)} deg r.m.s., more than the rest band of the rule. "
            "Remedy: a finer sensor of the column's angle, or a shorter controller.period."
        )
    if reason == THROW:
        worst = int(np.argmax(np.where(which, forbidden.begins_s - forbidden.thrown_s, -np.inf)))
        thrown, begins = (to_text(1e3 * float(times[worst]), 3) for times in (forbidden.thrown_s, forbidden.begins_s))
        return head + (
            f"at the release the stretched link throws the column to the start of the rule's first time within {thrown} ms, with "
            f"the drive at its limit; one of these feels requires {begins} ms. Remedy: a stiffer link, a faster valve or current "
            "loop, a higher voltage, a shorter delay, or a heavier column."
        )
    if (which & forbidden.beyond.settings).any():
        return head + forbidden.beyond.sentence(units)
    worst = int(np.argmax(np.where(which, forbidden.fastest_s / forbidden.most_s, 0.0)))
    fastest, most = (to_text(1e3 * float(times[worst]), 3) for times in (forbidden.fastest_s, forbidden.most_s))
    return head + (
        f"at the limit of the drive the column takes {fastest} ms for the return that the rule times; one of these feels allows "
        f"{most} ms with its tolerance. Remedy: {_REMEDIES[Limit(reason)]}."
    )


_REMEDIES = {
    Limit.FLOW: "a larger valve, or a smaller piston where the force allows it",
    Limit.CURRENT: "a larger amplifier.current_limit",
    Limit.PRESSURE: "more pressure, a larger piston or a lighter column",
    Limit.TORQUE: "a stronger motor, or a lighter column",
    Limit.VOLTAGE: "a higher current_loop.voltage_limit, or more transmission.travel",
}
