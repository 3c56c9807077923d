"""Results of a run of two linked loaders."""

from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Annotated

from forcefeel.laws.law import Law
from forcefeel.linked.scenario import LinkedScenario
from forcefeel.loader.links import Link
from forcefeel.loader.loader import Loader
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.units import ANGLE, FORCE, SECONDS, TORQUE

if TYPE_CHECKING:
    import xarray as xr

SIDES = ("first", "second")
"""Both sides, as the names in a history begin."""


@dataclass(frozen=True)
class LinkMeasures:
    """Measures of a run of two linked loaders.

    Attributes:
        peak_link_torque_n_m: Largest torque of the link on a column or, of an electronic link, on a feel.
        peak_link_force_n: The same as a force at the first pilot's grip.
        peak_force_fight_n: Largest force with which the hands push against each other: the smaller of two of opposite sign,
            each with its arm's.
        largest_difference_rad: Largest angle of one column beyond the other.
        final_difference_rad: Angle of the first column beyond the second, mean over the last tenth of the run.
        first_final_angle_rad: Of the first column, likewise.
        second_final_angle_rad: Of the second column, likewise.
        first_priority_s: How long the first pilot has priority.
        second_priority_s: How long the second has.
        dual_input_s: How long both hands push with more than the ``dual_input_force`` of the link.
        gave_way_at_s: When the link first gave way or was opened; infinite if it did not.
        diverged_at_s: When a column left every bound; infinite if none did.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> pushed = ff.linked.LinkedScenario(ff.Scenario(ff.Step("40 lb")))
        >>> measures = ff.linked.simulate_linked(project, "pitch", pushed, "robust").measures
        >>> measures.peak_force_fight_n, measures.gave_way_at_s
        (0.0, inf)
    """

    peak_link_torque_n_m: Annotated[float, TORQUE]
    peak_link_force_n: Annotated[float, FORCE]
    peak_force_fight_n: Annotated[float, FORCE]
    largest_difference_rad: Annotated[float, ANGLE]
    final_difference_rad: Annotated[float, ANGLE]
    first_final_angle_rad: Annotated[float, ANGLE]
    second_final_angle_rad: Annotated[float, ANGLE]
    first_priority_s: Annotated[float, SECONDS]
    second_priority_s: Annotated[float, SECONDS]
    dual_input_s: Annotated[float, SECONDS]
    gave_way_at_s: Annotated[float, SECONDS]
    diverged_at_s: Annotated[float, SECONDS]


@dataclass(frozen=True, eq=False)
class LinkedRun:
    """A run of two linked loaders.

    Attributes:
        link: The link.
        loaders: Both loaders, the first pilot's first.
        laws: Their laws.
        scenario: The inputs.
        measures: The measures.
        outputs: Every output of both over ``time_s``, names with ``first_`` or ``second_``, and those of the link; SI units;
            NaN after divergence. ``history`` is the same as a data set of xarray.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> ff.linked.simulate_linked(project, "pitch", ff.linked.LinkedScenario(ff.Scenario(ff.Step("40 lb"))), "robust")
        <LinkedRun of pitch and pitch-first-officer, 2 s: the link held>
    """

    link: Link
    loaders: tuple[Loader, Loader]
    laws: tuple[Law, Law]
    scenario: LinkedScenario
    measures: LinkMeasures
    outputs: LabeledArrays = field(repr=False)

    @property
    def history(self) -> "xr.Dataset":
        """Every output over ``time_s`` as a data set of xarray, an extra."""
        return self.outputs.dataset

    @property
    def diverged(self) -> bool:
        """Whether a column left every bound."""
        return isfinite(self.measures.diverged_at_s)

    @property
    def note(self) -> str:
        """How the run ended, in words."""
        if self.diverged:
            return f"diverged at {self.measures.diverged_at_s:.3f} s: a column left every bound"
        if not isfinite(at_s := self.measures.gave_way_at_s):
            return "the link held"
        opened = self.scenario.disconnect_s is not None and at_s >= self.scenario.disconnect_s
        return f"the link {'was opened' if opened else 'gave way'} at {at_s:.3f} s"

    def __repr__(self) -> str:
        return f"<LinkedRun of {' and '.join(self.link.between)}, {self.scenario.first.duration_s:g} s: {self.note}>"
