"""Observable parameters of a loader by a set of records, before any fit.

``s_j`` derivative of all samples by parameter j, in shares of its value, over 1 % of each channel's r.m.s. (points,)

Parameters are taken in order of importance to a law. One is fitted if the part of ``s_j`` independent of the earlier ones,
``r_j = s_j - S (S^+ s_j)``, determines it: white noise of 1 % gives a standard error of ``1 / |r_j|``. If ``s_j`` is large and
``r_j`` is not, its effect is equivalent to that of others: with its file value, their estimates describe the same machine.

Friction is observable only if the motion reverses: in one direction it is a constant force, like an offset.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.identification.linear import LinearModel
from forcefeel.bench.identification.record_observation import RecordObservation
from forcefeel.bench.identification.record_run import COARSE_STEP_S, RecordRun
from forcefeel.bench.identification.response_observation import ResponseObservation
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.envelope.deviations import deviations_of
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC

DRY, BREAKAWAY = "column.coulomb_friction", "column.static_friction"
STRIBECK, ASYMMETRY, SEALS = "column.stribeck_velocity", "column.friction_asymmetry", "actuator.seal_friction"

FRICTION_CURVE = (BREAKAWAY, STRIBECK, ASYMMETRY, SEALS)
"""Rows that tell friction as it is from one that is the same at every speed, either way."""

_LAST = ("actuator.area", "actuator.bulk_modulus", "column.base_arm", "column.grip_arm")
"""Rows known by measurement or data sheet, fitted last."""

_MOTOR_FRICTION = ("motor.coulomb_friction", "motor.viscous_friction", "motor.cogging_torque")
"""Frictions of a motor, fitted if the file states them."""

_LEAST_SEEN = 4.0
"""|r_j|: 95 % of an estimate's errors within half of its value, beyond which an identification gives no number."""

_OWN = 3e-3
"""|r_j| / |s_j| below which it is rounding that tells a parameter from the others."""

_DISPLACEMENTS = ("column_angle", "piston_position", "drive_position", "motor_angle")
_WAY_BACK = 0.1
"""Of the travel in a record, above what noise makes."""

_FRICTION_AT_RAD = radians(1.0)
"""The feel's spring at this angle is a usual dry friction: where the search for it begins."""

_BREAKAWAY_SHARE = 1.2
"""Breakaway in the dry friction, where the search begins."""

_STRIBECK_RAD_PER_S, _ASYMMETRY, _SEALS_SHARE = 0.05, 0.1, 0.3
"""Where the search for these begins; of the seals a share of the dry friction, at the piston."""


@dataclass(frozen=True)
class Observability:
    """Parameters by observability.

    Attributes:
        fitted: Rows to be fitted.
        carried: Rows with an effect equivalent to that of the fitted ones.
        unseen: Rows with hardly any effect.
    """

    fitted: tuple[str, ...]
    carried: tuple[str, ...]
    unseen: tuple[str, ...]


def with_friction(loader: Loader) -> Loader:
    """The loader with a start value of dry friction, without tolerances that only bound a search.

    A search converges to a small friction from a large one, but not the reverse. A file with a normal tolerance of friction defines
    the start. An estimate includes the effect of inseparable parameters, and may exceed its own tolerance.
    """
    bounds = [key for key, tolerance in loader.tolerances.items() if tolerance.deviation is None]
    bare = loader.with_tolerances(dict.fromkeys(bounds))
    with_tolerance = bool({DRY, BREAKAWAY} & set(bare.tolerances))
    typical = bare["feel.stiffness"] * _FRICTION_AT_RAD / bare["column.grip_arm"]
    dry = bare[DRY] if with_tolerance and bare[DRY] else max(bare[DRY], typical)
    breakaway = bare[BREAKAWAY] if with_tolerance and bare[BREAKAWAY] else _BREAKAWAY_SHARE * dry
    lever = bare["column.grip_arm"] / (bare["linkage.ratio"] * bare["column.base_arm"])
    begins = {
        DRY: dry,
        BREAKAWAY: breakaway,
        STRIBECK: bare[STRIBECK] or _STRIBECK_RAD_PER_S,
        ASYMMETRY: bare[ASYMMETRY] or _ASYMMETRY,
    }
    if bare.drive != ELECTRIC:
        begins[SEALS] = bare[SEALS] or _SEALS_SHARE * dry * lever
    return bare.replace(begins, si=True)


def candidates(loader: Loader) -> tuple[str, ...]:
    """Candidate parameters of a loader with friction, in order of importance to a law."""
    elsewhere = ("load_cell", "potentiometer", DRY, *FRICTION_CURVE)
    plant = [key for key in deviations_of(loader) if loader[key] and not key.startswith(elsewhere)]
    more = [key for key in _MOTOR_FRICTION if loader.drive == ELECTRIC and loader[key]]
    first = [key for key in plant if key not in _LAST and key not in more]
    curve = (key for key in FRICTION_CURVE if loader[key])
    return (DRY, *first, *more, *curve, *(key for key in _LAST if key in plant))


def seen_by(
    loader: Loader, data: Sequence[Response | BenchRecord], keys: Sequence[str], law: Law | None = None
) -> Observability:
    """Sort parameters by observability at the file's values."""
    slopes = sensitivities(loader, data, keys, law)
    one_way = not any(turns_round(measurement) for measurement in data if isinstance(measurement, BenchRecord))
    sorted_keys: dict[str, list[str]] = {"fitted": [], "carried": [], "unseen": []}
    basis: list[NDArray[np.float64]] = []
    for key, column in zip(keys, slopes, strict=True):
        residual, size = column.copy(), float(np.linalg.norm(column))
        for _ in range(2):  # twice, for rounding
            for vector in basis:
                residual -= (vector @ residual) * vector
        norm = float(np.linalg.norm(residual))
        if not size > _LEAST_SEEN or (key in (DRY, BREAKAWAY) and one_way):
            sorted_keys["unseen"].append(key)
        elif norm > max(_LEAST_SEEN, _OWN * size):
            sorted_keys["fitted"].append(key)
            basis.append(residual / norm)
        else:
            sorted_keys["carried"].append(key)
    return Observability(*(tuple(sorted_keys[name]) for name in ("fitted", "carried", "unseen")))


def turns_round(record: BenchRecord) -> bool:
    """Whether the motion in a record reverses, or is not recorded."""
    displacements = [record.channels[name] for name in _DISPLACEMENTS if name in record.channels]
    return not displacements or any(
        _less_way(displacement) > _WAY_BACK * np.ptp(displacement) for displacement in displacements
    )


def _less_way(x: NDArray[np.float64]) -> float:
    """The lesser of the longest rise and the longest fall."""
    up, down = (np.max(sign * x - np.minimum.accumulate(sign * x)) for sign in (1, -1))
    return float(min(up, down))


def sensitivities(
    loader: Loader, data: Sequence[Response | BenchRecord], keys: Sequence[str], law: Law | None = None
) -> NDArray[np.float64]:
    """Derivative of all points by each parameter in shares of its value, over 1 % of the expected size, (keys, points)."""
    values = np.array([loader[key] for key in keys])
    rows = []
    for measurement in data:
        observed = (
            ResponseObservation(measurement, LinearModel(loader, measurement.experiment.loop, law), keys)
            if isinstance(measurement, Response)
            else RecordObservation(RecordRun(measurement, loader, law, COARSE_STEP_S), keys)
        )
        slopes = observed.compare(values, observed.own).slopes[:, : len(keys)]
        rows.append(np.where(np.isfinite(slopes), slopes, 0.0).T * values[:, np.newaxis])
    return np.hstack(rows)
