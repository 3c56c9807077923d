"""The work: every demand beside what the drive gives."""

from dataclasses import dataclass, replace
from math import isfinite, nan

import numpy as np
from numpy.typing import NDArray

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.sizing.demand import Demand, Duration, column_mass_kg, demands, release_s
from forcefeel.sizing.motor import Motor, MotorNeeds
from forcefeel.sizing.plan import SizingPlan
from forcefeel.sizing.relief import Relief, relief
from forcefeel.sizing.result import Curve, DemandResult, Needs, Remedy, Sizing
from forcefeel.sizing.valve import Valve, ValveNeeds

SHORT, LONG = "for a short time", "continuously"
"""Names of the curves."""


def size_drive(loader: Loader, axis: str | None = None, release_rad: float | None = None) -> Sizing:
    """Sets what the programmed feel and the rule ask of a loader's drive beside what it gives.

    Args:
        loader: The loader, with a motor or a valve.
        axis: Which control it is: ``pitch``, ``roll``, ``yaw``, ``stick`` or ``collective``; that of a built-in loader of its
            name, else pitch, if not given. The limits of 14 CFR 25.143(d) go by it.
        release_rad: Angle in rad of the release; half the throw's shorter side, 10 deg without stops, if not given.

    Returns:
        The demands, their needs, and the capability of the drive.

    Raises:
        InputError: If it is no loader, axis or angle.

    Example:
        >>> sizing = ff.sizing.size_drive(ff.loader.electric("elevator-electric"))
        >>> f"{sizing.capability.peak_force_n:.0f} N, {sizing.added_mass_kg:.2f} kg"
        '389 N, 0.63 kg'
    """
    return sized(SizingPlan.of(loader, axis, release_rad))


def sized(plan: SizingPlan) -> Sizing:
    """What came of a plan."""
    loader = plan.loader
    drive = Motor(loader) if loader.drive == ELECTRIC else Valve(loader)
    relieved = relief(drive, plan.release_rad, release_s(loader))
    results = tuple(_demand_result(drive, demand, relieved) for demand in demands(plan))
    return Sizing(
        plan=plan,
        capability=drive.capability,
        demands=results,
        curves=_curves(drive, results),
        missing=_missing(drive),
        added_mass_kg=drive.added_mass_kg,
        column_mass_kg=column_mass_kg(loader),
    )


def _demand_result(drive: Motor | Valve, demand: Demand, relieved: Relief | None) -> DemandResult:
    """What a demand takes at its worst moment; a release also what the engine's run of it takes."""
    force = demand.force_n + drive.added_mass_kg * demand.acceleration_m_per_s2
    speed = demand.speed_m_per_s
    held = demand.duration is not Duration.MOVING
    share = float(np.max(drive.share(force, speed)))
    lasting = _of_continuous(drive, float(force[0])) if held else nan
    path = _Path.of(force, speed, held=held)
    result = DemandResult(
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
        path_speed_m_per_s=path.speed_m_per_s,
        path_force_n=path.force_n,
        of_motion=nan if held else share,
    )
    # What cannot follow the motion by itself is told of that alone.
    return result if held or relieved is None or share > 1 else _relieved(result, relieved)


@dataclass(frozen=True, eq=False)
class _Path:
    """Moment by moment as the drive pushes, not a number where it holds back."""

    speed_m_per_s: NDArray[np.float64]
    force_n: NDArray[np.float64]

    @classmethod
    def of(cls, force: NDArray[np.float64], speed: NDArray[np.float64], *, held: bool = False) -> "_Path":
        pushes = np.where(force * speed > 0, 1.0, 1.0 if held else nan)
        return cls(np.abs(speed) * pushes, np.abs(force) * pushes)


def _relieved(result: DemandResult, relieved: Relief) -> DemandResult:
    """A release with what the relief of the link takes: of each the most."""
    path = _Path.of(relieved.force_n, relieved.speed_m_per_s)
    return replace(
        result,
        force_n=_most(result.force_n, float(np.abs(relieved.force_n).max())),
        speed_m_per_s=_most(result.speed_m_per_s, float(np.abs(relieved.speed_m_per_s).max())),
        of_peak=_most(result.of_peak, relieved.of_peak),
        needs=_most_needs(result.needs, relieved.needs),
        source=f"{result.source}; the engine under {relieved.law}",
        law=relieved.law,
        path_speed_m_per_s=np.concatenate([result.path_speed_m_per_s, [nan], path.speed_m_per_s]),
        path_force_n=np.concatenate([result.path_force_n, [nan], path.force_n]),
    )


def _most_needs(first: Needs, other: Needs) -> Needs:
    largest = {name: _most(value, vars(other)[name]) for name, value in vars(first).items()}
    return MotorNeeds(**largest) if isinstance(first, MotorNeeds) else ValveNeeds(**largest)


def _most(first: float, other: float) -> float:
    """The larger of two; the other where one is not a number."""
    return float(np.fmax(first, other))


def _of_continuous(drive: Motor | Valve, force: float) -> float:
    """Share of the continuous capability of the drive; by the current, which warms the motor."""
    if isinstance(drive, Valve):
        return float(drive.share(np.array([force]), np.zeros(1))[0])
    current = drive.needs(np.array([force]), np.zeros(1), held=False).current_a
    lasting = drive.capability.continuous_current_a
    return current / lasting if lasting > 0 else nan if np.isnan(lasting) else np.inf


def _remedy(drive: Motor | Valve, demand: Demand, force: float, share: float, lasting: float) -> Remedy | None:
    """Remedy for a force that the drive cannot hold."""
    long = demand.duration is Duration.LONG
    beyond = lasting > 1 if long else share > 1
    if demand.duration is Duration.MOVING or not beyond:
        return None
    if isinstance(drive, Valve):
        return drive.remedy(abs(force))
    return drive.remedy(abs(force), drive.capability.continuous_force_n if long else drive.capability.peak_force_n)


def _curves(drive: Motor | Valve, results: tuple[DemandResult, ...]) -> tuple[Curve, ...]:
    if isinstance(drive, Valve):
        return (Curve("limit of the valve", *drive.curve()),)
    capability, limit = drive.capability, drive.loader["current_loop.current_limit"]
    if not isfinite(capability.peak_force_n):
        return ()
    fastest = capability.fastest_m_per_s
    if not isfinite(fastest):
        fastest = _MOST_SPEED * max(result.speed_m_per_s for result in results)
    curves = [Curve(f"limit of the motor {SHORT}", *drive.curve(fastest, limit))]
    if capability.continuous_current_a > 0:
        curves.append(Curve(f"limit of the motor {LONG}", *drive.curve(fastest, capability.continuous_current_a)))
    return tuple(curves)


_MOST_SPEED = 4.0
"""Times the largest speed that is asked for; a curve without an end is drawn so far."""


def _missing(drive: Motor | Valve) -> tuple[str, ...]:
    if isinstance(drive, Valve):
        return ()
    limits = ("current_loop.current_limit", "current_loop.voltage_limit")
    return (*(row for row in limits if not isfinite(drive.loader[row])), *drive.heat_rows)
