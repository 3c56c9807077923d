"""Linear runs of loaders without optional rows, single or in batches, exact at the samples."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from forcefeel import _core
from forcefeel._core import GainLaw
from forcefeel.errors import InputError
from forcefeel.laws.analog.gains import analog
from forcefeel.linear.models import LinearModel, Linkage, loader_model
from forcefeel.linear.step import equilibrium, transition
from forcefeel.loader.loader import Loader, check_hydraulic
from forcefeel.loader.parameters import INDEX, OFF, TABLE
from forcefeel.simulation.outcome import MOST_HISTORY_BYTES, outputs
from forcefeel.simulation.scenario import Scenario, Steps, on_samples
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.threads import threads_or_cores

if TYPE_CHECKING:
    import xarray as xr


def applies(loader: Loader, scenario: Scenario) -> bool:
    """Whether the linear model applies: no optional rows, and no input other than the pilot's force."""
    others = (
        scenario.trim_rad,
        scenario.dynamic_pressure_pa,
        scenario.flight,
        scenario.shaker,
        scenario.test_signal_v,
        scenario.command_signal_v,
        scenario.feel_changes or None,
    )
    return not loader.given and not loader.curves and all(other is None for other in others)


_ANGLE = "column_angle_rad"

STABLE, STABLE_BY_POLES = 1, 3
"""Verdicts of the stability kernel that say stable: proved, and by computed poles."""


