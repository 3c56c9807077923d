"""A loader from bench data."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import GRIP_FORCE, OUTPUTS
from forcefeel.bench.estimate import estimate_response
from forcefeel.bench.experiments import Drive, Loop
from forcefeel.bench.identification.advice import advice_of
from forcefeel.bench.identification.bench_of import check_bench
from forcefeel.bench.identification.confidence import Confidence, half_widths
from forcefeel.bench.identification.fitted_loader import fitted_loader
from forcefeel.bench.identification.inseparable import DETERMINED, inseparable_sets
from forcefeel.bench.identification.linear import LinearModel, bench_law, model_response
from forcefeel.bench.identification.losses import Loss
from forcefeel.bench.identification.misfit import explained
from forcefeel.bench.identification.observations import Observation
from forcefeel.bench.identification.problem import Optimum, Problem
from forcefeel.bench.identification.record_observation import RecordObservation
from forcefeel.bench.identification.record_run import RecordRun
from forcefeel.bench.identification.response_observation import ResponseObservation, relative_error
from forcefeel.bench.identification.result import Estimate, Fitted, Identification, RigidTest, Status
from forcefeel.bench.identification.rigid import rigid_test
from forcefeel.bench.identification.search import from_afar, search
from forcefeel.bench.identification.unknowns import Unknown, parameter_keys, unknowns_of
from forcefeel.bench.plausibility import CLEAR, FAR, distance, misreading
from forcefeel.bench.records import BenchRecord
from forcefeel.bench.responses import Response
from forcefeel.bench.run_law import law_of_runs
from forcefeel.errors import InputError, expect, type_text
from forcefeel.laws.law import Law, LawLike
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import ELECTRIC

_HALF_RATE = 0.499
"""Largest frequency of a line, in cycles per period of the controller."""

MOST_STARTS = 256
"""Largest number of starts."""


def identify(  # noqa: PLR0913  keywords of what is asked
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    fit: str | Sequence[str],
    *,
    law: LawLike = None,
    starts: int = 5,
    begins: Sequence[Mapping[str, float]] = ({},),
    loss: Loss = "huber",
    priors: bool = True,
    as_responses: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Identification:
    """Estimate parameters of a loader from bench data.

    Frequency responses are compared with the linear model, records with the nonlinear one, all at once; the noise of each is found
    along with the parameters. See ``problem`` for the cost and ``confidence`` for the standard errors.

    Args:
        loader: The loader as its file states it. Tolerances bound the search, normal ones are priors.
        data: Responses and records, at least one.
        fit: Symbols or rows of the parameters: ``"k,c,J,C_i"``, of a motor ``"K_t,J_m,k,c,J"``.
        law: The law of the whole loader in the data; default, the original loop, or ``robust`` for a motor.
        starts: Number of starts of the search: those of ``begins``, then others within tolerance.
        begins: Values of the first starts by row, SI units, such as those of another fit; the file's for other rows.
        loss: ``huber`` lets residuals beyond three standard deviations count less; ``linear`` is plain least squares.
        priors: Whether normal tolerances are priors.
        as_responses: Convert records into frequency responses first, and use only the linear model.
        progress: Called with the number of finished searches and of all.

    Returns:
        The identification; its ``loader`` is ``None`` if a parameter is undetermined or ends at its bound.

    Raises:
        InputError: If a parameter cannot be fitted, there are no data or fewer points than unknowns, data contradict their stated
            experiment or channels, or the model diverges at every start.

    Example:
        >>> data = [ff.read_bench_data("examples/bench/servo-closed.csv")]
        >>> identification = ff.identify(ff.load("examples/bench/loader.toml"), data, "k,c", starts=1)
        >>> identification["k"].status.value
        'determined'
    """
    check_loader(loader)
    expect("fit", fit, (str, Sequence), 'symbols or rows of parameters such as "k,c,J"')
    if isinstance(data, str) or not isinstance(data, Sequence):
        raise InputError(
            f"data: expected a list of responses and records, as read_bench_data reads them, got {type_text(data)}"
        )
    for measurement in data:
        expect("data", measurement, (Response, BenchRecord), "responses and records, as read_bench_data reads them")
    keys = parameter_keys(fit, loader.drive)
    unknowns = unknowns_of(loader, keys)
    if not data:
        raise InputError("data: expected a frequency response or a record, got none")
    if not 1 <= starts <= MOST_STARTS:
        raise InputError(f"starts: expected 1 to {MOST_STARTS}, got {starts}")
    check_bench(loader, data)
    law = law_of_runs(data, loader) if law is None else law
    _check_valve(loader, keys, data, as_responses=as_responses)
    if loader.drive == ELECTRIC and any(measurement.experiment.loop is Loop.LOADER for measurement in data):
        law = Law.of(bench_law(law, loader), loader)  # designed or read once, for the loader as its file has it
    used = [
        part for measurement in data for part in (_as_responses(measurement, loader) if as_responses else [measurement])
    ]
    with_responses = [
        (measurement, [measurement] if isinstance(measurement, Response) else _seen_in(measurement, loader))
        for measurement in data
    ]
    for measurement, responses in with_responses:
        _suspect(loader, law, measurement, responses)
    problem = Problem(unknowns, [_observe(measurement, loader, keys, law) for measurement in used], loss, priors)
    _check_points(problem)
    first = np.array([[begin.get(unknown.key, unknown.nominal) for unknown in unknowns] for begin in begins])
    optimum, confidence, ends = search(problem, (first, starts), progress or (lambda done, total: None))
    estimates = _estimates(unknowns, problem, optimum, confidence)
    estimated_loader = _at_estimates(loader, estimates)
    compared = (
        [(measurement, [measurement]) for measurement in used if isinstance(measurement, Response)]
        if as_responses
        else with_responses
    )
    rigid, notes = _rigid(estimated_loader, law, unknowns, compared)
    identified = Identification(
        before=loader,
        estimates=estimates,
        correlation=confidence.correlation,
        fitted=_fitted(problem, optimum),
        ends=ends,
        inseparable=inseparable_sets(unknowns, confidence),
        advice=(),
        rigid=rigid,
        notes=(*notes, *_beside(data), *_jump(keys), *_made_for_another(law, loader)),
    )
    if identified.determined:
        sound = explained(identified.fitted) and identified.within_bounds
        return replace(identified, loader=fitted_loader(identified)) if sound else identified
    recorded = any(isinstance(measurement, BenchRecord) for measurement in used)
    advice = advice_of(estimated_loader, law, unknowns, confidence.information, recorded=recorded)
    return replace(identified, advice=advice)


def unseen_from_afar(
    loader: Loader, data: Sequence[Response | BenchRecord], keys: Sequence[str], law: LawLike = None
) -> tuple[str, ...]:
    """Parameters that the data will hardly determine, judged at the end of a search over the beginning of the data.

    A parameter with only jumps in the residual misleads the search and takes most of its time. Call this before ``identify``,
    with the same arguments, for parameters that may be left out.
    """
    unknowns = unknowns_of(loader, keys)
    confidence = from_afar(Problem(unknowns, [_observe(measurement, loader, keys, law) for measurement in data]))
    if confidence is None:
        return ()
    shares = confidence.quantile * half_widths(confidence.information)
    return tuple(unknown.key for unknown, share in zip(unknowns, shares, strict=True) if not share < DETERMINED)


def _beside(data: Sequence[Response | BenchRecord]) -> tuple[str, ...]:
    """Remarks on recorded channels without a fitted parameter."""
    gripped = any(
        isinstance(measurement, BenchRecord) and np.ptp(measurement.channels.get(GRIP_FORCE, 0.0)) > 0
        for measurement in data
    )
    sentence = f"{GRIP_FORCE} measures the hand and is not compared. To identify the sensor at the grip, run forcefeel commission."
    return (sentence,) * gripped


def _jump(keys: Sequence[str]) -> tuple[str, ...]:
    """A remark on a breakaway that is fitted as a jump."""
    sentence = (
        "The standard error of F_s holds only if the friction falls from breakaway at once. One that falls over a velocity reads "
        "as another breakaway: state column.stribeck_velocity and fit omega_s too."
    )
    return (sentence,) * ("column.static_friction" in keys and "column.stribeck_velocity" not in keys)


def _check_valve(
    loader: Loader, keys: Sequence[str], data: Sequence[Response | BenchRecord], *, as_responses: bool
) -> None:
    """Refuse the valve's gains at an operating point if records are simulated with its orifice."""
    gains = [key for key in ("valve.current_gain", "valve.pressure_gain") if key in keys]
    runs = any(isinstance(measurement, BenchRecord) for measurement in data) and not as_responses
    if gains and loader["valve.orifice"] and (runs or loader["controller.period"]):
        raise InputError(
            f"fit: the loader's flow follows the orifice, eq. (1), which has no {' and '.join(gains)}; fit valve.rated_flow (q_r), "
            "or take valve.orifice out of the loader file"
        )


