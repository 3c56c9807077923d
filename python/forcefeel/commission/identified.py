"""The first step: the loader from what the records see of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from forcefeel.bench.identification.bench_of import check_bench
from forcefeel.bench.identification.findings import identification_conclusions
from forcefeel.bench.identification.fit import identify, unseen_from_afar
from forcefeel.bench.identification.grip_sensor import GripSensorFound, find_grip_sensor
from forcefeel.bench.identification.result import Estimate, Identification, Status
from forcefeel.bench.identification.unknowns import parameter_keys
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import AT_END, CARRIED, IDENTIFIED, NOTHING, UNSEEN, Identified, ParameterFound
from forcefeel.commission.seen import BREAKAWAY, DRY, Seen, candidates, seen_by, with_friction
from forcefeel.commission.sensor_lag import SENSOR_OF, without_lag
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, TABLE, limits_si, value_text
from forcefeel.loader.sensors import GRIP_SENSOR, sample_variance, sensors_of, without_grip_sensor
from forcefeel.loader.tolerances import Distribution, Tolerance

_ROUNDS = 4
"""Most fits: after each, what it does not determine is left out."""

_EXACT = 1e-6
"""Relative deviation of a parameter whose share in the data others carry: with their estimates its value is as good as any."""

_ROUNDING = 1e-6
"""Of an estimate, relative to where its search began."""

_NEGLIGIBLE = 0.01
"""Of the friction where its search begins, the spring's pull at a degree: it holds the column within a hundredth of one."""

_WIDE = 3.0
"""Deviations at which its tolerance is cut off."""


@dataclass(frozen=True, eq=False)
class IdentifiedLoader:
    """What the first step hands on.

    Attributes:
        outcome: In numbers and sentences.
        found: The last fit.
        loader: The loader; ``None`` where the data do not do.
    """

    outcome: Identified
    found: Identification
    loader: Loader | None


def identify_loader(
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    plan: CommissionPlan,
    progress: Callable[[str], None] = lambda _: None,
) -> IdentifiedLoader:
    """Finds what of a loader the data determine, and the loader with it.

    Args:
        loader: As its file has it.
        data: Records and responses.
        plan: What is asked.
        progress: Told what is being done.

    Raises:
        InputError: If data are not of this loader, or not what they are said to be.
    """
    check_bench(loader, data)
    given = parameter_keys(tuple(plan.fit), loader.drive) if plan.fit else ()
    bare = without_grip_sensor(loader)  # the machine is the same, and no law on a bench uses what is yet to be tried
    begun = with_friction(bare) if not given else bare
    if not plan.own_instruments:
        data = [without_lag(one, loader) if isinstance(one, BenchRecord) else one for one in data]
    progress("what the data see")
    # The bench ran under the law of the file, which knows of no friction that is only a place to begin from.
    law = Law.of(None, bare) if loader.drive == ELECTRIC else None
    seen = Seen(given, (), ()) if given else seen_by(begun, data, candidates(begun), law)
    unseen, ended, nothing = list(seen.unseen), list[str](), list[str]()
    lost = DRY if DRY not in seen.fitted and not given else ""
    keys = [key for key in seen.fitted if not (lost and key == BREAKAWAY)]
    begun = _without(begun, lost)
    if not given and BREAKAWAY in keys and BREAKAWAY in unseen_from_afar(begun, data, keys, law):
        keys, begun = [key for key in keys if key != BREAKAWAY], _without(begun, BREAKAWAY)
    for _ in range(_ROUNDS):
        progress(f"fit of {len(keys)} parameters")
        try:
            found = identify(begun, data, keys, law=law, starts=plan.starts)
        except InputError as error:
            # A breakaway that the data do not determine stays where the search began, and may lie below the dry friction.
            if given or BREAKAWAY not in keys or BREAKAWAY not in str(error):
                raise
            keys, begun = [key for key in keys if key != BREAKAWAY], _without(begun, BREAKAWAY)
            found = identify(begun, data, keys, law=law, starts=plan.starts)
        status = {one.unknown.key: one for one in found.estimates}
        none = [key for key, one in status.items() if key in (DRY, BREAKAWAY) and _is_none(one)]
        weak = [key for key, one in status.items() if _is_open(one)]
        if BREAKAWAY in weak and not given:
            weak = [BREAKAWAY]  # the jumps that it makes leave others open too, which are determined without it
        held = [key for key, one in status.items() if _at_end(one, loader[key])]
        if given or not (none or weak or held) or len(none) + len(weak) + len(held) == len(keys):
            break
        if DRY in weak and DRY not in none:
            lost = DRY
        out = {*none, *weak, *held, *([BREAKAWAY] if DRY in (*none, *weak) else [])}
        unseen += [key for key in weak if key not in (DRY, BREAKAWAY)]
        ended += held
        nothing += {DRY} & set(none)
        keys = [key for key in keys if key not in out]
        for key in out & {DRY, BREAKAWAY}:
            begun = _without(begun, key)
    identified = None if found.loader is None else _completed(found, loader, (*seen.carried, *ended))
    if identified is not None:
        identified = identified.replace({key: loader[key] for key in TABLE if loader[key] != bare[key]})
    grip = GripSensorFound() if identified is None else find_grip_sensor(identified, data, law)
    if identified is not None:
        identified = identified.replace({key: value for key, (value, _) in grip.rows.items()})
    wanting = (*_friction_wanting(lost), *grip.wrong, *_noise_wanting(loader, found, grip.noise))
    good = identified is not None and not wanting
    conclusions = identification_conclusions(replace(found, loader=identified), plan.units)
    outcome = Identified(
        good=good,
        verdict=conclusions.verdict,
        findings=(*conclusions.findings, *grip.said),
        parameters=_parameters(
            loader, found, grip, {CARRIED: seen.carried, AT_END: ended, NOTHING: nothing, UNSEEN: unseen}
        )
        if identified
        else (),
        wanting=wanting,
        advice=(*(one.sentence for one in found.advice), *_friction_advice(lost), *grip.advice),
    )
    return IdentifiedLoader(outcome, replace(found, loader=identified), identified)


