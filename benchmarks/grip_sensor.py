"""The law ``grip`` on a plant and a release test that are not the program's: what a force sensor at the grip buys, witnessed.

Run ``python benchmarks/grip_sensor.py``; some minutes. ``elevator-2khz`` with ``grip_sensor.gain = 1``, noise of 0.02 lb, steps of
0.01 lb, the other sensors as in its file; orifice, limits and a sample of delay. Dry friction of the column, of which the law knows
nothing, breaks away at what it slides with. The law comes from the file, the machine is off it: by nothing, by 20 % in the column's
inertia or the linkage's ratio, or with a pilot's arm. Of the program come the law's numbers alone. Machines move by
``commission_machines.py``, which shares no line with the engine; releases from 10 deg over the frontier's 140 settings, spaced in
proportion, are judged in the words of Part 60 (``tests/release_witness.py``). ``--electric`` takes ``elevator-electric``,
``motor_machines.py`` and 40 settings. The force at the grip:

    F_g = F_p - (m theta'' + d theta' + k_a theta) / R_p         F_p = 0 from the release on

Before that, curves of both reckonings one over the other, with sensors that are exact. A column that sings hardly moves: at 90 to
130 Hz its angle stays within hundredths of a degree, while the valve's current goes from limit to limit and a hand feels pounds.
Part 60's words on the angle do not tell of it, so a setting fails here too where the command still reaches the current's limit
after ``SINGS_S``. Beside each share stands the program's own, which fails what is unstable by its poles, and how many verdicts
differ. Ends with an error if curves are apart, more verdicts differ than ``MOST_DIFFER``, or a share is below what is promised:
95 % nominally and 90 % in every case with 2 lb. ``--long 60`` lets what is unstable by its poles go on for a minute.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import commission_machines as witness
import motor_machines as motors
from tolerances import HELD, NO_ARM, PASSES, UNSTABLE, feel_step, margin

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.releases import Record
from forcefeel.frontier.run import DEFAULT_GRID
from forcefeel.laws.law import Law
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import ELECTRIC, HYDRAULIC
from forcefeel.simulation import Scenario, simulate
from forcefeel.simulation.inputs import Release

MOTOR_GRID = {"stiffness": "1.39..72 %:5:log", "frequency": "0.616..3.25 Hz:4:log", "damping": "0.1, 0.7"}
LAW, FRICTION_LB, WITH_CASES_LB = "grip", (0.0, 1.0, 2.0, 3.0), 2.0
SENSORS = ("load_cell", "potentiometer", "column_sensor", "grip_sensor")
TORQUE = witness.LBF * witness.INCH
CHANGES = {"column.inertia": 0.2, "linkage.ratio": 0.2}
OVERLAID_CASES = ("nominal", "column.inertia +20 %", "linkage.ratio -20 %", "firm arm")
OVERLAID = {"stiffness": "5, 30 %", "frequency": "1, 3 Hz", "damping": "0.1, 0.7"}
APART = 3e-3
"""Largest difference of two curves, of the deflection. Measured: 3e-6 where there is no arm or no friction; with both 2e-3, as what
moves the arm jumps where the column turns round, and a sample sees it or does not."""
SINGS_S = 0.5
"""After the release: a command at rest is far below the limit by then. Measured: 18 % of it at most, or the limit and more."""
MOST_DIFFER = 1
"""Verdicts of a case that may differ: noise draws its own in each, and a setting may lie at an edge. Measured: one, loose arm."""
PROMISED_NOMINAL, PROMISED_CASES = 0.95, 0.90


def machines(loader, friction_lb, off, arm, count):
    """Of a loader file what the witness is told, one machine as often as there are settings."""
    about_pivot = np.array(arm) * loader["column.grip_arm"] ** 2
    arms = dict(zip(("arm_inertia", "arm_damping", "arm_stiffness"), about_pivot, strict=True))
    if loader.drive == ELECTRIC:
        numbers = {name: loader[key] * off.get(key, 1.0) for name, key in motors.OF_FILE.items()}
        numbers |= {"friction": friction_lb * witness.LBF, **arms}
        return motors.Machines(**{name: np.full(count, value) for name, value in numbers.items()})
    numbers = {name: loader[key] * off.get(key, 1.0) * factor for name, (key, factor) in witness.OF_FILE.items()}
    numbers |= dict.fromkeys(("coulomb_friction", "static_friction"), friction_lb)
    many = witness.Machines.of(**{name: np.full(count, value) for name, value in numbers.items()})
    return replace(many, **{name: value / TORQUE for name, value in arms.items()})


class ValveMotion(witness.Motion):
    """A valve's machines from rest in a hand, told and asked in SI units."""

    def __init__(self, m, y, held):
        super().__init__(m)
        self.z[:, witness.X], self.z[:, witness.THETA] = y[:, 1] / witness.INCH, held
        self.z[:, witness.P] = y[:, 0] / witness.LBF / m.area

    def shown(self):
        """Force of the link in N, the piston in m, the column's angle."""
        force = (self.machines.area * self.z[:, witness.P] - self.z[:, witness.SEALS]) * witness.LBF
        return force, self.z[:, witness.X] * witness.INCH, self.z[:, witness.THETA]

    def run(self, command, time_s):
        """On for a time under a command in V."""
        for _ in range(round(time_s / witness.STEP_S)):
            self.step(self.current(command))


