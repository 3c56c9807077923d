"""forcefeel designs, proves and runs the force feel of aircraft simulator controls.

Here stand the names that most people need; ``__init__.pyi`` lists them. What else is public is in the modules with the commands'
names: ``forcefeel.linear``, ``forcefeel.laws``, ``forcefeel.bench``, ... A module is called by a noun, a function by a verb; so
``forcefeel.envelope`` is a module, and ``forcefeel.find_envelope`` computes one. All are fetched when first used.
"""

import sys
import warnings
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from forcefeel.public_names import imports_of, public_names

_fetch, __dir__, __all__ = public_names(__name__, __file__)

# What follows answers to the names of 0.1 and goes with 0.2.

_FUNCTIONS = {
    "conclusions": "design.conclusions",
    "design": "design_loader",
    "envelope": "find_envelope",
}
"""Names that were a function's and are a module's; where the function is."""


def __getattr__(name: str) -> Any:
    try:
        return _fetch(name)
    except AttributeError:
        if name in _FUNCTIONS:
            return import_module(f"forcefeel.{name}")
        if name.startswith("_") or not (place := _moved(name)):
            raise
    _warn(name, place)
    return getattr(import_module(f"forcefeel.{place}"), name)


def _moved(name: str) -> str:
    """The public module that has a name; nothing if none has."""
    if name == "Conclusions":
        return "conclusions"
    stubs = sorted(Path(__file__).parent.glob("*/__init__.pyi"))
    return next((stub.parent.name for stub in stubs if name in imports_of(stub)), "")


def _warn(name: str, place: str) -> None:
    place = place if place in _FUNCTIONS.values() else f"{place}.{name}"
    warnings.warn(f"forcefeel.{name} is now forcefeel.{place}", DeprecationWarning, stacklevel=3)


class _OnceAFunction(ModuleType):
    """A module that may still be called as the function that had its name."""

    def __call__(self, *args: Any, **options: Any) -> Any:
        name = self.__name__.rpartition(".")[2]
        _warn(name, _FUNCTIONS[name])
        module, _, function = f"forcefeel.{_FUNCTIONS[name]}".rpartition(".")
        return getattr(import_module(module), function)(*args, **options)


class _Package(ModuleType):
    """The package, which sees a module come that was a function."""

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _FUNCTIONS and isinstance(value, ModuleType):
            value.__class__ = _OnceAFunction
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
