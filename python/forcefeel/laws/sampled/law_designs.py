"""The methods by name: what each is, and its law for any settings of a loader."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType

from numpy.typing import ArrayLike

from forcefeel.errors import InputError
from forcefeel.laws.sampled import grip, h_infinity, load_cell_loop, load_cell_motor, torque_mode
from forcefeel.laws.sampled import observer_law as laws
from forcefeel.laws.sampled.grip import GRIP
from forcefeel.laws.sampled.rules import GRIP_BY_FREQUENCY, agile_tuning, grip_tuning, robust_tuning
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.laws.sampled.tuning import MOTOR_RATE_WEIGHT, OBSERVER, RECOVERED, Tuning
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import DRIVES, ELECTRIC
from forcefeel.loader.sensors import has_grip_sensor
from forcefeel.units import show


@dataclass(frozen=True)
class LawDesign:
    """A way to design sampled laws.

    Attributes:
        name: What it is called.
        summary: What it is, in a line.
        design: The laws of a loader for settings I, B, G in SI units, a row each.
        drives: Of which loaders.
        needs_grip_sensor: Whether it is for a force sensor at the grip.
    """

    name: str
    summary: str
    design: Callable[[Loader, ArrayLike], SampledLaw] = field(repr=False)
    drives: tuple[str, ...] = DRIVES
    needs_grip_sensor: bool = False

    def serves(self, loader: Loader) -> bool:
        """Whether it is for a loader's drive and has the sensors that it needs."""
        return loader.drive in self.drives and (has_grip_sensor(loader) or not self.needs_grip_sensor)


def tuned(name: str, summary: str, tuning: Tuning | Callable[[Loader], Tuning]) -> LawDesign:
    """Regulator, feed-forward and observer with these weights and noises, or with those that follow from the loader.

    Example:
        >>> from forcefeel.laws.sampled import robust_tuning
        >>> ff.laws.tuned("mine", "the robust law by another name", robust_tuning).name
        'mine'
    """
    return LawDesign(name, summary, partial(_tuned, tuning=tuning))


def _tuned(loader: Loader, feel: ArrayLike, tuning: Tuning | Callable[[Loader], Tuning]) -> SampledLaw:
    return laws.design(loader, feel, tuning if isinstance(tuning, Tuning) else tuning(loader))


def _by_drive(loader: Loader, tuning: Tuning) -> Tuning:
    return replace(tuning, rate_weight=MOTOR_RATE_WEIGHT) if loader.drive == ELECTRIC else tuning


def _load_cell(loader: Loader, feel: ArrayLike) -> SampledLaw:
    design = load_cell_motor.design if loader.drive == ELECTRIC else load_cell_loop.design
    return design(loader, feel)


def _at_grip(loader: Loader, feel: ArrayLike) -> SampledLaw:
    return grip.design(loader, feel, grip_tuning(loader), GRIP_BY_FREQUENCY[loader.drive])


def _robust(loader: Loader, feel: ArrayLike) -> SampledLaw:
    design = grip.design if has_grip_sensor(loader) else laws.design
    return design(loader, feel, robust_tuning(loader))


_LAW_DESIGNS = (
    LawDesign(
        load_cell_loop.LOAD_CELL,
        "state feedback with the load cell's loop in the plant, the column's inertia taken off the feel's",
        _load_cell,
    ),
    tuned(
        "observer",
        "optimal regulator, feed-forward from the feel, observer that trusts every sensor and its plant",
        partial(_by_drive, tuning=OBSERVER),
    ),
    tuned(
        "recovered",
        "the observer design with strong noise at the plant's input, for the regulator's margins: loop transfer recovery",
        partial(_by_drive, tuning=RECOVERED),
    ),
    LawDesign(
        "h-infinity",
        "no potentiometer, the pilot's torque by an H-infinity filter: least error under the worst disturbance",
        h_infinity.design,
    ),
    LawDesign(
        "robust",
        "the observer design without the potentiometer, weights and noises by the loader's lag, inertia and declared noises",
        _robust,
    ),
    tuned(
        "agile",
        "the robust design with another filter: bears a hand's arm better, noise worse; for parts known to a per cent",
        agile_tuning,
    ),
    LawDesign(
        GRIP,
        "a force sensor at the grip drives the feel, and the servo follows it: deviations of the parts have little effect",
        _at_grip,
        needs_grip_sensor=True,
    ),
    LawDesign(
        torque_mode.TORQUE_MODE,
        "no force sensor: the feel's torque by the motor's current, at the angle of the motor's encoder",
        torque_mode.design,
        (ELECTRIC,),
    ),
)

LAW_DESIGNS: Mapping[str, LawDesign] = MappingProxyType({each.name: each for each in _LAW_DESIGNS})
"""The methods by name."""


def law_design(name: str) -> LawDesign:
    """The method of this name.

    Raises:
        InputError: If the name is unknown.

    Example:
        >>> ff.laws.law_design("observer").summary[:8]
        'optimal '
    """
    try:
        return LAW_DESIGNS[name]
    except KeyError:
        raise InputError(f"law: expected {', '.join(LAW_DESIGNS)}, got {show(name)}") from None
