"""The public names: listed once for the program, once for type checkers, and all there."""

import ast
import inspect
from pathlib import Path

import forcefeel as ff

STUB = Path(ff.__file__).with_suffix(".pyi")


def test_stub_and_module_list_the_same_names_from_the_same_modules():
    imports = [node for node in ast.parse(STUB.read_text(encoding="utf-8")).body if isinstance(node, ast.ImportFrom)]
    listed = {alias.name: node.module.removeprefix("forcefeel.") for node in imports for alias in node.names}
    assert listed == ff._HOME


def test_every_name_is_there_and_documented():
    for name in ff.__all__:
        thing = getattr(ff, name)
        assert inspect.getdoc(thing), f"{name} has no docstring"
        assert not inspect.ismodule(thing)
