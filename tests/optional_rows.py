"""Loaders of either drive with optional rows: what goes with what, for tests."""

import re
from functools import cache
from math import radians

import numpy as np

from forcefeel.loader.built_in import elevator
from forcefeel.loader.consistency import ONLY_WITH, complaints
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, OFF, TABLE, absent, has

_LONGEST = 0.025
_COLDEST, _HOTTEST = -50.0, 400.0
_ROOM = {
    "controller.delay": {"controller.period": _LONGEST},
    "thermal.derating_from": {"thermal.ambient": _COLDEST, "thermal.winding_limit": _HOTTEST},
    "thermal.winding_limit": {"thermal.ambient": _COLDEST, "thermal.derating_from": 20.0},
    "surface.mach_2": {"surface.mach_1": 1e-3},
    "surface.mach_3": {"surface.mach_1": 1e-3, "surface.mach_2": 2e-3},
    "surface.deflection_1": {"surface.deflection_2": radians(85)},
    **{
        f"surface.deflection_{k}": {f"surface.deflection_{lower}": radians(lower - 91) for lower in range(1, k)}
        for k in range(2, 8)
    },
}
"""Values of others that leave a row all of its range."""


@cache
def bare(drive: str) -> Loader:
    """A loader of this drive that states what it must, at the table's values: of an electric one, its controller's period too."""
    if drive != ELECTRIC:
        return elevator()
    values = {
        key: OFF.get(key, row.default_si) if has(ELECTRIC, row) else absent(row) for key, row in TABLE.items()
    } | {"controller.period": 5e-4}
    return Loader("motor", "", np.array(list(values.values())))


def bare_of(key: str) -> Loader:
    """A loader that may have the row."""
    return bare(TABLE[key].drive or "hydraulic")


def companions(key: str) -> dict[str, float]:
    """The rows, at their examples, without which the optional row ``key`` would have no effect, or not all of its range."""
    found: dict[str, float] = dict(_ROOM.get(key, {}))
    wanted = [key, *found]
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
        for line in wrong:
            key, than = line.split(":")[0], re.search(r"expected less than (\S+),", line)
            # What a row at its own value off does not go with is the other's.
            gone = than[1] if than and values[key] == OFF[key] else key
            values[gone] = OFF[gone]
    return values
