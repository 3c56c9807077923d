"""The numbers of an analog law: gains for all settings, or gains for each."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import GainLaw
from forcefeel.linear.models import state_feedback
from forcefeel.loader.loader import Loader


@dataclass(frozen=True)
class FixedGains:
    """Gains for all settings, with their own scale of the load cell; without any, the original loop, eq. (13)."""

    law: GainLaw | None = None
    settings: ClassVar[int] = 1
    by_machine: ClassVar[bool] = False
    digital: ClassVar[None] = None

    @property
    def kind(self) -> str:
        """Name in a law's file."""
        return "original" if self.law is None else "compensator"

    @property
    def displacement_unit(self) -> str:
        """Unit of the feel computer's displacement delta: ``rad``, or ``V`` in a loop as the report's."""
        return "V" if self.law is None else self.law.displacement_unit

    def engine(self) -> dict[str, Any]:
        """Keywords of the engine."""
        return {"law": self.law}

    def as_json(self) -> dict[str, Any]:
        """The numbers in SI units; none of the original loop."""
        names = ("gains", "load_cell_arm", "displacement_unit")
        return {} if self.law is None else dict(zip(names, self.law.__getnewargs__(), strict=True))

    def some(self, _: object) -> "FixedGains":
        """The same numbers."""
        return self

    def gain_law(self, loader: Loader, _: int = 0) -> GainLaw:
        """The gains; of the original loop those of the loader."""
        return self.law or GainLaw.original(loader.si_values)


@dataclass(frozen=True, eq=False)
class SettingGains:
    """Gains c_1 .. c_7 for each setting or run, (settings, 7), with the load cell's scale of each machine."""

    gains: NDArray[np.float64]
    kind: ClassVar[str] = "state feedback"
    displacement_unit: ClassVar[str] = "rad"
    by_machine: ClassVar[bool] = True
    digital: ClassVar[None] = None

    @property
    def settings(self) -> int:
        """How many settings it has gains for."""
        return len(self.gains)

    def engine(self) -> dict[str, Any]:
        """Keywords of the engine."""
        return {"gains": np.ascontiguousarray(self.gains, dtype=np.float64)}

    def as_json(self) -> dict[str, Any]:
        """The numbers in SI units."""
        return {"gains": self.gains.tolist()}

    def some(self, which: slice | Sequence[int] | NDArray[np.intp]) -> "SettingGains":
        """The gains of some settings."""
        return SettingGains(self.gains[which])

    def gain_law(self, loader: Loader, setting: int = 0) -> GainLaw:
        """The gains of a setting with the load cell's scale of the loader."""
        return state_feedback(loader, self.gains[setting])


def analog(law: GainLaw | NDArray[np.float64] | None) -> FixedGains | SettingGains:
    """One law for all, gains c_1 .. c_7 (settings, 7), or without either the original loop."""
    return SettingGains(law) if isinstance(law, np.ndarray) else FixedGains(law)
