"""Runs of two linked loaders on the Rust engine."""

from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError, expect, suggestion
from forcefeel.laws.law import Law, LawLike
from forcefeel.linked.joint import common_step, delay_periods
from forcefeel.linked.result import SIDES, LinkedRun, LinkMeasures
from forcefeel.linked.scenario import LinkedScenario, on_step
from forcefeel.loader.links import AfterBreakout
from forcefeel.loader.loader import Loader
from forcefeel.loader.project import Project
from forcefeel.simulation.engine import prepared
from forcefeel.simulation.outcome import named, outputs
from forcefeel.simulation.scenario import Scenario
from forcefeel.units import show

_Numbers = NDArray[np.float64]
_Side = tuple[_core.Simulation, _Numbers, Any, _Numbers | None, _Numbers | None]
"""Simulation, values, and the law by name, as gains or as an observer."""


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
    expect("project", project, Project, "a Project, such as loader.read_project('cockpit.toml')")
    expect("scenario", scenario, LinkedScenario, "a LinkedScenario, such as LinkedScenario(Scenario(Step(100.0)))")
    if link not in project.links:
        known = f"one of {', '.join(project.links)}" if project.links else "a link in [links] of the project"
        raise InputError(f"link: expected {known}, got {show(link)}{suggestion(link, project.links)}")
    joint = project.links[link]
    loaders = (project.loaders[joint.between[0]], project.loaders[joint.between[1]])
    laws = (Law.of(law, loaders[0]), Law.of(law if second_law is None else second_law, loaders[1]))
    step_s = common_step(joint, loaders, scenario.first)
    scenarios = [replace(of_side, step_s=step_s) for of_side in (scenario.first, scenario.second)]
    units = [outputs(law.numbers.displacement_unit, loader.drive) for law, loader in zip(laws, loaders, strict=True)]
    first, second = (_side(*side) for side in zip(loaders, scenarios, units, laws, strict=True))
    jammed = scenario.jam_side(joint)
    rows = _core.simulate_linked(
        first,
        second,
        joint.values,
        delay=delay_periods(joint, loaders),
        uncouples=joint.after_breakout is AfterBreakout.UNCOUPLE,
        disconnect=None if scenario.disconnect_s is None else on_step(scenario.disconnect_s, step_s),
        jam=None if scenario.jam is None or jammed is None else (jammed, on_step(scenario.jam.at_s, step_s)),
    )
    names = {f"{side}_{name}": unit for side, of in zip(SIDES, units, strict=True) for name, unit in of.items()}
    names |= {named(name, unit) if unit != "N m" else f"{name}_n_m": unit for name, unit in _core.linked_outputs()}
    time = np.arange(len(rows)) * scenario.first.sample_s
    data = {name: ("time_s", row, {"units": unit}) for (name, unit), row in zip(names.items(), rows.T, strict=True)}
    whole = xr.Dataset(data, {"time_s": ("time_s", time, {"units": "s"})})
    measures = _measures(whole, loaders[0]["column.grip_arm"])
    history = whole.where(whole["time_s"] < measures.diverged_at_s)
    return LinkedRun(joint, loaders, laws, scenario, measures, history)


def _side(loader: Loader, scenario: Scenario, units: dict[str, str], law: Law) -> _Side:
    kinds = law.engine(loader)
    simulation = prepared(loader, scenario, range(len(units)), law)
    return simulation, loader.si_values, kinds.get("law"), kinds.get("gains"), kinds.get("observers")


def _measures(history: xr.Dataset, grip_arm: float) -> LinkMeasures:
    time = history["time_s"].to_numpy()
    values = {str(name): history[name].to_numpy() for name in history.data_vars}
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
        gave_way_at_s=_first(values["link_gives_way"][:until] > 0, time),
        diverged_at_s=_first(~known, time),
    )


def _late(values: NDArray[np.float64]) -> float:
    """The mean over the last tenth."""
    return float(np.mean(values[-max(len(values) // 10, 1) :])) if len(values) else float("nan")


def _first(when: NDArray[np.bool_], time: NDArray[np.float64]) -> float:
    return float(time[np.argmax(when)]) if when.any() else inf
