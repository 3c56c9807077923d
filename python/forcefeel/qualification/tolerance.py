"""One tolerance of a rule: a share of something, a fixed amount, or whichever of the two is larger."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from forcefeel.units import UnitSystem, factor, to_text

STRICT = ConfigDict(extra="forbid", frozen=True)

_ROUNDED = 0.03
"""Most that the rule's daN differ from its lb, as a share: both are its own roundings."""

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
    """A fixed amount, in the units of the rule: a force in lb and daN, or one of the others.

    Attributes:
        lb, dan: Force in lb and in daN, each as the rule rounds it; ``dan`` is left out where only lb was read.
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
        """Which of them it states, by the names in the table."""
        return tuple(self.model_dump(by_alias=True, exclude_none=True))

    def si(self, system: UnitSystem, travel: float | None) -> float | None:
        """The amount in SI units; ``None`` where it is a share of a travel that is not given.

        Args:
            system: Which of the rule's two roundings of a force holds.
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
        """The amount as the rule words it."""
        if self.lb is not None:
            metric = system is UnitSystem.SI and self.dan is not None
            return f"{self.dan:g} daN" if metric else f"{self.lb:g} lb"
        if self.travel is not None:
            return f"{to_text(100 * self.travel)} % of the total travel"
        words = {"s": "s", "deg": "deg", "deg_per_s": "deg/s", "in": "in", "count": ""}
        return " ".join(f"{self.model_dump(by_alias=True)[unit]:g} {words[unit]}".strip() for unit in self.units)


class Tolerance(BaseModel):
    """How far a quantity may be from the reference's: the larger of a share and a fixed amount, where both are stated.

    Attributes:
        quantity: What is compared.
        relative: Share of ``relative_to``, of the reference: the quantity itself, the first overshoot ``A1``, the largest
            ``Amax``, the displacement ``Ad``, or the largest value of a curve, ``peak``.
        grows: ``n + 1``: the share holds for n = 0 and is n + 1 times as large for the n-th.
        absolute: The fixed amount.
        required: The quantity must be there; nothing is compared.
        surface: Which surface, where a surface's position is compared.
        instead_of: Another quantity of the same test in whose stead it can be asked for.
        verified: Whether a person has held it against the document; ``None`` is what its test says.

    Raises:
        ValidationError: When it breaks a law: nothing stated, a share of nothing, a unit that does not measure the
            quantity, lb and daN that are not the same force.
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
            scale: What the share is of, from the reference, any shape.
            n: Which period; counted from 0.
            system: Which of the rule's roundings of a force holds.
            travel: The control's total travel, m or rad; without it an amount that is a share of it is left out, which
                is the stricter reading.

        Returns:
            Shape as ``scale``; infinite where nothing is compared.
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
            return "must be there"
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
