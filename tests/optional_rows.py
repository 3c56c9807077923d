"""Loaders with optional rows: what goes with what, for tests."""

from forcefeel.loader.consistency import ONLY_WITH, complaints
from forcefeel.loader.parameters import OFF, TABLE


def companions(key: str) -> dict[str, float]:
    """The rows, at their examples, without which the optional row ``key`` would have no effect, or not all of its range."""
    found: dict[str, float] = {"controller.period": 0.025} if key == "controller.delay" else {}
    wanted = [key]
    while wanted:
        row = wanted.pop()
        for needed in (others[0] for name, others in ONLY_WITH if name == row):
            if needed not in found and needed != key:
                found[needed] = TABLE[needed].default_si
                wanted.append(needed)
    return found


def going_together(values: dict[str, float]) -> dict[str, float]:
    """``values`` without the optional rows that do not go with the others."""
    values = dict(values)
    while wrong := complaints(values):
        for key in {line.split(":")[0] for line in wrong}:
            values[key] = OFF[key]
    return values
