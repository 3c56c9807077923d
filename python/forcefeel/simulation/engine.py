"""Runs of the Rust engine, single or in batches."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel.errors import InputError, expect
from forcefeel.laws.law import Law, LawLike
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import TABLE
from forcefeel.simulation import linear
from forcefeel.simulation.noisy_loop import angle_noise_rad
from forcefeel.simulation.outcome import (
    MOST_HISTORY_BYTES,
    Run,
    RunStatus,
    as_measures,
    history,
    measures_of,
    outputs,
    statuses,
    without_diverged,
)
from forcefeel.simulation.scenario import Scenario, Steps
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.threads import threads_or_cores

if TYPE_CHECKING:
    import xarray as xr

_SINGLE = 1


def simulate(loader: Loader, scenario: Scenario, law: LawLike = None) -> Run:
    """Runs a loader through a scenario.

    Args:
        loader: The loader with its optional effects.
        scenario: The inputs. The run begins at rest: hands off, under the first value of a recorded force, or held at the
            angle of a release.
        law: The law, its name or its file, as for ``Law.of``. Default: the original position loop, eq. (13).

    Returns:
        The run. A loader without optional rows is linear, and its run is exact at the samples. Other loaders are stepped, with
        an error of about 1e-5 of full travel at steps of 1 ms; so are loaders whose matrices are too ill-conditioned for an
        equilibrium. Peaks of an exact run are those of its samples.

    Raises:
        InputError: If a time is not on a step, a required input is missing, or a sampled law was designed for another
            controller.

    Example:
        >>> run = ff.simulate(ff.digital_elevator(), ff.Scenario(ff.Step(100.0), duration_s=3.0), "robust")
        >>> run.status.value
        'settled'
    """
    expect("scenario", scenario, Scenario, "a Scenario, such as Scenario(Step(100.0))")
    law = Law.of(law, loader)
    units = outputs(law.numbers.displacement_unit, loader.drive)
    exact = _exact(loader, law, scenario)
    noise = 0.0 if exact else _angle_noise_rad(loader, law)
    values, measured = exact or _stepped(loader, law, scenario, len(units), noise)
    status = RunStatus(statuses(measured[np.newaxis])[0])
    measures = as_measures(loader.drive, without_diverged(measured[np.newaxis])[0].tolist())
    values = _cut(values, scenario.sample_s, measures.diverged_at_s)
    about = {"loader": loader.name, "status": str(status)}
    return Run(
        loader=loader,
        scenario=scenario,
        status=status,
        measures=measures,
        outputs=history(values, units, scenario.sample_s, about),
        method="exact" if exact else "stepped",
        angle_noise_rad=noise,
        law_remark=law.made_for_another(loader),
    )


def _exact(loader: Loader, law: Law, scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Outputs and measures of the linear model; ``None`` if it does not apply, or rounding leaves no equilibrium."""
    if law.numbers.by_machine or not linear.applies(loader, scenario):
        return None
    try:
        return linear.run(loader, law.numbers.gain_law(loader), scenario)
    except np.linalg.LinAlgError:
        return None


