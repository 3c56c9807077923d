"""The first step: identification of the loader from records."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from forcefeel.bench.channels import GRIP_FORCE
from forcefeel.bench.identification.bench_of import check_bench
from forcefeel.bench.identification.findings import first_two, identification_conclusions
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.fitted_loader import normal_about
from forcefeel.bench.identification.grip_sensor import GripSensorEstimate, find_grip_sensor
from forcefeel.bench.identification.misfit import beyond_noise, runs_on_and_jumps
from forcefeel.bench.identification.result import Identification
from forcefeel.bench.identification.unknowns import parameter_keys
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.bench.run_law import law_of_runs
from forcefeel.commission.curve import curve_of
from forcefeel.commission.fits import Fits, fit_what_is_seen
from forcefeel.commission.friction_drift import drift_sentence, with_drift
from forcefeel.commission.observability import BREAKAWAY, DRY
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.result import AT_END, CARRIED, IDENTIFIED, NOTHING, Identified, IdentifiedParameter
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
    """Result of the first step.

    Attributes:
        outcome: Numbers and sentences.
        identification: The last fit.
        loader: The loader; ``None`` if the data are insufficient.
    """

    outcome: Identified
    identification: Identification
    loader: Loader | None


def identify_loader(
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    plan: CommissionPlan,
    progress: Callable[[str], None] = lambda _: None,
) -> IdentifiedLoader:
    """Identify the parameters of a loader that the data determine.

    Raises:
        InputError: If data are not of this loader, or contradict their labels.
    """
    check_bench(loader, data)
    requested = parameter_keys(tuple(plan.fit), loader.drive) if plan.fit else ()
    bare = without_grip_sensor(loader)  # no law on a bench uses a sensor that is not yet identified
    if not plan.own_instruments:
        data = [
            without_lag(measurement, loader) if isinstance(measurement, BenchRecord) else measurement
            for measurement in data
        ]
    # Otherwise the bench ran under the law of the file, without the start value of the friction.
    law = law_of_runs(data, loader) or (Law.of(None, bare) if loader.drive == ELECTRIC else None)
    if requested:
        progress(f"fit of {len(requested)} parameters")
        fits = Fits(identify(bare, data, requested, law=law, starts=plan.starts))
    else:
        fits = fit_what_is_seen(bare, data, law, plan, progress)
    identification = fits.identification
    identified, grip, noticed = None, GripSensorEstimate(), list[str]()
    if identification.loader is not None:
        with_sensor = identification.loader.replace(
            {key: loader[key] for key in TABLE if loader[key] != bare[key]}, si=True
        )
        completed = _completed(with_sensor, loader, fits)
        grip = find_grip_sensor(completed, data, law)
        identified = _with_grip_sensor(completed, grip)
        identified, widened = with_drift(identified)
        noticed += [*grip.notes, *drift_sentence(widened)]
    open_friction, remedy = ((_FRICTION_OPEN,), (_RECORD_FRICTION,)) if fits.friction_open else ((), ())
    missed = _missed(identification, plan) if identified else ()
    wanting = (*open_friction, *missed, *grip.wrong, *_noise_wanting(loader, identification, grip.noise))
    ok = identified is not None and not wanting
    conclusions = identification_conclusions(replace(identification, loader=identified), plan.units)
    outcome = Identified(
        ok=ok,
        verdict=" ".join((conclusions.verdict, *_beside_the_fit(grip))),
        findings=conclusions.findings,
        parameters=_parameters(loader, fits, grip) if identified else (),
        wanting=wanting,
        advice=(*(advice.sentence for advice in identification.advice), *remedy, *grip.advice),
        noticed=tuple(noticed),
        curve=curve_of(identification.fitted) if identified and identification.fitted else None,
    )
    return IdentifiedLoader(outcome, replace(identification, loader=identified), identified)


def _completed(identified: Loader, loader: Loader, fits: Fits) -> Loader:
    """The loader of a fit, with the file's tolerances of unchanged values, and none for values within other estimates."""
    carried = [*fits.without.get(CARRIED, ()), *fits.without.get(AT_END, ())]
    known = {*fits.identification.keys, *carried, *((DRY, BREAKAWAY) if fits.without.get(NOTHING) else ())}
    unchanged = [key for key in loader.tolerances if key not in known and identified[key] == loader[key]]
    tolerances = {key: loader.tolerances[key] for key in unchanged}
    return identified.with_tolerances(
        {**tolerances, **{key: normal_about(key, identified[key], 0.0) for key in carried}}
    )


