"""Which springs and dampings of a host a loader renders: those under which its loop is stable and swings no longer than asked for.

Spring rate K and damping B of the whole feel are those that an aircraft asks for; the law stays, and takes what comes beside its
feel as a moving neutral (``crates/model/src/feel.rs``, ``pushed_to``). Each pole ``z = exp(s T)`` of the loop from sample to sample
(``loops.sampled_loops``) has a damping ratio ``-Re s / |s|`` of half the feel's ``B / (2 sqrt(I K))`` or of 0.05, in the cases of
an envelope: each parameter at both ends of its tolerance, each arm at the grip. Cases in which the loader's own feel has less are
left out; an envelope shows them.
"""

import numpy as np
from numpy.typing import NDArray

from forcefeel.envelope.cases import REFERENCE_ARMS, Case, make_cases
from forcefeel.envelope.deviations import deviations_of
from forcefeel.envelope.machines import full_rows
from forcefeel.envelope.refinement import UNKNOWN, rounds
from forcefeel.envelope.softening import largest_share
from forcefeel.laws.law import Law, LawLike
from forcefeel.laws.sampled.sampled_law import SampledLaw
from forcefeel.loader.loader import Loader
from forcefeel.loops.sampled_loop import sampled_loops

_SPRINGS = np.geomspace(1 / 256, 1024, 28)
"""Spring rates that are tried, as multiples of the loader's own: three in two octaves."""

_RATIOS = np.geomspace(0.02, 8.0, 12)
"""Damping ratios ``B / (2 sqrt(I K))`` that are tried at each."""

_DIES = 0.05
"""Damping ratio of a swing that loses a quarter in a period."""

_CLEAR = 0.02
"""Damping ratio above the least from which on a feel's neighbors may be inferred from it."""

_NEVER = -2
"""An outcome that is not known beforehand at any feel."""


def rendered_feels(loader: Loader, law: Law) -> NDArray[np.float64]:
    """Spring rate K, N m/rad, with least and most damping B, N m s/rad, that are stable there; (springs, 3), K rising.

    K is a contiguous range around the loader's own G; no rows where not even that is stable. Coarse first, refined where the
    verdict changes, as the settings of an envelope (``envelope.refinement``).
    """
    inertia, own = loader["feel.inertia"], loader["feel.stiffness"]
    springs = own * _SPRINGS
    dampings = 2 * np.sqrt(inertia * springs)[:, None] * _RATIOS
    feels = np.stack(
        [np.full(dampings.shape, inertia), dampings, np.repeat(springs[:, None], len(_RATIOS), axis=1)], -1
    )
    programmed = np.array([[inertia, loader["feel.damping"], own]])
    every_case = make_cases(deviations_of(loader), REFERENCE_ARMS)
    steady = np.asarray(_margins(loader, law, [(case, programmed) for case in every_case]) >= 0)
    cases = [case for case, good in zip(every_case, steady, strict=True) if good]
    if not cases:
        return np.empty((0, 3))
    shape = len(cases), 1, *dampings.shape
    outcome, margin = np.full(shape, UNKNOWN, dtype=np.int8), np.full(shape, np.nan, dtype=np.float32)
    for wanted in rounds(outcome, margin, _NEVER):
        run = [(cases[k], feels[wanted[k, 0]]) for k in np.flatnonzero(wanted.any(axis=(1, 2, 3)))]
        if run:
            above = _margins(loader, law, run)
            outcome[wanted], margin[wanted] = above >= 0, np.where(above < 0, above, np.maximum(above - _CLEAR, 0.0))
    good = np.asarray((outcome[:, 0] > 0).all(axis=0))
    spans = [_span(dampings[k], good[k]) for k in range(len(springs))]
    reached = np.array([span is not None for span in spans])
    begin, end = _around(int(np.abs(_SPRINGS - 1).argmin()), reached)
    return np.array([(springs[k], *(spans[k] or ())) for k in range(begin, end)]).reshape(-1, 3)


def _margins(loader: Loader, law: Law, run: list[tuple[Case, NDArray[np.float64]]]) -> NDArray[np.float64]:
    """Damping ratio of the loop above the least, for the settings I, B, K of each case in turn."""
    settings = np.vstack([settings for _, settings in run])
    values = np.vstack([full_rows(loader, case, settings, law) for case, settings in run])
    least = np.minimum(settings[:, 1] / (2 * np.sqrt(settings[:, 0] * settings[:, 2])) / 2, _DIES)
    return np.asarray(_damping_ratios(loader, _informed(law, settings, loader), values) - least)


def within_drive(rendered: NDArray[np.float64], loader: Loader) -> NDArray[np.float64]:
    """The rows of ``rendered_feels`` up to the stiffest spring that the drive renders at the loader's own damping ratio."""
    if not len(rendered):
        return rendered
    own = loader["feel.stiffness"]
    most = largest_share(loader, float(rendered[-1, 0]) / own) * own
    ends = [np.interp(most, rendered[:, 0], rendered[:, k]) for k in (1, 2)]
    return np.vstack([rendered[rendered[:, 0] < most], [most, *ends]])


def _informed(law: Law, settings: NDArray[np.float64], loader: Loader) -> LawLike:
    """The law for each setting I, B, K: ``n_e = -((K - G) delta + (B - B_0) delta') / G`` moves its neutral."""
    numbers = law.sampled
    if numbers is None:
        return law
    own = loader["feel.stiffness"], loader["feel.damping"]
    moved = -(settings[:, [2, 1]] - own) / own[0]
    each = {name: np.repeat(getattr(numbers, name), len(settings), axis=0) for name in _ARRAYS}
    for name, k in (("command", 0), ("torque", 1)):
        each[name][:, -2:] += each["neutral"][:, [k]] * moved
    return SampledLaw(numbers.period_s, numbers.delay_s, **each)


_ARRAYS = ("transition", "input", "command", "torque", "friction", "neutral", "contact")


def _damping_ratios(loader: Loader, law: LawLike, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Least damping ratio of the poles of each loop; below zero where it is unstable."""
    with np.errstate(divide="ignore", invalid="ignore"):  # a pole at zero has died at once
        s = np.log(sampled_loops(loader, law, values).poles)
        ratios = np.where(np.isneginf(s.real), 1.0, -s.real / np.abs(s))
    return np.asarray(ratios.min(axis=1))


def _span(dampings: NDArray[np.float64], good: NDArray[np.bool_]) -> tuple[float, float] | None:
    """First and last damping of the longest run of good ones; ``None`` if there are fewer than two."""
    runs = [_around(int(k), good) for k in np.flatnonzero(good)]
    begin, end = max(runs, key=lambda run: run[1] - run[0], default=(0, 0))
    return (float(dampings[begin]), float(dampings[end - 1])) if end - begin > 1 else None


def _around(place: int, good: NDArray[np.bool_]) -> tuple[int, int]:
    """Begin and end of the run of good ones around a place; an empty one if that is not good."""
    bad = np.flatnonzero(~good)
    end = next((int(k) for k in bad if k >= place), len(good))
    begin = next((int(k) + 1 for k in bad[::-1] if k <= place), 0)
    return min(begin, end), end
