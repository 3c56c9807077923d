"""Machines with all tolerances at once, and the cases of an envelope, on a plant and a release test that are not the program's.

Run ``python benchmarks/tolerances.py``; some ten minutes. The digital elevator loader under ``agile``: inertia, linkage ratio and
base arm within 1 %, all else 20 %. The report's equations are integrated here, every machine at every setting, with orifice, limits
and delay; the releases are measured from a spline and judged in the words of Part 60. Of the program come the law's numbers and
what is drawn. Verdicts are compared with sensors that are exact, since noise draws its own in each; beside them stand the
program's shares with noise. Ends with an error if more verdicts differ than lie at an edge.

    A p = k (x - alpha R_b theta) + c (x' - alpha R_b theta')                          eq. (9)
    p' = 4 beta / V_E (q - A x'),    q = q_i sqrt(1 - sgn(q_i) p / p_s)                eqs. (5), (1)
    q_i'' = w_n^2 (q_c - q_i) - 2 zeta w_n q_i',    q_c = (q_r / i_r) K_2 e            eq. (3)
    (J + m R_p^2) theta'' = alpha R_b A p - d R_p^2 theta' - k_a R_p^2 theta           eqs. (6), (7), and an arm
"""

import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import forcefeel as ff
from forcefeel.envelope.deviations import CHANGES
from forcefeel.envelope.draws import Draws
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.releases import Record
from forcefeel.frontier.bound import DAMPINGS, inertia_bound
from forcefeel.frontier.second_order_bound import setting_groups
from forcefeel.laws.sampled.law_designs import LAW_DESIGNS
from forcefeel.threads import cores

sys.path.append(str(Path(__file__).parents[1] / "tests"))  # behind: it has folders of the benchmarks' names
from release_witness import features, ideal, least_margin

LB, IN = 4.4482216152605, 0.0254
NOMINAL = {
    "amplifier.admittance": 1.56e-3,
    "valve.rated_flow": 100 * IN**3,
    "valve.supply_pressure": 1200 * LB / IN**2,
    "valve.natural_frequency": 377.0,
    "valve.damping_ratio": 0.9,
    "actuator.area": 2.36 * IN**2,
    "actuator.oil_volume": 11.7 * IN**3,
    "actuator.bulk_modulus": 250000 * LB / IN**2,
    "linkage.ratio": 0.59,
    "linkage.stiffness": 6107.86 * LB / IN,
    "linkage.damping": 16.2016 * LB / IN,
    "column.inertia": 37.4 * LB * IN,
    "column.base_arm": 10 * IN,
    "column.grip_arm": 31.375 * IN,
}
CURRENT, FLOW = 0.015, 100 * IN**3
EXACT = dict.fromkeys(
    f"{part}.{row}" for part in ("load_cell", "potentiometer", "column_sensor") for row in ("noise", "resolution")
)
"""What makes the sensors of the loader exact."""

PERIOD_S, HELD = 5e-4, np.radians(10.0)
SUBSTEPS = 20
"""Runge-Kutta steps in a period: 25 us, where the fastest pole of oil and damper is at -8e4 1/s."""

NO_ARM = 0.0, 0.0, 0.0

KNOWN = {key: 0.01 if key in {"column.inertia", "linkage.ratio", "column.base_arm"} else 0.2 for key in NOMINAL}
GRID = {"stiffness": "1..100 %:6:log", "frequency": "1, 2, 4 Hz", "damping": "0.2, 0.4, 0.7, 1.5"}
EVEN = {"stiffness": "1..100 %:5:log", "frequency": "1..4 Hz:3:log", "damping": "0.2..1.5:3:log"}
MACHINES, SEED, LAW = 40, 0, "agile"
PASSES, UNSTABLE = 0, 1
"""Places among the program's outcomes."""
EDGE = 0.003
"""Of the displacement: about 5 %, from which on an overshoot counts."""
NEAR = 0.02
"""Share of a tolerance: verdicts that are nearer to the edge may differ by the engine's steps of 0.5 ms."""
APART = 0.002
"""Share of the releases whose verdicts may differ all the same: one oscillation more or less counts whole."""


