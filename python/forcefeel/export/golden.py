"""Inputs of the golden vectors of an exported law: runs of its loader, random input, random flights, rows that are tuned.

``forcefeel._core.ExportedLaw.answers`` gives what the simulated controller answers.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import LawSource
from forcefeel.errors import InputError
from forcefeel.export.exported import Exported
from forcefeel.export.tunable import tuned
from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.loader.parameters import ELECTRIC
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.loader.surface import has_surface
from forcefeel.simulation.engine import simulate
from forcefeel.simulation.inputs.signals import Chirp, Release
from forcefeel.simulation.scenario import Scenario

PART = 2500
"""Samples of each part: release, sweep, random input from beyond either stop."""

_SEED = 20
RELEASED_RAD = 0.1
"""Where a release begins, of a feel that the drive can hold there."""
_RESTING = 400
"""Samples in which friction holds the column before a sweep."""
_SWINGING = 1400
"""Samples of swings against a column that is held: slower than those that the law takes for contact at once, and growing."""
_APART_RAD = 0.2
"""How far a column swings to either side, farther than its feel follows."""
_QUICK = 8
"""Place of ``t_q`` among the numbers of the part for contact."""
_SHARES = (1.0, 0.1, 0.01)
"""Factors on release and sweep: with a feel that is heavy for the drive, a large one can diverge."""

_ALWAYS = ("force", "position", "base", "grip", "trim", "stiffness_factor", "shaker")
_CHANGING = ("blend",)
_ADDED = ("added_force", "added_stiffness", "added_damping")
INPUTS = (*_ALWAYS, *_CHANGING, *_ADDED)
"""Inputs of the law each period: those of a law for several settings, and of a loader with a surface, among them."""

TUNINGS = 17
"""Values of the rows that are tuned: the loader's own, the least, the greatest, and others at random."""

_FLIGHT = {
    "dynamic_pressure": ("in Pa", 0.0, 2e4),
    "true_airspeed": ("in m/s", 0.0, 250.0),
    "angle_of_attack": ("in rad", -0.3, 0.3),
    "sideslip": ("in rad", -0.3, 0.3),
    "roll_rate": ("in rad/s", -1.0, 1.0),
    "pitch_rate": ("in rad/s", -1.0, 1.0),
    "yaw_rate": ("in rad/s", -1.0, 1.0),
    "load_factor": ("in g", -1.0, 3.0),
    "mach": ("Mach number", 0.0, 1.2),
    "tab": ("angle of the trim tab in rad", -0.3, 0.3),
    "angle": ("of the control in rad", -0.3, 0.3),
}
"""What a hinge moment is given: unit, and between which values the golden vectors lie."""
_FLIGHTS = 500


def golden_flights(
    loader: Loader, added: Callable[[NDArray[np.float64]], NDArray[np.float64]], *, single: bool
) -> dict[str, object]:
    """Numbers of a flight with their units; of a loader with a surface, random flights, and what it adds in them."""
    numbers = {name: unit for name, (unit, *_) in _FLIGHT.items()}
    if not has_surface(loader):
        return {"flight": numbers}
    low, high = np.array([limits for _, *limits in _FLIGHT.values()]).T
    flights = np.random.default_rng(_SEED).uniform(low, high, (_FLIGHTS, len(_FLIGHT)))
    if single:
        flights = flights.astype(np.float32).astype(np.float64)
    return {
        "flight": numbers,
        "flights": _FLIGHTS,
        "flown": spelled_rows(flights, single=single),
        "adds": spelled_rows(added(flights), single=single),
    }


def golden_columns(exported: Exported) -> tuple[str, ...]:
    """Those of ``INPUTS`` that the law's C is given."""
    added = exported.linked or has_surface(exported.loader)
    return _ALWAYS + _CHANGING * (len(exported.settings) > 1) + _ADDED * added


