"""How symbols, units and numbers are set: as HTML in the page, as spans in the drawing, as plain text in the plots."""

import math
import re

from markupsafe import Markup, escape

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import Unit, UnitSystem, to_text

_GREEK = {
    "alpha": "α",
    "beta": "β",
    "delta": "δ",
    "theta": "θ",
    "zeta": "ζ",
    "omega": "ω",
    "phi": "φ",
    "sigma": "σ",
    "tau": "τ",
    "dtheta": "Δθ",
    "w": "ω",
}
_RAISED = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
NONE = "–"
"""Stands where there is no number."""

_MINUS = "\N{MINUS SIGN}"
_MIDDLE_DOT = "\N{MIDDLE DOT}"

_SYMBOL_IN_PROSE = re.compile(r"(?<![\w.])(?:[A-Za-z]_(?:\d|max|[A-Za-z])|[GIBJ])(?!\w|\.\w)")
_PARAMETER_IN_PROSE = re.compile("|".join(re.escape(key) for key in sorted(TABLE, key=len, reverse=True)))
_MINUS_IN_PROSE = re.compile(r" -(?!-)")
_PRODUCT_IN_PROSE = re.compile(r"\b(?:lb|N|V|mA) (?:in|m|cm|s)\b(?: s\b)?")
_POWER_IN_PROSE = re.compile(r"(?<=[a-z])\^(\d)")


def unit_text(written: str) -> str:
    """``lb in s^2`` as ``lb·in·s²``."""
    raised = re.sub(r"\^(-?\d+)", lambda match: match[1].translate(_RAISED), written)
    return raised.replace(" ", _MIDDLE_DOT)


def number_text(value: float, digits: int = 4) -> str:
    """A number with a true minus sign and at most ``digits`` significant digits; a power of ten set as one."""
    text = to_text(value, digits).replace("-", _MINUS)
    mantissa, _, power = text.partition("e")
    if not math.isfinite(value) or not power:
        return text
    return f"{mantissa}×10{power.replace(_MINUS, '-').translate(_RAISED)}"


def percent_text(share: float, *, signed: bool = False) -> str:
    """A share as percent, with as many decimals as a column of them needs; a dash where it is undefined."""
    percent = 100 * share
    if not math.isfinite(percent):
        return NONE
    if abs(percent) >= 1e5:
        return f"{number_text(percent, 3)} %"
    decimals = 0 if abs(percent) >= 1000 else 1 if abs(percent) >= 1 else 2
    sign = "+" if signed and percent > 0 else ""
    return f"{sign}{percent:.{decimals}f} %".replace("-", _MINUS)


def change_text(share: float) -> str:
    """A deviation that someone chose, such as +5 %, without decimals that it does not have."""
    return f"{'+' if share > 0 else ''}{number_text(100 * share)} %"


def value_text(value: float, measured_in: Unit, system: UnitSystem) -> str:
    """A SI value without its unit, to three digits, for a row or a column that names the unit; a dash where undefined."""
    return number_text(measured_in.from_si(value, system), 3) if math.isfinite(value) else NONE


def heading_text(name: str, measured_in: Unit, system: UnitSystem) -> str:
    """A heading with the unit that the numbers below it are in."""
    shown = unit_text(measured_in.shown(system))
    return f"{name}, {shown}" if shown else name


def quantity_text(value: float, measured_in: Unit, system: UnitSystem, digits: int = 4) -> str:
    """A SI value with its unit, as people read it under ``system``; infinite and undefined values have no unit."""
    number = number_text(measured_in.from_si(value, system), digits)
    shown = unit_text(measured_in.shown(system)) if math.isfinite(value) else ""
    return f"{number} {shown}".rstrip()


def parameter_text(loader: Loader, key: str, system: UnitSystem) -> str:
    """A loader's number with its unit."""
    return quantity_text(loader[key], unit(TABLE[key]), system)


def split_symbol(symbol: str) -> tuple[str, str, str]:
    """``w_n`` as (``ω``, ``n``, no dashes); ``x_b'`` and ``x'_b`` as (``x``, ``b``, one dash); what it is over after the dashes."""
    bare = symbol.replace("'", "")
    base, _, index = bare.partition("_")
    index, over, rest = index.partition(" / ")
    after = (over + rest).replace(" pi", "π")
    return _GREEK.get(base, base), index, "′" * (len(symbol) - len(bare)) + after


def symbol_html(symbol: str) -> Markup:
    """A symbol of the report in HTML, index below the line."""
    base, index, dashes = split_symbol(symbol)
    lowered = Markup("<sub>{}</sub>").format(index) if index else Markup("")
    return Markup('<i class="symbol">{}</i>{}{}').format(base, lowered, dashes)


def symbol_svg(symbol: str) -> Markup:
    """A symbol in the drawing; what follows in the line is raised back to its height."""
    base, index, dashes = split_symbol(symbol)
    slanted = Markup('<tspan class="symbol">{}</tspan>').format(base)
    if not index:
        return slanted + Markup("{}").format(dashes)
    lowered = Markup('<tspan class="index" dy="4">{}</tspan>').format(index)
    return slanted + lowered + Markup('<tspan dy="-4">{}</tspan>').format(dashes or "\N{ZERO WIDTH SPACE}")


def prose_html(text: str) -> Markup:
    """A plain sentence in HTML: symbols with their index, products of units with a dot, parameters by name and symbol.

    Example:
        >>> from forcefeel.page.typography import prose_html
        >>> print(prose_html("at -2 deg, or name it with --fit"))
        at −2 deg, or name it with --fit
    """
    html = str(escape(text)).replace("&#39;", "\N{RIGHT SINGLE QUOTATION MARK}").replace(" %", "\N{NO-BREAK SPACE}%")
    html = _MINUS_IN_PROSE.sub(f" {_MINUS}", html)
    html = _PRODUCT_IN_PROSE.sub(lambda match: match[0].replace(" ", _MIDDLE_DOT), html)
    html = _POWER_IN_PROSE.sub(lambda match: match[1].translate(_RAISED), html)
    html = _SYMBOL_IN_PROSE.sub(lambda match: str(symbol_html(match[0])), html)
    return Markup(_PARAMETER_IN_PROSE.sub(lambda match: parameter_name(match[0]), html))


def parameter_name(key: str) -> Markup:
    """``linkage.ratio`` as its words and its symbol."""
    return Markup("{} ").format(key.replace(".", " ").replace("_", " ")) + symbol_html(TABLE[key].symbol)
