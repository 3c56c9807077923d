"""What feel and rule ask of a drive at the grip.

``F`` force at the grip · ``v`` its speed · ``theta_0`` angle of the release · ``R_p`` arm of the grip ·
``J`` inertia of the column · ``I``, ``B``, ``G`` the programmed feel
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite, pi

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.sizing.control_forces import RULE, control_forces
from forcefeel.sizing.plan import SizingPlan
from forcefeel.units import ANGLE, UnitSystem, to_text


class Duration(StrEnum):
    """How long a force is asked for."""

    SHORT = "short"
    LONG = "long"
    MOVING = "moving"


@dataclass(frozen=True, eq=False)
class Demand:
    """One thing that is asked of a drive.

    Attributes:
        name: In words.
        duration: How long.
        programmed: Whether the loader's own feel asks for it, not the rule.
        force_n: Force at the grip that turns the column, N, a moment each: one of a force that is held.
        acceleration_m_per_s2: Of the grip, along the force: the drive's own mass takes more force by it.
        speed_m_per_s: Speed of the grip, along the force.
        source: Where it comes from.
        verified: Whether a person has held it against that.
    """

    name: str
    duration: Duration
    programmed: bool
    force_n: NDArray[np.float64]
    acceleration_m_per_s2: NDArray[np.float64] = field(repr=False)
    speed_m_per_s: NDArray[np.float64] = field(repr=False)
    source: str
    verified: bool = True


def demands(plan: SizingPlan) -> tuple[Demand, ...]:
    """All that is asked: the pilot's force, the feel at its stops or where it is let go, a release, the rule's limits."""
    return tuple(_demands(plan))


def _demands(plan: SizingPlan) -> Iterator[Demand]:
    loader = plan.loader
    yield _held("pilot's force", loader["pilot.force"], "pilot.force of the loader file")
    stops = _stops_rad(loader)
    angle = max(stops or (plan.release_rad, -plan.release_rad), key=lambda end: programmed_force(loader, end))
    where = f"{to_text(ANGLE.from_si(abs(angle) if not stops else angle, UnitSystem.SI), 3)} deg"
    force = programmed_force(loader, angle)
    if isfinite(force):
        yield _held(
            f"feel at its stop, {where}" if stops else f"feel at {where}", force, "the programmed feel, standing still"
        )
    yield _release(plan)
    for row in control_forces():
        if row.axis == plan.axis:
            name = f"{RULE.removeprefix('14 CFR ')} {row.name}"
            yield _held(name, row.force_n, row.source, Duration(row.duration), programmed=False, verified=row.verified)


def _held(
    name: str,
    force: float,
    source: str,
    duration: Duration = Duration.SHORT,
    *,
    programmed: bool = True,
    verified: bool = True,
) -> Demand:
    none = np.zeros(1)
    return Demand(name, duration, programmed, np.array([force]), none, none, source, verified)


def _stops_rad(loader: Loader) -> list[float]:
    """The ends of the travel; none where nothing ends it."""
    for part in ("column.stop", "feel.hard_stop"):
        if known := [end for side in ("low", "high") if isfinite(end := loader[f"{part}_{side}"])]:
            return known
    return []


def programmed_force(loader: Loader, angle_rad: float) -> float:
    """Force at the grip in N, a magnitude, that holds the programmed control still at an angle.

    The parts of the feel's equation at rest add up (`crates/model/src/feel.rs`): ``G (theta - deadband) / R_p`` or the curve,
    times the largest factor of the dynamic pressure; breakout, preload, hysteresis and, before it moves on, friction; the
    soft stops.
    """
    return abs(_force(loader, angle_rad))


def _force(loader: Loader, angle: float) -> float:
    sign, size, arm = np.sign(angle), abs(angle), loader["column.grip_arm"]
    beyond = sign * max(size - loader["feel.deadband"], 0.0)
    curve = loader.force_curve
    spring = loader["feel.stiffness"] * beyond / arm if curve is None else float(curve.at(beyond))
    factor = max(loader.stiffness_factor.y) if loader.stiffness_factor else 1.0
    held = loader["feel.breakout"] * min(1.0, size / loader["feel.breakout_travel"]) + loader["feel.hysteresis"]
    held += max(loader["feel.coulomb_friction"], loader["feel.static_friction"])
    stop = loader["feel.soft_stop_high"] if sign > 0 else loader["feel.soft_stop_low"]
    past = max(size - abs(stop), 0.0) if isfinite(stop) else 0.0
    stopped = loader["feel.soft_stop_stiffness"] * past / arm
    return float(factor * spring + sign * (held + stopped) + loader["feel.preload"])


def _release(plan: SizingPlan) -> Demand:
    """The hands-off release of ``I``, ``B``, ``G``: the drive accelerates the column, ``F = J theta'' / R_p``, eqs. (6), (7)."""
    loader = plan.loader
    feel = np.array([[loader[key] for key in FEEL_SETTING]])
    inertia, damping, stiffness = feel[0]
    time = np.linspace(0.0, PERIODS * 2 * pi * np.sqrt(inertia / stiffness), MOMENTS)
    angle, rate = _core.feel_transitions(feel, time)[0, :, :, 0].T * plan.release_rad
    acceleration = -(damping * rate + stiffness * angle) / inertia
    arm = loader["column.grip_arm"]
    name = f"release from {to_text(ANGLE.from_si(plan.release_rad, UnitSystem.SI), 3)} deg"
    force = loader["column.inertia"] * acceleration / arm
    return Demand(
        name, Duration.MOVING, True, force, arm * acceleration, arm * rate, "the programmed I, B, G, eq. (11)"
    )


PERIODS, MOMENTS = 1.5, 601
"""Periods of a release that are looked at, since later swings are smaller, and into how many moments they are cut."""
