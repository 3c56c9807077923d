"""Fits of the first step: each omits the parameters that the previous one did not determine."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field

from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.result import Estimate, Identification, Status
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.commission.observability import (
    BREAKAWAY,
    DRY,
    FRICTION_CURVE,
    STRIBECK,
    candidates,
    seen_by,
    with_friction,
)
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import AT_END, CARRIED, NOTHING, UNSEEN
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader

_ROUNDS = 4
"""Most fits."""

_ROUNDING = 1e-6
"""Relative difference between an estimate and its start that counts as zero."""

_NEGLIGIBLE = 0.01
"""Negligible friction, as a share of its start, the spring's force at 1 deg: it holds the column within 0.01 deg."""

_SMALL = 0.1
"""Share of a friction at which another start begins: a model whose column sticks has no slopes that would free it."""

_FALL = frozenset({BREAKAWAY, STRIBECK})
"""Rows of a friction that falls over a velocity."""


@dataclass(frozen=True, eq=False)
class Fits:
    """Status of the parameters of a loader after the fits.

    Attributes:
        identification: The last fit.
        without: Parameters without a value, by their state.
        friction_open: Whether the data leave the column's dry friction undetermined.
    """

    identification: Identification
    without: Mapping[str, Sequence[str]] = field(default_factory=dict)
    friction_open: bool = False


def fit_what_is_seen(
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    law: Law | None,
    plan: CommissionPlan,
    progress: Callable[[str], None],
) -> Fits:
    """Fit all observable parameters of a loader, without those that stay undetermined; ``law`` is that of the bench, if any.

    Raises:
        InputError: If the data contradict their labels.
    """
    progress("observable parameters")
    start = with_friction(loader)
    observed = seen_by(start, data, candidates(start), law)
    curve = [key for key in FRICTION_CURVE if key in observed.fitted]
    keys, friction_open = [key for key in observed.fitted if key not in curve], DRY not in observed.fitted
    unseen, carried = (
        [key for key in rows if key not in FRICTION_CURVE] for rows in (observed.unseen, observed.carried)
    )
    ended, nothing = list[str](), list[str]()
    even = without(start, (DRY, *FRICTION_CURVE) if friction_open else FRICTION_CURVE)
    for _ in range(_ROUNDS):
        progress(f"fit of {len(keys)} parameters")
        begins = [{}, {DRY: _SMALL * even[DRY]}] if DRY in keys else [{}]
        identification = identify(even, data, keys, law=law, starts=plan.starts, begins=begins)
        status = {estimate.unknown.key: estimate for estimate in identification.estimates}
        none = [key for key, estimate in status.items() if key == DRY and _is_none(estimate)]
        weak = [key for key, estimate in status.items() if _is_open(estimate)]
        at_end = [key for key, estimate in status.items() if _at_end(estimate, loader[key])]
        out = {*none, *weak, *at_end}
        if not out or len(out) == len(keys):
            break
        friction_open |= DRY in weak and DRY not in none
        unseen += [key for key in weak if key != DRY]
        ended += at_end
        nothing += none
        keys = [key for key in keys if key not in out]
        even = without(even, (DRY,) if DRY in out else ())
    if DRY in keys and identification.loader is not None and curve:
        progress(f"fit of {len(curve)} parameters of friction")
        identification = _curved(identification, without(start, set(FRICTION_CURVE) - set(curve)), curve, data, law)
    return Fits(identification, {CARRIED: carried, AT_END: ended, NOTHING: nothing, UNSEEN: unseen}, friction_open)


def _curved(
    even: Identification,
    start: Loader,
    curve: Sequence[str],
    data: Sequence[Response | BenchRecord],
    law: Law | None,
) -> Identification:
    """The fit with those rows of the friction's curve that the data determine; the one without where they determine none.

    The fall comes last: its jumps hide a friction of the seals from a search that begins without it, and leave others
    undetermined where it is not determined itself. A breakaway stays with its Stribeck velocity alone: a fall over a velocity that
    is read as a jump has another breakaway, and a standard error that is far too small.
    """
    lasting = _shown(even, start, [key for key in curve if key not in _FALL], data, law)
    if not set(curve) >= _FALL:
        return lasting
    return _shown(lasting, start, [key for key in curve if key in _FALL or key in lasting.keys], data, law)


def _shown(
    before: Identification,
    start: Loader,
    rows: Sequence[str],
    data: Sequence[Response | BenchRecord],
    law: Law | None,
) -> Identification:
    """The fit with those of some more rows that the data determine; the one before where they determine none, or no fall."""
    begin = {estimate.unknown.key: estimate.value for estimate in before.estimates}
    others = [key for key in begin if key not in FRICTION_CURVE]
    while rows:
        bare = without(start, set(FRICTION_CURVE) - set(rows))
        try:
            identification = identify(bare, data, [*others, *rows], law=law, starts=1, begins=[begin])
        except InputError:  # a breakaway below the friction, which no loader may have
            return before
        status = {estimate.unknown.key: estimate for estimate in identification.estimates}
        shown = [key for key in rows if _is_shown(status[key])]
        if shown == list(rows):
            return before if identification.loader is None else identification
        if _FALL & set(rows) and not set(shown) >= _FALL:
            return before
        rows = shown
    return before


def without(loader: Loader, rows: Collection[str]) -> Loader:
    """The loader without these rows and their tolerances."""
    stated = [key for key in rows if loader[key]]
    bare = loader.with_tolerances(dict.fromkeys(key for key in stated if key in loader.tolerances))
    return bare.replace(dict.fromkeys(stated))


def _is_shown(estimate: Estimate) -> bool:
    """Whether the data determine a row, with an interval that excludes zero."""
    return estimate.status is Status.DETERMINED and not estimate.low <= 0 <= estimate.high


def _is_none(estimate: Estimate) -> bool:
    """Whether a friction is absent: its 95 % interval, or the estimate itself, is negligible."""
    return estimate.high < _NEGLIGIBLE * estimate.unknown.scale or estimate.value < _ROUNDING * estimate.unknown.scale


def _is_open(estimate: Estimate) -> bool:
    """Whether the data leave a parameter undetermined; for a friction, between absent and present."""
    dry = estimate.unknown.key == DRY
    return estimate.status is Status.UNDETERMINED or (dry and estimate.low <= 0 and not _is_none(estimate))


def _at_end(estimate: Estimate, stated: float) -> bool:
    """Whether an estimate ended at the end of its range, at the file's value."""
    return estimate.status is Status.AT_BOUND and bool(stated) and abs(estimate.value / stated - 1) < _ROUNDING
