"""What ``commission`` makes of machines that it has never seen, from a minute of bench, judged on the machines themselves.

Run ``python benchmarks/commission.py --machines 200``. Each machine has every plant parameter of ``elevator-2khz`` within its
tolerance at once (20 %, the valve's flow 30 %), dry friction of 0.5 to 3 lb at the grip with a breakaway force of 1 to 1.3 times
that, an encoder of 20 bits, a load cell with 0.1 lb of noise, and sensors of 500 Hz. The loader file knows of none of this but the
sensors. Records of 60 s come from an integrator that shares no line with the engine (``commission_machines.py``). The first two
steps of ``commission`` find the loader and the law; the law is then released on the machine itself over 96 settings, spaced in
proportion.

Prints each machine, then the mean share and that of the worst tenth. ``--electric`` takes ``elevator-electric`` in its place, whose
records are the engine's own: its witness takes half an hour a minute.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
import time
from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

sys.path.insert(0, str(Path(__file__).parent))

import commission_machines as witness

import forcefeel as ff
from forcefeel.bench.experiments import Experiment
from forcefeel.bench.records import BenchRecord
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.law_for import choose_law
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.simulated_bench import BenchTime, bench_signal, simulated_records
from forcefeel.envelope.draws import Draws
from forcefeel.envelope.plan import make_plan
from forcefeel.errors import InputError
from forcefeel.loader.feel_settings import own_feel

FRICTION_LB, BREAKAWAY = (0.5, 3.0), (1.0, 1.3)
LAG = {f"{sensor}.bandwidth": "500 Hz" for sensor in ("load_cell", "potentiometer", "column_sensor")}
INSTRUMENT = 0.003
PROMISED_MEAN, PROMISED_TENTH = 0.95, 0.90


def drawn(file, count, seed):
    """Machines of a loader file, which are what no file says."""
    cases = make_plan(file, ["robust"], {"stiffness": "20, 100 %"}, arms=(), draws=Draws(count, seed)).machines
    random = np.random.default_rng([seed, 7])
    bare = file.with_tolerances(dict.fromkeys(file.tolerances))
    for case in cases:
        dry = random.uniform(*FRICTION_LB)
        friction = {
            "column.coulomb_friction": f"{dry} lb",
            "column.static_friction": f"{dry * random.uniform(*BREAKAWAY)} lb",
        }
        yield bare.replace({key: float(file[key] * (1 + share)) for key, share in case.off.items()}).replace(friction)


def witnessed(file, machines, asked):
    """The records of hydraulic machines from the witness, all side by side."""
    signal = bench_signal(file, asked)
    many = witness.Machines.of(
        **{name: [one[key] * factor for one in machines] for name, (key, factor) in witness.OF_FILE.items()}
    )
    piston = [file[f"potentiometer.{name}"] for name in ("bandwidth", "noise", "resolution")]
    sensors = witness.Sensors(piston[0], piston[1] / witness.INCH, piston[2] / witness.INCH)
    exact = witness.run(many, signal.signal, asked.rate_hz, sensors, asked.seed)
    random = np.random.default_rng([asked.seed, 1])
    for k in range(len(machines)):
        channels = {"test_signal": signal.signal}
        for name, values in exact.items():
            channels[name] = shown(file, name, values[k], asked, random)
        yield [BenchRecord("bench", Experiment.read("servo-closed"), signal.time_s, channels)]


def shown(file, name, values, asked, random):
    """What a sensor of the file shows: behind its lag, by a spline of the samples in steps of a tenth, with noise and in steps."""
    normal = random.standard_normal(len(values))
    sensor = {"column_angle": "column_sensor", "piston_position": "potentiometer", "load_cell_force": "load_cell"}.get(
        name
    )
    if sensor is None:
        return values + INSTRUMENT * values.std() * normal
    bandwidth, noise, step = (file[f"{sensor}.{part}"] for part in ("bandwidth", "noise", "resolution"))
    fine = CubicSpline(np.arange(len(values)), values)(np.arange(10 * len(values) - 9) / 10)
    turn, lag, seen = bandwidth / asked.rate_hz / 10, fine[0], [fine[0]]
    for before, now in pairwise(fine):
        slope = (now - before) / turn
        lag = now - slope + (lag - before + slope) * np.exp(-turn)
        seen.append(lag)
    return np.round((np.array(seen)[::10] + noise * normal) / step) * step


def share_on(machine, name, law, plan):
    """Share of the settings that a law renders on a machine, and what fails first elsewhere."""
    found = ff.find_envelope(machine, {name: law}, plan.grid, changes={}, arms=())
    failing = {str(kind): share for kind, share in found.failure_shares(name).items() if share > 0}
    return found.even_shares(name).passes, failing


def commissioned(file, machine, data, plan):
    """Share on the machine, the law, and what the identification missed most, in a per cent."""
    step = identify_loader(file, data, plan)
    if step.loader is None:
        return 0.0, "", step.outcome.verdict
    chosen, scored, _ = choose_law(step.loader, plan)
    if not chosen.name:
        return 0.0, "", chosen.verdict
    feel = np.vstack([own_feel(step.loader), scored.plan.settings.feel(scored.plan.loader)])
    law = ff.Law.of(chosen.name, step.loader, feel)
    share, failing = share_on(machine, chosen.name, law, plan)
    exact, _ = share_on(machine, chosen.name, ff.Law.of(chosen.name, machine, feel), plan)
    nominal = next(one.over.shares.passes for one in scored.scores if one.name == chosen.name)
    worst = sorted(
        ((abs(one.value / machine[one.key] - 1), one.key) for one in step.outcome.parameters if alone(one.key)),
        reverse=True,
    )[0]
    what = ", ".join(f"{kind} {share:.0%}" for kind, share in failing.items()) or "nothing fails"
    told = f"as identified {nominal:.1%}, with the machine known exactly {exact:.1%}; {worst[1]} off {worst[0]:.2%}; {what}"
    return share, chosen.name, f"{told}{'' if step.outcome.good else '; wanting: ' + '; '.join(step.outcome.wanting)}"


def alone(key):
    """Whether the records determine a parameter by itself, and not in a product with one that is held."""
    return key in (
        "amplifier.admittance",
        "valve.natural_frequency",
        "linkage.stiffness",
        "column.inertia",
        "motor.torque_constant",
        "motor.inertia",
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--machines", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=60.0, help="of bench")
    parser.add_argument("--seed", type=int, default=2026)
    parser.add_argument("--electric", action="store_true")
    asked = parser.parse_args()
    time_ = BenchTime(asked.seconds, seed=asked.seed)
    file = (ff.loader.electric("elevator-electric") if asked.electric else ff.digital_elevator()).replace(LAG)
    machines = list(drawn(file, asked.machines, asked.seed))
    begun = time.perf_counter()
    records = (
        (simulated_records(file, machine, time_) for machine in machines)
        if asked.electric
        else witnessed(file, machines, time_)
    )
    plan, shares, laws = CommissionPlan(), [], Counter()
    for k, (machine, data) in enumerate(zip(machines, records, strict=True)):
        try:
            share, name, told = commissioned(file, machine, data, plan)
        except InputError as error:
            share, name, told = 0.0, "", str(error)
        shares.append(share)
        laws[name or "none"] += 1
        friction = machine["column.coulomb_friction"] / witness.LBF
        print(
            f"machine {k + 1}, {friction:.2f} lb of friction: {share:.1%} with {name or 'no law'}; {told}", flush=True
        )
    worst = np.sort(shares)[: max(1, round(0.1 * len(shares)))]
    print(
        f"{len(shares)} machines in {time.perf_counter() - begun:.0f} s: mean share {np.mean(shares):.1%}, the worst tenth "
        f"{worst.mean():.1%} (at best {worst.max():.1%}); laws: {', '.join(f'{name} {count}' for name, count in laws.items())}"
    )
    if np.mean(shares) < PROMISED_MEAN or worst.max() < PROMISED_TENTH:
        sys.exit(f"promised are {PROMISED_MEAN:.0%} and {PROMISED_TENTH:.0%}")


if __name__ == "__main__":
    main()