def _with_grip_sensor(loader: Loader, grip: GripSensorEstimate) -> Loader:
    """The loader with the identified rows of its grip sensor and their tolerances."""
    bare = loader.with_tolerances(dict.fromkeys(key for key in grip.rows if key in loader.tolerances))
    completed = bare.replace({key: value for key, (value, _) in grip.rows.items()}, si=True)
    return completed.with_tolerances({key: normal_about(key, *row) for key, row in grip.rows.items()})


def _beside_the_fit(grip: GripSensorEstimate) -> tuple[str, ...]:
    """A remark on the identified rows of the grip sensor."""
    return (f"{GRIP_FORCE} determines {' and '.join(grip.rows)} beside them.",) if grip.rows else ()


def _parameters(loader: Loader, fits: Fits, grip: GripSensorEstimate) -> tuple[IdentifiedParameter, ...]:
    rows = [
        IdentifiedParameter(
            estimate.unknown.key,
            loader[estimate.unknown.key],
            estimate.value,
            estimate.deviation / abs(estimate.value or 1.0),
            IDENTIFIED,
        )
        for estimate in fits.identification.estimates
    ]
    rows += [
        IdentifiedParameter(key, loader[key], value, deviation / abs(value), IDENTIFIED)
        for key, (value, deviation) in grip.rows.items()
    ]
    for state, keys in fits.without.items():
        rows += [
            IdentifiedParameter(key, loader[key], fits.identification.before[key], 0.0, state)
            for key in dict.fromkeys(keys)
        ]
    order = list(TABLE)
    finite = [replace(row, before=row.before if np.isfinite(row.before) else 0.0) for row in rows]
    return tuple(sorted(finite, key=lambda row: order.index(row.key)))


def _missed(identification: Identification, plan: CommissionPlan) -> tuple[str, ...]:
    """A sentence if the model errs beyond noise, so that parameters may be off by more than their tolerances."""
    missed = [fitted for fitted in identification.fitted if beyond_noise(fitted)]
    if not missed:
        return ()
    remedy = (
        "identify all that the data determine: leave out --fit" if plan.fit else "look at the plots of what is left"
    )
    return (
        f"The model misses more of {first_two(missed)} than noise, so parameters can be off by more than their standard errors, "
        f"and a law for them is made for another machine; {remedy}.",
    )


def _noise_wanting(loader: Loader, identification: Identification, at_grip: float | None) -> tuple[str, ...]:
    """A sentence for each sensor with a declared noise of zero, with its measured noise."""
    measured = {
        SENSOR_OF[fitted.channel]: runs_on_and_jumps(fitted.measured.real - fitted.modeled.real)[1]
        for fitted in identification.fitted
        if fitted.channel in SENSOR_OF and isinstance(fitted.data, BenchRecord)
    } | ({} if at_grip is None else {GRIP_SENSOR: at_grip})
    lines = []
    for sensor, variance in zip(sensors_of(loader), sample_variance(loader), strict=True):
        if variance > 0 or not loader["controller.period"]:
            continue
        key = f"{sensor}.noise"
        if sensor in measured:
            least = value_text(TABLE[key], measured[sensor], 2)
            evidence = f"the records show {least} r.m.s."
            remedy = f'state it in the loader file, or with --set {key}="{least}"'
        else:
            evidence, remedy = (
                "no record says how large it is",
                "state it in the loader file, from the sensor's data sheet",
            )
        lines.append(
            f"{key} is declared as zero, and {evidence}: a law designed for it trusts the sensor without limit; {remedy}."
        )
    return tuple(lines)
