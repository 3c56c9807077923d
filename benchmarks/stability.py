"""Stability of a million closed loops of eight states: Routh's signs in vector lanes beside NumPy's batched eigenvalues.

Run ``python benchmarks/stability.py``. Every loop has its own parameters; the time here includes building its matrix from
them, NumPy is given the matrices. First the verdicts are held against NumPy's eigenvalues, wherever these are far enough from
the axis to tell, for several choices of parameters and for both laws. Then both are timed by their own time on one core, and
last the verdicts on all cores by the wall's. Ends with an error if an answer differs or a promise is not kept.
"""

import os

os.environ.update({f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM")})
ALL_CORES = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [0]
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {ALL_CORES[0]})

import sys
import time

import numpy as np
from core_peak import cpu_seconds, peak_flops

from forcefeel import _core
from forcefeel.laws.analog.recursion import design_gains
from forcefeel.linear.models import state_feedback
from forcefeel.loader.built_in import elevator
from forcefeel.loader.parameters import INDEX, PLANT_PARAMETERS
from forcefeel.sweep.stability import stability_batch

LOOPS, CHECKED, REPEATS = 1_000_000, 20_000, 5
TRUSTED = 1e-10  # share of the largest pole from which the sign of NumPy's real parts is to be trusted
PROMISED_RATIO, PROMISED_CORES = 10, 1.9
# Operations of the kernel on a loop, in double precision: 486 fused products and sums of twice the digits with their bounds, 29
# operations each (a fused one counts as two); exchanges, balancing and the matrix itself come on top and are not counted.
FLOPS = 486 * 29

LOADER = elevator()
WHOLE = [
    *(key for key in PLANT_PARAMETERS if key not in ("column.base_arm", "column.grip_arm")),
    *("load_cell.gain", "potentiometer.gain", "feel.inertia", "feel.damping", "feel.stiffness"),
]
CASES = {
    "two settings of the feel": (("feel.stiffness", "feel.inertia"), 1.0),
    "link and column": (("linkage.stiffness", "column.inertia"), 1.0),
    "three of the servo": (("valve.current_gain", "potentiometer.gain", "actuator.bulk_modulus"), 1.0),
    "seventeen, within 25 %": (WHOLE, 0.1),
    "seventeen, over two decades": (WHOLE, 1.0),
}


def draw(keys, decades, count):
    """Values of the parameters, each within so many decades to either side of the loader's."""
    rng = np.random.default_rng(1974)
    return {key: LOADER[key] * 10 ** rng.uniform(-decades, decades, count) for key in keys}


def matrices(varied, law, count):
    systems = np.empty((count, 8, 8))
    values = LOADER.si_values.copy()
    for k in range(count):
        for key, column in varied.items():
            values[INDEX[key]] = column[k]
        systems[k] = _core.compliant(values, law or _core.GainLaw.original(values))[0]
    return systems


def wrong(varied, law, systems):
    """How many verdicts are not those of NumPy's eigenvalues, how many these cannot tell, and how many are stable."""
    first = {key: column[:CHECKED] for key, column in varied.items()}
    stable = stability_batch(LOADER, first, law, threads=1).stable.values
    poles = np.linalg.eigvals(systems)
    largest, size = poles.real.max(axis=1), np.abs(poles).max(axis=1)
    clear = np.abs(largest) > TRUSTED * size
    return np.sum(stable[clear] != (largest[clear] < 0)), np.sum(~clear), stable.mean()


def main():
    failed = []
    peak = peak_flops()
    print(f"{LOOPS:,} loops of the elevator loader, one core, peak {peak / 1e9:.0f} Gflop/s\n")
    print(
        f"{'varied':<30}{'law':<10}{'wrong':>6}{'stable':>9}{'proved':>9}{'here':>9}{'eigvals':>10}{'ratio':>7}{'of peak':>9}"
    )
    laws = {"original": None, "feedback": state_feedback(LOADER, design_gains(LOADER).gains)}
    for name, (keys, decades) in CASES.items():
        for law_name, law in laws.items():
            varied = draw(keys, decades, LOOPS)
            systems = matrices(varied, law, CHECKED)
            errors, _, stable = wrong(varied, law, systems)
            verdicts = stability_batch(LOADER, varied, law, threads=1)
            own_seconds = cpu_seconds(lambda v=varied, law=law: stability_batch(LOADER, v, law, threads=1)) / LOOPS
            peer = cpu_seconds(lambda s=systems: np.linalg.eigvals(s)) / CHECKED
            ratio = peer / own_seconds
            proved = f"{verdicts.proved.values.mean():9.3%}"
            speed = f"{own_seconds * 1e6:6.2f} us{peer * 1e6:7.2f} us{ratio:7.1f}{FLOPS / own_seconds / peak:9.0%}"
            print(f"{name:<30}{law_name:<10}{errors:>6}{stable:9.1%}{proved}{speed}", flush=True)
            if errors:
                failed.append(f"{name}, {law_name}: {errors} verdicts are not those of the eigenvalues")
            if ratio < PROMISED_RATIO:
                failed.append(f"{name}, {law_name}: {ratio:.1f} times NumPy, expected {PROMISED_RATIO}")
    both_cores(failed)
    for failure in failed:
        print("FAILED", failure)
    sys.exit(bool(failed))


def both_cores(failed):
    """The kernel by the wall's time, best of some: it takes an idle machine."""
    if len(ALL_CORES) < 2:
        return
    os.sched_setaffinity(0, set(ALL_CORES))
    varied = draw(*CASES["two settings of the feel"], LOOPS)
    loops = _core.Loops(LOADER.si_values, [INDEX[key] for key in varied], np.column_stack(list(varied.values())))
    spent = {}
    for threads in (1, len(ALL_CORES)) * REPEATS:
        begin = time.perf_counter()
        loops.stability(threads)
        spent[threads] = min(spent.get(threads, np.inf), time.perf_counter() - begin)
    ratio = spent[1] / spent[len(ALL_CORES)]
    print(f"\n{len(ALL_CORES)} cores: {ratio:.2f} times one; {spent[len(ALL_CORES)]:.2f} s for {LOOPS:,} loops")
    if len(ALL_CORES) == 2 and ratio < PROMISED_CORES:
        failed.append(f"two cores: {ratio:.2f} times one, expected {PROMISED_CORES}; is the machine idle?")


if __name__ == "__main__":
    main()
