"""Plan of a sweep over linked pairs: both loaders drawn from their tolerances, and the link from those of its rows."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from forcefeel.errors import InputError, expect, suggestion
from forcefeel.laws.law import Law, LawLike
from forcefeel.linked.engine import PairValues, check_pair
from forcefeel.linked.result import SIDES
from forcefeel.linked.scenario import LinkedScenario
from forcefeel.loader.links import LINK_TABLE, Link
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX, in_range, range_text
from forcefeel.loader.project import Project
from forcefeel.loader.tolerance_text import of_row
from forcefeel.loader.tolerances import ASSUMED, Tolerance
from forcefeel.seeded_numbers import shares
from forcefeel.simulation.scenario import LARGEST_SEED
from forcefeel.sweep import text
from forcefeel.sweep.members import impossible
from forcefeel.sweep.plan import MOST_RUNS, check_whole, loader_tolerances
from forcefeel.units import show

LINKED_RUNS = 1000
"""Default number of pairs."""

_LINK = "link."

ASSUMED_ROWS = ("stiffness", "damping", "breakout")
"""Rows of a link that are off by ``ASSUMED``, unless stated."""


@dataclass(frozen=True, eq=False)
class LinkedSweep:
    """A Monte Carlo sweep over linked pairs.

    The numbers of a pair depend on the seed, the row and the pair's index alone; both loaders are drawn independently.

    Attributes:
        project: The project.
        link: Name of the link.
        scenario: What both pilots do, and what happens to the link, in each run.
        laws: The law of each side, one for all pairs; ``designed`` once.
        runs: Number of pairs.
        seed: Seed of the draw.
        vary: Tolerances as for ``Sweep``: a row of a loader varies on both sides, ``link.stiffness`` and so on in the link. Rows
            stiffness, damping and breakout of the link have ``ASSUMED`` to either side unless stated; ``None`` for none.

    Raises:
        InputError: If a parameter is unknown or out of its range, nothing varies, or as ``simulate_linked``.

    Example:
        >>> project = ff.loader.read_project("examples/cockpit/transport-column.toml")
        >>> both = ff.linked.LinkedScenario(ff.Scenario(ff.Step("40 lb"), 0.5))
        >>> sorted(ff.sweep.LinkedSweep(project, "pitch", both, runs=8).varied)[-2:]
        ['second.valve.rated_flow', 'second.valve.supply_pressure']
    """

    project: Project
    link: str
    scenario: LinkedScenario
    laws: tuple[LawLike, LawLike] = (None, None)
    runs: int = LINKED_RUNS
    seed: int = 0
    vary: Mapping[str, Any] = field(default_factory=dict)
    varied: Mapping[str, Tolerance] = field(init=False)
    designed: tuple[Law, Law] = field(init=False)

    def __post_init__(self) -> None:
        expect("project", self.project, Project, "a Project, such as loader.read_project('cockpit.toml')")
        check_whole("runs", self.runs, 1, MOST_RUNS)
        check_whole("seed", self.seed, 0, LARGEST_SEED)
        if self.link not in self.project.links:
            known = ", ".join(self.project.links) or "a link in [links] of the project"
            raise InputError(
                f"link: expected {known}, got {show(self.link)}{suggestion(self.link, self.project.links)}"
            )
        check_pair(self.project, self.link, self.scenario)
        of_link = {key: given for key, given in self.vary.items() if key.startswith(_LINK)}
        of_loaders = {key: given for key, given in self.vary.items() if key not in of_link}
        drawn = {
            f"{side}.{key}": tolerance
            for side, loader in zip(SIDES, self.loaders, strict=True)
            for key, tolerance in loader_tolerances(loader, of_loaders).items()
        }
        drawn |= _link_tolerances(self.joint, of_link)
        if not drawn:
            raise InputError(
                "nothing varies: all tolerances are none; leave one in, or add --vary 'link.stiffness=20 %'"
            )
        object.__setattr__(self, "varied", MappingProxyType(drawn))
        first, second = (Law.of(law, loader) for law, loader in zip(self.laws, self.loaders, strict=True))
        object.__setattr__(self, "designed", (first, second))

    @property
    def joint(self) -> Link:
        """The link."""
        return self.project.links[self.link]

    @property
    def loaders(self) -> tuple[Loader, Loader]:
        """Both loaders."""
        return self.project.sides(self.joint)

    @property
    def nominal(self) -> PairValues:
        """The pair of the project."""
        first, second = (loader.si_values[np.newaxis] for loader in self.loaders)
        return PairValues(first, second, self.joint.values[np.newaxis])

    def drawn(self, runs: range) -> dict[str, NDArray[np.float64]]:
        """The varied SI values in some runs."""
        return {
            key: tolerance.quantile(shares(self.seed, key, runs.start, len(runs)))
            for key, tolerance in self.varied.items()
        }

    def values(self, runs: range) -> tuple[PairValues, NDArray[np.bool_]]:
        """The SI values of some pairs, and which are impossible: the pair of the project stands in their place."""
        nominal = self.nominal
        rows = {
            "first": np.repeat(nominal.first, len(runs), axis=0),
            "second": np.repeat(nominal.second, len(runs), axis=0),
            "link": np.repeat(self.joint.values[np.newaxis], len(runs), axis=0),
        }
        for key, column in self.drawn(runs).items():
            of, _, row = key.partition(".")
            rows[of][:, list(LINK_TABLE).index(row) if of == "link" else INDEX[row]] = column
        failed = np.zeros(len(runs), dtype=bool)
        for side in SIDES:
            for which in impossible(rows[side]).values():
                failed |= which
        for of, value in (("first", nominal.first), ("second", nominal.second), ("link", nominal.link)):
            rows[of][failed] = value
        return PairValues(rows["first"], rows["second"], rows["link"]), failed


def _link_tolerances(link: Link, vary: Mapping[str, Any]) -> dict[str, Tolerance]:
    """The tolerances of the link's rows by ``link.row``."""
    stated = {row: f"{100 * ASSUMED:g} %" for row in ASSUMED_ROWS if isfinite(link[row]) and link[row] != 0}
    given = {_LINK + row: tolerance for row, tolerance in stated.items()} | dict(vary)
    tolerances = {}
    for key, spec in given.items():
        name = key.removeprefix(_LINK)
        if name not in LINK_TABLE or name == "delay":
            known = [row for row in LINK_TABLE if row != "delay"]
            raise InputError(f"vary: {key}: expected a row of a link ({', '.join(known)}){suggestion(name, known)}")
        row = LINK_TABLE[name]
        try:
            form = text.tolerance(key, spec) if isinstance(spec, str) else spec
            if form is None:
                continue
            tolerance = form if isinstance(form, Tolerance) else of_row(row, form, link[name])
        except InputError as error:
            raise InputError(f"vary: {key}: {error}") from error
        if not all(in_range(row, bound) for bound in (tolerance.low, tolerance.high)):
            raise InputError(f"vary: {key}: expected bounds within {range_text(row)}; narrow it")
        tolerances[key] = tolerance
    return tolerances
