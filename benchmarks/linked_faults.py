"""A million faults on one side of two linked loaders, in virtual time, and 100,000 runs without one.

    python benchmarks/linked_faults.py [cases] [threads]

The pairs are those of the projects in ``examples/cockpit``, under the law ``robust``: hands on both sides, one or two faults on one
of them, whose column is held by an arm or a clamp, or pushed into an end stop, every other time; see ``crates/faults/src/pair.rs``.
It fails where ``benchmarks/faults.py`` would, on either side, and further if an electronic link stops the other side, if the link
pushes the other hand with more than the largest legal force, or if a run without a fault is stopped. A hand that pushes beyond the
limits itself does so over a link, too.
"""

import os
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import faults
import numpy as np
from numpy.typing import NDArray

import forcefeel as ff
from forcefeel import _core
from forcefeel.linked.joint import delay_periods
from forcefeel.loader.links import AfterBreakout, LinkKind

PROJECTS = "linked-sticks", "transport", "uncoupling", "helicopter"
COCKPITS = Path(__file__).parent.parent / "examples/cockpit"
LINK, FAULTY, FORCE, STEP, SIDES = 0, 1, 2, 3, 4
"""Columns of the outcomes; from the last on those of both sides."""

Rows = NDArray[np.float64]


@dataclass
class Pair:
    """Linked loaders of a ready project, and their laws."""

    name: str
    link: ff.linked.Link
    loaders: tuple[ff.Loader, ff.Loader]

    @property
    def laws(self) -> list[Rows]:
        """A row for each side."""
        made = [ff.Law.of("robust", loader).sampled for loader in self.loaders]
        return [law.rows()[0] for law in made if law is not None]


def pairs() -> list[Pair]:
    """The links of the ready projects."""
    projects = [ff.loader.read_project(COCKPITS / f"{name}.toml") for name in PROJECTS]
    return [
        Pair(f"{project.name}, {link.name}", link, project.sides(link))
        for project in projects
        for link in project.pilot_links.values()
    ]


def run(of: list[Pair], faulty: int, cases: int, threads: int) -> Rows:
    """Outcomes of the cases, each with so many faults on one side."""
    values = np.array([loader.si_values for pair in of for loader in pair.loaders])
    laws = np.array([row for pair in of for row in pair.laws])
    links = [
        (
            (2 * k, 2 * k + 1),
            pair.link.values.tolist(),
            delay_periods(pair.link, pair.loaders),
            pair.link.after_breakout is AfterBreakout.UNCOUPLE,
        )
        for k, pair in enumerate(of)
    ]
    pieces = [
        _core.supervised_pair_faults(
            values, laws, links, seed=7, first=k, count=min(faults.PIECE, cases - k), faults=faulty, threads=threads
        )
        for k in range(0, cases, faults.PIECE)
    ]
    return np.concatenate(pieces)


def judged(of: list[Pair], outcomes: Rows, faulty: int) -> Counter[str]:
    """What went wrong, and how often."""
    sides = outcomes[:, SIDES:].reshape(len(outcomes), 2, -1)
    which, at = outcomes[:, LINK].astype(int), outcomes[:, FAULTY].astype(int)
    other = sides[np.arange(len(outcomes)), 1 - at]
    largest = np.array([[loader["safety.absolute_force"] for loader in pair.loaders] for pair in of])[which, 1 - at]
    kinds = [_core.fault_kinds().index(kind) for kind in faults.OF_HAND]
    by_hand = np.isin(sides[np.arange(len(outcomes)), at][:, [faults.KIND, faults.SECOND]], kinds).any(axis=1)
    electronic = np.array([pair.link.kind is LinkKind.ELECTRONIC for pair in of])[which]
    conditions = {
        "the other side is stopped": electronic & (faulty > 0) & (other[:, faults.STOPPED] >= 0),
        "the link pushes with more than the largest legal force": (outcomes[:, FORCE] > largest) & ~by_hand,
        "stopped without a fault": (faulty == 0) & (sides[:, :, faults.STOPPED] >= 0).any(axis=1),
    }
    bad = Counter[str]()
    for k, pair in enumerate(of):
        for side in (0, 1):
            mine = sides[(which == k) & ~(by_hand & (at != side)), side]
            bad += Counter({f"{pair.name}: {what}": n for what, n in faults.judged(mine, faulty).items()})
        bad += Counter({f"{pair.name}: {what}": int(wrong[which == k].sum()) for what, wrong in conditions.items()})
    return bad


def main() -> None:
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else faults.CASES
    threads = int(sys.argv[2]) if len(sys.argv) > 2 else os.cpu_count() or 1
    of, bad = pairs(), Counter[str]()
    for faulty, count in ((0, cases // 10), (1, cases // 2), (2, cases // 2)):
        begin = time.perf_counter()
        outcomes = run(of, faulty, count, threads)
        print(f"{count} cases with {faulty} faults in {time.perf_counter() - begin:.0f} s on {threads} threads")
        sides = outcomes[:, SIDES:].reshape(len(outcomes), 2, -1)
        other = sides[np.arange(len(outcomes)), 1 - outcomes[:, FAULTY].astype(int)]
        for k, pair in enumerate(of):
            mine = outcomes[:, LINK] == k
            print(
                f"  {pair.name}: at most {sides[mine][..., faults.EXCESS].max():.1f} J beyond the feel, "
                f"{sides[mine][..., faults.ABOVE].max() * 1e3:.0f} ms above 1.5 times the largest force; of the other side "
                f"{(other[mine][:, faults.STOPPED] >= 0).mean():.1%} stopped, {other[mine][:, faults.EXCESS].max():.2f} J; "
                f"link {outcomes[mine][:, FORCE].max():.0f} N there, {outcomes[mine][:, STEP].max():.1f} N in a period"
            )
        bad += judged(of, outcomes, faulty)
    for what, count in bad.most_common():
        print(f"WRONG {count} times: {what}")
    if bad:
        sys.exit(1)


if __name__ == "__main__":
    main()
