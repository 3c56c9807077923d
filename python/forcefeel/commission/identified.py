"""The first step: the loader from what the records see of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from forcefeel.bench.channels import GRIP_FORCE
from forcefeel.bench.identification.bench_of import check_bench
from forcefeel.bench.identification.findings import first_two, identification_conclusions
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.fitted_loader import normal_about
from forcefeel.bench.identification.grip_sensor import GripSensorFound, find_grip_sensor
from forcefeel.bench.identification.misfit import beyond_noise, runs_on_and_jumps
from forcefeel.bench.identification.result import Identification
from forcefeel.bench.identification.unknowns import parameter_keys
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.commission.curve import curve_of
from forcefeel.commission.fits import Fits, fit_what_is_seen
from forcefeel.commission.observability import BREAKAWAY, DRY
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import AT_END, CARRIED, IDENTIFIED, NOTHING, Identified, ParameterFound
from forcefeel.commission.sensor_lag import SENSOR_OF, without_lag
from forcefeel.laws.law import Law
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import ELECTRIC, TABLE, value_text
from forcefeel.loader.sensors import GRIP_SENSOR, sample_variance, sensors_of, without_grip_sensor

_FRICTION_OPEN = (
    "The data do not determine the dry friction of the column: they are frequency responses, or the column hardly breaks away "
    "or never reverses in them. A law without it mistakes friction for a hand."
)

_RECORD_FRICTION = (
    "Add a record with many reversals, such as a multisine of a minute (excite) or a slow sweep of force both ways (experiment: "
    "sweep); or state column.coulomb_friction in the loader file and name the other parameters with --fit."
)


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
    if not plan.own_instruments:
        data = [without_lag(one, loader) if isinstance(one, BenchRecord) else one for one in data]
    # The bench ran under the law of the file, which knows of no friction that is only a place to begin from.
    law = Law.of(None, bare) if loader.drive == ELECTRIC else None
    if given:
        progress(f"fit of {len(given)} parameters")
        fits = Fits(identify(bare, data, given, law=law, starts=plan.starts))
    else:
        fits = fit_what_is_seen(bare, data, law, plan, progress)
    found = fits.found
    identified, grip = None, GripSensorFound()
    if found.loader is not None:
        with_sensor = found.loader.replace({key: loader[key] for key in TABLE if loader[key] != bare[key]}, si=True)
        completed = _completed(with_sensor, loader, fits)
        grip = find_grip_sensor(completed, data, law)
        identified = _with_found(completed, grip)
    open_friction, remedy = ((_FRICTION_OPEN,), (_RECORD_FRICTION,)) if fits.friction_open else ((), ())
    missed = _missed(found, plan) if identified else ()
    wanting = (*open_friction, *missed, *grip.wrong, *_noise_wanting(loader, found, grip.noise))
    good = identified is not None and not wanting
    conclusions = identification_conclusions(replace(found, loader=identified), plan.units)
    outcome = Identified(
        good=good,
        verdict=" ".join((conclusions.verdict, *_beside_the_fit(grip))),
        findings=conclusions.findings,
        parameters=_parameters(loader, fits, grip) if identified else (),
        wanting=wanting,
        advice=(*(one.sentence for one in found.advice), *remedy, *grip.advice),
        noticed=grip.said,
        curve=curve_of(found.fitted) if identified and found.fitted else None,
    )
    return IdentifiedLoader(outcome, replace(found, loader=identified), identified)


def _completed(found: Loader, loader: Loader, fits: Fits) -> Loader:
    """The loader of a fit, with the tolerances of its file where its value stands and none where the estimates carry them."""
    carried = [*fits.without.get(CARRIED, ()), *fits.without.get(AT_END, ())]
    told = {*fits.found.keys, *carried, *((DRY, BREAKAWAY) if fits.without.get(NOTHING) else ())}
    stands = [key for key in loader.tolerances if key not in told and found[key] == loader[key]]
    kept = {key: loader.tolerances[key] for key in stands}
    return found.with_tolerances({**kept, **{key: normal_about(key, found[key], 0.0) for key in carried}})


def _with_found(loader: Loader, grip: GripSensorFound) -> Loader:
    """The loader with what its grip's sensor showed, as sure as that is."""
    bare = loader.with_tolerances(dict.fromkeys(key for key in grip.rows if key in loader.tolerances))
    told = bare.replace({key: value for key, (value, _) in grip.rows.items()}, si=True)
    return told.with_tolerances({key: normal_about(key, *it) for key, it in grip.rows.items()})


def _beside_the_fit(grip: GripSensorFound) -> tuple[str, ...]:
    """What is identified of the grip's sensor, which no motion of the loader shows."""
    return (f"{GRIP_FORCE} determines {' and '.join(grip.rows)} beside them.",) if grip.rows else ()


def _parameters(loader: Loader, fits: Fits, grip: GripSensorFound) -> tuple[ParameterFound, ...]:
    rows = [
        ParameterFound(
            one.unknown.key, loader[one.unknown.key], one.value, one.deviation / abs(one.value or 1.0), IDENTIFIED
        )
        for one in fits.found.estimates
    ]
    rows += [
        ParameterFound(key, loader[key], value, deviation / abs(value), IDENTIFIED)
        for key, (value, deviation) in grip.rows.items()
    ]
    for state, keys in fits.without.items():
        rows += [ParameterFound(key, loader[key], fits.found.before[key], 0.0, state) for key in dict.fromkeys(keys)]
    order = list(TABLE)
    finite = [replace(row, before=row.before if np.isfinite(row.before) else 0.0) for row in rows]
    return tuple(sorted(finite, key=lambda row: order.index(row.key)))


def _missed(found: Identification, plan: CommissionPlan) -> tuple[str, ...]:
    """What the fitted model misses beyond noise: its parameters are off by more than their tolerances say."""
    missed = [one for one in found.fitted if beyond_noise(one)]
    if not missed:
        return ()
    remedy = (
        "identify all that the data determine: leave out --fit" if plan.fit else "look at the plots of what is left"
    )
    return (
        f"The model misses more of {first_two(missed)} than noise, so parameters can be off by more than their standard errors, "
        f"and a law for them is made for another machine; {remedy}.",
    )


def _noise_wanting(loader: Loader, found: Identification, at_grip: float | None) -> tuple[str, ...]:
    """Sensors whose noise is declared as zero, with what the records show; a law for them is made for sensors that nobody has."""
    measured = {
        SENSOR_OF[one.channel]: runs_on_and_jumps(one.measured.real - one.modelled.real)[1]
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
