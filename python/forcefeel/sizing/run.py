"""The work: every demand beside what the drive gives."""

from math import isfinite, nan

import numpy as np

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.sizing.demand import Demand, Duration, column_mass_kg, demands
from forcefeel.sizing.motor import Motor
from forcefeel.sizing.plan import SizingPlan
from forcefeel.sizing.result import Asked, Curve, Remedy, Sizing
from forcefeel.sizing.valve import Valve

SHORT, LONG = "for a short time", "for ever"
"""Names of the curves."""


def size_drive(loader: Loader, axis: str | None = None, release_rad: float | None = None) -> Sizing:
    """Sets what the programmed feel and the rule ask of a loader's drive beside what it gives.

    Args:
        loader: The loader, with a motor or a valve.
        axis: Which control it is: ``pitch``, ``roll``, ``yaw`` or ``stick``; that of a built-in loader of its name, else pitch, if
            not given. The limits of 14 CFR 25.143(d) go by it.
        release_rad: Angle in rad of the release; half the throw's shorter side, 10 deg without stops, if not given.

    Returns:
        What is asked, what it takes, what the drive gives.

    Raises:
        InputError: If it is no loader, axis or angle.

    Example:
        >>> import forcefeel as ff
        >>> found = ff.sizing.size_drive(ff.loader.electric("elevator-electric"))
        >>> f"{found.gives.peak_force_n:.0f} N, {found.added_mass_kg:.2f} kg"
        '389 N, 0.63 kg'
    """
    return sized(SizingPlan.of(loader, axis, release_rad))


def sized(plan: SizingPlan) -> Sizing:
    """What came of a plan."""
    loader = plan.loader
    drive = Motor(loader) if loader.drive == ELECTRIC else Valve(loader)
    asked = tuple(_asked(drive, one) for one in demands(plan))
    return Sizing(
        plan=plan,
        gives=drive.gives,
        asked=asked,
        curves=_curves(drive, asked),
        missing=_missing(drive),
        added_mass_kg=drive.added_mass_kg,
        column_mass_kg=column_mass_kg(loader),
    )


def _asked(drive: Motor | Valve, demand: Demand) -> Asked:
    """What a demand takes at its worst moment."""
    force = demand.force_n + drive.added_mass_kg * demand.acceleration_m_per_s2
    speed = demand.speed_m_per_s
    held = demand.duration is not Duration.MOVING
    share = float(np.max(drive.share(force, speed)))
    lasting = _of_continuous(drive, float(force[0])) if held else nan
    pushes = np.where(force * speed > 0, 1.0, 1.0 if held else nan)
    return Asked(
        name=demand.name,
        duration=demand.duration,
        programmed=demand.programmed,
        force_n=float(np.abs(force).max()),
        speed_m_per_s=float(np.abs(speed).max()),
        of_peak=share,
        of_continuous=lasting,
        needs=drive.needs(force, speed, held=held),
        remedy=_remedy(drive, demand, float(force[0]), share, lasting),
        source=demand.source,
        verified=demand.verified,
        path_speed_m_per_s=np.abs(speed) * pushes,
        path_force_n=np.abs(force) * pushes,
    )


def _of_continuous(drive: Motor | Valve, force: float) -> float:
    """Share of what the drive gives for ever; by the current, which is what warms."""
    if isinstance(drive, Valve):
        return float(drive.share(np.array([force]), np.zeros(1))[0])
    current = drive.needs(np.array([force]), np.zeros(1), held=False).current_a
    lasting = drive.gives.continuous_current_a
    return current / lasting if lasting > 0 else nan if np.isnan(lasting) else np.inf


def _remedy(drive: Motor | Valve, demand: Demand, force: float, share: float, lasting: float) -> Remedy | None:
    """What would hold a force that the drive does not."""
    long = demand.duration is Duration.LONG
    beyond = lasting > 1 if long else share > 1
    if demand.duration is Duration.MOVING or not beyond:
        return None
    if isinstance(drive, Valve):
        return drive.remedy(abs(force))
    return drive.remedy(abs(force), drive.gives.continuous_force_n if long else drive.gives.peak_force_n)


def _curves(drive: Motor | Valve, asked: tuple[Asked, ...]) -> tuple[Curve, ...]:
    if isinstance(drive, Valve):
        return (Curve("the valve gives", *drive.curve()),)
    gives, limit = drive.gives, drive.loader["current_loop.current_limit"]
    if not isfinite(gives.peak_force_n):
        return ()
    fastest = gives.fastest_m_per_s
    if not isfinite(fastest):
        fastest = _MOST_SPEED * max(one.speed_m_per_s for one in asked)
    found = [Curve(f"the motor gives {SHORT}", *drive.curve(fastest, limit))]
    if gives.continuous_current_a > 0:
        found.append(Curve(f"the motor gives {LONG}", *drive.curve(fastest, gives.continuous_current_a)))
    return tuple(found)


_MOST_SPEED = 4.0
"""Times the largest speed that is asked for; a curve without an end is drawn so far."""


def _missing(drive: Motor | Valve) -> tuple[str, ...]:
    if isinstance(drive, Valve):
        return ()
    limits = ("current_loop.current_limit", "current_loop.voltage_limit")
    return (*(row for row in limits if not isfinite(drive.loader[row])), *drive.heat_rows)
