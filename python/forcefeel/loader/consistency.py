"""What the optional rows of the parameter table ask of one another."""

import math
from collections.abc import Mapping

from forcefeel.errors import InputError
from forcefeel.loader.parameters import OFF, TABLE, value_text

BELOW = (
    ("column.stop_low", "column.stop_high"),
    ("feel.soft_stop_low", "feel.soft_stop_high"),
    ("feel.hard_stop_low", "feel.hard_stop_high"),
    ("thermal.ambient", "thermal.derating_from"),
    ("thermal.derating_from", "thermal.winding_limit"),
    ("surface.mach_1", "surface.mach_2"),
    ("surface.mach_2", "surface.mach_3"),
    *((f"surface.deflection_{k}", f"surface.deflection_{k + 1}") for k in range(1, 7)),
)
"""Pairs of which the first lies below the second."""

AT_LEAST = (
    ("column.static_friction", "column.coulomb_friction"),
    ("feel.static_friction", "feel.coulomb_friction"),
    ("motor.static_friction", "motor.coulomb_friction"),
)
"""Pairs of which the first, where given, is no smaller than the second."""

_HEAT = tuple(
    f"thermal.{name}" for name in ("winding_capacity", "housing_capacity", "winding_resistance", "housing_resistance")
)

_SAMPLED = ("load_cell", "potentiometer", "column_sensor")

ONLY_WITH: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("actuator.relief_gain", ("actuator.relief_pressure",)),
    ("column.stribeck_velocity", ("column.static_friction",)),
    ("column.friction_asymmetry", ("column.coulomb_friction", "column.static_friction")),
    ("column.gravity_angle", ("column.gravity_torque",)),
    ("column.stop_stiffness", ("column.stop_low", "column.stop_high")),
    ("column.stop_damping", ("column.stop_low", "column.stop_high")),
    *((f"{sensor}.{name}", ("controller.period",)) for sensor in _SAMPLED for name in ("noise", "resolution")),
    ("grip_sensor.gain", ("controller.period",)),
    *(
        (f"grip_sensor.{name}", ("grip_sensor.gain",))
        for name in ("mass", "offset", "noise", "resolution", "bandwidth")
    ),
    ("controller.delay", ("controller.period",)),
    ("controller.input_range", ("controller.period",)),
    ("controller.input_range", ("controller.input_bits",)),
    ("controller.input_bits", ("controller.period",)),
    ("controller.input_bits", ("controller.input_range",)),
    ("controller.output_range", ("controller.period",)),
    ("controller.output_range", ("controller.output_bits",)),
    ("controller.output_bits", ("controller.period",)),
    ("controller.output_bits", ("controller.output_range",)),
    ("controller.antiwindup", ("controller.period",)),
    ("motor.cogging_periods", ("motor.cogging_torque",)),
    ("motor.cogging_phase", ("motor.cogging_torque",)),
    ("motor.cogging_periods_2", ("motor.cogging_torque_2",)),
    ("motor.cogging_phase_2", ("motor.cogging_torque_2",)),
    ("current_loop.continuous_current", ("current_loop.peak_time",)),
    ("current_loop.peak_time", ("current_loop.continuous_current",)),
    ("winding.temperature_coefficient", ("thermal.winding_capacity",)),
    *((key, (other,)) for key in _HEAT for other in _HEAT if key != other),
    *((f"thermal.{name}", ("thermal.winding_capacity",)) for name in ("ambient", "derating_from", "winding_limit")),
    ("brake.engaged", ("brake.torque",)),
    ("feel.breakout_travel", ("feel.breakout",)),
    ("feel.hysteresis_travel", ("feel.hysteresis",)),
    ("feel.detent_angle", ("feel.detent_force",)),
    ("feel.detent_travel", ("feel.detent_force",)),
    ("feel.soft_stop_stiffness", ("feel.soft_stop_low", "feel.soft_stop_high")),
    ("feel.soft_stop_damping", ("feel.soft_stop_low", "feel.soft_stop_high")),
    ("feel.shaker_frequency", ("feel.shaker_force",)),
    ("surface.area", ("surface.gearing",)),
    *(
        (f"surface.{name}", ("surface.area",))
        for name in (
            *("chord", "gearing", "gearing_change", "at_zero", "per_flow", "per_deflection", "per_tab", "per_rate"),
            *("share", "pressure_ratio", "flow_per_attack", "flow_per_sideslip", "incidence", "tab_gearing"),
            *("roll_arm", "pitch_arm", "yaw_arm", "tab_stiffness", "cable_stiffness", "compressible", "mach_1"),
            "deflection_1",
        )
    ),
    ("surface.mach_2", ("surface.mach_1",)),
    ("surface.mach_3", ("surface.mach_2",)),
    *(
        (f"surface.{name}_factor_{k}", (f"surface.mach_{k}",))
        for name in ("flow", "deflection", "tab")
        for k in (1, 2, 3)
    ),
    ("surface.deflection_1", ("surface.deflection_2",)),
    *((f"surface.deflection_{k}", (f"surface.deflection_{k - 1}",)) for k in range(2, 8)),
    *((f"surface.deflection_{k}", (f"surface.coefficient_{k}",)) for k in range(1, 8)),
    *((f"surface.coefficient_{k}", (f"surface.deflection_{k}",)) for k in range(1, 8)),
    ("surface.area", ("surface.chord",)),
)
"""Rows without effect unless one of the others is given."""

