"""Ways to compensate the column's dry friction, side by side: what they render where the friction is known, and where it is off.

    python benchmarks/friction_compensation.py [loader] [pounds ...]

Each row is the law ``robust`` with another compensation; each column the machine's friction, breakaway with it, off what the law
was told by a share. A cell is the share of settings whose release is within the rule's tolerances, and behind the stroke that of
those that swing on: which in the last two programmed periods of the record, where the ideal is below 0.1 % of the deflection,
still swing so far that the feel's spring has more than ``SWINGS`` of the friction.

* none: the law of a loader without friction. Its observer has the disturbance at the command and the hand's torque as states: that
  alone is a disturbance observer, to which friction is the hand's.
* servo: no observer; position loop and load cell (``load-cell``).
* dither: none, and a triangle of 30 Hz on the command, of the amplitude in V that is named.
* feed-forward: the friction along the smoothed sign of the rate, nothing held at rest. The usual tanh(v / v_s).
* friction observer: nothing known, the level learnt from zero to twice the true one (Friedland, Park 1992).
* given back: known, at rest a play.
* lower end: the same with the share that no machine of the tolerance is given too much by.
* learnt: known, and learnt within 20 %. What the laws of a loader file do whose tolerance is 20 %.
* learnt at once: the same, and trusted as soon as it is learnt.
* learnt, from the lower end: the same, begun there.

Then the share of released settings that hands off come to rest within ``RESTS_DEG`` over the last third of ``RELEASED_S``, and the
mean distance from the neutral; "restless" is "learnt" without its part for a column that friction holds.

Behind them, on elevator-2khz, what learning costs a hand, the friction exactly as told: the share of it that a sinusoidal push of
20 N feels beside the programmed feel, and the shares of settings with each pilot's arm.

Sources: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083-1138; H. Olsson, K. J. Astrom, C. Canudas de
Wit, M. Gafvert, P. Lischinsky, Friction models and friction compensation, European J. Control 4 (1998) 176-195; B. Friedland, Y.-J.
Park, On adaptive friction compensation, IEEE Trans. Automatic Control 37 (1992) 1609-1612.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
from dataclasses import replace
from itertools import product

import numpy as np

from forcefeel.choice.score import COARSE
from forcefeel.envelope.cases import NOMINAL, Case, Kind
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.machines import full_rows
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.releases import carrying, measured, pieces, released
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.laws.sampled.sampled_law import OF_FRICTION
from forcefeel.loader.built_in import BUILT_IN
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import HYDRAULIC
from forcefeel.qualification.batch_verdicts import judge_releases
from forcefeel.simulation import Scenario, simulate, simulate_batch
from forcefeel.simulation.inputs import Recorded, Release, Schedule

OFF = (-0.2, -0.1, 0.0, 0.1, 0.2)
BREAKS_AWAY = 1.2
SWINGS = 0.25
DITHER_HZ, DITHER_V = 30.0, (0.02, 0.1, 0.5)
NEGATIVE, POSITIVE, BREAKAWAY, PER_STRIBECK, UNCERTAIN, SLOW, LEAK, LEAST, MOST, GAIN, HAND, BLUR, TRUST, REST = range(
    -OF_FRICTION, 0
)
NOTHING = 1e-6
LEVELS = [NEGATIVE, POSITIVE]
RESTS_DEG, RELEASED_DEG, RELEASED_S = 0.02, 3.0, 14.0
# Share of the file's G, Hz, damping ratio.
RELEASED = list(product((0.05, 0.1, 0.2, 0.4, 0.8), (0.7, 1.5, 2.5), (0.15, 0.3, 0.7)))
HANDS, HERTZ = ("given back", "learnt at once", "learnt"), (0.2, 0.5)
ROWS = ("column.coulomb_friction", "column.static_friction")
LOADERS = {"elevator-2khz": (0.5, 1.0, 2.0), "elevator-electric": (0.5, 1.0)}


def case(off):
    """Friction and breakaway off by a share."""
    return Case(f"{off:+.0%}", Kind.PLANT, dict.fromkeys(ROWS, off)) if off else NOMINAL


def law(change=lambda known: None, name="robust", known=True):
    """A design whose numbers of the friction are changed in place."""

    def design(loader, feel):
        made = LAW_DESIGNS[name].design(loader if known else loader.replace(dict.fromkeys(ROWS)), feel)
        numbers = made.friction.copy()
        change(numbers)
        return replace(made, friction=numbers)

    return design


def unlearnt(numbers):
    numbers[:, GAIN] = 0.0


def fed_forward(numbers):
    unlearnt(numbers)
    numbers[:, [UNCERTAIN, REST]], numbers[:, LEAK] = 0.0, 1.0


def lower(numbers):
    """Begun at the least friction of the tolerance."""
    share = 1 + numbers[:, LEAST]
    numbers[:, LEVELS] *= share[:, None]
    numbers[:, MOST], numbers[:, LEAST] = (1 + numbers[:, MOST]) / share - 1, 0.0


def fixed_lower(numbers):
    lower(numbers)
    unlearnt(numbers)


def at_once(numbers):
    numbers[:, TRUST] = 1.0


def from_nothing(numbers):
    numbers[:, LEVELS] *= NOTHING
    numbers[:, GAIN] /= NOTHING
    numbers[:, LEAST], numbers[:, MOST] = 0.0, 2 / NOTHING


def restless(numbers):
    numbers[:, REST] = 0.0


WAYS = {
    "none": law(known=False),
    "servo": law(name="load-cell", known=False),
    "feed-forward": law(fed_forward),
    "friction observer": law(from_nothing),
    "given back": law(unlearnt),
    "lower end": law(fixed_lower),
    "learnt": law(),
    "restless": law(restless),
    "learnt at once": law(at_once),
    "learnt, from the lower end": law(lower),
}


def judged(plan, record, which, feel, angles):
    """Share that passes, and that does not come to rest, of each case."""
    ideal = measured(plan, record, ideal_releases(feel, plan.release_rad, record.step_s, record.samples), 1)
    period = 2 * np.pi / plan.settings.rows[which[0], 1]
    end = angles[:, :, -round(2 * period / record.step_s) :]
    torque = SWINGS * plan.loader[ROWS[0]] * plan.loader["column.grip_arm"]
    swings = ~(np.ptp(end, axis=2) / 2 * feel[:, 2] <= torque)  # what diverged is no number
    passes = [
        judge_releases(measured(plan, record, angle, 1), ideal, plan.test, travel=plan.throw.travel_rad).passed
        for angle in angles
    ]
    return np.array(passes), swings


def tried(loader, design, release=None):
    """Passes and swings, (cases, settings), of a design; ``release`` runs the machines of a piece if not the envelope's own."""
    plan = make_plan(loader, ["robust"], COARSE, changes={}, arms=())
    feel, cases = plan.settings.feel(loader), [case(off) for off in OFF]
    passes, swings = np.zeros((2, len(cases), len(feel)), dtype=bool)
    for which, record in pieces(plan):
        made = Law.of(design(plan.loader, feel[which]), plan.loader, name="way")
        made = replace(made, feel=feel[which])
        _, angles = (release or released)(plan, cases, feel[which], made, record, 1)
        angles = angles.reshape(len(cases), len(which), -1)
        passes[:, which], swings[:, which] = judged(plan, record, which, feel[which], angles)
    return passes, swings


