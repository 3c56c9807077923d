"""Drift of dry friction after commissioning: a tolerance that a minute of bench cannot show.

A record determines the friction of its day, often to 1 %. Grease and seals change with temperature, wear and rest. A law learns the
friction within its tolerance only, so the loader file keeps at least ``DRIFT``.
"""

from dataclasses import replace

from forcefeel.bench.identification.fitted_loader import normal_about
from forcefeel.commission.observability import BREAKAWAY, DRY, STRIBECK
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE
from forcefeel.loader.tolerances import ENDS_AT

DRIFT = 0.2
"""Least tolerance, as a share. With an identified 0.2 to 3 %, a drift of 20 % leaves five machines 33 to 68 % of the settings, with
this 80 to 98 %. A friction that stays costs 0 to 5 % by it."""

_SLOW = 0.6
"""Least tolerance of the Stribeck velocity. On three machines of an independent integrator it was off by up to 31 %, the breakaway
by up to 11 %, six to eight of their standard errors. The cause is noise and steps of the piston's sensor: in the closed loop they
shake the column, which the fit runs without. One machine, 6 s: 20 % and 6 % off with them, 1.5 % and 0.3 % without."""

_LEAST = {
    DRY: DRIFT,
    BREAKAWAY: DRIFT,
    STRIBECK: _SLOW,
    "motor.coulomb_friction": DRIFT,
    "motor.static_friction": DRIFT,
}


def with_drift(loader: Loader) -> tuple[Loader, tuple[str, ...]]:
    """The loader with at least ``DRIFT`` as tolerance of each dry friction, and the rows that this widens."""
    stated = [key for key in _LEAST if key in loader.tolerances and loader[key]]
    narrow = [key for key in stated if _reach(loader, key) < _LEAST[key]]
    if not narrow:
        return loader, ()
    symbols = ", ".join(TABLE[key].symbol for key in narrow)
    source = f"{loader.source}; tolerance of {symbols} widened to {100 * DRIFT:.0f} % or more for drift with temperature and wear"
    widened = {key: normal_about(key, loader[key], _LEAST[key] / ENDS_AT * loader[key]) for key in narrow}
    return replace(loader.with_tolerances(widened), source=source.lstrip("; ")), tuple(narrow)


def drift_sentence(keys: tuple[str, ...]) -> tuple[str, ...]:
    """The reason, if any row is widened."""
    if not keys:
        return ()
    named = f"{', '.join(keys[:-1])} and {keys[-1]}" if keys[1:] else keys[0]
    return (
        f"The loader file has a tolerance of {100 * DRIFT:.0f} % or more for {named}: the record determines today's friction, "
        "which drifts with temperature and wear. The law learns it within this tolerance.",
    )


def _reach(loader: Loader, key: str) -> float:
    """Largest deviation at the ends of a tolerance, as a share of the value."""
    return max(abs(end / loader[key] - 1) for end in loader.tolerances[key].ends)
