"""The control forces that the airworthiness rule permits, the table ``data/control_forces.toml``."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Annotated

from forcefeel.units import FORCE, factor


@dataclass(frozen=True)
class ForceLimit:
    """One row of the table.

    Attributes:
        axis: ``pitch``, ``roll`` or ``yaw``.
        duration: ``short`` or ``long``.
        hands: With which hands; empty where the rule does not say.
        force_n: The largest force at wheel or pedals, N.
        source: Where it stands.
        verified: Whether a person has held the row against the document.
    """

    axis: str
    duration: str
    hands: str
    force_n: Annotated[float, FORCE]
    source: str
    verified: bool

    @property
    def name(self) -> str:
        """In words: ``short term, two hands``."""
        return ", ".join(filter(None, (f"{self.duration} term", self.hands)))


RULE = "14 CFR 25.143(d)"
"""Whose limits they are."""


@cache
def control_forces() -> tuple[ForceLimit, ...]:
    """All rows.

    Raises:
        ValueError: If the table breaks its own laws: another rule, a row twice, a force that is not above zero, a long-term force
            that is not below the short-term ones.
    """
    table = tomllib.loads(resources.files("forcefeel").joinpath("data/control_forces.toml").read_text(encoding="utf-8"))
    rows = tuple(
        ForceLimit(force_n=row.pop("force_lb") * factor("lb", "N"), **row) for row in map(dict, table["limits"])
    )
    keys = [(row.axis, row.duration, row.hands) for row in rows]
    if table["id"] != RULE or len(set(keys)) < len(keys) or min(row.force_n for row in rows) <= 0:
        raise ValueError(f"control_forces.toml: expected rows of {RULE}, each once, with forces above zero")
    for axis in {row.axis for row in rows}:
        short, long = (
            [row.force_n for row in rows if (row.axis, row.duration) == (axis, duration)] for duration in _DURATIONS
        )
        if not short or not long or max(long) >= min(short):
            raise ValueError(f"control_forces.toml: {axis}: expected long-term forces below the short-term ones")
    return rows


_DURATIONS = ("short", "long")
