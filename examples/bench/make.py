"""The synthetic bench: a loader that is not what its file says, measured with sensors as they are.

No bench data of a control loader are public. This makes some, so that an identification can be tried where the truth is known: the
nonlinear loader of ``truth.toml`` with friction and a current limit, seen at 500 Hz to 2 kHz by sensors with noise and steps.
``bench_machine.py`` integrates it: no line of the engine that ``identify`` fits has a part in the records.
Run it in any folder to make the files anew; they come out the same.
"""

from pathlib import Path

import bench_machine
import numpy as np
import pyarrow as pa
from pyarrow import parquet
from scipy.io import savemat

import forcefeel as ff
from forcefeel.simulation.inputs import Multisine

HERE = Path(__file__).parent

FILE = {"amplifier.current_limit": "15 mA", "column.coulomb_friction": "2 lb", "column.static_friction": "2 lb"}
"""What the file adds to the report's loader; friction as its designers guessed it."""

TRUTH = {
    "linkage.stiffness": (5230.0, "lb/in", "link_stiffness"),
    "linkage.damping": (19.4, "lb s/in", "link_damping"),
    "column.inertia": (40.6, "lb in s^2", "inertia"),
    "valve.current_gain": (4.87, "in^3/(s mA)", "current_gain"),
    "column.coulomb_friction": (1.3, "lb", "coulomb_friction"),
    "column.static_friction": (1.5, "lb", "static_friction"),
}
"""What the machine is: value and unit, and what ``bench_machine`` calls it."""

MACHINE = bench_machine.Machine(current_limit=15.0, **{name: value for value, _, name in TRUTH.values()})

# unit in which the sensor shows it and that in the unit of `bench_machine`, noise r.m.s. and step in the sensor's unit
SENSORS = {
    "column angle": ("deg", np.pi / 180, 0.002, 0.001),
    "piston position": ("in", 1.0, 0.0003, 0.0002),
    "load pressure": ("lb/in^2", 1.0, 0.3, 0.2),
    "pilot force": ("lb", 1.0, 0.02, 0.01),
}
"""Sensors of a usual kind, no one product."""


def loader(changes):
    """The report's loader with changes, free of its assumed tolerances."""
    report = ff.elevator()
    return report.with_tolerances(dict.fromkeys(report.tolerances)).replace(changes, si=True)


def seen(signals, names, rate_hz, seed):
    """What the sensors show of signals: time in s, and a column for each name with its unit."""
    random = np.random.default_rng(seed)
    samples = len(signals[names[0].replace(" ", "_")])
    columns = {"time (s)": np.round(np.arange(samples) / rate_hz, 6)}
    for name in names:
        unit, size, noise, step = SENSORS[name]
        reading = signals[name.replace(" ", "_")] / size
        reading = reading + noise * random.standard_normal(samples)
        columns[f"{name} ({unit})"] = np.round(np.round(reading / step) * step, 6) + 0.0
    return columns


def run(loop, rate_hz, **how):
    """The machine's channels over time."""
    return {channel: values[0] for channel, values in bench_machine.run(MACHINE, loop, rate_hz, **how).items()}


def multisine(volts, duration_s, rate_hz, period_s, seed):
    """A test signal of 0.3 to 40 Hz that comes softly: what the generator sets, in V."""
    lines = np.unique(np.rint(np.geomspace(0.3, 40.0, 50) * period_s)) / period_s
    wave = Multisine(volts, tuple(lines.tolist()), period_s, seed=seed).sample(duration_s, 1 / rate_hz)
    time_s = np.arange(len(wave.start) + 1) / rate_hz
    return np.round(np.append(wave.start, wave.end[-1]) * np.clip(time_s, 0, 1), 4)


