"""Results of a run."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from html import escape
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.loader.softened_feel import SoftenedFeel
from forcefeel.simulation.scenario import Scenario
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.units import (
    ANGLE,
    ANGULAR_VELOCITY,
    BY_SI,
    CURRENT,
    FLOW,
    MOTOR_CURRENT,
    PRESSURE,
    RATIO,
    SECONDS,
    VOLTAGE,
    UnitSystem,
    show,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

BAND = 0.05
"""A run has settled when its last swing is within this share of its whole swing, the residual band of the rules, and stays
within it around where it rests."""


def named(name: str, unit: str) -> str:
    """``name`` with the suffix of its unit."""
    return f"{name}_{BY_SI[unit].suffix}".rstrip("_")


@cache
def measures_of(drive: str) -> Mapping[str, str]:
    """The measures of a run with that drive and their SI units, in the engine's order."""
    return MappingProxyType({named(name, unit): unit for name, unit in _core.simulation_measures(drive)})


MEASURES = measures_of(HYDRAULIC)
"""Those of a hydraulic loader; of any other too the first are those of the motion, and the last is when it diverged."""


class RunStatus(StrEnum):
    """How a run ended."""

    SETTLED = "settled"
    MOVING = "moving"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class Motion:
    """Measures of a run for any drive.

    Attributes:
        maximum_angle_rad: Largest column angle.
        time_of_maximum_s: When.
        minimum_angle_rad: Smallest column angle.
        time_of_minimum_s: When.
        final_angle_rad: Mean over the last tenth of the run.
        equilibrium_angle_rad: Where the last force holds the column, dry friction aside; not a number where nothing does, or a test
            signal, the shaker or a change of the feel goes on at the end.
        overshoot: How far beyond the equilibrium, as a share of the way to it from the start. Not a number where the run does not
            tell it to 1 %: a way of no more than 5 % of the largest excursion, or an excursion of no more than 5 % of the way; a
            stop that was met; a run that ends before the column turns or rests; motion that the sensors' noise hides.
        settling_time_s: From then on within 5 % of the way around the equilibrium, or around where dry friction holds the column
            farther off; of the largest excursion for a column that ends where it began. Not a number where it does not stay.
        period_s: Mean time from one pass of the equilibrium to the next to the same side; not a number as the overshoot, and with
            fewer than three passes.
        periods: How many periods that is the mean of; not a number without one.
        last_swing_rad: Lowest to highest angle over the last tenth of the run.
        peak_current_a: Largest magnitude of the current of valve or motor.
    """

    maximum_angle_rad: Annotated[float, ANGLE]
    time_of_maximum_s: Annotated[float, SECONDS]
    minimum_angle_rad: Annotated[float, ANGLE]
    time_of_minimum_s: Annotated[float, SECONDS]
    final_angle_rad: Annotated[float, ANGLE]
    equilibrium_angle_rad: Annotated[float, ANGLE]
    overshoot: Annotated[float, RATIO]
    settling_time_s: Annotated[float, SECONDS]
    period_s: Annotated[float, SECONDS]
    periods: Annotated[float, RATIO]
    last_swing_rad: Annotated[float, ANGLE]
    peak_current_a: Annotated[float, CURRENT]


@dataclass(frozen=True)
class Measures(Motion):
    """Measures of a run of a hydraulic loader.

    Attributes:
        peak_pressure_pa: Largest magnitude of the load pressure.
        peak_flow_m3_per_s: Largest magnitude of the flow.
        diverged_at_s: When the run left every bound; infinite if it did not.

    Example:
        >>> run = ff.simulate(ff.elevator(), ff.Scenario(ff.Step(100.0)))
        >>> f"overshoot {run.measures.overshoot:.0%}"
        'overshoot 45%'
    """

    peak_pressure_pa: Annotated[float, PRESSURE]
    peak_flow_m3_per_s: Annotated[float, FLOW]
    diverged_at_s: Annotated[float, SECONDS]