def golden_tunings(exported: Exported, *, single: bool) -> NDArray[np.float64]:
    """Values of the rows that are tuned (17, rows), the first those of the loader."""
    rows = exported.tunable
    low, high = np.array([[row.low for row in rows], [row.high for row in rows]])
    own = [exported.loader[row.key] for row in rows]
    others = np.random.default_rng(_SEED).uniform(low, high, (TUNINGS - 3, len(rows)))
    values = np.vstack([own, low, high, others])
    return values.astype(np.float32).astype(np.float64) if single else values


def golden_inputs(exported: Exported) -> tuple[NDArray[np.float64], list[tuple[int, int]]]:
    """Inputs (samples, 11) and settings: a release and a sweep from runs of the loader, random input from beyond either stop.

    In the random parts the settings, trim, spring factor and shaker change, and what a surface adds. Of a law with rows that are
    tuned the settings are places among ``golden_tunings``. Before the random parts are releases with the least and the greatest.

    Raises:
        InputError: If a run diverges.
    """
    loader = exported.loader
    period = exported.law.period_s or 0.0
    law = exported.law.some([0])
    own = loader.replace(dict(zip(FEEL_SETTING, exported.settings[0].tolist(), strict=True)), si=True)
    force = loader["pilot.force"]
    duration = PART * period

    def release(share: float) -> Scenario:
        return Scenario(Release(RELEASED_RAD * share), duration_s=duration, sample_s=period)

    def sweep(share: float) -> Scenario:
        return Scenario(Chirp(0.3 * share * force, 0.2, 20.0, duration), duration_s=duration, sample_s=period)

    swept = recorded(own, law, sweep)
    if exported.sampled().knows_friction:
        swept = np.vstack([_resting(loader, swept[0]), swept[:-_RESTING]])
    parts = [recorded(own, law, release), swept]
    pairs = [(0, 0)] * (2 * PART)
    if exported.tunable:
        for setting, end in ((1, "least"), (2, "greatest")):
            values = {row.key: row.low if end == "least" else row.high for row in exported.tunable}
            try:
                parts.append(recorded(tuned(own, values), law, release))
            except InputError as error:
                raise InputError(f"tunable: with the {end} values: {error}; narrow the ranges") from error
            pairs += [(setting, setting)] * PART
    random = np.random.default_rng(_SEED)
    size = np.abs(np.vstack(parts)[:, :3]).max(axis=0)
    count = TUNINGS if exported.tunable else len(exported.settings)
    for side in (-1, 1):
        part = _stirred(exported, size, side, random)
        for k in range(PART):
            block, within = divmod(k, 200)  # a tenth of a second with shares, then a constant one
            part[k, 7] = within / 100 if len(exported.settings) > 1 and within < 100 else 0.0
            pairs.append((block % count, (block + (not exported.tunable)) % count))
        parts.append(part)
    return np.vstack(parts), pairs


def _stirred(
    exported: Exported, size: NDArray[np.float64], side: int, random: np.random.Generator
) -> NDArray[np.float64]:
    """Random input that begins at rest beyond the stops of one side.

    On the low side the column swings apart from its feel, on the high one a hand swings against a column that is held.
    """
    loader = exported.loader
    force, sampled = loader["pilot.force"], exported.sampled()
    inputs = np.zeros((PART, len(INPUTS)))
    inputs[:, :3] = size * random.standard_normal((PART, 3)).cumsum(axis=0) / 20
    inputs[:, 3] = has_grip_sensor(loader) * force * random.uniform(-1, 1, PART)
    inputs[:, 4:7] = [0.0, 1.0, 0.0] + [0.02, 0.2, 0.5] * random.uniform(-1, 1, (PART, 3))
    if exported.linked or has_surface(loader):
        beside = [0.1 * force, loader["feel.stiffness"], loader["feel.damping"]]
        inputs[:, 8:] = beside * random.uniform(-0.5, 1, (PART, 3))
    base = _beyond(loader, side) * loader["column.base_arm"]
    inputs[:, 1:3] += base * np.array([loader["linkage.ratio"], 1.0])
    if sampled.knows_contact:
        inputs[:_SWINGING, 1:3] = inputs[0, 1:3]
        if side < 0:
            inputs[:_SWINGING, 0] = 0.0
            inputs[:_SWINGING, :3] += _swinging_apart(exported, _SWINGING)
        else:
            swings = np.arange(_SWINGING) * sampled.period_s / (1.5 * sampled.contact[0, _QUICK])
            inputs[:_SWINGING, 0] = size[0] * 1.6 ** np.minimum(swings, 8.0) * np.sin(np.pi * swings)
    return inputs


