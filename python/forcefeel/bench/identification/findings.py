"""Conclusions from an identification, in sentences."""

import math
from collections.abc import Sequence

from forcefeel.bench.identification.digits import error, estimated, nominal, percent, relative_error, title_of, unit_of
from forcefeel.bench.identification.misfit import UNEXPLAINED, beyond_noise, model_error, size_text, unexplained
from forcefeel.bench.identification.result import Ended, Estimate, Fitted, Identification, RigidTest, Status
from forcefeel.bench.responses import Response
from forcefeel.conclusions import Conclusions, of_result
from forcefeel.loader.beyond_linear import beyond_linear
from forcefeel.loader.consistency import AT_LEAST
from forcefeel.loader.parameters import TABLE, limits_si
from forcefeel.loader.tolerances import Distribution
from forcefeel.units import UnitSystem, to_text

STRONG = 0.9
"""Correlation from which on two estimates count as correlated."""

ONE_DIRECTION = 0.99
"""Correlation from which on what the model misses is magnified sevenfold and more in both: ``1 / sqrt(1 - r^2)``."""

_MOST_NAMED = 4
"""Parameters or data that sentences name; the tables have all."""

_SAME_LEFT = 1.05
"""What one place leaves over what another does, below which the data hardly tell one from the other."""

_FAR = 700.0
"""A larger difference of logarithms has no exponential."""

_PRIOR_COUNTS = 1.2
"""The interval from the data alone over that with the prior, from which on the prior is worth a word."""

_NEARLY_ONE = 0.9995

_LEAST_PROBABILITY = 1e-16
"""A smaller one is not worth its digits."""


@of_result
def identification_conclusions(found: Identification, units: UnitSystem) -> Conclusions:
    """The conclusions, with numbers in ``units``; ``good`` where the data determine all and the model explains them."""
    lines = (
        *(one.sentence for one in found.inseparable),
        *(one.sentence for one in found.advice),
        *_moved(found, units),
        *_at_bound(found, units),
        *_correlated(found),
        *_priors(found),
        _rigid(found.rigid) if found.rigid else "",
        _starts(found),
        *_left(found, units),
        _left_out(found),
        *found.notes,
    )
    good = found.loader is not None and not any(map(beyond_noise, found.fitted))
    return Conclusions(good, _verdict(found, units) + _doubt(found), tuple(line for line in lines if line))


def _verdict(found: Identification, units: UnitSystem) -> str:
    lost = _with(found, Status.UNDETERMINED)
    count = len(found.estimates)
    if lost:
        which = "The parameter" if count == 1 else f"{len(lost)} of {count} parameters"
        verb = "is" if len(lost) == 1 else "are"
        return f"{which} {verb} not determined by these data: {_named(lost)}. No loader file is written."
    bound = _with(found, Status.AT_BOUND)
    but = f", but {_named(bound)} ended at {'its' if len(bound) == 1 else 'their'} bound" if bound else ""
    unwritten = " No loader file is written." if bound else ""
    if count == 1:
        (one,) = found.estimates
        value, deviation = (_with_unit(one, it, units) for it in (estimated(one, one.value, units), error(one, units)))
        if bound:
            return f"{one.unknown.key} ended at its bound, {value}: the data do not determine it. No loader file is written."
        return f"{one.unknown.key} is determined: {value} with a standard error of {deviation}."
    shares = [it for it in found.estimates if it.value and not it.unknown.is_phase]
    ordered = sorted(shares or found.estimates, key=relative_error)
    first, last = ordered[0], ordered[-1]
    return (
        f"{_all(count)} parameters are determined{but}: their standard errors are from {percent(relative_error(first))} "
        f"({first.unknown.key}) to {percent(relative_error(last))} ({last.unknown.key}).{unwritten}"
    )


def _doubt(found: Identification) -> str:
    """A sentence more where the standard errors do not say how wrong the estimates can be."""
    bad = sorted((one for one in found.fitted if unexplained(one) > UNEXPLAINED), key=unexplained)
    if bad:
        it = "it" if len(found.estimates) == 1 else "them"
        start = f"But do not rely on {it}: the" if found.determined else "Besides, the"
        unwritten = " No loader file is written." if found.determined and found.within_bounds else ""
        return (
            f" {start} model misses {title_of(bad[-1])} by {percent(unexplained(bad[-1]))}, so it is not the model of this "
            f"machine under this experiment.{unwritten} See its plot. A fit of records includes friction and limits; a fit of "
            "responses does not."
        )
    missed = list(filter(beyond_noise, found.fitted))
    if not found.determined or not missed:
        return ""
    loose = [pair for pair in strong_pairs(found) if abs(pair[2]) > ONE_DIRECTION]
    if loose:
        first, second, size = loose[0]
        return (
            f" But the model misses more than noise, and the data hardly separate {first} from {second} (correlation "
            f"{correlation_text(size)}): both errors can be far larger than the standard errors."
        )
    return f" But the model misses more of {first_two(missed)} than noise, so the estimates can be off by more than these errors."


