"""A steady hand: columns with dry friction that go on moving under a constant force.

A hand pushes with a constant force for 16 s, alone or with an arm's mass, damping and stiffness at the grip, and without end stops.
Under a passive feel the column comes to rest. The benchmark counts the settings of ``contact.py`` whose column moves by more than
0.05, 0.2 and 1 deg, from peak to peak, in the last 2 s: with dry friction that the law knows, and without friction. Noise
moves the lightest feels, and some of them swing in an arm, with friction or without. A column that goes away is ``inf``.

    python benchmarks/steady_hand.py [LOADER ...] [--law robust] [--friction "1 lb"] [--light]
"""

import argparse
from itertools import product

import numpy as np
from contact import FRICTION, LOADERS, settings

from forcefeel.envelope.contact import STOPS
from forcefeel.laws.law import Law
from forcefeel.loader.arms import ARM_ROWS, ARMS, Arm
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.simulation import Scenario
from forcefeel.simulation.engine import batch_outputs
from forcefeel.simulation.inputs import Step

FORCES_N = 4.0, 8.0, 20.0
"""0.9, 1.8 and 4.5 lb: less than usual friction, about as much, and more."""
HANDS = None, Arm.LOOSE, Arm.FIRM
DURATION_S, LAST_S = 16.0, 2.0
LIMITS_DEG = 0.05, 0.2, 1.0


def motions_deg(loader: Loader, law: Law, feel: np.ndarray, force_n: float, arm: Arm | None) -> np.ndarray:
    """How far the column of each setting still moves in the end."""
    there = loader.replace(dict.fromkeys(STOPS))
    if arm is not None:
        there = there.replace(dict(zip(ARM_ROWS, ARMS[arm], strict=True)), si=True)
    scenario = Scenario(Step(force_n), duration_s=DURATION_S)
    rows = there.rows(FEEL_SETTING, feel)
    run = batch_outputs(there, scenario, rows, law, keep=["column_angle_rad"], first_run=None)
    motions = np.degrees(np.ptp(run["column_angle_rad"][:, run["time_s"] > DURATION_S - LAST_S], axis=1))
    return np.nan_to_num(motions, nan=np.inf)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("loaders", nargs="*", default=LOADERS)
    parser.add_argument("--law", default="robust")
    parser.add_argument("--friction", default="1 lb", help="dry friction at the grip, known to the law")
    parser.add_argument("--light", action="store_true", help="light feels: 1 to 5 % of the largest stiffness")
    given = parser.parse_args()
    limits = ", ".join(f"{limit:g}" for limit in LIMITS_DEG)
    print(f"loader             force, N  arm    friction  moves by {limits} deg of   largest, deg")
    for name in given.loaders:
        loader = BUILT_IN[name]()
        feel = settings(loader, light=given.light)
        rubs = loader.replace(dict.fromkeys(FRICTION, given.friction))
        columns = [
            (what, one, Law.of(given.law, one, feel)) for what, one in (("none", loader), (given.friction, rubs))
        ]
        for force, arm, (what, one, law) in product(FORCES_N, HANDS, columns):
            motions = motions_deg(one, law, feel, force, arm)
            counts = " ".join(f"{np.sum(motions > limit):5d}" for limit in LIMITS_DEG)
            print(
                f"{name:18s} {force:8g}  {arm or 'none':6s} {what:8s}  {counts} {len(feel):12d} {np.max(motions):12.2f}"
            )


if __name__ == "__main__":
    main()