def _resting(loader: Loader, sample: NDArray[np.float64]) -> NDArray[np.float64]:
    """A column at its neutral (count, 11) under a hand that holds the feel's preload: friction may hold it as well."""
    samples = np.tile(sample, (_RESTING, 1))
    lever = loader["linkage.ratio"] * loader["column.base_arm"]
    samples[:, :3] = [-loader["feel.preload"] * loader["column.grip_arm"] / lever, 0.0, 0.0]
    return samples


def _swinging_apart(exported: Exported, count: int) -> NDArray[np.float64]:
    """Load cell, position and base (count, 3) of a column that swings farther than its feel follows."""
    loader, swing_s = exported.loader, 1.5 * float(exported.sampled().contact[0, _QUICK])
    angle = _APART_RAD * np.sin(np.pi * np.arange(count) * exported.sampled().period_s / swing_s)
    arm = loader["column.base_arm"]
    force = -loader["column.inertia"] * (np.pi / swing_s) ** 2 * angle / (arm * loader["linkage.ratio"])
    return np.column_stack([force, angle * arm * loader["linkage.ratio"], angle * arm])


def _beyond(loader: Loader, side: int) -> float:
    """An angle beyond the stops and the curve of a feel on one side."""
    end = "low" if side < 0 else "high"
    curve = [] if loader.force_curve is None else [loader.force_curve.arrays[0][0 if side < 0 else -1]]
    ends = [side * RELEASED_RAD, *curve, *(loader[f"feel.{stop}_stop_{end}"] for stop in ("soft", "hard"))]
    return float(1.1 * side * max(side * angle for angle in ends if math.isfinite(angle)))


def recorded(loader: Loader, law: Law, scenario: Callable[[float], Scenario], count: int = PART) -> NDArray[np.float64]:
    """Sensor values at each of ``count`` samples of ``scenario(1.0)``, or of a smaller one if that diverges.

    Raises:
        InputError: If the smallest diverges too.
    """
    for share in _SHARES:
        outputs = simulate(loader, scenario(share), law).outputs
        if np.isfinite(outputs["column_angle_rad"]).all():
            break
    else:
        feel = ", ".join(f"{loader[key]:.6g}" for key in FEEL_SETTING)
        raise InputError(
            f"law: {loader.name} diverges with {law.name} at I, B, G = {feel} (SI units), so there is no reference for the export; "
            "use settings that this loader can render, or another law"
        )
    position = "drive_position_m" if loader.drive == ELECTRIC else "piston_position_m"
    samples = np.zeros((count, len(INPUTS)))
    base = outputs["column_angle_rad"] * loader["column.base_arm"]
    for column, values in enumerate((outputs["load_cell_force_n"], outputs[position], base)):
        samples[:, column] = values[:count]
    samples[:, 5] = 1.0
    return samples


def within_ranges(inputs: NDArray[np.float64], source: LawSource) -> NDArray[np.float64]:
    """Inputs (samples, 11), clipped to the ranges of the law's inputs."""
    clipped = inputs.copy()
    for name, (low, high) in source.inputs:
        column = INPUTS.index(name)
        clipped[:, column] = clipped[:, column].clip(low, high)
    return clipped


def spelled_rows(numbers: NDArray[np.float64], *, single: bool) -> str:
    """C literals that are exact to the last bit."""

    def spelled(value: float) -> str:
        if not math.isfinite(value):
            return "NAN" if math.isnan(value) else "INFINITY" if value > 0 else "-INFINITY"
        return f"{np.float32(value)!s}F" if single else repr(value)

    return ",\n".join(f"    {{{', '.join(map(spelled, row))}}}" for row in numbers.tolist())
