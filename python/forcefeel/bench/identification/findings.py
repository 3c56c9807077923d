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
"""Correlation at which an error of the model is magnified sevenfold in both: ``1 / sqrt(1 - r^2)``."""

_MOST_NAMED = 4
"""Number of parameters or data in a sentence; the tables have all."""

_SAME_LEFT = 1.05
"""Largest ratio of residuals of two ends that the data hardly distinguish."""

_FAR = 700.0
"""Largest difference of logarithms with an exponential."""

_PRIOR_COUNTS = 1.2
"""Ratio of the interval from the data alone to that with the prior, above which the prior is mentioned."""

_NEARLY_ONE = 0.9995

_LEAST_PROBABILITY = 1e-16
"""Smallest probability written with digits."""


@of_result
def identification_conclusions(identification: Identification, units: UnitSystem) -> Conclusions:
    """The conclusions, with numbers in ``units``; ``ok`` if the data determine all and the model explains them."""
    lines = (
        *(group.sentence for group in identification.inseparable),
        *(advice.sentence for advice in identification.advice),
        *_changed_parameters(identification, units),
        *_at_bound(identification, units),
        *_correlated(identification),
        *_priors(identification),
        _rigid(identification.rigid) if identification.rigid else "",
        _starts(identification),
        *_residuals(identification, units),
        _left_out(identification),
        *identification.notes,
    )
    ok = identification.loader is not None and not any(map(beyond_noise, identification.fitted))
    return Conclusions(
        ok, _verdict(identification, units) + _doubt(identification), tuple(line for line in lines if line)
    )


def _verdict(identification: Identification, units: UnitSystem) -> str:
    lost = _with_status(identification, Status.UNDETERMINED)
    count = len(identification.estimates)
    if lost:
        which = "The parameter" if count == 1 else f"{len(lost)} of {count} parameters"
        verb = "is" if len(lost) == 1 else "are"
        return f"{which} {verb} not determined by these data: {_named(lost)}. No loader file is written."
    bound = _with_status(identification, Status.AT_BOUND)
    but = f", but {_named(bound)} ended at {'its' if len(bound) == 1 else 'their'} bound" if bound else ""
    unwritten = " No loader file is written." if bound else ""
    if count == 1:
        (estimate,) = identification.estimates
        value, deviation = (
            _with_unit(estimate, text, units)
            for text in (estimated(estimate, estimate.value, units), error(estimate, units))
        )
        if bound:
            return f"{estimate.unknown.key} ended at its bound, {value}: the data do not determine it. No loader file is written."
        return f"{estimate.unknown.key} is determined: {value} with a standard error of {deviation}."
    shares = [estimate for estimate in identification.estimates if estimate.value and not estimate.unknown.is_phase]
    ordered = sorted(shares or identification.estimates, key=relative_error)
    first, last = ordered[0], ordered[-1]
    return (
        f"{_count_text(count)} parameters are determined{but}: their standard errors are from {percent(relative_error(first))} "
        f"({first.unknown.key}) to {percent(relative_error(last))} ({last.unknown.key}).{unwritten}"
    )


def _doubt(identification: Identification) -> str:
    """A further sentence if the estimates can be off by more than their standard errors."""
    bad = sorted((fitted for fitted in identification.fitted if unexplained(fitted) > UNEXPLAINED), key=unexplained)
    if bad:
        pronoun = "it" if len(identification.estimates) == 1 else "them"
        start = f"But do not rely on {pronoun}: the" if identification.determined else "Besides, the"
        unwritten = " No loader file is written." if identification.determined and identification.within_bounds else ""
        return (
            f" {start} model misses {title_of(bad[-1])} by {percent(unexplained(bad[-1]))}, so it is not the model of this "
            f"machine under this experiment.{unwritten} See its plot. A fit of records includes friction and limits; a fit of "
            "responses does not."
        )
    missed = list(filter(beyond_noise, identification.fitted))
    if not identification.determined or not missed:
        return ""
    loose = [pair for pair in strong_pairs(identification) if abs(pair[2]) > ONE_DIRECTION]
    if loose:
        first, second, size = loose[0]
        return (
            f" But the model misses more than noise, and the data hardly separate {first} from {second} (correlation "
            f"{correlation_text(size)}): both errors can be far larger than the standard errors."
        )
    return f" But the model misses more of {first_two(missed)} than noise, so the estimates can be off by more than these errors."


def first_two(missed: Sequence[Fitted]) -> str:
    """The data with model errors, two of them by name."""
    return " and ".join([*map(title_of, missed[:2]), *(["others"] if len(missed) > 2 else [])])


