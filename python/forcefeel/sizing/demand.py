"""Demands of the feel and the rule on a drive, at the grip.

``F`` force at the grip · ``v`` its speed · ``theta_0`` angle of the release · ``R_p`` arm of the grip ·
``J`` inertia of the column · ``I``, ``B``, ``G`` the programmed feel
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from math import isfinite, pi

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel import _core
from forcefeel.linear.release_motion import release_motion
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.sizing.control_forces import RULE, control_forces
from forcefeel.sizing.plan import SizingPlan
from forcefeel.units import ANGLE, UnitSystem, to_text


class Duration(StrEnum):
    """Duration of a demand."""

    SHORT = "short"
    LONG = "long"
    MOVING = "moving"


@dataclass(frozen=True, eq=False)
class Demand:
    """One demand on a drive.

    Attributes:
        name: Its name.
        duration: Its duration.
        programmed: Whether it comes from the loader's feel, not from the rule.
        force_n: Force at the grip that moves the column, N, over time; one value for a held force.
        acceleration_m_per_s2: Acceleration of the grip along the force; the drive's own mass adds force.
        speed_m_per_s: Speed of the grip along the force.
        source: Its source.
        verified: Whether it is verified against the source.
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
    """All demands: pilot's force, largest force of the feel, a release, limits of the rule."""
    return tuple(_demands(plan))


def _demands(plan: SizingPlan) -> Iterator[Demand]:
    loader = plan.loader
    yield _held("pilot's force", loader["pilot.force"], "pilot.force of the loader file")
    yield from feel_demands(plan)
    yield _release(plan)
    for row in control_forces():
        if row.axis == plan.axis:
            name = f"{RULE.removeprefix('14 CFR ')} {row.name}"
            yield _held(name, row.force_n, row.source, Duration(row.duration), programmed=False, verified=row.verified)


def feel_demands(plan: SizingPlan) -> Iterator[Demand]:
    """Largest holding force of the feel, up to its stops or the angle of the release."""
    loader, stops = plan.loader, _stops_rad(plan.loader)
    ends = stops or (-plan.release_rad, plan.release_rad)
    angle = hardest_angle(loader, min(*ends, 0.0), max(*ends, 0.0))
    force = float(programmed_force(loader, angle))
    if isfinite(force):
        labeled = angle if stops or angle not in ends else abs(angle)
        where = f"{to_text(ANGLE.from_si(labeled, UnitSystem.SI), 3)} deg"
        name = f"feel at its stop, {where}" if angle in stops else f"feel at {where}"
        yield _held(name, force, "the programmed feel, at rest")


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
    """Ends of the travel; empty without stops."""
    for part in ("column.stop", "feel.hard_stop"):
        if known := [end for side in ("low", "high") if isfinite(end := loader[f"{part}_{side}"])]:
            return known
    return []


def programmed_force(loader: Loader, angles_rad: ArrayLike) -> NDArray[np.float64]:
    """Largest holding force of the programmed control at rest, N at the grip, a magnitude; shape as ``angles_rad``.

    The maximum covers the states of hysteresis and shaker, static friction, and all stiffness factors of the dynamic pressure
    (`crates/model/src/feel.rs`).
    """
    angles = np.asarray(angles_rad, dtype=np.float64)
    factor = loader.stiffness_factor
    engine = loader.force_curve.arrays if loader.force_curve else None
    between = [
        _core.feel_held_between(loader.si_values, angles.ravel(), scale, curve=engine)
        for scale in ((min(factor.y), max(factor.y)) if factor else (1.0,))
    ]
    return np.asarray(np.abs(between).max(axis=(0, 2))).reshape(angles.shape)


def column_mass_kg(loader: Loader) -> float:
    """Mass of the column at the grip, kg: ``J / R_p^2``."""
    return float(_core.column_grip_force(loader.si_values, np.array([1 / loader["column.grip_arm"]]))[0])


def hardest_angle(loader: Loader, low_rad: float, high_rad: float) -> float:
    """Angle between two limits with the largest holding force; of several, the farthest from neutral."""
    ends, hardest = (low_rad, high_rad), 0.0
    for _ in range(_ZOOMS):
        angles = np.linspace(*ends, _ANGLES)
        force = programmed_force(loader, angles)
        most = force >= force.max() * (1 - _ROUNDING)
        at = int(np.argmax(np.where(most, np.abs(angles), -1.0)))
        hardest = float(angles[at])
        ends = (float(angles[max(at - 1, 0)]), float(angles[min(at + 1, _ANGLES - 1)]))
    return hardest


_ANGLES, _ZOOMS, _ROUNDING = 1001, 4, 1e-12
"""Angles of a search, number of refinements around the hardest angle, and rounding of equal forces."""


def _release(plan: SizingPlan) -> Demand:
    """The hands-off release of ``I``, ``B``, ``G``: the drive accelerates the column, ``F = J theta'' / R_p``, eqs. (6), (7)."""
    loader = plan.loader
    feel = np.array([[loader[key] for key in FEEL_SETTING]])
    motion = release_motion(loader, feel, plan.release_rad, release_s(loader) / (MOMENTS - 1), MOMENTS)
    rate, acceleration, _ = np.array(list(motion))[:, :, 0].T
    arm = loader["column.grip_arm"]
    name = f"release from {to_text(ANGLE.from_si(plan.release_rad, UnitSystem.SI), 3)} deg"
    force = _core.column_grip_force(loader.si_values, acceleration)
    return Demand(
        name, Duration.MOVING, True, force, arm * acceleration, arm * rate, "the programmed I, B, G, eq. (11)"
    )


def release_s(loader: Loader) -> float:
    """Evaluated duration of a release, s."""
    return PERIODS * 2 * pi / _core.feel_frequency(loader.si_values)[0]


PERIODS, MOMENTS = 1.5, 601
"""Evaluated periods of a release, because later swings are smaller, and number of samples."""
