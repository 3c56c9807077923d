"""What ``pip install forcefeel`` brings suffices for the daily commands; the others name the extra that they lack.

Each command runs where no package can be imported but those of the small install, by its requirements and theirs.
"""

import re
import subprocess
import sys
import tomllib
from functools import cache
from importlib.metadata import distribution, packages_distributions
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from forcefeel.errors import EXTRAS
from tests.parametrization import mostly_slow

PROJECT = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]

RUN = """
import sys
for name in sys.argv[1].split(","):
    sys.modules[name] = None  # an import of it is a ModuleNotFoundError
del sys.argv[1]
import forcefeel.cli
forcefeel.cli.main()
"""


def _brought(requirements, extra=""):
    """The distributions that these requirements install, with all that they require."""
    names = set()
    for requirement in map(Requirement, requirements):
        if requirement.marker and not requirement.marker.evaluate({"extra": extra}):
            continue
        name = canonicalize_name(requirement.name)
        names |= {name} | _brought(distribution(name).requires or ())
    return names


@cache
def _left_out():
    """Looked up where it is needed: it takes each worker a second."""
    small = {*_brought(PROJECT["dependencies"]), "forcefeel"}
    return sorted(
        module
        for module, owners in packages_distributions().items()
        if module.isidentifier() and not {canonicalize_name(owner) for owner in owners} & small
    )


def _run(folder, *words):
    command = [sys.executable, "-P", "-c", RUN, ",".join(_left_out()), *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, check=False)


@pytest.mark.parametrize(
    "words",
    mostly_slow(
        [
            "new my.toml",
            "analyze",
            "simulate elevator-2khz --input release --angle 10deg",
            "law elevator-1974",
            "law elevator-2khz --law robust --save-law robust.json",
            "design",
            "export elevator-2khz --law robust --to c --out c",
            "export elevator-2khz --law robust --to fmu --out fmu",
            "run elevator-2khz --law robust --duration 1",
        ],
        2,
    ),
)
def test_small_install_suffices(tmp_path, words):
    done = _run(tmp_path, *words.split())
    assert done.returncode == 0, done.stderr
    if words == "design":
        assert "pip install 'forcefeel[pages]'" in done.stderr
        assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "package"),
    mostly_slow(
        [
            ("design --out report", "pages"),
            ("law elevator-2khz --law robust --out law", "pages"),
            ("simulate --out run", "pages"),
            ("envelope", "pages"),
            ("fly sidestick-pitch", "fly"),
            ("sweep --runs 10", "pages"),
            ("qualify elevator-2khz --law robust", "pages"),
        ],
        2,
    ),
)
def test_command_names_the_extra_that_it_lacks(tmp_path, words, package):
    done = _run(tmp_path, *words.split())
    assert done.returncode == 2
    assert re.search(rf"pip install 'forcefeel\[({package}|pages)\]'$", done.stderr.strip()), done.stderr
    assert not list(tmp_path.iterdir())


def test_extras_are_those_of_the_project():
    """Each package that an extra brings is among its import names, and no extra is unknown to its error."""
    stated = {name: requirements for name, requirements in PROJECT["optional-dependencies"].items() if name != "all"}
    assert stated.keys() == EXTRAS.keys()
    for extra, requirements in stated.items():
        packages = {Requirement(text).name for text in requirements} - {"forcefeel"}
        assert packages <= set(EXTRAS[extra])
