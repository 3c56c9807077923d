"""The fits of the first step: each leaves out what the one before it did not determine."""

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
"""Most fits: after each, what it does not determine is left out."""

_ROUNDING = 1e-6
"""Of an estimate, relative to where its search began."""

_NEGLIGIBLE = 0.01
"""Of the friction where its search begins, the spring's pull at a degree: it holds the column within a hundredth of one."""


@dataclass(frozen=True, eq=False)
class Fits:
    """What became of the parameters of a loader.

    Attributes:
        identification: The last fit.
        without: Parameters without a value, by their state.
        friction_open: Whether the data leave the column's dry friction open.
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
    """Fits all that the data see of a loader, until what is left is determined.

    Args:
        loader: As its file has it.
        data: Records and responses.
        law: Of the bench, where the records are of the whole loader.
        plan: What is asked.
        progress: Told what is being done.

    Raises:
        InputError: If the data are not what they are said to be.
    """
    progress("what the data see")
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
            # A breakaway that the data do not determine stays where the search began, and may lie below the dry friction.
            if BREAKAWAY not in keys or BREAKAWAY not in str(error):
                raise
            keys, start = _left_out(BREAKAWAY, keys, start)
            identification = identify(start, data, keys, law=law, starts=plan.starts)
        status = {estimate.unknown.key: estimate for estimate in identification.estimates}
        none = [key for key, estimate in status.items() if key in (DRY, BREAKAWAY) and _is_none(estimate)]
        weak = [key for key, estimate in status.items() if _is_open(estimate)]
        if BREAKAWAY in weak:
            weak = [BREAKAWAY]  # the jumps that it makes leave others open too, which are determined without it
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
    """What is fitted without a parameter, and the loader: a friction is none then, and none has no breakaway force."""
    out = (DRY, BREAKAWAY) if key == DRY else (key,)
    rest = [key for key in keys if key not in out]
    if key not in (DRY, BREAKAWAY):
        return rest, loader
    bare = loader.with_tolerances(dict.fromkeys(row for row in out if row in loader.tolerances))
    return rest, bare.replace(dict.fromkeys(out))


def _is_none(estimate: Estimate) -> bool:
    """Whether a friction is none: all of its 95 % interval is next to nothing, or it is itself but for rounding."""
    return estimate.high < _NEGLIGIBLE * estimate.unknown.scale or estimate.value < _ROUNDING * estimate.unknown.scale


def _is_open(estimate: Estimate) -> bool:
    """Whether the data do not determine a parameter: of a friction, whether it may be none and may be more."""
    dry = estimate.unknown.key in (DRY, BREAKAWAY)
    return estimate.status is Status.UNDETERMINED or (dry and estimate.low <= 0 and not _is_none(estimate))


def _at_end(estimate: Estimate, stated: float) -> bool:
    """Whether an estimate ended at the end of its range, where the file's value stands."""
    return estimate.status is Status.AT_BOUND and bool(stated) and abs(estimate.value / stated - 1) < _ROUNDING