def shaken(volts):
    """Runs as ``released``, with dither."""

    def run(plan, cases, feel, law, record, threads):
        quarters = np.arange(0, record.duration_s + 1 / DITHER_HZ, 0.25 / DITHER_HZ)
        wave = Schedule(quarters, volts * np.sin(np.pi / 2 * np.arange(len(quarters))))
        step = plan.loader["controller.period"]
        scenario = Scenario(Release(plan.release_rad), record.duration_s, step, record.step_s, command_signal_v=wave)
        rows = np.vstack([full_rows(plan.loader, case, feel, law) for case in cases])
        each = law.some(np.tile(np.arange(len(feel)), len(cases)))
        runs = simulate_batch(plan.loader, scenario, rows, each, keep=["column_angle_rad"], threads=threads)
        return None, runs["column_angle_rad"].values

    return run


def with_arms(loader, design):
    """Passes of the nominal machine by the name of the pilot's arm."""
    plan = make_plan(loader, ["robust"], COARSE, changes={})
    cases, feel = [case for case in plan.cases if case.arm], plan.settings.feel(loader)
    passes = np.zeros((len(cases), len(feel)), dtype=bool)
    for which, record in pieces(plan):
        made = replace(Law.of(design(plan.loader, feel[which]), plan.loader, name="way"), feel=feel[which])
        _, angles = released(plan, cases, feel[which], made, record, 1)
        for k, history in enumerate(angles.reshape(len(cases), len(which), -1)):
            felt = carrying(loader, feel[which], cases[k].arm)
            ideal = ideal_releases(felt, plan.release_rad, record.step_s, record.samples)
            measures = (measured(plan, record, angles_, 1) for angles_ in (history, ideal))
            passes[k, which] = judge_releases(*measures, plan.test, travel=plan.throw.travel_rad).passed
    return {case.name: passes[k].mean() for k, case in enumerate(cases)}