_ROUNDING = 1e-9
"""Relative; a value that was written in the other unit system is still the same."""

MOST_UNDER_WAY = 7
"""Longest delay of the digital controller, in periods."""

_MOST_PARTS = 64
"""The delay is a whole number of parts of the period, of so many at most."""


def complaints(values: Mapping[str, float]) -> list[str]:
    """A line for each optional row that does not go with the others; the SI values by ``part.name`` are good by themselves."""
    return [
        *(
            _not_below(low, high, values)
            for low, high in BELOW
            if low in values and not _below(values[low], values[high])
        ),
        *(
            _too_small(key, least, values)
            for key, least in AT_LEAST
            if key in values and values[key] != OFF[key] and values[key] < values[least] * (1 - _ROUNDING)
        ),
        *without_effect(values).values(),
        *_late(values),
        *_blind(values),
        *_undriven(values),
        *_two_springs(values),
    ]


def parts_of_period(period: float, delay: float) -> int:
    """The fewest equal parts of the controller's period, in s, of which its delay is a whole number.

    Raises:
        InputError: If the delay is longer than runs can follow, or there are too many parts.
    """
    limit, came = (value_text(TABLE[f"controller.{name}"], it) for name, it in (("period", period), ("delay", delay)))
    expected = f"at most {MOST_UNDER_WAY} periods of {limit}"
    if delay <= MOST_UNDER_WAY * period * (1 + _ROUNDING):
        for parts in range(1, _MOST_PARTS + 1):
            share = delay / period * parts
            if abs(share - round(share)) < _ROUNDING * parts:
                return parts
        expected = f"a simple share of the period of {limit}, such as a half or a tenth"
    raise InputError(f"controller.delay: expected {expected}, got {came}")


def _late(values: Mapping[str, float]) -> list[str]:
    """A line for a delay that no run could follow."""
    period, delay = values["controller.period"], values["controller.delay"]
    try:
        if period:
            parts_of_period(period, delay)
    except InputError as error:
        return [str(error)]
    return []


def _undriven(values: Mapping[str, float]) -> list[str]:
    """A line for a motor without a controller."""
    if "motor.torque_constant" in values and not values["controller.period"]:
        return [
            "controller.period: missing value; an electric drive takes its command from a digital controller; "
            'add [controller] period = "0.5 ms" and delay = "0.5 ms"'
        ]
    return []


def _two_springs(values: Mapping[str, float]) -> list[str]:
    """A line for a coefficient of the surface's angle beside a table over that angle."""
    slope, table = "surface.per_deflection", "surface.deflection_1"
    if values.get(slope, 0.0) != OFF[slope] and values.get(table, OFF[table]) != OFF[table]:
        return [f"{slope}: stands beside a table over the same angle, from {table} on; leave one of them out"]
    return []


def _blind(values: Mapping[str, float]) -> list[str]:
    """What is wrong with a sensor at the grip that sees nothing move, or nothing pull."""
    mass, step = "grip_sensor.mass", "grip_sensor.resolution"
    sentences, lever = [], values.get("column.grip_arm", 0.0)
    if mass in values and values[mass] != OFF[mass] and values[mass] * lever**2 >= values["column.inertia"]:
        most = value_text(TABLE[mass], values["column.inertia"] / lever**2)
        sentences.append(
            f"{mass}: expected less than the whole column has, J / R_p^2 = {most} at the grip, got "
            f"{value_text(TABLE[mass], values[mass])}; what the sensor sees move is the rest of J, and nothing would be left; give "
            "the mass of the grip alone, and column.inertia with it"
        )
    if step in values and values[step] != OFF[step] and values[step] >= values["pilot.force"]:
        force, came = (value_text(TABLE[key], values[key]) for key in ("pilot.force", step))
        sentences.append(
            f"{step}: expected less than pilot.force, which is {force}, got {came}; a sensor of such steps sees no hand, give its "
            "smallest step"
        )
    return sentences


def without_effect(values: Mapping[str, float]) -> dict[str, str]:
    """The optional rows that are given, but not what they act with; a line for each. Values are in SI units by ``part.name``."""
    off = {key for key, value in OFF.items() if values.get(key, value) == value}
    reasons: dict[str, str] = {}
    for key, others in ONLY_WITH:
        if key not in off and off.issuperset(others):
            reasons.setdefault(key, _alone(key, others))
    return reasons


def _below(low: float, high: float) -> bool:
    return high == math.inf or (low < high and not math.isclose(low, high, rel_tol=_ROUNDING))


def _not_below(low: str, high: str, values: Mapping[str, float]) -> str:
    limit, came = (value_text(TABLE[key], values[key]) for key in (high, low))
    remedy = "leave one out where there is no such stop" if "stop" in low else "set them apart"
    return f"{low}: expected less than {high}, which is {limit}, got {came}; {remedy}"


def _too_small(key: str, least: str, values: Mapping[str, float]) -> str:
    limit, came = (value_text(TABLE[name], values[name]) for name in (least, key))
    return f"{key}: expected at least {least}, which is {limit}, got {came}; leave it out where both are the same"


def _alone(key: str, others: tuple[str, ...]) -> str:
    row = TABLE[others[0]]
    too = f"give {others[0]} too, such as {value_text(row, row.default_si)!r}"
    return f"{key}: has no effect without {' or '.join(others)}; {too}, or leave {key} out"