def run(loader: Loader, law: GainLaw, scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Outputs (outputs, samples) and measures of the run.

    ``x_{k+1} = Phi x_k + Gamma_0 u_k + Gamma_1 (u_{k+1} - u_k)`` with the exponential of the model's matrices, exact for a force
    that changes evenly within each step.

    Raises:
        numpy.linalg.LinAlgError: If the run begins at rest under a force, and rounding leaves no equilibrium.
    """
    model = loader_model(loader, law, Linkage.COMPLIANT)
    steps = Steps.of(on_samples(scenario), loader)
    force = steps.inputs["force"].copy()
    phi, level, ramp = transition(np.asarray(model.A), np.asarray(model.B)[:, 0], steps.step_s)
    start = np.zeros(len(phi))
    angle, until = steps.held or (0.0, 0)
    if steps.held or steps.start_force_n:
        per_force = equilibrium(model)
        hand = angle / float(np.asarray(model.C)[0] @ per_force)
        start = per_force * (hand + steps.start_force_n)
        force[:until] += hand
    with np.errstate(over="ignore", invalid="ignore"):
        by_force = np.outer(force[:, 0], level) + np.outer(force[:, 1] - force[:, 0], ramp)
        states = _core.propagated(phi, start, by_force)
        pilot_force = np.append(force[:, 0], force[-1, 1])
        outputs = _outputs(model, states, pilot_force)
    samples, rest = outputs[:, :: steps.every], _angle_under(model, force[-1, 1])
    return samples, _core.simulation_measure(samples, scenario.sample_s, rest, free=-(-until // steps.every))


def _angle_under(model: LinearModel, force: float) -> float:
    """Column angle in rad at rest under a force in N; NaN where rounding leaves no equilibrium."""
    if force == 0:
        return 0.0
    try:
        return force * float(np.asarray(model.C)[0] @ equilibrium(model))
    except np.linalg.LinAlgError:
        return np.nan


def simulate_linear_batch(
    loader: Loader,
    scenario: Scenario,
    values: NDArray[np.float64],
    law: GainLaw | NDArray[np.float64] | None = None,
    *,
    keep: Sequence[str] = (_ANGLE,),
    threads: int | None = None,
) -> "xr.Dataset":
    """Runs many loaders of the linear model, eq. (17), through one scenario, exact at the samples.

    ``x_{k+1} = Phi x_k + Gamma_0 u_k + Gamma_1 (u_{k+1} - u_k)`` with ``Phi = exp(A h)`` of each run's own matrix: exact for a
    force that changes evenly within each step, as ``control.forced_response`` takes it. Eight runs stand side by side in
    vector lanes, on all cores.

    Args:
        loader: A loader without optional rows, as all runs are.
        scenario: The inputs of each run: a force or a release only.
        values: SI values, one row per run in the order of ``parameters.TABLE``; ``pilot.force`` scales the scenario's force.
        law: One law for all, or state-feedback gains c_1 .. c_7 (runs, 7). Not given, each run has the original
            position loop, eq. (13), of its own parameters.
        keep: Names of the outputs whose histories are kept.
        threads: Number of threads. Default: all cores. The numbers do not depend on it.

    Returns:
        Over ``run`` and ``time_s``: the outputs in ``keep``, SI units, and ``diverged_at_s``: when the column of an unstable loop
        left 10 rad, from where on its outputs are not numbers; infinite for all others.

    Raises:
        InputError: If the loader or the scenario is not linear, values have the wrong shape or vary an optional row, an output
            is unknown, a time does not fall on a step, or the histories are too large.

    Source:
        C. F. Van Loan, Computing integrals involving the matrix exponential, 1978.

    Example:
        >>> loader = ff.elevator()
        >>> runs = ff.simulation.simulate_linear_batch(loader, ff.Scenario(ff.Step(100.0), 0.5), np.tile(loader.si_values, (3, 1)))
        >>> runs.column_angle_rad.shape
        (3, 501)
    """
    check_hydraulic(
        loader, "the linear batch of eq. (17)", "simulate_batch runs motors, and step_response their linear model"
    )
    values = np.ascontiguousarray(values, dtype=np.float64)
    numbers = analog(law)
    units = outputs(numbers.displacement_unit)
    columns = _check(loader, scenario, values, law)
    for name in keep:
        if name not in units:
            raise InputError(f"keep: expected names of outputs ({', '.join(units)}), got {name!r}")
    steps = Steps.of(on_samples(scenario), loader)
    shape = (len(values), len(keep), len(steps.inputs["force"]) // steps.every + 1)
    if 8 * np.prod(shape) > MOST_HISTORY_BYTES:
        raise InputError(
            f"keep: histories of {len(values)} runs take more than {MOST_HISTORY_BYTES >> 30} GiB; run fewer at a time"
        )
    threads = threads_or_cores(threads)
    force, force_scale = (
        steps.inputs["force"],
        values[:, INDEX["pilot.force"]] / loader["pilot.force"],
    )

    def histories_of(runs: slice | NDArray[np.intp], names: Sequence[str]) -> NDArray[np.float64]:
        some = values[runs]
        histories = np.empty((len(some), len(names), shape[2]))
        _core.Loops(loader.si_values, columns, some[:, columns], **numbers.some(runs).engine()).run(
            histories,
            force,
            steps.step_s,
            every=steps.every,
            outputs=[list(units).index(name) for name in names],
            force_scale=force_scale[runs],
            start_force=steps.start_force_n,
            held=steps.held,
            threads=threads,
        )
        return histories

    histories = histories_of(slice(None), keep)
    verdicts = _core.Loops(loader.si_values, columns, values[:, columns], **numbers.engine()).stability(threads)
    unstable = np.flatnonzero((verdicts != STABLE) & (verdicts != STABLE_BY_POLES))
    diverged_at_s = np.full(len(values), np.inf)
    if len(unstable):
        kept = _ANGLE in keep
        angle = histories[unstable, keep.index(_ANGLE)] if kept else histories_of(unstable, [_ANGLE])[:, 0]
        beyond = ~(np.abs(angle) < _core.BOUND_RAD)
        first = np.where(beyond.any(axis=1), beyond.argmax(axis=1) * scenario.sample_s, np.inf)
        diverged_at_s[unstable] = first
        gone = np.arange(shape[2]) * scenario.sample_s >= first[:, np.newaxis]
        histories[unstable] = np.where(gone[:, np.newaxis], np.nan, histories[unstable])
    time = ("time_s", np.arange(shape[2]) * scenario.sample_s, {"units": "s"})
    coordinates: dict[str, Any] = {"run": np.arange(len(values)), "time_s": time}
    data: dict[str, Any] = {
        name: (("run", "time_s"), histories[:, k], {"units": units[name]}) for k, name in enumerate(keep)
    }
    data["diverged_at_s"] = ("run", diverged_at_s, {"units": "s"})
    return LabeledArrays(data, coordinates, {"loader": loader.name}).dataset


def _check(
    loader: Loader, scenario: Scenario, values: NDArray[np.float64], law: GainLaw | NDArray[np.float64] | None
) -> list[int]:
    """The columns in which the runs differ from the loader."""
    if not applies(loader, scenario):
        raise InputError("loader, scenario: expected no optional rows and nothing but a force; use simulate_batch")
    if values.ndim != 2 or values.shape[1] != len(TABLE) or not len(values):
        raise InputError(f"values: expected a row of {len(TABLE)} values for each run, got shape {values.shape}")
    if isinstance(law, np.ndarray) and law.shape != (len(values), 7):
        raise InputError(f"law: expected gains of shape ({len(values)}, 7), got {law.shape}")
    varied = np.flatnonzero(np.any(values != loader.si_values, axis=0))
    for key in OFF:
        if INDEX[key] in varied:
            raise InputError(f"values: {key} is no part of the linear model; use simulate_batch")
    if not np.all(np.isfinite(values[:, varied])):
        raise InputError("values: expected finite numbers")
    return [int(column) for column in varied]


def _outputs(model: LinearModel, states: NDArray[np.float64], force: NDArray[np.float64]) -> NDArray[np.float64]:
    """The engine's outputs, in its order, from the model's."""
    c, d = np.asarray(model.C), np.asarray(model.D)[:, :1]
    signals = dict(zip(model.output_labels, c @ states.T + d * force, strict=True))
    signals |= dict(zip(model.state_labels, states.T, strict=True)) | {"pilot_force_n": force}
    per_base = c[0, model.state_labels.index("base_position_m")]
    signals["column_velocity_rad_per_s"] = per_base * signals["base_velocity_m_per_s"]
    return np.array([signals[_signal(name, signals)] for name, _ in _core.simulation_outputs()])


def _signal(name: str, signals: dict[str, NDArray[np.float64]]) -> str:
    """The model's name, which ends with the unit, of an output of the engine."""
    return next(signal for signal in signals if signal.startswith(name))
