"""The synthetic bench: a loader that is not what its file says, measured with sensors as they are.

No bench data of a control loader are public. This makes some, so that an identification can be tried where the truth is known: the
nonlinear loader of ``truth.toml`` with friction and a current limit, seen at 500 Hz to 2 kHz by sensors with noise and steps.
Run it in any folder to make the files anew; they come out the same.
"""

from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet
from scipy.io import savemat

import forcefeel as ff
from forcefeel.inputs import Multisine, Recorded, Release, Schedule
from forcefeel.units import factor

HERE = Path(__file__).parent

FILE = {"amplifier.current_limit": "15 mA", "column.coulomb_friction": "2 lb", "column.static_friction": "2 lb"}
"""What the file adds to the report's loader; friction as its designers guessed it."""

TRUTH = {
    "linkage.stiffness": "5230 lb/in",
    "linkage.damping": "19.4 lb s/in",
    "column.inertia": "40.6 lb in s^2",
    "valve.current_gain": "4.87 in^3/(s mA)",
    "column.coulomb_friction": "1.3 lb",
    "column.static_friction": "1.5 lb",
}
"""What the machine is."""

# unit in which the sensor shows it, noise r.m.s. and step in that unit, name and SI unit of the simulated signal
SENSORS = {
    "column angle": ("deg", 0.002, 0.001, "column_angle_rad", "rad"),
    "piston position": ("in", 0.0003, 0.0002, "piston_position_m", "m"),
    "load pressure": ("lb/in^2", 0.3, 0.2, "load_pressure_pa", "Pa"),
    "pilot force": ("lb", 0.02, 0.01, "pilot_force_n", "N"),
}
"""Sensors of a usual kind, no one product."""


def machine(changes):
    """The report's loader with changes, free of its assumed tolerances."""
    loader = ff.elevator()
    return loader.with_tolerances(dict.fromkeys(loader.tolerances)).replace(changes)


def run(loader, law, names, rate_hz, seed, **scenario):
    """Runs the machine and gives what its sensors show: time in s, and a column for each name with its unit."""
    history = ff.simulate(loader, ff.Scenario(step_s=5e-4, sample_s=1 / rate_hz, **scenario), law).history
    random = np.random.default_rng(seed)
    columns = {"time (s)": np.round(history["time_s"].values, 6)}
    for name in names:
        unit, noise, step, signal, si_unit = SENSORS[name]
        shown = history[signal].values / factor(unit, si_unit)
        shown = shown + noise * random.standard_normal(len(shown))
        columns[f"{name} ({unit})"] = np.round(np.round(shown / step) * step, 6) + 0.0
    return columns


def multisine(volts, duration_s, rate_hz, period_s, seed):
    """A test signal of 0.3 to 40 Hz that comes softly: what the generator sets, in V."""
    lines = np.unique(np.rint(np.geomspace(0.3, 40.0, 50) * period_s)) / period_s
    wave = Multisine(volts, tuple(lines.tolist()), period_s, seed=seed).sample(duration_s, 1 / rate_hz)
    time_s = np.arange(len(wave.start) + 1) / rate_hz
    return np.round(np.append(wave.start, wave.end[-1]) * np.clip(time_s, 0, 1), 4)


def under_test_signal(loader, law, volts, names, rate_hz, seed, duration_s=60.0):
    """A record under a multisine."""
    signal = multisine(volts, duration_s, rate_hz, 10.0, seed)
    times = np.arange(len(signal)) / rate_hz
    schedule = Schedule(tuple(times.tolist()), tuple(signal.tolist()))
    columns = run(loader, law, names, rate_hz, seed, test_signal_v=schedule, duration_s=duration_s)
    return {"time (s)": columns.pop("time (s)"), "test signal (V)": signal, **columns}


def csv(path, about, columns):
    """A CSV file whose first lines say what it is."""
    lines = [f"# {line}" for line in about] + [",".join(columns)]
    lines += [",".join(f"{value:.10g}" for value in row) for row in zip(*columns.values(), strict=True)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(out=HERE):
    start, truth = machine(FILE), machine({**FILE, **TRUTH})
    closed, opened = ff.Compensator.position_loop(truth.values), ff.Compensator.none(truth.values)
    (out / "loader.toml").write_text(start.to_toml(), encoding="utf-8")
    (out / "truth.toml").write_text(truth.to_toml(), encoding="utf-8")

    everything = ("column angle", "piston position", "load pressure")
    table = under_test_signal(truth, closed, 4.0, everything, 500.0, 1)
    arrays = {name: values.astype(np.float32) if name != "time (s)" else values for name, values in table.items()}
    parquet.write_table(
        pa.table(arrays).replace_schema_metadata({"experiment": "servo-closed"}),
        out / "multisine.parquet",
        compression="zstd",
    )

    for name, law, volts, channel in (
        ("servo-closed", closed, 4.0, "column angle"),
        ("servo-open", opened, 4.0, "load pressure"),
    ):
        fast = under_test_signal(truth, law, volts, (channel,), 2000.0, 2)
        record = out / f"{name}-record.csv"
        csv(record, [f"experiment: {name}"], fast)
        found = ff.estimate_response(ff.read_bench_record(record), channel.replace(" ", "_"))
        record.unlink()  # of the analyser only the response is left
        unit = SENSORS[channel][0]
        gain = np.abs(found.value) / factor(unit, SENSORS[channel][4])
        about = [f"experiment: {name}", "from: test_signal (V)", f"to: {channel.replace(' ', '_')} ({unit})"]
        columns = {
            "frequency (Hz)": found.frequency_hz,
            "gain (dB)": np.round(20 * np.log10(gain), 3),
            "phase (deg)": np.round(np.degrees(np.unwrap(np.angle(found.value))), 2),
            "coherence": np.round(found.coherence, 6),
            "deviation": np.round(found.deviation, 6),
        }
        csv(out / f"{name}.csv", about, columns)

    held_s = 0.25
    release = run(
        truth, closed, ("column angle", "piston position"), 1000.0, 3, force=Release(0.06, held_s), duration_s=3.0
    )
    names = {
        "time (s)": "time_s",
        "column angle (deg)": "column_angle_deg",
        "piston position (in)": "piston_position_in",
    }
    savemat(
        out / "release.mat",
        {"experiment": "servo-closed release", **{names[k]: v for k, v in release.items()}},
        do_compression=True,
    )

    times, force = (
        np.array([0.0, 1.0, 6.0, 16.0, 21.0, 22.0]),
        np.array([0.0, 0.0, 20.0, -20.0, 0.0, 0.0]) * factor("lb", "N"),
    )
    sweep = run(truth, None, ("pilot force", "column angle"), 500.0, 4, force=Recorded(times, force), duration_s=22.0)
    csv(out / "sweep.csv", ["experiment: sweep"], sweep)


if __name__ == "__main__":
    main()
