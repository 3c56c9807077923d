"""Strikes: how fast end stops throw the columns of 48 settings back, at three rates, with and without the law's part for contact.

The hand and the count are those of ``forcefeel.envelope.strike``. The benchmark prints how many of the settings that strike a stop
it throws back, how many leave it more than a tenth faster than they came, and the largest ratio of both rates.

    python benchmarks/strikes.py [LOADER ...] [--law robust]
"""

import argparse
from itertools import product

import numpy as np
from contact import LOADERS, settings

from forcefeel.envelope.contact import Contact
from forcefeel.envelope.strike import strikes
from forcefeel.laws.law import Law
from forcefeel.loader.built_in import BUILT_IN

RATES = 1.0, 2.0, 3.0
STOPS = (
    Contact(True, 1e6, 0.02),
    Contact(True, 1e6, 0.1),
    Contact(True, 1e5, 0.1),
    Contact(True, 1e4, 0.1),
    Contact(True, 3e3, 0.02),
    Contact(True, 1e3, 0.02),
)
FASTER = 1.1


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("loaders", nargs="*", default=LOADERS)
    parser.add_argument("--law", default="robust")
    options = parser.parse_args()
    print("loader             stop, N/m  damping  rad/s   law      thrown back  faster     of   largest ratio")
    total = {}
    for name in options.loaders:
        loader = BUILT_IN[name]()
        feel = settings(loader, light=False)
        law = Law.of(options.law, loader, feel)
        laws = {"free": law.without_contact(), "contact": law}
        for stop, rate, (kind, each) in product(STOPS, RATES, laws.items()):
            struck = strikes(stop.on(loader), each, feel, rate, threads=None)
            ratio = struck.back / struck.came
            counts = np.array([struck.thrown_back.sum(), (ratio > FASTER).sum(), np.isfinite(ratio).sum()])
            total[kind] = total.get(kind, 0) + counts
            print(
                f"{name:18s} {stop.stiffness_n_per_m:9,.0f} {stop.damping_ratio:8.2f} {rate:6.0f}   {kind:8s}"
                f" {counts[0]:11d} {counts[1]:7d} {counts[2]:6d} {np.fmax.reduce(ratio):15.1f}"
            )
    for kind, (thrown, faster, of) in total.items():
        print(
            f"{kind}: of {of:,} strikes {thrown:,} throw the column back, {faster:,} return it more than a tenth faster"
        )


if __name__ == "__main__":
    main()
