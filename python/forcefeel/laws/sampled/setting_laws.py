"""The law that each programmed setting gets, whatever method it comes from.

Laws are designed for the nominal plant and each setting of the feel; a perturbed plant meets the law of the nominal one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import Compensator
from forcefeel.errors import InputError
from forcefeel.laws.gain_schedule import schedule_gains
from forcefeel.laws.recursion import GAIN_SYMBOLS, NAMED_DESIGNS, DesignSettings, compensate
from forcefeel.laws.sampled.methods import METHODS, Method
from forcefeel.laws.sampled_compensator import SampledCompensator
from forcefeel.linear.models import state_feedback
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.units import show

Law = DesignSettings | Method | Compensator | None
"""``DesignSettings``, ``Method``: a law for each setting; ``Compensator``: one for all; ``None``: the original loop, eq. (13)."""

NAMED_LAWS = (*NAMED_DESIGNS, *METHODS)
"""The names of laws: the report's, then those that are made for a digital controller."""


def names_for(loader: Loader) -> tuple[str, ...]:
    """The names of all laws that a loader can run: the sampled ones need a digital controller."""
    return NAMED_LAWS if loader["controller.period"] else tuple(NAMED_DESIGNS)


def named(names: Sequence[str], loader: Loader) -> dict[str, Law]:
    """The laws of these names for a loader.

    Raises:
        InputError: If a name is unknown, given twice, or there is none.
    """
    for name in names:
        if name not in NAMED_LAWS:
            raise InputError(f"compensator: expected {', '.join(NAMED_LAWS)}, got {show(name)}")
    if not names or len(set(names)) < len(names):
        raise InputError(f"compensator: expected different ones of {', '.join(NAMED_LAWS)}, got {show(list(names))}")
    return {name: METHODS[name] if name in METHODS else NAMED_DESIGNS[name](loader) for name in names}


def own_law(name: str, loader: Loader) -> Compensator | SampledCompensator | None:
    """The law of a name for a loader's own setting; ``None`` is the original position loop.

    Raises:
        InputError: If the name is unknown, the recursion does not give the gains, or a sampled law cannot be designed.
    """
    (law,) = named((name,), loader).values()
    if not isinstance(law, DesignSettings):
        own = np.array([[loader[key] for key in FEEL_SETTING]])
        return SettingLaws.of(law, loader, own).single(loader, 0)
    found = compensate(loader, law)
    if not found.reached:
        raise InputError(f"compensator: the recursion does not give the {name} gains for this loader: {found.note}")
    return found.compensator(loader)


@dataclass(frozen=True, eq=False)
class SettingLaws:
    """The law of each setting, as the engine takes it.

    Attributes:
        found: SI gains c_1 .. c_7, a row for each setting; a sampled law for each; one law for all; or ``None``, the original loop.
    """

    found: NDArray[np.float64] | SampledCompensator | Compensator | None

    @classmethod
    def of(cls, law: Law, loader: Loader, feel: NDArray[np.float64]) -> "SettingLaws":
        """The laws for settings I, B, G, a row each.

        Raises:
            InputError: If they cannot be designed.
        """
        if isinstance(law, Method):
            return cls(law.design(loader, feel))
        if not isinstance(law, DesignSettings):
            return cls(law)
        gains = np.zeros((len(feel), len(GAIN_SYMBOLS)))
        gains[:, :-1] = schedule_gains(loader, feel, law).gains
        return cls(gains)

    @property
    def gains(self) -> NDArray[np.float64] | None:
        """The gains of each setting; ``None`` where it is not gains that differ."""
        return self.found if isinstance(self.found, np.ndarray) else None

    @property
    def fixed(self) -> Compensator | None:
        """The law that holds for all; ``None`` where there is none, or it is the original loop."""
        return self.found if isinstance(self.found, Compensator) else None

    def some(self, which: slice | NDArray[np.intp]) -> "SettingLaws":
        """Those of some settings."""
        if isinstance(self.found, np.ndarray):
            return SettingLaws(np.ascontiguousarray(self.found[which]))
        return SettingLaws(self.found.some(which)) if isinstance(self.found, SampledCompensator) else self

    def single(self, loader: Loader, setting: int) -> Compensator | SampledCompensator | None:
        """The law of one setting; ``None`` for the original loop."""
        if isinstance(self.found, np.ndarray):
            return state_feedback(loader, self.found[setting])
        return self.found.some(setting) if isinstance(self.found, SampledCompensator) else self.found
