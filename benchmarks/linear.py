"""The linear step response of the elevator loader, Monte Carlo over its parameters: this engine beside its peers.

Run ``python benchmarks/linear.py``. Two seconds, a sample each 1 ms, a 96 lb step at 0.1 s, every run with its own matrices. The
yardstick is a kernel written by hand in C with eight lanes (``peers/linear_kernel.c``), which is given its transition matrices;
the time here includes all: the matrices from the parameters, their exponentials, the steps, the labeled result. What is left
without the preparation is told by runs of sixteen steps. First every contestant is held against python-control's exact
response, then all are timed by their own time on one core, last on all cores. Ends with an error if an answer differs or a
promise is not kept.
"""

import os

os.environ.update({f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM")})
ALL_CORES = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [0]
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {ALL_CORES[0]})

import sys
import time
from pathlib import Path

import control
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))

from core_peak import cpu_seconds, peak_flops
from peers import case, linear_kernel
from peers.kernel import aligned

from forcefeel.linear.state_space import compliant_model
from forcefeel.loader.built_in import elevator
from forcefeel.loader.loader import Loader
from forcefeel.loader.parameters import INDEX
from forcefeel.simulation import Scenario
from forcefeel.simulation.inputs import Step
from forcefeel.simulation.linear import simulate_linear_batch

POUND = 4.4482216152605
# Histories of just below 32 MB: larger ones come anew from the operating system at each call, which takes longer than the runs.
RUNS, CHECKED, REPEATS, WARM_UP = 1984, 24, 21, 3
STEPS = case.OUTPUTS - 1
AGREEMENT = 1e-8  # of the largest angle; python-control exponentiates an unbalanced matrix
PROMISED_OF_KERNEL, PROMISED_OVER_CONTROL, PROMISED_CORES = 2.0, 1000, 1.9
# Fused products of a step: nine for the sample, 72 of the state for sixteen of them; each counts as two.
FLOPS = 2 * (9 + 72 / 16)
LOADER = elevator()
KEYS = {
    "K_2": "amplifier.admittance",
    "w_n": "valve.natural_frequency",
    "zeta": "valve.damping_ratio",
    "A": "actuator.area",
    "V_E": "actuator.oil_volume",
    "beta": "actuator.bulk_modulus",
    "k": "linkage.stiffness",
    "c": "linkage.damping",
    "J": "column.inertia",
    "K_1": "load_cell.gain",
    "K_3": "potentiometer.gain",
    "I": "feel.inertia",
    "B": "feel.damping",
    "G": "feel.stiffness",
}


def scenario(duration_s):
    start = case.STEP_TIME if duration_s == case.DURATION else 0.0
    return Scenario(Step(96 * POUND, start), duration_s)


def values(parameters):
    """Rows of the parameter table for rows of the case's numbers."""
    rows = np.tile(LOADER.si_values, (len(parameters), 1))
    for name, key in KEYS.items():
        column = case.NAMES.index(name)
        rows[:, INDEX[key]] *= parameters[:, column] / case.NOMINAL[column]
    return rows


def own(rows, duration_s=case.DURATION, threads=1):
    return simulate_linear_batch(LOADER, scenario(duration_s), rows, threads=threads).column_angle_rad.values


def by_control(rows):
    """Exact responses: from the step on, as python-control draws straight lines between samples."""
    after = np.full(case.OUTPUTS - case.STEP_OUTPUT, 96 * POUND)
    outputs = np.zeros((len(rows), case.OUTPUTS))
    for angle, row in zip(outputs, rows, strict=True):
        model = compliant_model(Loader("one", "here", row))[0, 0]
        angle[case.STEP_OUTPUT :] = control.forced_response(model, case.TIMES[: len(after)], after).outputs
    return outputs


def check_answers(parameters, rows, failed):
    expected = by_control(rows[:CHECKED])
    answers = {"forcefeel": own(rows[:CHECKED])}
    if linear_kernel.available():
        answers |= {name: linear_kernel.run(parameters[:CHECKED], form) for form, name in linear_kernel.NAMES.items()}
    for name, angles in answers.items():
        error = np.abs(angles - expected).max() / np.abs(expected).max()
        print(f"{name:<28} differs from control.forced_response by {error:.0e} of the largest angle")
        if not error < AGREEMENT:
            failed.append(f"{name}: differs by {error:.1e}, expected less than {AGREEMENT:g}")


def kernel_seconds(parameters, form):
    """Seconds of the kernel in C alone; its matrices are there."""
    systems = linear_kernel.grouped(parameters, form)
    theta = aligned(len(systems), case.OUTPUTS, linear_kernel.LANES)
    return cpu_seconds(lambda: linear_kernel.simulate(systems, theta, form), REPEATS, WARM_UP)


def main():
    failed = []
    parameters = case.draw(RUNS)
    rows = values(parameters)
    check_answers(parameters, rows, failed)
    peak = peak_flops()
    whole = cpu_seconds(lambda: own(rows), REPEATS, WARM_UP)
    prepared = cpu_seconds(lambda: own(rows, 16e-3), REPEATS, WARM_UP)
    steps = RUNS * STEPS
    print(f"\n{RUNS} runs of {STEPS} steps, one core, peak {peak / 1e9:.0f} Gflop/s; ns a step and run")
    print(f"{'forcefeel, all included':<44}{whole / steps * 1e9:8.2f}{FLOPS * steps / whole / peak:8.0%} of peak")
    bare = (whole - prepared) / (steps - 16 * RUNS)
    print(f"{'forcefeel, matrices prepared':<44}{bare * 1e9:8.2f}{FLOPS / bare / peak:8.0%} of peak")
    print(f"{'    preparation, us a run':<44}{(prepared - 16 * RUNS * bare) / RUNS * 1e6:8.2f}")
    if linear_kernel.available():
        for form, name in linear_kernel.NAMES.items():
            peer = kernel_seconds(parameters, form)
            print(f"{name:<44}{peer / steps * 1e9:8.2f}   forcefeel takes {whole / peer:.2f} times that, ", end="")
            print(f"prepared {bare * steps / peer:.2f} times")
            if form == "dense" and whole > PROMISED_OF_KERNEL * peer:
                failed.append(f"{whole / peer:.2f} times the time of {name}, expected at most {PROMISED_OF_KERNEL}")
    else:
        failed.append("no C compiler for the yardstick")
    few = rows[:CHECKED]
    peer = cpu_seconds(lambda: by_control(few), 3) / CHECKED * RUNS
    print(f"{'control.forced_response':<44}{peer / steps * 1e9:8.0f}   {peer / whole:,.0f} times the time of forcefeel")
    if peer < PROMISED_OVER_CONTROL * whole:
        failed.append(f"{peer / whole:.0f} times as fast as control.forced_response, expected {PROMISED_OVER_CONTROL}")
    all_cores(rows)
    for failure in failed:
        print("FAILED", failure)
    sys.exit(bool(failed))


def all_cores(rows):
    """By the wall's time, best of some: it takes an idle machine."""
    if len(ALL_CORES) < 2:
        return
    os.sched_setaffinity(0, set(ALL_CORES))
    spent = {}
    for threads in (1, len(ALL_CORES)) * REPEATS:
        begin = time.perf_counter()
        own(rows, threads=threads)
        spent[threads] = min(spent.get(threads, np.inf), time.perf_counter() - begin)
    print(f"{len(ALL_CORES)} cores: {spent[1] / spent[len(ALL_CORES)]:.2f} times one")


if __name__ == "__main__":
    main()
