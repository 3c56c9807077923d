"""The law ``grip`` on a plant and a release test that are not the program's: what a force sensor at the grip buys, witnessed.

Run ``python benchmarks/grip_sensor.py``; some minutes. ``elevator-2khz`` with ``grip_sensor.gain = 1``, noise of 0.02 lb, steps of
0.01 lb, the other sensors as in its file; orifice, limits and a sample of delay. Dry friction of the column, of which the law knows
nothing, breaks away at what it slides with. The law comes from the file, the machine is off it: by nothing, by 20 % in the column's
inertia or the linkage's ratio, or with a pilot's arm. Of the program come the law's numbers alone. Machines move by
``commission_machines.py``, which shares no line with the engine; releases from 10 deg over the frontier's 140 settings, spaced in
proportion, are judged in the words of Part 60 (``tests/release_witness.py``). The force at the grip:

    F_g = F_p - (m theta'' + d theta' + k_a theta) / R_p         F_p = 0 from the release on

Before that, curves of both reckonings one over the other, with sensors that are exact. Beside each share stands the program's own,
and how many verdicts differ; the program fails what is unstable by its poles too, which a record need not show. Ends with an error
if curves are apart, or a share is below what is promised: 95 % nominally and 90 % in every case with 2 lb.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import commission_machines as witness
from tolerances import HELD, NO_ARM, PASSES, UNSTABLE, feel_step, margin

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.releases import Record
from forcefeel.frontier.run import DEFAULT_GRID
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.methods import METHODS
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Release

LAW, FRICTION_LB, WITH_CASES_LB = "grip", (0.0, 1.0, 2.0, 3.0), 2.0
SENSORS = ("load_cell", "potentiometer", "column_sensor", "grip_sensor")
TORQUE = witness.LBF * witness.INCH
CHANGES = {"column.inertia": 0.2, "linkage.ratio": 0.2}
OVERLAID_CASES = ("nominal", "column.inertia +20 %", "linkage.ratio -20 %", "firm arm")
OVERLAID = {"stiffness": "5, 30 %", "frequency": "1, 3 Hz", "damping": "0.1, 0.7"}
APART = 3e-3
"""Largest difference of two curves, of the deflection. Measured: 3e-6 where there is no arm or no friction; with both 2e-3, as what
moves the arm jumps where the column turns round, and a sample sees it or does not."""
PROMISED_NOMINAL, PROMISED_CASES = 0.95, 0.90


def machines(loader, friction_lb, off, arm, count):
    """Of a loader file what the witness is told, one machine as often as there are settings."""
    numbers = {name: loader[key] * off.get(key, 1.0) * factor for name, (key, factor) in witness.OF_FILE.items()}
    numbers |= dict.fromkeys(("coulomb_friction", "static_friction"), friction_lb)
    found = witness.Machines.of(**{name: np.full(count, value) for name, value in numbers.items()})
    about_pivot = np.array(arm) * loader["column.grip_arm"] ** 2 / TORQUE
    return replace(found, **dict(zip(("arm_inertia", "arm_damping", "arm_stiffness"), about_pivot, strict=True)))


def machine_of(case):
    """Factors by parameter, and the arm."""
    return {key: 1 + off for key, off in case.off.items()}, case.arm.values if case.arm else NO_ARM


def settled(laws, m, feel):
    """States at rest at the held angle in a hand, friction at nothing: x, p, F_g in SI units, xi and delta.

    ``xi = A xi + B [y; 0]``, ``0 = c [xi; y; delta; 0]``, ``G delta = t [xi; y; delta; 0]``; unknown are xi, p A = F_c and delta.
    """
    count, n = len(feel), laws.states
    lever, arm = m.lever * witness.INCH, m.grip_arm * witness.INCH
    per_force = np.stack(
        [np.ones(count), 1 / (m.link_stiffness * witness.LBF / witness.INCH), 0 * arm, -lever / arm], 1
    )
    alone = np.stack([0 * lever, lever * HELD, np.full(count, HELD), 0 * lever], 1)
    equations, right = np.zeros((count, n + 2, n + 2)), np.zeros((count, n + 2))
    equations[:, :n, :n] = np.eye(n) - laws.transition
    equations[:, :n, n] = -np.einsum("pij,pj->pi", laws.input[:, :, :4], per_force)
    right[:, :n] = np.einsum("pij,pj->pi", laws.input[:, :, :4], alone)
    for row, law in ((n, laws.command), (n + 1, laws.torque)):
        equations[:, row, :n], equations[:, row, n + 1] = law[:, :n], law[:, n + 4]
        equations[:, row, n] = np.einsum("pj,pj->p", law[:, n : n + 4], per_force)
        right[:, row] = -np.einsum("pj,pj->p", law[:, n : n + 4], alone)
    equations[:, n + 1, n + 1] -= feel[:, 2]
    found = np.linalg.solve(equations, right[..., None])[..., 0]
    y = alone + per_force * found[:, n : n + 1]
    return y, found[:, :n], np.stack([found[:, n + 1], np.zeros(count)], 1)


def release(loader, laws, m, feel, record, random):
    """Column angle (settings, samples) from the release on; without ``random`` the sensors are exact."""
    noise, step = (np.array([loader[f"{part}.{row}"] for part in SENSORS]) for row in ("noise", "resolution"))
    y, xi, delta = settled(laws, m, feel)
    motion, feels, count = witness.Motion(m), feel_step(feel), len(feel)
    z, waiting = motion.z, np.zeros(count)
    z[:, witness.X], z[:, witness.P], z[:, witness.THETA] = y[:, 1] / witness.INCH, y[:, 0] / witness.LBF / m.area, HELD
    limit = m.current_limit / m.admittance
    every, within = round(record.step_s / witness.PERIOD_S), round(witness.PERIOD_S / witness.STEP_S)
    angles = np.empty((count, record.samples))
    for k in range((record.samples - 1) * every + 1):
        if k % every == 0:
            angles[:, k // every] = z[:, witness.THETA]
        pull = np.where(motion.rests & (k > 0), 0.0, motion.push(z) + z[:, witness.DRY])
        at_arm = (
            m.arm_inertia / m.turned * pull + m.arm_damping * z[:, witness.W] + m.arm_stiffness * z[:, witness.THETA]
        )
        force = m.area * z[:, witness.P] * witness.LBF
        y = np.stack(
            [force, z[:, witness.X] * witness.INCH, z[:, witness.THETA], -at_arm / m.grip_arm * witness.LBF], 1
        )
        if random:
            y += noise * random.standard_normal(y.shape)
            y = np.where(step > 0, np.round(y / np.where(step > 0, step, 1.0)) * step, y)
        heard = np.concatenate([xi, y, delta], 1)
        e, torque = (np.einsum("pj,pj->p", law, heard) for law in (laws.command, laws.torque))
        told = np.concatenate([y, np.clip(e, -limit, limit)[:, None]], 1)
        xi = np.einsum("pij,pj->pi", laws.transition, xi) + np.einsum("pij,pj->pi", laws.input, told)
        delta = np.einsum("pij,pj->pi", feels, np.concatenate([delta, torque[:, None]], 1))
        for _ in range(within):
            motion.step(motion.current(waiting))
        waiting = e
        z[np.abs(z[:, witness.THETA]) > 100 * HELD] = 0.0  # what has run away has failed
    return angles


def judged(loader, plan, friction_lb, off, arm, seed):
    """Which settings pass on a machine."""
    feel, passes = plan.settings.feel(loader), np.zeros(plan.settings.count, dtype=bool)
    carried = feel + np.array(arm) * loader["column.grip_arm"] ** 2
    for frequency in plan.settings.frequency:
        which = np.flatnonzero(plan.settings.rows[:, 1] == frequency)
        record = Record.of(frequency, plan.settings.damping[0])
        m = machines(loader, friction_lb, off, arm, len(which))
        laws = METHODS[LAW].design(loader, feel[which])
        paths = release(loader, laws, m, feel[which], record, np.random.default_rng([seed, which[0]]))
        passes[which] = [margin(*pair, record, edge=0) > 0 for pair in zip(paths, carried[which], strict=True)]
    return passes


def with_friction(loader, friction_lb):
    return loader.replace(dict.fromkeys(("column.coulomb_friction", "column.static_friction"), f"{friction_lb} lb"))


def laid_over(loader, friction_lb, off, arm):
    """Largest difference to the engine's own curve at a few settings, of the deflection, sensors exact."""
    exact = loader.replace({f"{part}.{row}": None for part in SENSORS for row in ("noise", "resolution")})
    machine = {key: float(exact[key] * factor) for key, factor in off.items()}
    machine |= dict(zip(("pilot.arm_mass", "pilot.arm_damping", "pilot.arm_stiffness"), map(float, arm), strict=True))
    plan, worst = make_plan(exact, [LAW], OVERLAID, changes={}, arms=()), []
    feel = plan.settings.feel(exact)
    record = Record(witness.PERIOD_S, 4001)
    m = machines(exact, friction_lb, off, arm, len(feel))
    paths = release(exact, METHODS[LAW].design(exact, feel), m, feel, record, None)
    for one, path in zip(feel, paths, strict=True):
        asked = exact.replace(dict(zip(FEEL_SETTING, one.tolist(), strict=True)))
        truth = with_friction(asked.replace(machine), friction_lb)
        run = simulate(truth, Scenario(Release(HELD), record.duration_s, 1e-4, record.step_s), Law.of(LAW, asked))
        worst.append(np.abs(run.history["column_angle_rad"].values - path).max() / HELD)
    return max(worst)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=17)
    seed, begun, wrong = parser.parse_args().seed, time.perf_counter(), []
    sensor = {"grip_sensor.gain": 1.0, "grip_sensor.noise": "0.02 lb", "grip_sensor.resolution": "0.01 lb"}
    loader = ff.digital_elevator().replace(sensor)
    plan = make_plan(loader, [LAW], DEFAULT_GRID, changes=CHANGES)
    cases = {case.name: case for case in plan.cases}
    drawn_over = {name: (2.0, cases[name]) for name in OVERLAID_CASES} | {
        "nominal, no friction": (0.0, cases["nominal"])
    }
    for name, (friction, case) in drawn_over.items():
        apart = laid_over(loader, friction, *machine_of(case))
        print(f"the engine's curves and these, {name}: at most {apart:.1e} of the deflection apart", flush=True)
        if not apart < APART:
            wrong.append(f"the curves are {apart:.1e} apart, expected less than {APART:g}")
    for friction in FRICTION_LB:
        asked = list(cases.values()) if friction == WITH_CASES_LB else [cases["nominal"]]
        rubbed = with_friction(loader, friction) if friction else loader
        program = ff.find_envelope(rubbed, (LAW,), DEFAULT_GRID, changes=CHANGES)
        codes = program.codes(LAW)[: len(asked)]
        passes = np.array([judged(loader, plan, friction, *machine_of(case), seed) for case in asked])
        for case, mine, code in zip(asked, passes, codes, strict=True):
            differ = mine != (code == PASSES)
            slow = int((differ & (code == UNSTABLE)).sum())
            print(
                f"{friction:g} lb, {case.name}: {mine.mean():.1%} of {mine.size} settings, by the program "
                f"{(code == PASSES).mean():.1%}; {int(differ.sum())} verdicts differ, {slow} of them unstable by the poles alone",
                flush=True,
            )
        if friction == WITH_CASES_LB:
            both = passes.all(axis=0).mean(), (codes == PASSES).all(axis=0).mean()
            print(
                f"{friction:g} lb, in every one of these cases: {both[0]:.1%}, by the program {both[1]:.1%}", flush=True
            )
            if passes[0].mean() < PROMISED_NOMINAL or both[0] < PROMISED_CASES:
                wrong.append(f"promised are {PROMISED_NOMINAL:.0%} nominally, {PROMISED_CASES:.0%} in every case")
    print(f"{time.perf_counter() - begun:.0f} s")
    if wrong:
        sys.exit("; ".join(wrong))


if __name__ == "__main__":
    main()
