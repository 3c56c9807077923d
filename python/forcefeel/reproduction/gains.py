"""The printed feedback coefficients, in both units."""

import numpy as np

from forcefeel.design.workflow import Design
from forcefeel.laws.analog.recursion import GAIN_SYMBOLS, GAIN_UNITS, DesignSettings, GainDesign, design_gains, gains_in
from forcefeel.reproduction.appendix import printed
from forcefeel.reproduction.table import Reason, Row, Section, cut, number
from forcefeel.units import ROTARY_STIFFNESS, UnitSystem, factor, to_text

_C_I_LOW = "5.445 in^3/(s mA)"
"""The smallest C_i that is printed as 5.45."""

_C_I_UNCUT = "5.457 in^3/(s mA)"
"""C_i of eqs. (1), (2) before it was cut to 5.45."""


def published(design: Design) -> tuple[Section, ...]:
    """The appendix's vector in U.S. and in SI units, from the published horizon."""
    return tuple(
        Section(
            f"Feedback coefficients, {title}",
            tuple(_rows(design, system, printed()["gains"][system.value])),
        )
        for system, title in ((UnitSystem.US, "U.S. units"), (UnitSystem.SI, "SI units"))
    )


def horizon(design: Design) -> Section:
    """The horizon with which the printed vector was computed."""
    gains = {
        name: _us(gain_design)
        for name, gain_design in (("published", design.published), ("converged", design.converged))
    }
    seventh = _seventh(design)
    c_1, c_7 = float(gains["published"][0]), float(gains["published"][6])
    not_converged = Reason(
        "recursion (22) gives the printed vector over 0.05 s (500 steps of 0.1 ms from [E]_0 = [Q]), not when it has"
        " converged",
        c_1,
    )
    coupling = Reason("the report computed it with -alpha R_b / I", c_7)
    return Section(
        "Computation of the feedback coefficients",
        (
            number("c_1, recursion converged", "eq. (22)", "-4.93", gains["converged"][0], "V/in", not_converged),
            number("c_1, horizon of 0.05 s", "eq. (22)", "-4.93", gains["published"][0], "V/in"),
            number("c_7 with -alpha R_b / I", "eq. (19)", "-0.0065", gains["published"][6], "V/lb"),
            number("c_7 with G_max / I as printed", "eq. (19)", "-0.0065", seventh["printed"], "V/lb", coupling),
            number("c_7 with R_p / I", "eq. (19)", "-0.0065", seventh["column"], "V/lb", coupling),
        ),
    )


def _rows(design: Design, system: UnitSystem, digits: list[str]) -> list[Row]:
    values = gains_in(system, design.published.gains)
    return [
        number(symbol, "appendix", text, float(value), unit.shown(system), _reason(design, symbol, system))
        for symbol, text, value, unit in zip(GAIN_SYMBOLS, digits, values, GAIN_UNITS, strict=True)
    ]


def _reason(design: Design, symbol: str, system: UnitSystem) -> Reason | None:
    if symbol == "c_6" and system is UnitSystem.SI:
        return Reason(
            "converted from the rounded U.S. value, -0.018 V s/in, and cut", cut(-0.018 * factor("V s/in", "V s/cm"), 5)
        )
    if symbol != "c_3":
        return None
    low, high = (_c_3(design, c_i) for c_i in (_C_I_LOW, _C_I_UNCUT))
    text = (
        f"within the rounding of C_i: {_C_I_LOW}, printed as 5.45, gives {to_text(low)}; the uncut {_C_I_UNCUT} gives"
        f" {to_text(high)}"
    )
    return Reason(text, low)


def _c_3(design: Design, current_gain: str) -> float:
    loader = design.loader.replace({"valve.current_gain": current_gain}, si=True)
    return float(_us(design_gains(loader))[2])


def _seventh(design: Design) -> dict[str, float]:
    loader = design.loader
    # G_max is no lever arm; in U.S. units its number stands where inches are meant.
    inches = ROTARY_STIFFNESS.from_si(loader["feel.maximum_stiffness"], UnitSystem.US)
    arms = {"printed": inches * factor("in", "m"), "column": loader["column.grip_arm"]}
    return {
        name: float(_us(design_gains(loader, DesignSettings(horizon_s=0.05, pilot_arm_m=arm)))[6])
        for name, arm in arms.items()
    }


def _us(gain_design: GainDesign) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return gains_in(UnitSystem.US, gain_design.gains)
