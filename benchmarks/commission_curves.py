"""Releases of commissioned machines over those of the ideal feel, by an integrator that shares no line with the engine.

Run ``python benchmarks/commission_curves.py 1 2 3 --figure curves.svg`` with numbers of machines of ``commission.py`` (their
count is part of the draw: ``--of`` is its ``--machines``). Each is identified from its minute of bench as there, the law that
``commission`` chooses is made of what was found, and the machine is let go of from 10 deg under it: ``commission_machines.py``
moves it, sensors with lag, noise and steps show it, and the law is its exported C, compiled. Verdicts are in the words of Part 60
(``tests/release_witness.py``). Before that the same releases with sensors that are exact but for their lag, over the engine's;
ends with an error if those are apart.

With ``--all`` the machine is let go of at the 96 settings of ``commission.py``, its friction as it was and after its drift: two
minutes of processor time each. Shares have the weights of ``commission.py``; the plain share follows each.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import ctypes
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "forcefeel"
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import commission_machines as witness
from grip_sensor import KINDS, settled
from tolerances import HELD, ideal, margin

import forcefeel as ff
from commission import after_drift, as_it_rubs, drawn, drawn_drifts, friction_lb, on_file, witnessed
from forcefeel.commission.identified import identify_loader
from forcefeel.commission.law_for import choose_law
from forcefeel.commission.plan import CommissionPlan
from forcefeel.commission.simulated_bench import BenchTime
from forcefeel.envelope.plan import make_plan
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
APART, SOFTEST_APART = 1e-3, 0.2
"""Of two curves, of the deflection. Measured: 6e-4 and less. On the softest feel, whose spring friction holds from a few degrees
on, 10 %, from where the column first stops: a slip a sample later goes elsewhere. There the engine in steps of a quarter and of
an eighth of its own is 11 % from itself."""


STEPS = """
#include "law_law.h"
static law_state states[law_SETTINGS];
static law_input shown(const double *y, unsigned k) {{
    law_input in = {{0}};
    in.force = y[0]; in.position = y[1]; in.base = y[2] * law_BASE_PER_RAD; in.stiffness_factor = 1.0;
    {setting}
    return in;
}}
int begin(const double *y) {{
    int status = 0;
    for (unsigned k = 0U; k < law_SETTINGS; ++k) {{
        const law_input in = shown(y + 3U * k, k);
        status |= (int)law_law_reset(&states[k], &in);
    }}
    return status;
}}
int step(const double *y, double *command) {{
    int status = 0;
    for (unsigned k = 0U; k < law_SETTINGS; ++k) {{
        const law_input in = shown(y + 3U * k, k);
        law_output out;
        status |= (int)law_law_step(&states[k], &in, &out);
        command[k] = out.command;
    }}
    return status;
}}
"""


class ExportedLaw:
    """A law and its feel as compiled C, a state for each setting."""

    def __init__(self, exported):
        folder = Path(tempfile.mkdtemp())
        self.count = len(exported.settings)
        ff.export.write_export(exported, ff.export.Target.C, folder / "c")
        setting = "in.from = in.to = k;" if self.count > 1 else ""
        (folder / "c" / "steps.c").write_text(STEPS.format(setting=setting), encoding="utf-8")
        program = ["cc", "-O2", "-ffp-contract=off", "-shared", "-fPIC", "-o", "law.so", "steps.c", "law_law.c", "-lm"]
        subprocess.run(program, cwd=folder / "c", check=True)
        self.library = ctypes.CDLL(os.fspath(folder / "c" / "law.so"))
        shutil.rmtree(folder)

    def begin(self, y):
        """Resets it where the sensors show ``y`` (settings, 3)."""
        y = np.ascontiguousarray(y)
        if self.library.begin(ctypes.c_void_p(y.ctypes.data)):
            sys.exit("the law has no equilibrium there")

    def step(self, y):
        """The commands of a sample."""
        y, command = np.ascontiguousarray(y), np.empty(self.count)
        if self.library.step(ctypes.c_void_p(y.ctypes.data), ctypes.c_void_p(command.ctypes.data)):
            sys.exit("the law refuses what it is shown")
        return command


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


def released(made_for, machine, law, feel, record, random):
    """Column angle (settings, samples) of a machine let go of under a law of a loader, whose sensors it has."""
    numbers = {name: machine[key] * factor for name, (key, factor) in witness.OF_FILE.items()}
    m = witness.Machines.of(**{name: np.full(len(feel), value) for name, value in numbers.items()})
    kind = KINDS[HYDRAULIC]
    y, _, _ = settled(law.sampled, m, feel, kind)
    motion, waiting = kind.motion(m, y, HELD), m.held_by * y[:, 0]
    program = ExportedLaw(ff.export.Exported(made_for, law, "law"))
    program.begin(y)
    reading, every = Shown(made_for, y, random), round(record.step_s / witness.PERIOD_S)
    angles = np.empty((len(feel), record.samples))
    for k in range((record.samples - 1) * every + 1):
        if k % every == 0:
            angles[:, k // every] = motion.z[:, kind.angle]
        command = program.step(reading.sample())
        for _ in range(round(witness.PERIOD_S / witness.STEP_S)):
            motion.run(waiting, witness.STEP_S)
            reading.on(np.stack(motion.shown(), 1))
        waiting = command
    return angles


def feels_of(loader):
    """I, B, G of what is drawn."""
    stiffness = np.array(STIFFNESS) * loader["feel.maximum_stiffness"]
    inertia = stiffness / FREQUENCY_RAD_S**2
    return np.column_stack([inertia, 2 * DAMPING * FREQUENCY_RAD_S * inertia, stiffness])


def apart(machine):
    """Largest difference of each curve to the engine's own, of the deflection, sensors exact but for their lag."""
    exact = {f"{sensor}.{row}": None for sensor in SENSORS for row in ("noise", "resolution")}
    truth, record = machine.replace(exact, si=True), Record(witness.PERIOD_S, 4001)
    feel = feels_of(truth)
    law = Law.of("robust", machine, feel)
    actual = released(machine, machine, law, feel, record, None)
    scenario = Scenario(Release(HELD), record.duration_s, 1e-4, record.step_s)
    rows = truth.rows(FEEL_SETTING, feel)
    reference = simulate_batch(truth, scenario, rows, law, keep=["column_angle_rad"])["column_angle_rad"].values
    return np.abs(actual - reference).max(axis=1) / HELD


