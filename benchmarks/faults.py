"""A million faults in supervised loaders, in virtual time, and 100,000 runs without one.

    python benchmarks/faults.py [cases] [threads]

Half of the cases have one fault, half have two; a tenth as many runs have none. Loaders are the built-in ones under a sampled
controller, each under its laws, with its own feel and with feels drawn about it; without a fault, with its own feel and the law
``robust``. Each case has safety times, a hand, and faults of drawn kinds at drawn moments; see ``crates/faults``. Half of the
columns with a fault, and a quarter of the others, are held by an arm or a clamp, or pushed into an end stop.

It fails if a loader is stopped too late or without a fault, a command is beyond its limit or no number, the hand is given more
energy than the physical bound, or if with one fault it is given more than 10 J beyond the feel, or the force at the grip is above
1.5 times the largest legal one for longer than 20 ms, where neither a hand pushes harder nor an end stop carries it. What a clamp
is given counts as force alone.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
import time
from collections import Counter

import numpy as np
from numpy.typing import NDArray

import forcefeel as ff
from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.axes import ELECTRIC_AXES
from forcefeel.loader.built_in import open_loader

CASES, FEELS, SEED = 1_000_000, 6, 0
WRONG = ("late", "unsafe", "beyond the limit", "too fast", "no number", "energy", "false alarm", "host")
PIECE = 50_000
MOST_ENERGY_J, MOST_TIME_ABOVE_S = 10.0, 0.02
OF_HAND = ("LargestForce", "LastingForce")
"""Faults of the hand: what it feels is its own force."""
KIND, SECOND, STOPPED, BITS, GIVEN, BOUND, ABOVE, EXCESS = 0, 1, 3, 5, 6, 7, 10, 12
"""Columns of the outcomes."""

Rows = NDArray[np.float64]


def loaders() -> list[tuple[str, ff.Loader]]:
    """The built-in loaders under a sampled controller."""
    analog = ff.elevator().replace({"controller.period": "1 ms", "controller.delay": "1 ms"})
    named = [(name, open_loader(name)) for name in ("elevator-2khz", *ELECTRIC_AXES)]
    grips = [(name, loader.replace(GRIP)) for name, loader in named]
    return [("elevator-1974", analog), *named, *grips]


GRIP = {"grip_sensor.gain": 1.0, "grip_sensor.noise": "0.02 lb", "grip_sensor.resolution": "0.01 lb"}
"""A force sensor at the grip, which closes the loop of the laws ``robust`` and ``grip``."""


def drawn() -> tuple[Rows, Rows, list[int]]:
    """Values and laws, a row for each loader with a feel; which rows are its own feel under the law ``robust``."""
    rng = np.random.default_rng(SEED)
    values, laws, own = [], [], []
    for name, loader in loaders():
        inertia, damping, stiffness = (loader[f"feel.{key}"] for key in ("inertia", "damping", "stiffness"))
        frequency, ratio = np.sqrt(stiffness / inertia), damping / (2 * np.sqrt(stiffness * inertia))
        at_grip = bool(loader["grip_sensor.gain"])
        others = "grip" if at_grip else "observer" if name in ELECTRIC_AXES else "agile"
        for law in ("robust", others):
            for k in range(FEELS):
                g = stiffness * 2 ** rng.uniform(-1.5, 0.7)
                w, zeta = frequency * 2 ** rng.uniform(-0.5, 0.5), ratio * 2 ** rng.uniform(-0.5, 1)
                feel = {"feel.inertia": g / w**2, "feel.damping": 2 * zeta * g / w, "feel.stiffness": g}
                changed = loader if k == 0 else loader.replace(feel, si=True)
                try:
                    made = ff.Law.of(law, changed).sampled
                except InputError as error:
                    print(f"{name}, {law}: left out: {error}")
                    continue
                if made is not None:
                    if k == 0 and law == "robust":
                        own.append(len(values))
                    values.append(np.asarray(changed.si_values, dtype=np.float64))
                    laws.append(made.rows()[0])
    return np.array(values), np.array(laws), own


def run(of: tuple[Rows, Rows], faults: int, cases: int, threads: int) -> Rows:
    """Outcomes of the cases, each with so many faults."""
    pieces = [
        _core.supervised_faults(
            *of, seed=7, first=first, count=min(PIECE, cases - first), faults=faults, threads=threads
        )
        for first in range(0, cases, PIECE)
    ]
    return np.concatenate(pieces)


def judged(outcomes: Rows, faults: int) -> Counter[str]:
    """What went wrong, and how often."""
    kinds, bad = _core.fault_kinds(), Counter[str]()
    by_hand = np.isin(outcomes[:, [KIND, SECOND]], [kinds.index(kind) for kind in OF_HAND]).any(axis=1)
    energy = (outcomes[:, EXCESS] > MOST_ENERGY_J) & (faults < 2)
    force = (outcomes[:, ABOVE] > MOST_TIME_ABOVE_S) & (faults < 2) & ~by_hand
    for row, more, above in zip(outcomes, energy, force, strict=True):
        what = [name for bit, name in enumerate(WRONG) if int(row[BITS]) >> bit & 1]
        what += ["above 10 J"] * bool(more) + ["above 1.5 times the largest force"] * bool(above)
        if what:
            bad[f"{kinds[int(row[KIND])]} and {kinds[int(row[SECOND])]}: {', '.join(what)}"] += 1
    return bad


def main() -> None:
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else CASES
    threads = int(sys.argv[2]) if len(sys.argv) > 2 else os.cpu_count() or 1
    values, laws, own = drawn()
    kinds, bad = _core.fault_kinds(), Counter[str]()
    for faults, count in ((0, cases // 10), (1, cases // 2), (2, cases // 2)):
        begin = time.perf_counter()
        of = (values[own], laws[own]) if faults == 0 else (values, laws)
        outcomes = run(of, faults, count, threads)
        took = time.perf_counter() - begin
        share = (outcomes[:, GIVEN] / np.maximum(outcomes[:, BOUND], 1e-9)).max()
        print(
            f"{count} cases with {faults} faults in {took:.0f} s on {threads} threads: "
            f"{int((outcomes[:, STOPPED] >= 0).sum())} loaders stopped; to the hand beyond the feel at most "
            f"{outcomes[:, EXCESS].max():.1f} J, {share:.0%} of the physical bound; "
            f"above 1.5 times the largest force for {outcomes[:, ABOVE].max() * 1e3:.0f} ms at most"
        )
        if faults == 1:
            for k, kind in enumerate(kinds):
                of_kind = outcomes[outcomes[:, KIND] == k]
                print(
                    f"  {kind}: {len(of_kind)} cases, {int((of_kind[:, STOPPED] >= 0).sum())} stopped, "
                    f"at most {of_kind[:, EXCESS].max(initial=0):.1f} J, {of_kind[:, ABOVE].max(initial=0) * 1e3:.0f} ms"
                )
        bad += judged(outcomes, faults)
    for what, count in bad.most_common():
        print(f"WRONG {count} times: {what}")
    if bad:
        sys.exit(1)


if __name__ == "__main__":
    main()
