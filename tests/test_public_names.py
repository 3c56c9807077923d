"""The public names: few at the top, the rest in the commands' modules, all there, each of them where it is said to be."""

import ast
import inspect
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import forcefeel as ff
from forcefeel.public_names import imports_of

PACKAGE = Path(ff.__file__).parent
MODULES = ["forcefeel", *(f"forcefeel.{stub.parent.name}" for stub in sorted(PACKAGE.glob("*/__init__.pyi")))]
MOST = 25


@pytest.mark.parametrize("module", MODULES)
def test_number_of_public_names_is_limited(module):
    assert 0 < len(import_module(module).__all__) <= MOST


@pytest.mark.parametrize("module", MODULES)
def test_every_public_name_exists_and_is_documented(module):
    for name in import_module(module).__all__:
        assert inspect.getdoc(getattr(import_module(module), name)), f"{module}.{name} has no docstring"


@pytest.mark.parametrize("module", MODULES)
def test_no_module_hides_a_name(module):
    """The import of a submodule sets the package's attribute of its name."""
    folder = PACKAGE.joinpath(*module.split(".")[1:])
    modules = {path.stem for path in folder.glob("*.py")} | {path.parent.name for path in folder.glob("*/__init__.py")}
    assert modules.isdisjoint(import_module(module).__all__)


def test_dir_of_package_lists_names_and_modules():
    assert dir(ff) == sorted([*ff.__all__, *(module.removeprefix("forcefeel.") for module in MODULES[1:])])


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="module 'forcefeel' has no attribute 'elevater'"):
        _ = ff.elevater


def test_project_uses_names_from_their_public_modules():
    """What mypy shows of the package, for the rest: tests and documents make warnings errors where they run."""
    root = Path(__file__).parents[1]
    public = imports_of(PACKAGE / "__init__.pyi")
    files = [path for folder in ("tests", "benchmarks", "docs", "examples") for path in (root / folder).rglob("*.py")]
    used = [
        f"{path.name}: ff.{node.attr}"
        for path in files
        if path != Path(__file__)
        for text in [path.read_text(encoding="utf-8")]
        if not {*re.findall(r"\bff\s*\.\s*(\w+)", text)} <= {*public}  # a part of it may be text: then look closely
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "ff"
        if node.attr not in public
    ]
    assert [one for one in used if not one.endswith(("__", "ff._core"))] == []


HEAVY = ("control", "matplotlib", "scipy", "xarray", "pandas", "plotly", "pint", "pydantic", "jinja2", "rich")


def test_loader_import_loads_no_heavy_library():
    code = f"import sys, forcefeel as ff; ff.elevator(); ff.loader; print([m for m in {HEAVY} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
