"""Fields in SI units that also take text with a unit, and are checked."""

from forcefeel.errors import InputError
from forcefeel.simulation.inputs.sampled import Bound, check_number
from forcefeel.units import parse

_EXAMPLES = {"n": ("N", "100 N"), "s": ("s", "0.5 s"), "hz": ("Hz", "2 Hz"), "rad": ("rad", "5 deg")}
"""SI unit and example by the suffix of a field's name."""


class Quantity:
    """A field of a dataclass in the SI unit that its name ends with: a number in that unit, or text with any unit of its kind.

    Args:
        default: The default; required if not given.
        bound: The range of the number; ``None`` if the class itself checks it.

    Raises:
        InputError: When set to text that is not a number with a unit of this kind, or to a number out of range.

    Example:
        >>> ff.Step("100 lb", start_s="50 ms")
        Step(force_n=444.822..., start_s=0.05)
    """

    def __init__(self, default: float | None = None, bound: Bound | None = "finite number") -> None:
        self._default, self._bound = default, bound

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        self._unit, self._example = _EXAMPLES[name.rpartition("_")[2]]

    def __get__(self, instance: object | None, owner: type) -> float:
        if instance is None:
            if self._default is None:
                raise AttributeError(self._name)  # tells the dataclass that the field has no default
            return self._default
        value: float = vars(instance)[self._name]
        return value

    def __set__(self, instance: object, value: float | str) -> None:
        if isinstance(value, str):
            try:
                value = parse(value, self._unit, self._example)
            except InputError as error:
                raise InputError(f"{type(instance).__name__}: {self._name}: {error}") from error
        if self._bound is not None:
            check_number(type(instance).__name__, self._name, value, self._bound)
        vars(instance)[self._name] = value
