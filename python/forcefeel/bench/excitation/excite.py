"""Design of an excitation: information per line, best spectrum within limits, phases, scale on the nonlinear loader."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.excitation.limits import limits_of
from forcefeel.bench.excitation.lines import Lines, lines_of
from forcefeel.bench.excitation.optimal_power import PowerProblem, optimal_power
from forcefeel.bench.excitation.plan import ExcitationPlan, Timing, spectral_lines, timing
from forcefeel.bench.excitation.rehearsal import Bench, beside_noise, fit_to_limits
from forcefeel.bench.excitation.result import EVEN_SHARE, Excitation, LimitUse
from forcefeel.bench.excitation.waves import Wave, chirps, multisine
from forcefeel.bench.experiments import Drive, Experiment, Loop, check_experiment
from forcefeel.bench.identification.linear import bench_law
from forcefeel.bench.identification.unknowns import parameter_keys, unknowns_of
from forcefeel.errors import InputError
from forcefeel.laws.law import ROBUST, Law, LawLike
from forcefeel.laws.sampled.torque_mode import TORQUE_MODE
from forcefeel.loader.bus import UDP
from forcefeel.loader.loader import Loader, check_loader
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC

USUAL: Mapping[str, str] = MappingProxyType({HYDRAULIC: "servo-closed", ELECTRIC: "loader command_current"})
"""Default experiment of each drive; a loop holds the piston or the motor in place."""

USUAL_FIT: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        HYDRAULIC: (
            "amplifier.admittance",
            "valve.natural_frequency",
            "linkage.stiffness",
            "linkage.damping",
            "column.inertia",
        ),
        ELECTRIC: ("motor.torque_constant", "motor.inertia", "linkage.stiffness", "linkage.damping", "column.inertia"),
    }
)
"""Parameters of a signal for a machine of which all is asked; it reveals the others too."""

USUAL_TO_HZ = 60.0
"""Highest line of that signal: the link's resonance and the valve's lag lie below."""

_OPEN_FROM_HZ = 4.0
"""Default lowest frequency of an open motor, Hz; below it, its drift during the ramp exceeds its swing."""

_IN_BAND = 1e-3
"""Least power of a line in the band of a chirp, as a share of the largest."""


def excite(
    loader: Loader,
    fit: str | Sequence[str],
    experiment: str | Experiment | None = None,
    plan: ExcitationPlan | None = None,
    law: LawLike = None,
    *,
    progress: Callable[[str], None] = lambda step: None,
) -> Excitation:
    """Design the excitation that best determines chosen parameters within the limits of the bench.

    A multisine has the D-optimal spectrum: it maximizes ``ln det M``, the information of the relative parameters, over the powers
    of the lines, with the r.m.s. of current, travel, force and drive within their limits over a crest factor; a fifth of the power
    is even over all lines. A chirp is the one of a few with the largest ``ln det M``. Either is then scaled by runs of the
    nonlinear loader until every peak holds its limit and one is near.

    Args:
        loader: The loader, with the best known values.
        fit: Parameters by symbol or key: ``"k,c,J,C_i"``.
        experiment: Loop and drive, such as ``"servo-closed"``; see ``Experiment.read``. Default ``"servo-closed"`` for a
            valve, ``"loader command_current"`` for a motor.
        plan: Kind, length, band, noise and limits.
        law: The law of the whole loader; default, the original loop, or ``robust`` for a motor. On a bus ``torque-mode`` for a
            motor, whose command a sample that comes early or late changes least, and ``robust`` for a valve.
        progress: Called with the name of each step as it begins.

    Returns:
        The signal, its predicted errors and the peaks.

    Raises:
        InputError: If a parameter is unknown or has no effect in this experiment, the time is too short or the rate too low for
            the band, or the loader cannot hold the limits.
        NotSeparableError: If no excitation of this experiment separates the parameters.

    Source: G. C. Goodwin and R. L. Payne, Dynamic System Identification, 1977, ch. 6; M. B. Zarrop, Optimal Experiment Design for
    Dynamic System Identification, 1979; R. Pintelon and J. Schoukens, System Identification: A Frequency Domain Approach, 2nd ed.
    2012, ch. 5.

    Example:
        >>> plan = ff.bench.ExcitationPlan(time_s=4.0, rate_hz=200.0, to_hz=20.0)
        >>> found = ff.bench.excite(ff.elevator(), "k", "servo-closed", plan)
        >>> sorted(found.standard_errors)
        ['linkage.stiffness']
    """
    check_loader(loader)
    plan = (plan or ExcitationPlan()).of(loader)
    keys = parameter_keys(fit, loader.drive)
    unknowns_of(loader, keys)
    resolved = experiment if isinstance(experiment, Experiment) else Experiment.read(experiment or USUAL[loader.drive])
    check_experiment(resolved, loader)
    if resolved.loop is Loop.MOTOR_OPEN and plan.from_hz is None:
        plan = replace(plan, from_hz=_OPEN_FROM_HZ)
    if resolved.drive is Drive.RELEASE:
        raise InputError("experiment: a release is its own excitation; take one with a signal or a pilot_force")
    if law is not None and resolved.loop is not Loop.LOADER:
        raise InputError(f"law: is the law of the whole loader, and {resolved} is of the servo alone; leave it out")
    progress("law")
    if law is None and resolved.loop is Loop.LOADER and loader.bus is not None and loader.bus.kind != UDP:
        law = TORQUE_MODE if loader.drive == ELECTRIC else ROBUST
    if law is not None or (loader.drive == ELECTRIC and resolved.loop is Loop.LOADER):
        law = Law.of(bench_law(law, loader), loader)  # designed or read once, not for each rehearsal
    times = timing(plan)
    bench = Bench(loader, resolved, law, plan.rate_hz)
    limits = beside_noise(bench, len(times.times_s), limits_of(loader, resolved.drive, plan.limits))
    progress("information of the lines")
    lines = lines_of(loader, keys, resolved, plan, spectral_lines(plan, times, loader), law, limits)
    progress("spectrum")
    best = optimal_power(lines.problem(0.0)).power
    wave = _best_chirp(lines, times) if plan.signal == "chirp" else _multisine(lines, times)
    progress("runs up to the limits")
    scale, peaks = fit_to_limits(bench, wave.signal, limits)
    power = scale**2 * wave.power
    whole = lines.problem(0.0)
    return Excitation(
        loader=loader,
        experiment=resolved,
        fit=keys,
        plan=plan,
        words=wave.words,
        time_s=times.times_s,
        signal=scale * wave.signal,
        period_s=times.period_s if plan.signal == "multisine" else None,
        frequency_hz=lines.frequency_hz,
        power=power,
        noise=dict(zip(plan.channels, lines.sigma.tolist(), strict=True)),
        information=wave.counted * whole.matrix(power),
        uses=tuple(LimitUse(limit, peak) for limit, peak in zip(limits, peaks, strict=True)),
        efficiency=_efficiency(whole, whole.filled(wave.power), best),
        even_efficiency=_efficiency(whole, whole.even(), best),
        law=law if isinstance(law, Law) else None,
    )


def _multisine(lines: Lines, times: Timing) -> Wave:
    problem = lines.problem(EVEN_SHARE)
    power = optimal_power(problem).power
    return multisine(times, lines.frequency_hz, power, lines.limited / lines.limit[:, np.newaxis], lines.travel)


def _best_chirp(lines: Lines, times: Timing) -> Wave:
    """The chirp with the largest ln det M, each scaled to the limits of a slow sweep of its band."""
    problem, height = lines.problem(0.0), np.abs(lines.limited)
    best, best_information = None, -np.inf
    for wave in chirps(times, lines.frequency_hz):
        scale = float(np.min(lines.limit / np.max(height[:, wave.power > _IN_BAND * wave.power.max()], axis=1)))
        information = problem.log_det(scale**2 * wave.power)
        if information > best_information:
            best, best_information = replace(wave, signal=scale * wave.signal, power=scale**2 * wave.power), information
    if best is None:
        raise InputError("band: no chirp in it determines the parameters; take a wider band or a multisine")
    return best


def _efficiency(problem: PowerProblem, power: NDArray[np.float64], best: NDArray[np.float64]) -> float:
    parameters = problem.information.shape[1]
    return float(np.exp((problem.log_det(power) - problem.log_det(best)) / parameters))