def first_two(missed: Sequence[Fitted]) -> str:
    """What is missed, two of them by name."""
    return " and ".join([*map(title_of, missed[:2]), *(["others"] if len(missed) > 2 else [])])


def _moved(found: Identification, units: UnitSystem) -> list[str]:
    """Who left the file's value, and how far; who did not."""
    known = _with(found, Status.DETERMINED)
    moved = sorted((it for it in known if differs(it)), key=lambda it: -abs(change(it)))
    lines = [_one_moved(it, units) for it in moved[:_MOST_NAMED]]
    if len(moved) > _MOST_NAMED:
        rest = moved[_MOST_NAMED:]
        lines.append(
            f"{_named(rest)} changed too, by at most {_part(max(abs(change(it)) for it in rest))}; see the table."
        )
    same = [it for it in known if not differs(it)]
    if same:
        agree, value = ("agrees", "value lies within its") if len(same) == 1 else ("agree", "values lie within their")
        intervals = "interval" if len(same) == 1 else "intervals"
        lines.append(f"{_named(same)} {agree} with the file, whose {value} 95 % {intervals}.")
    return lines


def _one_moved(one: Estimate, units: UnitSystem) -> str:
    unknown = one.unknown
    way = "above" if one.value > unknown.nominal else "below"
    value = _with_unit(one, estimated(one, one.value, units), units)
    far = f"{to_text(math.degrees(abs(change(one))), 3)} deg" if unknown.is_phase else _part(abs(change(one)))
    text = f"{unknown.key} lies {far} {way} the file's value, {value} instead of {nominal(one, units)}"
    told = unknown.tolerance
    if told is None:
        return f"{text}; the file states no tolerance for it."
    if told.distribution is Distribution.NORMAL and told.peak is not None and told.deviation is not None:
        share = abs(one.value - told.peak) / told.deviation
        return f"{text}; that is {to_text(share, 2)} standard deviations of its tolerance."
    low, high = ((bound - unknown.nominal) / unknown.scale for bound in (told.low, told.high))
    return f"{text}; its tolerance allows {_signed(low)} to {_signed(high)}."


def _at_bound(found: Identification, units: UnitSystem) -> list[str]:
    """Who would go farther, and what to do about it."""
    lines = []
    for one in _with(found, Status.AT_BOUND):
        unknown, limits = one.unknown, limits_si(TABLE[one.unknown.key])
        k = int(abs(one.value - unknown.high) < abs(one.value - unknown.low))
        bound, end, way = (unknown.low, unknown.high)[k], ("lower", "upper")[k], ("smaller", "larger")[k]
        value = _with_unit(one, estimated(one, bound, units), units)
        remedy = "The bound is the file's tolerance: widen or remove it if the machine may deviate that far."
        others = [key for pair in AT_LEAST if unknown.key in pair for key in pair if key not in found.keys]
        if others and found.before[others[0]] == bound:
            remedy = f"The bound is {others[0]}: fit both, or leave {unknown.key} out."
        elif unknown.tolerance is None or bound == limits[k]:
            remedy = "The bound is the end of the valid range: check the units and the experiment of the data."
        lines.append(
            f"{unknown.key} ended at its {end} bound, {value} ({_signed(change(one))}): the data require a {way} value. {remedy}"
        )
    return lines


def _correlated(found: Identification) -> list[str]:
    """The strongest pairs."""
    pairs = strong_pairs(found)
    lines = []
    for first, second, size in pairs[:_MOST_NAMED]:
        way = "rises" if size > 0 else "falls"
        lines.append(
            f"{first} and {second} are correlated: when one rises the other {way} (correlation {correlation_text(size)}). The "
            "data determine a combination of them better than each."
        )
    if len(pairs) > _MOST_NAMED:
        lines.append(f"{len(pairs) - _MOST_NAMED} more pairs are correlated beyond {STRONG:g}; see the map.")
    return lines


def correlation_text(size: float) -> str:
    """Three digits; one that would be rounded to 1 is not 1."""
    return to_text(size, 3) if abs(size) < _NEARLY_ONE else f"beyond {math.copysign(0.999, size)}"


def strong_pairs(found: Identification) -> list[tuple[str, str, float]]:
    """Determined parameters whose estimates hang together, the strongest first, and their correlation."""
    known = [k for k, it in enumerate(found.estimates) if it.status is not Status.UNDETERMINED]
    pairs = [
        (found.keys[i], found.keys[j], float(found.correlation[i, j]))
        for a, i in enumerate(known)
        for j in known[a + 1 :]
    ]
    return sorted((it for it in pairs if abs(it[2]) > STRONG), key=lambda it: -abs(it[2]))