def _as_responses(data: Response | BenchRecord, loader: Loader) -> list[Response]:
    """The responses of a record to every measured channel, or a response itself."""
    if isinstance(data, Response):
        return [data]
    if data.experiment.drive is Drive.RELEASE:
        raise InputError(f"{data.name}: a release has no frequency response; leave it out, or fit records as they are")
    return [_response_of(data, channel, loader) for channel in data.channels if channel in OUTPUTS]


def _response_of(record: BenchRecord, channel: str, loader: Loader) -> Response:
    """A record's response to a channel, below half the rate of the loader's controller."""
    estimate = estimate_response(record, channel)
    below_half_rate = estimate.frequency_hz * loader["controller.period"] < _HALF_RATE
    coherence, deviation = (
        None if array is None else array[below_half_rate] for array in (estimate.coherence, estimate.deviation)
    )
    lines, value = estimate.frequency_hz[below_half_rate], estimate.value[below_half_rate]
    return replace(estimate, frequency_hz=lines, value=value, coherence=coherence, deviation=deviation)


def _suspect(loader: Loader, law: LawLike, data: Response | BenchRecord, responses: Sequence[Response]) -> None:
    """Refuse responses whose labels contradict the model of the loader file."""
    for response in responses:
        arguments = loader, response.experiment, response.input, response.output, response.frequency_hz
        predicted = model_response(*arguments, law=law)
        answers = bool(np.all(np.isfinite(predicted) & (predicted != 0)))
        if answers and isinstance(data, BenchRecord):
            _check_polarity(response, predicted)
        elif answers and (sentence := misreading(response, predicted)):
            raise InputError(sentence)
        elif not answers and isinstance(data, Response):
            raise InputError(
                f"{response.name}: nothing of {response.input} reaches {response.output} in the model ({response.experiment}); "
                "expected a channel that answers; correct the experiment or leave the response out"
            )


