"""Of the drawn loaders that fall short of 95 % under ``robust``: what forbids, and the least change of one part that lifts each.

    python benchmarks/short_loaders.py [--first-seed 6000] [--out docs/how-to/short-loaders.svg]

One part of the loader at a time is made better by the shares of ``STEPS`` and the law designed anew; what counts is the least share
with which it renders 95 % of the settings that its limits then allow. Drawn is the release of the worst failing setting over its
ideal: the angle, and flow and current as shares of the largest.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
from math import radians
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.hashsalt"] = "forcefeel"
import matplotlib.pyplot as plt
import numpy as np
from drawn_loaders import GOOD, GRID, LOADERS, drawn, known, rendered

import forcefeel as ff
from forcefeel.envelope.ideal import ideal_releases
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute

RELEASE_DEG = 10.0
STEPS = (1.02, 1.05, 1.1, 1.2, 1.5, 2.0)
BETTER = {
    "flow": ("valve.rated_flow", "valve.flow_limit", "valve.current_gain", "valve.pressure_gain"),
    "pressure": ("valve.supply_pressure",),
    "valve's frequency": ("valve.natural_frequency",),
    "link's stiffness": ("linkage.stiffness",),
}
"""Parameters that are made better together."""
SHOWN_S, DRAWN = 0.16, 3


def lifts(loader: ff.Loader) -> dict[str, float]:
    """The least share by which each part must be better, infinite where none of ``STEPS`` does."""
    lifts_ = {}
    for name, keys in BETTER.items():
        steps = (known(loader.replace({key: step * loader[key] for key in keys}, si=True)) for step in STEPS)
        good = (
            step - 1 for step, loader in zip(STEPS, steps, strict=True) if rendered(loader, RELEASE_DEG).passes >= GOOD
        )
        lifts_[name] = next(good, np.inf)
    return lifts_


def worst(loader: ff.Loader) -> tuple[np.ndarray, str]:
    """I, B, G of the setting that fails by most among those that are allowed, and by what."""
    plan = make_plan(loader, ["robust"], GRID, changes={}, arms=(), angle_rad=radians(RELEASE_DEG))
    envelope = compute(plan, threads=1)
    margin, outcome = (envelope.data[name].values[0, 0].ravel() for name in ("margin", "outcome"))
    counted = np.where((outcome != 0) & ~envelope.forbidden.settings, np.nan_to_num(margin, nan=-np.inf), np.inf)
    index = int(np.argmin(counted))
    return plan.settings.feel(loader)[index], envelope.outcomes[outcome[index]]


def draw(axes: np.ndarray, loader: ff.Loader, seed: int) -> None:
    """The release of the worst setting over its ideal, and the flow."""
    feel, why = worst(loader)
    rows = dict(zip(("feel.inertia", "feel.damping", "feel.stiffness"), feel.tolist(), strict=True))
    loader_ = loader.replace(rows, si=True)
    history = ff.simulate(
        loader_, ff.Scenario(ff.Release(radians(RELEASE_DEG)), duration_s=SHOWN_S), ff.Law.of("robust", loader_)
    ).history
    time = np.asarray(history["time_s"])
    ideal = ideal_releases(feel[None], RELEASE_DEG, float(time[1] - time[0]), len(time))[0]
    angle, flow = axes
    angle.plot(1e3 * time, ideal, "k:", label="ideal")
    angle.plot(1e3 * time, np.degrees(history["column_angle_rad"]), label="robust")
    angle.axhline(0.9 * RELEASE_DEG, color="0.7", linewidth=0.8)
    frequency = np.sqrt(feel[2] / feel[0]) / (2 * np.pi)
    angle.set_title(f"seed {seed}: {frequency:.2g} Hz, fails by {why}", fontsize=9)
    flow.plot(1e3 * time, history["actuator_flow_m3_per_s"] / loader["valve.flow_limit"], label="flow / largest")
    flow.plot(
        1e3 * time,
        history["valve_current_a"] / loader["amplifier.current_limit"],
        label="current / largest",
        linewidth=0.8,
    )
    flow.set_xlabel("ms after the release")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first-seed", type=int, default=6000)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    seeds = range(options.first_seed, options.first_seed + LOADERS)
    shares = {seed: rendered(drawn(seed), RELEASE_DEG).passes for seed in seeds}
    short = sorted((seed for seed in seeds if shares[seed] < GOOD), key=shares.__getitem__)
    for seed in short:
        better = sorted(lifts(drawn(seed)).items(), key=lambda lift: lift[1])
        text = ", ".join(f"{name} +{share:.0%}" for name, share in better if share < np.inf)
        print(f"{seed}: {shares[seed]:.1%}, lifted by {text or 'none of these alone'}", flush=True)
    if options.out:
        figure, axes = plt.subplots(2, DRAWN, figsize=(11, 5), sharex="col", squeeze=False)
        for column, seed in zip(axes.T, short, strict=False):
            draw(column, drawn(seed), seed)
        axes[0, 0].set_ylabel("column, deg")
        for row in axes:
            row[0].legend(fontsize=8)
        figure.tight_layout()
        figure.savefig(options.out, metadata={"Date": None})


if __name__ == "__main__":
    main()
