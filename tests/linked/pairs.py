"""Linked loaders for the tests."""

from dataclasses import replace

import numpy as np

import forcefeel as ff
from forcefeel import _core
from forcefeel.laws.law import Law
from forcefeel.loader.links import LINK_TABLE
from forcefeel.simulation.engine import prepared

EXAMPLES = "examples/cockpit"
LB, LB_IN, DEG = 4.4482216152605, 0.1129848290276167, np.pi / 180


def project(name):
    """A ready project."""
    return ff.loader.read_project(f"{EXAMPLES}/{name}.toml")


def simulated(name, first, second=None, kind=None, **more):
    """A run of a ready project with two forces; of another kind of link if one is given."""
    axes = project(name)
    if kind is not None:
        axes = replace(axes, links={key: replace(link, kind=kind) for key, link in axes.links.items()})
    scenario = ff.linked.LinkedScenario(first, second_force=second or ff.simulation.HandsOff(), **more)
    return ff.linked.simulate_linked(axes, next(iter(axes.links)), scenario, "robust")


def link_values(**si):
    """SI values of a link, in the order of its table."""
    assert set(si) <= set(LINK_TABLE)
    return np.array([si.get(name, row.off_si) for name, row in LINK_TABLE.items()], dtype=float)


def raw(loaders, scenarios, values, law, outputs=(0, 1, 2), **joint):
    """The core's rows of two loaders: ``outputs`` of the first, of the second, then those of the link."""
    sides = []
    for loader, scenario in zip(loaders, scenarios, strict=True):
        kinds = {"law": law} if law == "open" else Law.of(law, loader).engine(loader)
        engine = prepared(loader, scenario, outputs)
        sides.append(
            (engine, loader.si_values[np.newaxis], kinds.get("law"), kinds.get("gains"), kinds.get("observers"))
        )
    return _core.simulate_linked(*sides, values[np.newaxis], **joint)[0]
