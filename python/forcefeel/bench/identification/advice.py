"""Which experiment more would determine what the data do not.

Every response that the bench could measure, of each loop, drive and channel, adds its information to that of the data. It is taken
at 60 lines, with the noise of a good bench.
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
"""Experiments that are named."""


def advice_of(
    loader: Loader, law: LawLike, unknowns: Sequence[Unknown], information: NDArray[np.float64], *, recorded: bool
) -> tuple[Advice, ...]:
    """The experiments that would determine all unknowns, the best first; if none would alone, the best pair of them.

    Args:
        loader: The loader at the estimates.
        law: The law of the whole loader.
        unknowns: The unknowns.
        information: Of the data alone, in shares as ``confidence`` has them.
        recorded: Whether there are records in time among the data.
    """
    scale = np.array([max(abs(loader[it.key]), it.scale) for it in unknowns])
    candidates = list(_candidates(loader, law, [it.key for it in unknowns], scale))
    open_still = _NORMAL * half_widths(information) >= DETERMINED
    if unseen := [
        it for j, it in enumerate(unknowns) if open_still[j] and all(more[j, j] == 0 for _, more in candidates)
    ]:
        return (_beyond_the_linear_model(unseen, recorded=recorded),)
    alone = _sufficient([((words,), more) for words, more in candidates], information)
    if not alone:
        pairs = [((one, other), a + b) for k, (one, a) in enumerate(candidates) for other, b in candidates[k + 1 :]]
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
    """Those that determine everything, the surest first, with the half-widths that they lead to."""
    found = [(words, _NORMAL * half_widths(information + more)) for words, more in candidates]
    enough = [(words, shares) for words, shares in found if shares.max() < DETERMINED]
    return sorted(enough, key=lambda it: float(it[1].max()))


def _advice(words: Sequence[str], unknowns: Sequence[Unknown], shares: NDArray[np.float64]) -> Advice:
    known = ", ".join(f"{it.symbol} to ±{100 * share:.2g} %" for it, share in zip(unknowns, shares, strict=True))
    sentence = f"Measure {' and '.join(words)}: with 1 % of noise a line it would give {known}."
    return Advice(sentence, {it.key: float(share) for it, share in zip(unknowns, shares, strict=True)})


def _beyond_the_linear_model(unseen: Sequence[Unknown], *, recorded: bool) -> Advice:
    symbols = " and ".join(it.symbol for it in unseen)
    how = (
        "Record the loader again, slower, through more reversals and over more of its travel, or fit fewer parameters."
        if recorded
        else "Record the loader in time, such as a sweep of the force through both directions or a release, and fit that."
    )
    return Advice(f"No frequency response sees {symbols}: the linear model does not depend on it. {how}", {})
