"""A million faults in supervised loaders, in virtual time: half of them single, half in pairs.

    python benchmarks/faults.py [cases] [threads]

Loaders are the built-in ones with a sampled controller, each under its laws and with feels drawn about its own. Each case has
safety times, a hand, and faults of drawn kinds at drawn moments; see ``crates/faults``. It fails if a loader is stopped too late
or without a fault, a command is beyond its limit or no number, or the hand is given more energy than the bound.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
import time
from collections import Counter

import numpy as np

import forcefeel as ff
from forcefeel import _core
from forcefeel.errors import InputError
from forcefeel.loader.axes import ELECTRIC_AXES
from forcefeel.loader.built_in import open_loader

CASES, FEELS, SEED = 1_000_000, 6, 0
WRONG = ("late", "unsafe", "beyond the limit", "too fast", "no number", "energy", "false alarm", "host")
PIECE = 50_000


def drawn() -> tuple[np.ndarray, np.ndarray]:
    """Values and laws, a row for each loader with a feel."""
    rng = np.random.default_rng(SEED)
    values, laws = [], []
    for name in ("elevator-2khz", *ELECTRIC_AXES):
        loader = open_loader(name)
        inertia, damping, stiffness = (loader[f"feel.{key}"] for key in ("inertia", "damping", "stiffness"))
        frequency, ratio = np.sqrt(stiffness / inertia), damping / (2 * np.sqrt(stiffness * inertia))
        for law in ("robust", "observer") if name in ELECTRIC_AXES else ("robust", "agile"):
            for _ in range(FEELS):
                g = stiffness * 2 ** rng.uniform(-1.5, 0.7)
                w, zeta = frequency * 2 ** rng.uniform(-0.5, 0.5), ratio * 2 ** rng.uniform(-0.5, 1)
                feel = {"feel.inertia": g / w**2, "feel.damping": 2 * zeta * g / w, "feel.stiffness": g}
                changed = loader.replace(feel, si=True)
                try:
                    made = ff.Law.of(law, changed).sampled
                except InputError as error:
                    print(f"{name}, {law}: left out: {error}")
                    continue
                if made is not None:
                    values.append(np.asarray(changed.si_values, dtype=np.float64))
                    laws.append(made.rows()[0])
    return np.array(values), np.array(laws)


def main() -> None:
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else CASES
    threads = int(sys.argv[2]) if len(sys.argv) > 2 else os.cpu_count() or 1
    values, laws = drawn()
    kinds, bad = _core.fault_kinds(), Counter[str]()
    for pairs in (False, True):
        begin, stopped, injected, share = time.perf_counter(), 0, 0.0, 0.0
        for first in range(0, cases // 2, PIECE):
            count = min(PIECE, cases // 2 - first)
            result = _core.supervised_faults(
                values, laws, seed=7, first=first, count=count, pairs=pairs, threads=threads
            )
            stopped += int((result[:, 3] >= 0).sum())
            injected, share = (
                max(injected, result[:, 6].max()),
                max(share, (result[:, 6] / np.maximum(result[:, 7], 1e-9)).max()),
            )
            for row in result[result[:, 5] != 0]:
                what = ", ".join(name for bit, name in enumerate(WRONG) if int(row[5]) >> bit & 1)
                bad[f"{kinds[int(row[0])]} and {kinds[int(row[1])]}: {what}"] += 1
        took = time.perf_counter() - begin
        print(
            f"{cases // 2} cases with {'two faults' if pairs else 'one fault'} in {took:.0f} s on {threads} threads: "
            f"{stopped} loaders stopped; to the hand at most {injected:.1f} J, {share:.0%} of the bound"
        )
    for what, count in bad.most_common():
        print(f"WRONG {count} times: {what}")
    if bad:
        sys.exit(1)


if __name__ == "__main__":
    main()