def commissioned(file, places, machines, seconds):
    """Of each machine what was identified, and the name of the law that was chosen."""
    options = BenchTime(seconds, seed=SEED)
    for data in witnessed(file, machines, [number - 1 for number in places], options):
        identified = identify_loader(file, data, CommissionPlan()).loader
        yield identified, choose_law(identified, CommissionPlan())[0].name


def curves(identified, name, machine, number):
    """Time, curves and the ideal's, and the margins, of the settings that are drawn."""
    feel, record = feels_of(identified), Record.of(FREQUENCY_RAD_S, DAMPING)
    law = Law.of(name, identified, feel)
    angles = released(identified, machine, law, feel, record, np.random.default_rng([SEED, number]))
    ideals = np.array([ideal(setting, HELD, record.time_s) for setting in feel])
    return record.time_s, angles, ideals, [margin(*pair, record, edge=0) for pair in zip(angles, feel, strict=True)]


def share(identified, name, machine, number):
    """Share of the 96 settings that a machine renders: log-weighted, and plain."""
    plan = make_plan(identified, [name], CommissionPlan().grid, arms=())
    feel = plan.settings.feel(identified)
    damping, frequency, _ = plan.settings.rows.T
    own = [Record.of(*each) for each in zip(frequency, damping, strict=True)]
    longest = Record(witness.PERIOD_S, round(max(record.duration_s for record in own) / witness.PERIOD_S) + 1)
    law = Law.of(name, identified, feel)
    angles = released(identified, machine, law, feel, longest, np.random.default_rng([SEED, number]))
    passes = np.zeros(len(feel), dtype=bool)
    for k, (angle, setting, record) in enumerate(zip(angles, feel, own, strict=True)):
        every = round(record.step_s / witness.PERIOD_S)
        passes[k] = margin(angle[: every * record.samples : every], setting, record, edge=0) > 0
    return plan.settings.weights[passes].sum(), passes.mean()


