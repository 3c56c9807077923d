"""The nonlinear step of the elevator loader, Monte Carlo over its parameters: this engine beside its peers.

Run ``python benchmarks/simulation.py``. The case is in ``peers/case.py``: orifice valve, valve dynamics, current limit, dry
friction, stops, a 96 lb step at 0.1 s, 2 s, a sample each 1 ms. The reference is the tests' independent witness, which
finds every switch of friction and stop as an event and steps to 1e-10 between them; the samples are none that anything was
tuned on. Every contestant is first held to the error that the comparison allows, then timed by its own time on one core, and
last on all cores.

Peers that are not installed are said to be missing: ``pip install numba jax numbalsoda``; a C compiler for the hand-written kernel.
"""

import os

os.environ.update({f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM", "NUMBA")})
ALL_CORES = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [0]
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {ALL_CORES[0]})

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent
sys.path[:0] = [str(ROOT), str(ROOT.parent / "tests")]

from core_peak import peak_flops
from peers import case, jax_diffrax, kernel, numba_rk4, numbalsoda_lsoda, scipy_lsoda

import nonlinear_witness as witness
from forcefeel.loader.built_in import elevator
from forcefeel.loader.parameters import TABLE
from forcefeel.simulation import Scenario, simulate, simulate_batch
from forcefeel.simulation.inputs import Step

POUND = 4.4482216152605
SAMPLES = 40
FASTEST = 2e-3
"""Longest step, in s; a sample each 1 ms all the same."""

OPERATIONS = 510, 10, 176
"""Sums and products, divisions and roots, the rest of a step and run, as crates/batch/tests/all/operations.rs counts them."""

RUNS = 4096
REPEATS = 5
PROMISED_OVER_SCIPY, PROMISED_SINGLE, PROMISED_OVER_COMPILED = 1000, 50, 20
KEYS = dict(
    zip(
        case.NAMES,
        (
            "amplifier.admittance",
            "valve.natural_frequency",
            "valve.damping_ratio",
            "valve.rated_flow",
            "valve.supply_pressure",
            "actuator.area",
            "actuator.oil_volume",
            "actuator.bulk_modulus",
            "linkage.stiffness",
            "linkage.damping",
            "column.inertia",
            "load_cell.gain",
            "potentiometer.gain",
            "feel.inertia",
            "feel.damping",
            "feel.stiffness",
        ),
        strict=True,
    )
)
WITNESS = (
    "admittance",
    "valve_frequency",
    "valve_damping_ratio",
    "rated_flow",
    "supply_pressure",
    "area",
    "oil_volume",
    "bulk_modulus",
    "link_stiffness",
    "link_damping",
    "column_inertia",
    "load_cell_gain",
    "potentiometer_gain",
    "feel_inertia",
    "feel_damping",
    "feel_stiffness",
)
LOADER = elevator().replace(
    {
        "amplifier.current_limit": f"{case.CURRENT_LIMIT} mA",
        "valve.orifice": True,
        "column.coulomb_friction": "3 lb",
        "column.stop_low": -case.STOP,
        "column.stop_high": case.STOP,
        "column.stop_stiffness": f"{case.STOP_STIFFNESS} lb in/rad",
        "column.stop_damping": f"{case.STOP_DAMPING} lb in s/rad",
    },
    si=True,
)


def scenario(step_s):
    return Scenario(Step(96 * POUND, case.STEP_TIME), case.DURATION, step_s=step_s, sample_s=1e-3)


def values(parameters):
    """Rows of the parameter table for rows of the case's numbers."""
    rows = np.tile(LOADER.si_values, (len(parameters), 1))
    for k, key in enumerate(KEYS.values()):
        rows[:, list(TABLE).index(key)] *= parameters[:, k] / case.NOMINAL[k]
    return rows


def fresh(count):
    """Samples that nothing was tuned on."""
    factors = np.random.default_rng(1974).uniform(1 - case.SPREAD, 1 + case.SPREAD, (count, len(case.NAMES)))
    return case.NOMINAL * factors


def reference(parameters):
    """The witness's column angles."""
    bare = witness.Machine(
        orifice=True,
        current_limit=case.CURRENT_LIMIT,
        coulomb_friction=3.0,
        static_friction=3.0,
        stop_low=-case.STOP,
        stop_high=case.STOP,
        stop_stiffness=case.STOP_STIFFNESS,
        stop_damping=case.STOP_DAMPING,
    )
    machines = (replace(bare, **dict(zip(WITNESS, row.tolist(), strict=True))) for row in parameters)
    push, solver = [(case.STEP_TIME, 96.0)], witness.Solver("LSODA", 1e-10)
    return np.array(
        [witness.simulate(machine, push, case.DURATION, case.TIMES, solver=solver)["theta"] for machine in machines]
    )


def own(parameters, step_s):
    runs = simulate_batch(LOADER, scenario(step_s), values(parameters), keep=("column_angle_rad",), threads=1)
    return runs["column_angle_rad"].values


def rate(run, count, clock=time.process_time):
    """Runs a second: the median of some repeats, of the process's own time."""
    run()
    spent = []
    for _ in range(REPEATS):
        begin = clock()
        run()
        spent.append(clock() - begin)
    return count / np.median(spent)


@dataclass(frozen=True)
class Contestant:
    """Somebody who solves the case.

    Attributes:
        name: Who.
        run: Column angles of rows of the case's numbers.
        runs: How many are timed.
        kind: ``own``, ``solver`` (a general solver with the case's equations) or ``kernel`` (written by hand for this very case).
    """

    name: str
    run: Callable
    runs: int
    kind: str


def contestants():
    own_ones = [
        Contestant(f"forcefeel, batch, steps of {step * 1e3:g} ms", lambda p, step=step: own(p, step), RUNS, "own")
        for step in (2e-3, 1e-3)
    ]
    peers = [
        (scipy_lsoda, Contestant(scipy_lsoda.NAME_PLAIN + " (8 states)", scipy_lsoda.run_plain, 4, "solver")),
        (scipy_lsoda, Contestant(scipy_lsoda.NAME + " (pressure slaved)", scipy_lsoda.run, 32, "solver")),
        (numbalsoda_lsoda, Contestant(numbalsoda_lsoda.NAME, numbalsoda_lsoda.run, 400, "solver")),
        (jax_diffrax, Contestant(jax_diffrax.NAME, jax_diffrax.run, 1024, "kernel")),
        (numba_rk4, Contestant(numba_rk4.NAME, numba_rk4.run, RUNS, "kernel")),
        (kernel, Contestant(kernel.NAME + ", 1 ms", kernel.run, RUNS, "kernel")),
    ]
    for module, peer in peers:
        if module.available():
            own_ones.append(peer)
        else:
            print(f"{peer.name}: not installed, left out")
    return own_ones


def main():
    samples = fresh(SAMPLES)
    print(f"reference: {SAMPLES} fresh samples by the independent witness ...", flush=True)
    truth = reference(samples)
    timed = fresh(RUNS)
    rates, failed = {}, []
    print(f"{'':44} {'runs/s':>9} {'P90':>9} {'worst':>9}   errors as shares of {case.TRAVEL:g} rad of travel")
    for contestant in contestants():
        error = case.errors(contestant.run(samples), truth)
        p90, worst = np.percentile(error, 90), error.max()
        rates[contestant] = rate(
            lambda contestant=contestant: contestant.run(timed[: contestant.runs]), contestant.runs
        )
        good = p90 <= case.ALLOWED_P90 and worst <= case.ALLOWED_WORST
        print(
            f"{contestant.name:44} {rates[contestant]:9,.0f} {p90:9.1e} {worst:9.1e}   {'' if good else 'error too large'}",
            flush=True,
        )
        if contestant.kind == "own" and not good:
            failed.append(f"{contestant.name}: error {p90:.1e}, {worst:.1e}")
    report(rates, failed)
    for failure in failed:
        print("FAILED", failure)
    sys.exit(bool(failed))


def report(rates, failed):
    """Ratios, the single run, and both cores."""
    own_rate = next(rate for contestant, rate in rates.items() if contestant.kind == "own")
    for contestant, peer_rate in rates.items():
        if contestant.kind != "own":
            print(f"forcefeel's batch in steps of 2 ms is {own_rate / peer_rate:8.2f} times {contestant.name}")
    plain = next(rate for contestant, rate in rates.items() if "plain" in contestant.name)
    single = rate(lambda: [simulate(LOADER, scenario(FASTEST)) for _ in range(20)], 20)
    measured = rate(lambda: simulate_batch(LOADER, scenario(FASTEST), values(fresh(RUNS)), threads=1), RUNS)
    peak, steps = peak_flops(), case.DURATION / FASTEST
    flops = sum(OPERATIONS[:2]) * steps * measured
    print(
        f"measures alone: {measured:,.0f} runs a second, {flops / 1e9:.0f} Gflop/s, {flops / peak:.0%} of the core's peak of "
        f"{peak / 1e9:.0f}; half of that is fused operations, which are left out so that every machine gives the same bits"
    )
    print(f"a single run: {single:,.0f} a second, {single / plain:.0f} times SciPy's LSODA")
    check(failed, "batch over SciPy's LSODA", own_rate / plain, PROMISED_OVER_SCIPY)
    check(failed, "single run over SciPy's LSODA", single / plain, PROMISED_SINGLE)
    compiled = [rate for contestant, rate in rates.items() if contestant.name == numbalsoda_lsoda.NAME]
    if compiled:
        check(failed, "batch over compiled LSODA", own_rate / compiled[0], PROMISED_OVER_COMPILED)
    both_cores()


def check(failed, what, ratio, promised):
    if ratio < promised:
        failed.append(f"{what}: {ratio:.1f} times, expected {promised}")


def both_cores():
    """By the wall's time, best of some: it takes an idle machine."""
    if len(ALL_CORES) < 2:
        return
    os.sched_setaffinity(0, set(ALL_CORES))
    many = values(fresh(4 * RUNS))
    spent = {}
    for threads in (1, len(ALL_CORES)) * REPEATS:
        begin = time.perf_counter()
        simulate_batch(LOADER, scenario(FASTEST), many, threads=threads)
        spent[threads] = min(spent.get(threads, np.inf), time.perf_counter() - begin)
    ratio = spent[1] / spent[len(ALL_CORES)]
    print(f"{len(ALL_CORES)} cores: {ratio:.2f} times one; {len(many) / spent[len(ALL_CORES)]:,.0f} runs a second")


if __name__ == "__main__":
    main()
