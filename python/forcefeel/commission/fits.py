"""Fits of the first step: each omits the parameters that the previous one did not determine."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from forcefeel.bench.identification.fit import identify, unseen_from_afar
from forcefeel.bench.identification.result import Estimate, Identification, Status
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.commission.observability import BREAKAWAY, DRY, candidates, seen_by, with_friction
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
    keys, friction_open = list(observed.fitted), DRY not in observed.fitted
    unseen, ended, nothing = list(observed.unseen), list[str](), list[str]()
    if friction_open:
        keys, start = _left_out(DRY, keys, start)
    if BREAKAWAY not in keys or BREAKAWAY in unseen_from_afar(start, data, keys, law):
        keys, start = _left_out(BREAKAWAY, keys, start)
    for _ in range(_ROUNDS):
        progress(f"fit of {len(keys)} parameters")
        try:
            identification = identify(start, data, keys, law=law, starts=plan.starts)
        except InputError as error:
            # An undetermined breakaway keeps its start value, and may lie below the dry friction.
            if BREAKAWAY not in keys or BREAKAWAY not in str(error):
                raise
            keys, start = _left_out(BREAKAWAY, keys, start)
            identification = identify(start, data, keys, law=law, starts=plan.starts)
        status = {estimate.unknown.key: estimate for estimate in identification.estimates}
        none = [key for key, estimate in status.items() if key in (DRY, BREAKAWAY) and _is_none(estimate)]
        weak = [key for key, estimate in status.items() if _is_open(estimate)]
        if BREAKAWAY in weak:
            weak = [BREAKAWAY]  # its jumps leave others undetermined too, which are determined without it
        at_end = [key for key, estimate in status.items() if _at_end(estimate, loader[key])]
        if not (none or weak or at_end) or len(none) + len(weak) + len(at_end) == len(keys):
            break
        friction_open |= DRY in weak and DRY not in none
        unseen += [key for key in weak if key not in (DRY, BREAKAWAY)]
        ended += at_end
        nothing += {DRY} & set(none)
        for key in {*none, *weak, *at_end}:
            keys, start = _left_out(key, keys, start)
    return Fits(
        identification, {CARRIED: observed.carried, AT_END: ended, NOTHING: nothing, UNSEEN: unseen}, friction_open
    )


def _left_out(key: str, keys: Sequence[str], loader: Loader) -> tuple[list[str], Loader]:
    """The fitted keys and the loader without a parameter; without friction there is no breakaway force."""
    out = (DRY, BREAKAWAY) if key == DRY else (key,)
    rest = [key for key in keys if key not in out]
    if key not in (DRY, BREAKAWAY):
        return rest, loader
    bare = loader.with_tolerances(dict.fromkeys(row for row in out if row in loader.tolerances))
    return rest, bare.replace(dict.fromkeys(out))


def _is_none(estimate: Estimate) -> bool:
    """Whether a friction is absent: its 95 % interval, or the estimate itself, is negligible."""
    return estimate.high < _NEGLIGIBLE * estimate.unknown.scale or estimate.value < _ROUNDING * estimate.unknown.scale


def _is_open(estimate: Estimate) -> bool:
    """Whether the data leave a parameter undetermined; for a friction, between absent and present."""
    dry = estimate.unknown.key in (DRY, BREAKAWAY)
    return estimate.status is Status.UNDETERMINED or (dry and estimate.low <= 0 and not _is_none(estimate))


def _at_end(estimate: Estimate, stated: float) -> bool:
    """Whether an estimate ended at the end of its range, at the file's value."""
    return estimate.status is Status.AT_BOUND and bool(stated) and abs(estimate.value / stated - 1) < _ROUNDING
