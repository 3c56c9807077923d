"""Releases of commissioned machines over those of the ideal feel, by an integrator and a law that share no line with the engine.

Run ``python benchmarks/commission_curves.py 1 2 3 --figure curves.svg`` with numbers of machines of ``commission.py``. Each is
identified from its minute of bench as there, the law that ``commission`` chooses is made of what was found, and the machine is let
go of from 10 deg under it: ``commission_machines.py`` moves it, sensors with lag, noise and steps show it, and the law runs here,
with the dry friction that it gives back and learns (the equations of ``crates/model/src/known_friction.rs``, written anew). Of the
program come the law's numbers. Verdicts are in the words of Part 60 (``tests/release_witness.py``). Before that the same releases
with sensors that are exact but for their lag, over the engine's; ends with an error if those are apart.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "forcefeel"
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import commission_machines as witness
from grip_sensor import KINDS, settled
from tolerances import HELD, feel_step, ideal, margin

from commission import BREAKAWAY, DRY, drawn, on_file, witnessed
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.law_for import choose_law
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.simulated_bench import BenchTime
from forcefeel.envelope.releases import Record
from forcefeel.laws.law import Law
from forcefeel.loader.loader import FEEL_SETTING
from forcefeel.loader.parameters import HYDRAULIC
from forcefeel.page.palette import COMPLIANT, IDEAL
from forcefeel.simulation import Scenario, simulate_batch
from forcefeel.simulation.inputs import Release

SEED = 2026
SENSORS = ("load_cell", "potentiometer", "column_sensor")
STIFFNESS, FREQUENCY_RAD_S, DAMPING = (0.01, 0.05, 0.2, 1.0), 2 * np.pi * 1.5, 0.2
"""Settings that are drawn: shares of the largest stiffness."""
TURNED = 0.8
"""Way now and of late, one over the other, from which on a column moves one way."""
APART, SOFTEST_APART = 1e-3, 0.2
"""Of two curves, of the deflection. Measured: 6e-4 and less. On the softest feel, whose spring friction holds from a few degrees
on, 10 %, from where the column first stops: a slip a sample later goes elsewhere. There the engine in steps of a quarter and of
an eighth of its own is 11 % from itself."""


class Friction:
    """What laws recall of the friction that they know, by setting."""

    def __init__(self, laws, feel_torque):
        n, numbers = laws.states, laws.friction
        self.rate, self.enters = numbers[:, : n + 5], numbers[:, n + 5 : -10]
        self.numbers = numbers[:, -10:].T
        self.heard, self.push = feel_torque.copy(), feel_torque.copy()
        self.learnt, self.trusted, self.way = np.zeros((3, len(feel_torque)))

    def sample(self, torque, known):
        """Torque that the feel hears of what is estimated, and by what the law's states move."""
        level, room, slow, leak, low, high, gain, hand, blur, trust = self.numbers
        rate = np.einsum("pj,pj->p", self.rate, known)
        direction, compensated = rate / np.hypot(rate, slow), level + self.learnt
        friction = compensated * direction
        least, most = (np.clip(2 * (rate + side * slow) / slow, -1, 1) for side in (-1, 1))
        band, rest = compensated + room * (most - least) / 2, torque - friction
        feel_torque = np.clip(self.heard + leak * (rest - self.heard), rest + least * band, rest + most * band)
        held, straight = np.abs(self.push) >= hand, direction * self.way > TURNED
        learnt = np.where(straight, np.clip(self.learnt - gain * direction * torque, low, high), self.learnt)
        trusted = np.where(~held & straight, self.trusted + trust * (self.learnt - self.trusted), self.trusted)
        self.learnt = np.where(held, self.learnt + gain * (self.trusted - self.learnt), learnt)
        self.heard, self.trusted = feel_torque, trusted
        self.push, self.way = self.push + blur * (torque - self.push), self.way + blur * (direction - self.way)
        return feel_torque, self.enters * friction[:, None]


class Shown:
    """What the sensors of a file show: behind their lags, with noise, in steps."""

    def __init__(self, loader, y, random):
        self.noise, self.step, bandwidth = (
            np.array([loader[f"{sensor}.{row}"] for sensor in SENSORS]) for row in ("noise", "resolution", "bandwidth")
        )
        self.turn, self.before, self.lag, self.random = bandwidth * witness.STEP_S, y, y.copy(), random

    def on(self, y):
        """A step of the machine later, what is measured straight between."""
        slope = (y - self.before) / self.turn
        self.lag = y - slope + (self.lag - self.before + slope) * np.exp(-self.turn)
        self.before = y

    def sample(self):
        """What is shown now."""
        if not self.random:
            return self.lag
        return np.round((self.lag + self.noise * self.random.standard_normal(self.lag.shape)) / self.step) * self.step


