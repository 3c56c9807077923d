"""Flight schedule: a feel and its sampled law at every knot, interpolated between knots.

``I``, ``B``, ``G`` and all numbers of the law are linear along each axis between two knots. The laws of a loader by one design
share the coordinates of their observers, so the output of an interpolated law lies between the outputs of its neighbors.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import prod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.flight_schedule.axes import ScheduleAxis, check_axes, mesh, place_text, point_of
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.law_designs import law_design
from forcefeel.laws.sampled.sampled_law import NUMBERS, SampledLaw
from forcefeel.loader.feel_settings import check_feel_range
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.simulation import FeelChange

if TYPE_CHECKING:
    from scipy.interpolate import RegularGridInterpolator

_FEEL = len(FEEL_SETTING)


@dataclass(frozen=True, eq=False)
class ScheduledSetting:
    """Setting at one point of a schedule.

    Attributes:
        feel: I, B, G in SI units.
        loader: The loader with this feel.
        law: The law.
    """

    feel: tuple[float, float, float]
    loader: Loader
    law: SampledLaw


@dataclass(frozen=True, eq=False)
class FlightSchedule:
    """Feels and laws over the settings of an aircraft.

    Attributes:
        loader: Loader of the designs.
        law: Name of the law design.
        axes: One to three axes.
        feel: I, B, G in SI units at the knots, (values of each axis ..., 3).
        laws: Law of each knot; the last axis runs fastest.

    Raises:
        InputError: If axes, feels and laws do not match, or the laws were designed for another controller.
    """

    loader: Loader
    law: str
    axes: tuple[ScheduleAxis, ...]
    feel: NDArray[np.float64] = field(repr=False)
    laws: SampledLaw = field(repr=False)

    def __post_init__(self) -> None:
        axes = check_axes(self.axes)
        feel = np.array(self.feel, dtype=np.float64)
        shape = tuple(len(axis.values) for axis in axes)
        if feel.shape != (*shape, _FEEL):
            raise InputError(f"feel: expected I, B, G at every knot, the shape {(*shape, _FEEL)}, got {feel.shape}")
        if self.laws.settings != np.prod(shape):
            raise InputError(f"laws: expected one for each of {np.prod(shape)} knots, got {self.laws.settings}")
        Law(self.law, self.laws, self.laws.period_s, self.laws.delay_s).check(self.loader)
        feel.setflags(write=False)
        object.__setattr__(self, "axes", axes)
        object.__setattr__(self, "feel", feel)

    @property
    def knots(self) -> int:
        """Number of knots."""
        return self.laws.settings

    @cached_property
    def where(self) -> NDArray[np.float64]:
        """Axis values at each knot, (knots, axes)."""
        return mesh([axis.values for axis in self.axes])

    @cached_property
    def rows(self) -> NDArray[np.float64]:
        """I, B, G of each knot, (knots, 3)."""
        return self.feel.reshape(-1, _FEEL)

    @cached_property
    def _numbers(self) -> "RegularGridInterpolator":
        from scipy.interpolate import RegularGridInterpolator  # noqa: PLC0415  an extra; reading knots needs none

        flat = np.hstack([self.rows, *(getattr(self.laws, name).reshape(self.knots, -1) for name in NUMBERS)])
        values = flat.reshape(*self.feel.shape[:-1], -1)
        return RegularGridInterpolator([axis.values for axis in self.axes], values, method="linear", bounds_error=True)

    def between(self, where: NDArray[np.float64]) -> tuple[NDArray[np.float64], SampledLaw]:
        """Feels (points, 3) and laws at points (points, axes) within the knots."""
        numbers_at = self._numbers(where)
        shapes = [getattr(self.laws, name).shape[1:] for name in NUMBERS]
        feel, *parts = np.split(numbers_at, np.cumsum([_FEEL, *map(prod, shapes[:-1])]), axis=1)
        numbers = (part.reshape(-1, *shape) for part, shape in zip(parts, shapes, strict=True))
        return feel, SampledLaw(self.laws.period_s, self.laws.delay_s, *numbers)

    def at(self, **where: float) -> ScheduledSetting:
        """Feel and law at a point: ``schedule.at(dynamic_pressure=120, flaps=10)``.

        Args:
            where: A value for each axis, in its unit, by its name with ``_`` for spaces.

        Raises:
            InputError: If an axis is missing or unknown, or a value is outside the knots: a schedule is not extrapolated.
        """
        feel, law = self.between(point_of(self.axes, where)[np.newaxis])
        inertia, damping, stiffness = feel[0].tolist()
        changed = dict(zip(FEEL_SETTING, (inertia, damping, stiffness), strict=True))
        return ScheduledSetting((inertia, damping, stiffness), self.loader.replace(changed, si=True), law)

    def change(self, at_s: float, fade_s: float = 0.5, **where: float) -> FeelChange:
        """Change of I, B, G and the law in a run, from the current ones to those at a point of the schedule.

        The change is direct. For a long path use several changes along the schedule.

        Args:
            at_s: Begin, s.
            fade_s: Duration, s.
            where: As in ``at``.

        Raises:
            InputError: As in ``at``.
        """
        setting = self.at(**where)
        return FeelChange(at_s, dict(zip(FEEL_SETTING, setting.feel, strict=True)), fade_s, setting.law)


def design_schedule(
    loader: Loader, axes: Sequence[ScheduleAxis], feel: ArrayLike, law: str = "robust"
) -> FlightSchedule:
    """Design the law of every knot.

    Args:
        loader: The loader, with ``controller.period``; its own I, B, G are not used.
        axes: One to three axes with the values of the knots.
        feel: I, B, G in SI units (N m s^2/rad, N m s/rad, N m/rad) at every knot, (values of each axis ..., 3); for example by
            ``second_order_feel``.
        law: A name of ``designs.LAW_DESIGNS``.

    Returns:
        The schedule, unchecked: see ``check_schedule``.

    Raises:
        InputError: If the loader has no period, the feel has another shape or is out of range, or the law is unknown.

    Example:
        >>> pressure = ff.flight_schedule.ScheduleAxis("pressure", "lb/ft^2", (50, 100))
        >>> feel = ff.flight_schedule.second_order_feel([500.0, 1000.0], [1.0, 1.5], 0.6)
        >>> ff.flight_schedule.design_schedule(ff.digital_elevator(), [pressure], feel).law
        'robust'
    """
    checked = check_axes(axes)
    design = law_design(law)
    try:
        values = np.array(feel, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"feel: expected I, B, G at every knot ({error})") from error
    shape = (*(len(axis.values) for axis in checked), _FEEL)
    if values.shape != shape:
        raise InputError(f"feel: expected I, B, G at every knot, the shape {shape}, got {values.shape}")
    rows = values.reshape(-1, _FEEL)
    # Ranges are intervals, so interpolated feels are within them too.
    check_feel_range(rows, lambda knot: f"at {place_text(checked, mesh([axis.values for axis in checked])[knot])}")
    return FlightSchedule(loader, law, checked, values, design.design(loader, rows))


def second_order_feel(
    stiffness_n_m_per_rad: ArrayLike, frequency_hz: ArrayLike, damping_ratio: ArrayLike
) -> NDArray[np.float64]:
    """I, B, G of stiffness, natural frequency and damping ratio, eq. (11): ``I = G / w^2``, ``B = 2 zeta w I``.

    Args:
        stiffness_n_m_per_rad: G, N m/rad; an array of any shape, broadcast with the others.
        frequency_hz: Natural frequency in Hz.
        damping_ratio: zeta.

    Returns:
        SI values, (..., 3).

    Raises:
        InputError: If a frequency is not above 0.

    Example:
        >>> ff.flight_schedule.second_order_feel([500.0, 1000.0], [1.0, 1.5], 0.6).shape
        (2, 3)
    """
    stiffness, frequency, damping = np.broadcast_arrays(
        *(np.asarray(values, dtype=np.float64) for values in (stiffness_n_m_per_rad, frequency_hz, damping_ratio))
    )
    if not (frequency > 0).all():
        raise InputError("frequency_hz: expected numbers above 0")
    parts = (2 * np.pi * frequency, damping, stiffness)
    inertia, damping = _core.feel_from_frequencies(*(np.ravel(part) for part in parts))
    return np.stack([inertia.reshape(stiffness.shape), damping.reshape(stiffness.shape), stiffness], axis=-1)