def under_test_signal(loop, volts, names, rate_hz, seed, duration_s=60.0):
    """A record under a multisine."""
    signal = multisine(volts, duration_s, rate_hz, 10.0, seed)
    columns = seen(run(loop, rate_hz, test_signal=signal), names, rate_hz, seed)
    return {"time (s)": columns.pop("time (s)"), "test signal (V)": signal, **columns}


def csv(path, about, columns):
    """A CSV file whose first lines say what it is."""
    lines = [f"# {line}" for line in about] + [",".join(columns)]
    lines += [",".join(f"{value:.10g}" for value in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def response(loop, channel, volts, out):
    """What an analyser makes of a fast record."""
    fast = under_test_signal(loop, volts, (channel,), 2000.0, 2)
    record = out / f"{loop}-record.csv"
    csv(record, [f"experiment: {loop}"], fast)
    estimate = ff.bench.estimate_response(ff.bench.read_bench_record(record), channel.replace(" ", "_"))
    record.unlink()  # of the analyser only the response is left
    unit, size, _, _ = SENSORS[channel]
    gain = np.abs(estimate.value) / (size * bench_machine.SI[channel.replace(" ", "_")])
    about = [f"experiment: {loop}", "from: test_signal (V)", f"to: {channel.replace(' ', '_')} ({unit})"]
    columns = {
        "frequency (Hz)": estimate.frequency_hz,
        "gain (dB)": np.round(20 * np.log10(gain), 3),
        "phase (deg)": np.round(np.degrees(np.unwrap(np.angle(estimate.value))), 2),
        "coherence": np.round(estimate.coherence, 6),
        "deviation": np.round(estimate.deviation, 6),
    }
    csv(out / f"{loop}.csv", about, columns)


def release(held_s, angle, duration_s, rate_hz):
    """The grip held at an angle in rad on the closed servo, and let go."""
    start = bench_machine.held(MACHINE, "servo-closed", angle)
    free = run("servo-closed", rate_hz, force=np.zeros(round((duration_s - held_s) * rate_hz) + 1), start=start)
    before = round(held_s * rate_hz)
    signals = {channel: np.append(np.full(before, values[0]), values) for channel, values in free.items()}
    return seen(signals, ("column angle", "piston position"), rate_hz, 3)


def sweep(rate_hz):
    """Force at the grip up and down, slowly, on the whole loader."""
    time_s = np.arange(round(22.0 * rate_hz) + 1) / rate_hz
    force = np.interp(time_s, [1.0, 6.0, 16.0, 21.0], [0.0, 20.0, -20.0, 0.0])
    return seen(
        {**run("loader", rate_hz, force=force), "pilot_force": force}, ("pilot force", "column angle"), rate_hz, 4
    )


def main(out=HERE):
    start, truth = loader(FILE), loader({**FILE, **{key: f"{value} {unit}" for key, (value, unit, _) in TRUTH.items()}})
    (out / "loader.toml").write_text(start.to_toml(), encoding="utf-8")
    (out / "truth.toml").write_text(truth.to_toml(), encoding="utf-8")

    everything = ("column angle", "piston position", "load pressure")
    table = under_test_signal("servo-closed", 4.0, everything, 500.0, 1)
    arrays = {name: values.astype(np.float32) if name != "time (s)" else values for name, values in table.items()}
    parquet.write_table(
        pa.table(arrays).replace_schema_metadata({"experiment": "servo-closed"}),
        out / "multisine.parquet",
        compression="zstd",
    )
    response("servo-closed", "column angle", 4.0, out)
    response("servo-open", "load pressure", 4.0, out)
    names = {
        "time (s)": "time_s",
        "column angle (deg)": "column_angle_deg",
        "piston position (in)": "piston_position_in",
    }
    columns = {names[name]: values for name, values in release(0.25, 0.06, 3.0, 1000.0).items()}
    savemat(out / "release.mat", {"experiment": "servo-closed release", **columns}, do_compression=True)
    csv(out / "sweep.csv", ["experiment: sweep"], sweep(500.0))


if __name__ == "__main__":
    main()