def _priors(found: Identification) -> list[str]:
    """Estimates to which the file's tolerance adds much."""
    leaning = [
        it
        for it in found.estimates
        if it.status is not Status.UNDETERMINED and it.unknown.prior and it.share > _PRIOR_COUNTS * _half(it)
    ]
    return [
        f"{it.unknown.key} depends on the loader file's prior: from the data alone its 95 % interval is ±{percent(it.share)} in "
        f"place of ±{percent(_half(it))}."
        for it in leaning[:_MOST_NAMED]
    ]


def _rigid(test: RigidTest) -> str:
    statistic = f"F({test.degrees[0]}, {test.degrees[1]}) = {to_text(test.f_statistic, 3)}, {probability_text(test)}"
    rigid, compliant = percent(test.rigid_rms), percent(test.compliant_rms)
    if test.needed:
        return (
            f"The link's compliance is needed: a rigid link leaves an error of {rigid} (root mean square) where the compliant one "
            f"leaves {compliant}; {statistic}."
        )
    return (
        f"The link's compliance is not needed to explain these data: a rigid link leaves an error of {rigid} (root mean square), "
        f"the compliant one {compliant}; {statistic}."
    )


def probability_text(test: RigidTest) -> str:
    """``p = 0.03``, or that it is too small for digits."""
    if test.probability < _LEAST_PROBABILITY:
        return f"p < {_LEAST_PROBABILITY:.0e}"
    return f"p = {to_text(test.probability, 2)}"


def _starts(found: Identification) -> str:
    count, same = len(found.ends), sum(end.same for end in found.ends)
    if count <= 1:
        return "The search started only once, at the file's values; for a search of other minima see --starts."
    if same == count:
        return f"{_all(count)} starts of the search ended in the same minimum."
    other = min(worse(found, end) for end in found.ends if not end.same)
    text = f"{same} of {count} starts of the search ended in the same, best minimum"
    if other < _SAME_LEFT:
        return f"{text}; another minimum explains the data about as well, so make a further experiment before you rely on this one."
    return f"{text}; the others ended in worse ones, the next best with {to_text(other, 3)} times the residual."


def worse(found: Identification, end: Ended) -> float:
    """How many times as much a place leaves of the data as the best one: the exponential of what their costs differ by."""
    return math.exp(min(end.cost - min(it.cost for it in found.ends), _FAR))


def _left(found: Identification, units: UnitSystem) -> list[str]:
    """What the model does not explain, beside what the data say of their noise."""
    lines = [text for one in found.fitted if (text := model_error(one, units))]
    named = [f"{title_of(one)}: {size_text(one, one.residual_rms, units)}" for one in found.fitted]
    if named:
        more = f"; {len(named) - _MOST_NAMED} more are in the table" if len(named) > _MOST_NAMED else ""
        lines.append(f"Residual of the fit (r.m.s.): {'; '.join(named[:_MOST_NAMED])}{more}.")
    return lines


def _left_out(found: Identification) -> str:
    """What responses do not show of the loader."""
    rows = beyond_linear(found.before)
    if not rows or not any(isinstance(one.data, Response) for one in found.fitted):
        return ""
    if found.before["controller.period"]:
        return (
            "Responses are compared with the sampled linear model, which neglects friction, stops, limits and rounding; "
            "records are "
            "compared with the full model."
        )
    return f"Responses are compared with the linear model, which neglects {rows}; records are compared with the full model."


def change(one: Estimate) -> float:
    """How far the estimate lies from the file's value, as a share of it."""
    return (one.value - one.unknown.nominal) / one.unknown.scale


def differs(one: Estimate) -> bool:
    """Whether the file's value lies outside the 95 % interval."""
    return not one.low <= one.unknown.nominal <= one.high


def _with(found: Identification, status: Status) -> list[Estimate]:
    return [it for it in found.estimates if it.status is status]


def _named(some: list[Estimate]) -> str:
    names = [it.unknown.key for it in some]
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def _half(one: Estimate) -> float:
    """Half the 95 % interval as a share of the value."""
    return (one.high - one.low) / 2 / abs(one.value) if one.value else math.inf


def _all(count: int) -> str:
    return "Both" if count == 2 else f"All {count}"


def _with_unit(one: Estimate, value: str, units: UnitSystem) -> str:
    return f"{value} {unit_of(one, units)}".strip()


def _part(share: float) -> str:
    """A part of a value in percent, three digits: +13.7 % is not +14 %."""
    return f"{to_text(100 * share, 3)} %"


def _signed(share: float) -> str:
    return f"{'+' if share > 0 else ''}{_part(share)}"
