"""What of a loader the linear models do not have, as a sentence."""

from forcefeel.loader.curves import CURVES
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC

_NAMED = 3
"""Rows that a sentence names."""


_OF_MOTOR = frozenset(
    {"motor.three_phase", "motor.viscous_friction", "transmission.stiffness", "controller.period", "controller.delay"}
)
"""Optional rows that the linear models of a motor, and its sampled loops, have."""


def left_out(loader: Loader) -> str:
    """What the linear models do not have of ``loader``, as a sentence; empty where it has nothing beyond the report's rows."""
    rows = beyond_linear(loader)
    return rows and f"The linear models neglect {rows}; forcefeel simulate includes them."


def beyond_linear(loader: Loader) -> str:
    """The optional rows and curves that ``loader`` gives, by name as far as a sentence can hold them."""
    linear = _OF_MOTOR if loader.drive == ELECTRIC else frozenset()
    keys = [
        *(key for key in loader.given if key not in linear and not key.startswith("safety.")),
        *(CURVES[name].key for name in loader.curves),
    ]
    if linear:  # what changes the feel itself before what bounds the drive
        keys.sort(key=lambda key: not key.startswith("feel."))
    named, more = keys[:_NAMED], len(keys) - _NAMED
    if more > 0:
        return f"{', '.join(named)} and {more} more of the loader's optional rows"
    return " and ".join(filter(None, (", ".join(named[:-1]), *named[-1:])))