def _changed_parameters(identification: Identification, units: UnitSystem) -> list[str]:
    """Parameters off the file's value, and those that agree with it."""
    determined = _with_status(identification, Status.DETERMINED)
    moved = sorted(
        (estimate for estimate in determined if differs(estimate)), key=lambda estimate: -abs(change(estimate))
    )
    lines = [_changed_parameter(estimate, units) for estimate in moved[:_MOST_NAMED]]
    if len(moved) > _MOST_NAMED:
        rest = moved[_MOST_NAMED:]
        lines.append(
            f"{_named(rest)} changed too, by at most {_part(max(abs(change(estimate)) for estimate in rest))}; see the table."
        )
    same = [estimate for estimate in determined if not differs(estimate)]
    if same:
        agree, value = ("agrees", "value lies within its") if len(same) == 1 else ("agree", "values lie within their")
        intervals = "interval" if len(same) == 1 else "intervals"
        lines.append(f"{_named(same)} {agree} with the file, whose {value} 95 % {intervals}.")
    return lines


def _changed_parameter(estimate: Estimate, units: UnitSystem) -> str:
    unknown = estimate.unknown
    direction = "above" if estimate.value > unknown.nominal else "below"
    value = _with_unit(estimate, estimated(estimate, estimate.value, units), units)
    size = (
        f"{to_text(math.degrees(abs(change(estimate))), 3)} deg" if unknown.is_phase else _part(abs(change(estimate)))
    )
    text = f"{unknown.key} lies {size} {direction} the file's value, {value} instead of {nominal(estimate, units)}"
    tolerance = unknown.tolerance
    if tolerance is None:
        return f"{text}; the file states no tolerance for it."
    if tolerance.distribution is Distribution.NORMAL and tolerance.peak is not None and tolerance.deviation is not None:
        share = abs(estimate.value - tolerance.peak) / tolerance.deviation
        return f"{text}; that is {to_text(share, 2)} standard deviations of its tolerance."
    low, high = ((bound - unknown.nominal) / unknown.scale for bound in (tolerance.low, tolerance.high))
    return f"{text}; its tolerance allows {_signed(low)} to {_signed(high)}."


def _at_bound(identification: Identification, units: UnitSystem) -> list[str]:
    """Parameters at a bound, with remedies."""
    lines = []
    for estimate in _with_status(identification, Status.AT_BOUND):
        unknown, limits = estimate.unknown, limits_si(TABLE[estimate.unknown.key])
        k = int(abs(estimate.value - unknown.high) < abs(estimate.value - unknown.low))
        bound, end, direction = (unknown.low, unknown.high)[k], ("lower", "upper")[k], ("smaller", "larger")[k]
        value = _with_unit(estimate, estimated(estimate, bound, units), units)
        remedy = "The bound is the file's tolerance: widen or remove it if the machine may deviate that far."
        others = [key for pair in AT_LEAST if unknown.key in pair for key in pair if key not in identification.keys]
        if others and identification.before[others[0]] == bound:
            remedy = f"The bound is {others[0]}: fit both, or leave {unknown.key} out."
        elif unknown.tolerance is None or bound == limits[k]:
            remedy = "The bound is the end of the valid range: check the units and the experiment of the data."
        lines.append(
            f"{unknown.key} ended at its {end} bound, {value} ({_signed(change(estimate))}): the data require a "
            f"{direction} value. {remedy}"
        )
    return lines


def _correlated(identification: Identification) -> list[str]:
    """The most correlated pairs."""
    pairs = strong_pairs(identification)
    lines = []
    for first, second, size in pairs[:_MOST_NAMED]:
        verb = "rises" if size > 0 else "falls"
        lines.append(
            f"{first} and {second} are correlated: when one rises the other {verb} (correlation {correlation_text(size)}). The "
            "data determine a combination of them better than each."
        )
    if len(pairs) > _MOST_NAMED:
        lines.append(f"{len(pairs) - _MOST_NAMED} more pairs are correlated beyond {STRONG:g}; see the map.")
    return lines


def correlation_text(size: float) -> str:
    """Three digits, without rounding to 1."""
    return to_text(size, 3) if abs(size) < _NEARLY_ONE else f"beyond {math.copysign(0.999, size)}"