@dataclass(frozen=True)
class MotorMeasures(Motion):
    """Measures of a run of an electric loader.

    Attributes:
        peak_current_a: Largest magnitude of its current.
        peak_voltage_v: Largest magnitude of the motor's voltage.
        peak_speed_rad_per_s: Largest magnitude of its speed.
        diverged_at_s: When the run left every bound; infinite if it did not.
    """

    peak_current_a: Annotated[float, MOTOR_CURRENT]
    peak_voltage_v: Annotated[float, VOLTAGE]
    peak_speed_rad_per_s: Annotated[float, ANGULAR_VELOCITY]
    diverged_at_s: Annotated[float, SECONDS]


KINDS: Mapping[str, type[Measures] | type[MotorMeasures]] = MappingProxyType(
    {HYDRAULIC: Measures, ELECTRIC: MotorMeasures}
)
"""Type of the measures by drive."""


def as_measures(drive: str, values: Iterable[float]) -> Measures | MotorMeasures:
    """The measures of a run from the engine's numbers."""
    return KINDS[drive](**dict(zip(measures_of(drive), values, strict=True)))


@dataclass(frozen=True, eq=False)
class Run:
    """One run.

    Attributes:
        loader: The loader.
        scenario: The inputs.
        status: Status at the end.
        measures: The measures.
        outputs: Every output over ``time_s``, SI units; NaN after divergence. ``history`` is the same as a data set of xarray.
        method: ``exact`` where everything is linear, ``stepped`` otherwise.
        angle_noise_rad: R.m.s. of the column's angle by the sensors' noise alone.
        law_remark: That the law was made for another loader; empty where it was not: ``Law.made_for_another``.
        softened: What became of the programmed feel, where it was softened to what the drive renders.

    Example:
        >>> run = ff.simulate(ff.elevator(), ff.Scenario(ff.Step(100.0)))
        >>> run
        <Run of 'elevator-1974', 2 s, exact: settled at 1.241 s>
    """

    loader: Loader
    scenario: Scenario
    status: RunStatus
    measures: Measures | MotorMeasures
    outputs: LabeledArrays = field(repr=False)
    method: str = "stepped"
    angle_noise_rad: float = 0.0
    law_remark: str = ""
    softened: SoftenedFeel | None = None

    @property
    def history(self) -> "xr.Dataset":
        """Every output over ``time_s`` as a data set of xarray, an extra."""
        return self.outputs.dataset

    @property
    def note(self) -> str:
        """How the run ended, in words."""
        match self.status:
            case RunStatus.DIVERGED:
                return f"diverged at {self.measures.diverged_at_s:.3f} s: the column left every bound"
            case RunStatus.MOVING:
                return f"still moving after {self.scenario.duration_s:g} s"
            case RunStatus.SETTLED:
                return f"settled at {self.measures.settling_time_s:.3f} s"

    def __repr__(self) -> str:
        return f"<Run of {self.loader.name!r}, {self.scenario.duration_s:g} s, {self.method}: {self.note}>"

    def _repr_html_(self) -> str:
        from forcefeel.plots.draw import image, small_axes  # noqa: PLC0415  Matplotlib, for notebooks

        overshoot = f", overshoot {self.measures.overshoot:.0%}" if isfinite(self.measures.overshoot) else ""
        verdict = f"{self.note}{overshoot}"
        return f"<p><b>{escape(self.loader.name)}</b>: {verdict}</p>{image(self.plot(ax=small_axes()), verdict)}"

    def plot(self, *outputs: str, units: UnitSystem = UnitSystem.SI, ax: "Axes | None" = None) -> "Axes":
        """Draws outputs over time; the column's angle beside the programmed one if none is named.

        Args:
            outputs: Names in ``history``, of one kind of quantity.
            units: Units of the labels.
            ax: Matplotlib axes to draw on; of a figure of its own if not given.

        Returns:
            The axes.

        Raises:
            InputError: If an output is unknown or two differ in kind.

        Example:
            >>> run = ff.simulate(ff.elevator(), ff.Scenario(ff.Step(100.0), duration_s=0.5))
            >>> run.plot("valve_current_a").get_ylabel()
            'Valve current, mA'
        """
        from forcefeel.plots.draw import curves  # noqa: PLC0415  Matplotlib, for whoever plots

        if unknown := [name for name in outputs if name not in self.outputs]:
            raise InputError(
                f"outputs: expected names such as {', '.join(list(self.outputs)[:3])}, got {show(unknown[0])}"
            )
        curves_si = {name: self.outputs[name] for name in outputs} or self._angles()
        kinds = {self.outputs.unit(name) for name in outputs} or {"rad"}
        if len(kinds) > 1:
            raise InputError(f"outputs: expected one kind of quantity on one axis, got {', '.join(sorted(kinds))}")
        unit = BY_SI[kind := kinds.pop()]
        scale, time = unit.from_si(1.0, units), self.outputs["time_s"]
        words = {name: in_words(name, kind) for name in curves_si}
        what = (
            next(iter(words.values()))
            if len(curves_si) == 1
            else in_words("angle" if kind == "rad" else "output", kind)
        )
        return curves(
            {words[name]: (time, scale * values) for name, values in curves_si.items()},
            "Time, s",
            f"{what[:1].upper()}{what[1:]}, {unit.shown(units)}".rstrip(", "),
            f"{self.loader.name}: {self.note}",
            ax,
        )

    def _angles(self) -> dict[str, NDArray[np.float64]]:
        """The column's angle, and that which the feel programs."""
        programmed = self.outputs[feel_position(self)] / per_feel_angle(self)
        return {"column_angle_rad": self.outputs["column_angle_rad"], "programmed_angle_rad": programmed}


