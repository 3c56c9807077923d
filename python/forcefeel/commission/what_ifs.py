"""Changes that would render more: the machine with a single change, and a law for it.

In the order of what a change asks of the machine: something measured better, a part of the electronics exchanged, a part of the
mechanics, a part added that moves with the grip. Each is released over the settings to its end, nominal and hands off.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np

from forcefeel.commission.fits import without
from forcefeel.commission.observability import BREAKAWAY, DRY, FRICTION_CURVE, SEALS
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import WhatIf
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute
from forcefeel.errors import InputError
from forcefeel.laws.sampled.grip import GRIP
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import OFF
from forcefeel.loader.sensors import SENSORS, has_grip_sensor
from forcefeel.loader.tolerances import Distribution, Tolerance

_GAIN = 0.01
"""Least gain in share of a reported change."""

_EXACT = 1e-6
"""Tolerance of an exactly known friction."""

_BITS = 23
"""Bits of a very fine encoder."""

_GRIP_SHARE = 2e-4
"""Noise and steps of a force sensor at the grip, in the pilot's force: 0.02 lb of 100 lb."""


def what_ifs(loader: Loader, name: str, plan: CommissionPlan, now: float) -> tuple[WhatIf, ...]:
    """Changed machines that would render more with their own law, the smallest change first.

    Args:
        loader: The machine, with the tolerance of its friction, which the law learns within.
        name: The law's design; a force sensor at the grip has its own.
        plan: The plan of the commissioning.
        now: The share that the machine renders as it is.
    """
    candidates = []
    for change, law, other in _others(loader, name):
        try:
            envelope_plan = make_plan(other, [law], plan.grid, rule=plan.rule, changes={}, arms=())
            candidates.append(
                WhatIf(change, compute(envelope_plan, threads=plan.threads).even_shares(law).nominal_share)
            )
        except InputError:  # no law of this design for such a machine
            continue
    return tuple(candidate for candidate in candidates if candidate.passes >= now + _GAIN)


def _others(loader: Loader, name: str) -> Iterator[tuple[str, str, Loader]]:
    """The change, the law and the machine."""
    # The law follows how well the rest is known.
    reduced = _without_tolerances(loader, {BREAKAWAY})
    if reduced[DRY]:
        exact = Tolerance(Distribution.UNIFORM, (1 - _EXACT) * reduced[DRY], (1 + _EXACT) * reduced[DRY])
        yield "dry friction known exactly", name, reduced.with_tolerances({DRY: exact})
    for words, rows in _electronics(reduced).items():
        yield words, name, _without_tolerances(reduced, rows).replace(rows, si=True)
    if reduced[DRY]:
        yield "half the dry friction", name, _rubbing(reduced, 0.5)
        yield "no dry friction", name, _rubbing(reduced, 0.0)
    if reduced["controller.period"] and not has_grip_sensor(reduced):
        least = _GRIP_SHARE * reduced["pilot.force"]
        rows = {"grip_sensor.gain": 1.0, "grip_sensor.noise": least, "grip_sensor.resolution": least}
        yield f"a force sensor at the grip (law {GRIP})", GRIP, reduced.replace(rows, si=True)


def _without_tolerances(loader: Loader, rows: Iterable[str]) -> Loader:
    return loader.with_tolerances({row: None for row in rows if row in loader.tolerances})


def _electronics(loader: Loader) -> dict[str, dict[str, float | None]]:
    """Rows of other sensors, another controller, another amplifier."""
    rows: dict[str, dict[str, float | None]] = {}
    lags = [key for sensor in SENSORS if np.isfinite(loader[key := f"{sensor}.bandwidth"])]
    if lags:
        rows["sensors without lag"] = dict.fromkeys(lags)
    step = 2 * pi / 2**_BITS
    coarse = [key for part in ("noise", "resolution") if loader[key := f"column_sensor.{part}"] > step]
    if coarse:
        rows[f"encoder of {_BITS} bits at the column"] = dict.fromkeys(coarse, step)
    noisy = [key for sensor in SENSORS for part in ("noise", "resolution") if loader[key := f"{sensor}.{part}"]]
    if noisy:
        rows["a tenth of the sensors' noise"] = {key: loader[key] / 10 for key in noisy}
    if loader["controller.period"]:
        keys = ("controller.period", "controller.delay")
        rows["half the controller's period and delay"] = {key: loader[key] / 2 for key in keys}
    limits = ("amplifier.current_limit", "valve.flow_limit", "current_loop.current_limit", "current_loop.voltage_limit")
    narrow = [key for key in limits if key in loader.given and np.isfinite(loader[key])]
    if narrow:
        rows["twice the drive's limits"] = {key: 2 * loader[key] for key in narrow}
    return rows


def _rubbing(loader: Loader, share: float) -> Loader:
    """The machine with a share of its dry friction, of the same relative tolerance."""
    if not share:
        return without(loader, (DRY, *FRICTION_CURVE))
    tolerance = loader.tolerances.get(DRY)
    bare = _without_tolerances(loader, {DRY, BREAKAWAY, SEALS})
    stated = [key for key in (DRY, BREAKAWAY, SEALS) if bare[key] != OFF[key]]
    less = bare.replace({key: share * bare[key] for key in stated}, si=True)
    if tolerance is None:
        return less
    values = {at: getattr(tolerance, at) for at in ("low", "high", "peak", "deviation", "nominal")}
    scaled: dict[str, Any] = {at: None if value is None else share * value for at, value in values.items()}
    return less.with_tolerances({DRY: replace(tolerance, **scaled)})