def at_rest(loader, design, off):
    """Share of ``RELEASED`` that comes to rest, and how far from the neutral in deg, the machine's friction off by a share."""
    settings = [(loader["feel.stiffness"] * g, 2 * np.pi * hertz, zeta) for g, hertz, zeta in RELEASED]
    feel = np.array([(g / w**2, 2 * zeta * g / w, g) for g, w, zeta in settings])
    made = replace(Law.of(design(loader, feel), loader, name="way"), feel=feel)
    step = loader["controller.period"]
    scenario = Scenario(Release(np.radians(RELEASED_DEG)), RELEASED_S, step, 4 * step)
    rows = full_rows(loader, case(off), feel, made)
    runs = simulate_batch(loader, scenario, rows, made, keep=["column_angle_rad"])
    angle = np.degrees(runs["column_angle_rad"].values)
    end = angle[:, -angle.shape[1] // 3 :]
    return np.mean(np.ptp(end, axis=1) < RESTS_DEG), np.abs(end[:, -1]).mean()


def felt_by_hand(loader, design, newtons=20.0, hertz=0.2):
    """Share of the friction that a sinusoidal push feels of it where the column moves."""
    feel = np.array([[0.5, 3.0, 20.0]])
    loader = loader.replace(dict(zip(FEEL_SETTING, feel[0], strict=True)), si=True)
    time = np.linspace(0.0, 20.0, 4001)
    force = newtons * np.sin(2 * np.pi * hertz * time)
    made = Law.of(design(loader, feel), loader, name="way")
    scenario = Scenario(Recorded(time, force), time[-1], loader["controller.period"], 5e-3)
    history = simulate(loader, scenario, made).history
    angle, rate = history.column_angle_rad.values, history.column_velocity_rad_per_s.values
    torque = feel[0, 2] * angle + feel[0, 1] * rate
    moving = (np.abs(rate) > 0.2 * np.abs(rate).max()) & (history.time_s.values > 10.0)
    push = np.interp(history.time_s.values, time, force) - torque / loader["column.grip_arm"]
    return np.mean(push * np.sign(rate), where=moving) / loader[ROWS[0]]


def show(name, passes, swings):
    cells = "".join(
        f"{f'{100 * a:.0f} / {100 * b:.0f}':>10}" for a, b in zip(passes.mean(1), swings.mean(1), strict=True)
    )
    within = {0.1: [1, 2, 3], 0.2: slice(None)}
    worst = "".join(f"{100 * passes[rows].all(axis=0).mean():>8.0f}" for rows in within.values())
    print(f"{name:<28}{cells}{worst}", flush=True)


def main():
    name, *pounds = sys.argv[1:] or ["elevator-2khz"]
    loader = BUILT_IN[name]()
    for pound in map(float, pounds or LOADERS[name]):
        values = {ROWS[0]: f"{pound} lb", ROWS[1]: f"{BREAKS_AWAY * pound} lb"}
        rubbed = loader.replace(values)
        print(f"{name}, {pound:g} lb: within tolerance / swings on, %; in all within 10 %, within 20 %")
        print(" " * 28 + "".join(f"{f'{off:+.0%}':>10}" for off in OFF) + f"{'10 %':>8}{'20 %':>8}")
        for design_name, design in WAYS.items():
            show(design_name, *tried(rubbed, design))
        for volts in DITHER_V:
            show(
                f"dither, {volts:g} {'V' if rubbed.drive == HYDRAULIC else 'A'}",
                *tried(rubbed, WAYS["none"], shaken(volts)),
            )
        for design_name in ("restless", "learnt"):
            ends = [at_rest(rubbed, WAYS[design_name], off) for off in OFF]
            print(f"{design_name:<28}" + "".join(f"{f'{100 * share:.0f} %, {far:.2f}':>12}" for share, far in ends))
        for design_name in HANDS if name == "elevator-2khz" else ():
            felt = ", ".join(
                f"{hertz:g} Hz {felt_by_hand(rubbed, WAYS[design_name], hertz=hertz):.0%}" for hertz in HERTZ
            )
            arms = ", ".join(f"{name} {share:.0%}" for name, share in with_arms(rubbed, WAYS[design_name]).items())
            print(
                f"{design_name:<28}a push of 20 N feels of the friction, at {felt}; within tolerance with {arms}",
                flush=True,
            )


if __name__ == "__main__":
    main()
