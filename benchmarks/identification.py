"""How well and how fast a loader is identified from records of 60 s.

Run ``python benchmarks/identification.py [repetitions]``, 200 if not said. Draws as many machines, each with its own k, c, J, C_i
within 20 % of the file's and with friction, runs them all through one multisine on the batch engine, adds noise of 1 % to every
sensor, and identifies each from its record alone, from the file's values on. Then asserts what is promised: errors of k, c, J, C_i
below 2 %, and the truth inside the 95 % interval in 90 to 99 of 100 repetitions. Last it times one fit, and its exact slopes beside
central differences of plain runs on the batch engine, the answers asserted first. Ends with an error if anything does not hold.
"""

import sys
import time

import numpy as np

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord
from forcefeel.identification.fit import identify
from forcefeel.identification.record_run import RecordRun
from forcefeel.inputs import Multisine, Schedule
from forcefeel.simulation import Scenario, simulate_batch
from forcefeel.threads import cores

KEYS = ("linkage.stiffness", "linkage.damping", "column.inertia", "valve.current_gain")
SPREAD, NOISE, TIME_S, RATE_HZ, PERIOD_S = 0.2, 0.01, 60.0, 500.0, 10.0
CHANNELS = {
    "column_angle": "column_angle_rad",
    "piston_position": "piston_position_m",
    "load_pressure": "load_pressure_pa",
}
PROMISED_ERROR, PROMISED_INSIDE = 0.02, (0.90, 0.99)
PROMISED_SECONDS = 10.0
REPEATS = 5


def bench():
    """The loader as its file has it, and what the bench applies: a multisine of 0.2 to 40 Hz that comes and goes softly."""
    loader = ff.elevator().replace(
        {"column.coulomb_friction": "1.5 lb", "column.static_friction": "2 lb", "amplifier.current_limit": "15 mA"}
    )
    loader = loader.with_tolerances(dict.fromkeys(loader.tolerances))
    lines = np.unique(np.rint(np.geomspace(0.2, 40.0, 60) * PERIOD_S)) / PERIOD_S
    time_s = np.arange(round(TIME_S * RATE_HZ) + 1) / RATE_HZ
    wave = Multisine(2.0, tuple(lines.tolist()), PERIOD_S, seed=1).sample(TIME_S, 1 / RATE_HZ)
    signal = np.append(wave.start, wave.end[-1]) * np.clip(time_s, 0, 1)
    return loader, time_s, signal


def measured(loader, time_s, signal, repetitions):
    """Machines, and what their sensors show: values of KEYS (repetitions, 4) and channels (repetitions, samples)."""
    random = np.random.default_rng(1974)
    truth = np.array([loader[key] for key in KEYS]) * (1 + SPREAD * random.uniform(-1, 1, (repetitions, len(KEYS))))
    values = loader.rows(KEYS, truth)
    scenario, law = experiment(loader, time_s, signal)
    runs = simulate_batch(loader, scenario, values, law, keep=tuple(CHANNELS.values()))
    shown = {}
    for channel, name in CHANNELS.items():
        exact = runs[name].values
        shown[channel] = exact + NOISE * exact.std(axis=1, keepdims=True) * random.standard_normal(exact.shape)
    return truth, shown


def experiment(loader, time_s, signal):
    """What the batch engine is asked for: the scenario and the position loop."""
    drive = Schedule(tuple(time_s.tolist()), tuple(signal.tolist()))
    scenario = Scenario(test_signal_v=drive, duration_s=TIME_S, step_s=0.5 / RATE_HZ, sample_s=1 / RATE_HZ)
    return scenario, ff.Compensator.position_loop(loader.values)


def records(time_s, signal, shown):
    for k in range(len(shown["column_angle"])):
        channels = {"test_signal": signal, **{name: values[k] for name, values in shown.items()}}
        yield BenchRecord(f"machine {k}", Experiment.read("servo-closed"), time_s, channels)


