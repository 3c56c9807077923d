"""The law ``robust`` on loaders that it was not made for: drawn within a factor of two, known exactly, released from 10 and 2 deg.

    python benchmarks/drawn_loaders.py [loaders]

Each has twelve parameters of ``elevator-2khz`` times a factor between 1/2 and 2, even in proportion, the same sensors and the same
programmed feels. Counted are the settings that its limits allow: not those that ask for more flow or pressure than there is
(``frontier``), nor those whose link, stretched by the hand, throws the column back further than ``THROWN`` before the largest flow
can have stopped it:

    theta_0 - theta = 2/3 (G theta_0 / J) t_0^2,    t_0 the time in which the largest flow lets go of the link

the torque going from -G theta_0 through zero at ``t_0`` to what has stopped the column at ``2 t_0``. The seeds are none of those
that the numbers of ``laws/sampled/rules.py`` were found with.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
from dataclasses import dataclass
from math import radians

import numpy as np

import forcefeel as ff
from forcefeel.envelope.plan import make_plan
from forcefeel.envelope.run import compute_few
from forcefeel.frontier.valve_limits import valve_limits

FACTORS = (
    "amplifier.admittance",
    "valve.rated_flow",
    "valve.supply_pressure",
    "valve.natural_frequency",
    "actuator.area",
    "actuator.oil_volume",
    "actuator.bulk_modulus",
    "linkage.ratio",
    "linkage.stiffness",
    "linkage.damping",
    "column.inertia",
    "column.base_arm",
)
OPERATING_CURRENT, OPERATING_PRESSURE = 0.2, 0.33
"""Of the rated current and the supply's pressure, where the report takes the valve's gains."""
GRID = {"stiffness": "1..100 %:5:log", "frequency": "0.5..4 Hz:4:log", "damping": "0.1, 0.4, 1.5"}
RELEASES_DEG = (10.0, 2.0)
LOADERS, FIRST_SEED = 50, 1000
THROWN = 0.1
"""Share of the deflection: where the rule begins to measure a release."""
GOOD, PROMISED = 0.95, 0.9


@dataclass(frozen=True)
class Rendered:
    """Of one loader and release: share of all settings that its limits allow, and share of those that pass."""

    allowed: float
    passes: float


def drawn(seed: int) -> ff.Loader:
    """A loader whose parameters are the built-in one's times 1/2 to 2."""
    nominal = ff.digital_elevator()
    factors = 2 ** np.random.default_rng(seed).uniform(-1, 1, len(FACTORS))
    found = {key: float(nominal[key] * factor) for key, factor in zip(FACTORS, factors, strict=True)}
    found["linkage.ratio"] = min(found["linkage.ratio"], 1.0)
    flow, drop = found["valve.rated_flow"], np.sqrt(1 - OPERATING_PRESSURE)
    found["valve.flow_limit"] = flow
    found["valve.current_gain"] = float(flow / nominal["valve.rated_current"] * drop)
    found["valve.pressure_gain"] = float(flow * OPERATING_CURRENT / (2 * found["valve.supply_pressure"] * drop))
    return nominal.replace(found)


def rendered(loader: ff.Loader, release_deg: float) -> Rendered:
    """What `robust` renders of a loader's settings."""
    plan = make_plan(loader, ["robust"], GRID, changes={}, arms=(), angle_rad=radians(release_deg))
    limits = valve_limits(plan, threads=1)
    thrown = 2 / 3 * plan.settings.feel(loader)[:, 2] / loader["column.inertia"] * limits.unload_s**2
    allowed = ~limits.forbidden & (thrown <= THROWN)
    passes = compute_few(plan, threads=1).passes("robust")[0]
    return Rendered(float(allowed.mean()), float(passes[allowed].mean()) if allowed.any() else 1.0)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else LOADERS
    bad = []
    for release in RELEASES_DEG:
        found = [rendered(drawn(FIRST_SEED + k), release) for k in range(count)]
        passes = np.array([one.passes for one in found])
        good = int((passes >= GOOD).sum())
        print(
            f"release from {release:g} deg: limits allow {np.mean([one.allowed for one in found]):.1%} of the settings, of which "
            f"robust renders {passes.mean():.1%}, the worst loader {passes.min():.1%}; {good} of {count} loaders reach {GOOD:.0%}"
        )
        if good < PROMISED * count:
            bad.append(f"{release:g} deg")
    if bad:
        sys.exit(f"fewer than {PROMISED:.0%} of the loaders reach {GOOD:.0%} from {', '.join(bad)}")


if __name__ == "__main__":
    main()
