"""Gains from hardware changes: the law is designed for each changed loader, and its shares are compared."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import pi
from typing import Annotated

from forcefeel.envelope.plan import Plan
from forcefeel.envelope.result import Shares
from forcefeel.envelope.worst_case import worst_case_shares
from forcefeel.frontier.tightening import INERTIA, KNOWN_BETTER
from forcefeel.frontier.tolerance_levels import Progress, ToleranceLevels
from forcefeel.laws.sampled.grip import GRIP
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import OFF, TABLE, in_range
from forcefeel.loader.sensors import SENSORS
from forcefeel.units import PERCENT

KNOWN_TO = 0.02
"""Tolerance of a bench measurement; the nearest level is used unless the inertia is known better already."""


@dataclass(frozen=True)
class HardwareChange:
    """Change of the hardware.

    Attributes:
        name: Its name.
        factors: Factors on rows of the parameter table.
        remark: Accompanying condition.
        adds: New rows, as shares of an existing row.
        sets: New SI values of rows, for a loader with a digital controller.
        law: Law of the changed loader; unchanged if empty.
    """

    name: str
    factors: Mapping[str, float] = field(default_factory=dict)
    remark: str = ""
    adds: Mapping[str, tuple[float, str]] = field(default_factory=dict)
    sets: Mapping[str, float] = field(default_factory=dict)
    law: str = ""

    def applies(self, loader: Loader) -> bool:
        """Whether the loader has the changed rows, lacks the added ones, and stays within the ranges of the parameter table."""
        if any(loader[key] != OFF[key] for key in self.adds) or (
            (self.law or self.sets) and not loader["controller.period"]
        ):
            return False
        return all(
            loader[key] not in {OFF.get(key), 0.0} and in_range(TABLE[key], loader[key] * factor)
            for key, factor in self.factors.items()
        )

    def on(self, loader: Loader) -> Loader:
        """The changed loader."""
        changed = {key: loader[key] * factor for key, factor in self.factors.items()}
        added = {key: share * (loader[of] if of else 1.0) for key, (share, of) in self.adds.items()}
        return loader.replace(changed | added | dict(self.sets), si=True)


GRIP_SENSOR = "force sensor at the grip"
"""Name of the change that adds a sensor."""

_FINER = tuple(f"{part}.{name}" for part in SENSORS for name in ("noise", "resolution"))

_BITS = (17, 20, 23)
"""Bits of available encoders."""

_LIMITS_OF_MOTOR = ("current_loop.current_limit", "current_loop.voltage_limit")

CHANGES = (
    HardwareChange(
        "link twice as stiff",
        {"linkage.stiffness": 2.0, "linkage.damping": 2**0.5},
        "its damping ratio stays",
    ),
    HardwareChange("transmission twice as stiff", {"transmission.stiffness": 2.0}),
    HardwareChange("valve twice as fast", {"valve.natural_frequency": 2.0}),
    HardwareChange("current loop twice as fast", {"current_loop.bandwidth": 2.0}),
    HardwareChange("rotor half as heavy", {"motor.inertia": 0.5}, "its tolerance stays the same share"),
    HardwareChange(
        "twice the sampling rate",
        {"controller.period": 0.5, "controller.delay": 0.5},
        "the delay stays the same share of the period",
    ),
    HardwareChange("half the delay", {"controller.delay": 0.5}, "at the same rate"),
    HardwareChange("sensors four times finer", dict.fromkeys(_FINER, 0.25), "noise and resolution"),
    *(
        HardwareChange(
            f"encoder of {bits} bits at the column",
            remark="noise and resolution a step, a turn over 2^bits",
            sets=dict.fromkeys(("column_sensor.noise", "column_sensor.resolution"), 2 * pi / 2**bits),
        )
        for bits in _BITS
    ),
    HardwareChange(
        "supply pressure +50 %",
        {"valve.supply_pressure": 1.5, "valve.rated_flow": 1.5**0.5},
        "the orifice's flow follows its root",
    ),
    HardwareChange(
        "current and flow limit +50 %",
        {"amplifier.current_limit": 1.5, "valve.flow_limit": 1.5},
        "a larger spool stroke",
    ),
    HardwareChange("largest current and voltage +50 %", dict.fromkeys(_LIMITS_OF_MOTOR, 1.5), "torque and speed"),
    HardwareChange(
        GRIP_SENSOR,
        remark=f"law {GRIP}; noise and steps a 5,000th of the pilot's force",
        adds={
            "grip_sensor.gain": (1.0, ""),
            "grip_sensor.noise": (2e-4, "pilot.force"),
            "grip_sensor.resolution": (2e-4, "pilot.force"),
        },
        law=GRIP,
    ),
    HardwareChange("column half as heavy", {INERTIA: 0.5}, "its tolerance stays the same share"),
)
"""Changes to compute if they apply to the loader."""


@dataclass(frozen=True)
class Gain:
    """Gain from a change.

    Attributes:
        name: The change.
        remark: Accompanying condition.
        nominal, worst, stable_worst: Shares of the settings that pass nominally, pass in every case, and are stable in every case.
        nominal_gain, worst_gain, stable_worst_gain: Differences to the unchanged loader.
    """

    name: str
    remark: str
    nominal: Annotated[float, PERCENT]
    worst: Annotated[float, PERCENT]
    stable_worst: Annotated[float, PERCENT]
    nominal_gain: Annotated[float, PERCENT]
    worst_gain: Annotated[float, PERCENT]
    stable_worst_gain: Annotated[float, PERCENT]


def hardware_releases(plan: Plan) -> int:
    """Number of settings times cases of all changes that apply; some are decided without a run."""
    return sum(change.applies(plan.loader) for change in CHANGES) * plan.settings.count * len(plan.cases)


def hardware(
    levels: ToleranceLevels, *, threads: int | None = None, progress: Progress = lambda done, total: None
) -> tuple[Gain, ...]:
    """Compute the gains over ``levels``, the law on the unchanged loader; the largest in the worst case first."""
    plan, gains, done = levels.full.plan, [], 0
    before = levels.full.shares(levels.law)
    total = hardware_releases(plan)
    hardest = [row.case for row in sorted(levels.full.case_shares(levels.law), key=lambda row: row.passes)]

    def advance(some: int) -> None:
        nonlocal done
        done += some
        progress(done, total)

    for change in CHANGES:
        if not change.applies(plan.loader):
            continue
        # G_max and the settings do not change; a law given by name is designed for the changed loader.
        changed = Plan(
            change.on(plan.given),
            {law: LAW_DESIGNS[law]} if (law := change.law) else plan.laws,
            plan.settings,
            plan.rule,
            plan.deviations,
            plan.arms,
            plan.release_rad,
        )
        after = worst_case_shares(changed, hardest, threads=threads, advance=advance)
        gains.append(_gain(change.name, change.remark, after, before))
    if levels.tolerances[INERTIA] > KNOWN_TO:
        gains += [_known(levels, before, keys) for keys in ((INERTIA,), KNOWN_BETTER)]
    return tuple(sorted(gains, key=lambda gain: (-gain.worst_gain, -gain.nominal_gain)))


def _gain(name: str, remark: str, after: Shares, before: Shares) -> Gain:
    return Gain(
        name,
        remark,
        after.nominal_share,
        after.worst_case_share,
        after.stable_worst,
        after.nominal_share - before.nominal_share,
        after.worst_case_share - before.worst_case_share,
        after.stable_worst - before.stable_worst,
    )


def _known(levels: ToleranceLevels, before: Shares, keys: Sequence[str]) -> Gain:
    """Gain with some parameters on the level with the inertia known to ``KNOWN_TO``: the same machine, measured better."""
    full = levels.tolerances[INERTIA]
    level = min(range(len(levels.factors)), key=lambda k: abs(levels.factors[k] * full - KNOWN_TO))
    worst, stable = (float(levels.worst(keys, level, stable=only_stable).mean()) for only_stable in (False, True))
    after = Shares(levels.law, before.stable, before.nominal_share, stable, worst)
    what = "column inertia" if len(keys) == 1 else "column inertia, linkage ratio and base arm"
    return _gain(f"{what} known to {100 * levels.factors[level] * full:.3g} %", "the same machine", after, before)