def draw(drawn_curves, path):
    """A row for each machine, a column for each stiffness."""
    rows = list(drawn_curves)
    columns = len(STIFFNESS)
    figure, every = plt.subplots(
        len(rows), columns, figsize=(10, 1.9 * len(rows)), sharex=True, sharey=True, squeeze=False, layout="constrained"
    )
    for (number, machine, (time_s, angles, ideals, margins)), axes in zip(rows, every, strict=True):
        for ax, angle, ideal_, room, of_largest in zip(axes, angles, ideals, margins, STIFFNESS, strict=True):
            ax.plot(time_s, np.degrees(ideal_), color=IDEAL, linestyle=":", label="ideal feel")
            ax.plot(time_s, np.degrees(angle), color=COMPLIANT, linewidth=1.2, label="machine")
            ax.set_title(f"{of_largest:.0%} of the stiffness: {'within' if room > 0 else 'outside'}", fontsize="small")
            ax.spines[["top", "right"]].set_visible(False)
        axes[0].set_ylabel(f"machine {number}, {friction_lb(machine):.1f} lb\ndeg", fontsize="small")
    for ax in every[-1]:
        ax.set_xlabel("s")
    every[0][0].legend(frameon=False, fontsize="small")
    figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else None)


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("machines", type=int, nargs="+", help="numbers as commission.py counts them")
    parser.add_argument("--seconds", type=float, default=60.0, help="of bench")
    parser.add_argument("--of", type=int, default=100, help="machines drawn")
    parser.add_argument("--figure", type=Path)
    parser.add_argument("--all", action="store_true", help="settings, and after a drift of the friction too")
    options = parser.parse_args()
    file, random = on_file(), np.random.default_rng([SEED, 11])
    every = [as_it_rubs(machine, random) for machine in drawn(file, options.of, SEED)]
    machines, drifts = [every[number - 1] for number in options.machines], drawn_drifts(options.of, SEED)
    for number, machine in zip(options.machines, machines, strict=True):
        far = apart(machine)
        text = ", ".join(f"{error:.0e}" for error in far)
        print(f"machine {number}: at most {text} of the deflection from the engine's curves", flush=True)
        if not (far[0] < SOFTEST_APART and far[1:].max() < APART):
            sys.exit(f"expected less than {SOFTEST_APART:g}, and less than {APART:g} but for the softest")
    rows = []
    for number, machine, (identified, name) in zip(
        options.machines, machines, commissioned(file, options.machines, machines, options.seconds), strict=True
    ):
        _, angles, ideals, margins = curve = curves(identified, name, machine, number)
        off = np.abs(angles - ideals).max(axis=1) / HELD
        text = ", ".join(f"{room:+.2f} (at most {far:.1%} off)" for room, far in zip(margins, off, strict=True))
        print(f"machine {number}, {friction_lb(machine):.2f} lb, {name}: margins {text}", flush=True)
        rows.append((number, machine, curve))
        if options.all:
            drift = drifts[number - 1]
            (now, plain), (later, later_plain) = (
                share(identified, name, it, number) for it in (machine, after_drift(machine, drift))
            )
            drifted = f"{later:.1%} ({later_plain:.1%}) after {drift:+.0%}"
            print(f"machine {number}: {now:.1%} of the settings (plain {plain:.1%}), {drifted}", flush=True)
    if options.figure:
        draw(rows, options.figure)


if __name__ == "__main__":
    main()
