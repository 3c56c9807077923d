"""Runs of two linked loaders on the Rust engine."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError, expect, suggestion
from forcefeel.laws.law import Law, LawLike
from forcefeel.linked.joint import common_step, delay_periods
from forcefeel.linked.result import SIDES, LinkedRun, LinkMeasures
from forcefeel.linked.scenario import LinkedScenario, on_step, side_and_step
from forcefeel.loader.links import LINK_TABLE, AfterBreakout, Link
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import TABLE
from forcefeel.loader.project import Project
from forcefeel.simulation.engine import prepared
from forcefeel.simulation.outcome import MOST_HISTORY_BYTES, named, outputs
from forcefeel.simulation.scenario import Scenario
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.threads import threads_or_cores
from forcefeel.units import show

if TYPE_CHECKING:
    import xarray as xr

_Numbers = NDArray[np.float64]
_Side = tuple[_core.Simulation, _Numbers, Any, _Numbers | None, _Numbers | None]
"""Simulation, values of each run, and the law by name, as gains or as observers."""


def simulate_linked(
    project: Project, link: str, scenario: LinkedScenario, law: LawLike = None, second_law: LawLike = None
) -> LinkedRun:
    """Runs both loaders of a link through a scenario.

    Args:
        project: The project of both.
        link: Name of the link.
        scenario: The inputs. The run begins at rest, the link without torque.
        law: The law of the first loader, its name or its file, as for ``Law.of``.
        second_law: The law of the second. Default: ``law``, designed for it.

    Returns:
        The run. A mechanical link is of the second order in the step; each loader is stepped as by ``simulate``.

    Raises:
        InputError: If the project has no such link, or the periods of both loaders differ. An electronic link needs digital
            controllers and a delay of whole periods, a mechanical link a step that is short enough; else as ``simulate``.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> both = ff.linked.LinkedScenario(ff.Scenario(ff.Step("80 lb")), second_force=ff.Step("-80 lb"))
        >>> round(ff.linked.simulate_linked(project, "pitch", both, "robust").measures.peak_force_fight_n)
        356
    """
    pair = _Pair.of(project, link, scenario, (law, law if second_law is None else second_law))
    loaders = pair.loaders
    names, rows = pair.run(PairValues(loaders[0].si_values[np.newaxis], loaders[1].si_values[np.newaxis]))
    time = np.arange(rows.shape[1]) * scenario.first.sample_s
    values = dict(zip(names, rows[0].T, strict=True))
    measures = link_measures(np.asarray(time, dtype=np.float64), values, loaders[0]["column.grip_arm"])
    known = time < measures.diverged_at_s
    data = {name: ("time_s", np.where(known, row, np.nan), {"units": names[name]}) for name, row in values.items()}
    labeled = LabeledArrays(data, {"time_s": ("time_s", time, {"units": "s"})})
    return LinkedRun(pair.link, loaders, pair.laws, scenario, measures, labeled)


@dataclass(frozen=True, eq=False)
class PairValues:
    """SI values of many linked pairs, a row for each pair.

    Attributes:
        first, second: Of both loaders, in the order of ``parameters.TABLE``.
        link: Of the link, in the order of ``LINK_TABLE``. Default: those of the project, for all pairs.

    Raises:
        InputError: If the shapes do not match.

    Example:
        >>> rows = np.tile(ff.digital_elevator().si_values, (3, 1))
        >>> len(ff.linked.PairValues(rows, rows).first)
        3
    """

    first: _Numbers
    second: _Numbers
    link: _Numbers | None = None

    def __post_init__(self) -> None:
        for name, width in (("first", len(TABLE)), ("second", len(TABLE)), ("link", len(LINK_TABLE))):
            if (rows := getattr(self, name)) is None:
                continue
            rows = np.ascontiguousarray(rows, dtype=np.float64)
            shape = max(len(self.first), 1), width
            if rows.shape != shape:
                raise InputError(f"{name}: expected shape {shape}, a row for each pair, got {rows.shape}")
            object.__setattr__(self, name, rows)


def simulate_linked_batch(
    project: Project,
    link: str,
    scenario: LinkedScenario,
    values: PairValues,
    laws: tuple[LawLike, LawLike] = (None, None),
    *,
    keep: Sequence[str] = ("column_angle_rad",),
    threads: int | None = None,
) -> "xr.Dataset":
    """Runs many pairs of linked loaders through one scenario, on all cores.

    Args:
        project: The project; the curves, controllers and forces of its loaders apply to all pairs.
        link: Name of the link.
        scenario: The inputs, as for ``simulate_linked``.
        values: The loaders and links.
        laws: The law of each side: one for all pairs, or one for each.
        keep: Names of the outputs of both sides whose histories are kept.
        threads: Number of threads. Default: all cores. The numbers do not depend on it.

    Returns:
        Over ``run`` and ``time_s`` the histories of both sides, with ``first_`` or ``second_``, and those of the link. All runs
        have the noise of ``simulate_linked``, so that they differ by their values alone. Diverged runs are not cut off.

    Raises:
        InputError: As ``simulate_linked``; or the histories are too large.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> rows = np.tile(project.loaders["pitch"].si_values, (3, 1))
        >>> pushed = ff.linked.LinkedScenario(ff.Scenario(ff.Step("40 lb"), 0.5))
        >>> pairs = ff.linked.PairValues(rows, rows)
        >>> dict(ff.linked.simulate_linked_batch(project, "pitch", pushed, pairs, ("robust", "robust")).sizes)
        {'run': 3, 'time_s': 501}
    """
    pair = _Pair.of(project, link, scenario, laws, values.link)
    names, rows = pair.run(values, keep, threads_or_cores(threads))
    time = np.arange(rows.shape[1]) * scenario.first.sample_s
    data = {name: (("run", "time_s"), rows[:, :, k], {"units": unit}) for k, (name, unit) in enumerate(names.items())}
    return LabeledArrays(data, {"time_s": ("time_s", time, {"units": "s"})}).dataset


def linked_samples(project: Project, link: str, scenario: LinkedScenario, laws: tuple[LawLike, LawLike]) -> _Numbers:
    """What both laws and their link were given and gave in a run, (samples, 13), a row for each sample of the scenario.

    Of each side load cell, drive position, base, grip and the command; the force of both hands; 1 if the link is open.

    Raises:
        InputError: As ``simulate_linked``.
    """
    pair = _Pair.of(project, link, scenario, laws)
    first, second = (loader.si_values[np.newaxis] for loader in pair.loaders)
    names, rows = pair.run(PairValues(first, second), (), samples=True)
    return rows[0, :, len(names) :]


def check_pair(project: Project, link: str, scenario: LinkedScenario) -> None:
    """Refuses a link that ``simulate_linked`` cannot run.

    Raises:
        InputError: As ``simulate_linked``.
    """
    joint = project.links[link]
    loaders = project.sides(joint)
    common_step(joint, loaders, scenario.first)
    delay_periods(joint, loaders)


@dataclass(frozen=True)
class _Pair:
    """Two loaders on their link, checked."""

    link: Link
    loaders: tuple[Loader, Loader]
    laws: tuple[Law, Law]
    scenario: LinkedScenario
    step_s: float

    @classmethod
    def of(
        cls,
        project: Project,
        link: str,
        scenario: LinkedScenario,
        laws: tuple[LawLike, LawLike],
        links: _Numbers | None = None,
    ) -> "_Pair":
        expect("project", project, Project, "a Project, such as loader.read_project('cockpit.toml')")
        expect("scenario", scenario, LinkedScenario, "a LinkedScenario, such as LinkedScenario(Scenario(Step(100.0)))")
        if link not in project.links:
            known = f"one of {', '.join(project.links)}" if project.links else "a link in [links] of the project"
            raise InputError(f"link: expected {known}, got {show(link)}{suggestion(link, project.links)}")
        joint = project.links[link]
        loaders = project.sides(joint)
        stiffest = joint if links is None else replace(joint, values=links.max(axis=0))
        step_s = common_step(stiffest, loaders, scenario.first)
        return cls(joint, loaders, (Law.of(laws[0], loaders[0]), Law.of(laws[1], loaders[1])), scenario, step_s)

    def run(
        self, values: PairValues, keep: Sequence[str] | None = None, threads: int = 1, *, samples: bool = False
    ) -> tuple[dict[str, str], _Numbers]:
        """Name and unit of each output, and the outputs (runs, samples, outputs); all of both sides without ``keep``.

        With ``samples`` what laws and link were given and gave follows without names.
        """
        scenario, runs = self.scenario, len(values.first)
        names: dict[str, str] = {}
        sides = []
        for k, (inputs, rows) in enumerate(((scenario.first, values.first), (scenario.second, values.second))):
            units, side = self._side(k, inputs, rows, keep)
            names |= {f"{SIDES[k]}_{name}": unit for name, unit in units.items()}
            sides.append(side)
        names |= {named(name, unit) if unit != "N m" else f"{name}_n_m": unit for name, unit in _core.linked_outputs()}
        times = round(scenario.first.duration_s / scenario.first.sample_s) + 1
        if 8 * runs * times * len(names) > MOST_HISTORY_BYTES:
            raise InputError(
                f"keep: histories of {runs} pairs take more than {MOST_HISTORY_BYTES >> 30} GiB; keep fewer outputs, or run fewer "
                "pairs at once"
            )
        return names, _core.simulate_linked(
            sides[0],
            sides[1],
            np.tile(self.link.values, (runs, 1)) if values.link is None else values.link,
            delay=delay_periods(self.link, self.loaders),
            uncouples=self.link.after_breakout is AfterBreakout.UNCOUPLE,
            disconnect=None if scenario.disconnect_s is None else on_step(scenario.disconnect_s, self.step_s),
            jam=side_and_step("jam", scenario.jam, self.link, self.step_s),
            button=side_and_step("button", scenario.button, self.link, self.step_s),
            samples=samples,
            threads=threads,
        )

    def _side(
        self, k: int, inputs: Scenario, rows: _Numbers, keep: Sequence[str] | None
    ) -> tuple[dict[str, str], _Side]:
        """Name and unit of each output of a side, and the side."""
        law, loader = self.laws[k], self.loaders[k]
        units = outputs(law.numbers.displacement_unit, loader.drive)
        kept = list(units if keep is None else keep)
        if unknown := [name for name in kept if name not in units]:
            raise InputError(f"keep: expected names of outputs ({', '.join(units)}), got {unknown[0]!r}")
        places, kinds = [list(units).index(name) for name in kept], law.engine(loader)
        simulation = prepared(loader, replace(inputs, step_s=self.step_s), places, law)
        side = simulation, rows, kinds.get("law"), kinds.get("gains"), kinds.get("observers")
        return {name: units[name] for name in kept}, side


def link_measures(time: _Numbers, values: Mapping[str, _Numbers], grip_arm: float) -> LinkMeasures:
    """The measures of a run from its outputs by name; ``grip_arm`` of the first loader."""
    angles = [values[f"{side}_column_angle_rad"] for side in SIDES]
    known = np.all(np.abs(angles) < _core.BOUND_RAD, axis=0)
    until = len(time) if known.all() else int(np.argmin(known))
    first, second = (angle[:until] for angle in angles)
    torques = [values[f"{side}_link_torque_n_m"][:until] for side in SIDES]
    hands = [values[f"{side}_hand_force_n"][:until] for side in SIDES]
    fight = np.where(hands[0] * hands[1] < 0, np.minimum(*np.abs(hands)), 0.0)
    torque = float(np.max(np.abs(torques), initial=0.0))
    return LinkMeasures(
        peak_link_torque_n_m=torque,
        peak_link_force_n=torque / grip_arm,
        peak_force_fight_n=float(np.max(fight, initial=0.0)),
        largest_difference_rad=float(np.max(np.abs(first - second), initial=0.0)),
        final_difference_rad=_late(first - second),
        first_final_angle_rad=_late(first),
        second_final_angle_rad=_late(second),
        first_priority_s=_lasts(values["priority"][:until] == 1, time),
        second_priority_s=_lasts(values["priority"][:until] == 2, time),
        dual_input_s=_lasts(values["dual_input"][:until] > 0, time),
        gave_way_at_s=_first(values["link_gives_way"][:until] > 0, time),
        diverged_at_s=_first(~known, time),
    )


def _late(values: NDArray[np.float64]) -> float:
    """The mean over the last tenth."""
    return float(np.mean(values[-max(len(values) // 10, 1) :])) if len(values) else float("nan")


def _lasts(when: NDArray[np.bool_], time: NDArray[np.float64]) -> float:
    return float(np.count_nonzero(when) * (time[1] - time[0]))


def _first(when: NDArray[np.bool_], time: NDArray[np.float64]) -> float:
    return float(time[np.argmax(when)]) if when.any() else inf