def _stepped(
    loader: Loader, law: Law, scenario: Scenario, outputs: int, noise: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Outputs and measures of the engine."""
    engine = prepared(loader, scenario, range(outputs), law)
    measured, histories = engine.run(
        loader.si_values[np.newaxis], **law.engine(loader), seed=scenario.seed, angle_noise=noise, threads=_SINGLE
    )
    return histories[0], measured[0]


def _angle_noise_rad(loader: Loader, law: Law) -> float:
    """R.m.s. column angle caused by sensor noise, the smallest measurable swing; zero if each run has its own law."""
    return 0.0 if law.numbers.by_machine or law.numbers.settings > 1 else angle_noise_rad(loader, law)


def simulate_batch(
    loader: Loader,
    scenario: Scenario,
    values: NDArray[np.float64],
    law: LawLike = None,
    *,
    keep: Sequence[str] = (),
    first_run: int | None = 0,
    threads: int | None = None,
) -> "xr.Dataset":
    """Runs many loaders through one scenario, side by side in vector lanes, on all cores.

    Args:
        loader: The nominal loader; its curves, controller and force apply to all runs.
        scenario: The inputs of each run.
        values: SI values, one row per run in the order of ``parameters.TABLE``; ``pilot.force`` scales the scenario's force.
        law: The law, as for ``Law.of``: one for all, or one for each run (gains c_1 .. c_7 (runs, 7), or a sampled
            law). Default: the original position loop with the parameters of each run.
        keep: Names of outputs whose histories are kept, such as ``column_angle_rad``.
        first_run: Index of the first run, for the noise; a batch in parts returns the same numbers. ``None`` gives all runs the
            noise of run 0, so that they differ by their values alone; it takes a quarter less time.
        threads: Number of threads. Default: all cores. The numbers do not depend on it.

    Returns:
        Over ``run``: every measure of ``Measures``, ``status``, and the requested histories over ``time_s``. With one law for
        all, measures exclude swings below the sensor noise of the nominal loader.

    Raises:
        InputError: As ``simulate``; if values have the wrong shape, vary a shared row, or the histories are too large.

    Example:
        >>> loader = ff.elevator()
        >>> runs = ff.simulation.simulate_batch(loader, ff.Scenario(ff.Step(100.0), 0.5), np.tile(loader.si_values, (3, 1)))
        >>> runs.sizes["run"]
        3
    """
    return batch_outputs(loader, scenario, values, law, keep=keep, first_run=first_run, threads=threads).dataset


def batch_outputs(
    loader: Loader,
    scenario: Scenario,
    values: NDArray[np.float64],
    law: LawLike = None,
    *,
    keep: Sequence[str] = (),
    first_run: int | None = 0,
    threads: int | None = None,
) -> LabeledArrays:
    """What ``simulate_batch`` makes its data set of; the same arguments."""
    check_loader(loader)
    expect("scenario", scenario, Scenario, "a Scenario, such as Scenario(Step(100.0))")
    values = np.ascontiguousarray(values, dtype=np.float64)
    _check(loader, values)
    law = Law.of(law, loader)
    units = outputs(law.numbers.displacement_unit, loader.drive)
    for name in keep:
        if name not in units:
            raise InputError(f"keep: expected names of outputs ({', '.join(units)}), got {name!r}")
    order = list(units)
    engine = prepared(loader, scenario, [order.index(name) for name in keep], law)
    samples = round(scenario.duration_s / scenario.sample_s) + 1
    if len(values) * len(keep) * samples * 8 > MOST_HISTORY_BYTES:
        raise InputError(
            f"keep: histories of {len(values)} runs take more than {MOST_HISTORY_BYTES >> 30} GiB; keep fewer outputs or none"
        )
    measured, histories = engine.run(
        values,
        **law.engine(loader),
        force_scale=values[:, list(TABLE).index("pilot.force")] / loader["pilot.force"],
        seed=scenario.seed,
        first_run=first_run,
        angle_noise=_angle_noise_rad(loader, law),
        threads=threads_or_cores(threads),
    )
    status = statuses(measured)
    measured = without_diverged(measured)
    data: dict[str, Any] = {
        name: ("run", measured[:, k], {"units": unit})
        for k, (name, unit) in enumerate(measures_of(loader.drive).items())
    }
    data["status"] = ("run", status, {})
    coordinates: dict[str, Any] = {"run": np.arange(len(values)) + (first_run or 0)}
    if keep:
        coordinates["time_s"] = ("time_s", np.arange(samples) * scenario.sample_s, {"units": "s"})
        for k, name in enumerate(keep):
            cut = _cut_all(histories[:, k], scenario.sample_s, measured[:, -1])
            data[name] = (("run", "time_s"), cut, {"units": units[name]})
    return LabeledArrays(data, coordinates, {"loader": loader.name})


def prepared(loader: Loader, scenario: Scenario, keep: Sequence[int] = (), law: Law | None = None) -> _core.Simulation:
    """The engine for a scenario; ``law`` is the initial law, before the scenario's changes."""
    steps = Steps.of(scenario, loader)
    return _core.Simulation(
        steps.inputs,
        steps.step_s,
        every=steps.every,
        outputs=list(keep),
        start_force=steps.start_force_n,
        held=steps.held,
        timing=steps.timing,
        curve=loader.force_curve.arrays if loader.force_curve else None,
        cancellation=None if law is None or law.cancellation is None else law.cancellation.numbers,
        changes=engine_changes(loader, scenario, steps, law),
    )


def engine_changes(
    loader: Loader, scenario: Scenario, steps: Steps, law: Law | None
) -> list[tuple[int, int, NDArray[np.float64], NDArray[np.float64] | None]]:
    """The changes of the feel: first step, last step, values and law afterwards."""
    return [
        (*change, None if law is None else _next_law(loader, law, feel_change.law))
        for change, feel_change in zip(steps.changes, scenario.feel_changes, strict=True)
    ]


def _next_law(loader: Loader, law: Law, following: LawLike) -> NDArray[np.float64] | None:
    """The law after a change of the feel, for the engine."""
    if following is None:
        return None
    after = Law.of(following, loader).sampled
    if law.sampled is None or after is None:
        raise InputError("feel change: a sampled law can only follow a sampled law; use one as the law of the run")
    if (after.settings, after.states) != (1, law.sampled.states):
        raise InputError(
            f"feel change: expected one law of {law.sampled.states} states, as before, got {after.settings} laws of "
            f"{after.states}"
        )
    row: NDArray[np.float64] = after.rows()[0]
    return row


SHARED = ("valve.orifice", "controller.period", "controller.delay", "feel.shaker_frequency")
"""Rows that all runs of a batch share."""


def _check(loader: Loader, values: NDArray[np.float64]) -> None:
    if values.ndim != 2 or values.shape[1] != len(TABLE) or not len(values):
        raise InputError(f"values: expected a row of {len(TABLE)} values for each run, got shape {values.shape}")
    keys = list(TABLE)
    for key in SHARED:
        if np.any(values[:, keys.index(key)] != loader[key]):
            raise InputError(f"{key}: is the same for all runs of a batch; run a batch for each value")


def _cut(values: NDArray[np.float64], sample_s: float, diverged_at_s: float) -> NDArray[np.float64]:
    """The outputs of a run, NaN from its divergence on."""
    return _cut_all(values, sample_s, np.full(len(values), diverged_at_s))


def _cut_all(values: NDArray[np.float64], sample_s: float, diverged_at_s: NDArray[np.float64]) -> NDArray[np.float64]:
    gone = np.isfinite(diverged_at_s)
    if np.any(gone):
        time = np.arange(values.shape[1]) * sample_s
        values[gone] = np.where(time < diverged_at_s[gone, np.newaxis], values[gone], np.nan)
    return values