def strong_pairs(identification: Identification) -> list[tuple[str, str, float]]:
    """Pairs of determined parameters with correlated estimates, the strongest first, and their correlation."""
    determined = [
        k for k, estimate in enumerate(identification.estimates) if estimate.status is not Status.UNDETERMINED
    ]
    pairs = [
        (identification.keys[i], identification.keys[j], float(identification.correlation[i, j]))
        for a, i in enumerate(determined)
        for j in determined[a + 1 :]
    ]
    return sorted((pair for pair in pairs if abs(pair[2]) > STRONG), key=lambda pair: -abs(pair[2]))


def _priors(identification: Identification) -> list[str]:
    """Estimates that depend on the file's tolerance."""
    leaning = [
        estimate
        for estimate in identification.estimates
        if estimate.status is not Status.UNDETERMINED
        and estimate.unknown.prior
        and estimate.share > _PRIOR_COUNTS * _half(estimate)
    ]
    return [
        f"{estimate.unknown.key} depends on the loader file's prior: from the data alone its 95 % interval is "
        f"±{percent(estimate.share)} in place of ±{percent(_half(estimate))}."
        for estimate in leaning[:_MOST_NAMED]
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
    """``p = 0.03``, or an upper bound for a very small one."""
    if test.probability < _LEAST_PROBABILITY:
        return f"p < {_LEAST_PROBABILITY:.0e}"
    return f"p = {to_text(test.probability, 2)}"


def _starts(identification: Identification) -> str:
    count, same = len(identification.ends), sum(end.same for end in identification.ends)
    if count <= 1:
        return "The search started only once, at the file's values; for a search of other minima see --starts."
    if same == count:
        return f"{_count_text(count)} starts of the search ended in the same minimum."
    other = min(worse(identification, end) for end in identification.ends if not end.same)
    text = f"{same} of {count} starts of the search ended in the same, best minimum"
    if other < _SAME_LEFT:
        return f"{text}; another minimum explains the data about as well, so make a further experiment before you rely on this one."
    return f"{text}; the others ended in worse ones, the next best with {to_text(other, 3)} times the residual."


def worse(identification: Identification, end: Ended) -> float:
    """Residual at an end relative to the best one: the exponential of the difference of their costs."""
    return math.exp(min(end.cost - min(other.cost for other in identification.ends), _FAR))


def _residuals(identification: Identification, units: UnitSystem) -> list[str]:
    """Residuals of the model, with the stated noise."""
    lines = [text for fitted in identification.fitted if (text := model_error(fitted, units))]
    named = [f"{title_of(fitted)}: {size_text(fitted, fitted.residual_rms, units)}" for fitted in identification.fitted]
    if named:
        more = f"; {len(named) - _MOST_NAMED} more are in the table" if len(named) > _MOST_NAMED else ""
        lines.append(f"Residual of the fit (r.m.s.): {'; '.join(named[:_MOST_NAMED])}{more}.")
    return lines


def _left_out(identification: Identification) -> str:
    """Effects that responses do not include."""
    rows = beyond_linear(identification.before)
    if not rows or not any(isinstance(fitted.data, Response) for fitted in identification.fitted):
        return ""
    if identification.before["controller.period"]:
        return (
            "Responses are compared with the sampled linear model, which neglects friction, stops, limits and rounding; "
            "records are "
            "compared with the full model."
        )
    return f"Responses are compared with the linear model, which neglects {rows}; records are compared with the full model."


def change(estimate: Estimate) -> float:
    """Change from the file's value, as a share of it."""
    return (estimate.value - estimate.unknown.nominal) / estimate.unknown.scale


def differs(estimate: Estimate) -> bool:
    """Whether the file's value lies outside the 95 % interval."""
    return not estimate.low <= estimate.unknown.nominal <= estimate.high


def _with_status(identification: Identification, status: Status) -> list[Estimate]:
    return [estimate for estimate in identification.estimates if estimate.status is status]


def _named(estimates: list[Estimate]) -> str:
    names = [estimate.unknown.key for estimate in estimates]
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def _half(estimate: Estimate) -> float:
    """Half the 95 % interval as a share of the value."""
    return (estimate.high - estimate.low) / 2 / abs(estimate.value) if estimate.value else math.inf


def _count_text(count: int) -> str:
    return "Both" if count == 2 else f"All {count}"


def _with_unit(estimate: Estimate, value: str, units: UnitSystem) -> str:
    return f"{value} {unit_of(estimate, units)}".strip()


def _part(share: float) -> str:
    """A part of a value in percent, three digits: +13.7 % is not +14 %."""
    return f"{to_text(100 * share, 3)} %"


def _signed(share: float) -> str:
    return f"{'+' if share > 0 else ''}{_part(share)}"
