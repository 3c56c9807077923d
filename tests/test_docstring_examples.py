"""Every public name has an example in its docstring, and every example runs and gives what it says.

The example of a function is that of what it returns, and the names of an enumeration are its own.
"""

import doctest
import inspect
import re
from enum import Enum
from functools import cache
from importlib import import_module
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

import forcefeel as ff
from forcefeel.design import workflow

ROOT = Path(__file__).parents[1]
PACKAGE = Path(ff.__file__).parent
MODULES = ["forcefeel", *(f"forcefeel.{stub.parent.name}" for stub in sorted(PACKAGE.glob("*/__init__.pyi")))]
COMPILED = {"GainLaw"}
"""Documented by the extension's own source."""


def public():
    """Each class and function once, by the first place that it is public in."""
    found = {}
    for module in MODULES:
        for name in import_module(module).__all__:
            thing = getattr(import_module(module), name)
            if callable(thing) and name not in COMPILED and thing not in found.values():
                found[f"{module}.{name}"] = thing
    return found


PUBLIC = public()
ASSUMED = {"ff": ff, "np": np, "Path": Path}
"""Imports that every example goes without, as docs/reference/python.rst says."""
RETURNED = {
    word
    for thing in PUBLIC.values()
    if not inspect.isclass(thing)
    for word in re.findall(r"\w+", inspect.formatannotation(inspect.signature(thing).return_annotation))
}
DESIGN = cache(workflow.design_loader)
"""Half a dozen examples begin with the same design."""


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    """A folder to write in, with the project's data to read."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    mpl.use("Agg")
    monkeypatch.setattr(workflow, "design_loader", DESIGN)


SLOW = {
    *("forcefeel.choice.best_law", "forcefeel.feel.feel_conclusions", "forcefeel.feel.write_feel"),
    *("forcefeel.fly.FlightReport", "forcefeel.fly.Flown", "forcefeel.fly.Maneuver"),
    *("forcefeel.fly.fly_maneuver", "forcefeel.fly.write_flight", "forcefeel.live.HostState"),
    *("forcefeel.frontier.LinkFrontier", "forcefeel.frontier.LinkLimit", "forcefeel.frontier.write_links"),
    *("forcefeel.frontier.link_frontier", "forcefeel.frontier.write_frontier", "forcefeel.sweep.write_sweep"),
    *("forcefeel.fly.fly", "forcefeel.fly.fly_live", "forcefeel.bus.play", "forcefeel.design.write_report"),
    *("forcefeel.feel.fit_feel", "forcefeel.design.design_servo", "forcefeel.commission.simulated_records"),
    *("forcefeel.choice.choose", "forcefeel.reproduction.reproduce", "forcefeel.choice.write_choice"),
    *("forcefeel.find_frontier", "forcefeel.envelope.soften", "forcefeel.envelope.write_envelope"),
    *("forcefeel.bench.excite", "forcefeel.bench.write_excitation", "forcefeel.bench.write_identification"),
    *("forcefeel.flight_schedule.write_schedule", "forcefeel.linked.check_link", "forcefeel.design.drop_paths"),
    *("forcefeel.fly.HeldFlight", "forcefeel.choice.score_laws", "forcefeel.sweep.write_linked_sweep"),
}
"""Examples of seconds; the tests of each command run the same functions."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in PUBLIC]
)
def test_docstring_example_gives_stated_output(name):
    thing = PUBLIC[name]
    own = [test for test in doctest.DocTestFinder().find(thing, name, globs=ASSUMED) if test.examples]
    shown_by_function = inspect.isclass(thing) and (issubclass(thing, Enum) or thing.__name__ in RETURNED)
    assert shown_by_function or any(test.name == name for test in own), "has no example"
    failures = []
    runner = doctest.DocTestRunner(verbose=False)
    for test in own:
        runner.run(test, out=failures.append)
    assert failures == []


def test_slow_examples_are_of_public_names():
    assert SLOW - PUBLIC.keys() == set()


def test_wrong_docstring_example_is_detected():
    def adds():
        """Adds.

        Example:
            >>> 1 + 1
            3
        """

    (test,) = doctest.DocTestFinder().find(adds, "adds", globs={})
    assert doctest.DocTestRunner(verbose=False).run(test, out=lambda text: None).failed == 1
    assert inspect.getdoc(adds)