@dataclass(frozen=True)
class Kind:
    """A drive's witness: its motion, places of angle, rate and friction in it, the units of its machines' length and force."""

    motion: type
    angle: int
    rate: int
    dry: int
    length: float
    force: float


KINDS = {
    HYDRAULIC: Kind(ValveMotion, witness.THETA, witness.W, witness.DRY, witness.INCH, witness.LBF),
    ELECTRIC: Kind(motors.Motion, motors.THETA, motors.W, motors.DRY, 1.0, 1.0),
}


def machine_of(case):
    """Factors by parameter, and the arm."""
    return {key: 1 + off for key, off in case.off.items()}, case.arm.values if case.arm else NO_ARM


def settled(laws, m, feel, kind):
    """States at rest at the held angle in a hand, friction at nothing: x, p, F_g in SI units, xi and delta.

    ``xi = A xi + B [y; e]``, ``e = c [xi; y; delta; 0]``, ``G delta = t [xi; y; delta; 0]``; unknown are xi, F_c and delta; e
    is the command that holds F_c.
    """
    count, n, sensed = len(feel), laws.states, laws.input.shape[2] - 1
    lever, arm = m.lever * kind.length, m.grip_arm * kind.length
    per_force = np.stack([np.ones(count), kind.length / kind.force / m.link_stiffness, 0 * arm, -lever / arm], 1)
    alone = np.stack([0 * lever, lever * HELD, np.full(count, HELD), 0 * lever], 1)
    per_force, alone = per_force[:, :sensed], alone[:, :sensed]
    equations, right = np.zeros((count, n + 2, n + 2)), np.zeros((count, n + 2))
    equations[:, :n, :n] = np.eye(n) - laws.transition
    known = np.concatenate([per_force, m.held_by[:, None]], 1)
    equations[:, :n, n] = -np.einsum("pij,pj->pi", laws.input, known)
    right[:, :n] = np.einsum("pij,pj->pi", laws.input[:, :, :sensed], alone)
    for row, law in ((n, laws.command), (n + 1, laws.torque)):
        equations[:, row, :n], equations[:, row, n + 1] = law[:, :n], law[:, n + sensed]
        equations[:, row, n] = np.einsum("pj,pj->p", law[:, n : n + sensed], per_force)
        right[:, row] = -np.einsum("pj,pj->p", law[:, n : n + sensed], alone)
    equations[:, n, n] -= m.held_by
    equations[:, n + 1, n + 1] -= feel[:, 2]
    solution = np.linalg.solve(equations, right[..., None])[..., 0]
    y = alone + per_force * solution[:, n : n + 1]
    return y, solution[:, :n], np.stack([solution[:, n + 1], np.zeros(count)], 1)


