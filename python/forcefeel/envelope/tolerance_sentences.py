"""Sentences on the tolerances of a plant and their sources, and on sensors without noise."""

from collections.abc import Mapping
from math import degrees

from forcefeel.envelope.deviations import Deviation, Origin, uncounted
from forcefeel.laws.sampled.rules import undeclared_noise
from forcefeel.loader.loader import Loader
from forcefeel.units import to_text

_HEADINGS = {
    Origin.FILE: "Tolerances by the loader file",
    Origin.GIVEN: "Tolerances by option",
    Origin.RULER: "Tolerances of a ruler, assumed",
    Origin.ASSUMED: "Tolerances assumed, not measured",
}


def ends_text(deviation: Deviation) -> str:
    """Range of a deviation, such as ``±20 %``."""
    low, high = (100 * end for end in deviation.ends)
    if abs(low + high) < _SAME * (high - low):
        return f"±{to_text(high, 3)} %"
    return f"{to_text(low, 3)} to {to_text(high, 3)} %"


_SAME = 1e-9
"""Relative difference of ends that counts as rounding."""


def tolerance_sentences(loader: Loader, deviations: Mapping[str, Deviation]) -> tuple[str, ...]:
    """A sentence for each source of tolerances, and one for the tolerances without a case."""
    sentences = []
    for origin, heading in _HEADINGS.items():
        groups: dict[str, list[str]] = {}
        for key, deviation in deviations.items():
            if deviation.origin is origin:
                groups.setdefault(ends_text(deviation), []).append(key)
        if groups:
            parts = (f"{ends} of {', '.join(keys)}" for ends, keys in groups.items())
            sentences.append(f"{heading}: {'; '.join(parts)}.")
    if left := [key for key in uncounted(loader) if key not in deviations]:
        why = "sensors count as calibrated, and absent parts have no deviation"
        sentences.append(f"Tolerances omitted: {', '.join(left)} ({why}).")
    return tuple(sentences)


def silent_sentences(loader: Loader) -> tuple[str, ...]:
    """A sentence on sensors of a digital controller without noise, and the noise that designs assume; empty if all have noise."""
    if not (loader["controller.period"] and (assumed := undeclared_noise(loader))):
        return ()
    values = {
        "load_cell": f"{to_text(assumed.get('load_cell', 0.0), 2)} N",
        "column_sensor": f"{to_text(degrees(assumed.get('column_sensor', 0.0)), 2)} deg",
    }
    taken = " and ".join(values[name] for name in assumed)
    return (
        f"Sensors without noise or resolution: {', '.join(assumed)}. A real machine renders less; the laws are designed for "
        f"{taken} r.m.s. State noise and resolution in the loader file ({', '.join(f'{name}.noise' for name in assumed)}).",
    )