@dataclass(frozen=True)
class Pairs:
    """Machines and settings, a pair in each place: factors by parameter, I, B, G, the arm, and which law it meets."""

    factors: dict
    feel: np.ndarray
    arm: np.ndarray
    law: np.ndarray


def feel_step(feel):
    """[delta, delta'] after a period under a torque that stays, (pairs, 2, 3) on [delta, delta', torque]."""
    inertia, damping, stiffness = feel.T
    s = np.sqrt((damping / (2 * inertia)) ** 2 - stiffness / inertia + 0j)
    mean, turned = -damping / (2 * inertia), s * PERIOD_S
    decay = np.exp(mean * PERIOD_S)
    even = (decay * np.cosh(turned)).real
    odd = (decay * np.where(np.abs(turned) < 1e-9, PERIOD_S, np.sinh(turned) / np.where(s == 0, 1, s))).real
    first, second, other = even - mean * odd, odd, even + mean * odd
    rows = [[first, second, (1 - first) / stiffness], [-stiffness / inertia * second, other, second / inertia]]
    return np.moveaxis(np.array(rows), 2, 0)


def rates(y, e, v, arm):
    """Time derivative of [x, p, q_i, q_i', theta, theta'] of all pairs."""
    x, p, q_i, q_rate, theta, rate = y
    x_rate = (v["A"] * p - v["k"] * (x - v["lever"] * theta)) / v["c"] + v["lever"] * rate
    q = q_i * np.sqrt(np.maximum(0.0, 1 - np.sign(q_i) * p / v["p_s"]))
    current = np.clip(v["K_2"] * e, -CURRENT, CURRENT)
    command = np.clip(v["q_r"] / CURRENT * current, -FLOW, FLOW)
    torque = v["lever"] * v["A"] * p - arm[1] * rate - arm[2] * theta
    return np.array(
        [
            x_rate,
            v["oil"] * (q - v["A"] * x_rate),
            q_rate,
            v["w"] ** 2 * (command - q_i) - 2 * v["zeta"] * v["w"] * q_rate,
            rate,
            torque / (v["J"] + arm[0]),
        ]
    )


