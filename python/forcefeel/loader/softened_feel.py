"""A programmed feel beside the one that its loader's drive renders."""

from dataclasses import dataclass

from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE, unit
from forcefeel.units import Json, UnitSystem, quantity, to_text

STIFFNESS = "feel.stiffness"


@dataclass(frozen=True, eq=False)
class SoftenedFeel:
    """What became of a programmed feel.

    Attributes:
        loader: The loader with the feel that its drive renders.
        requested_n_m_per_rad: The programmed stiffness G, N m/rad.
        reason: The limit that softened it; empty if the feel is as programmed.
    """

    loader: Loader
    requested_n_m_per_rad: float
    reason: str = ""

    def sentence(self, units: UnitSystem) -> str:
        """The rendered and the programmed stiffness, and the limit; empty if the feel is as programmed."""
        if not self.reason:
            return ""
        measured_in = unit(TABLE[STIFFNESS])
        rendered, requested = (
            to_text(measured_in.from_si(value, units), 3)
            for value in (self.loader[STIFFNESS], self.requested_n_m_per_rad)
        )
        return f"Feel softened: stiffness {rendered} of {requested} {measured_in.shown(units)}, {self.reason}."

    def as_json(self, units: UnitSystem) -> Json:
        """Both stiffnesses and the limit; ``None`` if the feel is as programmed."""
        if not self.reason:
            return None
        measured_in = unit(TABLE[STIFFNESS])
        return {
            "stiffness": quantity(self.loader[STIFFNESS], measured_in, units),
            "programmed_stiffness": quantity(self.requested_n_m_per_rad, measured_in, units),
            "reason": self.reason,
        }
