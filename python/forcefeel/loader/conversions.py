"""Rows of the parameter table from what a loader file or a data sheet states in their stead.

=============  ===========================================  ==================  =======================================
part           stated                                       row                 equation
=============  ===========================================  ==================  =======================================
valve          ``operating_current``, ``..._pressure``      ``C_i``, ``C_p``    eqs. (1), (2)
linkage        ``resonance_frequency``, damping ratio       ``k``, ``c``        eqs. (6), (9)
feel           ``natural_frequency``, ``damping_ratio``     ``I``, ``B``        eq. (11)
motor          ``torque_constant_peak``, ``_rms``           ``K_t``             ``K``, ``K / sqrt 2``
motor          ``voltage_constant``, ``_peak``, ``_rms``    ``K_t``             ``K_e``, ``sqrt 3 / 2 K_e``, ``sqrt 1.5 K_e``
motor          ``speed_constant``, ``_peak``, ``_rms``      ``K_t``             the same with ``K_e = 1 / K_v``
winding        ``..._line_to_line``, ``..._phase``          ``R``, ``L``        a half; itself
current loop   ``current_limit_``, ``continuous_...``       ``i_max``, ``i_c``  peak: itself; r.m.s.: times ``sqrt 2``
current loop   ``supply_voltage``                           ``u_max``           ``U``; of three phases ``U / sqrt 3``
transmission   ``lead``, ``radius``, with ``gear_ratio``    ``r``               ``lead / (2 pi N)``, ``r_o / N``
transmission   ``backlash_angle``                           ``b_t``             ``N r b_g``
=============  ===========================================  ==================  =======================================

``K_t`` and current are per peak ampere of a phase of three, or of a brushed motor. Power in equals power out: ``T omega = e i`` of
two terminals, and ``T omega = 3/2 e i`` of three phases with the peaks ``e`` and ``i`` of a phase; between two of them the peak is
``sqrt 3 e``. Block commutation drives two of three phases at a time, as a brushed motor's winding. Space vector modulation reaches
the phase voltage ``U / sqrt 3``.

Sources: D. C. Hanselman, Brushless Permanent Magnet Motor Design; vendors' definitions, such as ``K_t = 60 sqrt 3 U_i / (2 pi n)``
of r.m.s. values, Kollmorgen AKD, ``MOTOR.KT``.
"""

from collections.abc import Callable, Mapping
from math import sqrt, tau
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.loader.parameters import INDEX, TABLE, absent

_Values = Mapping[str, float]


class Conversion(NamedTuple):
    """What may be stated in the stead of rows.

    Attributes:
        part: The table of the loader file.
        stated: The keys, all together.
        rows: The rows of that part that follow.
        formula: Their SI values from those of all rows by ``part.name``, and from those of the keys of the part.
    """

    part: str
    stated: tuple[str, ...]
    rows: tuple[str, ...]
    formula: Callable[[_Values, _Values], tuple[float, ...]]


def _factor(part: str, stated: str, row: str, factor: float = 1.0) -> Conversion:
    return Conversion(part, (stated,), (row,), lambda _, given: (factor * given[stated],))


def _quotient(part: str, stated: str, row: str, over: float) -> Conversion:
    return Conversion(part, (stated,), (row,), lambda _, given: (over / given[stated],))


def _winding(end: str, share: float) -> Conversion:
    keys = (f"resistance_{end}", f"inductance_{end}")
    return Conversion(
        "winding", keys, ("resistance", "inductance"), lambda _, given: tuple(share * given[k] for k in keys)
    )


def _travel(stated: str, per: float, *gear: str) -> Conversion:
    return Conversion(
        "transmission",
        (stated, *gear),
        ("travel",),
        lambda _, given: (given[stated] / per / given.get("gear_ratio", 1.0),),
    )


def _array(values: _Values) -> NDArray[np.float64]:
    """Values in the table's order; the model's formulas read only rows that are given."""
    return np.array([values.get(key, absent(row)) for key, row in TABLE.items()])


CONVERSIONS = (
    Conversion(
        "valve",
        ("operating_current", "operating_pressure"),
        ("current_gain", "pressure_gain"),
        lambda v, given: _core.valve_gains(_array(v), given["operating_current"], given["operating_pressure"]),
    ),
    Conversion(
        "linkage",
        ("resonance_frequency", "resonance_damping_ratio"),
        ("stiffness", "damping"),
        lambda v, given: _core.linkage_from_resonance(
            _array(v), given["resonance_frequency"], given["resonance_damping_ratio"]
        ),
    ),
    Conversion(
        "feel",
        ("natural_frequency", "damping_ratio"),
        ("inertia", "damping"),
        lambda v, given: _core.feel_from_frequency(
            given["natural_frequency"], given["damping_ratio"], _array(v)[INDEX["feel.stiffness"]]
        ),
    ),
    _factor("motor", "torque_constant_peak", "torque_constant"),
    _factor("motor", "torque_constant_rms", "torque_constant", 1 / sqrt(2)),
    _quotient("motor", "speed_constant", "torque_constant", 1.0),
    _quotient("motor", "speed_constant_peak", "torque_constant", sqrt(3) / 2),
    _quotient("motor", "speed_constant_rms", "torque_constant", sqrt(1.5)),
    _factor("motor", "voltage_constant", "torque_constant"),
    _factor("motor", "voltage_constant_peak", "torque_constant", sqrt(3) / 2),
    _factor("motor", "voltage_constant_rms", "torque_constant", sqrt(1.5)),
    _winding("line_to_line", 0.5),
    _winding("phase", 1.0),
    *(_factor("current_loop", f"{row}_peak", row) for row in ("current_limit", "continuous_current")),
    *(_factor("current_loop", f"{row}_rms", row, sqrt(2)) for row in ("current_limit", "continuous_current")),
    Conversion(
        "current_loop",
        ("supply_voltage",),
        ("voltage_limit",),
        lambda v, given: (given["supply_voltage"] / (sqrt(3) if v["motor.three_phase"] else 1.0),),
    ),
    _travel("lead", tau),
    _travel("lead", tau, "gear_ratio"),
    _travel("radius", 1.0),
    _travel("radius", 1.0, "gear_ratio"),
    Conversion(
        "transmission",
        ("backlash_angle",),
        ("backlash",),
        lambda v, given: (given["backlash_angle"] * v["transmission.travel"] * given.get("gear_ratio", 1.0),),
    ),
)
"""In the order in which they are worked out: a later one may read a row of an earlier one."""


def groups(part: str) -> dict[tuple[str, ...], list[Conversion]]:
    """The conversions of a part by the rows that follow."""
    own = [conversion for conversion in CONVERSIONS if conversion.part == part]
    return {rows: [it for it in own if it.rows == rows] for rows in dict.fromkeys(it.rows for it in own)}