def release(pairs, laws, record):
    """Column angle (pairs, samples) from the release on."""
    built = {key: value * pairs.factors[key] for key, value in NOMINAL.items()}
    names = {"A": "actuator.area", "k": "linkage.stiffness", "c": "linkage.damping", "p_s": "valve.supply_pressure"}
    names |= {"K_2": "amplifier.admittance", "q_r": "valve.rated_flow", "w": "valve.natural_frequency"}
    names |= {"zeta": "valve.damping_ratio", "J": "column.inertia"}
    v = {name: built[key] for name, key in names.items()}
    v["lever"] = built["linkage.ratio"] * built["column.base_arm"]
    v["oil"] = 4 * built["actuator.bulk_modulus"] / built["actuator.oil_volume"]
    arm = (pairs.arm * built["column.grip_arm"][:, None] ** 2).T
    a, b, c, t = (getattr(laws, name)[pairs.law] for name in ("transition", "input", "command", "torque"))
    n, count = a.shape[1], len(pairs.law)

    # Held at rest: xi = a xi + b [y; 0], no command, and the torque that the feel's spring asks for; unknown [xi, F_c, delta].
    equations, right = np.zeros((count, n + 2, n + 2)), np.zeros((count, n + 2))
    known = np.stack([np.zeros(count), v["lever"] * HELD, np.full(count, HELD)], axis=1)  # y but for F_c
    by_force = np.stack([np.ones(count), 1 / v["k"], np.zeros(count)], axis=1)  # y per F_c
    equations[:, :n, :n] = np.eye(n) - a
    equations[:, :n, n] = -np.einsum("pij,pj->pi", b[:, :, :3], by_force)
    right[:, :n] = np.einsum("pij,pj->pi", b[:, :, :3], known)
    for row, law in ((n, c), (n + 1, t)):
        equations[:, row, :n] = law[:, :n]
        equations[:, row, n] = np.einsum("pj,pj->p", law[:, n : n + 3], by_force)
        equations[:, row, n + 1] = law[:, n + 3]
        right[:, row] = -np.einsum("pj,pj->p", law[:, n : n + 3], known)
    equations[:, n + 1, n + 1] -= pairs.feel[:, 2]
    solution = np.linalg.solve(equations, right[..., None])[..., 0]
    xi, force, delta = solution[:, :n], solution[:, n], np.stack([solution[:, n + 1], np.zeros(count)], axis=1)

    zero = np.zeros(count)
    y = np.array([v["lever"] * HELD + force / v["k"], force / v["A"], zero, zero, np.full(count, HELD), zero])
    waiting, feel, h = zero, feel_step(pairs.feel), PERIOD_S / SUBSTEPS
    every, angles = round(record.step_s / PERIOD_S), np.empty((count, record.samples))
    for k in range((record.samples - 1) * every + 1):
        if k % every == 0:
            angles[:, k // every] = y[4]
        measured = np.stack([v["A"] * y[1], y[0], y[4]], axis=1)
        feel_input = np.concatenate([xi, measured, delta], axis=1)
        e, torque = np.einsum("pj,pj->p", c, feel_input), np.einsum("pj,pj->p", t, feel_input)
        answered = np.clip(e, -CURRENT / NOMINAL["amplifier.admittance"], CURRENT / NOMINAL["amplifier.admittance"])
        xi = np.einsum("pij,pj->pi", a, xi) + np.einsum(
            "pij,pj->pi", b, np.concatenate([measured, answered[:, None]], 1)
        )
        delta = np.einsum("pij,pj->pi", feel, np.concatenate([delta, torque[:, None]], axis=1))
        for _ in range(SUBSTEPS):
            first = rates(y, waiting, v, arm)
            second = rates(y + h / 2 * first, waiting, v, arm)
            third = rates(y + h / 2 * second, waiting, v, arm)
            y = y + h / 6 * (first + 2 * second + 2 * third + rates(y + h * third, waiting, v, arm))
        y = np.where(np.abs(y[4]) < 100 * HELD, y, 0.0)  # what has run away has failed
        waiting = e
    return angles


def margin(path, feel, record, edge=EDGE):
    """Least margin as a share of its tolerance; below zero fails, not a number where the count of overshoots is at its edge."""
    reference = features(record.time_s, ideal(feel, HELD, record.time_s))
    steady = path[-len(path) // 10 :].mean()  # an observer's leak leaves it a little off zero for a while
    try:
        actual = features(record.time_s, path - steady)
    except (IndexError, ValueError):  # it never comes back, or it is no longer finite
        return -np.inf
    if any(abs(size - 0.05) < edge for figures in (actual, reference) for size in figures[2][:2]):
        return np.nan
    return min(least_margin(actual, reference), 1 - abs(steady / path[0]) / 0.05)


def margins(settings, feel, cases):
    """Margins (cases, settings) of machines with arms; a case is factors by parameter and an arm."""
    margins_ = np.empty((len(cases), len(feel)))
    laws = LAW_DESIGNS[LAW].design(ff.digital_elevator(), feel)
    for frequency in settings.frequency:
        which = np.flatnonzero(settings.rows[:, 1] == frequency)
        record = Record.of(frequency, settings.damping[0])
        pairs = [(k, setting) for k in range(len(cases)) for setting in which]
        case, law = (np.array(column) for column in zip(*pairs, strict=True))
        factors = {key: np.array([cases[k][0].get(key, 1.0) for k in case]) for key in NOMINAL}
        arm = np.array([cases[k][1] for k in case])
        paths = release(Pairs(factors, feel[law], arm, law), laws, record)
        carried = feel[law] + arm * NOMINAL["column.grip_arm"] ** 2
        margins_[case, law] = [margin(*pair, record) for pair in zip(paths, carried, strict=True)]
    return margins_


def compare(name, actual, codes):
    """Prints how the two reckonings agree; the sentence of a failure, or nothing."""
    clear, stable = np.abs(actual) > NEAR, codes != UNSTABLE
    differ = int((clear & stable & ((actual > 0) != (codes == PASSES))).sum())
    print(
        f"{name}: of {actual.size:,} releases {differ} verdicts differ; {int((~clear).sum())} at an edge are left out"
    )
    slow = int((~stable & (actual > NEAR)).sum())
    print(f"  {slow} more are unstable by their poles and would pass, since they grow slowly")
    return [f"{name}: {differ} verdicts differ"] if differ > APART * actual.size else []


def settled(actual, codes):
    """Which pass here; what is at the edge of the count of overshoots, as the program has it."""
    return np.where(np.isnan(actual), codes == PASSES, actual > 0)


def shares(passes):
    """The two shares of drawn machines, their mean and the worst, as the program counts them."""
    by_setting, by_machine = passes.mean(axis=0), passes.mean(axis=1)
    return np.array([(by_setting >= 0.95).mean(), (by_machine >= 0.95).mean(), passes.mean(), by_machine.min()])


def drawn(corners):
    """All tolerances at once by both reckonings."""
    noisy, draws = ff.digital_elevator(), Draws(MACHINES, SEED, corners)
    both = [
        ff.find_envelope(loader, (LAW,), GRID, changes=KNOWN, arms=(), draws=draws)
        for loader in (noisy.replace(EXACT, si=True), noisy)
    ]
    plan = both[0].plan
    cases = [({key: 1 + share for key, share in machine.off.items()}, NO_ARM) for machine in plan.machines]
    actual = margins(plan.settings, plan.settings.feel(plan.loader), cases)
    exact, with_noise = (envelope.data["drawn_outcome"].values[0].reshape(actual.shape) for envelope in both)
    name = "at the corners" if corners else "at random"
    for whose, passes in (
        ("here", settled(actual, exact)),
        ("program", exact == PASSES),
        ("program, with noise", with_noise == PASSES),
    ):
        numbers = "settings {:.1%}, machines {:.1%}, mean {:.1%}, worst machine {:.1%}".format(*shares(passes))
        print(f"all at once, {name}, {whose}: {numbers}")
    return compare(name, actual, exact)


def one_at_a_time():
    """The cases on a grid that is even in proportion on all three axes, by both reckonings."""
    noisy = ff.digital_elevator()
    both = [ff.find_envelope(loader, (LAW,), EVEN) for loader in (noisy.replace(EXACT, si=True), noisy)]
    plan = both[0].plan
    cases = [
        ({key: 1 + share for key, share in case.off.items()}, case.arm.values if case.arm else NO_ARM)
        for case in plan.cases
    ]
    actual = margins(plan.settings, plan.settings.feel(plan.loader), cases)
    passes = [settled(actual, both[0].codes(LAW)), *(envelope.passes(LAW) for envelope in both)]
    for whose, passing in zip(("here", "program", "program, with noise"), passes, strict=True):
        print(f"even grid, {whose}: nominally {passing[0].mean():.1%}, in every case {passing.all(axis=0).mean():.1%}")
    return compare("cases", actual, both[0].codes(LAW))


def any_law():
    """What is left of the standard grid to any law with the inertia known to 20 %, linear, or right for masses in the hand too.

    With a mass of up to 2 e J / R_p^2 in the hand one motion must pass as the release of I, of I + 2 e J and of all between.
    """
    plan = make_plan(ff.digital_elevator(), (LAW,))
    off = np.array([0.2 * plan.loader["column.inertia"], 0.0, 0.0])
    linear, possible = inertia_bound(plan, (0.2,)).shares[0], np.zeros(plan.settings.count, dtype=bool)
    for group in setting_groups(plan, cores()):
        shifted = [replace(group, feel=group.feel + k * off, _ideal={}) for k in (0.0, 0.5, 1.0, 1.5, 2.0)]
        for lean in np.linspace(0, 2, 9):
            for damping in DAMPINGS:
                motion = group.feel * [1, damping, 1] + lean * off
                possible[group.which] |= np.all([shifted_group.passes(motion) for shifted_group in shifted], axis=0)
    print(
        f"inertia known to 20 %: {linear:.1%} are left to a linear law, {possible.mean():.1%} to any law that must be right"
    )
    print("  for whatever mass of up to 0.4 J / R_p^2 the hand holds")
    return []


def main():
    assert set(CHANGES) - set(NOMINAL) == {"valve.current_gain", "valve.pressure_gain"}  # the orifice stands for these
    failed = []
    for work in (lambda: drawn(corners=False), lambda: drawn(corners=True), one_at_a_time, any_law):
        begin = time.perf_counter()
        failed += work()
        print(f"{time.perf_counter() - begin:.0f} s", flush=True)
    for failure in failed:
        print("FAILED", failure)
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
