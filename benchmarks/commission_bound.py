"""What forbids the machines on which ``commission`` falls short: its bound, computed and drawn.

Run ``python benchmarks/commission_bound.py rows.csv [--below 0.95] [--figure bound.svg]`` on the rows of ``commission.py --out``.
For each machine of a share below that: what the law renders that was made for what was identified; what one renders that was made
for the machine itself, friction exactly as it is, so that nothing is left of what bench and search do not know; and what the
machine would render with one thing of its hardware changed (``forcefeel.commission.what_ifs``), a law made for that, likewise
exactly known.
What no friction leaves is friction's; what lies between identified and known is the uncertainty's; the rest is the drive's.

Prints a row for each machine, in Markdown, and the change that asks least of the machine and reaches that share.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "forcefeel"
import matplotlib.pyplot as plt

sys.path.insert(0, str(Path(__file__).parent))

from commission_rows import read

from commission import PROMISED_TENTH, ROW, drawn, on_file, surely
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.what_ifs import what_ifs
from forcefeel.page.palette import COMPENSATED, COMPLIANT, IDEAL, RIGID

EVERYTHING = -1.0
"""Gain from which on a change is told: also what loses."""
DRAWN = {
    "as identified": ("o", COMPLIANT, True),
    "dry friction known exactly": ("o", IDEAL, False),
    "half the dry friction": ("s", RIGID, False),
    "no dry friction": ("s", RIGID, True),
    "encoder of 23 bits at the column": ("^", "#A8568A", False),
    "a force sensor at the grip (law grip)": ("D", COMPENSATED, True),
}
"""Marker, color and whether it is filled."""
BESIDE = 0.22
"""Of a line's height."""


def bounds(rows, machines):
    """By machine: its row, and the shares by what is changed."""
    plan = CommissionPlan()
    for row in rows:
        what_if_results = what_ifs(surely(machines[row["machine"] - 1]), row["law"] or "robust", plan, EVERYTHING)
        yield row, {"as identified": row["share"], **{result.change: result.passes for result in what_if_results}}


def lifting(shares, goal):
    """What asks least of the hardware and reaches a share."""
    changes = list(shares.items())[2:]
    return next((change for change, share in changes if share >= goal), "none of these alone")


def draw(results, path):
    """A line for each machine, a mark for each share."""
    figure, axes = plt.subplots(figsize=(8, 1.7 + 0.4 * len(results)), layout="constrained")
    for at, (_, shares) in enumerate(results):
        marks = [(name, share) for name, share in shares.items() if name in DRAWN]
        low, high = min(share for _, share in marks), max(share for _, share in marks)
        axes.plot([100 * low, 100 * high], [at, at], color="#cccccc", linewidth=1, zorder=1)
        for name, share in marks:
            marker, color, filled = DRAWN[name]
            style = {"color": color, "markerfacecolor": color if filled else "white", "markersize": 7, "linestyle": ""}
            x = at + (BESIDE if name.startswith("a force sensor") else 0.0)  # it stands where no friction does
            axes.plot(100 * share, x, marker, label=name if not at else None, zorder=2, **style)
    axes.axvline(100 * PROMISED_TENTH, color="#888888", linewidth=0.8, linestyle=":")
    axes.set_yticks(
        range(len(results)), [f"machine {row['machine']}, {row['friction_lb']:.1f} lb" for row, _ in results]
    )
    axes.set_ylim(len(results) - 0.4, -0.6)
    axes.set_xlabel("settings within tolerance, %")
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside upper center", ncols=2, frameon=False, fontsize="small")
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("rows", type=Path, help="of commission.py --out")
    parser.add_argument("--below", type=float, default=PROMISED_TENTH)
    parser.add_argument("--seed", type=int, default=2026, help="of the rows")
    parser.add_argument("--figure", type=Path)
    options = parser.parse_args()
    every = read(options.rows, ROW)
    rows = sorted((row for row in every if row["share"] < options.below), key=lambda row: row["share"])
    machines = list(drawn(on_file(), max(row["machine"] for row in every), options.seed))
    results = list(bounds(rows, machines))
    for k, (row, shares) in enumerate(results):
        if not k:
            print("| machine | friction |", " | ".join(shares), f"| what asks least and reaches {options.below:.0%} |")
            print("|---|---|", "---|" * (len(shares) + 1), sep="")
        text = " | ".join(f"{share:.1%}" for share in shares.values())
        print(f"| {row['machine']} | {row['friction_lb']:.2f} lb | {text} | {lifting(shares, options.below)} |")
    print(f"{len(results)} of {len(every)} machines are below {options.below:.0%}")
    if options.figure and results:
        draw(results, options.figure)


if __name__ == "__main__":
    main()
