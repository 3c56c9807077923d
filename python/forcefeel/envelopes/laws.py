"""The compensators that an envelope compares: the law that each programmed setting gets.

Gains are designed for the nominal plant and each setting of the feel; a perturbed plant meets the gains of the nominal one.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import Compensator
from forcefeel.compensation import GAIN_SYMBOLS, NAMED_DESIGNS, DesignSettings
from forcefeel.errors import InputError
from forcefeel.loader import Loader
from forcefeel.models import state_feedback
from forcefeel.schedule import schedule_gains
from forcefeel.units import show

Law = DesignSettings | Compensator | None
"""``DesignSettings``: gains for each setting; ``Compensator``: one law for all; ``None``: the original position loop, eq. (13)."""


def named(names: tuple[str, ...], loader: Loader) -> dict[str, Law]:
    """The laws of these names for a loader.

    Raises:
        InputError: If a name is unknown, given twice, or there is none.
    """
    for name in names:
        if name not in NAMED_DESIGNS:
            raise InputError(f"compensator: expected {', '.join(NAMED_DESIGNS)}, got {show(name)}")
    if not names or len(set(names)) < len(names):
        raise InputError(f"compensator: expected different ones of {', '.join(NAMED_DESIGNS)}, got {show(list(names))}")
    return {name: NAMED_DESIGNS[name](loader) for name in names}


@dataclass(frozen=True, eq=False)
class SettingLaws:
    """The law of each setting.

    Attributes:
        gains: SI gains c_1 .. c_7, a row for each setting; ``None`` where one law holds for all.
        law: That one; ``None`` with gains, or for the original loop.
    """

    gains: NDArray[np.float64] | None
    law: Compensator | None

    @classmethod
    def of(cls, law: Law, loader: Loader, feel: NDArray[np.float64]) -> "SettingLaws":
        """The laws for settings I, B, G, a row each.

        Raises:
            InputError: If the gains cannot be designed.
        """
        if not isinstance(law, DesignSettings):
            return cls(None, law)
        gains = np.zeros((len(feel), len(GAIN_SYMBOLS)))
        gains[:, :-1] = schedule_gains(loader, feel, law).gains
        return cls(gains, None)

    def some(self, which: slice | NDArray[np.intp]) -> "SettingLaws":
        """Those of some settings."""
        return SettingLaws(None if self.gains is None else np.ascontiguousarray(self.gains[which]), self.law)

    def single(self, loader: Loader, setting: int) -> Compensator | None:
        """The law of one setting; ``None`` for the original loop."""
        return self.law if self.gains is None else state_feedback(loader, self.gains[setting])
