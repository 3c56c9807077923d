"""How well the motor, the link and the column of an electric loader are identified from records that the engine did not make.

Run ``python benchmarks/electric_identification.py``. Machines whose torque constant, inertias, link, friction and cogging lie up to
a quarter off their files (elevator-electric, sidestick-roll, desktop-yoke, and loaders of which every number is one of these times
1/2 to 2) are run under the file's law by SciPy on equations written by hand (``tests/electric_witness.py``), with 1 % of noise on
every sensor. Each is identified from its records alone, from the file's values on:

- smooth: a multisine of current for 4 s; K_t, J_m, k, c, J;
- rough: with dry and viscous friction and cogging, the same and a slow sweep of force for 6 s; those too.

Asserts that errors are within four standard errors, and that of a hundred parameters 90 to 99 lie inside their 95 % intervals.
``--machines`` smooth and ``--rough`` rough ones for each loader, ``--loaders`` further ones, a machine each.
By itself it takes half an hour on two cores, of which the records' integration is nine tenths.
"""

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests import electric_bench as bench

from forcefeel.bench.identification.fit import identify
from forcefeel.errors import InputError
from forcefeel.laws.law import Law
from forcefeel.loader.built_in import electric
from forcefeel.loader.parameters import required
from forcefeel.threads import cores

NAMES = ("elevator-electric", "sidestick-roll", "desktop-yoke")
MEASURED = ("column_angle", "drive_position", "load_cell_force", "motor_current")
PROMISED_DEVIATIONS, PROMISED_INSIDE = 4.0, (0.90, 0.99)
ENOUGH = 100
"""Parameters from which on their share inside the intervals is judged."""
DRAWN = ("motor", "winding", "current_loop", "transmission", "linkage", "column", "feel")
"""Parts of a further loader of which every number is drawn."""
KEPT = ("linkage.ratio",)
SHARE = {False: 0.06, True: 0.15}
"""R.m.s. of the multisine in the largest current: a rough motor is to slide through most of it, not to creep, for the witness's dry
friction is a steep slope that creeps by some 4 um in 4 s where a real one sticks."""
LIMITS = ("current_loop.current_limit", "current_loop.voltage_limit")


def further(name, random):
    """A loader of which every number is the built-in one's times 1/2 to 2, under which its law can be designed."""
    file = bench.file_of(electric(name))
    rows = [key for key in required("electric") if key.split(".")[0] in DRAWN and key not in KEPT]
    while True:
        drawn = {key: file[key] * 2 ** random.uniform(-1, 1) for key in (*rows, *LIMITS)}
        try:
            loader = file.replace(drawn, si=True)
            Law.of("robust", loader)
        except InputError:
            continue
        return loader


def fitted(job):
    """Value, truth, deviation and whether the interval holds the truth, of each parameter of one machine."""
    name, drawn, rough, seed = job
    random = np.random.default_rng([seed, *map(ord, name), drawn, rough])
    loader = further(name, random) if drawn else electric(name)
    file = bench.file_of(loader, rough)
    keys = (*bench.SMOOTH, *(bench.ROUGH if rough else ()))
    truth, law = bench.truth_of(file, keys, random), Law.of("robust", file)
    settle = bench.SETTLE_S if rough else 0.0
    sine = bench.multisine(SHARE[rough], file, 4.0, random)
    data = [bench.record(truth, law, "loader command_current", sine, 4.0, random=random, settle_s=settle)]
    if rough:
        data.append(bench.record(truth, law, "sweep", bench.slow(file), 6.0, random=random, settle_s=settle))
    identified = identify(file, [bench.measured(record, *MEASURED) for record in data], keys, law=law, starts=1)
    rows = [
        (
            estimate.unknown.symbol,
            estimate.value,
            truth[estimate.unknown.key],
            estimate.deviation,
            estimate.low <= truth[estimate.unknown.key] <= estimate.high,
        )
        for estimate in identified.estimates
    ]
    return job, rows


def asked_for():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--machines", type=int, default=12, help="smooth machines for each loader")
    parser.add_argument("--rough", type=int, default=4, help="rough machines for each loader")
    parser.add_argument("--loaders", type=int, default=12, help="further loaders")
    parser.add_argument("--seed", type=int, default=1974)
    return parser.parse_args()


def main():
    options = asked_for()
    jobs = [(name, 0, False, options.seed + k) for name in NAMES for k in range(options.machines)]
    jobs += [(NAMES[k % 3], 1, False, options.seed + k) for k in range(options.loaders)]
    jobs += [(name, 0, True, options.seed + k) for name in NAMES for k in range(options.rough)]
    wrong, inside = [], {False: [], True: []}
    with ProcessPoolExecutor(cores()) as pool:
        for (name, drawn, rough, seed), rows in pool.map(fitted, jobs):
            kind = f"{name}{', drawn' if drawn else ''}{', rough' if rough else ''}, {seed}"
            print(kind)
            for symbol, value, truth, deviation, holds in rows:
                apart = (value - truth) / deviation
                print(f"  {symbol:6}{100 * (value / truth - 1):+9.3f} % of the truth, {apart:+6.2f} standard errors")
                if not abs(apart) < PROMISED_DEVIATIONS:
                    wrong.append(f"{kind}: {symbol} is {apart:+.1f} standard errors off")
                inside[rough].append(holds)
    for rough, held in inside.items():
        share = np.mean(held) if held else np.nan
        print(
            f"{'rough' if rough else 'smooth'}: the 95 % intervals hold {100 * share:.1f} % of {len(held)} true values"
        )
        if len(held) >= ENOUGH and not PROMISED_INSIDE[0] <= share <= PROMISED_INSIDE[1]:
            wrong.append(f"the intervals hold the truth in {100 * share:.1f} %, promised are 90 to 99 %")
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