def _check_polarity(response: Response, predicted: NDArray[np.complex128]) -> None:
    """Refuse a record's channel of reversed sign; its response is estimated here and has no other labeling errors."""
    as_read = distance(response.value, predicted)
    if as_read > FAR and distance(-response.value, predicted) < CLEAR * as_read:
        raise InputError(f"{response.name}: the polarity seems reversed; turn the sign of one channel")


def _seen_in(record: BenchRecord, loader: Loader) -> list[Response]:
    """The responses of a record, if any: uneven samples, steps, slow sweeps and releases have none."""
    responses = []
    for name in record.channels if record.experiment.drive is not Drive.RELEASE else ():
        if name in OUTPUTS:
            with suppress(InputError):
                responses.append(_response_of(record, name, loader))
    return responses


def _observe(data: Response | BenchRecord, loader: Loader, keys: Sequence[str], law: LawLike) -> Observation:
    if isinstance(data, Response):
        return ResponseObservation(data, LinearModel(loader, data.experiment.loop, law), keys)
    return RecordObservation(RecordRun(data, loader, law), keys)


def _check_points(problem: Problem) -> None:
    points, unknowns = problem.groups[-1].stop, len(problem.unknowns)
    if points < 2 * unknowns:
        raise InputError(
            f"data: expected {2 * unknowns} points at least for {unknowns} parameters, got {points}; measure more lines or fit "
            "fewer parameters"
        )


