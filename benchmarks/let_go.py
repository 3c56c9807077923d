"""Letting go: how soon the column follows its feel again after a hand has pushed it into an end stop.

A hand pushes a column into a stop at 5 deg, then lets go, eases to half the force of the feel there, or pulls the column back. Or
it strikes the stop, pushes for 0.35 s and lets go. The reference is the programmed feel with a stop that returns no energy:

    I delta'' + B delta' + G delta = R_p F,   delta <= 5 deg

The benchmark prints the time integral of the difference between column and reference over the next 1.5 s, divided by 5 deg: mean
and maximum of 16 settings.

    python benchmarks/let_go.py [LOADER ...] [--law robust] [--friction "1 lb"]
"""

import argparse

import numpy as np
from contact import FRICTION, LOADERS, settings

from forcefeel.envelope.contact import STOP_RAD, Contact
from forcefeel.laws.law import Law
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.simulation import Scenario
from forcefeel.simulation.engine import batch_outputs
from forcefeel.simulation.inputs import Recorded

MORE_N, STRIKE_N = 20.0, 40.0
"""Force of a push and of a strike beyond the spring of the feel at the stop."""
STRUCK_S, HELD_S, AFTER_S, STEP_S = 0.4, 1.5, 1.5, 1e-3
HANDS = {"lets go": (0.0, 0.05), "eases": (0.5, 0.3), "pulls": (-0.5, 0.2), "strikes": None}
"""Final force as a share of that spring's, and the time in s that it takes to reach it."""
STOPS = Contact(True, 1e6, 0.02), Contact(True, 1e4, 0.1)
TIME = np.arange(0.0, HELD_S + AFTER_S + STEP_S / 2, STEP_S)


def push(hand: str, at_stop_n: float) -> tuple[np.ndarray, float]:
    """Force over time, and when the hand leaves the stop."""
    if HANDS[hand] is None:
        return np.where((TIME > 0.05) & (TIME < STRUCK_S), at_stop_n + STRIKE_N, 0.0), STRUCK_S
    share, takes_s = HANDS[hand]
    most = at_stop_n + MORE_N
    points = [0.0, 0.5, HELD_S, HELD_S + takes_s], [0.0, most, most, share * at_stop_n]
    return np.interp(TIME, *points), HELD_S


def ideal(torque: np.ndarray, feel: np.ndarray) -> np.ndarray:
    """Displacement of the feel, by small steps."""
    (inertia, damping, stiffness), (delta, rate), parts = feel, (0.0, 0.0), 4
    displacement = np.zeros_like(torque)
    for k, now in enumerate(torque):
        displacement[k] = delta
        for _ in range(parts):
            rate += STEP_S / parts * (now - damping * rate - stiffness * delta) / inertia
            delta += STEP_S / parts * rate
            if delta > STOP_RAD:
                delta, rate = STOP_RAD, min(rate, 0.0)
    return displacement


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("loaders", nargs="*", default=LOADERS)
    parser.add_argument("--law", default="robust")
    parser.add_argument("--friction", help="dry friction at the grip, known to the law")
    options = parser.parse_args()
    print("loader             hand       stop, N/m   mean, largest time lost, ms")
    for name in options.loaders:
        loader = BUILT_IN[name]().replace(dict.fromkeys(FRICTION, options.friction) if options.friction else {})
        feels = settings(loader, light=False)[::3]
        law = Law.of(options.law, loader, feels)
        for hand in HANDS:
            for stop in STOPS:
                there, lost = stop.on(loader), np.zeros(len(feels))
                for i, feel in enumerate(feels):
                    force, leaves_s = push(hand, feel[2] * STOP_RAD / loader["column.grip_arm"])
                    run = batch_outputs(
                        there,
                        Scenario(Recorded(TIME, force), duration_s=TIME[-1]),
                        there.rows(FEEL_SETTING, feel[None]),
                        law.some(np.array([i])),
                        keep=["column_angle_rad"],
                        first_run=None,
                    )
                    time = run["time_s"]
                    after = (time > leaves_s) & (time < leaves_s + AFTER_S)
                    reference = np.interp(time, TIME, ideal(force * loader["column.grip_arm"], feel))
                    lost[i] = (
                        np.trapezoid(np.abs(run["column_angle_rad"][0] - reference)[after], time[after]) / STOP_RAD
                    )
                print(
                    f"{name:18s} {hand:8s} {stop.stiffness_n_per_m:10,.0f} {lost.mean() * 1e3:10.0f} {lost.max() * 1e3:7.0f}"
                )


if __name__ == "__main__":
    main()