def check_intervals(found, truth):
    """Prints errors and coverage, and says what does not hold."""
    value = np.array([[it.value for it in one.estimates] for one in found])
    low = np.array([[it.low for it in one.estimates] for one in found])
    high = np.array([[it.high for it in one.estimates] for one in found])
    error = np.abs(value / truth - 1)
    inside = ((low <= truth) & (truth <= high)).mean(axis=0)
    print(f"{'':22}{'median error':>14}{'largest error':>15}{'95 % interval holds it':>24}")
    for j, it in enumerate(found[0].estimates):
        print(
            f"{it.unknown.key:22}{100 * np.median(error[:, j]):12.3f} %{100 * error[:, j].max():13.3f} %{100 * inside[j]:22.1f} %"
        )
    wrong = []
    if error.max() >= PROMISED_ERROR:
        wrong.append(f"an estimate is {100 * error.max():.2f} % off, promised are {100 * PROMISED_ERROR:.0f} %")
    if not np.all((PROMISED_INSIDE[0] <= inside) & (inside <= PROMISED_INSIDE[1])):
        wrong.append(f"the intervals hold the truth in {100 * inside} %, promised are 90 to 99 %")
    return wrong


def differences(loader, time_s, signal):
    """Slopes by central differences: plain runs to either side of each parameter, side by side on the batch engine."""
    scenario, law = experiment(loader, time_s, signal)
    value = np.array([loader[key] for key in KEYS])
    steps = 1e-5 * np.diag(value)
    runs = simulate_batch(
        loader,
        scenario,
        loader.rows(KEYS, np.vstack([value + steps, value - steps])),
        law,
        keep=tuple(CHANNELS.values()),
    )
    sides = np.array([runs[name].values for name in CHANNELS.values()])
    return (sides[:, :4] - sides[:, 4:]).transpose(1, 0, 2) / (2 * 1e-5 * value[:, np.newaxis, np.newaxis])


def median_seconds(job):
    times = []
    for _ in range(REPEATS):
        begun = time.perf_counter()
        job()
        times.append(time.perf_counter() - begun)
    return float(np.median(times))


def main():
    repetitions = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    loader, time_s, signal = bench()
    begun = time.perf_counter()
    truth, shown = measured(loader, time_s, signal, repetitions)
    made = time.perf_counter() - begun
    data = list(records(time_s, signal, shown))
    begun = time.perf_counter()
    found = [identify(loader, [record], KEYS, starts=1) for record in data]
    fitted = time.perf_counter() - begun
    print(
        f"{repetitions} machines of {TIME_S:.0f} s at {RATE_HZ:.0f} Hz: run in {made:.1f} s, identified in {fitted:.0f} s"
    )
    wrong = check_intervals(found, truth)

    run = RecordRun(data[0], loader, None)
    slopes = run.at(loader.values, KEYS).slopes
    apart = differences(loader, time_s, signal)
    largest = np.abs(slopes).max(axis=2, keepdims=True)
    agreement = float(np.max(np.abs(slopes - apart) / largest))
    assert agreement < 1e-3, f"slopes and differences are {agreement:.1e} apart"
    exact = median_seconds(lambda: run.at(loader.values, KEYS))
    central = median_seconds(lambda: differences(loader, time_s, signal))
    print(
        f"four slopes of {TIME_S:.0f} s: {exact:.3f} s on {cores()} cores, central differences {central / exact:.1f} times as long"
    )
    print(f"they agree to {agreement:.0e} of the largest slope, which is what the differences are good for")
    seconds = median_seconds(lambda: identify(loader, data[:1], KEYS))
    print(f"a fit of four parameters to {TIME_S:.0f} s, five starts: {seconds:.2f} s")
    if seconds > PROMISED_SECONDS:
        wrong.append(f"a fit takes {seconds:.1f} s, promised are {PROMISED_SECONDS:.0f} s")
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
