"""Further experiments that would determine the undetermined parameters.

The information of each possible response, by loop, drive and channel, at 60 lines and with the noise of a good bench, is added to
that of the data.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from forcefeel.bench.channels import inputs, outputs
from forcefeel.bench.experiments import Drive, Experiment, Loop
from forcefeel.bench.identification.confidence import half_widths
from forcefeel.bench.identification.inseparable import DETERMINED
from forcefeel.bench.identification.linear import LinearModel
from forcefeel.bench.identification.result import Advice
from forcefeel.bench.identification.unknowns import Unknown
from forcefeel.laws.law import LawLike
from forcefeel.loader.loader import Loader

_LINES_HZ = np.geomspace(0.2, 50.0, 60)
_NOISE = 0.01
"""Relative deviation of each line."""

_NORMAL = 1.96
"""Standard errors in half a 95 % interval."""

_MOST = 3
"""Number of named experiments."""


def advice_of(
    loader: Loader, law: LawLike, unknowns: Sequence[Unknown], information: NDArray[np.float64], *, recorded: bool
) -> tuple[Advice, ...]:
    """Experiments that would each determine all unknowns, the best first; otherwise the best pair.

    Args:
        loader: The loader at the estimates.
        law: The law of the whole loader.
        unknowns: The unknowns.
        information: Information of the data alone, in shares as in ``confidence``.
        recorded: Whether the data contain time records.
    """
    scale = np.array([max(abs(loader[unknown.key]), unknown.scale) for unknown in unknowns])
    candidates = list(_candidates(loader, law, [unknown.key for unknown in unknowns], scale))
    open_still = _NORMAL * half_widths(information) >= DETERMINED
    if unseen := [
        unknown
        for j, unknown in enumerate(unknowns)
        if open_still[j] and all(added[j, j] == 0 for _, added in candidates)
    ]:
        return (_beyond_the_linear_model(unseen, recorded=recorded),)
    alone = _sufficient([((words,), added) for words, added in candidates], information)
    if not alone:
        pairs = [((first, other), a + b) for k, (first, a) in enumerate(candidates) for other, b in candidates[k + 1 :]]
        alone = _sufficient(pairs, information)[:1]
    return tuple(_advice(words, unknowns, shares) for words, shares in alone[:_MOST])


def _candidates(
    loader: Loader, law: LawLike, keys: Sequence[str], scale: NDArray[np.float64]
) -> Iterator[tuple[str, NDArray[np.float64]]]:
    signal, force, _ = map(Drive, inputs(loader.drive))
    for loop in (loop for loop in Loop if Experiment(loop, force).made_for in (None, loader.drive)):
        responses = LinearModel(loader, loop, law).responses(loader.si_values, keys, _lines(loader))
        for drive in (signal, force):
            for channel in outputs(loader.drive):
                value, slopes = responses.between(str(drive), channel, drive)
                if np.abs(value).max() == 0:
                    continue
                error = slopes * scale[:, np.newaxis] / np.where(value == 0, np.inf, value) / _NOISE
                yield (
                    f"the response from {drive} to {channel} ({Experiment(loop, drive).loop})",
                    (error.conj() @ error.T).real,
                )


def _lines(loader: Loader) -> NDArray[np.float64]:
    period = loader["controller.period"]
    return _LINES_HZ[0.4 / period > _LINES_HZ] if period else _LINES_HZ


def _sufficient(
    candidates: Sequence[tuple[tuple[str, ...], NDArray[np.float64]]], information: NDArray[np.float64]
) -> list[tuple[tuple[str, ...], NDArray[np.float64]]]:
    """The candidates that determine all unknowns, the most accurate first, with their half-widths."""
    widths = [(words, _NORMAL * half_widths(information + added)) for words, added in candidates]
    sufficient = [(words, shares) for words, shares in widths if shares.max() < DETERMINED]
    return sorted(sufficient, key=lambda candidate: float(candidate[1].max()))


def _advice(words: Sequence[str], unknowns: Sequence[Unknown], shares: NDArray[np.float64]) -> Advice:
    targets = ", ".join(
        f"{unknown.symbol} to ±{100 * share:.2g} %" for unknown, share in zip(unknowns, shares, strict=True)
    )
    sentence = f"Measure {' and '.join(words)}: with 1 % of noise a line it would give {targets}."
    return Advice(sentence, {unknown.key: float(share) for unknown, share in zip(unknowns, shares, strict=True)})


def _beyond_the_linear_model(unseen: Sequence[Unknown], *, recorded: bool) -> Advice:
    symbols = " and ".join(unknown.symbol for unknown in unseen)
    remedy = (
        "Record the loader again, slower, through more reversals and over more of its travel, or fit fewer parameters."
        if recorded
        else "Record the loader in time, such as a sweep of the force through both directions or a release, and fit that."
    )
    return Advice(f"No frequency response sees {symbols}: the linear model does not depend on it. {remedy}", {})
