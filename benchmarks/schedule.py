"""Gains for many feel settings: one linear equation each, against one Riccati equation each.

Run ``python benchmarks/schedule.py``. On one core: checks that both give the same gains, then times python-control's
``lqr`` and ``dlqr`` on the six-state problem of each setting against ``schedule_gains`` on many settings at once. Ends
with an error if the answers differ or a ratio falls below the one that is promised.
"""

import os

# One thread: the limits are read when NumPy loads its linear algebra, so they stand before the imports.
os.environ.update({f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM")})
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

import control
import numpy as np
from core_peak import peak_flops

from forcefeel.laws.analog.gain_schedule import schedule_gains
from forcefeel.laws.analog.recursion import DesignSettings, SampledProblem
from forcefeel.linear.state_space import design_plant
from forcefeel.loader.built_in import elevator

SETTINGS = 200_000
PEER_SETTINGS = 200
REPEATS = 7
AGREEMENT = 1e-6  # share of each gain; the two agree to some 1e-10
PROMISED_RATIO = 1000

# Additions, multiplications and divisions per setting that the formulas of crates/solve/src/schedule.rs ask for, n = 4:
# system M'^2 + t M' + d (36), right-hand side Q', coupling times a 2 by 2 (32), LU n (n - 1) (4 n + 1) / 6 = 34, two
# triangular solves n (2 n - 1) = 28, row times right-hand side (14), coefficients of the feel (10).
CONTINUOUS_FLOPS = 36 + 32 + 34 + 28 + 14 + 10
# And the exponential of a 2 by 2 (30, its exp, sqrt, sin and cos as one each) and the gains times it (6).
SAMPLED_FLOPS = CONTINUOUS_FLOPS + 36


@dataclass(frozen=True)
class Contest:
    """One design method in one kind of time."""

    name: str
    peer: str
    continuous: bool
    solve: Callable
    flops: int


CONTESTS = (
    Contest("continuous", "control.lqr", True, control.lqr, CONTINUOUS_FLOPS),
    Contest("sampled", "control.dlqr", False, control.dlqr, SAMPLED_FLOPS),
)


def random_settings(loader, count):
    """I, B, G in SI units: 1 to 100 % of G_max, 0.5 to 4 Hz, damping ratio 0.1 to 1.5."""
    rng = np.random.default_rng(1974)
    stiffness = loader["feel.maximum_stiffness"] * rng.uniform(0.01, 1.0, count)
    w = 2 * np.pi * rng.uniform(0.5, 4.0, count)
    inertia = stiffness / w**2
    return np.column_stack([inertia, 2 * rng.uniform(0.1, 1.5, count) * w * inertia, stiffness])


def whole_problem(loader, setting, *, continuous):
    """Matrices of the six-state problem, states scaled to the order of one, and their scale."""
    own = loader.replace(
        dict(zip(("feel.inertia", "feel.damping", "feel.stiffness"), setting.tolist(), strict=True)), si=True
    )
    problem = SampledProblem.of(own, DesignSettings())
    scale, q = problem.scale[:6], problem.q[:6, :6]
    if not continuous:
        return (problem.phi[:6, :6], problem.h[:6], q, problem.r), scale
    plant = design_plant(own)
    return (plant.A[:6, :6] * scale / scale[:, None], plant.B[:6] / scale[:, None], q, problem.r), scale


def seconds(run):
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def median_seconds(run):
    return float(np.median([seconds(run) for _ in range(REPEATS)]))


def compete(contest, loader, settings, peak):
    """Checks the answer, prints one row of the table and returns how many times faster the schedule is."""
    problems = [whole_problem(loader, s, continuous=contest.continuous) for s in settings[:PEER_SETTINGS]]
    expected = np.array([-contest.solve(*matrices)[0][0] / scale for matrices, scale in problems])
    gains = schedule_gains(loader, settings[:PEER_SETTINGS], continuous=contest.continuous).gains
    error = np.max(np.abs(gains / expected - 1))
    if not error < AGREEMENT:
        sys.exit(f"{contest.name}: the gains differ by {error:.1e}; expected less than {AGREEMENT:g}")
    peer = float(np.median([median_seconds(lambda m=m: contest.solve(*m)) for m, _ in problems]))
    own = median_seconds(lambda: schedule_gains(loader, settings, continuous=contest.continuous)) / len(settings)
    share = contest.flops / own / peak
    print(
        f"{contest.name:<12}{contest.peer:<14}{peer * 1e6:>10.0f} us{own * 1e9:>12.0f} ns{peer / own:>10.0f}"
        f"{error:>12.0e}{contest.flops:>8}{share:>9.1%}"
    )
    return peer / own


def main():
    loader = elevator()
    settings = random_settings(loader, SETTINGS)
    peak = peak_flops()
    print(f"{SETTINGS} settings of the elevator loader, one core, peak {peak / 1e9:.0f} Gflop/s\n")
    print(
        f"{'time':<12}{'peer':<14}{'peer each':>13}{'here each':>15}{'ratio':>10}{'differ':>12}{'flops':>8}{'of peak':>9}"
    )
    ratios = [compete(contest, loader, settings, peak) for contest in CONTESTS]
    if min(ratios) < PROMISED_RATIO:
        sys.exit(f"\nthe schedule is {min(ratios):.0f} times faster; expected at least {PROMISED_RATIO}")


if __name__ == "__main__":
    main()
