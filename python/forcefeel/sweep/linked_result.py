"""Run and result of a sweep over linked pairs."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf, isfinite, nan

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from forcefeel.conclusions import Conclusions, interval_text, of_result, share_text
from forcefeel.linked.engine import PairValues, link_measures, simulate_linked_batch
from forcefeel.linked.result import SIDES
from forcefeel.loader.links import AfterBreakout
from forcefeel.sweep.linked_plan import LinkedSweep
from forcefeel.sweep.summary import Share, Spread, chance_of, rank_correlations, share_of, spread_of
from forcefeel.threads import threads_or_cores
from forcefeel.units import ANGLE, FORCE, Unit, UnitSystem, to_text

LINKED_MEASURES: dict[str, tuple[str, Unit]] = {
    "peak_force_fight_n": ("force fight of the hands", FORCE),
    "largest_difference_rad": ("largest position difference", ANGLE),
    "final_difference_rad": ("position difference at the end", ANGLE),
    "peak_link_force_n": ("peak link force at the first grip", FORCE),
    "breakout_force_n": ("link force at the first grip as it gives way", FORCE),
    "swing_rad": ("swing beyond rest after the link opened", ANGLE),
}
"""Name and unit of each measure of a pair."""

HELD, GAVE_WAY, DIVERGED, IMPOSSIBLE = "held", "gave way", "diverged", "impossible"
STATUSES = (HELD, GAVE_WAY, DIVERGED, IMPOSSIBLE)

_CHUNK_BYTES = 200_000_000
"""Histories of the pairs that run at once."""

_SAME = 1e-6
"""Spread, as a share of the value, that is not mentioned."""

_LISTED = 3
"""Rows with the largest effect that are named."""


@dataclass(frozen=True, eq=False)
class LinkedSweepResult:
    """Every pair of a sweep.

    Attributes:
        sweep: The sweep.
        runs: Over ``run`` each varied row, each measure of ``LINKED_MEASURES`` in SI units, and the index of its status.
        nominal: The measures of the pair of the project.
        shares: Share of each status.
        spreads: Spread by measure, of the measures that any pair has.
        correlations: Spearman's rank correlations, as of ``Summary``.
        chance: As of ``Summary``.
    """

    sweep: LinkedSweep
    runs: xr.Dataset = field(repr=False)
    nominal: dict[str, float]
    shares: tuple[Share, ...]
    spreads: dict[str, Spread]
    correlations: xr.DataArray = field(repr=False)
    chance: float

    def share(self, status: str) -> Share:
        """The share of a status."""
        return self.shares[STATUSES.index(status)]

    def ranking(self, measure: str) -> list[tuple[str, float]]:
        """The rows with a significant correlation with a measure, the strongest first."""
        row = self.correlations.sel(measure=measure)
        pairs = zip(map(str, row["parameter"].values), map(float, row.values), strict=True)
        return sorted((pair for pair in pairs if abs(pair[1]) > self.chance), key=lambda pair: -abs(pair[1]))


def run_linked_sweep(
    sweep: LinkedSweep, *, threads: int | None = None, progress: Callable[[int, int], None] = lambda _done, _total: None
) -> LinkedSweepResult:
    """Run a sweep over linked pairs; its numbers depend on the sweep alone. All pairs have the same sensor noise.

    Args:
        sweep: The sweep.
        threads: Number of threads; default: all cores.
        progress: Called with the numbers of finished and of all runs.

    Raises:
        InputError: As ``simulate_linked_batch``.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> pushed = ff.linked.LinkedScenario(ff.Scenario(ff.Step("20 lb"), 0.5))
        >>> found = ff.sweep.run_linked_sweep(ff.sweep.LinkedSweep(project, "pitch", pushed, ("robust", "robust"), runs=16))
        >>> found.share("held").runs
        16
    """
    threads = threads_or_cores(threads)
    scenario = sweep.scenario.first
    samples = round(scenario.duration_s / scenario.sample_s) + 1
    size = max(threads, _CHUNK_BYTES // (8 * 10 * samples))
    measured, statuses = [], []
    progress(0, sweep.runs)
    for first in range(0, sweep.runs, size):
        runs = range(first, min(first + size, sweep.runs))
        values, failed = sweep.values(runs)
        rows, status = _measured(sweep, values, threads)
        rows[failed], status[failed] = nan, STATUSES.index(IMPOSSIBLE)
        measured.append(rows)
        statuses.append(status)
        progress(runs.stop, sweep.runs)
    table, status = np.vstack(measured), np.concatenate(statuses)
    columns = sweep.drawn(range(sweep.runs)) | dict(zip(LINKED_MEASURES, table.T, strict=True))
    data = xr.Dataset({name: ("run", column) for name, column in columns.items()} | {"status": ("run", status)})
    nominal = dict(zip(LINKED_MEASURES, _measured(sweep, sweep.nominal, 1)[0][0].tolist(), strict=True))
    finite = {name: column[np.isfinite(column)] for name, column in zip(LINKED_MEASURES, table.T, strict=True)}
    spreads = {
        name: spread_of(name, finite[name], nominal[name], unit)
        for name, (_, unit) in LINKED_MEASURES.items()
        if len(finite[name])
    }
    counts = [int(np.count_nonzero(status == k)) for k in range(len(STATUSES))]
    return LinkedSweepResult(
        sweep,
        data,
        nominal,
        tuple(share_of(name, count, sweep.runs, True) for name, count in zip(STATUSES, counts, strict=True)),
        spreads,
        rank_correlations(data, list(spreads), list(sweep.varied)),
        chance_of(sweep.runs),
    )


def _measured(sweep: LinkedSweep, values: PairValues, threads: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The measures of some pairs, a row each, and the index of each status."""
    data = simulate_linked_batch(
        sweep.project, sweep.link, sweep.scenario, values, sweep.designed, keep=("column_angle_rad",), threads=threads
    )
    time = data["time_s"].to_numpy()
    columns = {str(name): data[name].to_numpy() for name in data.data_vars}
    grip_arm = sweep.loaders[0]["column.grip_arm"]
    rows = np.full((len(values.first), len(LINKED_MEASURES)), nan)
    status = np.zeros(len(rows), dtype=np.int64)
    for k, row in enumerate(rows):
        history = {name: column[k] for name, column in columns.items()}
        measures = link_measures(time, history, grip_arm)
        by_itself = measures.gave_way_at_s < (sweep.scenario.disconnect_s or inf)
        if isfinite(measures.diverged_at_s):
            status[k] = STATUSES.index(DIVERGED)
            continue
        status[k] = STATUSES.index(GAVE_WAY if by_itself else HELD)
        opens = by_itself and sweep.joint.after_breakout is AfterBreakout.UNCOUPLE
        opened = measures.gave_way_at_s if opens else sweep.scenario.disconnect_s
        at = int(np.searchsorted(time, measures.gave_way_at_s)) if by_itself else None
        row[:] = (
            measures.peak_force_fight_n,
            measures.largest_difference_rad,
            measures.final_difference_rad,
            measures.peak_link_force_n,
            # One that uncouples has no torque any more.
            nan
            if at is None
            else float(np.abs(history["first_link_torque_n_m"][max(at - 1, 0) : at + 1]).max()) / grip_arm,
            nan if opened is None else _swing(time >= opened, history),
        )
    return rows, status