def _is_none(one: Estimate) -> bool:
    """Whether a friction is none: all of its 95 % interval is next to nothing, or it is itself but for rounding."""
    return one.high < _NEGLIGIBLE * one.unknown.scale or one.value < _ROUNDING * one.unknown.scale


def _is_open(one: Estimate) -> bool:
    """Whether the data do not determine a parameter: of a friction, whether it may be none and may be more."""
    dry = one.unknown.key in (DRY, BREAKAWAY)
    return one.status is Status.UNDETERMINED or (dry and one.low <= 0 and not _is_none(one))


def _at_end(one: Estimate, stated: float) -> bool:
    """Whether an estimate ended at the end of its range, where the file's value stands."""
    return one.status is Status.AT_BOUND and bool(stated) and abs(one.value / stated - 1) < _ROUNDING


def _without(loader: Loader, key: str) -> Loader:
    """The loader without a friction."""
    if not key:
        return loader
    rows = (DRY, BREAKAWAY) if key == DRY else (key,)
    bare = loader.with_tolerances(dict.fromkeys(row for row in rows if row in loader.tolerances))
    return bare.replace(dict.fromkeys(rows))


def _completed(found: Identification, loader: Loader, carried: Sequence[str]) -> Loader | None:
    """The loader of a fit, with the tolerances of its file where nothing was found and none where the estimates carry them."""
    if found.loader is None:
        return None
    kept = {key: it for key, it in loader.tolerances.items() if key not in found.keys and key not in carried}
    exact = {key: _exact(key, found.loader[key]) for key in carried}
    return found.loader.with_tolerances({**kept, **exact})


def _exact(key: str, value: float) -> Tolerance:
    deviation = _EXACT * abs(value)
    least, most = limits_si(TABLE[key])
    low, high = max(value - _WIDE * deviation, least), min(value + _WIDE * deviation, most)
    return Tolerance(Distribution.NORMAL, low, high, peak=value, deviation=deviation, nominal=value)


def _parameters(
    loader: Loader, found: Identification, grip: GripSensorFound, others: Mapping[str, Sequence[str]]
) -> tuple[ParameterFound, ...]:
    rows = [
        ParameterFound(
            one.unknown.key, loader[one.unknown.key], one.value, one.deviation / abs(one.value or 1.0), IDENTIFIED
        )
        for one in found.estimates
    ]
    rows += [
        ParameterFound(key, loader[key], value, deviation / abs(value), IDENTIFIED)
        for key, (value, deviation) in grip.rows.items()
    ]
    for state, keys in others.items():
        rows += [ParameterFound(key, loader[key], found.before[key], 0.0, state) for key in dict.fromkeys(keys)]
    order = list(TABLE)
    finite = [replace(row, before=row.before if np.isfinite(row.before) else 0.0) for row in rows]
    return tuple(sorted(finite, key=lambda row: order.index(row.key)))


def _friction_wanting(lost: str) -> tuple[str, ...]:
    if not lost:
        return ()
    return (
        "The data do not determine the dry friction of the column: they are frequency responses, or it hardly breaks away "
        "in them, or never turns round. A law that does not know of it takes it for a hand that pulls.",
    )


def _friction_advice(lost: str) -> tuple[str, ...]:
    if not lost:
        return ()
    return (
        "Record the loader in time through many reversals, such as a multisine of a minute (excite) or a slow sweep of force both "
        "ways (experiment: sweep), and give that beside these data; or state column.coulomb_friction in the loader file and name "
        "with --fit what else is to be identified.",
    )


def _noise_wanting(loader: Loader, found: Identification, at_grip: float | None) -> tuple[str, ...]:
    """Sensors whose noise is declared as zero, with what the records show; a law for them is made for sensors that nobody has."""
    measured = {
        SENSOR_OF[one.channel]: one.residual_rms
        for one in found.fitted
        if one.channel in SENSOR_OF and isinstance(one.data, BenchRecord)
    } | ({} if at_grip is None else {GRIP_SENSOR: at_grip})
    lines = []
    for sensor, variance in zip(sensors_of(loader), sample_variance(loader), strict=True):
        if variance > 0 or not loader["controller.period"]:
            continue
        key = f"{sensor}.noise"
        if sensor in measured:
            least = value_text(TABLE[key], measured[sensor], 2)
            shown = f"the records show {least} r.m.s."
            remedy = f'state it in the loader file, or with --set {key}="{least}"'
        else:
            shown, remedy = (
                "no record says how large it is",
                "state it in the loader file, from the sensor's data sheet",
            )
        lines.append(
            f"{key} is declared as zero, and {shown}: a law designed for it trusts the sensor without limit; {remedy}."
        )
    return tuple(lines)
