"""How well and how fast a loader is identified from records of 60 s that the engine did not make.

Run ``python benchmarks/identification.py``. Draws 200 machines, each with its own k, c, J, C_i and F_c within 20 % of the file's,
runs them through one multisine on the integrator of ``examples/bench``, which shares no line with the engine, adds noise of 1 % to
every sensor, and identifies each from its record alone, from the file's values on. Then asserts what is promised of every set of
channels: errors of k, c, J, C_i below 2 %, every parameter within four standard errors, and the truth inside the 95 % interval in
90 to 99 of 100 machines. So it does with loaders whose other parameters are the built-in one's times 1/2 to 2.

Last it times one fit, and its exact slopes beside central differences of plain runs on the batch engine, the answers asserted
first. Ends with an error if anything does not hold.

By itself it takes 200 machines for the sets of channels that a bench measures first, and two for each other set that ``excite
--measure`` can ask for, in some ten minutes on two cores. ``--machines 200 --others 200 --loaders 200`` is all of it, two hours.
``--measure`` takes one set alone, ``--measure all`` that of all nine channels. ``--seed`` draws other machines.
"""

import argparse
import sys
import time
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from drawn_machines import CHANNELS, FITTED, RATE_HZ, TIME_S, further_loaders, machines, records

import forcefeel as ff
from forcefeel.bench.identification.fit import identify
from forcefeel.bench.identification.record_run import RecordRun
from forcefeel.bench.records import BenchRecord
from forcefeel.simulation import Scenario, simulate_batch
from forcefeel.simulation.inputs import Schedule
from forcefeel.threads import cores

KEYS = tuple(FITTED)
PROMISED_KEYS = 4
"""The first of them, whose errors are promised; 2 % of the friction are a small force."""

ANGLE, PISTON, PRESSURE = "column_angle", "piston_position", "load_pressure"
MAIN_SETS = ((ANGLE, PISTON), (ANGLE, PISTON, PRESSURE))
"""The two motions, and what ``excite --measure`` takes if nothing is said."""
OTHER_SETS = (
    CHANNELS,
    *((channel,) for channel in CHANNELS),
    *((ANGLE, channel) for channel in CHANNELS if channel not in (ANGLE, PISTON)),
)

PROMISED_ERROR, PROMISED_INSIDE, PROMISED_DEVIATIONS = 0.02, (0.90, 0.99), 4.0
ENOUGH = 100
"""Machines from which on their share inside the intervals is judged: of fewer, 99 of 100 is a matter of luck."""
TOGETHER = 50
"""Machines whose records are in memory at once."""
PROMISED_SECONDS = 10.0
REPEATS = 5
SLOPES = {
    "column_angle": "column_angle_rad",
    "piston_position": "piston_position_m",
    "load_pressure": "load_pressure_pa",
}
"""Channels of which slopes are compared, and the batch engine's names for them."""


def fitted(loader, record, channels):
    """Estimates, their standard errors and the ends of their intervals, (4, KEYS)."""
    seen = BenchRecord(
        record.name,
        record.experiment,
        record.time_s,
        {name: record.channels[name] for name in ("test_signal", *channels)},
    )
    identified = identify(loader, [seen], KEYS, starts=1)
    return np.array(
        [(estimate.value, estimate.deviation, estimate.low, estimate.high) for estimate in identified.estimates]
    ).T


def all_fitted(drawn, sets, seed):
    """What is found from each set of channels of as many machines as the set asks for: by set, (machines, 4, KEYS)."""
    estimates = defaultdict(list)
    most = max(sets.values())
    with ThreadPoolExecutor(cores()) as pool:
        for first in range(0, most, TOGETHER):
            which = slice(first, min(first + TOGETHER, most))
            data = list(records(drawn, which, seed))
            for channels, count in sets.items():
                batch = data[: max(0, count - first)]
                estimates[channels] += pool.map(lambda record, c=channels: fitted(drawn.loader, record, c), batch)
    return {channels: np.array(rows) for channels, rows in estimates.items()}


def check(name, estimates, truth):
    """Prints errors and coverage, and says what does not hold. ``found`` (machines, 4, KEYS), ``truth`` (machines, KEYS)."""
    value, deviation, low, high = np.moveaxis(estimates, 1, 0)
    error = np.abs(value / truth - 1)
    apart = np.abs(value - truth) / deviation
    inside = ((low <= truth) & (truth <= high)).mean(axis=0)
    print(f"\n{name}, {len(truth)} machines")
    print(f"{'':24}{'median error':>13}{'largest':>11}{'in standard errors':>20}{'95 % interval holds it':>24}")
    for j, key in enumerate(KEYS):
        print(
            f"{key:24}{100 * np.median(error[:, j]):11.3f} %{100 * error[:, j].max():9.3f} %{apart[:, j].max():20.1f}"
            f"{100 * inside[j]:22.1f} %"
        )
    wrong = []
    if error[:, :PROMISED_KEYS].max() >= PROMISED_ERROR:
        wrong.append(f"{100 * error[:, :PROMISED_KEYS].max():.2f} % off, promised are {100 * PROMISED_ERROR:.0f} %")
    if not apart.max() < PROMISED_DEVIATIONS:
        wrong.append(f"{apart.max():.1f} standard errors off, promised are {PROMISED_DEVIATIONS:.0f}")
    if len(truth) >= ENOUGH and not np.all((PROMISED_INSIDE[0] <= inside) & (inside <= PROMISED_INSIDE[1])):
        wrong.append(f"the intervals hold the truth in {np.round(100 * inside, 1)} %, promised are 90 to 99 %")
    return [f"{name}: {sentence}" for sentence in wrong]