def _swing(after: NDArray[np.bool_], history: dict[str, NDArray[np.float64]]) -> float:
    """Largest angle of a column beyond where it comes to rest, after the link opened."""
    swings = []
    for side in SIDES:
        angle = history[f"{side}_column_angle_rad"]
        end = float(np.mean(angle[-max(len(angle) // 10, 1) :]))
        swings.append(float(np.max(np.sign(end) * angle[after], initial=0.0)) - abs(end))
    return max(*swings, 0.0)


@of_result
def linked_sweep_conclusions(result: LinkedSweepResult, units: UnitSystem) -> Conclusions:
    """The conclusions, with numbers in ``units``."""
    ended = [f"{row.status} {share_text(row.share)}" for row in result.shares if row.runs]
    diverged = result.share(DIVERGED)
    verdict = f"{result.sweep.runs:,} pairs: the link {', '.join(ended)}."
    sentences = []
    for name, spread in result.spreads.items():
        if spread.highest - spread.lowest <= _SAME * abs(spread.highest):
            continue
        low, high = (_text(name, spread.quantile(share), units) for share in (0.05, 0.95))
        ranking = [f"{key} ({rho:+.2f})" for key, rho in result.ranking(name)[:_LISTED]]
        influence = f" Largest effects: {', '.join(ranking)}." if ranking else ""
        sentences.append(f"{LINKED_MEASURES[name][0].capitalize()}, nine of ten pairs: {low} to {high}.{influence}")
    if diverged.runs:
        interval = interval_text(diverged.low, diverged.high)
        sentences.insert(0, f"{diverged.runs:,} pairs diverged; of all such pairs {interval} do.")
    assumed = [key for key in result.sweep.varied if key.startswith("link.") and key not in result.sweep.vary]
    if assumed:
        sentences.append(f"Assumed: 20 % to either side of {', '.join(assumed)}. Change it with --vary.")
    return Conclusions(not diverged.runs, verdict, tuple(sentences))


def _text(name: str, value: float, units: UnitSystem) -> str:
    unit = LINKED_MEASURES[name][1]
    return f"{to_text(unit.from_si(value, units), 3)} {unit.shown(units)}"
