"""A loader from bench data."""

from collections.abc import Callable, Sequence
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
from forcefeel.bench.identification.linear import LinearModel, model_response
from forcefeel.bench.identification.losses import Loss
from forcefeel.bench.identification.misfit import explained
from forcefeel.bench.identification.observations import Observation
from forcefeel.bench.identification.problem import Place, Problem
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
from forcefeel.errors import InputError, expect, type_text
from forcefeel.laws.law import Law, LawLike
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import ELECTRIC

_HALF_RATE = 0.499
"""Cycles of a line in a controller's period at most."""

MOST_STARTS = 256
"""More starts than anybody waits for."""


def identify(  # noqa: PLR0913  keywords of what is asked
    loader: Loader,
    data: Sequence[Response | BenchRecord],
    fit: str | Sequence[str],
    *,
    law: LawLike = None,
    starts: int = 5,
    loss: Loss = "huber",
    priors: bool = True,
    as_responses: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Identification:
    """Finds parameters of a loader from what was measured of it.

    Frequency responses are compared with the linear model, records with the nonlinear one, all at once; the noise of each is found
    along with the parameters. See ``problem`` for what is minimised and ``confidence`` for the standard errors.

    Args:
        loader: The loader as its file has it. Tolerances bound the search, normal ones count as knowledge.
        data: Responses and records, one at least.
        fit: Symbols or rows of the parameters: ``"k,c,J,C_i"``, of a motor ``"K_t,J_m,k,c,J"``.
        law: The law of the whole loader in the data; the original one, or ``robust`` of a motor, if not given.
        starts: How many places the search starts from: the file's values, then others within tolerance.
        loss: ``huber`` lets residuals beyond three standard deviations count less; ``linear`` is plain least squares.
        priors: Whether normal tolerances count as knowledge.
        as_responses: Turn records into frequency responses first, and use the linear model alone.
        progress: Told how many of the searches are done.

    Returns:
        The identification; its ``loader`` is ``None`` where the data do not determine a parameter, or one ends at its bound.

    Raises:
        InputError: If a parameter cannot be fitted, there are no data or fewer points than unknowns, data are not what they are
            said to be, or the model diverges at every start.

    Example:
        >>> import forcefeel as ff
        >>> data = [ff.read_bench_data("examples/bench/servo-closed.csv")]
        >>> found = ff.identify(ff.load("examples/bench/loader.toml"), data, "k,c", starts=1)
        >>> found["k"].status.value
        'determined'
    """
    check_loader(loader)
    expect("fit", fit, (str, Sequence), 'symbols or rows of parameters such as "k,c,J"')
    if isinstance(data, str) or not isinstance(data, Sequence):
        raise InputError(
            f"data: expected a list of responses and records, as read_bench_data reads them, got {type_text(data)}"
        )
    for one in data:
        expect("data", one, (Response, BenchRecord), "responses and records, as read_bench_data reads them")
    keys = parameter_keys(fit, loader.drive)
    unknowns = unknowns_of(loader, keys)
    if not data:
        raise InputError("data: expected a frequency response or a record, got none")
    if not 1 <= starts <= MOST_STARTS:
        raise InputError(f"starts: expected 1 to {MOST_STARTS}, got {starts}")
    check_bench(loader, data)
    _check_valve(loader, keys, data, as_responses=as_responses)
    if loader.drive == ELECTRIC and any(one.experiment.loop is Loop.LOADER for one in data):
        law = Law.of(law, loader)  # designed or read once, for the loader as its file has it
    used = [it for one in data for it in (_as_responses(one, loader) if as_responses else [one])]
    seen = [(it, [it] if isinstance(it, Response) else _seen_in(it, loader)) for it in data]
    for it, responses in seen:
        _suspect(loader, law, it, responses)
    problem = Problem(unknowns, [_observe(it, loader, keys, law) for it in used], loss, priors)
    _check_points(problem)
    place, confidence, ends = search(problem, starts, progress or (lambda done, total: None))
    estimates = _estimates(unknowns, problem, place, confidence)
    found = _at_estimates(loader, estimates)
    compared = [(it, [it]) for it in used if isinstance(it, Response)] if as_responses else seen
    rigid, notes = _rigid(found, law, unknowns, compared)
    identified = Identification(
        before=loader,
        estimates=estimates,
        correlation=confidence.correlation,
        fitted=_fitted(problem, place),
        ends=ends,
        inseparable=inseparable_sets(unknowns, confidence),
        advice=(),
        rigid=rigid,
        notes=(*notes, *_beside(data), *_made_for_another(law, loader)),
    )
    if identified.determined:
        sound = explained(identified.fitted) and identified.within_bounds
        return replace(identified, loader=fitted_loader(identified)) if sound else identified
    recorded = any(isinstance(it, BenchRecord) for it in used)
    advice = advice_of(found, law, unknowns, confidence.information, recorded=recorded)
    return replace(identified, advice=advice)


def unseen_from_afar(
    loader: Loader, data: Sequence[Response | BenchRecord], keys: Sequence[str], law: LawLike = None
) -> tuple[str, ...]:
    """Rows that data will hardly determine: all of the data leave them open where a search over their beginning ends.

    A parameter to which data answer in nothing but jumps leads the whole search astray, and takes most of its time. To be asked
    of what may be left out, before ``identify``, whose arguments these are.
    """
    unknowns = unknowns_of(loader, keys)
    confidence = from_afar(Problem(unknowns, [_observe(it, loader, keys, law) for it in data]))
    if confidence is None:
        return ()
    shares = confidence.quantile * half_widths(confidence.information)
    return tuple(one.key for one, share in zip(unknowns, shares, strict=True) if not share < DETERMINED)


def _beside(data: Sequence[Response | BenchRecord]) -> tuple[str, ...]:
    """What records hold that no parameter is fitted to."""
    held = any(isinstance(it, BenchRecord) and np.ptp(it.channels.get(GRIP_FORCE, 0.0)) > 0 for it in data)
    sentence = (
        f"{GRIP_FORCE} is not compared: it shows the hand. What it tells of the sensor at the grip, commission finds."
    )
    return (sentence,) * held


def _check_valve(
    loader: Loader, keys: Sequence[str], data: Sequence[Response | BenchRecord], *, as_responses: bool
) -> None:
    """Refuses the valve's gains at an operating point where records are run with its orifice."""
    gains = [key for key in ("valve.current_gain", "valve.pressure_gain") if key in keys]
    runs = any(isinstance(it, BenchRecord) for it in data) and not as_responses
    if gains and loader["valve.orifice"] and (runs or loader["controller.period"]):
        raise InputError(
            f"fit: the loader's flow follows the orifice, eq. (1), which has no {' and '.join(gains)}; fit valve.rated_flow (q_r), "
            "or take valve.orifice out of the loader file"
        )


def _as_responses(data: Response | BenchRecord, loader: Loader) -> list[Response]:
    """A record's responses to every channel that was measured; a response is one already."""
    if isinstance(data, Response):
        return [data]
    if data.experiment.drive is Drive.RELEASE:
        raise InputError(f"{data.name}: a release has no frequency response; leave it out, or fit records as they are")
    return [_response_of(data, channel, loader) for channel in data.channels if channel in OUTPUTS]


def _response_of(record: BenchRecord, channel: str, loader: Loader) -> Response:
    """A record's response to a channel, below half the rate of the loader's controller."""
    found = estimate_response(record, channel)
    kept = found.frequency_hz * loader["controller.period"] < _HALF_RATE
    coherence, deviation = (None if it is None else it[kept] for it in (found.coherence, found.deviation))
    lines, value = found.frequency_hz[kept], found.value[kept]
    return replace(found, frequency_hz=lines, value=value, coherence=coherence, deviation=deviation)


def _suspect(loader: Loader, law: LawLike, data: Response | BenchRecord, responses: Sequence[Response]) -> None:
    """Refuses data that are not what their responses are said to be, as far as the loader file's model can tell."""
    for response in responses:
        asked = loader, response.experiment, response.input, response.output, response.frequency_hz
        predicted = model_response(*asked, law=law)
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
    """Of a record's channel only the sign can be taken for the other one; its response is estimated here and has no other slips."""
    as_read = distance(response.value, predicted)
    if as_read > FAR and distance(-response.value, predicted) < CLEAR * as_read:
        raise InputError(f"{response.name}: the polarity seems reversed; turn the sign of one channel")


def _seen_in(record: BenchRecord, loader: Loader) -> list[Response]:
    """The responses of a record as far as it has any: uneven samples, steps, slow sweeps and releases have none."""
    found = []
    for name in record.channels if record.experiment.drive is not Drive.RELEASE else ():
        if name in OUTPUTS:
            with suppress(InputError):
                found.append(_response_of(record, name, loader))
    return found


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
    unknowns: Sequence[Unknown], problem: Problem, place: Place, confidence: Confidence
) -> tuple[Estimate, ...]:
    values = problem.values(place.x)
    deviation = confidence.deviation[: len(unknowns)] * confidence.sizes * problem.scale
    shares = confidence.quantile * half_widths(confidence.information)
    found = []
    for j, (unknown, value) in enumerate(zip(unknowns, values.tolist(), strict=True)):
        if not shares[j] < DETERMINED:
            found.append(Estimate(unknown, value, np.inf, -np.inf, np.inf, np.inf, Status.UNDETERMINED))
            continue
        half = confidence.quantile * float(deviation[j])
        status = Status.AT_BOUND if place.at_bound[j] else Status.DETERMINED
        found.append(
            Estimate(unknown, value, float(deviation[j]), value - half, value + half, float(shares[j]), status)
        )
    return tuple(found)


