"""Drift of dry friction after commissioning: a tolerance that a minute of bench cannot show.

A record determines the friction of its day, often to 1 %. Grease and seals change with temperature, wear and rest. A law learns the
friction within its tolerance only, so the loader file keeps at least ``DRIFT``.
"""

from dataclasses import replace

from forcefeel.bench.identification.fitted_loader import normal_about
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE
from forcefeel.loader.tolerances import ENDS_AT

DRIFT = 0.2
"""Least tolerance, as a share. With an identified 0.2 to 3 %, a drift of 20 % leaves five machines 33 to 68 % of the settings, with
this 80 to 98 %. A friction that stays costs 0 to 5 % by it."""

_DRY_FRICTION = (
    "column.coulomb_friction",
    "column.static_friction",
    "motor.coulomb_friction",
    "motor.static_friction",
)


def with_drift(loader: Loader) -> tuple[Loader, tuple[str, ...]]:
    """The loader with at least ``DRIFT`` as tolerance of each dry friction, and the rows that this widens."""
    narrow = [key for key in _DRY_FRICTION if key in loader.tolerances and loader[key] and _reach(loader, key) < DRIFT]
    if not narrow:
        return loader, ()
    symbols = ", ".join(TABLE[key].symbol for key in narrow)
    source = f"{loader.source}; tolerance of {symbols} widened to {DRIFT:.0%} for drift with temperature and wear"
    widened = {key: normal_about(key, loader[key], DRIFT / ENDS_AT * loader[key]) for key in narrow}
    return replace(loader.with_tolerances(widened), source=source.lstrip("; ")), tuple(narrow)


def drift_sentence(keys: tuple[str, ...]) -> tuple[str, ...]:
    """The reason, if any row is widened."""
    if not keys:
        return ()
    named = f"{', '.join(keys[:-1])} and {keys[-1]}" if keys[1:] else keys[0]
    return (
        f"The loader file has a tolerance of {DRIFT:.0%} for {named}: the record determines today's friction, which drifts with "
        "temperature and wear, and the law learns it within this tolerance.",
    )


def _reach(loader: Loader, key: str) -> float:
    """Largest deviation at the ends of a tolerance, as a share of the value."""
    return max(abs(end / loader[key] - 1) for end in loader.tolerances[key].ends)
