"""Contact: settings of a loader against 30 clamps and 15 end stops, with and without the law's part for contact.

A clamp holds the grip and is tapped with 3 lb; a stop at 5 deg is pushed into with 1.8 lb. A setting swings on if the force there
varies by 2 lb or more over the last second (clamp: half a second), and by no less than nine tenths of that in the one before.
The settings are 4 stiffnesses x 4 frequencies x 3 damping ratios, from a twenty-fifth of the loader's own stiffness on.

    python benchmarks/contact.py [LOADER ...] [--law robust]
"""

import argparse
from collections.abc import Iterator
from itertools import product

import numpy as np

import forcefeel as ff
from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING, Loader
from forcefeel.simulation import simulate_batch
from forcefeel.simulation.inputs import Pulse

LOADERS = (
    "elevator-2khz",
    "elevator-electric",
    "aileron-wheel",
    "rudder-pedals",
    "sidestick-pitch",
    "sidestick-roll",
    "desktop-yoke",
)
STIFFNESSES = (1e3, 1e4, 3e4, 1e5, 1e6)
DAMPING_RATIOS = (0.02, 0.1, 0.5)
MASSES = (0.0, 3.0)
QUIET_N = 2 * 4.4482
GONE = 0.9
STOP_RAD = np.radians(5.0)


def settings(loader: Loader) -> np.ndarray:
    """I, B, G in SI units, a row each."""
    rows = []
    for share, frequency, ratio in product((0.04, 0.1, 0.3, 1.0), (0.8, 1.5, 2.2, 3.0), (0.1, 0.3, 0.7)):
        stiffness, omega = share * loader["feel.stiffness"], 2 * np.pi * frequency
        inertia = stiffness / omega**2
        rows.append((inertia, 2 * ratio * omega * inertia, stiffness))
    return np.array(rows)


def contacts(loader: Loader, *, stop: bool) -> Iterator[tuple[float, Loader]]:
    """Stiffness at the grip, and the loader in that contact."""
    arm, own = loader["column.grip_arm"], loader["column.inertia"] / loader["column.grip_arm"] ** 2
    for mass, k, ratio in product(MASSES[:1] if stop else MASSES, STIFFNESSES, DAMPING_RATIOS):
        damping = 2 * ratio * np.sqrt(k * (own + mass))
        if stop:
            at_stop = {
                "column.stop_high": STOP_RAD,
                "column.stop_stiffness": k * arm**2,
                "column.stop_damping": damping * arm**2,
            }
            yield k, loader.replace(at_stop, si=True)
        else:
            rows = {"pilot.arm_mass": mass, "pilot.arm_stiffness": k, "pilot.arm_damping": damping}
            yield k, loader.replace(rows, si=True)


def contact_forces(
    loader: Loader, law: Law, feel: np.ndarray, stiffness: float, *, stop: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Whether each setting swings on, and its largest force of the contact in N."""
    force = ff.Step("1.8 lb") if stop else Pulse("3 lb", start_s=0.05, width_s=0.05)
    scenario, last_s = ff.Scenario(force, duration_s=4.0 if stop else 2.5), 1.0 if stop else 0.5
    runs = simulate_batch(loader, scenario, loader.rows(FEEL_SETTING, feel), law, keep=["column_angle_rad"])
    angle = np.nan_to_num(runs["column_angle_rad"].to_numpy(), nan=10.0)
    if stop:
        angle = np.maximum(angle - STOP_RAD, 0.0)
    at_grip = angle * stiffness * loader["column.grip_arm"]
    from_end = scenario.duration_s - runs["time_s"].to_numpy()
    before, last = (
        np.ptp(at_grip[:, (from_end >= k * last_s) & (from_end < (k + 1) * last_s)], axis=1) for k in (1, 0)
    )
    return (last > QUIET_N) & (last > GONE * before), np.abs(at_grip).max(axis=1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("loaders", nargs="*", default=LOADERS)
    parser.add_argument("--law", default="robust")
    given = parser.parse_args()
    print("loader             contact  law        swings on     largest force, lb")
    for name in given.loaders:
        loader = ff.digital_elevator() if name == "elevator-2khz" else ff.loader.electric(name)
        feel = settings(loader)
        alone = Law.of(given.law, loader, feel)
        law = alone.with_contact(loader)
        for stop, (kind, one) in product((False, True), (("free", alone), ("contact", law))):
            swings, largest = zip(
                *(contact_forces(there, one, feel, k, stop=stop) for k, there in contacts(loader, stop=stop)),
                strict=True,
            )
            where, count = "stop" if stop else "clamp", np.sum(swings)
            print(
                f"{name:18s} {where:8s} {kind:8s} {count:5d} of {np.size(swings):5d} {np.max(largest) / 4.4482:10.0f}"
            )


if __name__ == "__main__":
    main()