def _at_estimates(loader: Loader, estimates: Sequence[Estimate]) -> Loader:
    """The loader at the estimates; an undetermined one stays as the file has it."""
    told = {it.unknown.key: it.value for it in estimates if it.status is not Status.UNDETERMINED}
    try:
        return loader.with_tolerances(dict.fromkeys(set(told) & set(loader.tolerances))).replace(told, si=True)
    except InputError as error:
        raise InputError(
            f"fit: the estimates do not go with the rest of the loader: {error}; fit that parameter too, or correct the loader file"
        ) from error


def _fitted(problem: Problem, place: Place) -> tuple[Fitted, ...]:
    """Every curve beside the model, fitted and as the file has it."""
    groups = iter(place.noise)
    before = problem.start(np.array([it.nominal for it in problem.unknowns]))
    found = []
    own_before = problem.own(before)
    for it, own, own_at_file in zip(problem.observations, problem.own(place.x), own_before, strict=True):
        then = it.curves(problem.values(before), own_at_file)
        simulated_noise = it.simulated_noise(problem.values(place.x))
        for curve, old, simulated in zip(it.curves(problem.values(place.x), own), then, simulated_noise, strict=True):
            rms = (
                relative_error(it.data, curve.modelled)
                if isinstance(it.data, Response)
                else float(np.sqrt(np.mean(np.square(curve.measured - curve.modelled))))
            )
            noise = float(next(groups)) * curve.expected
            points = (curve.at, curve.measured, curve.modelled, old.modelled)
            found.append(Fitted(it.data, curve.channel, *points, rms, noise, simulated))
    return tuple(found)


def _made_for_another(law: LawLike, loader: Loader) -> tuple[str, ...]:
    text = law.made_for_another(loader) if isinstance(law, Law) else ""
    return (text,) if text else ()


def _rigid(
    loader: Loader,
    law: LawLike,
    unknowns: Sequence[Unknown],
    seen: Sequence[tuple[Response | BenchRecord, list[Response]]],
) -> tuple[RigidTest | None, tuple[str, ...]]:
    """The test of the link on what was given and what was seen in records under a signal; and why there is none."""
    responses = [
        response
        for it, found in seen
        if isinstance(it, Response) or it.experiment.drive not in (Drive.PILOT_FORCE, Drive.RELEASE)
        for response in found
    ]
    if not responses:
        return None, ("Whether the link is compliant was not judged: that takes a frequency response.",)
    if loader["controller.period"]:
        why = "there is no rigid model of a loader under a digital controller"
        return None, (f"Whether the link is compliant was not judged: {why}.",)
    return rigid_test(loader, law, unknowns, responses), ()
