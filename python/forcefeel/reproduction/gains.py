"""The printed feedback coefficients, in both units."""

import numpy as np

from forcefeel.compensation import (
    GAIN_SYMBOLS,
    GAIN_UNITS,
    Compensation,
    DesignSettings,
    compensate,
    gains_in,
    published_settings,
)
from forcefeel.reproduction.appendix import printed
from forcefeel.reproduction.table import Row, Section, number
from forcefeel.units import ROTARY_STIFFNESS, UnitSystem, factor, to_text
from forcefeel.workflow import Design

_C_I_LOW = "5.445 in^3/(s mA)"
"""The smallest C_i that is printed as 5.45."""


def published(design: Design) -> tuple[Section, ...]:
    """The appendix's vector in U.S. and in SI units, from the published horizon."""
    return tuple(
        Section(
            f"Appendix: feedback coefficients, {title}",
            tuple(_rows(design, system, printed()["gains"][system.value])),
        )
        for system, title in ((UnitSystem.US, "U.S. units"), (UnitSystem.SI, "SI units"))
    )


def horizon(design: Design) -> Section:
    """What the printed vector is, and what it is not."""
    gains = {name: _us(found) for name, found in (("published", design.published), ("converged", design.converged))}
    seventh = _seventh(design)
    not_converged = (
        "recursion (22) run until the gains stand still does not give the printed vector; over a horizon of 0.05 s"
        " (500 steps of 0.1 ms from [E]_0 = [Q]) it does"
    )
    return Section(
        "Appendix: how the feedback coefficients were computed",
        (
            number("c_1, recursion converged", "eq. (22)", "-4.93", gains["converged"][0], "V/in", not_converged),
            number("c_1, horizon of 0.05 s", "eq. (22)", "-4.93", gains["published"][0], "V/in"),
            number("c_7 with -alpha R_b / I", "eq. (19)", "-0.0065", gains["published"][6], "V/lb"),
            number(
                "c_7 with G_max / I as printed", "eq. (19)", "-0.0065", seventh["printed"], "V/lb", "see eq. (19) above"
            ),
            number(
                "c_7 with R_p / I",
                "eq. (19)",
                "-0.0065",
                seventh["column"],
                "V/lb",
                "the coefficient that the column's torque at rest asks for, eq. (6)",
            ),
        ),
    )


def _rows(design: Design, system: UnitSystem, digits: list[str]) -> list[Row]:
    values = gains_in(system, design.published.gains)
    return [
        number(symbol, "appendix", text, float(value), unit.shown(system), _reason(design, symbol, system))
        for symbol, text, value, unit in zip(GAIN_SYMBOLS, digits, values, GAIN_UNITS, strict=True)
    ]


def _reason(design: Design, symbol: str, system: UnitSystem) -> str:
    if symbol == "c_6" and system is UnitSystem.SI:
        return "converted from the rounded U.S. value and cut: -0.018 V s/in are -0.007087 V s/cm"
    if symbol != "c_3":
        return ""
    loader = design.loader.replace({"valve.current_gain": _C_I_LOW})
    other = _us(compensate(loader, published_settings(loader)))[2]
    return f"within the rounding of the printed inputs: C_i = {_C_I_LOW}, printed as 5.45, gives {to_text(other)}"


def _seventh(design: Design) -> dict[str, float]:
    loader = design.loader
    # G_max is no lever arm; in U.S. units its number stands where inches are meant.
    inches = ROTARY_STIFFNESS.from_si(loader["feel.maximum_stiffness"], UnitSystem.US)
    arms = {"printed": inches * factor("in", "m"), "column": loader["column.grip_arm"]}
    return {
        name: float(_us(compensate(loader, DesignSettings(horizon_s=0.05, pilot_arm_m=arm)))[6])
        for name, arm in arms.items()
    }


def _us(found: Compensation) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return gains_in(UnitSystem.US, found.gains)
