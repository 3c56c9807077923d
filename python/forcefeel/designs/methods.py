"""The methods by name: what each is, and its law for any settings of a loader."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from numpy.typing import ArrayLike

from forcefeel.designs.laws import design
from forcefeel.designs.tuning import OBSERVER, RECOVERED, ROBUST, Tuning
from forcefeel.errors import InputError
from forcefeel.loader import Loader
from forcefeel.sampled_compensator import SampledCompensator
from forcefeel.units import show


@dataclass(frozen=True)
class Method:
    """A way to design sampled laws.

    Attributes:
        name: What it is called.
        summary: What it is, in a line.
        tuning: Its weights and noises.
    """

    name: str
    summary: str
    tuning: Tuning = field(repr=False)

    def design(self, loader: Loader, feel: ArrayLike) -> SampledCompensator:
        """The laws for settings I, B, G in SI units, a row each; ``laws.design`` with this method's tuning."""
        return design(loader, feel, self.tuning)


_METHODS = (
    Method(
        "observer",
        "optimal regulator, feed-forward from the feel, observer that trusts every sensor and its plant",
        OBSERVER,
    ),
    Method(
        "recovered",
        "the same with strong noise at the plant's input, for the regulator's margins: loop transfer recovery",
        RECOVERED,
    ),
    Method(
        "robust",
        "the same without the potentiometer, weights and noises searched for over many perturbed plants at once",
        ROBUST,
    ),
)

METHODS: Mapping[str, Method] = MappingProxyType({each.name: each for each in _METHODS})
"""The methods by name."""


def method(name: str) -> Method:
    """The method of this name.

    Raises:
        InputError: If there is none.
    """
    try:
        return METHODS[name]
    except KeyError:
        raise InputError(f"method: expected {', '.join(METHODS)}, got {show(name)}") from None
