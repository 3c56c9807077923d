"""Compute an envelope: for each frequency, in chunks, the ideal once and then every law in every case."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby, product
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import NOMINAL, Case
from forcefeel.envelope.contact import Contact, touch
from forcefeel.envelope.forbidden import forbidden
from forcefeel.envelope.outcomes import FIGURES, PASSED, find_outcomes
from forcefeel.envelope.passivity import passivity
from forcefeel.envelope.plan import Plan, PlanOptions, make_plan
from forcefeel.envelope.refinement import SMALL_STRIDES, UNKNOWN, rounds
from forcefeel.envelope.result import PASSES, UNSTABLE, AngleShares, Envelope
from forcefeel.envelope.settings import AXES, ListedSettings
from forcefeel.envelope.softening import SoftenedShares, softened_rows, softening
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.tables.labeled_arrays import LabeledArrays
from forcefeel.threads import side_by_side, threads_or_cores

Progress = Callable[[int, int], None]
"""Called with the numbers of completed and of all releases."""


def find_envelope(
    loader: Loader,
    laws: Sequence[str] | Mapping[str, Law] = ("original", "published", "converged"),
    grid: Mapping[str, str | Sequence[float]] | None = None,
    *,
    threads: int | None = None,
    progress: Progress = lambda done, total: None,
    **options: Unpack[PlanOptions],
) -> Envelope:
    """Compute the programmed feels at which a loader's loop is stable and a release passes the rule's tolerances.

    Each setting is programmed by its stiffness ``G``, natural frequency and damping ratio, ``I = G / w^2``, ``B = 2 zeta w I`` of
    eq. (11). The column is held at an angle and released. The rule's figures of its free response are compared with those of I, B
    and G alone: with the nominal plant, with a deviation of each plant parameter, and with each pilot's arm at the grip. An arm
    is at the grip of both the column and the ideal, so the comparison is of the column that the hand feels.

    Args:
        loader: The loader. The settings replace its programmed feel; optional rows of the feel and an arm are omitted.
        laws: Names of ``law.NAMED_LAWS``, or laws by name: ``DesignSettings`` and ``LawDesign`` design a law for each setting and
            the nominal plant, a file or a ``Law`` contains one for each, a ``GainLaw`` is one for all, ``None`` is the original
            loop.
        grid: Values by axis, ``stiffness`` (shares of G_max), ``frequency`` (rad/s), ``damping``, as numbers or as text such as
            ``"1..100 %:40:log"``, ``"0.5..4 Hz:25"``, ``"0.1..1.5:20"``.
        threads: Number of threads; default: all cores. The results do not depend on it.
        progress: Called with the numbers of completed and of all releases.
        options: ``rule``, an edition of ``qualification.editions()``; ``changes``, shares or deviations by plant parameter instead
            of the loader's tolerances; ``arms``; ``angle_rad``; ``draws``, machines with all tolerances at once;
            ``smaller_rad``, further release angles for the nominal plant; ``contacts``, such as ``ff.envelope.CONTACTS``;
            ``soften``, whether to soften settings beyond the drive; ``full``, run every setting. Default: on a fine grid of a
            simulated loader, most settings of a perturbed plant take their outcome from neighbors; ``data["inferred"]`` marks them.

    Returns:
        The envelope.

    Raises:
        InputError: If an argument is invalid.

    Example:
        >>> grid = {"stiffness": "10..100 %:3:log", "frequency": "1..3 Hz:3", "damping": "0.3, 0.7"}
        >>> envelope = ff.find_envelope(ff.elevator(), ["original", "published"], grid)
        >>> envelope.shares("original").stable
        0.7777777777777778
    """
    return compute(make_plan(loader, laws, grid, **options), threads=threads, progress=progress)


def compute(plan: Plan, *, threads: int | None = None, progress: Progress = lambda done, total: None) -> Envelope:
    """Compute a planned envelope; arguments as in ``find_envelope``."""
    return _compute(plan, list(_groups(plan)), threads, progress)


_BATCH, _TOGETHER = 384, 32
"""Most releases of a linear loader in a batch of several cases, and most cases of a simulated one that are run together: batches of
few runs leave lanes and cores empty.
"""


def _groups(plan: Plan) -> Iterator[tuple[Case, ...]]:
    """Cases that run together: all whole or all inferred."""
    size = max(1, _BATCH * len(plan.settings.frequency) // plan.settings.count) if plan.linear else _TOGETHER
    for _, group in groupby((*plan.cases, *plan.machines), plan.infers):
        alike = tuple(group)
        yield from (alike[first : first + size] for first in range(0, len(alike), size))


def _compute(plan: Plan, groups: Sequence[tuple[Case, ...]], threads: int | None, progress: Progress) -> Envelope:
    """Release every law in every case, each group of cases in one batch, then the nominal plant from further angles."""
    threads = threads_or_cores(threads)
    feel, laws = _designed(plan)
    done = 0

    def advance(some: int) -> None:
        nonlocal done
        done += some
        progress(done, plan.releases)

    advance(0)
    outcome, margin, inferred = find_outcomes(plan, feel, laws, groups, threads, advance)
    smaller = []
    for angle in plan.smaller_rad:
        smaller_plan = replace(plan, angle_rad=angle)
        codes, _, _ = find_outcomes(smaller_plan, feel, laws, [(NOMINAL,)], threads, advance)
        passes = {name: float((codes[k] == PASSED).mean()) for k, name in enumerate(laws)}
        smaller.append(AngleShares(angle, 1 - float(forbidden(smaller_plan, threads=threads).settings.mean()), passes))
    grips = {name: passivity(plan.loader, plan.laws[name], law, feel) for name, law in laws.items()}
    outcomes = (PASSES, UNSTABLE, *FIGURES)
    # A law designed here is for the plan's reduced loader, a law of a file for the whole loader.
    remarks = [law.made_for_another(plan.given) for law in laws.values() if law.made_for_another(plan.loader)]
    arrays = _arrays(plan, outcome, margin, inferred)
    if plan.contacts:
        _touch(plan, feel, laws, threads, advance, arrays)
    about = {"loader": plan.loader.name, "rule": plan.rule, "outcomes": ", ".join(outcomes)}
    labeled = LabeledArrays(arrays, _coordinates(plan), about)
    softened = _softened(plan, outcome[:, 0] == PASSED, threads) if plan.soften else ()
    return Envelope(plan, labeled, outcomes, grips, tuple(smaller), tuple(filter(None, remarks)), softened)


def _softened(plan: Plan, as_programmed: NDArray[np.bool_], threads: int) -> tuple[SoftenedShares, ...]:
    """Shares of the settings (laws, settings) that pass as programmed, softened, or not at all, with the nominal plant."""
    limits = softening(plan, threads=threads)
    which = np.flatnonzero((limits.reason >= 0) & np.isfinite(limits.share))
    passes = np.zeros_like(as_programmed)
    if len(which):
        listed = replace(plan, settings=ListedSettings(softened_rows(plan.settings.rows[which], limits.share[which])))
        codes, _, _ = find_outcomes(listed, *_designed(listed), [(NOMINAL,)], threads, lambda _: None)
        passes[:, which] = (codes[:, 0] == PASSED) & ~as_programmed[:, which]
    return tuple(SoftenedShares.of(*row, limits.share) for row in zip(plan.laws, as_programmed, passes, strict=True))


_NEVER, _SWINGS_ON, _THROWN_BACK = -2, 1, 2
"""Codes of a setting that is unstable beforehand, which in contact none is, and of those that are not quiet."""


def _touch(
    plan: Plan,
    feel: NDArray[np.float64],
    laws: Mapping[str, Law],
    threads: int,
    advance: Callable[[int], None],
    data: dict[str, Any],
) -> None:
    """Add to the arrays which settings swing on in which contact, what a stop throws back, and the largest forces and rates."""
    over = ("law", "contact", *AXES)
    shape = (len(laws), len(plan.contacts), *plan.settings.shape)
    codes = np.full((len(laws), len(plan.contacts), len(feel)), UNKNOWN, dtype=np.int8)
    forces, returns = np.full(codes.shape, np.nan), np.full(codes.shape, np.nan)
    margins = np.full(codes.shape, np.nan, dtype=np.float32)

    def run(task: tuple[tuple[int, Law], tuple[int, Contact]]) -> None:
        (k, law), (j, contact) = task
        # Of views, which share their memory.
        outcome, margin = (array[k, j].reshape(1, *plan.settings.shape) for array in (codes, margins))
        wanted = rounds(outcome, margin, _NEVER, SMALL_STRIDES) if plan.inferring else [np.ones(outcome.shape, bool)]
        for each in wanted:
            which = np.flatnonzero(each)
            touched = touch(plan.loader, law.some(which), feel[which], contact, threads)
            codes[k, j, which] = np.where(touched.swings_on, _SWINGS_ON, np.where(touched.thrown_back, _THROWN_BACK, 0))
            forces[k, j, which], returns[k, j, which] = touched.largest_force_n, touched.returns
            margins[k, j, which] = touched.margin

    for _ in side_by_side(run, product(enumerate(laws.values()), enumerate(plan.contacts)), threads):
        advance(plan.contact_releases)
    data["swings_on"] = over, (codes == _SWINGS_ON).reshape(shape)
    data["thrown_back"] = over, (codes == _THROWN_BACK).reshape(shape)
    data["returns"] = over, returns.reshape(shape)
    data["contact_inferred"] = over, np.isnan(forces).reshape(shape)
    data["largest_force_n"] = over, forces.reshape(shape)


def _designed(plan: Plan) -> tuple[NDArray[np.float64], dict[str, Law]]:
    """I, B, G of the settings, and the laws designed for them."""
    feel = plan.settings.feel(plan.loader)
    return feel, {name: Law.of(law, plan.loader, feel, name) for name, law in plan.laws.items()}


def _coordinates(plan: Plan) -> dict[str, Any]:
    axes = {name: (name, list(getattr(plan.settings, name)), {"units": axis.unit.si}) for name, axis in AXES.items()}
    coordinates: dict[str, Any] = {"law": list(plan.laws), "case": [case.name for case in plan.cases], **axes}
    if plan.machines:
        coordinates["parameter"] = list(plan.deviations)
    if plan.contacts:
        coordinates["contact"] = [contact.name for contact in plan.contacts]
    return coordinates


def _arrays(
    plan: Plan,
    outcome: NDArray[np.int8],
    margin: NDArray[np.float32],
    inferred: NDArray[np.bool_],
) -> dict[str, Any]:
    over = tuple(AXES)
    shape = (len(plan.laws), -1, *plan.settings.shape)
    single = slice(len(plan.cases))
    data: dict[str, Any] = {
        "outcome": (("law", "case", *over), outcome[:, single].reshape(shape)),
        "margin": (("law", "case", *over), margin[:, single].reshape(shape)),
        "inferred": (("law", "case", *over), inferred[:, single].reshape(shape)),
    }
    if plan.machines:
        drawn = slice(len(plan.cases), None)
        data["drawn_outcome"] = ("law", "machine", *over), outcome[:, drawn].reshape(shape)
        data["drawn_margin"] = ("law", "machine", *over), margin[:, drawn].reshape(shape)
        data["drawn_inferred"] = ("law", "machine", *over), inferred[:, drawn].reshape(shape)
        data["off"] = ("machine", "parameter"), [list(machine.off.values()) for machine in plan.machines]
    return data