def experiment(loader, time_s, signal):
    """What the batch engine is asked for: the scenario and the position loop."""
    drive = Schedule(tuple(time_s.tolist()), tuple(signal.tolist()))
    scenario = Scenario(test_signal_v=drive, duration_s=TIME_S, step_s=1 / RATE_HZ, sample_s=1 / RATE_HZ)
    return scenario, ff.laws.GainLaw.position_loop(loader.si_values)


def differences(loader, time_s, signal, keys):
    """Slopes by central differences: plain runs to either side of each parameter, side by side on the batch engine."""
    scenario, law = experiment(loader, time_s, signal)
    value = np.array([loader[key] for key in keys])
    steps = 1e-5 * np.diag(value)
    rows = loader.rows(keys, np.vstack([value + steps, value - steps]))
    runs = simulate_batch(loader, scenario, rows, law, keep=tuple(SLOPES.values()))
    sides = np.array([runs[name].values for name in SLOPES.values()])
    return (sides[:, : len(keys)] - sides[:, len(keys) :]).transpose(1, 0, 2) / (
        2 * 1e-5 * value[:, np.newaxis, np.newaxis]
    )


def median_seconds(job):
    times = []
    for _ in range(REPEATS):
        begun = time.perf_counter()
        job()
        times.append(time.perf_counter() - begun)
    return float(np.median(times))


def check_speed(drawn, record):
    """Times slopes and a fit; says if the fit takes too long."""
    loader, keys = drawn.loader, KEYS[:PROMISED_KEYS]
    names = ("test_signal", *SLOPES)
    seen = BenchRecord(record.name, record.experiment, record.time_s, {name: record.channels[name] for name in names})
    arguments = loader, record.time_s, record.channels["test_signal"], keys
    run = RecordRun(seen, loader, None)
    slopes, apart = run.at(loader.si_values, keys).slopes, differences(*arguments)
    largest = np.abs(slopes).max(axis=2, keepdims=True)
    agreement = float(np.max(np.abs(slopes - apart) / largest))
    assert agreement < 1e-3, f"slopes and differences are {agreement:.1e} apart"
    exact = median_seconds(lambda: run.at(loader.si_values, keys))
    central = median_seconds(lambda: differences(*arguments))
    longer = f"central differences {central / exact:.1f} times as long"
    print(f"\nfour slopes of {TIME_S:.0f} s: {exact:.3f} s on {cores()} cores, {longer}")
    print(f"they agree to {agreement:.0e} of the largest slope, which is what the differences are good for")
    seconds = median_seconds(lambda: identify(loader, [seen], keys))
    print(f"a fit of four parameters to {TIME_S:.0f} s, five starts: {seconds:.2f} s")
    return [f"a fit takes {seconds:.1f} s, promised are {PROMISED_SECONDS:.0f} s"] if seconds > PROMISED_SECONDS else []


def asked_for():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--machines", type=int, default=200, help="for each of the first sets of channels")
    parser.add_argument("--others", type=int, default=2, help="machines for each of the other sets")
    parser.add_argument("--loaders", type=int, default=6, help="loaders with other parameters")
    parser.add_argument("--measure", help="this set of channels alone: column_angle,load_pressure, or all")
    parser.add_argument("--seed", type=int, default=1974)
    return parser.parse_args()


def sets_asked_for(options):
    """How many machines by set of channels."""
    if options.measure:
        channels = CHANNELS if options.measure == "all" else tuple(options.measure.split(","))
        return {channels: options.machines}
    return dict.fromkeys(MAIN_SETS, options.machines) | dict.fromkeys(OTHER_SETS, options.others)


def main():
    options = asked_for()
    sets = sets_asked_for(options)
    drawn = machines(max(sets.values()), options.seed)
    begun, wrong = time.perf_counter(), []
    for channels, estimates in all_fitted(drawn, sets, options.seed).items():
        name = "all nine channels" if channels == CHANNELS else " + ".join(channels)
        wrong += check(name, estimates, drawn.truth_si[: len(estimates)]) if len(estimates) else []
    further, default = further_loaders(options.loaders, options.seed), {MAIN_SETS[-1]: 1}
    results = [
        all_fitted(loader_set, default, [options.seed, k])[MAIN_SETS[-1]] for k, loader_set in enumerate(further)
    ]
    if further:
        truth = np.concatenate([loader_set.truth_si for loader_set in further])
        wrong += check("further loaders, " + " + ".join(MAIN_SETS[-1]), np.concatenate(results), truth)
    fits, took = sum(sets.values()) + len(further), time.perf_counter() - begun
    print(f"\n{fits} fits in {took:.0f} s, the records' making included")
    wrong += check_speed(drawn, next(records(drawn, slice(0, 1), options.seed)))
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