def feel_position(run: Run) -> str:
    """Name of the programmed displacement among the outputs; its unit is that of the law."""
    return next(name for name in run.outputs if name.startswith("feel_position"))


def per_feel_angle(run: Run) -> float:
    """Programmed displacement, in its unit, per column angle: 1, or K_3 alpha R_b where it is a voltage."""
    if feel_position(run).endswith("_rad"):
        return 1.0
    loader = run.loader
    return loader["potentiometer.gain"] * loader["linkage.ratio"] * loader["column.base_arm"]


def in_words(name: str, unit: str) -> str:
    """An output's name as people write it, without its unit."""
    return name.removesuffix(f"_{BY_SI[unit].suffix}").replace("_", " ")


def statuses(measures: NDArray[np.float64]) -> NDArray[np.str_]:
    """The status of each run from its measures, rows in the order of ``MEASURES``."""
    column = {name: measures[:, k] for k, name in enumerate(MEASURES)}
    swing = column["maximum_angle_rad"] - column["minimum_angle_rad"]
    settled = (column["last_swing_rad"] <= BAND * swing) & np.isfinite(column["settling_time_s"])
    status = np.where(settled, RunStatus.SETTLED, RunStatus.MOVING)
    return np.where(np.isfinite(column["diverged_at_s"]), RunStatus.DIVERGED, status)


def without_diverged(measures: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same, but of a run that diverged only when; its other measures are not a number."""
    kept = np.array(measures)
    gone = np.isfinite(measures[:, -1])
    kept[gone, :-1] = np.nan
    return kept


def outputs(displacement_unit: str, drive: str = HYDRAULIC) -> dict[str, str]:
    """The outputs of a run and their SI units; the feel's displacement is a voltage or an angle."""
    feel = {"feel_position": displacement_unit, "feel_velocity": f"{displacement_unit}/s"}
    return {
        named(name, actual): actual
        for name, unit in _core.simulation_outputs(drive)
        if (actual := feel.get(name, unit)) is not None
    }


def history(
    values: NDArray[np.float64], units: dict[str, str], sample_s: float, attributes: dict[str, Any]
) -> LabeledArrays:
    """One run's outputs (outputs, samples) over time; not a number once the column has left every bound."""
    time = np.arange(values.shape[1]) * sample_s
    data = {name: ("time_s", row, {"units": unit}) for (name, unit), row in zip(units.items(), values, strict=True)}
    return LabeledArrays(data, {"time_s": ("time_s", time, {"units": "s"})}, attributes)


MOST_HISTORY_BYTES = 4 * 2**30
"""Largest histories that a batch keeps; more is refused before it starts."""
