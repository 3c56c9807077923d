"""One tolerance of a rule: a share, a fixed amount, or the larger of the two."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from forcefeel.units import UnitSystem, factor, to_text

STRICT = ConfigDict(extra="forbid", frozen=True)

_ROUNDED = 0.03
"""Largest relative difference between the rule's daN and lb, both rounded by the rule."""

_FORCES = frozenset({"breakout", "force", "dynamic increment"})
_TIMES = frozenset({"P0", "Pn", "fall time", "rise time"})
_DISPLACEMENTS = frozenset({"A1", "An", "Ad", "steady state"})
_UNITS = {
    **dict.fromkeys(_FORCES, ("lb", "dan")),
    **dict.fromkeys(_TIMES, ("s",)),
    **dict.fromkeys(_DISPLACEMENTS, ("travel",)),
    "surface": ("deg",),
    "freeplay": ("in",),
    "overshoots": ("count",),
    "body rate": ("deg_per_s",),
    "trim rate": ("deg_per_s",),
}

Quantity = Literal[
    "P0",
    "Pn",
    "A1",
    "An",
    "Ad",
    "first overshoot",
    "overshoots",
    "steady state",
    "fall time",
    "rise time",
    "breakout",
    "force",
    "surface",
    "freeplay",
    "dynamic increment",
    "body rate",
    "trim rate",
]


class Absolute(BaseModel):
    """A fixed amount in the units of the rule: a force in lb and daN, or another quantity.

    Attributes:
        lb, dan: Force in lb and in daN, each as the rule rounds it; ``dan`` is omitted where only lb is stated.
        s, deg, deg_per_s, count: Time, angle, rate of an angle, number.
        inch: Length in inches, ``in`` in the table.
        travel: Share of the control's total travel.
    """

    model_config = STRICT

    lb: float | None = Field(None, gt=0)
    dan: float | None = Field(None, gt=0)
    s: float | None = Field(None, gt=0)
    deg: float | None = Field(None, gt=0)
    deg_per_s: float | None = Field(None, gt=0)
    count: int | None = Field(None, gt=0)
    inch: float | None = Field(None, gt=0, alias="in")
    travel: float | None = Field(None, gt=0, lt=1)

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the stated amounts, by their names in the table."""
        return tuple(self.model_dump(by_alias=True, exclude_none=True))

    def si(self, system: UnitSystem, travel: float | None) -> float | None:
        """The amount in SI units; ``None`` for a share of an unknown travel.

        Args:
            system: Unit system that selects the rule's rounding of forces.
            travel: The control's total travel, m or rad.
        """
        if self.travel is not None:
            return None if travel is None else self.travel * travel
        if self.lb is not None:
            metric = system is UnitSystem.SI and self.dan is not None
            return 10.0 * (self.dan or 0.0) if metric else self.lb * factor("lb", "N")
        for amount, scale in (
            (self.s, 1.0),
            (self.count, 1.0),
            (self.deg, factor("deg", "rad")),
            (self.deg_per_s, factor("deg", "rad")),
            (self.inch, factor("in", "m")),
        ):
            if amount is not None:
                return amount * scale
        return None

    def text(self, system: UnitSystem) -> str:
        """The amount in the wording of the rule."""
        if self.lb is not None:
            metric = system is UnitSystem.SI and self.dan is not None
            return f"{self.dan:g} daN" if metric else f"{self.lb:g} lb"
        if self.travel is not None:
            return f"{to_text(100 * self.travel)} % of the total travel"
        words = {"s": "s", "deg": "deg", "deg_per_s": "deg/s", "in": "in", "count": ""}
        return " ".join(f"{self.model_dump(by_alias=True)[unit]:g} {words[unit]}".strip() for unit in self.units)


class Tolerance(BaseModel):
    """Allowed difference from the reference: the larger of a share and a fixed amount if both are stated.

    Attributes:
        quantity: The compared quantity.
        relative: Share of ``relative_to``, of the reference: the quantity itself, the first overshoot ``A1``, the largest
            ``Amax``, the displacement ``Ad``, or the largest value of a curve, ``peak``.
        grows: ``n + 1``: the share of period n is n + 1 times that of n = 0.
        absolute: The fixed amount.
        required: The quantity must exist; its value is not compared.
        surface: The surface, where a surface's position is compared.
        instead_of: Another quantity of the same test that it can replace.
        verified: Whether it is verified against the document; ``None`` as its test.

    Raises:
        ValidationError: If it states no tolerance, a share without its base, a unit of another quantity, or lb and daN of
            different forces.
    """

    model_config = STRICT

    quantity: Quantity
    relative: float | None = Field(None, gt=0, lt=1)
    relative_to: Literal["itself", "A1", "Amax", "Ad", "peak"] | None = None
    grows: Literal["n + 1"] | None = None
    absolute: Absolute | None = None
    required: bool = False
    surface: str | None = None
    instead_of: Quantity | None = None
    verified: bool | None = None

    @model_validator(mode="after")
    def _laws(self) -> "Tolerance":
        stated = self.relative is not None or self.absolute is not None
        _law(stated is not self.required, "a tolerance states a share or an amount, or that the quantity is required")
        _law((self.relative is None) is (self.relative_to is None), "relative and relative_to go together")
        _law(self.grows is None or self.quantity == "Pn", "only the periods' tolerance grows")
        _law((self.surface is None) is (self.quantity != "surface"), "a surface is named where one is compared")
        if self.absolute is not None:
            units = self.absolute.units
            allowed = _UNITS.get(self.quantity, ())
            _law(set(units) <= set(allowed) and units[:1] == allowed[:1], f"{self.quantity} is stated in {allowed}")
            lb, dan = self.absolute.lb, self.absolute.dan
            same = lb is None or dan is None or abs(10 * dan / (lb * factor("lb", "N")) - 1) < _ROUNDED
            _law(same, "lb and dan are the same force but for rounding")
        return self

    def limit(
        self, scale: ArrayLike, *, n: int = 0, system: UnitSystem = UnitSystem.US, travel: float | None = None
    ) -> NDArray[np.float64]:
        """The largest difference that passes, in SI units.

        Args:
            scale: Base of the share, from the reference, any shape.
            n: Number of the period, from 0.
            system: Unit system that selects the rule's rounding of forces.
            travel: The control's total travel, m or rad; without it an amount that is a share of it is omitted, which
                is stricter.

        Returns:
            Shape as ``scale``; infinite where the quantity is not compared.
        """
        size = np.abs(np.asarray(scale, dtype=np.float64))
        fixed = None if self.absolute is None else self.absolute.si(system, travel)
        if self.relative is None:
            return np.full_like(size, np.inf if fixed is None else fixed)
        share = self.relative * (n + 1 if self.grows else 1) * size
        return share if fixed is None else np.maximum(share, fixed)

    def text(self, system: UnitSystem = UnitSystem.US) -> str:
        """The tolerance in words, such as ``10 % or 5 lb, whichever is larger``."""
        if self.required:
            return "required"
        parts = []
        if self.relative is not None:
            of = {"itself": "", "peak": " of the peak"}.get(self.relative_to or "", f" of {self.relative_to}")
            grows = f" ({self.grows})" if self.grows else ""
            parts.append(f"{to_text(100 * self.relative)}{grows} %{of}")
        if self.absolute is not None:
            parts.append(self.absolute.text(system))
        return " or ".join(parts) + (", whichever is larger" if len(parts) > 1 else "")


def _law(holds: bool, sentence: str) -> None:
    if not holds:
        raise ValueError(sentence)