def _estimates(
    unknowns: Sequence[Unknown], problem: Problem, optimum: Optimum, confidence: Confidence
) -> tuple[Estimate, ...]:
    values = problem.values(optimum.x)
    deviation = confidence.deviation[: len(unknowns)] * confidence.sizes * problem.scale
    shares = confidence.quantile * half_widths(confidence.information)
    estimates = []
    for j, (unknown, value) in enumerate(zip(unknowns, values.tolist(), strict=True)):
        if not shares[j] < DETERMINED:
            estimates.append(Estimate(unknown, value, np.inf, -np.inf, np.inf, np.inf, Status.UNDETERMINED))
            continue
        half = confidence.quantile * float(deviation[j])
        status = Status.AT_BOUND if optimum.at_bound[j] else Status.DETERMINED
        estimates.append(
            Estimate(unknown, value, float(deviation[j]), value - half, value + half, float(shares[j]), status)
        )
    return tuple(estimates)


def _at_estimates(loader: Loader, estimates: Sequence[Estimate]) -> Loader:
    """The loader at the estimates, with undetermined parameters at the file values."""
    values = {
        estimate.unknown.key: estimate.value for estimate in estimates if estimate.status is not Status.UNDETERMINED
    }
    try:
        return loader.with_tolerances(dict.fromkeys(set(values) & set(loader.tolerances))).replace(values, si=True)
    except InputError as error:
        raise InputError(
            f"fit: the estimates do not go with the rest of the loader: {error}; fit that parameter too, or correct the loader file"
        ) from error


def _fitted(problem: Problem, optimum: Optimum) -> tuple[Fitted, ...]:
    """Each measured curve with the fitted model and the model of the file."""
    groups = iter(optimum.noise)
    before = problem.start(np.array([unknown.nominal for unknown in problem.unknowns]))
    fits = []
    own_before = problem.own(before)
    for observation, own, own_at_file in zip(problem.observations, problem.own(optimum.x), own_before, strict=True):
        then = observation.curves(problem.values(before), own_at_file)
        simulated_noise = observation.simulated_noise(problem.values(optimum.x))
        for curve, curve_before, simulated in zip(
            observation.curves(problem.values(optimum.x), own), then, simulated_noise, strict=True
        ):
            rms = (
                relative_error(observation.data, curve.modeled)
                if isinstance(observation.data, Response)
                else float(np.sqrt(np.mean(np.square(curve.measured - curve.modeled))))
            )
            noise = float(next(groups)) * curve.expected
            points = (curve.at, curve.measured, curve.modeled, curve_before.modeled)
            fits.append(Fitted(observation.data, curve.channel, *points, rms, noise, simulated))
    return tuple(fits)


def _made_for_another(law: LawLike, loader: Loader) -> tuple[str, ...]:
    text = law.made_for_another(loader) if isinstance(law, Law) else ""
    return (text,) if text else ()


def _rigid(
    loader: Loader,
    law: LawLike,
    unknowns: Sequence[Unknown],
    with_responses: Sequence[tuple[Response | BenchRecord, list[Response]]],
) -> tuple[RigidTest | None, tuple[str, ...]]:
    """The test of the link on responses, given or estimated from records; or the reason for its absence."""
    responses = [
        response
        for measurement, responses in with_responses
        if isinstance(measurement, Response) or measurement.experiment.drive not in (Drive.PILOT_FORCE, Drive.RELEASE)
        for response in responses
    ]
    if not responses:
        return None, ("Whether the link is compliant was not judged: that takes a frequency response.",)
    if loader["controller.period"]:
        why = "there is no rigid model of a loader under a digital controller"
        return None, (f"Whether the link is compliant was not judged: {why}.",)
    return rigid_test(loader, law, unknowns, responses), ()