def released(file, machine, laws, feel, record, random):
    """Column angle (settings, samples) of a machine let go of under laws."""
    numbers = {name: machine[key] * factor for name, (key, factor) in witness.OF_FILE.items()}
    m = witness.Machines.of(**{name: np.full(len(feel), value) for name, value in numbers.items()})
    kind = KINDS[HYDRAULIC]
    y, xi, delta = settled(laws, m, feel, kind)
    motion, feels, waiting = kind.motion(m, y, HELD), feel_step(feel), m.held_by * y[:, 0]
    friction = Friction(laws, feel[:, 2] * delta[:, 0])
    reading, limit, every = Shown(file, y, random), m.command_limit, round(record.step_s / witness.PERIOD_S)
    angles = np.empty((len(feel), record.samples))
    for k in range((record.samples - 1) * every + 1):
        if k % every == 0:
            angles[:, k // every] = motion.z[:, kind.angle]
        y = reading.sample()
        feel_input = np.concatenate([xi, y, delta], 1)
        e, torque = (np.einsum("pj,pj->p", law, feel_input) for law in (laws.command, laws.torque))
        torque, moved = friction.sample(torque, feel_input)
        law_input = np.concatenate([y, np.clip(e, -limit, limit)[:, None]], 1)
        xi = np.einsum("pij,pj->pi", laws.transition, xi) + np.einsum("pij,pj->pi", laws.input, law_input) + moved
        delta = np.einsum("pij,pj->pi", feels, np.concatenate([delta, torque[:, None]], 1))
        for _ in range(round(witness.PERIOD_S / witness.STEP_S)):
            motion.run(waiting, witness.STEP_S)
            reading.on(np.stack(motion.shown(), 1))
        waiting = e
    return angles


def feels_of(loader):
    """I, B, G of what is drawn."""
    stiffness = np.array(STIFFNESS) * loader["feel.maximum_stiffness"]
    inertia = stiffness / FREQUENCY_RAD_S**2
    return np.column_stack([inertia, 2 * DAMPING * FREQUENCY_RAD_S * inertia, stiffness])


def apart(file, machine):
    """Largest difference of each curve to the engine's own, of the deflection, sensors exact but for their lag."""
    exact = {f"{sensor}.{row}": None for sensor in SENSORS for row in ("noise", "resolution")}
    truth, record = machine.replace(exact, si=True), Record(witness.PERIOD_S, 4001)
    feel = feels_of(truth)
    law = Law.of("robust", machine, feel)
    actual = released(file, machine, law.sampled, feel, record, None)
    scenario = Scenario(Release(HELD), record.duration_s, 1e-4, record.step_s)
    rows = truth.rows(FEEL_SETTING, feel)
    reference = simulate_batch(truth, scenario, rows, law, keep=["column_angle_rad"])["column_angle_rad"].values
    return np.abs(actual - reference).max(axis=1) / HELD


def curves(file, places, seconds):
    """Of each machine its number, friction, curves and the ideal's, and the margins."""
    machines = list(drawn(file, max(places), SEED))
    some = [machines[number - 1] for number in places]
    options = BenchTime(seconds, seed=SEED)
    for number, machine, data in zip(
        places, some, witnessed(file, some, [number - 1 for number in places], options), strict=True
    ):
        identified = identify_loader(file, data, CommissionPlan()).loader
        name = choose_law(identified, CommissionPlan())[0].name
        feel, record = feels_of(identified), Record.of(FREQUENCY_RAD_S, DAMPING)
        laws = Law.of(name, identified, feel).sampled
        angles = released(file, machine, laws, feel, record, np.random.default_rng([SEED, number]))
        ideals = np.array([ideal(setting, HELD, record.time_s) for setting in feel])
        margins = [margin(*pair, record, edge=0) for pair in zip(angles, feel, strict=True)]
        yield number, machine, name, record.time_s, angles, ideals, margins


def draw(drawn_curves, path):
    """A row for each machine, a column for each stiffness."""
    rows = list(drawn_curves)
    columns = len(rows[0][4])
    figure, every = plt.subplots(
        len(rows), columns, figsize=(10, 1.9 * len(rows)), sharex=True, sharey=True, squeeze=False, layout="constrained"
    )
    for (number, machine, _, time_s, angles, ideals, margins), axes in zip(rows, every, strict=True):
        for ax, angle, ideal_, room, share in zip(axes, angles, ideals, margins, STIFFNESS, strict=True):
            ax.plot(time_s, np.degrees(ideal_), color=IDEAL, linestyle=":", label="ideal feel")
            ax.plot(time_s, np.degrees(angle), color=COMPLIANT, linewidth=1.2, label="machine")
            ax.set_title(f"{share:.0%} of the stiffness: {'within' if room > 0 else 'outside'}", fontsize="small")
            ax.spines[["top", "right"]].set_visible(False)
        axes[0].set_ylabel(f"machine {number}, {machine[DRY] / witness.LBF:.1f} lb\ndeg", fontsize="small")
    for ax in every[-1]:
        ax.set_xlabel("s")
    every[0][0].legend(frameon=False, fontsize="small")
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("machines", type=int, nargs="+", help="numbers as commission.py counts them")
    parser.add_argument("--seconds", type=float, default=60.0, help="of bench")
    parser.add_argument("--figure", type=Path)
    options = parser.parse_args()
    file, drawn_curves = on_file(), []
    for number, machine in enumerate(drawn(file, max(options.machines), SEED), 1):
        if number in options.machines:
            far = apart(file, machine)
            text = ", ".join(f"{error:.0e}" for error in far)
            print(f"machine {number}: at most {text} of the deflection from the engine's curves", flush=True)
            if not (far[0] < SOFTEST_APART and far[1:].max() < APART):
                sys.exit(f"expected less than {SOFTEST_APART:g}, and less than {APART:g} but for the softest")
    for curve in curves(file, options.machines, options.seconds):
        number, machine, name, _, angles, ideals, margins = curve
        off = np.abs(angles - ideals).max(axis=1) / HELD
        text = ", ".join(f"{room:+.2f} (at most {far:.1%} off)" for room, far in zip(margins, off, strict=True))
        friction = machine[DRY] / witness.LBF
        print(
            f"machine {number}, {friction:.2f} lb, breakaway {machine[BREAKAWAY] / machine[DRY]:.2f}, {name}: margins {text}",
            flush=True,
        )
        drawn_curves.append(curve)
    if options.figure:
        draw(drawn_curves, options.figure)


if __name__ == "__main__":
    main()
