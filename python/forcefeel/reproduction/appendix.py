"""The appendix's constants: comparison of the two columns, and origin of the values."""

import tomllib
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from forcefeel import _core
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE
from forcefeel.reproduction.table import Reason, Row, Section, cut, number
from forcefeel.units import factor, parse

_ROUNDED_FACTORS = {
    "actuator.area": ("6.45 cm^2 to the in^2", 6.45),
    "feel.stiffness": ("11.2985 N cm to the lb in", 11.2985),
    "linkage.damping": ("1.7512 N/cm to the lb/in", 1.7512),
    "linkage.stiffness": ("1.751 N/cm to the lb/in", 1.751),
    "valve.supply_pressure": ("0.6894 N/cm^2 to the lb/in^2", 0.6894),
    "actuator.bulk_modulus": ("0.6894 N/cm^2 to the lb/in^2", 0.6894),
}
"""Factors with which the SI column was converted, found by dividing it by the U.S. column."""


@cache
def printed() -> dict[str, Any]:
    """The printed numbers."""
    text = resources.files("forcefeel").joinpath("data/report_1974.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def columns() -> Section:
    """Comparison of each SI value with its converted U.S. value."""
    rows = []
    for key, entry in printed()["appendix"].items():
        converted = float(entry["us"]) * factor(entry["us_unit"], entry["si_unit"])
        reason = None
        if key in _ROUNDED_FACTORS:
            words, rounded = _ROUNDED_FACTORS[key]
            text = f"rounded factor, {words}"
            reason = Reason(text, float(entry["us"]) * rounded)
        rows.append(number(TABLE[key].symbol, "appendix", entry["si"], converted, entry["si_unit"], reason))
    return Section("SI column, converted from the U.S. column", tuple(rows))


def origins(loader: Loader) -> Section:
    """Values that follow from others."""
    values = loader.si_values
    c_i, c_p = _core.valve_gains(values, 0.2, 0.33)
    k, c = _core.linkage_from_resonance(values, parse("12 Hz", "rad/s", "12 Hz"), 0.1)
    k_pi, _ = _core.linkage_from_resonance(values, 2 * 3.14159 * 12, 0.1)
    text = "computed with pi = 3.14159"
    frequency, damping_ratio = _core.feel_frequency(values)
    share = loader["feel.maximum_stiffness"] / loader["feel.stiffness"]
    return Section(
        "Origin of the values",
        (
            _us("C_i from eq. (1)", "eqs. (1), (2)", "valve.current_gain", c_i, _truncated(c_i)),
            _us("C_p from eq. (1)", "eqs. (1), (2)", "valve.pressure_gain", c_p),
            _us(
                "k from 12 Hz",
                "page of fig. 8",
                "linkage.stiffness",
                k,
                Reason(text, _us_value("linkage.stiffness", k_pi)),
            ),
            _us("c from 12 Hz and damping ratio 0.1", "page of fig. 8", "linkage.damping", c),
            number(
                "valve natural frequency, 60 Hz", "page of eq. (3)", "377", parse("60 Hz", "rad/s", "1 Hz"), "rad/s"
            ),
            number("natural frequency of I, B, G", "appendix", "2.0", frequency / (2 * np.pi), "Hz"),
            number("damping ratio of I, B, G", "appendix", "0.2", damping_ratio, ""),
            number("G_max / G", "appendix", "3", share, ""),
        ),
    )


def _us(item: str, where: str, key: str, value_si: float, reason: Reason | None = None) -> Row:
    """A row in U.S. units against the appendix's value of ``key``."""
    entry = printed()["appendix"][key]
    return number(item, where, entry["us"], _us_value(key, value_si), entry["us_unit"], reason)


def _us_value(key: str, value_si: float) -> float:
    return value_si * factor(TABLE[key].unit_si, TABLE[key].unit_us)


def _truncated(c_i: float) -> Reason:
    return Reason("cut after two decimals instead of rounded", cut(_us_value("valve.current_gain", c_i), 2))
