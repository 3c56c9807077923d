"""Largest stable stiffness of an electronic link against its delay and its injected damping.

Both loaders run under their law, hands off, without their optional rows: noise, limits and friction are not part of a limit. A
stiffness is stable if the swing after a small push decays. The limit is found ``_PARTS`` stiffnesses at a time.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, pi
from types import MappingProxyType
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from forcefeel._core import MOST_LINK_DELAY
from forcefeel.conclusions import Conclusions, of_result
from forcefeel.errors import InputError
from forcefeel.laws.law import Law, LawLike
from forcefeel.linked.engine import PairValues, simulate_linked_batch
from forcefeel.linked.result import SIDES
from forcefeel.linked.scenario import LinkedScenario
from forcefeel.loader.links import LINK_TABLE, Link, LinkKind
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import unit
from forcefeel.loader.project import Project
from forcefeel.simulation.inputs import Pulse
from forcefeel.simulation.scenario import Scenario
from forcefeel.units import PERCENT, ROTARY_DAMPING, ROTARY_STIFFNESS, SECONDS, UnitSystem, to_text

DELAYS = (1, 2, 4, 10, 20, 40)
"""Periods of delay of a frontier."""

DAMPING = (0.0, 0.5, 1.0)
"""Injected damping as shares of the damping of the less damped feel."""

_PARTS, _ROUNDS = 5, 5
"""Stiffnesses that run side by side, and how often: the limit is known to 1 in 380."""

_PUSH_N, _PUSH_S = 0.1, 0.01

_GROWN = 10.0
"""Largest angle of a stable pair, as a multiple of what the push holds: a swing at a limit of the drive does not grow."""

_SHORTEST_S, _PERIODS = 6.0, 10
"""Shortest run, and periods of the slower feel in it."""


@dataclass(frozen=True)
class LinkLimit:
    """One delay and one injected damping.

    Attributes:
        delay_s: One-way delay.
        injected_damping_n_m_s_per_rad: Largest damping that the link injects on each side.
        stiffness_n_m_per_rad: Largest stable stiffness; infinite if the largest of the row is stable, 0 if none is.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/linked-sticks.toml")
        >>> links = ff.frontier.link_frontier(project, "robust", delays=[1]).links
        >>> round(links["stick-pitch"].limits[0].stiffness_n_m_per_rad, -3)
        17000.0
    """

    delay_s: Annotated[float, SECONDS]
    injected_damping_n_m_s_per_rad: Annotated[float, ROTARY_DAMPING]
    stiffness_n_m_per_rad: Annotated[float, ROTARY_STIFFNESS]


@dataclass(frozen=True, eq=False)
class LinkFrontier:
    """Limits of one link.

    Attributes:
        link: The link.
        law: Name of the law, of both sides.
        limits: By delay, then by injected damping.
        own: The limit at the link's own delay and injected damping; ``None`` for a mechanical link.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/linked-sticks.toml")
        >>> links = ff.frontier.link_frontier(project, "robust", delays=[1]).links
        >>> round(links["stick-pitch"].used, 3)
        0.018
    """

    link: Link
    law: str
    limits: tuple[LinkLimit, ...]
    own: LinkLimit | None

    @property
    def used(self) -> Annotated[float, PERCENT]:
        """Stiffness of the link as a share of its limit; NaN for a mechanical link."""
        if self.own is None:
            return float("nan")
        limit = self.own.stiffness_n_m_per_rad
        return self.link["stiffness"] / limit if limit else inf


@dataclass(frozen=True, eq=False)
class CockpitFrontier:
    """Limits of each link of a project.

    Attributes:
        name: Name of the project.
        links: By name of the link.
    """

    name: str
    links: Mapping[str, LinkFrontier]


def link_frontier(
    project: Project,
    law: LawLike = None,
    *,
    delays: Sequence[int] = DELAYS,
    threads: int | None = None,
    progress: Callable[[str, int, int], None] = lambda what, done, total: None,
) -> CockpitFrontier:
    """Find the largest stable stiffness of each link of a project, as an electronic link.

    Args:
        project: The project.
        law: Law of both loaders, as for ``Law.of``.
        delays: One-way delays, in periods.
        threads: Number of threads; default: all cores.
        progress: Called with the link and the numbers of completed and of all runs.

    Raises:
        InputError: If the project has no link, a delay is out of range, or its loaders have no digital controller of one period.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/linked-sticks.toml")
        >>> frontier = ff.frontier.link_frontier(project, "robust", delays=[1])
        >>> frontier.links["stick-pitch"].used < 0.1
        True
    """
    if not project.pilot_links:
        has = "has interconnects alone" if project.links else "has no table [links]"
        raise InputError(
            f"{project.path}: {has}; add a link between two pilots' controls [links.NAME], or name the loader of one axis"
        )
    if not delays or not all(isinstance(delay, int) and 1 <= delay <= MOST_LINK_DELAY for delay in delays):
        raise InputError(f"delays: expected whole periods from 1 to {MOST_LINK_DELAY}, got {list(delays)}")
    total = len(project.pilot_links) * (len(delays) + 1)
    done = 0

    def advance(name: str) -> None:
        nonlocal done
        done += 1
        progress(f"link {name}", done, total)

    def frontier(link: Link) -> LinkFrontier:
        if link["middle_inertia"]:
            raise InputError(
                f"links.{link.name}.middle_inertia: the frontier is of a link without a body at its middle; leave the middle out"
            )
        pair = _Bare.of(project, link, law)
        period, damping = pair.loaders[0]["controller.period"], pair.damping
        limits: list[LinkLimit] = []
        for periods in delays:
            limits += pair.limits(periods * period, [share * damping for share in DAMPING], threads)
            advance(link.name)
        own = None
        if link.kind is LinkKind.ELECTRONIC:
            (own,) = pair.limits(link["delay"] or period, [link["injected_damping"]], threads)
        advance(link.name)
        return LinkFrontier(link, pair.law, tuple(limits), own)

    try:
        return CockpitFrontier(
            project.name, MappingProxyType({k: frontier(link) for k, link in project.pilot_links.items()})
        )
    except InputError as error:
        raise InputError(f"{project.path}: {error}") from error


@dataclass(frozen=True)
class _Bare:
    """Two loaders without optional rows, and their laws."""

    project: Project
    link: Link
    loaders: tuple[Loader, Loader]
    laws: tuple[Law, Law]

    @classmethod
    def of(cls, project: Project, link: Link, law: LawLike) -> "_Bare":
        loaders = [_bare(project.loaders[axis]) for axis in link.between]
        bare = {**project.loaders, **dict(zip(link.between, loaders, strict=True))}
        free = {"play": 0.0, "breakout": inf}
        values = np.array([free.get(row, value) for row, value in zip(LINK_TABLE, link.values, strict=True)])
        free_link = replace(link, values=values, kind=LinkKind.ELECTRONIC)
        laws = Law.of(law, loaders[0]), Law.of(law, loaders[1])
        return cls(replace(project, loaders=bare), free_link, (loaders[0], loaders[1]), laws)

    @property
    def law(self) -> str:
        """Name of the law."""
        return self.laws[0].name

    @property
    def damping(self) -> float:
        """Damping of the less damped feel."""
        return min(loader["feel.damping"] for loader in self.loaders)

    def limits(self, delay_s: float, dampings: list[float], threads: int | None) -> list[LinkLimit]:
        """The limit for each injected damping."""
        row = LINK_TABLE["stiffness"]
        bounds = np.tile(np.log([row.minimum_si, row.maximum_si]), (len(dampings), 1))
        top = self._stable(delay_s, bounds[:, 1:], dampings, threads)[:, 0]
        bottom = self._stable(delay_s, bounds[:, :1], dampings, threads)[:, 0]
        for _ in range(_ROUNDS):
            along = np.linspace(bounds[:, 0], bounds[:, 1], _PARTS + 2, axis=1)
            stable = self._stable(delay_s, along[:, 1:-1], dampings, threads)
            first = np.where(stable.all(axis=1), _PARTS, np.argmin(stable, axis=1))
            bounds = np.take_along_axis(along, np.stack([first, first + 1], axis=1), axis=1)
        middle = np.where(top, inf, np.where(bottom, np.exp(bounds.mean(axis=1)), 0.0))
        return [LinkLimit(delay_s, damping, float(k)) for damping, k in zip(dampings, middle, strict=True)]

    def _stable(
        self, delay_s: float, log_stiffness: NDArray[np.float64], dampings: list[float], threads: int | None
    ) -> NDArray[np.bool_]:
        """Whether the swing of a pair decays (dampings, stiffnesses)."""
        names = list(LINK_TABLE)
        rows = np.tile(self.link.values, (log_stiffness.size, 1))
        rows[:, names.index("stiffness")] = np.exp(log_stiffness).ravel()
        rows[:, names.index("injected_damping")] = np.repeat(dampings, log_stiffness.shape[1])
        values = self.link.values.copy()
        values[names.index("delay")] = delay_s
        delayed = replace(self.project, links={self.link.name: replace(self.link, values=values)})
        first, second = (np.tile(loader.si_values, (len(rows), 1)) for loader in self.loaders)
        pairs = PairValues(first, second, rows)
        runs = simulate_linked_batch(delayed, self.link.name, self._scenario(), pairs, self.laws, threads=threads)
        angles = np.stack([runs[f"{side}_column_angle_rad"].to_numpy() for side in SIDES])
        quarter = angles.shape[2] // 4
        with np.errstate(over="ignore", invalid="ignore"):
            late, early = (
                np.sqrt((part**2).sum(axis=(0, 2)))
                for part in (angles[:, :, -quarter:], angles[:, :, quarter : 2 * quarter])
            )
            small = np.abs(angles).max(axis=(0, 2)) < _GROWN * max(
                _PUSH_N * loader["column.grip_arm"] / loader["feel.stiffness"] for loader in self.loaders
            )
        return np.asarray((late <= early) & small).reshape(log_stiffness.shape)

    def _scenario(self) -> LinkedScenario:
        period = self.loaders[0]["controller.period"]
        slowest = max(2 * pi * (loader["feel.inertia"] / loader["feel.stiffness"]) ** 0.5 for loader in self.loaders)
        samples = round(max(_SHORTEST_S, _PERIODS * slowest) / period)
        push = Pulse(_PUSH_N, 0.0, _PUSH_S)
        return LinkedScenario(Scenario(push, samples * period, period, period))


def _bare(loader: Loader) -> Loader:
    """The loader with its controller and without other optional rows."""
    rows = [key for key in loader.given if not key.startswith("controller.")]
    without = Loader(loader.name, loader.source, loader.si_values)
    return without.replace(dict.fromkeys(rows)) if rows else without


@of_result
def link_conclusions(frontier: CockpitFrontier, units: UnitSystem) -> Conclusions:
    """The stiffness of each link as a share of its limit."""
    beyond = [name for name, link in frontier.links.items() if link.used >= 1]
    lines = [_text(link, units) for link in frontier.links.values()]
    if beyond:
        return Conclusions(False, f"Beyond the largest stable stiffness: {', '.join(beyond)}.", tuple(lines))
    return Conclusions(True, "No electronic link is beyond its largest stable stiffness.", tuple(lines))


def _text(frontier: LinkFrontier, units: UnitSystem) -> str:
    link, own = frontier.link, frontier.own
    if own is None:
        return f"Link {link.name} is mechanical: it has no delay. The table is for an electronic link in its place."
    delay, share = f"{1e3 * own.delay_s:g} ms", f"{to_text(100 * frontier.used, 3)} %"
    limit = stiffness_text(own, units)
    return f"Link {link.name}: its stiffness is {share} of the largest stable one at {delay}, {limit}."


def stiffness_text(limit: LinkLimit, units: UnitSystem) -> str:
    """The largest stable stiffness with its unit, three digits of it."""
    of, row = unit(LINK_TABLE["stiffness"]), LINK_TABLE["stiffness"]
    known = isfinite(limit.stiffness_n_m_per_rad)
    value = of.from_si(limit.stiffness_n_m_per_rad if known else row.maximum_si, units)
    return f"{'' if known else 'above '}{float(f'{value:.3g}'):,.0f} {of.shown(units)}"