def release(loader, laws, m, feel, record, random):
    """Column angle (settings, samples) from the release on, and when the command last reached the limit of the current, s.

    Without ``random`` the sensors are exact.
    """
    noise, step = (np.array([loader[f"{part}.{row}"] for part in SENSORS]) for row in ("noise", "resolution"))
    kind = KINDS[loader.drive]
    y, xi, delta = settled(laws, m, feel, kind)
    motion, feels, count = kind.motion(m, y, HELD), feel_step(feel), len(feel)
    z, waiting = motion.z, m.held_by * y[:, 0]
    limit, every = m.command_limit, round(record.step_s / witness.PERIOD_S)
    angles, sung = np.empty((count, record.samples)), np.zeros(count)
    for k in range((record.samples - 1) * every + 1):
        angle, rate = z[:, kind.angle], z[:, kind.rate]
        if k % every == 0:
            angles[:, k // every] = angle
        pull = np.where(motion.rests & (k > 0), 0.0, motion.torque(z) + z[:, kind.dry])
        at_arm = m.arm_inertia / m.turned * pull + m.arm_damping * rate + m.arm_stiffness * angle
        y = np.stack([*motion.shown(), -at_arm / m.grip_arm * kind.force], 1)
        if random:
            y += noise * random.standard_normal(y.shape)
            y = np.where(step > 0, np.round(y / np.where(step > 0, step, 1.0)) * step, y)
        feel_input = np.concatenate([xi, y, delta], 1)
        e, torque = (np.einsum("pj,pj->p", law, feel_input) for law in (laws.command, laws.torque))
        law_input = np.concatenate([y, np.clip(e, -limit, limit)[:, None]], 1)
        xi = np.einsum("pij,pj->pi", laws.transition, xi) + np.einsum("pij,pj->pi", laws.input, law_input)
        delta = np.einsum("pij,pj->pi", feels, np.concatenate([delta, torque[:, None]], 1))
        motion.run(waiting, witness.PERIOD_S)
        waiting = e
        sung[np.abs(e) >= limit] = k * witness.PERIOD_S
        z[np.abs(angle) > 100 * HELD] = 0.0  # what has run away has failed
    return angles, sung


def judged(loader, plan, friction_lb, off, arm, seed):
    """Which settings pass on a machine, and which sing."""
    feel, (passes, singing) = plan.settings.feel(loader), np.zeros((2, plan.settings.count), dtype=bool)
    carried = feel + np.array(arm) * loader["column.grip_arm"] ** 2
    for frequency in plan.settings.frequency:
        which = np.flatnonzero(plan.settings.rows[:, 1] == frequency)
        record = Record.of(frequency, plan.settings.damping[0])
        m = machines(loader, friction_lb, off, arm, len(which))
        laws = LAW_DESIGNS[LAW].design(loader, feel[which])
        paths, sung = release(loader, laws, m, feel[which], record, np.random.default_rng([seed, which[0]]))
        sings = sung > SINGS_S
        good = [margin(*pair, record, edge=0) > 0 for pair in zip(paths, carried[which], strict=True)]
        passes[which], singing[which] = good & ~sings, sings
    return passes, singing


def long_records(loader, plan, grid, seconds, seed):
    """Prints which of the settings that are unstable by their poles with an arm still sing at the end of long records."""
    codes = ff.find_envelope(loader, (LAW,), grid, changes={}).codes(LAW)
    feel, record = plan.settings.feel(loader), Record(witness.PERIOD_S, round(seconds / witness.PERIOD_S) + 1)
    for case, code in zip([case for case in plan.cases if not case.off], codes, strict=True):
        which = np.flatnonzero(code == UNSTABLE)
        for friction in (0.0, WITH_CASES_LB) if len(which) else ():
            m = machines(loader, friction, *machine_of(case), len(which))
            laws = LAW_DESIGNS[LAW].design(loader, feel[which])
            _, sung = release(loader, laws, m, feel[which], record, np.random.default_rng(seed))
            ended = ", ".join(f"{last:.1f}" for last in sung)
            print(
                f"{case.name}, {friction:g} lb, settings {which}: at the limit until {ended} s of {seconds:g}",
                flush=True,
            )


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
    paths, _ = release(exact, LAW_DESIGNS[LAW].design(exact, feel), m, feel, record, None)
    for setting, path in zip(feel, paths, strict=True):
        at_setting = exact.replace(dict(zip(FEEL_SETTING, setting.tolist(), strict=True)), si=True)
        truth = with_friction(at_setting.replace(machine, si=True), friction_lb)
        run = simulate(truth, Scenario(Release(HELD), record.duration_s, 1e-4, record.step_s), Law.of(LAW, at_setting))
        worst.append(np.abs(run.history["column_angle_rad"].values - path).max() / HELD)
    return max(worst)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=17)
    parser.add_argument("--electric", action="store_true", help="elevator-electric in place of elevator-2khz")
    parser.add_argument(
        "--long", type=float, help="instead: records of so many seconds of what is unstable by its poles"
    )
    chosen, begun, wrong = parser.parse_args(), time.perf_counter(), []
    seed, built_in = chosen.seed, ff.loader.electric("elevator-electric") if chosen.electric else ff.digital_elevator()
    sensor = {"grip_sensor.gain": 1.0, "grip_sensor.noise": "0.02 lb", "grip_sensor.resolution": "0.01 lb"}
    loader = built_in.replace(sensor, si=True)
    grid = MOTOR_GRID if chosen.electric else DEFAULT_GRID
    plan = make_plan(loader, [LAW], grid, changes=CHANGES)
    if chosen.long:
        long_records(loader, plan, grid, chosen.long, seed)
        return
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
        chosen = list(cases.values()) if friction == WITH_CASES_LB else [cases["nominal"]]
        rubbed = with_friction(loader, friction) if friction else loader
        program = ff.find_envelope(rubbed, (LAW,), grid, changes=CHANGES)
        codes = program.codes(LAW)[: len(chosen)]
        passes, singing = np.moveaxis(
            [judged(loader, plan, friction, *machine_of(case), seed) for case in chosen], 1, 0
        )
        for case, passing, sings, code in zip(chosen, passes, singing, codes, strict=True):
            differ = passing != (code == PASSES)
            print(
                f"{friction:g} lb, {case.name}: {passing.mean():.1%} of {passing.size} settings, by the program "
                f"{(code == PASSES).mean():.1%}; {int(differ.sum())} verdicts differ; {int(sings.sum())} sing, "
                f"{int((code == UNSTABLE).sum())} are unstable by their poles, {int((sings & (code == UNSTABLE)).sum())} both",
                flush=True,
            )
            if differ.sum() > MOST_DIFFER:
                wrong.append(f"{friction:g} lb, {case.name}: {int(differ.sum())} verdicts differ")
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
