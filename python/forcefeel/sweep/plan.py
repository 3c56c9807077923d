"""Plan of a sweep: loader, scenario, varied parameters and number of runs. It determines the values of every run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import prod
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError, expect
from forcefeel.laws.analog.recursion import DesignSettings
from forcefeel.laws.law import Law, LawLike, check_given
from forcefeel.loader.consistency import without_effect
from forcefeel.loader.loader import FEEL_SETTING, Loader, check_loader
from forcefeel.loader.parameters import INDEX, TABLE
from forcefeel.loader.tolerances import Tolerance, beyond
from forcefeel.seeded_numbers import shares
from forcefeel.simulation import Scenario
from forcefeel.simulation.scenario import LARGEST_SEED, Steps
from forcefeel.sweep import text
from forcefeel.threads import LANES
from forcefeel.units import show

MOST_RUNS = 10_000_000
"""Largest number of runs: their results take some 4 GB of disk."""

MONTE_CARLO_RUNS = 10_000
"""Default number of runs over tolerances: a share of 1 % is then known to a fifth of it."""

_CHUNK_STEPS = 30_000_000
"""Steps of the engine in a chunk, about a second of work for a core."""

_CHUNK_RUNS = 2**15
"""Most runs in a chunk: its rows and their copies in the engine take some 100 MB."""

_CHUNKS = 16
"""Least number of chunks, for progress."""

_MOST_AXES = 2

_GEOMETRY = ("linkage.ratio", "column.base_arm")
"""Rows that the engine needs for the torque input of the feel if gains differ between runs."""


@dataclass(frozen=True, eq=False)
class Sweep:
    """A sweep: machines drawn from tolerances (Monte Carlo), a grid over settings, or such machines at each of its points.

    The numbers of a machine depend on the seed, the parameter and the machine's index alone (``seeded_numbers``). At every
    point of a grid stand the same machines, so that what differs between points is the setting.

    Attributes:
        loader: The nominal loader; its tolerances say how the machines differ.
        scenario: Scenario of each run.
        law: One law for all; not given, each has the original position loop of its own parameters. With
            ``DesignSettings`` the gains are designed anew for each setting I, B, G that the sweep gives the feel, by these
            settings and for the nominal machine: whatever else varies meets the law of its feel.
        runs: Machines; with ``grids`` machines at each point, and not given the nominal one alone. Without ``grids`` 10,000
            if not given.
        seed: Seed of the draw, 0 or more. The noise of sensors has its own, in the scenario.
        vary: Tolerances by ``part.name`` beside those of the loader, or in their place: as ``Loader.with_tolerances`` takes
            them, or ``"1 lb..5 lb"`` for uniform between these; ``None`` keeps the loader's value.
        grids: One or two parameters by ``part.name`` with their values: SI numbers, or text such as
            ``"288..28800 lb in/rad:40:log"``. Such a parameter has no tolerance.

    Raises:
        InputError: If a parameter is unknown, shared by all runs, out of its range or both varied and a grid; if nothing
            varies; if the scenario does not go with the loader.

    Example:
        >>> sweep = ff.Sweep(ff.elevator(), ff.Scenario(ff.Step(100.0), 0.5), vary={"linkage.stiffness": "10 %"}, runs=32)
        >>> sweep.total
        32
    """

    loader: Loader
    scenario: Scenario
    law: LawLike = None
    runs: int | None = None
    seed: int = 0
    vary: Mapping[str, Any] = field(default_factory=dict)
    grids: Mapping[str, str | Sequence[float]] = field(default_factory=dict)
    varied: Mapping[str, Tolerance] = field(init=False)
    axes: Mapping[str, tuple[float, ...]] = field(init=False)
    steps: int = field(init=False)

    def __post_init__(self) -> None:
        check_loader(self.loader)
        expect("scenario", self.scenario, Scenario, "a Scenario, such as Scenario(Step(100.0))")
        check_given(self.law)
        expect("vary", self.vary, Mapping, 'tolerances by part.name such as {"linkage.stiffness": "20 %"}')
        expect("grids", self.grids, Mapping, 'values by part.name such as {"feel.stiffness": "300..900 N m/rad:20"}')
        if self.runs is not None:
            check_whole("runs", self.runs, 1, MOST_RUNS)
        check_whole("seed", self.seed, 0, LARGEST_SEED)
        axes = {key: _axis(key, values) for key, values in self.grids.items()}
        if len(axes) > _MOST_AXES:
            remedy = "vary the others, --vary and --runs"
            raise InputError(f"grid: expected one or two parameters, got {len(axes)}; {remedy}")
        for key in axes:
            if key in self.vary:
                raise InputError(f"{key}: given as a grid and to vary; leave one out")
        if self.vary and axes and self.runs is None:
            raise InputError("vary: at a grid say how many machines stand at each point (--runs), or leave it out")
        drawn = loader_tolerances(self.loader, self.vary) if not axes or self.runs is not None else {}
        varied = {key: values for key, values in drawn.items() if key not in axes}
        object.__setattr__(self, "axes", MappingProxyType(axes))
        object.__setattr__(self, "varied", MappingProxyType(varied))
        if wrong := [*beyond(varied), *_without_effect(self.loader, axes)]:
            raise InputError("\n".join(wrong))
        self._check_varied()
        self._check_design()
        self._check_scenario()

    def _check_varied(self) -> None:
        """Refuse a sweep without variation, or with too many runs."""
        if not self.varied and not self.axes:
            raise InputError(
                f"nothing varies: {self.loader.name} has no tolerances; add a section [tolerances] to the loader file, or "
                'say what varies, such as --vary "linkage.stiffness=20 %" or --grid "feel.stiffness=1000..9000 lb in/rad:20"'
            )
        if self.runs is not None and not self.varied:
            same = "no tolerances, so all machines at a point are the same"
            raise InputError(f"runs: {same}; leave --runs out, or add --vary")
        if self.total > MOST_RUNS:
            expected = f"at most {MOST_RUNS:,} in all, got {self.total:,}"
            raise InputError(f"runs: expected {expected}; take fewer at each point")

    def _check_design(self) -> None:
        """Refuse redesign if the law would not change, or would not fit the machine's geometry."""
        if not isinstance(self.law, DesignSettings):
            return
        changed = {*self.axes, *self.varied}
        if changed.isdisjoint(FEEL_SETTING):
            rows = ", ".join(FEEL_SETTING)
            raise InputError(
                f"law: to be designed for each setting of the feel, but none of {rows} varies; give one law, or leave "
                "--redesign out"
            )
        if geometry := [key for key in _GEOMETRY if key in changed]:
            raise InputError(
                f"law: designed for each setting it takes {geometry[0]} from each machine, where the nominal one is meant; "
                f"keep that as it is, such as --vary {geometry[0]}=none"
            )
        self.law_of(self.loader.si_values[np.newaxis])  # an impossible design is refused now

    def _check_scenario(self) -> None:
        if self.scenario.feel_changes and any(key.startswith("feel.") for key in (*self.axes, *self.varied)):
            raise InputError(
                "feel_changes: give every machine the nominal feel; leave them out, or vary no row of the feel"
            )
        object.__setattr__(self, "steps", len(Steps.of(self.scenario, self.loader).inputs))

    def __reduce__(self) -> tuple[type["Sweep"], tuple[Any, ...]]:
        # A law's file may be missing where the chunks are computed.
        law = self._one_law if isinstance(self.law, str | Path) else self.law
        arguments = (self.loader, self.scenario, law, self.runs, self.seed)
        return Sweep, (*arguments, dict(self.vary), dict(self.axes))

    def law_of(self, values: NDArray[np.float64]) -> Law:
        """The law of machines with these values (SI, a row each)."""
        if not isinstance(self.law, DesignSettings):
            return self._one_law
        feel = values[:, [INDEX[key] for key in FEEL_SETTING]]
        settings, index = np.unique(feel, axis=0, return_inverse=True)
        return Law.of(self.law, self.loader, settings).some(index)

    @cached_property
    def _one_law(self) -> Law:
        """The law of all machines, designed or read once."""
        return Law.of(self.law, self.loader)

    @property
    def redesigned(self) -> bool:
        """Whether each setting of the feel has a law of its own."""
        return isinstance(self.law, DesignSettings)

    @cached_property
    def nominal_law(self) -> Law:
        """The law of the nominal loader."""
        return self.law_of(self.loader.si_values[np.newaxis]).single(self.loader)

    @property
    def machines(self) -> int:
        """Runs at each point of the grid, or all runs without a grid."""
        return 1 if not self.varied else self.runs or MONTE_CARLO_RUNS

    @property
    def shape(self) -> tuple[int, ...]:
        """Values along each parameter of the grid."""
        return tuple(map(len, self.axes.values()))

    @property
    def total(self) -> int:
        """Runs in all."""
        return prod(self.shape) * self.machines

    @cached_property
    def chunks(self) -> tuple[range, ...]:
        """The runs in chunks, each computed and stored whole."""
        size = max(LANES, min(_CHUNK_STEPS // self.steps, _CHUNK_RUNS, -(-self.total // _CHUNKS)))
        size = -(-size // LANES) * LANES
        return tuple(range(first, min(first + size, self.total)) for first in range(0, self.total, size))

    def drawn(self, runs: range) -> dict[str, NDArray[np.float64]]:
        """The varied SI values in some runs: grid parameters, then those with a tolerance."""
        columns: dict[str, NDArray[np.float64]] = {}
        points = np.arange(runs.start, runs.stop) // self.machines
        for (key, values), places in zip(self.axes.items(), _unravel(points, self.shape), strict=True):
            columns[key] = np.array(values)[places]
        for key, tolerance in self.varied.items():
            columns[key] = tolerance.quantile(
                self._of_machines(lambda *span, key=key: shares(self.seed, key, *span), runs)
            )
        return columns

    def values(self, runs: range) -> NDArray[np.float64]:
        """The SI values of all parameters, a row for each of some runs."""
        rows = np.repeat(self.loader.si_values[np.newaxis], len(runs), axis=0)
        for key, column in self.drawn(runs).items():
            rows[:, INDEX[key]] = column
        return rows

    def _of_machines(self, draw: Callable[[int, int], NDArray[np.float64]], runs: range) -> NDArray[np.float64]:
        """The result of ``draw(first, count)`` for the machines of some runs, the same at each point."""
        if len(runs) >= self.machines:
            return draw(0, self.machines)[np.arange(runs.start, runs.stop) % self.machines]
        first = runs.start % self.machines
        head = min(len(runs), self.machines - first)
        return np.concatenate([draw(first, head), draw(0, len(runs) - head)])


def _unravel(points: NDArray[np.int64], shape: tuple[int, ...]) -> tuple[NDArray[np.int64], ...]:
    return tuple(np.unravel_index(points, shape)) if shape else ()


def check_whole(name: str, value: object, least: int, most: int) -> None:
    """Refuse what is no whole number from ``least`` to ``most``."""
    if not isinstance(value, int) or isinstance(value, bool) or not least <= value <= most:
        raise InputError(f"{name}: expected a whole number from {least:,} to {most:,}, got {show(value)}")


def _axis(key: str, spec: str | Sequence[float]) -> tuple[float, ...]:
    """The values (SI) of a grid's parameter."""
    try:
        text.check_key(key)
        if isinstance(spec, str):
            return text.grid(key, spec)
        values = tuple(map(float, spec))
        for value in values:
            text.check_in_range(key, value)
    except InputError as error:
        raise InputError(f"grid: {error}") from error
    except (TypeError, ValueError) as error:
        raise InputError(f"grid: {key}: expected text or numbers, got {show(spec)}") from error
    if not 2 <= len(values) <= text.MOST_STEPS or list(values) != sorted(set(values)):
        raise InputError(f"grid: {key}: expected 2 to {text.MOST_STEPS:,} rising values, got {len(values)}")
    return values


def _without_effect(loader: Loader, axes: Mapping[str, tuple[float, ...]]) -> list[str]:
    """A line for each parameter of a grid without effect on its own."""
    values = {key: loader[key] for key in TABLE} | {key: axis[-1] for key, axis in axes.items()}
    return [f"grid: {line}" for key, line in without_effect(values).items() if key in axes]


def loader_tolerances(loader: Loader, vary: Mapping[str, Any]) -> Mapping[str, Tolerance]:
    """The loader's tolerances with the requested changes."""
    try:
        tolerances = {
            key: text.tolerance(key, tolerance) if isinstance(tolerance, str) else tolerance
            for key, tolerance in vary.items()
        }
        for key in {**loader.tolerances, **tolerances}:
            if tolerances.get(key, key) is not None:
                text.check_key(key)
    except InputError as error:
        raise InputError(f"vary: {error}") from error
    try:
        return loader.with_tolerances(tolerances).tolerances
    except InputError as error:
        raise InputError(str(error).replace("tolerances.", "vary: ")) from error
