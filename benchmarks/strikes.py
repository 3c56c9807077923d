"""Strikes: how fast an end stop throws a column back, which a hand pushes into it and lets go there.

A constant force, found by bisection, takes the programmed feel to a stop at 5 deg at 1, 2 or 3 rad/s, and is gone as it gets there:

    I delta'' + B delta' + G delta = R_p F,   delta <= 5 deg

A stop takes the momentum of the whole column. Where the feel has less inertia, its law may give the column more speed than it came
with. A setting is thrown back where the column leaves more than a tenth faster than it came, and faster than its feel would alone.
The benchmark counts those of 48, with and without the law's part for contact, and prints the largest ratio of both rates.

    python benchmarks/strikes.py [LOADER ...] [--law robust]
"""

import argparse
from itertools import product

import numpy as np
from contact import LOADERS, settings
from let_go import STEP_S, ideal
from numpy.typing import NDArray

from forcefeel.envelope.contact import STOP_RAD, Contact
from forcefeel.laws.law import Law
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.simulation import Scenario
from forcefeel.simulation.engine import batch_outputs
from forcefeel.simulation.inputs import Recorded

RATES = 1.0, 2.0, 3.0
STOPS = Contact(True, 1e6, 0.02), Contact(True, 1e6, 0.1), Contact(True, 1e5, 0.1), Contact(True, 1e4, 0.1)
MOST_N, BEGINS_S, LASTS_S = 600.0, 0.05, 1.5
THROWN = 1.1
TIME = np.arange(0.0, LASTS_S, STEP_S)

Rows = NDArray[np.float64]


def rates(angle: Rows, time: Rows) -> tuple[float, float]:
    """Largest rate on the way to the stop, and back."""
    rate, there = np.gradient(angle, time), angle >= STOP_RAD
    if not there.any():
        return 0.0, 0.0
    struck = np.argmax(there)
    return rate[: struck + 1].max(), -rate[struck:].min()


def strike(feel: Rows, arm: float, to: float) -> tuple[Rows, float] | None:
    """Force over time that takes the feel to the stop at that rate, and the feel's rate back; none if it is more than a hand's."""
    low, high = 0.0, MOST_N
    for _ in range(16):
        force = (low + high) / 2
        reached = rates(ideal(np.where(TIME > BEGINS_S, force * arm, 0.0), feel), TIME)[0]
        low, high = (force, high) if reached < to else (low, force)
    if high == MOST_N:
        return None
    there = np.argmax(ideal(np.where(TIME > BEGINS_S, high * arm, 0.0), feel) >= STOP_RAD)
    pushed = np.where((TIME > BEGINS_S) & (np.arange(TIME.size) < there), high, 0.0)
    return pushed, rates(ideal(pushed * arm, feel), TIME)[1]


def thrown_back(loader: Loader, law: Law, feel: Rows, struck: tuple[Rows, float]) -> tuple[bool, float]:
    """Whether the column is thrown back, and its rate after the strike, of that before."""
    scenario = Scenario(Recorded(TIME, struck[0]), duration_s=TIME[-1])
    run = batch_outputs(
        loader, scenario, loader.rows(FEEL_SETTING, feel[None]), law, keep=["column_angle_rad"], first_run=None
    )
    before, after = rates(run["column_angle_rad"][0], run["time_s"])
    return after > THROWN * max(before, struck[1]), after / before if before else 0.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("loaders", nargs="*", default=LOADERS)
    parser.add_argument("--law", default="robust")
    options = parser.parse_args()
    print("loader             stop, N/m  damping  rad/s   law      thrown back   largest ratio")
    for name in options.loaders:
        loader = BUILT_IN[name]()
        feels = settings(loader, light=False)
        law = Law.of(options.law, loader, feels)
        laws = ("free", law.without_contact()), ("contact", law)
        struck = {rate: [strike(feel, loader["column.grip_arm"], rate) for feel in feels] for rate in RATES}
        for stop in STOPS:
            there = stop.on(loader)
            for rate, (kind, one) in product(RATES, laws):
                found = [
                    thrown_back(there, one.some(np.array([i])), feel, how)
                    for i, (feel, how) in enumerate(zip(feels, struck[rate], strict=True))
                    if how
                ]
                print(
                    f"{name:18s} {stop.stiffness_n_per_m:9,.0f} {stop.damping_ratio:8.2f} {rate:6.0f}   {kind:8s}"
                    f" {sum(thrown for thrown, _ in found):4d} of {len(found)} {max(ratio for _, ratio in found):12.1f}"
                )


if __name__ == "__main__":
    main()
